//! What a recording shows of a model: the parts of it that possible states visit, and what it allows after each observation.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{EventId, ta::AutomatonId};

use crate::{
    states::{PossibleState, range},
    walk::ModelWalk,
};

/// A location or an edge of an automaton, by its place there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ModelPart {
    Location(AutomatonId, usize),
    Edge(AutomatonId, usize),
}

/// An event with its arguments, as a key.
type OutputKey = (EventId, Vec<(u8, u64)>);
/// From when to when, in time since the observation; without an end, for as long as was asked.
type TimeWindow = (i64, Option<i64>);

/// What a model allows from an observation on, for as long as was asked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Allowance {
    /// When each output may come: windows in order, none of which meets another.
    outputs: BTreeMap<OutputKey, Vec<TimeWindow>>,
    /// How long it may be silent.
    silence: Option<i64>,
}

/// What a recording shows of a model.
#[derive(Clone, Debug, Default)]
pub struct ModelTrail {
    visited: BTreeSet<ModelPart>,
    /// After each observation, and before the first; `None` where it is too much to look ahead.
    allowances: Vec<Option<Allowance>>,
}

/// What one model allows of what another does not, and the other way round, after the same observations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AllowanceDifference {
    /// Something that the other allows is not allowed.
    pub less: bool,
    /// Something is allowed that the other does not allow.
    pub more: bool,
}

impl ModelTrail {
    /// Whether this location is one in which the model could be, this edge one that it could take, up to the end of the recording.
    #[must_use]
    pub fn visits(&self, part: ModelPart) -> bool {
        self.visited.contains(&part)
    }

    /// What it allows, against the same model with a change, on the same recording; up to where one of them departs.
    #[must_use]
    pub fn against(&self, other: &Self) -> AllowanceDifference {
        let mut difference = AllowanceDifference::default();
        for (own, others) in self.allowances.iter().zip(&other.allowances) {
            let (Some(own), Some(others)) = (own, others) else { continue };
            difference.less |= !own.covers(others);
            difference.more |= !others.covers(own);
        }
        difference
    }

    /// Keeps what the model allows in these states, in which it was seen to be, for some time.
    pub(crate) fn look_ahead(&mut self, walk: &mut ModelWalk, states: &[PossibleState], time: i64) {
        self.allowances.push(Allowance::of(walk, states, time));
    }

    pub(crate) fn visit(&mut self, parts: impl IntoIterator<Item = ModelPart>) {
        self.visited.extend(parts);
    }
}

impl Allowance {
    fn of(walk: &mut ModelWalk, states: &[PossibleState], time: i64) -> Option<Self> {
        let mut outputs: BTreeMap<OutputKey, Vec<TimeWindow>> = BTreeMap::new();
        let reached = walk.foreseen(states, time, &mut |seen| {
            let args = seen.output.args.iter().map(|arg| arg.key()).collect();
            let until = seen.until.filter(|until| *until < time);
            outputs.entry((seen.output.event, args)).or_default().push((seen.from, until));
        });
        let reached = reached.ok()?;
        let ends = |state: &PossibleState| range(&state.zone, state.since(), 0).1.unwrap_or(time);
        let last = reached.iter().map(ends).max().unwrap_or(0);
        for windows in outputs.values_mut() {
            *windows = joined(std::mem::take(windows));
        }
        Some(Self { outputs, silence: (last < time).then_some(last) })
    }

    /// Whether it allows all that another does.
    fn covers(&self, other: &Self) -> bool {
        let is_silent = reaches(self.silence, other.silence);
        let all = other.outputs.iter().all(|(output, windows)| {
            let own = self.outputs.get(output).map_or(&[][..], Vec::as_slice);
            let is_in = |window: &TimeWindow| own.iter().any(|w| w.0 <= window.0 && reaches(w.1, window.1));
            windows.iter().all(is_in)
        });
        is_silent && all
    }
}

/// Whether an end is as late as another; none is later than any.
fn reaches(end: Option<i64>, other: Option<i64>) -> bool {
    match (end, other) {
        (None, _) => true,
        (Some(end), Some(other)) => end >= other,
        (Some(_), None) => false,
    }
}

/// The same times, in windows that do not meet.
fn joined(mut windows: Vec<TimeWindow>) -> Vec<TimeWindow> {
    windows.sort_unstable_by_key(|window| window.0);
    let mut all: Vec<TimeWindow> = Vec::new();
    for window in windows {
        match all.last_mut() {
            Some(last) if last.1.is_none_or(|end| window.0 <= end) => {
                if !reaches(last.1, window.1) {
                    last.1 = window.1;
                }
            }
            Some(_) | None => all.push(window),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn allowance(windows: &[TimeWindow], silence: Option<i64>) -> Allowance {
        let outputs = [((EventId(0), Vec::new()), joined(windows.to_vec()))].into();
        Allowance { outputs, silence }
    }

    #[test]
    fn windows_that_meet_are_one() {
        assert_eq!(
            joined(vec![(5, Some(7)), (0, Some(2)), (2, Some(3)), (6, None)]),
            [(0, Some(3)), (5, None)]
        );
        assert_eq!(joined(vec![(0, None), (3, Some(4))]), [(0, None)]);
        assert_eq!(joined(vec![(0, Some(9)), (3, Some(4))]), [(0, Some(9))]);
    }

    #[test]
    fn what_is_allowed_is_compared_in_both_directions() {
        let wide = allowance(&[(0, Some(9))], None);
        for narrow in [
            allowance(&[(0, Some(8))], None),
            allowance(&[(1, Some(9))], None),
            allowance(&[(0, Some(4)), (6, Some(9))], None),
            allowance(&[(0, Some(9))], Some(9)),
            Allowance::default(),
        ] {
            assert!(wide.covers(&narrow) && !narrow.covers(&wide), "{narrow:?}");
            let trail =
                |of: &Allowance| ModelTrail { allowances: vec![Some(of.clone())], ..ModelTrail::default() };
            let difference = trail(&narrow).against(&trail(&wide));
            assert_eq!(difference, AllowanceDifference { less: true, more: false });
        }
        let other = allowance(&[(5, None)], Some(9));
        assert!(!wide.covers(&other) && !other.covers(&wide));
    }
}
