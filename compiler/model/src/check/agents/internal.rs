//! Internal actions: their arguments, by the table.

use hrdsl_ir::real::RealFunction;
use hrdsl_syntax::ast::{self, CallSyntax, ExprSyntaxKind as Syntax};

use crate::check::{
    agents::{
        agent::AgentScope,
        context::{known, restore},
        internal_table::{INTERNAL_ACTIONS, InternalAction, InternalOp},
        phase::AgentsPhase,
        terms::{TermMode, literal_of},
    },
    checker::Checker,
    state::scope::ExprEnv,
    template::CheckerPhase,
};
use crate::{
    Dimension, GoalId, InferredType, ListFunction, TypedContext, TypedExpr, TypedInternalAct, TypedStepKind,
    TypedTerm, UnaryOp,
    noun::Noun,
    report::{agents, names, types},
};

impl AgentsPhase<'_, '_> {
    /// The row of an internal action, if it has the right number of arguments.
    fn action(&mut self, call: &CallSyntax) -> Option<&'static InternalAction> {
        let name = &call.name;
        let Some(action) = INTERNAL_ACTIONS.iter().find(|a| a.name == name.text) else {
            let all = INTERNAL_ACTIONS.iter().map(|a| a.name);
            self.report(names::unknown(Noun::InternalAction, &name.text, name.span, all));
            return None;
        };
        let got = call.args.as_ref().map_or(0, Vec::len);
        let (least, most) = action.arity;
        if got < least || got > most {
            let want = if got < least { least } else { most };
            let issue = types::counts(Noun::InternalAction, action.name, want, got, call.span);
            self.report(issue.help(format!("write `{}`: {}", action.usage, action.help)));
            return None;
        }
        Some(action)
    }

    /// An internal action in a formula.
    pub(in crate::check) fn asked(
        &mut self,
        scope: &AgentScope,
        call: &CallSyntax,
        env: &mut ExprEnv,
    ) -> TypedContext {
        let action = self.action(call);
        if let Some(action) = action.filter(|a| !a.asks()) {
            self.report(agents::is_a_step(action.name, action.usage, call.span));
        }
        let args = call.args.as_deref().unwrap_or_default();
        let Some(action) = action.filter(|a| a.asks()) else {
            // Nothing is said about what it may have been meant to bind.
            let variable = |c: &Checker<'_>, name: &ast::NameSyntax| c.is_variable(&name.text);
            args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            return TypedContext::True;
        };
        match self.question(scope, action, args, env) {
            Some(internal) => TypedContext::Internal(Box::new(internal), call.span),
            None => TypedContext::True,
        }
    }

    fn question(
        &mut self,
        scope: &AgentScope,
        action: &InternalAction,
        args: &[ast::ExprSyntax],
        env: &mut ExprEnv,
    ) -> Option<TypedInternalAct> {
        let agent = InferredType::Enum(self.players.agent_names);
        Some(match (action.op, args) {
            (op @ (InternalOp::FindAll | InternalOp::SetOf), [template, formula, out]) => {
                let before = known(env);
                let formula = self.context(scope, formula, env);
                let template = self.expr(template, env);
                restore(env, &before);
                let out = self.out(out, InferredType::list(template.ty), env);
                TypedInternalAct::FindAll { template, formula, set: op == InternalOp::SetOf, out }
            }
            (InternalOp::Count, [formula, out]) => {
                let before = known(env);
                let formula = self.context(scope, formula, env);
                restore(env, &before);
                TypedInternalAct::Count { formula, out: self.out(out, InferredType::Int, env) }
            }
            (InternalOp::Member, [element, list]) => {
                let list = self.expr_of(list, InferredType::list(InferredType::Unknown), env);
                let element = self.out(element, list.ty.element().unwrap_or(InferredType::Unknown), env);
                TypedInternalAct::Member { element, list }
            }
            (InternalOp::Apply(function), [ins @ .., out]) => {
                let (args, result) = self.function(function, ins, env)?;
                TypedInternalAct::Apply { function, args, out: self.out(out, result, env) }
            }
            (InternalOp::Holds(function), ins) => {
                let (args, _) = self.function(function, ins, env)?;
                TypedInternalAct::Holds { function, args }
            }
            (op @ (InternalOp::Intend | InternalOp::Desire | InternalOp::Suspended), [goal]) => {
                self.of_goal(scope, op, goal, env)?
            }
            (InternalOp::Random, [out]) => TypedInternalAct::Random {
                from: None,
                out: self.out(out, InferredType::Float(Dimension::NUMBER), env),
            },
            (InternalOp::Random, [list, out]) => {
                let list = self.expr_of(list, InferredType::list(InferredType::Unknown), env);
                let out = self.out(out, list.ty.element().unwrap_or(InferredType::Unknown), env);
                TypedInternalAct::Random { from: Some(list), out }
            }
            (InternalOp::Shuffle, [list, out]) => {
                let list = self.expr_of(list, InferredType::list(InferredType::Unknown), env);
                let out = self.out(out, list.ty, env);
                TypedInternalAct::Shuffle { list, out }
            }
            (InternalOp::Time, [out]) => {
                TypedInternalAct::Time { out: self.out(out, InferredType::Float(Dimension::TIME), env) }
            }
            (InternalOp::MyName, [out]) => TypedInternalAct::MyName { out: self.out(out, agent, env) },
            (InternalOp::AllNames, [out]) => {
                TypedInternalAct::AllNames { out: self.out(out, InferredType::list(agent), env) }
            }
            (_, _) => return None,
        })
    }

    /// What is asked of a goal: whether it is suspended, if nothing else.
    fn of_goal(
        &mut self,
        scope: &AgentScope,
        op: InternalOp,
        goal: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedInternalAct> {
        let (goal, args) = self.goal_term(scope, goal, env, true)?;
        Some(if op == InternalOp::Intend {
            TypedInternalAct::Intend { goal, args }
        } else if op == InternalOp::Desire {
            TypedInternalAct::Desire { goal, args }
        } else {
            TypedInternalAct::Suspended { goal, args }
        })
    }

    /// A result: a term that is matched with it.
    pub(in crate::check) fn out(
        &mut self,
        arg: &ast::ExprSyntax,
        kind: InferredType,
        env: &mut ExprEnv,
    ) -> TypedTerm {
        self.matched_arg(arg, TermMode::Kind(kind), env, true)
    }

    /// The arguments of a function of lists and strings, and what it yields.
    fn function(
        &mut self,
        f: ListFunction,
        args: &[ast::ExprSyntax],
        env: &mut ExprEnv,
    ) -> Option<(Vec<TypedExpr>, InferredType)> {
        use ListFunction as F;
        let list = InferredType::list(InferredType::Unknown);
        Some(match (f, args) {
            (F::Length, [arg]) => {
                (vec![self.list_or_text(arg, InferredType::Unknown, env)], InferredType::Int)
            }
            (F::Empty, [arg]) => {
                (vec![self.list_or_text(arg, InferredType::Unknown, env)], InferredType::Bool)
            }
            (F::Reverse, [arg]) => {
                let arg = self.list_or_text(arg, InferredType::Unknown, env);
                let result = arg.ty;
                (vec![arg], result)
            }
            (F::Sort, [arg]) => {
                let arg = self.expr_of(arg, list, env);
                let ty = arg.ty;
                (vec![arg], ty)
            }
            (F::Min | F::Max, [arg]) => {
                let arg = self.expr_of(arg, list, env);
                let element = arg.ty.element().unwrap_or(InferredType::Unknown);
                (vec![arg], element)
            }
            (F::Nth, [index, arg]) => {
                let index = self.expr_of(index, InferredType::Int, env);
                let arg = self.expr_of(arg, list, env);
                let element = arg.ty.element().unwrap_or(InferredType::Unknown);
                (vec![index, arg], element)
            }
            (F::Delete, [x, arg]) => {
                let arg = self.expr_of(arg, list, env);
                let x = self.single(x, arg.ty.element().unwrap_or(InferredType::Unknown), env);
                let ty = arg.ty;
                (vec![x, arg], ty)
            }
            (F::Union | F::Intersection | F::Difference, [a, b]) => {
                let a = self.expr_of(a, list, env);
                let b = self.expr_of(b, a.ty, env);
                let ty = a.ty.with(b.ty).unwrap_or(a.ty);
                (vec![a, b], ty)
            }
            (F::Prefix | F::Suffix | F::Sublist, [a, b]) => {
                let a = self.list_or_text(a, InferredType::Unknown, env);
                let b = self.list_or_text(b, a.ty, env);
                (vec![a, b], InferredType::Bool)
            }
            (F::Occurrences | F::Slice, args) => self.of_places(args, env)?,
            (F::Real(f), args) => self.of_numbers(f, args, env),
            (F::ToText, [arg]) => (vec![self.expr(arg, env)], InferredType::Text),
            (F::Concat, args) => self.concat(args, env),
            (_, _) => return None,
        })
    }

    /// Lists alone make a list; with a string among them all are put into a string.
    fn concat(&mut self, args: &[ast::ExprSyntax], env: &mut ExprEnv) -> (Vec<TypedExpr>, InferredType) {
        let args: Vec<TypedExpr> = args.iter().map(|a| self.expr(a, env)).collect();
        if args.iter().any(|a| a.ty == InferredType::Text) {
            return (args, InferredType::Text);
        }
        let mut ty = if args.iter().all(|a| a.ty == InferredType::Unknown) {
            InferredType::Unknown
        } else {
            InferredType::list(InferredType::Unknown)
        };
        let mut fitted = Vec::new();
        for arg in args {
            let arg = self.fit(arg, ty, env);
            ty = ty.with(arg.ty).unwrap_or(ty);
            fitted.push(arg);
        }
        (fitted, ty)
    }

    /// Places of one list or string in another, or the part between two places.
    fn of_places(
        &mut self,
        args: &[ast::ExprSyntax],
        env: &mut ExprEnv,
    ) -> Option<(Vec<TypedExpr>, InferredType)> {
        match args {
            [a, b] => {
                let a = self.list_or_text(a, InferredType::Unknown, env);
                let b = self.list_or_text(b, a.ty, env);
                Some((vec![a, b], InferredType::list(InferredType::Int)))
            }
            [of, from, to] => {
                let of = self.list_or_text(of, InferredType::Unknown, env);
                let (from, to) =
                    (self.expr_of(from, InferredType::Int, env), self.expr_of(to, InferredType::Int, env));
                let ty = of.ty;
                Some((vec![of, from, to], ty))
            }
            _ => None,
        }
    }

    fn of_numbers(
        &mut self,
        f: RealFunction,
        args: &[ast::ExprSyntax],
        env: &mut ExprEnv,
    ) -> (Vec<TypedExpr>, InferredType) {
        let number = InferredType::Float(Dimension::NUMBER);
        let args: Vec<TypedExpr> = if f.is_of_list() {
            args.iter().map(|a| self.list_of_numbers(a, env)).collect()
        } else {
            args.iter().map(|a| self.number_of(a, env)).collect()
        };
        let sum = args.first().and_then(|a| a.ty.element()).filter(|_| f == RealFunction::Sum);
        let result = if f.is_whole() { InferredType::Int } else { sum.unwrap_or(number) };
        (args, result)
    }

    /// A number without a dimension, whole or not.
    fn number_of(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> TypedExpr {
        let e = self.single(e, InferredType::Unknown, env);
        if is_number(e.ty) {
            return e;
        }
        self.report(types::other_shape("a number", &e.ty.to_string(), e.span));
        TypedExpr::error(e.span)
    }

    fn list_of_numbers(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> TypedExpr {
        let list = self.expr_of(e, InferredType::list(InferredType::Unknown), env);
        if list.ty.element().is_none_or(is_number) {
            return list;
        }
        self.report(types::other_shape("a list of numbers", &list.ty.to_string(), list.span));
        TypedExpr::error(list.span)
    }

    fn list_or_text(&mut self, e: &ast::ExprSyntax, like: InferredType, env: &mut ExprEnv) -> TypedExpr {
        let e = self.single(e, like, env);
        match e.ty {
            InferredType::Text | InferredType::List(_) | InferredType::Unknown => e,
            InferredType::Bool | InferredType::Int | InferredType::Float(_) | InferredType::Enum(_) => {
                self.report(types::other_shape("a list or a string", &e.ty.to_string(), e.span));
                TypedExpr::error(e.span)
            }
        }
    }

    /// A goal without `!`, with arguments that are matched. Without parentheses any will do.
    fn goal_term(
        &mut self,
        scope: &AgentScope,
        e: &ast::ExprSyntax,
        env: &mut ExprEnv,
        binds: bool,
    ) -> Option<(GoalId, Vec<TypedTerm>)> {
        let call = self.goal_call(e)?;
        let goals = &self.names.goals[usize::from(scope.id.0)];
        if call.args.is_none()
            && let Some((index, ..)) = goals.get_full(&call.name.text)
        {
            let arity = self.s.agents[usize::from(scope.id.0)].goals[index].arity;
            let goal = GoalId(u16::try_from(index).unwrap_or(u16::MAX));
            return Some((goal, vec![TypedTerm::Any; usize::from(arity)]));
        }
        let goal = self.goal(scope, &call)?;
        let fields = self.goal_fields(scope.id, goal);
        Some((goal, self.matched(Noun::Goal, &call, fields.as_ref(), env, binds)))
    }

    /// The goal that an argument names.
    pub(in crate::check) fn goal_call(&mut self, e: &ast::ExprSyntax) -> Option<CallSyntax> {
        if let Syntax::Unary { op: UnaryOp::Not, .. } = &e.kind {
            let help = "a goal is written without `!` here";
            self.report(agents::no_formula("a negation", e.span, help));
            return None;
        }
        match literal_of(e) {
            Some(literal) => {
                self.not_negated(&literal, "a goal");
                if let Some(first) = literal.annotations.first() {
                    self.report(agents::not_annotated("a goal that is named", first.span));
                }
                Some(literal.call).filter(|_| !literal.negated)
            }
            None => {
                if e.kind != Syntax::Error {
                    self.report(types::needs_name(Noun::Goal, e.span));
                }
                None
            }
        }
    }

    // ── steps ──

    pub(in crate::check) fn internal_step(
        &mut self,
        scope: &AgentScope,
        call: &CallSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        let known_to_ask = INTERNAL_ACTIONS.iter().any(|a| a.name == call.name.text && a.asks());
        if known_to_ask {
            return Some(TypedStepKind::Test(self.asked(scope, call, env)));
        }
        let args = call.args.as_deref().unwrap_or_default();
        let Some(action) = self.action(call) else {
            let variable = |c: &Checker<'_>, name: &ast::NameSyntax| c.is_variable(&name.text);
            args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            return None;
        };
        match (action.op, args) {
            (InternalOp::Send, [to, how, what]) => self.send_message(scope, Some(to), how, what, env),
            (InternalOp::Broadcast, [how, what]) => self.send_message(scope, None, how, what, env),
            (InternalOp::Ask, [to, what, within @ ..]) => self.ask(scope, to, what, within.first(), env),
            (InternalOp::AskAll, [to, template, what, out, within @ ..]) => {
                self.ask_all(scope, (to, template, what, out), within.first(), env)
            }
            (InternalOp::Print, args) => {
                Some(TypedStepKind::Print { args: args.iter().map(|a| self.expr(a, env)).collect() })
            }
            (InternalOp::Control(what), [goal]) => {
                let goal = self.goal_term(scope, goal, env, false)?;
                Some(TypedStepKind::Control { what, goal: Some(goal) })
            }
            (InternalOp::Control(what), []) => Some(TypedStepKind::Control { what, goal: None }),
            (InternalOp::Abolish, [belief]) => self.abolish(scope, belief, env),
            (InternalOp::Fail, []) => Some(TypedStepKind::Fail),
            (_, _) => None,
        }
    }

    /// `.abolish(b(_))`; without parentheses all facts of the belief.
    fn abolish(
        &mut self,
        scope: &AgentScope,
        e: &ast::ExprSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        let Some(mut literal) = literal_of(e) else {
            if e.kind != Syntax::Error {
                self.report(types::needs_name(Noun::Belief, e.span));
            }
            return None;
        };
        let named = self.names.beliefs[usize::from(scope.id.0)].get(&literal.call.name.text);
        if let (None, Some(id)) = (&literal.call.args, named) {
            let fields = self.belief_fields(scope.id, crate::BeliefId(id));
            let any = |_: &_| ast::ExprSyntax { kind: Syntax::Any, span: e.span };
            literal.call.args = Some(fields.iter().map(any).collect());
        }
        Some(TypedStepKind::Abolish(self.literal(scope, &literal, env, (false, false))?))
    }
}

/// Whether it is a number without a dimension, or may be one.
fn is_number(ty: InferredType) -> bool {
    match ty {
        InferredType::Int | InferredType::Unknown => true,
        InferredType::Float(dimension) => dimension == Dimension::NUMBER,
        InferredType::Bool | InferredType::Enum(_) | InferredType::Text | InferredType::List(_) => false,
    }
}
