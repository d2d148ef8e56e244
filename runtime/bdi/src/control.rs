//! Internal actions that change what is intended: dropping, suspending, ending goals.

use hrdsl_ir::bdi::{Control, GoalId, Term, TriggerOn};

use crate::{
    Cause, Logged,
    cycle::Machine,
    event::Event,
    intention::State,
    mind::agree,
    step::Flow,
    unify::{Slot, known},
};

impl Machine<'_> {
    /// Does it for an intention that executes a step.
    pub fn control(
        &mut self,
        place: u32,
        what: Control,
        goal: Option<&(GoalId, Vec<Term>)>,
    ) -> Result<Flow, Cause> {
        let number = self.mind.pool.see(place).number;
        match goal {
            Some((goal, args)) => {
                let slots = self.mind.pool.see(place).vars();
                let args: Vec<Slot> = args.iter().map(|t| known(t, slots)).collect();
                self.control_goal(what, *goal, &args);
            }
            None => self.control_all(place, what),
        }
        let intention = self.mind.pool.see(place);
        let same = intention.number == number && !matches!(intention.state, State::Free);
        // What was ended, or ended and began anew, has been seen to.
        let untouched = same && matches!(intention.state, State::Ready) && !self.ready.contains(&place);
        Ok(if untouched { Flow::Next } else { Flow::Suspended })
    }

    /// Without a goal: of all others, or of the intention itself.
    fn control_all(&mut self, place: u32, what: Control) {
        match what {
            Control::DropIntention => self.drop_others(place),
            Control::DropDesire => {
                self.drop_others(place);
                self.mind.events.retain(|e| !is_goal(e));
            }
            Control::DropEvent => {
                let waiting: Vec<u32> = self.mind.events.iter().filter_map(|e| e.of).collect();
                self.mind.events.clear();
                waiting.into_iter().for_each(|p| self.drop_whole(p));
            }
            Control::Suspend => self.mind.pool.at(place).suspended = true,
            // The checker refuses these without a goal.
            Control::SucceedGoal | Control::FailGoal | Control::Resume => {}
        }
    }

    fn drop_others(&mut self, place: u32) {
        let root = self.root(place);
        for other in self.mind.pool.in_order() {
            if self.is_used(other) && self.root(other) != root {
                self.drop_whole(other);
            }
        }
    }

    pub fn control_goal(&mut self, what: Control, goal: GoalId, args: &[Slot]) {
        let has: Vec<(u32, Option<usize>)> = self
            .mind
            .pool
            .in_order()
            .into_iter()
            .filter_map(|place| {
                let frame = self.mind.frame_of(self.mind.pool.see(place), goal, args);
                let posted = || self.mind.events.iter().any(|e| e.of == Some(place) && is_this(e, goal, args));
                (frame.is_some() || posted()).then_some((place, frame))
            })
            .collect();
        match what {
            Control::DropIntention => has.into_iter().for_each(|(place, _)| self.drop_whole(place)),
            Control::DropDesire => {
                has.into_iter().for_each(|(place, _)| self.drop_whole(place));
                self.mind.events.retain(|e| !is_this(e, goal, args));
            }
            Control::DropEvent => {
                let waiting: Vec<u32> =
                    self.mind.events.iter().filter(|e| is_this(e, goal, args)).filter_map(|e| e.of).collect();
                self.mind.events.retain(|e| !is_this(e, goal, args));
                waiting.into_iter().for_each(|p| self.drop_whole(p));
            }
            Control::SucceedGoal => {
                has.into_iter().for_each(|(place, frame)| self.succeed(place, frame));
                self.mind.events.retain(|e| e.of.is_some() || !is_this(e, goal, args));
            }
            Control::FailGoal => has.into_iter().for_each(|(place, frame)| self.fail_goal(place, frame)),
            Control::Suspend => has.into_iter().for_each(|(place, _)| self.suspend(place)),
            Control::Resume => has.into_iter().for_each(|(place, _)| self.wake(place)),
        }
    }

    fn is_used(&self, place: u32) -> bool {
        !matches!(self.mind.pool.see(place).state, State::Free)
    }

    /// The intention that forked, and was forked by none.
    fn root(&self, mut place: u32) -> u32 {
        while let Some(parent) = self.mind.pool.see(place).parent {
            place = parent;
        }
        place
    }

    /// The goal counts as achieved.
    fn succeed(&mut self, place: u32, frame: Option<usize>) {
        if !self.is_used(place) {
            return;
        }
        self.detach(place);
        if let Some(frame) = frame {
            while self.mind.pool.see(place).frames.len() > frame {
                self.leave(place);
            }
        } else {
            let height = self.mind.pool.see(place).frames.len();
            self.drop_deadlines(place, height);
        }
        self.resume(place);
    }

    fn fail_goal(&mut self, place: u32, frame: Option<usize>) {
        if !self.is_used(place) {
            return;
        }
        let posted = self.detach(place);
        match (frame, posted) {
            (Some(frame), _) => {
                while self.mind.pool.see(place).frames.len() > frame + 1 {
                    self.leave(place);
                }
                self.fail(place, Cause::Told);
            }
            (None, Some(event)) if let TriggerOn::GoalAdded(goal) = event.on => {
                self.fail_unadopted(place, goal, &event, Cause::Told);
            }
            (None, _) => self.fail(place, Cause::Told),
        }
    }

    fn suspend(&mut self, place: u32) {
        for child in self.mind.pool.see(place).children.clone() {
            self.suspend(child);
        }
        let intention = self.mind.pool.at(place);
        intention.suspended = true;
        if matches!(intention.state, State::Ready) && self.ready.contains(&place) {
            self.mind.pool.at(place).state = State::Held;
            self.ready.retain(|p| *p != place);
        }
    }

    fn wake(&mut self, place: u32) {
        for child in self.mind.pool.see(place).children.clone() {
            self.wake(child);
        }
        let intention = self.mind.pool.at(place);
        intention.suspended = false;
        if matches!(intention.state, State::Held) {
            self.make_ready(place);
        }
    }

    // ── Ends without failure ──

    /// Removes an intention, with the one that it is a branch of and all branches.
    pub fn drop_whole(&mut self, place: u32) {
        if self.is_used(place) {
            let root = self.root(place);
            self.drop_tree(root);
        }
    }

    pub fn drop_children(&mut self, place: u32) {
        for child in std::mem::take(&mut self.mind.pool.at(place).children) {
            self.drop_tree(child);
        }
    }

    fn drop_tree(&mut self, place: u32) {
        self.detach(place);
        let reply = self.mind.pool.see(place).reply;
        self.drop_deadlines(place, 0);
        self.entry_of(place, || Logged::Dropped);
        self.mind.pool.release(place);
        if let Some(reply) = reply {
            self.answer_nothing(reply);
        }
    }

    /// The intention no longer waits for anything; gives the event that it waited for, if there was one.
    pub fn detach(&mut self, place: u32) -> Option<Event> {
        self.drop_children(place);
        let mut posted = None;
        match self.mind.pool.see(place).state {
            State::Awaiting { timer, .. } => {
                self.awaiting.retain(|p| *p != place);
                if let Some(timer) = timer {
                    self.timers.remove(&timer);
                }
            }
            State::Asking { timer, .. } => {
                if let Some(timer) = timer {
                    self.timers.remove(&timer);
                }
            }
            State::Sleeping(timer) => {
                self.timers.remove(&timer);
            }
            State::Posted => {
                let at = self.mind.events.iter().position(|e| e.of == Some(place));
                posted = at.and_then(|at| self.mind.events.remove(at));
            }
            State::Ready => self.ready.retain(|p| *p != place),
            // What is under way ends by itself, and nobody waits for it.
            State::Acting(_) | State::Free | State::Held | State::Forked { .. } => {}
        }
        self.mind.pool.at(place).state = State::Ready;
        posted
    }
}

fn is_goal(event: &Event) -> bool {
    matches!(event.on, TriggerOn::GoalAdded(_))
}

fn is_this(event: &Event, goal: GoalId, args: &[Slot]) -> bool {
    event.on == TriggerOn::GoalAdded(goal) && agree(&event.args, args)
}
