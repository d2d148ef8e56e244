//! The replay of a witness: each rule of the semantics is checked, under concrete clocks, by the
//! [interpreter](crate::witness::concrete).

use std::fmt;

use hrdsl_ir::{
    EventId, Program, Value,
    expr::EvalError,
    ta::{
        Automaton, AutomatonVar, ChannelId, ChannelKind, ClockConstraint, FunctionId, LocationId,
        LocationKind, SyncLabel, located_automaton,
    },
};

use crate::{
    network::{
        code::SyncMedium,
        error::ModelError,
        query::{EventCounter, EventLimit, StateFormula, StateView, StateViewScope, any_matches, nanos},
        selects::choices,
        semantics::AutomatonMove,
    },
    witness::{
        concrete::{ConcreteInterpreter, compare},
        run::{WitnessRun, WitnessRunStep},
    },
};

/// Why a run is not one of the network.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WitnessReplayError {
    step: usize,
    why: String,
}

impl fmt::Display for WitnessReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {}: {}", self.step, self.why)
    }
}

/// The state after a replay.
pub(crate) struct ReplayedState<'p> {
    machine: ConcreteInterpreter<'p>,
    /// Variables and the numbers that they keep.
    slots: Vec<(&'p AutomatonVar, i64)>,
    counters: Vec<i64>,
    ticks: i64,
    /// No automaton is in a committed location.
    pub(crate) settled: bool,
    /// The discrete state before each step, and at the end: locations and variables.
    pub(crate) history: Vec<Vec<i64>>,
}

impl ReplayedState<'_> {
    /// The faults that are met by what may happen right now.
    pub(crate) fn faults(&self) -> Vec<ModelError> {
        self.machine.faults()
    }

    /// Locations, variables, counters, in the search's order.
    pub(crate) fn numbers(&self) -> Vec<i64> {
        discrete(&self.machine).into_iter().chain(self.counters.iter().copied()).collect()
    }

    /// Whether a formula holds at the end.
    ///
    /// # Errors
    /// If an expression has no value there, or the model is at fault where `deadlock` looks.
    pub(crate) fn meets(&self, formula: &StateFormula) -> Result<bool, ModelError> {
        let value = |e: EvalError| ModelError::Question(format!("the formula has no value: {e}"));
        match formula {
            StateFormula::And(fs) => {
                for f in fs {
                    if !self.meets(f)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            StateFormula::Or(fs) => {
                for f in fs {
                    if self.meets(f)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            }
            StateFormula::Not(f) => Ok(!self.meets(f)?),
            StateFormula::Clock(c) => self.compares(c).map_err(value),
            StateFormula::Deadlock => Ok(!self.machine.can_ever_move()?),
            StateFormula::At { .. } | StateFormula::Data(_) | StateFormula::CounterIn { .. } => {
                formula.holds(self).map_err(value)
            }
        }
    }

    fn compares(&self, c: &ClockConstraint) -> Result<bool, EvalError> {
        let clocks = self.machine.clocks();
        let clock = |id: hrdsl_ir::ta::ClockId| clocks.get(usize::from(id.0)).copied().ok_or(EvalError::Type);
        let value = clock(c.clock)? - c.minus.map_or(Ok(0), clock)?;
        let bound = i128::from(nanos(&c.bound, &StateViewScope(self))?) * i128::from(self.ticks);
        Ok(compare(value, c.op, bound))
    }
}

impl StateView for ReplayedState<'_> {
    fn location(&self, automaton: usize) -> Option<LocationId> {
        self.machine.location.get(automaton).copied()
    }

    fn slot(&self, slot: u16) -> Option<Value> {
        if let Some(automaton) = located_automaton(slot, self.machine.location.len()) {
            return self.location(usize::from(automaton)).map(|l| Value::Int(i64::from(l.0)));
        }
        let (var, n) = self.slots.get(usize::from(slot))?;
        var.value(*n)
    }

    fn counter(&self, counter: usize) -> i64 {
        self.counters.get(counter).copied().unwrap_or(0)
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.machine.apply(function, args)
    }
}

fn discrete(machine: &ConcreteInterpreter) -> Vec<i64> {
    let locations = machine.location.iter().map(|l| i64::from(l.0));
    locations.chain(machine.numbers().into_iter().map(|(_, n)| n)).collect()
}

/// Runs a witness and checks each rule of the semantics on its path.
pub(crate) fn replay<'p>(
    program: &'p Program,
    automata: &[&'p Automaton],
    counters: &[EventCounter],
    limits: &[EventLimit],
    witness: &WitnessRun,
) -> Result<ReplayedState<'p>, WitnessReplayError> {
    let mut machine = ConcreteInterpreter::new(program, automata, witness.ticks);
    let mut counted = vec![0; counters.len()];
    let mut used = vec![0; limits.len()];
    let mut history = vec![discrete(&machine)];
    invariants(&machine).map_err(|why| WitnessReplayError { step: 0, why })?;
    for (step, s) in witness.steps.iter().enumerate() {
        replay_step(&mut machine, s).map_err(|why| WitnessReplayError { step, why })?;
        history.push(discrete(&machine));
        let Some((event, args)) = &s.event else { continue };
        count(&mut counted, counters, *event, args);
        for (n, limit) in used.iter_mut().zip(limits) {
            *n += i64::from(any_matches(&limit.patterns, *event, args));
            if *n > limit.at_most {
                return Err(WitnessReplayError {
                    step,
                    why: "an event happens more often than its limit".into(),
                });
            }
        }
    }
    wait(&mut machine, witness.end).map_err(|why| WitnessReplayError { step: witness.steps.len(), why })?;
    Ok(ReplayedState {
        slots: machine.numbers(),
        counters: counted,
        ticks: witness.ticks,
        settled: !machine.any_committed(),
        history,
        machine,
    })
}

fn count(counted: &mut [i64], counters: &[EventCounter], event: EventId, args: &[Value]) {
    for (n, counter) in counted.iter_mut().zip(counters) {
        if any_matches(&counter.patterns, event, args) && *n < counter.cap {
            *n += 1;
        }
    }
}

/// Lets time pass, if it may.
fn wait(machine: &mut ConcreteInterpreter, until: i64) -> Result<(), String> {
    let time = i128::from(until);
    if time < machine.now {
        return Err("time goes back".into());
    }
    if time > machine.now {
        if (0..machine.members.len()).any(|m| machine.kind(m) != LocationKind::Normal) {
            return Err("time passes in an urgent or committed location".into());
        }
        if machine.is_urged() {
            return Err("time passes although an urgent transition is possible".into());
        }
    }
    machine.advance(time);
    invariants(machine)
}

fn replay_step(machine: &mut ConcreteInterpreter, s: &WitnessRunStep) -> Result<(), String> {
    wait(machine, s.time)?;
    let Some((first, rest)) = s.moves.split_first() else { return Err("nobody moves".into()) };
    if s.moves.iter().any(|m| machine.members.get(m.automaton).is_none_or(|a| m.edge >= a.edges.len())) {
        return Err("an automaton or edge is not there".into());
    }
    starts(machine, first, s)?;
    match (&s.event, &s.channel) {
        (None, None) if rest.is_empty() => {}
        (None, None) => return Err("an internal edge is taken together with others".into()),
        (Some((event, args)), None) => {
            hears(machine, first.automaton, rest, SyncMedium::Event(*event), args)?
        }
        (None, Some((channel, args))) => meets(machine, first, rest, *channel, args)?,
        (Some(_), Some(_)) => return Err("an event and a channel at once".into()),
    }
    let committed = |m: &AutomatonMove| machine.kind(m.automaton) == LocationKind::Committed;
    if machine.any_committed() && !s.moves.iter().any(committed) {
        return Err("a committed location waits".into());
    }
    for m in &s.moves {
        machine.take(m).map_err(|e| e.to_string())?;
    }
    invariants(machine)
}

fn invariants(machine: &ConcreteInterpreter) -> Result<(), String> {
    match machine.broken_invariant().map_err(|e| e.to_string())? {
        None => Ok(()),
        Some(m) => Err(format!("the invariant of `{}` does not hold", machine.members[m].name)),
    }
}

/// Whether the first edge can be taken, and what it sends is what the step says.
fn starts(machine: &ConcreteInterpreter, first: &AutomatonMove, s: &WitnessRunStep) -> Result<(), String> {
    let edge = machine.edge(first);
    if !choices(&edge.selects).contains(&first.binders) {
        return Err("the selects have other values".into());
    }
    if !machine.clock_guard(first).map_err(|e| e.to_string())? {
        return Err("the first edge's clock guard does not hold".into());
    }
    if !machine.guard(first).map_err(|e| e.to_string())? {
        return Err("the first edge's guard does not hold".into());
    }
    let same =
        |own: &[Value], values: &[Value]| own.iter().map(|v| v.key()).eq(values.iter().map(|v| v.key()));
    let another = || Err("the first edge does something else".to_owned());
    match &edge.sync {
        SyncLabel::Internal if s.event.is_none() && s.channel.is_none() => Ok(()),
        SyncLabel::Send { event, args } => match (&s.event, &s.channel) {
            (Some((sent, values)), None) if event == sent => {
                let own = machine.arguments(first, *event, args).map_err(|e| e.to_string())?;
                if same(&own, values) { Ok(()) } else { Err("the sender sends other arguments".into()) }
            }
            _ => another(),
        },
        SyncLabel::Offer { channel, args } => match (&s.event, &s.channel) {
            (None, Some((over, values))) if channel == over => {
                let declared = machine.channel(*channel).ok_or("the channel is not there")?;
                let own = machine.offered(first, declared, args).map_err(|e| e.to_string())?;
                if same(&own, values) { Ok(()) } else { Err("other arguments are offered".into()) }
            }
            _ => another(),
        },
        SyncLabel::Join { channel } => match (&s.event, &s.channel) {
            (None, Some((over, values))) if channel == over && values.is_empty() => Ok(()),
            _ => another(),
        },
        SyncLabel::Internal | SyncLabel::Receive { .. } | SyncLabel::Accept { .. } => another(),
    }
}

/// Everybody else who can take part does, and nobody who cannot.
fn hears(
    machine: &ConcreteInterpreter,
    sender: usize,
    receivers: &[AutomatonMove],
    medium: SyncMedium,
    args: &[Value],
) -> Result<(), String> {
    let mut left = receivers;
    for m in machine.others(sender) {
        let can = machine.receptions(m, medium, args, true).map_err(|e| e.to_string())?;
        left = takes_part(machine, m, &can, left)?;
    }
    if left.is_empty() { Ok(()) } else { Err("the receivers are out of order".into()) }
}

/// Takes the member's move off the list: it must have one of those that it can take, if there are any.
fn takes_part<'a>(
    machine: &ConcreteInterpreter,
    member: usize,
    can: &[AutomatonMove],
    left: &'a [AutomatonMove],
) -> Result<&'a [AutomatonMove], String> {
    match left.split_first() {
        Some((first, rest)) if first.automaton == member => {
            if can.contains(first) {
                Ok(rest)
            } else {
                Err(format!("`{}` cannot take part that way", machine.members[member].name))
            }
        }
        Some(_) | None if can.is_empty() => Ok(left),
        Some(_) | None => Err(format!("`{}` must take part and does not", machine.members[member].name)),
    }
}

fn meets(
    machine: &ConcreteInterpreter,
    first: &AutomatonMove,
    rest: &[AutomatonMove],
    id: ChannelId,
    args: &[Value],
) -> Result<(), String> {
    let channel = machine.channel(id).ok_or("the channel is not there")?;
    let medium = SyncMedium::Channel(id);
    match &channel.kind {
        ChannelKind::Broadcast => hears(machine, first.automaton, rest, medium, args),
        ChannelKind::Binary => {
            let [partner] = rest else { return Err("a binary synchronisation is not of two".into()) };
            if partner.automaton == first.automaton {
                return Err("an automaton shakes hands with itself".into());
            }
            let can = machine.receptions(partner.automaton, medium, args, true).map_err(|e| e.to_string())?;
            takes_part(machine, partner.automaton, &can, rest).map(drop)
        }
        ChannelKind::MultiWay(participants) => {
            let all: Vec<AutomatonMove> = std::iter::once(first).chain(rest).cloned().collect();
            let mut left = all.as_slice();
            for p in participants {
                let Some(member) = machine.member(p.automaton) else { continue };
                let can = machine.receptions(member, medium, &[], true).map_err(|e| e.to_string())?;
                if can.is_empty() && !p.optional {
                    return Err(format!("`{}` must take part and cannot", machine.members[member].name));
                }
                left = takes_part(machine, member, &can, left)?;
            }
            if left.is_empty() { Ok(()) } else { Err("the participants are out of order".into()) }
        }
    }
}
