//! Edges: selects, guards split into clock bounds and data, synchronisation, updates.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BinaryOp, Call, EdgeActionKind as Action, ExprKind as Syntax, Name, Param as SyntaxParam,
};

use super::{Checker, Env, automaton::Scope, is_variable_name, item::Part};
use crate::{
    ClockConstraint, ClockId, ClockOp, Dim, Edge, EventId, Expr, ExprKind, Kind, Leaf, LocationId, Param,
    ReceiveArg, StimulusStep, Sync, Type, Value,
    noun::Noun,
    report::{automata, types},
    types::Layout,
};

impl Checker<'_> {
    pub(super) fn edge(&mut self, scope: &Scope, edge: &ast::Edge, span: Span) -> Option<Edge> {
        let (from, to) = (self.location(scope, &edge.from), self.location(scope, &edge.to));
        let mut env = scope.env.clone();
        let selects = self.selects(&edge.selects, &mut env);
        let mut equal = Vec::new();
        let receive = edge.on.as_ref().map(|call| self.receive(scope, call, &mut env, &mut equal));
        let mut clock_guard = Vec::new();
        let mut data: Vec<Expr> = equal;
        if let Some(guard) = &edge.guard {
            for part in conjuncts(guard) {
                match self.clock_bound(part, scope, &mut env) {
                    Some(bound) => clock_guard.extend(bound),
                    None => data.push(self.expr_of(part, Kind::Bool, &mut env)),
                }
            }
        }
        let mut updates = Vec::new();
        let mut sent: Option<(Span, Option<Sync>)> = None;
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
            (None, None) => Sync::Internal,
        };
        let guard = data.into_iter().reduce(and);
        Some(Edge { from: from?, to: to?, selects, clock_guard, guard, sync, updates, span })
    }

    fn location(&mut self, scope: &Scope, name: &Name) -> Option<LocationId> {
        if let Some(id) = scope.locations.get(&name.text) {
            return Some(LocationId(id));
        }
        let all: Vec<String> = scope.locations.names().map(str::to_owned).collect();
        let local = scope.env.find(&name.text).map(|l| l.noun);
        self.unknown(Noun::Location, name, &all, local);
        None
    }

    fn selects(&mut self, selects: &[SyntaxParam], env: &mut Env) -> Vec<Param> {
        let mut resolved = Vec::new();
        for select in selects {
            let ty = self.ty(&select.ty).filter(|ty| self.finite(*ty, "a select", select.name.span));
            self.check_free(env, Noun::Variable, &select.name);
            match ty {
                Some(ty) => env.push_typed(&select.name.text, Noun::Variable, ty),
                None => env.push_local(&select.name.text, Noun::Variable, Kind::Unknown),
            };
            resolved.push(Param { name: select.name.text.clone(), ty: ty.unwrap_or(Type::Bool) });
        }
        resolved
    }

    /// `on e(…)`: a lower-case name that means nothing yet is bound; a variable's value is compared by the guard.
    fn receive(&mut self, scope: &Scope, call: &Call, env: &mut Env, equal: &mut Vec<Expr>) -> Option<Sync> {
        let local = env.find(&call.name.text).map(|l| l.noun);
        let Some(event) = self.event(Noun::EventOrStimulus, &call.name, local) else {
            self.bind_unknown(call, env);
            return None;
        };
        self.perceives(scope.actor, event, call.name.span, true);
        let fields = self.fields_of(event);
        let Some(args) = &call.args else {
            return Some(Sync::Receive { event, args: vec![ReceiveArg::Any; self.arity_of(event)] });
        };
        if args.len() != fields.len() {
            self.wrong_arity(self.noun_of(event), call, &fields);
            return None;
        }
        // What is there before the edge binds anything.
        let scalar = fields.iter().all(|(_, layout)| matches!(layout, Layout::Scalar(_)));
        let seen = if scalar { Env::default() } else { env.clone() };
        let free = |c: &Checker<'_>, name: &Name| {
            seen.layout(&name.text).is_none()
                && seen.find(&name.text).is_none()
                && !c.has_value(&name.text)
                && !is_variable_name(&name.text)
        };
        let parts = self.spread_args(args, &fields, env, &free);
        let received = parts.into_iter().map(|part| self.received_part(part, env, equal)).collect();
        Some(Sync::Receive { event, args: received })
    }

    /// What an unknown event would bind is known, but not its types.
    fn bind_unknown(&mut self, call: &Call, env: &mut Env) {
        let free = |c: &Checker<'_>, name: &Name| !c.has_value(&name.text) && !is_variable_name(&name.text);
        call.args.iter().flatten().for_each(|arg| self.bind_names(arg, env, &free));
    }

    fn received_part(&mut self, part: Part<'_>, env: &mut Env, equal: &mut Vec<Expr>) -> ReceiveArg {
        match part {
            Part::Any => ReceiveArg::Any,
            Part::Syntax(arg, ty) => self.received(arg, ty, env, equal),
            Part::Done(e, ty) => self.compared(e, ty, env, equal),
            // The same name a second time: the parts are compared.
            Part::Variable(name, ty) if env.find(&name.text).is_some() => {
                let value = self.variable(&name, env);
                self.compared(value, ty, env, equal)
            }
            Part::Variable(name, ty) => {
                self.finite(ty, "what an automaton binds", name.span);
                env.push_typed(&name.text, Noun::Variable, ty);
                ReceiveArg::Bind
            }
        }
    }

    fn received(&mut self, arg: &ast::Expr, ty: Type, env: &mut Env, equal: &mut Vec<Expr>) -> ReceiveArg {
        if arg.kind == Syntax::Any {
            return ReceiveArg::Any;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && env.find(&name.text).is_none()
            && env.layout(&name.text).is_none()
            && !self.has_value(&name.text)
            && !is_variable_name(&name.text)
        {
            self.finite(ty, "what an automaton binds", name.span);
            env.push_typed(&name.text, Noun::Variable, ty);
            return ReceiveArg::Bind;
        }
        let value = self.expr_for(arg, ty, env);
        self.compared(value, ty, env, equal)
    }

    /// What is received is compared with a value.
    fn compared(&mut self, value: Expr, ty: Type, env: &mut Env, equal: &mut Vec<Expr>) -> ReceiveArg {
        let span = value.span;
        if let Some(value) = value.constant() {
            return ReceiveArg::Is(value);
        }
        if value.ty == Kind::Unknown {
            return ReceiveArg::Any;
        }
        self.finite(ty, "what an automaton compares", span);
        let bound = env.push_local("", Noun::Variable, ty.kind());
        let leaf = Expr { kind: ExprKind::Leaf(Leaf::Local(bound)), ty: ty.kind(), span };
        let kind = ExprKind::Binary(BinaryOp::Eq, Box::new(leaf), Box::new(value));
        equal.push(Expr { kind, ty: Kind::Bool, span });
        ReceiveArg::Bind
    }

    fn send(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> Option<Sync> {
        let local = env.find(&call.name.text).map(|l| l.noun);
        let event = self.event(Noun::EventOrStimulus, &call.name, local)?;
        self.owns(scope.actor, event, call);
        let fields = self.fields_of(event);
        let args = self.args(self.noun_of(event), call, &fields, env);
        let params = self.s.events[usize::from(event.0)].params.clone();
        if args.len() != params.len() {
            return None;
        }
        for (arg, param) in args.iter().zip(&params) {
            if !param.ty.is_finite() && arg.constant().is_none() && arg.ty != Kind::Unknown {
                self.report(types::not_constant(arg.span));
            }
        }
        if self.emits_by_sample(event) {
            self.report(automata::sampled_emit(&call.name.text, call.name.span));
        }
        Some(Sync::Send { event, args })
    }

    /// Whether some emitted event, or whether it is emitted, depends on a sample.
    fn emits_by_sample(&self, event: EventId) -> bool {
        let e = &self.s.events[usize::from(event.0)];
        let params = e.params.len();
        e.stimulus.as_ref().is_some_and(|s| sampled(&s.steps, params))
    }

    // ── clock bounds ──

    /// A comparison with a clock on one side. `None`: there is no clock at the top of it, it is data;
    /// `Some(None)`: it is a bound, but a wrong one.
    pub(super) fn clock_bound(
        &mut self,
        e: &ast::Expr,
        scope: &Scope,
        env: &mut Env,
    ) -> Option<Option<ClockConstraint>> {
        let Syntax::Binary { op, left, right } = &e.kind else { return None };
        let (l, r) = (clock_side(left, scope), clock_side(right, scope));
        let (side, other, flipped) = match (l, r) {
            (Some((x, None)), Some((y, None))) => {
                // `x < y` is `x - y < 0`
                let op = self.clock_op(*op, e.span, false);
                return Some(op.map(|op| ClockConstraint { clock: x, minus: Some(y), op, bound: 0.0 }));
            }
            (Some(side), _) => (side, right, false),
            (None, Some(side)) => (side, left, true),
            (None, None) => return None,
        };
        let op = self.clock_op(*op, e.span, flipped);
        let bound = self.constant(other, Kind::Float(Dim::TIME), env).and_then(Value::number);
        let constraint = op.zip(bound);
        Some(constraint.map(|(op, bound)| ClockConstraint { clock: side.0, minus: side.1, op, bound }))
    }

    fn clock_op(&mut self, op: BinaryOp, span: Span, flipped: bool) -> Option<ClockOp> {
        let written = match op {
            BinaryOp::Lt => Ok(ClockOp::Lt),
            BinaryOp::Le => Ok(ClockOp::Le),
            BinaryOp::Eq => Ok(ClockOp::Eq),
            BinaryOp::Ge => Ok(ClockOp::Ge),
            BinaryOp::Gt => Ok(ClockOp::Gt),
            BinaryOp::Ne => Err("!="),
            BinaryOp::Or => Err("||"),
            BinaryOp::And => Err("&&"),
            BinaryOp::Add => Err("+"),
            BinaryOp::Sub => Err("-"),
            BinaryOp::Mul => Err("*"),
            BinaryOp::Div => Err("/"),
            BinaryOp::Rem => Err("%"),
        };
        match (written, flipped) {
            (Ok(op), false) => Some(op),
            (Ok(op), true) => Some(match op {
                ClockOp::Lt => ClockOp::Gt,
                ClockOp::Le => ClockOp::Ge,
                ClockOp::Eq => ClockOp::Eq,
                ClockOp::Ge => ClockOp::Le,
                ClockOp::Gt => ClockOp::Lt,
            }),
            (Err(op), _) => {
                self.report(automata::clock_comparison(op, span));
                None
            }
        }
    }
}

/// `x` or `x - y`
fn clock_side(e: &ast::Expr, scope: &Scope) -> Option<(ClockId, Option<ClockId>)> {
    let clock = |e: &ast::Expr| match &e.kind {
        Syntax::Path(path) if path.names.len() == 1 => scope.clocks.get(&path.names[0].text).map(ClockId),
        _ => None,
    };
    match &e.kind {
        Syntax::Binary { op: BinaryOp::Sub, left, right } => Some((clock(left)?, Some(clock(right)?))),
        _ => Some((clock(e)?, None)),
    }
}

/// The parts of a conjunction, in order.
pub(super) fn conjuncts(e: &ast::Expr) -> Vec<&ast::Expr> {
    match &e.kind {
        Syntax::Binary { op: BinaryOp::And, left, right } => {
            let mut parts = conjuncts(left);
            parts.extend(conjuncts(right));
            parts
        }
        _ => vec![e],
    }
}

pub(super) fn and(a: Expr, b: Expr) -> Expr {
    let span = a.span.to(b.span);
    Expr { kind: ExprKind::Binary(BinaryOp::And, Box::new(a), Box::new(b)), ty: Kind::Bool, span }
}

fn sampled(steps: &[StimulusStep], params: usize) -> bool {
    let reads_sample = |e: &Expr| {
        let mut found = false;
        e.each(&mut |e| {
            found |= matches!(e.kind, ExprKind::Leaf(Leaf::Local(i)) if usize::from(i) >= params);
        });
        found
    };
    steps.iter().any(|step| match step {
        StimulusStep::Emit { args, .. } => args.iter().any(reads_sample),
        StimulusStep::If { condition, then, otherwise } => {
            let inside = sampled(then, params) || sampled(otherwise, params);
            inside || reads_sample(condition) && (emits(then) || emits(otherwise))
        }
        StimulusStep::Hold(_) | StimulusStep::Act(_) => false,
    })
}

fn emits(steps: &[StimulusStep]) -> bool {
    steps.iter().any(|step| match step {
        StimulusStep::Emit { .. } => true,
        StimulusStep::If { then, otherwise, .. } => emits(then) || emits(otherwise),
        StimulusStep::Hold(_) | StimulusStep::Act(_) => false,
    })
}
