//! Where the names of a scenario stand, and which constants it uses: read off the AST once all is resolved. Without
//! errors the elements of the scenario are those of the AST, in the same order.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as AgentMember, AutomatonMemberKind as Member, ItemKind, SuiteMemberKind,
};

use super::Checker;
use crate::{AgentPlaces, AutomatonPlaces, Constant, VarPlace};

impl Checker<'_> {
    pub(super) fn places(&mut self) {
        for (item, span) in self.each_item() {
            match item {
                ItemKind::Event(event) => self.s.places.events.push(event.name.span),
                ItemKind::Stimulus(stimulus) => self.s.places.events.push(stimulus.name.span),
                ItemKind::Agent(agent) => self.s.places.agents.push(agent_places(agent)),
                ItemKind::Automaton(automaton) => self.s.places.automata.push(automaton_places(automaton)),
                ItemKind::Var(var) => {
                    self.s.places.shared.push(VarPlace { name: var.name.span, whole: span });
                }
                ItemKind::Network { name, .. } => self.s.places.networks.push(name.span),
                ItemKind::Suite(suite) => self.s.places.awaits.push(awaits(suite)),
                ItemKind::Const { name, .. } => {
                    let used = self.consts.get(name.text.as_str()).is_none_or(|c| c.used);
                    self.s.constants.push(Constant { name: name.text.clone(), place: name.span, span, used });
                }
                ItemKind::Use(_)
                | ItemKind::Actor { .. }
                | ItemKind::Require(_)
                | ItemKind::Assume(_)
                | ItemKind::Cover(_)
                | ItemKind::Cross(_)
                | ItemKind::Part(_)
                | ItemKind::World(_)
                | ItemKind::System(_)
                | ItemKind::Test(_)
                | ItemKind::Error => {}
            }
        }
        let signals = &self.in_world.signals;
        self.s.places.signals = signals.entries().filter_map(|(_, id)| signals.span(id)).collect();
    }
}

fn agent_places(agent: &ast::Agent) -> AgentPlaces {
    let mut places = AgentPlaces { name: agent.name.span, ..AgentPlaces::default() };
    for member in &agent.members {
        match &member.kind {
            AgentMember::Belief { name, .. } => places.beliefs.push(name.span),
            AgentMember::Plan(plan) => places.triggers.push(plan.trigger.call.span),
            AgentMember::Goal(_) | AgentMember::Error => {}
        }
    }
    places
}

fn automaton_places(automaton: &ast::Automaton) -> AutomatonPlaces {
    let mut places = AutomatonPlaces { name: automaton.name.span, ..AutomatonPlaces::default() };
    for member in &automaton.members {
        match &member.kind {
            Member::Clock(clocks) => places.clocks.extend(clocks.iter().map(|c| c.span)),
            Member::Var(var) => places.vars.push(VarPlace { name: var.name.span, whole: member.span }),
            Member::Location { name, .. } => places.locations.push(name.span),
            Member::Edge(edge) => places.waits.push(edge.on.as_ref().map_or(member.span, |on| on.span)),
            Member::Error => {}
        }
    }
    places
}

fn awaits(suite: &ast::Suite) -> Vec<Span> {
    let mut spans = Vec::new();
    for member in &suite.members {
        if let SuiteMemberKind::Await(events) = &member.kind {
            spans.extend(events.iter().map(|call| call.span));
        }
    }
    spans
}
