//! Edges: selects, guards split into clock bounds and data, synchronisation, updates.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BinaryOp, Call, EdgeActionKind as Action, ExprKind as Syntax, Name, Param as SyntaxParam,
};

use super::{Checker, Env, automaton::Scope, is_variable_name};
use crate::{
    ClockConstraint, ClockId, ClockOp, Dim, Edge, EventId, Expr, ExprKind, Kind, Leaf, LocationId, Param,
    ReceiveArg, StimulusStep, Sync, Type, Update, Value,
    noun::Noun,
    report::{automata, types},
};

impl Checker<'_> {
    pub(super) fn edge(&mut self, scope: &Scope, edge: &ast::Edge, span: Span) -> Option<Edge> {
        let (from, to) = (self.location(scope, &edge.from), self.location(scope, &edge.to));
        let mut env = self.automaton_env(scope);
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
                Action::Assign { target, op, value } => {
                    updates.extend(self.update(scope, target, *op, value, &mut env));
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
        let local = self.automaton_env(scope).find(&name.text).map(|l| l.noun);
        self.unknown(Noun::Location, name, &all, local);
        None
    }

    fn selects(&mut self, selects: &[SyntaxParam], env: &mut Env) -> Vec<Param> {
        let mut resolved = Vec::new();
        for select in selects {
            let ty = self.ty(&select.ty).filter(|ty| self.finite(*ty, "a select", select.name.span));
            self.check_free(env, Noun::Variable, &select.name);
            env.push_local(&select.name.text, Noun::Variable, ty.map_or(Kind::Unknown, Type::kind));
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
        let params = self.params_of(event);
        let Some(args) = &call.args else {
            return Some(Sync::Receive { event, args: vec![ReceiveArg::Any; params.len()] });
        };
        if args.len() != params.len() {
            self.report(types::arity(self.noun_of(event), &call.name.text, &params, args.len(), call.span));
            return None;
        }
        let mut received = Vec::new();
        for (arg, param) in args.iter().zip(&params) {
            received.push(self.received(arg, param, env, equal));
        }
        Some(Sync::Receive { event, args: received })
    }

    /// What an unknown event would bind is known, but not its types.
    fn bind_unknown(&mut self, call: &Call, env: &mut Env) {
        for arg in call.args.iter().flatten() {
            if let Syntax::Path(path) = &arg.kind
                && let [name] = path.names.as_slice()
                && env.find(&name.text).is_none()
            {
                env.push_local(&name.text, Noun::Variable, Kind::Unknown);
            }
        }
    }

    fn received(
        &mut self,
        arg: &ast::Expr,
        param: &Param,
        env: &mut Env,
        equal: &mut Vec<Expr>,
    ) -> ReceiveArg {
        if arg.kind == Syntax::Any {
            return ReceiveArg::Any;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && env.find(&name.text).is_none()
            && !self.consts.contains_key(name.text.as_str())
            && !is_variable_name(&name.text)
        {
            self.finite(param.ty, "what an automaton binds", name.span);
            env.push_local(&name.text, Noun::Variable, param.ty.kind());
            return ReceiveArg::Bind;
        }
        let value = self.expr_for(arg, param.ty, env);
        if let Some(value) = value.constant() {
            return ReceiveArg::Is(value);
        }
        if value.ty == Kind::Unknown {
            return ReceiveArg::Any;
        }
        self.finite(param.ty, "what an automaton compares", arg.span);
        let bound = env.push_local("", Noun::Variable, param.ty.kind());
        let leaf = Expr { kind: ExprKind::Leaf(Leaf::Local(bound)), ty: param.ty.kind(), span: arg.span };
        let kind = ExprKind::Binary(BinaryOp::Eq, Box::new(leaf), Box::new(value));
        equal.push(Expr { kind, ty: Kind::Bool, span: arg.span });
        ReceiveArg::Bind
    }

    fn send(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> Option<Sync> {
        let local = env.find(&call.name.text).map(|l| l.noun);
        let event = self.event(Noun::EventOrStimulus, &call.name, local)?;
        self.owns(scope.actor, event, call);
        let params = self.params_of(event);
        let args = self.args(self.noun_of(event), call, &params, env);
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

    fn update(
        &mut self,
        scope: &Scope,
        target: &Name,
        op: Option<BinaryOp>,
        value: &ast::Expr,
        env: &mut Env,
    ) -> Option<Update> {
        if let Some(clock) = scope.clocks.get(&target.text) {
            let zero = match value.kind {
                Syntax::Int(n) => n == 0,
                Syntax::Quantity { number, .. } => {
                    number == 0.0 && self.expr_of(value, Kind::Float(Dim::TIME), env).constant().is_some()
                }
                _ => false,
            };
            if !zero || op.is_some() {
                self.report(automata::clock_set(&target.text, target.span));
                return None;
            }
            return Some(Update::Reset(ClockId(clock)));
        }
        let slot = env.find(&target.text).map(|l| (l.leaf, l.noun));
        let (leaf, ty) = match slot {
            Some((Some(Leaf::Own(i)), _)) => {
                (Leaf::Own(i), self.s.automata[scope.index].vars[usize::from(i)].ty)
            }
            Some((Some(Leaf::Shared(i)), _)) => (Leaf::Shared(i), self.s.shared[usize::from(i)].ty),
            Some((Some(Leaf::Local(_) | Leaf::Signal(_)) | None, _)) => {
                let message = format!("`{}` is bound by the edge: it cannot be assigned", target.text);
                let issue =
                    hrdsl_source::Diagnostic::error(hrdsl_source::Code::WRONG_KIND, target.span, message);
                self.report(issue.help("assign a variable declared by `var`"));
                return None;
            }
            None => {
                let vars = env.locals.iter().filter(|l| !matches!(l.leaf, Some(Leaf::Local(_))));
                let all: Vec<String> = vars.map(|l| l.name.clone()).collect();
                self.unknown(Noun::Variable, target, &all, None);
                self.expr(value, env);
                return None;
            }
        };
        let value = self.new_value(leaf, ty, op, value, target, env);
        Some(match leaf {
            Leaf::Own(i) => Update::Own(i, value),
            Leaf::Shared(i) | Leaf::Local(i) => Update::Shared(i, value),
            Leaf::Signal(_) => return None,
        })
    }

    /// `v`, or for `x += v` the sum.
    fn new_value(
        &mut self,
        leaf: Leaf,
        ty: Type,
        op: Option<BinaryOp>,
        value: &ast::Expr,
        target: &Name,
        env: &mut Env,
    ) -> Expr {
        let Some(op) = op else { return self.expr_for(value, ty, env) };
        if ty == Type::Bool {
            self.report(types::mismatch(Kind::Int, Kind::Bool, None, target.span));
        }
        let by = self.expr_of(value, Kind::Int, env);
        let span = target.span.to(value.span);
        let old = Expr { kind: ExprKind::Leaf(leaf), ty: ty.kind(), span: target.span };
        Expr { kind: ExprKind::Binary(op, Box::new(old), Box::new(by)), ty: Kind::Int, span }
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

fn and(a: Expr, b: Expr) -> Expr {
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
