//! Tokens to declarations, statements and expressions.

mod declaration;
mod expression;
mod statement;

use hrdsl_source::Span;

use super::{
    ast::{UppaalExpr, UppaalSelect, UppaalSync},
    fault::{UppaalFault, unsupported},
    lex::{UppaalComment, UppaalFragment, UppaalToken, UppaalTokenKind, lex},
};

/// How deep expressions and statements may be nested.
const MAX_DEPTH: usize = 60;

type UppaalParseResult<T> = Result<T, UppaalFault>;

pub struct UppaalParser {
    tokens: Vec<UppaalToken>,
    at: usize,
    depth: usize,
    /// Operators of the expression that is being read: they are as high as the expression can be.
    operators: usize,
}

/// Words of declarations that mean things no scenario has.
const UNSUPPORTED: &[(&str, &str)] = &[
    ("double", "numbers with a fraction (`double`)"),
    ("string", "texts (`string`)"),
    ("hybrid", "hybrid clocks (`hybrid`)"),
    ("dynamic", "dynamic templates (`dynamic`)"),
    ("spawn", "dynamic templates (`spawn`)"),
    ("before_update", "`before_update`"),
    ("after_update", "`after_update`"),
    ("import", "functions of libraries (`import`)"),
    ("switch", "`switch`"),
    ("break", "`break`"),
    ("continue", "`continue`"),
    ("assert", "`assert`"),
    ("priority", "priorities of channels (`chan priority`)"),
];

impl UppaalParser {
    pub fn new(piece: &UppaalFragment) -> UppaalParseResult<Self> {
        Ok(Self { tokens: lex(piece)?, at: 0, depth: 0, operators: 0 })
    }

    // ── Tokens ──

    fn peek(&self) -> &UppaalTokenKind {
        self.ahead(0)
    }

    fn ahead(&self, n: usize) -> &UppaalTokenKind {
        self.tokens.get(self.at + n).map_or(&UppaalTokenKind::End, |t| &t.tok)
    }

    fn span(&self) -> Span {
        self.tokens.get(self.at).or(self.tokens.last()).map_or_else(Span::default, |t| t.span)
    }

    /// The span of the token before.
    fn last(&self) -> Span {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or_else(|| self.span(), |t| t.span)
    }

    fn next(&mut self) {
        self.at = (self.at + 1).min(self.tokens.len().saturating_sub(1));
    }

    fn is(&self, mark: &str) -> bool {
        matches!(self.peek(), UppaalTokenKind::Mark(m) if *m == mark)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), UppaalTokenKind::Word(w) if w == word)
    }

    fn take(&mut self, mark: &str) -> bool {
        let found = self.is(mark);
        if found {
            self.next();
        }
        found
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.next();
        }
        found
    }

    /// What is said of a declaration: before it, within it (its first tokens), and after it in its last line.
    fn comments(&self, start: usize, inside: usize) -> Vec<String> {
        let mut lines = Vec::new();
        for (at, token) in self.tokens.iter().enumerate().skip(start) {
            let belongs = |c: &&UppaalComment| match at {
                // What ends the line of the declaration before is its own.
                _ if at == start => !c.trailing,
                _ if at < inside => true,
                _ => at == self.at && c.trailing,
            };
            lines.extend(token.comments.iter().filter(belongs).flat_map(|c| c.lines.clone()));
            if at >= self.at {
                break;
            }
        }
        lines
    }

    fn fault(&self, expected: &str) -> UppaalFault {
        let mut message = format!("expected {expected}, found {}", self.peek().shown());
        if *self.peek() == UppaalTokenKind::Mark("~") {
            message += ", which is no operator of UPPAAL: `-1 - x` is `x` with every bit changed";
        }
        UppaalFault { span: self.span(), message }
    }

    fn expect(&mut self, mark: &str) -> UppaalParseResult<()> {
        if self.take(mark) { Ok(()) } else { Err(self.fault(&format!("`{mark}`"))) }
    }

    fn name(&mut self, what: &str) -> UppaalParseResult<(String, Span)> {
        self.supported()?;
        match self.peek() {
            UppaalTokenKind::Word(w) if !is_keyword(w) => {
                let out = (w.clone(), self.span());
                self.next();
                Ok(out)
            }
            UppaalTokenKind::Word(w) => {
                let message =
                    format!("expected {what}; `{w}` is a word of UPPAAL's language: choose another name");
                Err(UppaalFault { span: self.span(), message })
            }
            UppaalTokenKind::Int(_) | UppaalTokenKind::Mark(_) | UppaalTokenKind::End => {
                Err(self.fault(what))
            }
        }
    }

    /// Nothing follows.
    pub fn end(&self) -> UppaalParseResult<()> {
        if *self.peek() == UppaalTokenKind::End { Ok(()) } else { Err(self.fault("the end")) }
    }

    pub fn at_end(&self) -> bool {
        *self.peek() == UppaalTokenKind::End
    }

    fn supported(&self) -> UppaalParseResult<()> {
        let UppaalTokenKind::Word(word) = self.peek() else { return Ok(()) };
        match UNSUPPORTED.iter().find(|(w, _)| w == word) {
            Some((_, what)) => Err(unsupported(self.span(), what)),
            None => Ok(()),
        }
    }

    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> UppaalParseResult<T>) -> UppaalParseResult<T> {
        if self.depth == MAX_DEPTH {
            return Err(UppaalFault { span: self.span(), message: "this is nested too deeply".to_owned() });
        }
        self.depth += 1;
        let out = parse(self);
        self.depth -= 1;
        out
    }

    // ── Labels ──

    /// Expressions separated by commas, none if `close` is next.
    pub fn list(&mut self, close: &str) -> UppaalParseResult<Vec<UppaalExpr>> {
        let mut all = Vec::new();
        if self.is(close) || self.at_end() {
            return Ok(all);
        }
        loop {
            all.push(self.expr()?);
            if !self.take(",") {
                return Ok(all);
            }
        }
    }

    pub fn selects(&mut self) -> UppaalParseResult<Vec<UppaalSelect>> {
        let mut all = Vec::new();
        while !self.at_end() {
            let (name, span) = self.name("the name of what is selected")?;
            self.expect(":")?;
            all.push(UppaalSelect { name, ty: self.ty()?, span });
            if !self.take(",") && !self.take(";") {
                break;
            }
        }
        Ok(all)
    }

    pub fn sync(&mut self) -> UppaalParseResult<UppaalSync> {
        let channel = self.postfix()?;
        let offers = self.take("!");
        if !offers && !self.take("?") {
            return Err(self.fault("`!` or `?`"));
        }
        Ok(UppaalSync { channel, offers })
    }

    /// `f --> g`, or `f` alone.
    pub fn leads_to(&mut self) -> UppaalParseResult<(UppaalExpr, Option<UppaalExpr>)> {
        let left = self.expr()?;
        let right = if self.take("-->") { Some(self.expr()?) } else { None };
        Ok((left, right))
    }

    /// `{ f } : a, b` or `: a, b`
    pub fn measures(&mut self) -> UppaalParseResult<(Option<UppaalExpr>, Vec<UppaalExpr>)> {
        let when = if self.take("{") {
            let f = self.expr()?;
            self.expect("}")?;
            Some(f)
        } else {
            None
        };
        self.expect(":")?;
        Ok((when, self.list(";")?))
    }
}

fn is_keyword(word: &str) -> bool {
    const WORDS: &[&str] = &[
        "and",
        "bool",
        "broadcast",
        "chan",
        "clock",
        "const",
        "deadlock",
        "do",
        "else",
        "exists",
        "false",
        "for",
        "forall",
        "if",
        "imply",
        "int",
        "meta",
        "not",
        "or",
        "return",
        "scalar",
        "struct",
        "sum",
        "system",
        "true",
        "typedef",
        "urgent",
        "void",
        "while",
    ];
    WORDS.contains(&word)
}
