//! Tests by search: one exploration of the network decides every goal; what its witnesses show needs no test of its own.
//!
//! The coverage points are counted by the search itself, so that a bin of a cross product is a condition on states, and
//! no property is written by hand. The goals of a requirement are decided on the network with the requirement's observer.

use hrdsl_ir::{
    Program,
    suite::{PlayerRef, SearchGoal, Suite},
    ta::Network,
};
use hrdsl_results::{GoalReport, GoalStatus};
use hrdsl_ta::{Error, Goal, GoalKind};

use crate::{
    AbstractTest, Harvest,
    covers::{Seen, Shown},
    expand::{Named, counters, goals},
    extract,
};
use hrdsl_prove::{Decided, Fate, Observed, Run, Settings, Watch, decide, held::Held, of_formula};

/// Decides all goals and takes the environment's part of each witness.
///
/// # Errors
/// A network that does not exist or cannot be run.
pub fn harvest(
    program: &Program,
    suite: &Suite,
    network: u16,
    asked: &[SearchGoal],
    settings: &Settings,
) -> Result<Harvest, String> {
    let network = program
        .networks
        .get(network as usize)
        .ok_or_else(|| format!("suite `{}` names no network", suite.name))?;
    let named = goals(program, network, asked);
    let mut harvest = Harvest::default();
    let all: Vec<&Named> = named.iter().collect();
    let (fates, states) = fates(program, network, &all, settings, &mut harvest.notes)
        .map_err(|e| format!("network `{}`: {e}", network.name))?;
    let held_back = held_back(program, network, &named, &fates, settings, states);
    let players: Vec<PlayerRef> = network.automata.iter().map(|a| PlayerRef::Automaton(*a)).collect();
    let awaits = extract::Awaits::of(program, &players);
    for ((named, fate), held_back) in named.iter().zip(&fates).zip(held_back) {
        let (status, mut reason) = said(fate, states);
        if let Some(why) = held_back {
            reason = format!("{reason}; {why}");
        }
        if let Fate::Reached(run) = fate {
            harvest.tests.push(test(program, suite, &awaits, named, run));
        }
        harvest.goals.push(GoalReport { goal: named.name.clone(), status, reason, test: None });
    }
    note_reached(program, network, &named, &fates, &mut harvest.tests);
    Ok(harvest)
}

fn test(
    program: &Program,
    suite: &Suite,
    awaits: &extract::Awaits,
    named: &Named,
    run: &Run,
) -> AbstractTest {
    let trace = run.witness.trace();
    AbstractTest {
        steps: extract::steps(program, awaits, &trace, suite.patience),
        because: vec![format!("witness of {}", named.name)],
        predicts: extract::covered(program, &trace).cross_names(&program.coverage),
        ..AbstractTest::default()
    }
}

/// Which goals each test's run reaches.
fn note_reached(
    program: &Program,
    network: &Network,
    named: &[Named],
    fates: &[Fate],
    tests: &mut [AbstractTest],
) {
    let initial: Vec<_> =
        network.automata.iter().map(|id| program.automata[usize::from(id.0)].initial).collect();
    let reached = fates.iter().enumerate().filter_map(|(goal, fate)| match fate {
        Fate::Reached(run) => Some((goal, run)),
        Fate::Unreachable | Fate::Open(_) => None,
    });
    for ((own, run), test) in reached.zip(tests) {
        let seen = Seen::of(program, &initial, &run.witness, test.predicts.clone());
        let shows = |goal: usize| goal == own || named[goal].shown.iter().any(|s| seen.has(s));
        test.reaches = (0..named.len()).filter(|goal| shows(*goal)).collect();
    }
}

/// For each goal: why nothing reaches it, if it is that holds take no time.
fn held_back(
    program: &Program,
    network: &Network,
    named: &[Named],
    decided: &[Fate],
    settings: &Settings,
    states: usize,
) -> Vec<Option<String>> {
    let mut reasons = vec![None; named.len()];
    let open: Vec<usize> =
        (0..named.len()).filter(|goal| matches!(decided[*goal], Fate::Unreachable)).collect();
    if open.is_empty() {
        return reasons;
    }
    let Some(held) = Held::of(program, network) else { return reasons };
    let questions: Vec<&Named> = open.iter().map(|goal| &named[*goal]).collect();
    let settings = Held::settings(settings, states);
    // A fault of this network is none of the model's.
    let Ok((fates, _)) = fates(&held.program, network, &questions, &settings, &mut Vec::new()) else {
        return reasons;
    };
    for (goal, fate) in open.into_iter().zip(fates) {
        if let Fate::Reached(run) = fate {
            reasons[goal] = held.because(&run.witness);
        }
    }
    reasons
}

fn said(fate: &Fate, states: usize) -> (GoalStatus, String) {
    match fate {
        Fate::Reached(run) => (GoalStatus::Reached, format!("in {} steps", run.witness.steps.len())),
        Fate::Unreachable => (
            GoalStatus::Unreachable,
            format!("proved: none of the {states} symbolic states that the model can reach meets it"),
        ),
        Fate::Open(why) => (GoalStatus::Open, why.clone()),
    }
}

/// What a search must keep besides the state, so that goals that need more do not burden the others.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Needs {
    Nothing,
    LastEdges,
    LastDefinitions,
}

fn needs(goal: &Goal) -> Needs {
    match goal.what {
        GoalKind::Pair { .. } => Needs::LastEdges,
        GoalKind::Use { .. } => Needs::LastDefinitions,
        GoalKind::Edge { .. } | GoalKind::Location { .. } | GoalKind::Condition(_) | GoalKind::Formula(_) => {
            Needs::Nothing
        }
    }
}

/// Decides all goals: those of the network alone in one exploration, pairs and uses in one each, and those of each
/// requirement in one of its own.
fn fates(
    program: &Program,
    network: &Network,
    named: &[&Named],
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<(Vec<Fate>, usize), Error> {
    let plain = Observed::new(program, network);
    let questions: Vec<Goal> = named.iter().flat_map(|n| n.ways.iter().cloned()).collect();
    let mut decided = Decided { fates: Vec::new(), states: 0, visited: 0, searches: 0 };
    let mut ways: Vec<Fate> = vec![Fate::Unreachable; questions.len()];
    for need in [Needs::Nothing, Needs::LastEdges, Needs::LastDefinitions] {
        let of: Vec<usize> = (0..questions.len()).filter(|q| needs(&questions[*q]) == need).collect();
        if of.is_empty() {
            continue;
        }
        let some: Vec<Goal> = of.iter().map(|q| questions[*q].clone()).collect();
        let counters = if need == Needs::Nothing { counters(program) } else { Vec::new() };
        let more = decide(program, &plain, &some, &counters, settings, &Watch::default())?;
        decided.states += more.states;
        decided.visited += more.visited;
        decided.searches += more.searches;
        for (question, fate) in of.into_iter().zip(more.fates) {
            ways[question] = fate;
        }
    }
    let alone = named.iter().filter(|n| n.monitor.is_none()).count();
    notes.push(format!(
        "network `{}`: {} symbolic states stored, {} visited, for {alone} goals in {}",
        network.name,
        decided.states,
        decided.visited,
        match decided.searches {
            0 | 1 => "one exploration".to_owned(),
            n => format!("{n} explorations"),
        }
    ));
    let (states, mut ways) = (decided.states, ways.into_iter());
    let mut fates = Vec::new();
    for goal in named {
        fates.push(match goal.monitor {
            None => any(ways.by_ref().take(goal.ways.len())),
            Some(monitor) => of_requirement(program, network, monitor, &goal.shown, settings)?,
        });
    }
    Ok((fates, states))
}

/// The fate of a goal to which there are several ways.
fn any(ways: impl Iterator<Item = Fate>) -> Fate {
    let mut fate = Fate::Unreachable;
    for way in ways {
        fate = match (fate, way) {
            (Fate::Reached(run), _) | (_, Fate::Reached(run)) => Fate::Reached(run),
            (Fate::Open(why), _) | (_, Fate::Open(why)) => Fate::Open(why),
            (Fate::Unreachable, Fate::Unreachable) => Fate::Unreachable,
        };
    }
    fate
}

fn of_requirement(
    program: &Program,
    network: &Network,
    monitor: usize,
    shown: &[Shown],
    settings: &Settings,
) -> Result<Fate, Error> {
    let mut observed = Observed::new(program, network);
    let verdicts = match observed.add(&program.monitors[monitor]) {
        Ok(verdicts) => verdicts,
        Err(why) => return Ok(Fate::Open(why)),
    };
    let formula = if shown.iter().any(|s| matches!(s, Shown::Violation(_))) {
        verdicts.violated
    } else {
        Some(verdicts.triggered)
    };
    let Some(formula) = formula else { return Ok(Fate::Unreachable) };
    let Decided { mut fates, .. } =
        decide(program, &observed, &[of_formula(&formula)], &[], settings, &Watch::default())?;
    Ok(fates.pop().unwrap_or(Fate::Unreachable))
}
