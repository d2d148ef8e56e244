//! Answers to queries: what holds, a run that shows it, and a sentence that says why.

use std::ops::ControlFlow;

use hrdsl_ir::{
    Program,
    suite::{Delays, WitnessKind},
    ta::{Ask, Formula, Measure, Network, Query},
};
use serde::Serialize;

use crate::{
    Budget, Ending, Error, Exhausted, Extremum, Goal, GoalKind, Model, ModelError, Observe, Options, Outcome,
    StateFormula, Timing, Witness,
    extremum::{Side, extrema},
    fastest::fastest,
    graph::{Detail, Graph},
    liveness::{Found, Hunt, Trap},
    plain::Plain,
    search::explore,
    story::seconds,
    witness,
};

/// How questions are answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manner {
    /// Of each search.
    pub budget: Budget,
    /// For what is decided by reachability.
    pub witness: WitnessKind,
    pub delays: Delays,
    /// For sampled delays.
    pub seed: u64,
    /// Threads of the exploration for what reachability decides; 0 counts as 1.
    pub threads: usize,
}

impl Manner {
    fn timing(&self) -> Timing {
        Timing { delays: self.delays, seed: self.seed, prompt: false }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Proved. Of `sup` and `inf`: each bound is known.
    Holds,
    /// Refuted.
    Fails,
    /// The budget was used up first.
    Open,
}

/// What is known of a query.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    pub verdict: Verdict,
    /// A sentence that says why.
    pub why: String,
    /// A run that shows it: a witness of `E<>` and `E[]`, a counterexample of `A[]`, `A<>` and `-->`.
    pub run: Option<Box<Witness>>,
    /// Of `sup` and `inf`: for each measure.
    pub extrema: Vec<Extremum>,
}

/// Answers one query.
///
/// # Errors
/// If the model is at fault, the query has no meaning, or the engine contradicts itself.
pub fn answer(program: &Program, network: &Network, query: &Query, manner: &Manner) -> Result<Answer, Error> {
    let mut all = answers(program, network, &[query], manner)?;
    all.pop().ok_or_else(|| Error::Internal("a query has no answer".into()))
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
    manner: &Manner,
) -> Result<Vec<Answer>, Error> {
    let goals: Vec<Option<Goal>> = queries.iter().map(|q| reachability(&q.ask)).collect();
    let formulas = queries.iter().flat_map(|q| formulas(&q.ask)).collect();
    let observe = Observe { formulas, ..Observe::default() };
    let model = Model::new(program, network, &observe)?;
    let asker = Asker { program, network, model: &model, manner };
    let mut outcomes = asker.decide(&goals)?;
    let mut all = Vec::new();
    for (i, query) in queries.iter().enumerate() {
        all.push(match (&goals[i], outcomes[i].take()) {
            (Some(goal), Some((outcome, states))) => asker.reached(&query.ask, goal, outcome, states)?,
            (_, None) | (None, _) => asker.ask(&query.ask)?,
        });
    }
    Ok(all)
}

/// The goal that decides a query, if reachability does.
fn reachability(ask: &Ask) -> Option<Goal> {
    let goal = |f: Formula| Some(Goal { what: GoalKind::Formula(f), settled: false });
    match ask {
        Ask::Possibly(f) => goal(f.clone()),
        Ask::Invariantly(f) => goal(Formula::Not(Box::new(f.clone()))),
        Ask::PotentiallyAlways(_)
        | Ask::Eventually(_)
        | Ask::LeadsTo(..)
        | Ask::Sup { .. }
        | Ask::Inf { .. } => None,
    }
}

/// All formulas of a query.
fn formulas(ask: &Ask) -> Vec<Formula> {
    match ask {
        Ask::Possibly(f)
        | Ask::Invariantly(f)
        | Ask::PotentiallyAlways(f)
        | Ask::Eventually(f)
        | Ask::Sup { when: f, .. }
        | Ask::Inf { when: f, .. } => vec![f.clone()],
        Ask::LeadsTo(f, g) => vec![f.clone(), g.clone()],
    }
}

struct Asker<'a> {
    program: &'a Program,
    network: &'a Network,
    model: &'a Model<'a>,
    manner: &'a Manner,
}

/// How a goal ended, and how many symbolic states were kept.
type Decided = (Outcome, usize);

impl Asker<'_> {
    /// Decides the goals: those without `deadlock` in one exploration by simulation, those with it in one of a zone graph
    /// that tells valuations apart.
    fn decide(&self, goals: &[Option<Goal>]) -> Result<Vec<Option<Decided>>, Error> {
        let mut all: Vec<Option<Decided>> = goals.iter().map(|_| None).collect();
        let asks = |g: &Goal| g.formula().is_some_and(|f| f.asks_deadlock());
        let of = |deadlock: bool| -> Vec<(usize, &Goal)> {
            let some = goals.iter().enumerate().filter_map(|(i, g)| Some((i, g.as_ref()?)));
            some.filter(|(_, g)| asks(g) == deadlock).collect()
        };
        let easy = of(false);
        if !easy.is_empty() {
            let asked: Vec<Goal> = easy.iter().map(|(_, g)| (*g).clone()).collect();
            let options = match self.manner.witness {
                WitnessKind::Shortest => Options::shortest(),
                WitnessKind::Any | WitnessKind::Fastest => Options::default(),
            };
            let options =
                Options { budget: self.manner.budget, threads: self.manner.threads.max(1), ..options };
            let report = explore(self.model, &asked, &options, &|_| true)?;
            for ((i, _), outcome) in easy.iter().zip(report.goals) {
                all[*i] = Some((outcome, report.states_stored));
            }
        }
        let hard = of(true);
        if !hard.is_empty() {
            self.deadlocks(&hard, &mut all)?;
        }
        Ok(all)
    }

    fn deadlocks(&self, goals: &[(usize, &Goal)], all: &mut [Option<Decided>]) -> Result<(), Error> {
        let formulas: Vec<StateFormula> = goals.iter().filter_map(|(_, g)| g.formula()).collect();
        let refs: Vec<&StateFormula> = formulas.iter().collect();
        let graph = Graph::new(self.model, Detail::Tell, &refs, 0)?;
        let mut met: Vec<Option<u32>> = vec![None; goals.len()];
        let mut plain = Plain::new(&graph);
        let exhausted = plain.explore(self.manner.budget, &mut |at, seen, _| {
            let here = graph.here(&seen.state);
            for (f, met) in formulas.iter().zip(&mut met) {
                if met.is_none() && !f.part(&here, &seen.zone)?.is_empty() {
                    *met = Some(at);
                }
            }
            let done = met.iter().all(Option::is_some);
            Ok(if done { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        for (((i, goal), f), met) in goals.iter().zip(&formulas).zip(&met) {
            let outcome = match (met, exhausted) {
                (Some(at), _) => {
                    let run = witness::reach_goal(&graph, plain.path(*at), f, goal, Timing::default())?;
                    Outcome::Reached(Box::new(run))
                }
                (None, Some(what)) => Outcome::Open(what),
                (None, None) => Outcome::Unreachable,
            };
            all[*i] = Some((outcome, plain.nodes.len()));
        }
        Ok(())
    }

    fn reached(&self, ask: &Ask, goal: &Goal, outcome: Outcome, states: usize) -> Result<Answer, Error> {
        let universal = matches!(ask, Ask::Invariantly(_));
        let plain = |verdict, why| Answer { verdict, why, run: None, extrema: Vec::new() };
        Ok(match outcome {
            Outcome::Reached(found) => {
                let run = self.chosen(goal, found)?;
                let how = length(&run);
                let (verdict, why) = if universal {
                    (Verdict::Fails, format!("a run leaves it {how}"))
                } else {
                    (Verdict::Holds, format!("a run reaches it {how}"))
                };
                Answer { verdict, why, run: Some(run), extrema: Vec::new() }
            }
            Outcome::Unreachable => {
                let seen = format!("all that can be reached was seen ({})", count(states, "symbolic state"));
                if universal {
                    plain(Verdict::Holds, format!("no run leaves it: {seen}"))
                } else {
                    plain(Verdict::Fails, format!("no run reaches it: {seen}"))
                }
            }
            Outcome::Open(what) => plain(Verdict::Open, used_up(what)),
        })
    }

    /// The witness that the options ask for, instead of the one that was found.
    fn chosen(&self, goal: &Goal, found: Box<Witness>) -> Result<Box<Witness>, Error> {
        let timing = self.manner.timing();
        if self.manner.witness == WitnessKind::Fastest
            && let Some(run) = fastest(self.model, goal, self.manner.budget, timing)?
        {
            return Ok(run);
        }
        if timing.delays == Delays::Earliest {
            return Ok(found);
        }
        witness::retimed(self.model, &found, goal, timing).map(Box::new)
    }

    fn ask(&self, ask: &Ask) -> Result<Answer, Error> {
        match ask {
            Ask::PotentiallyAlways(f) => self.always(f.into()),
            Ask::Eventually(f) => self.eventually(&f.into()),
            Ask::LeadsTo(f, g) => self.leads_to(&f.into(), &g.into()),
            Ask::Sup { of, when } => self.bounds(Side::Sup, of, when),
            Ask::Inf { of, when } => self.bounds(Side::Inf, of, when),
            Ask::Possibly(_) | Ask::Invariantly(_) => Err(Error::Internal("not decided by this".into())),
        }
    }

    /// `E[] f` is `not A<> not f`.
    fn always(&self, f: StateFormula) -> Result<Answer, Error> {
        let avoid = f.not();
        let found = self.hunt(&[&avoid], |hunt| hunt.avoiding(&avoid))?;
        Ok(match found {
            Hunted::Run(run, trap) => {
                let why = format!("a run stays in it: {}", self.how(&trap, &run, false));
                Answer { verdict: Verdict::Holds, why, run: Some(run), extrema: Vec::new() }
            }
            Hunted::Nothing => {
                none(Verdict::Fails, "every run leaves it: no maximal run stays in it".to_owned())
            }
            Hunted::Open(what) => none(Verdict::Open, used_up(what)),
        })
    }

    fn eventually(&self, f: &StateFormula) -> Result<Answer, Error> {
        let found = self.hunt(&[f], |hunt| hunt.avoiding(f))?;
        Ok(match found {
            Hunted::Run(run, trap) => {
                let why = self.how(&trap, &run, true);
                Answer { verdict: Verdict::Fails, why, run: Some(run), extrema: Vec::new() }
            }
            Hunted::Nothing => none(Verdict::Holds, "every maximal run reaches it".to_owned()),
            Hunted::Open(what) => none(Verdict::Open, used_up(what)),
        })
    }

    fn leads_to(&self, f: &StateFormula, g: &StateFormula) -> Result<Answer, Error> {
        let found = self.hunt(&[f, g], |hunt| hunt.after(f, g))?;
        Ok(match found {
            Hunted::Run(run, trap) => {
                let why = format!("after the first, {}", self.how(&trap, &run, true));
                Answer { verdict: Verdict::Fails, why, run: Some(run), extrema: Vec::new() }
            }
            Hunted::Nothing => none(
                Verdict::Holds,
                "from each state of the first, every maximal run reaches the second".to_owned(),
            ),
            Hunted::Open(what) => none(Verdict::Open, used_up(what)),
        })
    }

    fn hunt<'f>(
        &self,
        formulas: &[&'f StateFormula],
        search: impl FnOnce(&mut Hunt<'_, '_, '_>) -> Result<Found, Error>,
    ) -> Result<Hunted, Error> {
        if formulas.iter().any(|f| f.asks_deadlock()) {
            let what = "`deadlock` can be asked for in `E<>`, `A[]`, `sup` and `inf`, not in questions about all of a run";
            return Err(ModelError::Question(what.into()).into());
        }
        let graph = Graph::new(self.model, Detail::Tell, formulas, 0)?;
        let mut hunt = Hunt::new(&graph, formulas, self.manner.budget);
        Ok(match search(&mut hunt)? {
            Found::Nothing => Hunted::Nothing,
            Found::Open(what) => Hunted::Open(what),
            Found::Trap(trap) => {
                let timing = self.manner.timing();
                let run = witness::concrete(&graph, &trap.stops, trap.ending, None, timing)?;
                let still = match trap.ending {
                    Ending::Again(_) => {
                        let times = witness::times(&graph, &trap.stops, Timing::default())?;
                        times.is_some_and(|t| !t.can_last(trap.from))
                    }
                    Ending::Reached | Ending::Stuck | Ending::Waits => false,
                };
                Hunted::Run(Box::new(run), Shown { trap, still })
            }
        })
    }

    /// What a maximal run does that never meets the formula.
    fn how(&self, shown: &Shown, run: &Witness, refuted: bool) -> String {
        let at = self.places(&shown.trap.state);
        match shown.trap.ending {
            Ending::Waits if refuted => {
                format!("time can pass for ever in {at}, so no run has to go on from there")
            }
            Ending::Waits => format!("time can pass for ever in {at}"),
            Ending::Stuck => format!("nothing more can happen in {at}, {}", length(run)),
            Ending::Again(from) => {
                let steps = count(run.steps.len() - from, "transition");
                let zeno = if shown.still { ", in which no time passes" } else { "" };
                format!("a run goes round for ever through {at}, by {steps}{zeno}")
            }
            Ending::Reached => format!("a run shows it in {at}"),
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

    fn bounds(&self, side: Side, of: &[Measure], when: &Formula) -> Result<Answer, Error> {
        use crate::Reach;
        let timing = self.manner.timing();
        let all = extrema(self.model, side, of, &when.into(), self.manner.budget, timing)?;
        let open = all.iter().any(|e| matches!(e.limit, Reach::Open { .. }));
        let verdict = if open { Verdict::Open } else { Verdict::Holds };
        let texts: Vec<String> = all.iter().map(|e| limit_text(e, side)).collect();
        Ok(Answer { verdict, why: texts.join("; "), run: None, extrema: all })
    }
}

enum Hunted {
    Run(Box<Witness>, Shown),
    Nothing,
    Open(Exhausted),
}

/// A trap, and whether no time can pass in its loop.
struct Shown {
    trap: Box<Trap>,
    still: bool,
}

fn none(verdict: Verdict, why: String) -> Answer {
    Answer { verdict, why, run: None, extrema: Vec::new() }
}

fn limit_text(e: &Extremum, side: Side) -> String {
    use crate::{Quantity, Reach};
    let text = |q: &Quantity| match q {
        Quantity::Nanos(n) => format!("{} s", seconds(*n, 1)),
        Quantity::Number(n) => n.to_string(),
    };
    let (closed, open) = if side == Side::Sup { ("<=", "<") } else { (">=", ">") };
    match &e.limit {
        Reach::At { value, attained } => format!("{} {}", if *attained { closed } else { open }, text(value)),
        Reach::Unbounded => "unbounded".to_owned(),
        Reach::Nowhere => "the formula holds nowhere".to_owned(),
        Reach::Open { seen: Some(q) } => format!("not decided; {} was seen", text(q)),
        Reach::Open { seen: None } => "not decided".to_owned(),
    }
}

fn used_up(what: Exhausted) -> String {
    let what = match what {
        Exhausted::States => "states",
        Exhausted::Memory => "memory",
        Exhausted::Stopped => return "not decided: the search was stopped".to_owned(),
    };
    format!("not decided: the budget of {what} was used up")
}

fn length(run: &Witness) -> String {
    if run.steps.is_empty() && run.end == 0 {
        return "at the start".to_owned();
    }
    format!("after {} and {} s", count(run.steps.len(), "transition"), seconds(run.end, run.ticks))
}

fn count(n: usize, of: &str) -> String {
    if n == 1 { format!("1 {of}") } else { format!("{n} {of}s") }
}
