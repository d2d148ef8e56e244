//! One discrete-event loop in virtual, simulated or outside time: who plays whom, and who hears what.
//!
//! Players (agents, automata, a test script, the system under test) are asked in a fixed order; none sees another.
//! The [`Stage`], when present, holds the world: it plays the actors that no player plays. Everything that happens is
//! recorded in a [`Trace`].
//!
//! # Seams
//! What the loop does not do itself is behind three traits, each with a [double](doubles) for tests:
//! - a [`World`] holds the bodies, and says when it next changes by itself;
//! - a [`System`] plays the system actor: it asks, and is answered, by a [`SystemPlayer`];
//! - a [`Clock`] lets time pass: at once, or as the outside wants.

mod clock;
pub mod doubles;
mod script;
mod stage;
mod stimulus;
mod system;
mod system_player;
mod world;

use std::collections::VecDeque;

use hrdsl_ir::{ActorId, EventId, Nanos, Program, Role, Value, world::WorldAction};
use hrdsl_trace::{Step, Trace, What};

pub use clock::{Clock, VirtualClock};
pub use script::ScriptPlayer;
pub use stage::Stage;
pub use stimulus::{Performance, draw_samples};
pub use system::{System, SystemAnswer, SystemArgument, SystemFault, SystemFaultKind, SystemRequest, Ticket};
pub use system_player::SystemPlayer;
pub use world::{Begun, DeviceOrder, OrderError, OrderId, World};

/// At most so many events at one instant: more is a model in which time cannot pass.
const EVENTS_AT_AN_INSTANT: usize = 10_000;

/// What a player wants to happen now.
#[derive(Clone, Debug)]
pub enum Message {
    /// An event or stimulus of the player's actor happens.
    Event { event: EventId, args: Vec<Value> },
    /// The world changes; `vars` are the values of the action's variables.
    Act { action: WorldAction, vars: Vec<Value> },
}

/// What a player is given when it is asked.
pub struct Context<'a, 'p> {
    pub now: Nanos,
    /// Waits for events may be given up now: nothing else happens any more at this instant by itself.
    pub expire: bool,
    /// Counts the events delivered; players that are told together know by it that it is the same event.
    pub delivery: u64,
    pub out: &'a mut Vec<Message>,
    /// The world, if there is one: only the program under test and the sensors reach for it.
    pub stage: Option<&'a mut Stage<'p>>,
}

/// Anything that plays actors.
pub trait Player {
    /// The actors it plays; it hears what any of them hears.
    fn actors(&self) -> &[ActorId];
    /// The run begins, or the time it asked for has come.
    ///
    /// # Errors
    /// What ends the run.
    fn wake(&mut self, cx: &mut Context<'_, '_>) -> Result<(), Fault>;
    /// An event addressed to its actor happened.
    ///
    /// # Errors
    /// What ends the run.
    fn hear(&mut self, event: EventId, args: &[Value], cx: &mut Context<'_, '_>) -> Result<(), Fault>;
    /// When it next wants to be woken.
    fn next_wake(&self) -> Option<Nanos>;
    /// It will do nothing more, whatever happens.
    fn is_finished(&self) -> bool;
}

/// Why a run could not go on.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Fault {
    #[error("{0}")]
    Model(String),
    #[error("{0}")]
    World(String),
    #[error("{0}")]
    System(SystemFault),
}

/// How a run ended.
#[derive(Clone, Debug)]
pub enum Ended {
    /// Every player is finished, or nobody waits for anything that could still come.
    Quiet,
    /// The time limit was reached.
    Limit,
    Fault(Fault),
}

/// The outcome of a run.
pub struct Run {
    pub trace: Trace,
    pub ended: Ended,
}

/// The loop's state.
pub struct Harness<'p> {
    program: &'p Program,
    players: Vec<Box<dyn Player + 'p>>,
    stage: Option<Stage<'p>>,
    clock: Box<dyn Clock + 'p>,
    limit: Nanos,
    now: Nanos,
    trace: Trace,
    /// Events that happened and are not yet delivered, with the player that made them.
    pending: VecDeque<(Option<usize>, EventId, Vec<Value>)>,
    at_this_instant: usize,
    expire: bool,
    delivery: u64,
}

impl<'p> Harness<'p> {
    /// Players are asked in a fixed order: the system's first, so that what it does at an instant is known to those whose
    /// wait for it ends at the same instant; then in the order given. The run ends at `limit` at the latest.
    #[must_use]
    pub fn new(
        program: &'p Program,
        mut players: Vec<Box<dyn Player + 'p>>,
        stage: Option<Stage<'p>>,
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
    pub fn with_clock(self, clock: Box<dyn Clock + 'p>) -> Self {
        Self { clock, ..self }
    }

    /// Runs to the end.
    #[must_use]
    pub fn run(mut self) -> Run {
        let ended = self.run_loop().unwrap_or_else(Ended::Fault);
        if let Some(stage) = &mut self.stage {
            stage.sample(self.now, &mut self.trace);
        }
        self.trace.end = self.now;
        Run { trace: self.trace, ended }
    }

    fn run_loop(&mut self) -> Result<Ended, Fault> {
        if let Some(stage) = &mut self.stage {
            stage.sample(0, &mut self.trace);
        }
        for index in 0..self.players.len() {
            self.ask(index, |player, cx| player.wake(cx))?;
        }
        self.deliver()?;
        loop {
            if self.players.iter().all(|p| p.is_finished()) {
                return Ok(Ended::Quiet);
            }
            let next = self.players.iter().filter_map(|p| p.next_wake());
            let due = next.chain(self.stage.as_ref().and_then(Stage::next_wake)).min();
            let Some(time) = self.clock.advance(self.now, due, self.limit) else {
                return Ok(Ended::Quiet);
            };
            self.pass_time(time.clamp(self.now, self.limit.max(self.now)));
            if self.now >= self.limit && due.is_none_or(|due| due > self.limit) {
                return Ok(Ended::Limit);
            }
            self.wake_players()?;
        }
    }

    fn pass_time(&mut self, to: Nanos) {
        if to > self.now {
            self.at_this_instant = 0;
        }
        self.now = to;
        if let Some(stage) = &mut self.stage {
            stage.advance(to, &mut self.trace);
        }
    }

    /// Wakes whoever asked for this time, or whose command to the world has ended: first for what ends by itself (a
    /// pause, a motion, a stimulus), then for what was awaited in vain, so that an event at the instant of a time-out
    /// still counts.
    fn wake_players(&mut self) -> Result<(), Fault> {
        for expire in [false, true] {
            self.expire = expire;
            for index in 0..self.players.len() {
                let due = self.players[index].next_wake().is_some_and(|t| t <= self.now);
                let done = self.stage.as_ref().is_some_and(Stage::has_ended_orders);
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
        act: impl FnOnce(&mut dyn Player, &mut Context<'_, 'p>) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut out = Vec::new();
        let mut cx = Context {
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

    fn accept(&mut self, from: Option<usize>, message: Message) -> Result<(), Fault> {
        match message {
            Message::Event { event, args } => {
                self.at_this_instant += 1;
                if self.at_this_instant > EVENTS_AT_AN_INSTANT {
                    let name = &self.program.event(event).name;
                    return Err(Fault::Model(format!(
                        "time cannot pass: more than {EVENTS_AT_AN_INSTANT} events at one instant, the last `{name}`"
                    )));
                }
                if let Some(stage) = &mut self.stage {
                    stage.sample(self.now, &mut self.trace);
                }
                let what = What::Event { event, args: args.clone() };
                self.trace.steps.push(Step { time: self.now, what });
                let from = self.maker(from, event);
                self.pending.push_back((from, event, args));
            }
            Message::Act { action, vars } => {
                if let Some(stage) = &mut self.stage {
                    stage.act(&action, &vars).map_err(Fault::World)?;
                }
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
    fn deliver(&mut self) -> Result<(), Fault> {
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

    /// Rules of the world that were set off by commands, not by events.
    fn answer_of_the_world(&mut self) -> Result<(), Fault> {
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

/// Whether an actor perceives an event: stimuli reach the environment only; what is addressed to nobody in particular
/// reaches everybody.
#[must_use]
pub fn is_perceived(program: &Program, actor: ActorId, event: EventId) -> bool {
    let e = program.event(event);
    if e.is_stimulus() {
        program.actor(actor).role == Role::Environment
    } else {
        e.to.is_empty() || e.from == actor || e.to.contains(&actor)
    }
}
