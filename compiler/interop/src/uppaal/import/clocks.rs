//! Conditions that speak of clocks: as guards they are split into alternatives, in queries they stay as they are.

use hrdsl_source::Span;

use super::{
    ast::{BinaryOp, Expr, ExprKind, Quantifier},
    expr::{all, not},
    fault::{Fault, fault},
    scope::{Level, Out, Sym},
    translation::Cx,
};

/// How many edges one transition may become.
const MAX_ALTERNATIVES: usize = 64;

/// A conjunction.
#[derive(Clone, Debug, Default)]
pub struct Conjunction {
    pub clocks: Vec<String>,
    pub data: Vec<Out>,
}

impl Conjunction {
    /// The text, empty if it always holds; `None` if it never does.
    pub fn text(&self) -> Option<String> {
        let data = all(self.data.iter().cloned());
        match data.value {
            Some(0) => None,
            Some(_) => Some(self.clocks.join(" && ")),
            None if self.clocks.is_empty() => Some(data.text),
            None => Some(format!("{} && {}", self.clocks.join(" && "), data.at(Level::And))),
        }
    }
}

/// Clocks with their signs, and what is added to them.
#[derive(Default)]
struct Sum {
    clocks: Vec<(i64, String)>,
    terms: Vec<(i64, Out)>,
}

impl Cx<'_> {
    pub fn mentions_clock(&mut self, e: &Expr) -> bool {
        let mut names = Vec::new();
        e.each(&mut |part| match &part.kind {
            ExprKind::Name(_) | ExprKind::Field(..) => names.push(part.clone()),
            ExprKind::Int(_)
            | ExprKind::Bool(_)
            | ExprKind::Neg(_)
            | ExprKind::Not(_)
            | ExprKind::Binary(..)
            | ExprKind::Choice(..)
            | ExprKind::Index(..)
            | ExprKind::Call(..)
            | ExprKind::Assign(..)
            | ExprKind::Step { .. }
            | ExprKind::Quantified(..)
            | ExprKind::Rate
            | ExprKind::Deadlock => {}
        });
        names.iter().any(|n| self.names_clock(n))
    }

    fn names_clock(&mut self, e: &Expr) -> bool {
        match &e.kind {
            ExprKind::Name(name) => matches!(self.find(name), Some(Sym::Clock(_))),
            // What `forall` binds may be an argument of the process: any of its processes has the same clocks.
            ExprKind::Field(of, field) => {
                let name = match &of.kind {
                    ExprKind::Call(of, _) => of.root(),
                    _ => of.root(),
                };
                let of_name = |p: &&super::translation::Process| name == Some(&p.model_name);
                let process = self.processes.iter().find(of_name);
                process.is_some_and(|p| matches!(p.scope.get(field), Some(Sym::Clock(_))))
            }
            _ => false,
        }
    }

    /// The alternatives of a condition, each a conjunction.
    pub fn alternatives(&mut self, e: &Expr) -> Result<Vec<Conjunction>, Fault> {
        self.split(e, true)
    }

    /// Where the condition is as `wanted`.
    fn split(&mut self, e: &Expr, wanted: bool) -> Result<Vec<Conjunction>, Fault> {
        if !self.mentions_clock(e) {
            let data = self.condition(e)?;
            let data = if wanted { data } else { not(&data) };
            return Ok(vec![Conjunction { clocks: Vec::new(), data: vec![data] }]);
        }
        match &e.kind {
            ExprKind::Not(of) => self.split(of, !wanted),
            ExprKind::Binary(BinaryOp::And, a, b) => {
                let parts = vec![self.split(a, wanted)?, self.split(b, wanted)?];
                combine(parts, wanted, e.span)
            }
            ExprKind::Binary(BinaryOp::Or, a, b) => {
                let parts = vec![self.split(a, wanted)?, self.split(b, wanted)?];
                combine(parts, !wanted, e.span)
            }
            ExprKind::Binary(BinaryOp::Imply, a, b) => {
                let parts = vec![self.split(a, !wanted)?, self.split(b, wanted)?];
                combine(parts, !wanted, e.span)
            }
            ExprKind::Choice(c, a, b) => {
                let yes = combine(vec![self.split(c, true)?, self.split(a, wanted)?], true, e.span)?;
                let no = combine(vec![self.split(c, false)?, self.split(b, wanted)?], true, e.span)?;
                combine(vec![yes, no], false, e.span)
            }
            ExprKind::Quantified(q @ (Quantifier::Forall | Quantifier::Exists), name, ty, of) => {
                let parts = self.parts(name, ty, |cx| cx.split(of, wanted))?;
                combine(parts, (*q == Quantifier::Forall) == wanted, e.span)
            }
            ExprKind::Binary(op, a, b) => {
                let Some(op) = Comparison::of(*op) else {
                    return fault(e.span, "clocks may be compared, and nothing else");
                };
                let op = if wanted { op } else { op.negated() };
                let sides =
                    if op == Comparison::Ne { vec![Comparison::Lt, Comparison::Gt] } else { vec![op] };
                let one = |cx: &mut Self, op| {
                    let clocks = vec![cx.comparison(op, a, b, e.span)?];
                    Ok(Conjunction { clocks, data: Vec::new() })
                };
                sides.into_iter().map(|op| one(self, op)).collect()
            }
            _ => {
                self.expr(e)?;
                fault(e.span, "clocks may be compared with numbers and with each other, and nothing else")
            }
        }
    }

    /// A comparison of clocks as a scenario writes it.
    fn comparison(&mut self, op: Comparison, a: &Expr, b: &Expr, span: Span) -> Result<String, Fault> {
        let mut sum = Sum::default();
        self.add(a, 1, &mut sum)?;
        self.add(b, -1, &mut sum)?;
        sum.terms.iter_mut().for_each(|(sign, _)| *sign = -*sign);
        let plus: Vec<&String> = sum.clocks.iter().filter(|(s, _)| *s > 0).map(|(_, c)| c).collect();
        let minus: Vec<&String> = sum.clocks.iter().filter(|(s, _)| *s < 0).map(|(_, c)| c).collect();
        let (left, op) = match (plus.as_slice(), minus.as_slice()) {
            ([x], []) => ((*x).clone(), op),
            ([x], [y]) => (format!("{x} - {y}"), op),
            ([], [y]) => {
                sum.terms.iter_mut().for_each(|(sign, _)| *sign = -*sign);
                ((*y).clone(), op.flipped())
            }
            _ => return fault(span, "a comparison has one clock, or the difference of two"),
        };
        Ok(format!("{left} {} {}", op.text(), time(&sum.terms)))
    }

    fn add(&mut self, e: &Expr, sign: i64, sum: &mut Sum) -> Result<(), Fault> {
        if !self.mentions_clock(e) {
            let value = self.expr(e)?.into_int();
            sum.terms.push((sign, value));
            return Ok(());
        }
        match &e.kind {
            ExprKind::Binary(BinaryOp::Add, a, b) => {
                self.add(a, sign, sum)?;
                self.add(b, sign, sum)
            }
            ExprKind::Binary(BinaryOp::Sub, a, b) => {
                self.add(a, sign, sum)?;
                self.add(b, -sign, sum)
            }
            ExprKind::Neg(of) => self.add(of, -sign, sum),
            ExprKind::Name(_) | ExprKind::Index(..) | ExprKind::Field(..) => {
                let clock = self.clock(e)?;
                sum.clocks.push((sign, clock));
                Ok(())
            }
            _ => {
                self.expr(e)?;
                fault(e.span, "clocks may be added to and subtracted from, and nothing else")
            }
        }
    }

    pub fn clock(&mut self, e: &Expr) -> Result<String, Fault> {
        match self.place(e)? {
            Sym::Clock(c) if c.dims.is_empty() => Ok(c.name),
            Sym::Clock(_) => fault(e.span, "this is an array of clocks: an index is missing"),
            other => fault(e.span, format!("expected a clock, found {}", other.noun())),
        }
    }

    /// What a clock is set to.
    pub fn setting(&mut self, e: &Expr) -> Result<String, Fault> {
        let mut sum = Sum::default();
        self.add(e, 1, &mut sum)?;
        let value = time(&sum.terms);
        match sum.clocks.as_slice() {
            [] => Ok(if value == "0 s" { "0".to_owned() } else { value }),
            [(1, from)] if value == "0 s" => Ok(from.clone()),
            [(1, from)] => Ok(format!("{from} + {value}")),
            _ => fault(e.span, "a clock is set to a number, or to another clock plus a number"),
        }
    }

    /// A condition of a query, in which clocks may stand under `or` and `not`.
    pub fn formula(&mut self, e: &Expr) -> Result<Out, Fault> {
        if !self.mentions_clock(e) {
            return self.condition(e);
        }
        match &e.kind {
            ExprKind::Not(of) => self.formula(of).map(|of| not(&of)),
            ExprKind::Binary(BinaryOp::And, a, b) => {
                let parts = [self.formula(a)?, self.formula(b)?];
                Ok(all(parts.into_iter()))
            }
            ExprKind::Binary(BinaryOp::Or, a, b) => {
                let parts = [self.formula(a)?, self.formula(b)?];
                Ok(super::expr::any(parts.into_iter()))
            }
            ExprKind::Binary(BinaryOp::Imply, a, b) => {
                let (a, b) = (self.formula(a)?, self.formula(b)?);
                let text = format!("{} imply {}", a.at(Level::Or), b.at(Level::Or));
                Ok(Out::new(text, Level::Imply, true))
            }
            ExprKind::Quantified(Quantifier::Forall, name, ty, of) => {
                Ok(all(self.parts(name, ty, |cx| cx.formula(of))?.into_iter()))
            }
            ExprKind::Quantified(Quantifier::Exists, name, ty, of) => {
                Ok(super::expr::any(self.parts(name, ty, |cx| cx.formula(of))?.into_iter()))
            }
            _ => {
                let parts = self.split(e, true)?;
                let text = |c: &Conjunction| {
                    let level =
                        if c.clocks.len() + c.data.len() > 1 { Level::And } else { Level::Comparison };
                    c.text().map_or_else(|| Out::bool(false), |t| Out::new(t, level, true))
                };
                Ok(super::expr::any(parts.iter().map(text)))
            }
        }
    }
}

/// All of these together, or one of them.
fn combine(parts: Vec<Vec<Conjunction>>, together: bool, span: Span) -> Result<Vec<Conjunction>, Fault> {
    let mut out: Vec<Conjunction> = if together { vec![Conjunction::default()] } else { Vec::new() };
    for part in parts {
        if together {
            let with = |a: &Conjunction, b: &Conjunction| Conjunction {
                clocks: a.clocks.iter().chain(&b.clocks).cloned().collect(),
                data: a.data.iter().chain(&b.data).cloned().collect(),
            };
            out = out.iter().flat_map(|a| part.iter().map(move |b| with(a, b))).collect();
        } else {
            out.extend(part);
        }
        if out.len() > MAX_ALTERNATIVES {
            return fault(
                span,
                format!("this condition over clocks has more than {MAX_ALTERNATIVES} alternatives"),
            );
        }
    }
    Ok(out)
}

/// A sum of numbers as a time, one unit being a second.
fn time(terms: &[(i64, Out)]) -> String {
    if let Some(all) = terms.iter().map(|(s, t)| t.value.map(|n| s * n)).collect::<Option<Vec<_>>>() {
        // The name of a constant says more than its number.
        if let [(1, only)] = terms
            && only.level == Level::Atom
            && only.text.parse::<i64>().is_err()
        {
            return format!("{} * 1 s", only.text);
        }
        return format!("{} s", all.iter().sum::<i64>());
    }
    let mut text = String::new();
    for (sign, term) in terms {
        let shown = match term.value {
            Some(n) => format!("{n} s"),
            None => format!("{} * 1 s", term.at(Level::Atom)),
        };
        match (text.is_empty(), sign) {
            (true, 1) => text = shown,
            (true, _) => text = format!("0 s - {shown}"),
            (false, 1) => text += &format!(" + {shown}"),
            (false, _) => text += &format!(" - {shown}"),
        }
    }
    text
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Comparison {
    Lt,
    Le,
    Eq,
    Ge,
    Gt,
    Ne,
}

impl Comparison {
    fn of(op: BinaryOp) -> Option<Self> {
        Some(match op {
            BinaryOp::Lt => Self::Lt,
            BinaryOp::Le => Self::Le,
            BinaryOp::Eq => Self::Eq,
            BinaryOp::Ge => Self::Ge,
            BinaryOp::Gt => Self::Gt,
            BinaryOp::Ne => Self::Ne,
            BinaryOp::Add
            | BinaryOp::Sub
            | BinaryOp::Mul
            | BinaryOp::Div
            | BinaryOp::Rem
            | BinaryOp::Min
            | BinaryOp::Max
            | BinaryOp::And
            | BinaryOp::Or
            | BinaryOp::Imply => return None,
        })
    }

    fn negated(self) -> Self {
        match self {
            Self::Lt => Self::Ge,
            Self::Le => Self::Gt,
            Self::Eq => Self::Ne,
            Self::Ge => Self::Lt,
            Self::Gt => Self::Le,
            Self::Ne => Self::Eq,
        }
    }

    /// With its sides exchanged.
    fn flipped(self) -> Self {
        match self {
            Self::Lt => Self::Gt,
            Self::Le => Self::Ge,
            Self::Ge => Self::Le,
            Self::Gt => Self::Lt,
            Self::Eq => Self::Eq,
            Self::Ne => Self::Ne,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Lt => "<",
            Self::Le => "<=",
            Self::Eq => "==",
            Self::Ge => ">=",
            Self::Gt => ">",
            Self::Ne => "!=",
        }
    }
}
