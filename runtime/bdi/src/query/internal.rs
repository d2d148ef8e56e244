//! Internal actions that ask: their answers, in the search of a formula.

use hrdsl_ir::{
    List, Value,
    bdi::{AgentTerm, GoalId, InternalAct, PlanContext},
    expr::EvalError,
    list::{apply, order, same},
    value::seconds,
};

use super::{AnswerSource, BeliefQueryError, FormulaPosition, QuerySolver, SolverContinuation};
use crate::{
    dice::AgentRng,
    mind::{GoalAttitude, MentalState},
    unify::{VariableSlot, eval, undo, unify_all},
};

/// What all answers together become, and what that is matched with.
#[derive(Clone, Copy, Debug)]
pub(super) enum AnswerCollection<'p> {
    List {
        out: &'p AgentTerm,
    },
    /// Sorted, each once.
    Set {
        out: &'p AgentTerm,
    },
    Count {
        out: &'p AgentTerm,
    },
}

impl<'p> QuerySolver<'p> {
    pub(super) fn internal(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        internal: &'p InternalAct,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let base = at.base as usize;
        let value = |e, slots: &[VariableSlot]| eval(e, &slots[base..]);
        let (out, result) = match internal {
            InternalAct::FindAll { template, formula, set, out } => {
                let into = if *set { AnswerCollection::Set { out } } else { AnswerCollection::List { out } };
                return Ok(Some(self.collect(into, formula, Some(template), at)));
            }
            InternalAct::Count { formula, out } => {
                return Ok(Some(self.collect(AnswerCollection::Count { out }, formula, None, at)));
            }
            InternalAct::Member { element, list } => {
                let list = value(list, &self.slots)?.as_list().ok_or(EvalError::Type)?;
                return self.member(element, list, at);
            }
            InternalAct::Apply { function, args, out } => {
                let args: Vec<Value> =
                    args.iter().map(|a| value(a, &self.slots)).collect::<Result<_, _>>()?;
                (out, apply(*function, &args)?)
            }
            InternalAct::Holds { function, args } => {
                let args: Vec<Value> =
                    args.iter().map(|a| value(a, &self.slots)).collect::<Result<_, _>>()?;
                let holds = apply(*function, &args)? == Some(Value::Bool(true));
                return Ok(holds.then_some(at.next));
            }
            InternalAct::Intend { goal, args } => {
                return self.held(mind, GoalAttitude::Intended, *goal, args, at);
            }
            InternalAct::Desire { goal, args } => {
                return self.held(mind, GoalAttitude::Desired, *goal, args, at);
            }
            InternalAct::Suspended { goal, args } => {
                return self.held(mind, GoalAttitude::Suspended, *goal, args, at);
            }
            InternalAct::Random { from: None, out } => (out, Some(Value::Float(dice.fraction()))),
            InternalAct::Random { from: Some(list), out } => {
                let list = value(list, &self.slots)?.as_list().ok_or(EvalError::Type)?;
                (out, (!list.is_empty()).then(|| list.iter().nth(dice.below(list.len()))).flatten())
            }
            InternalAct::Shuffle { list, out } => {
                let list = value(list, &self.slots)?.as_list().ok_or(EvalError::Type)?;
                let mut all: Vec<Value> = list.iter().collect();
                dice.shuffle(&mut all);
                (out, Some(Value::List(List::of(&all))))
            }
            InternalAct::Time { out } => (out, Some(Value::Float(seconds(mind.now)))),
            InternalAct::MyName { out } => (out, Some(Value::Symbol(mind.me.name))),
            InternalAct::AllNames { out } => (out, Some(Value::List(mind.me.peers.list))),
        };
        let Some(result) = result else { return Ok(None) };
        Ok(self.matches(out, result, at)?.then_some(at.next))
    }

    fn held(
        &mut self,
        mind: &MentalState<'p>,
        attitude: GoalAttitude,
        goal: GoalId,
        args: &'p [AgentTerm],
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let from = self.had.len() as u32;
        mind.each_had(attitude, goal, &mut |had| self.had.extend_from_slice(had));
        let arity = args.len() as u32;
        if arity == 0 {
            return Ok(mind.has_any(attitude, goal).then_some(at.next));
        }
        let to = self.had.len() as u32;
        self.goals(args, from, to, at)
    }

    pub(super) fn goals(
        &mut self,
        args: &'p [AgentTerm],
        mut from: u32,
        to: u32,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        while from < to {
            let end = from + args.len() as u32;
            let mark = self.trail.len();
            let had = self.had[from as usize..end as usize].to_vec();
            let base = at.base as usize;
            if unify_all(args, had.into_iter(), base, &mut self.slots, &mut self.trail)? {
                self.choose(AnswerSource::Goals { args, from: end, to }, at);
                if let Some(choice) = self.choices.last_mut() {
                    choice.trail = mark as u32;
                }
                return Ok(Some(at.next));
            }
            from = end;
        }
        Ok(None)
    }

    fn collect(
        &mut self,
        into: AnswerCollection<'p>,
        formula: &'p PlanContext,
        template: Option<&'p hrdsl_ir::Expr>,
        at: FormulaPosition,
    ) -> u32 {
        self.choose(AnswerSource::Collection { start: self.collected.len(), into }, at);
        let end = self.push(SolverContinuation::Collected(template), at);
        self.push(
            SolverContinuation::Goals(std::slice::from_ref(formula)),
            FormulaPosition { next: end, ..at },
        )
    }

    pub(super) fn member(
        &mut self,
        element: &'p AgentTerm,
        mut list: List,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        while let Some((head, rest)) = list.split() {
            let mark = self.trail.len();
            if self.matches(element, head, at)? {
                if !rest.is_empty() {
                    self.choose(AnswerSource::Member { element, rest }, at);
                    if let Some(choice) = self.choices.last_mut() {
                        choice.trail = mark as u32;
                    }
                }
                return Ok(Some(at.next));
            }
            undo(&mut self.slots, &mut self.trail, mark);
            list = rest;
        }
        Ok(None)
    }

    pub(super) fn gathered(
        &mut self,
        start: usize,
        into: AnswerCollection<'p>,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let mut all: Vec<Value> = self.collected.drain(start..).collect();
        let (out, value) = match into {
            AnswerCollection::List { out } => (out, Value::List(List::of(&all))),
            AnswerCollection::Set { out } => {
                all.sort_by(|a, b| order(*a, *b));
                all.dedup_by(|a, b| same(*a, *b));
                (out, Value::List(List::of(&all)))
            }
            AnswerCollection::Count { out } => (out, Value::Int(all.len() as i64)),
        };
        Ok(self.matches(out, value, at)?.then_some(at.next))
    }
}
