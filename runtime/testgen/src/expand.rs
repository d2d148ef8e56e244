//! What a suite by search asks for, as goals of the search: one name for each, and what a run must show.

use hrdsl_ir::{
    Program,
    coverage::{BinName, Condition, Cross},
    suite::SearchGoal,
    ta::{Ask, Automaton, AutomatonId, LocationId, Network},
};
use hrdsl_results::GoalName;
use hrdsl_ta::{Counter, Goal, GoalKind, StateFormula};

use crate::{covers::Shown, flow};
use hrdsl_prove as prove;

/// A goal with its name for people. It is reached if one of the ways to it is.
pub struct Named {
    pub name: GoalName,
    pub ways: Vec<Goal>,
    /// Each with the way of the same place.
    pub shown: Vec<Shown>,
    /// Index of the requirement whose observer it needs.
    pub monitor: Option<usize>,
}

impl Named {
    pub(super) fn one(name: impl Into<GoalName>, what: GoalKind, settled: bool, shown: Shown) -> Self {
        Self { name: name.into(), ways: vec![Goal { what, settled }], shown: vec![shown], monitor: None }
    }
}

/// The goals of a suite, each once.
pub fn goals(program: &Program, network: &Network, asked: &[SearchGoal]) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    for goal in asked.iter().flat_map(|g| of(program, network, g)) {
        if all.iter().all(|known| known.name != goal.name) {
            all.push(goal);
        }
    }
    all
}

/// One counter for each coverage point, up to where its bins no longer tell numbers apart.
pub fn counters(program: &Program) -> Vec<Counter> {
    let cap = |point: &hrdsl_ir::coverage::Point| {
        point.bins.iter().map(|b| b.hi.map_or(b.lo, |hi| hi + 1).max(b.lo)).max().unwrap_or(0)
    };
    let counter =
        |point: &hrdsl_ir::coverage::Point| Counter { patterns: point.count.clone(), cap: cap(point) };
    program.coverage.points.iter().map(counter).collect()
}

fn of(program: &Program, network: &Network, goal: &SearchGoal) -> Vec<Named> {
    match goal {
        SearchGoal::Bins { cross } => {
            program.coverage.crosses.get(*cross as usize).map_or_else(Vec::new, |c| bins(program, c))
        }
        SearchGoal::Locations => each_automaton(program, network, locations),
        SearchGoal::Edges => each_automaton(program, network, edges),
        SearchGoal::Pairs => each_automaton(program, network, flow::pairs),
        SearchGoal::Uses => flow::uses(program, network),
        SearchGoal::Violation { monitor } => requirement(program, *monitor, "violation", Shown::Violation),
        SearchGoal::Trigger { monitor } => requirement(program, *monitor, "trigger", Shown::Trigger),
        SearchGoal::Query { query } => {
            let Some(query) = program.queries.get(usize::from(*query)) else { return Vec::new() };
            let Ask::Possibly(formula) = &query.ask else { return Vec::new() };
            let goal = prove::of_formula(formula);
            vec![Named::one(format!("query {}", query.name), goal.what, false, Shown::Nothing)]
        }
    }
}

fn requirement(program: &Program, monitor: u16, what: &str, shown: fn(usize) -> Shown) -> Vec<Named> {
    let at = usize::from(monitor);
    let Some(requirement) = program.monitors.get(at) else { return Vec::new() };
    let name = GoalName::from(format!("{what} of {}", requirement.name));
    vec![Named { name, ways: Vec::new(), shown: vec![shown(at)], monitor: Some(at) }]
}

fn each_automaton(
    program: &Program,
    network: &Network,
    f: impl Fn(usize, &Automaton) -> Vec<Named>,
) -> Vec<Named> {
    let of = |(index, id): (usize, &AutomatonId)| f(index, &program.automata[id.0 as usize]);
    network.automata.iter().enumerate().flat_map(of).collect()
}

fn locations(index: usize, automaton: &Automaton) -> Vec<Named> {
    let ids = (0u16..).map(LocationId).zip(&automaton.locations);
    let named = ids.filter(|(_, l)| !is_generated(&l.name)).map(|(location, l)| {
        let what = GoalKind::Location { automaton: index, location };
        let name = format!("location {}.{}", automaton.name, l.name);
        Named::one(name, what, false, Shown::Location(index, location))
    });
    named.collect()
}

fn edges(index: usize, automaton: &Automaton) -> Vec<Named> {
    let named = declared(automaton).into_iter().map(|(number, edge)| {
        let what = GoalKind::Edge { automaton: index, edge };
        let name = format!("edge {}: {}", automaton.name, edge_name(automaton, number, edge));
        Named::one(name, what, false, Shown::Edge(index, edge))
    });
    named.collect()
}

/// Edges that were written, with their numbers in the source from 1.
pub(super) fn declared(automaton: &Automaton) -> Vec<(usize, usize)> {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let written = automaton.edges.iter().enumerate().filter(|(_, e)| !is_generated(name(e.from)));
    (1..).zip(written.map(|(edge, _)| edge)).collect()
}

/// `sense -> decide (edge 3)`
pub(super) fn edge_name(automaton: &Automaton, number: usize, edge: usize) -> String {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let e = &automaton.edges[edge];
    format!("{} -> {} (edge {number})", name(e.from), name(final_target(automaton, e.to)))
}

/// Locations that the compiler put into an edge have a `~` in their name; so have variables.
pub(super) fn is_generated(name: &str) -> bool {
    name.contains('~')
}

/// Where an edge leads to in the source: through generated locations.
fn final_target(automaton: &Automaton, mut to: LocationId) -> LocationId {
    for _ in 0..automaton.locations.len() {
        if !is_generated(&automaton.locations[to.0 as usize].name) {
            break;
        }
        let Some(next) = automaton.edges.iter().find(|e| e.from == to) else { break };
        to = next.to;
    }
    to
}

// ── bins ──

/// A bin holds where its condition does and none of the cross's `ignore`s.
fn bins(program: &Program, cross: &Cross) -> Vec<Named> {
    let ignored = cross.ignore.iter().map(|c| StateFormula::Not(Box::new(formula(program, c))));
    let ignored: Vec<StateFormula> = ignored.collect();
    let named = cross.bins.iter().map(|bin| {
        let mut all = vec![formula(program, &bin.when)];
        all.extend(ignored.iter().cloned());
        let name = BinName::new(&cross.name, &bin.name);
        Named::one(
            GoalName::of_bin(&name),
            GoalKind::Condition(StateFormula::And(all)),
            true,
            Shown::Bin(name),
        )
    });
    named.collect()
}

/// The condition over the counters: counter i is point i.
fn formula(program: &Program, condition: &Condition) -> StateFormula {
    match condition {
        Condition::In { point, bin } => {
            let point = point.0 as usize;
            let bin = &program.coverage.points[point].bins[*bin as usize];
            StateFormula::CounterIn { counter: point, lo: bin.lo, hi: bin.hi }
        }
        Condition::Not(c) => StateFormula::Not(Box::new(formula(program, c))),
        Condition::And(cs) => StateFormula::And(cs.iter().map(|c| formula(program, c)).collect()),
        Condition::Or(cs) => StateFormula::Or(cs.iter().map(|c| formula(program, c)).collect()),
    }
}
