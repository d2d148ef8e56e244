//! Queries of a scenario, answered about their networks.

use hrdsl_ir::{
    Program,
    ta::{Ask, Formula, Network, Query},
};
use hrdsl_ta::{Answer, Error, Extremum, Goal, Manner, Outcome, Quantity, Reach, Verdict};

use super::{
    Observed, Run, Settings, Watch,
    goals::{exhausted, of_formula},
    held::Held,
    settings::search,
};

/// What became of a query.
#[derive(Clone, Debug)]
pub struct Answered {
    /// Index into [`Program::queries`].
    pub query: usize,
    pub found: Found,
    /// Shows it, if a run can.
    pub run: Option<Box<Run>>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// Symbolic states stored, if that is known.
    pub states: Option<usize>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    Satisfied,
    NotSatisfied,
    /// Of a `sup` or `inf`, for each measure.
    Bounds(Vec<String>),
    /// Not decided: why.
    Open(String),
    /// The model is at fault, and where.
    Fault(String),
}

/// Answers a query. It is about the network alone: assumptions do not restrict it.
///
/// # Errors
/// If the engine contradicts itself, or there is no such query.
pub fn answer(
    program: &Program,
    query: usize,
    settings: &Settings,
    watch: &Watch,
) -> Result<Answered, String> {
    let asked = program.queries.get(query).ok_or_else(|| format!("there is no query {query}"))?;
    let network = program
        .networks
        .get(usize::from(asked.network))
        .ok_or_else(|| format!("query `{}` is about no network", asked.name))?;
    let plain = Observed::new(program, network);
    let result = match reachability(&asked.ask) {
        Some(goal) => by_search(&plain, &[(query, goal)], settings, watch).map(|mut all| all.remove(0)),
        None => in_general(program, network, asked, settings).map(|a| told(&plain, query, &asked.ask, a)),
    };
    match result {
        Ok(answered) => Ok(answered),
        Err(Error::Model { error, witness }) => Ok(Answered {
            query,
            found: Found::Fault(error.to_string()),
            run: witness.map(|witness| Box::new(Run { observed: plain, witness: *witness })),
            notes: Vec::new(),
            states: None,
        }),
        Err(Error::Internal(what)) => Err(format!("query `{}`: {what}", asked.name)),
    }
}

/// Answers several queries of one network: those that reachability decides in one exploration, the others one by one.
///
/// # Errors
/// As [`answer`].
pub fn answers(
    program: &Program,
    queries: &[usize],
    settings: &Settings,
    watch: &Watch,
) -> Result<Vec<Answered>, String> {
    let sought = |q: &usize| Some((*q, reachability(&program.queries.get(*q)?.ask)?));
    let together: Vec<(usize, Sought)> = queries.iter().filter_map(sought).collect();
    let network =
        together.first().and_then(|(q, _)| program.networks.get(usize::from(program.queries[*q].network)));
    let mut found: Vec<Answered> = Vec::new();
    if let Some(network) = network
        && together.len() > 1
    {
        match by_search(&Observed::new(program, network), &together, settings, watch) {
            Ok(all) => found = all,
            // Which of them come upon the fault is seen one by one.
            Err(Error::Model { .. }) => {}
            Err(Error::Internal(what)) => return Err(format!("network `{}`: {what}", network.name)),
        }
    }
    let one = |query: &usize| match found.iter().position(|a| a.query == *query) {
        Some(at) => Ok(found[at].clone()),
        None => answer(program, *query, settings, watch),
    };
    queries.iter().map(one).collect()
}

/// What a search looks for, and what it means to find it.
struct Sought {
    formula: Formula,
    reached: Found,
    not: Found,
}

/// For what reachability decides.
fn reachability(ask: &Ask) -> Option<Sought> {
    let sought = match ask {
        Ask::Possibly(f) => {
            Sought { formula: f.clone(), reached: Found::Satisfied, not: Found::NotSatisfied }
        }
        Ask::Invariantly(f) => Sought {
            formula: Formula::Not(Box::new(f.clone())),
            reached: Found::NotSatisfied,
            not: Found::Satisfied,
        },
        Ask::PotentiallyAlways(_)
        | Ask::Eventually(_)
        | Ask::LeadsTo(..)
        | Ask::Sup { .. }
        | Ask::Inf { .. } => return None,
    };
    (!asks_deadlock(&sought.formula)).then_some(sought)
}

/// Deadlocks need zones that tell more apart than the search for many goals keeps.
fn asks_deadlock(formula: &Formula) -> bool {
    match formula {
        Formula::Deadlock => true,
        Formula::Not(f) => asks_deadlock(f),
        Formula::And(fs) | Formula::Or(fs) => fs.iter().any(asks_deadlock),
        Formula::At { .. } | Formula::Data(_) | Formula::Clock(_) => false,
    }
}

/// One answer for each of the queries, all from one exploration.
fn by_search(
    plain: &Observed,
    asked: &[(usize, Sought)],
    settings: &Settings,
    watch: &Watch,
) -> Result<Vec<Answered>, Error> {
    let goals: Vec<Goal> = asked.iter().map(|(_, sought)| of_formula(&sought.formula)).collect();
    let report = search(plain, &goals, &[], &[], settings, watch)?;
    let states = Some(report.states_stored);
    let mut notes = Vec::new();
    if let Some(reason) = &report.global_because {
        notes.push(format!("searched without local time: {reason}"));
    }
    let answered = asked.iter().zip(report.goals).map(|((query, sought), outcome)| {
        let (found, run) = match outcome {
            Outcome::Reached(witness) => {
                (sought.reached.clone(), Some(Box::new(Run { observed: plain.clone(), witness: *witness })))
            }
            Outcome::Open(what) => (Found::Open(exhausted(what)), None),
            Outcome::Unreachable => (sought.not.clone(), None),
        };
        Answered { query: *query, found, run, notes: notes.clone(), states }
    });
    let mut answered: Vec<Answered> = answered.collect();
    note_holds(plain, &goals, &mut answered, settings, watch);
    Ok(answered)
}

/// Notes of what is not possible if it is so only because holds take no time.
fn note_holds(
    plain: &Observed,
    goals: &[Goal],
    answered: &mut [Answered],
    settings: &Settings,
    watch: &Watch,
) {
    let impossible = |i: &usize| {
        let query = plain.program.queries.get(answered[*i].query);
        answered[*i].found == Found::NotSatisfied && query.is_some_and(|q| matches!(q.ask, Ask::Possibly(_)))
    };
    let open: Vec<usize> = (0..answered.len()).filter(impossible).collect();
    if open.is_empty() {
        return;
    }
    let Some(held) = Held::of(&plain.program, &plain.network) else { return };
    let goals: Vec<Goal> = open.iter().map(|i| goals[*i].clone()).collect();
    let states = open.iter().filter_map(|i| answered[*i].states).max().unwrap_or(0);
    let settings = Held::settings(settings, states);
    let observed = Observed::new(&held.program, &plain.network);
    let Ok(report) = search(&observed, &goals, &[], &[], &settings, watch) else { return };
    for (i, outcome) in open.into_iter().zip(report.goals) {
        if let Outcome::Reached(witness) = outcome {
            answered[i].notes.extend(held.because(&witness));
        }
    }
}

fn in_general(
    program: &Program,
    network: &Network,
    query: &Query,
    settings: &Settings,
) -> Result<Answer, Error> {
    let manner = Manner {
        budget: settings.budget,
        witness: settings.witness,
        delays: settings.delays,
        seed: settings.seed,
        threads: settings.threads,
    };
    hrdsl_ta::answer(program, network, query, &manner)
}

fn told(plain: &Observed, query: usize, ask: &Ask, answer: Answer) -> Answered {
    let bounds = matches!(ask, Ask::Sup { .. } | Ask::Inf { .. });
    let run = answer.run.or_else(|| answer.extrema.iter().find_map(|e| e.run.clone()));
    let found = match answer.verdict {
        Verdict::Open => Found::Open(answer.why.clone()),
        Verdict::Holds | Verdict::Fails if bounds => {
            Found::Bounds(answer.extrema.iter().map(bound).collect())
        }
        Verdict::Holds => Found::Satisfied,
        Verdict::Fails => Found::NotSatisfied,
    };
    let said = matches!(found, Found::Open(_) | Found::Bounds(_));
    Answered {
        query,
        found,
        run: run.map(|witness| Box::new(Run { observed: plain.clone(), witness: *witness })),
        notes: if said { Vec::new() } else { vec![answer.why] },
        states: None,
    }
}

/// `5 s`, `less than 5 s`, `no bound`
fn bound(extremum: &Extremum) -> String {
    let text = |q: &Quantity| match q {
        Quantity::Nanos(t) => format!("{} s", decimal(*t)),
        Quantity::Number(n) => n.to_string(),
    };
    match &extremum.limit {
        Reach::At { value, attained: true } => text(value),
        Reach::At { value, attained: false } => format!("{}, which is not attained", text(value)),
        Reach::Unbounded => "without bound".to_owned(),
        Reach::Nowhere => "the formula holds nowhere".to_owned(),
        Reach::Open { seen: Some(seen) } => format!("open; at least {} is attained", text(seen)),
        Reach::Open { seen: None } => "open".to_owned(),
    }
}

/// Seconds, exactly.
fn decimal(nanos: i64) -> String {
    let text = format!("{}.{:09}", nanos / 1_000_000_000, (nanos % 1_000_000_000).abs());
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
