//! Whose turn it is: in an agent as in Jason nothing goes on beside an atomic intention.

use crate::{cycle::AgentMachine, event::QueuedEvent};

impl AgentMachine<'_> {
    /// Whether there is an event or an intention whose turn it is.
    pub fn has_turn(&self) -> bool {
        self.has_queued()
            && (self.holder().is_none() || self.own_event().is_some() || self.own_ready().is_some())
    }

    fn has_queued(&self) -> bool {
        !(self.mind.events.is_empty() && self.ready.is_empty())
    }

    /// The intention beside which nothing else goes on.
    pub fn holder(&self) -> Option<u32> {
        self.exclusive.filter(|place| self.mind.pool.see(*place).atomic > 0)
    }

    fn is_atomic(&self, place: u32) -> bool {
        self.mind.pool.see(place).atomic > 0
    }

    /// Where the atomic intention's event, or that of a branch of it, is in the queue.
    fn own_event(&self) -> Option<usize> {
        self.mind.events.iter().position(|e| e.of.is_some_and(|place| self.is_atomic(place)))
    }

    pub fn own_ready(&self) -> Option<usize> {
        self.ready.iter().position(|place| self.is_atomic(*place))
    }

    /// The plan of the atomic intention that keeps others from their turn, if it waits for what does not come.
    pub fn blocked_by(&self) -> Option<u16> {
        let waits = self.has_queued() && !self.has_turn();
        let holder = self.holder().filter(|_| waits && self.halted.is_none())?;
        self.mind.pool.see(holder).frames.iter().find(|f| f.atomic).map(|f| f.plan)
    }

    /// The next event while an atomic intention goes on, or the first after it.
    pub fn exclusive_event(&mut self) -> Option<QueuedEvent> {
        if self.holder().is_none() {
            self.exclusive = None;
            return self.mind.events.pop_front();
        }
        self.own_event().and_then(|at| self.mind.events.remove(at))
    }
}
