//! Queries of the belief base: a depth-first search for the answers of a formula, through facts and rules.
//!
//! The search keeps its own stacks, so that a deep recursion of rules needs no deep recursion here: *continuations*, what
//! is still to be answered, linked from the next one on; *choices*, where another way can be tried; and *slots*, the
//! variables of the formula and of each rule that is called.

mod internal;

use std::fmt;

use hrdsl_ir::{
    List, Value,
    bdi::{Context, Internal, Literal, Rule, Term},
    expr::EvalError,
};

use crate::{
    belief::{Annotations, Cursor, picked},
    dice::Dice,
    mind::Mind,
    unify::{Slot, Trail, eval, known, undo, unify, unify_all, well_bound},
};

/// Rules that may call each other.
pub(crate) const MAX_DEPTH: u32 = 100_000;

/// Steps of one query.
pub(crate) const MAX_STEPS: u64 = 10_000_000;

/// Why a query has no answer, not even "none".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    NoValue(EvalError),
    /// More than 100 000 rules call each other.
    TooDeep,
    /// More than 10 000 000 steps.
    TooLong,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NoValue(error) => error.fmt(f),
            Fault::TooDeep => f.write_str("rules call each other too deeply"),
            Fault::TooLong => f.write_str("the query takes too many steps"),
        }
    }
}

impl From<EvalError> for Fault {
    fn from(error: EvalError) -> Self {
        Fault::NoValue(error)
    }
}

/// No continuation: the answer is complete.
const DONE: u32 = u32::MAX;

/// Where a formula stands: the variables it means, how many rules are being called, and what follows it.
#[derive(Clone, Copy, Debug)]
struct At {
    base: u32,
    depth: u32,
    next: u32,
}

#[derive(Clone, Copy, Debug)]
enum Cont<'p> {
    /// All of these are to be answered.
    Goals(&'p [Context]),
    /// A rule's body has an answer: the head is matched with what called it, whose variables start at `caller`.
    Return { rule: &'p Rule, literal: &'p Literal, caller: u32 },
    /// What is negated has an answer; the choice at this height is the negation's.
    Refuted(u32),
    /// One more answer of `.findall`, `.count`
    Collected(Option<&'p hrdsl_ir::Expr>),
}

#[derive(Clone, Copy, Debug)]
enum Way<'p> {
    Facts {
        literal: &'p Literal,
        cursor: Cursor,
        row: Option<(usize, usize)>,
    },
    Rules {
        literal: &'p Literal,
        from: usize,
    },
    Or(&'p [Context]),
    Member {
        element: &'p Term,
        rest: List,
    },
    /// The goals that are had, from this one on, with their arguments.
    Goals {
        args: &'p [Term],
        from: u32,
        to: u32,
    },
    /// What is negated has no answer.
    Negation,
    /// There are no more answers; those from `start` on are collected.
    Collection {
        start: usize,
        what: &'p Internal,
    },
}

/// A way to go on, and the heights of the stacks to go back to.
#[derive(Clone, Copy, Debug)]
struct Choice<'p> {
    way: Way<'p>,
    at: At,
    trail: u32,
    conts: u32,
    slots: u32,
}

/// The search, and its stacks, kept from one query to the next.
#[derive(Debug, Default)]
pub(crate) struct Solver<'p> {
    /// Before a query: the variables of its formula. After it: the same, with what the answer binds, then those of rules.
    pub slots: Vec<Slot>,
    pub trail: Trail,
    conts: Vec<(Cont<'p>, At)>,
    choices: Vec<Choice<'p>>,
    collected: Vec<Value>,
    /// The arguments of goals that are had.
    had: Vec<Slot>,
    steps: u64,
    /// The parts of the formula, if it is a conjunction, and the last of them that was begun.
    parts: &'p [Context],
    pub farthest: usize,
}

impl<'p> Solver<'p> {
    /// Begins with as many open variables.
    #[inline]
    pub fn open(&mut self, variables: usize) {
        self.slots.clear();
        self.slots.resize(variables, None);
        self.trail.clear();
    }

    /// Begins with these variables.
    pub fn with(&mut self, slots: &[Slot]) {
        self.slots.clear();
        self.slots.extend_from_slice(slots);
        self.trail.clear();
    }

    /// The first answer of the formula; what it binds is in `slots`.
    pub fn solve(&mut self, mind: &Mind<'p>, dice: &mut Dice, formula: &'p Context) -> Result<bool, Fault> {
        match formula {
            Context::True => return Ok(true),
            Context::Test(expr) => return Ok(truth(eval(expr, &self.slots)?)?),
            Context::And(_)
            | Context::Or(_)
            | Context::Not(_)
            | Context::Belief(_)
            | Context::Unify(..)
            | Context::Internal(_) => {}
        }
        self.begin(if let Context::And(parts) = formula { parts } else { &[] });
        let mark = self.trail.len();
        let at = At { base: 0, depth: 0, next: DONE };
        let first = self.push(Cont::Goals(std::slice::from_ref(formula)), at);
        let found = self.advance(mind, dice, first);
        if found != Ok(true) {
            undo(&mut self.slots, &mut self.trail, mark);
        }
        found
    }

    /// The first answer of a literal.
    pub fn answer(&mut self, mind: &Mind<'p>, dice: &mut Dice, literal: &'p Literal) -> Result<bool, Fault> {
        self.begin(&[]);
        let mark = self.trail.len();
        let found = match self.literal(mind, literal, At { base: 0, depth: 0, next: DONE })? {
            Some(at) => self.advance(mind, dice, at),
            None => Ok(false),
        };
        if found != Ok(true) {
            undo(&mut self.slots, &mut self.trail, mark);
        }
        found
    }

    fn begin(&mut self, parts: &'p [Context]) {
        self.conts.clear();
        self.choices.clear();
        self.collected.clear();
        self.had.clear();
        (self.steps, self.farthest) = (0, 0);
        self.parts = parts;
    }

    fn literal(&mut self, mind: &Mind<'p>, literal: &'p Literal, at: At) -> Result<Option<u32>, Fault> {
        let slots = &self.slots[at.base as usize..];
        well_bound(&literal.args, slots)?;
        let first = literal.args.first().and_then(|t| known(t, slots));
        let cursor = mind.beliefs.of(literal.belief).cursor(first);
        self.facts(mind, literal, cursor, None, at)
    }

    /// Whether there is another answer after the last one.
    pub fn again(&mut self, mind: &Mind<'p>, dice: &mut Dice) -> Result<bool, Fault> {
        match self.backtrack(mind)? {
            Some(at) => self.advance(mind, dice, at),
            None => Ok(false),
        }
    }

    fn push(&mut self, cont: Cont<'p>, at: At) -> u32 {
        self.conts.push((cont, at));
        self.conts.len() as u32 - 1
    }

    fn choose(&mut self, way: Way<'p>, at: At) {
        let (trail, conts, slots) =
            (self.trail.len() as u32, self.conts.len() as u32, self.slots.len() as u32);
        self.choices.push(Choice { way, at, trail, conts, slots });
    }

    fn advance(&mut self, mind: &Mind<'p>, dice: &mut Dice, mut at: u32) -> Result<bool, Fault> {
        while at != DONE {
            self.steps += 1;
            if self.steps > MAX_STEPS {
                return Err(Fault::TooLong);
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
        mind: &Mind<'p>,
        dice: &mut Dice,
        cont: Cont<'p>,
        at: At,
    ) -> Result<Option<u32>, Fault> {
        match cont {
            Cont::Goals(goals) => {
                if goals.as_ptr_range().end == self.parts.as_ptr_range().end && at.base == 0 {
                    self.farthest = self.farthest.max(self.parts.len() - goals.len());
                }
                let Some((first, rest)) = goals.split_first() else { return Ok(Some(at.next)) };
                let next = if rest.is_empty() { at.next } else { self.push(Cont::Goals(rest), at) };
                self.goal(mind, dice, first, At { next, ..at })
            }
            Cont::Return { rule, literal, caller } => self.give_back(rule, literal, caller, at),
            Cont::Refuted(height) => {
                let negation = self.choices[height as usize];
                self.choices.truncate(height as usize);
                undo(&mut self.slots, &mut self.trail, negation.trail as usize);
                Ok(None)
            }
            Cont::Collected(template) => {
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
        mind: &Mind<'p>,
        dice: &mut Dice,
        goal: &'p Context,
        at: At,
    ) -> Result<Option<u32>, Fault> {
        let yes = |holds: bool| Ok(holds.then_some(at.next));
        match goal {
            Context::True => yes(true),
            Context::Test(expr) => yes(truth(eval(expr, &self.slots[at.base as usize..])?)?),
            Context::Unify(term, expr) => {
                let value = eval(expr, &self.slots[at.base as usize..])?;
                yes(self.matches(term, value, at)?)
            }
            Context::And(all) => Ok(Some(self.push(Cont::Goals(all), at))),
            Context::Or(any) => Ok(self.either(any, at)),
            Context::Not(inner) => {
                let height = self.choices.len() as u32;
                self.choose(Way::Negation, at);
                let end = self.push(Cont::Refuted(height), at);
                Ok(Some(self.push(Cont::Goals(std::slice::from_ref(inner)), At { next: end, ..at })))
            }
            Context::Belief(literal) => self.literal(mind, literal, at),
            Context::Internal(internal) => self.internal(mind, dice, internal, at),
        }
    }

    fn matches(&mut self, term: &Term, value: Value, at: At) -> Result<bool, EvalError> {
        unify(term, value, at.base as usize, &mut self.slots, &mut self.trail)
    }

    fn either(&mut self, any: &'p [Context], at: At) -> Option<u32> {
        let (first, rest) = any.split_first()?;
        if !rest.is_empty() {
            self.choose(Way::Or(rest), at);
        }
        Some(self.push(Cont::Goals(std::slice::from_ref(first)), at))
    }

    /// The next fact that matches, from the cursor on; after the last the rules. `row` is a fact whose annotations can be
    /// chosen in another way.
    fn facts(
        &mut self,
        mind: &Mind<'p>,
        literal: &'p Literal,
        mut cursor: Cursor,
        mut row: Option<(usize, usize)>,
        at: At,
    ) -> Result<Option<u32>, Fault> {
        let rows = mind.beliefs.of(literal.belief);
        loop {
            let (index, mut way) = match row.take() {
                Some(row) => row,
                None => match rows.next(&mut cursor) {
                    Some(index) => (index, 0),
                    None => return self.rules(mind, literal, 0, at),
                },
            };
            let annotations = rows.annotations(index);
            let ways = annotations.len().saturating_pow(literal.annotations.len() as u32);
            while way < ways {
                let mark = self.trail.len();
                let args = rows.row(index).iter().map(|v| Some(*v));
                let base = at.base as usize;
                let found = unify_all(&literal.args, args, base, &mut self.slots, &mut self.trail)?
                    && self.annotated(literal, annotations, way, at)?;
                way += 1;
                if found {
                    let row = (way < ways).then_some((index, way));
                    let way = Way::Facts { literal, cursor, row };
                    self.choose(way, at);
                    if let Some(choice) = self.choices.last_mut() {
                        choice.trail = mark as u32;
                    }
                    return Ok(Some(at.next));
                }
                undo(&mut self.slots, &mut self.trail, mark);
            }
        }
    }

    /// Whether each annotation of the literal matches that of the fact which this way picks: the last changes fastest.
    fn annotated(
        &mut self,
        literal: &Literal,
        of: &Annotations,
        way: usize,
        at: At,
    ) -> Result<bool, EvalError> {
        let picked = picked(way, of.len(), literal.annotations.len());
        for ((what, term), place) in literal.annotations.iter().zip(picked) {
            let (held, value) = of[place];
            if held != *what || !self.matches(term, value, at)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The next rule whose head matches.
    fn rules(
        &mut self,
        mind: &Mind<'p>,
        literal: &'p Literal,
        from: usize,
        at: At,
    ) -> Result<Option<u32>, Fault> {
        let rules = mind.library.rules(literal.belief);
        // What is derived has no annotations.
        if !literal.annotations.is_empty() || from >= rules.len() {
            return Ok(None);
        }
        if at.depth >= MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        for (index, rule) in rules.iter().copied().enumerate().skip(from) {
            let (mark, base) = (self.trail.len(), self.slots.len());
            self.choose(Way::Rules { literal, from: index + 1 }, at);
            self.slots.resize(base + rule.vars.len(), None);
            if self.call(rule, literal, at.base as usize, base)? {
                if index + 1 == rules.len() {
                    self.choices.pop();
                }
                let back = Cont::Return { rule, literal, caller: at.base };
                let inner = At { base: base as u32, depth: at.depth + 1, next: at.next };
                let back = self.push(back, inner);
                let body = std::slice::from_ref(&rule.body);
                return Ok(Some(self.push(Cont::Goals(body), At { next: back, ..inner })));
            }
            self.choices.pop();
            undo(&mut self.slots, &mut self.trail, mark);
            self.slots.truncate(base);
        }
        Ok(None)
    }

    /// Gives a rule what its caller knows; an argument that the head computes is compared when the rule has an answer.
    fn call(&mut self, rule: &Rule, literal: &Literal, caller: usize, base: usize) -> Result<bool, Fault> {
        for (head, arg) in rule.args.iter().zip(&literal.args) {
            if let Term::Expr(expr) = arg {
                eval(expr, &self.slots[caller..base])?;
            }
            let Some(value) = known(arg, &self.slots[caller..base]) else { continue };
            if matches!(head, Term::Expr(_)) && known(head, &self.slots[base..]).is_none() {
                continue;
            }
            if !unify(head, value, base, &mut self.slots, &mut self.trail)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn give_back(
        &mut self,
        rule: &Rule,
        literal: &Literal,
        caller: u32,
        at: At,
    ) -> Result<Option<u32>, Fault> {
        for (head, arg) in rule.args.iter().zip(&literal.args) {
            if matches!((head, arg), (_, Term::Any)) {
                continue;
            }
            let own = &self.slots[at.base as usize..];
            let value = match head {
                Term::Expr(expr) => Some(eval(expr, own)?),
                Term::Any | Term::Var(_) | Term::List(..) => known(head, own),
            };
            let Some(value) = value else {
                if known(arg, &self.slots[caller as usize..]).is_some() {
                    continue;
                }
                let variable = if let Term::Var(v) = head { *v } else { 0 };
                return Err(Fault::NoValue(EvalError::Unbound(variable)));
            };
            if !unify(arg, value, caller as usize, &mut self.slots, &mut self.trail)? {
                return Ok(None);
            }
        }
        Ok(Some(at.next))
    }

    /// The latest choice that leads on.
    fn backtrack(&mut self, mind: &Mind<'p>) -> Result<Option<u32>, Fault> {
        while let Some(Choice { way, at, trail, conts, slots }) = self.choices.pop() {
            undo(&mut self.slots, &mut self.trail, trail as usize);
            self.slots.resize(slots as usize, None);
            self.conts.truncate(conts as usize);
            let next = match way {
                Way::Facts { literal, cursor, row } => self.facts(mind, literal, cursor, row, at)?,
                Way::Rules { literal, from } => self.rules(mind, literal, from, at)?,
                Way::Or(any) => self.either(any, at),
                Way::Member { element, rest } => self.member(element, rest, at)?,
                Way::Goals { args, from, to } => self.goals(args, from, to, at)?,
                Way::Negation => Some(at.next),
                Way::Collection { start, what } => self.gathered(start, what, at)?,
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
