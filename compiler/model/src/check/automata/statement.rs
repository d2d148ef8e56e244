//! The statements of functions.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, AccessSyntax, NameSyntax, StatementSyntaxKind as Syntax};

use crate::check::{
    automata::phase::AutomataPhase,
    state::scope::ExprEnv,
    template::CheckerPhase,
    value::{element::type_of, range},
};
use crate::{
    AutomatonVar, BinaryOp, InferredType, Type, TypedExpr, TypedExprKind, TypedLvalue, TypedStatement, Value,
    VariableRef, noun::Noun, report::functions, types::TypeLayout, types::starting_var,
};

/// The range of a loop's variable where nothing is known of its ends.
const WIDE: (i64, i64) = (-(1 << 31), (1 << 31) - 1);

/// The function whose statements are being checked.
pub(in crate::check) struct FunctionBody<'n> {
    name: &'n str,
    /// As in [`Callable`](Callable).
    result: Option<Option<Type>>,
    /// INVARIANT: the locals of the environment are the parameters, then these.
    pub locals: Vec<(AutomatonVar, Span)>,
    /// The places of the variables of loops.
    loops: Vec<u16>,
    /// A statement may be executed more than once.
    again: bool,
}

impl<'n> FunctionBody<'n> {
    pub fn new(name: &'n str, result: Option<Option<Type>>) -> Self {
        Self { name, result, locals: Vec::new(), loops: Vec::new(), again: false }
    }
}

/// Whether some statement could not be read.
pub(in crate::check) fn unread(statements: &[ast::StatementSyntax]) -> bool {
    statements.iter().any(|s| match &s.kind {
        Syntax::Error => true,
        Syntax::If { then, otherwise, .. } => unread(then) || unread(otherwise),
        Syntax::While { body, .. } | Syntax::For { body, .. } => unread(body),
        Syntax::Var(_) | Syntax::Assign { .. } | Syntax::Call(_) | Syntax::Return(_) => false,
    })
}

/// Whether no way leads past the end of these statements.
pub(in crate::check) fn returns(statements: &[TypedStatement]) -> bool {
    statements.iter().any(|s| match s {
        TypedStatement::Return(_) => true,
        TypedStatement::If { then, otherwise, .. } => returns(then) && returns(otherwise),
        TypedStatement::While { condition, .. } => condition.constant() == Some(Value::Bool(true)),
        TypedStatement::Assign { .. } | TypedStatement::Call { .. } | TypedStatement::For { .. } => false,
    })
}

impl AutomataPhase<'_, '_> {
    /// What is declared in a block is known to its end.
    pub(in crate::check) fn block(
        &mut self,
        statements: &[ast::StatementSyntax],
        env: &mut ExprEnv,
        body: &mut FunctionBody<'_>,
    ) -> Vec<TypedStatement> {
        let (locals, layouts) = (env.locals.len(), env.layouts.len());
        let mut out = Vec::new();
        for statement in statements {
            self.statement(statement, env, body, &mut out);
        }
        env.locals[locals..].iter_mut().for_each(|l| l.name.clear());
        env.layouts.truncate(layouts);
        out
    }

    fn statement(
        &mut self,
        statement: &ast::StatementSyntax,
        env: &mut ExprEnv,
        body: &mut FunctionBody<'_>,
        out: &mut Vec<TypedStatement>,
    ) {
        match &statement.kind {
            Syntax::Var(var) => self.local_var(var, env, body, out),
            Syntax::Assign { target, access, op, value } => {
                self.assign_in_function((target, access), *op, value, env, body, out);
            }
            Syntax::Call(call) => match self.called_function(call, env) {
                Some((id, args)) => out.push(TypedStatement::Call { function: id, args }),
                None if env.function(&call.name.text).is_some() => {}
                None => self.no_such_statement(call, env),
            },
            Syntax::If { condition, then, otherwise } => {
                let condition = self.expr_of(condition, InferredType::Bool, env);
                let then = self.block(then, env, body);
                let otherwise = self.block(otherwise, env, body);
                out.push(TypedStatement::If { condition, then, otherwise });
            }
            Syntax::While { condition, body: inner } => {
                let condition = self.expr_of(condition, InferredType::Bool, env);
                let again = std::mem::replace(&mut body.again, true);
                let inner = self.block(inner, env, body);
                body.again = again;
                out.push(TypedStatement::While { condition, body: inner });
            }
            Syntax::For { name, range, body: inner } => {
                out.extend(self.for_loop(name, range, inner, env, body));
            }
            Syntax::Return(value) => {
                let value = self.returned(value.as_ref(), statement, env, body);
                out.push(TypedStatement::Return(value));
            }
            Syntax::Error => {}
        }
    }

    /// `var i: 0..5 = 0`
    fn local_var(
        &mut self,
        var: &ast::VarSyntax,
        env: &mut ExprEnv,
        body: &mut FunctionBody<'_>,
        out: &mut Vec<TypedStatement>,
    ) {
        let span = var.name.span;
        let layout = self.layout(&var.ty).filter(|l| {
            self.plain(l, &var.name.text, span) && self.finite_layout(l, "a variable of a function", span)
        });
        let layout = layout.unwrap_or(TypeLayout::Unknown);
        let mut values = Vec::new();
        if let Some(e) = &var.init {
            match &layout {
                TypeLayout::Unknown => drop(self.item(e, env)),
                TypeLayout::Scalar(_) | TypeLayout::Record(_) | TypeLayout::Array(..) => {
                    self.item_for(e, &layout, env).flatten(&mut values);
                }
            }
        }
        let mut leaves = Vec::new();
        self.leaves(&var.name.text, &layout, &mut leaves);
        let first = env.next_local();
        self.add_local(env, &var.name, Noun::Variable, &layout);
        let given = values.len() == leaves.len();
        let mut values = values.into_iter();
        for ((name, ty), i) in leaves.into_iter().zip(first..) {
            let init = crate::check::value::variable::nearest_to_zero(ty);
            body.locals.push((starting_var(&name, ty, init), span));
            let value = values.next().filter(|_| given);
            // In a loop it starts anew each time.
            let again = body.again.then(|| TypedExpr::value(init, InferredType::of(ty), span));
            if let Some(value) = value.or(again) {
                out.push(TypedStatement::Assign { place: TypedLvalue::slot(VariableRef::Local(i)), value });
            }
        }
    }

    /// `queue[len] = e`
    fn assign_in_function(
        &mut self,
        (target, access): (&NameSyntax, &[AccessSyntax]),
        op: Option<BinaryOp>,
        value: &ast::ExprSyntax,
        env: &mut ExprEnv,
        body: &FunctionBody<'_>,
        out: &mut Vec<TypedStatement>,
    ) {
        let found = env.find(&target.text).map(|l| (l.leaf, l.ty, type_of(l)));
        let layout = match found {
            Some((None, ..)) => {
                self.report(functions::clock(&target.text, target.span));
                return;
            }
            Some((Some(VariableRef::Local(i)), ..)) if body.loops.contains(&i) => {
                self.report(functions::loop_variable(&target.text, target.span));
                return;
            }
            Some((Some(_), InferredType::Unknown, _)) => TypeLayout::Unknown,
            Some((Some(_), _, ty)) => TypeLayout::Scalar(ty),
            None => match env.layout(&target.text) {
                Some(layout) => layout.clone(),
                None => {
                    let single = env.all().filter(|l| l.leaf.is_some()).map(|l| l.name.as_str());
                    let single = single.filter(|n| !n.is_empty() && !n.contains(['.', '[']));
                    let all: Vec<String> = single.chain(env.layout_names()).map(str::to_owned).collect();
                    self.unknown(Noun::Variable, target, &all, None);
                    TypeLayout::Unknown
                }
            },
        };
        if layout == TypeLayout::Unknown {
            self.item(value, env);
            return;
        }
        let assigned = self.assigned(target, (layout, access), op, value, env);
        out.extend(assigned.into_iter().map(|(place, value)| TypedStatement::Assign { place, value }));
    }

    /// A call of what is no function.
    fn no_such_statement(&mut self, call: &ast::CallSyntax, env: &mut ExprEnv) {
        let name = &call.name;
        call.args.iter().flatten().for_each(|a| drop(self.item(a, env)));
        match self.kind_of(&name.text) {
            Some(is @ (Noun::Event | Noun::Stimulus)) => {
                self.report(functions::event(&name.text, is, name.span));
            }
            Some(_) | None => {
                let all: Vec<String> = env.function_names().map(str::to_owned).collect();
                let local = env.find(&name.text).map(|l| l.noun);
                self.unknown(Noun::Function, name, &all, local);
            }
        }
    }

    /// `for i in lo..hi { … }`
    fn for_loop(
        &mut self,
        name: &NameSyntax,
        range: &ast::RangeSyntax,
        inner: &[ast::StatementSyntax],
        env: &mut ExprEnv,
        body: &mut FunctionBody<'_>,
    ) -> Option<TypedStatement> {
        let lo = self.expr_of(&range.lo, InferredType::Int, env);
        let hi = range.hi.as_ref().map(|hi| self.expr_of(hi, InferredType::Int, env));
        if hi.is_none() {
            self.report(functions::open_range(range.span));
        }
        let ends = |e: Option<&TypedExpr>| e.and_then(|e| range::of(e, env)).unwrap_or(WIDE);
        let (least, most) = (ends(Some(&lo)).0, ends(hi.as_ref()).1);
        let ty = Type::Int { lo: least, hi: most.max(least) };
        let local = env.next_local();
        self.check_free(env, Noun::Variable, name);
        env.push_typed(&name.text, name.span, Noun::Variable, ty);
        body.locals.push((starting_var(&name.text, ty, Value::Int(least)), name.span));
        body.loops.push(local);
        let again = std::mem::replace(&mut body.again, true);
        let inner = self.block(inner, env, body);
        body.again = again;
        if let Some(l) = env.locals.get_mut(usize::from(local)) {
            l.name.clear();
        }
        Some(TypedStatement::For { slot: VariableRef::Local(local), lo, hi: hi?, body: inner })
    }

    /// `return e`
    fn returned(
        &mut self,
        value: Option<&ast::ExprSyntax>,
        statement: &ast::StatementSyntax,
        env: &mut ExprEnv,
        body: &FunctionBody<'_>,
    ) -> Option<TypedExpr> {
        match (value, body.result) {
            (None, None) => None,
            (None, Some(_)) => {
                self.report(functions::returns_nothing(body.name, statement.span));
                None
            }
            (Some(e), None) => {
                self.item(e, env);
                self.report(functions::returns_something(body.name, e.span));
                None
            }
            (Some(e), Some(Some(ty))) => Some(self.expr_for(e, ty, env)),
            (Some(e), Some(None)) => {
                self.item(e, env);
                Some(TypedExpr { kind: TypedExprKind::Error, ty: InferredType::Unknown, span: e.span })
            }
        }
    }
}
