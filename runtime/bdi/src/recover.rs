//! The end of plans, good or bad: finished plans leave their intention, failures look for a failure plan.

use hrdsl_ir::{
    Span,
    bdi::{GoalId, StepKind, Term, TriggerOn},
};

use crate::{
    Cause, Failure, Logged, Machine,
    event::{Args, Event},
    step::answers,
    unify::{Trail, first_match, unify_all},
};

impl Machine<'_> {
    /// Lets an intention go on: plans that are finished leave it, and if one is left it is ready.
    pub(crate) fn resume(&mut self, place: u32) {
        loop {
            let intention = self.pool.at(place);
            let Some(top) = intention.frames.last().copied() else {
                self.pool.release(place);
                return;
            };
            let plan = self.library.plan(top.plan);
            if usize::from(top.next) < plan.body.len() {
                self.make_ready(place);
                return;
            }
            let end = match plan.trigger.on {
                TriggerOn::TestAdded(_) => {
                    let slots = &intention.slots[top.vars as usize..];
                    let answers = answers(&plan.trigger.args, intention.args(top), slots);
                    intention.pop();
                    self.answer(place, &answers)
                }
                TriggerOn::GoalAdded(_)
                | TriggerOn::GoalFailed(_)
                | TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::Perceived(_) => {
                    intention.pop();
                    Ok(())
                }
            };
            // A failure plan may have an empty body, and be finished too.
            if let Err(cause) = end
                && !self.unwind(place, cause)
            {
                return;
            }
        }
    }

    /// Gives a test goal's answers to the query that asked. What the plan left open, the belief base is asked again.
    fn answer(&mut self, place: u32, answers: &Args) -> Result<(), Cause> {
        let intention = self.pool.at(place);
        let Some(asker) = intention.frames.last().copied() else { return Ok(()) };
        let step = self.library.plan(asker.plan).body.get(usize::from(asker.next).wrapping_sub(1));
        // INVARIANT: only a query asks.
        let Some(StepKind::Query { belief, args }) = step.map(|s| &s.kind) else { return Ok(()) };
        let (slots, mut trail) = (intention.vars(), Trail::new());
        if !unify_all(args, answers.iter().copied(), slots, &mut trail)? {
            return Err(Cause::NoAnswer(*belief));
        }
        let open = args.iter().any(|t| matches!(t, Term::Var(v) if slots[usize::from(*v)].is_none()));
        if open && first_match(self.beliefs.of(*belief), args, slots, &mut trail)?.is_none() {
            return Err(Cause::NoAnswer(*belief));
        }
        Ok(())
    }

    /// The step that an intention is at has failed.
    pub(crate) fn fail(&mut self, place: u32, cause: Cause) {
        if self.unwind(place, cause) {
            self.resume(place);
        }
    }

    /// A goal has no plan: it fails itself, before the goal below it does.
    pub(crate) fn fail_to_adopt(&mut self, place: u32, goal: GoalId, event: &Event) {
        let args = &event.args;
        let relevant = !self.library.relevant(TriggerOn::GoalAdded(goal)).is_empty();
        let cause = if relevant { Cause::NoApplicablePlan } else { Cause::NoRelevantPlan };
        let mut failure = self.failure(place, cause);
        (failure.goal, failure.origin) = (Some((goal, args.clone())), event.origin);
        self.log.enter(self.now, self.pool.at(place).number, Logged::Failed(failure.clone()));
        let on = TriggerOn::GoalFailed(goal);
        if let Some(plan) = self.select(on, args, Some(place)) {
            self.enter(place, plan, on, args);
        } else if self.handle(place, failure) {
            self.resume(place);
        }
    }

    /// Logs a failure and looks for a failure plan; `false` if the intention is gone.
    fn unwind(&mut self, place: u32, cause: Cause) -> bool {
        let failure = self.failure(place, cause);
        self.log.enter(self.now, self.pool.at(place).number, Logged::Failed(failure.clone()));
        self.handle(place, failure)
    }

    /// Puts the first applicable failure plan, from the top goal downwards, in the place of its goal.
    fn handle(&mut self, place: u32, failure: Failure) -> bool {
        loop {
            let intention = self.pool.at(place);
            let Some(top) = intention.frames.last().copied() else { break };
            let trigger = self.library.plan(top.plan).trigger.on;
            let args = Args::from_slice(intention.args(top));
            if let TriggerOn::GoalAdded(goal) = trigger {
                let on = TriggerOn::GoalFailed(goal);
                if let Some(plan) = self.select(on, &args, Some(place)) {
                    self.replace_top(place, plan, on, args);
                    return true;
                }
            }
            self.pool.at(place).pop();
        }
        self.log.enter(self.now, self.pool.at(place).number, Logged::Dropped(failure));
        self.pool.release(place);
        false
    }

    fn replace_top(&mut self, place: u32, plan: u16, on: TriggerOn, args: Args) {
        self.log.selections[plan as usize] += 1;
        let intention = self.pool.at(place);
        intention.pop();
        intention.push(plan, &args, &self.selector.slots);
        if self.log.detailed {
            let what = Logged::Selected { on, args, plan };
            self.log.enter(self.now, intention.number, what);
        }
    }

    /// Where the intention is, as the place of a failure.
    fn failure(&mut self, place: u32, cause: Cause) -> Failure {
        let origin = self.agent_origin();
        let intention = self.pool.at(place);
        let Some(top) = intention.frames.last().copied() else {
            return Failure { goal: None, plan: None, cause, origin };
        };
        let plan = self.library.plan(top.plan);
        let at: Option<Span> = usize::from(top.next).checked_sub(1).map(|step| plan.body[step].origin);
        let goal =
            intention.frames.iter().rev().find_map(|frame| match self.library.plan(frame.plan).trigger.on {
                TriggerOn::GoalAdded(goal) | TriggerOn::GoalFailed(goal) => {
                    Some((goal, Args::from_slice(intention.args(*frame))))
                }
                TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::TestAdded(_)
                | TriggerOn::Perceived(_) => None,
            });
        Failure { goal, plan: Some(top.plan), cause, origin: at.unwrap_or(plan.origin) }
    }
}
