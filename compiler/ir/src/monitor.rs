//! Requirements, each a deterministic timed automaton with one clock over the trace, or a formula.

use std::fmt;

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{
    event::EventPattern,
    expr::Expr,
    formula::MonitorFormula,
    value::{Nanos, Unit},
    world::SignalId,
};

/// Index into [`Program::monitors`](crate::Program::monitors), which are the requirements in source order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RequirementId(pub u16);

/// A requirement, lowered to a monitor automaton or a formula.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Monitor {
    /// `R5`
    pub name: String,
    pub kind: RequirementKind,
    /// The requirement's own words, if it has a title.
    pub title: String,
    /// Its doc comment: where it comes from, such as a standard's clause.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub doc: String,
    /// The formal part as written in the source.
    pub text: String,
    /// Signals that guards and margins read: `Expr::Var(i)` is `signals[i]`.
    pub signals: Vec<SignalId>,
    /// Conditions over the signals of which each new truth is a cause; of those that change at one instant the first comes first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Expr>,
    pub states: Vec<MonitorState>,
    pub initial: StateId,
    /// What happens at time 0, before anything else.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at_start: Vec<MonitorEffect>,
    /// In each state the first edge, in order, whose trigger and guard hold is taken; none: the state stays.
    pub edges: Vec<MonitorEdge>,
    /// The robustness of a numeric requirement: positive as long as it holds. The verdict keeps the least.
    pub margin: Option<MonitorMargin>,
    /// It is a formula instead, without states and edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<Box<MonitorFormula>>,
    pub origin: Span,
}

impl Monitor {
    /// The unit of its margin, if it has one.
    #[must_use]
    pub fn margin_unit(&self) -> Option<Unit> {
        let of_formula = self.formula.as_ref().and_then(|formula| formula.unit);
        self.margin.as_ref().map(|margin| margin.unit).or(of_formula)
    }
}

/// The judgement on one requirement in one trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MonitorOutcome {
    /// It was triggered, and held.
    Pass,
    /// It was violated at least once.
    Fail,
    /// It was never triggered: the trace says nothing about it.
    Vacuous,
    /// It was not violated, but the trace ended while an obligation was pending, or a comparison had no value.
    Inconclusive,
}

impl fmt::Display for MonitorOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MonitorOutcome::Pass => "pass",
            MonitorOutcome::Fail => "fail",
            MonitorOutcome::Vacuous => "vacuous",
            MonitorOutcome::Inconclusive => "inconclusive",
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RequirementKind {
    Safety,
    Functional,
}

/// Index into [`Monitor::states`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct StateId(pub u16);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonitorState {
    pub name: String,
    /// An obligation is pending here: a trace that ends in this state is inconclusive, not passed.
    pub pending: bool,
    /// The state is left by a [`MonitorTrigger::Deadline`] edge once the clock reaches this.
    pub deadline: Option<Nanos>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonitorEdge {
    pub from: StateId,
    pub to: StateId,
    pub on: MonitorTrigger,
    /// A boolean expression over the signals.
    pub guard: Option<Expr>,
    /// What the clock has to read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<MonitorClockGuard>,
    pub effects: Vec<MonitorEffect>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MonitorClockGuard {
    /// Less than this.
    Before(Nanos),
    /// More than this.
    After(Nanos),
}

impl MonitorClockGuard {
    #[must_use]
    pub fn allows(self, reading: Nanos) -> bool {
        match self {
            Self::Before(bound) => reading < bound,
            Self::After(bound) => reading > bound,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MonitorTrigger {
    /// Any of these events.
    Event(Vec<EventPattern>),
    /// A condition has got this truth from the other one or, if `first` is set, is known for the first time.
    Becomes { condition: u16, truth: bool, first: bool },
    /// Any new sample of a signal that the monitor reads.
    Sample,
    /// The clock reached the state's deadline. An event at the very instant of the deadline comes first.
    Deadline,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MonitorEffect {
    /// The monitor's clock is set to zero.
    ResetClock,
    /// The requirement was triggered: it is checked, and this step is its first witness.
    Trigger,
    /// An obligation was met.
    Discharge,
    /// What happens here is a violation if a [`Fail`](Self::Fail) follows.
    Suspect,
    /// The requirement is violated; the first violation is reported, the monitor goes on to count.
    Fail,
}

/// `value` is the margin, in `unit`. It is evaluated on each step of the given kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonitorMargin {
    pub value: Expr,
    pub unit: Unit,
    /// Only at these events; empty: on every sample.
    pub at: Vec<EventPattern>,
    /// Only in these states; empty: in all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub within: Vec<StateId>,
}

/// `assume at most N e within D`: restricts which stimuli are generated; never gives a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumption<T = String> {
    /// As written in the source; for the checker, where that stands.
    pub text: T,
    pub events: Vec<EventPattern>,
    pub at_most: u32,
    /// Within any window of this length; `None`: within the test.
    pub within: Option<Nanos>,
    pub origin: Span,
}
