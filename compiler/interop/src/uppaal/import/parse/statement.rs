//! Statements of functions.

use super::{Parsed, Parser, is_keyword};
use crate::uppaal::import::{
    ast::{Expr, Statement, StatementKind},
    lex::Tok,
};

impl Parser {
    pub(super) fn block(&mut self) -> Parsed<Vec<Statement>> {
        self.expect("{")?;
        let mut all = Vec::new();
        while !self.take("}") {
            if self.at_end() {
                return Err(self.fault("`}`"));
            }
            all.push(self.deeper(Self::statement)?);
        }
        Ok(all)
    }

    pub(super) fn boxed(&mut self) -> Parsed<Box<Statement>> {
        self.deeper(Self::statement).map(Box::new)
    }

    pub(super) fn statement(&mut self) -> Parsed<Statement> {
        let start = self.span();
        self.supported()?;
        let kind = self.statement_kind()?;
        Ok(Statement { kind, span: start.to(self.last()) })
    }

    pub(super) fn statement_kind(&mut self) -> Parsed<StatementKind> {
        if self.is("{") {
            return Ok(StatementKind::Block(self.block()?));
        }
        if self.take(";") {
            return Ok(StatementKind::Empty);
        }
        if self.take_word("if") {
            let condition = self.parenthesised()?;
            let then = self.boxed()?;
            let otherwise = if self.take_word("else") { Some(self.boxed()?) } else { None };
            return Ok(StatementKind::If(condition, then, otherwise));
        }
        if self.take_word("while") {
            return Ok(StatementKind::While(self.parenthesised()?, self.boxed()?));
        }
        if self.take_word("do") {
            let body = self.boxed()?;
            if !self.take_word("while") {
                return Err(self.fault("`while`"));
            }
            let condition = self.parenthesised()?;
            self.expect(";")?;
            return Ok(StatementKind::DoWhile(body, condition));
        }
        if self.take_word("for") {
            return self.for_statement();
        }
        if self.take_word("return") {
            let value = if self.is(";") { None } else { Some(self.expr()?) };
            self.expect(";")?;
            return Ok(StatementKind::Return(value));
        }
        let starts_type =
            ["const", "int", "bool", "clock", "chan", "typedef"].iter().any(|w| self.is_word(w));
        if starts_type
            || matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Word(w)) if !is_keyword(w))
        {
            return Ok(StatementKind::Decl(self.declaration()?));
        }
        let mut all = vec![self.expr()?];
        while self.take(",") {
            all.push(self.expr()?);
        }
        self.expect(";")?;
        Ok(if all.len() == 1 {
            StatementKind::Expr(all.swap_remove(0))
        } else {
            let each = |e: Expr| Statement { span: e.span, kind: StatementKind::Expr(e) };
            StatementKind::Block(all.into_iter().map(each).collect())
        })
    }

    pub(super) fn for_statement(&mut self) -> Parsed<StatementKind> {
        self.expect("(")?;
        if matches!((self.peek(), self.ahead(1)), (Tok::Word(_), Tok::Mark(":"))) {
            let (name, _) = self.name("a name")?;
            self.expect(":")?;
            let ty = self.ty()?;
            self.expect(")")?;
            return Ok(StatementKind::ForRange(name, ty, self.boxed()?));
        }
        let init = self.list(";")?;
        self.expect(";")?;
        let condition = if self.is(";") { None } else { Some(self.expr()?) };
        self.expect(";")?;
        let step = self.list(")")?;
        self.expect(")")?;
        Ok(StatementKind::For(init, condition, step, self.boxed()?))
    }

    pub(super) fn parenthesised(&mut self) -> Parsed<Expr> {
        self.expect("(")?;
        let e = self.expr()?;
        self.expect(")")?;
        Ok(e)
    }
}
