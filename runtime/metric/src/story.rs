//! The story of a goal over a whole run: when it was asked, how that ended, and all the spans of time in which it is violated.

use hrdsl_ir::{
    Nanos,
    formula::{MetricFormula, MetricGoal},
};

use crate::{
    engine::piece::SignalPiece,
    evaluator::{RobustnessOverTime, robustness_over_time},
    run::AtomsOverTime,
};

/// From a moment up to, and not including, another one; what goes on at the end is over one nanosecond after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormulaSpan {
    pub from: Nanos,
    pub until: Nanos,
}

/// A while in which the premise of `always (P implies Q)` held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AskedSpan {
    pub span: FormulaSpan,
    /// By when what is asked of its first moment is known at the latest; `None`: at once.
    pub due: Option<Nanos>,
    /// Whether the conclusion held all the while; `None`: the run ended before that was known.
    pub kept: Option<bool>,
    /// When that became known.
    pub known: Nanos,
}

/// What became of a goal, moment by moment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FormulaStory {
    /// In order.
    pub asked: Vec<AskedSpan>,
    /// In order; what no continuation would mend.
    pub violated: Vec<FormulaSpan>,
}

impl FormulaStory {
    /// Of the atoms of a goal over a run.
    #[must_use]
    pub fn of(goal: &MetricGoal, atoms: &AtomsOverTime) -> Self {
        let both = |a: &MetricGoal, b: &MetricGoal| (Self::of(a, atoms), Self::of(b, atoms));
        let mut story = match goal {
            MetricGoal::And(a, b) => {
                let (mut a, b) = both(a, b);
                a.asked.extend(b.asked);
                a.violated.extend(b.violated);
                a
            }
            MetricGoal::Or(a, b) => {
                let (mut a, b) = both(a, b);
                // It is violated once the last of the alternatives is.
                let last = a.violated.first().zip(b.violated.first()).map(|(a, b)| a.from.max(b.from));
                a.asked.extend(b.asked);
                a.violated = last.map(|from| FormulaSpan { from, until: after(atoms) }).into_iter().collect();
                a
            }
            MetricGoal::Now(formula) => {
                let at_start = FormulaSpan { from: atoms.start, until: atoms.start.saturating_add(1) };
                let known = KnownFormula::new(formula, atoms);
                let fails = known.truth(atoms.start) == Some(false);
                Self { violated: fails.then_some(at_start).into_iter().collect(), ..Self::default() }
            }
            MetricGoal::Eventually(_) => Self::default(),
            MetricGoal::Always(formula) => Self::of_always(formula, atoms),
            MetricGoal::Until(first, then) => Self::of_until(first, then, false, atoms),
            MetricGoal::Release(then, first) => Self::of_until(first, then, true, atoms),
        };
        story.asked.sort_by_key(|asked| asked.span.from);
        story.violated.sort_by_key(|span| span.from);
        story
    }

    fn of_always(formula: &MetricFormula, atoms: &AtomsOverTime) -> Self {
        let whole = robustness_over_time(formula, &atoms.atoms, (atoms.start, atoms.end));
        let violated = spans(&whole.upper, false, after(atoms));
        let MetricFormula::Implies(premise, conclusion) = formula else {
            return Self { asked: Vec::new(), violated };
        };
        let later = premise.horizon();
        let premise = robustness_over_time(premise, &atoms.atoms, (atoms.start, atoms.end));
        let conclusion = KnownFormula::new(conclusion, atoms);
        let asked = spans(&premise.lower, true, after(atoms));
        Self { asked: asked.into_iter().map(|span| conclusion.asked(span, later)).collect(), violated }
    }

    /// `first` has to hold before a moment at which `then` does; `with`: at that moment, too.
    fn of_until(first: &MetricFormula, then: &MetricFormula, with: bool, atoms: &AtomsOverTime) -> Self {
        let (first, then) = (KnownFormula::new(first, atoms), KnownFormula::new(then, atoms));
        let mut moments: Vec<Nanos> = [&first, &then]
            .into_iter()
            .flat_map(|of| of.over_time.upper.iter().map(|piece| piece.start))
            .collect();
        moments.sort_unstable();
        for from in moments {
            let is_met = then.may_hold(from);
            let is_kept = first.may_hold(from);
            if (with || !is_met) && !is_kept {
                let until = after(atoms);
                return Self { asked: Vec::new(), violated: vec![FormulaSpan { from, until }] };
            }
            if is_met {
                break;
            }
        }
        Self::default()
    }
}

fn after(atoms: &AtomsOverTime) -> Nanos {
    atoms.end.saturating_add(1)
}

/// The spans in which a signal holds, or does not.
fn spans(pieces: &[SignalPiece], truth: bool, after: Nanos) -> Vec<FormulaSpan> {
    let mut found: Vec<FormulaSpan> = Vec::new();
    for (at, piece) in pieces.iter().enumerate() {
        if piece.value.holds() != truth {
            continue;
        }
        let until = pieces.get(at + 1).map_or(after, |next| next.start);
        match found.last_mut() {
            Some(last) if last.until == piece.start => last.until = until,
            Some(_) | None => found.push(FormulaSpan { from: piece.start, until }),
        }
    }
    found
}

/// A formula over the whole run, with what it is made of.
struct KnownFormula<'f> {
    formula: &'f MetricFormula,
    over_time: RobustnessOverTime,
    of: Vec<KnownFormula<'f>>,
    after: Nanos,
}

impl<'f> KnownFormula<'f> {
    fn new(formula: &'f MetricFormula, atoms: &AtomsOverTime) -> Self {
        // Of what looks back only, the present is enough.
        let of = if formula.horizon() == 0 { Vec::new() } else { formula.operands() };
        Self {
            formula,
            over_time: robustness_over_time(formula, &atoms.atoms, (atoms.start, atoms.end)),
            of: of.into_iter().map(|operand| Self::new(operand, atoms)).collect(),
            after: after(atoms),
        }
    }

    /// Whether it holds at a moment; `None`: that is not known when the run ends.
    fn truth(&self, at: Nanos) -> Option<bool> {
        if at >= self.after {
            return None;
        }
        let holds = |pieces: &[SignalPiece]| {
            let later = pieces.partition_point(|piece| piece.start <= at);
            later.checked_sub(1).and_then(|place| pieces.get(place)).map(|piece| piece.value.holds())
        };
        match (holds(&self.over_time.lower), holds(&self.over_time.upper)) {
            (Some(true), _) => Some(true),
            (_, Some(false)) => Some(false),
            _ => None,
        }
    }

    fn may_hold(&self, at: Nanos) -> bool {
        self.truth(at) != Some(false)
    }

    /// The first moment from one to another, both included, at which it has this truth for certain.
    fn first(&self, from: Nanos, to: Nanos, truth: bool) -> Option<Nanos> {
        let pieces = if truth { &self.over_time.lower } else { &self.over_time.upper };
        let later = pieces.partition_point(|piece| piece.start <= from);
        let mut at = later.saturating_sub(1);
        while let Some(piece) = pieces.get(at).filter(|piece| piece.start <= to && piece.start < self.after) {
            if piece.value.holds() == truth {
                return Some(piece.start.max(from)).filter(|found| *found < self.after);
            }
            at += 1;
        }
        None
    }

    /// When its truth at a moment became known.
    fn known(&self, at: Nanos) -> Nanos {
        let horizon = self.formula.horizon();
        let latest = at.saturating_add(horizon);
        let Some(truth) = self.truth(at).filter(|_| horizon > 0) else { return latest.min(self.after) };
        let earliest = match (self.formula, &self.of[..]) {
            (MetricFormula::Not(_), [of]) => Some(of.known(at)),
            (MetricFormula::And(..), [a, b]) => Some(both_known((a, truth), (b, truth), !truth, at)),
            (MetricFormula::Or(..), [a, b]) => Some(both_known((a, truth), (b, truth), truth, at)),
            (MetricFormula::Implies(..), [a, b]) => Some(both_known((a, !truth), (b, truth), truth, at)),
            (MetricFormula::Eventually(window, _), [of]) if truth => of
                .first(at.saturating_add(window.from), at.saturating_add(window.to), true)
                .map(|s| of.known(s)),
            (MetricFormula::Always(window, _), [of]) if !truth => {
                let (from, to) = (at.saturating_add(window.from), at.saturating_add(window.to));
                of.first(from, to, false).map(|s| of.known(s))
            }
            (MetricFormula::Until(window, _, then), [_, of]) if truth && then.horizon() == 0 => {
                of.first(at.saturating_add(window.from), at.saturating_add(window.to), true)
            }
            (MetricFormula::Until(_, first, _), [of, _]) if first.horizon() == 0 => {
                of.first(at, latest, false)
            }
            _ => None,
        };
        earliest.map_or(latest, |earliest| earliest.min(latest)).min(self.after)
    }

    /// What became of it over a while in which it was asked, which is known of each moment so much later.
    fn asked(&self, span: FormulaSpan, later: Nanos) -> AskedSpan {
        let horizon = self.formula.horizon();
        let due = (horizon > 0).then(|| span.from.saturating_add(horizon.max(later)));
        let known = |at: Nanos| self.known(at).max(at.saturating_add(later)).min(self.after);
        let last = span.until.saturating_sub(1).max(span.from);
        if let Some(broken) = self.first(span.from, last, false) {
            return AskedSpan { span, due, kept: Some(false), known: known(broken) };
        }
        let mut at = span.from;
        while at <= last {
            if self.truth(at) != Some(true) {
                return AskedSpan { span, due, kept: None, known: self.after };
            }
            let next = self.over_time.lower.iter().map(|piece| piece.start).find(|start| *start > at);
            at = next.unwrap_or(Nanos::MAX);
        }
        // What is asked of the present only is asked until the while is over.
        let known = if horizon > 0 { known(last) } else { known(last).max(span.until) };
        AskedSpan { span, due, kept: Some(true), known }
    }
}

/// Of two operands: either of them that is as it has to be is `enough`, or both are needed.
fn both_known(
    (a, a_truth): (&KnownFormula<'_>, bool),
    (b, b_truth): (&KnownFormula<'_>, bool),
    enough: bool,
    at: Nanos,
) -> Nanos {
    let (first, second) = (a.known(at), b.known(at));
    if !enough {
        return first.max(second);
    }
    match (a.truth(at) == Some(a_truth), b.truth(at) == Some(b_truth)) {
        (true, false) => first,
        (false, true) => second,
        (true, true) | (false, false) => first.min(second),
    }
}
