//! Answers to queries: what holds, a run that shows it, and a sentence that says why.

use std::cell::Cell;

use hrdsl_ir::{
    Program,
    suite::{DelayChoice, WitnessKind},
    ta::{Network, Query, QueryFormula, QueryKind, QueryMeasure},
};
use serde::Serialize;

use crate::{
    decide::{
        deadlock::{DeadlockOptions, DecidedGoal, deadlocks},
        explore::explore,
        extremum::{ExtremumOptions, ExtremumQuestion, ExtremumSide, MeasureExtremum, extrema},
        fastest::fastest,
        liveness::{LivenessSearch, MaximalRun, MaximalRunSearchResult},
        standing_bounds, standing_runs,
        words::{count, length, limit_text, used_up},
        zeno::{self, LoopPace},
    },
    network::{
        error::ModelError,
        graph::ZoneGraph,
        model::{CompiledNetwork, ObservationOptions},
        query::{GoalKind, ReachabilityGoal, SearchBudget, StateFormula},
    },
    search::{
        options::SearchOptions,
        report::{GoalOutcome, SearchCutoff, SearchProgress, SearchStatistics},
        round_search::{GoOn, SearchCompany},
    },
    witness::{
        build,
        error::SearchError,
        run::{RunEnding, WitnessRun},
        schedule::ScheduleOptions,
    },
    zone::extrapolation::ExtrapolationAbstraction,
};

/// How questions are answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryOptions {
    /// Of each search.
    pub budget: SearchBudget,
    /// For what is decided by reachability.
    pub witness: WitnessKind,
    pub delays: DelayChoice,
    /// For sampled delays.
    pub seed: u64,
    /// Threads of the exploration for what reachability decides; 0 counts as 1.
    pub threads: usize,
}

impl QueryOptions {
    pub(super) fn timing(&self) -> ScheduleOptions {
        ScheduleOptions { delays: self.delays, seed: self.seed, prompt: false }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum QueryVerdict {
    /// Proved. Of `sup` and `inf`: each bound is known.
    Holds,
    /// Refuted.
    Fails,
    /// The budget was used up first.
    Inconclusive,
}

/// What is known of a query.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QueryAnswer {
    pub verdict: QueryVerdict,
    /// A sentence that says why.
    pub why: String,
    /// A run that shows it: a witness of `E<>` and `E[]`, a counterexample of `A[]`, `A<>` and `-->`.
    pub run: Option<Box<WitnessRun>>,
    /// Of `sup` and `inf`: for each measure.
    pub extrema: Vec<MeasureExtremum>,
    /// Of the searches that it took, if they are known.
    pub statistics: Option<SearchStatistics>,
}

/// Answers one query.
///
/// # Errors
/// If the model is at fault, the query has no meaning, or the engine contradicts itself.
pub fn answer(
    program: &Program,
    network: &Network,
    query: &Query,
    options: &QueryOptions,
) -> Result<QueryAnswer, SearchError> {
    answer_watched(program, network, query, options, &|_| true)
}

/// As [`answer`]; `go_on` is told how far each search is, and ends it by `false`.
///
/// # Errors
/// As [`answer`].
pub fn answer_watched(
    program: &Program,
    network: &Network,
    query: &Query,
    options: &QueryOptions,
    go_on: &dyn Fn(&SearchProgress<'_>) -> bool,
) -> Result<QueryAnswer, SearchError> {
    let mut all = answers_watched(program, network, &[query], options, go_on)?;
    all.pop().ok_or_else(|| SearchError::Internal("a query has no answer".into()))
}

/// Answers queries about one network, in their order. Those that reachability decides (`E<>`, `A[]`) are decided in one
/// exploration.
///
/// # Errors
/// As [`answer`].
pub fn answers(
    program: &Program,
    network: &Network,
    queries: &[&Query],
    options: &QueryOptions,
) -> Result<Vec<QueryAnswer>, SearchError> {
    answers_watched(program, network, queries, options, &|_| true)
}

fn answers_watched(
    program: &Program,
    network: &Network,
    queries: &[&Query],
    options: &QueryOptions,
    go_on: GoOn<'_>,
) -> Result<Vec<QueryAnswer>, SearchError> {
    let goals: Vec<Option<ReachabilityGoal>> = queries.iter().map(|q| reachability(&q.ask)).collect();
    let formulas = queries.iter().flat_map(|q| formulas(&q.ask)).collect();
    let observe = ObservationOptions { formulas, ..ObservationOptions::default() };
    let model = CompiledNetwork::new(program, network, &observe)?;
    let took = Cell::new(None);
    let widest = Cell::new(None);
    let company = SearchCompany { go_on, took: &took, widest: &widest };
    let asker = QueryEvaluator { program, network, model: &model, options, company };
    let mut outcomes = asker.decide(&goals)?;
    let together = took.take();
    let mut all = Vec::new();
    for (i, query) in queries.iter().enumerate() {
        all.push(match (&goals[i], outcomes[i].take()) {
            (Some(goal), Some((outcome, states))) => {
                QueryAnswer { statistics: together, ..asker.reached(&query.ask, goal, outcome, states)? }
            }
            (_, None) | (None, _) => {
                let answer = asker.ask(&query.ask)?;
                QueryAnswer { statistics: took.take(), ..answer }
            }
        });
    }
    Ok(all)
}

/// The goal that decides a query, if reachability does.
fn reachability(ask: &QueryKind) -> Option<ReachabilityGoal> {
    let goal = |f: QueryFormula| Some(ReachabilityGoal { what: GoalKind::Formula(f), settled: false });
    match ask {
        QueryKind::Possibly(f) => goal(f.clone()),
        QueryKind::Invariantly(f) => goal(QueryFormula::Not(Box::new(f.clone()))),
        QueryKind::PotentiallyAlways(_)
        | QueryKind::Eventually(_)
        | QueryKind::LeadsTo(..)
        | QueryKind::Sup { .. }
        | QueryKind::Inf { .. } => None,
    }
}

/// All formulas of a query.
fn formulas(ask: &QueryKind) -> Vec<QueryFormula> {
    match ask {
        QueryKind::Possibly(f)
        | QueryKind::Invariantly(f)
        | QueryKind::PotentiallyAlways(f)
        | QueryKind::Eventually(f)
        | QueryKind::Sup { when: f, .. }
        | QueryKind::Inf { when: f, .. } => vec![f.clone()],
        QueryKind::LeadsTo(f, g) => vec![f.clone(), g.clone()],
    }
}

struct QueryEvaluator<'a> {
    program: &'a Program,
    network: &'a Network,
    model: &'a CompiledNetwork<'a>,
    options: &'a QueryOptions,
    company: SearchCompany<'a>,
}

impl QueryEvaluator<'_> {
    /// Decides the goals: those without `deadlock` in one exploration, those with it in another.
    fn decide(&self, goals: &[Option<ReachabilityGoal>]) -> Result<Vec<Option<DecidedGoal>>, SearchError> {
        let mut all: Vec<Option<DecidedGoal>> = goals.iter().map(|_| None).collect();
        let asks = |g: &ReachabilityGoal| g.formula().is_some_and(|f| f.asks_deadlock());
        let of = |deadlock: bool| -> Vec<(usize, &ReachabilityGoal)> {
            let some = goals.iter().enumerate().filter_map(|(i, g)| Some((i, g.as_ref()?)));
            some.filter(|(_, g)| asks(g) == deadlock).collect()
        };
        let easy = of(false);
        if !easy.is_empty() {
            let asked: Vec<ReachabilityGoal> = easy.iter().map(|(_, g)| (*g).clone()).collect();
            let options = match self.options.witness {
                WitnessKind::Shortest => SearchOptions::shortest(),
                WitnessKind::Any | WitnessKind::Fastest => SearchOptions::default(),
            };
            let options = SearchOptions {
                budget: self.options.budget,
                threads: self.options.threads.max(1),
                ..options
            };
            let report = explore(self.model, &asked, &options, self.company.go_on)?;
            self.company.add(report.statistics());
            self.company.widest.set(report.widest);
            for ((i, _), outcome) in easy.iter().zip(report.goals) {
                all[*i] = Some((outcome, report.states_stored));
            }
        }
        let hard = of(true);
        if !hard.is_empty() {
            let asked: Vec<&ReachabilityGoal> = hard.iter().map(|(_, goal)| *goal).collect();
            let options = DeadlockOptions {
                budget: self.options.budget,
                threads: self.options.threads,
                shortest: self.options.witness == WitnessKind::Shortest,
            };
            let decided = deadlocks(self.model, &asked, &options, self.company)?;
            for ((i, _), decided) in hard.iter().zip(decided) {
                all[*i] = Some(decided);
            }
        }
        Ok(all)
    }

    fn reached(
        &self,
        ask: &QueryKind,
        goal: &ReachabilityGoal,
        outcome: GoalOutcome,
        states: usize,
    ) -> Result<QueryAnswer, SearchError> {
        let universal = matches!(ask, QueryKind::Invariantly(_));
        Ok(match outcome {
            GoalOutcome::Reached(found) => {
                let run = self.chosen(goal, found)?;
                let how = length(&run);
                let (verdict, why) = if universal {
                    (QueryVerdict::Fails, format!("a run leaves it {how}"))
                } else {
                    (QueryVerdict::Holds, format!("a run reaches it {how}"))
                };
                shown(verdict, why, run)
            }
            GoalOutcome::Unreachable => {
                let seen = format!("all that can be reached was seen ({})", count(states, "symbolic state"));
                if universal {
                    none(QueryVerdict::Holds, format!("no run leaves it: {seen}"))
                } else {
                    none(QueryVerdict::Fails, format!("no run reaches it: {seen}"))
                }
            }
            GoalOutcome::Inconclusive(what) => none(QueryVerdict::Inconclusive, self.used_up(what)),
        })
    }

    /// Why a search has not decided, and which variable may be the cause.
    fn used_up(&self, what: SearchCutoff) -> String {
        let why = used_up(what);
        let Some(widest) = self.company.widest.take() else { return why };
        let told = format!("{why}; {widest}");
        // Several goals of one search ask for it.
        self.company.widest.set(Some(widest));
        told
    }

    /// The witness that the options ask for, instead of the one that was found.
    fn chosen(
        &self,
        goal: &ReachabilityGoal,
        found: Box<WitnessRun>,
    ) -> Result<Box<WitnessRun>, SearchError> {
        let timing = self.options.timing();
        if self.options.witness == WitnessKind::Fastest
            && let Some(run) = fastest(self.model, goal, &found, self.options.budget, timing)?
        {
            return Ok(run);
        }
        if timing.delays == DelayChoice::Earliest {
            return Ok(found);
        }
        build::retimed(self.model, &found, goal, timing).map(Box::new)
    }

    fn ask(&self, ask: &QueryKind) -> Result<QueryAnswer, SearchError> {
        match ask {
            QueryKind::PotentiallyAlways(f) => self.always(f.into()),
            QueryKind::Eventually(f) => self.eventually(&f.into()),
            QueryKind::LeadsTo(f, g) => self.leads_to(&f.into(), &g.into()),
            QueryKind::Sup { of, when } => self.bounds(ExtremumSide::Sup, of, when),
            QueryKind::Inf { of, when } => self.bounds(ExtremumSide::Inf, of, when),
            QueryKind::Possibly(_) | QueryKind::Invariantly(_) => {
                Err(SearchError::Internal("not decided by this".into()))
            }
        }
    }

    /// `E[] f` is `not A<> not f`.
    fn always(&self, f: StateFormula) -> Result<QueryAnswer, SearchError> {
        let avoid = f.not();
        let found = self.hunt(&[&avoid], |hunt| hunt.avoiding(&avoid))?;
        Ok(match found {
            LivenessSearchResult::Run(run, trap) => {
                let why = format!("a run stays in it: {}", self.explain_run(&trap, &run, false));
                shown(QueryVerdict::Holds, why, run)
            }
            LivenessSearchResult::Nothing => {
                none(QueryVerdict::Fails, "every run leaves it: no maximal run stays in it".to_owned())
            }
            LivenessSearchResult::Inconclusive(what) => none(QueryVerdict::Inconclusive, self.used_up(what)),
        })
    }

    fn eventually(&self, f: &StateFormula) -> Result<QueryAnswer, SearchError> {
        let found = self.hunt(&[f], |hunt| hunt.avoiding(f))?;
        Ok(match found {
            LivenessSearchResult::Run(run, trap) => {
                let why = self.explain_run(&trap, &run, true);
                shown(QueryVerdict::Fails, why, run)
            }
            LivenessSearchResult::Nothing => {
                none(QueryVerdict::Holds, "every maximal run reaches it".to_owned())
            }
            LivenessSearchResult::Inconclusive(what) => none(QueryVerdict::Inconclusive, self.used_up(what)),
        })
    }

    fn leads_to(&self, f: &StateFormula, g: &StateFormula) -> Result<QueryAnswer, SearchError> {
        let found = self.hunt(&[f, g], |hunt| hunt.after(f, g))?;
        Ok(match found {
            LivenessSearchResult::Run(run, trap) => {
                let why = format!("after the first, {}", self.explain_run(&trap, &run, true));
                shown(QueryVerdict::Fails, why, run)
            }
            LivenessSearchResult::Nothing => none(
                QueryVerdict::Holds,
                "from each state of the first, every maximal run reaches the second".to_owned(),
            ),
            LivenessSearchResult::Inconclusive(what) => none(QueryVerdict::Inconclusive, self.used_up(what)),
        })
    }

    fn hunt(
        &self,
        formulas: &[&StateFormula],
        search: impl Fn(&mut LivenessSearch<'_, '_, '_>) -> Result<MaximalRunSearchResult, SearchError>,
    ) -> Result<LivenessSearchResult, SearchError> {
        if formulas.iter().any(|f| f.asks_deadlock()) {
            let what = "`deadlock` can be asked for in `E<>`, `A[]`, `sup` and `inf`, not in questions about all of a run";
            return Err(ModelError::Question(what.into()).into());
        }
        let graph = ZoneGraph::new(self.model, formulas)?;
        let stands = self.model.stops();
        if stands && graph.splits() {
            self.model.refuse_stopped("a comparison of two clocks with each other")?;
        }
        let go = |abstraction| {
            let limits = (self.options.budget, self.company.go_on);
            let mut hunt = LivenessSearch::new(&graph, formulas, limits, abstraction);
            let found = search(&mut hunt)?;
            self.company.add(hunt.statistics());
            if matches!(found, MaximalRunSearchResult::Inconclusive(_)) {
                self.company.widest.set(hunt.widest());
            }
            Ok::<_, SearchError>(found)
        };
        let mut found = go(ExtrapolationAbstraction::LowerUpper)?;
        if matches!(found, MaximalRunSearchResult::Doubtful) {
            found = go(ExtrapolationAbstraction::Greatest)?;
        }
        Ok(match found {
            MaximalRunSearchResult::Doubtful if stands => {
                LivenessSearchResult::Inconclusive(SearchCutoff::Zones)
            }
            MaximalRunSearchResult::Doubtful => {
                return Err(SearchError::Internal("an exact search is in doubt".into()));
            }
            MaximalRunSearchResult::Nothing => LivenessSearchResult::Nothing,
            MaximalRunSearchResult::Inconclusive(what) => LivenessSearchResult::Inconclusive(what),
            MaximalRunSearchResult::Found(trap) => {
                let timing = self.options.timing();
                if stands {
                    let confirmed = standing_runs::confirm(&graph, &trap, timing)?;
                    return Ok(match confirmed {
                        None => LivenessSearchResult::Inconclusive(SearchCutoff::Zones),
                        Some((run, pace)) => {
                            LivenessSearchResult::Run(Box::new(run), LivenessCounterexample { trap, pace })
                        }
                    });
                }
                let run = build::concrete(&graph, &trap.stops, trap.ending, None, timing)?;
                let pace = zeno::pace(&graph, &trap)?;
                LivenessSearchResult::Run(Box::new(run), LivenessCounterexample { trap, pace })
            }
        })
    }

    /// What a maximal run does that never meets the formula.
    fn explain_run(&self, shown: &LivenessCounterexample, run: &WitnessRun, refuted: bool) -> String {
        let at = self.places(&shown.trap.state);
        match shown.trap.ending {
            RunEnding::Waits if refuted => {
                format!("time can pass for ever in {at}, so no run has to go on from there")
            }
            RunEnding::Waits => format!("time can pass for ever in {at}"),
            RunEnding::Stuck => format!("nothing more can happen in {at}, {}", length(run)),
            RunEnding::Again(from) => {
                let steps = count(run.steps.len() - from, "transition");
                format!("a run goes round for ever through {at}, by {steps}{}", shown.pace.told())
            }
            RunEnding::Reached | RunEnding::Fault => format!("a run shows it in {at}"),
        }
    }

    /// The locations of a state: those of the automata that have more than one.
    fn places(&self, state: &[i64]) -> String {
        let mut names = Vec::new();
        for (id, at) in self.network.automata.iter().zip(state) {
            let Some(a) = self.program.automata.get(usize::from(id.0)) else { continue };
            let place = usize::try_from(*at).ok().and_then(|at| a.locations.get(at));
            if let Some(l) = place.filter(|_| a.locations.len() > 1 || self.network.automata.len() == 1) {
                names.push(format!("`{}.{}`", a.name, l.name));
            }
        }
        match names.split_last() {
            None => "the only state".to_owned(),
            Some((one, [])) => one.clone(),
            Some((last, others)) => format!("{} and {last}", others.join(", ")),
        }
    }

    fn bounds(
        &self,
        side: ExtremumSide,
        of: &[QueryMeasure],
        when: &QueryFormula,
    ) -> Result<QueryAnswer, SearchError> {
        use crate::decide::extremum::ExtremumLimit;
        let options = ExtremumOptions {
            budget: self.options.budget,
            threads: self.options.threads,
            timing: self.options.timing(),
        };
        let question = ExtremumQuestion { side, of, when };
        let find = if self.model.stops() { standing_bounds::extrema } else { extrema };
        let all = find(self.program, self.network, &question, options, self.company)?;
        let inconclusive = all.iter().any(|e| matches!(e.limit, ExtremumLimit::Inconclusive { .. }));
        let verdict = if inconclusive { QueryVerdict::Inconclusive } else { QueryVerdict::Holds };
        let texts: Vec<String> = all.iter().map(|e| limit_text(e, side)).collect();
        let mut why = texts.join("; ");
        if let (true, Some(widest)) = (inconclusive, self.company.widest.take()) {
            why = format!("{why}; {widest}");
        }
        Ok(QueryAnswer { verdict, why, run: None, extrema: all, statistics: None })
    }
}

enum LivenessSearchResult {
    Run(Box<WitnessRun>, LivenessCounterexample),
    Nothing,
    Inconclusive(SearchCutoff),
}

/// A trap, and how time passes in its loop.
struct LivenessCounterexample {
    trap: Box<MaximalRun>,
    pace: LoopPace,
}

fn none(verdict: QueryVerdict, why: String) -> QueryAnswer {
    QueryAnswer { verdict, why, run: None, extrema: Vec::new(), statistics: None }
}

/// With a run that shows it.
fn shown(verdict: QueryVerdict, why: String, run: Box<WitnessRun>) -> QueryAnswer {
    QueryAnswer { run: Some(run), ..none(verdict, why) }
}
