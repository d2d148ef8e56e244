//! What a requirement says: its pattern and its scope, with names resolved and bounds that can be kept.

use hrdsl_syntax::{
    CountBound, RequirementPattern, SentenceMapping, TemporalFormula, TemporalKind,
    ast::{BinaryOp, CallSyntax, ExprSyntax, ExprSyntaxKind, ParsedPattern},
};

use super::phase::TestingPhase;
use crate::check::{state::template::TemplateArgument, template::CheckerPhase, world::edge::RISING};
use crate::{
    TypedOccurrence, TypedPattern,
    noun::Noun,
    report::{requirements, types},
};

/// A monitor has a state for each of so many.
const MOST: i64 = 1000;

impl TestingPhase<'_, '_> {
    pub(super) fn sentence(&mut self, parsed: &ParsedPattern) -> TypedPattern {
        let parsed = self.with_events(parsed);
        let to = SentenceMapping {
            events: |c: &mut Self, events: &[CallSyntax]| c.occurrences(events),
            condition: Self::condition,
            time: |c: &mut Self, e: &ExprSyntax| c.time(e, "the time", true),
            bound: |c: &mut Self, e: &ExprSyntax| c.time(e, "the bound of a window", false),
            count: |c: &mut Self, e: &ExprSyntax, bound| c.times_of(e, bound),
        };
        let sentence = parsed.map(self, &to);
        self.can_be_kept(&parsed, &sentence);
        if let (RequirementPattern::Formula(written), RequirementPattern::Formula(formula)) =
            (&parsed.pattern, &sentence.pattern)
        {
            self.can_be_decided(written, true);
            self.has_windows(formula);
        }
        sentence
    }

    /// `eventually E` is read as a condition; here it becomes known that E are events.
    fn with_events(&self, parsed: &ParsedPattern) -> ParsedPattern {
        let mut parsed = parsed.clone();
        if let RequirementPattern::Eventually { events, condition, .. } = &mut parsed.pattern
            && let Some(calls) = condition.as_ref().and_then(|e| self.as_events(e))
        {
            (*events, *condition) = (calls, None);
        }
        if let RequirementPattern::Formula(formula) = &mut parsed.pattern {
            self.name_events(formula);
        }
        parsed
    }

    /// The atoms of a formula that are events.
    fn name_events(&self, formula: &mut TemporalFormula<CallSyntax, ExprSyntax, ExprSyntax>) {
        match &mut formula.kind {
            TemporalKind::Condition(e) => {
                if let Some(calls) = self.as_events(e) {
                    formula.kind = TemporalKind::Events(calls);
                }
            }
            TemporalKind::Not(of) | TemporalKind::Look { of, .. } => self.name_events(of),
            TemporalKind::Junction(_, of) | TemporalKind::Reach { of, .. } => {
                of.iter_mut().for_each(|part| self.name_events(part));
            }
            TemporalKind::Constant(_) | TemporalKind::Events(_) => {}
        }
    }

    /// The events that an expression names, if it is nothing but events joined by `or`.
    fn as_events(&self, e: &ExprSyntax) -> Option<Vec<CallSyntax>> {
        if let ExprSyntaxKind::Binary { op: BinaryOp::Or, left, right } = &e.kind {
            let mut events = self.as_events(left)?;
            events.extend(self.as_events(right)?);
            return Some(events);
        }
        let (callee, args) = if let ExprSyntaxKind::Call { callee, args } = &e.kind {
            (callee, Some(args.clone()))
        } else if let ExprSyntaxKind::Path(path) = &e.kind {
            (path, None)
        } else {
            return None;
        };
        let [name] = callee.names.as_slice() else { return None };
        let call = CallSyntax { name: name.clone(), args, span: e.span };
        let given =
            matches!(self.given(&name.text), Some(TemplateArgument::Events(_) | TemplateArgument::Unknown));
        let is_event = given
            || self.events.table.get(&name.text).is_some()
            || self.is_edge(&call)
            || self.is_misspelt_edge(&call);
        is_event.then(|| vec![call])
    }

    fn occurrences(&mut self, calls: &[CallSyntax]) -> Vec<TypedOccurrence> {
        let mut all = Vec::new();
        for call in calls {
            if self.is_edge(call) {
                all.extend(self.edge(call));
            } else if !self.says_misspelt_edge(call) {
                let patterns = self.patterns(std::slice::from_ref(call));
                all.extend(patterns.into_iter().map(TypedOccurrence::Event));
            }
        }
        all
    }

    /// `rising(P)`
    fn edge(&mut self, call: &CallSyntax) -> Option<TypedOccurrence> {
        let args = call.args.as_deref().unwrap_or_default();
        let [condition] = args else {
            let name = &call.name.text;
            let issue = types::counts(Noun::Function, name, 1, args.len(), call.span);
            self.report(issue.help(format!(
                "write `{name}(CONDITION)`; where it has to hold for some time, let a rule make an event: \
                 `on {name}(CONDITION, TIME) emit …`"
            )));
            return None;
        };
        let condition = self.condition(condition);
        Some(TypedOccurrence::Edge { rising: call.name.text == RISING, condition })
    }

    /// How often something has to happen. What may not happen at all is `never`, and may be `at most 0`, too.
    fn times_of(&mut self, e: &ExprSyntax, bound: CountBound) -> Option<u32> {
        let least = match bound {
            CountBound::AtMost => 0,
            CountBound::AtLeast | CountBound::Exactly => 1,
        };
        let n = self.count(e, "the number", least)?;
        if n > MOST {
            self.report(types::must_be("the number", &format!("at most {MOST}"), e.span));
        }
        u32::try_from(n).ok().filter(|_| n <= MOST)
    }

    /// Bounds that leave no time, and those that one clock cannot keep.
    fn can_be_kept(&mut self, parsed: &ParsedPattern, sentence: &TypedPattern) {
        let (RequirementPattern::Causes { not_before: Some(early), within: Some(late), .. }
        | RequirementPattern::Precedes { not_before: Some(early), within: Some(late), .. }) = &parsed.pattern
        else {
            return;
        };
        let span = early.span.to(late.span);
        if matches!(parsed.pattern, RequirementPattern::Precedes { .. }) {
            self.report(requirements::two_clocks(span));
            return;
        }
        let times: Vec<f64> = sentence.times().copied().collect();
        if let [early, late] = times.as_slice()
            && early > late
        {
            self.report(requirements::no_time(*early, *late, span));
        }
    }
}
