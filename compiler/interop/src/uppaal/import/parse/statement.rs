//! Statements of functions.

use super::{UppaalParseResult, UppaalParser, is_keyword};
use crate::uppaal::import::{
    ast::{UppaalExpr, UppaalStatement, UppaalStatementKind},
    lex::UppaalTokenKind,
};

impl UppaalParser {
    pub(super) fn block(&mut self) -> UppaalParseResult<Vec<UppaalStatement>> {
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

    pub(super) fn boxed(&mut self) -> UppaalParseResult<Box<UppaalStatement>> {
        self.deeper(Self::statement).map(Box::new)
    }

    pub(super) fn statement(&mut self) -> UppaalParseResult<UppaalStatement> {
        let start = self.span();
        self.supported()?;
        let kind = self.statement_kind()?;
        Ok(UppaalStatement { kind, span: start.to(self.last()) })
    }

    pub(super) fn statement_kind(&mut self) -> UppaalParseResult<UppaalStatementKind> {
        if self.is("{") {
            return Ok(UppaalStatementKind::Block(self.block()?));
        }
        if self.take(";") {
            return Ok(UppaalStatementKind::Empty);
        }
        if self.take_word("if") {
            let condition = self.parenthesised()?;
            let then = self.boxed()?;
            let otherwise = if self.take_word("else") { Some(self.boxed()?) } else { None };
            return Ok(UppaalStatementKind::If(condition, then, otherwise));
        }
        if self.take_word("while") {
            return Ok(UppaalStatementKind::While(self.parenthesised()?, self.boxed()?));
        }
        if self.take_word("do") {
            let body = self.boxed()?;
            if !self.take_word("while") {
                return Err(self.fault("`while`"));
            }
            let condition = self.parenthesised()?;
            self.expect(";")?;
            return Ok(UppaalStatementKind::DoWhile(body, condition));
        }
        if self.take_word("for") {
            return self.for_statement();
        }
        if self.take_word("return") {
            let value = if self.is(";") { None } else { Some(self.expr()?) };
            self.expect(";")?;
            return Ok(UppaalStatementKind::Return(value));
        }
        let starts_type = ["const", "int", "bool", "clock", "chan", "typedef", "meta", "struct", "scalar"]
            .iter()
            .any(|w| self.is_word(w));
        if starts_type
            || matches!((self.peek(), self.ahead(1)), (UppaalTokenKind::Word(_), UppaalTokenKind::Word(w)) if !is_keyword(w))
        {
            return Ok(UppaalStatementKind::Decl(self.declaration()?));
        }
        let mut all = vec![self.expr()?];
        while self.take(",") {
            all.push(self.expr()?);
        }
        self.expect(";")?;
        Ok(if all.len() == 1 {
            UppaalStatementKind::Expr(all.swap_remove(0))
        } else {
            let each = |e: UppaalExpr| UppaalStatement { span: e.span, kind: UppaalStatementKind::Expr(e) };
            UppaalStatementKind::Block(all.into_iter().map(each).collect())
        })
    }

    pub(super) fn for_statement(&mut self) -> UppaalParseResult<UppaalStatementKind> {
        self.expect("(")?;
        if matches!((self.peek(), self.ahead(1)), (UppaalTokenKind::Word(_), UppaalTokenKind::Mark(":"))) {
            let (name, _) = self.name("a name")?;
            self.expect(":")?;
            let ty = self.ty()?;
            self.expect(")")?;
            return Ok(UppaalStatementKind::ForRange(name, ty, self.boxed()?));
        }
        let init = self.list(";")?;
        self.expect(";")?;
        let condition = if self.is(";") { None } else { Some(self.expr()?) };
        self.expect(";")?;
        let step = self.list(")")?;
        self.expect(")")?;
        Ok(UppaalStatementKind::For(init, condition, step, self.boxed()?))
    }

    pub(super) fn parenthesised(&mut self) -> UppaalParseResult<UppaalExpr> {
        self.expect("(")?;
        let e = self.expr()?;
        self.expect(")")?;
        Ok(e)
    }
}
