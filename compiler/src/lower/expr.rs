//! Values, types and expressions.

use hrdsl_ir::{
    self as ir, Expr, Unit,
    expr::{Index, Place},
};
use hrdsl_model::{self as model, Dim, ExprKind, Leaf, Term};
use hrdsl_syntax::ast;

pub(crate) fn value(v: model::Value) -> ir::Value {
    match v {
        model::Value::Bool(b) => ir::Value::Bool(b),
        model::Value::Int(n) => ir::Value::Int(n),
        model::Value::Float(x) => ir::Value::Float(x),
        model::Value::Symbol(symbol) => ir::Value::Symbol(symbol),
        model::Value::Text(text) => ir::Value::Text(ir::Text { text: text.0 }),
        model::Value::List(list) => ir::Value::List(ir::List::of(&values(list.values()))),
    }
}

pub(crate) fn values(vs: &[model::Value]) -> Vec<ir::Value> {
    vs.iter().copied().map(value).collect()
}

pub(crate) fn ty(of: model::Type) -> ir::Type {
    match of {
        model::Type::Bool => ir::Type::Bool,
        model::Type::Int { lo, hi } => ir::Type::Int { lo, hi },
        model::Type::Float(dim) => ir::Type::Float(unit(dim)),
        model::Type::Enum(of) => ir::Type::Enum(of),
        model::Type::Text => ir::Type::Text,
        model::Type::List(of) => ir::Type::List(ir::ListOf::new(ty(of.element()))),
    }
}

/// The unit of a dimension; one without a name of its own is printed without.
pub(crate) fn unit(dim: Dim) -> Unit {
    let units = [
        (Dim::TIME, Unit::Second),
        (Dim::LENGTH, Unit::Metre),
        (Dim::ANGLE, Unit::Radian),
        (Dim::MASS, Unit::Kilogram),
        (Dim::FORCE, Unit::Newton),
        (Dim::SPEED, Unit::MetrePerSecond),
        (Dim::ANGULAR_SPEED, Unit::RadianPerSecond),
        (Dim::ACCELERATION, Unit::MetrePerSecondSquared),
        (Dim::ANGULAR_ACCELERATION, Unit::RadianPerSecondSquared),
        (Dim::PRESSURE, Unit::Pascal),
        (Dim::TORQUE, Unit::NewtonMetre),
        (Dim::FREQUENCY, Unit::Hertz),
        (Dim::DATA, Unit::Byte),
    ];
    units.into_iter().find(|(d, _)| *d == dim).map_or(Unit::None, |(_, unit)| unit)
}

pub(crate) fn params(params: &[model::Param]) -> Vec<ir::Param> {
    params.iter().map(|p| ir::Param { name: p.name.clone(), ty: ty(p.ty) }).collect()
}

/// Where a value that is not constant comes from.
pub(crate) enum Source {
    Leaf(Leaf),
    Term(Term, model::Expr),
}

/// Lowers an expression; `read` gives what stands for a name or a measurement.
pub(crate) fn expr(e: &model::Expr, read: &mut dyn FnMut(Source) -> Expr) -> Expr {
    match &e.kind {
        ExprKind::Const(v) => Expr::Const(value(*v)),
        ExprKind::Leaf(leaf) => read(Source::Leaf(*leaf)),
        ExprKind::Term(term) => read(Source::Term(*term, e.clone())),
        ExprKind::Unary(op, a) => {
            let op = match op {
                ast::UnaryOp::Not => ir::expr::UnaryOp::Not,
                ast::UnaryOp::Neg => ir::expr::UnaryOp::Neg,
            };
            Expr::Unary(op, Box::new(expr(a, read)))
        }
        ExprKind::Binary(op, a, b) => {
            let a = expr(a, read);
            Expr::binary(operator(*op), a, expr(b, read))
        }
        ExprKind::If(c, a, b) => {
            let (c, a) = (expr(c, read), expr(a, read));
            Expr::If(Box::new(c), Box::new(a), Box::new(expr(b, read)))
        }
        ExprKind::Call(f, args) => {
            let f = match f {
                model::Function::Abs => ir::expr::Function::Abs,
                model::Function::Min => ir::expr::Function::Min,
                model::Function::Max => ir::expr::Function::Max,
                model::Function::Norm => ir::expr::Function::Norm,
            };
            Expr::Call(f, args.iter().map(|a| expr(a, read)).collect())
        }
        ExprKind::List(items, rest) => {
            let items = items.iter().map(|a| expr(a, read)).collect();
            let rest = rest.as_ref().map(|r| Box::new(expr(r, read)));
            Expr::List(items, rest)
        }
        ExprKind::Element(of) => Expr::Element(Box::new(place(of, read))),
        ExprKind::Apply(function, args, _) => {
            Expr::Apply(*function, args.iter().map(|a| expr(a, read)).collect())
        }
        // INVARIANT: a scenario with errors is not lowered.
        ExprKind::Error => Expr::bool(false),
    }
}

/// Lowers a variable or an element of an array of them.
pub(crate) fn place(of: &model::Place, read: &mut dyn FnMut(Source) -> Expr) -> Place {
    let slot = match read(Source::Leaf(of.leaf)) {
        Expr::Var(slot) => slot,
        // INVARIANT: arrays are indexed at run time in automata and functions only, where leaves are variables.
        _ => u16::MAX,
    };
    let index = |i: &model::Index, at| Index { at, count: i.count, stride: i.stride };
    let indices = of.indices.iter().map(|i| index(i, expr(&i.at, read))).collect();
    Place { slot, indices }
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

pub(crate) fn locals(es: &[model::Expr]) -> Vec<Expr> {
    es.iter().map(local).collect()
}

pub(crate) fn operator(op: ast::BinaryOp) -> ir::expr::BinaryOp {
    use ir::expr::BinaryOp as To;
    match op {
        ast::BinaryOp::Add => To::Add,
        ast::BinaryOp::Sub => To::Sub,
        ast::BinaryOp::Mul => To::Mul,
        ast::BinaryOp::Div => To::Div,
        ast::BinaryOp::Rem => To::Rem,
        ast::BinaryOp::Eq => To::Eq,
        ast::BinaryOp::Ne => To::Ne,
        ast::BinaryOp::Lt => To::Lt,
        ast::BinaryOp::Le => To::Le,
        ast::BinaryOp::Gt => To::Gt,
        ast::BinaryOp::Ge => To::Ge,
        ast::BinaryOp::And => To::And,
        ast::BinaryOp::Or => To::Or,
    }
}
