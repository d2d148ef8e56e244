//! Internal actions: their arguments, by the table.

use hrdsl_syntax::ast::{self, Call, ExprKind as Syntax};

use crate::check::{
    agents::{
        agent::Scope,
        context::{known, restore},
        internal_table::{INTERNAL_ACTIONS, InternalAction, Op},
        terms::{Due, literal_of},
    },
    checker::Checker,
    state::scope::Env,
};
use crate::{
    Arg, Context, Dim, Expr, GoalId, Internal, Kind, ListFunction, StepKind, UnaryOp,
    noun::Noun,
    report::{agents, names, types},
};

impl Checker<'_> {
    /// The row of an internal action, if it has the right number of arguments.
    fn action(&mut self, call: &Call) -> Option<&'static InternalAction> {
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
    pub(in crate::check) fn asked(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> Context {
        let action = self.action(call);
        if let Some(action) = action.filter(|a| !a.asks()) {
            self.report(agents::is_a_step(action.name, action.usage, call.span));
        }
        let args = call.args.as_deref().unwrap_or_default();
        let Some(action) = action.filter(|a| a.asks()) else {
            // Nothing is said about what it may have been meant to bind.
            let variable = |c: &Checker<'_>, name: &ast::Name| c.is_variable(&name.text);
            args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            return Context::True;
        };
        match self.question(scope, action, args, env) {
            Some(internal) => Context::Internal(Box::new(internal), call.span),
            None => Context::True,
        }
    }

    fn question(
        &mut self,
        scope: &Scope,
        action: &InternalAction,
        args: &[ast::Expr],
        env: &mut Env,
    ) -> Option<Internal> {
        let agent = Kind::Enum(self.players.agent_names);
        Some(match (action.op, args) {
            (op @ (Op::FindAll | Op::SetOf), [template, formula, out]) => {
                let before = known(env);
                let formula = self.context(scope, formula, env);
                let template = self.expr(template, env);
                restore(env, &before);
                let out = self.out(out, Kind::list(template.ty), env);
                Internal::FindAll { template, formula, set: op == Op::SetOf, out }
            }
            (Op::Count, [formula, out]) => {
                let before = known(env);
                let formula = self.context(scope, formula, env);
                restore(env, &before);
                Internal::Count { formula, out: self.out(out, Kind::Int, env) }
            }
            (Op::Member, [element, list]) => {
                let list = self.expr_of(list, Kind::list(Kind::Unknown), env);
                let element = self.out(element, list.ty.element().unwrap_or(Kind::Unknown), env);
                Internal::Member { element, list }
            }
            (Op::Apply(function), [ins @ .., out]) => {
                let (args, result) = self.function(function, ins, env)?;
                Internal::Apply { function, args, out: self.out(out, result, env) }
            }
            (Op::Holds(function), ins) => {
                let (args, _) = self.function(function, ins, env)?;
                Internal::Holds { function, args }
            }
            (op @ (Op::Intend | Op::Desire | Op::Suspended), [goal]) => {
                let (goal, args) = self.goal_term(scope, goal, env, true)?;
                match op {
                    Op::Intend => Internal::Intend { goal, args },
                    Op::Desire => Internal::Desire { goal, args },
                    _ => Internal::Suspended { goal, args },
                }
            }
            (Op::Random, [out]) => {
                Internal::Random { from: None, out: self.out(out, Kind::Float(Dim::NUMBER), env) }
            }
            (Op::Random, [list, out]) => {
                let list = self.expr_of(list, Kind::list(Kind::Unknown), env);
                let out = self.out(out, list.ty.element().unwrap_or(Kind::Unknown), env);
                Internal::Random { from: Some(list), out }
            }
            (Op::Shuffle, [list, out]) => {
                let list = self.expr_of(list, Kind::list(Kind::Unknown), env);
                let out = self.out(out, list.ty, env);
                Internal::Shuffle { list, out }
            }
            (Op::Time, [out]) => Internal::Time { out: self.out(out, Kind::Float(Dim::TIME), env) },
            (Op::MyName, [out]) => Internal::MyName { out: self.out(out, agent, env) },
            (Op::AllNames, [out]) => Internal::AllNames { out: self.out(out, Kind::list(agent), env) },
            (_, _) => return None,
        })
    }

    /// A result: a term that is matched with it.
    pub(in crate::check) fn out(&mut self, arg: &ast::Expr, kind: Kind, env: &mut Env) -> Arg {
        self.matched_arg(arg, Due::Kind(kind), env, true)
    }

    /// The arguments of a function of lists and strings, and what it yields.
    fn function(&mut self, f: ListFunction, args: &[ast::Expr], env: &mut Env) -> Option<(Vec<Expr>, Kind)> {
        use ListFunction as F;
        let list = Kind::list(Kind::Unknown);
        Some(match (f, args) {
            (F::Length | F::Reverse | F::Empty, [arg]) => {
                let arg = self.list_or_text(arg, Kind::Unknown, env);
                let result = match f {
                    F::Length => Kind::Int,
                    F::Empty => Kind::Bool,
                    _ => arg.ty,
                };
                (vec![arg], result)
            }
            (F::Sort, [arg]) => {
                let arg = self.expr_of(arg, list, env);
                let ty = arg.ty;
                (vec![arg], ty)
            }
            (F::Min | F::Max, [arg]) => {
                let arg = self.expr_of(arg, list, env);
                let element = arg.ty.element().unwrap_or(Kind::Unknown);
                (vec![arg], element)
            }
            (F::Nth, [index, arg]) => {
                let index = self.expr_of(index, Kind::Int, env);
                let arg = self.expr_of(arg, list, env);
                let element = arg.ty.element().unwrap_or(Kind::Unknown);
                (vec![index, arg], element)
            }
            (F::Delete, [x, arg]) => {
                let arg = self.expr_of(arg, list, env);
                let x = self.single(x, arg.ty.element().unwrap_or(Kind::Unknown), env);
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
                let a = self.list_or_text(a, Kind::Unknown, env);
                let b = self.list_or_text(b, a.ty, env);
                (vec![a, b], Kind::Bool)
            }
            (F::ToText, [arg]) => (vec![self.expr(arg, env)], Kind::Text),
            (F::Concat, args) => self.concat(args, env),
            (_, _) => return None,
        })
    }

    /// Lists alone make a list; with a string among them all are put into a string.
    fn concat(&mut self, args: &[ast::Expr], env: &mut Env) -> (Vec<Expr>, Kind) {
        let args: Vec<Expr> = args.iter().map(|a| self.expr(a, env)).collect();
        if args.iter().any(|a| a.ty == Kind::Text) {
            return (args, Kind::Text);
        }
        let mut ty = if args.iter().all(|a| a.ty == Kind::Unknown) {
            Kind::Unknown
        } else {
            Kind::list(Kind::Unknown)
        };
        let mut fitted = Vec::new();
        for arg in args {
            let arg = self.fit(arg, ty, env);
            ty = ty.with(arg.ty).unwrap_or(ty);
            fitted.push(arg);
        }
        (fitted, ty)
    }

    fn list_or_text(&mut self, e: &ast::Expr, like: Kind, env: &mut Env) -> Expr {
        let e = self.single(e, like, env);
        match e.ty {
            Kind::Text | Kind::List(_) | Kind::Unknown => e,
            Kind::Bool | Kind::Int | Kind::Float(_) | Kind::Enum(_) => {
                self.report(types::other_shape("a list or a string", &e.ty.to_string(), e.span));
                Expr::error(e.span)
            }
        }
    }

    /// A goal without `!`, with arguments that are matched. Without parentheses any will do.
    fn goal_term(
        &mut self,
        scope: &Scope,
        e: &ast::Expr,
        env: &mut Env,
        binds: bool,
    ) -> Option<(GoalId, Vec<Arg>)> {
        let call = self.goal_call(e)?;
        let goals = &self.agents.goals[usize::from(scope.id.0)];
        if call.args.is_none()
            && let Some((index, ..)) = goals.get_full(&call.name.text)
        {
            let arity = self.s.agents[usize::from(scope.id.0)].goals[index].arity;
            let goal = GoalId(u16::try_from(index).unwrap_or(u16::MAX));
            return Some((goal, vec![Arg::Any; usize::from(arity)]));
        }
        let goal = self.goal(scope, &call)?;
        let fields = self.goal_fields(scope.id, goal);
        Some((goal, self.matched(Noun::Goal, &call, fields.as_ref(), env, binds)))
    }

    /// The goal that an argument names.
    pub(in crate::check) fn goal_call(&mut self, e: &ast::Expr) -> Option<Call> {
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
        scope: &Scope,
        call: &Call,
        env: &mut Env,
    ) -> Option<StepKind> {
        let known_to_ask = INTERNAL_ACTIONS.iter().any(|a| a.name == call.name.text && a.asks());
        if known_to_ask {
            return Some(StepKind::Test(self.asked(scope, call, env)));
        }
        let args = call.args.as_deref().unwrap_or_default();
        let Some(action) = self.action(call) else {
            let variable = |c: &Checker<'_>, name: &ast::Name| c.is_variable(&name.text);
            args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            return None;
        };
        match (action.op, args) {
            (Op::Send, [to, how, what]) => self.send_message(scope, Some(to), how, what, env),
            (Op::Broadcast, [how, what]) => self.send_message(scope, None, how, what, env),
            (Op::Ask, [to, what, within @ ..]) => self.ask(scope, to, what, within.first(), env),
            (Op::AskAll, [to, template, what, out, within @ ..]) => {
                self.ask_all(scope, (to, template, what, out), within.first(), env)
            }
            (Op::Print, args) => {
                Some(StepKind::Print { args: args.iter().map(|a| self.expr(a, env)).collect() })
            }
            (Op::Control(what), [goal]) => {
                let goal = self.goal_term(scope, goal, env, false)?;
                Some(StepKind::Control { what, goal: Some(goal) })
            }
            (Op::Control(what), []) => Some(StepKind::Control { what, goal: None }),
            (Op::Abolish, [belief]) => self.abolish(scope, belief, env),
            (Op::Fail, []) => Some(StepKind::Fail),
            (_, _) => None,
        }
    }

    /// `.abolish(b(_))`; without parentheses all facts of the belief.
    fn abolish(&mut self, scope: &Scope, e: &ast::Expr, env: &mut Env) -> Option<StepKind> {
        let Some(mut literal) = literal_of(e) else {
            if e.kind != Syntax::Error {
                self.report(types::needs_name(Noun::Belief, e.span));
            }
            return None;
        };
        let named = self.agents.beliefs[usize::from(scope.id.0)].get(&literal.call.name.text);
        if let (None, Some(id)) = (&literal.call.args, named) {
            let fields = self.belief_fields(scope.id, crate::BeliefId(id));
            let any = |_: &_| ast::Expr { kind: Syntax::Any, span: e.span };
            literal.call.args = Some(fields.iter().map(any).collect());
        }
        Some(StepKind::Abolish(self.literal(scope, &literal, env, (false, false))?))
    }
}
