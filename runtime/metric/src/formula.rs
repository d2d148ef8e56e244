//! Formulas: atoms, Boolean operators, and operators with windows into the past and the future.

use hrdsl_ir::Nanos;

/// What can be asked of every moment of a run. An atom is a number: it says which of the signals that the formula is evaluated on it is.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PastWindow {
    pub(crate) from: Nanos,
    pub(crate) to: Option<Nanos>,
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FutureWindow {
    pub(crate) from: Nanos,
    pub(crate) to: Nanos,
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
#[derive(Clone, Debug, PartialEq)]
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
