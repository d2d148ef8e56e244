//! Patterns as parts of monitors: the tables of the page on requirements.

use hrdsl_ir::{
    Expr,
    expr::UnaryOp,
    monitor::{MonitorClockGuard, MonitorEffect, MonitorMargin, MonitorTrigger},
    value::nanos,
};
use hrdsl_model::{self as model, TypedOccurrence};
use hrdsl_syntax::{CountBound, LastingBound, RequirementPattern};

use super::{
    margin,
    parts::{MonitorParts, PatternPart, events},
    scopes::ScopeSort,
};
use crate::lower::expr::ruled_out;
use MonitorEffect::{Discharge, Fail, ResetClock, Trigger};

type TypedPlainPattern = RequirementPattern<TypedOccurrence, model::TypedExpr, f64, u32>;

impl MonitorParts<'_, '_> {
    pub fn pattern(&mut self, pattern: &TypedPlainPattern, scope: ScopeSort) -> PatternPart {
        match pattern {
            RequirementPattern::Causes { trigger, response, not_before, within } => {
                self.causes_part([trigger, response], *not_before, *within)
            }
            RequirementPattern::Forbids { trigger, forbidden, until } => {
                self.forbids([trigger, forbidden, until])
            }
            RequirementPattern::Precedes { first, then, not_before, within } => {
                self.precedes([first, then], *not_before, *within)
            }
            RequirementPattern::NeverWhile { events, condition: None } if scope != ScopeSort::Whole => {
                self.at_most(events, 0, scope)
            }
            RequirementPattern::NeverWhile { events, condition } => self.never(events, condition.as_ref()),
            RequirementPattern::Globally(condition) => self.globally(condition),
            RequirementPattern::Eventually { events, condition, within } => {
                self.eventually(events, condition.as_ref(), *within)
            }
            RequirementPattern::Counts { events, bound, count } => {
                let count = count.unwrap_or(0);
                match bound {
                    CountBound::AtMost => self.at_most(events, count, scope),
                    CountBound::AtLeast => self.at_least(events, count, false),
                    CountBound::Exactly => self.at_least(events, count, true),
                }
            }
            RequirementPattern::Formula(_) => ruled_out("formula as an automaton"),
            RequirementPattern::Lasts { condition, bound, time } => {
                let time = time.unwrap_or(0.0);
                match bound {
                    LastingBound::AtLeast => self.lasts_at_least(condition, time),
                    LastingBound::AtMost => self.lasts_at_most(condition, time),
                }
            }
        }
    }

    /// While an answer is due, an event that is both answer and trigger answers.
    fn causes_part(
        &mut self,
        [trigger, response]: [&[TypedOccurrence]; 2],
        not_before: Option<f64>,
        within: Option<f64>,
    ) -> PatternPart {
        let (trigger, response) = (self.causes(trigger), self.causes(response));
        let mut part = PatternPart::default();
        let idle = part.state("idle", &[]);
        let pending = part.pending("pending", within.map(nanos), &[Fail]);
        part.edges(idle, pending, &trigger, &[Trigger, ResetClock]);
        if let Some(early) = not_before {
            let early = Some(MonitorClockGuard::Before(nanos(early)));
            part.timed(pending, idle, &response, early, &[Fail]);
        }
        part.edges(pending, idle, &response, &[Discharge]);
        part.edges(pending, pending, &trigger, &[Trigger]);
        if within.is_some() {
            part.edges(pending, idle, &[MonitorTrigger::Deadline], &[Fail]);
        }
        part.entry(None, idle, &[]);
        part
    }

    fn forbids(&mut self, [trigger, forbidden, until]: [&[TypedOccurrence]; 3]) -> PatternPart {
        let trigger = self.causes(trigger);
        let (forbidden, until) = (self.causes(forbidden), self.causes(until));
        let mut part = PatternPart::default();
        let idle = part.state("idle", &[]);
        let armed = part.state("armed", &[Discharge]);
        part.edges(idle, armed, &trigger, &[Trigger]);
        part.edges(armed, armed, &forbidden, &[Fail]);
        part.edges(armed, idle, &until, &[Discharge]);
        part.edges(armed, armed, &trigger, &[Trigger]);
        part.entry(None, idle, &[]);
        part
    }

    /// An event that is both comes first, and is allowed. With `within` the time counts from the last of those that come
    /// first, with `not before` from the first of them.
    fn precedes(
        &mut self,
        [first, then]: [&[TypedOccurrence]; 2],
        not_before: Option<f64>,
        within: Option<f64>,
    ) -> PatternPart {
        let (first, then) = (self.causes(first), self.causes(then));
        let timed = not_before.is_some() || within.is_some();
        let starts: &[MonitorEffect] = if timed { &[ResetClock] } else { &[] };
        let mut part = PatternPart::default();
        let before = part.state("before", &[]);
        let after = part.state("after", &[]);
        part.edges(before, after, &first, starts);
        part.edges(before, before, &then, &[Trigger, Fail]);
        if within.is_some() {
            part.edges(after, after, &first, &[ResetClock]);
        }
        let wrong = not_before
            .map(|t| MonitorClockGuard::Before(nanos(t)))
            .or_else(|| within.map(|t| MonitorClockGuard::After(nanos(t))));
        if wrong.is_some() {
            part.timed(after, after, &then, wrong, &[Trigger, Fail]);
        }
        part.edges(after, after, &then, &[Trigger, Discharge]);
        part.entry(None, before, &[]);
        part
    }

    /// The margin is that of the negated condition, at the events.
    fn never(&mut self, listed: &[TypedOccurrence], condition: Option<&model::TypedExpr>) -> PatternPart {
        let on = self.causes(listed);
        let guard = condition.map(|c| self.reader.expr(c));
        let margin = condition.and_then(|c| margin(c, false, &mut self.reader));
        let mut part = PatternPart::default();
        let watch = part.state("watch", &[]);
        match &guard {
            Some(guard) => {
                part.guarded(watch, watch, &on, guard, &[Trigger, Fail]);
                part.edges(watch, watch, &on, &[Trigger, Discharge]);
            }
            None => part.edges(watch, watch, &on, &[Trigger, Fail]),
        }
        part.entry(None, watch, &[]);
        // Without events it would be taken at every sample.
        let at = events(listed);
        part.margin = margin.filter(|_| at.len() == listed.len()).map(|(value, unit)| MonitorMargin {
            value,
            unit,
            at,
            within: Vec::new(),
        });
        part
    }

    /// The first sample triggers; each time the condition ceases to hold is one failure.
    fn globally(&mut self, condition: &model::TypedExpr) -> PatternPart {
        let holds = self.reader.expr(condition);
        let broken = not(holds.clone());
        let margin = margin(condition, true, &mut self.reader);
        let sample = [MonitorTrigger::Sample];
        let mut part = PatternPart::default();
        let (unseen, seen) = (part.state("unseen", &[]), part.state("seen", &[]));
        let violated = part.state("violated", &[]);
        part.guarded(unseen, violated, &sample, &broken, &[Trigger, Fail]);
        part.guarded(unseen, seen, &sample, &holds, &[Trigger]);
        part.guarded(seen, violated, &sample, &broken, &[Fail]);
        part.guarded(violated, seen, &sample, &holds, &[]);
        part.entry(Some(broken), violated, &[Trigger, Fail]);
        part.entry(Some(holds), seen, &[Trigger]);
        part.entry(None, unseen, &[]);
        part.margin =
            margin.map(|(value, unit)| MonitorMargin { value, unit, at: Vec::new(), within: Vec::new() });
        part
    }

    fn eventually(
        &mut self,
        listed: &[TypedOccurrence],
        condition: Option<&model::TypedExpr>,
        within: Option<f64>,
    ) -> PatternPart {
        let mut part = PatternPart::default();
        let waiting = part.pending("waiting", within.map(nanos), &[Fail]);
        let met = part.state("met", &[]);
        let on = self.causes(listed);
        part.edges(waiting, met, &on, &[Discharge]);
        if let Some(condition) = condition {
            let holds = self.reader.expr(condition);
            part.guarded(waiting, met, &[MonitorTrigger::Sample], &holds, &[Discharge]);
            part.entry(Some(holds), met, &[Trigger, Discharge]);
        }
        if within.is_some() {
            let missed = part.state("missed", &[]);
            part.edges(waiting, missed, &[MonitorTrigger::Deadline], &[Fail]);
        }
        part.entry(None, waiting, &[Trigger, ResetClock]);
        part
    }

    /// In the whole run each event is judged; in a part of it, that part.
    fn at_most(&mut self, listed: &[TypedOccurrence], count: u32, scope: ScopeSort) -> PatternPart {
        let on = self.causes(listed);
        let [enters, allowed, one_more, closing]: [&[MonitorEffect]; 4] = match scope {
            ScopeSort::Whole => [&[], &[Trigger, Discharge], &[Trigger, Fail], &[]],
            ScopeSort::Open => [&[Trigger], &[], &[Fail], &[Discharge]],
            ScopeSort::Closed => [&[], &[], &[Fail], &[Trigger, Discharge]],
        };
        let mut part = PatternPart::default();
        let mut here = part.state("none", closing);
        part.entry(None, here, enters);
        for n in 1..=count {
            let next = part.state(&n.to_string(), closing);
            part.edges(here, next, &on, allowed);
            here = next;
        }
        part.edges(here, here, &on, one_more);
        part
    }

    fn at_least(&mut self, listed: &[TypedOccurrence], count: u32, exactly: bool) -> PatternPart {
        let on = self.causes(listed);
        let mut part = PatternPart::default();
        let mut here = part.pending("none", None, &[Fail]);
        part.entry(None, here, &[Trigger]);
        for n in 1..count {
            let next = part.pending(&n.to_string(), None, &[Fail]);
            part.edges(here, next, &on, &[]);
            here = next;
        }
        let enough = part.state(&count.to_string(), &[]);
        part.edges(here, enough, &on, &[Discharge]);
        if exactly {
            let over = part.state("more", &[]);
            part.edges(enough, over, &on, &[Fail]);
            part.edges(over, over, &on, &[Fail]);
        }
        part
    }

    /// What holds from the beginning has become true nobody knows when.
    fn lasts_at_least(&mut self, condition: &model::TypedExpr, time: f64) -> PatternPart {
        let (condition, holds) = self.condition(condition);
        let becomes = |truth, first| [MonitorTrigger::Becomes { condition, truth, first }];
        let mut part = PatternPart::default();
        let off = part.state("off", &[]);
        let on = part.pending("on", Some(nanos(time)), &[]);
        let held = part.state("held", &[]);
        part.edges(off, on, &becomes(true, false), &[Trigger, ResetClock]);
        part.edges(off, held, &becomes(true, true), &[]);
        let early = Some(MonitorClockGuard::Before(nanos(time)));
        part.timed(on, off, &becomes(false, false), early, &[Fail]);
        part.edges(on, off, &becomes(false, false), &[Discharge]);
        part.edges(on, held, &[MonitorTrigger::Deadline], &[Discharge]);
        part.edges(held, off, &becomes(false, false), &[]);
        part.entry(Some(holds), held, &[]);
        part.entry(None, off, &[]);
        part
    }

    /// What holds from the beginning has held since then.
    fn lasts_at_most(&mut self, condition: &model::TypedExpr, time: f64) -> PatternPart {
        let (condition, holds) = self.condition(condition);
        let becomes = |truth| [MonitorTrigger::Becomes { condition, truth, first: true }];
        let mut part = PatternPart::default();
        let off = part.state("off", &[]);
        let on = part.pending("on", Some(nanos(time)), &[Discharge]);
        let over = part.state("over", &[]);
        part.edges(off, on, &becomes(true), &[Trigger, ResetClock]);
        part.edges(on, off, &becomes(false), &[Discharge]);
        part.edges(on, over, &[MonitorTrigger::Deadline], &[Fail]);
        part.edges(over, off, &becomes(false), &[]);
        part.entry(Some(holds), on, &[Trigger, ResetClock]);
        part.entry(None, off, &[]);
        part
    }
}

fn not(e: Expr) -> Expr {
    Expr::Unary(UnaryOp::Not, Box::new(e))
}
