//! AgentSpeak text to tokens.

use hrdsl_source::{FileId, Span};

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentSpeakTokenKind {
    /// `beer`, `.send`, `math.abs`, `'any text'`
    Atom(String),
    /// `X`, `_X`
    Var(String),
    /// `_`
    Any,
    Int(i64),
    Float(f64),
    Text(String),
    /// A word of the language: `not`, `if`, …
    Word(&'static str),
    /// An operator or mark.
    Mark(&'static str),
    End,
}

#[derive(Clone, Debug)]
pub struct AgentSpeakToken {
    pub tok: AgentSpeakTokenKind,
    pub span: Span,
}

/// The longest first.
const MARKS: &[&str] = &[
    "|&|", "|||", "\\==", "=..", ":-", "<-", "<=", ">=", "==", "\\=", "!!", "**", "::", "(", ")", "{", "}",
    "[", "]", ",", ";", ":", ".", "@", "!", "?", "+", "-", "*", "/", "<", ">", "=", "&", "|", "~", "^", "#",
];

const WORDS: &[&str] = &["not", "true", "false", "if", "elif", "else", "while", "for", "div", "mod"];

/// The tokens of a text, the last one `End`; and the places where it is no text of the language, with what is wrong.
pub fn lex(file: FileId, text: &str) -> (Vec<AgentSpeakToken>, Vec<(Span, String)>) {
    lex_from(file, text, 0)
}

/// The tokens from a place on.
pub fn lex_from(file: FileId, text: &str, at: usize) -> (Vec<AgentSpeakToken>, Vec<(Span, String)>) {
    let mut lexer = AgentSpeakLexer { file, text, at, tokens: Vec::new(), faults: Vec::new() };
    while lexer.at < text.len() {
        lexer.next();
    }
    lexer.push(AgentSpeakTokenKind::End, text.len());
    (lexer.tokens, lexer.faults)
}

struct AgentSpeakLexer<'t> {
    file: FileId,
    text: &'t str,
    at: usize,
    tokens: Vec<AgentSpeakToken>,
    faults: Vec<(Span, String)>,
}

impl AgentSpeakLexer<'_> {
    fn push(&mut self, tok: AgentSpeakTokenKind, start: usize) {
        self.tokens.push(AgentSpeakToken { tok, span: Span::new(self.file, start, self.at) });
    }

    fn fault(&mut self, start: usize, message: impl Into<String>) {
        self.faults.push((Span::new(self.file, start, self.at), message.into()));
    }

    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    /// Takes characters as long as `take` says so.
    fn run(&mut self, take: impl Fn(char) -> bool) -> &str {
        let start = self.at;
        self.at += self.rest().find(|c| !take(c)).unwrap_or(self.text.len() - start);
        &self.text[start..self.at]
    }

    fn next(&mut self) {
        let start = self.at;
        let Some(c) = self.rest().chars().next() else { return };
        let second = self.rest().chars().nth(1);
        if c.is_whitespace() || c == '\u{feff}' {
            self.at += c.len_utf8();
        } else if self.rest().starts_with("//") {
            self.run(|c| c != '\n');
        } else if self.rest().starts_with("/*") {
            self.block_comment();
        } else if c.is_ascii_digit() {
            self.number();
        } else if c == '"' || c == '\'' {
            self.quoted(c);
        } else if c == '_' || c.is_uppercase() {
            let name = self.run(is_word).to_owned();
            self.push(
                if name == "_" { AgentSpeakTokenKind::Any } else { AgentSpeakTokenKind::Var(name) },
                start,
            );
        } else if c.is_alphabetic() || (c == '.' && second.is_some_and(char::is_alphabetic)) {
            self.atom();
        } else if let Some(mark) = MARKS.iter().find(|m| self.rest().starts_with(**m)) {
            self.at += mark.len();
            self.push(AgentSpeakTokenKind::Mark(mark), start);
        } else {
            self.at += c.len_utf8();
            self.fault(start, format!("the character `{c}` means nothing here"));
        }
    }

    fn block_comment(&mut self) {
        let start = self.at;
        if let Some(end) = self.rest().find("*/") {
            self.at += end + 2;
        } else {
            self.at = self.text.len();
            self.fault(start, "the comment has no end; expected `*/`");
        }
    }

    fn number(&mut self) {
        let start = self.at;
        self.run(|c| c.is_ascii_digit());
        let mut float = false;
        let bytes = self.text.as_bytes();
        let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
        if bytes.get(self.at) == Some(&b'.') && digit(self.at + 1) {
            float = true;
            self.at += 1;
            self.run(|c| c.is_ascii_digit());
        }
        if matches!(bytes.get(self.at), Some(b'e' | b'E')) {
            let signed = usize::from(matches!(bytes.get(self.at + 1), Some(b'+' | b'-')));
            if digit(self.at + 1 + signed) {
                float = true;
                self.at += 1 + signed;
                self.run(|c| c.is_ascii_digit());
            }
        }
        let text = &self.text[start..self.at];
        let int = if float { None } else { text.parse().ok() };
        let tok = int.map_or_else(
            || text.parse().map(AgentSpeakTokenKind::Float).ok(),
            |n| Some(AgentSpeakTokenKind::Int(n)),
        );
        match tok {
            Some(AgentSpeakTokenKind::Float(x)) if !x.is_finite() => {
                self.fault(start, "the number is too large")
            }
            Some(tok) => self.push(tok, start),
            None => self.fault(start, "the number cannot be read"),
        }
    }

    fn quoted(&mut self, quote: char) {
        let start = self.at;
        self.at += 1;
        let mut text = String::new();
        loop {
            let mut chars = self.rest().chars();
            let taken = match (chars.next(), chars.next()) {
                (None, _) | (Some('\n'), _) => {
                    return self
                        .fault(start, format!("the text has no end on this line; expected `{quote}`"));
                }
                (Some('\\'), Some(escaped)) => {
                    text.push(match escaped {
                        'n' => '\n',
                        't' => '\t',
                        'r' => '\r',
                        other => other,
                    });
                    1 + escaped.len_utf8()
                }
                (Some(c), _) if c == quote => {
                    self.at += 1;
                    break;
                }
                (Some(c), _) => {
                    text.push(c);
                    c.len_utf8()
                }
            };
            self.at += taken;
        }
        self.push(
            if quote == '"' { AgentSpeakTokenKind::Text(text) } else { AgentSpeakTokenKind::Atom(text) },
            start,
        );
    }

    /// A dot belongs to the name if a letter or digit follows.
    fn atom(&mut self) {
        let start = self.at;
        loop {
            if self.rest().starts_with('.') {
                self.at += 1;
            }
            self.run(is_word);
            let mut rest = self.rest().chars();
            if rest.next() != Some('.') || !rest.next().is_some_and(is_word) {
                break;
            }
        }
        let text = &self.text[start..self.at];
        let tok = match WORDS.iter().find(|w| **w == text) {
            Some(word) => AgentSpeakTokenKind::Word(word),
            None => AgentSpeakTokenKind::Atom(text.to_owned()),
        };
        self.push(tok, start);
    }
}

fn is_word(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn toks(text: &str) -> Vec<AgentSpeakTokenKind> {
        let (tokens, faults) = lex(FileId(0), text);
        assert_eq!(faults, Vec::new());
        tokens.into_iter().map(|t| t.tok).collect()
    }

    #[test]
    fn a_dot_is_part_of_a_name_a_number_or_the_end() {
        let atom = |t: &str| AgentSpeakTokenKind::Atom(t.to_owned());
        let dot = AgentSpeakTokenKind::Mark(".");
        assert_eq!(
            toks("b(1).\n.send"),
            [
                atom("b"),
                AgentSpeakTokenKind::Mark("("),
                AgentSpeakTokenKind::Int(1),
                AgentSpeakTokenKind::Mark(")"),
                dot.clone(),
                atom(".send"),
                AgentSpeakTokenKind::End
            ]
        );
        assert_eq!(
            toks("math.abs 1.5. x."),
            [
                atom("math.abs"),
                AgentSpeakTokenKind::Float(1.5),
                dot.clone(),
                atom("x"),
                dot.clone(),
                AgentSpeakTokenKind::End
            ]
        );
        assert_eq!(
            toks("2e3 3."),
            [AgentSpeakTokenKind::Float(2000.0), AgentSpeakTokenKind::Int(3), dot, AgentSpeakTokenKind::End]
        );
    }

    #[test]
    fn the_longest_mark_is_taken() {
        let marks = toks("|&| ||| \\== =.. <- <= !! ** _ _X X");
        let kinds: Vec<String> = marks.iter().map(|t| format!("{t:?}")).collect();
        assert_eq!(kinds.len(), 12);
        assert_eq!(
            marks[8..11],
            [
                AgentSpeakTokenKind::Any,
                AgentSpeakTokenKind::Var("_X".to_owned()),
                AgentSpeakTokenKind::Var("X".to_owned())
            ]
        );
    }

    #[test]
    fn what_has_no_end_is_said() {
        assert_eq!(lex(FileId(0), "b(\"x").1.len(), 1);
        assert_eq!(lex(FileId(0), "/* b").1.len(), 1);
        assert_eq!(lex(FileId(0), "b % c").1.len(), 1);
    }
}
