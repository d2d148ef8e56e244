//! Expressions of TChecker as text of a scenario: integers, conditions, bounds on clocks.

use super::{
    ast::{TcheckerExpr, TcheckerExprKind, TcheckerModel, TcheckerOperator},
    names::TcheckerScenarioNames,
    parse::TcheckerFault,
};
use crate::exchange::time::too_long;

/// How tightly the text around an expression binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum SurroundingPrecedence {
    And,
    Not,
    Compare,
    Sum,
    Product,
    Factor,
}

/// Writes expressions. A name that the model does not declare is a local variable of a function.
pub struct ScenarioExprWriter<'a> {
    pub model: &'a TcheckerModel,
    pub names: &'a TcheckerScenarioNames,
}

type ScenarioTextResult = Result<String, TcheckerFault>;

fn fault<T>(e: &TcheckerExpr, message: impl Into<String>) -> Result<T, TcheckerFault> {
    Err(TcheckerFault { at: e.at, message: message.into() })
}

impl ScenarioExprWriter<'_> {
    /// The clock that a name means, if it is one.
    pub fn clock(&self, e: &TcheckerExpr) -> Result<Option<String>, TcheckerFault> {
        let TcheckerExprKind::Name(name, index) = &e.kind else { return Ok(None) };
        let Some(at) = self.model.clocks.iter().position(|c| c.name == *name) else { return Ok(None) };
        self.element(e, at, index.as_deref()).map(Some)
    }

    fn element(&self, e: &TcheckerExpr, clock: usize, index: Option<&TcheckerExpr>) -> ScenarioTextResult {
        let elements = &self.names.clocks[clock];
        let at = match index {
            None if elements.len() == 1 => 0,
            None => return fault(e, "an index is missing: this is an array of clocks"),
            Some(index) => match constant(index) {
                Some(n) => n,
                None => return fault(index, "the index of a clock is no constant here"),
            },
        };
        match usize::try_from(at).ok().and_then(|i| elements.get(i)) {
            Some(name) => Ok(name.clone()),
            None => fault(e, format!("index {at} is none of 0 to {}", elements.len() - 1)),
        }
    }

    /// `x` or `x - y`
    fn clock_term(&self, e: &TcheckerExpr) -> Result<Option<String>, TcheckerFault> {
        if let TcheckerExprKind::Binary(TcheckerOperator::Sub, left, right) = &e.kind {
            return Ok(match (self.clock(left)?, self.clock(right)?) {
                (Some(x), Some(y)) => Some(format!("{x} - {y}")),
                (Some(_), None) | (None, Some(_)) => {
                    return fault(e, "a clock is compared, or its difference to another");
                }
                (None, None) => None,
            });
        }
        self.clock(e)
    }

    /// One part of a conjunction.
    pub fn part(&self, e: &TcheckerExpr) -> ScenarioTextResult {
        let (e, negated) = if let TcheckerExprKind::Not(inner) = &e.kind
            && self.is_clock_bound(inner)?
        {
            (&**inner, true)
        } else {
            (e, false)
        };
        let TcheckerExprKind::Binary(op, left, right) = &e.kind else {
            return self.condition(e, SurroundingPrecedence::And);
        };
        if !op.compares() {
            return self.condition(e, SurroundingPrecedence::And);
        }
        let (term, op, other) = match (self.clock_term(left)?, self.clock_term(right)?) {
            (None, None) => return self.condition(e, SurroundingPrecedence::And),
            (Some(x), Some(y)) => return Ok(format!("{x} {} {y}", op.text())),
            (Some(x), None) => (x, *op, right),
            (None, Some(y)) => (y, op.flipped(), left),
        };
        let op = if negated { op.negated().unwrap_or(op) } else { op };
        if op == TcheckerOperator::Ne {
            return fault(e, "a clock is not compared by `!=`");
        }
        Ok(format!("{term} {} {}", op.text(), self.time(other)?))
    }

    fn is_clock_bound(&self, e: &TcheckerExpr) -> Result<bool, TcheckerFault> {
        let TcheckerExprKind::Binary(op, left, right) = &e.kind else { return Ok(false) };
        Ok(op.compares() && (self.clock_term(left)?.is_some() || self.clock_term(right)?.is_some()))
    }

    /// A number of TChecker's units of time: each is a second.
    pub fn time(&self, e: &TcheckerExpr) -> ScenarioTextResult {
        match constant(e) {
            Some(n) => match too_long(n) {
                Some(message) => fault(e, message),
                None => Ok(format!("{n} s")),
            },
            None => Ok(format!("{} * 1 s", self.int(e, SurroundingPrecedence::Product)?)),
        }
    }

    /// What a clock is set to.
    pub fn clock_value(&self, e: &TcheckerExpr) -> ScenarioTextResult {
        if let Some(y) = self.clock(e)? {
            return Ok(y);
        }
        if let TcheckerExprKind::Binary(TcheckerOperator::Add, left, right) = &e.kind {
            if let Some(y) = self.clock(left)? {
                return Ok(format!("{y} + {}", self.time(right)?));
            }
            if let Some(y) = self.clock(right)? {
                return Ok(format!("{y} + {}", self.time(left)?));
            }
        }
        match constant(e) {
            Some(0) => Ok("0".to_owned()),
            Some(n) if n < 0 => fault(e, format!("a clock is set to a number of at least 0, not to {n}")),
            Some(_) | None => self.time(e),
        }
    }

    pub fn integer(&self, e: &TcheckerExpr) -> ScenarioTextResult {
        self.int(e, SurroundingPrecedence::And)
    }

    pub fn boolean(&self, e: &TcheckerExpr) -> ScenarioTextResult {
        self.condition(e, SurroundingPrecedence::And)
    }

    fn condition(&self, e: &TcheckerExpr, around: SurroundingPrecedence) -> ScenarioTextResult {
        let (text, level) = match &e.kind {
            TcheckerExprKind::Binary(TcheckerOperator::And, left, right) => (
                format!(
                    "{} && {}",
                    self.condition(left, SurroundingPrecedence::And)?,
                    self.condition(right, SurroundingPrecedence::Not)?
                ),
                SurroundingPrecedence::And,
            ),
            TcheckerExprKind::Not(inner) => (
                format!("not {}", self.condition(inner, SurroundingPrecedence::Not)?),
                SurroundingPrecedence::Not,
            ),
            TcheckerExprKind::Binary(op, left, right) if op.compares() => {
                let (l, r) = (
                    self.int(left, SurroundingPrecedence::Sum)?,
                    self.int(right, SurroundingPrecedence::Sum)?,
                );
                (format!("{l} {} {r}", op.text()), SurroundingPrecedence::Compare)
            }
            TcheckerExprKind::Int(n) => {
                (if *n == 0 { "false" } else { "true" }.to_owned(), SurroundingPrecedence::Factor)
            }
            TcheckerExprKind::Name(..)
            | TcheckerExprKind::Neg(_)
            | TcheckerExprKind::Binary(..)
            | TcheckerExprKind::If(..) => {
                (format!("{} != 0", self.int(e, SurroundingPrecedence::Sum)?), SurroundingPrecedence::Compare)
            }
        };
        Ok(if level < around { format!("({text})") } else { text })
    }

    fn int(&self, e: &TcheckerExpr, around: SurroundingPrecedence) -> ScenarioTextResult {
        let (text, level) = match &e.kind {
            TcheckerExprKind::Int(n) => (
                n.to_string(),
                if *n < 0 { SurroundingPrecedence::Sum } else { SurroundingPrecedence::Factor },
            ),
            TcheckerExprKind::Name(name, index) => {
                (self.variable(e, name, index.as_deref())?, SurroundingPrecedence::Factor)
            }
            TcheckerExprKind::Neg(inner) => (
                format!("-{}", self.int(inner, SurroundingPrecedence::Factor)?),
                SurroundingPrecedence::Product,
            ),
            TcheckerExprKind::Binary(op @ (TcheckerOperator::Add | TcheckerOperator::Sub), left, right) => {
                let (l, r) = (
                    self.int(left, SurroundingPrecedence::Sum)?,
                    self.int(right, SurroundingPrecedence::Product)?,
                );
                (format!("{l} {} {r}", op.text()), SurroundingPrecedence::Sum)
            }
            TcheckerExprKind::Binary(
                op @ (TcheckerOperator::Mul | TcheckerOperator::Div | TcheckerOperator::Rem),
                left,
                right,
            ) => {
                let (l, r) = (
                    self.int(left, SurroundingPrecedence::Product)?,
                    self.int(right, SurroundingPrecedence::Factor)?,
                );
                (format!("{l} {} {r}", op.text()), SurroundingPrecedence::Product)
            }
            TcheckerExprKind::If(c, a, b) => {
                let (c, a, b) = (self.boolean(c)?, self.integer(a)?, self.integer(b)?);
                (format!("if {c} {{ {a} }} else {{ {b} }}"), SurroundingPrecedence::Factor)
            }
            // A truth as a number.
            TcheckerExprKind::Not(_) | TcheckerExprKind::Binary(..) => {
                (format!("if {} {{ 1 }} else {{ 0 }}", self.boolean(e)?), SurroundingPrecedence::Factor)
            }
        };
        Ok(if level < around { format!("({text})") } else { text })
    }

    fn variable(&self, e: &TcheckerExpr, name: &str, index: Option<&TcheckerExpr>) -> ScenarioTextResult {
        if self.clock(e)?.is_some() {
            return fault(e, "a clock is no number: it is compared, as a part of a conjunction");
        }
        let known = self.model.ints.iter().position(|i| i.of.name == name);
        let text = known.map_or(name, |i| &self.names.ints[i]);
        let array = known.is_some_and(|i| self.model.ints[i].of.size > 1);
        match index {
            Some(index) if array || known.is_none() => Ok(format!("{text}[{}]", self.integer(index)?)),
            Some(index) if constant(index) == Some(0) => Ok(text.to_owned()),
            Some(index) => fault(index, format!("`{name}` is no array")),
            None if array => fault(e, "an index is missing: this is an array"),
            None => Ok(text.to_owned()),
        }
    }

    /// What is assigned to: an integer, or an element of an array.
    pub fn target(&self, name: &str, index: Option<&TcheckerExpr>, at: usize) -> ScenarioTextResult {
        let e =
            TcheckerExpr { kind: TcheckerExprKind::Name(name.to_owned(), index.cloned().map(Box::new)), at };
        self.variable(&e, name, index)
    }

    /// Between which numbers the value lies where all of these conditions hold, as far as the ranges of the variables and their comparisons
    /// with constants tell.
    pub fn interval(&self, e: &TcheckerExpr, given: &[TcheckerExpr]) -> Option<(i64, i64)> {
        match &e.kind {
            TcheckerExprKind::Int(n) => Some((*n, *n)),
            TcheckerExprKind::Name(name, index) => {
                let int = self.model.ints.iter().find(|i| i.of.name == *name)?;
                let range = (int.lo, int.hi);
                Some(if index.is_none() {
                    given.iter().fold(range, |r, c| narrowed(r, name, c))
                } else {
                    range
                })
            }
            TcheckerExprKind::Neg(inner) => {
                let (lo, hi) = self.interval(inner, given)?;
                Some((hi.checked_neg()?, lo.checked_neg()?))
            }
            TcheckerExprKind::Binary(op, left, right) => {
                let ((a, b), (c, d)) = (self.interval(left, given)?, self.interval(right, given)?);
                match op {
                    TcheckerOperator::Add => Some((a.checked_add(c)?, b.checked_add(d)?)),
                    TcheckerOperator::Sub => Some((a.checked_sub(d)?, b.checked_sub(c)?)),
                    TcheckerOperator::Mul => {
                        let all =
                            [a.checked_mul(c)?, a.checked_mul(d)?, b.checked_mul(c)?, b.checked_mul(d)?];
                        Some((*all.iter().min()?, *all.iter().max()?))
                    }
                    TcheckerOperator::Div | TcheckerOperator::Rem => None,
                    TcheckerOperator::Eq
                    | TcheckerOperator::Ne
                    | TcheckerOperator::Lt
                    | TcheckerOperator::Le
                    | TcheckerOperator::Gt
                    | TcheckerOperator::Ge
                    | TcheckerOperator::And => Some((0, 1)),
                }
            }
            TcheckerExprKind::Not(_) => Some((0, 1)),
            TcheckerExprKind::If(_, a, b) => {
                let ((a, b), (c, d)) = (self.interval(a, given)?, self.interval(b, given)?);
                Some((a.min(c), b.max(d)))
            }
        }
    }
}

/// What is left of a variable's range where a condition holds; all of it, if nothing is.
fn narrowed((lo, hi): (i64, i64), name: &str, condition: &TcheckerExpr) -> (i64, i64) {
    let TcheckerExprKind::Binary(op, left, right) = &condition.kind else { return (lo, hi) };
    let is_it = |e: &TcheckerExpr| matches!(&e.kind, TcheckerExprKind::Name(n, None) if n == name);
    let (op, number) = match (constant(left), constant(right)) {
        (None, Some(n)) if is_it(left) => (*op, n),
        (Some(n), None) if is_it(right) => (op.flipped(), n),
        (Some(_) | None, Some(_) | None) => return (lo, hi),
    };
    let (least, most) = match op {
        TcheckerOperator::Eq => (number, number),
        TcheckerOperator::Lt => (lo, number.saturating_sub(1)),
        TcheckerOperator::Le => (lo, number),
        TcheckerOperator::Gt => (number.saturating_add(1), hi),
        TcheckerOperator::Ge => (number, hi),
        TcheckerOperator::Ne
        | TcheckerOperator::And
        | TcheckerOperator::Add
        | TcheckerOperator::Sub
        | TcheckerOperator::Mul
        | TcheckerOperator::Div
        | TcheckerOperator::Rem => (lo, hi),
    };
    let (least, most) = (lo.max(least), hi.min(most));
    if least <= most { (least, most) } else { (lo, hi) }
}

/// The number that an expression is, if it has no variables.
pub fn constant(e: &TcheckerExpr) -> Option<i64> {
    match &e.kind {
        TcheckerExprKind::Int(n) => Some(*n),
        TcheckerExprKind::Neg(inner) => constant(inner)?.checked_neg(),
        TcheckerExprKind::Binary(op, left, right) => {
            let (a, b) = (constant(left)?, constant(right)?);
            match op {
                TcheckerOperator::Add => a.checked_add(b),
                TcheckerOperator::Sub => a.checked_sub(b),
                TcheckerOperator::Mul => a.checked_mul(b),
                TcheckerOperator::Div => a.checked_div(b),
                TcheckerOperator::Rem => a.checked_rem(b),
                TcheckerOperator::Eq
                | TcheckerOperator::Ne
                | TcheckerOperator::Lt
                | TcheckerOperator::Le
                | TcheckerOperator::Gt
                | TcheckerOperator::Ge
                | TcheckerOperator::And => None,
            }
        }
        TcheckerExprKind::Name(..) | TcheckerExprKind::Not(_) | TcheckerExprKind::If(..) => None,
    }
}
