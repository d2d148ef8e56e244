//! Queries, resolved: formulas over the locations, variables and clocks of a network.

use hrdsl_source::Span;
use serde::Serialize;

use crate::{ClockId, ClockOp, Expr, LocationId, NetworkId};

/// A question about a network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Query {
    pub name: String,
    pub title: String,
    /// The formal part.
    pub text: Span,
    pub network: NetworkId,
    pub ask: Ask,
    pub span: Span,
}

/// What is asked; see `hrdsl_ir::ta::Ask`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ask {
    Possibly(Formula),
    Invariantly(Formula),
    PotentiallyAlways(Formula),
    Eventually(Formula),
    LeadsTo(Formula, Formula),
    Sup { of: Vec<Measure>, when: Formula },
    Inf { of: Vec<Measure>, when: Formula },
}

/// In its expressions, [`Leaf::Own`](crate::Leaf::Own) counts the variables of all automata, in the network's order.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Formula {
    /// The automaton by its place in the network.
    At {
        automaton: u16,
        location: LocationId,
    },
    Data(Expr),
    Clock(ClockBound),
    Deadlock,
    Not(Box<Formula>),
    And(Vec<Formula>),
    Or(Vec<Formula>),
}

impl Formula {
    /// Whether it speaks of `deadlock`.
    #[must_use]
    pub fn asks_deadlock(&self) -> bool {
        match self {
            Formula::Deadlock => true,
            Formula::Not(f) => f.asks_deadlock(),
            Formula::And(fs) | Formula::Or(fs) => fs.iter().any(Formula::asks_deadlock),
            Formula::At { .. } | Formula::Data(_) | Formula::Clock(_) => false,
        }
    }
}

/// `clock - minus op bound`. The clocks count the shared ones, then those of each automaton, in the network's order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClockBound {
    pub clock: ClockId,
    pub minus: Option<ClockId>,
    pub op: ClockOp,
    pub bound: Linear,
}

/// `seconds + Σ factor · value`, the values integers.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Linear {
    pub seconds: f64,
    pub terms: Vec<(f64, Expr)>,
}

/// What a `sup` or `inf` is taken of.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    Clock(ClockId),
    Data(Expr),
}
