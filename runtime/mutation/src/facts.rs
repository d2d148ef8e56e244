//! What all runs of the original have in common, as far as a requirement can say it, and what of that a run breaks.

use std::collections::BTreeMap;

use hrdsl_ir::{EventId, Nanos, Program, Type, Value, value::seconds, world::SignalId};
use hrdsl_trace::{Trace, TraceStepKind};

/// Patterns of a kind that are tried for one run.
const MOST_OF_A_KIND: usize = 4;
/// Bounds on times are so much longer than the longest that was seen: the next test may take a little longer.
const LEEWAY: f64 = 1.05;
/// The step of bounds on times, in seconds.
const TIME_STEP: f64 = 0.1;
/// The language counts no further in `at most N E`.
const MOST_COUNTED: usize = 1000;

/// One run: its events in order, and the range of each signal that is a number.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunFacts {
    events: Vec<(EventId, Nanos)>,
    ranges: BTreeMap<SignalId, (f64, f64)>,
}

/// What an event and a later one are to each other in a run, or in all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EventPair {
    /// The shortest and the longest time from the first to the next second; `None` if that never came.
    answered: Option<(Nanos, Nanos)>,
    /// Whether a first was between each two seconds.
    separated: bool,
    /// Whether each second had a first before it.
    preceded: bool,
    /// How often the first happened, and the second.
    firsts: usize,
    seconds: usize,
}

/// What holds in all runs.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommonFacts {
    counts: BTreeMap<EventId, (usize, usize)>,
    pairs: BTreeMap<(EventId, EventId), EventPair>,
    ranges: BTreeMap<SignalId, (f64, f64)>,
}

impl RunFacts {
    pub(crate) fn of(trace: &Trace) -> Self {
        let mut facts = Self::default();
        for step in &trace.steps {
            match &step.what {
                TraceStepKind::Event { event, .. } => facts.events.push((*event, step.time)),
                TraceStepKind::Sample { signal, value: Value::Float(value) } => {
                    let range = facts.ranges.entry(*signal).or_insert((*value, *value));
                    *range = (range.0.min(*value), range.1.max(*value));
                }
                TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => {}
            }
        }
        facts
    }

    fn count(&self, event: EventId) -> usize {
        self.events.iter().filter(|(other, _)| *other == event).count()
    }

    fn pair(&self, first: EventId, second: EventId) -> EventPair {
        let mut pair = EventPair::default();
        let (mut since, mut is_between) = (None, true);
        for (event, time) in &self.events {
            if *event == first {
                pair.firsts += 1;
                is_between = true;
                since.get_or_insert(*time);
            } else if *event == second {
                pair.seconds += 1;
                pair.preceded &= pair.firsts > 0;
                pair.separated &= std::mem::take(&mut is_between);
                if let Some(since) = since.take() {
                    let took = (time - since, time - since);
                    pair.answered = pair.answered.map(|range| united(range, took));
                }
            }
        }
        if since.is_some() {
            pair.answered = None;
        }
        pair
    }
}

impl CommonFacts {
    pub(crate) fn of(program: &Program, runs: &[RunFacts]) -> Self {
        let events: Vec<EventId> =
            (0..program.events.len()).filter_map(|at| at.try_into().ok()).map(EventId).collect();
        let mut common = Self::default();
        for run in runs {
            for event in &events {
                let count = run.count(*event);
                let range = common.counts.entry(*event).or_insert((count, count));
                *range = (range.0.min(count), range.1.max(count));
            }
            for (signal, (low, high)) in &run.ranges {
                let range = common.ranges.entry(*signal).or_insert((*low, *high));
                *range = (range.0.min(*low), range.1.max(*high));
            }
        }
        for first in &events {
            for second in events.iter().filter(|second| *second != first) {
                let pairs = runs.iter().map(|run| run.pair(*first, *second));
                if let Some(pair) = pairs.reduce(EventPair::and) {
                    common.pairs.insert((*first, *second), pair);
                }
            }
        }
        common
    }

    /// Patterns of requirements that hold in all these runs, as far as can be told here, and that another run breaks: the narrowest first.
    pub(crate) fn broken_by(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut patterns = self.broken_answers(program, run);
        patterns.extend(self.broken_counts(program, run));
        patterns.extend(self.broken_orders(program, run));
        patterns.extend(self.broken_separations(program, run));
        patterns.extend(self.broken_ranges(program, run));
        patterns
    }

    fn broken_answers(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut found: Vec<(bool, f64, String)> = Vec::new();
        for ((first, second), pair) in self.pairs_of_code(program) {
            let Some((shortest, longest)) = pair.answered.filter(|_| pair.firsts > 0) else { continue };
            let (early, late) = (earliest(shortest), time_bound(longest));
            let other = run.pair(*first, *second);
            if other.firsts == 0 {
                continue;
            }
            let is_late = other.answered.is_none_or(|(_, longest)| seconds(longest) > late);
            let is_early = other.answered.is_some_and(|(shortest, _)| seconds(shortest) < early);
            // What a test does is less of a cause than what is said or seen.
            let is_stimulus = program.event(*first).is_stimulus();
            let (first, second) = (pattern(program, *first), pattern(program, *second));
            if is_late {
                found.push((is_stimulus, late, format!("{first} causes {second} within {late} s")));
            } else if is_early {
                let text = format!("{first} causes {second} not before {early} s within {late} s");
                found.push((is_stimulus, late, text));
            }
        }
        found.sort_by(|(s, a, _), (t, b, _)| s.cmp(t).then(a.total_cmp(b)));
        found.into_iter().map(|(.., text)| text).take(MOST_OF_A_KIND).collect()
    }

    fn broken_separations(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut found: Vec<(bool, String)> = Vec::new();
        for ((first, second), pair) in self.pairs_of_code(program) {
            if pair.separated && pair.seconds > 0 && !run.pair(*first, *second).separated {
                let is_stimulus = program.event(*first).is_stimulus();
                let (first, second) = (pattern(program, *first), pattern(program, *second));
                found.push((is_stimulus, format!("{second} forbids {second} until {first}")));
            }
        }
        found.sort();
        found.into_iter().map(|(_, text)| text).take(MOST_OF_A_KIND).collect()
    }

    fn broken_counts(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut found = Vec::new();
        let of_code = self.counts.iter().filter(|(event, _)| !program.event(**event).is_stimulus());
        for (event, (least, most)) in of_code {
            let (count, event) = (run.count(*event), pattern(program, *event));
            if count > *most && *most == 0 {
                found.push(format!("never {event}"));
            } else if count > *most && *most <= MOST_COUNTED {
                found.push(format!("at most {most} {event}"));
            } else if count < *least && count == 0 {
                found.push(format!("eventually {event}"));
            } else if count < *least && *least <= MOST_COUNTED {
                found.push(format!("at least {least} {event}"));
            }
        }
        found.truncate(MOST_OF_A_KIND);
        found
    }

    fn broken_orders(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut found = Vec::new();
        for ((first, second), pair) in self.pairs_of_code(program) {
            if pair.preceded && pair.seconds > 0 && !run.pair(*first, *second).preceded {
                found.push(format!("{} precedes {}", pattern(program, *first), pattern(program, *second)));
            }
        }
        found.truncate(MOST_OF_A_KIND);
        found
    }

    fn broken_ranges(&self, program: &Program, run: &RunFacts) -> Vec<String> {
        let mut found = Vec::new();
        for (signal, (low, high)) in &run.ranges {
            let (Some((least, most)), declared) = (self.ranges.get(signal), program.signal(*signal)) else {
                continue;
            };
            let Type::Float(unit) = declared.ty else { continue };
            let (name, symbol) = (&declared.name, unit.symbol());
            let (above, below) = (beyond(*most, 1.0), beyond(*least, -1.0));
            if *high > above {
                found.push(format!("always {name} <= {above} {symbol}").trim_end().to_owned());
            }
            if *low < below {
                found.push(format!("always {name} >= {below} {symbol}").trim_end().to_owned());
            }
        }
        found.truncate(MOST_OF_A_KIND);
        found
    }

    /// The pairs whose second event a test does not play.
    fn pairs_of_code(&self, program: &Program) -> impl Iterator<Item = (&(EventId, EventId), &EventPair)> {
        self.pairs.iter().filter(|((_, second), _)| !program.event(*second).is_stimulus())
    }
}

/// What no event contradicts: no answer took any time yet.
impl Default for EventPair {
    fn default() -> Self {
        Self { answered: Some((Nanos::MAX, 0)), separated: true, preceded: true, firsts: 0, seconds: 0 }
    }
}

fn united(a: (Nanos, Nanos), b: (Nanos, Nanos)) -> (Nanos, Nanos) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl EventPair {
    fn and(self, other: Self) -> Self {
        Self {
            answered: self.answered.zip(other.answered).map(|(a, b)| united(a, b)),
            separated: self.separated && other.separated,
            preceded: self.preceded && other.preceded,
            firsts: self.firsts + other.firsts,
            seconds: self.seconds + other.seconds,
        }
    }
}

/// A bound in seconds that the longest time keeps, with some leeway.
fn time_bound(longest: Nanos) -> f64 {
    let steps = (seconds(longest) * LEEWAY / TIME_STEP).ceil().max(1.0);
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// A bound in seconds that the shortest time keeps, with some leeway; 0 if there is no room for one.
fn earliest(shortest: Nanos) -> f64 {
    let steps = (seconds(shortest) / LEEWAY / TIME_STEP).floor();
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// The next number in a direction with three digits: a bound that is kept by what was seen, and can be read.
fn beyond(value: f64, direction: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10_f64.powi(2 - value.abs().log10().floor() as i32);
    let scaled = if direction > 0.0 { (value * scale).ceil() } else { (value * scale).floor() };
    // Through its decimal text, so that it is written with these digits.
    format!("{:.2e}", scaled / scale).parse().unwrap_or(value)
}

/// Any event of this name.
fn pattern(program: &Program, event: EventId) -> String {
    let declared = program.event(event);
    if declared.params.is_empty() {
        return declared.name.clone();
    }
    let any = vec!["_"; declared.params.len()];
    format!("{}({})", declared.name, any.join(", "))
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::value::SECOND;

    use super::*;

    fn run(events: &[(u16, i64)]) -> RunFacts {
        let events = events.iter().map(|(event, time)| (EventId(*event), time * SECOND)).collect();
        RunFacts { events, ranges: BTreeMap::new() }
    }

    #[test]
    fn an_answer_counts_from_the_first_question_that_waits() {
        let pair = run(&[(0, 1), (0, 2), (1, 4), (1, 5), (0, 9), (1, 10)]).pair(EventId(0), EventId(1));
        let answered = Some((SECOND, 3 * SECOND));
        let expected = EventPair { answered, separated: false, preceded: true, firsts: 3, seconds: 3 };
        assert_eq!(pair, expected);
        let open = run(&[(1, 0), (0, 1)]).pair(EventId(0), EventId(1));
        assert_eq!((open.answered, open.preceded), (None, false));
        assert_eq!(pair.and(open).answered, None);
    }

    #[test]
    fn bounds_are_kept_by_what_was_seen_and_can_be_read() {
        assert_eq!(time_bound(0), 0.1);
        assert_eq!((time_bound(3 * SECOND), earliest(3 * SECOND), earliest(SECOND / 20)), (3.2, 2.8, 0.0));
        assert_eq!((beyond(0.123_41, 1.0), beyond(0.123_41, -1.0)), (0.124, 0.123));
        assert_eq!((beyond(-7.001, 1.0), beyond(-7.001, -1.0)), (-7.0, -7.01));
        assert_eq!((beyond(1234.5, 1.0), beyond(0.0, 1.0)), (1240.0, 0.0));
    }
}
