//! Tokens to the tree of a program: beliefs, rules, goals, plans, directives. Terms are in `term`, bodies in `body`.

mod body;
mod term;

use hrdsl_source::{FileId, SourceFiles, Span};

use super::{
    ast::{Item, ItemKind, Literal, Plan, Program, Term, TermKind, Trigger, TriggerKind},
    lex::{Tok, Token, lex, lex_from},
};
use crate::exchange::{
    note::SyntaxError,
    source::{Loader, MAX_BYTES},
};

/// How deep terms, blocks and includes may be nested.
const MAX_DEPTH: usize = 200;

/// What does not fit, and where.
#[derive(Debug)]
pub struct Fault {
    pub span: Span,
    pub message: String,
}

pub type Parsed<T> = Result<T, Fault>;

/// Where files come from, and what was wrong with them.
pub struct Reader<'l> {
    pub files: SourceFiles,
    pub loader: &'l dyn Loader,
    pub errors: Vec<SyntaxError>,
    /// The names of the files that are being read, the outermost first.
    open: Vec<String>,
    /// How much has been read, in bytes.
    bytes: usize,
}

impl<'l> Reader<'l> {
    pub fn new(loader: &'l dyn Loader) -> Self {
        Self { files: SourceFiles::default(), loader, errors: Vec::new(), open: Vec::new(), bytes: 0 }
    }

    /// Says what is wrong at a place.
    pub fn error(&mut self, span: Span, message: String) {
        let (file, line, column) = place(&self.files, span);
        self.errors.push(SyntaxError { file, line, column, message });
    }

    /// Reads a program, with the files that it includes.
    pub fn program(&mut self, name: &str, text: &str) -> Program {
        let mut program = Program::default();
        self.read(name, text, &mut program);
        program
    }

    fn read(&mut self, name: &str, text: &str, program: &mut Program) {
        self.open.push(name.to_owned());
        let mut parser = self.parser(name, text);
        loop {
            match parser.item() {
                Ok(None) => break,
                Ok(Some(Entry::Item(item))) => program.items.push(*item),
                Ok(Some(Entry::Include(path, span))) => self.include(name, &path, span, program),
                Err(fault) => {
                    self.error(fault.span, fault.message);
                    parser.skip();
                }
            }
        }
        self.open.pop();
    }

    /// A parser of a text that becomes one of the files.
    fn parser(&mut self, name: &str, text: &str) -> Parser {
        self.bytes += text.len();
        let file = self.files.add(name, text);
        let (tokens, faults) = lex(file, text);
        for (span, message) in faults {
            self.error(span, message);
        }
        Parser { file, tokens, at: 0, depth: 0 }
    }

    /// A parser of a piece of a file.
    pub fn piece(&mut self, span: Span) -> Parser {
        let text = self.files.get(span.file).map(|f| f.text.clone()).unwrap_or_default();
        let text = text.get(..span.end as usize).unwrap_or_default();
        let (tokens, faults) = lex_from(span.file, text, span.start as usize);
        for (span, message) in faults {
            self.error(span, message);
        }
        Parser { file: span.file, tokens, at: 0, depth: 0 }
    }

    fn include(&mut self, from: &str, path: &str, span: Span, program: &mut Program) {
        if path.starts_with('$') {
            let message = format!("`{path}` comes with Jason or JaCaMo, and is not read");
            program.items.push(Item { kind: ItemKind::Skipped(message), span });
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

enum Entry {
    Item(Box<Item>),
    Include(String, Span),
}

pub struct Parser {
    file: FileId,
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> &Tok {
        self.peek_at(0)
    }

    fn peek_at(&self, ahead: usize) -> &Tok {
        self.tokens.get(self.at + ahead).map_or(&Tok::End, |t| &t.tok)
    }

    fn here(&self) -> Span {
        self.tokens[self.at.min(self.tokens.len() - 1)].span
    }

    /// From the start of `from` to the end of what was read last.
    fn since(&self, from: Span) -> Span {
        let end = self.tokens[self.at.saturating_sub(1)].span.end.max(from.start);
        Span::new(self.file, from.start as usize, end as usize)
    }

    fn advance(&mut self) -> Tok {
        let tok = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        tok
    }

    fn is(&self, mark: &str) -> bool {
        matches!(self.peek(), Tok::Mark(m) if *m == mark)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Tok::Word(w) if *w == word)
    }

    fn take(&mut self, mark: &str) -> bool {
        let found = self.is(mark);
        if found {
            self.advance();
        }
        found
    }

    fn expect(&mut self, mark: &str, after: &str) -> Parsed<()> {
        if self.take(mark) { Ok(()) } else { Err(self.expected(&format!("`{mark}` {after}"))) }
    }

    fn expected(&self, what: &str) -> Fault {
        let found = match self.peek() {
            Tok::Atom(t) | Tok::Var(t) => format!("`{t}`"),
            Tok::Any => "`_`".to_owned(),
            Tok::Int(n) => format!("`{n}`"),
            Tok::Float(x) => format!("`{x}`"),
            Tok::Text(t) => format!("{t:?}"),
            Tok::Word(w) | Tok::Mark(w) => format!("`{w}`"),
            Tok::End => "the end of the file".to_owned(),
        };
        Fault { span: self.here(), message: format!("expected {what}, found {found}") }
    }

    /// Reads something one level further in.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth >= MAX_DEPTH {
            return Err(Fault { span: self.here(), message: "this is nested too deep".to_owned() });
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    /// Goes on after the next full stop.
    fn skip(&mut self) {
        self.depth = 0;
        while *self.peek() != Tok::End {
            if self.advance() == Tok::Mark(".") {
                break;
            }
        }
    }

    fn item(&mut self) -> Parsed<Option<Entry>> {
        let start = self.here();
        let kind = match self.peek() {
            Tok::End => return Ok(None),
            Tok::Mark("{") => return self.directive(start).map(Some),
            Tok::Mark("!") => {
                self.advance();
                let goal = self.literal_or_var("after `!`")?;
                self.expect(".", "after the goal")?;
                ItemKind::Goal(goal)
            }
            Tok::Mark("@" | "+" | "-" | "^") => {
                let plan = self.plan()?;
                self.expect(".", "at the end of the plan")?;
                ItemKind::Plan(plan)
            }
            _ => {
                let head = self.literal("a belief, a rule, a goal or a plan")?;
                let body = if self.take(":-") { Some(self.formula()?) } else { None };
                self.expect(".", if body.is_some() { "at the end of the rule" } else { "after the belief" })?;
                match body {
                    Some(body) => ItemKind::Rule { head, body },
                    None => ItemKind::Belief(head),
                }
            }
        };
        Ok(Some(Entry::Item(Box::new(Item { kind, span: self.since(start) }))))
    }

    fn directive(&mut self, start: Span) -> Parsed<Entry> {
        self.advance();
        let begins = matches!(self.peek(), Tok::Atom(a) if a == "begin");
        if begins && *self.peek_at(1) != Tok::Mark("}") {
            self.advance();
        }
        let directive = self.literal("a directive")?;
        self.expect("}", "after the directive")?;
        let span = self.since(start);
        if directive.functor == "include"
            && let Some(Term { kind: TermKind::Text(path), .. }) = directive.args.first()
        {
            return Ok(Entry::Include(path.clone(), span));
        }
        let name = &directive.functor;
        let message = match (name.as_str(), begins) {
            ("end", false) => format!("`{{ {name} }}` ends a directive, and means nothing here"),
            (_, true) => format!(
                "the directive `{name}` is not carried out; what it is about is carried over as it stands"
            ),
            (_, false) => format!("the directive `{name}` is not carried out"),
        };
        Ok(Entry::Item(Box::new(Item { kind: ItemKind::Skipped(message), span })))
    }

    fn plan(&mut self) -> Parsed<Plan> {
        let (mut label, mut annotations) = (None, Vec::new());
        if self.take("@") {
            if self.is("[") {
                annotations = self.annotations()?;
            } else {
                let named: Literal = self.literal("a label after `@`")?;
                label = Some(named.functor);
                annotations = named.annotations;
            }
        }
        let trigger = self.trigger()?;
        let context = if self.take(":") { Some(self.formula()?) } else { None };
        let body = if self.take("<-") { self.body()? } else { Vec::new() };
        Ok(Plan { label, annotations, trigger, context, body })
    }

    fn trigger(&mut self) -> Parsed<Trigger> {
        let sign = self.advance();
        let mark = match self.peek() {
            Tok::Mark(mark @ ("!" | "?")) => Some(*mark),
            _ => None,
        };
        if mark.is_some() {
            self.advance();
        }
        let kind = match (&sign, mark) {
            (Tok::Mark("+"), None) => TriggerKind::Added,
            (Tok::Mark("-"), None) => TriggerKind::Removed,
            (Tok::Mark("+"), Some("!")) => TriggerKind::Achieve,
            (Tok::Mark("-"), Some("!")) => TriggerKind::Failed,
            (Tok::Mark("+"), Some(_)) => TriggerKind::Test,
            (Tok::Mark("-"), Some(_)) => TriggerKind::TestFailed,
            (Tok::Mark("^"), Some(_)) => TriggerKind::State,
            _ => {
                self.at = self.at.saturating_sub(1 + usize::from(mark.is_some()));
                return Err(self.expected("a trigger (`+`, `-`, `+!`, `-!`, `+?`, `-?`)"));
            }
        };
        Ok(Trigger { kind, of: self.literal_or_var("in the trigger")? })
    }

    /// `b1(x), b2` of a project file's options.
    pub fn literals(&mut self) -> Parsed<Vec<Literal>> {
        let mut all = Vec::new();
        while *self.peek() != Tok::End {
            all.push(self.literal("a belief or goal")?);
            if !self.take(",") && *self.peek() != Tok::End {
                return Err(self.expected("`,`"));
            }
        }
        Ok(all)
    }
}
