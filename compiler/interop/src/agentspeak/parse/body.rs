//! Bodies of plans.

use super::{Parsed, Parser};
use crate::agentspeak::{
    ast::{Adding, Step, StepKind, TermKind},
    lex::Tok,
};

impl Parser {
    /// Steps up to the full stop or the brace after them.
    pub(super) fn body(&mut self) -> Parsed<Vec<Step>> {
        self.deeper(|p| {
            let mut steps = Vec::new();
            while !p.is(".") && !p.is("}") && *p.peek() != Tok::End {
                let step = p.branches()?;
                let is_block = !matches!(
                    step.kind,
                    StepKind::Achieve(_)
                        | StepKind::Spawn(_)
                        | StepKind::Query(_)
                        | StepKind::Add(..)
                        | StepKind::Remove(_)
                        | StepKind::Replace(_)
                        | StepKind::Action(_)
                        | StepKind::Formula(_)
                );
                steps.push(step);
                if !p.take(";") && !is_block && !p.is(".") && !p.is("}") {
                    return Err(p.expected("`;` or the end of the body after the step"));
                }
            }
            Ok(steps)
        })
    }

    /// `a |&| b`, `a ||| b`: groups to the right.
    fn branches(&mut self) -> Parsed<Step> {
        let start = self.here();
        let first = self.factor()?;
        let all = self.is("|&|");
        if !all && !self.is("|||") {
            return Ok(first);
        }
        self.advance();
        let rest = self.deeper(Self::branches)?;
        let mut branches = vec![opened(first)];
        match rest {
            Step { kind: StepKind::Fork { branches: more, all: same }, .. } if same == all => {
                branches.extend(more)
            }
            other => branches.push(opened(other)),
        }
        Ok(Step { kind: StepKind::Fork { branches, all }, span: self.since(start) })
    }

    fn factor(&mut self) -> Parsed<Step> {
        let start = self.here();
        let kind = match self.peek() {
            Tok::Word("if") => self.condition()?,
            Tok::Word(word @ ("while" | "for")) => {
                let loops = *word == "while";
                self.advance();
                self.expect("(", "before the condition")?;
                let condition = self.formula()?;
                self.expect(")", "after the condition")?;
                let body = self.block()?;
                if loops { StepKind::While { condition, body } } else { StepKind::For { condition, body } }
            }
            Tok::Mark("{") => StepKind::Block(self.block()?),
            _ => self.plain()?,
        };
        Ok(Step { kind, span: self.since(start) })
    }

    /// From `if` or `elif` on.
    fn condition(&mut self) -> Parsed<StepKind> {
        self.advance();
        self.expect("(", "before the condition")?;
        let condition = self.formula()?;
        self.expect(")", "after the condition")?;
        let then = self.block()?;
        let start = self.here();
        let otherwise = if self.is_word("elif") {
            let kind = self.deeper(Self::condition)?;
            vec![Step { kind, span: self.since(start) }]
        } else if self.is_word("else") {
            self.advance();
            if self.is_word("if") {
                let kind = self.deeper(Self::condition)?;
                vec![Step { kind, span: self.since(start) }]
            } else {
                self.block()?
            }
        } else {
            Vec::new()
        };
        Ok(StepKind::If { condition, then, otherwise })
    }

    fn block(&mut self) -> Parsed<Vec<Step>> {
        self.expect("{", "before the steps")?;
        let steps = self.body()?;
        self.expect("}", "after the steps")?;
        Ok(steps)
    }

    fn plain(&mut self) -> Parsed<StepKind> {
        let sign = match self.peek() {
            Tok::Mark(m @ ("!" | "!!" | "?" | "+" | "-")) => *m,
            _ => return self.bare(),
        };
        self.advance();
        if sign == "?" {
            return Ok(StepKind::Query(self.formula()?));
        }
        let second = match self.peek() {
            Tok::Mark(m @ ("+" | "<" | ">")) if sign == "+" => Some(*m),
            Tok::Mark(m @ ("+" | "-")) if sign == "-" => Some(*m),
            _ => None,
        };
        if second.is_some() {
            self.advance();
        }
        let of = self.literal_or_var(&format!("after `{sign}`"))?;
        Ok(match (sign, second) {
            ("!", _) => StepKind::Achieve(of),
            ("!!", _) => StepKind::Spawn(of),
            ("+", Some("+")) => StepKind::Add(of, Adding::NewFocus),
            ("+", Some("<")) => StepKind::Add(of, Adding::First),
            ("+", Some(_)) => StepKind::Add(of, Adding::Last),
            ("+", None) => StepKind::Add(of, Adding::Plain),
            (_, Some("+")) => StepKind::Replace(of),
            _ => StepKind::Remove(of),
        })
    }

    fn bare(&mut self) -> Parsed<StepKind> {
        let term = self.formula()?;
        Ok(match term.kind {
            TermKind::Literal(literal) => StepKind::Action(literal),
            _ => StepKind::Formula(term),
        })
    }
}

/// The steps of a branch.
fn opened(step: Step) -> Vec<Step> {
    match step.kind {
        StepKind::Block(steps) => steps,
        _ => vec![step],
    }
}
