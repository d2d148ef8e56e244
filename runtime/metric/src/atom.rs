//! Atoms: what a formula reads of signals and events, as robustness.

use hrdsl_ir::{EventPattern, Expr, Value, formula::FormulaAtomKind};

use crate::{
    measured::{MeasuredTruth, measured_number},
    robustness::Robustness,
};

/// A number made of signals, in SI units. A signal is a place among those that the formula reads.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NumberTerm {
    Constant(f64),
    /// `Expr::Var(i)` is the signal `i`.
    Expression(Expr),
    Signal(usize),
    Negative(Box<NumberTerm>),
    Absolute(Box<NumberTerm>),
    Binary(NumberOperator, Box<NumberTerm>, Box<NumberTerm>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Min,
    Max,
}

impl NumberTerm {
    /// `None`: a signal has no value yet. What cannot be computed is NaN.
    fn value(&self, signals: &[Option<Value>]) -> Option<f64> {
        Some(match self {
            Self::Constant(number) => *number,
            Self::Expression(expr) => measured_number(expr, &|signal| sampled(signal, signals))?,
            Self::Signal(signal) => signals.get(*signal).copied().flatten()?.as_f64()?,
            Self::Negative(a) => -a.value(signals)?,
            Self::Absolute(a) => a.value(signals)?.abs(),
            Self::Binary(operator, a, b) => {
                let (a, b) = (a.value(signals)?, b.value(signals)?);
                match operator {
                    NumberOperator::Add => a + b,
                    NumberOperator::Subtract => a - b,
                    NumberOperator::Multiply => a * b,
                    NumberOperator::Divide if b == 0.0 => f64::NAN,
                    NumberOperator::Divide => a / b,
                    NumberOperator::Min | NumberOperator::Max if a.is_nan() || b.is_nan() => f64::NAN,
                    NumberOperator::Min => a.min(b),
                    NumberOperator::Max => a.max(b),
                }
            }
        })
    }

    fn each_signal(&self, f: &mut dyn FnMut(usize)) {
        match self {
            Self::Constant(_) => {}
            Self::Expression(expr) => expr.each_var(&mut |signal| f(usize::from(signal))),
            Self::Signal(signal) => f(*signal),
            Self::Negative(a) | Self::Absolute(a) => a.each_signal(f),
            Self::Binary(_, a, b) => {
                a.each_signal(f);
                b.each_signal(f);
            }
        }
    }
}

/// The latest sample of a signal.
fn sampled(signal: u16, signals: &[Option<Value>]) -> Option<Value> {
    signals.get(usize::from(signal)).copied().flatten()
}

/// What an atom comes to at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AtomReading {
    pub value: Robustness,
    /// It compares what has no value.
    pub unvalued: bool,
}

impl AtomReading {
    /// `known`: how far a comparison holds; if there is no such number, only `negated` ones do, and by no distance.
    fn compared(known: Option<Robustness>, negated: bool) -> Self {
        let nothing = Self { value: Robustness::of_truth(negated), unvalued: true };
        known.map_or(nothing, |value| Self { value, unvalued: false })
    }

    fn of_truth(truth: bool) -> Self {
        Self { value: Robustness::of_truth(truth), unvalued: false }
    }
}

/// What an atom is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum AtomSource {
    /// The first is less than the second, or, unless `strict`, as great.
    Less {
        least: NumberTerm,
        most: NumberTerm,
        strict: bool,
    },
    Equal {
        left: NumberTerm,
        right: NumberTerm,
        negated: bool,
    },
    /// A signal is true.
    Truth(usize),
    /// A condition over signals is true.
    Holds(Expr),
    /// A signal has this value.
    Is {
        signal: usize,
        value: Value,
        negated: bool,
    },
    /// One of these events happens.
    Happens(EventPattern),
}

impl AtomSource {
    /// That of a requirement.
    pub fn of(atom: &FormulaAtomKind) -> Self {
        let number = |expr: &Expr| NumberTerm::Expression(expr.clone());
        match atom {
            FormulaAtomKind::Happens(pattern) => Self::Happens(pattern.clone()),
            FormulaAtomKind::Less { least, most, strict } => {
                Self::Less { least: number(least), most: number(most), strict: *strict }
            }
            FormulaAtomKind::Equal { left, right, negated } => {
                Self::Equal { left: number(left), right: number(right), negated: *negated }
            }
            FormulaAtomKind::Holds(condition) => Self::Holds(condition.clone()),
        }
    }

    /// `None`: a signal has no sample yet. An event does not happen.
    pub fn reading(&self, signals: &[Option<Value>]) -> Option<AtomReading> {
        match self {
            Self::Less { least, most, strict } => {
                let apart = most.value(signals)? - least.value(signals)?;
                Some(AtomReading::compared(Robustness::of(apart, *strict), false))
            }
            Self::Equal { left, right, negated } => {
                let apart = Robustness::of((left.value(signals)? - right.value(signals)?).abs(), true);
                Some(AtomReading::compared(apart.map(|a| if *negated { a } else { !a }), *negated))
            }
            Self::Truth(signal) => {
                signals.get(*signal).copied().flatten()?.as_bool().map(AtomReading::of_truth)
            }
            Self::Holds(condition) => {
                let MeasuredTruth { truth, unvalued } =
                    MeasuredTruth::of(condition, &|signal| sampled(signal, signals))?;
                Some(AtomReading { value: Robustness::of_truth(truth), unvalued })
            }
            Self::Is { signal, value, negated } => {
                let is = signals.get(*signal).copied().flatten()?.key() == value.key();
                Some(AtomReading::of_truth(is != *negated))
            }
            Self::Happens(_) => Some(AtomReading::of_truth(false)),
        }
    }

    /// Each signal that it reads.
    pub fn each_signal(&self, f: &mut dyn FnMut(usize)) {
        match self {
            Self::Less { least: a, most: b, .. } | Self::Equal { left: a, right: b, .. } => {
                a.each_signal(f);
                b.each_signal(f);
            }
            Self::Truth(signal) | Self::Is { signal, .. } => f(*signal),
            Self::Holds(condition) => condition.each_var(&mut |signal| f(usize::from(signal))),
            Self::Happens(_) => {}
        }
    }
}
