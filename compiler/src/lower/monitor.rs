//! Requirements → monitor automata: a pattern becomes a part with ways in and out, and its scope says when those are gone.

mod formula;
mod parts;
mod patterns;
mod scopes;

use hrdsl_ir::{
    Expr, Unit,
    expr::{BinaryOp, NumberFunction, OperatorSort},
    monitor::{Assumption, Monitor, StateId},
};
use hrdsl_model::{self as model, InferredType, TypedExprKind};
use hrdsl_source::SourceFiles;
use hrdsl_syntax::{RequirementPattern, ast};

use super::world::{SignalReader, SignalTable};
use parts::MonitorParts;

pub(crate) fn monitor(
    r: &model::TypedRequirement,
    files: &SourceFiles,
    signals: &mut SignalTable<'_>,
) -> Monitor {
    if let RequirementPattern::Formula(formula) = &r.pattern.pattern {
        return of_formula(r, formula, files, signals);
    }
    let mut parts = MonitorParts::new(signals);
    let scope = parts.scope(&r.pattern.scope);
    let part = parts.pattern(&r.pattern.pattern, scope.sort());
    let machine = scope.around(part);
    Monitor {
        name: r.name.clone(),
        kind: r.kind,
        title: r.title.clone(),
        doc: r.doc.clone(),
        text: one_line(files.text(r.text)),
        states: machine.states,
        initial: machine.initial,
        at_start: machine.at_start,
        edges: machine.edges,
        margin: machine.margin,
        formula: None,
        origin: r.span,
        conditions: parts.conditions.clone(),
        signals: parts.signals(),
    }
}

/// A formula has neither states nor edges: its operators are what executes it.
fn of_formula(
    r: &model::TypedRequirement,
    formula: &model::TypedTemporal,
    files: &SourceFiles,
    signals: &mut SignalTable<'_>,
) -> Monitor {
    let mut reader = SignalReader::new(signals);
    let formula = formula::formula(formula, &mut reader, files);
    Monitor {
        name: r.name.clone(),
        kind: r.kind,
        title: r.title.clone(),
        doc: r.doc.clone(),
        text: one_line(files.text(r.text)),
        states: Vec::new(),
        initial: StateId(0),
        at_start: Vec::new(),
        edges: Vec::new(),
        margin: None,
        formula: Some(Box::new(formula)),
        origin: r.span,
        conditions: Vec::new(),
        signals: reader.read(),
    }
}

pub(crate) fn assumption(a: &model::TypedAssumption, files: &SourceFiles) -> Assumption {
    Assumption {
        text: one_line(files.text(a.text)),
        events: a.events.clone(),
        at_most: a.at_most,
        within: a.within,
        origin: a.origin,
    }
}

pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The robustness of a condition (of its negation, if not `positive`): `a < c` has c − a, a conjunction the least of its
/// parts, a disjunction the greatest (Fainekos and Pappas, 2009). `None` if some part is not a comparison of numbers, or
/// the parts' units differ.
fn margin(e: &model::TypedExpr, positive: bool, reader: &mut SignalReader<'_, '_>) -> Option<(Expr, Unit)> {
    match &e.kind {
        TypedExprKind::Unary(ast::UnaryOp::Not, a) => margin(a, !positive, reader),
        TypedExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => {
            let ((a, unit), (b, other)) = (margin(a, positive, reader)?, margin(b, positive, reader)?);
            let least = (*op == BinaryOp::And) == positive;
            let pick = if least { NumberFunction::Min } else { NumberFunction::Max };
            (unit == other).then(|| (Expr::Call(pick, vec![a, b]), unit))
        }
        TypedExprKind::Binary(op, a, b) => {
            if op.sort() != OperatorSort::Order {
                return None;
            }
            let smaller_first = matches!(op, BinaryOp::Lt | BinaryOp::Le);
            let unit = match a.ty {
                InferredType::Float(dim) => dim.unit(),
                InferredType::Int
                | InferredType::Bool
                | InferredType::Enum(_)
                | InferredType::Text
                | InferredType::List(_)
                | InferredType::Unknown => Unit::None,
            };
            let (a, b) = (reader.expr(a), reader.expr(b));
            let (small, large) = if smaller_first == positive { (a, b) } else { (b, a) };
            Some((Expr::binary(BinaryOp::Sub, large, small), unit))
        }
        TypedExprKind::Unary(ast::UnaryOp::Neg, _)
        | TypedExprKind::Const(_)
        | TypedExprKind::Leaf(_)
        | TypedExprKind::Term(_)
        | TypedExprKind::If(..)
        | TypedExprKind::Call(..)
        | TypedExprKind::List(..)
        | TypedExprKind::Element(_)
        | TypedExprKind::Apply(..)
        | TypedExprKind::Error => None,
    }
}
