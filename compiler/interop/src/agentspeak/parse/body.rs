//! Bodies of plans.

use super::{AgentSpeakFault, AgentSpeakParseResult, AgentSpeakParser};
use crate::agentspeak::{
    ast::{AgentSpeakStep, AgentSpeakStepKind, BeliefAddition, TermKind},
    lex::AgentSpeakTokenKind,
};

impl AgentSpeakParser {
    /// Steps up to the full stop or the brace after them.
    pub(super) fn body(&mut self) -> AgentSpeakParseResult<Vec<AgentSpeakStep>> {
        self.deeper(|p| {
            let mut steps = Vec::new();
            while !p.is(".") && !p.is("}") && *p.peek() != AgentSpeakTokenKind::End {
                let step = p.branches()?;
                let is_block = step.blocks().is_some();
                steps.push(step);
                if !p.take(";") && !is_block && !p.is(".") && !p.is("}") {
                    return Err(p.expected("`;` or the end of the body after the step"));
                }
            }
            Ok(steps)
        })
    }

    /// `a |&| b`, `a ||| b`: groups to the right.
    fn branches(&mut self) -> AgentSpeakParseResult<AgentSpeakStep> {
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
            AgentSpeakStep { kind: AgentSpeakStepKind::Fork { branches: more, all: same }, .. }
                if same == all =>
            {
                branches.extend(more)
            }
            other => branches.push(opened(other)),
        }
        Ok(AgentSpeakStep { kind: AgentSpeakStepKind::Fork { branches, all }, span: self.since(start) })
    }

    fn factor(&mut self) -> AgentSpeakParseResult<AgentSpeakStep> {
        let start = self.here();
        let kind = match self.peek() {
            AgentSpeakTokenKind::Word("if") => self.condition()?,
            AgentSpeakTokenKind::Word(word @ ("while" | "for")) => {
                let loops = *word == "while";
                self.advance();
                self.expect("(", "before the condition")?;
                let condition = self.formula()?;
                self.expect(")", "after the condition")?;
                let body = self.block()?;
                if loops {
                    AgentSpeakStepKind::While { condition, body }
                } else {
                    AgentSpeakStepKind::For { condition, body }
                }
            }
            AgentSpeakTokenKind::Mark("{") => AgentSpeakStepKind::Block(self.block()?),
            AgentSpeakTokenKind::Mark("(") => self.parenthesis()?,
            _ => self.plain()?,
        };
        Ok(AgentSpeakStep { kind, span: self.since(start) })
    }

    /// `(a; b)`, or a formula that begins with a parenthesis.
    fn parenthesis(&mut self) -> AgentSpeakParseResult<AgentSpeakStepKind> {
        let start = self.at;
        let fault = match self.bare() {
            Ok(kind) => return Ok(kind),
            Err(fault) => fault,
        };
        self.at = start;
        // What was understood farther is more likely meant.
        let farther =
            |other: AgentSpeakFault| if other.span.start > fault.span.start { other } else { fault };
        self.group().map(AgentSpeakStepKind::Block).map_err(farther)
    }

    fn group(&mut self) -> AgentSpeakParseResult<Vec<AgentSpeakStep>> {
        self.advance();
        let mut steps = vec![self.deeper(Self::branches)?];
        while self.take(";") {
            steps.push(self.deeper(Self::branches)?);
        }
        self.expect(")", "after the steps")?;
        Ok(steps)
    }

    /// From `if` or `elif` on.
    fn condition(&mut self) -> AgentSpeakParseResult<AgentSpeakStepKind> {
        self.advance();
        self.expect("(", "before the condition")?;
        let condition = self.formula()?;
        self.expect(")", "after the condition")?;
        let then = self.block()?;
        let start = self.here();
        let otherwise = if self.is_word("elif") {
            let kind = self.deeper(Self::condition)?;
            vec![AgentSpeakStep { kind, span: self.since(start) }]
        } else if self.is_word("else") {
            self.advance();
            if self.is_word("if") {
                let kind = self.deeper(Self::condition)?;
                vec![AgentSpeakStep { kind, span: self.since(start) }]
            } else {
                self.block()?
            }
        } else {
            Vec::new()
        };
        Ok(AgentSpeakStepKind::If { condition, then, otherwise })
    }

    fn block(&mut self) -> AgentSpeakParseResult<Vec<AgentSpeakStep>> {
        self.expect("{", "before the steps")?;
        let steps = self.body()?;
        self.expect("}", "after the steps")?;
        Ok(steps)
    }

    fn plain(&mut self) -> AgentSpeakParseResult<AgentSpeakStepKind> {
        let sign = match self.peek() {
            AgentSpeakTokenKind::Mark(m @ ("!" | "!!" | "?" | "+" | "-")) => *m,
            _ => return self.bare(),
        };
        self.advance();
        if sign == "?" {
            return Ok(AgentSpeakStepKind::Query(self.formula()?));
        }
        let second = match self.peek() {
            AgentSpeakTokenKind::Mark(m @ ("+" | "<" | ">")) if sign == "+" => Some(*m),
            AgentSpeakTokenKind::Mark(m @ ("+" | "-")) if sign == "-" => Some(*m),
            _ => None,
        };
        if second.is_some() {
            self.advance();
        }
        let of = self.literal_or_var(&format!("after `{sign}`"))?;
        Ok(match (sign, second) {
            ("!", _) => AgentSpeakStepKind::Achieve(of),
            ("!!", _) => AgentSpeakStepKind::Spawn(of),
            ("+", Some("+")) => AgentSpeakStepKind::Add(of, BeliefAddition::NewFocus),
            ("+", Some("<")) => AgentSpeakStepKind::Add(of, BeliefAddition::First),
            ("+", Some(_)) => AgentSpeakStepKind::Add(of, BeliefAddition::Last),
            ("+", None) => AgentSpeakStepKind::Add(of, BeliefAddition::Plain),
            (_, Some("+")) => AgentSpeakStepKind::Replace(of),
            _ => AgentSpeakStepKind::Remove(of),
        })
    }

    fn bare(&mut self) -> AgentSpeakParseResult<AgentSpeakStepKind> {
        let term = self.formula()?;
        Ok(match term.kind {
            TermKind::Literal(literal) => AgentSpeakStepKind::Action(literal),
            _ => AgentSpeakStepKind::Formula(term),
        })
    }
}

/// The steps of a branch.
fn opened(step: AgentSpeakStep) -> Vec<AgentSpeakStep> {
    match step.kind {
        AgentSpeakStepKind::Block(steps) => steps,
        _ => vec![step],
    }
}
