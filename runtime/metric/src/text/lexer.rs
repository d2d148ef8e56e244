//! A formula's text to tokens.

use super::{
    error::{FormulaError, TextRange},
    units::{LITERAL_UNITS, LiteralUnit},
};

#[derive(Clone, Debug)]
pub(crate) enum FormulaTokenKind {
    Number(f64, Option<&'static LiteralUnit>),
    /// A name, a word, or names joined by points.
    Word,
    Sign(&'static str),
}

#[derive(Clone, Debug)]
pub(crate) struct FormulaToken {
    pub kind: FormulaTokenKind,
    pub range: TextRange,
}

/// Longer ones first.
const SIGNS: [&str; 22] = [
    "->", "<=", ">=", "==", "!=", "&&", "||", "<", ">", "!", "(", ")", "[", "]", ",", "+", "-", "*", "/",
    "@", "=", ":",
];

pub(crate) fn tokens(text: &str) -> Result<Vec<FormulaToken>, FormulaError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(rest) = text.get(at..)
        && let Some(first) = rest.chars().next()
    {
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (kind, length) = if first.is_ascii_digit() {
            number(rest, at)?
        } else if is_name(first) && first != '.' {
            (FormulaTokenKind::Word, length_while(rest, is_name))
        } else if let Some(sign) = SIGNS.into_iter().find(|s| rest.starts_with(s)) {
            (FormulaTokenKind::Sign(sign), sign.len())
        } else {
            let range = at..at + first.len_utf8();
            return Err(FormulaError::new(&range, format!("`{first}` is nothing in a formula")));
        };
        tokens.push(FormulaToken { kind, range: at..at + length });
        at += length;
    }
    Ok(tokens)
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

fn length_while(text: &str, of: impl Fn(char) -> bool) -> usize {
    text.find(|c| !of(c)).unwrap_or(text.len())
}

/// A number, with the unit behind it if there is one.
fn number(rest: &str, at: usize) -> Result<(FormulaTokenKind, usize), FormulaError> {
    let mut length = length_while(rest, |c| c.is_ascii_digit() || c == '.' || c == '_');
    let after = rest.get(length..).unwrap_or_default();
    let exponent = after.strip_prefix(['e', 'E']).map(|e| e.strip_prefix(['+', '-']).unwrap_or(e));
    if let Some(digits) = exponent.filter(|e| e.starts_with(|c: char| c.is_ascii_digit())) {
        length += after.len() - digits.len() + length_while(digits, |c| c.is_ascii_digit());
    }
    let digits = rest.get(..length).unwrap_or_default();
    let number = digits
        .replace('_', "")
        .parse()
        .map_err(|_| FormulaError::new(&(at..at + length), format!("`{digits}` is no number")))?;
    let after = rest.get(length..).unwrap_or_default();
    let blanks = length_while(after, |c| c == ' ');
    let place = after.get(blanks..).unwrap_or_default();
    let fits = |u: &&LiteralUnit| {
        let end = place.strip_prefix(u.symbol).map(|rest| rest.chars().next());
        end.is_some_and(|next| u.symbol == "%" || next.is_none_or(|c| !is_name(c) && c != '^'))
    };
    let unit = LITERAL_UNITS.iter().filter(fits).max_by_key(|u| u.symbol.len());
    let length = unit.map_or(length, |u| length + blanks + u.symbol.len());
    Ok((FormulaTokenKind::Number(number, unit), length))
}
