//! Least upper and greatest lower bounds where clocks stand still, by questions of reachability.
//!
//! Zones say more than can happen there, so a bound is found from both ends. A run to a state of the formula is looked for; along its path
//! a linear program tells exactly how far the measure goes. Then a state beyond that is asked for. If no run reaches one, that was the
//! bound; otherwise its path tells of a value beyond the first, and so on. Each question may also skip some values, so that bounds far away
//! are come to by halving. A bound that is no whole number of nanoseconds, and one of which zones cannot tell, stay open.

use hrdsl_ir::{
    Expr, Program, Value,
    expr::{BinaryOp, EvalError},
    ta::{ClockConstraint, ClockId, ClockOp, Network, QueryFormula, QueryMeasure, TimeSum},
};

use crate::{
    decide::{
        extremum::{
            ExtremumLimit, ExtremumOptions, ExtremumQuestion, ExtremumSide, ExtremumValue, MeasureExtremum,
            observed,
        },
        stopwatch,
    },
    network::{
        error::ModelError,
        graph::ZoneGraph,
        model::CompiledNetwork,
        query::{GoalKind, ReachabilityGoal, StateFormula, StateViewScope, no_value},
    },
    search::{options::SearchOptions, report::GoalOutcome, round_search::SearchCompany},
    witness::{
        build::{path_of, reach_formula, takes, ways},
        error::SearchError,
        run::WitnessRun,
        standing::ClockExtremum,
    },
    zone::{constraint::DifferenceConstraint, dbm::DbmBound},
};

/// So many questions are asked of a measure at most.
const QUESTIONS: usize = 64;

/// A value that runs come to, or as near to as one likes.
struct SeenValue {
    value: i64,
    attained: bool,
    /// Nothing of it was rounded.
    is_whole: bool,
    /// A run along whose path it is found.
    run: WitnessRun,
}

/// What is known after a question.
enum Seen {
    Value(SeenValue),
    /// The measure grows without bound along the path of this run.
    Unbounded(Box<WitnessRun>),
    /// No run comes to such a state.
    Nowhere,
    Unknown,
}

/// A value, and whether it is itself beyond enough.
type AskedValue = (i64, bool);

struct StandingBound<'a> {
    program: &'a Program,
    network: &'a Network,
    side: ExtremumSide,
    measure: &'a QueryMeasure,
    when: &'a QueryFormula,
    options: ExtremumOptions,
    company: SearchCompany<'a>,
    /// The number is that of a bool.
    is_bool: bool,
}

/// The bounds of each measure.
///
/// # Errors
/// If the model is at fault, or a measure has no value where the formula holds.
pub(super) fn extrema(
    program: &Program,
    network: &Network,
    question: &ExtremumQuestion,
    options: ExtremumOptions,
    company: SearchCompany<'_>,
) -> Result<Vec<MeasureExtremum>, SearchError> {
    let ExtremumQuestion { side, of, when } = *question;
    let one = |measure| {
        let is_bool = false;
        StandingBound { program, network, side, measure, when, options, company, is_bool }.find()
    };
    of.iter().map(one).collect()
}

impl StandingBound<'_> {
    fn find(mut self) -> Result<MeasureExtremum, SearchError> {
        let mut best = match self.ask(None)? {
            Seen::Value(first) => first,
            Seen::Nowhere => return Ok(alone(ExtremumLimit::Nowhere)),
            Seen::Unbounded(run) => return Ok(unbounded(run)),
            Seen::Unknown => return Ok(alone(ExtremumLimit::Inconclusive { seen: None })),
        };
        // Nothing is beyond this.
        let mut limit = self.limit();
        let mut step = self.step()?;
        for turn in 0..QUESTIONS {
            if best.attained && limit == Some(best.value) {
                return self.known(best);
            }
            let nearest = (best.value, !best.attained);
            let asked = match limit {
                _ if turn % 2 == 0 => nearest,
                None => {
                    step = step.saturating_mul(2);
                    (self.beyond(best.value, step), false)
                }
                Some(limit) => self.middle(best.value, limit)?.map_or(nearest, |middle| (middle, false)),
            };
            match self.ask(Some(asked))? {
                // Beyond what was rounded there is the same again.
                Seen::Value(next) if !next.is_whole && next.value == best.value => break,
                Seen::Value(next) => best = next,
                Seen::Unbounded(run) => return Ok(unbounded(run)),
                Seen::Nowhere if asked == nearest && best.is_whole => return self.known(best),
                Seen::Nowhere if asked == nearest => break,
                Seen::Nowhere => limit = Some(asked.0),
                Seen::Unknown => break,
            }
        }
        Ok(alone(ExtremumLimit::Inconclusive { seen: Some(self.quantity(best.value)) }))
    }

    fn quantity(&self, value: i64) -> ExtremumValue {
        match self.measure {
            QueryMeasure::Clock(_) => ExtremumValue::Nanos(value),
            QueryMeasure::Data(_) => ExtremumValue::Number(value),
        }
    }

    fn is_greatest(&self) -> bool {
        self.side == ExtremumSide::Sup
    }

    /// What nothing of the measure's kind is beyond.
    fn limit(&self) -> Option<i64> {
        match self.measure {
            QueryMeasure::Clock(_) => (!self.is_greatest()).then_some(0),
            QueryMeasure::Data(_) => self.is_bool.then(|| i64::from(self.is_greatest())),
        }
    }

    /// The first step: half of what the second question goes on by.
    fn step(&self) -> Result<i64, ModelError> {
        Ok(match self.measure {
            QueryMeasure::Clock(_) => observed(self.program, self.network, vec![self.when.clone()])?.unit,
            QueryMeasure::Data(_) => 1,
        })
    }

    fn beyond(&self, value: i64, step: i64) -> i64 {
        if self.is_greatest() { value.saturating_add(step) } else { value.saturating_sub(step) }
    }

    /// A value between two, as coarse as the network's times; `None`: there is none.
    fn middle(&self, best: i64, limit: i64) -> Result<Option<i64>, ModelError> {
        let grain = self.step()?;
        let middle = best.midpoint(limit).div_euclid(grain) * grain;
        Ok((middle > best.min(limit) && middle < best.max(limit)).then_some(middle))
    }

    /// That the measure is beyond a value.
    fn compared(&self, (value, or_equal): AskedValue) -> QueryFormula {
        match self.measure {
            QueryMeasure::Clock(clock) => {
                let op = match (self.side, or_equal) {
                    (ExtremumSide::Sup, true) => ClockOp::Ge,
                    (ExtremumSide::Sup, false) => ClockOp::Gt,
                    (ExtremumSide::Inf, true) => ClockOp::Le,
                    (ExtremumSide::Inf, false) => ClockOp::Lt,
                };
                let (clock, bound) = (ClockId(clock.0), TimeSum::constant(value));
                QueryFormula::Clock(ClockConstraint { clock, minus: None, op, bound })
            }
            QueryMeasure::Data(e) if self.is_bool && self.is_greatest() => QueryFormula::Data(e.clone()),
            QueryMeasure::Data(e) if self.is_bool => {
                QueryFormula::Not(Box::new(QueryFormula::Data(e.clone())))
            }
            // INVARIANT: a number is attained wherever it is found, so that it is never asked for itself.
            QueryMeasure::Data(e) => {
                let op = if self.is_greatest() { BinaryOp::Gt } else { BinaryOp::Lt };
                QueryFormula::Data(Expr::binary(op, e.clone(), Expr::int(value)))
            }
        }
    }

    /// Looks for a run to where the formula holds and the measure is beyond a value.
    fn ask(&mut self, beyond: Option<AskedValue>) -> Result<Seen, SearchError> {
        let formulas: Vec<QueryFormula> =
            std::iter::once(self.when.clone()).chain(beyond.map(|value| self.compared(value))).collect();
        let model = observed(self.program, self.network, formulas.clone())?;
        let goal = ReachabilityGoal { what: GoalKind::Formula(QueryFormula::And(formulas)), settled: false };
        let options = SearchOptions { budget: self.options.budget, ..SearchOptions::default() };
        let mut report = stopwatch::explore(&model, &[goal], &options, self.company.go_on)?;
        self.company.add(report.statistics());
        self.company.widest.set(report.widest.take());
        match report.goals.pop() {
            Some(GoalOutcome::Reached(run)) => self.measured(&model, *run),
            Some(GoalOutcome::Unreachable) => Ok(Seen::Nowhere),
            Some(GoalOutcome::Inconclusive(_)) | None => Ok(Seen::Unknown),
        }
    }

    /// How far the measure goes along the path of a run.
    fn measured(&mut self, model: &CompiledNetwork, run: WitnessRun) -> Result<Seen, SearchError> {
        let graph = ZoneGraph::new(model, &[])?;
        let (path, fault) = path_of(model, &run)?;
        if fault.is_some() {
            return Err(SearchError::Internal("a run takes a transition that is a fault".into()));
        }
        let clock = match self.measure {
            QueryMeasure::Clock(ClockId(clock)) => usize::from(*clock) + 1,
            QueryMeasure::Data(e) => {
                let mut state = graph.initial();
                for taken in &path {
                    state = graph.target(&state, taken)?;
                }
                let here = graph.here(&state);
                let found = e.eval_in(&StateViewScope(&here)).map_err(no_value)?;
                self.is_bool = found.as_bool().is_some();
                let value = number(found)?;
                return Ok(Seen::Value(SeenValue { value, attained: true, is_whole: true, run }));
            }
        };
        if clock >= model.dim {
            return Err(ModelError::Question("a measure is a clock that is not there".into()).into());
        }
        let formula = StateFormula::from(self.when);
        let stops = takes(path.into_iter().map(std::rc::Rc::new));
        let mut best: Option<SeenValue> = None;
        for way in ways(&graph, stops, Some(&formula))? {
            match way.extremum(clock, self.is_greatest())? {
                None => {}
                Some(ClockExtremum::Unbounded) => return Ok(Seen::Unbounded(Box::new(run))),
                Some(ClockExtremum::At { units, over, attained }) => {
                    let next = self.as_nanos(model, (units, over), attained, &run)?;
                    if best.as_ref().is_none_or(|old| self.is_better(&next, old)) {
                        best = Some(next);
                    }
                }
            }
        }
        let lost = || SearchError::Internal("the path of a run does not meet its formula".into());
        best.map(Seen::Value).ok_or_else(lost)
    }

    /// A fraction of units in nanoseconds, or what runs come to at least.
    fn as_nanos(
        &self,
        model: &CompiledNetwork,
        (units, over): (i128, i128),
        attained: bool,
        run: &WitnessRun,
    ) -> Result<SeenValue, SearchError> {
        let large = || SearchError::Internal("a bound needs numbers of more than 64 bits".into());
        let exact = units.checked_mul(i128::from(model.unit)).ok_or_else(large)?;
        let is_whole = exact % over == 0;
        let up = i128::from(!is_whole && !self.is_greatest());
        let value = i64::try_from(exact.div_euclid(over) + up).map_err(|_| large())?;
        // What is rounded is on the near side, so that runs come to it.
        Ok(SeenValue { value, attained: attained || !is_whole, is_whole, run: run.clone() })
    }

    fn is_better(&self, new: &SeenValue, old: &SeenValue) -> bool {
        let farther = if self.is_greatest() { new.value > old.value } else { new.value < old.value };
        farther || (new.value == old.value && new.attained && !old.attained)
    }

    /// The bound, with a run to it or to less than a unit of time from it.
    fn known(&self, best: SeenValue) -> Result<MeasureExtremum, SearchError> {
        let limit = ExtremumLimit::At { value: self.quantity(best.value), attained: best.attained };
        let QueryMeasure::Clock(ClockId(clock)) = self.measure else {
            return Ok(MeasureExtremum { limit, run: Some(Box::new(best.run)) });
        };
        let formulas = vec![self.when.clone(), self.compared((best.value, true))];
        let model = observed(self.program, self.network, formulas)?;
        let graph = ZoneGraph::new(&model, &[])?;
        let (path, _) = path_of(&model, &best.run)?;
        let stops = takes(path.into_iter().map(std::rc::Rc::new));
        let units = best.value / model.unit;
        let bound = |n: i64| if best.attained { DbmBound::le(n) } else { DbmBound::lt(n + 1) };
        let x = clock + 1;
        let near = match self.side {
            ExtremumSide::Sup => DifferenceConstraint { i: 0, j: x, bound: bound(-units) },
            ExtremumSide::Inf => DifferenceConstraint { i: x, j: 0, bound: bound(units) },
        };
        let formula = StateFormula::from(self.when);
        let run = reach_formula(&graph, stops, &formula, &[near], self.options.timing)?;
        Ok(MeasureExtremum { limit, run: Some(Box::new(run)) })
    }
}

fn number(value: Value) -> Result<i64, ModelError> {
    let number = value.as_int().or_else(|| value.as_bool().map(i64::from));
    number.ok_or_else(|| no_value(EvalError::Type))
}

fn alone(limit: ExtremumLimit) -> MeasureExtremum {
    MeasureExtremum { limit, run: None }
}

fn unbounded(run: Box<WitnessRun>) -> MeasureExtremum {
    MeasureExtremum { limit: ExtremumLimit::Unbounded, run: Some(run) }
}
