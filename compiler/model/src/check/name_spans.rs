//! Where the names of a scenario stand: read off the AST once all is resolved. Without errors the elements of the scenario are
//! those of the AST, in the same order, those of an instance the template's.

use std::collections::BTreeMap;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as AgentMember, AutomatonMemberKind as Member, ItemSyntaxKind, SuiteMemberKind,
};

use crate::check::state::{
    names::{DeclaredPlayer, PlayerNames},
    table::NameTable,
};
use crate::{AgentPlaces, AutomatonPlaces, AutomatonVar, Scenario, TypedAutomaton, VarPlace};

/// Completes the places of a scenario, whose items these are.
pub(in crate::check) fn complete(
    scenario: &mut Scenario,
    items: &[&ast::ItemSyntax],
    players: &PlayerNames<'_>,
    signals: &NameTable,
) {
    let (typed, places) = (&scenario.automata, &mut scenario.places);
    let shared = parts_of_each(&scenario.shared);
    for (item, span) in items.iter().map(|item| (&item.kind, item.span)) {
        if let ItemSyntaxKind::Event(event) = item {
            places.events.extend(event.names.iter().map(|one| one.name.span));
        }
        if let ItemSyntaxKind::Stimulus(stimulus) = item {
            places.events.push(stimulus.name.span);
        }
        if let ItemSyntaxKind::Var(var) = item {
            let parts = shared.get(var.name.text.as_str()).copied().unwrap_or_default();
            let place = VarPlace { name: var.name.span, whole: span };
            places.shared.extend(std::iter::repeat_n(place, parts));
        }
        if let ItemSyntaxKind::Network { name, .. } = item {
            places.networks.push(name.span);
        }
        if let ItemSyntaxKind::Suite(suite) = item {
            places.awaits.push(awaits(suite));
        }
    }
    let agents = players.agents.iter();
    places.agents = agents.map(|a| agent_places(a.syntax, a.name_span(a.syntax.name.span))).collect();
    let automata = players.automata.iter().zip(typed);
    places.automata =
        automata.map(|(a, of)| automaton_places(a.syntax, of, a.name_span(a.syntax.name.span))).collect();
    places.signals = signals.entries().filter_map(|(_, id)| signals.span(id)).collect();
}

impl<T> DeclaredPlayer<'_, T> {
    /// Where the agent or automaton gets its name.
    fn name_span(&self, plain: Span) -> Span {
        self.instance.map_or(plain, |i| i.name.span)
    }
}

fn agent_places(agent: &ast::AgentSyntax, name: Span) -> AgentPlaces {
    let mut places = AgentPlaces { name, ..AgentPlaces::default() };
    for member in &agent.members {
        if let AgentMember::Belief { name, .. } = &member.kind {
            places.beliefs.push(name.span);
        }
        if let AgentMember::Plan(plan) = &member.kind {
            places.triggers.push(plan.trigger.literal.span);
        }
    }
    places
}

fn automaton_places(automaton: &ast::AutomatonSyntax, of: &TypedAutomaton, name: Span) -> AutomatonPlaces {
    let mut places = AutomatonPlaces { name, ..AutomatonPlaces::default() };
    let vars = parts_of_each(&of.vars);
    for member in &automaton.members {
        match &member.kind {
            Member::Clock(clocks) => places.clocks.extend(clocks.iter().map(|c| c.span)),
            Member::Var(var) => {
                let parts = vars.get(var.name.text.as_str()).copied().unwrap_or_default();
                let place = VarPlace { name: var.name.span, whole: member.span };
                places.vars.extend(std::iter::repeat_n(place, parts));
            }
            Member::Location { name, .. } => places.locations.push(name.span),
            Member::Edge(edge) => places.waits.push(edge.on.as_ref().map_or(member.span, |on| on.span)),
            Member::Function(_) | Member::Allow(_) | Member::Error => {}
        }
    }
    places
}

/// Of how many single values each variable is made, by its name.
fn parts_of_each(vars: &[AutomatonVar]) -> BTreeMap<&str, usize> {
    let mut parts = BTreeMap::new();
    for var in vars {
        *parts.entry(whole_name(&var.name)).or_default() += 1;
    }
    parts
}

/// The variable that a single value is a part of: `to` of `to.x`, `a` of `a[0]`.
fn whole_name(part: &str) -> &str {
    part.split(['.', '[']).next().unwrap_or(part)
}

fn awaits(suite: &ast::SuiteSyntax) -> Vec<Span> {
    let mut spans = Vec::new();
    for member in &suite.members {
        if let SuiteMemberKind::Await(events) = &member.kind {
            spans.extend(events.iter().map(|call| call.span));
        }
    }
    spans
}
