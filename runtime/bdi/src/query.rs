//! Queries of the belief base: a depth-first search for the answers of a formula, through facts and rules.
//!
//! The search keeps its own stacks, so that a deep recursion of rules needs no deep recursion here: *continuations*, what
//! is still to be answered, linked from the next one on; *choices*, where another way can be tried; and *slots*, the
//! variables of the formula and of each rule that is called.

mod internal;
mod rules;

use std::fmt;

use hrdsl_ir::{
    List, Value,
    bdi::{AgentTerm, BeliefLiteral, BeliefRule, PlanContext},
    expr::EvalError,
};

use crate::{
    belief::{FactAnnotations, FactCursor, picked},
    dice::AgentRng,
    mind::MentalState,
    unify::{BindingTrail, VariableSlot, eval, known, undo, unify, unify_all, well_bound},
};

/// Rules that may call each other.
pub(crate) const MAX_DEPTH: u32 = 100_000;

/// Steps of one query.
pub(crate) const MAX_STEPS: u64 = 10_000_000;

/// Why a query has no answer, not even "none".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeliefQueryError {
    NoValue(EvalError),
    /// More than 100 000 rules call each other.
    TooDeep,
    /// More than 10 000 000 steps.
    TooLong,
}

impl fmt::Display for BeliefQueryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BeliefQueryError::NoValue(error) => error.fmt(f),
            BeliefQueryError::TooDeep => f.write_str("rules call each other too deeply"),
            BeliefQueryError::TooLong => f.write_str("the query takes too many steps"),
        }
    }
}

impl From<EvalError> for BeliefQueryError {
    fn from(error: EvalError) -> Self {
        BeliefQueryError::NoValue(error)
    }
}

/// No continuation: the answer is complete.
const DONE: u32 = u32::MAX;

/// Where a formula stands: the variables it means, how many rules are being called, and what follows it.
#[derive(Clone, Copy, Debug)]
struct FormulaPosition {
    base: u32,
    depth: u32,
    next: u32,
}

#[derive(Clone, Copy, Debug)]
enum SolverContinuation<'p> {
    /// All of these are to be answered.
    Goals(&'p [PlanContext]),
    /// A rule's body has an answer: the head is matched with what called it, whose variables start at `caller`.
    Return { rule: &'p BeliefRule, literal: &'p BeliefLiteral, caller: u32 },
    /// What is negated has an answer; the choice at this height is the negation's.
    Refuted(u32),
    /// One more answer of `.findall`, `.count`
    Collected(Option<&'p hrdsl_ir::Expr>),
}

#[derive(Clone, Copy, Debug)]
enum AnswerSource<'p> {
    Facts {
        literal: &'p BeliefLiteral,
        cursor: FactCursor,
        row: Option<(usize, usize)>,
    },
    Rules {
        literal: &'p BeliefLiteral,
        from: usize,
    },
    Or(&'p [PlanContext]),
    Member {
        element: &'p AgentTerm,
        rest: List,
    },
    /// The goals that are had, from this one on, with their arguments.
    Goals {
        args: &'p [AgentTerm],
        from: u32,
        to: u32,
    },
    /// What is negated has no answer.
    Negation,
    /// There are no more answers; those from `start` on are collected.
    Collection {
        start: usize,
        into: internal::AnswerCollection<'p>,
    },
}

/// A way to go on, and the heights of the stacks to go back to.
#[derive(Clone, Copy, Debug)]
struct ChoicePoint<'p> {
    source: AnswerSource<'p>,
    at: FormulaPosition,
    trail: u32,
    conts: u32,
    slots: u32,
}

/// The search, and its stacks, kept from one query to the next.
#[derive(Debug, Default)]
pub(crate) struct QuerySolver<'p> {
    /// Before a query: the variables of its formula. After it: the same, with what the answer binds, then those of rules.
    pub slots: Vec<VariableSlot>,
    pub trail: BindingTrail,
    conts: Vec<(SolverContinuation<'p>, FormulaPosition)>,
    choices: Vec<ChoicePoint<'p>>,
    collected: Vec<Value>,
    /// The arguments of goals that are had.
    had: Vec<VariableSlot>,
    steps: u64,
    /// The parts of the formula, if it is a conjunction, and the last of them that was begun.
    parts: &'p [PlanContext],
    pub farthest: usize,
}

impl<'p> QuerySolver<'p> {
    /// Begins with as many open variables.
    #[inline]
    pub fn open(&mut self, variables: usize) {
        self.slots.clear();
        self.slots.resize(variables, None);
        self.trail.clear();
    }

    /// Begins with these variables.
    pub fn with(&mut self, slots: &[VariableSlot]) {
        self.slots.clear();
        self.slots.extend_from_slice(slots);
        self.trail.clear();
    }

    /// The first answer of the formula; what it binds is in `slots`.
    pub fn solve(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        formula: &'p PlanContext,
    ) -> Result<bool, BeliefQueryError> {
        match formula {
            PlanContext::True => return Ok(true),
            PlanContext::Test(expr) => return Ok(truth(eval(expr, &self.slots)?)?),
            PlanContext::And(_)
            | PlanContext::Or(_)
            | PlanContext::Not(_)
            | PlanContext::Belief(_)
            | PlanContext::Unify(..)
            | PlanContext::Internal(_, _) => {}
        }
        self.begin(if let PlanContext::And(parts) = formula { parts } else { &[] });
        let mark = self.trail.len();
        let at = FormulaPosition { base: 0, depth: 0, next: DONE };
        let first = self.push(SolverContinuation::Goals(std::slice::from_ref(formula)), at);
        let found = self.advance(mind, dice, first);
        if found != Ok(true) {
            undo(&mut self.slots, &mut self.trail, mark);
        }
        found
    }

    /// The first answer of a literal.
    pub fn answer(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        literal: &'p BeliefLiteral,
    ) -> Result<bool, BeliefQueryError> {
        self.begin(&[]);
        let mark = self.trail.len();
        let found = match self.literal(mind, literal, FormulaPosition { base: 0, depth: 0, next: DONE })? {
            Some(at) => self.advance(mind, dice, at),
            None => Ok(false),
        };
        if found != Ok(true) {
            undo(&mut self.slots, &mut self.trail, mark);
        }
        found
    }

    fn begin(&mut self, parts: &'p [PlanContext]) {
        self.conts.clear();
        self.choices.clear();
        self.collected.clear();
        self.had.clear();
        (self.steps, self.farthest) = (0, 0);
        self.parts = parts;
    }

    fn literal(
        &mut self,
        mind: &MentalState<'p>,
        literal: &'p BeliefLiteral,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let slots = &self.slots[at.base as usize..];
        well_bound(&literal.args, slots)?;
        let first = literal.args.first().and_then(|t| known(t, slots));
        let rows = mind.beliefs.of(literal.belief);
        let divided = literal.annotations.is_empty() && mind.library.early(literal.belief) > 0;
        let cursor = if divided { rows.later(first) } else { rows.cursor(first) };
        self.facts(mind, literal, cursor, None, at)
    }

    /// Whether there is another answer after the last one.
    pub fn again(&mut self, mind: &MentalState<'p>, dice: &mut AgentRng) -> Result<bool, BeliefQueryError> {
        match self.backtrack(mind)? {
            Some(at) => self.advance(mind, dice, at),
            None => Ok(false),
        }
    }

    fn push(&mut self, cont: SolverContinuation<'p>, at: FormulaPosition) -> u32 {
        self.conts.push((cont, at));
        self.conts.len() as u32 - 1
    }

    fn choose(&mut self, source: AnswerSource<'p>, at: FormulaPosition) {
        let (trail, conts, slots) =
            (self.trail.len() as u32, self.conts.len() as u32, self.slots.len() as u32);
        self.choices.push(ChoicePoint { source, at, trail, conts, slots });
    }

    fn advance(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        mut at: u32,
    ) -> Result<bool, BeliefQueryError> {
        while at != DONE {
            self.steps += 1;
            if self.steps > MAX_STEPS {
                return Err(BeliefQueryError::TooLong);
            }
            let (cont, here) = self.conts[at as usize];
            let next = match self.follow(mind, dice, cont, here)? {
                None => self.backtrack(mind)?,
                some => some,
            };
            match next {
                Some(next) => at = next,
                None => return Ok(false),
            }
        }
        Ok(true)
    }

    /// One continuation; gives the next one, or `None` if there is no answer this way.
    fn follow(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        cont: SolverContinuation<'p>,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        match cont {
            SolverContinuation::Goals(goals) => {
                if goals.as_ptr_range().end == self.parts.as_ptr_range().end && at.base == 0 {
                    self.farthest = self.farthest.max(self.parts.len() - goals.len());
                }
                let Some((first, rest)) = goals.split_first() else { return Ok(Some(at.next)) };
                let next =
                    if rest.is_empty() { at.next } else { self.push(SolverContinuation::Goals(rest), at) };
                self.goal(mind, dice, first, FormulaPosition { next, ..at })
            }
            SolverContinuation::Return { rule, literal, caller } => self.give_back(rule, literal, caller, at),
            SolverContinuation::Refuted(height) => {
                let negation = self.choices[height as usize];
                self.choices.truncate(height as usize);
                undo(&mut self.slots, &mut self.trail, negation.trail as usize);
                Ok(None)
            }
            SolverContinuation::Collected(template) => {
                let value = match template {
                    Some(template) => eval(template, &self.slots[at.base as usize..])?,
                    None => Value::Bool(true),
                };
                self.collected.push(value);
                Ok(None)
            }
        }
    }

    fn goal(
        &mut self,
        mind: &MentalState<'p>,
        dice: &mut AgentRng,
        goal: &'p PlanContext,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let yes = |holds: bool| Ok(holds.then_some(at.next));
        match goal {
            PlanContext::True => yes(true),
            PlanContext::Test(expr) => yes(truth(eval(expr, &self.slots[at.base as usize..])?)?),
            PlanContext::Unify(term, expr) => {
                let value = eval(expr, &self.slots[at.base as usize..])?;
                yes(self.matches(term, value, at)?)
            }
            PlanContext::And(all) => Ok(Some(self.push(SolverContinuation::Goals(all), at))),
            PlanContext::Or(any) => Ok(self.either(any, at)),
            PlanContext::Not(inner) => {
                let height = self.choices.len() as u32;
                self.choose(AnswerSource::Negation, at);
                let end = self.push(SolverContinuation::Refuted(height), at);
                Ok(Some(self.push(
                    SolverContinuation::Goals(std::slice::from_ref(inner)),
                    FormulaPosition { next: end, ..at },
                )))
            }
            PlanContext::Belief(literal) => self.literal(mind, literal, at),
            PlanContext::Internal(internal, _) => self.internal(mind, dice, internal, at),
        }
    }

    fn matches(&mut self, term: &AgentTerm, value: Value, at: FormulaPosition) -> Result<bool, EvalError> {
        unify(term, value, at.base as usize, &mut self.slots, &mut self.trail)
    }

    fn either(&mut self, any: &'p [PlanContext], at: FormulaPosition) -> Option<u32> {
        let (first, rest) = any.split_first()?;
        if !rest.is_empty() {
            self.choose(AnswerSource::Or(rest), at);
        }
        Some(self.push(SolverContinuation::Goals(std::slice::from_ref(first)), at))
    }

    /// The next fact that matches, from the cursor on; after the last the rules. `row` is a fact whose annotations can be
    /// chosen in another way.
    fn facts(
        &mut self,
        mind: &MentalState<'p>,
        literal: &'p BeliefLiteral,
        mut cursor: FactCursor,
        mut row: Option<(usize, usize)>,
        at: FormulaPosition,
    ) -> Result<Option<u32>, BeliefQueryError> {
        let rows = mind.beliefs.of(literal.belief);
        loop {
            let (index, mut choice_no) = match row.take() {
                Some(row) => row,
                None => match rows.next(&mut cursor) {
                    Some(index) => (index, 0),
                    None => {
                        let after = if cursor.is_initial() { mind.library.early(literal.belief) } else { 0 };
                        return self.rules(mind, literal, after, at);
                    }
                },
            };
            let annotations = rows.annotations(index);
            let choices = annotations.len().saturating_pow(literal.annotations.len() as u32);
            while choice_no < choices {
                let mark = self.trail.len();
                let args = rows.row(index).iter().map(|v| Some(*v));
                let base = at.base as usize;
                let found = unify_all(&literal.args, args, base, &mut self.slots, &mut self.trail)?
                    && self.annotated(literal, annotations, choice_no, at)?;
                choice_no += 1;
                if found {
                    let row = (choice_no < choices).then_some((index, choice_no));
                    let source = AnswerSource::Facts { literal, cursor, row };
                    self.choose(source, at);
                    if let Some(choice) = self.choices.last_mut() {
                        choice.trail = mark as u32;
                    }
                    return Ok(Some(at.next));
                }
                undo(&mut self.slots, &mut self.trail, mark);
            }
        }
    }

    /// Whether each annotation of the literal matches that of the fact which the choice of this number picks: the last changes fastest.
    fn annotated(
        &mut self,
        literal: &BeliefLiteral,
        of: &FactAnnotations,
        choice_no: usize,
        at: FormulaPosition,
    ) -> Result<bool, EvalError> {
        let picked = picked(choice_no, of.len(), literal.annotations.len());
        for ((what, term), place) in literal.annotations.iter().zip(picked) {
            let (held, value) = of[place];
            if held != *what || !self.matches(term, value, at)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The latest choice that leads on.
    fn backtrack(&mut self, mind: &MentalState<'p>) -> Result<Option<u32>, BeliefQueryError> {
        while let Some(ChoicePoint { source, at, trail, conts, slots }) = self.choices.pop() {
            undo(&mut self.slots, &mut self.trail, trail as usize);
            self.slots.resize(slots as usize, None);
            self.conts.truncate(conts as usize);
            let next = match source {
                AnswerSource::Facts { literal, cursor, row } => self.facts(mind, literal, cursor, row, at)?,
                AnswerSource::Rules { literal, from } => self.rules(mind, literal, from, at)?,
                AnswerSource::Or(any) => self.either(any, at),
                AnswerSource::Member { element, rest } => self.member(element, rest, at)?,
                AnswerSource::Goals { args, from, to } => self.goals(args, from, to, at)?,
                AnswerSource::Negation => Some(at.next),
                AnswerSource::Collection { start, into } => self.gathered(start, into, at)?,
            };
            if next.is_some() {
                return Ok(next);
            }
        }
        Ok(None)
    }
}

fn truth(value: Value) -> Result<bool, EvalError> {
    value.as_bool().ok_or(EvalError::Type)
}
