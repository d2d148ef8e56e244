//! Events and state machines of a recording.

use hrdsl_ir::{Event, EventId, Program, Provenance, Role};
use hrdsl_recording::message::{RecordedTopic, TopicPart};
use hrdsl_trace::{MachineStep, TraceStepKind, print};

use super::run::{ReplayedRun, tick};
use crate::{
    columns::differences,
    document::{EventKind, MachineTrack, MessageRole, TopicDirection, TopicTrack, ViewEvent},
};

pub(super) fn events(run: &ReplayedRun<'_>) -> Vec<ViewEvent> {
    let mut events = Vec::new();
    for (at, step) in run.trace.steps.iter().enumerate() {
        let TraceStepKind::Event { event, args } = &step.what else { continue };
        let declared = run.program.event(*event);
        let text = print::event_text(run.program, *event, args);
        let args = text
            .strip_prefix(&declared.name)
            .map(|args| args.trim_start_matches('(').strip_suffix(')').unwrap_or_default().to_owned());
        events.push(ViewEvent {
            t: tick(step.time),
            until: None,
            name: declared.name.clone(),
            actor: Some(run.program.actor(declared.from).name.clone()),
            kind: kind(run.program, *event, declared),
            args: args.filter(|args| !args.is_empty()),
            step: Some(at as u64),
        });
    }
    events
}

/// What was sent through names of the middleware.
pub(super) fn topics(run: &ReplayedRun<'_>) -> Vec<TopicTrack> {
    let track = |topic: &RecordedTopic| TopicTrack {
        name: topic.name.clone(),
        interface: (!topic.interface.is_empty()).then(|| topic.interface.clone()),
        direction: if topic.outward { TopicDirection::Out } else { TopicDirection::In },
        role: match topic.part {
            TopicPart::Message => None,
            TopicPart::Request => Some(MessageRole::Request),
            TopicPart::Answer => Some(MessageRole::Answer),
            TopicPart::Feedback => Some(MessageRole::Feedback),
        },
        t: differences(topic.times.iter().map(|time| tick(*time).cast_signed())),
        text: topic.texts.clone(),
    };
    run.file.topics.iter().map(track).collect()
}

fn kind(program: &Program, id: EventId, event: &Event) -> EventKind {
    if event.is_stimulus() {
        return EventKind::Stimulus;
    }
    match program.provenance(id) {
        Provenance::Commanded => EventKind::Commanded,
        Provenance::Seen => EventKind::Seen,
        Provenance::Said | Provenance::Played => EventKind::Said,
    }
}

/// What is known of one machine so far.
struct MachineSoFar {
    name: String,
    states: Vec<String>,
    times: Vec<i64>,
    state: Vec<i64>,
    outcome: Vec<Option<String>>,
}

impl MachineSoFar {
    fn comes_to(&mut self, time: u64, state: &str, outcome: Option<String>) {
        let known = self.states.iter().position(|known| known == state);
        let at = known.unwrap_or_else(|| {
            self.states.push(state.to_owned());
            self.states.len() - 1
        });
        self.times.push(time as i64);
        self.state.push(at as i64);
        self.outcome.push(outcome);
    }
}

pub(super) fn machines(run: &ReplayedRun<'_>) -> Vec<MachineTrack> {
    let mut machines: Vec<MachineSoFar> = Vec::new();
    for step in &run.trace.steps {
        let TraceStepKind::Machine(what) = &step.what else { continue };
        let name = match what.as_ref() {
            MachineStep::Declared(declared) => &declared.machine,
            MachineStep::Begun { machine, .. } | MachineStep::Moved { machine, .. } => machine,
        };
        let at = machines.iter().position(|known| known.name == *name).unwrap_or_else(|| {
            let (states, times, state, outcome) = Default::default();
            machines.push(MachineSoFar { name: name.clone(), states, times, state, outcome });
            machines.len() - 1
        });
        let Some(machine) = machines.get_mut(at) else { continue };
        match what.as_ref() {
            MachineStep::Declared(declared) => {
                machine.states = declared.states.iter().chain(&declared.outcomes).cloned().collect();
            }
            MachineStep::Begun { state, .. } => machine.comes_to(tick(step.time), state, None),
            MachineStep::Moved { edge, .. } => {
                machine.comes_to(tick(step.time), &edge.to, Some(edge.outcome.clone()));
            }
        }
    }
    let system = run.program.actors.iter().find(|actor| actor.role == Role::System);
    let track = |machine: MachineSoFar| MachineTrack {
        name: machine.name,
        actor: system.map(|actor| actor.name.clone()),
        states: machine.states,
        t: differences(machine.times),
        state: machine.state,
        outcome: machine.outcome,
    };
    machines.into_iter().filter(|machine| !machine.times.is_empty()).map(track).collect()
}
