//! Expressions and statements in the attributes of a TChecker file.

use super::{
    ast::{
        ByteOffset, TcheckerExpr, TcheckerExprKind, TcheckerModel, TcheckerOperator, TcheckerStatement,
        TcheckerStatementKind,
    },
    parse::TcheckerFault,
};

/// How deep expressions and statements may be nested.
const MAX_DEPTH: usize = 200;

/// Reads the value of one attribute.
pub struct TcheckerTermParser<'a> {
    model: &'a TcheckerModel,
    tokens: Vec<(TcheckerToken<'a>, ByteOffset)>,
    at: usize,
    end: ByteOffset,
    depth: usize,
    locals: Vec<String>,
    bad: Option<TcheckerFault>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum TcheckerToken<'a> {
    Int(i64),
    Word(&'a str),
    Sign(&'static str),
}

const SIGNS: [&str; 20] =
    ["&&", "==", "!=", "<=", ">=", "<", ">", "!", "=", "+", "-", "*", "/", "%", "(", ")", "[", "]", ";", ","];

impl<'a> TcheckerTermParser<'a> {
    pub fn new(model: &'a TcheckerModel, text: &'a str, start: ByteOffset) -> Self {
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

    fn scan(&mut self, text: &'a str, start: ByteOffset) {
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
                    Ok(n) => self.tokens.push((TcheckerToken::Int(n), start + i)),
                    Err(_) => self.broken(start + i, format!("`{}` is too large", &rest[..len])),
                }
                i += len;
            } else if word(c) {
                let len = rest.find(|c| !word(c)).unwrap_or(rest.len());
                self.tokens.push((TcheckerToken::Word(&rest[..len]), start + i));
                i += len;
            } else if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
                self.tokens.push((TcheckerToken::Sign(sign), start + i));
                i += sign.len();
            } else {
                self.broken(start + i, format!("`{c}` means nothing in an expression"));
                i += c.len_utf8();
            }
        }
    }

    fn broken(&mut self, at: ByteOffset, message: String) {
        self.bad.get_or_insert(TcheckerFault { at, message });
    }

    // ── Tokens ──

    fn peek(&self) -> Option<TcheckerToken<'a>> {
        self.tokens.get(self.at).map(|t| t.0)
    }

    fn here(&self) -> ByteOffset {
        self.tokens.get(self.at).map_or(self.end, |t| t.1)
    }

    fn take(&mut self, token: TcheckerToken<'_>) -> bool {
        let found = self.peek() == Some(token);
        self.at += usize::from(found);
        found
    }

    fn sign(&mut self, sign: &'static str) -> bool {
        self.take(TcheckerToken::Sign(sign))
    }

    fn expect(&mut self, token: TcheckerToken<'_>) -> Result<(), TcheckerFault> {
        if self.take(token) {
            return Ok(());
        }
        let word = match token {
            TcheckerToken::Int(n) => n.to_string(),
            TcheckerToken::Word(w) => w.to_owned(),
            TcheckerToken::Sign(s) => s.to_owned(),
        };
        self.expected(&format!("`{word}`"))
    }

    fn expected<T>(&self, what: &str) -> Result<T, TcheckerFault> {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(TcheckerToken::Int(n)) => format!("`{n}`"),
            Some(TcheckerToken::Word(w)) => format!("`{w}`"),
            Some(TcheckerToken::Sign(s)) => format!("`{s}`"),
        };
        Err(TcheckerFault { at: self.here(), message: format!("expected {what}, found {found}") })
    }

    fn finish<T>(mut self, value: T) -> Result<T, TcheckerFault> {
        match self.bad.take() {
            Some(fault) => Err(fault),
            None if self.at < self.tokens.len() => self.expected("the end of the attribute"),
            None => Ok(value),
        }
    }

    fn deeper<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, TcheckerFault>,
    ) -> Result<T, TcheckerFault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(TcheckerFault { at: self.here(), message: "this is nested too deep".to_owned() });
        }
        let value = read(self);
        self.depth -= 1;
        value
    }

    // ── Expressions ──

    /// A whole attribute: the parts of a conjunction. Nothing is true.
    pub fn condition(mut self) -> Result<Vec<TcheckerExpr>, TcheckerFault> {
        if self.tokens.is_empty() {
            return self.finish(Vec::new());
        }
        let mut parts = Vec::new();
        let whole = self.conjunction()?;
        split(whole, &mut parts);
        self.finish(parts)
    }

    fn conjunction(&mut self) -> Result<TcheckerExpr, TcheckerFault> {
        self.deeper(|t| {
            let mut left = t.atom()?;
            while t.sign("&&") {
                let right = t.atom()?;
                left = binary(TcheckerOperator::And, left, right);
            }
            Ok(left)
        })
    }

    fn atom(&mut self) -> Result<TcheckerExpr, TcheckerFault> {
        let at = self.here();
        if self.sign("!") {
            let inner = self.deeper(Self::atom)?;
            return Ok(TcheckerExpr { kind: TcheckerExprKind::Not(Box::new(inner)), at });
        }
        let left = self.sum()?;
        let Some(op) = self.comparison() else { return Ok(left) };
        let right = self.sum()?;
        Ok(binary(op, left, right))
    }

    fn comparison(&mut self) -> Option<TcheckerOperator> {
        [
            TcheckerOperator::Eq,
            TcheckerOperator::Ne,
            TcheckerOperator::Le,
            TcheckerOperator::Ge,
            TcheckerOperator::Lt,
            TcheckerOperator::Gt,
        ]
        .into_iter()
        .find(|op| self.sign(op.text()))
    }

    fn sum(&mut self) -> Result<TcheckerExpr, TcheckerFault> {
        let mut left = self.product()?;
        while let Some(op) =
            [TcheckerOperator::Add, TcheckerOperator::Sub].into_iter().find(|op| self.sign(op.text()))
        {
            let right = self.product()?;
            left = binary(op, left, right);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<TcheckerExpr, TcheckerFault> {
        let mut left = self.factor()?;
        while let Some(op) = [TcheckerOperator::Mul, TcheckerOperator::Div, TcheckerOperator::Rem]
            .into_iter()
            .find(|op| self.sign(op.text()))
        {
            let right = self.factor()?;
            left = binary(op, left, right);
        }
        Ok(left)
    }

    fn factor(&mut self) -> Result<TcheckerExpr, TcheckerFault> {
        let at = self.here();
        if self.sign("-") {
            let inner = self.deeper(Self::factor)?;
            return Ok(TcheckerExpr { kind: TcheckerExprKind::Neg(Box::new(inner)), at });
        }
        if self.sign("(") {
            let inner = self.conjunction()?;
            self.expect(TcheckerToken::Sign(")"))?;
            return Ok(inner);
        }
        match self.peek() {
            Some(TcheckerToken::Int(n)) => {
                self.at += 1;
                Ok(TcheckerExpr { kind: TcheckerExprKind::Int(n), at })
            }
            Some(TcheckerToken::Word("if")) => {
                self.at += 1;
                let condition = self.conjunction()?;
                self.expect(TcheckerToken::Word("then"))?;
                let then = self.sum()?;
                self.expect(TcheckerToken::Word("else"))?;
                let otherwise = self.sum()?;
                let kind = TcheckerExprKind::If(Box::new(condition), Box::new(then), Box::new(otherwise));
                Ok(TcheckerExpr { kind, at })
            }
            Some(TcheckerToken::Word(name)) => {
                self.at += 1;
                self.known(name, at)?;
                let index = self.index()?.map(Box::new);
                Ok(TcheckerExpr { kind: TcheckerExprKind::Name(name.to_owned(), index), at })
            }
            Some(TcheckerToken::Sign(_)) | None => self.expected("a term"),
        }
    }

    fn index(&mut self) -> Result<Option<TcheckerExpr>, TcheckerFault> {
        if !self.sign("[") {
            return Ok(None);
        }
        let index = self.deeper(Self::sum)?;
        self.expect(TcheckerToken::Sign("]"))?;
        Ok(Some(index))
    }

    fn known(&self, name: &str, at: ByteOffset) -> Result<(), TcheckerFault> {
        let clock = self.model.clocks.iter().any(|c| c.name == name);
        let int = self.model.ints.iter().any(|i| i.of.name == name);
        if clock || int || self.locals.iter().any(|l| l == name) {
            return Ok(());
        }
        Err(TcheckerFault { at, message: format!("no clock or integer is called `{name}`") })
    }

    // ── Statements ──

    /// A whole attribute.
    pub fn statements(mut self) -> Result<Vec<TcheckerStatement>, TcheckerFault> {
        let all = self.sequence(&[])?;
        self.finish(all)
    }

    /// Up to one of these words, or the end.
    fn sequence(&mut self, stops: &[&str]) -> Result<Vec<TcheckerStatement>, TcheckerFault> {
        let mut all = Vec::new();
        loop {
            while self.sign(";") {}
            match self.peek() {
                None => return Ok(all),
                Some(TcheckerToken::Word(w)) if stops.contains(&w) => return Ok(all),
                Some(_) => {}
            }
            self.deeper(|t| t.statement(&mut all))?;
            let stops_here = matches!(self.peek(), Some(TcheckerToken::Word(w)) if stops.contains(&w));
            if self.peek().is_some() && !stops_here && self.peek() != Some(TcheckerToken::Sign(";")) {
                return self.expected("`;`");
            }
        }
    }

    fn statement(&mut self, out: &mut Vec<TcheckerStatement>) -> Result<(), TcheckerFault> {
        let at = self.here();
        let Some(TcheckerToken::Word(word)) = self.peek() else { return self.expected("a statement") };
        self.at += 1;
        let kind = match word {
            "nop" => return Ok(()),
            "if" => {
                let condition = self.conjunction()?;
                self.expect(TcheckerToken::Word("then"))?;
                let then = self.sequence(&["else", "end"])?;
                let otherwise = if self.take(TcheckerToken::Word("else")) {
                    self.sequence(&["end"])?
                } else {
                    Vec::new()
                };
                self.expect(TcheckerToken::Word("end"))?;
                TcheckerStatementKind::If { condition, then, otherwise }
            }
            "while" => {
                let condition = self.conjunction()?;
                self.expect(TcheckerToken::Word("do"))?;
                let body = self.sequence(&["end"])?;
                self.expect(TcheckerToken::Word("end"))?;
                TcheckerStatementKind::While { condition, body }
            }
            "local" => {
                let Some(TcheckerToken::Word(name)) = self.peek() else { return self.expected("a name") };
                self.at += 1;
                let size = self.index()?;
                let init = if self.sign("=") { Some(self.sum()?) } else { None };
                self.locals.push(name.to_owned());
                TcheckerStatementKind::Local { name: name.to_owned(), size, init }
            }
            name => {
                self.known(name, at)?;
                let index = self.index()?;
                self.expect(TcheckerToken::Sign("="))?;
                let value = self.sum()?;
                TcheckerStatementKind::Assign { name: name.to_owned(), index, value }
            }
        };
        out.push(TcheckerStatement { kind, at });
        Ok(())
    }
}

fn binary(op: TcheckerOperator, left: TcheckerExpr, right: TcheckerExpr) -> TcheckerExpr {
    let at = left.at;
    TcheckerExpr { kind: TcheckerExprKind::Binary(op, Box::new(left), Box::new(right)), at }
}

fn split(e: TcheckerExpr, out: &mut Vec<TcheckerExpr>) {
    match e.kind {
        TcheckerExprKind::Binary(TcheckerOperator::And, left, right) => {
            split(*left, out);
            split(*right, out);
        }
        TcheckerExprKind::Int(_)
        | TcheckerExprKind::Name(..)
        | TcheckerExprKind::Neg(_)
        | TcheckerExprKind::Not(_)
        | TcheckerExprKind::Binary(..)
        | TcheckerExprKind::If(..) => {
            out.push(e);
        }
    }
}
