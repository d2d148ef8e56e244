//! A run of models alone, in virtual time: agents and automata play all actors.

mod agent;
mod automaton;

use std::{cell::RefCell, rc::Rc};

use hrdsl_bdi::{AgentSociety, CYCLE_LIMIT, LogItem, measure::AgentCounts};
pub use hrdsl_bdi::{IntentionSummary, LogDetail, RunStatus, show};
use hrdsl_harness::{ActorPlayer, HarnessLoop, HarnessRun, RunTermination};
use hrdsl_ir::{
    EventId, Nanos, Program,
    bdi::{AgentId, InitialFact},
    suite::PlayerRef,
};
use hrdsl_trace::Trace;

use agent::SnapshotLog;
pub use agent::{AgentCompany, AgentPlayer, AgentSnapshot};
pub use automaton::AutomatonPlayer;

/// Entries of each agent's log that an inspection keeps.
const KEPT: usize = 200_000;

/// What a model run yields.
pub struct ModelRun {
    pub trace: Trace,
    pub ended: RunTermination,
    /// What the run took of each agent's program, in the order of the agents.
    pub measured: Vec<(AgentId, AgentCounts)>,
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
    /// `tried`, `selected`, `step`, …: [`LogItem::kind`].
    pub kind: &'static str,
    /// The event that a plan was looked for: `+!leg(1)`; `text` has it, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub event: Option<String>,
    pub text: String,
    /// Where the step or plan stands that the line is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<hrdsl_ir::Span>,
    /// Of a step: the event that it makes, or the stimulus that it does.
    #[serde(skip)]
    pub does: Option<EventId>,
}

impl LogLine {
    /// `0 s Human: +!table → table#1 as #1`
    #[must_use]
    pub fn line(&self) -> String {
        format!("{} {}: {}", show::time(self.time), self.agent, self.text)
    }
}

/// How a model is run.
#[derive(Clone, Copy, Debug)]
pub struct ModelRunOptions {
    /// Of `.random`.
    pub seed: u64,
    pub horizon: Nanos,
    /// Of the log.
    pub detail: LogDetail,
    /// So many cycles of an agent at one instant end the run.
    pub cycles: u64,
}

impl ModelRunOptions {
    /// With the usual bound of cycles.
    #[must_use]
    pub fn new(seed: u64, horizon: Nanos, detail: LogDetail) -> Self {
        Self { seed, horizon, detail, cycles: CYCLE_LIMIT }
    }
}

/// Runs the players together, the agents with these facts besides their own.
#[must_use]
pub fn model_run(
    program: &Program,
    players: &[PlayerRef],
    facts: &[(AgentId, InitialFact)],
    options: &ModelRunOptions,
) -> ModelRun {
    let (company, run) = ModelCast { program, players, facts, options }.run(false);
    told(&company.borrow(), run, options.detail)
}

/// A model run with all that there is to say about it.
pub struct ModelInspection {
    pub run: ModelRun,
    /// The agents' names, in their order.
    pub agents: Vec<String>,
    /// How the agents stood at the end of each instant at which they reasoned.
    pub snapshots: Vec<AgentSnapshot>,
    /// What each agent believes at the end.
    pub beliefs: Vec<Vec<String>>,
    /// The agents of which nothing goes on beside an atomic plan that waits, each with the plan.
    pub blocked: Vec<(String, String)>,
    /// How the agents stand together at the end.
    pub status: RunStatus,
    /// How many entries of the logs were left out, since there are too many.
    pub left_out: u64,
}

/// Runs the players as [`model_run`] does, and looks at the agents at the end of each instant.
#[must_use]
pub fn inspect(
    program: &Program,
    players: &[PlayerRef],
    facts: &[(AgentId, InitialFact)],
    options: &ModelRunOptions,
) -> ModelInspection {
    let (company, run) = ModelCast { program, players, facts, options }.run(true);
    let mut company = company.borrow_mut();
    let snapshots = company.snapshots.take().unwrap_or_default();
    let run = told(&company, run, options.detail);
    let society = &company.society;
    let snapshots = snapshots.finish(society);
    let agents: Vec<String> = society.names().map(str::to_owned).collect();
    let blocked = agents.iter().enumerate();
    let blocked = blocked.filter_map(|(i, name)| Some((name.clone(), society.blocked_by(i)?.to_owned())));
    ModelInspection {
        blocked: blocked.collect(),
        run,
        snapshots,
        beliefs: (0..agents.len()).map(|agent| society.believed(agent)).collect(),
        agents,
        status: society.status(),
        left_out: society.left_out(),
    }
}

/// Who plays, with what.
struct ModelCast<'p, 'a> {
    program: &'p Program,
    players: &'a [PlayerRef],
    facts: &'a [(AgentId, InitialFact)],
    options: &'a ModelRunOptions,
}

impl<'p> ModelCast<'p, '_> {
    fn run(&self, watch: bool) -> (Rc<RefCell<AgentCompany<'p>>>, HarnessRun) {
        let program = self.program;
        let agent = |player: &PlayerRef| match player {
            PlayerRef::Agent(id) => {
                let own = self.facts.iter().filter(|(a, _)| a == id).map(|(_, f)| f.clone());
                Some((*id, own.collect::<Vec<InitialFact>>()))
            }
            PlayerRef::Automaton(_) => None,
        };
        let agents: Vec<(AgentId, Vec<InitialFact>)> = self.players.iter().filter_map(agent).collect();
        let mut society = AgentSociety::with_detail(program, &agents, self.options.seed, self.options.detail);
        society.set_cycle_limit(self.options.cycles);
        society.measure();
        if watch {
            society.keep_log(KEPT);
        }
        let company = AgentCompany::new(program, society);
        let told = self.options.detail >= LogDetail::Steps;
        let snapshots = || if told { SnapshotLog::default() } else { SnapshotLog::at_the_end() };
        company.borrow_mut().snapshots = watch.then(snapshots);
        let mut members = AgentPlayer::all(&company).into_iter();
        let play = |player: &PlayerRef| -> Option<Box<dyn ActorPlayer + 'p>> {
            match player {
                PlayerRef::Agent(_) => Some(Box::new(members.next()?)),
                PlayerRef::Automaton(automaton) => Some(Box::new(AutomatonPlayer::new(program, *automaton))),
            }
        };
        let cast = self.players.iter().filter_map(play).collect();
        let run = HarnessLoop::new(program, cast, None, self.options.horizon).run();
        (company, run)
    }
}

fn told(company: &AgentCompany<'_>, run: HarnessRun, detail: LogDetail) -> ModelRun {
    let HarnessRun { trace, ended, .. } = run;
    let society = &company.society;
    let names: Vec<&str> = society.names().collect();
    let mut warnings: Vec<String> = Vec::new();
    let mut log = Vec::new();
    for (agent, entry) in society.log() {
        let is_warning = matches!(
            entry.what,
            LogItem::Fault { .. }
                | LogItem::FaultyAnswer { .. }
                | LogItem::StillHeld { .. }
                | LogItem::Refused { .. }
        );
        if !is_warning && detail < LogDetail::Steps {
            continue;
        }
        let text = society.describe(agent, entry);
        if is_warning {
            let warning = format!("{}: {}", names[agent], text.strip_prefix("warning: ").unwrap_or(&text));
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        if detail >= LogDetail::Steps {
            let (time, round, cycle, intention) = (entry.time, entry.round, entry.cycle, entry.intention);
            let (kind, event) = (entry.what.kind(), society.event_of(agent, entry));
            let (does, origin) = (society.done_in(agent, entry), society.origin_in(agent, entry));
            let agent = names[agent].to_owned();
            log.push(LogLine { time, round, cycle, agent, intention, kind, event, text, origin, does });
        }
    }
    let measured = society.agents().zip(society.measured().into_iter().cloned()).collect();
    ModelRun { trace, ended, measured, warnings, log }
}
