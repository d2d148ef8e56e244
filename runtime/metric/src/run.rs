//! A formula over a trace: samples and events to atoms, moment by moment.

use hrdsl_ir::{EventId, Nanos, Value, formula::MetricGoal, world::SignalId};
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind};

use crate::{
    atom::{AtomReading, AtomSource},
    engine::piece::SignalPiece,
    evaluator::{MetricEvaluator, MetricOutcome},
    robustness::Robustness,
    text::CheckedFormula,
};

/// A formula at work on one trace, in memory for what its windows hold.
#[derive(Clone, Debug)]
pub struct MetricRunner {
    goal: MetricGoal,
    atoms: Vec<AtomSource>,
    signals: Vec<SignalId>,
    /// The latest sample of each of them.
    values: Vec<Option<Value>>,
    /// For each signal, the atoms that read it.
    readers: Vec<Vec<usize>>,
    /// Those that are events.
    events: Vec<usize>,
    /// Atoms of which a signal has a new sample at this instant, and events that happen at it.
    touched: Vec<usize>,
    happening: Vec<usize>,
    /// The instant that is being shown.
    now: Nanos,
    /// Events that happened at the instant before, and when they are over.
    passing: (Nanos, Vec<usize>),
    evaluator: Option<MetricEvaluator>,
    /// What the atoms were over time, if somebody asks for it.
    tape: Option<Vec<Vec<SignalPiece>>>,
    start: Nanos,
    end: Option<Nanos>,
    /// When an atom first compared what has no value.
    unvalued: Option<Nanos>,
}

/// What the atoms of a formula were in a run, from its first moment to its last.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomsOverTime {
    pub start: Nanos,
    pub end: Nanos,
    /// For each atom a piece at the start, and one for each change.
    pub atoms: Vec<Vec<SignalPiece>>,
}

impl MetricRunner {
    #[must_use]
    pub fn new(formula: &CheckedFormula) -> Self {
        let CheckedFormula { goal, atoms, signals, .. } = formula;
        let mut readers = vec![Vec::new(); signals.len()];
        for (index, atom) in atoms.iter().enumerate() {
            atom.each_signal(&mut |signal| {
                if let Some(of) = readers.get_mut(signal)
                    && of.last() != Some(&index)
                {
                    of.push(index);
                }
            });
        }
        let is_event =
            |(index, atom): (usize, &AtomSource)| matches!(atom, AtomSource::Happens(_)).then_some(index);
        Self {
            goal: goal.clone(),
            atoms: atoms.clone(),
            signals: signals.clone(),
            values: vec![None; signals.len()],
            readers,
            events: atoms.iter().enumerate().filter_map(is_event).collect(),
            touched: Vec::new(),
            happening: Vec::new(),
            now: 0,
            passing: (0, Vec::new()),
            evaluator: None,
            tape: None,
            start: 0,
            end: None,
            unvalued: None,
        }
    }

    /// The same, which keeps what the atoms are, in memory that grows with the trace.
    #[must_use]
    pub fn taping(mut self) -> Self {
        self.tape = Some(vec![Vec::new(); self.atoms.len()]);
        self
    }

    /// What the atoms were, if it was [taping](Self::taping) and the formula has a first moment.
    #[must_use]
    pub fn tape(mut self) -> Option<AtomsOverTime> {
        let end = self.close();
        self.evaluator.as_ref()?;
        Some(AtomsOverTime { start: self.start, end, atoms: self.tape? })
    }

    /// The signals of the formula that have had no sample.
    pub fn unseen(&self) -> impl Iterator<Item = SignalId> + '_ {
        let places = self.signals.iter().zip(&self.values);
        places.filter(|(_, value)| value.is_none()).map(|(signal, _)| *signal)
    }

    /// Moments before this are known, if all that happened before the latest step was shown; and when the formula became violated first, as far
    /// as that is certain by them.
    pub(crate) fn settle(&mut self) -> (Nanos, Option<Nanos>) {
        // What happened at the instant before is over so much later, which is not yet taken.
        let known = if self.passing.1.is_empty() { self.now } else { self.now.min(self.passing.0) };
        let Some(evaluator) = &mut self.evaluator else { return (known, None) };
        evaluator.advance_now(known);
        (known, evaluator.first_failure())
    }

    /// What the run comes to, once it has ended; up to then, what it would come to if it ended with its latest step.
    #[must_use]
    pub fn outcome(mut self) -> MetricOutcome {
        let end = self.close();
        let unvalued = self.unvalued;
        self.evaluator.map_or(MetricOutcome::UNSEEN, |evaluator| evaluator.finish(end).given(unvalued))
    }

    /// All that was shown is known now; its end.
    fn close(&mut self) -> Nanos {
        let end = self.end.unwrap_or(self.now);
        if self.end.is_none() {
            self.close_instant();
        }
        // An event at the very end is over after it, where nothing is known.
        if self.passing.0 > end {
            self.passing.1.clear();
        }
        self.close_instant();
        end
    }

    fn event(&mut self, event: EventId, args: &[Value]) {
        for &index in &self.events {
            let matches = |atom: &AtomSource| match atom {
                AtomSource::Happens(pattern) => pattern.matches(event, args),
                AtomSource::Less { .. }
                | AtomSource::Equal { .. }
                | AtomSource::Truth(_)
                | AtomSource::Holds(_)
                | AtomSource::Is { .. } => false,
            };
            if self.atoms.get(index).is_some_and(matches) && !self.happening.contains(&index) {
                self.happening.push(index);
            }
        }
    }

    fn sample(&mut self, signal: SignalId, value: Value) {
        for (place, of) in self.signals.iter().enumerate() {
            if *of == signal {
                if let Some(known) = self.values.get_mut(place) {
                    *known = Some(value);
                }
                self.touched.extend(self.readers.get(place).into_iter().flatten());
            }
        }
    }

    /// All that happened at this instant is known.
    fn close_instant(&mut self) {
        if self.evaluator.is_none() {
            self.begin();
        }
        let Self { evaluator, tape, touched, happening, passing, now, unvalued, .. } = self;
        if let Some(evaluator) = evaluator {
            let mut change = |index: usize, start: Nanos, value: Robustness| {
                evaluator.change(index, start, value);
                if let Some(pieces) = tape.as_mut().and_then(|tape| tape.get_mut(index))
                    && pieces.last().is_none_or(|last| last.value != value)
                {
                    pieces.push(SignalPiece { start, value });
                }
            };
            for index in passing.1.drain(..) {
                // An event that happens in the next nanosecond, too, goes on.
                if passing.0 < *now || !happening.contains(&index) {
                    change(index, passing.0, Robustness::FALSE);
                }
            }
            for index in touched.drain(..) {
                if let Some(reading) = self.atoms.get(index).and_then(|a| a.reading(&self.values)) {
                    change(index, *now, reading.value);
                    if reading.unvalued {
                        unvalued.get_or_insert(*now);
                    }
                }
            }
            happening.iter().for_each(|index| change(*index, *now, Robustness::TRUE));
            evaluator.advance(now.saturating_add(1));
            *passing = (now.saturating_add(1), std::mem::take(happening));
        }
        touched.clear();
        happening.clear();
    }

    /// The first moment, if all signals have values. Without signals it is 0.
    fn begin(&mut self) {
        let start = if self.signals.is_empty() { 0 } else { self.now };
        let happens = |index: usize| start == self.now && self.happening.contains(&index);
        let values = self.atoms.iter().enumerate().map(|(index, atom)| {
            let happening = AtomReading { value: Robustness::TRUE, unvalued: false };
            if happens(index) { Some(happening) } else { atom.reading(&self.values) }
        });
        if let Some(readings) = values.collect::<Option<Vec<_>>>() {
            let values: Vec<Robustness> = readings.iter().map(|reading| reading.value).collect();
            self.unvalued = readings.iter().any(|reading| reading.unvalued).then_some(self.now);
            self.evaluator = Some(MetricEvaluator::new(&self.goal, start, &values));
            self.start = start;
            for (pieces, value) in self.tape.iter_mut().flatten().zip(values) {
                pieces.push(SignalPiece { start, value });
            }
        }
    }
}

impl TraceObserver for MetricRunner {
    fn step(&mut self, _: usize, step: &TraceStep) {
        if step.time > self.now {
            self.close_instant();
            self.now = step.time;
        }
        match &step.what {
            TraceStepKind::Event { event, args } => self.event(*event, args),
            TraceStepKind::Sample { signal, value } => self.sample(*signal, *value),
            TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, time: Nanos) {
        self.close_instant();
        self.now = self.now.max(time);
        self.end = Some(self.now);
    }
}
