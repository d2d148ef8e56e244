//! `.mas2j`: the project file of a system of agents. What says how agents are executed is skipped, with a note.

use hrdsl_source::{FileId, Span};

use super::parse::Fault;

/// A system of agents.
#[derive(Debug, Default)]
pub struct Project {
    pub name: String,
    pub agents: Vec<Entry>,
    /// `aslSourcePath`
    pub paths: Vec<String>,
    /// What was skipped.
    pub skipped: Vec<(Span, String)>,
}

/// `name file.asl [beliefs="…", goals="…"] #3;`
#[derive(Debug)]
pub struct Entry {
    pub name: String,
    pub file: String,
    pub count: usize,
    /// The places of the texts.
    pub beliefs: Option<Span>,
    pub goals: Option<Span>,
    pub span: Span,
}

/// The most agents of one line.
const MAX_COUNT: usize = 1000;

#[derive(Clone, Debug, PartialEq)]
enum Tok {
    Word(String),
    Text(String),
    Mark(char),
    End,
}

/// Reads a project.
///
/// # Errors
/// Where the text is no project, and what was expected.
pub fn project(file: FileId, text: &str) -> Result<Project, Fault> {
    let mut scan = Scan { tokens: tokens(file, text)?, at: 0, project: Project::default() };
    scan.project()?;
    Ok(scan.project)
}

fn tokens(file: FileId, text: &str) -> Result<Vec<(Tok, Span)>, Fault> {
    let mut all = Vec::new();
    let mut at = 0;
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '/' | '\\' | '$' | '-');
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let start = at;
        let span = |end: usize| Span::new(file, start, end);
        if c.is_whitespace() || c == '\u{feff}' {
            at += c.len_utf8();
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            let Some(end) = rest.find("*/") else {
                return Err(Fault {
                    span: span(text.len()),
                    message: "the comment has no end; expected `*/`".to_owned(),
                });
            };
            at += end + 2;
        } else if c == '"' {
            let mut escaped = false;
            let end = rest[1..].find(|c: char| {
                let ends = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            });
            let Some(end) = end else {
                return Err(Fault {
                    span: span(text.len()),
                    message: "the text has no end; expected `\"`".to_owned(),
                });
            };
            at += end + 2;
            all.push((Tok::Text(rest[1..=end].replace("\\\"", "\"")), span(at)));
        } else if is_word(c) {
            at += rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            all.push((Tok::Word(text[start..at].to_owned()), span(at)));
        } else {
            at += c.len_utf8();
            all.push((Tok::Mark(c), span(at)));
        }
    }
    all.push((Tok::End, Span::new(file, text.len(), text.len())));
    Ok(all)
}

/// Within the quotes.
fn inner(span: Span) -> Span {
    Span::new(span.file, span.start as usize + 1, (span.end as usize).saturating_sub(1))
}

struct Scan {
    tokens: Vec<(Tok, Span)>,
    at: usize,
    project: Project,
}

impl Scan {
    fn peek(&self) -> &Tok {
        &self.tokens[self.at].0
    }

    fn here(&self) -> Span {
        self.tokens[self.at].1
    }

    fn advance(&mut self) -> Tok {
        let tok = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        tok
    }

    fn take(&mut self, mark: char) -> bool {
        let found = *self.peek() == Tok::Mark(mark);
        if found {
            self.advance();
        }
        found
    }

    fn expected(&self, what: &str) -> Fault {
        let found = match self.peek() {
            Tok::Word(w) => format!("`{w}`"),
            Tok::Text(t) => format!("{t:?}"),
            Tok::Mark(c) => format!("`{c}`"),
            Tok::End => "the end of the file".to_owned(),
        };
        Fault { span: self.here(), message: format!("expected {what}, found {found}") }
    }

    fn word(&mut self, what: &str) -> Result<String, Fault> {
        match self.peek().clone() {
            Tok::Word(w) => {
                self.advance();
                Ok(w)
            }
            Tok::Text(_) | Tok::Mark(_) | Tok::End => Err(self.expected(what)),
        }
    }

    /// `name :` begins a section; so does the brace at the end end one.
    fn section_begins(&self) -> bool {
        let next = self.tokens.get(self.at + 1).map(|t| &t.0);
        matches!(self.peek(), Tok::Mark('}') | Tok::End)
            || (matches!(self.peek(), Tok::Word(_)) && next == Some(&Tok::Mark(':')))
    }

    fn project(&mut self) -> Result<(), Fault> {
        if !matches!(self.peek(), Tok::Word(w) if w.eq_ignore_ascii_case("mas")) {
            return Err(self.expected("`MAS`"));
        }
        self.advance();
        self.project.name = self.word("the project's name")?;
        if !self.take('{') {
            return Err(self.expected("`{` after the project's name"));
        }
        loop {
            let start = self.here();
            match self.peek().clone() {
                Tok::Mark('}') => return Ok(()),
                Tok::Word(name) if self.section_begins() => {
                    self.advance();
                    self.advance();
                    self.section(&name, start)?;
                }
                Tok::Word(_) | Tok::Text(_) | Tok::Mark(_) | Tok::End => {
                    return Err(self.expected("a section such as `agents:`, or `}`"));
                }
            }
        }
    }

    fn section(&mut self, name: &str, start: Span) -> Result<(), Fault> {
        if name == "agents" {
            while !self.section_begins() {
                self.agent()?;
            }
            return Ok(());
        }
        let mut depth = 0_usize;
        let mut said = Vec::new();
        while *self.peek() != Tok::End && (depth > 0 || !self.section_begins()) {
            match self.advance() {
                Tok::Mark('{' | '(' | '[') => depth += 1,
                Tok::Mark('}' | ')' | ']') => depth = depth.saturating_sub(1),
                Tok::Text(text) if name == "aslSourcePath" => self.project.paths.push(text),
                Tok::Word(word) => said.push(word),
                Tok::Text(_) | Tok::Mark(_) | Tok::End => {}
            }
        }
        match name {
            "aslSourcePath" | "infrastructure" | "centralised" => {}
            "environment" => {
                let class = said.first().cloned().unwrap_or_default();
                let message = format!(
                    "the environment `{class}` is a program: its actions become stimuli that take 1 s, its percepts beliefs"
                );
                self.project.skipped.push((start, message));
            }
            _ => self.project.skipped.push((start, format!("`{name}` of the project is skipped"))),
        }
        Ok(())
    }

    fn agent(&mut self) -> Result<(), Fault> {
        let start = self.here();
        let name = self.word("an agent's name")?;
        let mut entry =
            Entry { file: format!("{name}.asl"), name, count: 1, beliefs: None, goals: None, span: start };
        while !self.take(';') {
            let here = self.here();
            match self.advance() {
                Tok::Word(file) if file.ends_with(".asl") => entry.file = file,
                Tok::Text(file) if file.ends_with(".asl") => entry.file = file,
                Tok::Mark('[') => self.options(&mut entry)?,
                Tok::Mark('#') => {
                    let count = self.word("the number of agents after `#`")?;
                    let number = count.parse().ok().filter(|n| (1..=MAX_COUNT).contains(n));
                    entry.count = number.ok_or_else(|| Fault {
                        span: here,
                        message: format!(
                            "expected a number of agents from 1 to {MAX_COUNT}, found `{count}`"
                        ),
                    })?;
                }
                Tok::Word(word) => {
                    // `agentArchClass X`, `at "host"`
                    if !matches!(self.peek(), Tok::Mark(_) | Tok::End) {
                        self.advance();
                    }
                    self.project
                        .skipped
                        .push((here, format!("`{word}` of the agent `{}` is skipped", entry.name)));
                    self.arguments();
                }
                Tok::Text(_) | Tok::Mark(_) | Tok::End => {
                    self.at = self.at.saturating_sub(1);
                    return Err(self.expected("`;` after the agent"));
                }
            }
        }
        self.project.agents.push(entry);
        Ok(())
    }

    /// Skips `(…)`.
    fn arguments(&mut self) {
        if self.take('(') {
            let mut depth = 1;
            while depth > 0 && *self.peek() != Tok::End {
                match self.advance() {
                    Tok::Mark('(') => depth += 1,
                    Tok::Mark(')') => depth -= 1,
                    Tok::Word(_) | Tok::Text(_) | Tok::Mark(_) | Tok::End => {}
                }
            }
        }
    }

    fn options(&mut self, entry: &mut Entry) -> Result<(), Fault> {
        while !self.take(']') {
            let start = self.here();
            let name = self.word("an option, or `]`")?;
            let value =
                if self.take('=') { Some((self.advance(), self.tokens[self.at - 1].1)) } else { None };
            match (name.as_str(), value) {
                ("beliefs", Some((Tok::Text(_), span))) => entry.beliefs = Some(inner(span)),
                ("goals", Some((Tok::Text(_), span))) => entry.goals = Some(inner(span)),
                (_, _) => {
                    self.project.skipped.push((
                        start,
                        format!("the option `{name}` of the agent `{}` is skipped", entry.name),
                    ));
                }
            }
            self.arguments();
            if !self.take(',') && *self.peek() != Tok::Mark(']') {
                return Err(self.expected("`,` or `]`"));
            }
        }
        Ok(())
    }
}
