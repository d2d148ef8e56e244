//! Values, their types, and the units that only printing needs.

use std::fmt;

use serde::{Deserialize, Serialize};

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
}

impl Type {
    /// All values of a finite type, in order: `false` before `true`, integers upwards. `None` for floats.
    #[must_use]
    pub fn domain(self) -> Option<Vec<Value>> {
        match self {
            Type::Bool => Some(vec![Value::Bool(false), Value::Bool(true)]),
            Type::Int { lo, hi } => Some((lo..=hi).map(Value::Int).collect()),
            Type::Float(_) => None,
        }
    }

    /// Whether the value is of this type and, for an integer, within its range.
    #[must_use]
    pub fn admits(self, value: Value) -> bool {
        match (self, value) {
            (Type::Bool, Value::Bool(_)) | (Type::Float(_), Value::Float(_)) => true,
            (Type::Int { lo, hi }, Value::Int(n)) => (lo..=hi).contains(&n),
            (Type::Bool | Type::Int { .. } | Type::Float(_), _) => false,
        }
    }
}

/// A value of any of the language's scalar types.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
}

impl Value {
    #[must_use]
    pub fn as_bool(self) -> Option<bool> {
        match self {
            Value::Bool(b) => Some(b),
            Value::Int(_) | Value::Float(_) => None,
        }
    }

    #[must_use]
    pub fn as_int(self) -> Option<i64> {
        match self {
            Value::Int(n) => Some(n),
            Value::Bool(_) | Value::Float(_) => None,
        }
    }

    /// The number, whether integer or float.
    #[must_use]
    pub fn as_f64(self) -> Option<f64> {
        match self {
            Value::Int(n) => Some(n as f64),
            Value::Float(x) => Some(x),
            Value::Bool(_) => None,
        }
    }

    /// Equality as the language's `==` means it: bit for bit, so that it can key maps.
    #[must_use]
    pub fn key(self) -> (u8, u64) {
        match self {
            Value::Bool(b) => (0, u64::from(b)),
            Value::Int(n) => (1, n as u64),
            Value::Float(x) => (2, x.to_bits()),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::Int(n) => write!(f, "{n}"),
            Value::Float(x) => write!(f, "{x}"),
        }
    }
}
