//! HR0514: channels over which nothing can happen, because one side of them has no edge. HR0107: those that have no side.

use hrdsl_ir::known_name;
use hrdsl_source::Span;
use hrdsl_source::{Diagnostic, DiagnosticCode, FileId};

use super::facts::ScenarioFacts;
use crate::{AutomatonId, Channel, ChannelId, ChannelKind, ChannelParticipant, Scenario, TypedSync};

/// The automata with edges over one channel, in order, each once.
#[derive(Default)]
struct ChannelSides {
    offer: Vec<AutomatonId>,
    accept: Vec<AutomatonId>,
    join: Vec<AutomatonId>,
}

impl ChannelSides {
    fn of(scenario: &Scenario) -> Vec<Self> {
        let mut all: Vec<Self> = scenario.channels.iter().map(|_| Self::default()).collect();
        for (id, automaton) in (0..=u16::MAX).map(AutomatonId).zip(&scenario.automata) {
            for edge in &automaton.edges {
                let Some(ChannelId(channel)) = edge.sync.channel() else { continue };
                let Some(sides) = all.get_mut(usize::from(channel)) else { continue };
                let side = match edge.sync {
                    TypedSync::Offer { .. } => &mut sides.offer,
                    TypedSync::Accept { .. } => &mut sides.accept,
                    TypedSync::Join { .. } => &mut sides.join,
                    TypedSync::Internal | TypedSync::Send { .. } | TypedSync::Receive { .. } => continue,
                };
                if side.last() != Some(&id) {
                    side.push(id);
                }
            }
        }
        all
    }

    fn is_empty(&self) -> bool {
        self.offer.is_empty() && self.accept.is_empty() && self.join.is_empty()
    }
}

pub(crate) fn check<'a>(scenario: &'a Scenario, _: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    let sides = ChannelSides::of(scenario);
    let places = scenario.places.channels.iter();
    for ((channel, place), sides) in scenario.channels.iter().zip(places).zip(&sides) {
        if place.name.file != FileId(0) {
            continue;
        }
        if sides.is_empty() {
            issues.push(unused(channel, place.name));
            continue;
        }
        match &channel.kind {
            ChannelKind::Binary | ChannelKind::Broadcast => {
                issues.extend(one_side(scenario, (channel, place.name), sides));
            }
            ChannelKind::MultiWay(participants) => {
                let named = participants.iter().zip(&place.participants);
                let absent = named.filter(|(p, _)| !sides.join.contains(&p.automaton));
                issues.extend(absent.map(|(p, at)| no_part(scenario, channel, p, *at)));
            }
        }
    }
}

fn unused(channel: &Channel, at: Span) -> Diagnostic {
    let name = &channel.name;
    let issue =
        Diagnostic::warning(DiagnosticCode::UNUSED, at, format!("the channel `{name}` is never used"))
            .help("use it, or delete it");
    // One of several that are declared together cannot simply go.
    if channel.origin == at {
        return issue;
    }
    issue.fix(format!("delete `{name}`"), channel.origin, "", true)
}

/// A binary synchronisation or broadcast that only some edges offer, only some accept, or only one automaton does both.
fn one_side(
    scenario: &Scenario,
    (channel, at): (&Channel, Span),
    sides: &ChannelSides,
) -> Option<Diagnostic> {
    let name = &channel.name;
    let (message, help) = match (sides.offer.as_slice(), sides.accept.as_slice()) {
        ([], _) => (format!("nobody offers the channel `{name}`"), format!("let an edge do so: `do {name}`")),
        (_, []) => {
            (format!("nobody accepts the channel `{name}`"), format!("let an edge do so: `on {name}`"))
        }
        ([one], [other]) if one == other => {
            let automaton =
                known_name("automaton", scenario.automata.get(usize::from(one.0)).map(|a| a.name.as_str()));
            let message = format!("only `{automaton}` offers and accepts the channel `{name}`");
            (message, "let another automaton take one of the sides: none does both at once".to_owned())
        }
        ([_, ..], [_, ..]) => return None,
    };
    Some(Diagnostic::warning(DiagnosticCode::ONE_SIDED_CHANNEL, at, message).help(help))
}

fn no_part(scenario: &Scenario, channel: &Channel, participant: &ChannelParticipant, at: Span) -> Diagnostic {
    let (name, of) = (&channel.name, usize::from(participant.automaton.0));
    let automaton = known_name("automaton", scenario.automata.get(of).map(|a| a.name.as_str()));
    let message = format!("`{automaton}` has no edge for the multi-way channel `{name}`");
    let why = if participant.optional { "it never takes part" } else { "nobody can take part without it" };
    Diagnostic::warning(DiagnosticCode::ONE_SIDED_CHANNEL, at, message)
        .here(why)
        .help(format!("give it an edge with `on {name}`, or take it out of the participants"))
}
