//! The end of plans, good or bad: finished plans leave their intention, failures look for a failure plan.

use hrdsl_ir::{
    Span,
    bdi::{GoalId, Literal, StepKind, TriggerOn},
};

use crate::{
    Cause, Failure, Logged,
    code::Op,
    cycle::Machine,
    event::{Args, Event, Reply},
    intention::{Frame, State},
    step::answers,
    unify::{Trail, known, unify_all},
};

impl<'p> Machine<'p> {
    /// Lets an intention go on: plans that are finished leave it, and if one is left it is ready.
    pub fn resume(&mut self, place: u32) {
        loop {
            let intention = self.mind.pool.see(place);
            let Some(top) = intention.frames.last().copied() else {
                self.end(place);
                return;
            };
            let line = self.mind.library.code(top.plan).get(usize::from(top.next)).map(|l| &l.op);
            match line {
                Some(Op::Join) if top.branch => {}
                Some(_) => {
                    self.make_ready(place);
                    return;
                }
                None => {}
            }
            let plan = self.mind.library.plan(top.plan);
            let is_test = matches!(plan.trigger.on, TriggerOn::TestAdded(_) | TriggerOn::TestFailed(_));
            let answers = (is_test && !top.branch)
                .then(|| answers(&plan.trigger.args, intention.args(top), intention.vars()));
            self.leave(place);
            if !top.branch {
                self.measure(|m| m.completed[usize::from(top.plan)] += 1);
            }
            // A failure plan may have an empty body, and be finished too.
            if let Some(answers) = answers
                && let Err(cause) = self.give(place, &answers)
                && !self.unwind(place, cause)
            {
                return;
            }
        }
    }

    /// Takes the top plan off, and what is bound to it.
    pub fn leave(&mut self, place: u32) -> Option<Frame> {
        let intention = self.mind.pool.at(place);
        let frame = intention.pop()?;
        intention.atomic -= u32::from(self.mind.library.plan(frame.plan).atomic && !frame.branch);
        let height = intention.frames.len();
        self.drop_deadlines(place, height);
        Some(frame)
    }

    /// The deadlines of goals at this height and above no longer count.
    pub fn drop_deadlines(&mut self, place: u32, height: usize) {
        let deadlines = &mut self.mind.pool.at(place).deadlines;
        while let Some(last) = deadlines.last().copied().filter(|d| d.height as usize >= height) {
            deadlines.pop();
            self.timers.remove(&last.timer);
        }
    }

    /// An intention is empty: a branch's parent may go on.
    fn end(&mut self, place: u32) {
        let parent = self.mind.pool.see(place).parent;
        self.entry_of(place, || Logged::Finished);
        self.mind.pool.release(place);
        let Some(parent) = parent else { return };
        self.mind.pool.at(parent).children.retain(|c| *c != place);
        if let State::Forked { left, all } = self.mind.pool.see(parent).state {
            if all && left > 1 {
                self.mind.pool.at(parent).state = State::Forked { left: left - 1, all };
            } else {
                self.drop_children(parent);
                self.resume(parent);
            }
        }
    }

    /// A branch has failed.
    fn lose(&mut self, parent: u32, child: u32, cause: Cause) {
        self.mind.pool.at(parent).children.retain(|c| *c != child);
        if let State::Forked { left, all } = self.mind.pool.see(parent).state {
            if !all && left > 1 {
                self.mind.pool.at(parent).state = State::Forked { left: left - 1, all };
            } else {
                self.drop_children(parent);
                self.fail(parent, cause);
            }
        }
    }

    /// Gives a test goal's answers to the query that asked, or to the agent. What the plan left open, the belief base is
    /// asked again.
    fn give(&mut self, place: u32, answers: &Args) -> Result<(), Cause> {
        let intention = self.mind.pool.see(place);
        let Some(asker) = intention.frames.last().copied() else {
            if let Some(reply) = intention.reply {
                self.mind.pool.at(place).reply = None;
                self.answer(reply, answers);
            }
            return Ok(());
        };
        let Some(literal) = self.asked_by(asker) else { return Ok(()) };
        let vars = self.mind.pool.at(place).vars_mut();
        if !unify_all(&literal.args, answers.iter().copied(), 0, vars, &mut Trail::new())? {
            return Err(Cause::NoAnswer(literal.belief));
        }
        let open = literal.args.iter().any(|t| *t != hrdsl_ir::bdi::Term::Any && known(t, vars).is_none());
        if open {
            self.solver.with(self.mind.pool.see(place).vars());
            if !self.solver.answer(&self.mind, &mut self.dice, literal)? {
                return Err(Cause::NoAnswer(literal.belief));
            }
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
        }
        Ok(())
    }

    /// The literal of the query that a frame is at.
    fn asked_by(&self, frame: Frame) -> Option<&'p Literal> {
        match self.mind.library.code(frame.plan).get(usize::from(frame.at)).map(|l| &l.op) {
            Some(Op::Plain(StepKind::Query(literal))) => Some(literal),
            // INVARIANT: only a query asks.
            _ => None,
        }
    }

    // ── Failure ──

    /// The step that an intention is at has failed.
    pub fn fail(&mut self, place: u32, cause: Cause) {
        if self.unwind(place, cause) {
            self.resume(place);
        }
    }

    /// A goal has no plan: it fails itself, before the goal below it does.
    pub fn fail_to_adopt(&mut self, place: u32, goal: GoalId, event: &Event) {
        let relevant = !self.mind.library.relevant(TriggerOn::GoalAdded(goal)).is_empty();
        let cause = if relevant { Cause::NoApplicablePlan } else { Cause::NoRelevantPlan };
        self.fail_unadopted(place, goal, event, cause);
    }

    /// A goal that has no frame yet fails.
    pub fn fail_unadopted(&mut self, place: u32, goal: GoalId, event: &Event, cause: Cause) {
        let mut failure = self.failure(place, cause);
        (failure.goal, failure.origin) = (Some((goal, event.args.clone())), event.origin);
        self.enter_failure(place, failure.clone());
        let height = self.mind.pool.see(place).frames.len();
        self.drop_deadlines(place, height);
        let failed = Event { on: TriggerOn::GoalFailed(goal), of: Some(place), ..event.clone() };
        if let Some(plan) = self.select(&failed, Some(place)) {
            self.begin(place, plan, &failed);
        } else if self.handle(place, failure) {
            self.resume(place);
        }
    }

    /// A deadline is over: the goal at this height fails, with all that it led to.
    pub fn miss(&mut self, place: u32, height: u32) {
        let height = height as usize;
        let posted = self.detach(place);
        while self.mind.pool.see(place).frames.len() > height + 1 {
            self.leave(place);
        }
        self.drop_deadlines(place, height);
        let unadopted = self.mind.pool.see(place).frames.len() == height;
        match posted {
            Some(event) if unadopted && let TriggerOn::GoalAdded(goal) = event.on => {
                self.fail_unadopted(place, goal, &event, Cause::Deadline);
            }
            _ => self.fail(place, Cause::Deadline),
        }
    }

    /// Logs a failure and looks for a failure plan; `false` if the intention is gone.
    fn unwind(&mut self, place: u32, cause: Cause) -> bool {
        let failure = self.failure(place, cause);
        self.enter_failure(place, failure.clone());
        self.handle(place, failure)
    }

    /// Puts the first applicable failure plan, from the top goal downwards, in the place of its goal.
    fn handle(&mut self, place: u32, failure: Failure) -> bool {
        loop {
            let intention = self.mind.pool.see(place);
            let Some(top) = intention.frames.last().copied() else { break };
            let on = match self.mind.library.plan(top.plan).trigger.on {
                _ if top.branch => None,
                TriggerOn::GoalAdded(goal) => Some(TriggerOn::GoalFailed(goal)),
                TriggerOn::TestAdded(belief) => Some(TriggerOn::TestFailed(belief)),
                TriggerOn::GoalFailed(_)
                | TriggerOn::TestFailed(_)
                | TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::Perceived(_) => None,
            };
            let selected = on.filter(|on| !self.mind.library.relevant(*on).is_empty()).and_then(|on| {
                let args = Args::from_slice(self.mind.pool.see(place).args(top));
                let (annotations, origin) = (None, failure.origin);
                let of = Some(place);
                let event = Event { on, args, annotations, of, origin, by: None, reply: None };
                self.select(&event, of).map(|plan| (plan, event))
            });
            self.leave(place);
            if !top.branch {
                self.measure(|m| m.failed[usize::from(top.plan)] += 1);
            }
            if let Some((plan, event)) = selected {
                self.put(place, plan, &event, None);
                return true;
            }
        }
        let (parent, reply) = (self.mind.pool.see(place).parent, self.mind.pool.see(place).reply);
        let cause = failure.cause;
        if parent.is_none() {
            let number = self.mind.pool.see(place).number;
            self.enter(number, Logged::Abandoned(failure));
        }
        self.mind.pool.release(place);
        if let Some(reply) = reply {
            self.answer_nothing(reply);
        }
        if let Some(parent) = parent {
            self.lose(parent, place, cause);
        }
        false
    }

    /// Where the intention is, as the place of a failure.
    fn failure(&mut self, place: u32, cause: Cause) -> Failure {
        let origin = self.agent_origin();
        let intention = self.mind.pool.see(place);
        let Some(top) = intention.frames.last().copied() else {
            return Failure { goal: None, plan: None, cause, origin };
        };
        let plan = self.mind.library.plan(top.plan);
        let code = self.mind.library.code(top.plan);
        let at: Option<Span> = code.get(usize::from(top.at)).map(|l| l.origin);
        let goal = intention.frames.iter().rev().find_map(|frame| {
            let on = self.mind.library.plan(frame.plan).trigger.on;
            match on {
                TriggerOn::GoalAdded(goal) | TriggerOn::GoalFailed(goal) => {
                    Some((goal, Args::from_slice(intention.args(*frame))))
                }
                TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::TestAdded(_)
                | TriggerOn::TestFailed(_)
                | TriggerOn::Perceived(_) => None,
            }
        });
        Failure { goal, plan: Some(top.plan), cause, origin: at.unwrap_or(plan.origin) }
    }

    pub fn answer_nothing(&mut self, reply: Reply) {
        if let Some(question) = reply.question {
            self.say(reply.to, crate::event::Speech::Answer { question, answers: Vec::new() });
        }
    }
}
