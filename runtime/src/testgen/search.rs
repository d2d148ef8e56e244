//! Tests by search: one exploration of the network decides every goal; each witness becomes a test.
//!
//! The coverage points are counted by the search itself, so that a bin of a cross product is a condition on states, and
//! no property is written by hand.

use hrdsl_ir::{
    Program,
    coverage::{Condition, Cross},
    suite::{PlayerRef, SearchGoal, Suite},
    ta::{AutomatonId, LocationId, Network},
};
use hrdsl_ta::{Budget, Counter, Exhausted, Goal, GoalKind, Limit, Outcome, Report, StateFormula};

use super::{AbstractTest, GoalReport, GoalStatus, Harvest, extract};

/// A goal with its name for people.
struct Named {
    name: String,
    goal: Goal,
}

/// Decides all goals and takes the environment's part of each witness.
///
/// # Errors
/// A network that does not exist or cannot be run.
pub fn harvest(
    program: &Program,
    suite: &Suite,
    network: u16,
    goals: &[SearchGoal],
) -> Result<Harvest, String> {
    let network = program
        .networks
        .get(network as usize)
        .ok_or_else(|| format!("suite `{}` names no network", suite.name))?;
    let named: Vec<Named> = goals.iter().flat_map(|goal| expand(program, network, goal)).collect();
    let questions: Vec<Goal> = named.iter().map(|n| n.goal.clone()).collect();
    let report = hrdsl_ta::check(
        program,
        network,
        &questions,
        &counters(program),
        &limits(program),
        Budget::default(),
    )
    .map_err(|e| format!("network `{}`: {e}", network.name))?;
    let mut harvest = Harvest::default();
    harvest.notes.extend(windowed_assumptions(program));
    harvest.notes.push(format!(
        "network `{}`: {} symbolic states stored, {} visited, for {} goals in one exploration",
        network.name,
        report.states_stored,
        report.states_visited,
        named.len()
    ));
    let players: Vec<PlayerRef> = network.automata.iter().map(|a| PlayerRef::Automaton(*a)).collect();
    let awaits = extract::Awaits::of(program, &players);
    for (named, outcome) in named.iter().zip(&report.goals) {
        let (status, reason) = fate(outcome, &report);
        if let Outcome::Reached(witness) = outcome {
            let trace = witness.trace();
            harvest.tests.push(AbstractTest {
                steps: extract::steps(program, &awaits, &trace, suite.patience),
                because: vec![format!("witness of {}", named.name)],
                predicts: extract::covered(program, &trace).cross_names(&program.coverage),
                ..AbstractTest::default()
            });
        }
        harvest.goals.push(GoalReport { goal: named.name.clone(), status, reason });
    }
    Ok(harvest)
}

fn fate(outcome: &Outcome, report: &Report) -> (GoalStatus, String) {
    match outcome {
        Outcome::Reached(witness) => (GoalStatus::Reached, format!("in {} steps", witness.steps.len())),
        Outcome::Unreachable => (
            GoalStatus::Unreachable,
            format!(
                "proved: none of the {} symbolic states that the model can reach meets it",
                report.states_stored
            ),
        ),
        Outcome::Open(Exhausted::States) => (GoalStatus::Open, "the budget of states was used up".to_owned()),
        Outcome::Open(Exhausted::Memory) => (GoalStatus::Open, "the budget of memory was used up".to_owned()),
        Outcome::Open(Exhausted::Stopped) => (GoalStatus::Open, "the search was stopped".to_owned()),
    }
}

/// One counter for each coverage point, up to where its bins no longer tell numbers apart.
fn counters(program: &Program) -> Vec<Counter> {
    let cap = |point: &hrdsl_ir::coverage::Point| {
        point.bins.iter().map(|b| b.hi.map_or(b.lo, |hi| hi + 1).max(b.lo)).max().unwrap_or(0)
    };
    let counter =
        |point: &hrdsl_ir::coverage::Point| Counter { patterns: point.count.clone(), cap: cap(point) };
    program.coverage.points.iter().map(counter).collect()
}

fn limits(program: &Program) -> Vec<Limit> {
    let limit = |a: &hrdsl_ir::monitor::Assumption| Limit {
        patterns: a.events.clone(),
        at_most: i64::from(a.at_most),
    };
    program.assumptions.iter().map(limit).collect()
}

/// A window is searched as if it were the whole test: nothing that is generated breaks the assumption, but what only a
/// later window allows is not found.
fn windowed_assumptions(program: &Program) -> Vec<String> {
    let windowed = program.assumptions.iter().filter(|a| a.within.is_some());
    windowed.map(|a| format!("`{}` is searched with the whole test as its window", a.text)).collect()
}

fn expand(program: &Program, network: &Network, goal: &SearchGoal) -> Vec<Named> {
    match goal {
        SearchGoal::Bins { cross } => {
            program.coverage.crosses.get(*cross as usize).map_or_else(Vec::new, |c| bins(program, c))
        }
        SearchGoal::Pairs
        | SearchGoal::Uses
        | SearchGoal::Violation { .. }
        | SearchGoal::Trigger { .. }
        | SearchGoal::Query { .. } => Vec::new(),
        SearchGoal::Locations => each_automaton(program, network, |index, automaton| {
            let ids = (0u16..).map(LocationId).zip(&automaton.locations);
            let declared = ids.filter(|(_, l)| !is_generated(&l.name));
            let named = declared.map(|(id, l)| Named {
                name: format!("location {}.{}", automaton.name, l.name),
                goal: Goal { what: GoalKind::Location { automaton: index, location: id }, settled: false },
            });
            named.collect()
        }),
        SearchGoal::Edges => each_automaton(program, network, |index, automaton| {
            let name = |id: LocationId| automaton.locations[id.0 as usize].name.as_str();
            let declared = automaton.edges.iter().enumerate().filter(|(_, e)| !is_generated(name(e.from)));
            let named = declared.zip(1..).map(|((edge, e), number): (_, usize)| {
                let to = final_target(automaton, e.to);
                Named {
                    name: format!(
                        "edge {}: {} -> {} (edge {number})",
                        automaton.name,
                        name(e.from),
                        name(to)
                    ),
                    goal: Goal { what: GoalKind::Edge { automaton: index, edge }, settled: false },
                }
            });
            named.collect()
        }),
    }
}

/// Locations that the compiler put into an edge have a `~` in their name.
fn is_generated(name: &str) -> bool {
    name.contains('~')
}

/// Where an edge leads to in the source: through generated locations.
fn final_target(automaton: &hrdsl_ir::ta::Automaton, mut to: LocationId) -> LocationId {
    for _ in 0..automaton.locations.len() {
        if !is_generated(&automaton.locations[to.0 as usize].name) {
            break;
        }
        let Some(next) = automaton.edges.iter().find(|e| e.from == to) else { break };
        to = next.to;
    }
    to
}

fn each_automaton(
    program: &Program,
    network: &Network,
    f: impl Fn(usize, &hrdsl_ir::ta::Automaton) -> Vec<Named>,
) -> Vec<Named> {
    let of = |(index, id): (usize, &AutomatonId)| f(index, &program.automata[id.0 as usize]);
    network.automata.iter().enumerate().flat_map(of).collect()
}

/// What the goal of a bin is called, by the bin's name.
#[must_use]
pub fn bin_goal(bin: &str) -> String {
    format!("bin {bin}")
}

/// A bin holds where its condition does and none of the cross's `ignore`s.
fn bins(program: &Program, cross: &Cross) -> Vec<Named> {
    let ignored = cross.ignore.iter().map(|c| StateFormula::Not(Box::new(formula(program, c))));
    let ignored: Vec<StateFormula> = ignored.collect();
    let named = cross.bins.iter().map(|bin| {
        let mut all = vec![formula(program, &bin.when)];
        all.extend(ignored.iter().cloned());
        Named {
            name: bin_goal(&hrdsl_coverage::name::bin(&cross.name, &bin.name)),
            goal: Goal { what: GoalKind::Condition(StateFormula::And(all)), settled: true },
        }
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
