//! Queries of a scenario, answered about their networks.

use hrdsl_ir::{
    Program,
    ta::{Query, QueryFormula, QueryKind},
};
use hrdsl_ta::{
    ExtremumLimit, ExtremumValue, GoalOutcome, MeasureExtremum, QueryAnswer, QueryOptions, QueryVerdict,
    RangeAnswer, RangeFinding, ReachabilityGoal, SearchError, UnreadCounters,
};

use super::{
    goals::{cut_off, exhausted, of_formula},
    held::TimedHolds,
    observer::ObservedNetwork,
    run::ObservedRun,
    settings::{ProofOptions, SearchStatistics, SearchWatch, search, search_queries},
};

/// What became of a query.
#[derive(Clone, Debug)]
pub struct QueryResult {
    /// Index into [`Program::queries`].
    pub query: usize,
    pub found: QueryFinding,
    /// Shows it, if a run can.
    pub run: Option<Box<ObservedRun>>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// Of the search, if it is known.
    pub statistics: Option<SearchStatistics>,
    /// That search was one for several queries.
    pub joint: bool,
    /// Of variables that the search left out, since nothing reads them: whether they stay in their ranges.
    pub ranges: Vec<RangeResult>,
}

/// Whether variables that nothing reads stay in their ranges.
#[derive(Clone, Debug)]
pub struct RangeResult {
    /// Their slots of the network.
    pub slots: Vec<usize>,
    /// Their names: more than one if they are computed from each other.
    pub variables: Vec<String>,
    pub found: RangeVerdict,
    /// To the fault.
    pub run: Option<Box<ObservedRun>>,
    pub statistics: Option<SearchStatistics>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RangeVerdict {
    Kept,
    /// Why.
    Inconclusive(String),
    /// The model is at fault, and where.
    Left(String),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum QueryFinding {
    Satisfied,
    NotSatisfied,
    /// Of a `sup` or `inf`, for each measure.
    Bounds(Vec<String>),
    /// Inconclusive: why.
    Inconclusive(String),
    /// The model is at fault, and where.
    Fault(String),
}

/// Answers a query. It is about the network alone: assumptions do not restrict it. `ranges`: the variables of its network, by slot, of which it is
/// known whether they stay in their ranges.
///
/// # Errors
/// If the engine contradicts itself, or there is no such query.
pub fn answer(
    program: &Program,
    query: usize,
    settings: &ProofOptions,
    watch: &SearchWatch,
    ranges: &[usize],
) -> Result<QueryResult, String> {
    let asked = program.queries.get(query).ok_or_else(|| format!("there is no query {query}"))?;
    let network = program
        .networks
        .get(usize::from(asked.network.0))
        .ok_or_else(|| format!("query `{}` is about no network", asked.name))?;
    let plain = ObservedNetwork::new(program, network);
    let result = match reachability(&asked.ask) {
        Some(goal) => by_search(&plain, &[(query, goal)], settings, watch).map(|mut all| all.remove(0)),
        None => in_general(&plain, asked, settings, watch, ranges)
            .map(|(answer, ranges)| QueryResult { ranges, ..told(&plain, query, &asked.ask, answer) })
            .map(|mut result| {
                result.notes.extend(settings.explanation_in_general());
                result
            }),
    };
    match result {
        Ok(answered) => Ok(answered),
        Err(SearchError::Model { error, witness }) => Ok(QueryResult {
            query,
            found: QueryFinding::Fault(error.to_string()),
            run: witness.map(|witness| Box::new(ObservedRun { observed: plain, witness: *witness })),
            notes: Vec::new(),
            statistics: None,
            joint: false,
            ranges: Vec::new(),
        }),
        Err(SearchError::Internal(what)) => Err(format!("query `{}`: {what}", asked.name)),
    }
}

/// Answers several queries of one network: those that reachability decides in one exploration, the others one by one.
///
/// # Errors
/// As [`answer`].
pub fn answers(
    program: &Program,
    queries: &[usize],
    settings: &ProofOptions,
    watch: &SearchWatch,
    ranges: &[usize],
) -> Result<Vec<QueryResult>, String> {
    let sought = |q: &usize| Some((*q, reachability(&program.queries.get(*q)?.ask)?));
    let together: Vec<(usize, SoughtFormula)> = queries.iter().filter_map(sought).collect();
    let network =
        together.first().and_then(|(q, _)| program.networks.get(usize::from(program.queries[*q].network.0)));
    let mut found: Vec<QueryResult> = Vec::new();
    if let Some(network) = network
        && together.len() > 1
    {
        match by_search(&ObservedNetwork::new(program, network), &together, settings, watch) {
            Ok(all) => found = all,
            // Which of them come upon the fault is seen one by one.
            Err(SearchError::Model { .. }) => {}
            Err(SearchError::Internal(what)) => return Err(format!("network `{}`: {what}", network.name)),
        }
    }
    let one = |query: &usize| match found.iter().position(|a| a.query == *query) {
        Some(at) => Ok(found[at].clone()),
        None => answer(program, *query, settings, watch, ranges),
    };
    queries.iter().map(one).collect()
}

/// Whether one search answers such queries together.
#[must_use]
pub fn is_decided_with_others(query: &Query) -> bool {
    reachability(&query.ask).is_some()
}

/// What a search looks for, and what it means to find it.
struct SoughtFormula {
    formula: QueryFormula,
    reached: QueryFinding,
    not: QueryFinding,
}

/// For what reachability decides.
fn reachability(ask: &QueryKind) -> Option<SoughtFormula> {
    let sought = match ask {
        QueryKind::Possibly(f) => SoughtFormula {
            formula: f.clone(),
            reached: QueryFinding::Satisfied,
            not: QueryFinding::NotSatisfied,
        },
        QueryKind::Invariantly(f) => SoughtFormula {
            formula: QueryFormula::Not(Box::new(f.clone())),
            reached: QueryFinding::NotSatisfied,
            not: QueryFinding::Satisfied,
        },
        QueryKind::PotentiallyAlways(_)
        | QueryKind::Eventually(_)
        | QueryKind::LeadsTo(..)
        | QueryKind::Sup { .. }
        | QueryKind::Inf { .. } => return None,
    };
    (!asks_deadlock(&sought.formula)).then_some(sought)
}

/// Deadlocks need zones that tell more apart than the search for many goals keeps.
fn asks_deadlock(formula: &QueryFormula) -> bool {
    match formula {
        QueryFormula::Deadlock => true,
        QueryFormula::Not(f) => asks_deadlock(f),
        QueryFormula::And(fs) | QueryFormula::Or(fs) => fs.iter().any(asks_deadlock),
        QueryFormula::At { .. } | QueryFormula::Data(_) | QueryFormula::Clock(_) => false,
    }
}

/// One answer for each of the queries, all from one exploration.
fn by_search(
    plain: &ObservedNetwork,
    asked: &[(usize, SoughtFormula)],
    settings: &ProofOptions,
    watch: &SearchWatch,
) -> Result<Vec<QueryResult>, SearchError> {
    let goals: Vec<ReachabilityGoal> = asked.iter().map(|(_, sought)| of_formula(&sought.formula)).collect();
    let (report, ranges) = search_queries(plain, &goals, settings, watch)?;
    let ranges: Vec<RangeResult> =
        ranges.into_iter().map(|answer| range_result(plain, answer, watch)).collect();
    let (statistics, joint) = (Some(report.statistics()), asked.len() > 1);
    let mut notes = Vec::new();
    if let Some(reason) = &report.global_because {
        notes.push(format!("searched without local time: {reason}"));
    }
    notes.extend(settings.explanation(&report));
    let answered = asked.iter().zip(&report.goals).map(|((query, sought), outcome)| {
        let (found, run) = match outcome {
            GoalOutcome::Reached(witness) => (
                sought.reached.clone(),
                Some(Box::new(ObservedRun { observed: plain.clone(), witness: (**witness).clone() })),
            ),
            GoalOutcome::Inconclusive(what) => {
                (QueryFinding::Inconclusive(exhausted(*what, &report, watch)), None)
            }
            GoalOutcome::Unreachable => (sought.not.clone(), None),
        };
        let ranges = ranges.clone();
        QueryResult { query: *query, found, run, notes: notes.clone(), statistics, joint, ranges }
    });
    let mut answered: Vec<QueryResult> = answered.collect();
    note_holds(plain, &goals, &mut answered, settings, watch);
    Ok(answered)
}

fn range_result(plain: &ObservedNetwork, answer: RangeAnswer, watch: &SearchWatch) -> RangeResult {
    let (found, run) = match answer.finding {
        RangeFinding::Kept => (RangeVerdict::Kept, None),
        RangeFinding::Left { error, run } => (RangeVerdict::Left(error.to_string()), Some(run)),
        RangeFinding::Inconclusive { cutoff, widest } => {
            (RangeVerdict::Inconclusive(cut_off(cutoff, widest.as_ref(), watch)), None)
        }
        RangeFinding::Behind(error) => {
            (RangeVerdict::Inconclusive(format!("another fault of the model comes first: {error}")), None)
        }
    };
    RangeResult {
        slots: answer.slots,
        variables: answer.variables,
        found,
        run: run.map(|witness| Box::new(ObservedRun { observed: plain.clone(), witness: *witness })),
        statistics: answer.statistics,
    }
}

/// Notes of what is not possible if it is so only because holds take no time.
fn note_holds(
    plain: &ObservedNetwork,
    goals: &[ReachabilityGoal],
    answered: &mut [QueryResult],
    settings: &ProofOptions,
    watch: &SearchWatch,
) {
    let impossible = |i: &usize| {
        let query = plain.program.queries.get(answered[*i].query);
        answered[*i].found == QueryFinding::NotSatisfied
            && query.is_some_and(|q| matches!(q.ask, QueryKind::Possibly(_)))
    };
    let open: Vec<usize> = (0..answered.len()).filter(impossible).collect();
    if open.is_empty() {
        return;
    }
    let Some(held) = TimedHolds::of(&plain.program, &plain.network) else { return };
    let goals: Vec<ReachabilityGoal> = open.iter().map(|i| goals[*i].clone()).collect();
    let states = open.iter().filter_map(|i| answered[*i].statistics).map(|s| s.stored).max().unwrap_or(0);
    let settings = TimedHolds::settings(settings, states);
    let observed = ObservedNetwork::new(&held.program, &plain.network);
    let Ok(report) = search(&observed, &goals, &[], &[], &settings, watch) else { return };
    for (i, outcome) in open.into_iter().zip(report.goals) {
        if let GoalOutcome::Reached(witness) = outcome {
            answered[i].notes.extend(held.because(&witness));
        }
    }
}

/// For what reachability alone does not decide: the answer, and whether variables that the search left out stay in their ranges.
fn in_general(
    plain: &ObservedNetwork,
    query: &Query,
    settings: &ProofOptions,
    watch: &SearchWatch,
    known: &[usize],
) -> Result<(QueryAnswer, Vec<RangeResult>), SearchError> {
    let options = QueryOptions {
        budget: settings.budget,
        witness: settings.witness,
        delays: settings.delays,
        seed: settings.seed,
        threads: settings.threads,
    };
    let go_on = |p: &hrdsl_ta::SearchProgress<'_>| watch.goes_on(p);
    let (program, network) = (&plain.program, &plain.network);
    let unread = if settings.exact_counters {
        None
    } else {
        UnreadCounters::find_for_query(program, network, &query.ask)?
    };
    let (mut answer, ranges) = match unread {
        None => (hrdsl_ta::answer_watched(program, network, query, &options, &go_on)?, Vec::new()),
        Some(unread) => {
            let (answer, apart) = unread.answer(query, &options, &go_on)?;
            let ranges = if apart { unread.ranges(&settings.options(), known, &go_on)? } else { Vec::new() };
            (answer, ranges)
        }
    };
    if answer.verdict == QueryVerdict::Inconclusive && watch.is_stopped() {
        watch.stopped().clone_into(&mut answer.why);
    }
    let ranges = ranges.into_iter().map(|answer| range_result(plain, answer, watch)).collect();
    Ok((answer, ranges))
}

fn told(plain: &ObservedNetwork, query: usize, ask: &QueryKind, answer: QueryAnswer) -> QueryResult {
    let bounds = matches!(ask, QueryKind::Sup { .. } | QueryKind::Inf { .. });
    let run = answer.run.or_else(|| answer.extrema.iter().find_map(|e| e.run.clone()));
    let found = match answer.verdict {
        QueryVerdict::Inconclusive => QueryFinding::Inconclusive(answer.why.clone()),
        QueryVerdict::Holds | QueryVerdict::Fails if bounds => {
            QueryFinding::Bounds(answer.extrema.iter().map(bound).collect())
        }
        QueryVerdict::Holds => QueryFinding::Satisfied,
        QueryVerdict::Fails => QueryFinding::NotSatisfied,
    };
    // How long the run to a state is, is said of each run.
    let shown = run.is_some() && matches!(ask, QueryKind::Possibly(_) | QueryKind::Invariantly(_));
    let said = shown || matches!(found, QueryFinding::Inconclusive(_) | QueryFinding::Bounds(_));
    QueryResult {
        query,
        found,
        run: run.map(|witness| Box::new(ObservedRun { observed: plain.clone(), witness: *witness })),
        notes: if said { Vec::new() } else { vec![answer.why] },
        statistics: answer.statistics,
        joint: false,
        ranges: Vec::new(),
    }
}

/// `5 s`, `less than 5 s`, `no bound`
fn bound(extremum: &MeasureExtremum) -> String {
    let text = |q: &ExtremumValue| match q {
        ExtremumValue::Nanos(t) => format!("{} s", decimal(*t)),
        ExtremumValue::Number(n) => n.to_string(),
    };
    match &extremum.limit {
        ExtremumLimit::At { value, attained: true } => text(value),
        ExtremumLimit::At { value, attained: false } => format!("{}, which is not attained", text(value)),
        ExtremumLimit::Unbounded => "without bound".to_owned(),
        ExtremumLimit::Nowhere => "the formula holds nowhere".to_owned(),
        ExtremumLimit::Inconclusive { seen: Some(seen) } => {
            format!("inconclusive; at least {} is attained", text(seen))
        }
        ExtremumLimit::Inconclusive { seen: None } => "inconclusive".to_owned(),
    }
}

/// Seconds, exactly.
fn decimal(nanos: i64) -> String {
    let text = format!("{}.{:09}", nanos / 1_000_000_000, (nanos % 1_000_000_000).abs());
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
