//! Bounds on times and signals that the runs of the original keep, and that people can read.

use std::ops::RangeInclusive;

use hrdsl_ir::{Nanos, value::seconds};

/// Bounds on times are so much longer than the longest that was seen: the next test may take a little longer.
pub(crate) const LEEWAY: f64 = 1.05;
/// Where only that tells a mutant from the original, they have none.
pub(crate) const NO_LEEWAY: f64 = 1.0;
/// The step of bounds on times, in seconds.
const TIME_STEP: f64 = 0.1;
/// Digits of a bound on a signal: so many if that tells a mutant from the original, and more only if not.
const DIGITS: RangeInclusive<i32> = 3..=4;

/// A bound in seconds that the longest time keeps, with some leeway.
pub(crate) fn time_bound(longest: Nanos, leeway: f64) -> f64 {
    let steps = (seconds(longest) * leeway / TIME_STEP).ceil().max(1.0);
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// A bound in seconds that the shortest time keeps, with some leeway; 0 if there is no room for one.
pub(crate) fn earliest(shortest: Nanos, leeway: f64) -> f64 {
    let steps = (seconds(shortest) / leeway / TIME_STEP).floor();
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// The next number in a direction with as few digits as a bound may have.
pub(crate) fn readable(value: f64, direction: f64) -> f64 {
    beyond(value, direction, *DIGITS.start())
}

/// A number between what all runs of the original keep and what another run has, at no distance from the former that can be helped.
pub(crate) fn between(kept: f64, other: f64) -> Option<f64> {
    let direction = other - kept;
    let mut bounds = DIGITS.map(|digits| beyond(kept, direction, digits));
    bounds.find(|bound| (other - bound) * direction > 0.0)
}

/// The next number in a direction with so many digits: a bound that is kept by what was seen, and can be read.
fn beyond(value: f64, direction: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10_f64.powi(digits - 1 - value.abs().log10().floor() as i32);
    let scaled = if direction > 0.0 { (value * scale).ceil() } else { (value * scale).floor() };
    // Through its decimal text, so that it is written with these digits.
    format!("{:.6e}", scaled / scale).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::value::SECOND;

    use super::*;

    #[test]
    fn bounds_are_kept_by_what_was_seen_and_can_be_read() {
        assert_eq!(time_bound(0, LEEWAY), 0.1);
        let three = 3 * SECOND;
        assert_eq!(
            (time_bound(three, LEEWAY), earliest(three, LEEWAY), earliest(SECOND / 20, LEEWAY)),
            (3.2, 2.8, 0.0)
        );
        assert_eq!((time_bound(three, NO_LEEWAY), earliest(three, NO_LEEWAY)), (3.0, 3.0));
        assert_eq!((beyond(0.123_41, 1.0, 3), beyond(0.123_41, -1.0, 3)), (0.124, 0.123));
        assert_eq!((beyond(-7.001, 1.0, 3), beyond(-7.001, -1.0, 3)), (-7.0, -7.01));
        assert_eq!((beyond(1234.5, 1.0, 3), beyond(0.0, 1.0, 3)), (1240.0, 0.0));
    }

    #[test]
    fn a_bound_has_as_many_digits_as_it_needs() {
        assert_eq!(between(0.7051, 0.9), Some(0.706));
        assert_eq!(between(0.705_12, 0.7055), Some(0.7052), "0.706 would be kept, too");
        assert_eq!(between(0.705_12, 0.705_13), None, "nobody would ask for that");
        assert_eq!(between(0.7051, 0.2), Some(0.705));
        assert_eq!((between(1.0, 0.0), between(0.0, 1.0), between(1.0, 1.0)), (Some(1.0), Some(0.0), None));
    }
}
