//! Expressions: types, dimensions, folding.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, BinaryOp, ExprKind as Syntax, Name, UnaryOp};

use super::{Checker, ConstState, Env, is_variable_name};
use crate::{
    Dim, Expr, ExprKind, Function, Kind, Type, Unit, Value,
    noun::Noun,
    report::{agents::unbound, automata::clock_misused, types},
    value,
};

pub(super) const FUNCTIONS: [(&str, Function); 3] =
    [("abs", Function::Abs), ("min", Function::Min), ("max", Function::Max)];

impl Checker<'_> {
    /// Resolves and types an expression, and folds it if it is constant.
    pub(super) fn expr(&mut self, e: &ast::Expr, env: &mut Env) -> Expr {
        let span = e.span;
        match &e.kind {
            Syntax::Bool(b) => Expr::value(Value::Bool(*b), Kind::Bool, span),
            Syntax::Int(n) => Expr::value(Value::Int(*n), Kind::Int, span),
            Syntax::Float(x) => Expr::value(Value::Float(*x), Kind::Float(Dim::NUMBER), span),
            Syntax::Quantity { number, unit } => self.quantity(*number, unit, span),
            Syntax::Any => {
                self.report(types::no_value("`_`", span));
                Expr::error(span)
            }
            Syntax::Path(path) => self.path(path, env),
            Syntax::Call { callee, args } => self.call(callee, args, span, env),
            Syntax::Unary { op, operand } => self.unary(*op, operand, span, env),
            Syntax::Binary { op, left, right } => self.binary(*op, left, right, span, env),
            Syntax::If { condition, then, otherwise } => {
                let condition = self.expr_of(condition, Kind::Bool, env);
                let (then, otherwise) = (self.expr(then, env), self.expr(otherwise, env));
                self.conditional(condition, then, otherwise, span, env)
            }
            Syntax::Tuple(_) => {
                self.report(types::no_value("a vector", span));
                Expr::error(span)
            }
            Syntax::Error => Expr::error(span),
        }
    }

    /// An expression that must be of this kind.
    pub(super) fn expr_of(&mut self, e: &ast::Expr, want: Kind, env: &mut Env) -> Expr {
        let e = self.expr(e, env);
        self.fit(e, want, env)
    }

    /// An expression for a parameter or variable of this type; a constant must lie in its range.
    pub(super) fn expr_for(&mut self, e: &ast::Expr, ty: Type, env: &mut Env) -> Expr {
        let e = self.expr_of(e, ty.kind(), env);
        if let (Type::Int { lo, hi }, Some(Value::Int(n))) = (ty, e.constant())
            && !(lo..=hi).contains(&n)
        {
            self.report(types::out_of_range(Value::Int(n), lo, hi, e.span));
        }
        e
    }

    /// A constant of this kind; `None` with a diagnostic otherwise.
    pub(super) fn constant(&mut self, e: &ast::Expr, want: Kind, env: &mut Env) -> Option<Value> {
        let e = self.expr_of(e, want, env);
        if e.constant().is_none() && e.ty != Kind::Unknown {
            self.report(types::not_constant(e.span));
        }
        e.constant().filter(|_| e.ty != Kind::Unknown)
    }

    /// A constant quantity, in SI units.
    pub(super) fn quantity_of(&mut self, e: &ast::Expr, dim: Dim) -> Option<f64> {
        self.constant(e, Kind::Float(dim), &mut Env::constants()).and_then(Value::number)
    }

    /// A constant time in seconds, not negative; or more than zero.
    pub(super) fn time(&mut self, e: &ast::Expr, what: &str, positive: bool) -> Option<f64> {
        let t = self.quantity_of(e, Dim::TIME)?;
        if t < 0.0 || positive && t == 0.0 {
            let rule = if positive { "more than 0 s" } else { "at least 0 s" };
            self.report(types::must_be(what, rule, e.span));
            return None;
        }
        Some(t)
    }

    /// A constant whole number of at least `lo`.
    pub(super) fn count(&mut self, e: &ast::Expr, what: &str, lo: i64) -> Option<i64> {
        let Value::Int(n) = self.constant(e, Kind::Int, &mut Env::constants())? else { return None };
        if n < lo || n > i64::from(u32::MAX) {
            self.report(types::must_be(what, &format!("at least {lo}"), e.span));
            return None;
        }
        Some(n)
    }

    /// Makes an expression fit the kind that its place needs, or says that it does not.
    pub(super) fn fit(&mut self, e: Expr, want: Kind, env: &mut Env) -> Expr {
        if e.ty == want || want == Kind::Unknown {
            return e;
        }
        match (want, e.ty) {
            (_, Kind::Unknown) => {
                self.learn(&e, want, env);
                e
            }
            (Kind::Float(Dim::NUMBER), Kind::Int) => as_float(e),
            (Kind::Bool | Kind::Int | Kind::Float(_) | Kind::Unknown, _) => {
                self.report(types::mismatch(want, e.ty, e.constant(), e.span));
                Expr::error(e.span)
            }
        }
    }

    /// A variable's kind is known from its use.
    fn learn(&mut self, e: &Expr, ty: Kind, env: &mut Env) {
        if let ExprKind::Leaf(leaf) = e.kind {
            env.refine(leaf, ty);
        }
    }

    fn quantity(&mut self, number: f64, unit: &Name, span: Span) -> Expr {
        match Unit::of(&unit.text) {
            Some(unit) => Expr::value(Value::Float(unit.to_si(number)), Kind::Float(unit.dim), span),
            None => {
                self.report(types::unknown_unit(&unit.text, unit.span));
                Expr::error(span)
            }
        }
    }

    fn path(&mut self, path: &ast::Path, env: &mut Env) -> Expr {
        let [name] = path.names.as_slice() else { return self.dotted(path, env) };
        if let Some(local) = env.find(&name.text) {
            return match local.leaf {
                Some(leaf) if local.bound => {
                    Expr { kind: ExprKind::Leaf(leaf), ty: local.ty, span: path.span }
                }
                Some(_) => self.without_value(name, env),
                None => {
                    self.report(clock_misused(&name.text, name.span));
                    Expr::error(path.span)
                }
            };
        }
        if let Some(constant) = self.consts.get_mut(name.text.as_str()) {
            constant.used = true;
            return self.const_value(name);
        }
        if let Some(e) = self.signal_named(name, env) {
            return e;
        }
        self.without_value(name, env)
    }

    /// A name that has no value here.
    fn without_value(&mut self, name: &Name, env: &Env) -> Expr {
        let mut names: Vec<String> = env.locals.iter().filter(|l| l.bound).map(|l| l.name.clone()).collect();
        names.extend(self.consts.keys().map(|k| (*k).to_owned()));
        names.extend(self.signal_names(env));
        if env.plan && is_variable_name(&name.text) {
            self.report(unbound(&name.text, name.span, names.iter().map(String::as_str)));
        } else {
            self.unknown(env.noun.unwrap_or(Noun::Constant), name, &names, None);
        }
        Expr::error(name.span)
    }

    /// The value of a constant, worked out at its first use.
    fn const_value(&mut self, name: &Name) -> Expr {
        let Some(entry) = self.consts.get_mut(name.text.as_str()) else { return Expr::error(name.span) };
        match std::mem::replace(&mut entry.state, ConstState::Open) {
            ConstState::Done(e) => {
                let here = Expr { span: name.span, ..e.clone() };
                entry.state = ConstState::Done(e);
                here
            }
            ConstState::Open => {
                let declared = entry.name.span;
                self.report(types::constant_cycle(&name.text, name.span, declared));
                Expr::error(name.span)
            }
            ConstState::Unseen => {
                let value = entry.value;
                let mut e = self.expr(value, &mut Env::constants());
                if e.constant().is_none() {
                    e = Expr::error(e.span);
                }
                if let Some(entry) = self.consts.get_mut(name.text.as_str()) {
                    entry.state = ConstState::Done(e.clone());
                }
                Expr { span: name.span, ..e }
            }
        }
    }

    /// Works out all constants, so that each fault in one is found.
    pub(super) fn all_consts(&mut self) {
        let names: Vec<Name> = self.consts.values().map(|c| c.name.clone()).collect();
        for name in names {
            self.const_value(&name);
        }
    }

    fn call(&mut self, callee: &ast::Path, args: &[ast::Expr], span: Span, env: &mut Env) -> Expr {
        let name = &callee.names[0];
        let plain = FUNCTIONS.iter().find(|(n, _)| *n == name.text && callee.names.len() == 1);
        let Some((text, f)) = plain else { return self.measured(callee, args, span, env) };
        let want = if *f == Function::Abs { 1 } else { 2 };
        let args: Vec<Expr> = args.iter().map(|a| self.expr(a, env)).collect();
        if args.len() != want {
            self.report(types::counts(Noun::Function, text, want, args.len(), span));
            return Expr::error(span);
        }
        for arg in &args {
            if arg.ty == Kind::Bool {
                self.report(types::mismatch(Kind::Float(Dim::NUMBER), arg.ty, None, arg.span));
                return Expr::error(span);
            }
        }
        let Some(ty) = args.iter().skip(1).try_fold(args[0].ty, |ty, a| {
            self.same(text, (ty, args[0].span, args[0].constant()), (a.ty, a.span, a.constant()))
        }) else {
            return Expr::error(span);
        };
        let values: Option<Vec<Value>> = args.iter().map(Expr::constant).collect();
        let folded = values.map(|v| value::call(*f, &v));
        self.folded(folded, Expr { kind: ExprKind::Call(*f, args), ty, span })
    }

    fn unary(&mut self, op: UnaryOp, operand: &ast::Expr, span: Span, env: &mut Env) -> Expr {
        let operand = match op {
            UnaryOp::Not => self.expr_of(operand, Kind::Bool, env),
            UnaryOp::Neg => self.expr(operand, env),
        };
        if op == UnaryOp::Neg && operand.ty == Kind::Bool {
            self.report(types::mismatch(Kind::Float(Dim::NUMBER), operand.ty, None, operand.span));
            return Expr::error(span);
        }
        let ty = if op == UnaryOp::Not { Kind::Bool } else { operand.ty };
        let folded = operand.constant().map(|v| value::unary(op, v));
        self.folded(folded, Expr { kind: ExprKind::Unary(op, Box::new(operand)), ty, span })
    }

    fn binary(&mut self, op: BinaryOp, l: &ast::Expr, r: &ast::Expr, span: Span, env: &mut Env) -> Expr {
        let logical = matches!(op, BinaryOp::And | BinaryOp::Or);
        let mut side = |c: &mut Self, e| if logical { c.expr_of(e, Kind::Bool, env) } else { c.expr(e, env) };
        let (l, r) = (side(self, l), side(self, r));
        if l.ty == Kind::Unknown && r.ty != Kind::Unknown && !logical {
            self.learn(&l, r.ty, env);
        } else if r.ty == Kind::Unknown && !logical {
            self.learn(&r, l.ty, env);
        }
        let ty = if logical { Some(Kind::Bool) } else { self.result(op, &l, &r) };
        let Some(ty) = ty else { return Expr::error(span) };
        let folded = l.constant().zip(r.constant()).map(|(a, b)| value::binary(op, a, b));
        self.folded(folded, Expr { kind: ExprKind::Binary(op, Box::new(l), Box::new(r)), ty, span })
    }

    /// What an operator yields on these operands.
    fn result(&mut self, op: BinaryOp, l: &Expr, r: &Expr) -> Option<Kind> {
        let (left, right) = ((l.ty, l.span, l.constant()), (r.ty, r.span, r.constant()));
        match op {
            BinaryOp::And | BinaryOp::Or => Some(Kind::Bool),
            BinaryOp::Eq | BinaryOp::Ne => {
                if l.ty == Kind::Bool && r.ty == Kind::Bool {
                    return Some(Kind::Bool);
                }
                self.same(symbol(op), left, right).map(|_| Kind::Bool)
            }
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                self.numbers(op, l, r)?;
                self.same(symbol(op), left, right).map(|_| Kind::Bool)
            }
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Rem => {
                self.numbers(op, l, r)?;
                self.same(symbol(op), left, right)
            }
            BinaryOp::Mul | BinaryOp::Div => {
                self.numbers(op, l, r)?;
                Some(match (l.ty, r.ty) {
                    (Kind::Int, Kind::Int) => Kind::Int,
                    (Kind::Unknown, _) | (_, Kind::Unknown) => Kind::Unknown,
                    (a, b) => {
                        let (a, b) = (a.dim().unwrap_or_default(), b.dim().unwrap_or_default());
                        Kind::Float(if op == BinaryOp::Mul { a.times(b) } else { a.per(b) })
                    }
                })
            }
        }
    }

    fn numbers(&mut self, op: BinaryOp, l: &Expr, r: &Expr) -> Option<()> {
        if l.ty == Kind::Bool || r.ty == Kind::Bool {
            self.report(types::operands(symbol(op), (l.ty, l.span), (r.ty, r.span)));
            return None;
        }
        Some(())
    }

    /// The kind of two operands that must be alike.
    fn same(
        &mut self,
        op: &str,
        l: (Kind, Span, Option<Value>),
        r: (Kind, Span, Option<Value>),
    ) -> Option<Kind> {
        match (l.0, r.0) {
            (Kind::Unknown, other) | (other, Kind::Unknown) => Some(other),
            (a, b) if a == b => Some(a),
            (Kind::Bool, _) | (_, Kind::Bool) => {
                self.report(types::operands(op, (l.0, l.1), (r.0, r.1)));
                None
            }
            (a, b) if a.dim() == b.dim() => Some(Kind::Float(Dim::NUMBER)),
            (a, Kind::Float(dim)) if a.is_bare() => {
                self.report(types::bare_number(dim, l.2, l.1));
                None
            }
            (Kind::Float(dim), b) if b.is_bare() => {
                self.report(types::bare_number(dim, r.2, r.1));
                None
            }
            (Kind::Int | Kind::Float(_), Kind::Int | Kind::Float(_)) => {
                self.report(types::dimensions(op, (l.0, l.1), (r.0, r.1)));
                None
            }
        }
    }

    pub(super) fn conditional(
        &mut self,
        condition: Expr,
        then: Expr,
        otherwise: Expr,
        span: Span,
        env: &mut Env,
    ) -> Expr {
        let sides =
            ((then.ty, then.span, then.constant()), (otherwise.ty, otherwise.span, otherwise.constant()));
        let Some(ty) = self.same("if", sides.0, sides.1) else { return Expr::error(span) };
        let (then, otherwise) = (self.fit(then, ty, env), self.fit(otherwise, ty, env));
        if let Some(Value::Bool(b)) = condition.constant() {
            return Expr { span, ..if b { then } else { otherwise } };
        }
        Expr { kind: ExprKind::If(Box::new(condition), Box::new(then), Box::new(otherwise)), ty, span }
    }

    /// The constant, if the operands were.
    fn folded(&mut self, value: Option<Result<Value, value::FoldError>>, e: Expr) -> Expr {
        match value {
            None => e,
            Some(Ok(value)) => Expr::value(value, e.ty, e.span),
            Some(Err(error)) => {
                self.report(types::fold(error, e.span));
                Expr::error(e.span)
            }
        }
    }
}

/// A whole number where a float is due.
fn as_float(e: Expr) -> Expr {
    let (ty, span) = (Kind::Float(Dim::NUMBER), e.span);
    match e.constant().and_then(Value::number) {
        Some(x) => Expr::value(Value::Float(x), ty, span),
        None => {
            let one = Expr::value(Value::Float(1.0), ty, span);
            Expr { kind: ExprKind::Binary(BinaryOp::Mul, Box::new(e), Box::new(one)), ty, span }
        }
    }
}

/// The operator as it is written.
fn symbol(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Rem => "%",
        BinaryOp::Eq => "==",
        BinaryOp::Ne => "!=",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
        BinaryOp::And => "&&",
        BinaryOp::Or => "||",
    }
}
