//! What an agent decided, entry by entry.

use std::fmt;

use hrdsl_ir::{
    EventId, Nanos, Span, Symbol, Value,
    bdi::{BeliefAnnotation, BeliefId, ContentId, Performative, TriggerOn},
    expr::EvalError,
};

use crate::{
    belief::FactAnnotations, event::EventArguments, holding::HoldingKind, query::BeliefQueryError,
    unify::VariableSlot,
};

/// Index into the agent's plan library.
pub type PlanIndex = u16;

/// How much is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum LogDetail {
    /// Failures, faults and warnings.
    #[default]
    Failures,
    /// Also what is selected, done, believed, heard.
    Steps,
    /// Also each plan that was tried, and why it was not chosen.
    Reasons,
}

/// One entry of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogEntry {
    pub time: Nanos,
    /// Counts rounds, and the ends of actions and waits between them, over the run: what agents do in one round comes in
    /// their order.
    pub round: u64,
    /// Cycles at this instant.
    pub cycle: u64,
    /// The number of the intention that it is about; 0: none.
    pub intention: u32,
    pub what: LogItem,
}

#[derive(Clone, Debug, PartialEq)]
pub enum LogItem {
    /// A plan was selected; `fresh`: it began an intention.
    Selected {
        on: TriggerOn,
        args: EventArguments,
        plan: PlanIndex,
        vars: Vec<VariableSlot>,
        fresh: bool,
    },
    /// A plan was tried.
    Tried {
        on: TriggerOn,
        args: EventArguments,
        plan: PlanIndex,
        verdict: ApplicabilityVerdict,
    },
    /// An event for which no plan was selected.
    Unhandled {
        on: TriggerOn,
        args: EventArguments,
        origin: Span,
    },
    /// A plan could not be tried.
    Fault {
        plan: PlanIndex,
        fault: BeliefQueryError,
        origin: Span,
    },
    /// A question of another agent could not be answered.
    FaultyAnswer {
        belief: BeliefId,
        fault: BeliefQueryError,
    },
    /// A step is done: with the variables before it.
    Step {
        plan: PlanIndex,
        line: u16,
        vars: Vec<VariableSlot>,
        outcome: StepOutcome,
    },
    Failed(IntentionFailure),
    /// The intention is done.
    Finished,
    /// An internal action, or the end of another branch, removed the intention.
    Dropped,
    /// With the annotations that are new.
    Added {
        belief: BeliefId,
        args: Vec<Value>,
        annotations: FactAnnotations,
    },
    Left {
        belief: BeliefId,
        args: Vec<Value>,
    },
    /// A source was taken from a fact that has others.
    Taken {
        belief: BeliefId,
        args: Vec<Value>,
        source: Value,
    },
    /// A removal of what is from one source (open: any) removed nothing: the fact is held from these.
    StillHeld {
        belief: BeliefId,
        args: Vec<Value>,
        meant: VariableSlot,
        from: Vec<Value>,
    },
    /// A fact that does not fit its declaration was left out.
    Refused {
        belief: BeliefId,
        args: Vec<Value>,
    },
    Perceived {
        event: EventId,
        args: Vec<Value>,
    },
    Heard {
        from: u16,
        performative: Performative,
        content: ContentId,
        args: EventArguments,
        annotations: FactAnnotations,
    },
    /// A question of another agent that waits for the answer.
    Asked {
        from: u16,
        content: ContentId,
        args: EventArguments,
        all: bool,
    },
    Answered {
        from: u16,
        content: ContentId,
        all: bool,
        answers: Option<Vec<EventArguments>>,
    },
    Printed(String),
    /// At one instant the state repeats.
    Livelock,
    /// Too many cycles at one instant.
    Endless,
    /// Too much of this held at once.
    Overfull(HoldingKind),
}

impl LogItem {
    /// What kind of entry it is, in a word.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            LogItem::Selected { .. } => "selected",
            LogItem::Tried { .. } => "tried",
            LogItem::Unhandled { .. } => "unhandled",
            LogItem::Fault { .. } | LogItem::FaultyAnswer { .. } => "fault",
            LogItem::Step { .. } => "step",
            LogItem::Failed(_) => "failed",
            LogItem::Finished => "finished",
            LogItem::Dropped => "dropped",
            LogItem::Added { .. } | LogItem::Left { .. } | LogItem::Taken { .. } => "belief",
            LogItem::StillHeld { .. } | LogItem::Refused { .. } => "warning",
            LogItem::Perceived { .. } => "perceived",
            LogItem::Heard { .. } | LogItem::Asked { .. } | LogItem::Answered { .. } => "heard",
            LogItem::Printed(_) => "printed",
            LogItem::Livelock => "livelock",
            LogItem::Endless => "cycle_bound",
            LogItem::Overfull(_) => "holding_bound",
        }
    }
}

/// What became of a step, if that is not plain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOutcome {
    Done,
    /// `if`, `while`
    Holds(bool),
    /// Its condition has a fault.
    Faulty,
    /// `for`
    Answers(usize),
    /// `fork`
    Branches(usize),
}

/// Why a plan was chosen or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApplicabilityVerdict {
    /// The trigger's arguments or annotations do not match.
    Unlike,
    /// The context has no answer; the farthest part of it that the search came to, when it is a conjunction.
    False {
        part: usize,
    },
    Faulty(BeliefQueryError),
    Applicable,
}

/// Where and why something failed.
#[derive(Clone, Debug, PartialEq)]
pub struct IntentionFailure {
    /// What the plan that was being executed was selected for.
    pub on: TriggerOn,
    pub args: EventArguments,
    pub plan: PlanIndex,
    pub cause: FailureCause,
    /// The step that failed, or the plan.
    pub origin: Span,
}

/// Why a step or goal failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FailureCause {
    /// Neither beliefs, nor plans, nor the other agent have an answer.
    NoAnswer,
    /// An `await` was over before an event matched, an `.ask` before the answer came, a goal's deadline.
    TimedOut,
    /// An expression has no value.
    NoValue(EvalError),
    /// A query went too far.
    Query(BeliefQueryError),
    /// A value is not of the type, or not in the range, that a belief or event declares.
    OutOfRange,
    /// A `wait` or deadline of a negative time, or of what is not a time.
    BadWait,
    /// More plans than an intention can hold wait for each other.
    TooDeep,
    /// A message to an agent that is not in the run.
    NoSuchAgent(Value),
    /// A message about what the other agent does not have.
    NoSuchContent(Symbol),
    /// `.fail`
    Fail,
    /// `.fail_goal`
    FailGoal,
    /// Of `fork … and …`.
    Branch,
    /// Of `fork … or …`.
    AllBranches,
}

impl From<EvalError> for FailureCause {
    fn from(error: EvalError) -> Self {
        FailureCause::NoValue(error)
    }
}

impl From<BeliefQueryError> for FailureCause {
    fn from(fault: BeliefQueryError) -> Self {
        match fault {
            BeliefQueryError::NoValue(error) => FailureCause::NoValue(error),
            BeliefQueryError::TooDeep | BeliefQueryError::TooLong => FailureCause::Query(fault),
        }
    }
}

impl fmt::Display for FailureCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FailureCause::NoAnswer => f.write_str("no answer"),
            FailureCause::TimedOut => f.write_str("the time is over"),
            FailureCause::NoValue(error) => error.fmt(f),
            FailureCause::Query(fault) => fault.fmt(f),
            FailureCause::OutOfRange => f.write_str("a value is not of its type"),
            FailureCause::BadWait => f.write_str("a time is negative, or no number"),
            FailureCause::TooDeep => f.write_str("the stack is full"),
            FailureCause::NoSuchAgent(name) => write!(f, "{name} is not in this run"),
            FailureCause::NoSuchContent(name) => write!(f, "{name} has nothing of this name"),
            FailureCause::Fail => f.write_str(".fail"),
            FailureCause::FailGoal => f.write_str(".fail_goal"),
            FailureCause::Branch => f.write_str("a branch failed"),
            FailureCause::AllBranches => f.write_str("all branches failed"),
        }
    }
}

/// The entries so far.
#[derive(Debug, Default)]
pub(crate) struct ReasoningLog {
    pub entries: Vec<LogEntry>,
    /// How many entries are kept, at most; those that come later are counted. The end of all reasoning is always kept.
    pub most: Option<usize>,
    pub left_out: u64,
    pub detail: LogDetail,
    pub round: u64,
}

/// The sources among annotations.
pub(crate) fn sources(annotations: &FactAnnotations) -> Vec<Value> {
    let sources = annotations.iter().filter(|(what, _)| *what == BeliefAnnotation::Source);
    sources.map(|(_, value)| *value).collect()
}
