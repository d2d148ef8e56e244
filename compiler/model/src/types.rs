//! Types and dimensions: what a value is, and in which unit a quantity is counted.

use std::{
    fmt,
    sync::{Mutex, PoisonError},
};

use serde::Serialize;

use hrdsl_ir::{Type, Unit as SiUnit, Value, ta::Var};
use hrdsl_source::Enumeration;

/// A physical dimension: exponents of metre, kilogram, second, radian and byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Dim {
    pub m: i8,
    pub kg: i8,
    pub s: i8,
    pub rad: i8,
    #[serde(rename = "B")]
    pub byte: i8,
}

const fn dim(m: i8, kg: i8, s: i8, rad: i8) -> Dim {
    Dim { m, kg, s, rad, byte: 0 }
}

/// The dimensions that have a name: its type's name, the name in a sentence, its SI unit.
const NAMED: &[(Dim, &str, &str, SiUnit)] = &[
    (Dim::NUMBER, "number", "a bare number", SiUnit::None),
    (Dim::LENGTH, "length", "a length", SiUnit::Metre),
    (Dim::TIME, "time", "a time", SiUnit::Second),
    (Dim::ANGLE, "angle", "an angle", SiUnit::Radian),
    (Dim::MASS, "mass", "a mass", SiUnit::Kilogram),
    (Dim::FORCE, "force", "a force", SiUnit::Newton),
    (Dim::SPEED, "speed", "a speed", SiUnit::MetrePerSecond),
    (Dim::ANGULAR_SPEED, "angular_speed", "an angular speed", SiUnit::RadianPerSecond),
    (Dim::ACCELERATION, "acceleration", "an acceleration", SiUnit::MetrePerSecondSquared),
    (
        Dim::ANGULAR_ACCELERATION,
        "angular_acceleration",
        "an angular acceleration",
        SiUnit::RadianPerSecondSquared,
    ),
    (Dim::PRESSURE, "pressure", "a pressure", SiUnit::Pascal),
    (Dim::TORQUE, "torque", "a torque", SiUnit::NewtonMetre),
    (Dim::FREQUENCY, "frequency", "a frequency", SiUnit::Hertz),
    (Dim::DATA, "data", "an amount of data", SiUnit::Byte),
];

impl Dim {
    pub const NUMBER: Dim = dim(0, 0, 0, 0);
    pub const LENGTH: Dim = dim(1, 0, 0, 0);
    pub const TIME: Dim = dim(0, 0, 1, 0);
    pub const ANGLE: Dim = dim(0, 0, 0, 1);
    pub const MASS: Dim = dim(0, 1, 0, 0);
    pub const FORCE: Dim = dim(1, 1, -2, 0);
    pub const SPEED: Dim = dim(1, 0, -1, 0);
    pub const ANGULAR_SPEED: Dim = dim(0, 0, -1, 1);
    pub const ACCELERATION: Dim = dim(1, 0, -2, 0);
    pub const ANGULAR_ACCELERATION: Dim = dim(0, 0, -2, 1);
    pub const PRESSURE: Dim = dim(-1, 1, -2, 0);
    pub const TORQUE: Dim = dim(2, 1, -2, 0);
    pub const FREQUENCY: Dim = dim(0, 0, -1, 0);
    pub const DATA: Dim = Dim { byte: 1, ..Dim::NUMBER };

    /// The dimension of a product.
    #[must_use]
    pub fn times(self, other: Dim) -> Dim {
        self.combine(other, i8::saturating_add)
    }

    /// The dimension of a quotient.
    #[must_use]
    pub fn per(self, other: Dim) -> Dim {
        self.combine(other, i8::saturating_sub)
    }

    fn combine(self, other: Dim, by: fn(i8, i8) -> i8) -> Dim {
        Dim {
            m: by(self.m, other.m),
            kg: by(self.kg, other.kg),
            s: by(self.s, other.s),
            rad: by(self.rad, other.rad),
            byte: by(self.byte, other.byte),
        }
    }

    /// The dimension that is counted in this unit.
    #[must_use]
    pub fn of(unit: SiUnit) -> Dim {
        NAMED.iter().find(|n| n.3 == unit).map_or(Dim::NUMBER, |n| n.0)
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

impl fmt::Display for Dim {
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
pub struct Of<T: 'static>(&'static T);

impl<T> Clone for Of<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Of<T> {}

impl<T> PartialEq for Of<T> {
    fn eq(&self, other: &Self) -> bool {
        // INVARIANT: equal ones are one; see [`kept`].
        std::ptr::eq(self.0, other.0)
    }
}

impl<T> Eq for Of<T> {}

/// The one place where this is kept; there are few of them.
fn kept<T: PartialEq>(known: &Mutex<Vec<&'static T>>, of: T) -> Of<T> {
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().find(|t| ***t == of) {
        return Of(same);
    }
    let of: &'static T = Box::leak(Box::new(of));
    known.push(of);
    Of(of)
}

static KINDS: Mutex<Vec<&'static Kind>> = Mutex::new(Vec::new());

impl Of<Kind> {
    #[must_use]
    pub fn new(of: Kind) -> Self {
        kept(&KINDS, of)
    }

    #[must_use]
    pub fn element(self) -> Kind {
        *self.0
    }
}

/// A declared type, perhaps of several parts. Everything behind the checker knows the parts alone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layout {
    Scalar(Type),
    /// Into the checker's records.
    Record(u16),
    /// Of this many.
    Array(Box<Layout>, u16),
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
pub(crate) fn finite_var(name: &str, ty: Type) -> Var {
    let flag = || Var { name: name.to_owned(), lo: 0, hi: 1, init: 0, is_bool: true, enumeration: None };
    Var::of_type(name, ty).unwrap_or_else(flag)
}

/// The same, with what it starts with.
pub(crate) fn starting_var(name: &str, ty: Type, init: Value) -> Var {
    let var = finite_var(name, ty);
    Var { init: var.number(init).unwrap_or(var.init), ..var }
}

/// The names that [`type_named`] knows.
pub fn type_names() -> impl Iterator<Item = &'static str> {
    ["bool", "int", "float", "string"].into_iter().chain(NAMED.iter().map(|n| n.1))
}

/// What an expression yields, as far as the checker can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Bool,
    Int,
    Float(Dim),
    Enum(Enumeration),
    Text,
    List(Of<Kind>),
    /// Not known: a goal's argument, or an expression that already has a diagnostic. It fits everywhere.
    Unknown,
}

impl Kind {
    /// What a value of this type is.
    #[must_use]
    pub fn of(ty: Type) -> Kind {
        match ty {
            Type::Bool => Kind::Bool,
            Type::Int { .. } => Kind::Int,
            Type::Float(unit) => Kind::Float(Dim::of(unit)),
            Type::Enum(id) => Kind::Enum(id),
            Type::Text => Kind::Text,
            Type::List(of) => Kind::list(Kind::of(of.element())),
        }
    }

    /// A list of such elements.
    #[must_use]
    pub fn list(of: Kind) -> Kind {
        Kind::List(Of::<Kind>::new(of))
    }

    /// What the elements are, if it may be a list.
    #[must_use]
    pub fn element(self) -> Option<Kind> {
        match self {
            Kind::List(of) => Some(of.element()),
            Kind::Unknown => Some(Kind::Unknown),
            Kind::Bool | Kind::Int | Kind::Float(_) | Kind::Enum(_) | Kind::Text => None,
        }
    }

    /// What is known if something is of both kinds; `None`: nothing is.
    #[must_use]
    pub fn with(self, other: Kind) -> Option<Kind> {
        match (self, other) {
            (Kind::Unknown, known) | (known, Kind::Unknown) => Some(known),
            (Kind::List(a), Kind::List(b)) => a.element().with(b.element()).map(Kind::list),
            (a, b) => (a == b).then_some(a),
        }
    }

    /// The type's name, as it is declared.
    pub(crate) fn type_name(self) -> String {
        match self {
            Kind::Bool => "bool".to_owned(),
            Kind::Int => "int".to_owned(),
            Kind::Float(dim) => {
                NAMED.iter().find(|n| n.0 == dim).map_or_else(|| dim.to_string(), |n| n.1.to_owned())
            }
            Kind::Enum(of) => of.name().to_owned(),
            Kind::Text => "string".to_owned(),
            Kind::List(of) => format!("[{}]", of.element().type_name()),
            Kind::Unknown => "_".to_owned(),
        }
    }

    /// The dimension of a number; a whole number is a bare number.
    #[must_use]
    pub fn dim(self) -> Option<Dim> {
        match self {
            Kind::Int => Some(Dim::NUMBER),
            Kind::Float(dim) => Some(dim),
            Kind::Bool | Kind::Enum(_) | Kind::Text | Kind::List(_) | Kind::Unknown => None,
        }
    }

    /// Whether it may be a number.
    #[must_use]
    pub fn is_number(self) -> bool {
        match self {
            Kind::Int | Kind::Float(_) | Kind::Unknown => true,
            Kind::Bool | Kind::Enum(_) | Kind::Text | Kind::List(_) => false,
        }
    }

    #[must_use]
    pub fn is_bare(self) -> bool {
        self.dim() == Some(Dim::NUMBER)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Kind::Bool => f.write_str("a bool"),
            Kind::Int => f.write_str("a whole number"),
            Kind::Float(dim) => dim.fmt(f),
            Kind::Enum(of) => write!(f, "a value of `{of}`"),
            Kind::Text => f.write_str("a string"),
            Kind::List(of) if of.element() == Kind::Unknown => f.write_str("a list"),
            Kind::List(_) => write!(f, "a list `{}`", self.type_name()),
            Kind::Unknown => f.write_str("a value"),
        }
    }
}

/// A unit of the language: its symbol, dimension, and the factor to SI as a fraction, so that `55.55 cm` is exactly
/// `55.55 / 100`.
pub struct Unit {
    pub symbol: &'static str,
    pub dim: Dim,
    times: f64,
    per: f64,
}

impl Unit {
    /// The number in SI units.
    #[must_use]
    pub fn to_si(&self, number: f64) -> f64 {
        number * self.times / self.per
    }

    #[must_use]
    pub fn of(symbol: &str) -> Option<&'static Unit> {
        UNITS.iter().find(|u| u.symbol == symbol)
    }
}

const fn unit(symbol: &'static str, dim: Dim, times: f64, per: f64) -> Unit {
    Unit { symbol, dim, times, per }
}

/// All units, by dimension.
pub const UNITS: &[Unit] = &[
    unit("s", Dim::TIME, 1.0, 1.0),
    unit("ms", Dim::TIME, 1.0, 1e3),
    unit("us", Dim::TIME, 1.0, 1e6),
    unit("ns", Dim::TIME, 1.0, 1e9),
    unit("min", Dim::TIME, 60.0, 1.0),
    unit("h", Dim::TIME, 3600.0, 1.0),
    unit("m", Dim::LENGTH, 1.0, 1.0),
    unit("cm", Dim::LENGTH, 1.0, 1e2),
    unit("mm", Dim::LENGTH, 1.0, 1e3),
    unit("um", Dim::LENGTH, 1.0, 1e6),
    unit("km", Dim::LENGTH, 1e3, 1.0),
    unit("rad", Dim::ANGLE, 1.0, 1.0),
    unit("deg", Dim::ANGLE, std::f64::consts::PI, 180.0),
    unit("kg", Dim::MASS, 1.0, 1.0),
    unit("g", Dim::MASS, 1.0, 1e3),
    unit("N", Dim::FORCE, 1.0, 1.0),
    unit("mN", Dim::FORCE, 1.0, 1e3),
    unit("kN", Dim::FORCE, 1e3, 1.0),
    unit("m/s", Dim::SPEED, 1.0, 1.0),
    unit("cm/s", Dim::SPEED, 1.0, 1e2),
    unit("mm/s", Dim::SPEED, 1.0, 1e3),
    unit("km/h", Dim::SPEED, 1.0, 3.6),
    unit("rad/s", Dim::ANGULAR_SPEED, 1.0, 1.0),
    unit("deg/s", Dim::ANGULAR_SPEED, std::f64::consts::PI, 180.0),
    unit("rpm", Dim::ANGULAR_SPEED, std::f64::consts::PI, 30.0),
    unit("m/s^2", Dim::ACCELERATION, 1.0, 1.0),
    unit("cm/s^2", Dim::ACCELERATION, 1.0, 1e2),
    unit("mm/s^2", Dim::ACCELERATION, 1.0, 1e3),
    unit("rad/s^2", Dim::ANGULAR_ACCELERATION, 1.0, 1.0),
    unit("deg/s^2", Dim::ANGULAR_ACCELERATION, std::f64::consts::PI, 180.0),
    unit("Pa", Dim::PRESSURE, 1.0, 1.0),
    unit("kPa", Dim::PRESSURE, 1e3, 1.0),
    unit("N/cm^2", Dim::PRESSURE, 1e4, 1.0),
    unit("Nm", Dim::TORQUE, 1.0, 1.0),
    unit("Hz", Dim::FREQUENCY, 1.0, 1.0),
    unit("kHz", Dim::FREQUENCY, 1e3, 1.0),
    unit("B", Dim::DATA, 1.0, 1.0),
    unit("kB", Dim::DATA, 1e3, 1.0),
    unit("MB", Dim::DATA, 1e6, 1.0),
    unit("GB", Dim::DATA, 1e9, 1.0),
    unit("KiB", Dim::DATA, 1024.0, 1.0),
    unit("MiB", Dim::DATA, 1_048_576.0, 1.0),
    unit("GiB", Dim::DATA, 1_073_741_824.0, 1.0),
    unit("%", Dim::NUMBER, 1.0, 1e2),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_as_fractions() {
        let si = |n, u: &str| Unit::of(u).unwrap().to_si(n);
        assert_eq!(si(55.55, "cm"), 0.5555);
        assert_eq!(si(3.0, "ms"), 0.003);
        assert_eq!(si(180.0, "deg"), std::f64::consts::PI);
        assert_eq!(si(2.0, "h"), 7200.0);
        assert_eq!(si(50.0, "%"), 0.5);
    }

    #[test]
    fn a_length_per_time_is_a_speed() {
        assert_eq!(Dim::LENGTH.per(Dim::TIME), Dim::SPEED);
        assert_eq!(Dim::MASS.times(Dim::LENGTH).per(Dim::TIME).per(Dim::TIME), Dim::FORCE);
        assert_eq!(Dim::SPEED.to_string(), "a speed");
        assert_eq!(Dim::LENGTH.times(Dim::LENGTH).to_string(), "a quantity in m^2");
    }
}
