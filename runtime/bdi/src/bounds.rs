//! What one agent may hold at once: an agent that takes up ever more ends its run before the memory does.

use crate::{
    cycle::{AgentMachine, RunStatus},
    event::IncomingItem,
    holding::HoldingKind,
    intention::{Intention, NO_PLAN},
    log::{LogItem, PlanIndex},
};
use hrdsl_ir::bdi::BeliefId;

impl AgentMachine<'_> {
    /// Ends the run of an agent that holds too much.
    #[inline]
    pub fn is_overfull(&mut self) -> bool {
        let Some(what) = HoldingKind::ALL.into_iter().find(|what| self.held(*what) > what.most()) else {
            return false;
        };
        self.halted = Some(RunStatus::Overfull(what));
        self.enter(0, LogItem::Overfull(what));
        true
    }

    fn held(&self, what: HoldingKind) -> usize {
        match what {
            HoldingKind::Intentions => self.mind.pool.in_use(),
            HoldingKind::Events => self.mind.events.len(),
            HoldingKind::Facts => self.mind.beliefs.held(),
            HoldingKind::Messages => self.inbox.len() + self.outbox.len(),
            HoldingKind::Plans => self.mind.pool.plans(),
            HoldingKind::Values => self.mind.pool.values().max(self.found),
        }
    }

    /// What is held too much of, and by what: `more than 100000 intentions at once, most of them of the plan …`.
    pub fn overfull(&self, what: HoldingKind) -> String {
        let held = format!("holds more than {} {what} at once", what.most());
        let mut causes = Vec::new();
        if let Some(mostly) = self.mostly(what) {
            causes.push(format!("most of them {mostly}"));
        }
        if self.working != NO_PLAN {
            causes.push(format!("the last step was of the plan `{}`", self.label(self.working)));
        }
        if causes.is_empty() { held } else { format!("{held}: {}", causes.join("; ")) }
    }

    fn label(&self, plan: PlanIndex) -> &str {
        &self.mind.agent.plan(plan).label
    }

    /// Of what most of them are; of equally many the first.
    fn mostly(&self, what: HoldingKind) -> Option<String> {
        let of = |plan: PlanIndex| format!("of the plan `{}`", self.label(plan));
        let pool = || self.mind.pool.iter().map(|(_, i)| i);
        match what {
            HoldingKind::Intentions => {
                commonest(pool().filter_map(|i| i.frames.first()).map(|f| (f.plan, 1))).map(of)
            }
            HoldingKind::Events => {
                let by = self.mind.events.iter().filter_map(|e| e.by).map(|(plan, _)| (plan, 1));
                commonest(by).map(|plan| format!("posted by the plan `{}`", self.label(plan)))
            }
            HoldingKind::Facts => {
                let facts = (0u16..).zip(self.mind.beliefs.all()).map(|(id, rows)| (id, rows.held()));
                let name = |id: u16| &self.mind.agent.belief(BeliefId(id)).name;
                commonest(facts).map(|id| format!("of the belief `{}`", name(id)))
            }
            HoldingKind::Messages => {
                let from = self.inbox.iter().filter_map(|incoming| match incoming {
                    IncomingItem::Heard { from, .. } => Some((*from, 1)),
                    IncomingItem::Perceived { .. } => None,
                });
                let name = |place: u16| self.mind.me.peers.agents[usize::from(place)].0;
                commonest(from).map(|place| format!("from `{}`", name(place)))
            }
            HoldingKind::Plans => {
                commonest(pool().flat_map(|i| i.frames.iter().map(|f| (f.plan, 1)))).map(of)
            }
            HoldingKind::Values => commonest(pool().flat_map(Intention::values_by_plan)).map(of),
        }
    }
}

/// The number with the greatest sum, of equal ones the least.
fn commonest(all: impl Iterator<Item = (u16, usize)>) -> Option<u16> {
    let mut sums: Vec<usize> = Vec::new();
    for (number, count) in all {
        let number = usize::from(number);
        sums.resize(sums.len().max(number + 1), 0);
        sums[number] += count;
    }
    let most = sums.iter().copied().max().filter(|most| *most > 0)?;
    sums.iter().position(|n| *n == most).and_then(|n| u16::try_from(n).ok())
}
