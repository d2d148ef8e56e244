//! Lists and strings, the values of several parts that agents have: kept once in a table of the process, so that a value
//! stays as small as a number, equal lists are one, and a list shares its rest with others.
//!
//! The table only grows; it holds each distinct list that an agent made.

use std::{
    cmp::Ordering,
    fmt,
    sync::{LazyLock, Mutex, PoisonError},
};

use hrdsl_source::Symbol;
use rustc_hash::FxHashMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    eval_error::EvalError,
    real::{RealFunction, apply_real},
    value::Value,
};

/// A string.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Text {
    pub text: Symbol,
}

impl Text {
    #[must_use]
    pub fn new(text: &str) -> Self {
        Self { text: Symbol::intern(text) }
    }

    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.text.name()
    }
}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

struct ListCell {
    head: Value,
    tail: List,
    len: u32,
    number: u64,
}

/// A list: empty, or an element and the rest.
#[derive(Clone, Copy)]
pub struct List(Option<&'static ListCell>);

/// By what equal cells are known: the head's key, the rest's address.
type ListKey = (u8, u64, usize);

const SHARDS: usize = 16;

static CELLS: LazyLock<[Mutex<FxHashMap<ListKey, &'static ListCell>>; SHARDS]> =
    LazyLock::new(|| std::array::from_fn(|_| Mutex::default()));

impl List {
    pub const EMPTY: List = List(None);

    /// The list of this element and the rest.
    #[must_use]
    pub fn cons(head: Value, tail: List) -> Self {
        // An address is the key of a list within, whose number need not be its own.
        let (kind, content) = match head {
            Value::List(list) => (5, list.address() as u64),
            Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) => {
                head.key()
            }
        };
        let number = mix(mix(u64::from(kind), head.key().1), tail.number());
        let shard = &CELLS[number as usize % SHARDS];
        let mut cells = shard.lock().unwrap_or_else(PoisonError::into_inner);
        let len = tail.0.map_or(0, |c| c.len) + 1;
        let make = || -> &'static ListCell { Box::leak(Box::new(ListCell { head, tail, len, number })) };
        List(Some(cells.entry((kind, content, tail.address())).or_insert_with(make)))
    }

    #[must_use]
    pub fn of(elements: &[Value]) -> Self {
        elements.iter().rev().fold(List::EMPTY, |rest, e| List::cons(*e, rest))
    }

    #[must_use]
    pub fn split(self) -> Option<(Value, List)> {
        self.0.map(|c| (c.head, c.tail))
    }

    #[must_use]
    pub fn len(self) -> usize {
        self.0.map_or(0, |c| c.len as usize)
    }

    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0.is_none()
    }

    pub fn iter(self) -> impl Iterator<Item = Value> {
        std::iter::successors(self.0, |c| c.tail.0).map(|c| c.head)
    }

    /// A number that depends on the elements only: the same in every process.
    #[must_use]
    pub fn number(self) -> u64 {
        self.0.map_or(0x9e37_79b9_7f4a_7c15, |c| c.number)
    }

    fn address(self) -> usize {
        self.0.map_or(0, |c| std::ptr::from_ref(c).addr())
    }
}

fn mix(a: u64, b: u64) -> u64 {
    (a.rotate_left(5) ^ b).wrapping_mul(0x517c_c1b7_2722_0a95)
}

impl PartialEq for List {
    fn eq(&self, other: &Self) -> bool {
        self.address() == other.address()
    }
}

impl Eq for List {}

impl fmt::Display for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (i, element) in self.iter().enumerate() {
            let comma = if i == 0 { "" } else { ", " };
            write!(f, "{comma}{element}")?;
        }
        f.write_str("]")
    }
}

impl fmt::Debug for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Serialize for List {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de> Deserialize<'de> for List {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(|elements| List::of(&elements))
    }
}

/// The order of `.sort` and `.setof`: `false` before `true`, then numbers, symbols by name, strings, lists by their
/// elements.
#[must_use]
pub fn order(a: Value, b: Value) -> Ordering {
    let rank = |v: Value| match v {
        Value::Bool(_) => 0,
        Value::Int(_) | Value::Float(_) => 1,
        Value::Symbol(_) => 2,
        Value::Text(_) => 3,
        Value::List(_) => 4,
    };
    match (a, b) {
        (Value::Bool(a), Value::Bool(b)) => a.cmp(&b),
        (Value::Int(a), Value::Int(b)) => a.cmp(&b),
        (Value::Symbol(a), Value::Symbol(b)) => a.cmp(&b),
        (Value::Text(a), Value::Text(b)) => a.cmp(&b),
        (Value::List(a), Value::List(b)) => {
            let parts = a.iter().zip(b.iter()).map(|(a, b)| order(a, b));
            parts.into_iter().find(|o| o.is_ne()).unwrap_or_else(|| a.len().cmp(&b.len()))
        }
        _ => match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            _ => rank(a).cmp(&rank(b)),
        },
    }
}

/// Functions of lists, strings and numbers, called as internal actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ListFunction {
    /// Of a list or a string.
    Length,
    /// Of two or more lists, or of values of which one is a string.
    Concat,
    /// `(i, list)`, from 0; none beyond the end.
    Nth,
    Reverse,
    Sort,
    /// None of an empty list.
    Min,
    Max,
    /// `(x, list)`: without all elements equal to x.
    Delete,
    Union,
    Intersection,
    Difference,
    /// The text of a value; of a string itself.
    ToText,
    /// Whether a list or string is empty.
    Empty,
    /// `(a, b)`: whether b begins with a.
    Prefix,
    Suffix,
    /// Whether b contains a in one piece.
    Sublist,
    /// `(a, b)`: the places, from 0, at which b contains a.
    Occurrences,
    /// `(list or string, i, j)`: from the place i to the one before j; none if there are no such places.
    Slice,
    Real(RealFunction),
}

/// Applies a function; `None` if it has no value for these arguments.
///
/// # Errors
/// `Type` if the arguments are of other types, or too few.
#[expect(clippy::too_many_lines, reason = "a flat match")]
pub fn apply(f: ListFunction, args: &[Value]) -> Result<Option<Value>, EvalError> {
    use ListFunction as F;
    let list = |v: Vec<Value>| Ok(Some(Value::List(List::of(&v))));
    let held = |set: &[Value], v: Value| set.iter().any(|x| same(*x, v));
    match (f, args) {
        (F::Length, [Value::List(l)]) => Ok(Some(Value::Int(l.len() as i64))),
        (F::Length, [Value::Text(t)]) => Ok(Some(Value::Int(t.as_str().chars().count() as i64))),
        (F::Concat, [_, _, ..]) => concat(args),
        (F::Nth, [Value::Int(n), Value::List(l)]) => {
            Ok(usize::try_from(*n).ok().and_then(|n| l.iter().nth(n)))
        }
        (F::Reverse, [Value::List(l)]) => {
            Ok(Some(Value::List(l.iter().fold(List::EMPTY, |r, e| List::cons(e, r)))))
        }
        (F::Reverse, [Value::Text(t)]) => {
            let text: String = t.as_str().chars().rev().collect();
            Ok(Some(Value::Text(Text::new(&text))))
        }
        (F::Sort, [Value::List(l)]) => {
            let mut all: Vec<Value> = l.iter().collect();
            all.sort_by(|a, b| order(*a, *b));
            list(all)
        }
        (F::Min, [Value::List(l)]) => Ok(l.iter().reduce(|a, b| if order(b, a).is_lt() { b } else { a })),
        (F::Max, [Value::List(l)]) => Ok(l.iter().reduce(|a, b| if order(b, a).is_gt() { b } else { a })),
        (F::Delete, [x, Value::List(l)]) => list(l.iter().filter(|e| !same(*e, *x)).collect()),
        (F::Union, [Value::List(a), Value::List(b)]) => {
            let mut all = Vec::new();
            for e in a.iter().chain(b.iter()) {
                if !held(&all, e) {
                    all.push(e);
                }
            }
            list(all)
        }
        (F::Intersection | F::Difference, [Value::List(a), Value::List(b)]) => {
            let b: Vec<Value> = b.iter().collect();
            list(a.iter().filter(|e| held(&b, *e) == (f == F::Intersection)).collect())
        }
        (F::ToText, [Value::Text(t)]) => Ok(Some(Value::Text(*t))),
        (F::ToText, [v]) => Ok(Some(Value::Text(Text::new(&v.to_string())))),
        (F::Empty, [Value::List(l)]) => Ok(Some(Value::Bool(l.is_empty()))),
        (F::Empty, [Value::Text(t)]) => Ok(Some(Value::Bool(t.as_str().is_empty()))),
        (F::Prefix | F::Suffix | F::Sublist, [Value::Text(a), Value::Text(b)]) => {
            let (a, b) = (a.as_str(), b.as_str());
            Ok(Some(Value::Bool(if f == F::Prefix {
                b.starts_with(a)
            } else if f == F::Suffix {
                b.ends_with(a)
            } else {
                b.contains(a)
            })))
        }
        (F::Prefix | F::Suffix | F::Sublist, [Value::List(a), Value::List(b)]) => {
            let (a, b): (Vec<Value>, Vec<Value>) = (a.iter().collect(), b.iter().collect());
            let at = |from: usize| {
                let part = b.get(from..from + a.len());
                part.is_some_and(|p| p.iter().zip(&a).all(|(x, y)| same(*x, *y)))
            };
            Ok(Some(Value::Bool(if f == F::Prefix {
                at(0)
            } else if f == F::Suffix {
                b.len() >= a.len() && at(b.len() - a.len())
            } else {
                (0..=b.len()).any(at)
            })))
        }
        (F::Occurrences, [a, b]) => {
            let (a, b) = (elements(*a)?, elements(*b)?);
            let begins = |from: &usize| {
                b.get(*from..from + a.len()).is_some_and(|p| p.iter().zip(&a).all(|(x, y)| same(*x, *y)))
            };
            list((0..b.len()).filter(begins).map(|at| Value::Int(at as i64)).collect())
        }
        (F::Slice, [of, Value::Int(from), Value::Int(to)]) => Ok(slice(*of, *from, *to)?),
        (F::Real(f), args) => apply_real(f, args),
        (
            F::Length
            | F::Concat
            | F::Nth
            | F::Reverse
            | F::Sort
            | F::Min
            | F::Max
            | F::Delete
            | F::Union
            | F::Intersection
            | F::Difference
            | F::ToText
            | F::Empty
            | F::Prefix
            | F::Suffix
            | F::Sublist
            | F::Occurrences
            | F::Slice,
            _,
        ) => Err(EvalError::Type),
    }
}

/// The elements of a list; the characters of a string, each as one.
fn elements(of: Value) -> Result<Vec<Value>, EvalError> {
    match of {
        Value::List(list) => Ok(list.iter().collect()),
        Value::Text(text) => {
            let character = |c: char| Value::Text(Text::new(c.encode_utf8(&mut [0; 4])));
            Ok(text.as_str().chars().map(character).collect())
        }
        Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) => Err(EvalError::Type),
    }
}

fn slice(of: Value, from: i64, to: i64) -> Result<Option<Value>, EvalError> {
    let all = elements(of)?;
    let (Ok(from), Ok(to)) = (usize::try_from(from), usize::try_from(to)) else { return Ok(None) };
    let Some(part) = all.get(from..to) else { return Ok(None) };
    if let Value::Text(_) = of {
        let texts = part.iter().map(|v| if let Value::Text(t) = v { t.as_str() } else { "" });
        return Ok(Some(Value::Text(Text::new(&texts.collect::<String>()))));
    }
    Ok(Some(Value::List(List::of(part))))
}

fn concat(args: &[Value]) -> Result<Option<Value>, EvalError> {
    if args.iter().any(|a| matches!(a, Value::Text(_))) {
        let text = |v: &Value| if let Value::Text(t) = v { t.as_str().to_owned() } else { v.to_string() };
        let all: String = args.iter().map(text).collect();
        return Ok(Some(Value::Text(Text::new(&all))));
    }
    let mut all = List::EMPTY;
    for arg in args.iter().rev() {
        let Value::List(l) = arg else { return Err(EvalError::Type) };
        let elements: Vec<Value> = l.iter().collect();
        all = elements.iter().rev().fold(all, |rest, e| List::cons(*e, rest));
    }
    Ok(Some(Value::List(all)))
}

/// Whether two values match: bit for bit; a whole number matches the float that is exactly this number, other than `==`,
/// which rounds it; lists element by element.
#[must_use]
pub fn same(a: Value, b: Value) -> bool {
    match (a, b) {
        (Value::Int(n), Value::Float(x)) | (Value::Float(x), Value::Int(n)) => {
            // Back again: large whole numbers are rounded.
            n as f64 == x && x as i128 == i128::from(n)
        }
        (Value::Symbol(a), Value::Symbol(b)) => a == b,
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::List(a), Value::List(b)) => {
            a == b || (a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| same(a, b)))
        }
        (Value::Int(a), Value::Int(b)) => a == b,
        (
            Value::Bool(_)
            | Value::Int(_)
            | Value::Float(_)
            | Value::Symbol(_)
            | Value::Text(_)
            | Value::List(_),
            _,
        ) => a.key() == b.key(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ints(all: &[i64]) -> Value {
        Value::List(List::of(&all.iter().map(|n| Value::Int(*n)).collect::<Vec<_>>()))
    }

    fn text(t: &str) -> Value {
        Value::Text(Text::new(t))
    }

    #[test]
    fn equal_lists_are_one() {
        assert_eq!(ints(&[1, 2, 3]), ints(&[1, 2, 3]));
        assert_ne!(ints(&[1, 2, 3]), ints(&[1, 2]));
        assert_ne!(Value::List(List::of(&[Value::Float(1.0)])), ints(&[1]));
        assert!(same(Value::List(List::of(&[Value::Float(1.0)])), ints(&[1])));
        assert!(same(Value::Int(0), Value::Float(-0.0)) && !same(Value::Float(0.0), Value::Float(-0.0)));
        let large = Value::Float(9_007_199_254_740_992.0);
        assert!(same(Value::Int(1 << 53), large) && !same(Value::Int((1 << 53) + 1), large));
        assert!(!same(Value::Int(i64::MAX), Value::Float(i64::MAX as f64)));
        let nested = Value::List(List::of(&[ints(&[1]), ints(&[])]));
        assert_eq!(nested.to_string(), "[[1], []]");
        assert_eq!(nested, Value::List(List::of(&[ints(&[1]), ints(&[])])));
        let data = serde_json::to_string(&Value::List(List::of(&[nested, text("a")]))).unwrap();
        assert_eq!(data, "[[[1],[]],{\"text\":\"a\"}]");
        assert_eq!(serde_json::from_str::<Value>(&data).unwrap().to_string(), "[[[1], []], \"a\"]");
    }

    #[test]
    fn functions_do_what_their_names_say() {
        use ListFunction as F;
        let of = |f, args: &[Value]| apply(f, args).unwrap().map(|v| v.to_string());
        let some = |t: &str| Some(t.to_owned());
        let (a, b) = (ints(&[3, 1, 2, 1]), ints(&[1, 4]));
        assert_eq!(of(F::Length, &[a]), some("4"));
        assert_eq!(of(F::Length, &[text("né")]), some("2"));
        assert_eq!(of(F::Concat, &[a, b, ints(&[])]), some("[3, 1, 2, 1, 1, 4]"));
        assert_eq!(of(F::Concat, &[text("leg "), Value::Int(2)]), some("\"leg 2\""));
        assert_eq!((of(F::Nth, &[Value::Int(2), a]), of(F::Nth, &[Value::Int(4), a])), (some("2"), None));
        assert_eq!(of(F::Reverse, &[a]), some("[1, 2, 1, 3]"));
        assert_eq!(of(F::Sort, &[a]), some("[1, 1, 2, 3]"));
        assert_eq!(
            (of(F::Min, &[a]), of(F::Max, &[a]), of(F::Max, &[ints(&[])])),
            (some("1"), some("3"), None)
        );
        assert_eq!(of(F::Delete, &[Value::Int(1), a]), some("[3, 2]"));
        assert_eq!(of(F::Union, &[a, b]), some("[3, 1, 2, 4]"));
        assert_eq!(of(F::Intersection, &[a, b]), some("[1, 1]"));
        assert_eq!(of(F::Difference, &[a, b]), some("[3, 2]"));
        assert_eq!(of(F::ToText, &[b]), some("\"[1, 4]\""));
        assert_eq!(of(F::Empty, &[ints(&[])]), some("true"));
        assert_eq!(of(F::Prefix, &[ints(&[3, 1]), a]), some("true"));
        assert_eq!(of(F::Suffix, &[ints(&[3, 1]), a]), some("false"));
        assert_eq!(of(F::Sublist, &[ints(&[1, 2]), a]), some("true"));
        assert_eq!(of(F::Sublist, &[text("bc"), text("abcd")]), some("true"));
        assert_eq!(of(F::Occurrences, &[text("aa"), text("aaéaa")]), some("[0, 3]"));
        assert_eq!(of(F::Occurrences, &[ints(&[1]), a]), some("[1, 3]"));
        assert_eq!(of(F::Slice, &[text("aéb"), Value::Int(1), Value::Int(3)]), some("\"éb\""));
        assert_eq!(of(F::Slice, &[a, Value::Int(1), Value::Int(1)]), some("[]"));
        assert_eq!(of(F::Slice, &[a, Value::Int(2), Value::Int(5)]), None);
        assert_eq!(of(F::Slice, &[a, Value::Int(-1), Value::Int(1)]), None);
        assert_eq!(of(F::Slice, &[a, Value::Int(2), Value::Int(1)]), None);
        assert_eq!(apply(F::Length, &[Value::Int(1)]), Err(EvalError::Type));
        assert_eq!(apply(F::Concat, &[a, Value::Int(1)]), Err(EvalError::Type));
    }

    #[test]
    fn the_order_is_total_over_kinds() {
        let symbol = Value::Symbol(Symbol::intern("slow"));
        let sorted = [Value::Bool(true), Value::Float(0.5), Value::Int(1), symbol, text("a"), ints(&[1])];
        for (i, a) in sorted.iter().enumerate() {
            for (j, b) in sorted.iter().enumerate() {
                assert_eq!(order(*a, *b), i.cmp(&j), "{a} {b}");
            }
        }
        assert_eq!(order(ints(&[1, 2]), ints(&[1, 2, 0])), Ordering::Less);
    }
}
