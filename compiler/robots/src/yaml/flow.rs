//! Values in brackets: `[1, 2]`, `{a: 1}`, and scalars; all of it on joined lines.

use super::{
    line::{YamlFault, fault},
    scalar::{plain, quoted},
    value::YamlValue,
};
use crate::limits::MOST_NESTING;

pub(super) struct FlowReader<'a> {
    pub text: &'a str,
    /// The byte of the file that `text` begins at.
    pub start: usize,
    pub at: usize,
}

impl FlowReader<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn place(&self) -> usize {
        self.start + self.at
    }

    pub fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    pub fn is_done(&self) -> bool {
        self.rest().trim().is_empty()
    }

    /// A value up to one of the signs that end it in brackets.
    pub fn value(&mut self, depth: usize) -> Result<YamlValue, YamlFault> {
        if depth > MOST_NESTING {
            return fault(self.place(), format!("lists lie deeper than {MOST_NESTING} in each other"));
        }
        self.blanks();
        match self.rest().chars().next() {
            Some('[') => self.list(depth),
            Some('{') => self.map(depth),
            Some('"' | '\'') => {
                let (said, length) = quoted(self.rest(), self.place())?;
                self.at += length;
                Ok(YamlValue::Text(said))
            }
            Some('!') => {
                let tag: String = self.rest().chars().take_while(|c| !c.is_whitespace()).collect();
                self.at += tag.len();
                self.blanks();
                let said = match self.rest().chars().next() {
                    Some('"' | '\'') => {
                        let (said, length) = quoted(self.rest(), self.place())?;
                        self.at += length;
                        said
                    }
                    _ => self.word().to_owned(),
                };
                Ok(YamlValue::Tagged(tag, said))
            }
            Some('&' | '*') => fault(self.place(), "anchors and aliases are not read"),
            Some(_) | None => Ok(plain(self.word())),
        }
    }

    /// A word without quotes.
    fn word(&mut self) -> &str {
        let start = self.at;
        let rest = self.rest();
        let mut end = rest.len();
        for (at, c) in rest.char_indices() {
            let next = rest.get(at + c.len_utf8()..).and_then(|after| after.chars().next());
            let is_colon =
                c == ':' && next.is_none_or(|next| next.is_whitespace() || matches!(next, ',' | ']' | '}'));
            if matches!(c, ',' | '[' | ']' | '{' | '}') || is_colon {
                end = at;
                break;
            }
        }
        self.at += end;
        self.text.get(start..start + end).unwrap_or_default().trim()
    }

    fn list(&mut self, depth: usize) -> Result<YamlValue, YamlFault> {
        let mut items = Vec::new();
        self.at += 1;
        loop {
            self.blanks();
            if self.takes(']') {
                return Ok(YamlValue::List(items));
            }
            items.push(self.value(depth + 1)?);
            self.comma(']')?;
        }
    }

    fn map(&mut self, depth: usize) -> Result<YamlValue, YamlFault> {
        let mut pairs = Vec::new();
        self.at += 1;
        loop {
            self.blanks();
            if self.takes('}') {
                return Ok(YamlValue::Map(pairs));
            }
            let key = self.value(depth + 1)?;
            self.blanks();
            let value = if self.takes(':') { self.value(depth + 1)? } else { YamlValue::Null };
            pairs.push((key, value));
            self.comma('}')?;
        }
    }

    fn takes(&mut self, sign: char) -> bool {
        let takes = self.rest().starts_with(sign);
        if takes {
            self.at += sign.len_utf8();
        }
        takes
    }

    /// A comma, or the end that is left for the caller.
    fn comma(&mut self, end: char) -> Result<(), YamlFault> {
        self.blanks();
        if self.takes(',') || self.rest().starts_with(end) {
            return Ok(());
        }
        fault(self.place(), format!("a comma or `{end}` is missing"))
    }
}
