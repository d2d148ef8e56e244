//! Tests beside bounds really are there: random networks, against a walk over all states on the grid of the step.
//!
//! Guards and invariants are closed and receptions have no clock guards, so that what can be reached at all can be reached at
//! whole multiples of the step (Henzinger, Manna, Pnueli 1992).

use std::{
    collections::{BTreeSet, VecDeque},
    fmt::Write as _,
};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    EventId, Program,
    suite::BoundaryStep,
    ta::{Automaton, ClockConstraint, ClockOp, Edge, EdgeAssignment, LocationKind, SyncLabel},
    value::SECOND,
};
use hrdsl_runtime::{
    prove::ProofOptions,
    results::GoalStatus,
    testgen::{BoundFinding, BoundSide, bound_findings, boundary_step},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STEP: i64 = SECOND / 2;

/// No clock is compared with more than 4 s, and what is beyond that and a step is the same.
const MOST: i64 = 10;

/// A person who does two stimuli, and a robot that makes an event.
fn scenario(rng: &mut ChaCha8Rng) -> String {
    let mut text = "scenario random\nactor person : environment\nactor robot : system\n\
        event f0, f1 from person to robot\nevent e0 from robot to person\n\
        stimulus s0 by person { emit f0 }\nstimulus s1 by person { emit f1 }\n"
        .to_owned();
    for (name, actor, does, hears) in
        [("P", "person", ["s0", "s1"], ["e0", "e0"]), ("R", "robot", ["e0", "e0"], ["f0", "f1"])]
    {
        let _ = writeln!(text, "automaton {name} plays {actor} {{\n  clock x");
        for (at, location) in ["a", "b", "c"].into_iter().enumerate() {
            let init = if at == 0 { "init " } else { "" };
            let invariant = match rng.random_range(0..4) {
                0 => String::new(),
                _ => format!(" {{ invariant x <= {} s }}", rng.random_range(1..=4)),
            };
            let _ = writeln!(text, "  {init}location {location}{invariant}");
        }
        for _ in 0..rng.random_range(4..8) {
            let [from, to] = [0, 1].map(|_| ["a", "b", "c"][rng.random_range(0..3)]);
            let n = rng.random_range(1..=4);
            let guard = match rng.random_range(0..5) {
                0 => String::new(),
                1 => format!(" when x == {n} s"),
                2 => format!(" when x <= {n} s"),
                3 => format!(" when x >= {n} s && x <= {} s", rng.random_range(n..=4)),
                _ => format!(" when x >= {n} s"),
            };
            let reset = if rng.random_range(0..3) > 0 { "; x = 0" } else { "" };
            let _ = match rng.random_range(0..3) {
                0 => writeln!(text, "  {from} -> {to} on {} do x = 0", hears[rng.random_range(0..2)]),
                1 => writeln!(text, "  {from} -> {to}{guard} do x = 0"),
                _ => writeln!(text, "  {from} -> {to}{guard} do {}{reset}", does[rng.random_range(0..2)]),
            };
        }
        text.push_str("}\n");
    }
    text + "network n = P | R\n"
}

/// Locations, clocks in steps, and how many steps ago the site was left at its bound.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct GridState {
    at: [u16; 2],
    x: [i64; 2],
    left: Option<i64>,
}

/// Where a bound is, as its finding says.
struct Site {
    automaton: usize,
    location: u16,
    bound: i64,
    leaving: Vec<usize>,
}

struct Grid<'p> {
    automata: [&'p Automaton; 2],
    site: Site,
}

fn holds(c: &ClockConstraint, x: i64) -> bool {
    let n = c.bound.nanos / STEP;
    match c.op {
        ClockOp::Lt => x < n,
        ClockOp::Le => x <= n,
        ClockOp::Eq => x == n,
        ClockOp::Ge => x >= n,
        ClockOp::Gt => x > n,
    }
}

impl Grid<'_> {
    fn is_committed(&self, s: &GridState, m: usize) -> bool {
        self.automata[m].locations[usize::from(s.at[m])].kind == LocationKind::Committed
    }

    /// A step of time; `None`: it may not pass.
    fn later(&self, s: &GridState) -> Option<GridState> {
        let x = s.x.map(|x| (x + 1).min(MOST));
        let later = GridState { at: s.at, x, left: s.left.map(|n| (n + 1).min(2)) };
        let waits = (0..2).all(|m| !self.is_committed(s, m));
        (waits && self.stays(&later)).then_some(later)
    }

    fn stays(&self, s: &GridState) -> bool {
        (0..2).all(|m| {
            let location = &self.automata[m].locations[usize::from(s.at[m])];
            location.invariant.iter().all(|c| holds(c, s.x[m]))
        })
    }

    fn open(&self, s: &GridState, m: usize) -> impl Iterator<Item = (usize, &Edge)> {
        let (at, x) = (s.at[m], s.x[m]);
        let edges = self.automata[m].edges.iter().enumerate();
        edges.filter(move |(_, e)| e.from.0 == at && e.clock_guard.iter().all(|c| holds(c, x)))
    }

    fn moved(&self, s: &GridState, m: usize, edge: usize) -> GridState {
        let mut next = s.clone();
        let taken = &self.automata[m].edges[edge];
        next.at[m] = taken.to.0;
        if taken.updates.iter().any(|u| matches!(u, EdgeAssignment::Reset { .. })) {
            next.x[m] = 0;
        }
        if m == self.site.automaton && self.site.leaving.contains(&edge) {
            next.left = Some(0);
        }
        next
    }

    /// Each transition: who starts it, by which edge, what is sent, and where it leads.
    fn transitions(&self, s: &GridState) -> Vec<(usize, usize, Option<EventId>, GridState)> {
        let mut all = Vec::new();
        for m in 0..2 {
            for (edge, e) in self.open(s, m) {
                let next = self.moved(s, m, edge);
                let event = match &e.sync {
                    SyncLabel::Internal => None,
                    SyncLabel::Send { event, .. } => Some(*event),
                    _ => continue,
                };
                let other = 1 - m;
                let hurries = self.is_committed(s, m) || !self.is_committed(s, other);
                let hears = |e: &Edge| event.is_some() && e.sync.as_receive().map(|r| r.0) == event;
                let receivers: Vec<usize> =
                    self.open(s, other).filter(|(_, e)| hears(e)).map(|(at, _)| at).collect();
                let targets = match receivers.as_slice() {
                    _ if !hurries && receivers.is_empty() => continue,
                    [] => vec![next],
                    some => some.iter().map(|r| self.moved(&next, other, *r)).collect(),
                };
                all.extend(targets.into_iter().filter(|t| self.stays(t)).map(|t| (m, edge, event, t)));
            }
        }
        all
    }

    /// All states that can be reached.
    fn reachable(&self) -> BTreeSet<GridState> {
        let start = GridState { at: self.automata.map(|a| a.initial.0), x: [0, 0], left: None };
        let mut seen: BTreeSet<GridState> = [start.clone()].into();
        let mut open = VecDeque::from([start]);
        while let Some(s) = open.pop_front() {
            for next in self.transitions(&s).into_iter().map(|t| t.3).chain(self.later(&s)) {
                if seen.insert(next.clone()) {
                    open.push_back(next);
                }
            }
        }
        seen
    }

    /// The stimuli that count at the site: those that the automaton waits for there or does from there, or else all.
    fn counts(&self, program: &Program) -> Vec<usize> {
        let Site { automaton, location, .. } = self.site;
        let person = &self.automata[0].edges;
        let stimulus =
            |e: &Edge| e.sync.as_send().is_some_and(|(event, _)| program.event(event).is_stimulus());
        let all: Vec<usize> = (0..person.len()).filter(|e| stimulus(&person[*e])).collect();
        let own = &self.automata[automaton].edges;
        // `s0` makes `f0`.
        let made = |event: Option<EventId>| event.map(|e| program.event(e).name.replace('s', "f"));
        let waits = |event: Option<EventId>| {
            own.iter().filter(|e| e.from.0 == location).any(|e| {
                let heard = e.sync.as_receive().map(|r| program.event(r.0).name.clone());
                heard.is_some() && heard == made(event)
            })
        };
        let heard =
            |e: &usize| automaton == 0 && person[*e].from.0 == location || waits(person[*e].sync.event());
        let some: Vec<usize> = all.iter().copied().filter(heard).collect();
        if some.is_empty() { all } else { some }
    }

    /// Whether one of these can be done in a state that meets the condition.
    fn possible(
        &self,
        states: &BTreeSet<GridState>,
        counts: &[usize],
        is_it: impl Fn(&GridState) -> bool,
    ) -> bool {
        let does = |s: &GridState| self.transitions(s).iter().any(|t| t.0 == 0 && counts.contains(&t.1));
        states.iter().any(|s| is_it(s) && does(s))
    }
}

/// `R.b: x = 3 s, just before`
fn bound(finding: &BoundFinding) -> i64 {
    let name = finding.id.to_string();
    let time = name.split_once(" = ").and_then(|(_, rest)| rest.split_once(" s,")).map(|(time, _)| time);
    time.and_then(|time| time.parse::<i64>().ok()).unwrap_or_else(|| panic!("{name}")) * SECOND / STEP
}

fn leaving(automaton: &Automaton, location: u16, bound: i64) -> Vec<usize> {
    let here = |c: &&ClockConstraint| c.bound.nanos / STEP == bound;
    let invariant = &automaton.locations[usize::from(location)].invariant;
    let leaves = |e: &Edge| {
        let has = |op| e.clock_guard.iter().filter(here).any(|c| c.op == op);
        let ends = invariant.iter().chain(&e.clock_guard).filter(here).any(|c| c.op == ClockOp::Le);
        e.from.0 == location
            && e.sync.as_receive().is_none()
            && (has(ClockOp::Eq) || has(ClockOp::Ge) && ends)
    };
    (0..automaton.edges.len()).filter(|e| leaves(&automaton.edges[*e])).collect()
}

/// Replays a run on the grid; gives the last state before a stimulus.
fn replayed(grid: &Grid<'_>, program: &Program, finding: &BoundFinding) -> GridState {
    let run = finding.run.as_ref().unwrap();
    let mut state = GridState { at: grid.automata.map(|a| a.initial.0), x: [0, 0], left: None };
    let (mut now, mut before) = (0, None);
    for step in &run.steps {
        assert_eq!(step.time % (STEP * run.ticks), 0, "off the grid: {}", finding.id);
        for _ in 0..(step.time / (STEP * run.ticks) - now) {
            state = grid.later(&state).unwrap_or_else(|| panic!("time may not pass: {}", finding.id));
        }
        now = step.time / (STEP * run.ticks);
        if step.event.as_ref().is_some_and(|(event, _)| program.event(*event).is_stimulus()) {
            before = Some(state.clone());
        }
        let (first, edge) = (step.moves[0].automaton, step.moves[0].edge);
        let target = |t: &(usize, usize, Option<EventId>, GridState)| {
            (t.0, t.1) == (first, edge)
                && step
                    .moves
                    .get(1)
                    .is_none_or(|m| t.3.at[m.automaton] == grid.automata[m.automaton].edges[m.edge].to.0)
        };
        let options = grid.transitions(&state);
        state = options.into_iter().find(target).unwrap_or_else(|| panic!("not possible: {}", finding.id)).3;
    }
    before.unwrap_or_else(|| panic!("no stimulus: {}", finding.id))
}

#[test]
fn what_is_said_of_bounds_is_so_on_the_grid() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let step = boundary_step(&Program::default(), BoundaryStep { by: Some(STEP) });
    let (mut reached, mut beyond, mut unreachable, mut open) = (0, 0, 0, 0);
    for _ in 0..150 {
        let text = scenario(&mut rng);
        let program = compile(InputFile { name: "random", text: &text }, &[]).program;
        let program = program.unwrap_or_else(|| panic!("{text}"));
        let found = bound_findings(&program, &program.networks[0], step, &ProofOptions::default());
        let Ok(found) = found else { continue };
        for finding in &found.findings {
            let automata = [&program.automata[0], &program.automata[1]];
            let (automaton, location, bound) = (finding.automaton, finding.location.0, bound(finding));
            let leaving = leaving(automata[automaton], location, bound);
            let grid = Grid { automata, site: Site { automaton, location, bound, leaving } };
            let (states, counts) = (grid.reachable(), grid.counts(&program));
            let shift = match finding.side {
                BoundSide::Before => -1,
                BoundSide::At => 0,
                BoundSide::After => 1,
            };
            let site = &grid.site;
            let there = |s: &GridState| {
                s.at[site.automaton] == site.location && s.x[site.automaton] == site.bound + shift
            };
            let left = |s: &GridState| finding.side == BoundSide::After && s.left == Some(1);
            match finding.status {
                GoalStatus::Reached => {
                    let before = replayed(&grid, &program, finding);
                    assert!(there(&before) || left(&before), "{}\n{text}", finding.id);
                    beyond += usize::from(!there(&before));
                    reached += 1;
                }
                GoalStatus::Unreachable => {
                    let possible = grid.possible(&states, &counts, |s| there(s) || left(s));
                    assert!(!possible, "{} can be reached\n{text}", finding.id);
                    unreachable += 1;
                }
                GoalStatus::Inconclusive => open += 1,
            }
        }
    }
    assert!(reached > 200 && beyond > 5 && unreachable > 100, "{reached} {beyond} {unreachable}");
    assert!(open * 10 < reached, "{open} of {reached} are inconclusive");
}
