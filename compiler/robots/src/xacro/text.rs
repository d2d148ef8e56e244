//! Texts in pieces: what stands as it is, `${…}`, `$(…)`.

use std::ops::Range;

use hrdsl_source::Span;

use super::value::{EvalResult, wrong};
use crate::fault::RobotPlace;

/// A text, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct XacroText<'a> {
    pub text: &'a str,
    pub place: RobotPlace,
}

impl<'a> XacroText<'a> {
    /// A part of it; its exact place, unless escapes such as `&lt;` make the text shorter than what is written.
    pub fn part(self, range: Range<usize>) -> XacroText<'a> {
        let Span { file, start, end } = self.place.span;
        let place = if (end - start) as usize == self.text.len() {
            let span = Span::new(file, start as usize + range.start, start as usize + range.end);
            RobotPlace { span, ..self.place }
        } else {
            self.place
        };
        XacroText { text: self.text.get(range).unwrap_or_default(), place }
    }
}

/// A piece of a text, by its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TextPiece {
    Plain(Range<usize>),
    /// What stands between `${` and `}`.
    Expression(Range<usize>),
    /// What stands between `$(` and `)`.
    Substitution(Range<usize>),
}

pub(super) fn pieces(text: &str) -> EvalResult<Vec<TextPiece>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        let dollars = rest.len() - rest.trim_start_matches('$').len();
        let after = rest.get(dollars..).unwrap_or_default();
        let opens = after.starts_with(['{', '(']);
        if dollars == 0 {
            let length = rest.find('$').unwrap_or(rest.len());
            found.push(TextPiece::Plain(at..at + length));
            at += length;
        } else if opens && dollars > 1 {
            // One `$` too many says that it is meant as it is.
            found.push(TextPiece::Plain(at + 1..at + dollars + 1));
            at += dollars + 1;
        } else if opens {
            let is_expression = after.starts_with('{');
            let close = if is_expression { '}' } else { ')' };
            let Some(length) = rest.find(close) else {
                return wrong(
                    format!("a `{close}` is missing"),
                    format!("write `{close}`, or `$$` for a dollar sign"),
                );
            };
            let inside = at + 2..at + length;
            found.push(if is_expression {
                TextPiece::Expression(inside)
            } else {
                TextPiece::Substitution(inside)
            });
            at += length + 1;
        } else {
            found.push(TextPiece::Plain(at..at + dollars));
            at += dollars;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use TextPiece::{Expression, Plain, Substitution};

    #[test]
    fn texts_fall_into_pieces() {
        assert_eq!(
            pieces("a${b}$(c)d").unwrap(),
            [Plain(0..1), Expression(3..4), Substitution(7..8), Plain(9..10)]
        );
        assert_eq!(
            pieces("$${a} $b $").unwrap(),
            [Plain(1..3), Plain(3..6), Plain(6..7), Plain(7..9), Plain(9..10)]
        );
        assert_eq!(pieces("").unwrap(), []);
        assert!(pieces("${a").is_err() && pieces("$(a").is_err());
    }
}
