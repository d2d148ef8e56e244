//! Runs that a search gives.

use hrdsl_coverage::assume::AssumptionChecker;
use hrdsl_ir::{Nanos, Program};
use hrdsl_ta::{WitnessRun, WitnessTrace};
use hrdsl_trace::TraceStepKind;

use crate::observer::ObservedNetwork;

/// A run of the network with its observers.
#[derive(Clone, Debug)]
pub struct ObservedRun {
    /// What the witness speaks of.
    pub observed: ObservedNetwork,
    pub witness: WitnessRun,
}

impl ObservedRun {
    /// The run, told by names.
    #[must_use]
    pub fn named_trace(&self) -> WitnessTrace {
        WitnessTrace::from_run(&self.observed.program, &self.observed.network, &self.witness)
    }
}

/// Whether the run keeps the assumptions of the program.
pub(crate) fn keeps_assumptions(program: &Program, witness: &WitnessRun) -> bool {
    let trace = witness.trace();
    let events: Vec<(Nanos, _, _)> = trace
        .steps
        .iter()
        .filter_map(|s| match &s.what {
            TraceStepKind::Event { event, args } => Some((s.time, *event, args.clone())),
            TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => None,
        })
        .collect();
    AssumptionChecker::allows(program, &events)
}
