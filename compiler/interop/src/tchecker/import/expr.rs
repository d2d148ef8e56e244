//! Expressions of TChecker as text of a scenario: integers, conditions, bounds on clocks.

use super::{
    ast::{Expr, Kind, Model, Op},
    names::Names,
    parse::Fault,
};

/// How tightly the text around an expression binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    And,
    Not,
    Compare,
    Sum,
    Product,
    Factor,
}

/// Writes expressions. A name that the model does not declare is a local variable of a function.
pub struct Exprs<'a> {
    pub model: &'a Model,
    pub names: &'a Names,
}

type Text = Result<String, Fault>;

fn fault<T>(e: &Expr, message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault { at: e.at, message: message.into() })
}

impl Exprs<'_> {
    /// The clock that a name means, if it is one.
    pub fn clock(&self, e: &Expr) -> Result<Option<String>, Fault> {
        let Kind::Name(name, index) = &e.kind else { return Ok(None) };
        let Some(at) = self.model.clocks.iter().position(|c| c.name == *name) else { return Ok(None) };
        self.element(e, at, index.as_deref()).map(Some)
    }

    fn element(&self, e: &Expr, clock: usize, index: Option<&Expr>) -> Text {
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
    fn clock_term(&self, e: &Expr) -> Result<Option<String>, Fault> {
        if let Kind::Binary(Op::Sub, left, right) = &e.kind {
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
    pub fn part(&self, e: &Expr) -> Text {
        let (e, negated) = match &e.kind {
            Kind::Not(inner) if self.is_clock_bound(inner)? => (&**inner, true),
            Kind::Int(_) | Kind::Name(..) | Kind::Neg(_) | Kind::Not(_) | Kind::Binary(..) | Kind::If(..) => {
                (e, false)
            }
        };
        let Kind::Binary(op, left, right) = &e.kind else { return self.condition(e, Level::And) };
        if !op.compares() {
            return self.condition(e, Level::And);
        }
        let (term, op, other) = match (self.clock_term(left)?, self.clock_term(right)?) {
            (None, None) => return self.condition(e, Level::And),
            (Some(x), Some(y)) => return Ok(format!("{x} {} {y}", op.text())),
            (Some(x), None) => (x, *op, right),
            (None, Some(y)) => (y, op.flipped(), left),
        };
        let op = if negated { op.negated().unwrap_or(op) } else { op };
        if op == Op::Ne {
            return fault(e, "a clock is not compared by `!=`");
        }
        Ok(format!("{term} {} {}", op.text(), self.time(other)?))
    }

    fn is_clock_bound(&self, e: &Expr) -> Result<bool, Fault> {
        let Kind::Binary(op, left, right) = &e.kind else { return Ok(false) };
        Ok(op.compares() && (self.clock_term(left)?.is_some() || self.clock_term(right)?.is_some()))
    }

    /// A number of TChecker's units of time: each is a second.
    pub fn time(&self, e: &Expr) -> Text {
        match constant(e) {
            Some(n) => Ok(format!("{n} s")),
            None => Ok(format!("{} * 1 s", self.int(e, Level::Product)?)),
        }
    }

    /// What a clock is set to.
    pub fn clock_value(&self, e: &Expr) -> Text {
        if let Some(y) = self.clock(e)? {
            return Ok(y);
        }
        if let Kind::Binary(Op::Add, left, right) = &e.kind {
            if let Some(y) = self.clock(left)? {
                return Ok(format!("{y} + {}", self.time(right)?));
            }
            if let Some(y) = self.clock(right)? {
                return Ok(format!("{y} + {}", self.time(left)?));
            }
        }
        if constant(e) == Some(0) { Ok("0".to_owned()) } else { self.time(e) }
    }

    pub fn integer(&self, e: &Expr) -> Text {
        self.int(e, Level::And)
    }

    pub fn boolean(&self, e: &Expr) -> Text {
        self.condition(e, Level::And)
    }

    fn condition(&self, e: &Expr, around: Level) -> Text {
        let (text, level) = match &e.kind {
            Kind::Binary(Op::And, left, right) => (
                format!("{} && {}", self.condition(left, Level::And)?, self.condition(right, Level::Not)?),
                Level::And,
            ),
            Kind::Not(inner) => (format!("not {}", self.condition(inner, Level::Not)?), Level::Not),
            Kind::Binary(op, left, right) if op.compares() => {
                let (l, r) = (self.int(left, Level::Sum)?, self.int(right, Level::Sum)?);
                (format!("{l} {} {r}", op.text()), Level::Compare)
            }
            Kind::Int(n) => (if *n == 0 { "false" } else { "true" }.to_owned(), Level::Factor),
            Kind::Name(..) | Kind::Neg(_) | Kind::Binary(..) | Kind::If(..) => {
                (format!("{} != 0", self.int(e, Level::Sum)?), Level::Compare)
            }
        };
        Ok(if level < around { format!("({text})") } else { text })
    }

    fn int(&self, e: &Expr, around: Level) -> Text {
        let (text, level) = match &e.kind {
            Kind::Int(n) => (n.to_string(), if *n < 0 { Level::Sum } else { Level::Factor }),
            Kind::Name(name, index) => (self.variable(e, name, index.as_deref())?, Level::Factor),
            Kind::Neg(inner) => (format!("-{}", self.int(inner, Level::Factor)?), Level::Product),
            Kind::Binary(op @ (Op::Add | Op::Sub), left, right) => {
                let (l, r) = (self.int(left, Level::Sum)?, self.int(right, Level::Product)?);
                (format!("{l} {} {r}", op.text()), Level::Sum)
            }
            Kind::Binary(op @ (Op::Mul | Op::Div | Op::Rem), left, right) => {
                let (l, r) = (self.int(left, Level::Product)?, self.int(right, Level::Factor)?);
                (format!("{l} {} {r}", op.text()), Level::Product)
            }
            Kind::If(c, a, b) => {
                let (c, a, b) = (self.boolean(c)?, self.integer(a)?, self.integer(b)?);
                (format!("if {c} {{ {a} }} else {{ {b} }}"), Level::Factor)
            }
            // A truth as a number.
            Kind::Not(_) | Kind::Binary(..) => {
                (format!("if {} {{ 1 }} else {{ 0 }}", self.boolean(e)?), Level::Factor)
            }
        };
        Ok(if level < around { format!("({text})") } else { text })
    }

    fn variable(&self, e: &Expr, name: &str, index: Option<&Expr>) -> Text {
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
    pub fn target(&self, name: &str, index: Option<&Expr>, at: usize) -> Text {
        let e = Expr { kind: Kind::Name(name.to_owned(), index.cloned().map(Box::new)), at };
        self.variable(&e, name, index)
    }

    /// Between which numbers the value lies, as far as the ranges of the variables tell.
    pub fn interval(&self, e: &Expr) -> Option<(i64, i64)> {
        match &e.kind {
            Kind::Int(n) => Some((*n, *n)),
            Kind::Name(name, _) => self.model.ints.iter().find(|i| i.of.name == *name).map(|i| (i.lo, i.hi)),
            Kind::Neg(inner) => {
                let (lo, hi) = self.interval(inner)?;
                Some((hi.checked_neg()?, lo.checked_neg()?))
            }
            Kind::Binary(op, left, right) => {
                let ((a, b), (c, d)) = (self.interval(left)?, self.interval(right)?);
                match op {
                    Op::Add => Some((a.checked_add(c)?, b.checked_add(d)?)),
                    Op::Sub => Some((a.checked_sub(d)?, b.checked_sub(c)?)),
                    Op::Mul => {
                        let all =
                            [a.checked_mul(c)?, a.checked_mul(d)?, b.checked_mul(c)?, b.checked_mul(d)?];
                        Some((*all.iter().min()?, *all.iter().max()?))
                    }
                    Op::Div | Op::Rem => None,
                    Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge | Op::And => Some((0, 1)),
                }
            }
            Kind::Not(_) => Some((0, 1)),
            Kind::If(_, a, b) => {
                let ((a, b), (c, d)) = (self.interval(a)?, self.interval(b)?);
                Some((a.min(c), b.max(d)))
            }
        }
    }
}

/// The number that an expression is, if it has no variables.
pub fn constant(e: &Expr) -> Option<i64> {
    match &e.kind {
        Kind::Int(n) => Some(*n),
        Kind::Neg(inner) => constant(inner)?.checked_neg(),
        Kind::Binary(op, left, right) => {
            let (a, b) = (constant(left)?, constant(right)?);
            match op {
                Op::Add => a.checked_add(b),
                Op::Sub => a.checked_sub(b),
                Op::Mul => a.checked_mul(b),
                Op::Div => a.checked_div(b),
                Op::Rem => a.checked_rem(b),
                Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge | Op::And => None,
            }
        }
        Kind::Name(..) | Kind::Not(_) | Kind::If(..) => None,
    }
}
