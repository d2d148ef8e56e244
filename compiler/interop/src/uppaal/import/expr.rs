//! Expressions: what they are in the scenario. Bools and numbers, which UPPAAL mixes, are told apart.

use hrdsl_source::Span;

use super::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind, UppaalQuantifier, UppaalType},
    fault::{UppaalFault, fault},
    scope::{
        ChanSym, ScenarioExprText, ScenarioPrecedence, UppaalScalarType, UppaalScope, UppaalSymbol,
        UppaalSymbolType,
    },
    translation::UppaalTranslation,
};
use crate::exchange::note::NoteSeverity;

/// How many parts `forall`, `exists` and `sum` may become.
const MAX_PARTS: i64 = 1024;

/// How many parts stand one after the other without parentheses.
const MAX_IN_A_ROW: usize = 200;

impl UppaalTranslation<'_> {
    pub fn find(&self, name: &str) -> Option<&UppaalSymbol> {
        let scopes = self.locals.iter().rev().chain(&self.process).chain([&self.global]);
        scopes.into_iter().find_map(|s| s.get(name))
    }

    /// A constant number.
    pub fn constant(&mut self, e: &UppaalExpr) -> Result<i64, UppaalFault> {
        match self.expr(e)?.value {
            Some(n) => Ok(n),
            None => fault(e.span, "this must be constant"),
        }
    }

    pub fn condition(&mut self, e: &UppaalExpr) -> Result<ScenarioExprText, UppaalFault> {
        if let UppaalExprKind::Quantified(UppaalQuantifier::Sum, _, _, of) = &e.kind
            && let UppaalExprKind::Binary(op, ..) = &of.kind
            && op.compares()
        {
            let message = "this counts for how many values the comparison holds, and is met by one: `sum` goes as far \
                as it can; to compare the sum itself, write it in parentheses: `(sum(…) …) <= …`";
            self.notes.push((e.span, NoteSeverity::Warning, message.to_owned()));
        }
        Ok(self.expr(e)?.into_bool())
    }

    pub fn expr(&mut self, e: &UppaalExpr) -> Result<ScenarioExprText, UppaalFault> {
        match &e.kind {
            UppaalExprKind::Int(n) => Ok(ScenarioExprText::int(*n)),
            UppaalExprKind::Bool(b) => Ok(ScenarioExprText::bool(*b)),
            UppaalExprKind::Name(_) | UppaalExprKind::Index(..) | UppaalExprKind::Field(..) => self.read(e),
            UppaalExprKind::Neg(of) => self.negative(of),
            UppaalExprKind::Not(of) => {
                let of = self.condition(of)?;
                Ok(not(&of))
            }
            UppaalExprKind::Binary(op, a, b) => self.binary(*op, a, b, e.span),
            UppaalExprKind::Choice(c, a, b) => self.choice(c, a, b),
            UppaalExprKind::Call(of, args) if self.is_abs(of, args) => {
                let of = args.iter().map(|a| self.expr(a)).collect::<Result<Vec<_>, _>>()?;
                Ok(absolute(of.into_iter().next().unwrap_or_else(|| ScenarioExprText::int(0)).into_int()))
            }
            UppaalExprKind::Call(of, args) => self.call(of, args, e.span).and_then(|(text, result)| {
                let Some(result) = result else {
                    return fault(e.span, "this function has no value (`void`)");
                };
                Ok(ScenarioExprText::new(text, ScenarioPrecedence::Atom, result.is_bool))
            }),
            UppaalExprKind::Quantified(q, name, ty, of) => self.quantified(*q, name, ty, of),
            UppaalExprKind::Assign(..) => fault(
                e.span,
                "an assignment within an expression is not supported: write it before, \
                 or put parentheses around what is assigned (`and`, `or` and `not` bind looser than `=`)",
            ),
            UppaalExprKind::Step { .. } => fault(
                e.span,
                "`++` and `--` within an expression are not supported: write them as an assignment of their own",
            ),
            UppaalExprKind::Rate(_) => {
                fault(e.span, "the rate of a clock (`x'`) is a part of invariants only")
            }
            UppaalExprKind::Deadlock if self.in_query => {
                Ok(ScenarioExprText::new("deadlock".to_owned(), ScenarioPrecedence::Atom, true))
            }
            UppaalExprKind::Deadlock => fault(e.span, "`deadlock` may be asked in queries only"),
        }
    }

    /// `abs(n)`, if the model does not declare another `abs`.
    pub fn is_abs(&self, of: &UppaalExpr, args: &[UppaalExpr]) -> bool {
        args.len() == 1
            && matches!(&of.kind, UppaalExprKind::Name(name) if name == "abs")
            && self.find("abs").is_none()
    }

    fn negative(&mut self, of: &UppaalExpr) -> Result<ScenarioExprText, UppaalFault> {
        let of = self.expr(of)?.into_int();
        if let Some(n) = of.value.filter(|_| of.text.bytes().all(|b| b.is_ascii_digit())) {
            return Ok(ScenarioExprText::int(-n));
        }
        let text = format!("-{}", of.at(ScenarioPrecedence::Atom));
        Ok(ScenarioExprText {
            value: of.value.map(|n| -n),
            ..ScenarioExprText::new(text, ScenarioPrecedence::Factor, false)
        })
    }

    fn choice(
        &mut self,
        c: &UppaalExpr,
        a: &UppaalExpr,
        b: &UppaalExpr,
    ) -> Result<ScenarioExprText, UppaalFault> {
        let c = self.condition(c)?;
        let (a, b) = (self.expr(a)?, self.expr(b)?);
        let is_bool = a.is_bool && b.is_bool;
        let (a, b) = (a.of_type(is_bool), b.of_type(is_bool));
        if let Some(c) = c.value {
            return Ok(if c != 0 { a } else { b });
        }
        let text = format!("if {} {{ {} }} else {{ {} }}", c.text, a.text, b.text);
        Ok(ScenarioExprText::new(text, ScenarioPrecedence::Atom, is_bool))
    }

    fn binary(
        &mut self,
        op: UppaalBinaryOperator,
        a: &UppaalExpr,
        b: &UppaalExpr,
        span: Span,
    ) -> Result<ScenarioExprText, UppaalFault> {
        if let Some(same) = self.same_records(op, a, b, span)? {
            return Ok(same);
        }
        let (a, b) = (self.expr(a)?, self.expr(b)?);
        let both_bools = a.is_bool && b.is_bool;
        if op.is_on_bits() {
            return self.on_bits(op, a.into_int(), b.into_int(), span);
        }
        let (sign, level, of_bools) = signs(op, both_bools);
        let (a, b) = (a.of_type(of_bools), b.of_type(of_bools));
        let value = a.value.zip(b.value).map(|(a, b)| fold(op, a, b, span)).transpose()?;
        if op == UppaalBinaryOperator::Imply {
            return Ok(implied(&a, &b));
        }
        if value.is_none() && matches!(op, UppaalBinaryOperator::And | UppaalBinaryOperator::Or) {
            let both = [a, b].into_iter();
            return Ok(if op == UppaalBinaryOperator::And { all(both) } else { any(both) });
        }
        let is_bool = level <= ScenarioPrecedence::Comparison;
        let text = match op {
            UppaalBinaryOperator::Min | UppaalBinaryOperator::Max => {
                format!("{sign}({}, {})", a.text, b.text)
            }
            UppaalBinaryOperator::BitAnd
            | UppaalBinaryOperator::BitOr
            | UppaalBinaryOperator::BitXor
            | UppaalBinaryOperator::ShiftLeft
            | UppaalBinaryOperator::ShiftRight
            | UppaalBinaryOperator::Imply => String::new(),
            UppaalBinaryOperator::Or
            | UppaalBinaryOperator::And
            | UppaalBinaryOperator::Add
            | UppaalBinaryOperator::Mul => {
                format!("{} {sign} {}", a.at(level), b.at(level))
            }
            UppaalBinaryOperator::Sub | UppaalBinaryOperator::Div => {
                format!("{} {sign} {}", a.at(level), b.at(next(level)))
            }
            // After `%` a sign is not the beginning of an operand.
            UppaalBinaryOperator::Rem => format!("{} % {}", a.at(level), b.at(ScenarioPrecedence::Atom)),
            UppaalBinaryOperator::Eq
            | UppaalBinaryOperator::Ne
            | UppaalBinaryOperator::Lt
            | UppaalBinaryOperator::Le
            | UppaalBinaryOperator::Gt
            | UppaalBinaryOperator::Ge => {
                format!("{} {sign} {}", a.at(ScenarioPrecedence::Sum), b.at(ScenarioPrecedence::Sum))
            }
        };
        Ok(ScenarioExprText { text, level, is_bool, value })
    }

    fn quantified(
        &mut self,
        q: UppaalQuantifier,
        name: &str,
        ty: &UppaalType,
        of: &UppaalExpr,
    ) -> Result<ScenarioExprText, UppaalFault> {
        let parts = self.parts(name, ty, |cx| cx.expr(of))?;
        if q == UppaalQuantifier::Sum {
            let parts = parts.into_iter().map(ScenarioExprText::into_int);
            return Ok(joined(
                parts.collect(),
                "+",
                ScenarioPrecedence::Sum,
                ScenarioExprText::int(0),
                &|a, b| a.checked_add(b),
            ));
        }
        let parts = parts.into_iter().map(ScenarioExprText::into_bool);
        Ok(if q == UppaalQuantifier::Forall { all(parts) } else { any(parts) })
    }

    /// What is made of each value of a type.
    pub fn parts<T>(
        &mut self,
        name: &str,
        ty: &UppaalType,
        make: impl Fn(&mut Self) -> Result<T, UppaalFault>,
    ) -> Result<Vec<T>, UppaalFault> {
        let scalar = self.scalar(ty)?;
        if scalar.hi - scalar.lo >= MAX_PARTS {
            return fault(ty.span, format!("this has more than {MAX_PARTS} values"));
        }
        let mut parts = Vec::new();
        for n in scalar.lo..=scalar.hi {
            self.locals
                .push(UppaalScope::from_iter([(name.to_owned(), UppaalSymbol::Const(scalar.literal(n)))]));
            let part = make(self);
            self.locals.pop();
            parts.push(part?);
        }
        Ok(parts)
    }

    // ── Types ──

    /// The type of single values.
    pub fn scalar(&mut self, ty: &UppaalType) -> Result<UppaalScalarType, UppaalFault> {
        match self.ty(ty)? {
            UppaalSymbolType::Data(scalar, dims) if dims.is_empty() => Ok(scalar),
            UppaalSymbolType::Data(..)
            | UppaalSymbolType::Clock(_)
            | UppaalSymbolType::Chan { .. }
            | UppaalSymbolType::Record(..)
            | UppaalSymbolType::Void => {
                fault(ty.span, "expected a type of single values: `bool`, or integers of a range")
            }
        }
    }

    pub fn channel<'s>(&mut self, sym: &'s UppaalSymbol, span: Span) -> Result<&'s ChanSym, UppaalFault> {
        match sym {
            UppaalSymbol::Chan(c) if c.dims.is_empty() => Ok(c),
            UppaalSymbol::Chan(c) => {
                fault(span, format!("`{}` is an array of channels: an index is missing", c.name))
            }
            other => fault(span, format!("expected a channel, found {}", other.noun())),
        }
    }
}

fn next(level: ScenarioPrecedence) -> ScenarioPrecedence {
    match level {
        ScenarioPrecedence::Sum => ScenarioPrecedence::Product,
        ScenarioPrecedence::Product => ScenarioPrecedence::Factor,
        ScenarioPrecedence::Imply
        | ScenarioPrecedence::Or
        | ScenarioPrecedence::And
        | ScenarioPrecedence::Not
        | ScenarioPrecedence::Comparison
        | ScenarioPrecedence::Factor
        | ScenarioPrecedence::Atom => ScenarioPrecedence::Atom,
    }
}

pub fn not(of: &ScenarioExprText) -> ScenarioExprText {
    match of.value {
        Some(n) => ScenarioExprText::bool(n == 0),
        None => ScenarioExprText::new(
            format!("not {}", of.at(ScenarioPrecedence::Atom)),
            ScenarioPrecedence::Not,
            true,
        ),
    }
}

/// `a imply b`, as far as it is not certain.
pub fn implied(a: &ScenarioExprText, b: &ScenarioExprText) -> ScenarioExprText {
    match (a.value, b.value) {
        (Some(0), _) => ScenarioExprText::bool(true),
        (Some(_), _) => b.clone(),
        (None, Some(0)) => not(a),
        (None, Some(_)) => ScenarioExprText::bool(true),
        (None, None) => {
            let text = format!("{} imply {}", a.at(ScenarioPrecedence::Or), b.at(ScenarioPrecedence::Or));
            ScenarioExprText::new(text, ScenarioPrecedence::Imply, true)
        }
    }
}

fn joined(
    parts: Vec<ScenarioExprText>,
    sign: &str,
    level: ScenarioPrecedence,
    none: ScenarioExprText,
    fold: &dyn Fn(i64, i64) -> Option<i64>,
) -> ScenarioExprText {
    if parts.len() > MAX_IN_A_ROW {
        // In groups, since an expression may not be higher than some hundred levels.
        let groups = parts.chunks(MAX_IN_A_ROW).map(|group| {
            let group = joined(group.to_vec(), sign, level, none.clone(), fold);
            ScenarioExprText { level: ScenarioPrecedence::Imply, ..group }
        });
        let groups: Vec<ScenarioExprText> = groups.collect();
        return joined(groups, sign, level, none, fold);
    }
    parts
        .into_iter()
        .reduce(|a, b| {
            let value = a.value.zip(b.value).and_then(|(a, b)| fold(a, b));
            let text = format!("{} {sign} {}", a.at(level), b.at(level));
            ScenarioExprText { value, ..ScenarioExprText::new(text, level, none.is_bool) }
        })
        .unwrap_or(none)
}

/// The conjunction; what is certainly true is left out.
pub fn all(parts: impl Iterator<Item = ScenarioExprText>) -> ScenarioExprText {
    let parts: Vec<ScenarioExprText> = parts.filter(|p| p.value != Some(1)).collect();
    match parts.iter().find(|p| p.value == Some(0)) {
        Some(_) => ScenarioExprText::bool(false),
        None => {
            joined(parts, "&&", ScenarioPrecedence::And, ScenarioExprText::bool(true), &|a, b| Some(a & b))
        }
    }
}

/// The disjunction; what is certainly false is left out.
pub fn any(parts: impl Iterator<Item = ScenarioExprText>) -> ScenarioExprText {
    let parts: Vec<ScenarioExprText> = parts.filter(|p| p.value != Some(0)).collect();
    match parts.iter().find(|p| p.value == Some(1)) {
        Some(_) => ScenarioExprText::bool(true),
        None => {
            joined(parts, "||", ScenarioPrecedence::Or, ScenarioExprText::bool(false), &|a, b| Some(a | b))
        }
    }
}

/// How an operator is written, how tightly it binds, and whether it is one of bools.
fn signs(op: UppaalBinaryOperator, both_bools: bool) -> (&'static str, ScenarioPrecedence, bool) {
    match op {
        UppaalBinaryOperator::Or => ("||", ScenarioPrecedence::Or, true),
        UppaalBinaryOperator::And => ("&&", ScenarioPrecedence::And, true),
        UppaalBinaryOperator::Imply => ("imply", ScenarioPrecedence::Imply, true),
        UppaalBinaryOperator::Eq => ("==", ScenarioPrecedence::Comparison, both_bools),
        UppaalBinaryOperator::Ne => ("!=", ScenarioPrecedence::Comparison, both_bools),
        UppaalBinaryOperator::Lt => ("<", ScenarioPrecedence::Comparison, false),
        UppaalBinaryOperator::Le => ("<=", ScenarioPrecedence::Comparison, false),
        UppaalBinaryOperator::Gt => (">", ScenarioPrecedence::Comparison, false),
        UppaalBinaryOperator::Ge => (">=", ScenarioPrecedence::Comparison, false),
        UppaalBinaryOperator::Add => ("+", ScenarioPrecedence::Sum, false),
        UppaalBinaryOperator::Sub => ("-", ScenarioPrecedence::Sum, false),
        UppaalBinaryOperator::Mul => ("*", ScenarioPrecedence::Product, false),
        UppaalBinaryOperator::Div => ("/", ScenarioPrecedence::Product, false),
        UppaalBinaryOperator::Rem => ("%", ScenarioPrecedence::Product, false),
        UppaalBinaryOperator::Min => ("min", ScenarioPrecedence::Atom, false),
        UppaalBinaryOperator::Max => ("max", ScenarioPrecedence::Atom, false),
        UppaalBinaryOperator::BitAnd
        | UppaalBinaryOperator::BitOr
        | UppaalBinaryOperator::BitXor
        | UppaalBinaryOperator::ShiftLeft
        | UppaalBinaryOperator::ShiftRight => ("", ScenarioPrecedence::Atom, false),
    }
}

fn absolute(of: ScenarioExprText) -> ScenarioExprText {
    let out = ScenarioExprText::new(format!("abs({})", of.text), ScenarioPrecedence::Atom, false);
    of.value.map_or(out, |n| ScenarioExprText::int(n.abs()))
}

pub fn fold(op: UppaalBinaryOperator, a: i64, b: i64, span: Span) -> Result<i64, UppaalFault> {
    let value = match op {
        UppaalBinaryOperator::Add => a.checked_add(b),
        UppaalBinaryOperator::Sub => a.checked_sub(b),
        UppaalBinaryOperator::Mul => a.checked_mul(b),
        UppaalBinaryOperator::Div if b == 0 => return fault(span, "this divides by zero"),
        UppaalBinaryOperator::Rem if b == 0 => return fault(span, "this divides by zero"),
        UppaalBinaryOperator::Div => a.checked_div(b),
        UppaalBinaryOperator::Rem => a.checked_rem(b),
        UppaalBinaryOperator::Min => Some(a.min(b)),
        UppaalBinaryOperator::Max => Some(a.max(b)),
        UppaalBinaryOperator::Eq => Some(i64::from(a == b)),
        UppaalBinaryOperator::Ne => Some(i64::from(a != b)),
        UppaalBinaryOperator::Lt => Some(i64::from(a < b)),
        UppaalBinaryOperator::Le => Some(i64::from(a <= b)),
        UppaalBinaryOperator::Gt => Some(i64::from(a > b)),
        UppaalBinaryOperator::Ge => Some(i64::from(a >= b)),
        UppaalBinaryOperator::And => Some(i64::from(a != 0 && b != 0)),
        UppaalBinaryOperator::Or => Some(i64::from(a != 0 || b != 0)),
        UppaalBinaryOperator::Imply => Some(i64::from(a == 0 || b != 0)),
        UppaalBinaryOperator::BitAnd => Some(a & b),
        UppaalBinaryOperator::BitOr => Some(a | b),
        UppaalBinaryOperator::BitXor => Some(a ^ b),
        UppaalBinaryOperator::ShiftLeft | UppaalBinaryOperator::ShiftRight if !(0..32).contains(&b) => {
            return fault(span, "bits are shifted by 0 to 31 places");
        }
        UppaalBinaryOperator::ShiftLeft => Some(a << b),
        UppaalBinaryOperator::ShiftRight => Some(a >> b),
    };
    value
        .filter(|n| i32::try_from(*n).is_ok())
        .ok_or_else(|| UppaalFault { span, message: "this is larger than UPPAAL's integers".to_owned() })
}
