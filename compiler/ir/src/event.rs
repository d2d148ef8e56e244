//! The vocabulary: actors and the events between them.

use std::fmt;

use hrdsl_source::Span;
use serde::{Deserialize, Serialize};

use crate::{
    expr::Expr,
    value::{Type, Value},
    world::WorldAction,
};

/// Index into [`Program::actors`](crate::Program::actors).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ActorId(pub u16);

/// Index into [`Program::events`](crate::Program::events).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct EventId(pub u16);

/// A role; what plays it depends on the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Actor {
    pub name: String,
    pub role: Role,
    pub origin: Span,
}

/// Whether an actor makes the stimulus of a test or is what the test is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Environment,
    System,
}

/// Whose word an event is: what there is to show that it happened. From the weakest to the strongest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Provenance {
    /// The code says it, and nothing else shows it.
    Said,
    /// The code told a device to do it: what came of it is another matter.
    Commanded,
    /// The environment does it: the script of a test, as `gen` has found it.
    Played,
    /// The world shows it.
    Seen,
}

impl Provenance {
    /// The word for it, as the specification has it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Provenance::Said => "said",
            Provenance::Commanded => "commanded",
            Provenance::Played => "played",
            Provenance::Seen => "seen",
        }
    }
}

/// A named parameter of an event, belief or goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    pub name: String,
    pub ty: Type,
}

/// Something that happens at an instant, made by one actor; or a stimulus, one abstract action of a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event<E = Expr> {
    pub name: String,
    pub params: Vec<Parameter>,
    /// The actor that makes it.
    pub from: ActorId,
    /// The actors it is addressed to; empty: everybody but `from` perceives it. A stimulus is perceived by
    /// environment actors only, whatever this says.
    pub to: Vec<ActorId>,
    /// `Some` for a stimulus: what happens when the actor does it.
    pub stimulus: Option<Stimulus<E>>,
    pub origin: Span,
}

impl<E> Event<E> {
    #[must_use]
    pub fn is_stimulus(&self) -> bool {
        self.stimulus.is_some()
    }
}

/// The body of a stimulus: first all samples are drawn, in order, then the steps run in order.
///
/// In expressions, `Expr::Var(i)` is the i-th parameter for `i < params.len()`, then the samples in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stimulus<E = Expr> {
    pub samples: Vec<StimulusSample<E>>,
    pub steps: Vec<StimulusStep<E>>,
}

impl Stimulus {
    /// The steps that are done, in order, with `holds` deciding each `if`: no [`StimulusStep::If`] is among them.
    ///
    /// # Errors
    /// The first error of `holds`.
    pub fn taken<E>(&self, holds: &dyn Fn(&Expr) -> Result<bool, E>) -> Result<Vec<&StimulusStep>, E> {
        let mut out = Vec::new();
        take(&self.steps, holds, &mut out)?;
        Ok(out)
    }
}

fn take<'a, E>(
    steps: &'a [StimulusStep],
    holds: &dyn Fn(&Expr) -> Result<bool, E>,
    out: &mut Vec<&'a StimulusStep>,
) -> Result<(), E> {
    for step in steps {
        match step {
            StimulusStep::If { condition, then, otherwise } => {
                take(if holds(condition)? { then } else { otherwise }, holds, out)?;
            }
            StimulusStep::Emit { .. } | StimulusStep::Hold { .. } | StimulusStep::Act(_) => out.push(step),
        }
    }
    Ok(())
}

/// A value of the second tier, drawn uniformly from `lo..hi` by the test's seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StimulusSample<E = Expr> {
    pub name: String,
    pub ty: Type,
    pub lo: E,
    pub hi: E,
}

/// One step of a stimulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StimulusStep<E = Expr> {
    /// Make an event of the same actor.
    Emit {
        event: EventId,
        args: Vec<E>,
    },
    /// The actor is busy for a time (speech, a pause); an expression in seconds.
    Hold {
        seconds: E,
    },
    /// Change the world; does not wait for a motion to end.
    Act(WorldAction<E>),
    If {
        condition: E,
        then: Vec<StimulusStep<E>>,
        otherwise: Vec<StimulusStep<E>>,
    },
}

/// What an event must look like to match.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventPattern {
    pub event: EventId,
    /// One for each parameter.
    pub args: Vec<ArgPattern>,
}

/// What one argument must look like to match.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArgPattern {
    Any,
    Is(Value),
}

/// As the language writes it.
impl fmt::Display for ArgPattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ArgPattern::Any => f.write_str("_"),
            ArgPattern::Is(value) => value.fmt(f),
        }
    }
}

impl EventPattern {
    /// Whether an occurrence of `event` with these arguments matches.
    #[must_use]
    pub fn matches(&self, event: EventId, args: &[Value]) -> bool {
        self.event == event
            && self.args.len() == args.len()
            && self.args.iter().zip(args).all(|(p, v)| match p {
                ArgPattern::Any => true,
                ArgPattern::Is(want) => want.key() == v.key(),
            })
    }
}
