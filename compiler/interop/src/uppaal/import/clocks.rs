//! Conditions that speak of clocks: as guards they are split into alternatives, in queries they stay as they are.

use hrdsl_source::Span;

use super::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind, UppaalQuantifier},
    expr::{all, not},
    fault::{UppaalFault, fault},
    known::ClockEvent,
    scope::{ScenarioExprText, ScenarioPrecedence, UppaalSymbol},
    translation::UppaalTranslation,
};
use crate::exchange::time::too_long;

/// How many edges one transition may become.
const MAX_ALTERNATIVES: usize = 64;

/// A conjunction.
#[derive(Clone, Debug, Default)]
pub struct GuardConjunction {
    pub clocks: Vec<String>,
    pub data: Vec<ScenarioExprText>,
}

impl GuardConjunction {
    /// The text, empty if it always holds; `None` if it never does.
    pub fn text(&self) -> Option<String> {
        let data = all(self.data.iter().cloned());
        match data.value {
            Some(0) => None,
            Some(_) => Some(self.clocks.join(" && ")),
            None if self.clocks.is_empty() => Some(data.text),
            None => Some(format!("{} && {}", self.clocks.join(" && "), data.at(ScenarioPrecedence::And))),
        }
    }
}

/// Clocks with their signs, and what is added to them.
#[derive(Default)]
struct UppaalClockSum {
    clocks: Vec<(i64, String)>,
    terms: Vec<(i64, ScenarioExprText)>,
}

impl UppaalClockSum {
    /// `x - x` is 0.
    fn cancel(&mut self) {
        let is_pair = |(a, b): (&(i64, String), &(i64, String))| a.1 == b.1 && a.0 == -b.0;
        while let Some((i, j)) = (0..self.clocks.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .find(|(i, j)| is_pair((&self.clocks[*i], &self.clocks[*j])))
        {
            self.clocks.remove(i);
            self.clocks.remove(j);
        }
    }
}

impl UppaalTranslation<'_> {
    pub fn mentions_clock(&self, e: &UppaalExpr) -> bool {
        let mut found = false;
        e.each(&mut |part| found |= self.kind_of(part).is_some_and(UppaalSymbol::is_clock));
        found
    }

    /// The alternatives of a condition, each a conjunction.
    pub fn alternatives(&mut self, e: &UppaalExpr) -> Result<Vec<GuardConjunction>, UppaalFault> {
        self.split(e, true)
    }

    /// Where the condition is as `wanted`.
    fn split(&mut self, e: &UppaalExpr, wanted: bool) -> Result<Vec<GuardConjunction>, UppaalFault> {
        if !self.mentions_clock(e) {
            let data = self.condition(e)?;
            let data = if wanted { data } else { not(&data) };
            return Ok(vec![GuardConjunction { clocks: Vec::new(), data: vec![data] }]);
        }
        match &e.kind {
            UppaalExprKind::Not(of) => self.split(of, !wanted),
            UppaalExprKind::Binary(UppaalBinaryOperator::And, a, b) => {
                let parts = vec![self.split(a, wanted)?, self.split(b, wanted)?];
                combine(parts, wanted, e.span)
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Or, a, b) => {
                let parts = vec![self.split(a, wanted)?, self.split(b, wanted)?];
                combine(parts, !wanted, e.span)
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Imply, a, b) => {
                let parts = vec![self.split(a, !wanted)?, self.split(b, wanted)?];
                combine(parts, !wanted, e.span)
            }
            UppaalExprKind::Choice(c, a, b) => {
                let yes = combine(vec![self.split(c, true)?, self.split(a, wanted)?], true, e.span)?;
                let no = combine(vec![self.split(c, false)?, self.split(b, wanted)?], true, e.span)?;
                combine(vec![yes, no], false, e.span)
            }
            UppaalExprKind::Quantified(
                q @ (UppaalQuantifier::Forall | UppaalQuantifier::Exists),
                name,
                ty,
                of,
            ) => {
                let parts = self.parts(name, ty, |cx| cx.split(of, wanted))?;
                combine(parts, (*q == UppaalQuantifier::Forall) == wanted, e.span)
            }
            UppaalExprKind::Binary(op, a, b) => {
                let Some(op) = UppaalClockComparison::of(*op) else {
                    return fault(e.span, "clocks may be compared, and nothing else");
                };
                let op = if wanted { op } else { op.negated() };
                let sides = if op == UppaalClockComparison::Ne {
                    vec![UppaalClockComparison::Lt, UppaalClockComparison::Gt]
                } else {
                    vec![op]
                };
                let one = |cx: &mut Self, op| cx.comparison(op, a, b, e.span);
                sides.into_iter().map(|op| one(self, op)).collect()
            }
            _ => {
                self.expr(e)?;
                fault(e.span, "clocks may be compared with numbers and with each other, and nothing else")
            }
        }
    }

    /// A comparison of clocks as a scenario writes it.
    fn comparison(
        &mut self,
        op: UppaalClockComparison,
        a: &UppaalExpr,
        b: &UppaalExpr,
        span: Span,
    ) -> Result<GuardConjunction, UppaalFault> {
        let mut sum = UppaalClockSum::default();
        self.add(a, 1, &mut sum)?;
        self.add(b, -1, &mut sum)?;
        sum.cancel();
        if sum.clocks.is_empty() {
            return Ok(GuardConjunction { clocks: Vec::new(), data: vec![op.of_numbers(&sum.terms)] });
        }
        sum.terms.iter_mut().for_each(|(sign, _)| *sign = -*sign);
        let plus: Vec<&String> = sum.clocks.iter().filter(|(s, _)| *s > 0).map(|(_, c)| c).collect();
        let minus: Vec<&String> = sum.clocks.iter().filter(|(s, _)| *s < 0).map(|(_, c)| c).collect();
        let (left, op) = match (plus.as_slice(), minus.as_slice()) {
            ([x], []) => ((*x).clone(), op),
            ([_], [_]) if self.in_query && self.clocks_stand => {
                return fault(span, "a query cannot compare two clocks where clocks stand still");
            }
            ([x], [y]) => (format!("{x} - {y}"), op),
            ([], [y]) => {
                sum.terms.iter_mut().for_each(|(sign, _)| *sign = -*sign);
                ((*y).clone(), op.flipped())
            }
            _ => return fault(span, "a comparison has one clock, or the difference of two"),
        };
        let clocks = vec![format!("{left} {} {}", op.text(), time(&sum.terms, span)?)];
        Ok(GuardConjunction { clocks, data: Vec::new() })
    }

    fn add(&mut self, e: &UppaalExpr, sign: i64, sum: &mut UppaalClockSum) -> Result<(), UppaalFault> {
        if !self.mentions_clock(e) {
            let value = self.expr(e)?.into_int();
            sum.terms.push((sign, value));
            return Ok(());
        }
        match &e.kind {
            UppaalExprKind::Binary(UppaalBinaryOperator::Add, a, b) => {
                self.add(a, sign, sum)?;
                self.add(b, sign, sum)
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Sub, a, b) => {
                self.add(a, sign, sum)?;
                self.add(b, -sign, sum)
            }
            UppaalExprKind::Neg(of) => self.add(of, -sign, sum),
            UppaalExprKind::Name(_) | UppaalExprKind::Index(..) | UppaalExprKind::Field(..) => {
                let clock = self.clock(e)?;
                self.clock_log.push(ClockEvent { clock: clock.clone(), set: None });
                match self.standing.get(&clock) {
                    Some(n) => sum.terms.push((sign, ScenarioExprText::int(*n))),
                    None => sum.clocks.push((sign, clock)),
                }
                Ok(())
            }
            _ => {
                self.expr(e)?;
                fault(e.span, "clocks may be added to and subtracted from, and nothing else")
            }
        }
    }

    pub fn clock(&mut self, e: &UppaalExpr) -> Result<String, UppaalFault> {
        match self.place(e)? {
            UppaalSymbol::Clock(c) if c.dims.is_empty() => {
                if self.in_query && self.stopwatches.iter().any(|(name, _)| *name == c.name) {
                    return fault(
                        e.span,
                        format!("`{}` is stopped in some locations, and runs on here", c.name),
                    );
                }
                if !c.own {
                    self.clock_uses.entry(c.name.clone()).or_default().insert(self.processes.len());
                }
                Ok(c.name)
            }
            UppaalSymbol::Clock(_) => fault(e.span, "this is an array of clocks: an index is missing"),
            other => fault(e.span, format!("expected a clock, found {}", other.noun())),
        }
    }

    /// What a clock is set to.
    pub fn setting(&mut self, e: &UppaalExpr) -> Result<String, UppaalFault> {
        let mut sum = UppaalClockSum::default();
        self.add(e, 1, &mut sum)?;
        let value = time(&sum.terms, e.span)?;
        let numbers = sum.terms.iter().map(|(sign, term)| term.value.map(|n| sign * n));
        if sum.clocks.is_empty() && numbers.sum::<Option<i64>>().is_some_and(|n| n < 0) {
            return fault(e.span, "a clock is set to a number of at least 0");
        }
        match sum.clocks.as_slice() {
            [] => Ok(if value == "0 s" { "0".to_owned() } else { value }),
            [(1, from)] if value == "0 s" => Ok(from.clone()),
            [(1, from)] => Ok(format!("{from} + {value}")),
            _ => fault(e.span, "a clock is set to a number, or to another clock plus a number"),
        }
    }

    /// A condition of a query, in which clocks may stand under `or` and `not`.
    pub fn formula(&mut self, e: &UppaalExpr) -> Result<ScenarioExprText, UppaalFault> {
        if !self.mentions_clock(e) {
            return self.condition(e);
        }
        match &e.kind {
            UppaalExprKind::Not(of) => self.formula(of).map(|of| not(&of)),
            UppaalExprKind::Binary(UppaalBinaryOperator::And, a, b) => {
                let parts = [self.formula(a)?, self.formula(b)?];
                Ok(all(parts.into_iter()))
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Or, a, b) => {
                let parts = [self.formula(a)?, self.formula(b)?];
                Ok(super::expr::any(parts.into_iter()))
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Imply, a, b) => {
                Ok(super::expr::implied(&self.formula(a)?, &self.formula(b)?))
            }
            UppaalExprKind::Quantified(UppaalQuantifier::Forall, name, ty, of) => {
                Ok(all(self.parts(name, ty, |cx| cx.formula(of))?.into_iter()))
            }
            UppaalExprKind::Quantified(UppaalQuantifier::Exists, name, ty, of) => {
                Ok(super::expr::any(self.parts(name, ty, |cx| cx.formula(of))?.into_iter()))
            }
            _ => {
                // Which clock an index chooses is a part of what is asked.
                let parts = self.every_case(e.span, false, |cx| {
                    let mut parts = cx.split(e, true)?;
                    let asked = cx.cases.as_mut().map(|cases| std::mem::take(&mut cases.conditions));
                    parts.iter_mut().for_each(|part| part.data.extend(asked.iter().flatten().cloned()));
                    Ok(parts)
                })?;
                let parts = parts.concat();
                let text = |c: &GuardConjunction| {
                    let level = if c.clocks.len() + c.data.len() > 1 {
                        ScenarioPrecedence::And
                    } else {
                        ScenarioPrecedence::Comparison
                    };
                    c.text().map_or_else(
                        || ScenarioExprText::bool(false),
                        |t| ScenarioExprText::new(t, level, true),
                    )
                };
                Ok(super::expr::any(parts.iter().map(text)))
            }
        }
    }
}

/// All of these together, or one of them.
fn combine(
    parts: Vec<Vec<GuardConjunction>>,
    together: bool,
    span: Span,
) -> Result<Vec<GuardConjunction>, UppaalFault> {
    let mut out: Vec<GuardConjunction> =
        if together { vec![GuardConjunction::default()] } else { Vec::new() };
    for part in parts {
        if together {
            let with = |a: &GuardConjunction, b: &GuardConjunction| GuardConjunction {
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
fn time(terms: &[(i64, ScenarioExprText)], span: Span) -> Result<String, UppaalFault> {
    let known = terms.iter().map(|(s, t)| t.value.map(|n| s * n)).collect::<Option<Vec<_>>>();
    let sum = known.as_ref().map(|all| all.iter().fold(0, |sum: i64, n| sum.saturating_add(*n)));
    let numbers = terms.iter().filter_map(|(_, t)| t.value);
    match sum.map_or_else(|| numbers.into_iter().find_map(too_long), too_long) {
        Some(message) => fault(span, message),
        None => Ok(written_time(terms, sum)),
    }
}

/// The text of a time, whose number of seconds may be known.
fn written_time(terms: &[(i64, ScenarioExprText)], sum: Option<i64>) -> String {
    if let Some(sum) = sum {
        // The name of a constant says more than its number.
        if let [(1, only)] = terms
            && only.level == ScenarioPrecedence::Atom
            && only.text.parse::<i64>().is_err()
        {
            return format!("{} * 1 s", only.text);
        }
        return format!("{sum} s");
    }
    let mut text = String::new();
    for (sign, term) in terms {
        let shown = match term.value {
            Some(n) => format!("{n} s"),
            None => format!("{} * 1 s", term.at(ScenarioPrecedence::Atom)),
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
enum UppaalClockComparison {
    Lt,
    Le,
    Eq,
    Ge,
    Gt,
    Ne,
}

impl UppaalClockComparison {
    fn of(op: UppaalBinaryOperator) -> Option<Self> {
        Some(match op {
            UppaalBinaryOperator::Lt => Self::Lt,
            UppaalBinaryOperator::Le => Self::Le,
            UppaalBinaryOperator::Eq => Self::Eq,
            UppaalBinaryOperator::Ge => Self::Ge,
            UppaalBinaryOperator::Gt => Self::Gt,
            UppaalBinaryOperator::Ne => Self::Ne,
            UppaalBinaryOperator::Add
            | UppaalBinaryOperator::Sub
            | UppaalBinaryOperator::Mul
            | UppaalBinaryOperator::Div
            | UppaalBinaryOperator::Rem
            | UppaalBinaryOperator::Min
            | UppaalBinaryOperator::Max
            | UppaalBinaryOperator::And
            | UppaalBinaryOperator::Or
            | UppaalBinaryOperator::Imply
            | UppaalBinaryOperator::BitAnd
            | UppaalBinaryOperator::BitOr
            | UppaalBinaryOperator::BitXor
            | UppaalBinaryOperator::ShiftLeft
            | UppaalBinaryOperator::ShiftRight => return None,
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

    /// Whether a sum of numbers compares so with 0.
    fn of_numbers(self, terms: &[(i64, ScenarioExprText)]) -> ScenarioExprText {
        if let Some(all) = terms.iter().map(|(s, t)| t.value.map(|n| s * n)).collect::<Option<Vec<_>>>() {
            let sum: i64 = all.iter().sum();
            return ScenarioExprText::bool(match self {
                Self::Lt => sum < 0,
                Self::Le => sum <= 0,
                Self::Eq => sum == 0,
                Self::Ge => sum >= 0,
                Self::Gt => sum > 0,
                Self::Ne => sum != 0,
            });
        }
        let sum = terms.iter().fold("0".to_owned(), |text, (sign, term)| {
            let sign = if *sign < 0 { "-" } else { "+" };
            format!("{text} {sign} {}", term.at(ScenarioPrecedence::Product))
        });
        ScenarioExprText::new(format!("{sum} {} 0", self.text()), ScenarioPrecedence::Comparison, true)
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
