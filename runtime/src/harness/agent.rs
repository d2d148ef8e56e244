//! The player that is a BDI agent: it perceives, reasons, and does stimuli that take their time.

use hrdsl_bdi::{Action, ActionToken, Machine, Status};
use hrdsl_ir::{
    ActorId, EventId, Nanos, Program, Value,
    bdi::{AgentId, Fact},
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{Context, Fault, Message, Player, draw_samples, stimulus::Performance};

pub struct AgentPlayer<'p> {
    program: &'p Program,
    name: &'p str,
    actors: [ActorId; 1],
    machine: Machine<'p>,
    performances: Vec<(ActionToken, Performance)>,
    rng: ChaCha8Rng,
}

impl<'p> AgentPlayer<'p> {
    /// An agent with the beliefs chosen for it; `seed` draws the samples of its stimuli.
    #[must_use]
    pub fn new(program: &'p Program, agent: AgentId, chosen: &[Fact], seed: u64) -> Self {
        let declared = &program.agents[agent.0 as usize];
        Self {
            program,
            name: &declared.name,
            actors: [declared.actor],
            machine: Machine::new(program, agent, chosen),
            performances: Vec::new(),
            rng: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// Lets the agent reason until it waits.
    fn reason(&mut self, cx: &mut Context<'_>) -> Result<(), Fault> {
        let mut actions = Vec::new();
        loop {
            if cx.expire {
                self.machine.run(cx.now, &mut actions);
            } else {
                self.machine.settle(cx.now, &mut actions);
            }
            if actions.is_empty() {
                return self.check();
            }
            for action in actions.drain(..) {
                self.begin(action, cx)?;
            }
        }
    }

    fn begin(&mut self, Action { token, event, args }: Action, cx: &mut Context<'_>) -> Result<(), Fault> {
        if !self.program.event(event).is_stimulus() {
            cx.out.push(Message::Event { event, args });
            self.machine.stimulus_done(token, cx.now);
            return Ok(());
        }
        let samples = draw_samples(self.program, event, &args, &mut self.rng)?;
        let performance = Performance::begin(self.program, event, &args, &samples, cx)?;
        if performance.is_done(cx.now) {
            self.machine.stimulus_done(token, cx.now);
        } else {
            self.performances.push((token, performance));
        }
        Ok(())
    }

    fn check(&self) -> Result<(), Fault> {
        let what = match self.machine.status() {
            Status::Ready | Status::Waiting | Status::Idle => return Ok(()),
            Status::Livelock => "does not come to rest: a plan repeats without letting time pass".to_owned(),
            Status::Malformed => {
                self.machine.fault().map_or_else(|| "cannot be run".to_owned(), ToString::to_string)
            }
        };
        Err(Fault::Model(format!("agent `{}`: {what}", self.name)))
    }
}

impl Player for AgentPlayer<'_> {
    fn actors(&self) -> &[ActorId] {
        &self.actors
    }

    fn wake(&mut self, cx: &mut Context<'_>) -> Result<(), Fault> {
        let mut under_way = Vec::new();
        for (token, mut performance) in std::mem::take(&mut self.performances) {
            performance.go_on(cx);
            if performance.is_done(cx.now) {
                self.machine.stimulus_done(token, cx.now);
            } else {
                under_way.push((token, performance));
            }
        }
        self.performances.extend(under_way);
        self.reason(cx)
    }

    fn hear(&mut self, event: EventId, args: &[Value], cx: &mut Context<'_>) -> Result<(), Fault> {
        self.machine.perceive(event, args, cx.now);
        self.reason(cx)
    }

    fn next_wake(&self) -> Option<Nanos> {
        let holds = self.performances.iter().map(|(_, p)| p.until);
        holds.chain(self.machine.next_wake()).min()
    }

    fn is_finished(&self) -> bool {
        false
    }
}
