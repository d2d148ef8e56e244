//! What a violated formula consists of, over time: whether each formula in it holds, and by how much.

use hrdsl_ir::{Nanos, Unit, formula::MetricFormula, value::seconds};
use hrdsl_metric::{AtomsOverTime, CheckedFormula, Robustness, SignalPiece, robustness_over_time};
use hrdsl_results::{SubformulaReading, SubformulaValue, SubformulaValues};

/// What is told where the run ends too early to know.
const OPEN: &str = "open";

/// The formulas in it in the window of time, each after what it is made of; of comparisons of numbers in one unit, and what is made of them, by how
/// much they hold, too. Events, and signals that are true or false, are told by themselves.
pub(crate) fn formulas_over_time(
    formula: &CheckedFormula,
    tape: &AtomsOverTime,
    window: (Nanos, Nanos),
) -> Vec<SubformulaValues> {
    let mut parts = Vec::new();
    formula.goal.formulas().into_iter().for_each(|f| collect(f, formula, &mut parts));
    let mut told = Vec::new();
    for part in parts {
        let text = part.text(&|atom| formula.atom_text(atom).to_owned());
        let span = (tape.start, tape.end);
        let known = robustness_over_time(part, &tape.atoms, span);
        let pairs = both(&known.lower, &known.upper);
        let holds = |(least, most): (Robustness, Robustness)| {
            if least.holds() == most.holds() {
                SubformulaReading::Truth(least.holds())
            } else {
                SubformulaReading::Word(OPEN.to_owned())
            }
        };
        told.push(values_of(text.clone(), Unit::None, within(&pairs, window, holds)));
        let Some(unit) = formula.unit else { continue };
        let measured = within(&pairs, window, number);
        if measured.iter().any(|v| matches!(v.value, SubformulaReading::Number(_))) {
            told.push(values_of(format!("margin of {text}"), unit, measured));
        }
    }
    told
}

fn values_of(text: String, unit: Unit, values: Vec<SubformulaValue>) -> SubformulaValues {
    SubformulaValues { text, unit: unit.symbol().to_owned(), event: false, values }
}

fn number((least, most): (Robustness, Robustness)) -> SubformulaReading {
    if least != most {
        return SubformulaReading::Word(OPEN.to_owned());
    }
    match least.number() {
        number if number.is_finite() => SubformulaReading::Number(number),
        number if number > 0.0 => SubformulaReading::Word("holds whatever is measured".to_owned()),
        _ => SubformulaReading::Word("does not hold whatever is measured".to_owned()),
    }
}

/// Each once, after what it is made of.
fn collect<'f>(of: &'f MetricFormula, formula: &CheckedFormula, parts: &mut Vec<&'f MetricFormula>) {
    match of {
        MetricFormula::Constant(_) => return,
        MetricFormula::Atom(atom) if formula.is_told_by_itself(*atom) => return,
        MetricFormula::Atom(_)
        | MetricFormula::Not(_)
        | MetricFormula::And(..)
        | MetricFormula::Or(..)
        | MetricFormula::Implies(..)
        | MetricFormula::Once(..)
        | MetricFormula::Historically(..)
        | MetricFormula::Since(..)
        | MetricFormula::Eventually(..)
        | MetricFormula::Always(..)
        | MetricFormula::Until(..) => {}
    }
    of.operands().into_iter().for_each(|operand| collect(operand, formula, parts));
    if !parts.contains(&of) {
        parts.push(of);
    }
}

type BothBounds = (Nanos, (Robustness, Robustness));

/// The two bounds side by side; both begin at the first moment.
fn both(lower: &[SignalPiece], upper: &[SignalPiece]) -> Vec<BothBounds> {
    let mut times: Vec<Nanos> = lower.iter().chain(upper).map(|piece| piece.start).collect();
    times.sort_unstable();
    times.dedup();
    let at = |pieces: &[SignalPiece], time: Nanos| {
        let next = pieces.partition_point(|piece| piece.start <= time);
        next.checked_sub(1).and_then(|last| pieces.get(last)).map(|piece| piece.value)
    };
    times.into_iter().filter_map(|time| Some((time, (at(lower, time)?, at(upper, time)?)))).collect()
}

/// Each new reading in the window, of which the first is that at its beginning, if there was one.
fn within(
    pairs: &[BothBounds],
    (from, to): (Nanos, Nanos),
    reading: impl Fn((Robustness, Robustness)) -> SubformulaReading,
) -> Vec<SubformulaValue> {
    let mut told: Vec<SubformulaValue> = Vec::new();
    for (time, bounds) in pairs.iter().take_while(|(time, _)| *time <= to) {
        let value = SubformulaValue { time: seconds((*time).max(from)), value: reading(*bounds) };
        if *time <= from {
            told.clear();
        }
        if told.last().is_none_or(|last| last.value != value.value) {
            told.push(value);
        }
    }
    told
}
