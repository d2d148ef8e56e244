//! `.mas2j`: the project file of a system of agents. What says how agents are executed is skipped, with a note.

use hrdsl_source::{FileId, Span};

use super::parse::AgentSpeakFault;

/// A system of agents.
#[derive(Debug, Default)]
pub struct JasonProject {
    pub name: String,
    pub agents: Vec<JasonProjectAgent>,
    /// `aslSourcePath`
    pub paths: Vec<String>,
    /// What was skipped.
    pub skipped: Vec<(Span, String)>,
}

/// `name file.asl [beliefs="…", goals="…"] #3;`
#[derive(Debug)]
pub struct JasonProjectAgent {
    pub name: String,
    pub file: String,
    pub count: usize,
    /// The places of the texts.
    pub beliefs: Option<Span>,
    pub goals: Option<Span>,
    pub span: Span,
}

/// The most agents of one line.
const MAX_COUNT: usize = 5000;

#[derive(Clone, Debug, PartialEq)]
enum JasonProjectToken {
    Word(String),
    Text(String),
    Mark(char),
    End,
}

/// Reads a project.
///
/// # Errors
/// Where the text is no project, and what was expected.
pub fn project(file: FileId, text: &str) -> Result<JasonProject, AgentSpeakFault> {
    let mut scan =
        JasonProjectParser { tokens: tokens(file, text)?, at: 0, project: JasonProject::default() };
    scan.project()?;
    Ok(scan.project)
}

fn tokens(file: FileId, text: &str) -> Result<Vec<(JasonProjectToken, Span)>, AgentSpeakFault> {
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
                return Err(AgentSpeakFault {
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
                return Err(AgentSpeakFault {
                    span: span(text.len()),
                    message: "the text has no end; expected `\"`".to_owned(),
                });
            };
            at += end + 2;
            all.push((JasonProjectToken::Text(rest[1..=end].replace("\\\"", "\"")), span(at)));
        } else if is_word(c) {
            at += rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            all.push((JasonProjectToken::Word(text[start..at].to_owned()), span(at)));
        } else {
            at += c.len_utf8();
            all.push((JasonProjectToken::Mark(c), span(at)));
        }
    }
    all.push((JasonProjectToken::End, Span::new(file, text.len(), text.len())));
    Ok(all)
}

/// Within the quotes.
fn inner(span: Span) -> Span {
    Span::new(span.file, span.start as usize + 1, (span.end as usize).saturating_sub(1))
}

struct JasonProjectParser {
    tokens: Vec<(JasonProjectToken, Span)>,
    at: usize,
    project: JasonProject,
}

impl JasonProjectParser {
    fn peek(&self) -> &JasonProjectToken {
        &self.tokens[self.at].0
    }

    fn here(&self) -> Span {
        self.tokens[self.at].1
    }

    fn advance(&mut self) -> JasonProjectToken {
        let tok = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        tok
    }

    fn take(&mut self, mark: char) -> bool {
        let found = *self.peek() == JasonProjectToken::Mark(mark);
        if found {
            self.advance();
        }
        found
    }

    fn expected(&self, what: &str) -> AgentSpeakFault {
        let found = match self.peek() {
            JasonProjectToken::Word(w) => format!("`{w}`"),
            JasonProjectToken::Text(t) => format!("{t:?}"),
            JasonProjectToken::Mark(c) => format!("`{c}`"),
            JasonProjectToken::End => "the end of the file".to_owned(),
        };
        AgentSpeakFault { span: self.here(), message: format!("expected {what}, found {found}") }
    }

    fn word(&mut self, what: &str) -> Result<String, AgentSpeakFault> {
        match self.peek().clone() {
            JasonProjectToken::Word(w) => {
                self.advance();
                Ok(w)
            }
            JasonProjectToken::Text(_) | JasonProjectToken::Mark(_) | JasonProjectToken::End => {
                Err(self.expected(what))
            }
        }
    }

    /// `name :` begins a section; so does the brace at the end end one.
    fn section_begins(&self) -> bool {
        let next = self.tokens.get(self.at + 1).map(|t| &t.0);
        matches!(self.peek(), JasonProjectToken::Mark('}') | JasonProjectToken::End)
            || (matches!(self.peek(), JasonProjectToken::Word(_))
                && next == Some(&JasonProjectToken::Mark(':')))
    }

    fn project(&mut self) -> Result<(), AgentSpeakFault> {
        if !matches!(self.peek(), JasonProjectToken::Word(w) if w.eq_ignore_ascii_case("mas")) {
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
                JasonProjectToken::Mark('}') => return Ok(()),
                JasonProjectToken::Word(name) if self.section_begins() => {
                    self.advance();
                    self.advance();
                    self.section(&name, start)?;
                }
                JasonProjectToken::Word(_)
                | JasonProjectToken::Text(_)
                | JasonProjectToken::Mark(_)
                | JasonProjectToken::End => {
                    return Err(self.expected("a section such as `agents:`, or `}`"));
                }
            }
        }
    }

    fn section(&mut self, name: &str, start: Span) -> Result<(), AgentSpeakFault> {
        if name == "agents" {
            while !self.section_begins() {
                self.agent()?;
            }
            return Ok(());
        }
        let mut depth = 0_usize;
        let mut said = Vec::new();
        while *self.peek() != JasonProjectToken::End && (depth > 0 || !self.section_begins()) {
            match self.advance() {
                JasonProjectToken::Mark('{' | '(' | '[') => depth += 1,
                JasonProjectToken::Mark('}' | ')' | ']') => depth = depth.saturating_sub(1),
                JasonProjectToken::Text(text) if name == "aslSourcePath" => self.project.paths.push(text),
                JasonProjectToken::Word(word) => said.push(word),
                JasonProjectToken::Text(_) | JasonProjectToken::Mark(_) | JasonProjectToken::End => {}
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

    fn agent(&mut self) -> Result<(), AgentSpeakFault> {
        let start = self.here();
        let name = self.word("an agent's name")?;
        let mut entry = JasonProjectAgent {
            file: format!("{name}.asl"),
            name,
            count: 1,
            beliefs: None,
            goals: None,
            span: start,
        };
        while !self.take(';') {
            let here = self.here();
            match self.advance() {
                JasonProjectToken::Word(file) if file.ends_with(".asl") => entry.file = file,
                JasonProjectToken::Text(file) if file.ends_with(".asl") => entry.file = file,
                JasonProjectToken::Mark('[') => self.options(&mut entry)?,
                JasonProjectToken::Mark('#') => {
                    let count = self.word("the number of agents after `#`")?;
                    let number = count.parse().ok().filter(|n| (1..=MAX_COUNT).contains(n));
                    entry.count = number.ok_or_else(|| AgentSpeakFault {
                        span: here,
                        message: format!(
                            "expected a number of agents from 1 to {MAX_COUNT}, found `{count}`"
                        ),
                    })?;
                }
                JasonProjectToken::Word(word) => {
                    // `agentArchClass X`, `at "host"`
                    if !matches!(self.peek(), JasonProjectToken::Mark(_) | JasonProjectToken::End) {
                        self.advance();
                    }
                    self.project
                        .skipped
                        .push((here, format!("`{word}` of the agent `{}` is skipped", entry.name)));
                    self.arguments();
                }
                JasonProjectToken::Text(_) | JasonProjectToken::Mark(_) | JasonProjectToken::End => {
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
            while depth > 0 && *self.peek() != JasonProjectToken::End {
                match self.advance() {
                    JasonProjectToken::Mark('(') => depth += 1,
                    JasonProjectToken::Mark(')') => depth -= 1,
                    JasonProjectToken::Word(_)
                    | JasonProjectToken::Text(_)
                    | JasonProjectToken::Mark(_)
                    | JasonProjectToken::End => {}
                }
            }
        }
    }

    fn options(&mut self, entry: &mut JasonProjectAgent) -> Result<(), AgentSpeakFault> {
        while !self.take(']') {
            let start = self.here();
            let name = self.word("an option, or `]`")?;
            let value =
                if self.take('=') { Some((self.advance(), self.tokens[self.at - 1].1)) } else { None };
            match (name.as_str(), value) {
                ("beliefs", Some((JasonProjectToken::Text(_), span))) => entry.beliefs = Some(inner(span)),
                ("goals", Some((JasonProjectToken::Text(_), span))) => entry.goals = Some(inner(span)),
                (_, _) => {
                    self.project.skipped.push((
                        start,
                        format!("the option `{name}` of the agent `{}` is skipped", entry.name),
                    ));
                }
            }
            self.arguments();
            if !self.take(',') && *self.peek() != JasonProjectToken::Mark(']') {
                return Err(self.expected("`,` or `]`"));
            }
        }
        Ok(())
    }
}
