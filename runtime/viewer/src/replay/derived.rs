//! Values of numbers over recorded signals: as text, at a time, and over the whole run.

use hrdsl_ir::{
    Expr, Nanos, Value,
    expr::{NumberFunction, UnaryOp, sign},
    world::SignalId,
};
use hrdsl_trace::TraceStepKind;

use super::run::ReplayedRun;

/// An expression as the scenario would have it, with the names of its signals; `None` if it has more than numbers and truths in it.
pub(super) fn text(run: &ReplayedRun<'_>, signals: &[SignalId], expr: &Expr) -> Option<String> {
    written(&|slot| Some(run.program.signal(*signals.get(usize::from(slot))?).name.clone()), expr, 0)
}

/// `tightest`: how tightly what is around it binds.
fn written(name: &dyn Fn(u16) -> Option<String>, expr: &Expr, tightest: u8) -> Option<String> {
    match expr {
        Expr::Const(value) => Some(value.to_string()),
        Expr::Var(slot) => name(*slot),
        Expr::Unary(UnaryOp::Neg, a) => Some(format!("-{}", written(name, a, u8::MAX)?)),
        Expr::Binary(op, a, b) => {
            let (sign, binds) = sign(*op);
            let (a, b) = (written(name, a, binds)?, written(name, b, binds + 1)?);
            Some(if binds < tightest { format!("({a} {sign} {b})") } else { format!("{a} {sign} {b}") })
        }
        Expr::Call(function, parts) => {
            let parts: Vec<String> =
                parts.iter().map(|part| written(name, part, 0)).collect::<Option<_>>()?;
            let parts = parts.join(", ");
            let called = function.name();
            Some(match function {
                NumberFunction::Norm => format!("{called}(({parts}))"),
                NumberFunction::Abs | NumberFunction::Min | NumberFunction::Max => {
                    format!("{called}({parts})")
                }
            })
        }
        Expr::Unary(UnaryOp::Not, a) => Some(format!("not {}", written(name, a, u8::MAX)?)),
        Expr::If(..) | Expr::List(..) | Expr::Element(_) | Expr::Apply(..) => None,
    }
}

/// The latest value at a time, if its signals are known then.
pub(super) fn value_at(run: &ReplayedRun<'_>, signals: &[SignalId], expr: &Expr, at: Nanos) -> Option<f64> {
    let latest = |slot: u16| -> Option<Value> {
        let id = *signals.get(usize::from(slot))?;
        let known = run.trace.steps.iter().rev().filter(|step| step.time <= at);
        let mut samples = known.filter_map(|step| match &step.what {
            TraceStepKind::Sample { signal, value } if *signal == id => Some(*value),
            TraceStepKind::Sample { .. } | TraceStepKind::Event { .. } | TraceStepKind::Machine(_) => None,
        });
        samples.next()
    };
    expr.eval(&latest).ok()?.as_f64()
}

/// Its values at each instant at which one of its signals has a new one.
pub(super) fn values(run: &ReplayedRun<'_>, signals: &[SignalId], expr: &Expr) -> Vec<(Nanos, f64)> {
    let mut latest: Vec<Option<Value>> = vec![None; signals.len()];
    let mut values: Vec<(Nanos, f64)> = Vec::new();
    for step in &run.trace.steps {
        let TraceStepKind::Sample { signal, value } = &step.what else { continue };
        let Some(known) = signals.iter().position(|id| id == signal).and_then(|at| latest.get_mut(at)) else {
            continue;
        };
        *known = Some(*value);
        let now = expr.eval(&|slot| latest.get(usize::from(slot)).copied().flatten());
        let Some(now) = now.ok().and_then(Value::as_f64) else { continue };
        // Of several samples of an instant, all count.
        if values.last().is_some_and(|(time, _)| *time == step.time) {
            values.pop();
        }
        if values.last().is_none_or(|(_, before)| *before != now) {
            values.push((step.time, now));
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Expr,
        expr::{BinaryOp, NumberFunction},
    };

    use super::written;

    #[test]
    fn numbers_are_written_as_in_a_scenario() {
        let name = |slot: u16| Some(["watch.dx", "watch.dy"][usize::from(slot)].to_owned());
        let text = |expr: &Expr| written(&name, expr, 0).unwrap();
        let norm = Expr::Call(NumberFunction::Norm, vec![Expr::Var(0), Expr::Var(1)]);
        assert_eq!(text(&norm), "norm((watch.dx, watch.dy))");
        let less = Expr::binary(BinaryOp::Sub, Expr::Var(0), Expr::float(0.5));
        let nested = Expr::binary(BinaryOp::Sub, Expr::Var(1), less.clone());
        assert_eq!(text(&nested), "watch.dy - (watch.dx - 0.5)");
        let product = Expr::binary(BinaryOp::Mul, less.clone(), Expr::Var(1));
        assert_eq!(text(&product), "(watch.dx - 0.5) * watch.dy");
        assert_eq!(text(&Expr::Call(NumberFunction::Abs, vec![less])), "abs(watch.dx - 0.5)");
        assert_eq!(written(&name, &Expr::List(Vec::new(), None), 0), None);
    }
}
