//! States in which a model can be: where it is, and the zone of its clocks with a few more that only run.

use std::sync::Arc;

use hrdsl_ir::{EventId, Value};
use hrdsl_ta::dbm::{Dbm, DbmBound};

/// An event of the model, with its arguments and who sends it.
#[derive(Clone, Debug)]
pub(crate) struct SentOutput {
    pub event: EventId,
    pub args: Vec<Value>,
    /// Index in the network, and in the automaton.
    pub edge: (usize, usize),
}

impl SentOutput {
    pub(crate) fn is(&self, event: EventId, args: &[Value]) -> bool {
        self.event == event
            && self.args.len() == args.len()
            && self.args.iter().zip(args).all(|(a, b)| a.key() == b.key())
    }

    /// As a part of a key.
    fn words(&self) -> impl Iterator<Item = u64> {
        let args = self.args.iter().flat_map(|a| [u64::from(a.key().0), a.key().1]);
        [u64::from(self.event.0), self.edge.0 as u64, self.edge.1 as u64].into_iter().chain(args)
    }
}

/// What a clock after those of the network measures.
#[derive(Clone, Debug)]
pub(crate) enum ExtraClock {
    /// The time since an output that was not seen yet; the oldest comes first.
    Queued(Arc<SentOutput>),
    /// Of a bound that is watched: a copy of what it compares, made when an edge was taken.
    Copied(usize),
    /// The time since that edge; the copy comes just before.
    Since(usize),
}

/// A set of states of the model with the same locations, variables and outputs on their way.
#[derive(Clone, Debug)]
pub(crate) struct PossibleState {
    pub discrete: Vec<i64>,
    /// Those of the network, then the time since the last observation, then the extra ones.
    pub zone: Dbm,
    pub extras: Vec<ExtraClock>,
}

/// What two states must have in common to be compared.
pub(crate) type StateKey = (Vec<i64>, Vec<u64>);

impl PossibleState {
    /// The clock that measures the time since the last observation.
    pub(crate) fn since(&self) -> usize {
        self.zone.dim() - 1 - self.extras.len()
    }

    pub(crate) fn key(&self) -> StateKey {
        let words = self.extras.iter().flat_map(|extra| {
            let (kind, bound, output) = match extra {
                ExtraClock::Queued(output) => (0, 0, Some(output)),
                ExtraClock::Copied(bound) => (1, *bound as u64, None),
                ExtraClock::Since(bound) => (2, *bound as u64, None),
            };
            [kind, bound].into_iter().chain(output.into_iter().flat_map(|o| o.words()))
        });
        (self.discrete.clone(), words.collect())
    }

    /// The oldest output that was not seen yet.
    pub(crate) fn queued(&self) -> Option<&Arc<SentOutput>> {
        self.extras.iter().find_map(queued)
    }

    /// The clocks that measure how long ago outputs were.
    pub(crate) fn ages(&self) -> impl Iterator<Item = usize> + '_ {
        let first = self.since() + 1;
        self.extras.iter().zip(first..).filter(|(extra, _)| queued(extra).is_some()).map(|(_, at)| at)
    }

    /// A clock more: a copy of another one (0: it begins at zero).
    pub(crate) fn with(mut self, copied: usize, extra: ExtraClock) -> Self {
        let old = clocks(self.zone.dim());
        let from: Vec<(u16, i64)> = old.chain([(number(copied), 0)]).collect();
        self.gather(&from);
        self.extras.push(extra);
        self
    }

    /// Without the oldest output that was not seen yet.
    pub(crate) fn popped(mut self) -> Self {
        let Some(place) = self.extras.iter().position(|extra| queued(extra).is_some()) else { return self };
        let at = self.since() + 1 + place;
        let from: Vec<(u16, i64)> =
            clocks(self.zone.dim()).filter(|(clock, _)| usize::from(*clock) != at).collect();
        self.gather(&from);
        self.extras.remove(place);
        self
    }

    /// Now something was observed: the time since the last observation begins anew, and what was watched is dropped.
    pub(crate) fn observed(mut self) -> Self {
        let since = self.since();
        let is_kept = |clock: usize| {
            clock <= since || self.extras.get(clock - since - 1).is_some_and(|extra| queued(extra).is_some())
        };
        let kept = clocks(self.zone.dim()).filter(|(clock, _)| is_kept(usize::from(*clock)));
        let from: Vec<(u16, i64)> =
            kept.map(|(clock, by)| if usize::from(clock) == since { (0, 0) } else { (clock, by) }).collect();
        self.gather(&from);
        self.extras.retain(|extra| queued(extra).is_some());
        self
    }

    fn gather(&mut self, from: &[(u16, i64)]) {
        let mut zone = Dbm::zero(1);
        zone.gather(&self.zone, from);
        self.zone = zone;
    }

    /// The part of it where so much time has passed since the last observation.
    pub(crate) fn at(&self, since: i64) -> Option<Self> {
        let mut part = self.clone();
        let clock = part.since();
        let is_there = part.zone.constrain(clock, 0, DbmBound::le(since))
            && part.zone.constrain(0, clock, DbmBound::le(-since));
        is_there.then_some(part)
    }
}

/// The values at which the clocks of watched bounds were looked at, as far as all these states agree how often that was: each as one range.
pub(crate) fn common_samples(states: &[PossibleState]) -> Vec<(usize, i64, Option<i64>)> {
    let of = |state: &PossibleState| {
        let first = state.since() + 1;
        let copies = state.extras.iter().zip(first..).filter_map(|(extra, at)| match extra {
            ExtraClock::Copied(bound) => Some((*bound, at)),
            ExtraClock::Queued(_) | ExtraClock::Since(_) => None,
        });
        let sample = |(bound, at): (usize, usize)| {
            let (least, most) = range(&state.zone, at, at + 1);
            (bound, least, most)
        };
        copies.map(sample).collect::<Vec<_>>()
    };
    let mut all = states.iter().map(of);
    let mut common = all.next().unwrap_or_default();
    for other in all {
        let times = |of: &[(usize, i64, Option<i64>)], bound| of.iter().filter(|s| s.0 == bound).count();
        let other = other.as_slice();
        let agreed = common.clone();
        common.retain(|(bound, _, _)| times(&agreed, *bound) == times(other, *bound));
        let mut seen: Vec<usize> = Vec::new();
        for (bound, least, most) in &mut common {
            let nth = seen.iter().filter(|b| *b == bound).count();
            seen.push(*bound);
            let Some(same) = other.iter().filter(|s| s.0 == *bound).nth(nth) else { continue };
            *least = (*least).min(same.1);
            *most = most.zip(same.2).map(|(a, b)| a.max(b));
        }
    }
    common
}

fn queued(extra: &ExtraClock) -> Option<&Arc<SentOutput>> {
    match extra {
        ExtraClock::Queued(output) => Some(output),
        ExtraClock::Copied(_) | ExtraClock::Since(_) => None,
    }
}

fn clocks(dim: usize) -> impl Iterator<Item = (u16, i64)> {
    (0..number(dim)).map(|clock| (clock, 0))
}

/// Networks have fewer clocks than a `u16` can count.
fn number(clock: usize) -> u16 {
    u16::try_from(clock).unwrap_or(u16::MAX)
}

/// The least and the greatest value of the difference of two clocks in a zone; none: there is no greatest.
pub(crate) fn range(zone: &Dbm, clock: usize, minus: usize) -> (i64, Option<i64>) {
    let (least, most) = (zone.at(minus, clock), zone.at(clock, minus));
    let bounded = |bound: DbmBound| (!bound.is_infinite()).then(|| bound.value());
    (bounded(least).map_or(i64::MIN, |n| -n), bounded(most))
}
