//! What a violated requirement consists of, around its first violation: the value of each part over time.

use std::io::BufRead;

use hrdsl_ir::{
    EventPattern, Expr, Nanos, Program, Unit, Value,
    expr::{BinaryOp, UnaryOp, sign},
    monitor::{Monitor, MonitorTrigger},
    value::{nanos, seconds},
    world::SignalId,
};
use hrdsl_metric::{CheckedFormula, MetricRunner};
use hrdsl_results::{FirstFailure, SubformulaReading, SubformulaValue, SubformulaValues, TraceJudgement};
use hrdsl_trace::{TraceObserver, TraceStep, TraceStepKind, print};

use crate::{JudgeError, NamedFormula, formula_parts::formulas_over_time, recording::observe};

/// Reads a recording once more, and puts the values of the parts of each violated requirement and formula into its first violation, from so
/// long before it to so long after it. The judgement is that on the recording, with the formulas' verdicts behind the requirements'.
///
/// # Errors
/// A recording that cannot be read any more.
pub fn tell_values_around(
    (program, formulas): (&Program, &[NamedFormula]),
    source: impl BufRead,
    changed: bool,
    judgement: &mut TraceJudgement,
    around: Nanos,
) -> Result<(), JudgeError> {
    let mut watches = Vec::new();
    for (place, verdict) in judgement.verdicts.iter().enumerate() {
        let Some(failure) = &verdict.failure else { continue };
        let monitor = program.monitors.get(place);
        let formula = match monitor {
            Some(monitor) => CheckedFormula::of_monitor(monitor),
            None => formulas.get(place - program.monitors.len()).map(|named| named.formula.clone()),
        };
        let parts = match (&formula, monitor) {
            (Some(formula), _) => named(program, formula),
            (None, Some(monitor)) => parts_of(program, monitor),
            (None, None) => Vec::new(),
        };
        let at = nanos(failure.time);
        let window = (at.saturating_sub(around).max(0), at.saturating_add(around));
        let formula = formula.map(|formula| (MetricRunner::new(&formula).taping(), formula));
        let parts = PartsWatch::new(program, parts, window);
        watches.push(FailureWatch { place, parts, formula });
    }
    if watches.is_empty() {
        return Ok(());
    }
    let mut watches = WatchedFailures(watches);
    observe(program, source, changed, &mut watches)?;
    for watch in watches.0 {
        let failure = judgement.verdicts.get_mut(watch.place).and_then(|verdict| verdict.failure.as_mut());
        if let Some(FirstFailure { around, .. }) = failure {
            *around = watch.told();
        }
    }
    Ok(())
}

/// What is watched of a requirement.
#[derive(Clone, Debug)]
struct RequirementPart {
    text: String,
    unit: Unit,
    what: WatchedPart,
}

#[derive(Clone, Debug)]
enum WatchedPart {
    /// `Expr::Var(i)` is the signal `i` of the program.
    Value(Expr),
    Event(EventPattern),
}

/// The parts of a requirement: its events, then signals, numbers and conditions, each after what it is made of.
fn parts_of(program: &Program, monitor: &Monitor) -> Vec<RequirementPart> {
    let mut events: Vec<&EventPattern> = Vec::new();
    let on_edges = monitor.edges.iter().filter_map(|edge| match &edge.on {
        MonitorTrigger::Event(patterns) => Some(patterns),
        MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => None,
    });
    for pattern in on_edges.flatten() {
        if !events.contains(&pattern) {
            events.push(pattern);
        }
    }
    let mut values = Vec::new();
    let guards = monitor.edges.iter().filter_map(|edge| edge.guard.as_ref());
    let margin = monitor.margin.as_ref().map(|margin| &margin.value);
    for expr in monitor.conditions.iter().chain(guards).chain(margin) {
        collect(&of_program(expr, &monitor.signals), &mut values);
    }
    let texts = PartPrinter { program };
    let event = |pattern: &EventPattern| RequirementPart {
        text: program.pattern_text(pattern),
        unit: Unit::None,
        what: WatchedPart::Event(pattern.clone()),
    };
    let value = |expr: Expr| RequirementPart {
        text: texts.expr(&expr),
        unit: texts.unit(&expr).unwrap_or(Unit::None),
        what: WatchedPart::Value(expr),
    };
    events.into_iter().map(event).chain(values.into_iter().map(value)).collect()
}

/// The events and signals that a formula names.
fn named(program: &Program, formula: &CheckedFormula) -> Vec<RequirementPart> {
    let events = formula.events().map(|pattern| RequirementPart {
        text: program.pattern_text(pattern),
        unit: Unit::None,
        what: WatchedPart::Event(pattern.clone()),
    });
    let signals = formula.signals().iter().map(|signal| RequirementPart {
        text: program.signal(*signal).name.clone(),
        unit: print::unit_of(program.signal(*signal).ty),
        what: WatchedPart::Value(Expr::Var(signal.0)),
    });
    events.chain(signals).collect()
}

/// An expression of a monitor, with the signals of the program for the monitor's own.
fn of_program(expr: &Expr, signals: &[SignalId]) -> Expr {
    let all = |items: &[Expr]| items.iter().map(|item| of_program(item, signals)).collect();
    let boxed = |item: &Expr| Box::new(of_program(item, signals));
    match expr {
        Expr::Var(place) => Expr::Var(signals.get(usize::from(*place)).map_or(u16::MAX, |s| s.0)),
        Expr::Unary(op, a) => Expr::Unary(*op, boxed(a)),
        Expr::Binary(op, a, b) => Expr::Binary(*op, boxed(a), boxed(b)),
        Expr::If(c, a, b) => Expr::If(boxed(c), boxed(a), boxed(b)),
        Expr::Call(f, items) => Expr::Call(*f, all(items)),
        // Requirements have none of the others, which automata have, but for lists without signals.
        Expr::Const(_) | Expr::List(..) | Expr::Element(_) | Expr::Apply(..) => expr.clone(),
    }
}

/// The parts of an expression, each once, after what it is made of. Numbers without a name, and what is only the opposite of another part,
/// are none.
fn collect(expr: &Expr, parts: &mut Vec<Expr>) {
    match expr {
        Expr::Const(_) => return,
        Expr::Unary(UnaryOp::Not, a) => return collect(a, parts),
        Expr::Unary(UnaryOp::Neg, a) => collect(a, parts),
        Expr::Binary(_, a, b) => {
            collect(a, parts);
            collect(b, parts);
        }
        Expr::If(c, a, b) => [c, a, b].into_iter().for_each(|part| collect(part, parts)),
        Expr::Call(_, items) => items.iter().for_each(|item| collect(item, parts)),
        Expr::Var(_) | Expr::List(..) | Expr::Element(_) | Expr::Apply(..) => {}
    }
    if !parts.contains(expr) {
        parts.push(expr.clone());
    }
}

/// Writes parts of requirements as the language does.
struct PartPrinter<'p> {
    program: &'p Program,
}

impl PartPrinter<'_> {
    fn expr(&self, expr: &Expr) -> String {
        self.within(expr, 0, Unit::None)
    }

    /// `around` is how tightly what is around it binds; `unit` is that of a number without one.
    fn within(&self, expr: &Expr, around: u8, unit: Unit) -> String {
        let list = |items: &[Expr]| {
            let unit = items.iter().find_map(|item| self.unit(item)).unwrap_or(unit);
            items.iter().map(|item| self.within(item, 0, unit)).collect::<Vec<_>>().join(", ")
        };
        let (text, level) = match expr {
            Expr::Const(value) => (print::value(*value, unit), 9),
            Expr::Var(_) => (self.signal(expr).map_or_else(|| "?".to_owned(), |s| s.name.clone()), 9),
            Expr::Unary(UnaryOp::Not, a) => (format!("not {}", self.within(a, 3, unit)), 3),
            Expr::Unary(UnaryOp::Neg, a) => (format!("-{}", self.within(a, 7, unit)), 6),
            Expr::Binary(op, a, b) => {
                let (written, level) = match sign(*op) {
                    ("&&", level) => ("and", level),
                    ("||", level) => ("or", level),
                    other => other,
                };
                let unit =
                    if level == 6 { Unit::None } else { self.unit(a).or(self.unit(b)).unwrap_or(unit) };
                let left = if level == 4 { 5 } else { level };
                (
                    format!("{} {written} {}", self.within(a, left, unit), self.within(b, level + 1, unit)),
                    level,
                )
            }
            Expr::If(c, a, b) => {
                let [c, a, b] = [c, a, b].map(|part| self.within(part, 0, unit));
                (format!("if {c} {{ {a} }} else {{ {b} }}"), 9)
            }
            Expr::Call(f, items) => (format!("{}({})", f.name(), list(items)), 9),
            Expr::List(items, _) => (format!("[{}]", list(items)), 9),
            // Only automata have these.
            Expr::Element(_) | Expr::Apply(..) => ("?".to_owned(), 9),
        };
        if level < around { format!("({text})") } else { text }
    }

    fn signal(&self, expr: &Expr) -> Option<&hrdsl_ir::world::Signal> {
        let Expr::Var(place) = expr else { return None };
        self.program.signals.get(usize::from(*place))
    }

    /// The unit of a number, as far as signals say it.
    fn unit(&self, expr: &Expr) -> Option<Unit> {
        match expr {
            Expr::Var(_) => {
                self.signal(expr).map(|signal| print::unit_of(signal.ty)).filter(|u| *u != Unit::None)
            }
            Expr::Unary(UnaryOp::Neg, a) => self.unit(a),
            Expr::Binary(BinaryOp::Mul, a, b) => match (self.unit(a), self.unit(b)) {
                (Some(unit), None) | (None, Some(unit)) => Some(unit),
                // A product of two has another one, which is not told.
                (Some(_), Some(_)) | (None, None) => None,
            },
            Expr::Binary(BinaryOp::Div, a, b) => self.unit(a).filter(|_| self.unit(b).is_none()),
            Expr::Binary(op, a, b) if sign(*op).1 > 4 => self.unit(a).or(self.unit(b)),
            Expr::If(_, a, b) => self.unit(a).or(self.unit(b)),
            Expr::Call(_, items) => items.iter().find_map(|item| self.unit(item)),
            Expr::Const(_)
            | Expr::Unary(UnaryOp::Not, _)
            | Expr::Binary(..)
            | Expr::List(..)
            | Expr::Element(_)
            | Expr::Apply(..) => None,
        }
    }
}

/// The parts of one requirement at work on a trace.
struct PartsWatch {
    parts: Vec<RequirementPart>,
    /// The latest value of each, and what is told of it.
    latest: Vec<Option<Value>>,
    told: Vec<Vec<SubformulaValue>>,
    /// The latest sample of each signal of the program.
    signals: Vec<Option<Value>>,
    window: (Nanos, Nanos),
    /// The instant of samples that no part has been asked about yet.
    sampled: Option<Nanos>,
}

impl PartsWatch {
    fn new(program: &Program, parts: Vec<RequirementPart>, window: (Nanos, Nanos)) -> Self {
        Self {
            latest: vec![None; parts.len()],
            told: vec![Vec::new(); parts.len()],
            signals: vec![None; program.signals.len()],
            parts,
            window,
            sampled: None,
        }
    }

    /// All samples of an instant are known: a condition over several signals never has some of them new and others old.
    fn close_instant(&mut self) {
        let Some(time) = self.sampled.take() else { return };
        let signals = &self.signals;
        let value_of = |place: u16| signals.get(usize::from(place)).copied().flatten();
        for ((part, latest), told) in self.parts.iter().zip(&mut self.latest).zip(&mut self.told) {
            let WatchedPart::Value(expr) = &part.what else { continue };
            // What has no value stays as it was.
            let Ok(value) = expr.eval(&value_of) else { continue };
            let before = latest.replace(value);
            if before == Some(value) || time < self.window.0 {
                continue;
            }
            if told.is_empty()
                && time > self.window.0
                && let Some(before) = before
            {
                told.push(SubformulaValue { time: seconds(self.window.0), value: reading(before) });
            }
            told.push(SubformulaValue { time: seconds(time), value: reading(value) });
        }
    }

    fn told(self) -> Vec<SubformulaValues> {
        let from = seconds(self.window.0);
        let all = self.parts.into_iter().zip(self.latest).zip(self.told);
        let told =
            |((part, latest), mut values): ((RequirementPart, Option<Value>), Vec<SubformulaValue>)| {
                if values.is_empty()
                    && let Some(value) = latest
                {
                    values.push(SubformulaValue { time: from, value: reading(value) });
                }
                let event = matches!(part.what, WatchedPart::Event(_));
                SubformulaValues { text: part.text, unit: part.unit.symbol().to_owned(), event, values }
            };
        all.map(told).collect()
    }
}

fn reading(value: Value) -> SubformulaReading {
    match value {
        Value::Bool(truth) => SubformulaReading::Truth(truth),
        Value::Int(_) | Value::Float(_) => match value.as_f64().filter(|x| x.is_finite()) {
            Some(number) => SubformulaReading::Number(number),
            None => SubformulaReading::Word(value.to_string()),
        },
        Value::Symbol(_) | Value::Text(_) | Value::List(_) => SubformulaReading::Word(value.to_string()),
    }
}

impl TraceObserver for PartsWatch {
    fn step(&mut self, _: usize, step: &TraceStep) {
        if self.sampled.is_some_and(|time| step.time > time) {
            self.close_instant();
        }
        if step.time > self.window.1 {
            return;
        }
        match &step.what {
            TraceStepKind::Sample { signal, value } => {
                if let Some(known) = self.signals.get_mut(usize::from(signal.0)) {
                    *known = Some(*value);
                    self.sampled = Some(step.time);
                }
            }
            TraceStepKind::Event { event, args } if step.time >= self.window.0 => {
                let happens =
                    SubformulaValue { time: seconds(step.time), value: SubformulaReading::Truth(true) };
                for (part, told) in self.parts.iter().zip(&mut self.told) {
                    if matches!(&part.what, WatchedPart::Event(pattern) if pattern.matches(*event, args)) {
                        told.push(happens.clone());
                    }
                }
            }
            TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => {}
        }
    }

    fn end(&mut self, _: Nanos) {
        self.close_instant();
    }
}

/// What is watched of one violated requirement: its parts and, of a formula, the formulas in it.
struct FailureWatch {
    /// Its place among the verdicts.
    place: usize,
    parts: PartsWatch,
    formula: Option<(MetricRunner, CheckedFormula)>,
}

impl FailureWatch {
    fn told(self) -> Vec<SubformulaValues> {
        let window = self.parts.window;
        let mut told = self.parts.told();
        if let Some((runner, formula)) = self.formula
            && let Some(tape) = runner.tape()
        {
            told.extend(formulas_over_time(&formula, &tape, window));
        }
        told
    }
}

struct WatchedFailures(Vec<FailureWatch>);

impl TraceObserver for WatchedFailures {
    fn step(&mut self, index: usize, step: &TraceStep) {
        for watch in &mut self.0 {
            watch.parts.step(index, step);
            if let Some((runner, _)) = &mut watch.formula {
                runner.step(index, step);
            }
        }
    }

    fn end(&mut self, time: Nanos) {
        for watch in &mut self.0 {
            watch.parts.end(time);
            if let Some((runner, _)) = &mut watch.formula {
                runner.end(time);
            }
        }
    }
}
