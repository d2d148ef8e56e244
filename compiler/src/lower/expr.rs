//! Expressions: what stands for their names and measurements.

use hrdsl_ir::{
    Expr,
    expr::{ArrayIndex, Lvalue},
};
use hrdsl_model::{self as model, SignalTerm, TypedExprKind, VariableRef};

/// Where a value that is not constant comes from.
pub(crate) enum LeafSource {
    Leaf(VariableRef),
    Term(SignalTerm, model::TypedExpr),
}

/// Stops at what the checker has ruled out: this is a fault of ours, and a value in its place would be a wrong answer.
#[track_caller]
pub(crate) fn ruled_out(what: &str) -> ! {
    unreachable!("the checker lets no {what} through")
}

/// Lowers an expression; `read` gives what stands for a name or a measurement.
pub(crate) fn expr(e: &model::TypedExpr, read: &mut dyn FnMut(LeafSource) -> Expr) -> Expr {
    match &e.kind {
        TypedExprKind::Const(v) => Expr::Const(*v),
        TypedExprKind::Leaf(leaf) => read(LeafSource::Leaf(*leaf)),
        TypedExprKind::Term(term) => read(LeafSource::Term(*term, e.clone())),
        TypedExprKind::Unary(op, a) => Expr::Unary(*op, Box::new(expr(a, read))),
        TypedExprKind::Binary(op, a, b) => {
            let a = expr(a, read);
            Expr::binary(*op, a, expr(b, read))
        }
        TypedExprKind::If(c, a, b) => {
            let (c, a) = (expr(c, read), expr(a, read));
            Expr::If(Box::new(c), Box::new(a), Box::new(expr(b, read)))
        }
        TypedExprKind::Call(f, args) => Expr::Call(*f, args.iter().map(|a| expr(a, read)).collect()),
        TypedExprKind::List(items, rest) => {
            let items = items.iter().map(|a| expr(a, read)).collect();
            let rest = rest.as_ref().map(|r| Box::new(expr(r, read)));
            Expr::List(items, rest)
        }
        TypedExprKind::Element(of) => {
            // Only automata and functions choose elements at run time, and their leaves are variables.
            let Expr::Var(slot) = read(LeafSource::Leaf(of.slot)) else { ruled_out("element of a constant") };
            let index = |i: &model::TypedIndex| ArrayIndex {
                at: expr(&i.at, read),
                count: i.count,
                stride: i.stride,
            };
            let indices = of.indices.iter().map(index).collect();
            Expr::Element(Box::new(Lvalue { slot, indices }))
        }
        TypedExprKind::Apply(function, args, _) => {
            Expr::Apply(*function, args.iter().map(|a| expr(a, read)).collect())
        }
        TypedExprKind::Error => ruled_out("expression with an error"),
    }
}

/// An expression over the locals alone: of a stimulus or a plan.
pub(crate) fn local(e: &model::TypedExpr) -> Expr {
    expr(e, &mut |source| match source {
        LeafSource::Leaf(VariableRef::Local(i)) => Expr::Var(i),
        LeafSource::Leaf(VariableRef::Own(_) | VariableRef::Shared(_) | VariableRef::Signal(_))
        | LeafSource::Term(..) => ruled_out("variable but locals into a stimulus or plan"),
    })
}
