//! What a run of an agent took of its program: raw counts, from which model coverage is made.

use std::collections::BTreeMap;

use hrdsl_ir::bdi::{Agent, ContentId, Performative, TriggerOn};

use crate::intention::NO_PLAN;

/// Counts of one agent. Plans are counted by their place in the plan library; steps by their *site*: their place in the
/// plan's body when all steps, those within blocks too, are counted from 0 in the order of the text
/// ([`each_step`](hrdsl_ir::bdi::each_step)).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AgentCounts {
    /// By plan: selected; finished; failed, also by the failure of a sub-goal.
    pub selected: Vec<u64>,
    pub completed: Vec<u64>,
    pub failed: Vec<u64>,
    /// By plan: tried, and the trigger's arguments did not match.
    pub unmatched: Vec<u64>,
    /// By plan, of those tried whose trigger matched: the context was false, true.
    pub contexts: Vec<[u64; 2]>,
    /// By plan, then by the parts of its context that `&&` joins (one part if it is no conjunction): how often this was
    /// the farthest part that the search came to and that had no answer.
    pub blocked: Vec<Vec<u64>>,
    /// By plan: tried, and an expression had no value.
    pub faults: Vec<u64>,
    /// By trigger: how often an event came with no, one, several applicable plans.
    pub applicable: BTreeMap<TriggerOn, [u64; 3]>,
    /// By plan and site: the message was sent.
    pub sent: BTreeMap<(u16, u16), u64>,
    pub received: BTreeMap<(Performative, ContentId), u64>,
    /// By plan, site of a goal in its body, and the plan that was selected for it.
    pub edges: BTreeMap<(u16, u16, u16), u64>,
    /// By plans that lay on each other at the top of an intention, the lowest first.
    pub paths: BTreeMap<[u16; 3], u64>,
}

impl AgentCounts {
    #[must_use]
    pub fn new(agent: &Agent) -> Self {
        let plans = agent.plans.len();
        Self {
            selected: vec![0; plans],
            completed: vec![0; plans],
            failed: vec![0; plans],
            unmatched: vec![0; plans],
            contexts: vec![[0; 2]; plans],
            blocked: agent.plans.iter().map(|p| vec![0; p.context.conjuncts().len()]).collect(),
            faults: vec![0; plans],
            ..Self::default()
        }
    }

    /// A plan was selected, for a goal that the step `by` of another posted, above these plans.
    pub(crate) fn begin(&mut self, plan: u16, by: Option<(u16, u16)>, under: [u16; 2]) {
        self.selected[usize::from(plan)] += 1;
        if let Some((from, site)) = by {
            *self.edges.entry((from, site, plan)).or_default() += 1;
        }
        if !under.contains(&NO_PLAN) {
            *self.paths.entry([under[1], under[0], plan]).or_default() += 1;
        }
    }

    /// Adds the counts of another run of the same agent.
    pub fn add(&mut self, other: &Self) {
        fn each(to: &mut [u64], from: &[u64]) {
            to.iter_mut().zip(from).for_each(|(a, b)| *a += b);
        }
        fn keyed<K: Ord + Copy>(to: &mut BTreeMap<K, u64>, from: &BTreeMap<K, u64>) {
            from.iter().for_each(|(k, n)| *to.entry(*k).or_default() += n);
        }
        each(&mut self.selected, &other.selected);
        each(&mut self.completed, &other.completed);
        each(&mut self.failed, &other.failed);
        each(&mut self.unmatched, &other.unmatched);
        each(&mut self.faults, &other.faults);
        self.contexts.iter_mut().zip(&other.contexts).for_each(|(a, b)| each(a, b));
        self.blocked.iter_mut().zip(&other.blocked).for_each(|(a, b)| each(a, b));
        for (on, counts) in &other.applicable {
            each(self.applicable.entry(*on).or_default(), counts);
        }
        keyed(&mut self.sent, &other.sent);
        keyed(&mut self.received, &other.received);
        keyed(&mut self.edges, &other.edges);
        keyed(&mut self.paths, &other.paths);
    }
}
