//! Numbers as descriptions write them: apart by blanks, finite.

use crate::fault::{RobotFault, RobotFaultKind, RobotPlace};

/// One number.
pub(crate) fn number_in(text: &str, place: RobotPlace) -> Result<f64, RobotFault> {
    let word = text.trim();
    let help = "write a number with a point: 0.5";
    let number: f64 = word.parse().map_err(|_| RobotFaultKind::BadNumber(word.to_owned()).at(place, help))?;
    if number.is_finite() {
        Ok(number)
    } else {
        Err(RobotFaultKind::NotFinite(word.to_owned()).at(place, help))
    }
}

/// Exactly so many.
pub(crate) fn numbers_in<const N: usize>(text: &str, place: RobotPlace) -> Result<[f64; N], RobotFault> {
    let numbers =
        text.split_whitespace().map(|word| number_in(word, place)).collect::<Result<Vec<f64>, _>>()?;
    <[f64; N]>::try_from(numbers).map_err(|numbers| {
        let kind = RobotFaultKind::WrongCount { expected: N, found: numbers.len() };
        let example = ["0"; N].join(" ");
        kind.at(place, format!("write {N} numbers with blanks between them: {example}"))
    })
}
