//! Edges: selects, guards split into clock bounds and data, synchronisation, updates.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BinaryOp, CallSyntax, EdgeActionKind as Action, ExprSyntaxKind as Syntax, NameSyntax,
    ParamSyntax as SyntaxParam,
};

use crate::check::{
    automata::{automaton::EdgeScope, channel::EdgeMedium, phase::AutomataPhase},
    checker::Checker,
    state::{
        item::ArgumentPart,
        scope::{ExprEnv, is_variable_name},
    },
    template::CheckerPhase,
};
use crate::{
    ArgPattern, AutomatonVar, ClockId, EventId, InferredType, LocationId, ReceiveArg, Type,
    TypedClockConstraint, TypedEdge, TypedExpr, TypedExprKind, TypedStimulusStep, TypedSync, VariableRef,
    noun::Noun,
    report::{automata, types},
    types::{TypeLayout, finite_var},
};

impl AutomataPhase<'_, '_> {
    pub(in crate::check) fn edge(
        &mut self,
        scope: &EdgeScope,
        edge: &ast::EdgeSyntax,
        span: Span,
    ) -> Option<TypedEdge> {
        let (from, to) = (self.location(scope, &edge.from), self.location(scope, &edge.to));
        let mut env = scope.env.clone();
        let selects = self.selects(&edge.selects, &mut env);
        let mut equal = Vec::new();
        let receive = edge.on.as_ref().map(|call| self.receive(scope, call, &mut env, &mut equal));
        let Conjunction { bounds: clock_guard, mut data, timed, stopped } =
            self.conjunction(scope, edge.guard.as_ref(), &mut env);
        for (_, span) in stopped {
            self.report(automata::stopped_on_edge(span));
        }
        data.splice(0..0, equal);
        let mut updates = Vec::new();
        let mut sent: Option<(Span, Option<TypedSync>)> = None;
        for action in &edge.actions {
            match &action.kind {
                Action::Send(call) if self.calls_function(call, &mut env, &mut updates) => {}
                Action::Send(call) => {
                    match (&sent, &edge.on) {
                        (Some((first, _)), _) => self.report(automata::two_sends(call.span, *first)),
                        (None, Some(on)) => self.report(automata::takes_and_sends(call.span, on.span)),
                        (None, None) => {}
                    }
                    let sync = self.send(scope, call, &mut env);
                    if sent.is_none() {
                        sent = Some((call.span, sync));
                    }
                }
                Action::Assign { target, access, op, value } => {
                    self.update(scope, (target, access), *op, value, &mut env, &mut updates);
                }
            }
        }
        let sync = match (receive, sent) {
            (Some(receive), _) => receive?,
            (None, Some((_, send))) => send?,
            (None, None) => TypedSync::Internal,
        };
        self.check_urgent(&sync, timed);
        let guard = data.into_iter().reduce(and);
        Some(TypedEdge { from: from?, to: to?, selects, clock_guard, guard, sync, updates, origin: span })
    }

    /// A conjunction taken apart: the bounds on clocks, the rest, and where the first bound is.
    pub(in crate::check) fn conjunction(
        &mut self,
        scope: &EdgeScope,
        condition: Option<&ast::ExprSyntax>,
        env: &mut ExprEnv,
    ) -> Conjunction {
        let mut all = Conjunction::default();
        for part in condition.into_iter().flat_map(conjuncts) {
            if let Some(clock) = self.stopped_clock(part, scope, env) {
                all.stopped.extend(clock.map(|clock| (clock, part.span)));
                continue;
            }
            match self.clock_bound(part, scope, env) {
                Some(bound) => {
                    all.timed = all.timed.or(Some(part.span));
                    all.bounds.extend(bound);
                }
                None => all.data.push(self.expr_of(part, InferredType::Bool, env)),
            }
        }
        all
    }

    fn location(&mut self, scope: &EdgeScope, name: &NameSyntax) -> Option<LocationId> {
        if let Some(id) = scope.locations.get(&name.text) {
            self.refer(name, scope.locations.span(id));
            return Some(LocationId(id));
        }
        let all: Vec<String> = scope.locations.names().map(str::to_owned).collect();
        let local = scope.env.find(&name.text).map(|l| l.noun);
        self.unknown(Noun::Location, name, &all, local);
        None
    }

    fn selects(&mut self, selects: &[SyntaxParam], env: &mut ExprEnv) -> Vec<AutomatonVar> {
        let mut resolved = Vec::new();
        for select in selects {
            let ty = self.ty(&select.ty).filter(|ty| self.finite(*ty, "a select", select.name.span));
            self.check_free(env, Noun::Variable, &select.name);
            match ty {
                Some(ty) => env.push_typed(&select.name.text, select.name.span, Noun::Variable, ty),
                None => {
                    env.push_local(&select.name.text, select.name.span, Noun::Variable, InferredType::Unknown)
                }
            };
            resolved.push(finite_var(&select.name.text, ty.unwrap_or(Type::Bool)));
        }
        resolved
    }

    /// `on e(…)`: a lower-case name that means nothing yet is bound; a variable's value is compared by the guard.
    fn receive(
        &mut self,
        scope: &EdgeScope,
        call: &CallSyntax,
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> Option<TypedSync> {
        let local = env.find(&call.name.text).map(|l| l.noun);
        match self.medium(scope, &call.name, local) {
            Some(EdgeMedium::Channel(channel)) => self.accept(scope, channel, call, env, equal),
            Some(EdgeMedium::Event(event)) => {
                if let Some(actor) = scope.actor {
                    self.perceives(actor, event, call.name.span, true);
                }
                let fields = self.fields_of(event);
                let args = self.received_args(self.noun_of(event), call, &fields, env, equal)?;
                Some(TypedSync::Receive { event, args })
            }
            None => {
                self.bind_unknown(call, env);
                None
            }
        }
    }

    /// What is done with each single value of an event or channel.
    pub(in crate::check) fn received_args(
        &mut self,
        noun: Noun,
        call: &CallSyntax,
        fields: &[(String, TypeLayout)],
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> Option<Vec<ReceiveArg>> {
        let Some(args) = &call.args else {
            return Some(vec![ReceiveArg::Match(ArgPattern::Any); self.flat(fields).len()]);
        };
        if args.len() != fields.len() {
            self.wrong_arity(noun, call, fields);
            return None;
        }
        // What is there before the edge binds anything.
        let scalar = fields.iter().all(|(_, layout)| matches!(layout, TypeLayout::Scalar(_)));
        let seen = if scalar { ExprEnv::default() } else { env.clone() };
        let free = |c: &Checker<'_>, name: &NameSyntax| {
            seen.layout(&name.text).is_none()
                && seen.find(&name.text).is_none()
                && !c.has_value(&name.text)
                && !is_variable_name(&name.text)
        };
        let parts = self.spread_args(args, fields, env, &free);
        Some(parts.into_iter().map(|part| self.received_part(part, env, equal)).collect())
    }

    /// What an unknown event would bind is known, but not its types.
    fn bind_unknown(&mut self, call: &CallSyntax, env: &mut ExprEnv) {
        let free =
            |c: &Checker<'_>, name: &NameSyntax| !c.has_value(&name.text) && !is_variable_name(&name.text);
        call.args.iter().flatten().for_each(|arg| self.bind_names(arg, env, &free));
    }

    fn received_part(
        &mut self,
        part: ArgumentPart<'_>,
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> ReceiveArg {
        match part {
            ArgumentPart::Any => ReceiveArg::Match(ArgPattern::Any),
            ArgumentPart::Syntax(arg, ty) => self.received(arg, ty, env, equal),
            ArgumentPart::Done(e, ty) => self.compared(e, ty, env, equal),
            // The same name a second time: the parts are compared.
            ArgumentPart::Variable(name, ty) if env.find(&name.text).is_some() => {
                let value = self.variable(&name, env);
                self.compared(value, ty, env, equal)
            }
            ArgumentPart::Variable(name, ty) => {
                self.finite(ty, "what an automaton binds", name.span);
                self.define_here(&name, InferredType::of(ty));
                env.push_typed(&name.text, name.span, Noun::Variable, ty);
                ReceiveArg::Bind
            }
        }
    }

    fn received(
        &mut self,
        arg: &ast::ExprSyntax,
        ty: Type,
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> ReceiveArg {
        if arg.kind == Syntax::Any {
            return ReceiveArg::Match(ArgPattern::Any);
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && env.find(&name.text).is_none()
            && env.layout(&name.text).is_none()
            && !self.has_value(&name.text)
            && !is_variable_name(&name.text)
        {
            self.finite(ty, "what an automaton binds", name.span);
            self.define_here(name, InferredType::of(ty));
            env.push_typed(&name.text, name.span, Noun::Variable, ty);
            return ReceiveArg::Bind;
        }
        let value = self.expr_for(arg, ty, env);
        self.compared(value, ty, env, equal)
    }

    /// What is received is compared with a value.
    fn compared(
        &mut self,
        value: TypedExpr,
        ty: Type,
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> ReceiveArg {
        let span = value.span;
        if let Some(value) = value.constant() {
            return ReceiveArg::Match(ArgPattern::Is(value));
        }
        if value.ty == InferredType::Unknown {
            return ReceiveArg::Match(ArgPattern::Any);
        }
        self.finite(ty, "what an automaton compares", span);
        let bound = env.push_local("", span, Noun::Variable, InferredType::of(ty));
        let leaf = TypedExpr {
            kind: TypedExprKind::Leaf(VariableRef::Local(bound)),
            ty: InferredType::of(ty),
            span,
        };
        let kind = TypedExprKind::Binary(BinaryOp::Eq, Box::new(leaf), Box::new(value));
        equal.push(TypedExpr { kind, ty: InferredType::Bool, span });
        ReceiveArg::Bind
    }

    fn send(&mut self, scope: &EdgeScope, call: &CallSyntax, env: &mut ExprEnv) -> Option<TypedSync> {
        let local = env.find(&call.name.text).map(|l| l.noun);
        let event = match self.medium(scope, &call.name, local)? {
            EdgeMedium::Channel(channel) => return self.offer(channel, call, env),
            EdgeMedium::Event(event) => event,
        };
        if let Some(actor) = scope.actor {
            self.owns(actor, event, call);
        }
        let fields = self.fields_of(event);
        let noun = self.noun_of(event);
        let args = self.args(noun, call, &fields, env);
        let params = self.s.events[usize::from(event.0)].params.clone();
        if args.len() != params.len() {
            return None;
        }
        for (arg, param) in args.iter().zip(&params) {
            if !param.ty.is_finite() && arg.constant().is_none() && arg.ty != InferredType::Unknown {
                self.report(types::not_constant(arg.span));
            }
        }
        if self.emits_by_sample(event) {
            self.report(automata::sampled_emit(&call.name.text, call.name.span));
        }
        Some(TypedSync::Send { event, args })
    }

    /// Whether some emitted event, or whether it is emitted, depends on a sample.
    fn emits_by_sample(&self, event: EventId) -> bool {
        let e = &self.s.events[usize::from(event.0)];
        let params = e.params.len();
        e.stimulus.as_ref().is_some_and(|s| sampled(&s.steps, params))
    }
}

/// The parts of a conjunction, in order.
/// The parts of a guard or an invariant.
#[derive(Default)]
pub(in crate::check) struct Conjunction {
    pub bounds: Vec<TypedClockConstraint>,
    pub data: Vec<TypedExpr>,
    /// Where the first bound of a clock is.
    pub timed: Option<Span>,
    /// The clocks that stand still, and where that is said.
    pub stopped: Vec<(ClockId, Span)>,
}

pub(in crate::check) fn conjuncts(e: &ast::ExprSyntax) -> Vec<&ast::ExprSyntax> {
    let Syntax::Binary { op: ast::BinaryOp::And, left, right } = &e.kind else { return vec![e] };
    let mut parts = conjuncts(left);
    parts.extend(conjuncts(right));
    parts
}

pub(in crate::check) fn and(a: TypedExpr, b: TypedExpr) -> TypedExpr {
    let span = a.span.to(b.span);
    TypedExpr {
        kind: TypedExprKind::Binary(BinaryOp::And, Box::new(a), Box::new(b)),
        ty: InferredType::Bool,
        span,
    }
}

fn sampled(steps: &[TypedStimulusStep], params: usize) -> bool {
    let reads_sample = |e: &TypedExpr| {
        let mut found = false;
        e.each(&mut |e| {
            found |= matches!(e.kind, TypedExprKind::Leaf(VariableRef::Local(i)) if usize::from(i) >= params);
        });
        found
    };
    steps.iter().any(|step| match step {
        TypedStimulusStep::Emit { args, .. } => args.iter().any(reads_sample),
        TypedStimulusStep::If { condition, then, otherwise } => {
            let inside = sampled(then, params) || sampled(otherwise, params);
            inside || reads_sample(condition) && (emits(then) || emits(otherwise))
        }
        TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => false,
    })
}

fn emits(steps: &[TypedStimulusStep]) -> bool {
    steps.iter().any(|step| match step {
        TypedStimulusStep::Emit { .. } => true,
        TypedStimulusStep::If { then, otherwise, .. } => emits(then) || emits(otherwise),
        TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => false,
    })
}
