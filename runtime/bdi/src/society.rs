//! All agents of a run: they reason in rounds, and hear each other between two rounds.
//!
//! In a round each agent settles by itself; so the agents of a round can be run one after the other or at the same time,
//! with the same outcome.

use std::sync::Arc;

use hrdsl_ir::{
    ActorId, EventId, Nanos, Program, Span, Value,
    bdi::{AgentId, InitialFact},
};
use rayon::prelude::*;

use crate::{
    check::MalformedAgentError,
    cycle::{AgentMachine, CYCLE_LIMIT, RunStatus},
    event::{ActionToken, AgentAction},
    log::{LogDetail, LogEntry, LogItem},
    measure::AgentCounts,
    mind::PeerTable,
    repeat::{FingerprintedState, RepetitionDetector},
    standing::IntentionSummary,
};

/// The multi-agent system of a run.
///
/// After each batch of [`perceive`](Self::perceive) and [`stimulus_done`](Self::stimulus_done) the harness calls
/// [`settle`](Self::settle) at the same time, and does what the agents do, until they do nothing; at
/// [`wake_of`](Self::wake_of) an agent it also calls [`expire`](Self::expire). Times never go back.
#[derive(Debug)]
pub struct AgentSociety<'p> {
    machines: Vec<AgentMachine<'p>>,
    actors: Vec<Option<ActorId>>,
    now: Nanos,
    /// Counts rounds, and the ends of actions and waits between them, over the run.
    round: u64,
    /// Rounds at the instant `now`.
    rounds: u64,
    limit: u64,
    repetition: RepetitionDetector,
    halted: Option<RunStatus>,
    parallel: bool,
    /// Agents with work, in their order.
    active: Vec<u16>,
    /// Kept empty between rounds, for its memory.
    senders: Vec<u16>,
}

impl<'p> AgentSociety<'p> {
    /// The agents at time 0, each with its initial beliefs and the facts chosen for it. `seed` is that of `.random`.
    #[must_use]
    pub fn new(program: &'p Program, agents: &[(AgentId, Vec<InitialFact>)], seed: u64) -> Self {
        Self::with_detail(program, agents, seed, LogDetail::default())
    }

    /// The same, with a log of this detail from the beginning on.
    #[must_use]
    pub fn with_detail(
        program: &'p Program,
        agents: &[(AgentId, Vec<InitialFact>)],
        seed: u64,
        detail: LogDetail,
    ) -> Self {
        let peers = Arc::new(PeerTable::new(program, agents.iter().map(|(id, _)| *id)));
        let machine = |(place, (id, chosen)): (u16, &(AgentId, Vec<InitialFact>))| {
            AgentMachine::new(program, *id, chosen, place, &peers, seed, detail)
        };
        let machines: Vec<AgentMachine> = (0u16..).zip(agents).map(machine).collect();
        let actor =
            |(id, _): &(AgentId, Vec<InitialFact>)| program.agents.get(usize::from(id.0)).map(|a| a.actor);
        Self {
            machines,
            actors: agents.iter().map(actor).collect(),
            now: 0,
            round: 0,
            rounds: 0,
            limit: CYCLE_LIMIT,
            repetition: RepetitionDetector::default(),
            halted: None,
            parallel: false,
            active: Vec::new(),
            senders: Vec::new(),
        }
    }

    /// The actors that the agents play, in their order.
    pub fn actors(&self) -> impl Iterator<Item = ActorId> {
        self.actors.iter().copied().flatten()
    }

    /// The agents, in their order.
    pub fn agents(&self) -> impl Iterator<Item = AgentId> {
        self.machines.iter().map(|m| m.mind.me.id)
    }

    /// Their names, in their order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.machines.iter().map(|m| m.mind.me.name.name())
    }

    /// Counts what the run takes of each program: see [`measured`](Self::measured).
    pub fn measure(&mut self) {
        for machine in &mut self.machines {
            machine.measured = Some(Box::new(AgentCounts::new(machine.mind.agent)));
        }
    }

    /// Runs the agents of a round on the threads of the current rayon pool. The outcome is the same.
    pub fn set_parallel(&mut self, yes: bool) {
        self.parallel = yes;
    }

    /// How many cycles of an agent, or rounds, at one instant count as endless ([`CYCLE_LIMIT`]).
    pub fn set_cycle_limit(&mut self, cycles: u64) {
        self.limit = cycles;
        self.machines.iter_mut().for_each(|m| m.cycle_limit = cycles);
    }

    #[must_use]
    pub fn cycle_limit(&self) -> u64 {
        self.limit
    }

    /// An event reaches an agent, which will take it in when it is next run.
    pub fn perceive(&mut self, agent: usize, event: EventId, args: &[Value]) {
        if let Some(machine) = self.machines.get_mut(agent) {
            machine.perceive(event, args);
        }
    }

    /// The agent's action is finished, and its intention goes on when it is next run. A token that is not of an action in
    /// progress has no effect.
    pub fn stimulus_done(&mut self, agent: usize, token: ActionToken, now: Nanos) {
        self.pass(now);
        self.round += 1;
        if let Some(machine) = self.machines.get_mut(agent) {
            machine.log.round = self.round;
            machine.action_done(token);
        }
    }

    /// Does rounds until everybody waits or is done, or until somebody acts: then the caller does the actions and calls
    /// again. Appends what the agents do, in their order, with the agent's place.
    pub fn settle(&mut self, now: Nanos, out: &mut Vec<(usize, AgentAction)>) {
        self.pass(now);
        self.active.clear();
        let working = (0u16..).zip(&self.machines).filter(|(_, m)| m.has_work());
        self.active.extend(working.map(|(place, _)| place));
        self.reason();
        if self.halted.is_some() {
            return;
        }
        for (place, machine) in self.machines.iter_mut().enumerate() {
            out.extend(machine.actions.drain(..).map(|action| (place, action)));
        }
    }

    /// Ends what is due for an agent: a `wait`, an `await`, a question, a deadline. `false` if nothing is; otherwise the
    /// agents are to be settled.
    pub fn expire(&mut self, agent: usize, now: Nanos) -> bool {
        self.pass(now);
        // What ends so is a round of its own in the log: after the rounds before, before those that follow from it.
        let round = self.round + 1;
        let halted = self.halted.is_some();
        let any = self.machines.get_mut(agent).filter(|_| !halted).is_some_and(|machine| {
            machine.log.round = round;
            machine.expire()
        });
        self.round += u64::from(any);
        any
    }

    /// Settles, and lets what is due expire, until nothing is left to do at this instant but actions: for agents that are
    /// alone in a run.
    pub fn run(&mut self, now: Nanos, out: &mut Vec<(usize, AgentAction)>) {
        loop {
            let before = out.len();
            self.settle(now, out);
            if out.len() > before || self.halted.is_some() {
                return;
            }
            let mut any = false;
            for agent in 0..self.machines.len() {
                any = self.expire(agent, now) || any;
            }
            if !any {
                return;
            }
        }
    }

    fn pass(&mut self, now: Nanos) {
        if now > self.now {
            self.now = now;
            self.rounds = 0;
            self.machines.iter_mut().for_each(|m| m.advance(now));
        }
    }

    /// Rounds of the active agents and of those they speak to.
    fn reason(&mut self) {
        self.repetition.forget();
        let mut spoken = 0;
        while !self.active.is_empty() && self.halted.is_none() {
            self.round += 1;
            self.rounds += 1;
            if self.rounds > self.limit {
                return self.halt(RunStatus::Endless);
            }
            self.settle_active();
            if self.halted.is_some() {
                return;
            }
            if self.deliver() {
                return;
            }
            spoken += 1;
            let mut repetition = std::mem::take(&mut self.repetition);
            let repeats = !self.active.is_empty() && repetition.seen(spoken, self);
            self.repetition = repetition;
            if repeats {
                return self.halt(RunStatus::Livelock);
            }
        }
    }

    fn settle_active(&mut self) {
        let round = self.round;
        let settle = |machine: &mut AgentMachine| {
            machine.log.round = round;
            machine.settle();
        };
        if self.parallel && self.active.len() > 1 {
            let mut active = vec![false; self.machines.len()];
            self.active.iter().for_each(|place| active[usize::from(*place)] = true);
            let machines = self.machines.par_iter_mut().zip(active);
            machines.filter(|(_, active)| *active).for_each(|(machine, _)| settle(machine));
        } else {
            for place in &self.active {
                settle(&mut self.machines[usize::from(*place)]);
            }
        }
        let halted = self.active.iter().find_map(|place| self.machines[usize::from(*place)].halted);
        if let Some(status) = halted.filter(|s| *s != RunStatus::Malformed) {
            self.halted = Some(status);
        }
    }

    /// Messages go to their receivers, in the order of senders and as they were sent; who hears is active next. Whether
    /// somebody acts, too.
    fn deliver(&mut self) -> bool {
        let mut senders = std::mem::take(&mut self.senders);
        std::mem::swap(&mut senders, &mut self.active);
        let mut acts = false;
        for sender in &senders {
            acts = acts || !self.machines[usize::from(*sender)].actions.is_empty();
            let mut mail = std::mem::take(&mut self.machines[usize::from(*sender)].outbox);
            for letter in mail.drain(..) {
                if let Some(receiver) = self.machines.get_mut(usize::from(letter.to)) {
                    receiver.receive(*sender, letter.speech);
                    // Who has settled has read all letters before.
                    if receiver.inbox.len() == 1 {
                        self.active.push(letter.to);
                    }
                }
            }
            self.machines[usize::from(*sender)].outbox = mail;
        }
        self.active.sort_unstable();
        senders.clear();
        self.senders = senders;
        acts
    }

    fn halt(&mut self, status: RunStatus) {
        // After all that the round has brought.
        self.round += 1;
        self.halted = Some(status);
        self.active.truncate(1);
        let what = if status == RunStatus::Livelock { LogItem::Livelock } else { LogItem::Endless };
        for place in &self.active {
            let machine = &mut self.machines[usize::from(*place)];
            machine.log.round = self.round;
            machine.enter(0, what.clone());
        }
    }

    /// The earliest time at which something of this agent is due.
    #[must_use]
    pub fn wake_of(&self, agent: usize) -> Option<Nanos> {
        if self.halted.is_some() { None } else { self.machines.get(agent).and_then(AgentMachine::next_wake) }
    }

    /// The earliest time at which a `wait`, an `await` or a deadline is over.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        if self.halted.is_some() {
            return None;
        }
        self.machines.iter().filter_map(AgentMachine::next_wake).min()
    }

    /// How the agents stand together: the first of malformed, overfull, livelock, endless, ready, waiting, idle that one of them is.
    #[must_use]
    pub fn status(&self) -> RunStatus {
        let order = |status: &RunStatus| match status {
            RunStatus::Malformed => 0,
            RunStatus::Overfull(_) => 1,
            RunStatus::Livelock => 2,
            RunStatus::Endless => 3,
            RunStatus::Ready => 4,
            RunStatus::Waiting => 5,
            RunStatus::Idle => 6,
        };
        let all = self.machines.iter().map(AgentMachine::status).chain(self.halted);
        all.min_by_key(order).unwrap_or(RunStatus::Idle)
    }

    /// The agents that did not come to rest, or cannot be run, by name.
    #[must_use]
    pub fn at_fault(&self) -> Vec<&'p str> {
        let name = |m: &AgentMachine<'p>| m.mind.me.name.name();
        let own = self.machines.iter().filter(|m| m.halted.is_some());
        let own: Vec<&str> = own.map(name).collect();
        if !own.is_empty() || self.halted.is_none() {
            return own;
        }
        self.active.iter().map(|place| name(&self.machines[usize::from(*place)])).collect()
    }

    /// What an agent holds too much of, and which plans make it so.
    #[must_use]
    pub fn overfull(&self) -> Option<String> {
        self.machines.iter().find_map(|m| {
            let Some(RunStatus::Overfull(what)) = m.halted else { return None };
            Some(m.overfull(what))
        })
    }

    /// Why a program cannot be run.
    #[must_use]
    pub fn fault(&self) -> Option<&MalformedAgentError> {
        self.machines.iter().find_map(|m| m.fault.as_ref())
    }

    /// What was counted, by agent; empty unless [`measure`](Self::measure) was called.
    #[must_use]
    pub fn measured(&self) -> Vec<&AgentCounts> {
        self.machines.iter().filter_map(|m| m.measured.as_deref()).collect()
    }

    /// The agents' logs as one: by round, then by agent, then as entered. With each entry the agent's place.
    #[must_use]
    pub fn log(&self) -> Vec<(usize, &LogEntry)> {
        let entries = self
            .machines
            .iter()
            .enumerate()
            .flat_map(|(place, m)| m.log.entries.iter().map(move |entry| (place, entry)));
        let mut all: Vec<(usize, &LogEntry)> = entries.collect();
        all.sort_by_key(|(place, entry)| (entry.round, *place));
        all
    }

    /// Hands the logs over and begins new ones, for a run that must not grow.
    pub fn clear_log(&mut self) {
        self.machines.iter_mut().for_each(|m| m.log.entries.clear());
    }

    /// An entry of an agent's log in a line of text, with names; without time and agent.
    #[must_use]
    pub fn describe(&self, agent: usize, entry: &LogEntry) -> String {
        self.machines.get(agent).map_or_else(String::new, |m| m.describe(entry))
    }

    /// The event that an entry of an agent's log is about, if it is about the choice of a plan.
    #[must_use]
    pub fn event_of(&self, agent: usize, entry: &LogEntry) -> Option<String> {
        self.machines.get(agent).and_then(|m| m.event_of(entry))
    }

    /// Where the plan or step stands that an entry of an agent's log is about, if it is about one.
    #[must_use]
    pub fn origin_in(&self, agent: usize, entry: &LogEntry) -> Option<Span> {
        self.machines.get(agent).and_then(|m| m.origin_in(entry))
    }

    /// The event that a step of an agent's log makes, or the stimulus that it does: the entry's text has its arguments.
    #[must_use]
    pub fn done_in(&self, agent: usize, entry: &LogEntry) -> Option<EventId> {
        let LogItem::Step { plan, line, .. } = &entry.what else { return None };
        self.machines.get(agent).and_then(|m| m.mind.library.event_at(*plan, *line))
    }

    /// The atomic plan that waits, at the end of a run, for what only its own agent could bring, so that nothing else of the
    /// agent goes on.
    #[must_use]
    pub fn blocked_by(&self, agent: usize) -> Option<&str> {
        let machine = self.machines.get(agent)?;
        machine.blocked_by().map(|plan| machine.mind.library.plan(plan).label.as_str())
    }

    /// What an agent intends, in the order of adoption.
    #[must_use]
    pub fn standing(&self, agent: usize) -> Vec<IntentionSummary> {
        self.machines.get(agent).map(AgentMachine::standing).unwrap_or_default()
    }

    /// What an agent believes, as text, in the order of [`beliefs`](Self::beliefs).
    #[must_use]
    pub fn believed(&self, agent: usize) -> Vec<String> {
        self.machines.get(agent).map(AgentMachine::believed).unwrap_or_default()
    }

    /// Keeps so many entries of each agent's log at most.
    pub fn keep_log(&mut self, most: usize) {
        self.machines.iter_mut().for_each(|m| m.log.most = Some(most));
    }

    /// How many entries were left out of the logs.
    #[must_use]
    pub fn left_out(&self) -> u64 {
        self.machines.iter().map(|m| m.log.left_out).sum()
    }

    /// All that an agent believes now: by the order of declarations, then oldest first.
    pub fn beliefs(&self, agent: usize) -> impl Iterator<Item = InitialFact> {
        self.machines.get(agent).into_iter().flat_map(|m| m.mind.beliefs.facts())
    }

    /// How many plans the highest intention of any agent holds.
    #[must_use]
    pub fn height(&self) -> usize {
        self.machines.iter().map(|m| m.mind.pool.height()).max().unwrap_or(0)
    }
}

impl FingerprintedState for AgentSociety<'_> {
    fn fingerprint(&self) -> u64 {
        let each = self.machines.iter().map(FingerprintedState::fingerprint);
        let inboxes = self.machines.iter().map(|m| m.inbox.front().map_or(0, crate::state::letter));
        each.chain(inboxes).fold(self.active.len() as u64, |h, n| h.rotate_left(7) ^ n)
    }

    fn state(&self) -> Vec<u64> {
        let active = self.active.iter().map(|p| u64::from(*p));
        active.chain(self.machines.iter().flat_map(FingerprintedState::state)).collect()
    }
}
