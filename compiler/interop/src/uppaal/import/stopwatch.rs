//! Stopwatches: clocks that an invariant stops (`x' == 0`), where that can be said without stopping them, and where it cannot.
//!
//! Sets of clocks that are not all equally fast are no zones, and cost a search of their own (`spec/search.md`). So a clock is
//! not stopped where its value is known all the same. Either nothing asks for it before it is set again: it may as well run.
//! Or it stands at a number, the same on every way there: then what asks for it asks for that number, and it is set to it on the way out.
//! All others stand still in the scenario, too.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::Span;

use super::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind, UppaalQuantifier},
    fault::{UppaalFault, fault},
    known::ClockEvent,
    scope::ScenarioExprText,
    template::ParsedTemplate,
    translation::UppaalTranslation,
    xml::UppaalTemplate,
};
use crate::exchange::note::NoteSeverity;

/// The clocks that stand in a location, with their values; and the invariant without what stops them.
#[derive(Clone, Debug, Default)]
pub struct StoppedClocks {
    pub values: BTreeMap<String, i64>,
    /// The clocks that stand at a value that depends on the run.
    pub stands: Vec<String>,
    pub invariant: Option<UppaalExpr>,
}

/// `x' == …`
struct ClockRate {
    clock: String,
    rate: ScenarioExprText,
    span: Span,
}

/// One case of an edge, for one clock.
struct ClockStep {
    from: usize,
    to: usize,
    effect: ClockEffect,
}

/// What an edge does with a clock.
#[derive(Clone, Copy)]
struct ClockEffect {
    /// It is read, as it was before.
    reads: bool,
    /// What it is set to in the end, if it is set: a number, if that is constant.
    sets: Option<Option<i64>>,
}

impl UppaalTranslation<'_> {
    /// What stands in each location of a template, in the process that is being written.
    pub fn stopped(
        &mut self,
        model: &UppaalTemplate,
        template: &ParsedTemplate,
        names: &[String],
    ) -> Result<Vec<StoppedClocks>, UppaalFault> {
        let mut all = Vec::new();
        let mut rates = Vec::new();
        for invariant in &template.invariants {
            let mut found = Vec::new();
            let invariant = match invariant {
                Some(e) => self.without_rates(e, &mut found)?,
                None => None,
            };
            all.push(StoppedClocks { values: BTreeMap::new(), stands: Vec::new(), invariant });
            rates.push(found);
        }
        let clocks: BTreeSet<String> = rates.iter().flatten().map(|rate| rate.clock.clone()).collect();
        if clocks.is_empty() {
            return Ok(all);
        }
        let notes = self.notes.len();
        let logs = self.clock_logs(model, template, names);
        let asked: Vec<_> =
            all.iter().map(|l: &StoppedClocks| self.clocks_asked(l.invariant.as_ref())).collect();
        self.notes.truncate(notes);
        for clock in clocks {
            let steps = logs.iter().filter_map(|(at, log)| {
                let transition = model.transitions.get(*at)?;
                Some(ClockStep { from: transition.from, to: transition.to, effect: effect_of(log, &clock) })
            });
            let steps: Vec<ClockStep> = steps.collect();
            let asked: Vec<bool> = asked.iter().map(|log| log.iter().any(|e| e.clock == clock)).collect();
            let alive = alive(&steps, &asked);
            self.stop(&clock, (model.initial, &steps, &alive), &rates, &mut all)?;
        }
        Ok(all)
    }

    /// Where one clock stands.
    fn stop(
        &mut self,
        clock: &str,
        (initial, steps, alive): (usize, &[ClockStep], &[bool]),
        rates: &[Vec<ClockRate>],
        all: &mut [StoppedClocks],
    ) -> Result<(), UppaalFault> {
        let mut stopped: Vec<Option<&ClockRate>> = Vec::new();
        for found in rates {
            let rate = found.iter().find(|rate| rate.clock == clock && rate.rate.value != Some(1));
            if let Some(ClockRate { rate: ScenarioExprText { value: Some(n), .. }, span, .. }) = rate
                && *n != 0
            {
                return fault(
                    *span,
                    format!("a clock runs (`1`) or stands (`0`); the rate {n} is not supported"),
                );
            }
            stopped.push(rate);
        }
        let values = values(initial, steps, &stopped);
        let stands = |rate: &ClockRate| rate.rate.value == Some(0);
        let runs_on = |at: usize, rate: &ClockRate| alive[at] && values[at].is_none() && stands(rate);
        let real = stopped.iter().enumerate().any(|(at, rate)| rate.is_some_and(|rate| runs_on(at, rate)));
        if real && stopped.iter().flatten().all(|rate| stands(rate)) {
            let locations = all.iter_mut().zip(&stopped).filter(|(_, rate)| rate.is_some());
            locations.for_each(|(location, _)| location.stands.push(clock.to_owned()));
            return Ok(());
        }
        if let Some(first) = stopped.iter().flatten().next() {
            self.stopwatches.push((clock.to_owned(), first.span));
        }
        for (at, rate) in stopped.iter().enumerate() {
            let Some(rate) = rate else { continue };
            match values[at] {
                _ if !alive[at] => {
                    let message =
                        format!("`{clock}` may run on here: nothing asks for it before it is set again");
                    self.notes.push((rate.span, NoteSeverity::Info, message));
                }
                Some(n) if stands(rate) && !real => {
                    all[at].values.insert(clock.to_owned(), n);
                }
                _ if stands(rate) => all[at].stands.push(clock.to_owned()),
                Some(_) | None => {
                    return fault(
                        rate.span,
                        format!(
                            "the rate of `{clock}` is an expression here, and it is asked for later: give the state in which it stands \
                             a location of its own, with `{clock}' == 0`, and let an urgent channel lead there and back"
                        ),
                    );
                }
            }
        }
        Ok(())
    }

    /// An invariant without its rates, which are collected.
    fn without_rates(
        &mut self,
        e: &UppaalExpr,
        out: &mut Vec<ClockRate>,
    ) -> Result<Option<UppaalExpr>, UppaalFault> {
        if !has_rate(e) {
            return Ok(Some(e.clone()));
        }
        match &e.kind {
            UppaalExprKind::Binary(UppaalBinaryOperator::And, a, b) => {
                let (a, b) = (self.without_rates(a, out)?, self.without_rates(b, out)?);
                let both = |a: UppaalExpr, b| {
                    let kind = UppaalExprKind::Binary(UppaalBinaryOperator::And, Box::new(a), Box::new(b));
                    UppaalExpr { kind, span: e.span }
                };
                Ok(match (a, b) {
                    (Some(a), Some(b)) => Some(both(a, b)),
                    (a, b) => a.or(b),
                })
            }
            UppaalExprKind::Quantified(UppaalQuantifier::Forall, name, ty, of) => {
                let found = self.parts(name, ty, |cx| {
                    let mut found = Vec::new();
                    cx.without_rates(of, &mut found).map(|rest| (rest, found))
                })?;
                let mut rest = None;
                for (left, found) in found {
                    rest = rest.or(left);
                    out.extend(found);
                }
                Ok(rest.map(|rest| {
                    let kind = UppaalExprKind::Quantified(
                        UppaalQuantifier::Forall,
                        name.clone(),
                        ty.clone(),
                        Box::new(rest),
                    );
                    UppaalExpr { kind, span: e.span }
                }))
            }
            UppaalExprKind::Binary(UppaalBinaryOperator::Eq, a, b) => {
                let ((UppaalExprKind::Rate(of), rate) | (rate, UppaalExprKind::Rate(of))) =
                    (&a.kind, &b.kind)
                else {
                    return fault(e.span, "a rate is given as `x' == 0` or `x' == 1`");
                };
                let rate = UppaalExpr { kind: rate.clone(), span: e.span };
                let rate = self.expr(&rate)?.into_int();
                out.push(ClockRate { clock: self.clock(of)?, rate, span: e.span });
                Ok(None)
            }
            _ => fault(
                e.span,
                "a rate is given as `x' == 0` or `x' == 1`, joined to the rest of the invariant by `&&`",
            ),
        }
    }

    /// What each case of each edge does with the clocks, one after the other, as it is written.
    fn clock_logs(
        &mut self,
        model: &UppaalTemplate,
        template: &ParsedTemplate,
        names: &[String],
    ) -> Vec<(usize, Vec<ClockEvent>)> {
        let mut logs = Vec::new();
        for (at, (transition, edge)) in model.transitions.iter().zip(&template.edges).enumerate() {
            let cases = self.edge_cases(edge, |cx| {
                cx.clock_log.clear();
                cx.edge_texts(transition, edge, names)?;
                Ok(std::mem::take(&mut cx.clock_log))
            });
            // What is wrong is said when it is written.
            logs.extend(cases.unwrap_or_default().into_iter().map(|log| (at, log)));
        }
        logs
    }

    fn clocks_asked(&mut self, invariant: Option<&UppaalExpr>) -> Vec<ClockEvent> {
        self.clock_log.clear();
        if let Some(e) = invariant {
            let _wrong_is_said_when_it_is_written = self.alternatives(e);
        }
        std::mem::take(&mut self.clock_log)
    }
}

/// What counts of all that an edge does with a clock.
fn effect_of(log: &[ClockEvent], clock: &str) -> ClockEffect {
    let events: Vec<_> = log.iter().filter(|event| event.clock == clock).map(|event| event.set).collect();
    ClockEffect {
        reads: events.first().is_some_and(Option::is_none),
        sets: events.iter().rev().find_map(|set| *set),
    }
}

fn has_rate(e: &UppaalExpr) -> bool {
    let mut found = false;
    e.each(&mut |part| found |= matches!(part.kind, UppaalExprKind::Rate(_)));
    found
}

/// The locations from which something asks for the clock before it is set.
fn alive(steps: &[ClockStep], asked: &[bool]) -> Vec<bool> {
    let mut alive = asked.to_vec();
    loop {
        let mut changed = false;
        for edge in steps {
            let needs = edge.effect.reads || edge.effect.sets.is_none() && alive[edge.to];
            if needs && !alive[edge.from] {
                alive[edge.from] = true;
                changed = true;
            }
        }
        if !changed {
            return alive;
        }
    }
}

/// At which number the clock stands wherever it is stopped, if that is one and the same on every way there.
fn values(initial: usize, steps: &[ClockStep], stopped: &[Option<&ClockRate>]) -> Vec<Option<i64>> {
    // None: nothing leads there so far. Some(None): different values.
    let mut values: Vec<Option<Option<i64>>> = vec![None; stopped.len()];
    values[initial] = Some(Some(0));
    loop {
        let mut changed = false;
        for edge in steps {
            let arrives = match (edge.effect.sets, stopped[edge.from], values[edge.from]) {
                (_, _, None) => None,
                (Some(n), _, Some(_)) => Some(n),
                (None, Some(rate), Some(n)) if rate.rate.value == Some(0) => Some(n),
                // Where it runs, it may have any value.
                (None, _, Some(_)) => Some(None),
            };
            let Some(arrives) = arrives else { continue };
            let merged = match values[edge.to] {
                None => arrives,
                Some(before) if before == arrives => before,
                Some(_) => None,
            };
            if values[edge.to] != Some(merged) {
                values[edge.to] = Some(merged);
                changed = true;
            }
        }
        if !changed {
            return values.into_iter().map(Option::flatten).collect();
        }
    }
}
