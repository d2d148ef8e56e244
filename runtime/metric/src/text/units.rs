//! The units that literals can have. They are those of the language; a test compares them.

use hrdsl_ir::Unit;

/// A unit: its symbol, the SI unit in which values are kept, and the factor to it as a fraction, so that `55.55 cm` is exactly `55.55 / 100`.
#[derive(Debug)]
pub struct LiteralUnit {
    pub symbol: &'static str,
    pub si: Unit,
    times: f64,
    per: f64,
}

impl LiteralUnit {
    /// The number in the SI unit.
    #[must_use]
    pub fn to_si(&self, number: f64) -> f64 {
        number * self.times / self.per
    }
}

const fn unit(symbol: &'static str, si: Unit, times: f64, per: f64) -> LiteralUnit {
    LiteralUnit { symbol, si, times, per }
}

const HALF_TURN: f64 = std::f64::consts::PI;

/// All units, by what they measure.
pub const LITERAL_UNITS: &[LiteralUnit] = &[
    unit("s", Unit::Second, 1.0, 1.0),
    unit("ms", Unit::Second, 1.0, 1e3),
    unit("us", Unit::Second, 1.0, 1e6),
    unit("ns", Unit::Second, 1.0, 1e9),
    unit("min", Unit::Second, 60.0, 1.0),
    unit("h", Unit::Second, 3600.0, 1.0),
    unit("m", Unit::Metre, 1.0, 1.0),
    unit("cm", Unit::Metre, 1.0, 1e2),
    unit("mm", Unit::Metre, 1.0, 1e3),
    unit("um", Unit::Metre, 1.0, 1e6),
    unit("km", Unit::Metre, 1e3, 1.0),
    unit("rad", Unit::Radian, 1.0, 1.0),
    unit("deg", Unit::Radian, HALF_TURN, 180.0),
    unit("kg", Unit::Kilogram, 1.0, 1.0),
    unit("g", Unit::Kilogram, 1.0, 1e3),
    unit("N", Unit::Newton, 1.0, 1.0),
    unit("mN", Unit::Newton, 1.0, 1e3),
    unit("kN", Unit::Newton, 1e3, 1.0),
    unit("m/s", Unit::MetrePerSecond, 1.0, 1.0),
    unit("cm/s", Unit::MetrePerSecond, 1.0, 1e2),
    unit("mm/s", Unit::MetrePerSecond, 1.0, 1e3),
    unit("km/h", Unit::MetrePerSecond, 1.0, 3.6),
    unit("rad/s", Unit::RadianPerSecond, 1.0, 1.0),
    unit("deg/s", Unit::RadianPerSecond, HALF_TURN, 180.0),
    unit("rpm", Unit::RadianPerSecond, HALF_TURN, 30.0),
    unit("m/s^2", Unit::MetrePerSecondSquared, 1.0, 1.0),
    unit("cm/s^2", Unit::MetrePerSecondSquared, 1.0, 1e2),
    unit("mm/s^2", Unit::MetrePerSecondSquared, 1.0, 1e3),
    unit("rad/s^2", Unit::RadianPerSecondSquared, 1.0, 1.0),
    unit("deg/s^2", Unit::RadianPerSecondSquared, HALF_TURN, 180.0),
    unit("Pa", Unit::Pascal, 1.0, 1.0),
    unit("kPa", Unit::Pascal, 1e3, 1.0),
    unit("N/cm^2", Unit::Pascal, 1e4, 1.0),
    unit("Nm", Unit::NewtonMetre, 1.0, 1.0),
    unit("N/m", Unit::NewtonPerMetre, 1.0, 1.0),
    unit("N/mm", Unit::NewtonPerMetre, 1e3, 1.0),
    unit("Ns/m", Unit::NewtonSecondPerMetre, 1.0, 1.0),
    unit("Nms/rad", Unit::NewtonMetreSecondPerRadian, 1.0, 1.0),
    unit("kgm^2", Unit::KilogramSquareMetre, 1.0, 1.0),
    unit("Hz", Unit::Hertz, 1.0, 1.0),
    unit("kHz", Unit::Hertz, 1e3, 1.0),
    unit("B", Unit::Byte, 1.0, 1.0),
    unit("kB", Unit::Byte, 1e3, 1.0),
    unit("MB", Unit::Byte, 1e6, 1.0),
    unit("GB", Unit::Byte, 1e9, 1.0),
    unit("KiB", Unit::Byte, 1024.0, 1.0),
    unit("MiB", Unit::Byte, 1_048_576.0, 1.0),
    unit("GiB", Unit::Byte, 1_073_741_824.0, 1.0),
    unit("%", Unit::None, 1.0, 1e2),
];
