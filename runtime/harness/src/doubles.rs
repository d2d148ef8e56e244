//! Doubles of what is behind the harness's seams, for the tests of whatever runs on it: a world, a system and a clock that do
//! what they are told.

use std::{cell::RefCell, collections::VecDeque, rc::Rc};

use hrdsl_ir::{
    Nanos, Value,
    device::DeviceBody,
    device_state::DeviceState,
    world::{SignalId, WorldAction},
};

use crate::{
    clock::TimeSource,
    command::CheckedCommand,
    fault::SystemFault,
    system::seam::{RequestTicket, SystemActor, SystemAnswer, SystemRequest},
    world::{CommandId, WorldBackend},
};

/// A world in which signals have the values that a table says, and commands take the time that it says.
#[derive(Clone, Debug, Default)]
pub struct ToldWorld {
    /// From which time on a signal has which value; in order.
    pub signals: Vec<(Nanos, SignalId, Value)>,
    /// By device and command: how long it takes, and how it ends. Others cannot be done.
    pub commands: Vec<(&'static str, &'static str, ToldCommand)>,
    /// What devices tell of themselves from which time on: under which name, which numbers; in order.
    pub states: Vec<(Nanos, DeviceBody, DeviceState, Vec<f64>)>,
    /// What it was asked to do, each with the time.
    pub seen: Rc<RefCell<Vec<(Nanos, String)>>>,
    now: Nanos,
    under_way: Vec<(Nanos, CommandId, Result<(), String>)>,
    count: u64,
}

/// What becomes of a command.
#[derive(Clone, Debug)]
pub struct ToldCommand {
    pub takes: Nanos,
    pub ends: Result<(), String>,
}

impl ToldWorld {
    /// A world with these [signals](Self::signals) and [commands](Self::commands).
    #[must_use]
    pub fn new(
        signals: Vec<(Nanos, SignalId, Value)>,
        commands: Vec<(&'static str, &'static str, ToldCommand)>,
    ) -> Self {
        Self { signals, commands, ..Self::default() }
    }

    /// The same, with devices that tell these [states](Self::states).
    #[must_use]
    pub fn with_states(mut self, states: Vec<(Nanos, DeviceBody, DeviceState, Vec<f64>)>) -> Self {
        self.states = states;
        self
    }
}

impl WorldBackend for ToldWorld {
    fn next_wake(&self) -> Option<Nanos> {
        let ends = self.under_way.iter().map(|(end, _, _)| *end);
        let changes = self.signals.iter().map(|(time, _, _)| *time).filter(|time| *time > self.now);
        ends.chain(changes).min()
    }

    fn advance(&mut self, to: Nanos) {
        self.now = to;
    }

    fn read(&mut self, signal: SignalId) -> Value {
        let known = self.signals.iter().rev().find(|(time, of, _)| *of == signal && *time <= self.now);
        known.map_or(Value::Bool(false), |(_, _, value)| *value)
    }

    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.seen.borrow_mut().push((self.now, format!("{action:?} {vars:?}")));
        Ok(())
    }

    fn command(&mut self, command: &CheckedCommand<'_>) -> Result<CommandId, String> {
        let names = (command.device.name.as_str(), command.command.name.as_str());
        self.seen.borrow_mut().push((self.now, format!("{} {} {:?}", names.0, names.1, command.call)));
        let told = self.commands.iter().find(|(device, command, _)| (*device, *command) == names);
        let Some((_, _, told)) = told else { return Err("nobody said what becomes of it".to_owned()) };
        let id = CommandId(self.count);
        self.count += 1;
        self.under_way.push((self.now + told.takes, id, told.ends.clone()));
        Ok(id)
    }

    fn state(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        let is =
            |s: &&(Nanos, DeviceBody, DeviceState, Vec<f64>)| s.0 <= self.now && s.1 == device && s.2 == what;
        self.states.iter().rev().find(is).map(|(_, _, _, numbers)| numbers.clone())
    }

    fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)> {
        let (ended, rest): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.under_way).into_iter().partition(|(end, _, _)| *end <= self.now);
        self.under_way = rest;
        ended.into_iter().map(|(_, id, end)| (id, end)).collect()
    }
}

/// A system that makes the requests of a list.
#[derive(Clone, Debug, Default)]
pub struct ToldSystem {
    pub steps: VecDeque<ToldStep>,
    /// What it was answered: when, to which of its requests (from 0), what.
    pub answers: Rc<RefCell<Vec<(Nanos, u64, SystemAnswer)>>>,
    made: u64,
    open: Vec<RequestTicket>,
}

/// What a [`ToldSystem`] does next.
#[derive(Clone, Debug)]
pub enum ToldStep {
    /// Asks at once, whatever is still open.
    Ask(SystemRequest),
    /// Asks when everything before it was answered, as a program in lock-step does.
    Then(SystemRequest),
    /// Does what no system should.
    Fail(SystemFault),
}

impl ToldSystem {
    #[must_use]
    pub fn new(steps: Vec<ToldStep>) -> Self {
        Self { steps: steps.into(), ..Self::default() }
    }
}

impl SystemActor for ToldSystem {
    fn is_ready(&self) -> bool {
        match self.steps.front() {
            Some(ToldStep::Then(_)) => self.open.is_empty(),
            Some(ToldStep::Ask(_) | ToldStep::Fail(_)) => true,
            None => false,
        }
    }

    fn next(&mut self, _: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault> {
        let request = match self.steps.pop_front() {
            Some(ToldStep::Ask(request) | ToldStep::Then(request)) => request,
            Some(ToldStep::Fail(fault)) => return Err(fault),
            None => return Ok(None),
        };
        let ticket = RequestTicket(self.made);
        self.made += 1;
        self.open.push(ticket);
        Ok(Some((ticket, request)))
    }

    fn answer(&mut self, ticket: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault> {
        self.open.retain(|open| *open != ticket);
        self.answers.borrow_mut().push((now, ticket.0, answer));
        Ok(())
    }
}

/// An outside that stops the clock at these times, whatever is due.
#[derive(Clone, Debug, Default)]
pub struct ToldClock {
    pub stops: VecDeque<Nanos>,
}

impl TimeSource for ToldClock {
    fn advance(&mut self, now: Nanos, due: Option<Nanos>, limit: Nanos) -> Option<Nanos> {
        let due = due.unwrap_or(limit).clamp(now, limit);
        while self.stops.front().is_some_and(|stop| *stop <= now) {
            self.stops.pop_front();
        }
        Some(self.stops.front().map_or(due, |stop| due.min(*stop)))
    }
}
