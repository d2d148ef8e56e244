//! Functions of numbers, called as internal actions: the powers, roots, angles and means of agents.
//!
//! Those that have no exact result are computed without the machine's library, so that they are the same everywhere.

use serde::{Deserialize, Serialize};

use crate::{eval_error::EvalError, list::order, value::Value};

/// A function of numbers, or of a list of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RealFunction {
    /// `(x, y)`: x to the power of y.
    Power,
    Sqrt,
    /// The greatest whole number that is not above it.
    Floor,
    Ceil,
    /// The nearest whole number; of two the greater.
    Round,
    /// The natural logarithm.
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// Of a list; whole if all its numbers are.
    Sum,
    /// Of a list, as the others below; none of an empty one.
    Mean,
    Median,
    /// The standard deviation of a sample; none of less than two numbers.
    StdDev,
}

impl RealFunction {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Power,
        Self::Sqrt,
        Self::Floor,
        Self::Ceil,
        Self::Round,
        Self::Log,
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Sum,
        Self::Mean,
        Self::Median,
        Self::StdDev,
    ];

    /// As it is called, without its dot.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Sqrt => "sqrt",
            Self::Floor => "floor",
            Self::Ceil => "ceil",
            Self::Round => "round",
            Self::Log => "log",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sum => "sum",
            Self::Mean => "mean",
            Self::Median => "median",
            Self::StdDev => "std_dev",
        }
    }

    /// Whether it takes a list.
    #[must_use]
    pub fn is_of_list(self) -> bool {
        match self {
            Self::Sum | Self::Mean | Self::Median | Self::StdDev => true,
            Self::Power
            | Self::Sqrt
            | Self::Floor
            | Self::Ceil
            | Self::Round
            | Self::Log
            | Self::Sin
            | Self::Cos
            | Self::Tan
            | Self::Asin
            | Self::Acos
            | Self::Atan => false,
        }
    }

    /// Whether its result is always whole.
    #[must_use]
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Floor | Self::Ceil | Self::Round)
    }
}

/// Applies a function; `None` if it has no value for these arguments.
///
/// # Errors
/// `Type` if the arguments are of other types, or too few; `Overflow` if a whole number is too large.
pub fn apply_real(f: RealFunction, args: &[Value]) -> Result<Option<Value>, EvalError> {
    match args {
        [Value::List(list)] if f.is_of_list() => {
            let all: Vec<Value> = list.iter().collect();
            of_list(f, &all)
        }
        [x, y] if f == RealFunction::Power => Ok(Some(Value::Float(libm::pow(number(*x)?, number(*y)?)))),
        [x] => of_number(f, *x).map(Some),
        _ => Err(EvalError::Type),
    }
}

fn number(value: Value) -> Result<f64, EvalError> {
    match value {
        Value::Int(n) => Ok(n as f64),
        Value::Float(x) => Ok(x),
        Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => Err(EvalError::Type),
    }
}

fn of_number(f: RealFunction, value: Value) -> Result<Value, EvalError> {
    if let (Value::Int(_), true) = (value, f.is_whole()) {
        return Ok(value);
    }
    let x = number(value)?;
    Ok(match f {
        RealFunction::Floor => whole(libm::floor(x))?,
        RealFunction::Ceil => whole(libm::ceil(x))?,
        RealFunction::Round => {
            let below = libm::floor(x);
            // The half is added to what is left, since it would be rounded away in a large number.
            whole(if x - below >= 0.5 { below + 1.0 } else { below })?
        }
        RealFunction::Sqrt => Value::Float(libm::sqrt(x)),
        RealFunction::Log => Value::Float(libm::log(x)),
        RealFunction::Sin => Value::Float(libm::sin(x)),
        RealFunction::Cos => Value::Float(libm::cos(x)),
        RealFunction::Tan => Value::Float(libm::tan(x)),
        RealFunction::Asin => Value::Float(libm::asin(x)),
        RealFunction::Acos => Value::Float(libm::acos(x)),
        RealFunction::Atan => Value::Float(libm::atan(x)),
        RealFunction::Power
        | RealFunction::Sum
        | RealFunction::Mean
        | RealFunction::Median
        | RealFunction::StdDev => return Err(EvalError::Type),
    })
}

fn whole(x: f64) -> Result<Value, EvalError> {
    // −2⁶³ is a whole number of 64 bits, 2⁶³ is not.
    let limit = 9_223_372_036_854_775_808.0;
    if (-limit..limit).contains(&x) { Ok(Value::Int(x as i64)) } else { Err(EvalError::Overflow) }
}

fn of_list(f: RealFunction, all: &[Value]) -> Result<Option<Value>, EvalError> {
    if f == RealFunction::Sum && all.iter().all(|v| matches!(v, Value::Int(_))) {
        let add = |sum: Option<i64>, v: &Value| sum?.checked_add(v.as_int()?);
        return all.iter().fold(Some(0), add).map(|n| Some(Value::Int(n))).ok_or(EvalError::Overflow);
    }
    let numbers = all.iter().map(|v| number(*v)).collect::<Result<Vec<f64>, _>>()?;
    let count = numbers.len() as f64;
    let sum: f64 = numbers.iter().fold(0.0, |sum, x| sum + x);
    Ok(match f {
        RealFunction::Sum => Some(sum),
        RealFunction::Mean => (!numbers.is_empty()).then(|| sum / count),
        RealFunction::Median => median(all),
        RealFunction::StdDev => (numbers.len() > 1).then(|| {
            let mean = sum / count;
            let squares = numbers.iter().fold(0.0, |sum, x| sum + (x - mean) * (x - mean));
            libm::sqrt(squares / (count - 1.0))
        }),
        RealFunction::Power
        | RealFunction::Sqrt
        | RealFunction::Floor
        | RealFunction::Ceil
        | RealFunction::Round
        | RealFunction::Log
        | RealFunction::Sin
        | RealFunction::Cos
        | RealFunction::Tan
        | RealFunction::Asin
        | RealFunction::Acos
        | RealFunction::Atan => return Err(EvalError::Type),
    }
    .map(Value::Float))
}

/// The middle one in order; of an even number the mean of the middle two.
fn median(all: &[Value]) -> Option<f64> {
    let mut sorted = all.to_vec();
    sorted.sort_by(|a, b| order(*a, *b));
    let at = |i: usize| sorted.get(i).and_then(|v| number(*v).ok());
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 { at(middle) } else { Some((at(middle.checked_sub(1)?)? + at(middle)?) / 2.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::List;

    fn of(f: RealFunction, args: &[Value]) -> Option<String> {
        apply_real(f, args).unwrap().map(|v| v.to_string())
    }

    #[test]
    fn functions_of_numbers_do_what_their_names_say() {
        use RealFunction as F;
        let (int, float) = (Value::Int, Value::Float);
        let some = |t: &str| Some(t.to_owned());
        assert_eq!(of(F::Power, &[int(2), int(10)]), some("1024"));
        assert_eq!(of(F::Power, &[int(2), int(-1)]), some("0.5"));
        assert_eq!(of(F::Sqrt, &[int(16)]), some("4"));
        assert_eq!((of(F::Floor, &[float(-2.5)]), of(F::Ceil, &[float(-2.5)])), (some("-3"), some("-2")));
        assert_eq!((of(F::Round, &[float(2.5)]), of(F::Round, &[float(-2.5)])), (some("3"), some("-2")));
        assert_eq!(of(F::Round, &[float(0.499_999_999_999_999_94)]), some("0"));
        assert_eq!(of(F::Floor, &[int(7)]), some("7"));
        assert_eq!(of(F::Atan, &[int(0)]), some("0"));
        assert_eq!(apply_real(F::Floor, &[float(1e300)]), Err(EvalError::Overflow));
        assert_eq!(apply_real(F::Floor, &[float(f64::NAN)]), Err(EvalError::Overflow));
        assert_eq!(apply_real(F::Sqrt, &[Value::Bool(true)]), Err(EvalError::Type));
        assert_eq!(apply_real(F::Sqrt, &[int(1), int(1)]), Err(EvalError::Type));
    }

    #[test]
    fn functions_of_lists_of_numbers_do_so_too() {
        use RealFunction as F;
        let list = |all: &[f64]| {
            let values: Vec<Value> = all.iter().map(|x| Value::Float(*x)).collect();
            Value::List(List::of(&values))
        };
        let ints = Value::List(List::of(&[Value::Int(4), Value::Int(1), Value::Int(1)]));
        assert_eq!(of(F::Sum, &[ints]), Some("6".into()));
        assert_eq!(apply_real(F::Sum, &[ints]), Ok(Some(Value::Int(6))));
        assert_eq!(of(F::Sum, &[list(&[0.5, 1.0])]), Some("1.5".into()));
        assert_eq!(of(F::Mean, &[ints]), Some("2".into()));
        assert_eq!(
            (of(F::Median, &[ints]), of(F::Median, &[list(&[3.0, 1.0])])),
            (Some("1".into()), Some("2".into()))
        );
        assert_eq!(of(F::StdDev, &[list(&[1.0, 2.0, 3.0])]), Some("1".into()));
        for f in [F::Mean, F::Median, F::StdDev] {
            assert_eq!(apply_real(f, &[list(&[])]), Ok(None));
        }
        let most = Value::List(List::of(&[Value::Int(i64::MAX), Value::Int(1)]));
        assert_eq!(apply_real(F::Sum, &[most]), Err(EvalError::Overflow));
    }
}
