//! The loop: players are asked in turn, and what they want happens, until nobody waits for anything.

use std::collections::VecDeque;

use hrdsl_ir::{ActorId, EventId, Nanos, Program, Role, Value};
use hrdsl_trace::{Trace, TraceStep, TraceStepKind, picture::WorldPicture};

use crate::{
    clock::{TimeSource, VirtualClock},
    log::SystemLog,
    message::PlayerMessage,
    player::{ActorPlayer, AwaitInVain, HarnessError, PlayerContext, is_perceived},
    port::PortHistory,
    said::SaidHistory,
    stage::WorldStage,
    world::WorldAccuracy,
};

/// At most so many events at one instant: more is a model in which time cannot pass.
const EVENTS_AT_AN_INSTANT: usize = 10_000;

/// How a run ended.
#[derive(Clone, Debug)]
pub enum RunTermination {
    /// Every player is finished, or nobody waits for anything that could still come.
    Quiescent,
    /// The time limit was reached.
    Limit,
    Fault(HarnessError),
}

/// The outcome of a run.
pub struct HarnessRun {
    pub trace: Trace,
    pub ended: RunTermination,
    /// What the system's programs opened to speak with each other.
    pub ports: PortHistory,
    /// What they have logged.
    pub log: SystemLog,
    /// What the steps of its test awaited in vain, in the order in which that was given up.
    pub unmet: Vec<AwaitInVain>,
    /// How far the world strayed from what cannot be; `None`: there is none, or it cannot tell.
    pub accuracy: Option<WorldAccuracy>,
    /// What the programs of the system said; empty if nobody asked for it.
    pub said: SaidHistory,
    /// What could be seen of the world; empty if nobody asked for it.
    pub picture: WorldPicture,
}

/// The loop's state.
pub struct HarnessLoop<'p> {
    program: &'p Program,
    players: Vec<Box<dyn ActorPlayer + 'p>>,
    stage: Option<WorldStage<'p>>,
    clock: Box<dyn TimeSource + 'p>,
    limit: Nanos,
    now: Nanos,
    trace: Trace,
    /// Events that happened and are not yet delivered, with the player that made them.
    pending: VecDeque<(Option<usize>, EventId, Vec<Value>)>,
    at_this_instant: usize,
    expire: bool,
    delivery: u64,
}

impl<'p> HarnessLoop<'p> {
    /// Players are asked in a fixed order: the system's first, so that what it does at an instant is known to those whose
    /// wait for it ends at the same instant; then in the order given. The run ends at `limit` at the latest.
    #[must_use]
    pub fn new(
        program: &'p Program,
        mut players: Vec<Box<dyn ActorPlayer + 'p>>,
        stage: Option<WorldStage<'p>>,
        limit: Nanos,
    ) -> Self {
        players.sort_by_key(|p| !plays_the_system(program, p.actors()));
        Self {
            program,
            players,
            stage,
            clock: Box::new(VirtualClock),
            limit,
            now: 0,
            trace: Trace::default(),
            pending: VecDeque::new(),
            at_this_instant: 0,
            expire: false,
            delivery: 0,
        }
    }

    /// The same with another clock than the harness's own.
    #[must_use]
    pub fn with_clock(self, clock: Box<dyn TimeSource + 'p>) -> Self {
        Self { clock, ..self }
    }

    /// Runs to the end.
    #[must_use]
    pub fn run(mut self) -> HarnessRun {
        let ended = self.run_loop().unwrap_or_else(RunTermination::Fault);
        if let Some(stage) = &mut self.stage {
            stage.sample(self.now, &mut self.trace);
        }
        self.trace.end = self.now;
        let system = self.players.iter().find(|p| plays_the_system(self.program, p.actors()));
        let ports = system.map(|p| p.ports(self.now)).unwrap_or_default();
        let log = system.map(|p| p.log()).unwrap_or_default();
        let said = system.map(|p| p.said()).unwrap_or_default();
        let mut unmet: Vec<_> = self.players.iter().flat_map(|p| p.unmet_awaits(self.now)).collect();
        unmet.sort_by_key(|vain| (vain.until, vain.step));
        let accuracy = self.stage.as_ref().and_then(WorldStage::accuracy);
        let picture = self.stage.as_mut().map(WorldStage::take_picture).unwrap_or_default();
        HarnessRun { trace: self.trace, ended, ports, log, unmet, accuracy, said, picture }
    }

    fn run_loop(&mut self) -> Result<RunTermination, HarnessError> {
        if let Some(stage) = &mut self.stage {
            stage.sample(0, &mut self.trace);
        }
        for index in 0..self.players.len() {
            self.ask(index, |player, cx| player.wake(cx))?;
        }
        self.deliver()?;
        loop {
            if self.players.iter().all(|p| p.is_finished()) {
                return Ok(RunTermination::Quiescent);
            }
            let next = self.players.iter().filter_map(|p| p.next_wake());
            let due = next.chain(self.stage.as_ref().and_then(WorldStage::next_wake)).min();
            let Some(time) = self.clock.advance(self.now, due, self.limit) else {
                return Ok(RunTermination::Quiescent);
            };
            self.pass_time(time.clamp(self.now, self.limit.max(self.now)))?;
            if self.now >= self.limit && due.is_none_or(|due| due > self.limit) {
                return Ok(RunTermination::Limit);
            }
            self.deliver()?;
            self.wake_players()?;
        }
    }

    fn pass_time(&mut self, to: Nanos) -> Result<(), HarnessError> {
        if to > self.now {
            self.at_this_instant = 0;
        }
        self.now = to;
        if let Some(stage) = &mut self.stage {
            stage.advance(to, &mut self.trace);
            if let Some(fault) = stage.fault() {
                return Err(HarnessError::World(fault));
            }
        }
        Ok(())
    }

    /// Wakes whoever asked for this time, or whose command to the world has ended: first for what ends by itself (a
    /// pause, a motion, a stimulus), then for what was awaited in vain, so that an event at the instant of a time-out
    /// still counts.
    fn wake_players(&mut self) -> Result<(), HarnessError> {
        for expire in [false, true] {
            self.expire = expire;
            for index in 0..self.players.len() {
                let due = self.players[index].next_wake().is_some_and(|t| t <= self.now);
                let done = self.stage.as_ref().is_some_and(WorldStage::has_ended_commands);
                if due || (done && plays_the_system(self.program, self.players[index].actors())) {
                    self.ask(index, |player, cx| player.wake(cx))?;
                    self.deliver()?;
                }
            }
        }
        self.expire = false;
        Ok(())
    }

    /// Lets a player act and takes what it wants to happen.
    fn ask(
        &mut self,
        index: usize,
        act: impl FnOnce(&mut dyn ActorPlayer, &mut PlayerContext<'_, 'p>) -> Result<(), HarnessError>,
    ) -> Result<(), HarnessError> {
        let mut out = Vec::new();
        let mut cx = PlayerContext {
            now: self.now,
            expire: self.expire,
            delivery: self.delivery,
            out: &mut out,
            stage: self.stage.as_mut(),
        };
        let result = act(self.players[index].as_mut(), &mut cx);
        for message in out {
            self.accept(Some(index), message)?;
        }
        result
    }

    fn accept(&mut self, from: Option<usize>, message: PlayerMessage) -> Result<(), HarnessError> {
        match message {
            PlayerMessage::Event { event, args } => {
                self.at_this_instant += 1;
                if self.at_this_instant > EVENTS_AT_AN_INSTANT {
                    let name = &self.program.event(event).name;
                    return Err(HarnessError::Model(format!(
                        "time cannot pass: more than {EVENTS_AT_AN_INSTANT} events at one instant, the last `{name}`"
                    )));
                }
                if let Some(stage) = &mut self.stage {
                    stage.sample(self.now, &mut self.trace);
                }
                let what = TraceStepKind::Event { event, args: args.clone() };
                self.trace.steps.push(TraceStep { time: self.now, what });
                let from = self.maker(from, event);
                self.pending.push_back((from, event, args));
            }
            PlayerMessage::Act { action, vars } => {
                if let Some(stage) = &mut self.stage {
                    stage.act(&action, &vars).map_err(HarnessError::World)?;
                }
            }
            PlayerMessage::Machine(step) => {
                if let Some(stage) = &mut self.stage {
                    stage.settle(self.now, &mut self.trace);
                }
                let what = TraceStepKind::Machine(Box::new(step));
                self.trace.steps.push(TraceStep { time: self.now, what });
            }
        }
        Ok(())
    }

    /// Who made the event: of players that act together, the one who plays its actor.
    fn maker(&self, asked: Option<usize>, event: EventId) -> Option<usize> {
        let actor = self.program.event(event).from;
        let asked = asked?;
        if self.players[asked].actors().contains(&actor) {
            return Some(asked);
        }
        self.players.iter().position(|p| p.actors().contains(&actor)).or(Some(asked))
    }

    /// Delivers what happened, first come first served, until nobody has anything to answer.
    fn deliver(&mut self) -> Result<(), HarnessError> {
        loop {
            self.answer_of_the_world()?;
            let Some((from, event, args)) = self.pending.pop_front() else { return Ok(()) };
            self.delivery += 1;
            if let Some(stage) = &mut self.stage {
                for message in stage.hear(event, &args) {
                    self.accept(None, message)?;
                }
            }
            for index in 0..self.players.len() {
                if Some(index) != from && self.is_heard_by(index, event) {
                    self.ask(index, |player, cx| player.hear(event, &args, cx))?;
                }
            }
        }
    }

    /// Rules of the world that were set off by commands and conditions, not by events.
    fn answer_of_the_world(&mut self) -> Result<(), HarnessError> {
        let Some(stage) = &mut self.stage else { return Ok(()) };
        for message in stage.take_answers() {
            self.accept(None, message)?;
        }
        Ok(())
    }

    fn is_heard_by(&self, index: usize, event: EventId) -> bool {
        self.players[index].actors().iter().any(|a| is_perceived(self.program, *a, event))
    }
}

fn plays_the_system(program: &Program, actors: &[ActorId]) -> bool {
    actors.iter().any(|a| program.actor(*a).role == Role::System)
}
