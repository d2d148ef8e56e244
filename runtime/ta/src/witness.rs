//! Witnesses: a run that shows something, with concrete times, believed only after a replay under concrete clocks.
//!
//! A path of transitions gets its times from a [schedule](crate::schedule): the earliest, the latest or sampled ones.

use std::rc::Rc;

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    ta::{ChannelId, LocationId, Network},
};
use hrdsl_trace::{Step, Trace, What};
use serde::Serialize;

use crate::{
    Error, Goal, GoalKind, StateFormula,
    code::Medium,
    compile::values,
    dbm::Dbm,
    expand::Taken,
    graph::{Detail, Graph, Stay},
    network::{Constraint, Model},
    replay::{self, Final},
    schedule::{Schedule, Times, Timing},
    semantics::Move,
};

/// A run of the network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Witness {
    /// The network's name.
    pub network: String,
    /// Ticks in a nanosecond; 1 unless strict bounds are finer than that.
    pub ticks: i64,
    pub steps: Vec<WitnessStep>,
    /// When what it shows is so, in ticks: with the last transition, or later if time had to pass.
    pub end: i64,
    pub ending: Ending,
}

/// How a run goes on after its last transition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// What was asked for is reached.
    #[default]
    Reached,
    /// The steps from this one on can be repeated for ever; not always with the same delays. Runs in which time does not
    /// pass beyond a bound (Zeno runs) count.
    Again(usize),
    /// Nothing more can happen.
    Stuck,
    /// Time can pass for ever, and nothing has to happen.
    Waits,
}

/// One transition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessStep {
    /// Since the start, in ticks.
    pub time: i64,
    /// What was sent; `None`: nothing.
    pub event: Option<(EventId, Vec<Value>)>,
    /// The channel that it went over, with the arguments of the offer.
    pub channel: Option<(ChannelId, Vec<Value>)>,
    /// The edges taken: the sender's first, then those of who takes part, in the network's order; of a joint channel in the
    /// order of its parties.
    pub moves: Vec<Move>,
    /// Which automata changed their location: index in the network, from, to.
    pub locations: Vec<(usize, LocationId, LocationId)>,
    /// Which variables changed: slot of the network, from, to.
    pub variables: Vec<(usize, Value, Value)>,
}

impl Witness {
    /// The time of a step in nanoseconds, rounded down if ticks are finer.
    #[must_use]
    pub fn nanos(&self, step: &WitnessStep) -> Nanos {
        step.time.div_euclid(self.ticks.max(1))
    }

    /// The events as a trace, which ends with the last transition.
    #[must_use]
    pub fn trace(&self) -> Trace {
        let mut trace = Trace::default();
        for step in &self.steps {
            trace.end = self.nanos(step);
            if let Some((event, args)) = &step.event {
                let what = What::Event { event: *event, args: args.clone() };
                trace.steps.push(Step { time: trace.end, what });
            }
        }
        trace
    }

    /// A readable printing: see [`Story`](crate::Story).
    ///
    /// `network` must be the one that was searched.
    #[must_use]
    pub fn text(&self, program: &Program, network: &Network) -> String {
        crate::Story::of(program, network, self).text()
    }
}

/// A part of a path: a transition, or time that passes into something.
#[derive(Clone, Debug)]
pub(crate) enum Stop {
    /// A transition is taken where `before` holds, and `after` does right after it.
    Take { taken: Rc<Taken>, before: Vec<Constraint>, after: Vec<Constraint> },
    /// Some time passes, perhaps none; then these hold.
    Wait(Vec<Constraint>),
}

/// All bounds of a zone.
pub(crate) fn bounds_of(zone: &Dbm) -> Vec<Constraint> {
    let pairs = (0..zone.dim()).flat_map(|i| (0..zone.dim()).map(move |j| (i, j)));
    pairs
        .filter(|(i, j)| i != j && !zone.at(*i, *j).is_infinite())
        .map(|(i, j)| Constraint { i: i as u16, j: j as u16, bound: zone.at(i, j) })
        .collect()
}

/// The stops of transitions alone.
pub(crate) fn takes(path: impl IntoIterator<Item = Rc<Taken>>) -> Vec<Stop> {
    let stop = |taken| Stop::Take { taken, before: Vec::new(), after: Vec::new() };
    path.into_iter().map(stop).collect()
}

/// Makes the path concrete, replays it, and looks whether it meets the goal.
pub(crate) fn build(
    model: &Model,
    path: Vec<Taken>,
    goal: Option<&Goal>,
    timing: Timing,
) -> Result<Witness, Error> {
    let graph = Graph::new(model, Detail::Tell, &[], 0)?;
    let stops = takes(path.into_iter().map(Rc::new));
    match goal.and_then(Goal::formula) {
        Some(f) if f.is_timed() => reach_in_time(&graph, stops, &f, &[], goal, timing),
        Some(_) | None => concrete(&graph, &stops, Ending::Reached, goal, timing),
    }
}

/// The path, and then the time that the formula needs, with what must hold then besides.
pub(crate) fn reach_formula(
    graph: &Graph,
    stops: Vec<Stop>,
    f: &StateFormula,
    besides: &[Constraint],
    timing: Timing,
) -> Result<Witness, Error> {
    reach_in_time(graph, stops, f, besides, None, timing)
}

/// The path, and then the time that a goal's formula needs.
pub(crate) fn reach_goal(
    graph: &Graph,
    stops: Vec<Stop>,
    f: &StateFormula,
    goal: &Goal,
    timing: Timing,
) -> Result<Witness, Error> {
    reach_in_time(graph, stops, f, &[], Some(goal), timing)
}

/// The path and then the time that the formula needs: the first of its zones that can be.
fn reach_in_time(
    graph: &Graph,
    stops: Vec<Stop>,
    f: &StateFormula,
    besides: &[Constraint],
    goal: Option<&Goal>,
    timing: Timing,
) -> Result<Witness, Error> {
    let state = walk(graph, &stops)?.state;
    let mut all = Dbm::universe(graph.dim());
    let stay = graph.stay(&state)?.ok_or_else(|| internal("a path ends in a forbidden state"))?;
    stay.invariant.iter().chain(besides).for_each(|c| {
        crate::federation::keep(&mut all, *c);
    });
    let parts = f.part(&graph.here(&state), &all)?.into_zones();
    let mut best: Option<Witness> = None;
    for part in parts {
        let mut stops = stops.clone();
        stops.push(Stop::Wait(bounds_of(&part)));
        let w = walk(graph, &stops)?;
        let Some(times) = w.schedule.solve(graph.model.unit, timing) else { continue };
        let witness = finish(graph, w, &times, Ending::Reached, goal)?;
        // The earliest of them, as nanoseconds and their parts.
        let key = |w: &Witness| (i128::from(w.end) << 32) / i128::from(w.ticks);
        if best.as_ref().is_none_or(|b| key(&witness) < key(b)) {
            best = Some(witness);
        }
    }
    best.ok_or_else(|| internal("the zones reach a goal that no run reaches"))
}

fn internal(what: &str) -> Error {
    Error::Internal(what.to_owned())
}

/// Makes a path concrete and replays it.
pub(crate) fn concrete(
    graph: &Graph,
    stops: &[Stop],
    ending: Ending,
    goal: Option<&Goal>,
    timing: Timing,
) -> Result<Witness, Error> {
    let w = walk(graph, stops)?;
    let times = w
        .schedule
        .solve(graph.model.unit, timing)
        .ok_or_else(|| internal("the zones have a path that no run takes"))?;
    finish(graph, w, &times, ending, goal)
}

/// Whether time can pass between a stop and the end of the path, and at what times the stops are.
pub(crate) fn times(graph: &Graph, stops: &[Stop], timing: Timing) -> Result<Option<Times>, Error> {
    Ok(walk(graph, stops)?.schedule.solve(graph.model.unit, timing))
}

fn finish(
    graph: &Graph,
    w: Walk,
    times: &Times,
    ending: Ending,
    goal: Option<&Goal>,
) -> Result<Witness, Error> {
    let mut steps = w.steps;
    for (step, &at) in steps.iter_mut().zip(&w.at) {
        step.time = times.at[at];
    }
    let end = times.at.last().copied().unwrap_or(0);
    let witness = Witness { network: graph.model.name.to_owned(), ticks: times.ticks, steps, end, ending };
    believe(graph.model, &witness, &w.state, goal)?;
    Ok(witness)
}

fn believe(model: &Model, witness: &Witness, state: &[i64], goal: Option<&Goal>) -> Result<(), Error> {
    let ids: Vec<_> = model.members.iter().map(|m| m.automaton).collect();
    let end = replay::replay(model.program, &ids, &model.counters, &model.limits, witness)
        .map_err(|m| Error::Internal(format!("a witness does not replay: {m}")))?;
    if end.numbers() != state[..model.limit_at(0)] {
        return Err(internal("a witness ends in another state than the search"));
    }
    if let Ending::Again(from) = witness.ending
        && end.history.get(from) != end.history.last()
    {
        return Err(internal("a loop does not end where it begins"));
    }
    if witness.ending == Ending::Stuck && !end.meets(&StateFormula::Deadlock)? {
        return Err(internal("something can happen where nothing should"));
    }
    match goal {
        Some(goal) if !meets(goal, witness, &end)? => Err(internal("a witness does not meet its goal")),
        Some(_) | None => Ok(()),
    }
}

fn meets(goal: &Goal, witness: &Witness, end: &Final<'_>) -> Result<bool, Error> {
    let settled = end.settled || !goal.settled;
    Ok(match &goal.what {
        GoalKind::Edge { automaton, edge }
        | GoalKind::Pair { automaton, second: edge, .. }
        | GoalKind::Use { user: (automaton, edge), .. } => witness
            .steps
            .last()
            .is_some_and(|s| s.moves.iter().any(|m| m.automaton == *automaton && m.edge == *edge)),
        GoalKind::Location { .. } | GoalKind::Condition(_) | GoalKind::Formula(_) => match goal.formula() {
            Some(f) => settled && end.meets(&f)?,
            None => false,
        },
    })
}

/// A path without times.
struct Walk {
    steps: Vec<WitnessStep>,
    /// The number of each step's time.
    at: Vec<usize>,
    schedule: Schedule,
    /// The last discrete state.
    state: Vec<i64>,
}

fn walk(graph: &Graph, stops: &[Stop]) -> Result<Walk, Error> {
    let state = graph.initial();
    let schedule = Schedule::new(graph.dim());
    let mut w = Walk { steps: Vec::new(), at: Vec::new(), schedule, state };
    let mut stay = allowed(graph, &w.state)?;
    stay.invariant.iter().for_each(|c| w.schedule.require(*c));
    for stop in stops {
        let now = w.schedule.next(stay.waits);
        // An invariant is convex: it holds all the while if it holds at both ends.
        stay.invariant.iter().for_each(|c| w.schedule.require(*c));
        let (taken, after) = match stop {
            Stop::Wait(there) => {
                there.iter().for_each(|c| w.schedule.require(*c));
                continue;
            }
            Stop::Take { taken, before, after } => {
                before.iter().for_each(|c| w.schedule.require(*c));
                (taken, after)
            }
        };
        let target = graph.target(&w.state, taken);
        let target = target.map_err(|_| internal("a path takes a transition that is a fault"))?;
        taken.guard.iter().for_each(|c| w.schedule.require(*c));
        w.schedule.set(&taken.resets);
        stay = allowed(graph, &target)?;
        stay.invariant.iter().chain(after).for_each(|c| w.schedule.require(*c));
        w.steps.push(step(graph.model, &w.state, &target, taken));
        w.at.push(now);
        w.state = target;
    }
    Ok(w)
}

fn allowed(graph: &Graph, state: &[i64]) -> Result<Stay, Error> {
    graph.stay(state)?.ok_or_else(|| internal("a path leads through a forbidden state"))
}

fn step(model: &Model, before: &[i64], after: &[i64], taken: &Taken) -> WitnessStep {
    let location = |n: i64| LocationId(u16::try_from(n).unwrap_or(u16::MAX));
    let changed = |i: &usize| before[*i] != after[*i];
    let locations = (0..model.members.len()).filter(changed);
    let slots = (0..model.slots.len()).filter(|&s| changed(&model.slot_at(s)));
    let value = |state: &[i64], slot: usize| model.slot_value(state, slot);
    let args = |medium| values(model, medium, &taken.args);
    let (event, channel) = match taken.medium {
        None => (None, None),
        Some(medium @ Medium::Event(e)) => (Some((e, args(medium))), None),
        Some(medium @ Medium::Channel(c)) => (None, Some((c, args(medium)))),
    };
    WitnessStep {
        time: 0,
        event,
        channel,
        moves: taken.parts.iter().map(|t| model.moved(t)).collect(),
        locations: locations.map(|m| (m, location(before[m]), location(after[m]))).collect(),
        variables: slots
            .filter_map(|s| value(before, s).zip(value(after, s)).map(|(a, b)| (s, a, b)))
            .collect(),
    }
}

/// The same run with other delays: its path is found again by the moves and, among transitions of the same moves, by the
/// clocks.
///
/// # Errors
/// If the run is not one of the model.
pub fn retimed(model: &Model, run: &Witness, goal: &Goal, timing: Timing) -> Result<Witness, Error> {
    let graph = Graph::new(model, Detail::Tell, &[], 0)?;
    let mut path: Vec<Taken> = Vec::new();
    let mut state = graph.initial();
    // Each clock is zero at a time, in ticks.
    let scale = i128::from(model.unit) * i128::from(run.ticks);
    let mut zero = vec![0i128; model.dim];
    for s in &run.steps {
        let now = i128::from(s.time);
        let same = |t: &Taken, s: &WitnessStep| {
            t.parts.len() == s.moves.len() && t.parts.iter().zip(&s.moves).all(|(t, m)| model.moved(t) == *m)
        };
        let value = |x: u16| if x == 0 { 0 } else { now - zero[usize::from(x)] };
        let keeps = |c: &Constraint| {
            let (d, b) = (value(c.i) - value(c.j), i128::from(c.bound.value()) * scale);
            c.bound.is_infinite() || d < b || (d == b && !c.bound.is_strict())
        };
        let found =
            graph.actions(&state).into_iter().find(|a| same(&a.taken, s) && a.taken.guard.iter().all(keeps));
        let action = found.ok_or_else(|| internal("a run takes a transition that is not there"))?;
        let before = zero.clone();
        for set in &action.taken.resets {
            let from = if set.from == 0 { now } else { before[usize::from(set.from)] };
            zero[usize::from(set.clock)] = from - i128::from(set.by) * scale;
        }
        state = action.target.map_err(|_| internal("a run takes a transition that is a fault"))?;
        path.push((*action.taken).clone());
    }
    build(model, path, Some(goal), timing)
}
