//! What is unreachable only because a `hold` takes no time in automata.
//!
//! The events of a stimulus are sent one after the other through committed locations, whatever is held between them. What is
//! proved unreachable is searched once more in a network in which time may pass there, as long as it likes. If it is reached
//! then, the holds are the cause, and the run shows which, and how far the network comes without.

use std::collections::BTreeSet;

use hrdsl_ir::{
    EventId, Program,
    event::StimulusStep,
    expr::Expr,
    ta::{Automaton, AutomatonId, Edge, Location, LocationId, LocationKind, Network, SyncLabel},
};
use hrdsl_ta::WitnessRun;

use super::{observer::number, settings::ProofOptions};

/// A program in which the holds of a network's stimuli take time.
pub struct TimedHolds {
    pub program: Program,
    places: Vec<HoldLocation>,
    /// By member of the network, with where it starts.
    members: Vec<(AutomatonId, LocationId)>,
}

/// A location that stands for a hold.
struct HoldLocation {
    member: usize,
    location: LocationId,
    stimulus: EventId,
}

impl TimedHolds {
    /// `None`: holds keep nothing back in this network.
    pub fn of(program: &Program, network: &Network) -> Option<Self> {
        let mut held = Self { program: program.clone(), places: Vec::new(), members: Vec::new() };
        for (member, id) in network.automata.iter().enumerate() {
            let automaton = held.program.automata.get_mut(usize::from(id.0))?;
            held.members.push((*id, automaton.initial));
            for first in 0..automaton.edges.len() {
                let SyncLabel::Send { event: stimulus, .. } = automaton.edges[first].sync else { continue };
                let Some(body) = &program.events.get(usize::from(stimulus.0))?.stimulus else { continue };
                let locations = let_pass(automaton, first, &HoldSites::of(&body.steps));
                held.places.extend(locations.into_iter().map(|location| HoldLocation {
                    member,
                    location,
                    stimulus,
                }));
            }
        }
        (!held.places.is_empty()).then_some(held)
    }

    /// The search for what was not found among so many states: it must not cost much more than the proof did.
    pub fn settings(settings: &ProofOptions, states: usize) -> ProofOptions {
        let mut settings = *settings;
        settings.budget.states = settings.budget.states.min(states.saturating_mul(4).saturating_add(1000));
        settings
    }

    /// What a run of this program, in which the holds take time, says about the network in which they take none.
    pub fn because(&self, run: &WitnessRun) -> Option<String> {
        let mut at: Vec<LocationId> = self.members.iter().map(|m| m.1).collect();
        let mut now = 0;
        for step in &run.steps {
            let holding: Vec<&HoldLocation> =
                self.places.iter().filter(|p| at[p.member] == p.location).collect();
            let goes_on = step.moves.iter().any(|m| holding.iter().any(|p| p.member == m.automaton));
            if !holding.is_empty() && (step.time > now || !goes_on) {
                return Some(self.told(&holding, &at));
            }
            now = step.time;
            for (member, _, to) in &step.locations {
                // Observers have no holds.
                if let Some(at) = at.get_mut(*member) {
                    *at = *to;
                }
            }
        }
        None
    }

    fn told(&self, holding: &[&HoldLocation], at: &[LocationId]) -> String {
        let stimulus = |p: &HoldLocation| format!("`{}`", self.program.event(p.stimulus).name);
        let stimuli: BTreeSet<String> = holding.iter().map(|p| stimulus(p)).collect();
        let stimuli: Vec<String> = stimuli.into_iter().collect();
        let place = |(member, here): (usize, &LocationId)| {
            let automaton = self.program.automaton(self.members[member].0);
            let name = &automaton.name;
            match holding.iter().find(|p| p.member == member) {
                Some(p) => format!("{name} doing {}", stimulus(p)),
                None => format!("{name} in `{}`", automaton.location(*here).name),
            }
        };
        let nearest: Vec<String> = at.iter().enumerate().map(place).collect();
        format!(
            "a `hold` takes no time in automata: it would be reached if the holds of {} did; without that, the nearest is {}",
            stimuli.join(" and "),
            nearest.join(", ")
        )
    }
}

/// Where the body of a stimulus holds.
#[derive(Default)]
struct HoldSites {
    /// The events that are emitted after a hold.
    before: BTreeSet<EventId>,
    /// It holds after the last of them.
    last: bool,
}

impl HoldSites {
    fn of(steps: &[StimulusStep]) -> Self {
        let mut holds = Self::default();
        holds.walk(steps);
        holds
    }

    fn walk(&mut self, steps: &[StimulusStep]) {
        for step in steps {
            match step {
                StimulusStep::Emit { event, .. } => {
                    if std::mem::take(&mut self.last) {
                        self.before.insert(*event);
                    }
                }
                StimulusStep::Hold { seconds: Expr::Const(time) } => {
                    self.last |= time.as_f64().is_some_and(|t| t > 0.0);
                }
                StimulusStep::Hold { .. } => self.last = true,
                StimulusStep::If { then, otherwise, .. } => {
                    let held = self.last;
                    self.walk(then);
                    let after = std::mem::replace(&mut self.last, held);
                    self.walk(otherwise);
                    self.last |= after;
                }
                StimulusStep::Act(_) => {}
            }
        }
    }
}

/// Lets time pass where the stimulus of this edge holds: the locations that now stand for it.
fn let_pass(automaton: &mut Automaton, first: usize, holds: &HoldSites) -> Vec<LocationId> {
    let mut places = Vec::new();
    let mut ends = vec![first];
    let mut here = automaton.edges[first].to;
    while is_generated(automaton, here) {
        let out = |e: &usize| automaton.edges[*e].from == here;
        ends = (0..automaton.edges.len()).filter(out).collect();
        let sent = |e: &usize| automaton.edges[*e].sync.as_send();
        let waits = ends.iter().filter_map(sent).any(|(event, _)| holds.before.contains(&event));
        if waits {
            automaton.locations[usize::from(here.0)].kind = LocationKind::Normal;
            places.push(here);
        }
        let Some(next) = ends.first().map(|e| automaton.edges[*e].to) else { return places };
        here = next;
    }
    // Where time can pass anyway, the model says for itself how long it stays after the last event.
    if holds.last && automaton.locations[usize::from(here.0)].kind != LocationKind::Normal {
        places.push(stop_before(automaton, &ends, here));
    }
    places
}

/// A new location in which time can pass, between the ends of these edges and where they lead.
fn stop_before(automaton: &mut Automaton, ends: &[usize], target: LocationId) -> LocationId {
    let new = LocationId(number(automaton.locations.len()));
    let origin = automaton.edges[ends[0]].origin;
    automaton.locations.push(Location {
        name: format!("~{}", automaton.locations.len()),
        kind: LocationKind::Normal,
        invariant: Vec::new(),
        holds: None,
        stopped: Vec::new(),
        origin,
    });
    for end in ends {
        automaton.edges[*end].to = new;
    }
    automaton.edges.push(Edge {
        from: new,
        to: target,
        selects: Vec::new(),
        clock_guard: Vec::new(),
        guard: None,
        sync: SyncLabel::Internal,
        updates: Vec::new(),
        origin,
    });
    new
}

/// The compiler's own locations have a `~` in their name.
fn is_generated(automaton: &Automaton, location: LocationId) -> bool {
    automaton.locations.get(usize::from(location.0)).is_some_and(|l| l.name.contains('~'))
}
