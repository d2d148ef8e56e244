//! The players that are BDI agents: they perceive, reason together in rounds, and do stimuli that take their time.

use std::{cell::RefCell, rc::Rc};

use hrdsl_bdi::{ActionToken, AgentAction, AgentSociety, IntentionSummary, RunStatus};
use hrdsl_ir::{ActorId, EventId, Nanos, Program, Value};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use hrdsl_harness::{
    ActorPlayer, HarnessError, PlayerContext, PlayerMessage, StimulusPerformance, draw_samples, is_perceived,
};

/// From so many agents on they reason on several threads.
const MANY: usize = 32;

/// All agents of a run; each has a player of its own, but they reason together.
pub struct AgentCompany<'p> {
    program: &'p Program,
    pub society: AgentSociety<'p>,
    members: Vec<AgentPerformer>,
    /// The delivery that they have all heard.
    heard: u64,
    /// If it is wanted: how they stand at the end of each instant at which they reasoned.
    pub snapshots: Option<SnapshotLog>,
}

/// So many intentions are noted in all snapshots of a run; after that only how the agents stand in the end.
const NOTED: usize = 200_000;

/// How the agents stand from instant to instant.
#[derive(Default)]
pub struct SnapshotLog {
    all: Vec<AgentSnapshot>,
    noted: usize,
    /// At which there was no room for another.
    missed: Option<Nanos>,
}

impl SnapshotLog {
    /// Only how they stand in the end.
    #[must_use]
    pub fn at_the_end() -> Self {
        Self { noted: NOTED, ..Self::default() }
    }

    /// How they stand at the end of this instant.
    fn note(&mut self, time: Nanos, society: &AgentSociety<'_>) {
        if self.noted >= NOTED {
            self.missed = Some(time);
            return;
        }
        if let Some(same) = self.all.pop_if(|s| s.time == time) {
            self.noted -= same.agents.iter().map(Vec::len).sum::<usize>();
        }
        let snapshot = AgentSnapshot::of(time, society);
        self.noted += snapshot.agents.iter().map(Vec::len).sum::<usize>();
        self.all.push(snapshot);
    }

    /// All of them, the last one as the agents stand now.
    #[must_use]
    pub fn finish(mut self, society: &AgentSociety<'_>) -> Vec<AgentSnapshot> {
        if let Some(time) = self.missed {
            self.all.pop_if(|s| s.time == time);
            self.all.push(AgentSnapshot::of(time, society));
        }
        self.all
    }
}

impl AgentSnapshot {
    fn of(time: Nanos, society: &AgentSociety<'_>) -> Self {
        let count = society.agents().count();
        Self { time, agents: (0..count).map(|agent| society.standing(agent)).collect() }
    }
}

/// What the agents intend at the end of an instant.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct AgentSnapshot {
    /// In nanoseconds.
    pub time: Nanos,
    /// By agent, in their order.
    pub agents: Vec<Vec<IntentionSummary>>,
}

/// What an agent is doing in the world.
struct AgentPerformer {
    actor: ActorId,
    performances: Vec<(ActionToken, StimulusPerformance)>,
    /// Draws the samples of its stimuli.
    rng: ChaCha8Rng,
}

impl<'p> AgentCompany<'p> {
    #[must_use]
    pub fn new(program: &'p Program, mut society: AgentSociety<'p>) -> Rc<RefCell<Self>> {
        let member =
            |actor| AgentPerformer { actor, performances: Vec::new(), rng: ChaCha8Rng::seed_from_u64(0) };
        let members: Vec<AgentPerformer> = society.actors().map(member).collect();
        society.set_parallel(members.len() >= MANY);
        Rc::new(RefCell::new(Self { program, society, members, heard: 0, snapshots: None }))
    }

    /// Rounds, until nobody says or does anything more.
    fn reason_in_rounds(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let mut actions = Vec::new();
        loop {
            self.society.settle(cx.now, &mut actions);
            if actions.is_empty() {
                return self.check();
            }
            for (agent, action) in actions.drain(..) {
                self.begin(agent, action, cx)?;
            }
        }
    }

    /// The same, and how they stand then is noted.
    fn reason(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let done = self.reason_in_rounds(cx);
        let Some(snapshots) = &mut self.snapshots else { return done };
        snapshots.note(cx.now, &self.society);
        done
    }

    fn begin(
        &mut self,
        agent: usize,
        action: AgentAction,
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        let AgentAction { token, event, args } = action;
        if !self.program.event(event).is_stimulus() {
            cx.out.push(PlayerMessage::Event { event, args });
            self.society.stimulus_done(agent, token, cx.now);
            return Ok(());
        }
        let member = &mut self.members[agent];
        let samples = draw_samples(self.program, event, &args, &mut member.rng)?;
        let performance = StimulusPerformance::begin(self.program, event, &args, &samples, cx)?;
        if performance.is_done(cx.now) {
            self.society.stimulus_done(agent, token, cx.now);
        } else {
            member.performances.push((token, performance));
        }
        Ok(())
    }

    fn check(&self) -> Result<(), HarnessError> {
        let what = match self.society.status() {
            RunStatus::Ready | RunStatus::Waiting | RunStatus::Idle => return Ok(()),
            RunStatus::Livelock => {
                "livelock: at one instant its state repeats, so time can never pass".to_owned()
            }
            RunStatus::Endless => format!(
                "cycle bound: more than {} cycles at one instant, without coming to rest",
                self.society.cycle_limit()
            ),
            RunStatus::Overfull(_) => self.society.overfull().unwrap_or_default(),
            RunStatus::Malformed => {
                self.society.fault().map_or_else(|| "cannot be run".to_owned(), ToString::to_string)
            }
        };
        Err(HarnessError::Model(format!("agent `{}`: {what}", self.society.at_fault().join("`, `"))))
    }

    fn wake(&mut self, agent: usize, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        let mut under_way = Vec::new();
        for (token, mut performance) in std::mem::take(&mut self.members[agent].performances) {
            performance.go_on(cx);
            if performance.is_done(cx.now) {
                self.society.stimulus_done(agent, token, cx.now);
            } else {
                under_way.push((token, performance));
            }
        }
        self.members[agent].performances.extend(under_way);
        self.reason(cx)?;
        while cx.expire && self.society.expire(agent, cx.now) {
            self.reason(cx)?;
        }
        Ok(())
    }

    /// The first of them that hears of an event tells all whom it reaches.
    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        if self.heard == cx.delivery {
            return Ok(());
        }
        self.heard = cx.delivery;
        let from = self.program.event(event).from;
        for (agent, member) in self.members.iter().enumerate() {
            if member.actor != from && is_perceived(self.program, member.actor, event) {
                self.society.perceive(agent, event, args);
            }
        }
        self.reason(cx)
    }

    fn next_wake(&self, agent: usize) -> Option<Nanos> {
        let holds = self.members[agent].performances.iter().map(|(_, p)| p.until);
        holds.chain(self.society.wake_of(agent)).min()
    }
}

/// One agent of a company.
pub struct AgentPlayer<'p> {
    company: Rc<RefCell<AgentCompany<'p>>>,
    agent: usize,
    actors: [ActorId; 1],
}

impl<'p> AgentPlayer<'p> {
    /// The players of all agents of a company, in their order.
    #[must_use]
    pub fn all(company: &Rc<RefCell<AgentCompany<'p>>>) -> Vec<Self> {
        let actors: Vec<ActorId> = company.borrow().members.iter().map(|m| m.actor).collect();
        let player = |(agent, actor)| Self { company: Rc::clone(company), agent, actors: [actor] };
        actors.into_iter().enumerate().map(player).collect()
    }
}

impl ActorPlayer for AgentPlayer<'_> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut PlayerContext<'_, '_>) -> Result<(), HarnessError> {
        self.company.borrow_mut().wake(self.agent, cx)
    }

    fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<(), HarnessError> {
        self.company.borrow_mut().hear(event, args, cx)
    }

    fn next_wake(&self) -> Option<Nanos> {
        self.company.borrow().next_wake(self.agent)
    }

    fn is_finished(&self) -> bool {
        false
    }
}
