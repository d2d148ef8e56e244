//! Functions of automata: their names and types, their calls, and what they read and assign.

use std::{collections::BTreeSet, rc::Rc};

use hrdsl_ir::known_name;
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, AutomatonMemberKind as Member, CallSyntax, ItemSyntaxKind, NameSyntax};

use crate::check::{
    automata::{phase::AutomataPhase, statement, statement::FunctionBody},
    state::{
        issues::too_many,
        scope::{CallableFunction, ExprEnv, IndexedArrays},
        table::MAX_NAMES,
    },
    template::CheckerPhase,
    value::expr::FUNCTIONS,
};
use crate::{
    AutomatonId, FunctionEffects, FunctionId, FunctionPlaces, InferredType, Type, TypedExpr, TypedFunction,
    TypedStatement, TypedUpdate, VariableRef, leaves,
    noun::Noun,
    report::{functions, names},
    types::{TypeLayout, finite_var},
};

impl AutomataPhase<'_, '_> {
    /// The functions of the scenario.
    pub(in crate::check) fn shared_functions(&mut self) {
        let start = self.s.functions.len();
        let mut bodies = Vec::new();
        for (item, span) in self.each_item() {
            let ItemSyntaxKind::Function(function) = item else { continue };
            let env = ExprEnv { shared: self.shared.scope.clone(), ..ExprEnv::default() };
            let callable = self.declare_function(function, None, &env, span);
            // Nobody else holds the scope now: it grows without a copy.
            drop(env);
            if let Some(callable) = callable {
                bodies.push((callable.id, function));
                Rc::make_mut(&mut self.shared.scope).functions.insert(function.name.text.clone(), callable);
            }
        }
        let env = ExprEnv { shared: self.shared.scope.clone(), ..ExprEnv::default() };
        self.functions_of(start, bodies, &env);
    }

    /// The functions of an automaton.
    pub(in crate::check) fn own_functions(
        &mut self,
        index: usize,
        automaton: &ast::AutomatonSyntax,
        env: &mut ExprEnv,
    ) {
        let start = self.s.functions.len();
        let owner = u16::try_from(index).ok().map(AutomatonId);
        let mut bodies = Vec::new();
        for member in &automaton.members {
            let Member::Function(function) = &member.kind else { continue };
            if let Some(callable) = self.declare_function(function, owner, env, member.span) {
                bodies.push((callable.id, function));
                Rc::make_mut(&mut env.own).functions.insert(function.name.text.clone(), callable);
            }
        }
        self.functions_of(start, bodies, env);
    }

    /// The bodies of functions that know each other, and what follows from all of them.
    fn functions_of(&mut self, start: usize, bodies: Vec<(FunctionId, &ast::FunctionSyntax)>, env: &ExprEnv) {
        for (id, function) in bodies {
            let env = ExprEnv {
                noun: Some(Noun::Variable),
                elements: IndexedArrays::Locals,
                effects: true,
                ..env.clone()
            };
            self.shared.functions.open = Some(id);
            self.function_body(id, function, env);
            self.shared.functions.open = None;
        }
        self.reach_of_functions(start);
        self.say_impure();
    }

    // ── names and types ──

    fn declare_function(
        &mut self,
        function: &ast::FunctionSyntax,
        owner: Option<AutomatonId>,
        env: &ExprEnv,
        span: Span,
    ) -> Option<CallableFunction> {
        let name = &function.name;
        let params = self.function_params(function);
        let result = function.result.as_ref().map(|ty| {
            let ty = self.ty(ty);
            ty.filter(|ty| self.finite(*ty, "the value of a function", name.span))
        });
        if !self.free_function(name, env) {
            return None;
        }
        let Ok(id) = u16::try_from(self.s.functions.len()) else { return None };
        if usize::from(id) >= MAX_NAMES {
            self.report(too_many(format!("there are more than {id} functions"), name.span));
            return None;
        }
        let typed = |(name, layout): &(String, TypeLayout)| {
            finite_var(name, if let TypeLayout::Scalar(ty) = layout { *ty } else { Type::Bool })
        };
        self.s.functions.push(TypedFunction {
            name: name.text.clone(),
            owner,
            params: params.iter().map(typed).collect(),
            locals: Vec::new(),
            result: result.map(|ty| finite_var(&name.text, ty.unwrap_or(Type::Bool))),
            pure: true,
            body: Vec::new(),
            origin: span,
        });
        self.s.effects.push(FunctionEffects::default());
        self.s.places.functions.push(FunctionPlaces { name: name.span, locals: Vec::new() });
        Some(CallableFunction { id: FunctionId(id), params: params.into(), result, span: name.span })
    }

    fn function_params(&mut self, function: &ast::FunctionSyntax) -> Vec<(String, TypeLayout)> {
        let mut params: Vec<(String, TypeLayout)> = Vec::new();
        for param in &function.params {
            let name = &param.name;
            let ty = self.ty(&param.ty).filter(|ty| self.finite(*ty, "a parameter of a function", name.span));
            params.push((name.text.clone(), ty.map_or(TypeLayout::Unknown, TypeLayout::Scalar)));
        }
        params
    }

    /// Nothing that is called or read like it has the name.
    fn free_function(&mut self, name: &NameSyntax, env: &ExprEnv) -> bool {
        let said = self.issues.list.len();
        let text = name.text.as_str();
        if FUNCTIONS.iter().any(|(built_in, _)| *built_in == text) {
            self.report(functions::built_in(text, name.span));
        } else if let Some(first) = env.function(text) {
            let first = Some(first.span);
            self.report(names::duplicate(Noun::Function, text, name.span, first));
        } else {
            match self.kind_of(text) {
                // These are called in places of their own.
                Some(Noun::Actor | Noun::Agent | Noun::Automaton | Noun::Template) | None => {
                    self.check_free(env, Noun::Function, name);
                }
                Some(apart) if apart.is_apart() => self.check_free(env, Noun::Function, name),
                Some(noun @ (Noun::Constant | Noun::Parameter | Noun::EnumValue | Noun::Variable)) => {
                    let before = self.issues.list.len();
                    self.check_free(env, Noun::Function, name);
                    if self.issues.list.len() == before {
                        self.report(names::duplicate(noun, text, name.span, None));
                    }
                }
                Some(noun) => {
                    let first =
                        self.events.table.span_of(text).or_else(|| self.types.record_names.span_of(text));
                    self.report(names::duplicate(noun, text, name.span, first));
                }
            }
        }
        self.issues.list.len() == said
    }

    fn function_body(&mut self, id: FunctionId, function: &ast::FunctionSyntax, mut env: ExprEnv) {
        let callable = env.function(&function.name.text).cloned();
        for (param, (_, layout)) in function.params.iter().zip(callable.iter().flat_map(|c| c.params.iter()))
        {
            match layout {
                TypeLayout::Scalar(_) => self.add_local(&mut env, &param.name, Noun::Parameter, layout),
                TypeLayout::Unknown | TypeLayout::Record(_) | TypeLayout::Array(..) => {
                    // Its place among the locals stays.
                    let (name, kind) = (&param.name, InferredType::Unknown);
                    env.push_local(&name.text, name.span, Noun::Parameter, kind);
                }
            }
        }
        let mut body = FunctionBody::new(&function.name.text, callable.and_then(|c| c.result));
        let broken = statement::unread(&function.body);
        let unread = self.source.unread_members;
        self.source.unread_members |= broken;
        let statements = self.block(&function.body, &mut env, &mut body);
        self.source.unread_members = unread;
        if function.result.is_some() && !statement::returns(&statements) && !broken {
            self.report(functions::ends_without_value(&function.name.text, function.name.span));
        }
        let variables = self.s.shared.len() + env.own.names.len();
        if variables + env.locals.len() > MAX_NAMES {
            let message = format!("`{}` sees more than {} variables", function.name.text, MAX_NAMES);
            self.report(too_many(message, function.name.span));
        }
        let routine = &mut self.s.functions[usize::from(id.0)];
        let (locals, places) = body.locals.into_iter().unzip();
        routine.locals = locals;
        routine.body = statements;
        self.s.places.functions[usize::from(id.0)].locals = places;
    }

    // ── calls ──

    /// An action of an edge that is not a sending; says so of one that was meant to be one.
    pub(in crate::check) fn calls_function(
        &mut self,
        call: &CallSyntax,
        env: &mut ExprEnv,
        updates: &mut Vec<TypedUpdate>,
    ) -> bool {
        let text = call.name.text.as_str();
        if env.function(text).is_none() {
            let known =
                self.given(text).is_some() || self.kind_of(text).is_some() || self.source.unread_items;
            let meant = (!known).then(|| hrdsl_source::nearest(text, env.function_names())).flatten();
            if self.source.unread_members && self.kind_of(text).is_none() {
                // It may be a function that could not be read.
                return true;
            }
            // Short names are near to all others.
            let Some(near) = meant.filter(|near| near.len() > 2) else { return false };
            if hrdsl_source::nearest(text, self.events.table.names()).is_some() {
                return false;
            }
            let issue = names::unknown(Noun::Function, text, call.name.span, [near]);
            self.report(issue);
            return true;
        }
        env.effects = true;
        let called = self.called_function(call, env);
        env.effects = false;
        updates.extend(called.map(|(id, args)| TypedUpdate::Call { function: id, args }));
        true
    }

    // ── what follows from bodies and calls ──

    /// What the functions from `start` on read and assign, with what they call; says so of recursion.
    fn reach_of_functions(&mut self, start: usize) {
        let end = self.s.functions.len();
        for id in self.in_order_of_calls(start, end) {
            let (mut reads, mut assigns) = direct(&self.s.functions[id]);
            for (called, _) in self.calls_of(id) {
                let of = &self.s.effects[usize::from(called.0)];
                reads.extend(of.reads.iter().copied().map(OrderedLeaf));
                assigns.extend(of.assigns.iter().copied().map(OrderedLeaf));
            }
            self.s.functions[id].pure = assigns.is_empty();
            self.s.effects[id] = FunctionEffects {
                reads: reads.into_iter().map(|l| l.0).collect(),
                assigns: assigns.into_iter().map(|l| l.0).collect(),
            };
        }
        self.shared.functions.calls.clear();
    }

    fn calls_of(&self, id: usize) -> Vec<(FunctionId, Span)> {
        let id = u16::try_from(id).unwrap_or(u16::MAX);
        self.shared.functions.calls.get(&id).cloned().unwrap_or_default()
    }

    /// Each function after those that it calls, without recursion: a chain of calls may be long.
    fn in_order_of_calls(&mut self, start: usize, end: usize) -> Vec<usize> {
        let mut order = Vec::new();
        let mut state = vec![0u8; end - start];
        let mut cycles = Vec::new();
        for first in start..end {
            if state[first - start] != 0 {
                continue;
            }
            state[first - start] = 1;
            let mut open = vec![(first, self.calls_of(first))];
            while let Some((id, left)) = open.last_mut() {
                let id = *id;
                let Some((called, span)) = left.pop() else {
                    state[id - start] = 2;
                    order.push(id);
                    open.pop();
                    continue;
                };
                let called = usize::from(called.0);
                // The functions of the scenario are known already when those of an automaton are looked at.
                match called.checked_sub(start).map(|c| state[c]) {
                    Some(0) => {
                        state[called - start] = 1;
                        let calls = self.calls_of(called);
                        open.push((called, calls));
                    }
                    Some(1) => {
                        let from = open.iter().position(|(id, _)| *id == called).unwrap_or(0);
                        let ring = open[from..].iter().map(|(id, _)| *id).chain([called]);
                        cycles.push((ring.collect::<Vec<usize>>(), span));
                    }
                    Some(_) | None => {}
                }
            }
        }
        for (ring, span) in cycles {
            let names: Vec<&str> = ring.iter().map(|id| self.s.functions[*id].name.as_str()).collect();
            let issue = functions::recursion(&names, span);
            self.report(issue);
        }
        order
    }

    /// Says so of functions that change something where a value is only looked at.
    pub(in crate::check) fn say_impure(&mut self) {
        for (id, span) in std::mem::take(&mut self.shared.functions.only_read) {
            let id = usize::from(id.0);
            let (Some(routine), Some(effects)) = (self.s.functions.get(id), self.s.effects.get(id)) else {
                continue;
            };
            let Some(first) = effects.assigns.first() else { continue };
            let var = match (first, routine.owner) {
                (VariableRef::Own(i), Some(owner)) => {
                    self.s.automata.get(usize::from(owner.0)).and_then(|a| a.vars.get(usize::from(*i)))
                }
                (VariableRef::Shared(i), _) => self.s.shared.get(usize::from(*i)),
                (VariableRef::Own(_) | VariableRef::Local(_) | VariableRef::Signal(_), _) => None,
            };
            let whole = known_name("variable", var.and_then(|v| v.name.split(['.', '[']).next()));
            let issue = functions::impure(&routine.name, whole, span);
            self.report(issue);
        }
    }
}

/// A variable outside of functions, in an order.
#[derive(Clone, Copy, PartialEq, Eq)]
struct OrderedLeaf(VariableRef);

impl OrderedLeaf {
    fn key(self) -> (u8, u16) {
        match self.0 {
            VariableRef::Shared(i) => (0, i),
            VariableRef::Own(i) => (1, i),
            VariableRef::Local(i) => (2, i),
            VariableRef::Signal(s) => (3, s.0),
        }
    }
}

impl PartialOrd for OrderedLeaf {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OrderedLeaf {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key().cmp(&other.key())
    }
}

/// The variables outside that a body itself reads and assigns.
fn direct(routine: &TypedFunction) -> (BTreeSet<OrderedLeaf>, BTreeSet<OrderedLeaf>) {
    let (mut reads, mut assigns) = (BTreeSet::new(), BTreeSet::new());
    let outside = |l: VariableRef| matches!(l, VariableRef::Own(_) | VariableRef::Shared(_));
    let mut all = Vec::new();
    routine.body.iter().for_each(|s| s.each(&mut |s| all.push(s)));
    for statement in all {
        let mut read = |e: &TypedExpr| {
            e.each_leaf(&mut |l| {
                if outside(l) {
                    reads.insert(OrderedLeaf(l));
                }
            });
        };
        statement.expressions().into_iter().for_each(&mut read);
        if let TypedStatement::Assign { place, .. } = statement {
            place.indices.iter().for_each(|i| read(&i.at));
            assigns.extend(leaves(place).into_iter().filter(|l| outside(*l)).map(OrderedLeaf));
        }
    }
    (reads, assigns)
}
