//! The latest samples of the signals.

use hrdsl_ir::{Nanos, Value, world::SignalId};
use hrdsl_trace::{SeenStep, TraceStep, TraceStepKind};

/// The latest sample of each signal of the program.
#[derive(Clone, Debug)]
pub(crate) struct LatestSamples(Vec<Option<SampleReading>>);

#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleReading {
    pub value: Value,
    /// The step of the trace that brought it.
    pub step: usize,
    pub time: Nanos,
}

impl SampleReading {
    /// The step that brought it.
    pub fn seen(self, signal: SignalId) -> SeenStep {
        let what = TraceStepKind::Sample { signal, value: self.value };
        SeenStep { index: self.step, step: TraceStep { time: self.time, what } }
    }
}

impl LatestSamples {
    pub fn new(signals: usize) -> Self {
        Self(vec![None; signals])
    }

    pub fn get(&self, signal: SignalId) -> Option<SampleReading> {
        self.0.get(usize::from(signal.0)).copied().flatten()
    }

    /// The sample that is this step of the trace, if it is the latest of its signal.
    pub fn of_step(&self, index: usize) -> Option<SeenStep> {
        let of = |(signal, reading): (u16, &Option<SampleReading>)| {
            Some((signal, reading.filter(|r| r.step == index)?))
        };
        let (signal, reading) = (0u16..).zip(&self.0).find_map(of)?;
        Some(reading.seen(SignalId(signal)))
    }

    pub fn set(&mut self, signal: SignalId, reading: SampleReading) {
        if let Some(slot) = self.0.get_mut(usize::from(signal.0)) {
            *slot = Some(reading);
        }
    }
}
