//! Terms and formulas, from the loosest operator to the tightest.

use super::{AgentSpeakParseResult, AgentSpeakParser};
use crate::agentspeak::{
    ast::{
        AgentSpeakLiteral, AgentSpeakOperator, AgentSpeakPlan, AgentSpeakStep, AgentSpeakStepKind,
        AgentSpeakTerm, AgentSpeakTriggerKind, TermKind,
    },
    lex::AgentSpeakTokenKind,
};

impl AgentSpeakParser {
    /// A formula, or any term.
    pub(super) fn formula(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        self.deeper(|p| {
            let left = p.conjunction()?;
            if p.take("|") {
                let right = p.formula()?;
                return Ok(binary(AgentSpeakOperator::Or, left, right));
            }
            Ok(left)
        })
    }

    fn conjunction(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        self.deeper(|p| {
            let left = p.negation()?;
            if p.take("&") {
                let right = p.conjunction()?;
                return Ok(binary(AgentSpeakOperator::And, left, right));
            }
            Ok(left)
        })
    }

    fn negation(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let start = self.here();
        if !self.is_word("not") {
            return self.relation();
        }
        self.advance();
        let of = self.deeper(Self::negation)?;
        Ok(AgentSpeakTerm { kind: TermKind::Not(Box::new(of)), span: self.since(start) })
    }

    fn relation(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let left = self.sum()?;
        let op = match self.peek() {
            AgentSpeakTokenKind::Mark("<") => AgentSpeakOperator::Less,
            AgentSpeakTokenKind::Mark("<=") => AgentSpeakOperator::LessEqual,
            AgentSpeakTokenKind::Mark(">") => AgentSpeakOperator::Greater,
            AgentSpeakTokenKind::Mark(">=") => AgentSpeakOperator::GreaterEqual,
            AgentSpeakTokenKind::Mark("==") => AgentSpeakOperator::Equal,
            AgentSpeakTokenKind::Mark("\\==") => AgentSpeakOperator::Different,
            AgentSpeakTokenKind::Mark("=") => AgentSpeakOperator::Unify,
            AgentSpeakTokenKind::Mark("\\=") => AgentSpeakOperator::NotUnify,
            AgentSpeakTokenKind::Mark("=..") => AgentSpeakOperator::Univ,
            _ => return Ok(left),
        };
        self.advance();
        let right = self.sum()?;
        Ok(binary(op, left, right))
    }

    /// What may stand in a list: no formula, because `|` is the list's.
    fn sum(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let mut left = self.product()?;
        loop {
            let op = match self.peek() {
                AgentSpeakTokenKind::Mark("+") => AgentSpeakOperator::Add,
                AgentSpeakTokenKind::Mark("-") => AgentSpeakOperator::Sub,
                _ => return Ok(left),
            };
            self.advance();
            left = binary(op, left, self.product()?);
        }
    }

    fn product(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let mut left = self.power()?;
        loop {
            let op = match self.peek() {
                AgentSpeakTokenKind::Mark("*") => AgentSpeakOperator::Mul,
                AgentSpeakTokenKind::Mark("/") => AgentSpeakOperator::Div,
                AgentSpeakTokenKind::Word("div") => AgentSpeakOperator::IntDiv,
                AgentSpeakTokenKind::Word("mod") => AgentSpeakOperator::Mod,
                _ => return Ok(left),
            };
            self.advance();
            left = binary(op, left, self.power()?);
        }
    }

    fn power(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let left = self.simple()?;
        if self.take("**") {
            let right = self.deeper(Self::power)?;
            return Ok(binary(AgentSpeakOperator::Pow, left, right));
        }
        Ok(left)
    }

    fn simple(&mut self) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let start = self.here();
        let kind = match self.peek().clone() {
            AgentSpeakTokenKind::Int(n) => {
                self.advance();
                TermKind::Int(n)
            }
            AgentSpeakTokenKind::Float(x) => {
                self.advance();
                TermKind::Float(x)
            }
            AgentSpeakTokenKind::Text(t) => {
                self.advance();
                TermKind::Text(t)
            }
            AgentSpeakTokenKind::Word(w @ ("true" | "false")) => {
                self.advance();
                TermKind::Bool(w == "true")
            }
            AgentSpeakTokenKind::Any | AgentSpeakTokenKind::Var(_) => return self.literal_or_var(""),
            AgentSpeakTokenKind::Mark("+") => {
                self.advance();
                return self.deeper(Self::simple);
            }
            AgentSpeakTokenKind::Mark("-") => {
                self.advance();
                match self.deeper(Self::simple)? {
                    AgentSpeakTerm { kind: TermKind::Int(n), .. } => TermKind::Int(-n),
                    AgentSpeakTerm { kind: TermKind::Float(x), .. } => TermKind::Float(-x),
                    other => TermKind::Neg(Box::new(other)),
                }
            }
            AgentSpeakTokenKind::Mark("(") => {
                self.advance();
                let inner = self.formula()?;
                self.expect(")", "to close the parenthesis")?;
                return Ok(inner);
            }
            AgentSpeakTokenKind::Mark("[") => self.deeper(Self::list)?,
            AgentSpeakTokenKind::Mark("{") => self.deeper(Self::braces)?,
            _ => return self.deeper(|p| p.literal_or_var("here")),
        };
        Ok(AgentSpeakTerm { kind, span: self.since(start) })
    }

    pub(super) fn literal_or_var(&mut self, place: &str) -> AgentSpeakParseResult<AgentSpeakTerm> {
        let start = self.here();
        let kind = match self.peek().clone() {
            AgentSpeakTokenKind::Any => {
                self.advance();
                TermKind::Any
            }
            AgentSpeakTokenKind::Var(name) => {
                self.advance();
                let annotations = if self.is("[") { self.annotations()? } else { Vec::new() };
                TermKind::Var { name, annotations }
            }
            _ => TermKind::Literal(self.literal(format!("a term {place}").trim_end())?),
        };
        Ok(AgentSpeakTerm { kind, span: self.since(start) })
    }

    /// `~ns::name(args)[annotations]`
    pub(super) fn literal(&mut self, what: &str) -> AgentSpeakParseResult<AgentSpeakLiteral> {
        let start = self.here();
        let negated = self.take("~");
        let mut functor = String::new();
        if self.take("::") {
            functor.push_str("default::");
        }
        loop {
            let AgentSpeakTokenKind::Atom(name) = self.peek().clone() else {
                return Err(self.expected(what));
            };
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
        Ok(AgentSpeakLiteral { negated, functor, args, annotations, span: self.since(start) })
    }

    pub(super) fn annotations(&mut self) -> AgentSpeakParseResult<Vec<AgentSpeakTerm>> {
        let start = self.here();
        let TermKind::List { mut items, rest } = self.deeper(Self::list)? else { return Ok(Vec::new()) };
        // What is left of the annotations: nothing that a scenario could speak of.
        if let Some(rest) = rest {
            let (items_of_rest, tail) = (vec![*rest], None);
            items.push(AgentSpeakTerm {
                kind: TermKind::List { items: items_of_rest, rest: tail },
                span: self.since(start),
            });
        }
        Ok(items)
    }

    fn list(&mut self) -> AgentSpeakParseResult<TermKind> {
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
    fn braces(&mut self) -> AgentSpeakParseResult<TermKind> {
        self.advance();
        let start = self.here();
        let plan_begins = self.is("@")
            || (matches!(self.peek(), AgentSpeakTokenKind::Mark("+" | "-" | "^"))
                && !matches!(self.peek_at(1), AgentSpeakTokenKind::Mark("+" | "-" | "<" | ">")));
        if !plan_begins {
            let body = self.body()?;
            self.expect("}", "after the steps")?;
            return Ok(TermKind::Body(body));
        }
        let AgentSpeakPlan { label, annotations, trigger, context, mut body } = self.plan()?;
        if self.take("}") {
            let alone = label.is_none() && annotations.is_empty() && context.is_none() && body.is_empty();
            return Ok(if alone { TermKind::Trigger(Box::new(trigger)) } else { TermKind::Plan });
        }
        let kind = match trigger.kind {
            AgentSpeakTriggerKind::Added => {
                AgentSpeakStepKind::Add(trigger.of, crate::agentspeak::ast::BeliefAddition::Plain)
            }
            AgentSpeakTriggerKind::Removed => AgentSpeakStepKind::Remove(trigger.of),
            AgentSpeakTriggerKind::Achieve
            | AgentSpeakTriggerKind::Failed
            | AgentSpeakTriggerKind::Test
            | AgentSpeakTriggerKind::TestFailed
            | AgentSpeakTriggerKind::State => return Err(self.expected("`}`, `:` or `<-` after the trigger")),
        };
        body.push(AgentSpeakStep { kind, span: self.since(start) });
        self.expect(";", "after the step")?;
        body.extend(self.body()?);
        self.expect("}", "after the steps")?;
        Ok(TermKind::Body(body))
    }
}

fn binary(op: AgentSpeakOperator, left: AgentSpeakTerm, right: AgentSpeakTerm) -> AgentSpeakTerm {
    let span = left.span.to(right.span);
    AgentSpeakTerm { kind: TermKind::Binary { op, left: Box::new(left), right: Box::new(right) }, span }
}
