//! What all runs of the original have in common: counts, times and orders of events, and ranges of signals.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_ir::{Nanos, Program, world::SignalId};

use crate::{
    bounds::readable,
    facts::{EventPair, RunFacts, RunMoment},
    forms::{EventForm, forms_of, narrower},
};

/// A run with the moments of the events of each form, in the order of the forms.
#[derive(Clone, Debug)]
pub(crate) struct FormedRun {
    pub facts: RunFacts,
    moments: Vec<Vec<RunMoment>>,
}

impl FormedRun {
    fn new(facts: RunFacts, forms: &[EventForm]) -> Self {
        let moments = |form: &EventForm| {
            let own = facts.events.iter().filter(|seen| form.pattern.matches(seen.event, &seen.args));
            own.map(|seen| seen.moment).collect()
        };
        let moments = forms.iter().map(moments).collect();
        Self { facts, moments }
    }

    pub(crate) fn moments(&self, form: usize) -> &[RunMoment] {
        self.moments.get(form).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn pair(&self, first: usize, second: usize) -> EventPair {
        EventPair::of(self.moments(first), self.moments(second))
    }

    /// Where what is asked from an event of this form on begins, or from the beginning of the run on.
    pub(crate) fn opening(&self, after: Option<usize>) -> Option<RunMoment> {
        after.map_or(Some(RunMoment::default()), |form| self.moments(form).first().copied())
    }

    /// The range of a signal from there on.
    pub(crate) fn range(&self, signal: SignalId, after: Option<usize>) -> Option<(f64, f64)> {
        self.facts.range(signal, self.opening(after)?)
    }

    /// How long after that the value of a signal first meets a condition.
    pub(crate) fn time_until(
        &self,
        signal: SignalId,
        after: Option<usize>,
        is_met: impl Fn(f64) -> bool,
    ) -> Option<Nanos> {
        self.facts.time_until(signal, self.opening(after)?, is_met)
    }
}

/// The ranges that a signal has in several runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommonRange {
    pub least: f64,
    pub most: f64,
    /// What all runs come down to.
    pub most_of_least: f64,
    /// What all runs come up to.
    pub least_of_most: f64,
    /// A bound that all runs come up to, and the latest time at which they do.
    pub high: (f64, Nanos),
    /// A bound that all runs come down to.
    pub low: (f64, Nanos),
}

/// What holds in all runs of the original.
#[derive(Clone, Debug)]
pub(crate) struct CommonFacts {
    pub forms: Vec<EventForm>,
    runs: Vec<FormedRun>,
    /// Of forms that exclude each other, and of which both happen; the second is not played.
    pub pairs: BTreeMap<(usize, usize), EventPair>,
    /// All events that happen, as they are written with any arguments and with theirs.
    pub known: BTreeSet<String>,
    /// How often each form happens in a run, at least and at most.
    counts: Vec<(usize, usize)>,
    ranges: BTreeMap<(Option<usize>, SignalId), CommonRange>,
}

impl CommonFacts {
    pub(crate) fn of(program: &Program, runs: Vec<RunFacts>) -> Self {
        let forms = forms_of(program, &runs);
        let runs: Vec<FormedRun> = runs.into_iter().map(|facts| FormedRun::new(facts, &forms)).collect();
        let happens = |form: &usize| runs.iter().any(|run| !run.moments(*form).is_empty());
        let seen: Vec<usize> = (0..forms.len()).filter(happens).collect();
        let mut pairs = BTreeMap::new();
        for (first, second) in seen.iter().flat_map(|first| seen.iter().map(move |second| (*first, *second)))
        {
            let (Some(a), Some(b)) = (forms.get(first), forms.get(second)) else { continue };
            if b.is_played || !a.excludes(b) {
                continue;
            }
            if let Some(pair) = runs.iter().map(|run| run.pair(first, second)).reduce(EventPair::and) {
                pairs.insert((first, second), pair);
            }
        }
        let count = |form: usize| {
            let counts = || runs.iter().map(|run| run.moments(form).len());
            (counts().min().unwrap_or(0), counts().max().unwrap_or(0))
        };
        let counts = (0..forms.len()).map(count).collect();
        let events = runs.iter().flat_map(|run| &run.facts.events);
        let known = events.flat_map(|event| {
            let any = std::iter::once(EventForm::any(program, event.event));
            any.chain(narrower(program, event)).map(|form| form.text)
        });
        let known = known.collect();
        let mut common = Self { forms, runs, pairs, known, counts, ranges: BTreeMap::new() };
        common.ranges = common.find_ranges(&seen);
        common
    }

    fn find_ranges(&self, seen: &[usize]) -> BTreeMap<(Option<usize>, SignalId), CommonRange> {
        let signals: BTreeSet<SignalId> = self.runs.iter().flat_map(|run| run.facts.signals()).collect();
        let openings = std::iter::once(None).chain(seen.iter().copied().map(Some));
        let all = openings.flat_map(|after| signals.iter().map(move |signal| (after, *signal)));
        all.filter_map(|(after, signal)| Some(((after, signal), self.find_range(signal, after)?))).collect()
    }

    /// Another run, to be held against these.
    pub(crate) fn formed(&self, facts: RunFacts) -> FormedRun {
        FormedRun::new(facts, &self.forms)
    }

    /// Of a form, how often it happens in a run: at least, and at most.
    pub(crate) fn count(&self, form: usize) -> (usize, usize) {
        self.counts.get(form).copied().unwrap_or_default()
    }

    /// The latest time at which a form first happens; `None` if a run has none.
    pub(crate) fn latest_first(&self, form: usize) -> Option<Nanos> {
        let firsts = self.runs.iter().map(|run| run.moments(form).first().map(|moment| moment.time));
        firsts.collect::<Option<Vec<Nanos>>>()?.into_iter().max()
    }

    /// What a signal has in common in the runs that have such an event, from it on; in all runs if none is asked for. `None` if there is no
    /// such run, or one of them has no value of it.
    pub(crate) fn range(&self, signal: SignalId, after: Option<usize>) -> Option<&CommonRange> {
        self.ranges.get(&(after, signal))
    }

    fn find_range(&self, signal: SignalId, after: Option<usize>) -> Option<CommonRange> {
        let opened = self.runs.iter().filter(|run| run.opening(after).is_some());
        let ranges = opened.map(|run| run.range(signal, after)).collect::<Option<Vec<(f64, f64)>>>()?;
        let common = ranges.into_iter().map(|(low, high)| [low, high, low, high]);
        let [least, most, most_of_least, least_of_most] =
            common.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1]), a[2].max(b[2]), a[3].min(b[3])])?;
        let (high, low) = (readable(least_of_most, -1.0), readable(most_of_least, 1.0));
        Some(CommonRange {
            least,
            most,
            most_of_least,
            least_of_most,
            high: (high, self.longest_until(signal, after, |value| value >= high)?),
            low: (low, self.longest_until(signal, after, |value| value <= low)?),
        })
    }

    /// The longest time that any of these runs needs until a signal meets a condition that it meets in all.
    pub(crate) fn longest_until(
        &self,
        signal: SignalId,
        after: Option<usize>,
        is_met: impl Fn(f64) -> bool + Copy,
    ) -> Option<Nanos> {
        let opened = self.runs.iter().filter(|run| run.opening(after).is_some());
        let times = opened.map(|run| run.time_until(signal, after, is_met));
        times.collect::<Option<Vec<Nanos>>>()?.into_iter().max()
    }
}
