//! Expressions as words: numbers, texts, names, signs.

use super::value::{EvalResult, XacroValue, not_done, wrong};

/// How many words an expression may have: its tree is gone through by calls.
const MOST_WORDS: usize = 800;

#[derive(Clone, Debug)]
pub(super) enum ExprWord {
    Value(XacroValue),
    Name(String),
    Sign(&'static str),
}

/// Longer ones first.
const SIGNS: [&str; 32] = [
    "**", "//", "==", "!=", "<=", ">=", "<<", ">>", ":=", "->", "+", "-", "*", "/", "%", "(", ")", "[", "]",
    "{", "}", ",", ":", ".", "<", ">", "=", "&", "|", "^", "~", "@",
];

pub(super) fn words(text: &str) -> EvalResult<Vec<ExprWord>> {
    let mut words = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let (word, length) = if first.is_ascii_digit() || first == '.' && digit_follows(rest) {
            number(rest)?
        } else if first == '"' || first == '\'' {
            quoted(rest)?
        } else if first.is_alphabetic() || first == '_' {
            name(rest)?
        } else {
            let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) else {
                return wrong(format!("`{}` does not belong there", first.escape_debug()), "take it out");
            };
            (ExprWord::Sign(sign), sign.len())
        };
        words.push(word);
        if words.len() > MOST_WORDS {
            return wrong(format!("it has more than {MOST_WORDS} words"), "put parts of it into properties");
        }
        rest = rest.get(length..).unwrap_or_default().trim_start();
    }
    Ok(words)
}

fn digit_follows(text: &str) -> bool {
    text.chars().nth(1).is_some_and(|c| c.is_ascii_digit())
}

fn number(text: &str) -> EvalResult<(ExprWord, usize)> {
    if let Some(hex) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        let length = hex.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(hex.len());
        let value = i64::from_str_radix(hex.get(..length).unwrap_or_default(), 16);
        return match value {
            Ok(value) => Ok((ExprWord::Value(XacroValue::Int(value)), 2 + length)),
            Err(_) => wrong("a number after `0x` is missing or too large", "write a smaller one"),
        };
    }
    let mut length = 0;
    let mut before = ' ';
    let mut is_float = false;
    for c in text.chars() {
        let is_exponent = matches!(c, 'e' | 'E') && !matches!(before, 'e' | 'E');
        let is_sign = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
        if !(c.is_ascii_digit() || c == '.' || c == '_' || is_exponent || is_sign) {
            break;
        }
        is_float |= c == '.' || is_exponent;
        before = c;
        length += c.len_utf8();
    }
    let written = text.get(..length).unwrap_or_default();
    let digits = written.replace('_', "");
    let next = text.get(length..).and_then(|rest| rest.chars().next());
    let value = if is_float {
        digits.parse().ok().map(XacroValue::Float)
    } else if digits.len() > 1 && digits.starts_with('0') && digits.bytes().any(|digit| digit != b'0') {
        None
    } else {
        digits.parse().ok().map(XacroValue::Int)
    };
    match value {
        Some(value) if !next.is_some_and(char::is_alphanumeric) => Ok((ExprWord::Value(value), length)),
        Some(_) | None => {
            wrong(format!("`{written}` is no number, or a too large one"), "write a number: 1, 0.5, 1e-3")
        }
    }
}

fn quoted(text: &str) -> EvalResult<(ExprWord, usize)> {
    let mut chars = text.char_indices();
    let open = chars.next().map_or('\'', |(_, c)| c);
    let mut said = String::new();
    while let Some((at, c)) = chars.next() {
        if c == open {
            return Ok((ExprWord::Value(XacroValue::text(said)?), at + 1));
        }
        if c != '\\' {
            said.push(c);
            continue;
        }
        match chars.next().map(|(_, c)| c) {
            Some('n') => said.push('\n'),
            Some('t') => said.push('\t'),
            Some(c @ ('\\' | '\'' | '"')) => said.push(c),
            Some(c) => {
                said.push('\\');
                said.push(c);
            }
            None => break,
        }
    }
    wrong("a text has no end", format!("write {open} behind it"))
}

fn name(text: &str) -> EvalResult<(ExprWord, usize)> {
    let length = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let name = text.get(..length).unwrap_or_default();
    let quote_follows = text.get(length..).is_some_and(|rest| rest.starts_with(['"', '\'']));
    if quote_follows
        && matches!(name.to_ascii_lowercase().as_str(), "f" | "r" | "b" | "u" | "fr" | "rf" | "br" | "rb")
    {
        return not_done(
            format!("text with `{name}` before its quotes"),
            "write it without, and join texts by `+`",
        );
    }
    if name == "lambda" {
        return not_done("`lambda`", "write the expression out, or a macro");
    }
    Ok((ExprWord::Name(name.to_owned()), length))
}
