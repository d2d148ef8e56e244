//! Expressions: what stands for their names and measurements.

use hrdsl_ir::{
    Expr,
    expr::{Index, Place},
};
use hrdsl_model::{self as model, ExprKind, Leaf, Term};

/// Where a value that is not constant comes from.
pub(crate) enum Source {
    Leaf(Leaf),
    Term(Term, model::Expr),
}

/// Lowers an expression; `read` gives what stands for a name or a measurement.
pub(crate) fn expr(e: &model::Expr, read: &mut dyn FnMut(Source) -> Expr) -> Expr {
    match &e.kind {
        ExprKind::Const(v) => Expr::Const(*v),
        ExprKind::Leaf(leaf) => read(Source::Leaf(*leaf)),
        ExprKind::Term(term) => read(Source::Term(*term, e.clone())),
        ExprKind::Unary(op, a) => Expr::Unary(*op, Box::new(expr(a, read))),
        ExprKind::Binary(op, a, b) => {
            let a = expr(a, read);
            Expr::binary(*op, a, expr(b, read))
        }
        ExprKind::If(c, a, b) => {
            let (c, a) = (expr(c, read), expr(a, read));
            Expr::If(Box::new(c), Box::new(a), Box::new(expr(b, read)))
        }
        ExprKind::Call(f, args) => Expr::Call(*f, args.iter().map(|a| expr(a, read)).collect()),
        ExprKind::List(items, rest) => {
            let items = items.iter().map(|a| expr(a, read)).collect();
            let rest = rest.as_ref().map(|r| Box::new(expr(r, read)));
            Expr::List(items, rest)
        }
        ExprKind::Element(of) => {
            // INVARIANT: only automata and functions choose elements at run time, and their leaves are variables.
            let slot = if let Expr::Var(slot) = read(Source::Leaf(of.slot)) { slot } else { u16::MAX };
            let index = |i: &model::Index| Index { at: expr(&i.at, read), count: i.count, stride: i.stride };
            let indices = of.indices.iter().map(index).collect();
            Expr::Element(Box::new(Place { slot, indices }))
        }
        ExprKind::Apply(function, args, _) => {
            Expr::Apply(*function, args.iter().map(|a| expr(a, read)).collect())
        }
        // INVARIANT: a scenario with errors is not lowered.
        ExprKind::Error => Expr::bool(false),
    }
}

/// An expression over the locals alone: of a stimulus or a plan.
pub(crate) fn local(e: &model::Expr) -> Expr {
    expr(e, &mut |source| match source {
        Source::Leaf(Leaf::Local(i)) => Expr::Var(i),
        // INVARIANT: the checker lets nothing else into such an expression.
        Source::Leaf(Leaf::Own(_) | Leaf::Shared(_) | Leaf::Signal(_)) | Source::Term(..) => {
            Expr::bool(false)
        }
    })
}
