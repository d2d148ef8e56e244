//! XacroArithmetic and comparison, with Python's rules for whole numbers, numbers and texts.

use std::cmp::Ordering;

use super::{
    syntax::{XacroArithmetic, XacroComparison},
    value::{EvalFault, EvalResult, XacroValue, wrong},
};
use crate::{fault::RobotFaultKind, limits::MOST_VALUE_SIZE};

pub(super) fn arithmetic(
    operator: XacroArithmetic,
    a: &XacroValue,
    b: &XacroValue,
) -> EvalResult<XacroValue> {
    if let (Some(x), Some(y)) = (a.whole(), b.whole()) {
        return whole(operator, x, y);
    }
    if let (Some(x), Some(y)) = (a.number(), b.number()) {
        return float(operator, x, y).map(XacroValue::Float);
    }
    match (operator, a, b) {
        (XacroArithmetic::Add, XacroValue::Text(x), XacroValue::Text(y)) => {
            XacroValue::text(format!("{x}{y}"))
        }
        (XacroArithmetic::Add, XacroValue::List(x), XacroValue::List(y)) => {
            XacroValue::list(x.iter().chain(y.iter()).cloned().collect())
        }
        (XacroArithmetic::Add, XacroValue::Tuple(x), XacroValue::Tuple(y)) => {
            XacroValue::tuple(x.iter().chain(y.iter()).cloned().collect())
        }
        (XacroArithmetic::Multiply, many, count) | (XacroArithmetic::Multiply, count, many)
            if count.whole().is_some() && many.whole().is_none() =>
        {
            repeated(many, count.whole().unwrap_or_default())
        }
        _ => {
            let help = match (a, b) {
                (XacroValue::Text(_), _) | (_, XacroValue::Text(_)) => {
                    "convert one of them: `str(x)`, `float(x)`"
                }
                _ => "use numbers",
            };
            wrong(format!("`{}` cannot join {} and {}", operator.sign(), a.noun(), b.noun()), help)
        }
    }
}

fn repeated(many: &XacroValue, count: i64) -> EvalResult<XacroValue> {
    let count = usize::try_from(count).unwrap_or_default();
    let all = |items: &[XacroValue]| -> EvalResult<Vec<XacroValue>> {
        if items.len().saturating_mul(count) > MOST_VALUE_SIZE {
            return too_much("values of a list");
        }
        Ok(std::iter::repeat_n(items, count).flatten().cloned().collect())
    };
    match many {
        XacroValue::Text(text) if text.len().saturating_mul(count) > MOST_VALUE_SIZE => {
            too_much("bytes of a text")
        }
        XacroValue::Text(text) => XacroValue::text(text.repeat(count)),
        XacroValue::List(items) => XacroValue::list(all(items.as_slice())?),
        XacroValue::Tuple(items) => XacroValue::tuple(all(items.as_slice())?),
        XacroValue::None
        | XacroValue::Bool(_)
        | XacroValue::Int(_)
        | XacroValue::Float(_)
        | XacroValue::Dict(_)
        | XacroValue::Function(_) => {
            wrong(format!("`*` cannot join {} and a whole number", many.noun()), "use numbers")
        }
    }
}

fn too_much<T>(what: &'static str) -> EvalResult<T> {
    let kind = RobotFaultKind::TooMuch { what, limit: MOST_VALUE_SIZE };
    Err(EvalFault::new(kind, "repeat it less often"))
}

fn by_zero<T>() -> EvalResult<T> {
    wrong("something is divided by 0", "ask before: `a / b if b else 0`")
}

fn whole(operator: XacroArithmetic, a: i64, b: i64) -> EvalResult<XacroValue> {
    let result = match operator {
        XacroArithmetic::Add => a.checked_add(b),
        XacroArithmetic::Subtract => a.checked_sub(b),
        XacroArithmetic::Multiply => a.checked_mul(b),
        XacroArithmetic::Divide | XacroArithmetic::FloorDivide | XacroArithmetic::Modulo if b == 0 => {
            return by_zero();
        }
        XacroArithmetic::Divide => return Ok(XacroValue::Float(a as f64 / b as f64)),
        XacroArithmetic::FloorDivide => a.checked_rem(b).map(|rest| {
            let quotient = (a - rest) / b;
            quotient - i64::from(rest != 0 && (rest < 0) != (b < 0))
        }),
        XacroArithmetic::Modulo => {
            a.checked_rem(b).map(|rest| if rest != 0 && (rest < 0) != (b < 0) { rest + b } else { rest })
        }
        XacroArithmetic::Power if b < 0 => return float(operator, a as f64, b as f64).map(XacroValue::Float),
        XacroArithmetic::Power => match (a, u32::try_from(b)) {
            (0 | 1, _) => Some(if b == 0 { 1 } else { a }),
            (-1, _) => Some(if b % 2 == 0 { 1 } else { -1 }),
            (_, Ok(exponent)) => a.checked_pow(exponent),
            (_, Err(_)) => None,
        },
    };
    match result {
        Some(number) => Ok(XacroValue::Int(number)),
        None => wrong("a whole number is larger than 64 bits", "compute with points: `2.0 ** 80`"),
    }
}

fn float(operator: XacroArithmetic, a: f64, b: f64) -> EvalResult<f64> {
    Ok(match operator {
        XacroArithmetic::Add => a + b,
        XacroArithmetic::Subtract => a - b,
        XacroArithmetic::Multiply => a * b,
        XacroArithmetic::Divide | XacroArithmetic::FloorDivide | XacroArithmetic::Modulo if b == 0.0 => {
            return by_zero();
        }
        XacroArithmetic::Divide => a / b,
        XacroArithmetic::FloorDivide => floor_and_rest(a, b).0,
        XacroArithmetic::Modulo => floor_and_rest(a, b).1,
        XacroArithmetic::Power => {
            if a == 0.0 && b < 0.0 {
                return by_zero();
            }
            if a < 0.0 && a.is_finite() && b.is_finite() && libm::floor(b) != b {
                return wrong("a negative number has no such root", "take `abs(x)`");
            }
            let power = libm::pow(a, b);
            if power.is_infinite() && a.is_finite() && b.is_finite() {
                return wrong("a power is too large", "compute with smaller numbers");
            }
            power
        }
    })
}

/// Python's `divmod`: the rest has the sign of the divisor.
fn floor_and_rest(a: f64, b: f64) -> (f64, f64) {
    let rest = libm::fmod(a, b);
    let mut quotient = (a - rest) / b;
    let rest = if rest == 0.0 {
        libm::copysign(0.0, b)
    } else if (rest < 0.0) != (b < 0.0) {
        quotient -= 1.0;
        rest + b
    } else {
        rest
    };
    if quotient == 0.0 {
        return (libm::copysign(0.0, a / b), rest);
    }
    let floor = libm::floor(quotient);
    (if quotient - floor > 0.5 { floor + 1.0 } else { floor }, rest)
}

/// `a == b`: numbers by value, whatever their kind.
pub(super) fn equal(a: &XacroValue, b: &XacroValue) -> bool {
    if let (Some(x), Some(y)) = (a.whole(), b.whole()) {
        return x == y;
    }
    if let (Some(x), Some(y)) = (a.number(), b.number()) {
        return x == y;
    }
    let all =
        |x: &[XacroValue], y: &[XacroValue]| x.len() == y.len() && x.iter().zip(y).all(|(a, b)| equal(a, b));
    match (a, b) {
        (XacroValue::None, XacroValue::None) => true,
        (XacroValue::Text(x), XacroValue::Text(y)) | (XacroValue::Function(x), XacroValue::Function(y)) => {
            x == y
        }
        (XacroValue::List(x), XacroValue::List(y)) | (XacroValue::Tuple(x), XacroValue::Tuple(y)) => {
            all(x.as_slice(), y.as_slice())
        }
        (XacroValue::Dict(x), XacroValue::Dict(y)) => {
            x.iter().count() == y.iter().count()
                && x.iter().all(|(key, value)| y.iter().any(|(k, v)| equal(k, key) && equal(v, value)))
        }
        _ => false,
    }
}

/// Which comes first; texts by their characters, lists by their first difference.
pub(super) fn order(a: &XacroValue, b: &XacroValue) -> EvalResult<Option<Ordering>> {
    if let (Some(x), Some(y)) = (a.whole(), b.whole()) {
        return Ok(Some(x.cmp(&y)));
    }
    if let (Some(x), Some(y)) = (a.number(), b.number()) {
        return Ok(x.partial_cmp(&y));
    }
    match (a, b) {
        (XacroValue::Text(x), XacroValue::Text(y)) => Ok(Some(x.cmp(y))),
        (XacroValue::List(x), XacroValue::List(y)) | (XacroValue::Tuple(x), XacroValue::Tuple(y)) => {
            for (p, q) in x.iter().zip(y.iter()) {
                if !equal(p, q) {
                    return order(p, q);
                }
            }
            Ok(Some(x.as_slice().len().cmp(&y.as_slice().len())))
        }
        _ => wrong(
            format!("{} and {} have no order", a.noun(), b.noun()),
            "compare numbers with numbers, texts with texts",
        ),
    }
}

pub(super) fn compare(comparison: XacroComparison, a: &XacroValue, b: &XacroValue) -> EvalResult<bool> {
    Ok(match comparison {
        XacroComparison::Equal => equal(a, b),
        XacroComparison::NotEqual => !equal(a, b),
        XacroComparison::Less => order(a, b)? == Some(Ordering::Less),
        XacroComparison::LessOrEqual => matches!(order(a, b)?, Some(Ordering::Less | Ordering::Equal)),
        XacroComparison::Greater => order(a, b)? == Some(Ordering::Greater),
        XacroComparison::GreaterOrEqual => matches!(order(a, b)?, Some(Ordering::Greater | Ordering::Equal)),
        XacroComparison::In => contains(b, a)?,
        XacroComparison::NotIn => !contains(b, a)?,
        XacroComparison::Is => same(a, b)?,
        XacroComparison::IsNot => !same(a, b)?,
    })
}

fn contains(all: &XacroValue, one: &XacroValue) -> EvalResult<bool> {
    match (all, one) {
        (XacroValue::Text(text), XacroValue::Text(part)) => Ok(text.contains(&**part)),
        (XacroValue::List(items) | XacroValue::Tuple(items), one) => {
            Ok(items.iter().any(|item| equal(item, one)))
        }
        (XacroValue::Dict(pairs), one) => Ok(pairs.iter().any(|(key, _)| equal(key, one))),
        _ => wrong(
            format!("nothing is `in` {}", all.noun()),
            "write a list, a dictionary or a text behind `in`",
        ),
    }
}

/// Python compares identities; only those that are values can be told apart by a description.
fn same(a: &XacroValue, b: &XacroValue) -> EvalResult<bool> {
    match (a, b) {
        (XacroValue::None, XacroValue::None) => Ok(true),
        (XacroValue::Bool(x), XacroValue::Bool(y)) => Ok(x == y),
        (XacroValue::None | XacroValue::Bool(_), _) | (_, XacroValue::None | XacroValue::Bool(_)) => {
            Ok(false)
        }
        _ => wrong("`is` compares only with None, True and False", "write `==`"),
    }
}
