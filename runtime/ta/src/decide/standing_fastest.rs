//! Fastest witnesses where clocks stand still.
//!
//! A linear program tells the least end of all runs along a path. Then the goal is asked for once more, in the network beside an automaton of
//! one location and a clock that is never set and never stands: a run that ends before that. If there is none, the first was as fast as any.

use hrdsl_ir::{
    Program, Span,
    ta::{
        Automaton, AutomatonId, ClockConstraint, ClockId, ClockOp, Location, LocationId, LocationKind,
        Network, QueryFormula, TimeSum,
    },
};

use crate::{
    decide::stopwatch,
    network::{
        graph::ZoneGraph,
        model::{CompiledNetwork, ObservationOptions},
        query::{GoalKind, ReachabilityGoal, SearchBudget},
    },
    search::{options::SearchOptions, report::GoalOutcome},
    witness::{
        build::{path_of, takes, ways, witness},
        error::SearchError,
        run::WitnessRun,
        schedule::ScheduleOptions,
        standing::ClockExtremum,
    },
};

/// So many faster runs are looked for at most.
const QUESTIONS: usize = 64;

/// The least end of the runs along a path.
struct LeastEnd {
    nanos: i64,
    attained: bool,
}

/// A run that meets the goal as early as any, given one that meets it; `None`: it is not known to be found.
///
/// # Errors
/// If the model is at fault, or the engine contradicts itself.
pub(super) fn fastest(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    known: &WitnessRun,
    budget: SearchBudget,
) -> Result<Option<Box<WitnessRun>>, SearchError> {
    let mut best = known.clone();
    for _ in 0..QUESTIONS {
        let Some(end) = least_end(model, goal, &best)? else { return Ok(None) };
        let faster = if end.attained && end.nanos == 0 {
            GoalOutcome::Unreachable
        } else {
            ask(model, goal, &end, budget)?
        };
        match faster {
            GoalOutcome::Reached(run) => best = *run,
            GoalOutcome::Inconclusive(_) => return Ok(None),
            GoalOutcome::Unreachable => {
                let (path, _) = path_of(model, &best)?;
                let run = witness(model, path, Some(goal), ScheduleOptions::default())?;
                return Ok(Some(Box::new(run)));
            }
        }
    }
    Ok(None)
}

/// `None`: it is no whole number of nanoseconds.
fn least_end(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    run: &WitnessRun,
) -> Result<Option<LeastEnd>, SearchError> {
    let graph = ZoneGraph::new(model, &[])?;
    let (path, _) = path_of(model, run)?;
    let stops = takes(path.into_iter().map(std::rc::Rc::new));
    let formula = goal.formula().filter(|f| f.is_timed());
    let mut best: Option<(i128, i128, bool)> = None;
    for way in ways(&graph, stops, formula.as_ref())? {
        // The clock after those of the network is the time since the start.
        let Some(ClockExtremum::At { units, over, attained }) = way.extremum(model.dim, false)? else {
            continue;
        };
        let better =
            best.is_none_or(|(u, o, a)| units * o < u * over || (units * o == u * over && attained && !a));
        if better {
            best = Some((units, over, attained));
        }
    }
    let Some((units, over, attained)) = best else {
        return Err(SearchError::Internal("the path of a run does not meet its goal".into()));
    };
    let exact = units * i128::from(model.unit);
    let nanos = i64::try_from(exact / over).ok().filter(|_| exact % over == 0);
    Ok(nanos.map(|nanos| LeastEnd { nanos, attained }))
}

/// Looks for a run to the goal that ends earlier.
fn ask(
    model: &CompiledNetwork,
    goal: &ReachabilityGoal,
    end: &LeastEnd,
    budget: SearchBudget,
) -> Result<GoalOutcome, SearchError> {
    let op = if end.attained { ClockOp::Lt } else { ClockOp::Le };
    let early = |clock| ClockConstraint { clock, minus: None, op, bound: TimeSum::constant(end.nanos) };
    // Where time may not pass nothing may happen any more, so that a deadlock is asked for at its time instead.
    let asks_deadlock = goal.formula().is_some_and(|f| f.asks_deadlock());
    let mut goal = goal.clone();
    if let GoalKind::Formula(formula) = &mut goal.what {
        let time = QueryFormula::Clock(early(ClockId(model.clocks() as u16)));
        *formula = QueryFormula::And(vec![formula.clone(), time]);
    }
    let own = early(ClockId(model.program.clocks.len() as u16));
    let (program, network) = beside_time(model, (!asks_deadlock).then_some(own));
    let formulas = match &goal.what {
        GoalKind::Formula(formula) => vec![formula.clone()],
        GoalKind::Location { .. }
        | GoalKind::Edge { .. }
        | GoalKind::Pair { .. }
        | GoalKind::Use { .. }
        | GoalKind::Condition(_) => Vec::new(),
    };
    let observe = ObservationOptions {
        counters: model.counters.clone(),
        limits: model.limits.clone(),
        formulas,
        ..ObservationOptions::default()
    };
    let timed = CompiledNetwork::new(&program, &network, &observe)?;
    let options = SearchOptions { budget, ..SearchOptions::default() };
    let mut report = stopwatch::explore(&timed, &[goal], &options, &|_| true)?;
    report.goals.pop().ok_or_else(|| SearchError::Internal("a goal has no outcome".into()))
}

/// The network beside an automaton that does nothing, with a clock of its own, which is the network's last.
fn beside_time(model: &CompiledNetwork, invariant: Option<ClockConstraint>) -> (Program, Network) {
    let mut program = model.program.clone();
    let number = |of: &Automaton| model.program.automata.iter().position(|a| std::ptr::eq(a, of));
    let members = model.members.iter().filter_map(|m| number(m.automaton));
    let mut automata: Vec<AutomatonId> = members.map(|n| AutomatonId(n as u16)).collect();
    automata.push(AutomatonId(program.automata.len() as u16));
    let location = Location {
        name: "passes".into(),
        kind: LocationKind::Normal,
        invariant: invariant.into_iter().collect(),
        holds: None,
        stopped: Vec::new(),
        origin: Span::default(),
    };
    program.automata.push(Automaton {
        name: "Time".into(),
        actor: None,
        clocks: vec!["since_start".into()],
        vars: Vec::new(),
        locations: vec![location],
        initial: LocationId(0),
        edges: Vec::new(),
        origin: Span::default(),
    });
    (program, Network { name: model.name.clone(), automata, origin: Span::default() })
}
