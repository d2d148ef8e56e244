//! What one agent may hold at once: an agent that takes up ever more ends its run before the memory does.

use std::fmt;

use crate::{
    cycle::{Machine, Status},
    event::Incoming,
    intention::{Intention, NO_PLAN},
    log::{Logged, PlanIndex},
};

/// A sort of what an agent holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holding {
    /// Branches too.
    Intentions,
    Events,
    /// Each counts once for each of its annotations.
    Facts,
    /// That it has yet to take in, or to give out.
    Messages,
    /// On the stacks of all intentions.
    Plans,
    /// Arguments and variables on the stacks, and answers that a `for` has yet to use.
    Values,
}

impl Holding {
    const ALL: [Holding; 6] = [
        Holding::Intentions,
        Holding::Events,
        Holding::Facts,
        Holding::Messages,
        Holding::Plans,
        Holding::Values,
    ];

    /// How many an agent may hold.
    #[must_use]
    pub const fn most(self) -> usize {
        match self {
            Holding::Intentions | Holding::Events | Holding::Facts | Holding::Messages => 100_000,
            Holding::Plans => 1_000_000,
            Holding::Values => 5_000_000,
        }
    }
}

impl fmt::Display for Holding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Holding::Intentions => "intentions",
            Holding::Events => "events",
            Holding::Facts => "facts",
            Holding::Messages => "messages",
            Holding::Plans => "plans on its stacks",
            Holding::Values => "values on its stacks",
        })
    }
}

impl Machine<'_> {
    /// Ends the run of an agent that holds too much.
    #[inline]
    pub fn is_overfull(&mut self) -> bool {
        let Some(what) = Holding::ALL.into_iter().find(|what| self.held(*what) > what.most()) else {
            return false;
        };
        self.halted = Some(Status::Overfull(what));
        self.enter(0, Logged::Overfull(what));
        true
    }

    fn held(&self, what: Holding) -> usize {
        match what {
            Holding::Intentions => self.mind.pool.in_use(),
            Holding::Events => self.mind.events.len(),
            Holding::Facts => self.mind.beliefs.held(),
            Holding::Messages => self.inbox.len() + self.outbox.len(),
            Holding::Plans => self.mind.pool.plans(),
            Holding::Values => self.mind.pool.values().max(self.found),
        }
    }

    /// What is held too much of, and by what: `more than 100000 intentions at once, most of them of the plan …`.
    pub fn overfull(&self, what: Holding) -> String {
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
        self.mind.agent.and_then(|a| a.plans.get(usize::from(plan))).map_or("?", |p| &p.label)
    }

    /// Of what most of them are; of equally many the first.
    fn mostly(&self, what: Holding) -> Option<String> {
        let of = |plan: PlanIndex| format!("of the plan `{}`", self.label(plan));
        let pool = || self.mind.pool.iter().map(|(_, i)| i);
        match what {
            Holding::Intentions => {
                commonest(pool().filter_map(|i| i.frames.first()).map(|f| (f.plan, 1))).map(of)
            }
            Holding::Events => {
                let by = self.mind.events.iter().filter_map(|e| e.by).map(|(plan, _)| (plan, 1));
                commonest(by).map(|plan| format!("posted by the plan `{}`", self.label(plan)))
            }
            Holding::Facts => {
                let facts = (0u16..).zip(self.mind.beliefs.all()).map(|(id, rows)| (id, rows.held()));
                let names = self.mind.agent.map(|a| &a.beliefs);
                let name = |id: u16| names.and_then(|n| n.get(usize::from(id))).map_or("?", |b| &b.name);
                commonest(facts).map(|id| format!("of the belief `{}`", name(id)))
            }
            Holding::Messages => {
                let from = self.inbox.iter().filter_map(|incoming| match incoming {
                    Incoming::Heard { from, .. } => Some((*from, 1)),
                    Incoming::Perceived { .. } => None,
                });
                let name = |place: u16| self.mind.me.peers.agents[usize::from(place)].0;
                commonest(from).map(|place| format!("from `{}`", name(place)))
            }
            Holding::Plans => commonest(pool().flat_map(|i| i.frames.iter().map(|f| (f.plan, 1)))).map(of),
            Holding::Values => commonest(pool().flat_map(Intention::values_by_plan)).map(of),
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
