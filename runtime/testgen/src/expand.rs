//! What a suite by search asks for, as goals of the search: one name for each, and what a run must show.

use hrdsl_ir::{
    Expr, Program,
    coverage::{BinCondition, BinName, CoverCross},
    expr::BinaryOp,
    monitor::RequirementId,
    suite::SearchGoal,
    ta::{Automaton, AutomatonId, AutomatonVar, LocationId, Network, QueryFormula, QueryKind},
};
use hrdsl_results::{RequirementName, SuiteGoalId};
use hrdsl_ta::{EventCounter, GoalKind, StateFormula};

use crate::{
    combinations::combinations,
    covers::WitnessedGoal,
    flow,
    named::{NamedGoal, declared, edge_name, is_generated},
};
use hrdsl_prove as prove;

/// The goals of a suite, each once.
pub fn goals(program: &Program, network: &Network, asked: &[SearchGoal]) -> Vec<NamedGoal> {
    let mut all: Vec<NamedGoal> = Vec::new();
    for goal in asked.iter().flat_map(|g| of(program, network, g)) {
        if all.iter().all(|known| known.id != goal.id) {
            all.push(goal);
        }
    }
    all
}

/// One counter for each coverpoint, up to where its bins no longer tell numbers apart.
pub fn counters(program: &Program) -> Vec<EventCounter> {
    let cap = |point: &hrdsl_ir::coverage::Coverpoint| {
        point.bins.iter().map(|b| b.hi.map_or(b.lo, |hi| hi + 1).max(b.lo)).max().unwrap_or(0)
    };
    let counter = |point: &hrdsl_ir::coverage::Coverpoint| EventCounter {
        patterns: point.count.clone(),
        cap: cap(point),
    };
    program.coverage.points.iter().map(counter).collect()
}

fn of(program: &Program, network: &Network, goal: &SearchGoal) -> Vec<NamedGoal> {
    match goal {
        SearchGoal::Bins(cross) => {
            program.coverage.crosses.get(usize::from(cross.0)).map_or_else(Vec::new, |c| bins(program, c))
        }
        SearchGoal::Locations => each_automaton(program, network, locations),
        SearchGoal::Edges => each_automaton(program, network, edges),
        SearchGoal::Pairs => each_automaton(program, network, flow::pairs),
        SearchGoal::Uses => flow::uses(program, network),
        SearchGoal::Values => values(program, network),
        SearchGoal::Combinations(all) => combinations(all),
        // Each has a question of its own: see `bounds`.
        SearchGoal::Bounds(_) => Vec::new(),
        SearchGoal::Violation(id) => {
            requirement(program, *id, SuiteGoalId::Violation, WitnessedGoal::Violation)
        }
        SearchGoal::Trigger(id) => requirement(program, *id, SuiteGoalId::Trigger, WitnessedGoal::Trigger),
        SearchGoal::Query(id) => {
            let Some(query) = program.queries.get(usize::from(id.0)) else { return Vec::new() };
            let QueryKind::Possibly(formula) = &query.ask else { return Vec::new() };
            let goal = prove::of_formula(formula);
            let id = SuiteGoalId::Query(query.name.clone());
            vec![NamedGoal::one(id, goal.what, false, WitnessedGoal::State(Box::new(formula.clone())))]
        }
    }
}

fn requirement(
    program: &Program,
    id: RequirementId,
    goal: fn(RequirementName) -> SuiteGoalId,
    shown: fn(usize) -> WitnessedGoal,
) -> Vec<NamedGoal> {
    let at = usize::from(id.0);
    let Some(requirement) = program.monitors.get(at) else { return Vec::new() };
    let id = goal(requirement.name.as_str().into());
    vec![NamedGoal { id, alternatives: Vec::new(), shown: vec![shown(at)], monitor: Some(at) }]
}

fn each_automaton(
    program: &Program,
    network: &Network,
    f: impl Fn(usize, &Automaton) -> Vec<NamedGoal>,
) -> Vec<NamedGoal> {
    let of = |(index, id): (usize, &AutomatonId)| f(index, &program.automata[id.0 as usize]);
    network.automata.iter().enumerate().flat_map(of).collect()
}

fn locations(index: usize, automaton: &Automaton) -> Vec<NamedGoal> {
    let ids = (0u16..).map(LocationId).zip(&automaton.locations);
    let named = ids.filter(|(_, l)| !is_generated(&l.name)).map(|(location, l)| {
        let what = GoalKind::Location { automaton: index, location };
        let id = SuiteGoalId::Location(format!("{}.{}", automaton.name, l.name));
        NamedGoal::one(id, what, false, WitnessedGoal::Location(index, location))
    });
    named.collect()
}

fn edges(index: usize, automaton: &Automaton) -> Vec<NamedGoal> {
    let named = declared(automaton).into_iter().map(|(number, edge)| {
        let what = GoalKind::Edge { automaton: index, edge };
        let name = edge_name(automaton, number, edge);
        let id = SuiteGoalId::Edge(format!("{}: {name}", automaton.name));
        NamedGoal::one(id, what, false, WitnessedGoal::Edge(index, edge))
    });
    named.collect()
}

/// A variable of more values is a counter or a time, and its values are no cases.
const MOST_VALUES: i64 = 16;

/// Each value of each variable that has few.
fn values(program: &Program, network: &Network) -> Vec<NamedGoal> {
    let members = network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0)));
    let vars = program.shared.iter().chain(members.flat_map(|a| &a.vars));
    let slots = (0u16..).zip(vars.zip(hrdsl_ta::slot_names(program, network)));
    let few = |var: &AutomatonVar| var.hi - var.lo < MOST_VALUES && !is_generated(&var.name);
    let of = |(slot, (var, name)): (u16, (&AutomatonVar, String))| {
        let each = (var.lo..=var.hi).filter_map(|n| var.value(n)).map(move |value| {
            let is = Expr::binary(BinaryOp::Eq, Expr::Var(slot), Expr::Const(value));
            let shown = WitnessedGoal::State(Box::new(QueryFormula::Data(is.clone())));
            let what = GoalKind::Condition(StateFormula::Data(is));
            let id = SuiteGoalId::Value(format!("{name} = {value}"));
            NamedGoal::one(id, what, false, shown)
        });
        each.collect::<Vec<_>>()
    };
    slots.filter(|(_, (var, _))| few(var)).flat_map(of).collect()
}

// ── bins ──

/// A bin holds where its condition does and none of the cross's `ignore`s.
fn bins(program: &Program, cross: &CoverCross) -> Vec<NamedGoal> {
    let ignored = cross.ignore.iter().map(|c| StateFormula::Not(Box::new(formula(program, c))));
    let ignored: Vec<StateFormula> = ignored.collect();
    let named = cross.bins.iter().map(|bin| {
        let mut all = vec![formula(program, &bin.when)];
        all.extend(ignored.iter().cloned());
        let name = BinName::new(&cross.name, &bin.name);
        NamedGoal::one(
            SuiteGoalId::Bin(name.clone()),
            GoalKind::Condition(StateFormula::And(all)),
            true,
            WitnessedGoal::Bin(name),
        )
    });
    named.collect()
}

/// The condition over the counters: counter i is point i.
fn formula(program: &Program, condition: &BinCondition) -> StateFormula {
    match condition {
        BinCondition::In { point, bin } => {
            let point = point.0 as usize;
            let bin = &program.coverage.points[point].bins[*bin as usize];
            StateFormula::CounterIn { counter: point, lo: bin.lo, hi: bin.hi }
        }
        BinCondition::Not(c) => StateFormula::Not(Box::new(formula(program, c))),
        BinCondition::And(cs) => StateFormula::And(cs.iter().map(|c| formula(program, c)).collect()),
        BinCondition::Or(cs) => StateFormula::Or(cs.iter().map(|c| formula(program, c)).collect()),
    }
}
