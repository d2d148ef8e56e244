//! Formulas in metric temporal logic: atoms, Boolean operators, and operators with windows into the past and the future.

use serde::{Deserialize, Serialize};

use crate::{
    event::EventPattern,
    expr::{BinaryOp, Expr},
    value::{Nanos, SECOND, Unit},
};

/// A requirement that is a formula.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonitorFormula {
    pub goal: MetricGoal,
    /// What the goal's atoms are.
    pub atoms: Vec<FormulaAtom>,
    /// The unit of all comparisons of numbers; `None`: there are none, or they are of different units, and no margin is told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormulaAtom {
    /// As written in the source.
    pub text: String,
    pub what: FormulaAtomKind,
}

/// What an atom is. `Expr::Var(i)` is the monitor's signal `i`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FormulaAtomKind {
    /// One of these events happens.
    Happens(EventPattern),
    /// The first is less than the second, or, unless `strict`, as great.
    Less {
        least: Expr,
        most: Expr,
        strict: bool,
    },
    Equal {
        left: Expr,
        right: Expr,
        negated: bool,
    },
    /// A condition without a number that would say how far it is from holding.
    Holds(Expr),
}

impl FormulaAtomKind {
    /// What its robustness is a function of; an event is not read of signals.
    #[must_use]
    pub fn reading(&self) -> Option<Expr> {
        match self {
            Self::Happens(_) => None,
            Self::Less { least: a, most: b, .. } | Self::Equal { left: b, right: a, .. } => {
                Some(Expr::binary(BinaryOp::Sub, b.clone(), a.clone()))
            }
            Self::Holds(condition) => Some(condition.clone()),
        }
    }
}

/// What can be asked of every moment of a run. An atom is a number: it says which of the signals that the formula is evaluated on it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MetricFormula {
    Constant(bool),
    Atom(usize),
    Not(Box<MetricFormula>),
    And(Box<MetricFormula>, Box<MetricFormula>),
    Or(Box<MetricFormula>, Box<MetricFormula>),
    Implies(Box<MetricFormula>, Box<MetricFormula>),
    Once(PastWindow, Box<MetricFormula>),
    Historically(PastWindow, Box<MetricFormula>),
    /// The first has held since the second did.
    Since(PastWindow, Box<MetricFormula>, Box<MetricFormula>),
    Eventually(FutureWindow, Box<MetricFormula>),
    Always(FutureWindow, Box<MetricFormula>),
    /// The first holds until the second does.
    Until(FutureWindow, Box<MetricFormula>, Box<MetricFormula>),
}

/// From so long ago to so long ago, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PastWindow {
    pub from: Nanos,
    pub to: Option<Nanos>,
}

impl PastWindow {
    /// From the start until now.
    pub const SINCE_START: Self = Self { from: 0, to: None };

    /// `to`: `None` is since the start. There is no window that ends before it begins, or begins later than now.
    #[must_use]
    pub fn new(from: Nanos, to: Option<Nanos>) -> Option<Self> {
        (from >= 0 && to.is_none_or(|to| to >= from)).then_some(Self { from, to })
    }

    /// From how long ago, and to how long ago.
    #[must_use]
    pub fn bounds(self) -> (Nanos, Option<Nanos>) {
        (self.from, self.to)
    }
}

/// From so much later to so much later, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FutureWindow {
    pub from: Nanos,
    pub to: Nanos,
}

impl FutureWindow {
    /// There is no window that ends before it begins, or begins earlier than now.
    #[must_use]
    pub fn new(from: Nanos, to: Nanos) -> Option<Self> {
        (from >= 0 && to >= from).then_some(Self { from, to })
    }

    /// From how much later, and to how much later.
    #[must_use]
    pub fn bounds(self) -> (Nanos, Nanos) {
        (self.from, self.to)
    }
}

impl MetricFormula {
    /// How far it looks ahead at most: its value at a moment is known so much later.
    #[must_use]
    pub fn horizon(&self) -> Nanos {
        let of = |a: &Self, b: &Self| a.horizon().max(b.horizon());
        match self {
            Self::Constant(_) | Self::Atom(_) => 0,
            Self::Not(a) | Self::Once(_, a) | Self::Historically(_, a) => a.horizon(),
            Self::And(a, b) | Self::Or(a, b) | Self::Implies(a, b) | Self::Since(_, a, b) => of(a, b),
            Self::Eventually(window, a) | Self::Always(window, a) => window.to.saturating_add(a.horizon()),
            Self::Until(window, a, b) => window.to.saturating_add(of(a, b)),
        }
    }
}

/// What is asked of a run as a whole. Operators without an end are here only: what is asked of every moment looks into a window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MetricGoal {
    And(Box<MetricGoal>, Box<MetricGoal>),
    Or(Box<MetricGoal>, Box<MetricGoal>),
    /// It holds at the first moment.
    Now(MetricFormula),
    /// It holds at every moment.
    Always(MetricFormula),
    /// It holds at some moment.
    Eventually(MetricFormula),
    /// The first holds at every moment before one at which the second does.
    Until(MetricFormula, MetricFormula),
    /// The second holds at every moment up to and including one at which the first does, or at all.
    Release(MetricFormula, MetricFormula),
}

impl MetricGoal {
    /// The opposite.
    #[must_use]
    pub fn negated(self) -> Self {
        let not = |formula| MetricFormula::Not(Box::new(formula));
        match self {
            Self::And(a, b) => Self::Or(Box::new(a.negated()), Box::new(b.negated())),
            Self::Or(a, b) => Self::And(Box::new(a.negated()), Box::new(b.negated())),
            Self::Now(a) => Self::Now(not(a)),
            Self::Always(a) => Self::Eventually(not(a)),
            Self::Eventually(a) => Self::Always(not(a)),
            Self::Until(a, b) => Self::Release(not(a), not(b)),
            Self::Release(a, b) => Self::Until(not(a), not(b)),
        }
    }
}

impl MetricGoal {
    /// How far it looks ahead at most from a moment of which it is asked.
    #[must_use]
    pub fn horizon(&self) -> Nanos {
        match self {
            Self::And(a, b) | Self::Or(a, b) => a.horizon().max(b.horizon()),
            Self::Now(a) | Self::Always(a) | Self::Eventually(a) => a.horizon(),
            Self::Until(a, b) | Self::Release(a, b) => a.horizon().max(b.horizon()),
        }
    }
}

// ── As text ── what binds more loosely than its place wants is in parentheses.

const LOOSEST: u8 = 0;
const OR: u8 = 1;
const AND: u8 = 2;
const REACH: u8 = 3;
const PREFIX: u8 = 4;
const TIGHTEST: u8 = 5;

impl MetricFormula {
    /// As the language writes it; `atom` is how an atom is written.
    #[must_use]
    pub fn text(&self, atom: &dyn Fn(usize) -> String) -> String {
        self.within(LOOSEST, atom)
    }

    fn within(&self, around: u8, atom: &dyn Fn(usize) -> String) -> String {
        let of = |f: &Self, level| f.within(level, atom);
        let prefixed =
            |word: &str, window: &str, f: &Self| (format!("{word}{window} {}", of(f, PREFIX)), PREFIX);
        let (text, level) = match self {
            Self::Constant(truth) => (truth.to_string(), TIGHTEST),
            Self::Atom(index) => (atom(*index), TIGHTEST),
            Self::Not(a) => prefixed("not", "", a),
            Self::And(a, b) => (format!("{} and {}", of(a, AND), of(b, REACH)), AND),
            Self::Or(a, b) => (format!("{} or {}", of(a, OR), of(b, AND)), OR),
            Self::Implies(a, b) => (format!("{} implies {}", of(a, OR), of(b, LOOSEST)), LOOSEST),
            Self::Once(w, a) => prefixed("once", &w.text(), a),
            Self::Historically(w, a) => prefixed("historically", &w.text(), a),
            Self::Eventually(w, a) => prefixed("eventually", &w.text(), a),
            Self::Always(w, a) => prefixed("always", &w.text(), a),
            Self::Since(w, a, b) => (format!("{} since{} {}", of(a, PREFIX), w.text(), of(b, PREFIX)), REACH),
            Self::Until(w, a, b) => (format!("{} until{} {}", of(a, PREFIX), w.text(), of(b, PREFIX)), REACH),
        };
        if level < around { format!("({text})") } else { text }
    }

    /// What it is made of.
    #[must_use]
    pub fn operands(&self) -> Vec<&Self> {
        match self {
            Self::Constant(_) | Self::Atom(_) => Vec::new(),
            Self::Not(a)
            | Self::Once(_, a)
            | Self::Historically(_, a)
            | Self::Eventually(_, a)
            | Self::Always(_, a) => vec![a],
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Implies(a, b)
            | Self::Since(_, a, b)
            | Self::Until(_, a, b) => vec![a, b],
        }
    }
}

impl MetricGoal {
    /// The formulas that are asked of moments, in the order of the text.
    #[must_use]
    pub fn formulas(&self) -> Vec<&MetricFormula> {
        match self {
            Self::And(a, b) | Self::Or(a, b) => {
                let mut all = a.formulas();
                all.extend(b.formulas());
                all
            }
            Self::Now(a) | Self::Always(a) | Self::Eventually(a) => vec![a],
            Self::Until(a, b) | Self::Release(a, b) => vec![a, b],
        }
    }
}

impl PastWindow {
    /// As the language writes it, behind the operator; nothing, if it goes back to the start.
    #[must_use]
    pub fn text(self) -> String {
        self.to.map_or_else(String::new, |to| window(self.from, to))
    }
}

impl FutureWindow {
    /// As the language writes it, behind the operator.
    #[must_use]
    pub fn text(self) -> String {
        window(self.from, self.to)
    }
}

fn window(from: Nanos, to: Nanos) -> String {
    format!("[{}, {}]", time(from), time(to))
}

/// In the largest unit in which it is whole.
fn time(nanos: Nanos) -> String {
    let units = [(SECOND, "s"), (SECOND / 1_000, "ms"), (SECOND / 1_000_000, "us"), (1, "ns")];
    let (size, unit) = units.into_iter().find(|(size, _)| nanos % size == 0).unwrap_or((1, "ns"));
    format!("{} {unit}", nanos / size)
}
