//! Requirements in metric temporal logic: atoms over signals and events, and what is asked of the run as a whole.

use hrdsl_ir::{
    Expr, Nanos, Unit,
    expr::{BinaryOp, OperatorSort, UnaryOp},
    formula::{
        FormulaAtom, FormulaAtomKind, FutureWindow, MetricFormula, MetricGoal, MonitorFormula, PastWindow,
    },
    value::nanos,
};
use hrdsl_model::{InferredType, TypedExpr, TypedExprKind, TypedOccurrence, TypedTemporal};
use hrdsl_source::SourceFiles;
use hrdsl_syntax::{TemporalJunction, TemporalKind, TemporalLook, TemporalReach, TemporalWindow};

use super::one_line;
use crate::lower::{expr::ruled_out, world::SignalReader};

/// A formula while it is made.
pub(super) struct FormulaParts<'r, 's, 'a> {
    reader: &'r mut SignalReader<'s, 'a>,
    files: &'r SourceFiles,
    atoms: Vec<FormulaAtom>,
    /// Those of the comparisons so far.
    units: Vec<Unit>,
}

pub(super) fn formula(
    formula: &TypedTemporal,
    reader: &mut SignalReader<'_, '_>,
    files: &SourceFiles,
) -> MonitorFormula {
    let mut parts = FormulaParts { reader, files, atoms: Vec::new(), units: Vec::new() };
    let goal = parts.goal(formula);
    parts.units.dedup();
    let unit = match parts.units.as_slice() {
        [unit] => Some(*unit),
        _ => None,
    };
    MonitorFormula { goal, atoms: parts.atoms, unit }
}

impl FormulaParts<'_, '_, '_> {
    /// What looks ahead as far as the run goes stands outermost, joined by what does not ask it of every moment.
    fn goal(&mut self, of: &TypedTemporal) -> MetricGoal {
        if !of.all().iter().any(|part| part.looks_without_end()) {
            return MetricGoal::Now(self.formula(of));
        }
        match &of.kind {
            TemporalKind::Not(a) => self.goal(a).negated(),
            TemporalKind::Junction(junction, parts) => {
                let [a, b] = parts.as_ref();
                let (a, b) = (self.goal(a), self.goal(b));
                match junction {
                    TemporalJunction::And => MetricGoal::And(Box::new(a), Box::new(b)),
                    TemporalJunction::Or => MetricGoal::Or(Box::new(a), Box::new(b)),
                    TemporalJunction::Implies => MetricGoal::Or(Box::new(a.negated()), Box::new(b)),
                }
            }
            TemporalKind::Look { look: TemporalLook::Always, window: None, of } => {
                MetricGoal::Always(self.formula(of))
            }
            TemporalKind::Look { look: TemporalLook::Eventually, window: None, of } => {
                MetricGoal::Eventually(self.formula(of))
            }
            TemporalKind::Reach { reach: TemporalReach::Until, window: None, of } => {
                let [a, b] = of.as_ref();
                let a = self.formula(a);
                MetricGoal::Until(a, self.formula(b))
            }
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Look { .. }
            | TemporalKind::Reach { .. } => MetricGoal::Now(self.formula(of)),
        }
    }

    fn formula(&mut self, of: &TypedTemporal) -> MetricFormula {
        match &of.kind {
            TemporalKind::Constant(truth) => MetricFormula::Constant(*truth),
            TemporalKind::Events(events) => self.any(events, &one_line(self.files.text(of.span))),
            TemporalKind::Condition(condition) => self.condition(condition),
            TemporalKind::Not(a) => not(self.formula(a)),
            TemporalKind::Junction(junction, parts) => {
                let [a, b] = parts.as_ref();
                let (a, b) = (Box::new(self.formula(a)), Box::new(self.formula(b)));
                match junction {
                    TemporalJunction::And => MetricFormula::And(a, b),
                    TemporalJunction::Or => MetricFormula::Or(a, b),
                    TemporalJunction::Implies => MetricFormula::Implies(a, b),
                }
            }
            TemporalKind::Look { look, window, of } => {
                let (window, of) = (window.as_ref(), Box::new(self.formula(of)));
                match look {
                    TemporalLook::Always => MetricFormula::Always(future(window), of),
                    TemporalLook::Eventually => MetricFormula::Eventually(future(window), of),
                    TemporalLook::Historically => MetricFormula::Historically(past(window), of),
                    TemporalLook::Once => MetricFormula::Once(past(window), of),
                }
            }
            TemporalKind::Reach { reach, window, of } => {
                let [a, b] = of.as_ref();
                let (window, a, b) = (window.as_ref(), Box::new(self.formula(a)), Box::new(self.formula(b)));
                match reach {
                    TemporalReach::Until => MetricFormula::Until(future(window), a, b),
                    TemporalReach::Since => MetricFormula::Since(past(window), a, b),
                }
            }
        }
    }

    /// One of several events.
    fn any(&mut self, events: &[TypedOccurrence], text: &str) -> MetricFormula {
        let mut any: Option<MetricFormula> = None;
        for occurrence in events {
            let one = match occurrence {
                TypedOccurrence::Event(pattern) => {
                    self.atom(text.to_owned(), FormulaAtomKind::Happens(pattern.clone()))
                }
                TypedOccurrence::Edge { rising, condition } => {
                    let condition = self.condition(condition);
                    edge(condition, *rising)
                }
            };
            any = Some(match any {
                Some(before) => MetricFormula::Or(Box::new(before), Box::new(one)),
                None => one,
            });
        }
        any.unwrap_or(MetricFormula::Constant(false))
    }

    /// A condition: what it is joined of are atoms of their own, so that its robustness is known.
    fn condition(&mut self, of: &TypedExpr) -> MetricFormula {
        match &of.kind {
            TypedExprKind::Const(value) if value.as_bool().is_some() => {
                MetricFormula::Constant(value.as_bool() == Some(true))
            }
            TypedExprKind::Unary(UnaryOp::Not, a) => not(self.condition(a)),
            TypedExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), a, b) => {
                let (a, b) = (Box::new(self.condition(a)), Box::new(self.condition(b)));
                if *op == BinaryOp::And { MetricFormula::And(a, b) } else { MetricFormula::Or(a, b) }
            }
            TypedExprKind::Binary(op, a, b) if self.compares_numbers(*op, a) => {
                self.comparison(of, *op, a, b)
            }
            TypedExprKind::Binary(..)
            | TypedExprKind::Unary(..)
            | TypedExprKind::Const(_)
            | TypedExprKind::Leaf(_)
            | TypedExprKind::Term(_)
            | TypedExprKind::If(..)
            | TypedExprKind::Call(..)
            | TypedExprKind::List(..)
            | TypedExprKind::Element(_)
            | TypedExprKind::Apply(..)
            | TypedExprKind::Error => {
                let holds = FormulaAtomKind::Holds(self.reader.expr(of));
                self.atom(one_line(self.files.text(of.span)), holds)
            }
        }
    }

    /// Whether it compares numbers; then their unit is kept.
    fn compares_numbers(&mut self, op: BinaryOp, operand: &TypedExpr) -> bool {
        let unit = match operand.ty {
            InferredType::Float(dimension) => dimension.unit(),
            InferredType::Int => Unit::None,
            InferredType::Bool
            | InferredType::Enum(_)
            | InferredType::Text
            | InferredType::List(_)
            | InferredType::Unknown => return false,
        };
        let compares = op.sort() == OperatorSort::Order || matches!(op, BinaryOp::Eq | BinaryOp::Ne);
        if compares {
            self.units.push(unit);
        }
        compares
    }

    fn comparison(&mut self, of: &TypedExpr, op: BinaryOp, a: &TypedExpr, b: &TypedExpr) -> MetricFormula {
        let (a, b) = (self.reader.expr(a), self.reader.expr(b));
        let less = |least: Expr, most: Expr, strict| FormulaAtomKind::Less { least, most, strict };
        let what = match op {
            BinaryOp::Lt => less(a, b, true),
            BinaryOp::Le => less(a, b, false),
            BinaryOp::Gt => less(b, a, true),
            BinaryOp::Ge => less(b, a, false),
            BinaryOp::Eq => FormulaAtomKind::Equal { left: a, right: b, negated: false },
            BinaryOp::Ne => FormulaAtomKind::Equal { left: a, right: b, negated: true },
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => {
                ruled_out("arithmetic as a condition")
            }
            BinaryOp::And | BinaryOp::Or => ruled_out("junction as a comparison"),
        };
        self.atom(one_line(self.files.text(of.span)), what)
    }

    fn atom(&mut self, text: String, what: FormulaAtomKind) -> MetricFormula {
        let known = self.atoms.iter().position(|atom| atom.what == what);
        MetricFormula::Atom(known.unwrap_or_else(|| {
            self.atoms.push(FormulaAtom { text, what });
            self.atoms.len() - 1
        }))
    }
}

fn not(of: MetricFormula) -> MetricFormula {
    MetricFormula::Not(Box::new(of))
}

/// It holds, and did not a nanosecond before; or the other way round.
fn edge(condition: MetricFormula, rising: bool) -> MetricFormula {
    const JUST_BEFORE: Nanos = 1;
    let opposite = not(condition.clone());
    let (now, before) = if rising { (condition, opposite) } else { (opposite, condition) };
    let window = past_window(JUST_BEFORE, Some(JUST_BEFORE));
    MetricFormula::And(Box::new(now), Box::new(MetricFormula::Once(window, Box::new(before))))
}

fn past(window: Option<&TemporalWindow<f64>>) -> PastWindow {
    window.map_or(PastWindow::SINCE_START, |w| past_window(nanos(w.from), Some(nanos(w.to))))
}

fn past_window(from: Nanos, to: Option<Nanos>) -> PastWindow {
    PastWindow::new(from, to).unwrap_or_else(|| ruled_out("window that ends before it begins"))
}

fn future(window: Option<&TemporalWindow<f64>>) -> FutureWindow {
    let window = window.and_then(|w| FutureWindow::new(nanos(w.from), nanos(w.to)));
    window.unwrap_or_else(|| ruled_out("operator without a window that is asked of every moment"))
}
