//! The plan library: which plans are relevant to a trigger, and which may leave early.

use hrdsl_ir::{
    Program,
    bdi::{Agent, Plan, TriggerOn},
};
use smallvec::SmallVec;

/// An agent's plans, indexed by what triggers them.
#[derive(Debug, Default)]
pub(crate) struct Library<'p> {
    plans: &'p [Plan],
    beliefs: usize,
    goals: usize,
    /// The relevant plans in source order, by [`place`](Self::place).
    relevant: Vec<SmallVec<[u16; 4]>>,
    /// Whether the plan's frame may be dropped as soon as its body is finished, even below a sub-goal.
    leaves_early: Vec<bool>,
}

impl<'p> Library<'p> {
    pub fn new(program: &Program, agent: &'p Agent) -> Self {
        let (beliefs, goals) = (agent.beliefs.len(), agent.goals.len());
        let mut library = Self { plans: &agent.plans, beliefs, goals, ..Self::default() };
        library.relevant.resize(3 * beliefs + 2 * goals + program.events.len(), SmallVec::new());
        for (index, plan) in (0u16..).zip(&agent.plans) {
            let place = library.place(plan.trigger.on);
            if let Some(plans) = library.relevant.get_mut(place) {
                plans.push(index);
            }
        }
        library.leaves_early = agent
            .plans
            .iter()
            .map(|plan| match plan.trigger.on {
                // The failure of a later sub-goal would have to find this goal.
                TriggerOn::GoalAdded(goal) => library.relevant(TriggerOn::GoalFailed(goal)).is_empty(),
                // Its end carries the answer.
                TriggerOn::TestAdded(_) => false,
                TriggerOn::GoalFailed(_)
                | TriggerOn::BeliefAdded(_)
                | TriggerOn::BeliefRemoved(_)
                | TriggerOn::Perceived(_) => true,
            })
            .collect();
        library
    }

    fn place(&self, on: TriggerOn) -> usize {
        match on {
            TriggerOn::BeliefAdded(b) => b.0 as usize,
            TriggerOn::BeliefRemoved(b) => self.beliefs + b.0 as usize,
            TriggerOn::TestAdded(b) => 2 * self.beliefs + b.0 as usize,
            TriggerOn::GoalAdded(g) => 3 * self.beliefs + g.0 as usize,
            TriggerOn::GoalFailed(g) => 3 * self.beliefs + self.goals + g.0 as usize,
            TriggerOn::Perceived(e) => 3 * self.beliefs + 2 * self.goals + e.0 as usize,
        }
    }

    /// The plans with this trigger, in source order.
    pub fn relevant(&self, on: TriggerOn) -> &[u16] {
        self.relevant.get(self.place(on)).map_or(&[], |plans| plans.as_slice())
    }

    /// The plan of this index, which must be one of the library's.
    pub fn plan(&self, index: u16) -> &'p Plan {
        &self.plans[index as usize]
    }

    pub fn leaves_early(&self, index: u16) -> bool {
        self.leaves_early[index as usize]
    }
}
