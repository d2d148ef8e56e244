//! Types and dimensions: what a value is, and in which unit a quantity is counted.

use std::{
    fmt,
    sync::{Mutex, PoisonError},
};

use serde::Serialize;

use hrdsl_ir::{Type, Unit as SiUnit, Value, ta::AutomatonVar};
use hrdsl_source::Enumeration;

/// A physical dimension: exponents of metre, kilogram, second, radian and byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Dimension {
    pub m: i8,
    pub kg: i8,
    pub s: i8,
    pub rad: i8,
    #[serde(rename = "B")]
    pub byte: i8,
}

const fn dim(m: i8, kg: i8, s: i8, rad: i8) -> Dimension {
    Dimension { m, kg, s, rad, byte: 0 }
}

/// The dimensions that have a name: its type's name, the name in a sentence, its SI unit.
const NAMED: &[(Dimension, &str, &str, SiUnit)] = &[
    (Dimension::NUMBER, "number", "a bare number", SiUnit::None),
    (Dimension::LENGTH, "length", "a length", SiUnit::Metre),
    (Dimension::TIME, "time", "a time", SiUnit::Second),
    (Dimension::ANGLE, "angle", "an angle", SiUnit::Radian),
    (Dimension::MASS, "mass", "a mass", SiUnit::Kilogram),
    (Dimension::FORCE, "force", "a force", SiUnit::Newton),
    (Dimension::SPEED, "speed", "a speed", SiUnit::MetrePerSecond),
    (Dimension::ANGULAR_SPEED, "angular_speed", "an angular speed", SiUnit::RadianPerSecond),
    (Dimension::ACCELERATION, "acceleration", "an acceleration", SiUnit::MetrePerSecondSquared),
    (
        Dimension::ANGULAR_ACCELERATION,
        "angular_acceleration",
        "an angular acceleration",
        SiUnit::RadianPerSecondSquared,
    ),
    (Dimension::PRESSURE, "pressure", "a pressure", SiUnit::Pascal),
    (Dimension::TORQUE, "torque", "a torque", SiUnit::NewtonMetre),
    (Dimension::STIFFNESS, "stiffness", "a stiffness", SiUnit::NewtonPerMetre),
    (Dimension::DAMPING, "damping", "a damping", SiUnit::NewtonSecondPerMetre),
    (Dimension::ANGULAR_DAMPING, "angular_damping", "an angular damping", SiUnit::NewtonMetreSecondPerRadian),
    (Dimension::INERTIA, "inertia", "a moment of inertia", SiUnit::KilogramSquareMetre),
    (Dimension::FREQUENCY, "frequency", "a frequency", SiUnit::Hertz),
    (Dimension::DATA, "data", "an amount of data", SiUnit::Byte),
];

impl Dimension {
    pub const NUMBER: Dimension = dim(0, 0, 0, 0);
    pub const LENGTH: Dimension = dim(1, 0, 0, 0);
    pub const TIME: Dimension = dim(0, 0, 1, 0);
    pub const ANGLE: Dimension = dim(0, 0, 0, 1);
    pub const MASS: Dimension = dim(0, 1, 0, 0);
    pub const FORCE: Dimension = dim(1, 1, -2, 0);
    pub const SPEED: Dimension = dim(1, 0, -1, 0);
    pub const ANGULAR_SPEED: Dimension = dim(0, 0, -1, 1);
    pub const ACCELERATION: Dimension = dim(1, 0, -2, 0);
    pub const ANGULAR_ACCELERATION: Dimension = dim(0, 0, -2, 1);
    pub const PRESSURE: Dimension = dim(-1, 1, -2, 0);
    pub const TORQUE: Dimension = dim(2, 1, -2, 0);
    pub const STIFFNESS: Dimension = dim(0, 1, -2, 0);
    pub const DAMPING: Dimension = dim(0, 1, -1, 0);
    pub const ANGULAR_DAMPING: Dimension = dim(2, 1, -1, -1);
    pub const INERTIA: Dimension = dim(2, 1, 0, 0);
    pub const FREQUENCY: Dimension = dim(0, 0, -1, 0);
    pub const DATA: Dimension = Dimension { byte: 1, ..Dimension::NUMBER };

    /// The dimension of a product.
    #[must_use]
    pub fn times(self, other: Dimension) -> Dimension {
        self.combine(other, i8::saturating_add)
    }

    /// The dimension of a quotient.
    #[must_use]
    pub fn per(self, other: Dimension) -> Dimension {
        self.combine(other, i8::saturating_sub)
    }

    fn combine(self, other: Dimension, by: fn(i8, i8) -> i8) -> Dimension {
        Dimension {
            m: by(self.m, other.m),
            kg: by(self.kg, other.kg),
            s: by(self.s, other.s),
            rad: by(self.rad, other.rad),
            byte: by(self.byte, other.byte),
        }
    }

    /// The dimension that is counted in this unit.
    #[must_use]
    pub fn of(unit: SiUnit) -> Dimension {
        NAMED.iter().find(|n| n.3 == unit).map_or(Dimension::NUMBER, |n| n.0)
    }

    /// Its SI unit; none, if it is a bare number or has no name of its own.
    #[must_use]
    pub fn unit(self) -> SiUnit {
        NAMED.iter().find(|n| n.0 == self).map_or(SiUnit::None, |n| n.3)
    }

    /// The SI unit's symbol; `None` for a dimension without a name.
    #[must_use]
    pub fn symbol(self) -> Option<&'static str> {
        NAMED.iter().find(|n| n.0 == self).map(|n| n.3.symbol())
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(named) = NAMED.iter().find(|n| n.0 == *self) {
            return f.write_str(named.2);
        }
        f.write_str("a quantity in")?;
        for (unit, power) in
            [("m", self.m), ("kg", self.kg), ("s", self.s), ("rad", self.rad), ("B", self.byte)]
        {
            match power {
                0 => {}
                1 => write!(f, " {unit}")?,
                _ => write!(f, " {unit}^{power}")?,
            }
        }
        Ok(())
    }
}

/// What the elements of a list are, kept once, so that a type stays as small as a number.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub struct InternedKind<T: 'static>(&'static T);

impl<T> Clone for InternedKind<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for InternedKind<T> {}

impl<T> PartialEq for InternedKind<T> {
    fn eq(&self, other: &Self) -> bool {
        // INVARIANT: equal ones are one; see [`kept`].
        std::ptr::eq(self.0, other.0)
    }
}

impl<T> Eq for InternedKind<T> {}

/// The one place where this is kept; there are few of them.
fn kept<T: PartialEq>(known: &Mutex<Vec<&'static T>>, of: T) -> InternedKind<T> {
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().find(|t| ***t == of) {
        return InternedKind(same);
    }
    let of: &'static T = Box::leak(Box::new(of));
    known.push(of);
    InternedKind(of)
}

static KINDS: Mutex<Vec<&'static InferredType>> = Mutex::new(Vec::new());

impl InternedKind<InferredType> {
    #[must_use]
    pub fn new(of: InferredType) -> Self {
        kept(&KINDS, of)
    }

    #[must_use]
    pub fn element(self) -> InferredType {
        *self.0
    }
}

/// A declared type, perhaps of several parts. Everything behind the checker knows the parts alone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TypeLayout {
    Scalar(Type),
    /// Into the checker's records.
    Record(u16),
    /// Of this many.
    Array(Box<TypeLayout>, u16),
    /// The type has a diagnostic: nothing is said about what is of it.
    Unknown,
}

/// The type of this name that is not a range.
#[must_use]
pub fn type_named(name: &str) -> Option<Type> {
    match name {
        "bool" => Some(Type::Bool),
        "float" => Some(Type::Float(SiUnit::None)),
        "int" => Some(Type::Int { lo: i64::MIN, hi: i64::MAX }),
        "string" => Some(Type::Text),
        _ => NAMED.iter().find(|n| n.1 == name).map(|n| Type::Float(n.3)),
    }
}

/// A variable of a finite type. INVARIANT: one whose type is not finite has a diagnostic, and its scenario is never run.
pub(crate) fn finite_var(name: &str, ty: Type) -> AutomatonVar {
    let flag =
        || AutomatonVar { name: name.to_owned(), lo: 0, hi: 1, init: 0, is_bool: true, enumeration: None };
    AutomatonVar::of_type(name, ty).unwrap_or_else(flag)
}

/// The same, with what it starts with.
pub(crate) fn starting_var(name: &str, ty: Type, init: Value) -> AutomatonVar {
    let var = finite_var(name, ty);
    AutomatonVar { init: var.number(init).unwrap_or(var.init), ..var }
}

/// The names that [`type_named`] knows.
pub fn type_names() -> impl Iterator<Item = &'static str> {
    ["bool", "int", "float", "string"].into_iter().chain(NAMED.iter().map(|n| n.1))
}

/// What an expression yields, as far as the checker can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InferredType {
    Bool,
    Int,
    Float(Dimension),
    Enum(Enumeration),
    Text,
    List(InternedKind<InferredType>),
    /// Not known: a goal's argument, or an expression that already has a diagnostic. It fits everywhere.
    Unknown,
}

impl InferredType {
    /// What a value of this type is.
    #[must_use]
    pub fn of(ty: Type) -> InferredType {
        match ty {
            Type::Bool => InferredType::Bool,
            Type::Int { .. } => InferredType::Int,
            Type::Float(unit) => InferredType::Float(Dimension::of(unit)),
            Type::Enum(id) => InferredType::Enum(id),
            Type::Text => InferredType::Text,
            Type::List(of) => InferredType::list(InferredType::of(of.element())),
        }
    }

    /// A list of such elements.
    #[must_use]
    pub fn list(of: InferredType) -> InferredType {
        InferredType::List(InternedKind::<InferredType>::new(of))
    }

    /// What the elements are, if it may be a list.
    #[must_use]
    pub fn element(self) -> Option<InferredType> {
        match self {
            InferredType::List(of) => Some(of.element()),
            InferredType::Unknown => Some(InferredType::Unknown),
            InferredType::Bool
            | InferredType::Int
            | InferredType::Float(_)
            | InferredType::Enum(_)
            | InferredType::Text => None,
        }
    }

    /// What is known if something is of both kinds; `None`: nothing is.
    #[must_use]
    pub fn with(self, other: InferredType) -> Option<InferredType> {
        match (self, other) {
            (InferredType::Unknown, known) | (known, InferredType::Unknown) => Some(known),
            (InferredType::List(a), InferredType::List(b)) => {
                a.element().with(b.element()).map(InferredType::list)
            }
            (a, b) => (a == b).then_some(a),
        }
    }

    /// The type's name, as it is declared.
    pub(crate) fn type_name(self) -> String {
        match self {
            InferredType::Bool => "bool".to_owned(),
            InferredType::Int => "int".to_owned(),
            InferredType::Float(dim) => {
                NAMED.iter().find(|n| n.0 == dim).map_or_else(|| dim.to_string(), |n| n.1.to_owned())
            }
            InferredType::Enum(of) => of.name().to_owned(),
            InferredType::Text => "string".to_owned(),
            InferredType::List(of) => format!("[{}]", of.element().type_name()),
            InferredType::Unknown => "_".to_owned(),
        }
    }

    /// The dimension of a number; a whole number is a bare number.
    #[must_use]
    pub fn dim(self) -> Option<Dimension> {
        match self {
            InferredType::Int => Some(Dimension::NUMBER),
            InferredType::Float(dim) => Some(dim),
            InferredType::Bool
            | InferredType::Enum(_)
            | InferredType::Text
            | InferredType::List(_)
            | InferredType::Unknown => None,
        }
    }

    /// Whether it may be a number.
    #[must_use]
    pub fn is_number(self) -> bool {
        match self {
            InferredType::Int | InferredType::Float(_) | InferredType::Unknown => true,
            InferredType::Bool | InferredType::Enum(_) | InferredType::Text | InferredType::List(_) => false,
        }
    }

    #[must_use]
    pub fn is_bare(self) -> bool {
        self.dim() == Some(Dimension::NUMBER)
    }
}

impl fmt::Display for InferredType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InferredType::Bool => f.write_str("a bool"),
            InferredType::Int => f.write_str("a whole number"),
            InferredType::Float(dim) => dim.fmt(f),
            InferredType::Enum(of) => write!(f, "a value of `{of}`"),
            InferredType::Text => f.write_str("a string"),
            InferredType::List(of) if of.element() == InferredType::Unknown => f.write_str("a list"),
            InferredType::List(_) => write!(f, "a list `{}`", self.type_name()),
            InferredType::Unknown => f.write_str("a value"),
        }
    }
}

/// A unit of the language: its symbol, dimension, and the factor to SI as a fraction, so that `55.55 cm` is exactly
/// `55.55 / 100`.
pub struct UnitOfMeasure {
    pub symbol: &'static str,
    pub dim: Dimension,
    times: f64,
    per: f64,
}

impl UnitOfMeasure {
    /// The number in SI units.
    #[must_use]
    pub fn to_si(&self, number: f64) -> f64 {
        number * self.times / self.per
    }

    #[must_use]
    pub fn of(symbol: &str) -> Option<&'static UnitOfMeasure> {
        UNITS.iter().find(|u| u.symbol == symbol)
    }
}

const fn unit(symbol: &'static str, dim: Dimension, times: f64, per: f64) -> UnitOfMeasure {
    UnitOfMeasure { symbol, dim, times, per }
}

/// All units, by dimension.
pub const UNITS: &[UnitOfMeasure] = &[
    unit("s", Dimension::TIME, 1.0, 1.0),
    unit("ms", Dimension::TIME, 1.0, 1e3),
    unit("us", Dimension::TIME, 1.0, 1e6),
    unit("ns", Dimension::TIME, 1.0, 1e9),
    unit("min", Dimension::TIME, 60.0, 1.0),
    unit("h", Dimension::TIME, 3600.0, 1.0),
    unit("m", Dimension::LENGTH, 1.0, 1.0),
    unit("cm", Dimension::LENGTH, 1.0, 1e2),
    unit("mm", Dimension::LENGTH, 1.0, 1e3),
    unit("um", Dimension::LENGTH, 1.0, 1e6),
    unit("km", Dimension::LENGTH, 1e3, 1.0),
    unit("rad", Dimension::ANGLE, 1.0, 1.0),
    unit("deg", Dimension::ANGLE, std::f64::consts::PI, 180.0),
    unit("kg", Dimension::MASS, 1.0, 1.0),
    unit("g", Dimension::MASS, 1.0, 1e3),
    unit("N", Dimension::FORCE, 1.0, 1.0),
    unit("mN", Dimension::FORCE, 1.0, 1e3),
    unit("kN", Dimension::FORCE, 1e3, 1.0),
    unit("m/s", Dimension::SPEED, 1.0, 1.0),
    unit("cm/s", Dimension::SPEED, 1.0, 1e2),
    unit("mm/s", Dimension::SPEED, 1.0, 1e3),
    unit("km/h", Dimension::SPEED, 1.0, 3.6),
    unit("rad/s", Dimension::ANGULAR_SPEED, 1.0, 1.0),
    unit("deg/s", Dimension::ANGULAR_SPEED, std::f64::consts::PI, 180.0),
    unit("rpm", Dimension::ANGULAR_SPEED, std::f64::consts::PI, 30.0),
    unit("m/s^2", Dimension::ACCELERATION, 1.0, 1.0),
    unit("cm/s^2", Dimension::ACCELERATION, 1.0, 1e2),
    unit("mm/s^2", Dimension::ACCELERATION, 1.0, 1e3),
    unit("rad/s^2", Dimension::ANGULAR_ACCELERATION, 1.0, 1.0),
    unit("deg/s^2", Dimension::ANGULAR_ACCELERATION, std::f64::consts::PI, 180.0),
    unit("Pa", Dimension::PRESSURE, 1.0, 1.0),
    unit("kPa", Dimension::PRESSURE, 1e3, 1.0),
    unit("N/cm^2", Dimension::PRESSURE, 1e4, 1.0),
    unit("Nm", Dimension::TORQUE, 1.0, 1.0),
    unit("N/m", Dimension::STIFFNESS, 1.0, 1.0),
    unit("N/mm", Dimension::STIFFNESS, 1e3, 1.0),
    unit("Ns/m", Dimension::DAMPING, 1.0, 1.0),
    unit("Nms/rad", Dimension::ANGULAR_DAMPING, 1.0, 1.0),
    unit("kgm^2", Dimension::INERTIA, 1.0, 1.0),
    unit("Hz", Dimension::FREQUENCY, 1.0, 1.0),
    unit("kHz", Dimension::FREQUENCY, 1e3, 1.0),
    unit("B", Dimension::DATA, 1.0, 1.0),
    unit("kB", Dimension::DATA, 1e3, 1.0),
    unit("MB", Dimension::DATA, 1e6, 1.0),
    unit("GB", Dimension::DATA, 1e9, 1.0),
    unit("KiB", Dimension::DATA, 1024.0, 1.0),
    unit("MiB", Dimension::DATA, 1_048_576.0, 1.0),
    unit("GiB", Dimension::DATA, 1_073_741_824.0, 1.0),
    unit("%", Dimension::NUMBER, 1.0, 1e2),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_as_fractions() {
        let si = |n, u: &str| UnitOfMeasure::of(u).unwrap().to_si(n);
        assert_eq!(si(55.55, "cm"), 0.5555);
        assert_eq!(si(3.0, "ms"), 0.003);
        assert_eq!(si(180.0, "deg"), std::f64::consts::PI);
        assert_eq!(si(2.0, "h"), 7200.0);
        assert_eq!(si(50.0, "%"), 0.5);
    }

    #[test]
    fn a_length_per_time_is_a_speed() {
        assert_eq!(Dimension::LENGTH.per(Dimension::TIME), Dimension::SPEED);
        assert_eq!(
            Dimension::MASS.times(Dimension::LENGTH).per(Dimension::TIME).per(Dimension::TIME),
            Dimension::FORCE
        );
        assert_eq!(Dimension::SPEED.to_string(), "a speed");
        assert_eq!(Dimension::LENGTH.times(Dimension::LENGTH).to_string(), "a quantity in m^2");
    }
}
