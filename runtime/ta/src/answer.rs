//! Answers to queries: what holds, a run that shows it, and a sentence that says why.

use hrdsl_ir::{
    Program,
    suite::{Delays, WitnessKind},
    ta::{Ask, Measure, Network, Query},
};
use serde::Serialize;

use crate::{
    Budget, Ending, Error, Exhausted, Extremum, Goal, GoalKind, Model, ModelError, Outcome, StateFormula,
    Timing, Witness,
    extremum::{Side, extrema},
    fastest::fastest,
    graph::{Detail, Graph},
    liveness::{Found, Hunt, Trap},
    search::explore,
    story::seconds,
    witness,
};

/// How questions are answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Of each search.
    pub budget: Budget,
    /// For what is decided by reachability. `Any` gives the shortest, too.
    pub witness: WitnessKind,
    pub delays: Delays,
    /// For sampled delays.
    pub seed: u64,
}

impl Options {
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
pub fn answer(
    program: &Program,
    network: &Network,
    query: &Query,
    options: &Options,
) -> Result<Answer, Error> {
    let mut all = answers(program, network, &[query], options)?;
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
    options: &Options,
) -> Result<Vec<Answer>, Error> {
    let goals: Vec<Option<Goal>> = queries.iter().map(|q| reachability(&q.ask)).collect();
    let asked: Vec<Goal> = goals.iter().flatten().cloned().collect();
    let formulas = queries.iter().flat_map(|q| formulas(&q.ask)).collect();
    let model = crate::answer::model(program, network, formulas)?;
    let mut outcomes = Vec::new();
    if !asked.is_empty() {
        let report = explore(&model, &asked, options.budget)?;
        outcomes = report.goals.into_iter().map(|o| (o, report.states_stored)).collect();
    }
    let mut outcomes = outcomes.into_iter();
    let asker = Asker { program, network, model: &model, options };
    let mut all = Vec::new();
    for (query, goal) in queries.iter().zip(&goals) {
        all.push(match goal {
            Some(goal) => {
                let next = outcomes.next();
                let (outcome, states) = next.ok_or_else(|| Error::Internal("a goal is lost".into()))?;
                asker.reached(&query.ask, goal, outcome, states)?
            }
            None => asker.ask(&query.ask)?,
        });
    }
    Ok(all)
}

/// The goal that decides a query, if reachability does.
fn reachability(ask: &Ask) -> Option<Goal> {
    let goal = |f: StateFormula| Some(Goal { what: GoalKind::Condition(f), settled: false });
    match ask {
        Ask::Possibly(f) => goal(f.into()),
        Ask::Invariantly(f) => goal(StateFormula::from(f).not()),
        Ask::PotentiallyAlways(_)
        | Ask::Eventually(_)
        | Ask::LeadsTo(..)
        | Ask::Sup { .. }
        | Ask::Inf { .. } => None,
    }
}

/// All formulas of a query.
fn formulas(ask: &Ask) -> Vec<hrdsl_ir::ta::Formula> {
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

fn model<'p>(
    program: &'p Program,
    network: &'p Network,
    formulas: Vec<hrdsl_ir::ta::Formula>,
) -> Result<Model<'p>, ModelError> {
    let _ = formulas;
    Model::new(program, network, &[], &[])
}

struct Asker<'a> {
    program: &'a Program,
    network: &'a Network,
    model: &'a Model<'a>,
    options: &'a Options,
}

impl Asker<'_> {
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
        let timing = self.options.timing();
        if self.options.witness == WitnessKind::Fastest
            && let Some(run) = fastest(self.model, goal, self.options.budget, timing)?
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
        let mut hunt = Hunt::new(&graph, formulas, self.options.budget);
        Ok(match search(&mut hunt)? {
            Found::Nothing => Hunted::Nothing,
            Found::Open(what) => Hunted::Open(what),
            Found::Trap(trap) => {
                let timing = self.options.timing();
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

    fn bounds(&self, side: Side, of: &[Measure], when: &hrdsl_ir::ta::Formula) -> Result<Answer, Error> {
        use crate::Reach;
        let timing = self.options.timing();
        let all = extrema(self.model, side, of, &when.into(), self.options.budget, timing)?;
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
