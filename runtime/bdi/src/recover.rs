//! The end of plans, good or bad: finished plans leave their intention, failures look for a failure plan.

use hrdsl_ir::{
    Expr,
    bdi::{PlanStepKind, TriggerOn},
    list::same,
};

use crate::{
    code::{PlanOp, settle},
    cycle::AgentMachine,
    event::{EventArguments, QueuedEvent, ReplyAddress, SpeechAct},
    intention::{IntentionState, PlanFrame},
    log::{FailureCause, IntentionFailure, LogItem},
    step::answers,
    unify::{BindingTrail, VariableSlot, known, unify_all},
};

impl<'p> AgentMachine<'p> {
    /// Lets an intention go on: plans that are finished leave it, and if one is left it is ready.
    pub fn resume(&mut self, place: u32) {
        if self.mind.pool.see(place).suspended {
            self.mind.pool.at(place).state = IntentionState::Held;
            return;
        }
        loop {
            let intention = self.mind.pool.see(place);
            let Some(top) = intention.frames.last().copied() else {
                self.end(place);
                return;
            };
            let line = self.mind.library.code(top.plan).get(usize::from(top.next)).map(|l| &l.op);
            match line {
                Some(PlanOp::Join) if top.branch => {}
                // The next answer of a `for` takes no step, nor does its end.
                Some(PlanOp::Next { end }) => {
                    let end = settle(self.mind.library.code(top.plan), *end);
                    let to = if self.next_answer(place) {
                        settle(self.mind.library.code(top.plan), top.next + 1)
                    } else {
                        end
                    };
                    self.jump(place, to);
                    continue;
                }
                Some(_) => {
                    self.make_ready(place);
                    return;
                }
                None => {}
            }
            let plan = self.mind.library.plan(top.plan);
            let asked = intention.args(top);
            let answers = (gives(plan.trigger.on, asked) && !top.branch)
                .then(|| answers(&plan.trigger.args, asked, intention.vars()));
            let own = answers.is_some().then(|| self.failure(place, FailureCause::NoAnswer));
            self.leave(place);
            if !top.branch {
                self.measure(|m| m.completed[usize::from(top.plan)] += 1);
            }
            let Some(answers) = answers else { continue };
            if let Err(cause) = self.give(place, &answers) {
                if self.mind.pool.see(place).frames.is_empty() {
                    let number = self.mind.pool.see(place).number;
                    if let Some(failure) = own {
                        self.enter(number, LogItem::Failed(IntentionFailure { cause, ..failure }));
                    }
                    self.unwind(place);
                } else {
                    self.fail(place, cause);
                }
                return;
            }
        }
    }

    /// Takes the top plan off, and what is bound to it.
    #[inline]
    pub fn leave(&mut self, place: u32) -> Option<PlanFrame> {
        let frame = self.mind.pool.pop(place)?;
        let intention = self.mind.pool.at(place);
        if intention.atomic > 0 && !frame.branch {
            intention.atomic -= u32::from(frame.atomic);
        }
        if !intention.deadlines.is_empty() {
            let height = intention.frames.len();
            self.drop_deadlines(place, height);
        }
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
        self.entry_of(place, || LogItem::Finished);
        self.mind.pool.release(place);
        let Some(parent) = parent else { return };
        let Some((left, all)) = self.lose_child(parent, place) else { return };
        if all && left > 0 {
            return;
        }
        self.drop_children(parent);
        self.resume(parent);
    }

    /// A branch has failed.
    fn lose(&mut self, parent: u32, child: u32) {
        let Some((left, all)) = self.lose_child(parent, child) else { return };
        if !all && left > 0 {
            return;
        }
        self.drop_children(parent);
        self.fail(parent, if all { FailureCause::Branch } else { FailureCause::AllBranches });
    }

    /// A branch was dropped.
    pub fn miss_branch(&mut self, parent: u32, child: u32) {
        match self.lose_child(parent, child) {
            Some((0, true)) => self.resume(parent),
            Some((0, false)) => self.fail(parent, FailureCause::AllBranches),
            Some(_) | None => {}
        }
    }

    /// A branch leaves its fork; gives how many are left, and whether all are waited for.
    fn lose_child(&mut self, parent: u32, child: u32) -> Option<(u32, bool)> {
        let intention = self.mind.pool.at(parent);
        intention.children.retain(|c| *c != child);
        let IntentionState::Forked { left, all } = intention.state else { return None };
        let left = left.saturating_sub(1);
        intention.state = IntentionState::Forked { left, all };
        Some((left, all))
    }

    /// Gives a test goal's answers to the query that asked, or to the agent, and a goal's values to the step that wants them.
    /// What the plan for a query left open, the belief base is asked again.
    fn give(&mut self, place: u32, answers: &EventArguments) -> Result<(), FailureCause> {
        let intention = self.mind.pool.see(place);
        let Some(asker) = intention.frames.last().copied() else {
            if let Some(reply) = intention.reply {
                self.answer(reply, answers)?;
                self.mind.pool.at(place).reply = None;
            }
            return Ok(());
        };
        let literal = match self.asking_step(asker) {
            Some(PlanStepKind::Query(literal)) => literal,
            Some(PlanStepKind::Achieve { goal, args, .. }) => {
                let answers = self.of_goal(*goal, answers.clone())?;
                let vars = self.mind.pool.at(place).vars_mut();
                return if take_values(args, &answers, vars) { Ok(()) } else { Err(FailureCause::NoAnswer) };
            }
            // INVARIANT: only these wait for values.
            _ => return Ok(()),
        };
        let vars = self.mind.pool.at(place).vars_mut();
        if !unify_all(&literal.args, answers.iter().copied(), 0, vars, &mut BindingTrail::new())? {
            return Err(FailureCause::NoAnswer);
        }
        let open =
            literal.args.iter().any(|t| *t != hrdsl_ir::bdi::AgentTerm::Any && known(t, vars).is_none());
        if open {
            self.solver.with(self.mind.pool.see(place).vars());
            if !self.solver.answer(&self.mind, &mut self.dice, literal)? {
                return Err(FailureCause::NoAnswer);
            }
            let vars = self.mind.pool.at(place).vars_mut();
            vars.copy_from_slice(&self.solver.slots[..vars.len()]);
        }
        Ok(())
    }

    /// The step that a frame is at.
    fn asking_step(&self, frame: PlanFrame) -> Option<&'p PlanStepKind> {
        match self.mind.library.code(frame.plan).get(usize::from(frame.at)).map(|l| &l.op) {
            Some(PlanOp::Plain(step)) => Some(step),
            Some(_) | None => None,
        }
    }

    // ── Failure ──

    /// The step that an intention is at has failed.
    pub fn fail(&mut self, place: u32, cause: FailureCause) {
        if !self.mind.pool.see(place).frames.is_empty() {
            let failure = self.failure(place, cause);
            let number = self.mind.pool.see(place).number;
            self.enter(number, LogItem::Failed(failure));
        }
        self.unwind(place);
    }

    /// A goal or a query has no plan.
    pub fn fail_by_itself(&mut self, event: &QueuedEvent) {
        if let Some(place) = event.of {
            let height = self.mind.pool.see(place).frames.len();
            self.drop_deadlines(place, height);
        }
        let Some(on) = failed(event.on) else {
            // A belief that changed, whose step goes on if nothing is to be done about it.
            return event.of.into_iter().for_each(|place| self.resume(place));
        };
        let event = QueuedEvent { on, by: None, ..event.clone() };
        if let Some(plan) = self.select(&event, event.of) {
            self.adopt(plan, &event);
        } else if let Some(place) = event.of {
            if self.is_lost(on) {
                self.drop_plans(place);
            }
            self.unwind(place);
        } else if let Some(reply) = event.reply() {
            self.answer_nothing(reply);
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
        match posted {
            // It has no plan yet.
            Some(event) if self.mind.pool.see(place).frames.len() == height => self.fail_by_itself(&event),
            _ => self.fail(place, FailureCause::TimedOut),
        }
    }

    /// Takes off plans until a failure plan takes the place of one, that of the first goal from the top for which one is
    /// applicable.
    fn unwind(&mut self, place: u32) {
        while let Some(top) = self.mind.pool.see(place).frames.last().copied() {
            let trigger = self.mind.library.plan(top.plan).trigger.on;
            let on = failed(trigger).filter(|_| !top.branch);
            let is_lost = !top.branch && on.or(removed(trigger)).is_some_and(|on| self.is_lost(on));
            let selected = on.filter(|on| !self.mind.library.relevant(*on).is_empty()).and_then(|on| {
                let args = EventArguments::from_slice(self.mind.pool.see(place).args(top));
                let event = QueuedEvent { of: Some(place), told: top.told, ..QueuedEvent::new(on, args) };
                self.select(&event, Some(place)).map(|plan| (plan, event))
            });
            self.leave(place);
            if !top.branch {
                self.measure(|m| m.failed[usize::from(top.plan)] += 1);
            }
            if let Some((plan, event)) = selected {
                self.stays_atomic = top.atomic && self.mind.agent.jason;
                self.begin(place, plan, &event);
                return;
            }
            if is_lost {
                self.drop_plans(place);
            }
        }
        let (parent, reply) = (self.mind.pool.see(place).parent, self.mind.pool.see(place).reply);
        self.mind.pool.release(place);
        if let Some(reply) = reply {
            self.answer_nothing(reply);
        }
        if let Some(parent) = parent {
            self.lose(parent, place);
        }
    }

    /// Whether a failure goes no further down than to this goal, whether or not a plan for it is applicable: in an agent as in
    /// Jason, where plans for the removal of a belief count, too, for its plans.
    fn is_lost(&self, on: TriggerOn) -> bool {
        self.mind.agent.jason && !self.mind.library.relevant(on).is_empty()
    }

    /// All plans leave, failed.
    fn drop_plans(&mut self, place: u32) {
        while let Some(frame) = self.leave(place) {
            if !frame.branch {
                self.measure(|m| m.failed[usize::from(frame.plan)] += 1);
            }
        }
    }

    /// What the plan on top is at, which fails.
    fn failure(&self, place: u32, cause: FailureCause) -> IntentionFailure {
        let intention = self.mind.pool.see(place);
        // INVARIANT: whoever asks has seen to it that there is a plan.
        let top = intention.frames[intention.frames.len() - 1];
        let plan = self.mind.library.plan(top.plan);
        let origin =
            self.mind.library.code(top.plan).get(usize::from(top.at)).map_or(plan.origin, |l| l.origin);
        let args = EventArguments::from_slice(intention.args(top));
        IntentionFailure { on: plan.trigger.on, args, plan: top.plan, cause, origin }
    }

    pub fn answer_nothing(&mut self, reply: ReplyAddress) {
        if let Some(question) = reply.question {
            self.say(
                reply.to,
                SpeechAct::Answer { question, content: reply.content, all: false, answers: None },
            );
        }
    }
}

/// Whether the end of a plan for this gives values to whoever waits: of a query, and of a goal that was open somewhere.
fn gives(on: TriggerOn, asked: &[VariableSlot]) -> bool {
    match on {
        TriggerOn::TestAdded(_) | TriggerOn::TestFailed(_) => true,
        TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_) => asked.iter().any(Option::is_none),
        TriggerOn::BeliefAdded(_) | TriggerOn::BeliefRemoved(_) | TriggerOn::Perceived(_) => false,
    }
}

/// Gives the open variables among a goal's arguments their values; `false` if one that is there twice would get two.
fn take_values(args: &[Expr], values: &[VariableSlot], vars: &mut [VariableSlot]) -> bool {
    for (arg, value) in args.iter().zip(values) {
        let (Expr::Var(var), Some(value)) = (arg, value) else { continue };
        match vars.get_mut(usize::from(*var)) {
            Some(Some(known)) if !same(*known, *value) => return false,
            Some(open @ None) => *open = Some(*value),
            Some(Some(_)) | None => {}
        }
    }
    true
}

/// What the failure of an event is, if there are plans for that.
fn failed(on: TriggerOn) -> Option<TriggerOn> {
    match on {
        TriggerOn::GoalAdded(goal) => Some(TriggerOn::GoalFailed(goal)),
        TriggerOn::TestAdded(belief) => Some(TriggerOn::TestFailed(belief)),
        TriggerOn::GoalFailed(_)
        | TriggerOn::TestFailed(_)
        | TriggerOn::BeliefAdded(_)
        | TriggerOn::BeliefRemoved(_)
        | TriggerOn::Perceived(_) => None,
    }
}

/// The removal of the belief that an event is about.
fn removed(on: TriggerOn) -> Option<TriggerOn> {
    match on {
        TriggerOn::BeliefAdded(belief) | TriggerOn::BeliefRemoved(belief) => {
            Some(TriggerOn::BeliefRemoved(belief))
        }
        TriggerOn::GoalAdded(_)
        | TriggerOn::GoalFailed(_)
        | TriggerOn::TestAdded(_)
        | TriggerOn::TestFailed(_)
        | TriggerOn::Perceived(_) => None,
    }
}
