//! Tokens to the tree of a program: beliefs, rules, goals, plans, directives. Terms are in `term`, bodies in `body`.

mod body;
mod term;

use hrdsl_source::{FileId, SourceFiles, Span};

use super::{
    ast::{
        AgentSpeakItem, AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakPlan, AgentSpeakProgram,
        AgentSpeakTerm, AgentSpeakTrigger, AgentSpeakTriggerKind, TermKind,
    },
    lex::{AgentSpeakToken, AgentSpeakTokenKind, lex, lex_from},
};
use crate::exchange::{
    note::SyntaxError,
    source::{ForeignLoader, MAX_BYTES},
};

/// How deep terms, blocks and includes may be nested.
const MAX_DEPTH: usize = 200;

/// What does not fit, and where.
#[derive(Debug)]
pub struct AgentSpeakFault {
    pub span: Span,
    pub message: String,
}

pub type AgentSpeakParseResult<T> = Result<T, AgentSpeakFault>;

/// Where files come from, and what was wrong with them.
pub struct AgentSpeakReader<'l> {
    pub files: SourceFiles,
    pub loader: &'l dyn ForeignLoader,
    pub errors: Vec<SyntaxError>,
    /// The names of the files that are being read, the outermost first.
    open: Vec<String>,
    /// How much has been read, in bytes.
    bytes: usize,
}

impl<'l> AgentSpeakReader<'l> {
    pub fn new(loader: &'l dyn ForeignLoader) -> Self {
        Self { files: SourceFiles::default(), loader, errors: Vec::new(), open: Vec::new(), bytes: 0 }
    }

    /// Says what is wrong at a place.
    pub fn error(&mut self, span: Span, message: String) {
        let (file, line, column) = place(&self.files, span);
        self.errors.push(SyntaxError { file, line, column, message });
    }

    /// Reads a program, with the files that it includes.
    pub fn program(&mut self, name: &str, text: &str) -> AgentSpeakProgram {
        let mut program = AgentSpeakProgram::default();
        self.read(name, text, &mut program);
        program
    }

    fn read(&mut self, name: &str, text: &str, program: &mut AgentSpeakProgram) {
        self.open.push(name.to_owned());
        let mut parser = self.parser(name, text);
        let (before, mut broken) = (program.items.len(), Vec::new());
        loop {
            let start = parser.here();
            match parser.item() {
                Ok(None) => break,
                Ok(Some(AgentSpeakEntry::Item(item))) => program.items.push(*item),
                Ok(Some(AgentSpeakEntry::Include(path, span))) => self.include(name, &path, span, program),
                Err(fault) => {
                    parser.skip();
                    broken.push((parser.since(start), fault));
                }
            }
        }
        // A clause that cannot be read is left out; where there is no other, this is no program.
        if program.items.len() == before {
            broken.into_iter().for_each(|(_, fault)| self.error(fault.span, fault.message));
        } else {
            program.items.extend(broken.into_iter().map(|(clause, fault)| {
                let (_, line, column) = place(&self.files, fault.span);
                let message = format!("line {line}, column {column}: {}", fault.message);
                AgentSpeakItem { kind: AgentSpeakItemKind::Broken(message), span: clause }
            }));
        }
        self.open.pop();
    }

    /// A parser of a text that becomes one of the files.
    fn parser(&mut self, name: &str, text: &str) -> AgentSpeakParser {
        self.bytes += text.len();
        let file = self.files.add(name, text);
        let (tokens, faults) = lex(file, text);
        for (span, message) in faults {
            self.error(span, message);
        }
        AgentSpeakParser { file, tokens, at: 0, depth: 0 }
    }

    /// A parser of a piece of a file.
    pub fn piece(&mut self, span: Span) -> AgentSpeakParser {
        let text = self.files.get(span.file).map(|f| f.text.clone()).unwrap_or_default();
        let text = text.get(..span.end as usize).unwrap_or_default();
        let (tokens, faults) = lex_from(span.file, text, span.start as usize);
        for (span, message) in faults {
            self.error(span, message);
        }
        AgentSpeakParser { file: span.file, tokens, at: 0, depth: 0 }
    }

    fn include(&mut self, from: &str, path: &str, span: Span, program: &mut AgentSpeakProgram) {
        if path.starts_with('$') {
            let message = format!("`{path}` comes with Jason or JaCaMo, and is not read");
            program.items.push(AgentSpeakItem { kind: AgentSpeakItemKind::Skipped(message), span });
            return;
        }
        match self.loader.load(from, path) {
            Ok(source) if self.open.contains(&source.name) => {
                self.error(span, format!("`{path}` includes itself"));
            }
            Ok(_) if self.open.len() > MAX_DEPTH => {
                self.error(span, "too many files include each other".to_owned())
            }
            Ok(source) if self.bytes + source.text.len() > MAX_BYTES => {
                let most = MAX_BYTES >> 20;
                self.error(span, format!("the programs with what they include are larger than {most} MiB"));
            }
            Ok(source) => self.read(&source.name, &source.text, program),
            Err(message) => self.error(span, message),
        }
    }
}

/// The file, the line and the column of a place.
pub fn place(files: &SourceFiles, span: Span) -> (String, u32, u32) {
    let at = files.position(span);
    (files.get(span.file).map(|f| f.name.clone()).unwrap_or_default(), at.line, at.column)
}

enum AgentSpeakEntry {
    Item(Box<AgentSpeakItem>),
    Include(String, Span),
}

pub struct AgentSpeakParser {
    file: FileId,
    tokens: Vec<AgentSpeakToken>,
    at: usize,
    depth: usize,
}

impl AgentSpeakParser {
    fn peek(&self) -> &AgentSpeakTokenKind {
        self.peek_at(0)
    }

    fn peek_at(&self, ahead: usize) -> &AgentSpeakTokenKind {
        self.tokens.get(self.at + ahead).map_or(&AgentSpeakTokenKind::End, |t| &t.tok)
    }

    fn here(&self) -> Span {
        self.tokens[self.at.min(self.tokens.len() - 1)].span
    }

    /// From the start of `from` to the end of what was read last.
    fn since(&self, from: Span) -> Span {
        let end = self.tokens[self.at.saturating_sub(1)].span.end.max(from.start);
        Span::new(self.file, from.start as usize, end as usize)
    }

    fn advance(&mut self) -> AgentSpeakTokenKind {
        let tok = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        tok
    }

    fn is(&self, mark: &str) -> bool {
        matches!(self.peek(), AgentSpeakTokenKind::Mark(m) if *m == mark)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), AgentSpeakTokenKind::Word(w) if *w == word)
    }

    fn take(&mut self, mark: &str) -> bool {
        let found = self.is(mark);
        if found {
            self.advance();
        }
        found
    }

    fn expect(&mut self, mark: &str, after: &str) -> AgentSpeakParseResult<()> {
        if self.take(mark) { Ok(()) } else { Err(self.expected(&format!("`{mark}` {after}"))) }
    }

    fn expected(&self, what: &str) -> AgentSpeakFault {
        let found = match self.peek() {
            AgentSpeakTokenKind::Atom(t) | AgentSpeakTokenKind::Var(t) => format!("`{t}`"),
            AgentSpeakTokenKind::Any => "`_`".to_owned(),
            AgentSpeakTokenKind::Int(n) => format!("`{n}`"),
            AgentSpeakTokenKind::Float(x) => format!("`{x}`"),
            AgentSpeakTokenKind::Text(t) => format!("{t:?}"),
            AgentSpeakTokenKind::Word(w) | AgentSpeakTokenKind::Mark(w) => format!("`{w}`"),
            AgentSpeakTokenKind::End => "the end of the file".to_owned(),
        };
        AgentSpeakFault { span: self.here(), message: format!("expected {what}, found {found}") }
    }

    /// Reads something one level further in.
    fn deeper<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> AgentSpeakParseResult<T>,
    ) -> AgentSpeakParseResult<T> {
        if self.depth >= MAX_DEPTH {
            return Err(AgentSpeakFault { span: self.here(), message: "this is nested too deep".to_owned() });
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    /// Goes on after the next full stop.
    fn skip(&mut self) {
        self.depth = 0;
        while *self.peek() != AgentSpeakTokenKind::End {
            if self.advance() == AgentSpeakTokenKind::Mark(".") {
                break;
            }
        }
    }

    fn item(&mut self) -> AgentSpeakParseResult<Option<AgentSpeakEntry>> {
        let start = self.here();
        let kind = match self.peek() {
            AgentSpeakTokenKind::End => return Ok(None),
            AgentSpeakTokenKind::Mark("{") => return self.directive(start).map(Some),
            AgentSpeakTokenKind::Mark("!") => {
                self.advance();
                let goal = self.literal_or_var("after `!`")?;
                self.expect(".", "after the goal")?;
                AgentSpeakItemKind::Goal(goal)
            }
            AgentSpeakTokenKind::Mark("@" | "+" | "-" | "^") => {
                let plan = self.plan()?;
                self.expect(".", "at the end of the plan")?;
                AgentSpeakItemKind::Plan(plan)
            }
            _ => {
                let head = self.literal("a belief, a rule, a goal or a plan")?;
                let body = if self.take(":-") { Some(self.formula()?) } else { None };
                self.expect(".", if body.is_some() { "at the end of the rule" } else { "after the belief" })?;
                match body {
                    Some(body) => AgentSpeakItemKind::Rule { head, body },
                    None => AgentSpeakItemKind::Belief(head),
                }
            }
        };
        Ok(Some(AgentSpeakEntry::Item(Box::new(AgentSpeakItem { kind, span: self.since(start) }))))
    }

    fn directive(&mut self, start: Span) -> AgentSpeakParseResult<AgentSpeakEntry> {
        self.advance();
        let begins = matches!(self.peek(), AgentSpeakTokenKind::Atom(a) if a == "begin");
        if begins && *self.peek_at(1) != AgentSpeakTokenKind::Mark("}") {
            self.advance();
        }
        let directive = self.literal("a directive")?;
        self.expect("}", "after the directive")?;
        let span = self.since(start);
        if directive.functor == "include"
            && let Some(AgentSpeakTerm { kind: TermKind::Text(path), .. }) = directive.args.first()
        {
            return Ok(AgentSpeakEntry::Include(path.clone(), span));
        }
        let name = &directive.functor;
        let message = match (name.as_str(), begins) {
            ("end", false) => format!("`{{ {name} }}` ends a directive, and means nothing here"),
            (_, true) => format!(
                "the directive `{name}` is not carried out; what it is about is carried over as it stands"
            ),
            (_, false) => format!("the directive `{name}` is not carried out"),
        };
        Ok(AgentSpeakEntry::Item(Box::new(AgentSpeakItem {
            kind: AgentSpeakItemKind::Skipped(message),
            span,
        })))
    }

    fn plan(&mut self) -> AgentSpeakParseResult<AgentSpeakPlan> {
        let (mut label, mut annotations) = (None, Vec::new());
        if self.take("@") {
            if self.is("[") {
                annotations = self.annotations()?;
            } else {
                let named: AgentSpeakLiteral = self.literal("a label after `@`")?;
                label = Some(named.functor);
                annotations = named.annotations;
            }
        }
        let trigger = self.trigger()?;
        let context = if self.take(":") { Some(self.formula()?) } else { None };
        let body = if self.take("<-") { self.body()? } else { Vec::new() };
        Ok(AgentSpeakPlan { label, annotations, trigger, context, body })
    }

    fn trigger(&mut self) -> AgentSpeakParseResult<AgentSpeakTrigger> {
        let sign = self.advance();
        let mark = match self.peek() {
            AgentSpeakTokenKind::Mark(mark @ ("!" | "?")) => Some(*mark),
            _ => None,
        };
        if mark.is_some() {
            self.advance();
        }
        let kind = match (&sign, mark) {
            (AgentSpeakTokenKind::Mark("+"), None) => AgentSpeakTriggerKind::Added,
            (AgentSpeakTokenKind::Mark("-"), None) => AgentSpeakTriggerKind::Removed,
            (AgentSpeakTokenKind::Mark("+"), Some("!")) => AgentSpeakTriggerKind::Achieve,
            (AgentSpeakTokenKind::Mark("-"), Some("!")) => AgentSpeakTriggerKind::Failed,
            (AgentSpeakTokenKind::Mark("+"), Some(_)) => AgentSpeakTriggerKind::Test,
            (AgentSpeakTokenKind::Mark("-"), Some(_)) => AgentSpeakTriggerKind::TestFailed,
            (AgentSpeakTokenKind::Mark("^"), Some(_)) => AgentSpeakTriggerKind::State,
            _ => {
                self.at = self.at.saturating_sub(1 + usize::from(mark.is_some()));
                return Err(self.expected("a trigger (`+`, `-`, `+!`, `-!`, `+?`, `-?`)"));
            }
        };
        Ok(AgentSpeakTrigger { kind, of: self.literal_or_var("in the trigger")? })
    }

    /// `b1(x), b2` of a project file's options.
    pub fn literals(&mut self) -> AgentSpeakParseResult<Vec<AgentSpeakLiteral>> {
        let mut all = Vec::new();
        while *self.peek() != AgentSpeakTokenKind::End {
            all.push(self.literal("a belief or goal")?);
            if !self.take(",") && *self.peek() != AgentSpeakTokenKind::End {
                return Err(self.expected("`,`"));
            }
        }
        Ok(all)
    }
}
