//! Least upper and greatest lower bounds of clocks and numbers, over all states in which a formula holds.
//!
//! All zones that the search for goals keeps are looked at. It tells apart what a clock may be up to some bound, so if a value comes
//! out beyond it, the bound is doubled and the search begins again. It ends when the value is within the bound; when some state of the
//! formula lets time pass for ever, so that the clock is unbounded; or, inconclusive, after [`RAISES`] doublings or when the
//! budget is used up. The last can only happen for a clock that grows in a loop of states each of which bounds time.

use std::ops::ControlFlow;

use hrdsl_ir::{
    Expr, Nanos, Program, Value,
    expr::EvalError,
    ta::{ClockConstraint, ClockId, ClockOp, Network, QueryFormula, QueryMeasure, TimeSum},
};
use serde::Serialize;

use crate::{
    decide::places::{each_place, of_expression},
    network::{
        error::ModelError,
        graph::ZoneGraph,
        model::{CompiledNetwork, ObservationOptions},
        query::{SearchBudget, StateFormula, StateViewScope, SymbolicView, no_value},
    },
    search::{
        options::SearchOptions,
        probe::{ProbeFinding, ProbeValue, ProbedState, StateProbe, spread},
        report::SearchCutoff,
        round_search::{RoundSearch, SearchAside, SearchCompany},
        start,
    },
    witness::{
        build::{reach_formula, takes},
        error::SearchError,
        run::WitnessRun,
        schedule::ScheduleOptions,
    },
    zone::{
        constraint::{DifferenceConstraint, keep},
        dbm::{Dbm, DbmBound},
        extrapolation::ExtrapolationAbstraction,
    },
};

/// How often a clock's bound is doubled.
pub const RAISES: u32 = 14;

/// A bound of one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureExtremum {
    pub limit: ExtremumLimit,
    /// A run to a state in which the measure has the value, or one less than a unit of time from it.
    pub run: Option<Box<WitnessRun>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExtremumLimit {
    /// `attained`: some state has the value (`<=`); otherwise states come as near as one likes (`<`).
    At { value: ExtremumValue, attained: bool },
    /// It grows without bound.
    Unbounded,
    /// The formula holds nowhere.
    Nowhere,
    /// The search ended too early; this value is not beyond the bound.
    Inconclusive { seen: Option<ExtremumValue> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExtremumValue {
    Nanos(Nanos),
    Number(i64),
}

/// Upper or lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExtremumSide {
    Sup,
    Inf,
}

/// The best value so far: in units or as a number, whether it is attained, and the node.
#[derive(Clone, Copy)]
struct BestValue {
    value: i64,
    attained: bool,
    node: u32,
}

enum MeasureTracker {
    /// `bound`: up to so many nanoseconds its values are told apart.
    Clock {
        clock: usize,
        bound: Nanos,
        best: Option<BestValue>,
        beyond: bool,
        unbounded: Option<u32>,
    },
    Number {
        of: Expr,
        best: Option<BestValue>,
    },
}

/// What is asked for.
pub(crate) struct ExtremumQuestion<'a> {
    pub side: ExtremumSide,
    pub of: &'a [QueryMeasure],
    pub when: &'a QueryFormula,
}

/// How it is looked for.
#[derive(Clone, Copy)]
pub(crate) struct ExtremumOptions {
    pub budget: SearchBudget,
    pub threads: usize,
    pub timing: ScheduleOptions,
}

/// The bounds of each measure, where no clock stands still.
///
/// # Errors
/// If the model is at fault, or a measure has no value where the formula holds.
pub(crate) fn extrema(
    program: &Program,
    network: &Network,
    question: &ExtremumQuestion,
    options: ExtremumOptions,
    company: SearchCompany<'_>,
) -> Result<Vec<MeasureExtremum>, SearchError> {
    let ExtremumQuestion { side, of, when } = *question;
    let formula = StateFormula::from(when);
    let plain = observed(program, network, vec![when.clone()])?;
    let mut tracks: Vec<MeasureTracker> =
        of.iter().map(|m| MeasureTracker::of(m, &plain)).collect::<Result<_, _>>()?;
    let mut raised = 0;
    loop {
        let mut formulas = vec![when.clone()];
        for t in &tracks {
            // The first keeps the unit of time what it is.
            t.told_apart(plain.unit, &mut formulas);
        }
        let model = observed(program, network, formulas)?;
        let graph = ZoneGraph::new(&model, &[])?;
        let probe = MeasureProbe::new(&graph, side, &formula, &tracks);
        let abstraction = if formula.asks_deadlock() {
            ExtrapolationAbstraction::Greatest
        } else {
            ExtrapolationAbstraction::LowerUpper
        };
        let search = SearchOptions {
            abstraction,
            budget: options.budget,
            threads: options.threads.max(1),
            ..SearchOptions::default()
        };
        let beside = SearchAside { probe: Some(&probe), within: None, go_on: Some(company.go_on) };
        let mut search = start::begin(&model, &[], &search, beside)?;
        let cutoff = look_everywhere(&mut *search, &mut tracks, side)?;
        company.add(search.statistics());
        if cutoff.is_some() {
            company.widest.set(search.widest());
        }
        let again = cutoff.is_none() && raised < RAISES && tracks.iter().any(|t| t.is_beyond(side));
        if !again {
            let mut end =
                ExtremumEnd { search: &mut *search, graph: &graph, side, when: &formula, cutoff, options };
            return tracks.iter().map(|t| end.finish(t)).collect();
        }
        raised += 1;
        tracks.iter_mut().for_each(|t| t.raise(side));
    }
}

/// The network with bounds of zones for these formulas.
pub(super) fn observed<'p>(
    program: &'p Program,
    network: &Network,
    formulas: Vec<QueryFormula>,
) -> Result<CompiledNetwork<'p>, ModelError> {
    let observe = ObservationOptions { formulas, ..ObservationOptions::default() };
    CompiledNetwork::new(program, network, &observe)
}

/// Goes through the search, and notes what is found.
fn look_everywhere(
    search: &mut dyn RoundSearch,
    tracks: &mut [MeasureTracker],
    side: ExtremumSide,
) -> Result<Option<SearchCutoff>, SearchError> {
    let mut found = Vec::new();
    loop {
        let flow = search.round(&mut found)?;
        found.drain(..).for_each(|finding| tracks[finding.question].note(&finding, side));
        if let ControlFlow::Break(end) = flow {
            return Ok(end);
        }
        if tracks.iter().all(MeasureTracker::is_unbounded) {
            return Ok(None);
        }
    }
}

/// A measure as workers look at it.
enum ProbedMeasure {
    /// Up to so many units its values are told apart.
    Clock {
        clock: usize,
        most: i64,
    },
    Number(Expr),
}

/// Looks in each symbolic state for the measures' values.
struct MeasureProbe<'a, 'm, 'p> {
    graph: &'a ZoneGraph<'m, 'p>,
    side: ExtremumSide,
    when: &'a StateFormula,
    measures: Vec<ProbedMeasure>,
}

impl StateProbe for MeasureProbe<'_, '_, '_> {
    fn each_place(&self, model: &CompiledNetwork, f: &mut dyn FnMut(u32)) {
        each_place(model, self.when, f);
        for m in &self.measures {
            if let ProbedMeasure::Number(e) = m {
                of_expression(model, e, f);
            }
        }
    }

    fn matters(&self, state: &[i64]) -> Result<bool, ModelError> {
        let here = self.graph.here(state);
        if !self.when.is_timed() {
            return self.when.holds(&here).map_err(no_value);
        }
        let Some(stay) = self.graph.stay(state)? else { return Ok(false) };
        let mut all = Dbm::universe(self.graph.dim());
        stay.invariant.iter().for_each(|c| {
            keep(&mut all, *c);
        });
        Ok(!self.when.part(&here, &all)?.is_empty())
    }

    fn look(&self, at: &ProbedState, out: &mut Vec<ProbeFinding>) -> Result<(), ModelError> {
        let here = self.graph.here(at.state);
        let zone = spread(self.graph.dim(), at.frame, at.zone);
        let parts = self.when.part(&here, &zone)?;
        if parts.is_empty() {
            return Ok(());
        }
        for (question, measure) in self.measures.iter().enumerate() {
            let mut add = |value| out.push(ProbeFinding { node: at.node, question, value });
            match measure {
                ProbedMeasure::Number(of) => {
                    let value = of.eval_in(&StateViewScope(&here)).map_err(no_value)?;
                    let value = number(value).ok_or_else(|| no_value(EvalError::Type))?;
                    add(ProbeValue::Bound { value, attained: true });
                }
                ProbedMeasure::Clock { clock, most } => {
                    for part in parts.zones() {
                        add(self.clock(*clock, *most, part, at.state)?);
                    }
                }
            }
        }
        Ok(())
    }
}

impl<'a, 'm, 'p> MeasureProbe<'a, 'm, 'p> {
    fn new(
        graph: &'a ZoneGraph<'m, 'p>,
        side: ExtremumSide,
        when: &'a StateFormula,
        tracks: &[MeasureTracker],
    ) -> Self {
        let measure = |t: &MeasureTracker| match t {
            MeasureTracker::Clock { clock, bound, .. } => {
                ProbedMeasure::Clock { clock: *clock, most: bound / graph.model.unit }
            }
            MeasureTracker::Number { of, .. } => ProbedMeasure::Number(of.clone()),
        };
        Self { graph, side, when, measures: tracks.iter().map(measure).collect() }
    }

    /// The clock's bound in a part of a zone in which the formula holds.
    fn clock(&self, clock: usize, most: i64, part: &Dbm, state: &[i64]) -> Result<ProbeValue, ModelError> {
        let (bound, value) = match self.side {
            ExtremumSide::Sup => (part.at(clock, 0), part.at(clock, 0).value()),
            ExtremumSide::Inf => (part.at(0, clock), -part.at(0, clock).value()),
        };
        if !bound.is_infinite() {
            // What is beyond the constants is not told apart, and a lower bound beyond them is weakened to "greater than it".
            let weakened = self.side == ExtremumSide::Inf && value == most && bound.is_strict();
            return Ok(if value > most || weakened {
                ProbeValue::Beyond
            } else {
                ProbeValue::Bound { value, attained: !bound.is_strict() }
            });
        }
        let stay = self.graph.stay(state)?.ok_or(ModelError::Initial)?;
        let here = self.graph.here(state);
        let for_ever = stay.for_ever() && lasts(self.when, &here, part)?;
        Ok(if for_ever { ProbeValue::ForEver } else { ProbeValue::Beyond })
    }
}

fn number(value: Value) -> Option<i64> {
    value.as_int().or_else(|| value.as_bool().map(i64::from))
}

/// Whether the formula goes on to hold while time passes.
fn lasts(when: &StateFormula, here: &dyn SymbolicView, part: &Dbm) -> Result<bool, ModelError> {
    let mut later = part.clone();
    later.up();
    Ok(when.part(here, &later)?.includes(&later))
}

fn improve(best: &mut Option<BestValue>, new: BestValue, side: ExtremumSide) {
    let better = best.is_none_or(|old| {
        let beyond = match side {
            ExtremumSide::Sup => new.value > old.value,
            ExtremumSide::Inf => new.value < old.value,
        };
        beyond || (new.value == old.value && new.attained && !old.attained)
    });
    if better {
        *best = Some(new);
    }
}

impl MeasureTracker {
    fn of(measure: &QueryMeasure, model: &CompiledNetwork) -> Result<Self, ModelError> {
        Ok(match measure {
            QueryMeasure::Clock(ClockId(c)) => {
                let clock = usize::from(*c) + 1;
                let most = model.extrapolation.greatest(model.dim).get(clock).copied();
                let most = most
                    .ok_or_else(|| ModelError::Question("a measure is a clock that is not there".into()))?;
                let bound = most.max(1).saturating_mul(model.unit);
                MeasureTracker::Clock { clock, bound, best: None, beyond: false, unbounded: None }
            }
            QueryMeasure::Data(e) => MeasureTracker::Number { of: e.clone(), best: None },
        })
    }

    /// Comparisons of the clock that make zones tell its values apart.
    fn told_apart(&self, unit: Nanos, out: &mut Vec<QueryFormula>) {
        if let MeasureTracker::Clock { clock, bound, .. } = self {
            out.extend([unit, *bound].map(|nanos| {
                QueryFormula::Clock(ClockConstraint {
                    clock: ClockId(*clock as u16 - 1),
                    minus: None,
                    op: ClockOp::Ge,
                    bound: TimeSum::constant(nanos),
                })
            }));
        }
    }

    fn note(&mut self, finding: &ProbeFinding, side: ExtremumSide) {
        let node = finding.node;
        match (self, finding.value) {
            (
                MeasureTracker::Number { best, .. } | MeasureTracker::Clock { best, .. },
                ProbeValue::Bound { value, attained },
            ) => improve(best, BestValue { value, attained, node }, side),
            (MeasureTracker::Clock { unbounded, .. }, ProbeValue::ForEver) => {
                unbounded.get_or_insert(node);
            }
            (MeasureTracker::Clock { beyond, .. }, ProbeValue::Beyond) => *beyond = true,
            (MeasureTracker::Number { .. }, ProbeValue::ForEver | ProbeValue::Beyond)
            | (_, ProbeValue::Met { .. }) => {}
        }
    }

    fn is_unbounded(&self) -> bool {
        match self {
            MeasureTracker::Clock { unbounded, .. } => unbounded.is_some(),
            MeasureTracker::Number { .. } => false,
        }
    }

    /// Whether the value may be one that extrapolation has made.
    fn is_beyond(&self, side: ExtremumSide) -> bool {
        match self {
            MeasureTracker::Number { .. } => false,
            MeasureTracker::Clock { best, beyond, unbounded, .. } => match side {
                ExtremumSide::Sup => unbounded.is_none() && *beyond,
                ExtremumSide::Inf => best.is_none() && *beyond,
            },
        }
    }

    fn raise(&mut self, side: ExtremumSide) {
        let more = self.is_beyond(side);
        match self {
            // The nodes have other numbers next time.
            MeasureTracker::Number { best, .. } => *best = None,
            MeasureTracker::Clock { bound, best, beyond, unbounded, .. } => {
                if more {
                    *bound = bound.saturating_mul(2);
                }
                (*best, *beyond, *unbounded) = (None, false, None);
            }
        }
    }
}

/// A search that has ended.
struct ExtremumEnd<'a, 'm, 'p> {
    search: &'a mut dyn RoundSearch,
    graph: &'a ZoneGraph<'m, 'p>,
    side: ExtremumSide,
    when: &'a StateFormula,
    cutoff: Option<SearchCutoff>,
    options: ExtremumOptions,
}

impl ExtremumEnd<'_, '_, '_> {
    fn finish(&mut self, track: &MeasureTracker) -> Result<MeasureExtremum, SearchError> {
        let unit = self.graph.model.unit;
        let cut = self.cutoff.is_some();
        let (best, open, endless, clock) = match track {
            MeasureTracker::Number { best, .. } => (*best, cut, None, None),
            MeasureTracker::Clock { best, unbounded, clock, .. } => {
                (*best, cut || track.is_beyond(self.side), *unbounded, Some(*clock))
            }
        };
        let quantity = |value: i64| match clock {
            Some(_) => ExtremumValue::Nanos(value.saturating_mul(unit)),
            None => ExtremumValue::Number(value),
        };
        if let Some(node) = endless {
            let run = self.run(node, &[])?;
            return Ok(MeasureExtremum { limit: ExtremumLimit::Unbounded, run: Some(run) });
        }
        let Some(b) = best.filter(|_| !open) else {
            let limit = if open {
                ExtremumLimit::Inconclusive { seen: best.map(|b| quantity(b.value)) }
            } else {
                ExtremumLimit::Nowhere
            };
            return Ok(MeasureExtremum { limit, run: None });
        };
        let near = clock.map(|x| near(x, b, self.side)).into_iter().collect::<Vec<_>>();
        let run = self.run(b.node, &near)?;
        let limit = ExtremumLimit::At { value: quantity(b.value), attained: b.attained };
        Ok(MeasureExtremum { limit, run: Some(run) })
    }

    /// A run to a node, and on to where the formula and the rest holds.
    fn run(&mut self, node: u32, besides: &[DifferenceConstraint]) -> Result<Box<WitnessRun>, SearchError> {
        let stops = takes(self.search.path_to(node)?.into_iter().map(std::rc::Rc::new));
        reach_formula(self.graph, stops, self.when, besides, self.options.timing).map(Box::new)
    }
}

/// That the clock has the value, or is less than a unit from it.
fn near(clock: usize, b: BestValue, side: ExtremumSide) -> DifferenceConstraint {
    let x = clock as u16;
    match (side, b.attained) {
        (ExtremumSide::Sup, true) => DifferenceConstraint { i: 0, j: x, bound: DbmBound::le(-b.value) },
        (ExtremumSide::Sup, false) => DifferenceConstraint { i: 0, j: x, bound: DbmBound::lt(1 - b.value) },
        (ExtremumSide::Inf, true) => DifferenceConstraint { i: x, j: 0, bound: DbmBound::le(b.value) },
        (ExtremumSide::Inf, false) => DifferenceConstraint { i: x, j: 0, bound: DbmBound::lt(b.value + 1) },
    }
}
