//! Execution of one step of a plan's body.

use hrdsl_ir::{
    EventId, EventPattern, Expr, Nanos, Span, Value,
    bdi::{BeliefId, Step, StepKind, Term, TriggerOn},
    expr::EvalError,
    value::nanos,
};
use smallvec::SmallVec;

use crate::{
    Action, ActionToken, Cause, Machine,
    belief::typed,
    event::{Args, Ground},
    intention::{State, Timer},
    unify::{Slot, Trail, eval, first_match},
};

/// What becomes of the intention after a step that did not fail.
enum Flow {
    /// It may go on.
    Next,
    /// It waits for something.
    Suspended,
}

impl From<EvalError> for Cause {
    fn from(error: EvalError) -> Self {
        Cause::NoValue(error)
    }
}

fn values<C: FromIterator<T>, T>(
    exprs: &[Expr],
    slots: &[Slot],
    of: impl Fn(Value) -> T,
) -> Result<C, Cause> {
    exprs.iter().map(|e| eval(e, slots).map(&of).map_err(Cause::from)).collect()
}

impl<'p> Machine<'p> {
    /// The next step of a ready intention.
    pub(crate) fn step(&mut self, place: u32, out: &mut Vec<Action>) {
        let Some(top) = self.pool.at(place).frames.last_mut() else { return };
        // INVARIANT: a ready intention's top plan is not finished.
        let Some(step) = self.library.plan(top.plan).body.get(usize::from(top.next)) else { return };
        top.next += 1;
        match self.execute(place, step, out) {
            Ok(Flow::Next) => self.resume(place),
            Ok(Flow::Suspended) => {}
            Err(cause) => self.fail(place, cause),
        }
    }

    fn execute(&mut self, place: u32, step: &'p Step, out: &mut Vec<Action>) -> Result<Flow, Cause> {
        let slots = self.pool.at(place).vars();
        match &step.kind {
            StepKind::Do { event, args } => {
                let args = values(args, slots, |v| v)?;
                self.act(place, *event, args, out)?;
                Ok(Flow::Suspended)
            }
            StepKind::Achieve { goal, args } => {
                let args = values(args, slots, Some)?;
                self.post(TriggerOn::GoalAdded(*goal), args, Some(place), step.origin);
                Ok(Flow::Suspended)
            }
            StepKind::Spawn { goal, args } => {
                let args = values(args, slots, Some)?;
                self.post(TriggerOn::GoalAdded(*goal), args, None, step.origin);
                Ok(Flow::Next)
            }
            StepKind::Query { belief, args } => self.query(place, *belief, args, step.origin),
            StepKind::Add { belief, args } => {
                let args = values(args, slots, |v| v)?;
                let args = self.declared(*belief, args)?;
                self.believe(*belief, &args);
                Ok(Flow::Next)
            }
            StepKind::Remove { belief, args } => self.forget(place, *belief, args),
            StepKind::Replace { belief, args } => {
                let args = values(args, slots, |v| v)?;
                self.replace(*belief, args)
            }
            StepKind::Await { events, within } => {
                self.start_await(place, events, *within);
                Ok(Flow::Suspended)
            }
            StepKind::Wait { seconds } => {
                let seconds = eval(seconds, slots)?.as_f64().filter(|s| s.is_finite() && *s >= 0.0);
                let time = nanos(seconds.ok_or(Cause::BadWait)?);
                self.set_timer(place, time);
                self.pool.at(place).state = State::Sleeping;
                Ok(Flow::Suspended)
            }
        }
    }

    fn act(&mut self, place: u32, event: EventId, args: Ground, out: &mut Vec<Action>) -> Result<(), Cause> {
        let args = typed(&self.program.event(event).params, args).ok_or(Cause::OutOfRange)?;
        // Only the low half: a token need only differ from the intention's earlier ones.
        let serial = self.next_serial() as u32;
        self.pool.at(place).state = State::Acting(serial);
        out.push(Action { token: ActionToken::new(place, serial), event, args: args.into_vec() });
        Ok(())
    }

    /// The arguments, as the belief's declaration has them.
    fn declared(&self, belief: BeliefId, args: Ground) -> Result<Ground, Cause> {
        let declared = self.agent.and_then(|a| a.beliefs.get(belief.0 as usize));
        declared.and_then(|b| typed(&b.params, args)).ok_or(Cause::OutOfRange)
    }

    /// Asks the belief base, and the plans for the test goal if it has no answer.
    fn query(&mut self, place: u32, belief: BeliefId, args: &[Term], origin: Span) -> Result<Flow, Cause> {
        let slots = self.pool.at(place).vars();
        if first_match(self.beliefs.of(belief), args, slots, &mut Trail::new())?.is_some() {
            return Ok(Flow::Next);
        }
        let on = TriggerOn::TestAdded(belief);
        if self.library.relevant(on).is_empty() {
            return Err(Cause::NoAnswer(belief));
        }
        let asked: Args = args
            .iter()
            .map(|term| match term {
                Term::Any => None,
                Term::Var(var) => slots[usize::from(*var)],
                // A term that computes with a variable which this literal binds is compared with the answer.
                Term::Expr(expr) => eval(expr, slots).ok(),
            })
            .collect();
        self.post(on, asked, Some(place), origin);
        Ok(Flow::Suspended)
    }

    fn forget(&mut self, place: u32, belief: BeliefId, args: &[Term]) -> Result<Flow, Cause> {
        let slots = self.pool.at(place).vars();
        let rows = self.beliefs.of_mut(belief);
        if let Some(index) = first_match(rows, args, slots, &mut Trail::new())? {
            let removed = rows.remove(index);
            self.announce(TriggerOn::BeliefRemoved(belief), &removed);
        }
        Ok(Flow::Next)
    }

    fn replace(&mut self, belief: BeliefId, args: Ground) -> Result<Flow, Cause> {
        let args = self.declared(belief, args)?;
        let (removed, added) = self.beliefs.of_mut(belief).replace(&args);
        for fact in removed {
            self.announce(TriggerOn::BeliefRemoved(belief), &fact);
        }
        if added {
            self.announce(TriggerOn::BeliefAdded(belief), &args);
        }
        Ok(Flow::Next)
    }

    fn start_await(&mut self, place: u32, events: &'p [EventPattern], within: Option<Nanos>) {
        let timer = within.map(|time| self.set_timer(place, time));
        self.pool.at(place).state = State::Awaiting { events, timer };
        self.awaiting.push(place);
    }

    fn set_timer(&mut self, place: u32, time: Nanos) -> Timer {
        let timer = Timer { due: self.now.saturating_add(time), serial: self.next_serial(), of: place };
        self.timers.insert(timer);
        timer
    }
}

/// The slots that the terms of a test goal's plan stand for at its end, for the query that asked.
pub(crate) fn answers(trigger: &[Term], asked: &[Slot], slots: &[Slot]) -> SmallVec<[Slot; 4]> {
    trigger
        .iter()
        .zip(asked)
        .map(|(term, asked)| match term {
            Term::Any => *asked,
            Term::Var(var) => slots[usize::from(*var)].or(*asked),
            Term::Expr(expr) => eval(expr, slots).ok().or(*asked),
        })
        .collect()
}
