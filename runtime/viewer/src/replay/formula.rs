//! Requirements that are formulas: what each asks for, and all that became of it.

use hrdsl_ir::{
    Expr, Nanos, Value,
    event::EventPattern,
    formula::{FormulaAtomKind, MetricFormula, MetricGoal},
    monitor::Monitor,
    value::seconds,
    world::SignalId,
};
use hrdsl_metric::{
    AskedSpan, AtomsOverTime, CheckedFormula, FormulaSpan, FormulaStory, MetricRunner, SignalPiece,
    robustness_over_time,
};
use hrdsl_trace::TraceStepKind;

use super::{
    asked::KeptCondition,
    run::{ReplayedRun, tick},
    tracks::truth_track,
    violation::{ToldRequirement, signal_text},
};
use crate::{
    document::SignalTrack,
    requirement::{ObligationOutcome, ViewObligation, ViewViolation},
};

/// A formula's atoms over a run.
pub(super) struct TapedFormula {
    checked: CheckedFormula,
    atoms: AtomsOverTime,
}

impl TapedFormula {
    /// `None`: the requirement is none, or one of its signals never had a value.
    pub fn new(run: &ReplayedRun<'_>, monitor: &Monitor) -> Option<Self> {
        let checked = CheckedFormula::of_monitor(monitor)?;
        let mut runner = MetricRunner::new(&checked).taping();
        run.trace.replay(&mut runner);
        Some(Self { atoms: runner.tape()?, checked })
    }

    /// When a part of it holds, and when it does not; neither where the run ends too early to know.
    pub fn truth(&self, name: &str, formula: &MetricFormula) -> SignalTrack {
        let (start, end) = (self.atoms.start, self.atoms.end);
        let over_time = robustness_over_time(formula, &self.atoms.atoms, (start, end));
        let mut times: Vec<Nanos> =
            over_time.lower.iter().chain(&over_time.upper).map(|piece| piece.start).collect();
        times.sort_unstable();
        times.dedup();
        let holds = |pieces: &[SignalPiece], at: Nanos| {
            let later = pieces.partition_point(|piece| piece.start <= at);
            later.checked_sub(1).and_then(|place| pieces.get(place)).is_some_and(|piece| piece.value.holds())
        };
        let truth = |at: Nanos| match (holds(&over_time.lower, at), holds(&over_time.upper, at)) {
            (true, _) => Some(true),
            (_, false) => Some(false),
            (false, true) => None,
        };
        let known = times.into_iter().map(|at| (at, truth(at)));
        truth_track(name, known)
    }

    /// When it was asked, and all its violations.
    pub fn told(&self, run: &ReplayedRun<'_>) -> (Vec<Nanos>, ToldRequirement) {
        let story = FormulaStory::of(&self.checked.goal, &self.atoms);
        let triggers: Vec<Nanos> = story.asked.iter().map(|asked| asked.span.from).collect();
        let obligation = |asked: &AskedSpan| {
            let outcome = match asked.kept {
                Some(true) => ObligationOutcome::Met,
                Some(false) => ObligationOutcome::Violated,
                None => ObligationOutcome::Pending,
            };
            ViewObligation {
                from: tick(asked.span.from),
                until: asked.kept.map(|_| tick(asked.known.min(run.trace.end))),
                deadline: asked.due.map(tick),
                outcome,
                trigger: self.premise(),
            }
        };
        let obligations: Vec<ViewObligation> = story.asked.iter().map(obligation).collect();
        let moments: Vec<Nanos> = story.violated.iter().map(|span| span.from).collect();
        let read = read_at(run, &self.checked, &moments);
        let violation = |(span, (values, step)): (&FormulaSpan, ReadValues)| {
            let (from, until) = (tick(span.from), tick(span.until.min(run.trace.end)));
            let values: Vec<String> =
                values.iter().map(|(signal, value)| signal_text(run, *signal, *value)).collect();
            let read = if values.is_empty() { String::new() } else { format!(": {}", values.join(", ")) };
            let is_in = |asked: &&AskedSpan| asked.span.from <= span.from && span.from < asked.span.until;
            let asked = story.asked.iter().find(is_in);
            ViewViolation {
                t: from,
                text: format!("{}{read}.", lasts(span, asked, run.trace.end)),
                since: asked.map(|asked| tick(asked.span.from)),
                until: (until > from).then_some(until),
                steps: step.into_iter().map(|step| step as u64).collect(),
            }
        };
        let violations = story.violated.iter().zip(read).map(violation).collect();
        (triggers, ToldRequirement { obligations, violations })
    }

    /// A part of it, as the scenario has it.
    pub fn text(&self, formula: &MetricFormula) -> String {
        formula.text(&|at| self.checked.atom_text(at).to_owned())
    }

    /// What is asked of is this.
    fn premise(&self) -> Option<String> {
        let MetricGoal::Always(MetricFormula::Implies(premise, _)) = &self.checked.goal else { return None };
        Some(self.text(premise))
    }
}

/// For how long it does not hold, and since when that is certain, if a window looks ahead.
fn lasts(span: &FormulaSpan, asked: Option<&AskedSpan>, end: Nanos) -> String {
    let until = span.until.min(end);
    let lasts = if tick(until) > tick(span.from) {
        format!("It does not hold from {} s to {} s", seconds(span.from), seconds(until))
    } else {
        format!("It does not hold at {} s", seconds(span.from))
    };
    match asked.map(|asked| asked.known.min(end)).filter(|known| tick(*known) > tick(span.from)) {
        Some(known) => format!("{lasts}, which is certain at {} s", seconds(known)),
        None => lasts,
    }
}

/// The values of signals, and the last step at that very moment.
type ReadValues = (Vec<(SignalId, Value)>, Option<usize>);

/// What a formula read at these moments, which are in order.
fn read_at(run: &ReplayedRun<'_>, formula: &CheckedFormula, moments: &[Nanos]) -> Vec<ReadValues> {
    let mut latest: Vec<Option<Value>> = vec![None; formula.signals().len()];
    let mut steps = run.trace.steps.iter().enumerate().peekable();
    let mut read = Vec::new();
    for moment in moments {
        let mut at_it = None;
        while let Some((index, step)) = steps.next_if(|(_, step)| step.time <= *moment) {
            match &step.what {
                TraceStepKind::Sample { signal, value } => {
                    for (of, known) in formula.signals().iter().zip(&mut latest) {
                        if of == signal {
                            *known = Some(*value);
                            at_it = Some(index).filter(|_| step.time == *moment).or(at_it);
                        }
                    }
                }
                TraceStepKind::Event { event, .. }
                    if step.time == *moment && formula.events().any(|pattern| pattern.event == *event) =>
                {
                    at_it = Some(index);
                }
                TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => {}
            }
        }
        let values = formula.signals().iter().zip(&latest).filter_map(|(id, value)| Some((*id, (*value)?)));
        read.push((values.collect(), at_it));
    }
    read
}

/// The events that a formula names.
pub(super) fn events(monitor: &Monitor) -> impl Iterator<Item = &EventPattern> {
    let atoms = monitor.formula.iter().flat_map(|formula| &formula.atoms);
    atoms.filter_map(|atom| match &atom.what {
        FormulaAtomKind::Happens(pattern) => Some(pattern),
        FormulaAtomKind::Less { .. } | FormulaAtomKind::Equal { .. } | FormulaAtomKind::Holds(_) => None,
    })
}

/// What a formula asks for.
pub(super) fn asked(monitor: &Monitor) -> Option<KeptCondition> {
    monitor.formula.as_ref().map(|formula| of_goal(monitor, &formula.goal))
}

fn of_goal(monitor: &Monitor, goal: &MetricGoal) -> KeptCondition {
    let of = |formula: &MetricFormula| of_formula(monitor, formula, true);
    let window = |text: &str, of: Vec<KeptCondition>| KeptCondition::Window {
        text: text.to_owned(),
        truth: true,
        formula: None,
        of,
    };
    match goal {
        MetricGoal::And(a, b) => KeptCondition::joined(true, [of_goal(monitor, a), of_goal(monitor, b)]),
        MetricGoal::Or(a, b) => KeptCondition::joined(false, [of_goal(monitor, a), of_goal(monitor, b)]),
        MetricGoal::Always(formula) => of(formula),
        MetricGoal::Now(formula) => window("at the first moment", vec![of(formula)]),
        MetricGoal::Eventually(formula) => window("eventually", vec![of(formula)]),
        MetricGoal::Until(a, b) => window("until", vec![of(a), of(b)]),
        MetricGoal::Release(a, b) => window("up to and including", vec![of(b), of(a)]),
    }
}

fn of_formula(monitor: &Monitor, formula: &MetricFormula, truth: bool) -> KeptCondition {
    let of = |formula: &MetricFormula, truth| of_formula(monitor, formula, truth);
    let window = |text: String, truth: bool, operands: Vec<KeptCondition>| KeptCondition::Window {
        text,
        truth,
        formula: Some(Box::new(formula.clone())),
        of: operands,
    };
    match formula {
        MetricFormula::Constant(is) => KeptCondition::Truth(Expr::bool(*is), truth),
        MetricFormula::Atom(at) => of_atom(monitor, *at, truth),
        MetricFormula::Not(a) => of(a, !truth),
        MetricFormula::And(a, b) => match edge(a, b) {
            Some(word) => window(word.to_owned(), truth, vec![of(a, true)]),
            None => KeptCondition::joined(truth, [of(a, truth), of(b, truth)]),
        },
        MetricFormula::Or(a, b) => KeptCondition::joined(!truth, [of(a, truth), of(b, truth)]),
        MetricFormula::Implies(a, b) => KeptCondition::joined(!truth, [of(a, !truth), of(b, truth)]),
        MetricFormula::Once(w, a) => window(format!("once{}", w.text()), truth, vec![of(a, true)]),
        MetricFormula::Historically(w, a) => {
            window(format!("historically{}", w.text()), truth, vec![of(a, true)])
        }
        MetricFormula::Eventually(w, a) => {
            window(format!("eventually{}", w.text()), truth, vec![of(a, true)])
        }
        MetricFormula::Always(w, a) => window(format!("always{}", w.text()), truth, vec![of(a, true)]),
        MetricFormula::Since(w, a, b) => {
            window(format!("since{}", w.text()), truth, vec![of(a, true), of(b, true)])
        }
        MetricFormula::Until(w, a, b) => {
            window(format!("until{}", w.text()), truth, vec![of(a, true), of(b, true)])
        }
    }
}

/// `P and once[1 ns, 1 ns] not P`, which the scenario has as `rising(P)`.
fn edge(a: &MetricFormula, b: &MetricFormula) -> Option<&'static str> {
    let MetricFormula::Once(window, before) = b else { return None };
    let MetricFormula::Not(was) = &**before else { return None };
    (window.bounds() == (1, Some(1)) && **was == *a).then_some("rising")
}

fn of_atom(monitor: &Monitor, at: usize, truth: bool) -> KeptCondition {
    let atom = monitor.formula.as_ref().and_then(|formula| formula.atoms.get(at));
    let Some(atom) = atom else { return KeptCondition::Happens("?".to_owned(), truth) };
    match &atom.what {
        FormulaAtomKind::Happens(_) => KeptCondition::Happens(atom.text.clone(), truth),
        FormulaAtomKind::Less { least, most, strict } => KeptCondition::less(least, most, *strict, truth),
        FormulaAtomKind::Equal { .. } => KeptCondition::Happens(atom.text.clone(), truth),
        FormulaAtomKind::Holds(condition) => KeptCondition::of(condition, truth),
    }
}
