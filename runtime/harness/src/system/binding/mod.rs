//! The scenario as a node of the system's middleware: it publishes what the world shows, hears what programs say, and serves what
//! they ask, as the binding says.

mod action_topics;
mod fill;
mod read;
mod rules;
mod said_topics;

use std::collections::BTreeMap;

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    binding::{GapValue, MessageTemplate, MiddlewareBinding, MiddlewareKind, TopicInput},
};

use super::{
    graph::{GraphDelivery, MessageGraph, ProgramIndex},
    seam::SystemArrival,
};
use crate::{
    player::PlayerContext,
    port::{GoalEnd, MessageText, PortDeclaration, PortKind, PortQos},
    world::CommandId,
};
use fill::{GapContext, HeardEvents};
use rules::{RuleOutcome, RuleState};

/// So many messages wait for the scenario at most; it takes each at once.
const DEPTH: usize = 1;

/// What the scenario's node does at one of its ports.
enum BoundPort {
    Input,
    /// By the place in the binding, as below.
    Output {
        output: usize,
        wildcard: Option<String>,
        state: RuleState,
    },
    Service {
        service: usize,
        state: RuleState,
    },
    Action {
        action: usize,
        state: RuleState,
    },
}

/// When a topic that the scenario publishes is due.
struct InputTimes {
    port: u64,
    /// Between two messages of no rate: when what one says is over.
    until: Option<Nanos>,
    /// When the last one went.
    sent: Option<Nanos>,
}

pub(super) struct BindingNode<'p> {
    program: &'p Program,
    binding: &'p MiddlewareBinding,
    node: ProgramIndex,
    ports: BTreeMap<u64, BoundPort>,
    inputs: Vec<InputTimes>,
    heard: HeardEvents,
    /// Goals that end with a command, by the number to answer by.
    goals: Vec<BoundGoal>,
    /// Commands whose end nobody is told of.
    unattended: Vec<CommandId>,
}

struct BoundGoal {
    command: CommandId,
    call: u64,
    action: usize,
    /// Which of the conditions the goal met on which the result depends.
    conditions: Vec<bool>,
}

/// How a goal ends, and the words that its client gets.
struct GoalEnding {
    call: u64,
    action: usize,
    end: GoalEnd,
    text: String,
    /// Which of the conditions the goal met on which the result depends.
    conditions: Vec<bool>,
}

/// Why something cannot be done, and whose fault that is.
pub(super) enum BindingFault {
    /// Of who has sent a message, who is told.
    Message(String),
    /// Of the scenario.
    Scenario(String),
}

impl BindingFault {
    pub fn text(self) -> String {
        match self {
            BindingFault::Message(why) | BindingFault::Scenario(why) => why,
        }
    }
}

impl From<String> for BindingFault {
    fn from(why: String) -> Self {
        BindingFault::Message(why)
    }
}

/// What goes to others, or why nothing does.
pub(super) type BindingOutcome = Result<Vec<GraphDelivery>, BindingFault>;

impl<'p> BindingNode<'p> {
    pub fn new(program: &'p Program, binding: &'p MiddlewareBinding, node: ProgramIndex) -> Self {
        Self {
            program,
            binding,
            node,
            ports: BTreeMap::new(),
            inputs: Vec::new(),
            heard: HeardEvents::default(),
            goals: Vec::new(),
            unattended: Vec::new(),
        }
    }

    /// Its place among the system's programs.
    pub fn node(&self) -> ProgramIndex {
        self.node
    }

    /// Opens what has a name of its own, and publishes what is latched.
    pub fn begin(&mut self, graph: &mut MessageGraph, cx: &mut PlayerContext<'_, '_>) -> BindingOutcome {
        let binding = self.binding;
        for input in &binding.inputs {
            let port =
                self.open(graph, PortKind::Publisher, &input.topic, &input.interface, input.latched)?;
            self.ports.insert(port, BoundPort::Input);
            self.inputs.push(InputTimes { port, until: None, sent: None });
        }
        for (at, output) in binding.outputs.iter().enumerate() {
            if !output.topic.contains('*') {
                self.listen(graph, at, &output.topic, None)?;
            }
        }
        for (at, service) in binding.services.iter().enumerate() {
            let port = self.open(graph, PortKind::Server, &service.service, &service.interface, false)?;
            let state = RuleState::new(&service.rules);
            self.ports.insert(port, BoundPort::Service { service: at, state });
        }
        for (at, action) in binding.actions.iter().enumerate() {
            let port = self.open(graph, PortKind::ActionServer, &action.action, &action.interface, false)?;
            let state = RuleState::new(&action.rules);
            self.ports.insert(port, BoundPort::Action { action: at, state });
        }
        let mut out = Vec::new();
        for at in 0..self.inputs.len() {
            // One that speaks of events has nothing to say before the first.
            if binding.inputs.get(at).is_some_and(|input| input.latched && !input.message.is_of_events()) {
                out.extend(self.publish(at, graph, cx)?);
            }
        }
        Ok(out)
    }

    /// A program has opened a port: if it publishes at a name with a varying part, the scenario hears it.
    pub fn opened(&mut self, declared: &PortDeclaration, graph: &mut MessageGraph) -> BindingOutcome {
        if declared.kind != PortKind::Publisher {
            return Ok(Vec::new());
        }
        let binding = self.binding;
        let mut out = Vec::new();
        for (at, output) in binding.outputs.iter().enumerate() {
            let Some(part) = rules::wildcard(&output.topic, &declared.name) else { continue };
            let is_heard = self.ports.values().any(|port| {
                matches!(port, BoundPort::Output { output, wildcard: Some(known), .. }
                    if *output == at && *known == part)
            });
            if !is_heard && rules::knows(&output.rules, &part) {
                out.extend(self.listen(graph, at, &declared.name, Some(part))?);
            }
        }
        Ok(out)
    }

    /// Why a program must not open this port, if there is a reason in the middleware.
    pub fn refuses(&self, declared: &PortDeclaration, graph: &MessageGraph) -> Result<(), String> {
        said_topics::refuse(declared, self.binding)?;
        match self.binding.kind {
            MiddlewareKind::Ros1 => action_topics::refuse(declared, graph),
            MiddlewareKind::Ros2 => Ok(()),
        }
    }

    fn listen(
        &mut self,
        graph: &mut MessageGraph,
        output: usize,
        topic: &str,
        wildcard: Option<String>,
    ) -> BindingOutcome {
        let Some(bound) = self.binding.outputs.get(output) else { return Ok(Vec::new()) };
        let port = self.ports.len() as u64;
        let state = RuleState::new(&bound.rules);
        let declared = declaration(port, PortKind::Subscriber, topic, &bound.interface, false);
        let out = graph.open(self.node, declared)?;
        self.ports.insert(port, BoundPort::Output { output, wildcard, state });
        Ok(out)
    }

    fn open(
        &mut self,
        graph: &mut MessageGraph,
        kind: PortKind,
        name: &str,
        interface: &str,
        latched: bool,
    ) -> Result<u64, String> {
        let port = self.ports.len() as u64;
        // Nobody else is there yet.
        graph.open(self.node, declaration(port, kind, name, interface, latched))?;
        Ok(port)
    }

    // ── what the programs hear ──

    /// When the next message is due, of those that somebody hears.
    pub fn next_wake(&self, now: Nanos, graph: &MessageGraph) -> Option<Nanos> {
        let due = |(times, input): (&InputTimes, &'p TopicInput)| {
            let hears = graph.has_subscriber(self.node, times.port);
            let periodic =
                input.period.filter(|_| hears).map(|period| said_topics::next_after(now, times.sent, period));
            periodic.into_iter().chain(times.until).min()
        };
        self.inputs.iter().zip(&self.binding.inputs).filter_map(due).min()
    }

    /// Publishes what is due; ends the goals whose commands have ended.
    pub fn wake(&mut self, graph: &mut MessageGraph, cx: &mut PlayerContext<'_, '_>) -> BindingOutcome {
        let binding = self.binding;
        let mut out = self.ended_goals(graph, cx)?;
        for (at, input) in binding.inputs.iter().enumerate() {
            let Some(times) = self.inputs.get(at) else { continue };
            let hears = graph.has_subscriber(self.node, times.port);
            let is_fresh = times.sent != Some(cx.now) && cx.now > 0;
            let on_grid = input.period.is_some_and(|period| hears && is_fresh && cx.now % period.max(1) == 0);
            if on_grid || times.until.is_some_and(|until| until <= cx.now) {
                out.extend(self.publish(at, graph, cx)?);
            }
        }
        Ok(out)
    }

    /// An event that the actor hears.
    pub fn hear(
        &mut self,
        event: EventId,
        args: &[Value],
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let binding = self.binding;
        self.heard.add(event, args, cx.now);
        let mut out = Vec::new();
        for (at, input) in binding.inputs.iter().enumerate() {
            let speaks = |value: &&GapValue| value.is_set_by(event, args);
            let is_said = input.message.leaves().iter().any(speaks);
            if is_said && input.period.is_none() {
                out.extend(self.publish(at, graph, cx)?);
            }
        }
        Ok(out)
    }

    fn publish(
        &mut self,
        at: usize,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let Some(input) = self.binding.inputs.get(at) else { return Ok(Vec::new()) };
        let Some(times) = self.inputs.get(at) else { return Ok(Vec::new()) };
        let port = times.port;
        let until = match input.period {
            None => held_until(&input.message, &self.heard, cx.now),
            Some(_) => None,
        };
        let message = self.filled(&input.message, ("topic", &input.topic), &[], cx)?;
        if let Some(times) = self.inputs.get_mut(at) {
            (times.sent, times.until) = (Some(cx.now), until);
        }
        Ok(graph.publish(self.node, port, &message)?)
    }

    /// A message of the scenario, at a name of this sort.
    fn filled(
        &self,
        template: &MessageTemplate,
        (sort, name): (&str, &str),
        conditions: &[bool],
        cx: &mut PlayerContext<'_, '_>,
    ) -> Result<MessageText, BindingFault> {
        let (kind, heard, stage) = (self.binding.kind, &self.heard, cx.stage.as_deref_mut());
        let mut context = GapContext { kind, heard, now: cx.now, stamp: None, conditions, stage };
        context.filled(template).map_err(|why| BindingFault::Scenario(format!("the {sort} `{name}`: {why}")))
    }

    // ── what they say ──

    /// Something has arrived for the scenario.
    ///
    /// # Errors
    /// What makes no sense about it: whoever sent it is told.
    pub fn take(
        &mut self,
        arrival: SystemArrival,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        match arrival {
            SystemArrival::Message { port, message } => {
                self.message(port, &message, cx)?;
                Ok(Vec::new())
            }
            SystemArrival::Called { port, call, message } => self.called(port, call, &message, graph, cx),
            SystemArrival::Canceled { call, .. } => self.canceled(call, graph, cx),
            SystemArrival::Event { .. }
            | SystemArrival::Ended { .. }
            | SystemArrival::Incompatible { .. }
            | SystemArrival::Answered { .. }
            | SystemArrival::Accepted { .. }
            | SystemArrival::Feedback { .. }
            | SystemArrival::CancelAnswered { .. }
            | SystemArrival::Finished { .. }
            | SystemArrival::Changed => Ok(Vec::new()),
        }
    }

    fn message(&mut self, port: u64, text: &str, cx: &mut PlayerContext<'_, '_>) -> Result<(), String> {
        let (program, binding) = (self.program, self.binding);
        let Some(BoundPort::Output { output, wildcard, state }) = self.ports.get_mut(&port) else {
            return Ok(());
        };
        let Some(bound) = binding.outputs.get(*output) else { return Ok(()) };
        let message = read::parse(text)?;
        let done = rules::carry_out(program, &bound.rules, (&message, wildcard.as_deref()), state, cx)?;
        self.unattended.extend(done.commands);
        Ok(())
    }

    fn called(
        &mut self,
        port: u64,
        call: u64,
        text: &str,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let (program, binding, node) = (self.program, self.binding, self.node);
        let message = match read::parse(text) {
            Ok(message) => message,
            Err(why) => return Ok(graph.respond(node, call, Err(why))?),
        };
        match self.ports.get_mut(&port) {
            Some(BoundPort::Service { service, state }) => {
                let Some(bound) = binding.services.get(*service) else { return Ok(Vec::new()) };
                let done = rules::carry_out(program, &bound.rules, (&message, None), state, cx);
                let answer = match done {
                    Ok(done) => {
                        self.unattended.extend(done.commands);
                        let at = ("service", bound.service.as_str());
                        Ok(self.filled(&bound.response, at, &done.conditions, cx)?)
                    }
                    Err(why) => Err(why),
                };
                Ok(graph.respond(node, call, answer)?)
            }
            Some(BoundPort::Action { action, state }) => {
                let action = *action;
                let Some(bound) = binding.actions.get(action) else { return Ok(Vec::new()) };
                let done = rules::carry_out(program, &bound.rules, (&message, None), state, cx);
                self.begun_goal(call, action, done, graph, cx)
            }
            Some(BoundPort::Input | BoundPort::Output { .. }) | None => Ok(Vec::new()),
        }
    }

    /// A goal whose rules were carried out: rejected, accepted and under way, or accepted and ended at once.
    fn begun_goal(
        &mut self,
        call: u64,
        action: usize,
        done: Result<RuleOutcome, String>,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let ending = |end, text, conditions| GoalEnding { call, action, end, text, conditions };
        let done = match done {
            Ok(done) if done.rules > 0 => done,
            Ok(done) => {
                let why = "no rule of the scenario fits the goal".to_owned();
                return self.finish(ending(GoalEnd::Rejected, why, done.conditions), graph, cx);
            }
            Err(why) => return self.finish(ending(GoalEnd::Rejected, why, Vec::new()), graph, cx),
        };
        let before = done.commands.len().saturating_sub(1);
        self.unattended.extend(done.commands.iter().take(before));
        let mut out = graph.accept(self.node, call, String::new())?;
        let conditions = done.conditions;
        let ending = match (done.commands.last(), done.failed) {
            (Some(command), _) => {
                self.goals.push(BoundGoal { command: *command, call, action, conditions });
                return Ok(out);
            }
            (None, Some(why)) => ending(GoalEnd::Aborted, why, conditions),
            (None, None) => ending(GoalEnd::Succeeded, String::new(), conditions),
        };
        out.extend(self.finish(ending, graph, cx)?);
        Ok(out)
    }

    fn finish(
        &self,
        ending: GoalEnding,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let GoalEnding { call, action, end, text, conditions } = ending;
        let Some(bound) = self.binding.actions.get(action) else { return Ok(Vec::new()) };
        let result = self.filled(&bound.result, ("action", &bound.action), &conditions, cx)?;
        Ok(graph.finish(self.node, call, end, (result, text))?)
    }

    fn ended_goals(&mut self, graph: &mut MessageGraph, cx: &mut PlayerContext<'_, '_>) -> BindingOutcome {
        let mut out = Vec::new();
        if let Some(stage) = cx.stage.as_deref_mut() {
            self.unattended.retain(|id| stage.take_ended(*id).is_none());
        }
        for goal in std::mem::take(&mut self.goals) {
            let ended = cx.stage.as_deref_mut().and_then(|stage| stage.take_ended(goal.command));
            match ended {
                Some(how) => {
                    let (end, text) = match how {
                        Ok(()) => (GoalEnd::Succeeded, String::new()),
                        Err(why) => (GoalEnd::Aborted, why),
                    };
                    let BoundGoal { call, action, conditions, .. } = goal;
                    let ending = GoalEnding { call, action, end, text, conditions };
                    out.extend(self.finish(ending, graph, cx)?);
                }
                None => self.goals.push(goal),
            }
        }
        Ok(out)
    }

    /// A goal that is canceled ends at once; its device is stopped, if it knows how to.
    fn canceled(
        &mut self,
        call: u64,
        graph: &mut MessageGraph,
        cx: &mut PlayerContext<'_, '_>,
    ) -> BindingOutcome {
        let Some(at) = self.goals.iter().position(|goal| goal.call == call) else {
            return Ok(Vec::new());
        };
        let goal = self.goals.remove(at);
        if let (Some(bound), Some(stage)) = (self.binding.actions.get(goal.action), cx.stage.as_deref_mut()) {
            rules::stop_devices(self.program, &bound.rules, stage);
        }
        let mut out = graph.answer_cancel(self.node, call, true, String::new())?;
        let (end, text) = (GoalEnd::Canceled, String::new());
        let BoundGoal { action, conditions, .. } = goal;
        out.extend(self.finish(GoalEnding { call, action, end, text, conditions }, graph, cx)?);
        Ok(out)
    }

    /// What a transition of a program's state machine makes happen.
    pub fn transition(&self, from: &str, to: &str) -> impl Iterator<Item = (EventId, Vec<Value>)> {
        let rules = self.binding.transitions.iter().filter(move |r| r.from == from && r.to == to);
        rules.map(|r| (r.event, r.args.clone())).collect::<Vec<_>>().into_iter()
    }
}

fn declaration(port: u64, kind: PortKind, name: &str, interface: &str, latched: bool) -> PortDeclaration {
    let (name, type_name) = (name.to_owned(), interface.to_owned());
    let (kept, qos) = (usize::from(latched), PortQos::default());
    PortDeclaration { port, kind, name, type_name, kept, depth: DEPTH, qos }
}

/// When the first of what holds is over.
fn held_until(message: &MessageTemplate, heard: &HeardEvents, now: Nanos) -> Option<Nanos> {
    let held = message.leaves().into_iter().filter_map(GapValue::as_held).filter(|(_, time)| *time > 0);
    let ends = held.filter_map(|(events, time)| Some(heard.last_of(events)?.saturating_add(time)));
    ends.filter(|end| *end > now).min()
}
