//! What a run has that requirements can speak of: its events with their times, and its signals with their ranges from any moment on.

use std::collections::BTreeMap;

use hrdsl_ir::{EventId, Nanos, Value, world::SignalId};
use hrdsl_trace::{Trace, TraceStepKind};

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SeenEvent {
    pub event: EventId,
    pub args: Vec<Value>,
    pub moment: RunMoment,
}

/// When something was: at which step, and at what time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RunMoment {
    pub step: usize,
    pub time: Nanos,
}

/// A sample of a signal, with the range from it to the end of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RangedSample {
    moment: RunMoment,
    value: f64,
    low: f64,
    high: f64,
}

/// One run.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunFacts {
    pub events: Vec<SeenEvent>,
    signals: BTreeMap<SignalId, Vec<RangedSample>>,
}

impl RunFacts {
    pub(crate) fn of(trace: &Trace) -> Self {
        let mut facts = Self::default();
        for (step, what) in trace.steps.iter().enumerate() {
            let moment = RunMoment { step, time: what.time };
            match &what.what {
                TraceStepKind::Event { event, args } => {
                    facts.events.push(SeenEvent { event: *event, args: args.clone(), moment });
                }
                TraceStepKind::Sample { signal, value } => {
                    let value = value.as_f64().or_else(|| value.as_bool().map(|b| f64::from(u8::from(b))));
                    let Some(value) = value.filter(|value| value.is_finite()) else { continue };
                    let sample = RangedSample { moment, value, low: value, high: value };
                    facts.signals.entry(*signal).or_default().push(sample);
                }
                TraceStepKind::Machine(_) => {}
            }
        }
        for samples in facts.signals.values_mut() {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for sample in samples.iter_mut().rev() {
                (low, high) = (low.min(sample.value), high.max(sample.value));
                (sample.low, sample.high) = (low, high);
            }
        }
        facts
    }

    /// The signals that have a number or a truth value.
    pub(crate) fn signals(&self) -> impl Iterator<Item = SignalId> + '_ {
        self.signals.keys().copied()
    }

    /// The range of a signal from a moment on, with the value that it has then.
    pub(crate) fn range(&self, signal: SignalId, from: RunMoment) -> Option<(f64, f64)> {
        self.samples(signal, from).first().map(|sample| (sample.low, sample.high))
    }

    /// How long after a moment the value of a signal first meets a condition.
    pub(crate) fn time_until(
        &self,
        signal: SignalId,
        from: RunMoment,
        is_met: impl Fn(f64) -> bool,
    ) -> Option<Nanos> {
        let met = self.samples(signal, from).iter().find(|sample| is_met(sample.value))?;
        Some((met.moment.time - from.time).max(0))
    }

    fn samples(&self, signal: SignalId, from: RunMoment) -> &[RangedSample] {
        let all = self.signals.get(&signal).map_or(&[][..], Vec::as_slice);
        let later = all.partition_point(|sample| sample.moment.step < from.step);
        all.get(later.saturating_sub(1)..).unwrap_or_default()
    }
}

/// What an event and a later one are to each other in a run, or in all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EventPair {
    /// The shortest and the longest time from the first to the next second; `None` if that never came.
    pub answered: Option<(Nanos, Nanos)>,
    /// Whether a first was between each two seconds.
    pub separated: bool,
    /// Whether each second had a first before it.
    pub preceded: bool,
    /// How often the first happened, and the second.
    pub firsts: usize,
    pub seconds: usize,
}

/// What no event contradicts: no answer took any time yet.
impl Default for EventPair {
    fn default() -> Self {
        Self { answered: Some((Nanos::MAX, 0)), separated: true, preceded: true, firsts: 0, seconds: 0 }
    }
}

impl EventPair {
    /// Of the moments of two events, each in order, none of which is of both.
    pub(crate) fn of(firsts: &[RunMoment], seconds: &[RunMoment]) -> Self {
        let mut pair = EventPair { firsts: firsts.len(), seconds: seconds.len(), ..EventPair::default() };
        let mut questions = firsts.iter().peekable();
        let (mut since, mut is_between, mut is_preceded) = (None, true, false);
        for second in seconds {
            while let Some(first) = questions.next_if(|first| *first < second) {
                (is_between, is_preceded) = (true, true);
                since.get_or_insert(first.time);
            }
            pair.preceded &= is_preceded;
            pair.separated &= std::mem::take(&mut is_between);
            if let Some(since) = since.take() {
                let took = (second.time - since, second.time - since);
                pair.answered = pair.answered.map(|range| united(range, took));
            }
        }
        if questions.next().is_some() {
            pair.answered = None;
        }
        pair
    }

    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            answered: self.answered.zip(other.answered).map(|(a, b)| united(a, b)),
            separated: self.separated && other.separated,
            preceded: self.preceded && other.preceded,
            firsts: self.firsts + other.firsts,
            seconds: self.seconds + other.seconds,
        }
    }
}

fn united(a: (Nanos, Nanos), b: (Nanos, Nanos)) -> (Nanos, Nanos) {
    (a.0.min(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::value::SECOND;

    use super::*;

    fn moments(steps: &[(usize, i64)]) -> Vec<RunMoment> {
        steps.iter().map(|(step, time)| RunMoment { step: *step, time: time * SECOND }).collect()
    }

    #[test]
    fn an_answer_counts_from_the_first_question_that_waits() {
        let pair = EventPair::of(&moments(&[(0, 1), (1, 2), (4, 9)]), &moments(&[(2, 4), (3, 5), (5, 10)]));
        let answered = Some((SECOND, 3 * SECOND));
        let expected = EventPair { answered, separated: false, preceded: true, firsts: 3, seconds: 3 };
        assert_eq!(pair, expected);
        let open = EventPair::of(&moments(&[(1, 1)]), &moments(&[(0, 0)]));
        assert_eq!((open.answered, open.preceded), (None, false));
        assert_eq!(pair.and(open).answered, None);
    }

    #[test]
    fn a_range_begins_with_the_value_that_a_signal_has() {
        let sample = |step, time, value, low, high| {
            let moment = RunMoment { step, time: time * SECOND };
            RangedSample { moment, value, low, high }
        };
        let samples =
            vec![sample(0, 0, 5.0, 1.0, 5.0), sample(2, 2, 1.0, 1.0, 3.0), sample(4, 4, 3.0, 3.0, 3.0)];
        let signals = [(SignalId(0), samples)].into();
        let run = RunFacts { events: Vec::new(), signals };
        let from = |step, time| RunMoment { step, time: time * SECOND };
        assert_eq!(run.range(SignalId(0), from(1, 1)), Some((1.0, 5.0)), "it is still 5 then");
        assert_eq!(run.range(SignalId(0), from(3, 3)), Some((1.0, 3.0)));
        assert_eq!(run.range(SignalId(1), from(0, 0)), None);
        assert_eq!(run.time_until(SignalId(0), from(1, 1), |value| value >= 5.0), Some(0));
        assert_eq!(run.time_until(SignalId(0), from(1, 1), |value| value < 4.0), Some(SECOND));
        assert_eq!(run.time_until(SignalId(0), from(1, 1), |value| value > 5.0), None);
    }
}
