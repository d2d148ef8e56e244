//! Whole numbers of a fine unit as decimal text, and back.

use std::fmt::Write;

/// `n` of `1/scale`, where `scale` is a power of ten: as many digits as it needs.
pub(crate) fn decimal(n: i64, scale: u64) -> String {
    let mut text = String::new();
    write_decimal(&mut text, n, scale);
    text
}

/// The same, behind what a text already has.
pub(crate) fn write_decimal(text: &mut String, n: i64, scale: u64) {
    if n < 0 {
        text.push('-');
    }
    // Into a string this cannot fail.
    _ = write!(text, "{}", n.unsigned_abs() / scale);
    let (mut rest, mut unit) = (n.unsigned_abs() % scale, scale / 10);
    if rest > 0 {
        text.push('.');
    }
    while rest > 0 {
        text.push(char::from(b'0' + (rest / unit) as u8));
        rest %= unit;
        unit /= 10;
    }
}

/// The same number with at most so many digits behind the point, and never a negative zero.
pub(crate) fn rounded(x: f64, scale: f64) -> f64 {
    (x * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use hrdsl_trace::picture::whole;

    use super::decimal;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        for (n, text) in [(0, "0"), (10_000, "1"), (-5, "-0.0005"), (12_340, "1.234"), (-20_001, "-2.0001")] {
            assert_eq!(decimal(n, 10_000), text);
            assert_eq!(whole(text.parse().unwrap(), 10_000.0), n);
        }
    }
}
