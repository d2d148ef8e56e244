//! The units in which a scenario writes its numbers: in them people read what is held to these.

use std::collections::BTreeMap;

use hrdsl_ir::Unit;
use hrdsl_metric::{LITERAL_UNITS, LiteralUnit};

use crate::requirement::ShownUnit;

/// Two numbers are the same one if they differ by so little of it.
const SAME: f64 = 1e-9;

/// A number with a unit, as it stands in a text.
#[derive(Clone, Copy, Debug)]
struct NumberWithUnit {
    /// In the SI unit.
    value: f64,
    unit: &'static LiteralUnit,
}

/// The numbers with units of a scenario's texts, and its constants that are one.
#[derive(Clone, Debug, Default)]
pub struct WrittenUnits {
    numbers: Vec<NumberWithUnit>,
    constants: BTreeMap<String, NumberWithUnit>,
}

impl WrittenUnits {
    /// Those of these texts; what comes first counts first.
    pub fn of<'t>(texts: impl IntoIterator<Item = &'t str>) -> Self {
        let mut found = Self::default();
        for line in texts.into_iter().flat_map(str::lines) {
            let line = line.split("//").next().unwrap_or(line);
            found.numbers.extend(numbers(line));
            if let Some((name, value)) =
                line.trim_start().strip_prefix("const ").and_then(|c| c.split_once('='))
            {
                let name = name.split(':').next().unwrap_or(name).trim();
                if let Some(number) = numbers(value).first() {
                    found.constants.entry(name.to_owned()).or_insert(*number);
                }
            }
        }
        found
    }

    /// The unit in which a limit is written: in the text that it is from, somewhere in the scenario, or as what the text names.
    pub(super) fn shown(&self, unit: Unit, limit: f64, text: &str) -> Option<ShownUnit> {
        let fits = |number: &&NumberWithUnit| number.unit.si == unit && unit != Unit::None;
        let is_it = |number: &&NumberWithUnit| {
            fits(number) && (number.value - limit.abs()).abs() <= SAME * limit.abs().max(SAME)
        };
        let own = numbers(text);
        let named: Vec<NumberWithUnit> =
            words(text).filter_map(|word| self.constants.get(word)).copied().collect();
        let number = own
            .iter()
            .chain(&named)
            .find(is_it)
            .or_else(|| self.numbers.iter().find(is_it))
            .or_else(|| own.iter().chain(&named).find(fits))?;
        Some(ShownUnit { symbol: number.unit.symbol.to_owned(), size: number.unit.to_si(1.0) })
    }
}

/// The names in a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !is_of_name(c)).filter(|word| !word.is_empty())
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The numbers with units in a line.
fn numbers(line: &str) -> Vec<NumberWithUnit> {
    let mut found = Vec::new();
    let mut rest = line;
    let mut before = ' ';
    while let Some(c) = rest.chars().next() {
        let is_begin = c.is_ascii_digit() && !is_of_name(before) && before != '.';
        if !is_begin {
            before = c;
            rest = rest.get(c.len_utf8()..).unwrap_or_default();
            continue;
        }
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let (number, behind) = rest.split_at(end);
        // In `2..5 cm` the second number has the unit.
        let behind_blanks = behind.trim_start();
        if let (Ok(number), Some(unit)) = (number.parse::<f64>(), unit_at(behind_blanks)) {
            found.push(NumberWithUnit { value: unit.to_si(number), unit });
        }
        before = '0';
        rest = behind;
    }
    found
}

/// The unit with which a text begins; the longest.
fn unit_at(text: &str) -> Option<&'static LiteralUnit> {
    let fits = |unit: &&LiteralUnit| {
        text.strip_prefix(unit.symbol).is_some_and(|rest| !rest.starts_with(is_of_name))
    };
    LITERAL_UNITS.iter().filter(fits).max_by_key(|unit| unit.symbol.len())
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::Unit;

    use super::WrittenUnits;

    #[test]
    fn a_limit_is_shown_in_the_unit_in_which_it_is_written() {
        let written = WrittenUnits::of([
            "const LIMIT = 25 cm // by 1 s\nconst SLACK: length = 5 mm\n",
            "on rising(tilt(base) > 50 deg) emit fell\nspeed(x) < 2 km/h, near2 3 m",
        ]);
        let shown = |unit, limit, text: &str| written.shown(unit, limit, text).map(|shown| shown.symbol);
        let is = |symbol: &str| Some(symbol.to_owned());
        assert_eq!(shown(Unit::Radian, 50_f64.to_radians(), ""), is("deg"));
        assert_eq!(shown(Unit::MetrePerSecond, 2.0 / 3.6, ""), is("km/h"));
        assert_eq!(shown(Unit::Metre, 3.0, ""), is("m"));
        assert_eq!(shown(Unit::Metre, 0.05, "never near while distance(a, b) < 50 mm"), is("mm"));
        assert_eq!(
            shown(Unit::Metre, 0.255, "globally way < LIMIT + SLACK"),
            is("cm"),
            "as what it is the sum of"
        );
        assert_eq!(shown(Unit::Metre, 0.7, "globally way < FAR"), None);
        assert_eq!(shown(Unit::Second, 0.25, ""), None, "what is in a comment is not written");
        let degree = written.shown(Unit::Radian, 50_f64.to_radians(), "").unwrap();
        assert!((degree.size - 1_f64.to_radians()).abs() < 1e-12);
    }
}
