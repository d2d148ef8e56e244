//! Witnesses: a way to a goal with earliest times, believed only after a replay under concrete clocks.
//!
//! The times of a path's transitions are the least solution of difference constraints over those times alone: a clock's
//! value is the time since the transition that last reset it. A strict bound counts as one infinitely small step ε more,
//! so that a time is `a` units and `b` ε. Then ε is made one tick. A tick is a nanosecond, unless the unit of the network
//! is so small that the path's ε would add up to a unit; then it is the fraction [`Witness::ticks`] of one.

use std::fmt::Write as _;

use hrdsl_ir::{
    EventId, Nanos, Program, Value,
    ta::{LocationId, Network},
};
use hrdsl_trace::{Step, Trace, What};

use crate::{
    Error, Goal, GoalKind,
    code::Medium,
    compile::values,
    concrete::{self, Final},
    expand::Taken,
    network::{Constraint, Model},
    search::goal_holds,
    semantics::{Effect, Firing, Move, Scratch},
};

/// A run of the network that leads to a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// The network's name.
    pub network: String,
    /// Ticks in a nanosecond; 1 unless strict bounds are finer than that.
    pub ticks: i64,
    pub steps: Vec<WitnessStep>,
}

/// One transition.
#[derive(Clone, Debug, PartialEq)]
pub struct WitnessStep {
    /// Since the start, in ticks.
    pub time: i64,
    /// What was sent; `None`: an internal edge.
    pub event: Option<(EventId, Vec<Value>)>,
    /// The edges taken: the sender's first, then the receivers', in the network's order.
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

    /// A readable printing, one line for each transition: when, who did what, which locations and variables changed.
    ///
    /// `network` must be the one that was searched.
    #[must_use]
    pub fn text(&self, program: &Program, network: &Network) -> String {
        let slots = crate::slot_names(program, network);
        let member = |m: usize| network.automata.get(m).and_then(|a| program.automata.get(usize::from(a.0)));
        let mut out = String::new();
        for step in &self.steps {
            let who = step.moves.first().and_then(|m| member(m.automaton)).map_or("?", |a| &a.name);
            let _ = write!(out, "{} s  {who}", decimal(step.time, self.ticks));
            if let Some((event, args)) = &step.event {
                let name = program.events.get(usize::from(event.0)).map_or("?", |e| &e.name);
                let args: Vec<String> = args.iter().map(ToString::to_string).collect();
                let list = if args.is_empty() { String::new() } else { format!("({})", args.join(", ")) };
                let _ = write!(out, " sends {name}{list}");
            }
            let mut facts = Vec::new();
            for m in &step.moves {
                let Some(a) = member(m.automaton) else { continue };
                let name = |l: LocationId| a.locations.get(usize::from(l.0)).map_or("?", |l| &l.name);
                if let Some(e) = a.edges.get(m.edge) {
                    facts.push(format!("{} {} -> {}", a.name, name(e.from), name(e.to)));
                }
            }
            for &(slot, from, to) in &step.variables {
                facts.push(format!("{} {from} -> {to}", slots.get(slot).map_or("?", |s| s)));
            }
            let _ = writeln!(out, ": {}", facts.join("; "));
        }
        out
    }
}

/// Ticks as seconds, exact for whole nanoseconds.
fn decimal(time: i64, ticks: i64) -> String {
    let nanos = time.div_euclid(ticks.max(1));
    let rest = time.rem_euclid(ticks.max(1));
    let mut text = format!("{}.{:09}", nanos / 1_000_000_000, nanos % 1_000_000_000);
    if rest == 0 {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    } else {
        let _ = write!(text, " + {rest}/{ticks} ns");
    }
    text
}

/// A time: units, then infinitely small steps.
type Time = (i64, i64);

/// `later ≥ earlier + (units, ε)`, of the transitions with these numbers.
struct AtLeast {
    later: usize,
    earlier: usize,
    by: Time,
}

/// Makes the path concrete, replays it, and looks whether it meets the goal.
pub(crate) fn build(model: &Model, path: &[Taken], goal: Option<&Goal>) -> Result<Witness, Error> {
    let Walk { mut steps, constraints, state } = walk(model, path)?;
    let times = least(steps.len() + 1, &constraints)
        .ok_or_else(|| Error::Internal("the zones reach a goal that no run reaches".into()))?;
    let most = times.iter().map(|t| t.1).max().unwrap_or(0);
    let ticks = most / model.unit + 1;
    for (step, &(units, small)) in steps.iter_mut().zip(&times[1..]) {
        let time = i128::from(units) * i128::from(model.unit) * i128::from(ticks) + i128::from(small);
        step.time = i64::try_from(time)
            .map_err(|_| Error::Internal("a witness lasts longer than time can be counted".into()))?;
    }
    let witness = Witness { network: model.name.to_owned(), ticks, steps };
    believe(model, &witness, &state, goal)?;
    Ok(witness)
}

fn believe(model: &Model, witness: &Witness, state: &[i64], goal: Option<&Goal>) -> Result<(), Error> {
    let ids: Vec<_> = model.members.iter().map(|m| m.automaton).collect();
    let end = concrete::replay(model.program, &ids, &model.counters, &model.limits, witness)
        .map_err(|m| Error::Internal(format!("a witness does not replay: {m}")))?;
    if end.numbers() != state[..model.limit_at(0)] {
        return Err(Error::Internal("a witness ends in another state than the search".into()));
    }
    match goal {
        Some(goal) if !meets(goal, witness, &end) => {
            Err(Error::Internal("a witness does not meet its goal".into()))
        }
        Some(_) | None => Ok(()),
    }
}

fn meets(goal: &Goal, witness: &Witness, end: &Final<'_>) -> bool {
    match &goal.what {
        GoalKind::Edge { automaton, edge }
        | GoalKind::Pair { automaton, second: edge, .. }
        | GoalKind::Use { user: (automaton, edge), .. } => witness
            .steps
            .last()
            .is_some_and(|s| s.moves.iter().any(|m| m.automaton == *automaton && m.edge == *edge)),
        GoalKind::Formula(_) => true,
        GoalKind::Location { .. } | GoalKind::Condition(_) => {
            (end.settled || !goal.settled) && goal_holds(goal, end) == Ok(true)
        }
    }
}

/// A path without times.
struct Walk {
    steps: Vec<WitnessStep>,
    /// What the times must keep.
    constraints: Vec<AtLeast>,
    /// The last discrete state.
    state: Vec<i64>,
}

fn walk(model: &Model, path: &[Taken]) -> Result<Walk, Error> {
    let (mut scratch, mut stack) = (Scratch::default(), Vec::new());
    let mut effect = Effect::default();
    let mut invariant = Vec::new();
    let mut state = model.initial();
    let (mut steps, mut constraints) = (Vec::new(), Vec::new());
    // The transition that last set each clock, and what it had then; all clocks start at 0, the start.
    let mut resets = vec![(0, 0); model.dim];
    model.invariant(&mut state, &mut stack, &mut invariant)?;
    invariant.iter().for_each(|&c| bound(c, 0, &resets, &mut constraints));
    for (before, taken) in path.iter().enumerate() {
        let now = before + 1;
        constraints.push(AtLeast { later: now, earlier: before, by: (0, 0) });
        if !model.may_delay(&mut state, &mut scratch) {
            constraints.push(AtLeast { later: before, earlier: now, by: (0, 0) });
        }
        // An invariant is convex: it holds all the while if it holds at both ends.
        model.invariant(&mut state, &mut stack, &mut invariant)?;
        invariant.iter().for_each(|&c| bound(c, now, &resets, &mut constraints));
        taken.guard.iter().for_each(|&c| bound(c, now, &resets, &mut constraints));
        let firing =
            Firing { parts: &taken.parts, medium: taken.medium, args: &taken.args, guard: &taken.guard };
        let done = model.effect(&state, &firing, &mut stack, &mut effect);
        if done.is_err() {
            return Err(Error::Internal("a path takes a transition that is a fault".into()));
        }
        let old = resets.clone();
        for r in &taken.resets {
            resets[usize::from(r.clock)] = match r.from {
                0 => (now, r.by),
                y => (old[usize::from(y)].0, old[usize::from(y)].1 + r.by),
            };
        }
        let mut target = effect.target.clone();
        model.invariant(&mut target, &mut stack, &mut invariant)?;
        invariant.iter().for_each(|&c| bound(c, now, &resets, &mut constraints));
        let event = match taken.medium {
            Some(medium @ Medium::Event(e)) => Some((e, values(model, medium, &taken.args))),
            Some(Medium::Channel(_)) | None => None,
        };
        let moves = taken.parts.iter().map(|t| model.moved(t)).collect();
        steps.push(step(model, &state, &target, event, moves));
        state = target;
    }
    Ok(Walk { steps, constraints, state })
}

fn step(
    model: &Model,
    before: &[i64],
    after: &[i64],
    event: Option<(EventId, Vec<Value>)>,
    moves: Vec<Move>,
) -> WitnessStep {
    let location = |n: i64| LocationId(u16::try_from(n).unwrap_or(u16::MAX));
    let changed = |i: &usize| before[*i] != after[*i];
    let locations = (0..model.members.len()).filter(changed);
    let slots = (0..model.slots.len()).filter(|&s| changed(&model.slot_at(s)));
    let value = |state: &[i64], slot: usize| model.slot_value(state, slot);
    WitnessStep {
        time: 0,
        event,
        moves,
        locations: locations.map(|m| (m, location(before[m]), location(after[m]))).collect(),
        variables: slots
            .filter_map(|s| value(before, s).zip(value(after, s)).map(|(a, b)| (s, a, b)))
            .collect(),
    }
}

/// `x_i - x_j ≺ b` at the transition `now`: `x` is the time since it was set, and what it was set to.
fn bound(c: Constraint, now: usize, resets: &[(usize, i64)], out: &mut Vec<AtLeast>) {
    let reset = |x: u16| if x == 0 { (now, 0) } else { resets[usize::from(x)] };
    let ((later, more), (earlier, less)) = (reset(c.i), reset(c.j));
    let by = (more - less - c.bound.value(), i64::from(c.bound.is_strict()));
    out.push(AtLeast { later, earlier, by });
}

/// The least times that keep all constraints, from 0 for the start; `None`: there are none.
fn least(count: usize, constraints: &[AtLeast]) -> Option<Vec<Time>> {
    let mut times = vec![(0, 0); count];
    for _ in 0..=count {
        let mut changed = false;
        for c in constraints {
            let from: Time = times[c.earlier];
            let at = (from.0 + c.by.0, from.1 + c.by.1);
            if at > times[c.later] {
                if c.later == 0 {
                    return None;
                }
                times[c.later] = at;
                changed = true;
            }
        }
        if !changed {
            return Some(times);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_times_count_strict_bounds_in_small_steps() {
        // t1 > 2, t2 > t1, t2 < 3, t3 ≥ t2 + 1
        let constraints = [
            AtLeast { later: 1, earlier: 0, by: (2, 1) },
            AtLeast { later: 2, earlier: 1, by: (0, 1) },
            AtLeast { later: 0, earlier: 2, by: (-3, 1) },
            AtLeast { later: 3, earlier: 2, by: (1, 0) },
        ];
        assert_eq!(least(4, &constraints), Some(vec![(0, 0), (2, 1), (2, 2), (3, 2)]));
    }

    #[test]
    fn contradiction_has_no_times() {
        let constraints =
            [AtLeast { later: 1, earlier: 0, by: (2, 0) }, AtLeast { later: 0, earlier: 1, by: (-2, 1) }];
        assert_eq!(least(2, &constraints), None);
    }

    #[test]
    fn times_print_as_seconds() {
        assert_eq!(decimal(0, 1), "0");
        assert_eq!(decimal(10_000_000_001, 1), "10.000000001");
        assert_eq!(decimal(1_500_000_000, 1), "1.5");
        assert_eq!(decimal(7, 3), "0.000000002 + 1/3 ns");
    }
}
