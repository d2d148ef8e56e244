//! A run of models alone, in virtual time: agents and automata play all actors.

use std::{cell::RefCell, rc::Rc};

use hrdsl_bdi::{CYCLE_LIMIT, Detail, Logged, Society, measure::Measured, show};
use hrdsl_ir::{
    Nanos, Program,
    bdi::{AgentId, Fact},
    suite::PlayerRef,
};
use hrdsl_trace::Trace;

use super::{AgentPlayer, AutomatonPlayer, Company, Ended, Harness, Player};

/// What a model run yields.
pub struct ModelRun {
    pub trace: Trace,
    pub ended: Ended,
    /// What the run took of each agent's program, in the order of the agents.
    pub measured: Vec<(AgentId, Measured)>,
    /// What a user should know, each once: `Human: …`.
    pub warnings: Vec<String>,
    /// The agents' log, line by line, in the detail asked for.
    pub log: Vec<LogLine>,
}

/// A line of the agents' log.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct LogLine {
    /// In nanoseconds.
    pub time: Nanos,
    pub round: u64,
    pub cycle: u64,
    pub agent: String,
    /// 0: none
    pub intention: u32,
    pub text: String,
    /// Where the step or plan stands that the line is about, if it is a failure or a fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<hrdsl_ir::Span>,
}

impl LogLine {
    /// `0 s Human: +!table → table#1 as #1`
    #[must_use]
    pub fn line(&self) -> String {
        format!("{} {}: {}", show::time(self.time), self.agent, self.text)
    }
}

/// Runs the players together, the agents with these facts besides their own; `seed` is that of `.random`.
#[must_use]
pub fn model_run(
    program: &Program,
    players: &[PlayerRef],
    facts: &[(AgentId, Fact)],
    seed: u64,
    horizon: Nanos,
) -> ModelRun {
    model_run_in_detail(program, players, facts, seed, horizon, Detail::Failures)
}

/// The same, with a log.
#[must_use]
pub fn model_run_in_detail(
    program: &Program,
    players: &[PlayerRef],
    facts: &[(AgentId, Fact)],
    seed: u64,
    horizon: Nanos,
    detail: Detail,
) -> ModelRun {
    let how = How { seed, horizon, detail, cycles: CYCLE_LIMIT };
    model_run_as(program, players, facts, &how)
}

/// How a model is run.
#[derive(Clone, Copy, Debug)]
pub struct How {
    /// Of `.random`.
    pub seed: u64,
    pub horizon: Nanos,
    pub detail: Detail,
    /// So many cycles of an agent at one instant end the run.
    pub cycles: u64,
}

/// The same, as it is said.
#[must_use]
pub fn model_run_as(
    program: &Program,
    players: &[PlayerRef],
    facts: &[(AgentId, Fact)],
    how: &How,
) -> ModelRun {
    let agent = |player: &PlayerRef| match player {
        PlayerRef::Agent(id) => {
            let own = facts.iter().filter(|(a, _)| a == id).map(|(_, f)| f.clone());
            Some((*id, own.collect::<Vec<Fact>>()))
        }
        PlayerRef::Automaton(_) => None,
    };
    let agents: Vec<(AgentId, Vec<Fact>)> = players.iter().filter_map(agent).collect();
    let mut society = Society::with_detail(program, &agents, how.seed, how.detail);
    society.set_cycle_limit(how.cycles);
    society.measure();
    let company = Company::new(program, society);
    let mut members = AgentPlayer::all(&company).into_iter();
    let play = |player: &PlayerRef| -> Option<Box<dyn Player + '_>> {
        match player {
            PlayerRef::Agent(_) => Some(Box::new(members.next()?)),
            PlayerRef::Automaton(automaton) => Some(Box::new(AutomatonPlayer::new(program, *automaton))),
        }
    };
    let cast = players.iter().filter_map(play).collect();
    let run = Harness::new(program, cast, None, how.horizon).run();
    told(&company, run.trace, run.ended, how.detail)
}

fn told(company: &Rc<RefCell<Company<'_>>>, trace: Trace, ended: Ended, detail: Detail) -> ModelRun {
    let company = company.borrow();
    let society = &company.society;
    let names: Vec<&str> = society.names().collect();
    let mut warnings: Vec<String> = Vec::new();
    let mut log = Vec::new();
    for (agent, entry) in society.log() {
        let origin = match &entry.what {
            Logged::Failed(failure) => Some(failure.origin),
            Logged::Fault { origin, .. } | Logged::Unhandled { origin, .. } => Some(*origin),
            _ => None,
        };
        let is_warning = matches!(
            entry.what,
            Logged::Fault { .. }
                | Logged::FaultyAnswer { .. }
                | Logged::StillHeld { .. }
                | Logged::Refused { .. }
        );
        if !is_warning && detail < Detail::Steps {
            continue;
        }
        let text = society.describe(agent, entry);
        if is_warning {
            let warning = format!("{}: {}", names[agent], text.strip_prefix("warning: ").unwrap_or(&text));
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        if detail >= Detail::Steps {
            let (time, round, cycle, intention) = (entry.time, entry.round, entry.cycle, entry.intention);
            log.push(LogLine { time, round, cycle, agent: names[agent].to_owned(), intention, text, origin });
        }
    }
    let measured = society.agents().zip(society.measured().into_iter().cloned()).collect();
    ModelRun { trace, ended, measured, warnings, log }
}
