//! Terms and formulas, from the loosest operator to the tightest.

use super::{Parsed, Parser};
use crate::agentspeak::{
    ast::{Literal, Op, Plan, Step, StepKind, Term, TermKind, TriggerKind},
    lex::Tok,
};

impl Parser {
    /// A formula, or any term.
    pub(super) fn formula(&mut self) -> Parsed<Term> {
        self.deeper(|p| {
            let left = p.conjunction()?;
            if p.take("|") {
                let right = p.formula()?;
                return Ok(binary(Op::Or, left, right));
            }
            Ok(left)
        })
    }

    fn conjunction(&mut self) -> Parsed<Term> {
        self.deeper(|p| {
            let left = p.negation()?;
            if p.take("&") {
                let right = p.conjunction()?;
                return Ok(binary(Op::And, left, right));
            }
            Ok(left)
        })
    }

    fn negation(&mut self) -> Parsed<Term> {
        let start = self.here();
        if !self.is_word("not") {
            return self.relation();
        }
        self.advance();
        let of = self.deeper(Self::negation)?;
        Ok(Term { kind: TermKind::Not(Box::new(of)), span: self.since(start) })
    }

    fn relation(&mut self) -> Parsed<Term> {
        let left = self.sum()?;
        let op = match self.peek() {
            Tok::Mark("<") => Op::Less,
            Tok::Mark("<=") => Op::LessEqual,
            Tok::Mark(">") => Op::Greater,
            Tok::Mark(">=") => Op::GreaterEqual,
            Tok::Mark("==") => Op::Equal,
            Tok::Mark("\\==") => Op::Different,
            Tok::Mark("=") => Op::Unify,
            Tok::Mark("\\=") => Op::NotUnify,
            Tok::Mark("=..") => Op::Univ,
            _ => return Ok(left),
        };
        self.advance();
        let right = self.sum()?;
        Ok(binary(op, left, right))
    }

    /// What may stand in a list: no formula, because `|` is the list's.
    fn sum(&mut self) -> Parsed<Term> {
        let mut left = self.product()?;
        loop {
            let op = match self.peek() {
                Tok::Mark("+") => Op::Add,
                Tok::Mark("-") => Op::Sub,
                _ => return Ok(left),
            };
            self.advance();
            left = binary(op, left, self.product()?);
        }
    }

    fn product(&mut self) -> Parsed<Term> {
        let mut left = self.power()?;
        loop {
            let op = match self.peek() {
                Tok::Mark("*") => Op::Mul,
                Tok::Mark("/") => Op::Div,
                Tok::Word("div") => Op::IntDiv,
                Tok::Word("mod") => Op::Mod,
                _ => return Ok(left),
            };
            self.advance();
            left = binary(op, left, self.power()?);
        }
    }

    fn power(&mut self) -> Parsed<Term> {
        let left = self.simple()?;
        if self.take("**") {
            let right = self.deeper(Self::power)?;
            return Ok(binary(Op::Pow, left, right));
        }
        Ok(left)
    }

    fn simple(&mut self) -> Parsed<Term> {
        let start = self.here();
        let kind = match self.peek().clone() {
            Tok::Int(n) => {
                self.advance();
                TermKind::Int(n)
            }
            Tok::Float(x) => {
                self.advance();
                TermKind::Float(x)
            }
            Tok::Text(t) => {
                self.advance();
                TermKind::Text(t)
            }
            Tok::Word(w @ ("true" | "false")) => {
                self.advance();
                TermKind::Bool(w == "true")
            }
            Tok::Any | Tok::Var(_) => return self.literal_or_var(""),
            Tok::Mark("+") => {
                self.advance();
                return self.deeper(Self::simple);
            }
            Tok::Mark("-") => {
                self.advance();
                match self.deeper(Self::simple)? {
                    Term { kind: TermKind::Int(n), .. } => TermKind::Int(-n),
                    Term { kind: TermKind::Float(x), .. } => TermKind::Float(-x),
                    other => TermKind::Neg(Box::new(other)),
                }
            }
            Tok::Mark("(") => {
                self.advance();
                let inner = self.formula()?;
                self.expect(")", "to close the parenthesis")?;
                return Ok(inner);
            }
            Tok::Mark("[") => self.deeper(Self::list)?,
            Tok::Mark("{") => self.deeper(Self::braces)?,
            _ => return self.deeper(|p| p.literal_or_var("here")),
        };
        Ok(Term { kind, span: self.since(start) })
    }

    pub(super) fn literal_or_var(&mut self, place: &str) -> Parsed<Term> {
        let start = self.here();
        let kind = match self.peek().clone() {
            Tok::Any => {
                self.advance();
                TermKind::Any
            }
            Tok::Var(name) => {
                self.advance();
                let annotations = if self.is("[") { self.annotations()? } else { Vec::new() };
                TermKind::Var { name, annotations }
            }
            _ => TermKind::Literal(self.literal(format!("a term {place}").trim_end())?),
        };
        Ok(Term { kind, span: self.since(start) })
    }

    /// `~ns::name(args)[annotations]`
    pub(super) fn literal(&mut self, what: &str) -> Parsed<Literal> {
        let start = self.here();
        let negated = self.take("~");
        let mut functor = String::new();
        if self.take("::") {
            functor.push_str("default::");
        }
        loop {
            let Tok::Atom(name) = self.peek().clone() else { return Err(self.expected(what)) };
            self.advance();
            functor.push_str(&name);
            if !self.take("::") {
                break;
            }
            functor.push_str("::");
        }
        let functor = functor.strip_prefix("default::").map(str::to_owned).unwrap_or(functor);
        let mut args = Vec::new();
        if self.take("(") && !self.take(")") {
            args.push(self.formula()?);
            while self.take(",") {
                args.push(self.formula()?);
            }
            self.expect(")", "or `,` after the argument")?;
        }
        let annotations = if self.is("[") { self.annotations()? } else { Vec::new() };
        Ok(Literal { negated, functor, args, annotations, span: self.since(start) })
    }

    pub(super) fn annotations(&mut self) -> Parsed<Vec<Term>> {
        let start = self.here();
        let TermKind::List { mut items, rest } = self.deeper(Self::list)? else { return Ok(Vec::new()) };
        // What is left of the annotations: nothing that a scenario could speak of.
        if let Some(rest) = rest {
            let (items_of_rest, tail) = (vec![*rest], None);
            items.push(Term {
                kind: TermKind::List { items: items_of_rest, rest: tail },
                span: self.since(start),
            });
        }
        Ok(items)
    }

    fn list(&mut self) -> Parsed<TermKind> {
        self.advance();
        let (mut items, mut rest) = (Vec::new(), None);
        if self.take("]") {
            return Ok(TermKind::List { items, rest });
        }
        items.push(self.sum()?);
        while self.take(",") {
            items.push(self.sum()?);
        }
        if self.take("|") {
            rest = Some(Box::new(self.sum()?));
        }
        self.expect("]", "or `,` in the list")?;
        Ok(TermKind::List { items, rest })
    }

    /// `{ … }` as a term: a trigger, a plan, or a body.
    fn braces(&mut self) -> Parsed<TermKind> {
        self.advance();
        let start = self.here();
        let plan_begins = self.is("@")
            || (matches!(self.peek(), Tok::Mark("+" | "-" | "^"))
                && !matches!(self.peek_at(1), Tok::Mark("+" | "-" | "<" | ">")));
        if !plan_begins {
            let body = self.body()?;
            self.expect("}", "after the steps")?;
            return Ok(TermKind::Body(body));
        }
        let Plan { label, annotations, trigger, context, mut body } = self.plan()?;
        if self.take("}") {
            let alone = label.is_none() && annotations.is_empty() && context.is_none() && body.is_empty();
            return Ok(if alone { TermKind::Trigger(Box::new(trigger)) } else { TermKind::Plan });
        }
        let kind = match trigger.kind {
            TriggerKind::Added => StepKind::Add(trigger.of, crate::agentspeak::ast::Adding::Plain),
            TriggerKind::Removed => StepKind::Remove(trigger.of),
            TriggerKind::Achieve
            | TriggerKind::Failed
            | TriggerKind::Test
            | TriggerKind::TestFailed
            | TriggerKind::State => return Err(self.expected("`}`, `:` or `<-` after the trigger")),
        };
        body.push(Step { kind, span: self.since(start) });
        self.expect(";", "after the step")?;
        body.extend(self.body()?);
        self.expect("}", "after the steps")?;
        Ok(TermKind::Body(body))
    }
}

fn binary(op: Op, left: Term, right: Term) -> Term {
    let span = left.span.to(right.span);
    Term { kind: TermKind::Binary { op, left: Box::new(left), right: Box::new(right) }, span }
}
