//! Expressions, from the loosest operator to the tightest.

use super::{Parsed, Parser, is_keyword};
use crate::uppaal::import::{
    ast::{BinaryOp, Expr, ExprKind, Quantifier},
    fault::{Fault, unsupported},
    lex::Tok,
};

/// How many operators an expression may have.
const MAX_OPERATORS: usize = 600;

impl Parser {
    pub fn expr(&mut self) -> Parsed<Expr> {
        if self.depth == 0 {
            self.operators = 0;
        }
        self.deeper(Self::words_or)
    }

    pub(super) fn operator(&mut self) -> Parsed<()> {
        self.operators += 1;
        if self.operators > MAX_OPERATORS {
            let message = format!("this expression has more than {MAX_OPERATORS} operators");
            return Err(Fault { span: self.span(), message });
        }
        Ok(())
    }

    pub(super) fn words_or(&mut self) -> Parsed<Expr> {
        let mut left = self.words_and()?;
        loop {
            let op = if self.take_word("or") {
                BinaryOp::Or
            } else if self.take_word("imply") {
                BinaryOp::Imply
            } else {
                return Ok(left);
            };
            self.operator()?;
            left = binary(op, left, self.words_and()?);
        }
    }

    pub(super) fn words_and(&mut self) -> Parsed<Expr> {
        let mut left = self.word_not()?;
        while self.take_word("and") {
            self.operator()?;
            left = binary(BinaryOp::And, left, self.word_not()?);
        }
        Ok(left)
    }

    pub(super) fn word_not(&mut self) -> Parsed<Expr> {
        let start = self.span();
        if self.take_word("not") {
            let of = self.deeper(Self::word_not)?;
            return Ok(Expr { span: start.to(of.span), kind: ExprKind::Not(Box::new(of)) });
        }
        self.assignment()
    }

    pub(super) fn assignment(&mut self) -> Parsed<Expr> {
        let left = self.choice()?;
        let Tok::Mark(mark) = *self.peek() else { return Ok(left) };
        let op = match mark {
            "=" | ":=" => None,
            "+=" => Some(BinaryOp::Add),
            "-=" => Some(BinaryOp::Sub),
            "*=" => Some(BinaryOp::Mul),
            "/=" => Some(BinaryOp::Div),
            "%=" => Some(BinaryOp::Rem),
            "&=" | "|=" | "^=" | "<<=" | ">>=" => return Err(self.bits(mark)),
            _ => return Ok(left),
        };
        self.next();
        let right = self.deeper(Self::assignment)?;
        let span = left.span.to(right.span);
        Ok(Expr { kind: ExprKind::Assign(op, Box::new(left), Box::new(right)), span })
    }

    pub(super) fn bits(&self, mark: &str) -> Fault {
        unsupported(self.span(), &format!("operations on bits (`{mark}`)"))
    }

    pub(super) fn choice(&mut self) -> Parsed<Expr> {
        let condition = self.operators(0)?;
        // In a synchronisation `?` is the last mark; there it is never read here.
        if !self.take("?") {
            return Ok(condition);
        }
        let then = self.deeper(Self::choice)?;
        self.expect(":")?;
        let otherwise = self.deeper(Self::choice)?;
        let span = condition.span.to(otherwise.span);
        Ok(Expr { kind: ExprKind::Choice(Box::new(condition), Box::new(then), Box::new(otherwise)), span })
    }

    pub(super) fn operators(&mut self, level: usize) -> Parsed<Expr> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.operators(level + 1)?;
        loop {
            let Tok::Mark(mark) = *self.peek() else { return Ok(left) };
            if ["&", "|", "^", "<<", ">>"].contains(&mark) {
                return Err(self.bits(mark));
            }
            let Some((_, op)) = operators.iter().find(|(m, _)| *m == mark) else { return Ok(left) };
            self.next();
            self.operator()?;
            left = binary(*op, left, self.operators(level + 1)?);
        }
    }

    pub(super) fn unary(&mut self) -> Parsed<Expr> {
        let start = self.span();
        let Tok::Mark(mark @ ("!" | "-" | "+" | "++" | "--")) = *self.peek() else { return self.postfix() };
        self.next();
        let of = self.deeper(Self::unary)?;
        let span = start.to(of.span);
        Ok(match mark {
            "!" => Expr { kind: ExprKind::Not(Box::new(of)), span },
            "-" => Expr { kind: ExprKind::Neg(Box::new(of)), span },
            "++" | "--" => Expr { kind: ExprKind::Step { up: mark == "++", of: Box::new(of) }, span },
            _ => of,
        })
    }

    pub(super) fn postfix(&mut self) -> Parsed<Expr> {
        let mut e = self.atom()?;
        loop {
            self.operator()?;
            let kind = if self.take("[") {
                let index = self.expr()?;
                self.expect("]")?;
                ExprKind::Index(Box::new(e.clone()), Box::new(index))
            } else if self.take("(") {
                let args = self.list(")")?;
                self.expect(")")?;
                ExprKind::Call(Box::new(e.clone()), args)
            } else if self.take(".") {
                let Tok::Word(field) = self.peek().clone() else { return Err(self.fault("a name")) };
                self.next();
                ExprKind::Field(Box::new(e.clone()), field)
            } else if self.is("++") || self.is("--") {
                let up = self.is("++");
                self.next();
                ExprKind::Step { up, of: Box::new(e.clone()) }
            } else if self.take("'") {
                ExprKind::Rate
            } else {
                return Ok(e);
            };
            e = Expr { kind, span: e.span.to(self.last()) };
        }
    }

    pub(super) fn atom(&mut self) -> Parsed<Expr> {
        let span = self.span();
        self.supported()?;
        let kind = match self.peek().clone() {
            Tok::Int(n) => ExprKind::Int(n),
            Tok::Mark("(") => return self.parenthesised(),
            Tok::Word(w) => match w.as_str() {
                "true" => ExprKind::Bool(true),
                "false" => ExprKind::Bool(false),
                "deadlock" => ExprKind::Deadlock,
                "forall" => return self.quantified(Quantifier::Forall),
                "exists" => return self.quantified(Quantifier::Exists),
                "sum" => return self.quantified(Quantifier::Sum),
                w if is_keyword(w) => return Err(self.fault("an expression")),
                _ => ExprKind::Name(w),
            },
            Tok::Mark(_) | Tok::End => return Err(self.fault("an expression")),
        };
        self.next();
        Ok(Expr { kind, span })
    }

    pub(super) fn quantified(&mut self, quantifier: Quantifier) -> Parsed<Expr> {
        let start = self.span();
        self.next();
        self.expect("(")?;
        let (name, _) = self.name("a name")?;
        self.expect(":")?;
        let ty = self.ty()?;
        self.expect(")")?;
        let of = self.expr()?;
        let span = start.to(of.span);
        Ok(Expr { kind: ExprKind::Quantified(quantifier, name, Box::new(ty), Box::new(of)), span })
    }
}

/// Operators of two operands, from the loosest to the tightest.
const LEVELS: &[&[(&str, BinaryOp)]] = &[
    &[("||", BinaryOp::Or)],
    &[("&&", BinaryOp::And)],
    &[("==", BinaryOp::Eq), ("!=", BinaryOp::Ne)],
    &[("<", BinaryOp::Lt), ("<=", BinaryOp::Le), (">", BinaryOp::Gt), (">=", BinaryOp::Ge)],
    &[("<?", BinaryOp::Min), (">?", BinaryOp::Max)],
    &[("+", BinaryOp::Add), ("-", BinaryOp::Sub)],
    &[("*", BinaryOp::Mul), ("/", BinaryOp::Div), ("%", BinaryOp::Rem)],
];

fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    Expr { kind: ExprKind::Binary(op, Box::new(left), Box::new(right)), span }
}
