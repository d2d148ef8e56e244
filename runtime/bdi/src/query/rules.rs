//! Rules in the search: which are tried, what they are given, and what they give back.

use hrdsl_ir::{
    bdi::{AgentTerm, BeliefLiteral, BeliefRule},
    expr::EvalError,
};

use super::{AnswerSource, BeliefQueryError, FormulaPosition, MAX_DEPTH, QuerySolver, SolverContinuation};
use crate::{
    mind::MentalState,
    unify::{eval, known, undo, unify},
};

impl<'p> QuerySolver<'p> {
    /// The next rule whose head matches. Those that stand before the facts of the text are followed by these.
    pub(super) fn rules(
        &mut self,
        mind: &MentalState<'p>,
        literal: &'p BeliefLiteral,
        from: usize,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let rules = mind.library.rules(literal.belief);
        // What is derived has no annotations.
        if !literal.annotations.is_empty() || from >= rules.len() {
            return Ok(None);
        }
        if at.depth >= MAX_DEPTH {
            return Err(BeliefQueryError::TooDeep);
        }
        let early = mind.library.early(literal.belief);
        let is_early = from < early;
        let end = if is_early { early } else { rules.len() };
        let initial = |solver: &Self| {
            let slots = &solver.slots[at.base as usize..];
            let first = literal.args.first().and_then(|t| known(t, slots));
            mind.beliefs.of(literal.belief).initial(first)
        };
        for (index, rule) in rules[..end].iter().copied().enumerate().skip(from) {
            let (mark, base) = (self.trail.len(), self.slots.len());
            self.choose(
                if is_early && index + 1 == end {
                    AnswerSource::Facts { literal, cursor: initial(self), row: None }
                } else {
                    AnswerSource::Rules { literal, from: index + 1 }
                },
                at,
            );
            self.slots.resize(base + rule.vars.len(), None);
            if self.call(rule, literal, at.base as usize, base)? {
                if !is_early && index + 1 == end {
                    self.choices.pop();
                }
                let back = SolverContinuation::Return { rule, literal, caller: at.base };
                let inner = FormulaPosition { base: base as u32, depth: at.depth + 1, next: at.next };
                let back = self.push(back, inner);
                let body = std::slice::from_ref(&rule.body);
                return Ok(Some(
                    self.push(SolverContinuation::Goals(body), FormulaPosition { next: back, ..inner }),
                ));
            }
            self.choices.pop();
            undo(&mut self.slots, &mut self.trail, mark);
            self.slots.truncate(base);
        }
        if is_early {
            let cursor = initial(self);
            return self.facts(mind, literal, cursor, None, at);
        }
        Ok(None)
    }

    /// Gives a rule what its caller knows; an argument that the head computes is compared when the rule has an answer.
    fn call(
        &mut self,
        rule: &BeliefRule,
        literal: &BeliefLiteral,
        caller: usize,
        base: usize,
    ) -> Result<bool, BeliefQueryError> {
        for (head, arg) in rule.args.iter().zip(&literal.args) {
            if let AgentTerm::Expr(expr) = arg {
                eval(expr, &self.slots[caller..base])?;
            }
            let Some(value) = known(arg, &self.slots[caller..base]) else { continue };
            if matches!(head, AgentTerm::Expr(_)) && known(head, &self.slots[base..]).is_none() {
                continue;
            }
            if !unify(head, value, base, &mut self.slots, &mut self.trail)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(super) fn give_back(
        &mut self,
        rule: &BeliefRule,
        literal: &BeliefLiteral,
        caller: u32,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        for (head, arg) in rule.args.iter().zip(&literal.args) {
            if matches!((head, arg), (_, AgentTerm::Any)) {
                continue;
            }
            let own = &self.slots[at.base as usize..];
            let value = match head {
                AgentTerm::Expr(expr) => Some(eval(expr, own)?),
                AgentTerm::Any | AgentTerm::Var(_) | AgentTerm::List(..) => known(head, own),
            };
            let Some(value) = value else {
                if known(arg, &self.slots[caller as usize..]).is_some() {
                    continue;
                }
                let variable = if let AgentTerm::Var(v) = head { *v } else { 0 };
                return Err(BeliefQueryError::NoValue(EvalError::Unbound(variable)));
            };
            if !unify(arg, value, caller as usize, &mut self.slots, &mut self.trail)? {
                return Ok(None);
            }
        }
        Ok(Some(at.next))
    }
}
