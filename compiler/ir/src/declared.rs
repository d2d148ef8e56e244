//! What the ids of a Program stand for.
//!
//! The checker gave them, so that what they stand for is there. An id of another Program is a fault of hrdsl's own, which ends what was being
//! done and is told as an internal error: no answer is made of it.

use crate::{
    Program,
    bdi::{Agent, AgentId, BeliefDecl, BeliefId, ContentId, GoalDecl, GoalId, MessageContent, Plan},
    coverage::{CoverBin, Coverage, Coverpoint, CoverpointId},
    event::{Actor, ActorId, Event, EventId, EventPattern, Parameter, Provenance},
    expr::FunctionId,
    ta::{Automaton, AutomatonFunction, AutomatonId, Channel, ChannelId, Location, LocationId},
    world::{Signal, SignalId},
};

/// What has this number among all of its kind.
#[track_caller]
fn numbered<'a, T>(what: &str, all: &'a [T], number: u16) -> &'a T {
    all.get(usize::from(number)).unwrap_or_else(|| panic!("this program has no {what} {number}"))
}

impl Program {
    #[must_use]
    #[track_caller]
    pub fn event(&self, id: EventId) -> &Event {
        numbered("event", &self.events, id.0)
    }

    /// A pattern of events as the language writes it: `sensed(true, _)`.
    #[must_use]
    #[track_caller]
    pub fn pattern_text(&self, pattern: &EventPattern) -> String {
        let name = &self.event(pattern.event).name;
        if pattern.args.is_empty() {
            return name.clone();
        }
        let args: Vec<String> = pattern.args.iter().map(ToString::to_string).collect();
        format!("{name}({})", args.join(", "))
    }

    /// Whose word an event is.
    #[must_use]
    #[track_caller]
    pub fn provenance(&self, id: EventId) -> Provenance {
        *numbered("provenance of the event", &self.provenance, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn actor(&self, id: ActorId) -> &Actor {
        numbered("actor", &self.actors, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn agent(&self, id: AgentId) -> &Agent {
        numbered("agent", &self.agents, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn content(&self, id: ContentId) -> &MessageContent {
        numbered("subject of messages", &self.contents, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn signal(&self, id: SignalId) -> &Signal {
        numbered("signal", &self.signals, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn automaton(&self, id: AutomatonId) -> &Automaton {
        numbered("automaton", &self.automata, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn channel(&self, id: ChannelId) -> &Channel {
        numbered("channel", &self.channels, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn function(&self, id: FunctionId) -> &AutomatonFunction {
        numbered("function", &self.functions, id.0)
    }
}

impl<E> Event<E> {
    /// The parameter of an argument.
    #[must_use]
    #[track_caller]
    pub fn param(&self, number: u16) -> &Parameter {
        numbered("parameter", &self.params, number)
    }
}

impl<E> Agent<E> {
    #[must_use]
    #[track_caller]
    pub fn belief(&self, id: BeliefId) -> &BeliefDecl {
        numbered("belief", &self.beliefs, id.0)
    }

    #[must_use]
    #[track_caller]
    pub fn goal(&self, id: GoalId) -> &GoalDecl {
        numbered("goal", &self.goals, id.0)
    }

    /// The plan at this place of the library.
    #[must_use]
    #[track_caller]
    pub fn plan(&self, place: u16) -> &Plan<E> {
        numbered("plan", &self.plans, place)
    }
}

impl BeliefDecl {
    /// What [`Declared`](crate::bdi::BeliefAnnotation::Declared) annotations mean.
    #[must_use]
    #[track_caller]
    pub fn annotation(&self, number: u16) -> &Parameter {
        numbered("annotation", &self.annotations, number)
    }
}

impl<E> Plan<E> {
    /// The name of a variable.
    #[must_use]
    #[track_caller]
    pub fn variable(&self, number: u16) -> &String {
        numbered("variable", &self.vars, number)
    }
}

impl<E, V> Automaton<E, V> {
    #[must_use]
    #[track_caller]
    pub fn location(&self, id: LocationId) -> &Location<E> {
        numbered("location", &self.locations, id.0)
    }
}

impl Coverage {
    #[must_use]
    #[track_caller]
    pub fn point(&self, id: CoverpointId) -> &Coverpoint {
        numbered("coverpoint", &self.points, id.0)
    }
}

impl Coverpoint {
    #[must_use]
    #[track_caller]
    pub fn bin(&self, number: u16) -> &CoverBin {
        numbered("bin", &self.bins, number)
    }
}
