//! Queries of a scenario, answered about their networks.

use hrdsl_ir::{
    Program,
    ta::{Ask, Formula},
};
use hrdsl_ta::{Error, Outcome};

use super::{Observed, Run, Settings, goals::of_formula, settings::search};

/// What became of a query.
#[derive(Clone, Debug)]
pub struct Answered {
    /// Index into [`Program::queries`].
    pub query: usize,
    pub found: Found,
    /// Shows it, if a run can.
    pub run: Option<Box<Run>>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// Symbolic states stored.
    pub states: usize,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    Satisfied,
    NotSatisfied,
    /// Of a `sup` or `inf`: of what, and the bound.
    Bounds(Vec<(String, String)>),
    /// Not decided: why.
    Open(String),
    /// The model is at fault, and where.
    Fault(String),
}

/// Answers a query. It is about the network alone: assumptions do not restrict it.
///
/// # Errors
/// If the engine contradicts itself, or there is no such query.
pub fn answer(program: &Program, query: usize, settings: &Settings, watch: &super::Watch) -> Result<Answered, String> {
    let _ = watch;
    let asked = program.queries.get(query).ok_or_else(|| format!("there is no query {query}"))?;
    let network = program
        .networks
        .get(usize::from(asked.network))
        .ok_or_else(|| format!("query `{}` is about no network", asked.name))?;
    let observed = Observed::new(program, network);
    let (formula, good) = match &asked.ask {
        Ask::Possibly(f) => (f.clone(), Found::Satisfied),
        Ask::Invariantly(f) => (Formula::Not(Box::new(f.clone())), Found::NotSatisfied),
        _ => unimplemented!(),
    };
    let bad = if good == Found::Satisfied { Found::NotSatisfied } else { Found::Satisfied };
    let mut answered = Answered { query, found: bad, run: None, notes: Vec::new(), states: 0 };
    match search(&observed, &[of_formula(&formula)], &[], &[], settings) {
        Ok(report) => {
            answered.states = report.states_stored;
            match report.goals.into_iter().next() {
                Some(Outcome::Reached(witness)) => {
                    answered.found = good;
                    answered.run = Some(Box::new(Run { observed, witness: *witness }));
                }
                Some(Outcome::Open(what)) => answered.found = Found::Open(super::goals::exhausted(what)),
                Some(Outcome::Unreachable) | None => {}
            }
        }
        Err(Error::Model { error, witness }) => {
            answered.found = Found::Fault(error.to_string());
            answered.run = witness.map(|witness| Box::new(Run { observed, witness: *witness }));
        }
        Err(Error::Internal(what)) => return Err(format!("query `{}`: {what}", asked.name)),
    }
    Ok(answered)
}
