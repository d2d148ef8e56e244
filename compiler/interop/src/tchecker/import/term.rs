//! Expressions and statements in the attributes of a TChecker file.

use super::{
    ast::{Act, At, Expr, Kind, Model, Op, Statement},
    parse::Fault,
};

/// How deep expressions and statements may be nested.
const MAX_DEPTH: usize = 200;

/// Reads the value of one attribute.
pub struct Terms<'a> {
    model: &'a Model,
    tokens: Vec<(Token<'a>, At)>,
    at: usize,
    end: At,
    depth: usize,
    locals: Vec<String>,
    bad: Option<Fault>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'a> {
    Int(i64),
    Word(&'a str),
    Sign(&'static str),
}

const SIGNS: [&str; 20] =
    ["&&", "==", "!=", "<=", ">=", "<", ">", "!", "=", "+", "-", "*", "/", "%", "(", ")", "[", "]", ";", ","];

impl<'a> Terms<'a> {
    pub fn new(model: &'a Model, text: &'a str, start: At) -> Self {
        let mut terms = Self {
            model,
            tokens: Vec::new(),
            at: 0,
            end: start + text.len(),
            depth: 0,
            locals: Vec::new(),
            bad: None,
        };
        terms.scan(text, start);
        terms
    }

    fn scan(&mut self, text: &'a str, start: At) {
        let mut i = 0;
        while let Some(c) = text[i..].chars().next() {
            let rest = &text[i..];
            if c.is_whitespace() {
                i += c.len_utf8();
                continue;
            }
            let word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '$');
            if c.is_ascii_digit() {
                let len = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
                match rest[..len].parse() {
                    Ok(n) => self.tokens.push((Token::Int(n), start + i)),
                    Err(_) => self.broken(start + i, format!("`{}` is too large", &rest[..len])),
                }
                i += len;
            } else if word(c) {
                let len = rest.find(|c| !word(c)).unwrap_or(rest.len());
                self.tokens.push((Token::Word(&rest[..len]), start + i));
                i += len;
            } else if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
                self.tokens.push((Token::Sign(sign), start + i));
                i += sign.len();
            } else {
                self.broken(start + i, format!("`{c}` means nothing in an expression"));
                i += c.len_utf8();
            }
        }
    }

    fn broken(&mut self, at: At, message: String) {
        self.bad.get_or_insert(Fault { at, message });
    }

    // ── Tokens ──

    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).map(|t| t.0)
    }

    fn here(&self) -> At {
        self.tokens.get(self.at).map_or(self.end, |t| t.1)
    }

    fn take(&mut self, token: Token<'_>) -> bool {
        let found = self.peek() == Some(token);
        self.at += usize::from(found);
        found
    }

    fn sign(&mut self, sign: &'static str) -> bool {
        self.take(Token::Sign(sign))
    }

    fn expect(&mut self, token: Token<'_>) -> Result<(), Fault> {
        if self.take(token) {
            return Ok(());
        }
        let word = match token {
            Token::Int(n) => n.to_string(),
            Token::Word(w) => w.to_owned(),
            Token::Sign(s) => s.to_owned(),
        };
        self.expected(&format!("`{word}`"))
    }

    fn expected<T>(&self, what: &str) -> Result<T, Fault> {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(Token::Int(n)) => format!("`{n}`"),
            Some(Token::Word(w)) => format!("`{w}`"),
            Some(Token::Sign(s)) => format!("`{s}`"),
        };
        Err(Fault { at: self.here(), message: format!("expected {what}, found {found}") })
    }

    fn finish<T>(mut self, value: T) -> Result<T, Fault> {
        match self.bad.take() {
            Some(fault) => Err(fault),
            None if self.at < self.tokens.len() => self.expected("the end of the attribute"),
            None => Ok(value),
        }
    }

    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(Fault { at: self.here(), message: "this is nested too deep".to_owned() });
        }
        let value = read(self);
        self.depth -= 1;
        value
    }

    // ── Expressions ──

    /// A whole attribute: the parts of a conjunction. Nothing is true.
    pub fn condition(mut self) -> Result<Vec<Expr>, Fault> {
        if self.tokens.is_empty() {
            return self.finish(Vec::new());
        }
        let mut parts = Vec::new();
        let whole = self.conjunction()?;
        split(whole, &mut parts);
        self.finish(parts)
    }

    fn conjunction(&mut self) -> Result<Expr, Fault> {
        self.deeper(|t| {
            let mut left = t.atom()?;
            while t.sign("&&") {
                let right = t.atom()?;
                left = binary(Op::And, left, right);
            }
            Ok(left)
        })
    }

    fn atom(&mut self) -> Result<Expr, Fault> {
        let at = self.here();
        if self.sign("!") {
            let inner = self.deeper(Self::atom)?;
            return Ok(Expr { kind: Kind::Not(Box::new(inner)), at });
        }
        let left = self.sum()?;
        let Some(op) = self.comparison() else { return Ok(left) };
        let right = self.sum()?;
        Ok(binary(op, left, right))
    }

    fn comparison(&mut self) -> Option<Op> {
        [Op::Eq, Op::Ne, Op::Le, Op::Ge, Op::Lt, Op::Gt].into_iter().find(|op| self.sign(op.text()))
    }

    fn sum(&mut self) -> Result<Expr, Fault> {
        let mut left = self.product()?;
        while let Some(op) = [Op::Add, Op::Sub].into_iter().find(|op| self.sign(op.text())) {
            let right = self.product()?;
            left = binary(op, left, right);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Expr, Fault> {
        let mut left = self.factor()?;
        while let Some(op) = [Op::Mul, Op::Div, Op::Rem].into_iter().find(|op| self.sign(op.text())) {
            let right = self.factor()?;
            left = binary(op, left, right);
        }
        Ok(left)
    }

    fn factor(&mut self) -> Result<Expr, Fault> {
        let at = self.here();
        if self.sign("-") {
            let inner = self.deeper(Self::factor)?;
            return Ok(Expr { kind: Kind::Neg(Box::new(inner)), at });
        }
        if self.sign("(") {
            let inner = self.conjunction()?;
            self.expect(Token::Sign(")"))?;
            return Ok(inner);
        }
        match self.peek() {
            Some(Token::Int(n)) => {
                self.at += 1;
                Ok(Expr { kind: Kind::Int(n), at })
            }
            Some(Token::Word("if")) => {
                self.at += 1;
                let condition = self.conjunction()?;
                self.expect(Token::Word("then"))?;
                let then = self.sum()?;
                self.expect(Token::Word("else"))?;
                let otherwise = self.sum()?;
                let kind = Kind::If(Box::new(condition), Box::new(then), Box::new(otherwise));
                Ok(Expr { kind, at })
            }
            Some(Token::Word(name)) => {
                self.at += 1;
                self.known(name, at)?;
                let index = self.index()?.map(Box::new);
                Ok(Expr { kind: Kind::Name(name.to_owned(), index), at })
            }
            Some(Token::Sign(_)) | None => self.expected("a term"),
        }
    }

    fn index(&mut self) -> Result<Option<Expr>, Fault> {
        if !self.sign("[") {
            return Ok(None);
        }
        let index = self.deeper(Self::sum)?;
        self.expect(Token::Sign("]"))?;
        Ok(Some(index))
    }

    fn known(&self, name: &str, at: At) -> Result<(), Fault> {
        let clock = self.model.clocks.iter().any(|c| c.name == name);
        let int = self.model.ints.iter().any(|i| i.of.name == name);
        if clock || int || self.locals.iter().any(|l| l == name) {
            return Ok(());
        }
        Err(Fault { at, message: format!("no clock or integer is called `{name}`") })
    }

    // ── Statements ──

    /// A whole attribute.
    pub fn statements(mut self) -> Result<Vec<Statement>, Fault> {
        let all = self.sequence(&[])?;
        self.finish(all)
    }

    /// Up to one of these words, or the end.
    fn sequence(&mut self, stops: &[&str]) -> Result<Vec<Statement>, Fault> {
        let mut all = Vec::new();
        loop {
            while self.sign(";") {}
            match self.peek() {
                None => return Ok(all),
                Some(Token::Word(w)) if stops.contains(&w) => return Ok(all),
                Some(_) => {}
            }
            self.deeper(|t| t.statement(&mut all))?;
            let stops_here = matches!(self.peek(), Some(Token::Word(w)) if stops.contains(&w));
            if self.peek().is_some() && !stops_here && self.peek() != Some(Token::Sign(";")) {
                return self.expected("`;`");
            }
        }
    }

    fn statement(&mut self, out: &mut Vec<Statement>) -> Result<(), Fault> {
        let at = self.here();
        let Some(Token::Word(word)) = self.peek() else { return self.expected("a statement") };
        self.at += 1;
        let kind = match word {
            "nop" => return Ok(()),
            "if" => {
                let condition = self.conjunction()?;
                self.expect(Token::Word("then"))?;
                let then = self.sequence(&["else", "end"])?;
                let otherwise =
                    if self.take(Token::Word("else")) { self.sequence(&["end"])? } else { Vec::new() };
                self.expect(Token::Word("end"))?;
                Act::If { condition, then, otherwise }
            }
            "while" => {
                let condition = self.conjunction()?;
                self.expect(Token::Word("do"))?;
                let body = self.sequence(&["end"])?;
                self.expect(Token::Word("end"))?;
                Act::While { condition, body }
            }
            "local" => {
                let Some(Token::Word(name)) = self.peek() else { return self.expected("a name") };
                self.at += 1;
                let size = self.index()?;
                let init = if self.sign("=") { Some(self.sum()?) } else { None };
                self.locals.push(name.to_owned());
                Act::Local { name: name.to_owned(), size, init }
            }
            name => {
                self.known(name, at)?;
                let index = self.index()?;
                self.expect(Token::Sign("="))?;
                let value = self.sum()?;
                Act::Assign { name: name.to_owned(), index, value }
            }
        };
        out.push(Statement { kind, at });
        Ok(())
    }
}

fn binary(op: Op, left: Expr, right: Expr) -> Expr {
    let at = left.at;
    Expr { kind: Kind::Binary(op, Box::new(left), Box::new(right)), at }
}

fn split(e: Expr, out: &mut Vec<Expr>) {
    match e.kind {
        Kind::Binary(Op::And, left, right) => {
            split(*left, out);
            split(*right, out);
        }
        Kind::Int(_) | Kind::Name(..) | Kind::Neg(_) | Kind::Not(_) | Kind::Binary(..) | Kind::If(..) => {
            out.push(e);
        }
    }
}
