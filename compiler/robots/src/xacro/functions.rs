//! Functions and constants that expressions may use: those of Python's that xacro offers.

use super::{
    operate::{arithmetic, order},
    syntax::XacroArithmetic,
    value::{EvalResult, XacroValue, not_done, wrong},
    written::{number, represented, whole, written},
};
use crate::limits::MOST_VALUE_SIZE;

/// Names of Python and of its module `math` that are functions here.
const FUNCTIONS: [&str; 50] = [
    "abs",
    "acos",
    "all",
    "any",
    "asin",
    "atan",
    "atan2",
    "bool",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "degrees",
    "divmod",
    "enumerate",
    "exp",
    "fabs",
    "float",
    "floor",
    "fmod",
    "hypot",
    "int",
    "isfinite",
    "isinf",
    "isnan",
    "len",
    "list",
    "log",
    "log10",
    "log2",
    "map",
    "max",
    "min",
    "pow",
    "radians",
    "range",
    "repr",
    "reversed",
    "round",
    "sin",
    "sinh",
    "sorted",
    "sqrt",
    "str",
    "sum",
    "tan",
    "tanh",
    "trunc",
    "tuple",
    "zip",
];
/// Those of xacro's own, which need to know where they are called.
const OUTER: [&str; 6] = ["load_yaml", "abs_filename", "arg", "fatal", "warning", "message"];
/// Modules whose members are reached by a point, and directly.
const SPACES: [&str; 3] = ["math", "python", "xacro"];

/// What a name stands for that nobody declared, and how many of the names that follow each other by points it takes.
pub(super) fn global(path: &[String]) -> Option<(XacroValue, usize)> {
    let (first, rest) = path.split_first()?;
    match rest.first() {
        Some(member) if SPACES.contains(&first.as_str()) => Some((named(member)?, 2)),
        Some(_) | None => Some((named(first)?, 1)),
    }
}

fn named(name: &str) -> Option<XacroValue> {
    use std::f64::consts;
    let constant = match name {
        "pi" => Some(consts::PI),
        "tau" => Some(consts::TAU),
        "e" => Some(consts::E),
        "inf" => Some(f64::INFINITY),
        "nan" => Some(f64::NAN),
        _ => None,
    };
    let is_function = FUNCTIONS.contains(&name) || OUTER.contains(&name);
    constant.map(XacroValue::Float).or_else(|| is_function.then(|| XacroValue::Function(name.into())))
}

/// All names that `global` knows.
pub(super) fn global_names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.into_iter().chain(OUTER).chain(["pi", "tau", "e", "inf", "nan"])
}

/// Whether a function is one that whoever calls it must do.
pub(super) fn is_outer(name: &str) -> bool {
    OUTER.contains(&name)
}

fn wrong_arguments<T>(name: &str, arguments: &[XacroValue]) -> EvalResult<T> {
    let nouns: Vec<&str> = arguments.iter().map(XacroValue::noun).collect();
    let given = if nouns.is_empty() { "nothing".to_owned() } else { nouns.join(", ") };
    wrong(format!("`{name}` cannot be taken of {given}"), "look at its arguments")
}

/// Calls a function that needs to know nothing but its arguments.
pub(super) fn call(name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    let numbers: Option<Vec<f64>> = arguments.iter().map(XacroValue::number).collect();
    if let (Some(numbers), false) = (numbers, arguments.is_empty())
        && let Some(result) = of_numbers(name, &numbers)
    {
        return result;
    }
    match (name, arguments) {
        ("min" | "max", _) => extreme(name, arguments),
        ("round", _) => round(arguments),
        ("divmod", [a, b]) => {
            let parts = [XacroArithmetic::FloorDivide, XacroArithmetic::Modulo]
                .map(|operator| arithmetic(operator, a, b));
            let [quotient, rest] = parts;
            XacroValue::tuple(vec![quotient?, rest?])
        }
        ("abs", [XacroValue::Int(number)]) => match number.checked_abs() {
            Some(number) => Ok(XacroValue::Int(number)),
            None => wrong("a whole number is larger than 64 bits", "compute with points"),
        },
        ("abs", [value]) if value.number().is_some() => Ok(match value.whole() {
            Some(number) => XacroValue::Int(number),
            None => XacroValue::Float(value.number().unwrap_or_default().abs()),
        }),
        ("str", [value]) => XacroValue::text(written(value)),
        ("str", []) => XacroValue::text(""),
        ("repr", [value]) => XacroValue::text(represented(value)),
        ("bool", [value]) => Ok(XacroValue::Bool(value.is_true())),
        ("int", _) => to_whole(arguments),
        ("float", _) => to_number(arguments),
        _ => of_lists(name, arguments),
    }
}

/// Functions of `math`: of numbers only.
fn of_numbers(name: &str, numbers: &[f64]) -> Option<EvalResult<XacroValue>> {
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    const RADIANS: f64 = std::f64::consts::PI / 180.0;
    let outside = || Some(wrong(format!("`{name}` is not defined there"), "look at its argument"));
    let result = match (name, numbers) {
        ("sin" | "cos" | "tan", [x]) if x.is_infinite() => return outside(),
        ("asin" | "acos", [x]) if x.abs() > 1.0 => return outside(),
        ("sqrt", [x]) if *x < 0.0 => return outside(),
        ("log" | "log10" | "log2", [x, ..]) if *x <= 0.0 => return outside(),
        ("log", [_, base]) if *base <= 0.0 || *base == 1.0 => return outside(),
        ("fmod", [x, y]) if *y == 0.0 || x.is_infinite() => return outside(),
        ("floor" | "ceil" | "trunc", [x]) => {
            let cut = match name {
                "floor" => libm::floor(*x),
                "ceil" => libm::ceil(*x),
                _ => libm::trunc(*x),
            };
            return Some(whole_of(cut));
        }
        ("isnan", [x]) => return Some(Ok(XacroValue::Bool(x.is_nan()))),
        ("isinf", [x]) => return Some(Ok(XacroValue::Bool(x.is_infinite()))),
        ("isfinite", [x]) => return Some(Ok(XacroValue::Bool(x.is_finite()))),
        ("pow", [x, y]) => {
            return Some(arithmetic(XacroArithmetic::Power, &XacroValue::Float(*x), &XacroValue::Float(*y)));
        }
        ("sin", [x]) => libm::sin(*x),
        ("cos", [x]) => libm::cos(*x),
        ("tan", [x]) => libm::tan(*x),
        ("asin", [x]) => libm::asin(*x),
        ("acos", [x]) => libm::acos(*x),
        ("atan", [x]) => libm::atan(*x),
        ("atan2", [y, x]) => libm::atan2(*y, *x),
        ("sinh", [x]) => libm::sinh(*x),
        ("cosh", [x]) => libm::cosh(*x),
        ("tanh", [x]) => libm::tanh(*x),
        ("sqrt", [x]) => libm::sqrt(*x),
        ("exp", [x]) => libm::exp(*x),
        ("log", [x]) => libm::log(*x),
        ("log", [x, base]) => libm::log(*x) / libm::log(*base),
        ("log10", [x]) => libm::log10(*x),
        ("log2", [x]) => libm::log2(*x),
        ("fabs", [x]) => x.abs(),
        ("hypot", [x, y]) => libm::hypot(*x, *y),
        ("fmod", [x, y]) => libm::fmod(*x, *y),
        ("copysign", [x, y]) => libm::copysign(*x, *y),
        ("degrees", [x]) => x * DEGREES,
        ("radians", [x]) => x * RADIANS,
        _ => return None,
    };
    let overflows = result.is_infinite() && numbers.iter().all(|x| x.is_finite());
    Some(if overflows {
        wrong(format!("`{name}` is too large there"), "compute with smaller numbers")
    } else {
        Ok(XacroValue::Float(result))
    })
}

fn whole_of(number: f64) -> EvalResult<XacroValue> {
    // From 2^63 on no 64 bits hold it.
    if number.abs() < 9.2e18 {
        Ok(XacroValue::Int(number as i64))
    } else {
        wrong(
            format!("{} is no whole number of 64 bits", super::written::float(number)),
            "compute with smaller numbers",
        )
    }
}

fn to_whole(arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    match arguments {
        [] => Ok(XacroValue::Int(0)),
        [XacroValue::Text(text)] => match whole(text.trim()) {
            Some(number) => Ok(XacroValue::Int(number)),
            None => wrong(
                format!("`{}` is no whole number", text.escape_debug()),
                "write `int(float(x))`, or a whole number",
            ),
        },
        [XacroValue::Float(number)] => whole_of(libm::trunc(*number)),
        [one] if one.whole().is_some() => Ok(XacroValue::Int(one.whole().unwrap_or_default())),
        _ => wrong_arguments("int", arguments),
    }
}

fn to_number(arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    match arguments {
        [] => Ok(XacroValue::Float(0.0)),
        [XacroValue::Text(text)] => match number(text.trim()) {
            Some(number) => Ok(XacroValue::Float(number)),
            None => wrong(format!("`{}` is no number", text.escape_debug()), "write one: 0.5"),
        },
        [one] if one.number().is_some() => Ok(XacroValue::Float(one.number().unwrap_or_default())),
        _ => wrong_arguments("float", arguments),
    }
}

/// Half to even, as Python rounds; with a number of digits it stays a number with a point.
fn round(arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    match arguments {
        [XacroValue::Float(number)] | [XacroValue::Float(number), XacroValue::None] => {
            whole_of(libm::rint(*number))
        }
        [one] if one.whole().is_some() => Ok(XacroValue::Int(one.whole().unwrap_or_default())),
        [XacroValue::Float(number), digits] => match digits.whole() {
            // A decimal of so many digits, exactly, and read again.
            Some(digits @ 0..=330) => {
                let rounded = format!("{number:.*}", digits as usize).parse().unwrap_or(*number);
                Ok(XacroValue::Float(rounded))
            }
            Some(digits @ -330..0) => {
                let ten = libm::pow(10.0, -digits as f64);
                Ok(XacroValue::Float(libm::rint(number / ten) * ten))
            }
            Some(_) => Ok(XacroValue::Float(*number)),
            None => wrong_arguments("round", arguments),
        },
        [one, digits] if one.whole().is_some() && digits.whole().is_some_and(|digits| digits >= 0) => {
            Ok(XacroValue::Int(one.whole().unwrap_or_default()))
        }
        _ => wrong_arguments("round", arguments),
    }
}

/// Of several values, or of one list.
fn extreme(name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    let values = match arguments {
        [one] => one.iterated()?,
        many => many.to_vec(),
    };
    let mut values = values.into_iter();
    let Some(mut best) = values.next() else {
        return wrong(format!("`{name}` of nothing"), "give it numbers");
    };
    let wanted = if name == "min" { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater };
    for value in values {
        if order(&value, &best)? == Some(wanted) {
            best = value;
        }
    }
    Ok(best)
}

fn of_lists(name: &str, arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    match (name, arguments) {
        ("len", [XacroValue::Text(text)]) => Ok(XacroValue::Int(text.chars().count() as i64)),
        ("len", [one]) => Ok(XacroValue::Int(one.iterated()?.len() as i64)),
        ("list", []) => XacroValue::list(Vec::new()),
        ("list", [one]) => XacroValue::list(one.iterated()?),
        ("tuple", [one]) => XacroValue::tuple(one.iterated()?),
        ("all", [one]) => Ok(XacroValue::Bool(one.iterated()?.iter().all(XacroValue::is_true))),
        ("any", [one]) => Ok(XacroValue::Bool(one.iterated()?.iter().any(XacroValue::is_true))),
        ("sum", [one]) => {
            let mut sum = XacroValue::Int(0);
            for value in one.iterated()? {
                sum = arithmetic(XacroArithmetic::Add, &sum, &value)?;
            }
            Ok(sum)
        }
        ("reversed", [one]) => {
            let mut values = one.iterated()?;
            values.reverse();
            XacroValue::list(values)
        }
        ("sorted", [one]) => sorted(one.iterated()?),
        ("enumerate", [one]) => {
            let pairs = (0..)
                .zip(one.iterated()?)
                .map(|(at, value)| XacroValue::tuple(vec![XacroValue::Int(at), value]));
            XacroValue::list(pairs.collect::<EvalResult<_>>()?)
        }
        ("zip", [one, other]) => {
            let pairs = one.iterated()?.into_iter().zip(other.iterated()?);
            XacroValue::list(pairs.map(|(a, b)| XacroValue::tuple(vec![a, b])).collect::<EvalResult<_>>()?)
        }
        ("range", _) => range(arguments),
        ("map", [XacroValue::Function(of), list]) if !is_outer(of) && &**of != "map" => XacroValue::list(
            list.iterated()?.into_iter().map(|value| call(of, &[value])).collect::<EvalResult<_>>()?,
        ),
        _ if FUNCTIONS.contains(&name) => wrong_arguments(name, arguments),
        _ => not_done(format!("function `{name}`"), "compute it otherwise"),
    }
}

/// By insertion: comparing may fail, which the sorts of the standard library do not provide for.
fn sorted(values: Vec<XacroValue>) -> EvalResult<XacroValue> {
    const MOST_SORTED: usize = 2000;
    if values.len() > MOST_SORTED {
        return wrong(format!("a list of more than {MOST_SORTED} values is sorted"), "sort a shorter one");
    }
    let mut in_order: Vec<XacroValue> = Vec::new();
    for value in values {
        let mut at = in_order.len();
        for (place, other) in in_order.iter().enumerate() {
            if order(&value, other)? == Some(std::cmp::Ordering::Less) {
                at = place;
                break;
            }
        }
        in_order.insert(at, value);
    }
    XacroValue::list(in_order)
}

fn range(arguments: &[XacroValue]) -> EvalResult<XacroValue> {
    let numbers: Option<Vec<i64>> = arguments.iter().map(XacroValue::whole).collect();
    let (from, to, by) = match numbers.as_deref() {
        Some([to]) => (0, *to, 1),
        Some([from, to]) => (*from, *to, 1),
        Some([from, to, by]) if *by != 0 => (*from, *to, *by),
        Some(_) | None => return wrong_arguments("range", arguments),
    };
    let steps = std::iter::successors(Some(from), |at| at.checked_add(by));
    let inside = steps.take_while(|at| if by > 0 { *at < to } else { *at > to }).take(MOST_VALUE_SIZE);
    XacroValue::list(inside.map(XacroValue::Int).collect())
}
