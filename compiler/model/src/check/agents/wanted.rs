//! Goals that give values: a variable without a value among a goal's arguments gets one, if all plans for the goal give it.
//!
//! Which arguments are ever open is found by looking at an agent's plans until nothing more is found. In plans for a goal that
//! is called with an open argument the variables of that argument have no value at first, and must have one at the end.

use std::collections::BTreeMap;

use hrdsl_source::Diagnostic;
use hrdsl_syntax::ast::{self, CallSyntax, ExprSyntaxKind as Syntax};

use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    state::{
        names::{GoalArgument, Ungiving},
        record::DeclaredFields,
        scope::ExprEnv,
    },
    template::CheckerPhase,
    value::operands::names_in,
};
use crate::{
    GoalId, InferredType, TriggerOn, Type, TypedExprKind, TypedStep, TypedStepKind, TypedTerm, VariableRef,
    noun::Noun,
    report::{agents, types},
    types::TypeLayout,
};

/// The variables of a plan that have no value at first, each with the goal's argument that it is in.
pub(super) struct WantedVars {
    goal: GoalId,
    vars: BTreeMap<u16, usize>,
    /// The arguments to which the plan cannot give a value.
    nameless: Vec<usize>,
}

impl AgentsPhase<'_, '_> {
    /// Opens the arguments of a goal that is waited for: a variable without a value, or `_`, stands for what the goal gives. Gives
    /// the goal as it is then written, and the arguments that a plan does not give.
    pub(super) fn open_args(
        &mut self,
        scope: &AgentScope,
        goal: GoalId,
        call: &CallSyntax,
        fields: Option<&DeclaredFields>,
        env: &mut ExprEnv,
    ) -> (CallSyntax, Vec<Ungiving>) {
        let mut call = call.clone();
        let mut kept = Vec::new();
        let mut at = 0;
        for i in 0..call.args.as_ref().map_or(0, Vec::len) {
            let layout = fields.map(|f| f.get(i).map(|(_, layout)| layout.clone()));
            let (here, ty) = (at, layout.clone().flatten().and_then(scalar));
            at += layout.as_ref().map_or(1, |l| l.as_ref().map_or(0, |l| self.size(l)));
            let args = call.args.as_mut().map_or(&mut [][..], Vec::as_mut_slice);
            let Some(name) = self.open_name(args, i, env) else { continue };
            if fields.is_some() && ty.is_none() {
                continue;
            }
            let ignored = args[i].kind == Syntax::Any;
            let known = self.names.wanted.entry((scope.id.0, goal.0)).or_default().entry(here);
            let mode = known.or_insert(GoalArgument { wanted: false, ungiving: None });
            if let Some(ungiving) = &mode.ungiving {
                kept.push(Ungiving { call: args[i].span, ..ungiving.clone() });
                continue;
            }
            mode.wanted |= !ignored;
            if ignored {
                args[i].kind =
                    Syntax::Path(ast::PathSyntax { names: vec![name.clone()], span: args[i].span });
            }
            match env.find_mut(&name.text) {
                Some(local) => {
                    local.bound = true;
                    (local.ty, local.range) =
                        ty.map_or((InferredType::Unknown, None), |ty| (InferredType::of(ty), ty.range()));
                }
                None => {
                    match ty {
                        Some(ty) => env.push_typed(&name.text, name.span, Noun::Variable, ty),
                        None => env.push_local(&name.text, name.span, Noun::Variable, InferredType::Unknown),
                    };
                    self.define_here(&name, ty.map_or(InferredType::Unknown, InferredType::of));
                    if !ignored {
                        env.opened.push(name);
                    }
                }
            }
        }
        (call, kept)
    }

    /// Warns of variables that a goal gives a value to, and nothing reads: they may have been meant as others.
    pub(super) fn say_unread(&mut self, env: &ExprEnv) {
        for name in &env.opened {
            if !self.s.names.is_used(name.span) {
                let others = env.locals.iter().map(|l| l.name.as_str()).filter(|other| *other != name.text);
                self.report(agents::given_unread(&name.text, name.span, others));
            }
        }
    }

    /// The variable that an argument is, if it is open and no other argument is computed with it; for `_` a new one.
    fn open_name(&self, args: &[ast::ExprSyntax], i: usize, env: &ExprEnv) -> Option<ast::NameSyntax> {
        if args[i].kind == Syntax::Any {
            let text = format!("_{}", env.locals.len());
            return Some(ast::NameSyntax { text, span: args[i].span });
        }
        let Syntax::Path(path) = &args[i].kind else { return None };
        let [name] = path.names.as_slice() else { return None };
        let computes = |e: &ast::ExprSyntax| {
            !matches!(e.kind, Syntax::Path(_)) && names_in(e).iter().any(|n| n.text == name.text)
        };
        let open = self.is_pattern(&args[i], env) && !args.iter().any(computes);
        open.then(|| name.clone())
    }

    /// Says of arguments that are open and not given why they are not.
    pub(super) fn say_ungiven(&mut self, goal: &str, kept: Vec<Ungiving>) {
        for ungiving in kept {
            let here = |issue: &&mut Diagnostic| issue.span() == ungiving.call;
            if let Some(issue) = self.issues.list.iter_mut().rev().find(here) {
                agents::not_given(issue, goal, ungiving.argument, ungiving.plan, ungiving.reads);
            }
        }
    }

    /// In a plan for a goal: the variables of arguments that are open somewhere have no value.
    pub(super) fn open_trigger(
        &mut self,
        scope: &AgentScope,
        (on, args): (TriggerOn, &[TypedTerm]),
        trigger: &ast::TriggerSyntax,
        env: &mut ExprEnv,
    ) -> Option<WantedVars> {
        let (TriggerOn::GoalAdded(goal) | TriggerOn::GoalFailed(goal)) = on else { return None };
        let known = self.names.wanted.get(&(scope.id.0, goal.0))?;
        let open: BTreeMap<usize, bool> =
            known.iter().filter(|(_, a)| a.ungiving.is_none()).map(|(i, a)| (*i, a.wanted)).collect();
        let mut given: Vec<u16> = Vec::new();
        for (_, arg) in args.iter().enumerate().filter(|(i, _)| !open.contains_key(i)) {
            arg.each_var(&mut |var| given.push(var));
        }
        let mut vars = BTreeMap::new();
        let mut nameless = Vec::new();
        for (i, wanted) in open {
            let Some(arg) = args.get(i) else { continue };
            if wanted && has_any(arg) {
                nameless.push(i);
            }
            arg.each_var(&mut |var| {
                if !given.contains(&var) {
                    vars.entry(var).or_insert(i);
                }
            });
        }
        let mut ungiving = Vec::new();
        // What is computed in the trigger is compared before the plan can give a value.
        for arg in args {
            let TypedTerm::Expr(e) = arg else { continue };
            e.each(&mut |part| {
                if let TypedExprKind::Leaf(VariableRef::Local(var)) = part.kind {
                    ungiving.extend(vars.remove(&var));
                }
            });
        }
        for i in ungiving {
            self.ungiving(scope, goal, i, false, trigger);
        }
        self.unbound.clear();
        for var in vars.keys() {
            if let Some(local) = env.locals.get_mut(usize::from(*var)) {
                local.bound = false;
            }
        }
        Some(WantedVars { goal, vars, nameless })
    }

    /// At the end of a plan: what it read before it had a value, and what it did not give.
    pub(super) fn close_trigger(
        &mut self,
        scope: &AgentScope,
        wanted: &WantedVars,
        body: &[TypedStep],
        trigger: &ast::TriggerSyntax,
        env: &ExprEnv,
    ) {
        let fails = body.last().is_some_and(|s| matches!(s.kind, TypedStepKind::Fail));
        let params = self.s.agents[usize::from(scope.id.0)].goals[usize::from(wanted.goal.0)].params.clone();
        for i in wanted.nameless.iter().filter(|_| !fails) {
            self.ungiving(scope, wanted.goal, *i, false, trigger);
        }
        for (var, i) in &wanted.vars {
            let Some(local) = env.locals.get(usize::from(*var)) else { continue };
            let reads = self.unbound.contains(&local.name);
            let key = (scope.id.0, wanted.goal.0);
            let asked = self.names.wanted.get(&key).and_then(|all| all.get(i)).is_some_and(|a| a.wanted);
            if reads || (asked && !local.bound && !fails) {
                self.ungiving(scope, wanted.goal, *i, reads, trigger);
            } else if let Some(param) = params.as_ref().and_then(|p| p.get(*i))
                && local.bound
            {
                let (got, want): (InferredType, InferredType) = (local.ty, InferredType::of(param.ty));
                let numbers = got.is_bare() && want.is_bare();
                if !is_list(param.ty) && !numbers && got.with(want).is_none() {
                    let (want, got) = (want.to_string(), got.to_string());
                    self.report(types::other_before(&local.name, &want, &got, trigger.span));
                }
            }
        }
    }

    /// A plan does not give this argument of its goal.
    fn ungiving(
        &mut self,
        scope: &AgentScope,
        goal: GoalId,
        argument: usize,
        reads: bool,
        trigger: &ast::TriggerSyntax,
    ) {
        let known = self.names.wanted.get_mut(&(scope.id.0, goal.0)).and_then(|all| all.get_mut(&argument));
        if let Some(known) = known.filter(|a| a.ungiving.is_none()) {
            known.ungiving = Some(Ungiving { plan: trigger.span, call: trigger.span, argument, reads });
        }
    }
}

fn scalar(layout: TypeLayout) -> Option<Type> {
    if let TypeLayout::Scalar(ty) = layout { Some(ty) } else { None }
}

/// A list is matched part by part.
fn is_list(ty: Type) -> bool {
    matches!(ty, Type::List(_))
}

fn has_any(term: &TypedTerm) -> bool {
    match term {
        TypedTerm::Any => true,
        TypedTerm::Var(_) | TypedTerm::Expr(_) => false,
        TypedTerm::List(items, rest) => items.iter().chain(rest.as_deref()).any(has_any),
    }
}
