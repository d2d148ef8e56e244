//! Times as decimal numbers of seconds, exact to the nanosecond: no float is involved.

use hrdsl_ir::Nanos;

const PER_SECOND: u64 = 1_000_000_000;

/// Seconds as a decimal number without superfluous digits: `1.25`, `300`, `0.000000001`.
#[must_use]
pub fn seconds(time: Nanos) -> String {
    let (whole, fraction) = (time.unsigned_abs() / PER_SECOND, time.unsigned_abs() % PER_SECOND);
    let sign = if time < 0 { "-" } else { "" };
    if fraction == 0 {
        return format!("{sign}{whole}");
    }
    let digits = format!("{fraction:09}");
    format!("{sign}{whole}.{}", digits.trim_end_matches('0'))
}

/// Nanoseconds from a decimal number of seconds, with or without exponent. Digits beyond the ninth place, which other
/// programs write when they print binary floats, are rounded to the nearest, halves away from zero.
///
/// `None`: it is no such number, or too large.
#[must_use]
pub fn nanos(text: &str) -> Option<Nanos> {
    short_nanos(text).or_else(|| long_nanos(text))
}

/// Numbers of a few digits without sign and exponent, which nearly all are.
fn short_nanos(text: &str) -> Option<Nanos> {
    let (mut value, mut places, mut is_fraction) = (0_i64, 0_u32, false);
    if text.len() > 17 || !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    for byte in text.bytes() {
        match byte {
            b'0'..=b'9' => {
                value = value * 10 + i64::from(byte - b'0');
                places += u32::from(is_fraction);
            }
            b'.' if !is_fraction => is_fraction = true,
            _ => return None,
        }
    }
    value.checked_mul(10_i64.checked_pow(9_u32.checked_sub(places)?)?)
}

fn long_nanos(text: &str) -> Option<Nanos> {
    let (negative, text) = text.strip_prefix('-').map_or((false, text), |rest| (true, rest));
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let mut digits = whole.bytes().chain(fraction.bytes());
    if whole.is_empty() || !digits.clone().all(|d| d.is_ascii_digit()) {
        return None;
    }
    // How many digits are left of the point once it is moved to count nanoseconds.
    let kept = i64::try_from(whole.len()).ok()? + i64::from(exponent) + 9;
    let mut value: i128 = 0;
    for _ in 0..kept {
        let digit = match digits.next() {
            Some(digit) => digit - b'0',
            None if value == 0 => break,
            None => 0,
        };
        value = value.checked_mul(10)?.checked_add(i128::from(digit))?;
    }
    if kept >= 0 && digits.next().is_some_and(|digit| digit >= b'5') {
        value += 1;
    }
    Nanos::try_from(if negative { -value } else { value }).ok()
}
