//! Requirements on the model: whether what a network can do violates a requirement of the scenario.
//!
//! # Steps
//! 1. [`Observed`] puts the requirement's monitor into the network as an automaton that only listens;
//! 2. the network with it is searched for the violation, and for the trigger: without one, that nothing is violated says
//!    little;
//! 3. a witness is made concrete, and its trace judged by the monitor itself: only what fails there is a violation.
//!
//! [Assumptions](hrdsl_ir::monitor::Assumption) restrict the model. Those about the whole test are limits of the search. Those
//! with a window are first left out: what cannot happen without them cannot happen with them, and a witness that keeps them
//! counts. Only if neither decides are they added as automata of their own ([`Observed::restrict`]).

mod goals;
pub mod held;
mod matching;
mod observer;
mod query;
mod settings;
mod window;

use hrdsl_coverage::assume::Assumptions;
use hrdsl_ir::{Nanos, Program, monitor::Monitor, ta::Network};
use hrdsl_monitor::Checker;
pub use hrdsl_ta::Story;
use hrdsl_ta::{Error, Witness};
use hrdsl_trace::{Observer as _, Trace, What};

use held::Held;

pub use goals::{Decided, Fate, decide, of_formula};
pub use observer::{Observed, Verdicts};
pub use query::{Answered, Found, answer, answers};
pub use settings::{Order, Settings, Watch};

/// What became of a requirement.
#[derive(Clone, Debug)]
pub struct Proof {
    /// Index into [`Program::monitors`].
    pub monitor: usize,
    pub status: Status,
    /// Symbolic states stored, of all searches that it took.
    pub states: usize,
    /// Why nothing triggers it, if that is known.
    pub note: Option<String>,
}

#[derive(Clone, Debug)]
pub enum Status {
    /// Some run violates it.
    Violated(Box<Run>),
    /// No run does.
    Holds {
        /// Whether some run triggers it. `None`: not decided within the budget.
        triggered: Option<bool>,
    },
    /// Not decided: why.
    Open(String),
    /// It cannot be judged on a model: why.
    NotOnTheModel(String),
    /// The model is at fault, and where.
    Fault { what: String, run: Option<Box<Run>> },
}

/// A run of the network with its observers.
#[derive(Clone, Debug)]
pub struct Run {
    /// What the witness speaks of.
    pub observed: Observed,
    pub witness: Witness,
}

impl Run {
    /// The run, told by names.
    #[must_use]
    pub fn story(&self) -> Story {
        Story::of(&self.observed.program, &self.observed.network, &self.witness)
    }
}

/// Searches a network for a violation of a requirement.
///
/// # Errors
/// The engine or the observer contradicts the monitor, or the network does not exist.
pub fn prove(
    program: &Program,
    network: &Network,
    monitor: usize,
    settings: &Settings,
    watch: &Watch,
) -> Result<Proof, String> {
    let Some(requirement) = program.monitors.get(monitor) else {
        return Err(format!("there is no requirement {monitor}"));
    };
    let mut observed = Observed::new(program, network);
    let verdicts = match observed.add(requirement) {
        Ok(verdicts) => verdicts,
        Err(why) => return Ok(Proof { monitor, status: Status::NotOnTheModel(why), states: 0, note: None }),
    };
    let formulas: Vec<_> = verdicts.violated.iter().chain([&verdicts.triggered]).collect();
    let questions: Vec<_> = formulas.into_iter().map(goals::of_formula).collect();
    let decided = match decide(program, &observed, &questions, &[], settings, watch) {
        Ok(decided) => decided,
        Err(Error::Model { error, witness }) => {
            let what = error.to_string();
            let run = witness.map(|witness| Box::new(Run { observed, witness: *witness }));
            return Ok(Proof { monitor, status: Status::Fault { what, run }, states: 0, note: None });
        }
        Err(Error::Internal(what)) => return Err(format!("requirement `{}`: {what}", requirement.name)),
    };
    let states = decided.states;
    let mut fates = decided.fates.into_iter();
    let violated = if verdicts.violated.is_some() { fates.next() } else { Some(Fate::Unreachable) };
    let triggered = match fates.next() {
        Some(Fate::Reached(_)) => Some(true),
        Some(Fate::Unreachable) => Some(false),
        Some(Fate::Open(_)) | None => None,
    };
    let status = match violated {
        Some(Fate::Reached(run)) => {
            judged(program, requirement, monitor, &run.witness)?;
            Status::Violated(run)
        }
        Some(Fate::Unreachable) => Status::Holds { triggered },
        Some(Fate::Open(why)) => Status::Open(why),
        None => Status::Open("it was not searched".to_owned()),
    };
    let note = match status {
        Status::Holds { triggered: Some(false) } => {
            held_back(program, network, requirement, settings, states, watch)
        }
        Status::Holds { .. }
        | Status::Violated(_)
        | Status::Open(_)
        | Status::NotOnTheModel(_)
        | Status::Fault { .. } => None,
    };
    Ok(Proof { monitor, status, states, note })
}

/// Why nothing triggers a requirement, if it is that holds take no time.
fn held_back(
    program: &Program,
    network: &Network,
    requirement: &Monitor,
    settings: &Settings,
    states: usize,
    watch: &Watch,
) -> Option<String> {
    let held = Held::of(program, network)?;
    let mut observed = Observed::new(&held.program, network);
    let triggered = observed.add(requirement).ok()?.triggered;
    let (goal, settings) = (of_formula(&triggered), Held::settings(settings, states));
    let decided = decide(&held.program, &observed, &[goal], &[], &settings, watch).ok()?;
    match decided.fates.first()? {
        Fate::Reached(run) => held.because(&run.witness),
        Fate::Unreachable | Fate::Open(_) => None,
    }
}

/// The monitor itself must see the violation.
fn judged(program: &Program, requirement: &Monitor, monitor: usize, witness: &Witness) -> Result<(), String> {
    let verdicts = verdicts(program, &trace(witness));
    match verdicts.get(monitor) {
        Some(v) if v.outcome == hrdsl_monitor::Outcome::Fail => Ok(()),
        Some(v) => Err(format!(
            "internal error: the search violates `{}`, and the monitor says of the same run: {}",
            requirement.name, v.outcome
        )),
        None => Err(format!("internal error: no verdict on `{}`", requirement.name)),
    }
}

/// What the monitors say of a trace.
pub fn verdicts(program: &Program, trace: &Trace) -> Vec<hrdsl_monitor::Verdict> {
    let mut checker = Checker::new(program);
    for (index, step) in trace.steps.iter().enumerate() {
        checker.step(index, step);
    }
    checker.end(trace.end);
    checker.verdicts()
}

/// The events of a run, and its end: what it shows may need time after the last of them.
pub fn trace(witness: &Witness) -> Trace {
    let mut trace = witness.trace();
    trace.end = trace.end.max(witness.end.div_euclid(witness.ticks.max(1)));
    trace
}

/// Whether the run keeps the assumptions of the program.
fn keeps_assumptions(program: &Program, witness: &Witness) -> bool {
    let trace = witness.trace();
    let events: Vec<(Nanos, _, _)> = trace
        .steps
        .iter()
        .filter_map(|s| match &s.what {
            What::Event { event, args } => Some((s.time, *event, args.clone())),
            What::Sample { .. } => None,
        })
        .collect();
    Assumptions::allows(program, &events)
}
