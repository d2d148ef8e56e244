//! Where a network compares clocks with times, and what its environment may do there.

use std::{collections::BTreeSet, ops::Range};

use hrdsl_ir::{
    EventId, Nanos, Program, Role, Value,
    event::StimulusStep,
    ta::{
        Automaton, ClockConstraint, ClockId, Edge, LocationId, LocationKind, Network, QueryFormula,
        SyncLabel, TimeSum,
    },
};

use crate::{
    named::is_generated,
    slots::{NetworkNumbers, clock_name},
    write,
};

/// More values of one edge's selects are not gone through.
const MOST_SELECTED: usize = 256;

/// An edge by which the environment does a stimulus.
#[derive(Clone)]
pub struct StimulusEdge {
    pub member: usize,
    pub edge: usize,
    /// It can be taken now, as far as its automaton is concerned.
    pub enabled: QueryFormula,
    from: LocationId,
    /// The stimulus, and the events that it may make.
    makes: BTreeSet<EventId>,
}

/// A comparison of a clock with a time, where an automaton is.
pub struct BoundSite {
    /// In the network.
    pub member: u16,
    pub location: LocationId,
    /// Of the network.
    pub clock: ClockId,
    pub time: TimeSum,
    /// `Robot.asked: x = 3 s`
    pub name: String,
    /// What may be done there: what the automaton waits for in this location, if that is anything; otherwise all.
    pub stimuli: Vec<StimulusEdge>,
    /// The automaton waits for something that a stimulus makes, or makes one itself.
    pub is_heard: bool,
    /// Edges by which the location is left at the bound exactly, whatever the environment does.
    pub leaving: Vec<usize>,
}

impl BoundSite {
    /// A clock is never less than zero.
    pub fn can_be(&self, shift: Nanos) -> bool {
        self.time.fixed().is_none_or(|nanos| nanos + shift >= 0)
    }
}

/// All edges by which the environment does something.
pub fn stimuli(program: &Program, network: &Network) -> Vec<StimulusEdge> {
    let numbers = NetworkNumbers::of(program, network);
    let mut all = Vec::new();
    for (member, id) in network.automata.iter().enumerate() {
        let automaton = program.automaton(*id);
        if automaton.actor.is_none_or(|actor| program.actor(actor).role != Role::Environment) {
            continue;
        }
        for (at, edge) in automaton.edges.iter().enumerate() {
            let SyncLabel::Send { event, .. } = edge.sync else { continue };
            if !program.event(event).is_stimulus() {
                continue;
            }
            if let Some(enabled) = enabled(program, network, &numbers, member, edge) {
                all.push(StimulusEdge {
                    member,
                    edge: at,
                    enabled,
                    from: edge.from,
                    makes: made(program, event),
                });
            }
        }
    }
    all
}

/// The edge can be taken: its automaton is there, its guards hold, and nobody else has to go first. `None`: that is not known.
fn enabled(
    program: &Program,
    network: &Network,
    numbers: &NetworkNumbers,
    member: usize,
    edge: &Edge,
) -> Option<QueryFormula> {
    let at =
        |member: usize, location| Some(QueryFormula::At { automaton: u16::try_from(member).ok()?, location });
    let mut all = vec![at(member, edge.from)?];
    let own = program.automaton(network.automata[member]);
    if own.location(edge.from).kind != LocationKind::Committed {
        for (other, id) in network.automata.iter().enumerate() {
            for (location, declared) in (0u16..).zip(&program.automaton(*id).locations) {
                if declared.kind == LocationKind::Committed {
                    all.push(QueryFormula::Not(Box::new(at(other, LocationId(location))?)));
                }
            }
        }
    }
    let ways = selected(edge)?.into_iter().map(|values| guarded(numbers, member, edge, &values));
    all.push(QueryFormula::Or(ways.collect::<Option<_>>()?));
    Some(QueryFormula::And(all))
}

/// Each choice of values for the edge's selects. `None`: they are too many.
fn selected(edge: &Edge) -> Option<Vec<Vec<Value>>> {
    let mut all: Vec<Vec<Value>> = vec![Vec::new()];
    // What no guard looks at makes no difference.
    if edge.guard.is_none() && edge.clock_guard.iter().all(|c| c.bound.terms.is_empty()) {
        return Some(all);
    }
    for select in &edge.selects {
        let values: Vec<Value> = (select.lo..=select.hi).filter_map(|n| select.value(n)).collect();
        if all.len().saturating_mul(values.len()) > MOST_SELECTED {
            return None;
        }
        let extend = |known: &Vec<Value>| {
            let known = known.clone();
            values.iter().map(move |value| [known.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(extend).collect();
    }
    Some(all)
}

fn guarded(numbers: &NetworkNumbers, member: usize, edge: &Edge, selects: &[Value]) -> Option<QueryFormula> {
    let mut parts = Vec::new();
    if let Some(guard) = &edge.guard {
        parts.push(QueryFormula::Data(numbers.expr(member, selects, guard)?));
    }
    for constraint in &edge.clock_guard {
        parts.push(QueryFormula::Clock(numbers.constraint(member, selects, constraint)?));
    }
    Some(QueryFormula::And(parts))
}

/// A stimulus and the events that it may make.
fn made(program: &Program, stimulus: EventId) -> BTreeSet<EventId> {
    let mut made: BTreeSet<EventId> = [stimulus].into();
    let mut open: Vec<&StimulusStep> =
        program.event(stimulus).stimulus.iter().flat_map(|s| &s.steps).collect();
    while let Some(step) = open.pop() {
        match step {
            StimulusStep::Emit { event, .. } => {
                made.insert(*event);
            }
            StimulusStep::If { then, otherwise, .. } => open.extend(then.iter().chain(otherwise)),
            StimulusStep::Hold { .. } | StimulusStep::Act(_) => {}
        }
    }
    made
}

/// The bounds of these members, in the order of the text.
pub fn of_members(
    program: &Program,
    network: &Network,
    stimuli: &[StimulusEdge],
    members: Range<usize>,
) -> Vec<BoundSite> {
    let numbers = NetworkNumbers::of(program, network);
    let mut all: Vec<BoundSite> = Vec::new();
    for member in members {
        let automaton = program.automaton(network.automata[member]);
        for (location, declared) in (0u16..).map(LocationId).zip(&automaton.locations) {
            // Where no time passes, nothing is just before or after.
            if declared.kind == LocationKind::Normal && !is_generated(&declared.name) {
                let place = BoundedLocation { program, numbers: &numbers, automaton, member, location };
                all.extend(place.sites(stimuli));
            }
        }
    }
    all
}

/// A location of a member.
struct BoundedLocation<'a> {
    program: &'a Program,
    numbers: &'a NetworkNumbers,
    automaton: &'a Automaton,
    member: usize,
    location: LocationId,
}

impl BoundedLocation<'_> {
    fn edges(&self) -> impl Iterator<Item = (usize, &Edge)> {
        self.automaton.edges.iter().enumerate().filter(|(_, e)| e.from == self.location)
    }

    fn sites(&self, stimuli: &[StimulusEdge]) -> Vec<BoundSite> {
        let declared = self.automaton.location(self.location);
        let guards = self.edges().flat_map(|(_, e)| &e.clock_guard);
        let mut known: Vec<(ClockId, &TimeSum)> = Vec::new();
        for c in declared.invariant.iter().chain(guards) {
            // The difference of two clocks is no time that an environment could wait for.
            let is_zero = c.bound.fixed() == Some(0);
            if c.minus.is_none() && !is_zero && !known.contains(&(c.clock, &c.bound)) {
                known.push((c.clock, &c.bound));
            }
        }
        let heard: Vec<StimulusEdge> = stimuli.iter().filter(|s| self.hears(s)).cloned().collect();
        let is_heard = !heard.is_empty();
        let stimuli = if is_heard { heard.as_slice() } else { stimuli };
        known.into_iter().filter_map(|(clock, time)| self.site(clock, time, stimuli, is_heard)).collect()
    }

    /// The automaton waits here for what the stimulus makes, or does it itself from here.
    fn hears(&self, stimulus: &StimulusEdge) -> bool {
        let own = stimulus.member == self.member && stimulus.from == self.location;
        own || self
            .edges()
            .any(|(_, e)| e.sync.as_receive().is_some_and(|(event, _)| stimulus.makes.contains(&event)))
    }

    /// `None`: the bound depends on what an edge receives or selects.
    fn site(
        &self,
        clock: ClockId,
        time: &TimeSum,
        stimuli: &[StimulusEdge],
        is_heard: bool,
    ) -> Option<BoundSite> {
        let name = format!(
            "{}.{}: {} = {}",
            self.automaton.name,
            self.automaton.location(self.location).name,
            clock_name(self.program, self.automaton, clock),
            self.text(time),
        );
        Some(BoundSite {
            member: u16::try_from(self.member).ok()?,
            location: self.location,
            clock: self.numbers.clock(self.member, clock)?,
            time: self.numbers.time(self.member, &[], time)?,
            name,
            stimuli: stimuli.to_vec(),
            is_heard,
            leaving: self.leaving(clock, time),
        })
    }

    /// Edges that are no reception, and are taken at the bound or not at all: their guard and the invariant leave no other time.
    fn leaving(&self, clock: ClockId, time: &TimeSum) -> Vec<usize> {
        use hrdsl_ir::ta::ClockOp::{Eq, Ge, Le};
        let here = |c: &&ClockConstraint| c.clock == clock && c.minus.is_none() && c.bound == *time;
        let invariant = &self.automaton.location(self.location).invariant;
        let leaves = |edge: &Edge| {
            let has = |op| edge.clock_guard.iter().filter(here).any(|c| c.op == op);
            let ends = invariant.iter().chain(&edge.clock_guard).filter(here).any(|c| c.op == Le);
            edge.sync.as_receive().is_none() && (has(Eq) || has(Ge) && ends)
        };
        self.edges().filter(|(_, e)| leaves(e)).map(|(at, _)| at).collect()
    }

    /// `14 s + untidy * 10 s`
    fn text(&self, time: &TimeSum) -> String {
        let names: Vec<&str> =
            self.program.shared.iter().chain(&self.automaton.vars).map(|v| v.name.as_str()).collect();
        let mut text = write::time_text(time.nanos);
        for term in &time.terms {
            let slot =
                if let hrdsl_ir::Expr::Var(slot) = &term.value { Some(usize::from(*slot)) } else { None };
            let value = slot.and_then(|slot| names.get(slot).copied()).unwrap_or("…");
            let sign = if term.factor < 0 { '-' } else { '+' };
            text = format!("{text} {sign} {value} * {}", write::time_text(term.factor.abs()));
        }
        text
    }
}
