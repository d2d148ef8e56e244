//! Expressions: types, dimensions, folding.

use hrdsl_source::{Enumeration, Span, Symbol};
use hrdsl_syntax::ast::{self, BinaryOp, ExprSyntaxKind as Syntax, NameSyntax, UnaryOp};

use crate::check::{
    checker::Checker,
    state::{
        item::ExprItem,
        scope::{ExprEnv, is_variable_name},
    },
};
use crate::{
    Dimension, EvalError, InferredType, NumberFunction, Text, Type, TypedExpr, TypedExprKind, UnitOfMeasure,
    Value,
    noun::Noun,
    report::{names, types},
};

pub(in crate::check) const FUNCTIONS: [(&str, NumberFunction); 4] = [
    ("abs", NumberFunction::Abs),
    ("min", NumberFunction::Min),
    ("max", NumberFunction::Max),
    ("norm", NumberFunction::Norm),
];

impl<'a> Checker<'a> {
    /// Resolves and types an expression of one value, and folds it if it is constant.
    pub(in crate::check) fn expr(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> TypedExpr {
        let item = self.item(e, env);
        self.one(item)
    }

    fn one(&mut self, item: ExprItem) -> TypedExpr {
        if let ExprItem::One(e) = item {
            return e;
        }
        let got = self.shown(&item);
        self.report(types::several_values(&got, item.span()));
        TypedExpr::error(item.span())
    }

    /// Resolves and types an expression of one or more values.
    pub(in crate::check) fn item(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> ExprItem {
        let span = e.span;
        ExprItem::One(match &e.kind {
            Syntax::Bool(b) => TypedExpr::value(Value::Bool(*b), InferredType::Bool, span),
            Syntax::Int(n) => TypedExpr::value(Value::Int(*n), InferredType::Int, span),
            Syntax::Float(x) => {
                TypedExpr::value(Value::Float(*x), InferredType::Float(Dimension::NUMBER), span)
            }
            Syntax::Quantity { number, unit } => self.quantity(*number, unit, span),
            Syntax::Any => {
                self.report(types::no_value("`_`", span));
                TypedExpr::error(span)
            }
            Syntax::Path(path) => return self.path(path, env),
            Syntax::Call { callee, args } => return self.call(callee, args, span, env),
            Syntax::Unary { op, operand } => return self.unary(*op, operand, span, env),
            Syntax::Binary { op, left, right } => return self.binary(*op, left, right, span, env),
            Syntax::If { condition, then, otherwise } => {
                let condition = self.expr_of(condition, InferredType::Bool, env);
                let (then, otherwise) = self.sides(then, otherwise, env);
                return self.either_item(&condition, then, otherwise, span, env);
            }
            Syntax::Tuple(parts) => {
                return self.tuple(parts, span, env);
            }
            Syntax::Index { of, index } => {
                return match self.element(e, env) {
                    Some(item) => item,
                    None => self.index(of, index, span, env),
                };
            }
            Syntax::Field { of, name } => {
                if let Some(item) = self.element(e, env) {
                    return item;
                }
                let item = self.item(of, env);
                return self.field(item, name);
            }
            Syntax::Text(text) => TypedExpr::value(Value::Text(Text::new(text)), InferredType::Text, span),
            Syntax::List { items, rest } => {
                self.list(items, rest.as_deref(), InferredType::Unknown, span, env)
            }
            Syntax::Unify { .. } | Syntax::Strong(_) | Syntax::Annotated { .. } | Syntax::Internal(_) => {
                self.no_value_here(e, env);
                TypedExpr::error(span)
            }
            Syntax::Error => TypedExpr::error(span),
        })
    }

    /// A value of an enumeration by its bare name, where one of this enumeration is due.
    fn symbol_of(&mut self, e: &ast::ExprSyntax, of: Enumeration) -> Option<TypedExpr> {
        let Syntax::Path(path) = &e.kind else { return None };
        let [name] = path.names.as_slice() else { return None };
        if self.given(&name.text).is_some() {
            return None;
        }
        let symbol = of.symbol(&name.text)?;
        self.refer_value(of, name);
        Some(symbol_value(of, symbol, e.span))
    }

    /// An expression that must be of this kind.
    pub(in crate::check) fn expr_of(
        &mut self,
        e: &ast::ExprSyntax,
        want: InferredType,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let item = self.item_due(e, want, env);
        let e = self.one(item);
        self.fit(e, want, env)
    }

    /// An expression where a value of this kind is due, which may be written by its bare name.
    pub(in crate::check) fn item_due(
        &mut self,
        e: &ast::ExprSyntax,
        want: InferredType,
        env: &mut ExprEnv,
    ) -> ExprItem {
        if let (InferredType::List(of), Syntax::List { items, rest }) = (want, &e.kind) {
            return ExprItem::One(self.list(items, rest.as_deref(), of.element(), e.span, env));
        }
        let InferredType::Enum(of) = want else { return self.item(e, env) };
        if let Some(symbol) = self.symbol_of(e, of) {
            return ExprItem::One(symbol);
        }
        if let Syntax::If { condition, then, otherwise } = &e.kind
            && self.needs_due(e)
        {
            let condition = self.expr_of(condition, InferredType::Bool, env);
            let then = self.expr_of(then, want, env);
            let otherwise = self.expr_of(otherwise, want, env);
            return ExprItem::One(self.conditional(condition, then, otherwise, e.span, env));
        }
        if let Syntax::Path(path) = &e.kind
            && let [name] = path.names.as_slice()
            && self.means_nothing(name, env)
        {
            self.unknown_value(name, of, env);
            return ExprItem::error(e.span);
        }
        self.item(e, env)
    }

    /// A name that is none of the enumeration's values, and nothing else either.
    fn unknown_value(&mut self, name: &NameSyntax, of: Enumeration, env: &ExprEnv) {
        let values = of.values().iter().map(|v| v.name());
        let others = self.names_with_value(env);
        // Another name is offered only if it is near.
        let all = values.clone().chain(others.iter().map(String::as_str));
        let issue = match hrdsl_source::nearest(&name.text, all) {
            Some(near) => names::unknown(Noun::EnumValue, &name.text, name.span, [near]),
            None => names::unknown(Noun::EnumValue, &name.text, name.span, values),
        };
        if !self.source.unread_items {
            self.report(issue);
        }
    }

    /// A name that nothing has which expressions speak of: another one was meant.
    fn means_nothing(&self, name: &NameSyntax, env: &ExprEnv) -> bool {
        let local = env.find(&name.text).is_some() || env.layout(&name.text).is_some();
        let signal = env
            .world
            .as_ref()
            .is_some_and(|prefix| self.world.names.kind_of(&format!("{prefix}{}", name.text)).is_some());
        let variable = env.plan && is_variable_name(&name.text);
        !local && !signal && !variable && !self.has_value(&name.text) && !self.is_spoken_of(&name.text)
    }

    /// An expression for a parameter or variable of this type; a constant must lie in its range.
    pub(in crate::check) fn expr_for(
        &mut self,
        e: &ast::ExprSyntax,
        ty: Type,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let e = self.expr_of(e, InferredType::of(ty), env);
        self.in_range(&e, ty);
        e
    }

    /// A constant must lie in the range of its type.
    pub(in crate::check) fn in_range(&mut self, e: &TypedExpr, ty: Type) {
        if let Some(value) = e.constant() {
            self.value_in_range(value, ty, e.span);
        }
    }

    fn value_in_range(&mut self, value: Value, ty: Type, span: Span) {
        match (ty, value) {
            (Type::Int { lo, hi }, Value::Int(n)) if !(lo..=hi).contains(&n) => {
                self.report(types::out_of_range(value, lo, hi, span));
            }
            (Type::List(of), Value::List(list)) => {
                list.iter().for_each(|v| self.value_in_range(v, of.element(), span));
            }
            (_, _) => {}
        }
    }

    /// Makes an expression fit the kind that its place needs, or says that it does not.
    pub(in crate::check) fn fit(&mut self, e: TypedExpr, want: InferredType, env: &mut ExprEnv) -> TypedExpr {
        if e.ty == want || want == InferredType::Unknown {
            return e;
        }
        match (want, e.ty) {
            (_, InferredType::Unknown) => {
                self.learn(&e, want, env);
                e
            }
            (InferredType::Float(Dimension::NUMBER), InferredType::Int) => as_float(e),
            (InferredType::List(_), InferredType::List(_)) if want.with(e.ty).is_some() => {
                self.learn(&e, want, env);
                e
            }
            (
                InferredType::Bool
                | InferredType::Int
                | InferredType::Float(_)
                | InferredType::Enum(_)
                | InferredType::Text
                | InferredType::List(_)
                | InferredType::Unknown,
                _,
            ) => {
                self.report(types::mismatch(want, e.ty, e.constant(), e.span));
                TypedExpr::error(e.span)
            }
        }
    }

    /// A variable's kind is known from its use.
    fn learn(&mut self, e: &TypedExpr, ty: InferredType, env: &mut ExprEnv) {
        if let TypedExprKind::Leaf(leaf) = e.kind {
            env.refine(leaf, ty);
        }
    }

    fn quantity(&mut self, number: f64, unit: &NameSyntax, span: Span) -> TypedExpr {
        match UnitOfMeasure::of(&unit.text) {
            Some(unit) => {
                let si = Ok(Value::Float(unit.to_si(number)));
                self.folded(
                    Some(si),
                    TypedExpr::value(Value::Float(0.0), InferredType::Float(unit.dim), span),
                )
            }
            None => {
                self.report(types::unknown_unit(&unit.text, unit.span));
                TypedExpr::error(span)
            }
        }
    }

    fn call(
        &mut self,
        callee: &ast::PathSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        let name = &callee.names[0];
        // One of an automaton has its name before it, in a query.
        let whole = callee.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".");
        let whole = NameSyntax { text: whole, ..name.clone() };
        if let Some(value) = self.applied_function(&whole, args, span, env) {
            return ExprItem::One(value);
        }
        if let ([_], Some(id)) = (callee.names.as_slice(), self.types.record_names.get(&name.text)) {
            self.refer(name, self.types.record_names.span(id));
            return self.record(id, name, args, span, env);
        }
        let plain = FUNCTIONS.iter().find(|(n, _)| *n == name.text && callee.names.len() == 1);
        let Some((text, f)) = plain else { return ExprItem::One(self.measured(callee, args, span, env)) };
        if *f == NumberFunction::Norm {
            return ExprItem::One(self.norm(args, span, env));
        }
        let want = if *f == NumberFunction::Abs { 1 } else { 2 };
        let args: Vec<TypedExpr> = args.iter().map(|a| self.expr(a, env)).collect();
        if args.len() != want {
            self.report(types::counts(Noun::Function, text, want, args.len(), span));
            return ExprItem::error(span);
        }
        for arg in &args {
            if !arg.ty.is_number() {
                let want = InferredType::Float(Dimension::NUMBER);
                self.report(types::mismatch(want, arg.ty, None, arg.span));
                return ExprItem::error(span);
            }
        }
        let Some(ty) = args.iter().skip(1).try_fold(args[0].ty, |ty, a| {
            self.same(text, (ty, args[0].span, args[0].constant()), (a.ty, a.span, a.constant()))
        }) else {
            return ExprItem::error(span);
        };
        ExprItem::One(self.applied(*f, args, ty, span))
    }

    /// `Pose(1 m, 2 m)`
    fn record(
        &mut self,
        id: u16,
        name: &NameSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        let Some(fields) = self.record_fields(id, name) else { return ExprItem::error(span) };
        if args.len() != fields.len() {
            let names: Vec<&str> = fields.iter().map(|(n, _)| n.as_str()).collect();
            let issue = types::counts(Noun::Record, &name.text, fields.len(), args.len(), span);
            self.report(issue.help(format!("write `{}({})`", name.text, names.join(", "))));
            return ExprItem::error(span);
        }
        let parts =
            args.iter().zip(fields.iter()).map(|(a, (_, layout))| self.item_for(a, layout, env)).collect();
        ExprItem::Record(id, parts, span)
    }

    pub(in crate::check) fn applied(
        &mut self,
        f: NumberFunction,
        args: Vec<TypedExpr>,
        ty: InferredType,
        span: Span,
    ) -> TypedExpr {
        let values: Option<Vec<Value>> = args.iter().map(TypedExpr::constant).collect();
        let folded = values.map(|v| hrdsl_ir::expr::call(f, &v));
        self.folded(folded, TypedExpr { kind: TypedExprKind::Call(f, args), ty, span })
    }

    fn unary(&mut self, op: UnaryOp, operand: &ast::ExprSyntax, span: Span, env: &mut ExprEnv) -> ExprItem {
        let operand = match op {
            UnaryOp::Not => ExprItem::One(self.expr_of(operand, InferredType::Bool, env)),
            UnaryOp::Neg => self.item(operand, env),
        };
        self.unary_item(op, operand, span)
    }

    fn unary_item(&mut self, op: UnaryOp, operand: ExprItem, span: Span) -> ExprItem {
        let operand = match operand {
            ExprItem::One(operand) => operand,
            ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                return ExprItem::Array(
                    parts.into_iter().map(|p| self.unary_item(op, p, span)).collect(),
                    span,
                );
            }
            ExprItem::Record(..) => {
                let got = self.shown(&operand);
                let issue = types::other_shape("a number", &got, operand.span());
                self.report(issue.help("a record has no negative: name a part of it"));
                return ExprItem::error(span);
            }
        };
        if op == UnaryOp::Neg && !operand.ty.is_number() {
            let want = InferredType::Float(Dimension::NUMBER);
            self.report(types::mismatch(want, operand.ty, None, operand.span));
            return ExprItem::error(span);
        }
        let ty = if op == UnaryOp::Not { InferredType::Bool } else { operand.ty };
        let folded = operand.constant().map(|v| hrdsl_ir::expr::unary(op, v));
        ExprItem::One(
            self.folded(folded, TypedExpr { kind: TypedExprKind::Unary(op, Box::new(operand)), ty, span }),
        )
    }

    fn binary(
        &mut self,
        op: BinaryOp,
        l: &ast::ExprSyntax,
        r: &ast::ExprSyntax,
        span: Span,
        env: &mut ExprEnv,
    ) -> ExprItem {
        if matches!(op, BinaryOp::And | BinaryOp::Or) {
            let (l, r) = (self.expr_of(l, InferredType::Bool, env), self.expr_of(r, InferredType::Bool, env));
            return ExprItem::One(self.operate(op, l, r, span, env));
        }
        let (l, r) = self.sides(l, r, env);
        match (l, r) {
            (ExprItem::One(l), ExprItem::One(r)) => ExprItem::One(self.operate(op, l, r, span, env)),
            (l, r) => self.combine(op, l, r, span, env),
        }
    }

    /// Both operands; bare names of an enumeration's values are of the other side's enumeration.
    fn sides(&mut self, l: &ast::ExprSyntax, r: &ast::ExprSyntax, env: &mut ExprEnv) -> (ExprItem, ExprItem) {
        if !self.types.values.is_empty() && self.needs_due(l) && !self.needs_due(r) {
            let right = self.item(r, env);
            return (self.item_like(l, &right, env), right);
        }
        let left = self.item(l, env);
        let right = self.item_like(r, &left, env);
        (left, right)
    }

    /// An operator on single values.
    pub(in crate::check) fn operate(
        &mut self,
        op: BinaryOp,
        l: TypedExpr,
        r: TypedExpr,
        span: Span,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let logical = matches!(op, BinaryOp::And | BinaryOp::Or);
        // What is multiplied with a quantity need not be one.
        let scaled = matches!(op, BinaryOp::Mul | BinaryOp::Div);
        let quantity = |ty: InferredType| matches!(ty, InferredType::Float(dim) if dim != Dimension::NUMBER);
        let tells = |ty: InferredType| !logical && (!scaled || !quantity(ty));
        if l.ty == InferredType::Unknown && r.ty != InferredType::Unknown && tells(r.ty) {
            self.learn(&l, r.ty, env);
        } else if r.ty == InferredType::Unknown && tells(l.ty) {
            self.learn(&r, l.ty, env);
        }
        if !logical && (l.kind == TypedExprKind::Error || r.kind == TypedExprKind::Error) {
            // One of them has a diagnostic; nothing follows from the other.
            return TypedExpr::error(span);
        }
        let ty = if logical { Some(InferredType::Bool) } else { self.result(op, &l, &r) };
        let Some(ty) = ty else { return TypedExpr::error(span) };
        let folded = l.constant().zip(r.constant()).map(|(a, b)| hrdsl_ir::expr::binary(op, a, b));
        self.folded(folded, TypedExpr { kind: TypedExprKind::Binary(op, Box::new(l), Box::new(r)), ty, span })
    }

    /// What an operator yields on these operands.
    fn result(&mut self, op: BinaryOp, l: &TypedExpr, r: &TypedExpr) -> Option<InferredType> {
        let (left, right) = ((l.ty, l.span, l.constant()), (r.ty, r.span, r.constant()));
        match op {
            BinaryOp::And | BinaryOp::Or => Some(InferredType::Bool),
            BinaryOp::Eq | BinaryOp::Ne => {
                if !l.ty.is_number() && l.ty.with(r.ty).is_some() {
                    return Some(InferredType::Bool);
                }
                self.same(symbol(op), left, right).map(|_| InferredType::Bool)
            }
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                self.numbers(op, l, r)?;
                self.same(symbol(op), left, right).map(|_| InferredType::Bool)
            }
            BinaryOp::Add | BinaryOp::Sub | BinaryOp::Rem => {
                self.numbers(op, l, r)?;
                self.same(symbol(op), left, right)
            }
            BinaryOp::Mul | BinaryOp::Div => {
                self.numbers(op, l, r)?;
                Some(match (l.ty, r.ty) {
                    (InferredType::Int, InferredType::Int) => InferredType::Int,
                    (InferredType::Unknown, _) | (_, InferredType::Unknown) => InferredType::Unknown,
                    (a, b) => {
                        let (a, b) = (a.dim().unwrap_or_default(), b.dim().unwrap_or_default());
                        InferredType::Float(if op == BinaryOp::Mul { a.times(b) } else { a.per(b) })
                    }
                })
            }
        }
    }

    fn numbers(&mut self, op: BinaryOp, l: &TypedExpr, r: &TypedExpr) -> Option<()> {
        if !l.ty.is_number() || !r.ty.is_number() {
            self.report(types::operands(symbol(op), (l.ty, l.span), (r.ty, r.span)));
            return None;
        }
        Some(())
    }

    /// The kind of two operands that must be alike.
    fn same(
        &mut self,
        op: &str,
        l: (InferredType, Span, Option<Value>),
        r: (InferredType, Span, Option<Value>),
    ) -> Option<InferredType> {
        match (l.0, r.0) {
            (InferredType::Unknown, other) | (other, InferredType::Unknown) => Some(other),
            (a, b) if a == b => Some(a),
            (InferredType::List(_), InferredType::List(_)) if l.0.with(r.0).is_some() => l.0.with(r.0),
            (InferredType::Bool | InferredType::Enum(_) | InferredType::Text | InferredType::List(_), _)
            | (_, InferredType::Bool | InferredType::Enum(_) | InferredType::Text | InferredType::List(_)) => {
                self.report(types::operands(op, (l.0, l.1), (r.0, r.1)));
                None
            }
            (a, b) if a.dim() == b.dim() => Some(InferredType::Float(Dimension::NUMBER)),
            (a, InferredType::Float(dim)) if a.is_bare() => {
                self.report(types::bare_number(dim, l.2, l.1));
                None
            }
            (InferredType::Float(dim), b) if b.is_bare() => {
                self.report(types::bare_number(dim, r.2, r.1));
                None
            }
            (InferredType::Int | InferredType::Float(_), InferredType::Int | InferredType::Float(_)) => {
                self.report(types::dimensions(op, (l.0, l.1), (r.0, r.1)));
                None
            }
        }
    }

    pub(in crate::check) fn conditional(
        &mut self,
        condition: TypedExpr,
        then: TypedExpr,
        otherwise: TypedExpr,
        span: Span,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        if then.kind == TypedExprKind::Error || otherwise.kind == TypedExprKind::Error {
            return TypedExpr::error(span);
        }
        let sides =
            ((then.ty, then.span, then.constant()), (otherwise.ty, otherwise.span, otherwise.constant()));
        let Some(ty) = self.same("if", sides.0, sides.1) else { return TypedExpr::error(span) };
        let (then, otherwise) = (self.fit(then, ty, env), self.fit(otherwise, ty, env));
        if let Some(Value::Bool(b)) = condition.constant() {
            return TypedExpr { span, ..if b { then } else { otherwise } };
        }
        TypedExpr {
            kind: TypedExprKind::If(Box::new(condition), Box::new(then), Box::new(otherwise)),
            ty,
            span,
        }
    }

    /// The constant, if the operands were.
    fn folded(&mut self, value: Option<Result<Value, EvalError>>, e: TypedExpr) -> TypedExpr {
        match value {
            None => e,
            Some(Ok(Value::Float(x))) if !x.is_finite() => {
                self.report(types::fold(EvalError::Overflow, e.span));
                TypedExpr::error(e.span)
            }
            Some(Ok(value)) => TypedExpr::value(value, e.ty, e.span),
            Some(Err(error)) => {
                self.report(types::fold(error, e.span));
                TypedExpr::error(e.span)
            }
        }
    }
}

pub(in crate::check) fn symbol_value(of: Enumeration, symbol: Symbol, span: Span) -> TypedExpr {
    TypedExpr::value(Value::Symbol(symbol), InferredType::Enum(of), span)
}

/// A whole number where a float is due.
fn as_float(e: TypedExpr) -> TypedExpr {
    let (ty, span) = (InferredType::Float(Dimension::NUMBER), e.span);
    match e.constant().and_then(Value::as_f64) {
        Some(x) => TypedExpr::value(Value::Float(x), ty, span),
        None => {
            let one = TypedExpr::value(Value::Float(1.0), ty, span);
            TypedExpr { kind: TypedExprKind::Binary(BinaryOp::Mul, Box::new(e), Box::new(one)), ty, span }
        }
    }
}

/// The operator as it is written.
pub(in crate::check) fn symbol(op: BinaryOp) -> &'static str {
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
