//! Internal actions that change what is intended: dropping, suspending, ending goals.

use hrdsl_ir::bdi::{AgentTerm, ControlAct, GoalId, TriggerOn};

use crate::{
    cycle::AgentMachine,
    event::QueuedEvent,
    intention::IntentionState,
    log::{FailureCause, LogItem},
    mind::agree,
    step::StepFlow,
    unify::{VariableSlot, known},
};

impl AgentMachine<'_> {
    /// Does it for an intention that executes a step.
    pub fn control(
        &mut self,
        place: u32,
        what: ControlAct,
        goal: Option<&(GoalId, Vec<AgentTerm>)>,
    ) -> Result<StepFlow, FailureCause> {
        let before = self.touched;
        match goal {
            Some((goal, args)) => {
                let slots = self.mind.pool.see(place).vars();
                crate::unify::well_bound(args, slots)?;
                let args: Vec<VariableSlot> = args.iter().map(|t| known(t, slots)).collect();
                self.acting = Some(place);
                self.control_goal(what, *goal, &args);
                self.acting = None;
            }
            None => {
                self.acting = Some(place);
                self.control_all(place, what);
                self.acting = None;
            }
        }
        // What was ended, or ended and went on another way, has been seen to.
        Ok(if self.touched == before { StepFlow::Next } else { StepFlow::Suspended })
    }

    /// Without a goal: of all others, or of the intention itself.
    fn control_all(&mut self, place: u32, what: ControlAct) {
        match what {
            ControlAct::DropIntention => self.drop_others(place),
            ControlAct::DropDesire => {
                self.drop_events(&|e| matches!(e.on, TriggerOn::GoalAdded(_)));
                self.drop_others(place);
            }
            ControlAct::DropEvent => self.drop_events(&|_| true),
            ControlAct::Suspend => self.mind.pool.at(place).suspended = true,
            // The checker refuses these without a goal.
            ControlAct::SucceedGoal | ControlAct::FailGoal | ControlAct::Resume => {}
        }
    }

    /// All but the intention itself and those whose branch it is.
    fn drop_others(&mut self, place: u32) {
        let mut own = vec![place];
        while let Some(parent) = self.mind.pool.see(own[own.len() - 1]).parent {
            own.push(parent);
        }
        for (other, number) in self.numbered() {
            if !own.contains(&other) && self.is_still(other, number) {
                self.drop_one(other);
            }
        }
    }

    pub fn control_goal(&mut self, what: ControlAct, goal: GoalId, args: &[VariableSlot]) {
        let is_this = |e: &QueuedEvent| e.on == TriggerOn::GoalAdded(goal) && agree(&e.args, args);
        match what {
            ControlAct::DropEvent => return self.drop_events(&is_this),
            ControlAct::DropDesire => self.drop_events(&is_this),
            ControlAct::DropIntention
            | ControlAct::SucceedGoal
            | ControlAct::FailGoal
            | ControlAct::Suspend
            | ControlAct::Resume => {}
        }
        let numbered = self.numbered();
        let has = numbered.into_iter().filter_map(|(place, number)| {
            self.mind.frame_of(self.mind.pool.see(place), goal, args).map(|frame| (place, number, frame))
        });
        for (place, number, frame) in has.collect::<Vec<_>>() {
            if !self.is_still(place, number) {
                continue;
            }
            match what {
                ControlAct::DropIntention | ControlAct::DropDesire => self.drop_one(place),
                ControlAct::SucceedGoal => self.succeed(place, frame),
                ControlAct::FailGoal => self.fail_goal(place, frame),
                ControlAct::Suspend => self.suspend(place),
                ControlAct::Resume => self.wake(place),
                ControlAct::DropEvent => {}
            }
        }
    }

    /// The intentions in use, in their order, with their numbers.
    fn numbered(&self) -> Vec<(u32, u32)> {
        let number = |place: u32| (place, self.mind.pool.see(place).number);
        self.mind.pool.in_order().into_iter().map(number).collect()
    }

    fn is_still(&self, place: u32, number: u32) -> bool {
        let intention = self.mind.pool.see(place);
        !matches!(intention.state, IntentionState::Free) && intention.number == number
    }

    fn drop_events(&mut self, of: &dyn Fn(&QueuedEvent) -> bool) {
        let events = std::mem::take(&mut self.mind.events);
        let (gone, kept): (Vec<QueuedEvent>, Vec<QueuedEvent>) = events.into_iter().partition(|e| of(e));
        self.mind.events.extend(kept);
        for event in gone {
            if let Some(place) = event.of {
                self.drop_one(place);
            }
            if let Some(reply) = event.reply() {
                self.answer_nothing(reply);
            }
        }
    }

    /// The goal counts as achieved.
    fn succeed(&mut self, place: u32, frame: usize) {
        self.detach(place);
        while self.mind.pool.see(place).frames.len() > frame {
            self.leave(place);
        }
        self.resume(place);
    }

    fn fail_goal(&mut self, place: u32, frame: usize) {
        self.detach(place);
        while self.mind.pool.see(place).frames.len() > frame + 1 {
            self.leave(place);
        }
        self.fail(place, FailureCause::FailGoal);
    }

    fn suspend(&mut self, place: u32) {
        let intention = self.mind.pool.at(place);
        intention.suspended = true;
        if matches!(intention.state, IntentionState::Ready) && self.ready.contains(&place) {
            self.mind.pool.at(place).state = IntentionState::Held;
            self.ready.retain(|p| *p != place);
        }
        for child in self.mind.pool.see(place).children.clone() {
            self.suspend(child);
        }
    }

    fn wake(&mut self, place: u32) {
        let children = self.mind.pool.see(place).children.clone();
        let intention = self.mind.pool.at(place);
        let was = std::mem::take(&mut intention.suspended);
        if was && matches!(intention.state, IntentionState::Held) {
            self.resume(place);
        }
        for child in children {
            self.wake(child);
        }
    }

    // ── Ends without failure ──

    /// Removes an intention; a fork that it is a branch of is told.
    fn drop_one(&mut self, place: u32) {
        if matches!(self.mind.pool.see(place).state, IntentionState::Free) {
            return;
        }
        let parent = self.mind.pool.see(place).parent;
        self.drop_tree(place);
        if let Some(parent) = parent {
            self.miss_branch(parent, place);
        }
    }

    pub fn drop_children(&mut self, place: u32) {
        for child in std::mem::take(&mut self.mind.pool.at(place).children) {
            self.drop_tree(child);
        }
    }

    fn drop_tree(&mut self, place: u32) {
        self.entry_of(place, || LogItem::Dropped);
        self.detach(place);
        let reply = self.mind.pool.see(place).reply;
        self.drop_deadlines(place, 0);
        self.mind.pool.release(place);
        if let Some(reply) = reply {
            self.answer_nothing(reply);
        }
    }

    /// The intention no longer waits for anything; gives the event that it waited for, if there was one.
    pub fn detach(&mut self, place: u32) -> Option<QueuedEvent> {
        if self.acting == Some(place) {
            self.touched += 1;
        }
        let mut posted = None;
        match self.mind.pool.see(place).state {
            IntentionState::Awaiting { timer, .. } => {
                self.awaiting.retain(|p| *p != place);
                if let Some(timer) = timer {
                    self.timers.remove(&timer);
                }
            }
            IntentionState::Asking { timer, .. } => {
                if let Some(timer) = timer {
                    self.timers.remove(&timer);
                }
            }
            IntentionState::Sleeping(timer) => {
                self.timers.remove(&timer);
            }
            IntentionState::Posted => {
                let at = self.mind.events.iter().position(|e| e.of == Some(place));
                posted = at.and_then(|at| self.mind.events.remove(at));
            }
            IntentionState::Ready => self.ready.retain(|p| *p != place),
            // What is under way ends by itself, and nobody waits for it.
            IntentionState::Acting(_)
            | IntentionState::Free
            | IntentionState::Held
            | IntentionState::Forked { .. } => {}
        }
        self.mind.pool.at(place).state = IntentionState::Ready;
        self.drop_children(place);
        posted
    }
}
