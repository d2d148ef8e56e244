//! Expressions, from the loosest operator to the tightest.

use super::{UppaalParseResult, UppaalParser, is_keyword};
use crate::uppaal::import::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind, UppaalQuantifier},
    fault::UppaalFault,
    lex::UppaalTokenKind,
};

/// How many operators an expression may have.
const MAX_OPERATORS: usize = 600;

impl UppaalParser {
    pub fn expr(&mut self) -> UppaalParseResult<UppaalExpr> {
        if self.depth == 0 {
            self.operators = 0;
        }
        self.deeper(Self::words_or)
    }

    pub(super) fn operator(&mut self) -> UppaalParseResult<()> {
        self.operators += 1;
        if self.operators > MAX_OPERATORS {
            let message = format!("this expression has more than {MAX_OPERATORS} operators");
            return Err(UppaalFault { span: self.span(), message });
        }
        Ok(())
    }

    pub(super) fn words_or(&mut self) -> UppaalParseResult<UppaalExpr> {
        let mut left = self.words_and()?;
        loop {
            let op = if self.take_word("or") {
                UppaalBinaryOperator::Or
            } else if self.take_word("imply") {
                UppaalBinaryOperator::Imply
            } else {
                return Ok(left);
            };
            self.operator()?;
            left = binary(op, left, self.words_and()?);
        }
    }

    pub(super) fn words_and(&mut self) -> UppaalParseResult<UppaalExpr> {
        let mut left = self.word_not()?;
        while self.take_word("and") {
            self.operator()?;
            left = binary(UppaalBinaryOperator::And, left, self.word_not()?);
        }
        Ok(left)
    }

    pub(super) fn word_not(&mut self) -> UppaalParseResult<UppaalExpr> {
        let start = self.span();
        if self.take_word("not") {
            let of = self.deeper(Self::word_not)?;
            return Ok(UppaalExpr { span: start.to(of.span), kind: UppaalExprKind::Not(Box::new(of)) });
        }
        self.assignment()
    }

    pub(super) fn assignment(&mut self) -> UppaalParseResult<UppaalExpr> {
        let left = self.choice()?;
        let UppaalTokenKind::Mark(mark) = *self.peek() else { return Ok(left) };
        let op = match mark {
            "=" | ":=" => None,
            "+=" => Some(UppaalBinaryOperator::Add),
            "-=" => Some(UppaalBinaryOperator::Sub),
            "*=" => Some(UppaalBinaryOperator::Mul),
            "/=" => Some(UppaalBinaryOperator::Div),
            "%=" => Some(UppaalBinaryOperator::Rem),
            "&=" => Some(UppaalBinaryOperator::BitAnd),
            "|=" => Some(UppaalBinaryOperator::BitOr),
            "^=" => Some(UppaalBinaryOperator::BitXor),
            "<<=" => Some(UppaalBinaryOperator::ShiftLeft),
            ">>=" => Some(UppaalBinaryOperator::ShiftRight),
            _ => return Ok(left),
        };
        self.next();
        let right = self.deeper(Self::assignment)?;
        let span = left.span.to(right.span);
        Ok(UppaalExpr { kind: UppaalExprKind::Assign(op, Box::new(left), Box::new(right)), span })
    }

    pub(super) fn choice(&mut self) -> UppaalParseResult<UppaalExpr> {
        let condition = self.operators(0)?;
        // In a synchronisation `?` is the last mark; there it is never read here.
        if !self.take("?") {
            return Ok(condition);
        }
        let then = self.deeper(Self::choice)?;
        self.expect(":")?;
        let otherwise = self.deeper(Self::choice)?;
        let span = condition.span.to(otherwise.span);
        Ok(UppaalExpr {
            kind: UppaalExprKind::Choice(Box::new(condition), Box::new(then), Box::new(otherwise)),
            span,
        })
    }

    pub(super) fn operators(&mut self, level: usize) -> UppaalParseResult<UppaalExpr> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.operators(level + 1)?;
        loop {
            let UppaalTokenKind::Mark(mark) = *self.peek() else { return Ok(left) };
            let Some((_, op)) = operators.iter().find(|(m, _)| *m == mark) else { return Ok(left) };
            self.next();
            self.operator()?;
            left = binary(*op, left, self.operators(level + 1)?);
        }
    }

    pub(super) fn unary(&mut self) -> UppaalParseResult<UppaalExpr> {
        let start = self.span();
        let UppaalTokenKind::Mark(mark @ ("!" | "-" | "+" | "++" | "--")) = *self.peek() else {
            return self.postfix();
        };
        self.next();
        let of = self.deeper(Self::unary)?;
        let span = start.to(of.span);
        Ok(match mark {
            "!" => UppaalExpr { kind: UppaalExprKind::Not(Box::new(of)), span },
            "-" => UppaalExpr { kind: UppaalExprKind::Neg(Box::new(of)), span },
            "++" | "--" => UppaalExpr {
                kind: UppaalExprKind::Step { up: mark == "++", first: true, of: Box::new(of) },
                span,
            },
            _ => of,
        })
    }

    pub(super) fn postfix(&mut self) -> UppaalParseResult<UppaalExpr> {
        let mut e = self.atom()?;
        loop {
            self.operator()?;
            let kind = if self.take("[") {
                let index = self.expr()?;
                self.expect("]")?;
                UppaalExprKind::Index(Box::new(e.clone()), Box::new(index))
            } else if self.take("(") {
                let args = self.list(")")?;
                self.expect(")")?;
                UppaalExprKind::Call(Box::new(e.clone()), args)
            } else if self.take(".") {
                let UppaalTokenKind::Word(field) = self.peek().clone() else {
                    return Err(self.fault("a name"));
                };
                self.next();
                UppaalExprKind::Field(Box::new(e.clone()), field)
            } else if self.is("++") || self.is("--") {
                let up = self.is("++");
                self.next();
                UppaalExprKind::Step { up, first: false, of: Box::new(e.clone()) }
            } else if self.take("'") {
                UppaalExprKind::Rate(Box::new(e.clone()))
            } else {
                return Ok(e);
            };
            e = UppaalExpr { kind, span: e.span.to(self.last()) };
        }
    }

    pub(super) fn atom(&mut self) -> UppaalParseResult<UppaalExpr> {
        let span = self.span();
        self.supported()?;
        let kind = match self.peek().clone() {
            UppaalTokenKind::Int(n) => UppaalExprKind::Int(n),
            UppaalTokenKind::Mark("(") => return self.parenthesised(),
            UppaalTokenKind::Word(w) => match w.as_str() {
                "true" => UppaalExprKind::Bool(true),
                "false" => UppaalExprKind::Bool(false),
                "deadlock" => UppaalExprKind::Deadlock,
                "forall" => return self.quantified(UppaalQuantifier::Forall),
                "exists" => return self.quantified(UppaalQuantifier::Exists),
                "sum" => return self.quantified(UppaalQuantifier::Sum),
                w if is_keyword(w) => return Err(self.fault("an expression")),
                _ => UppaalExprKind::Name(w),
            },
            UppaalTokenKind::Mark(_) | UppaalTokenKind::End => return Err(self.fault("an expression")),
        };
        self.next();
        Ok(UppaalExpr { kind, span })
    }

    pub(super) fn quantified(&mut self, quantifier: UppaalQuantifier) -> UppaalParseResult<UppaalExpr> {
        let start = self.span();
        self.next();
        self.expect("(")?;
        let (name, _) = self.name("a name")?;
        self.expect(":")?;
        let ty = self.ty()?;
        self.expect(")")?;
        let of = self.expr()?;
        let span = start.to(of.span);
        Ok(UppaalExpr {
            kind: UppaalExprKind::Quantified(quantifier, name, Box::new(ty), Box::new(of)),
            span,
        })
    }
}

/// Operators of two operands, from the loosest to the tightest.
const LEVELS: &[&[(&str, UppaalBinaryOperator)]] = &[
    &[("||", UppaalBinaryOperator::Or)],
    &[("&&", UppaalBinaryOperator::And)],
    &[("|", UppaalBinaryOperator::BitOr)],
    &[("^", UppaalBinaryOperator::BitXor)],
    &[("&", UppaalBinaryOperator::BitAnd)],
    &[("==", UppaalBinaryOperator::Eq), ("!=", UppaalBinaryOperator::Ne)],
    &[
        ("<", UppaalBinaryOperator::Lt),
        ("<=", UppaalBinaryOperator::Le),
        (">", UppaalBinaryOperator::Gt),
        (">=", UppaalBinaryOperator::Ge),
    ],
    &[("<?", UppaalBinaryOperator::Min), (">?", UppaalBinaryOperator::Max)],
    &[("<<", UppaalBinaryOperator::ShiftLeft), (">>", UppaalBinaryOperator::ShiftRight)],
    &[("+", UppaalBinaryOperator::Add), ("-", UppaalBinaryOperator::Sub)],
    &[("*", UppaalBinaryOperator::Mul), ("/", UppaalBinaryOperator::Div), ("%", UppaalBinaryOperator::Rem)],
];

fn binary(op: UppaalBinaryOperator, left: UppaalExpr, right: UppaalExpr) -> UppaalExpr {
    let span = left.span.to(right.span);
    UppaalExpr { kind: UppaalExprKind::Binary(op, Box::new(left), Box::new(right)), span }
}
