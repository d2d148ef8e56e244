//! What an agent decided and why, for the provenance of tests and the coverage of models.

use std::fmt;

use hrdsl_ir::{
    Nanos, Span,
    bdi::{Agent, BeliefId, GoalId, TriggerOn},
    expr::EvalError,
};

use crate::event::Args;

/// Index into [`Agent::plans`].
pub type PlanIndex = u16;

/// One decision.
#[derive(Clone, Debug, PartialEq)]
pub struct LogEntry {
    pub time: Nanos,
    /// Intentions are counted from 1 in the order of adoption; 0: none.
    pub intention: u32,
    pub what: Logged,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Logged {
    /// The plan was selected for the event.
    Selected { on: TriggerOn, args: Args, plan: PlanIndex },
    /// Plans are relevant to the event, but none is applicable; the event is ignored.
    Unhandled { on: TriggerOn, args: Args },
    /// The plan could not be selected since an expression of its trigger or context has no value.
    Fault { plan: PlanIndex, error: EvalError, origin: Span },
    /// A step or a goal failed.
    Failed(Failure),
    /// No failure plan took care of the failure: the intention is gone.
    Dropped(Failure),
    /// A belief that the agent was to start with does not fit its declaration.
    Refused { belief: BeliefId },
    /// The agent did not come to rest within the bounded number of cycles at one instant.
    Livelock,
}

/// A failure and where it happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The innermost goal that failed; none: the intention handles an event and has no goal.
    pub goal: Option<(GoalId, Args)>,
    /// The plan that was being executed; none: a goal of the agent's start, or of its own intention, found no plan.
    pub plan: Option<PlanIndex>,
    pub cause: Cause,
    /// The step that failed, or the agent.
    pub origin: Span,
}

/// Why a step or goal failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// No plan has the goal as its trigger.
    NoRelevantPlan,
    /// Plans are relevant to the goal but none is applicable.
    NoApplicablePlan,
    /// The belief base and the plans for the test goal have no answer.
    NoAnswer(BeliefId),
    /// An `await` was over before an event matched.
    TimedOut,
    /// An expression has no value.
    NoValue(EvalError),
    /// A value is not of the type, or not in the range, that a belief or event declares.
    OutOfRange,
    /// A `wait` for a negative time, or for what is not a time.
    BadWait,
    /// More plans than an intention can hold wait for each other.
    TooDeep,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::NoRelevantPlan => f.write_str("no plan is relevant"),
            Cause::NoApplicablePlan => f.write_str("no plan is applicable"),
            Cause::NoAnswer(_) => f.write_str("no belief answers"),
            Cause::TimedOut => f.write_str("the time is over"),
            Cause::NoValue(error) => error.fmt(f),
            Cause::OutOfRange => f.write_str("value out of range"),
            Cause::BadWait => f.write_str("not a time to wait"),
            Cause::TooDeep => f.write_str("too many nested goals"),
        }
    }
}

/// The log, and how often each plan was selected.
#[derive(Debug, Default)]
pub(crate) struct Log {
    pub entries: Vec<LogEntry>,
    pub selections: Vec<u64>,
    /// Whether selections are entered, or counted only.
    pub detailed: bool,
}

impl Log {
    pub fn enter(&mut self, time: Nanos, intention: u32, what: Logged) {
        self.entries.push(LogEntry { time, intention, what });
    }
}

/// A name with its arguments, as in the language: `shows(1, true)`; a name alone without arguments.
pub(crate) fn literal<T: fmt::Display>(name: &str, args: impl IntoIterator<Item = T>) -> String {
    let args: Vec<String> = args.into_iter().map(|a| a.to_string()).collect();
    if args.is_empty() { name.to_owned() } else { format!("{name}({})", args.join(", ")) }
}

fn open(args: &Args) -> impl Iterator<Item = String> {
    args.iter().map(|arg| arg.map_or_else(|| "_".to_owned(), |v| v.to_string()))
}

/// Makes entries readable.
pub(crate) struct Describe<'a> {
    pub agent: &'a Agent,
    pub events: &'a [hrdsl_ir::Event],
}

impl Describe<'_> {
    pub fn entry(&self, entry: &LogEntry) -> String {
        let what = match &entry.what {
            Logged::Selected { on, args, plan } => format!("{} by {}", self.on(*on, args), self.plan(*plan)),
            Logged::Unhandled { on, args } => format!("{} ignored", self.on(*on, args)),
            Logged::Fault { plan, error, .. } => format!("{} not tried: {error}", self.plan(*plan)),
            Logged::Failed(failure) => format!("failed {}", self.failure(failure)),
            Logged::Dropped(failure) => format!("dropped {}", self.failure(failure)),
            Logged::Refused { belief } => format!("refused {}", self.belief(*belief)),
            Logged::Livelock => "livelock".to_owned(),
        };
        if entry.intention == 0 { what } else { format!("#{} {what}", entry.intention) }
    }

    fn plan(&self, index: PlanIndex) -> &str {
        self.agent.plans.get(index as usize).map_or("?", |p| &p.label)
    }

    fn belief(&self, id: BeliefId) -> &str {
        self.agent.beliefs.get(id.0 as usize).map_or("?", |b| &b.name)
    }

    fn goal(&self, id: GoalId) -> &str {
        self.agent.goals.get(id.0 as usize).map_or("?", |g| &g.name)
    }

    fn on(&self, on: TriggerOn, args: &Args) -> String {
        let (sign, name) = match on {
            TriggerOn::BeliefAdded(b) => ("+", self.belief(b)),
            TriggerOn::BeliefRemoved(b) => ("-", self.belief(b)),
            TriggerOn::GoalAdded(g) => ("+!", self.goal(g)),
            TriggerOn::GoalFailed(g) => ("-!", self.goal(g)),
            TriggerOn::TestAdded(b) => ("+?", self.belief(b)),
            TriggerOn::Perceived(e) => ("on ", self.events.get(e.0 as usize).map_or("?", |e| &e.name)),
        };
        format!("{sign}{}", literal(name, open(args)))
    }

    fn failure(&self, failure: &Failure) -> String {
        let goal = failure.goal.as_ref().map(|(g, args)| format!("!{} ", literal(self.goal(*g), open(args))));
        let plan = failure.plan.map(|p| format!("in {}", self.plan(p)));
        let place = goal.unwrap_or_default() + &plan.unwrap_or_default();
        let belief = match failure.cause {
            Cause::NoAnswer(belief) => format!(" {}", self.belief(belief)),
            Cause::NoRelevantPlan
            | Cause::NoApplicablePlan
            | Cause::TimedOut
            | Cause::NoValue(_)
            | Cause::OutOfRange
            | Cause::BadWait
            | Cause::TooDeep => String::new(),
        };
        format!("{}: {}{belief}", place.trim_end(), failure.cause)
    }
}
