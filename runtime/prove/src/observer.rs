//! Requirements as automata: a monitor becomes one more automaton of the network, which only listens.
//!
//! # The observer of a monitor
//! Its locations are the monitor's states and `violated`, which it never leaves: what comes after the first violation does
//! not matter. An edge of the monitor on events becomes a receiving edge for each of its events. Since events are broadcast
//! and the observer has no invariants, the network does what it does without it.
//!
//! A deadline D of a pending state is no edge. The requirement is violated where the clock is **greater** than D in that
//! state: an event at the very instant of the deadline is still in time, so that the observer takes it if the clock is at most
//! D. In a run in which time does not go on after D the deadline is not missed on the model; a trace that ends there is
//! judged more strictly by the monitor, which knows that nothing comes any more.

use hrdsl_ir::{
    ActorId, EventId, EventPattern, Expr, Nanos, Program, Provenance,
    expr::Lvalue,
    monitor::{Monitor, MonitorClockGuard, MonitorEdge, MonitorEffect, MonitorTrigger},
    ta::{
        Automaton, AutomatonId, AutomatonVar, ClockConstraint, ClockId, ClockOp, Edge, EdgeAssignment,
        Location, LocationId, LocationKind, Network, QueryFormula, SyncLabel, TimeSum,
    },
};

use super::matching::receptions;

/// A program with observers in one of its networks.
#[derive(Clone, Debug)]
pub struct ObservedNetwork {
    pub program: Program,
    /// The network with the observers behind its own automata.
    pub network: Network,
}

/// What to look for in the network with an observer.
#[derive(Clone, Debug, PartialEq)]
pub struct ObserverFormulas {
    /// The requirement is violated. `None`: it cannot be, whatever happens.
    pub violated: Option<QueryFormula>,
    /// It was triggered.
    pub triggered: QueryFormula,
}

impl ObservedNetwork {
    /// A copy of the program with this network, without observers.
    #[must_use]
    pub fn new(program: &Program, network: &Network) -> Self {
        Self { program: program.clone(), network: network.clone() }
    }

    /// Adds the observer of a monitor.
    ///
    /// # Errors
    /// Why the requirement cannot be judged on a model.
    pub fn add(&mut self, monitor: &Monitor) -> Result<ObserverFormulas, String> {
        let plan = ObserverPlan::of(monitor)?;
        if let Some(event) = self.only_seen(&plan) {
            return Err(format!("the world makes `{event}`, and no automaton of the network"));
        }
        let shared_clocks = self.program.clocks.len();
        let before = self.members().map(|a| a.clocks.len()).sum::<usize>();
        let automaton = plan.automaton(&self.program)?;
        let verdicts = plan.verdicts(
            number(self.network.automata.len()),
            ClockId(number(shared_clocks + before)),
            number(self.program.shared.len() + self.members().map(|a| a.vars.len()).sum::<usize>()),
        );
        self.push(automaton);
        Ok(verdicts)
    }

    /// The first event of the requirement that is the world's to show, and that no automaton plays: to the network it never happens, which
    /// says nothing.
    fn only_seen(&self, plan: &ObserverPlan<'_>) -> Option<&str> {
        let shown = |event: &EventId| match self.program.provenance.get(usize::from(event.0)) {
            Some(Provenance::Seen | Provenance::Commanded) => true,
            Some(Provenance::Said | Provenance::Played) | None => false,
        };
        let edges = || self.members().flat_map(|automaton| &automaton.edges);
        let sent = |event: EventId| {
            edges().any(|e| matches!(&e.sync, SyncLabel::Send { event: sent, .. } if *sent == event))
        };
        let mut events = plan.on_events().flat_map(|(_, patterns)| patterns).map(|p| p.event);
        events
            .find(|event| shown(event) && !sent(*event))
            .map(|event| self.program.event(event).name.as_str())
    }

    /// Adds an automaton to the program and to the network.
    pub(super) fn push(&mut self, automaton: Automaton) {
        self.network.automata.push(AutomatonId(number(self.program.automata.len())));
        self.program.automata.push(automaton);
    }

    fn members(&self) -> impl Iterator<Item = &Automaton> {
        self.network.automata.iter().filter_map(|id| self.program.automata.get(usize::from(id.0)))
    }
}

pub(super) fn number(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

/// How a monitor is made an automaton.
struct ObserverPlan<'m> {
    monitor: &'m Monitor,
    /// For each state: when it fails, or goes on as another.
    deadlines: Vec<Option<StateDeadline>>,
    fails: bool,
    /// The locations that tell that it was triggered; `None`: a variable does.
    telling: Option<Vec<u16>>,
}

impl<'m> ObserverPlan<'m> {
    fn of(monitor: &'m Monitor) -> Result<Self, String> {
        let samples = monitor.edges.iter().any(|e| e.guard.is_some() || e.on == MonitorTrigger::Sample);
        if samples || !monitor.conditions.is_empty() || !monitor.signals.is_empty() {
            return Err("it reads signals of the world, which a network does not have".to_owned());
        }
        let deadlines =
            (0..monitor.states.len()).map(|s| deadline(monitor, s)).collect::<Result<Vec<_>, _>>()?;
        let fails = monitor
            .edges
            .iter()
            .any(|e| e.effects.contains(&MonitorEffect::Fail) && e.on != MonitorTrigger::Deadline)
            || deadlines.iter().flatten().any(|d| d.goes_on.is_none());
        let mut plan = Self { monitor, deadlines, fails, telling: None };
        plan.telling = plan.telling_locations();
        Ok(plan)
    }

    /// The location for what follows the first violation.
    fn violated(&self) -> u16 {
        number(self.monitor.states.len())
    }

    fn target(&self, edge: &MonitorEdge) -> u16 {
        if edge.effects.contains(&MonitorEffect::Fail) { self.violated() } else { edge.to.0 }
    }

    fn on_events(&self) -> impl Iterator<Item = MonitorRule<'m>> {
        self.monitor.edges.iter().filter_map(|e| match &e.on {
            MonitorTrigger::Event(patterns) => Some((e, patterns.as_slice())),
            MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => None,
        })
    }

    /// The targets of the edges that trigger, if to be in one of them means that it was triggered: each edge that leads there
    /// from elsewhere triggers.
    fn telling_locations(&self) -> Option<Vec<u16>> {
        let triggers = |e: &MonitorEdge| e.effects.contains(&MonitorEffect::Trigger);
        let mut targets: Vec<u16> =
            self.on_events().filter(|(e, _)| triggers(e)).map(|(e, _)| self.target(e)).collect();
        targets.sort_unstable();
        targets.dedup();
        let inside = |s: u16| targets.contains(&s);
        let tells = !inside(self.monitor.initial.0)
            && self.on_events().all(|(e, _)| inside(e.from.0) || !inside(self.target(e)) || triggers(e));
        tells.then_some(targets)
    }

    fn automaton(&self, program: &Program) -> Result<Automaton, String> {
        let monitor = self.monitor;
        let location = |name: &str| Location {
            name: name.to_owned(),
            kind: LocationKind::Normal,
            invariant: Vec::new(),
            holds: None,
            stopped: Vec::new(),
            origin: monitor.origin,
        };
        let mut locations: Vec<Location> = monitor.states.iter().map(|s| location(&s.name)).collect();
        locations.push(location("violated"));
        let flag = AutomatonVar {
            name: "triggered".to_owned(),
            lo: 0,
            hi: 1,
            init: 0,
            is_bool: true,
            enumeration: None,
        };
        let vars = if self.telling.is_none() { vec![flag] } else { Vec::new() };
        let timed =
            self.deadlines.iter().any(Option::is_some) || monitor.edges.iter().any(|e| e.clock.is_some());
        let mut edges = Vec::new();
        for state in 0..monitor.states.len() {
            self.edges_of(program, state, number(program.shared.len() + vars.len()), timed, &mut edges)?;
        }
        Ok(Automaton {
            name: monitor.name.clone(),
            actor: program.actors.first().map(|_| ActorId(0)),
            clocks: if timed { vec!["since".to_owned()] } else { Vec::new() },
            vars,
            locations,
            initial: LocationId(monitor.initial.0),
            edges,
            origin: monitor.origin,
        })
    }

    fn edges_of(
        &self,
        program: &Program,
        state: usize,
        binders: u16,
        timed: bool,
        out: &mut Vec<Edge>,
    ) -> Result<(), String> {
        let here = |at: usize| self.on_events().filter(move |(e, _)| usize::from(e.from.0) == at).collect();
        let rules: Vec<MonitorRule<'m>> = here(state);
        let clock = ClockId(number(program.clocks.len()));
        let reads = |op, bound| ClockConstraint { clock, minus: None, op, bound: TimeSum::constant(bound) };
        let deadline = self.deadlines[state].as_ref();
        let in_time: Vec<ClockConstraint> = deadline.iter().map(|d| reads(ClockOp::Le, d.after)).collect();
        match clock_guard(&rules)? {
            None => self.receiving(program, state, (&rules, &in_time), (binders, timed), out)?,
            Some(guard) => {
                // First what is done when the clock fits, then what is done when it does not.
                let (op, other, bound) = match guard {
                    MonitorClockGuard::Before(bound) => (ClockOp::Lt, ClockOp::Ge, bound),
                    MonitorClockGuard::After(bound) => (ClockOp::Gt, ClockOp::Le, bound),
                };
                let also = |op| [in_time.as_slice(), &[reads(op, bound)]].concat();
                self.receiving(program, state, (&rules, &also(op)), (binders, timed), out)?;
                let untimed: Vec<_> = rules.into_iter().filter(|(e, _)| e.clock.is_none()).collect();
                self.receiving(program, state, (&untimed, &also(other)), (binders, timed), out)?;
            }
        }
        let Some((late, goes_on)) = deadline.and_then(|d| Some((d.after, d.goes_on?))) else { return Ok(()) };
        let late = [reads(ClockOp::Gt, late)];
        self.receiving(program, state, (&here(usize::from(goes_on)), &late), (binders, timed), out)
    }

    /// Edges out of a state that receive what these rules are for, while the clock reads this.
    fn receiving(
        &self,
        program: &Program,
        state: usize,
        (rules, reads): (&[MonitorRule<'m>], &[ClockConstraint]),
        (binders, timed): (u16, bool),
        out: &mut Vec<Edge>,
    ) -> Result<(), String> {
        let patterns: Vec<&[EventPattern]> = rules.iter().map(|(_, p)| *p).collect();
        let clock = ClockId(number(program.clocks.len()));
        for reception in receptions(program, &patterns, binders)? {
            let edge = rules[reception.rule].0;
            let to = self.target(edge);
            let mut updates = Vec::new();
            if timed && edge.effects.contains(&MonitorEffect::ResetClock) {
                updates.push(EdgeAssignment::zero(clock));
            }
            if self.telling.is_none() && edge.effects.contains(&MonitorEffect::Trigger) {
                let place = Lvalue::slot(number(program.shared.len()));
                updates.push(EdgeAssignment::Assign { place, value: Expr::bool(true) });
            }
            if to == edge.from.0 && updates.is_empty() {
                // Nothing comes of it.
                continue;
            }
            out.push(Edge {
                from: LocationId(number(state)),
                to: LocationId(to),
                selects: Vec::new(),
                clock_guard: reads.to_vec(),
                guard: reception.guard,
                sync: SyncLabel::Receive { event: reception.event, args: reception.args },
                updates,
                origin: self.monitor.origin,
            });
        }
        Ok(())
    }

    /// The formulas over the network in which the observer has this place, and its clock and variable these numbers.
    fn verdicts(&self, automaton: u16, clock: ClockId, flag: u16) -> ObserverFormulas {
        let at = |location: u16| QueryFormula::At { automaton, location: LocationId(location) };
        let late = self.deadlines.iter().zip(0u16..).filter_map(|(d, state)| {
            let after = d.as_ref().filter(|d| d.goes_on.is_none())?.after;
            let past =
                ClockConstraint { clock, minus: None, op: ClockOp::Gt, bound: TimeSum::constant(after) };
            Some(QueryFormula::And(vec![at(state), QueryFormula::Clock(past)]))
        });
        let violated = QueryFormula::Or(std::iter::once(at(self.violated())).chain(late).collect());
        let triggered = match &self.telling {
            Some(locations) => QueryFormula::Or(locations.iter().map(|l| at(*l)).collect()),
            None => QueryFormula::Data(Expr::Var(flag)),
        };
        let at_once = self.monitor.at_start.contains(&MonitorEffect::Trigger);
        let triggered = if at_once { QueryFormula::Data(Expr::bool(true)) } else { triggered };
        ObserverFormulas { violated: self.fails.then_some(violated), triggered }
    }
}

/// An edge of a monitor with the events that it is for.
type MonitorRule<'m> = (&'m MonitorEdge, &'m [EventPattern]);

/// What the clock has to read for some rules of a state.
fn clock_guard(rules: &[MonitorRule<'_>]) -> Result<Option<MonitorClockGuard>, String> {
    let mut guards = rules.iter().filter_map(|(e, _)| e.clock);
    let first = guards.next();
    if guards.any(|guard| Some(guard) != first) {
        return Err("its monitor compares the clock with several times in one state".to_owned());
    }
    Ok(first)
}

/// When nothing may happen any longer in a state.
struct StateDeadline {
    after: Nanos,
    /// The state as which it goes on; `None`: the requirement is violated.
    goes_on: Option<u16>,
}

/// What becomes of a state if nothing happens.
fn deadline(monitor: &Monitor, state: usize) -> Result<Option<StateDeadline>, String> {
    let Some(after) = monitor.states[state].deadline else { return Ok(None) };
    let here = |e: &&MonitorEdge| usize::from(e.from.0) == state && e.on == MonitorTrigger::Deadline;
    let Some(edge) = monitor.edges.iter().find(here) else { return Ok(None) };
    let fails = edge.effects.contains(&MonitorEffect::Fail);
    // INVARIANT: the state as which it goes on does not look at the clock.
    let timeless = monitor.states[usize::from(edge.to.0)].deadline.is_none()
        && monitor.edges.iter().all(|e| e.from != edge.to || e.clock.is_none());
    if !fails && (edge.effects != [MonitorEffect::Suspect] || !timeless) {
        return Err("a deadline of its monitor passes without a violation".to_owned());
    }
    // INVARIANT: the clock counts from when the state is entered, so that at the entry it is not past the deadline.
    let entered_late = monitor.edges.iter().any(|e| {
        usize::from(e.to.0) == state
            && e.from != e.to
            && !e.effects.contains(&MonitorEffect::ResetClock)
            && e.on != MonitorTrigger::Deadline
    });
    if entered_late {
        return Err("a deadline of its monitor does not count from the trigger".to_owned());
    }
    Ok(Some(StateDeadline { after, goes_on: (!fails).then_some(edge.to.0) }))
}
