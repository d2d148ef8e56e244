//! Values, their types, and the units that only printing needs.

use std::{
    fmt,
    sync::{Mutex, PoisonError},
};

use hrdsl_source::{Enumeration, Symbol};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::list::{List, Text};

/// Simulated or virtual time since the start of a run, or a duration, in nanoseconds.
pub type Nanos = i64;

/// One second in [`Nanos`].
pub const SECOND: Nanos = 1_000_000_000;

/// Seconds to nanoseconds, rounded to the nearest.
#[must_use]
pub fn nanos(seconds: f64) -> Nanos {
    (seconds * 1e9).round() as Nanos
}

/// Nanoseconds to seconds.
#[must_use]
pub fn seconds(time: Nanos) -> f64 {
    time as f64 / 1e9
}

/// The SI unit (or none) in which a float is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    #[default]
    None,
    Second,
    Metre,
    Radian,
    Kilogram,
    Newton,
    MetrePerSecond,
    RadianPerSecond,
    MetrePerSecondSquared,
    RadianPerSecondSquared,
    Pascal,
    Hertz,
    NewtonMetre,
    NewtonPerMetre,
    NewtonSecondPerMetre,
    NewtonMetreSecondPerRadian,
    KilogramSquareMetre,
    Byte,
}

impl Unit {
    /// The symbol as it is written in the language; empty for a bare number.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::None => "",
            Unit::Second => "s",
            Unit::Metre => "m",
            Unit::Radian => "rad",
            Unit::Kilogram => "kg",
            Unit::Newton => "N",
            Unit::MetrePerSecond => "m/s",
            Unit::RadianPerSecond => "rad/s",
            Unit::MetrePerSecondSquared => "m/s^2",
            Unit::RadianPerSecondSquared => "rad/s^2",
            Unit::Pascal => "Pa",
            Unit::Hertz => "Hz",
            Unit::NewtonMetre => "Nm",
            Unit::NewtonPerMetre => "N/m",
            Unit::NewtonSecondPerMetre => "Ns/m",
            Unit::NewtonMetreSecondPerRadian => "Nms/rad",
            Unit::KilogramSquareMetre => "kgm^2",
            Unit::Byte => "B",
        }
    }
}

/// The type of a parameter, belief argument, variable or signal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Type {
    Bool,
    /// An integer of `lo..=hi`.
    Int {
        lo: i64,
        hi: i64,
    },
    /// A quantity in an SI unit, or a bare float.
    Float(Unit),
    Enum(Enumeration),
    /// A string.
    Text,
    /// A list of values of one type.
    List(ListOf),
}

/// The type of a list's elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListOf(&'static Type);

impl ListOf {
    #[must_use]
    pub fn new(of: Type) -> Self {
        let mut known = ELEMENTS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(same) = known.iter().find(|t| ***t == of) {
            return Self(same);
        }
        let of: &'static Type = Box::leak(Box::new(of));
        known.push(of);
        Self(of)
    }

    #[must_use]
    pub fn element(self) -> Type {
        *self.0
    }
}

/// The element types of all lists; there are few.
static ELEMENTS: Mutex<Vec<&'static Type>> = Mutex::new(Vec::new());

impl Serialize for ListOf {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ListOf {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Type::deserialize(deserializer).map(Self::new)
    }
}

impl Type {
    /// All values of a finite type, in order: `false` before `true`, integers upwards, symbols as they
    /// are declared. `None` for floats, strings and lists.
    #[must_use]
    pub fn domain(self) -> Option<Vec<Value>> {
        match self {
            Type::Bool => Some(vec![Value::Bool(false), Value::Bool(true)]),
            Type::Int { lo, hi } => Some((lo..=hi).map(Value::Int).collect()),
            Type::Enum(e) => Some(e.values().iter().copied().map(Value::Symbol).collect()),
            Type::Float(_) | Type::Text | Type::List(_) => None,
        }
    }

    /// The smallest and largest value of an integer type.
    #[must_use]
    pub fn range(self) -> Option<(i64, i64)> {
        match self {
            Type::Int { lo, hi } => Some((lo, hi)),
            Type::Bool | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_) => None,
        }
    }

    /// Whether its values can be enumerated.
    #[must_use]
    pub fn is_finite(self) -> bool {
        match self {
            Type::Int { lo, hi } => (lo, hi) != (i64::MIN, i64::MAX),
            Type::Bool | Type::Enum(_) => true,
            Type::Float(_) | Type::Text | Type::List(_) => false,
        }
    }

    /// Whether it is known to agents only: a string or a list.
    #[must_use]
    pub fn is_of_agents(self) -> bool {
        match self {
            Type::Text | Type::List(_) => true,
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) => false,
        }
    }

    /// Whether the value is of this type: an integer within its range, a symbol of this enumeration.
    #[must_use]
    pub fn admits(self, value: Value) -> bool {
        match (self, value) {
            (Type::Bool, Value::Bool(_)) | (Type::Float(_), Value::Float(_)) => true,
            (Type::Int { lo, hi }, Value::Int(n)) => (lo..=hi).contains(&n),
            (Type::Enum(e), Value::Symbol(s)) => e.index_of(s).is_some(),
            (Type::Text, Value::Text(_)) => true,
            (Type::List(of), Value::List(list)) => list.iter().all(|v| of.element().admits(v)),
            (
                Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
                _,
            ) => false,
        }
    }
}

/// A value: of one of the language's scalar types, or of an agent a string or a list.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
    /// A value of an enumeration.
    Symbol(Symbol),
    Text(Text),
    List(List),
}

impl Value {
    #[must_use]
    pub fn as_bool(self) -> Option<bool> {
        match self {
            Value::Bool(b) => Some(b),
            Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        }
    }

    #[must_use]
    pub fn as_int(self) -> Option<i64> {
        match self {
            Value::Int(n) => Some(n),
            Value::Bool(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        }
    }

    #[must_use]
    pub fn as_symbol(self) -> Option<Symbol> {
        match self {
            Value::Symbol(s) => Some(s),
            Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Text(_) | Value::List(_) => None,
        }
    }

    #[must_use]
    pub fn as_list(self) -> Option<List> {
        match self {
            Value::List(l) => Some(l),
            Value::Bool(_) | Value::Int(_) | Value::Float(_) | Value::Symbol(_) | Value::Text(_) => None,
        }
    }

    /// The number, whether integer or float.
    #[must_use]
    pub fn as_f64(self) -> Option<f64> {
        match self {
            Value::Int(n) => Some(n as f64),
            Value::Float(x) => Some(x),
            Value::Bool(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_) => None,
        }
    }

    /// Equality as the language's `==` means it: bit for bit, so that it can key maps. A symbol counts as
    /// a number made from its name.
    #[must_use]
    pub fn key(self) -> (u8, u64) {
        match self {
            Value::Bool(b) => (0, u64::from(b)),
            Value::Int(n) => (1, n as u64),
            Value::Float(x) => (2, x.to_bits()),
            Value::Symbol(s) => (3, s.number()),
            Value::Text(t) => (4, t.text.number()),
            Value::List(l) => (5, l.number()),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::Int(n) => write!(f, "{n}"),
            Value::Float(x) => write!(f, "{x}"),
            Value::Symbol(s) => write!(f, "{s}"),
            Value::Text(t) => write!(f, "{t}"),
            Value::List(l) => write!(f, "{l}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enumeration_admits_its_symbols_only() {
        let pace = Enumeration::intern("Pace", &["slow", "fast", "crawl"]);
        let symbol = |name| Value::Symbol(Symbol::intern(name));
        let all = vec![symbol("slow"), symbol("fast"), symbol("crawl")];
        assert_eq!(Type::Enum(pace).domain(), Some(all));
        assert!(Type::Enum(pace).admits(symbol("fast")));
        for other in [symbol("Fast"), Value::Bool(true), Value::Int(0), Value::Float(0.0)] {
            assert!(!Type::Enum(pace).admits(other));
        }
        for ty in [Type::Bool, Type::Int { lo: 0, hi: 9 }, Type::Float(Unit::None)] {
            assert!(!ty.admits(symbol("fast")));
        }
        let fast = symbol("fast");
        assert_eq!((fast.as_bool(), fast.as_int(), fast.as_f64()), (None, None, None));
        assert_eq!(fast.as_symbol().map(Symbol::name), Some("fast"));
        assert_eq!(fast.to_string(), "fast");
    }

    #[test]
    fn units_are_written_with_their_symbols() {
        let written = [
            (Unit::MetrePerSecondSquared, "m/s^2", "\"metre_per_second_squared\""),
            (Unit::RadianPerSecondSquared, "rad/s^2", "\"radian_per_second_squared\""),
            (Unit::Pascal, "Pa", "\"pascal\""),
            (Unit::Hertz, "Hz", "\"hertz\""),
            (Unit::NewtonMetre, "Nm", "\"newton_metre\""),
            (Unit::NewtonPerMetre, "N/m", "\"newton_per_metre\""),
            (Unit::NewtonSecondPerMetre, "Ns/m", "\"newton_second_per_metre\""),
            (Unit::NewtonMetreSecondPerRadian, "Nms/rad", "\"newton_metre_second_per_radian\""),
            (Unit::KilogramSquareMetre, "kgm^2", "\"kilogram_square_metre\""),
        ];
        for (unit, symbol, data) in written {
            assert_eq!((unit.symbol(), serde_json::to_string(&unit).unwrap().as_str()), (symbol, data));
        }
    }
}
