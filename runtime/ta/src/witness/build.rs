//! From a path of transitions to a witness, which is believed only after a replay under concrete clocks.
//!
//! The times come from a [schedule](crate::witness::schedule): the earliest, the latest or sampled ones.

use std::rc::Rc;

use hrdsl_ir::ta::LocationId;

use crate::{
    network::{
        actions::{DelayCondition, PathTransition},
        code::SyncMedium,
        error::ModelError,
        graph::ZoneGraph,
        model::{CompiledNetwork, values},
        query::{GoalKind, ReachabilityGoal, StateFormula},
    },
    witness::{
        error::SearchError,
        replay::{self, ReplayedState},
        run::{RunEnding, WitnessRun, WitnessRunStep},
        schedule::{PathSchedule, ScheduleOptions, ScheduledTimes},
        standing::{ClocksThen, DelayProgram},
    },
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::Dbm,
    },
};

/// A part of a path: a transition, or time that passes into something.
#[derive(Clone, Debug)]
pub(crate) enum PathSegment {
    /// A transition is taken where `before` holds, and `after` does right after it.
    Take { taken: Rc<PathTransition>, before: Vec<DifferenceConstraint>, after: Vec<DifferenceConstraint> },
    /// Some time passes, perhaps none; then these hold.
    Wait(Vec<DifferenceConstraint>),
}

/// All bounds of a zone.
pub(crate) fn bounds_of(zone: &Dbm) -> Vec<DifferenceConstraint> {
    let pairs = (0..zone.dim()).flat_map(|i| (0..zone.dim()).map(move |j| (i, j)));
    pairs
        .filter(|(i, j)| i != j && !zone.at(*i, *j).is_infinite())
        .map(|(i, j)| DifferenceConstraint { i: i as u16, j: j as u16, bound: zone.at(i, j) })
        .collect()
}

/// The stops of transitions alone.
pub(crate) fn takes(path: impl IntoIterator<Item = Rc<PathTransition>>) -> Vec<PathSegment> {
    let stop = |taken| PathSegment::Take { taken, before: Vec::new(), after: Vec::new() };
    path.into_iter().map(stop).collect()
}

/// Makes the path concrete, replays it, and looks whether it meets the goal.
pub(crate) fn witness(
    model: &CompiledNetwork,
    path: Vec<PathTransition>,
    goal: Option<&ReachabilityGoal>,
    timing: ScheduleOptions,
) -> Result<WitnessRun, SearchError> {
    let graph = ZoneGraph::new(model, &[])?;
    let stops = takes(path.into_iter().map(Rc::new));
    match goal.and_then(ReachabilityGoal::formula) {
        Some(f) if f.is_timed() => reach_in_time(&graph, stops, &f, &[], goal, timing)?.ok_or_else(unreal),
        Some(_) | None => concrete(&graph, &stops, RunEnding::Reached, goal, timing),
    }
}

/// The path, and then the time that the formula needs, with what must hold then besides.
pub(crate) fn reach_formula(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    f: &StateFormula,
    besides: &[DifferenceConstraint],
    timing: ScheduleOptions,
) -> Result<WitnessRun, SearchError> {
    reach_in_time(graph, stops, f, besides, None, timing)?.ok_or_else(unreal)
}

/// The path, and then the time that a goal's formula needs. `None`: no run along the path meets it.
pub(crate) fn reach_goal(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    f: &StateFormula,
    goal: &ReachabilityGoal,
    timing: ScheduleOptions,
) -> Result<Option<WitnessRun>, SearchError> {
    reach_in_time(graph, stops, f, &[], Some(goal), timing)
}

/// The path and then the time that the formula needs: the first of its zones that can be.
fn reach_in_time(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    f: &StateFormula,
    besides: &[DifferenceConstraint],
    goal: Option<&ReachabilityGoal>,
    timing: ScheduleOptions,
) -> Result<Option<WitnessRun>, SearchError> {
    let mut best: Option<WitnessRun> = None;
    for stops in ends(graph, stops, f, besides)? {
        let w = walk(graph, &stops)?;
        let Some(times) = w.schedule.timed(graph.model.unit, timing)? else { continue };
        let witness = finish(graph, w, &times, RunEnding::Reached, goal)?;
        if best.as_ref().is_none_or(|b| earliness(&witness) < earliness(b)) {
            best = Some(witness);
        }
    }
    Ok(best)
}

/// The path, and then the time until a formula holds with what must hold besides: once for each zone in which it does.
fn ends(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    f: &StateFormula,
    besides: &[DifferenceConstraint],
) -> Result<Vec<Vec<PathSegment>>, SearchError> {
    let state = walk(graph, &stops)?.state;
    let mut all = Dbm::universe(graph.dim());
    let stay = graph.stay(&state)?.ok_or_else(|| internal("a path ends in a forbidden state"))?;
    stay.invariant.iter().chain(besides).for_each(|c| {
        keep(&mut all, *c);
    });
    let parts = f.part(&graph.here(&state), &all)?.into_zones();
    let end = |part: &Dbm| stops.iter().cloned().chain([PathSegment::Wait(bounds_of(part))]).collect();
    Ok(parts.iter().map(end).collect())
}

/// The error of [`reach_in_time`] where its path is known to meet the formula.
pub(crate) fn unreal() -> SearchError {
    internal("the zones reach a goal that no run reaches")
}

fn internal(what: &str) -> SearchError {
    SearchError::Internal(what.to_owned())
}

/// Makes a path concrete and replays it.
pub(crate) fn concrete(
    graph: &ZoneGraph,
    stops: &[PathSegment],
    ending: RunEnding,
    goal: Option<&ReachabilityGoal>,
    timing: ScheduleOptions,
) -> Result<WitnessRun, SearchError> {
    let w = walk(graph, stops)?;
    let times = w
        .schedule
        .timed(graph.model.unit, timing)?
        .ok_or_else(|| internal("the zones have a path that no run takes"))?;
    finish(graph, w, &times, ending, goal)
}

/// Makes a path concrete that may have no times, and replays it. `None`: it has none.
pub(crate) fn timed(
    graph: &ZoneGraph,
    stops: &[PathSegment],
    goal: &ReachabilityGoal,
    timing: ScheduleOptions,
) -> Result<Option<WitnessRun>, SearchError> {
    let w = walk(graph, stops)?;
    let Some(times) = w.schedule.timed(graph.model.unit, timing)? else { return Ok(None) };
    finish(graph, w, &times, RunEnding::Reached, Some(goal)).map(Some)
}

/// Whether a path has times. `None`: the numbers are too large to tell.
pub(crate) fn feasible(graph: &ZoneGraph, stops: &[PathSegment]) -> Result<Option<bool>, SearchError> {
    Ok(walk(graph, stops)?.schedule.feasible())
}

/// Each way along a path on which clocks stand still, to where a formula holds at its end, or to its end at once if there is none.
pub(crate) fn ways(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    f: Option<&StateFormula>,
) -> Result<Vec<DelayProgram>, SearchError> {
    let all = match f {
        Some(f) => ends(graph, stops, f, &[])?,
        None => vec![stops],
    };
    let mut ways = Vec::new();
    for stops in all {
        ways.extend(walk(graph, &stops)?.schedule.standing().cloned());
    }
    Ok(ways)
}

/// Whether time can pass between a stop and the end of the path, and at what times the stops are.
pub(crate) fn times(
    graph: &ZoneGraph,
    stops: &[PathSegment],
    timing: ScheduleOptions,
) -> Result<Option<ScheduledTimes>, SearchError> {
    walk(graph, stops)?.schedule.timed(graph.model.unit, timing)
}

pub(crate) fn finish(
    graph: &ZoneGraph,
    w: UntimedPath,
    times: &ScheduledTimes,
    ending: RunEnding,
    goal: Option<&ReachabilityGoal>,
) -> Result<WitnessRun, SearchError> {
    let mut steps = w.steps;
    for (step, &at) in steps.iter_mut().zip(&w.at) {
        step.time = times.at[at];
    }
    let end = times.at.last().copied().unwrap_or(0);
    let witness = WitnessRun { network: graph.model.name.clone(), ticks: times.ticks, steps, end, ending };
    believe(graph.model, &witness, &w.state, goal)?;
    Ok(witness)
}

pub(crate) fn replayed<'p>(
    model: &CompiledNetwork<'p>,
    witness: &WitnessRun,
) -> Result<ReplayedState<'p>, SearchError> {
    let ids: Vec<_> = model.members.iter().map(|m| m.automaton).collect();
    replay::replay(model.program, &ids, &model.counters, &model.limits, witness)
        .map_err(|m| SearchError::Internal(format!("a witness does not replay: {m}")))
}

/// A fault of the model with the run to it, up to the instant at which the interpreter meets the fault, too. A fault that it does
/// not meet is one of the engine's own.
pub(crate) fn fault(graph: &ZoneGraph, stops: Vec<PathSegment>, error: ModelError) -> SearchError {
    match led_to(graph, stops, &error) {
        Ok(Some(witness)) => SearchError::Model { error, witness: Some(Box::new(witness)) },
        Ok(None) => SearchError::Internal(format!("a fault does not replay: {error}")),
        Err(internal) => internal,
    }
}

/// As [`fault`], of a path of transitions alone.
pub(crate) fn fault_after(
    model: &CompiledNetwork,
    path: impl IntoIterator<Item = Rc<PathTransition>>,
    error: ModelError,
) -> SearchError {
    match ZoneGraph::new(model, &[]) {
        Ok(graph) => fault(&graph, takes(path), error),
        Err(e) => e.into(),
    }
}

/// The run to a fault after a path, and the faults that may be met there instead. No run: none meets it.
pub(crate) fn fault_among_others(
    model: &CompiledNetwork,
    path: Vec<PathTransition>,
    error: &ModelError,
) -> Result<(Option<WitnessRun>, Vec<ModelError>), SearchError> {
    let graph = ZoneGraph::new(model, &[])?;
    let stops = takes(path.into_iter().map(Rc::new));
    let state = walk(&graph, &stops)?.state;
    let others = graph.actions(&state).into_iter().filter_map(|a| a.target.err()).map(|e| *e);
    let others = others.filter(|e| e != error).collect();
    Ok((led_to(&graph, stops, error)?, others))
}

/// `None`: no run along the path meets the fault.
fn led_to(
    graph: &ZoneGraph,
    stops: Vec<PathSegment>,
    error: &ModelError,
) -> Result<Option<WitnessRun>, SearchError> {
    if !error.is_of_a_transition() {
        return concrete(graph, &stops, RunEnding::Reached, None, ScheduleOptions::default()).map(Some);
    }
    let state = walk(graph, &stops)?.state;
    let mut best: Option<WitnessRun> = None;
    for conditions in graph.faulty(&state, error) {
        let mut stops = stops.clone();
        stops.push(PathSegment::Wait(conditions));
        let w = walk(graph, &stops)?;
        let Some(times) = w.schedule.timed(graph.model.unit, ScheduleOptions::default())? else { continue };
        let witness = finish(graph, w, &times, RunEnding::Fault, None)?;
        if replayed(graph.model, &witness)?.faults().contains(error)
            && best.as_ref().is_none_or(|b| earliness(&witness) < earliness(b))
        {
            best = Some(witness);
        }
    }
    Ok(best)
}

/// When a run ends, as nanoseconds and their parts.
fn earliness(run: &WitnessRun) -> i128 {
    (i128::from(run.end) << 32) / i128::from(run.ticks)
}

fn believe(
    model: &CompiledNetwork,
    witness: &WitnessRun,
    state: &[i64],
    goal: Option<&ReachabilityGoal>,
) -> Result<(), SearchError> {
    let end = replayed(model, witness)?;
    if end.numbers() != state[..model.limit_at(0)] {
        return Err(internal("a witness ends in another state than the search"));
    }
    if let RunEnding::Again(from) = witness.ending
        && end.history.get(from) != end.history.last()
    {
        return Err(internal("a loop does not end where it begins"));
    }
    if witness.ending == RunEnding::Stuck && !end.meets(&StateFormula::Deadlock)? {
        return Err(internal("something can happen where nothing should"));
    }
    match goal {
        Some(goal) if !meets(goal, witness, &end)? => Err(internal("a witness does not meet its goal")),
        Some(_) | None => Ok(()),
    }
}

fn meets(
    goal: &ReachabilityGoal,
    witness: &WitnessRun,
    end: &ReplayedState<'_>,
) -> Result<bool, SearchError> {
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
pub(crate) struct UntimedPath {
    steps: Vec<WitnessRunStep>,
    /// The number of each step's time.
    at: Vec<usize>,
    pub(crate) schedule: PathSchedule,
    /// The last discrete state.
    pub(crate) state: Vec<i64>,
    /// Where clocks stand still: those after as many stops as were asked for.
    pub(crate) then: Option<ClocksThen>,
}

fn walk(graph: &ZoneGraph, stops: &[PathSegment]) -> Result<UntimedPath, SearchError> {
    walk_noting(graph, stops, stops.len())
}

/// Goes along a path without times, and notes the clocks after so many of its stops.
pub(crate) fn walk_noting(
    graph: &ZoneGraph,
    stops: &[PathSegment],
    noted: usize,
) -> Result<UntimedPath, SearchError> {
    let state = graph.initial();
    // One more clock, which is never set, is the time since the start: stops may speak of it.
    let dim = graph.dim() + 1;
    let schedule =
        if graph.model.stops() { PathSchedule::with_standing_clocks(dim) } else { PathSchedule::new(dim) };
    let mut w = UntimedPath { steps: Vec::new(), at: Vec::new(), schedule, state, then: None };
    let mut stay = allowed(graph, &w.state)?;
    stay.invariant.iter().for_each(|c| w.schedule.require(*c));
    for (number, stop) in stops.iter().enumerate() {
        if number == noted {
            w.then = w.schedule.standing().map(DelayProgram::clocks_now);
        }
        let now = w.schedule.next_but(stay.waits, &stay.stopped);
        // An invariant is convex: it holds all the while if it holds at both ends.
        stay.invariant.iter().for_each(|c| w.schedule.require(*c));
        let (taken, after) = match stop {
            PathSegment::Wait(there) => {
                there.iter().for_each(|c| w.schedule.require(*c));
                continue;
            }
            PathSegment::Take { taken, before, after } => {
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
        w.steps.push(told_step(graph.model, &w.state, &target, taken));
        w.at.push(now);
        w.state = target;
    }
    Ok(w)
}

fn allowed(graph: &ZoneGraph, state: &[i64]) -> Result<DelayCondition, SearchError> {
    graph.stay(state)?.ok_or_else(|| internal("a path leads through a forbidden state"))
}

/// A transition between two states, at time 0.
pub(crate) fn told_step(
    model: &CompiledNetwork,
    before: &[i64],
    after: &[i64],
    taken: &PathTransition,
) -> WitnessRunStep {
    let location = |n: i64| LocationId(u16::try_from(n).unwrap_or(u16::MAX));
    let changed = |i: &usize| before[*i] != after[*i];
    let locations = (0..model.members.len()).filter(changed);
    let slots = (0..model.slots.len()).filter(|&s| changed(&model.slot_at(s)));
    let value = |state: &[i64], slot: usize| model.slot_value(state, slot);
    let args = |medium| values(model, medium, &taken.args);
    let (event, channel) = match taken.medium {
        None => (None, None),
        Some(medium @ SyncMedium::Event(e)) => (Some((e, args(medium))), None),
        Some(medium @ SyncMedium::Channel(c)) => (None, Some((c, args(medium)))),
    };
    WitnessRunStep {
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
pub fn retimed(
    model: &CompiledNetwork,
    run: &WitnessRun,
    goal: &ReachabilityGoal,
    timing: ScheduleOptions,
) -> Result<WitnessRun, SearchError> {
    if model.stops() {
        // Its times are those with the least end, which is all that there is of them.
        return Ok(run.clone());
    }
    match path_of(model, run)? {
        (path, None) => witness(model, path, Some(goal), timing),
        (_, Some(_)) => Err(internal("a run takes a transition that is a fault")),
    }
}

/// The transitions that a run takes, which may be one of the network without some of its assignments: up to the first that is a fault.
pub(crate) fn path_of(
    model: &CompiledNetwork,
    run: &WitnessRun,
) -> Result<(Vec<PathTransition>, Option<ModelError>), SearchError> {
    let graph = ZoneGraph::new(model, &[])?;
    let mut path: Vec<PathTransition> = Vec::new();
    let mut state = graph.initial();
    // Each clock is zero at a time, in ticks.
    let scale = i128::from(model.unit) * i128::from(run.ticks);
    let mut zero = vec![0i128; model.dim];
    let mut last = 0i128;
    for s in &run.steps {
        let now = i128::from(s.time);
        // The time at which a clock that stands still was zero comes along.
        for clock in model.stopped(&state) {
            zero[usize::from(clock)] += now - last;
        }
        last = now;
        let same = |t: &PathTransition, s: &WitnessRunStep| {
            t.parts.len() == s.moves.len() && t.parts.iter().zip(&s.moves).all(|(t, m)| model.moved(t) == *m)
        };
        let value = |x: u16| if x == 0 { 0 } else { now - zero[usize::from(x)] };
        let keeps = |c: &DifferenceConstraint| {
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
        state = match action.target {
            Ok(target) => target,
            Err(fault) => return Ok((path, Some(*fault))),
        };
        path.push((*action.taken).clone());
    }
    Ok((path, None))
}
