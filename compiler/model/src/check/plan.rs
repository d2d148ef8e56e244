//! Plans: trigger, context, body; each variable must have a value before it is read, from left to right.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, BinaryOp, Call, ExprKind as Syntax, StepKind as SyntaxStep, TriggerKind, UnaryOp,
};

use super::{
    Checker, Env, NOBODY, agent::Scope, expr::FUNCTIONS, is_variable_name, item::Part, layout::Fields,
    table::MAX_NAMES,
};
use crate::{
    ActorId, Arg, BeliefId, Context, Dim, EventId, Expr, Kind, Leaf, Plan, Role, Step, StepKind, TriggerOn,
    Type,
    noun::Noun,
    report::{names, roles},
};

impl Checker<'_> {
    pub(super) fn plan(&mut self, scope: &mut Scope, plan: &ast::Plan, span: Span) -> Option<Plan> {
        let label = self.label(scope, plan);
        let mut env = Env { plan: true, noun: Some(Noun::Variable), ..Env::default() };
        let trigger = self.trigger(scope, &plan.trigger, &mut env);
        let context = match &plan.context {
            Some(e) => self.context(scope, e, &mut env),
            None => Context::True,
        };
        let body: Vec<Step> = plan.body.iter().filter_map(|step| self.step(scope, step, &mut env)).collect();
        if env.locals.len() > MAX_NAMES {
            let message = format!("the plan has more than {MAX_NAMES} variables");
            self.report(super::too_many(message, plan.trigger.span));
        }
        let vars = env.locals.iter().map(|l| l.name.clone()).collect();
        let (trigger, args) = trigger?;
        let (head, name) = (plan.trigger.span, plan.trigger.call.name.span);
        Some(Plan { label, trigger, args, context, body, vars, span, head, name })
    }

    fn label(&mut self, scope: &mut Scope, plan: &ast::Plan) -> String {
        let trigger = plan.trigger.call.name.text.clone();
        let count = scope.plans_of.entry(trigger.clone()).or_insert(0);
        *count += 1;
        let made = format!("{trigger}#{count}");
        let Some(label) = &plan.label else { return made };
        Self::declare(&mut self.issues, &mut scope.labels, Noun::Label, label);
        label.text.clone()
    }

    fn trigger(
        &mut self,
        scope: &Scope,
        trigger: &ast::Trigger,
        env: &mut Env,
    ) -> Option<(TriggerOn, Vec<Arg>)> {
        let call = &trigger.call;
        let on_belief = |c: &mut Self, make: fn(BeliefId) -> TriggerOn, env: &mut Env| {
            let belief = c.belief(scope, &call.name);
            let fields = belief.map(|b| c.belief_fields(scope.id, b));
            let args = c.matched(Noun::Belief, call, fields.as_ref(), env, true);
            Some((make(belief?), args))
        };
        match trigger.kind {
            TriggerKind::Added => on_belief(self, TriggerOn::Added, env),
            TriggerKind::Removed => on_belief(self, TriggerOn::Removed, env),
            TriggerKind::Test => on_belief(self, TriggerOn::Test, env),
            TriggerKind::Achieve | TriggerKind::Failed => {
                let goal = self.goal(scope, call);
                let args = self.matched(Noun::Goal, call, None, env, true);
                let goal = goal?;
                let achieve = trigger.kind == TriggerKind::Achieve;
                Some((if achieve { TriggerOn::Achieve(goal) } else { TriggerOn::Failed(goal) }, args))
            }
            TriggerKind::On => {
                let local = self.kind_in_agent(scope, &call.name.text);
                let event = self.event(Noun::EventOrStimulus, &call.name, local);
                let fields = event.map(|e| self.fields_of(e));
                let args = match (&call.args, event) {
                    // Without parentheses any arguments will do.
                    (None, Some(event)) => vec![Arg::Any; self.arity_of(event)],
                    (Some(_), _) | (None, None) => {
                        self.matched(Noun::Event, call, fields.as_ref(), env, true)
                    }
                };
                let event = event?;
                self.perceives(self.s.agents[usize::from(scope.id.0)].actor, event, call.name.span, false);
                Some((TriggerOn::Perceived(event), args))
            }
        }
    }

    /// Whether an event reaches an actor: one of another actor, addressed to it or to everybody. Automata of one actor
    /// also hear each other.
    pub(super) fn perceives(&mut self, actor: ActorId, event: EventId, span: Span, own_too: bool) {
        let e = &self.s.events[usize::from(event.0)];
        if actor == NOBODY || e.from == NOBODY {
            return;
        }
        let who = self.actor_name(actor);
        let noun = if e.stimulus.is_some() { Noun::Stimulus } else { Noun::Event };
        let issue = if e.from == actor {
            if own_too {
                return;
            }
            let help = format!("it is done by `{who}` itself, which only perceives what others do");
            roles::not_perceived(noun, &e.name, who, &help, span)
        } else if e.stimulus.is_some() && self.role_of(actor) == Role::System {
            let help = "a stimulus is an action of a test: the system only perceives the events it emits";
            roles::not_perceived(noun, &e.name, who, help, span)
        } else if !e.to.is_empty() && !e.to.contains(&actor) {
            let to: Vec<&str> = e.to.iter().map(|a| self.actor_name(*a)).collect();
            let help = format!("it is declared `to {}`", to.join(", "));
            roles::not_perceived(noun, &e.name, who, &help, span)
        } else {
            return;
        };
        self.report(issue);
    }

    /// Arguments that are matched: `_`, a variable, or a value. `None` for parameters: their types are not known.
    fn matched(
        &mut self,
        noun: Noun,
        call: &Call,
        fields: Option<&Fields>,
        env: &mut Env,
        binds: bool,
    ) -> Vec<Arg> {
        let args = call.args.as_deref().unwrap_or_default();
        let variable =
            |c: &Checker<'_>, name: &ast::Name| is_variable_name(&name.text) && !c.has_value(&name.text);
        if fields.is_none() && noun != Noun::Goal {
            // Its name has a diagnostic.
            if binds {
                args.iter().for_each(|arg| self.bind_names(arg, env, &variable));
            }
            return args.iter().map(|_| Arg::Any).collect();
        }
        let Some(fields) = fields else {
            return args.iter().map(|arg| self.matched_arg(arg, None, env, binds)).collect();
        };
        if args.len() != fields.len() {
            self.wrong_arity(noun, call, fields);
        }
        let parts = self.spread_args(args, fields, env, &variable);
        let mut matched: Vec<Arg> =
            parts.into_iter().map(|part| self.matched_part(part, env, binds)).collect();
        for arg in args.iter().skip(fields.len()) {
            matched.push(self.matched_arg(arg, None, env, binds));
        }
        matched
    }

    fn matched_part(&mut self, part: Part<'_>, env: &mut Env, binds: bool) -> Arg {
        match part {
            Part::Any => Arg::Any,
            Part::Syntax(arg, ty) => self.matched_arg(arg, Some(ty), env, binds),
            Part::Done(e, _) => Arg::Expr(e),
            Part::Variable(name, ty) => self.matched_variable(&name, Some(ty), env, binds),
        }
    }

    fn matched_arg(&mut self, arg: &ast::Expr, ty: Option<Type>, env: &mut Env, binds: bool) -> Arg {
        if arg.kind == Syntax::Any {
            return Arg::Any;
        }
        if let Syntax::Path(path) = &arg.kind
            && let [name] = path.names.as_slice()
            && is_variable_name(&name.text)
            && !self.has_value(&name.text)
            && env.layout(&name.text).is_none()
        {
            return self.matched_variable(name, ty, env, binds);
        }
        Arg::Expr(match ty {
            Some(ty) => self.expr_for(arg, ty, env),
            None => self.expr(arg, env),
        })
    }

    /// Binds a variable, or compares with its value.
    fn matched_variable(&mut self, name: &ast::Name, ty: Option<Type>, env: &mut Env, binds: bool) -> Arg {
        let kind = ty.map_or(Kind::Unknown, Type::kind);
        match env.find_mut(&name.text) {
            Some(local) if !local.bound && binds => {
                local.bound = true;
                local.ty = kind;
                local.range = ty.and_then(Type::range);
            }
            Some(_) => {}
            None if binds => match ty {
                Some(ty) => {
                    env.push_typed(&name.text, Noun::Variable, ty);
                }
                None => {
                    env.push_local(&name.text, Noun::Variable, kind);
                }
            },
            None => {}
        }
        let e = self.variable(name, env);
        match self.fit(e, kind, env).kind {
            crate::ExprKind::Leaf(Leaf::Local(i)) => Arg::Var(i),
            _ => Arg::Any,
        }
    }

    // ── context ──

    fn context(&mut self, scope: &Scope, e: &ast::Expr, env: &mut Env) -> Context {
        match &e.kind {
            Syntax::Binary { op: BinaryOp::And, left, right } => {
                let mut parts = Vec::new();
                for side in [left, right] {
                    match self.context(scope, side, env) {
                        Context::And(more) => parts.extend(more),
                        one => parts.push(one),
                    }
                }
                Self::all_of(parts)
            }
            Syntax::Binary { op: BinaryOp::Or, left, right } => self.either(scope, left, right, env),
            Syntax::Unary { op: UnaryOp::Not, operand } => {
                // What a negation binds is bound within it only.
                let before: Vec<bool> = env.locals.iter().map(|l| l.bound).collect();
                let inner = self.context(scope, operand, env);
                restore(env, &before);
                Context::Not(Box::new(inner))
            }
            Syntax::Call { callee, args } if callee.names.len() == 1 => {
                let name = &callee.names[0];
                if FUNCTIONS.iter().any(|(f, _)| *f == name.text) {
                    return Context::Test(self.expr_of(e, Kind::Bool, env));
                }
                let call = Call { name: name.clone(), args: Some(args.clone()), span: e.span };
                self.literal(scope, &call, env)
            }
            Syntax::Path(path) if self.is_literal(path, env) => {
                let call = Call { name: path.names[0].clone(), args: None, span: e.span };
                self.literal(scope, &call, env)
            }
            _ if self.belief_in_test(scope, e) => Context::True,
            _ => Context::Test(self.expr_of(e, Kind::Bool, env)),
        }
    }

    /// A single name that is neither a variable nor a constant is meant as a belief.
    fn is_literal(&self, path: &ast::Path, env: &Env) -> bool {
        let [name] = path.names.as_slice() else { return false };
        let text = name.text.as_str();
        env.find(text).is_none() && !self.has_value(text) && !is_variable_name(text)
    }

    fn literal(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> Context {
        let belief = self.belief(scope, &call.name);
        let fields = belief.map(|b| self.belief_fields(scope.id, b));
        let args = self.matched(Noun::Belief, call, fields.as_ref(), env, true);
        belief.map_or(Context::True, |b| Context::Belief(b, args, call.span))
    }

    /// After an alternative a variable has a value if both sides give it one.
    fn either(&mut self, scope: &Scope, left: &ast::Expr, right: &ast::Expr, env: &mut Env) -> Context {
        let before: Vec<bool> = env.locals.iter().map(|l| l.bound).collect();
        let mut parts = Vec::new();
        let mut after: Vec<Vec<bool>> = Vec::new();
        for side in [left, right] {
            match self.context(scope, side, env) {
                Context::Or(more) => parts.extend(more),
                one => parts.push(one),
            }
            after.push(env.locals.iter().map(|l| l.bound).collect());
            restore(env, &before);
        }
        for (i, local) in env.locals.iter_mut().enumerate() {
            local.bound = after.iter().all(|bound| bound.get(i).copied().unwrap_or(false));
        }
        Context::Or(parts)
    }

    /// A belief inside of a comparison is a frequent slip.
    fn belief_in_test(&mut self, scope: &Scope, e: &ast::Expr) -> bool {
        let Syntax::Binary { left, right, .. } = &e.kind else { return false };
        for side in [left, right] {
            if let Syntax::Call { callee, .. } = &side.kind
                && callee.names.len() == 1
                && self.kind_in_agent(scope, &callee.names[0].text) == Some(Noun::Belief)
            {
                let name = &callee.names[0];
                let issue = names::wrong_kind(Noun::Function, Noun::Belief, &name.text, name.span, []);
                self.report(issue.help(format!("bind its value first: `{}(X) && X …`", name.text)));
                return true;
            }
        }
        false
    }

    // ── body ──

    fn step(&mut self, scope: &Scope, step: &ast::Step, env: &mut Env) -> Option<Step> {
        let kind = match &step.kind {
            SyntaxStep::Do(call) => self.act_of(scope, call, env)?,
            SyntaxStep::Achieve(call) => {
                let (goal, args) = self.adopt(scope, call, env);
                StepKind::Achieve(goal?, args)
            }
            SyntaxStep::Spawn(call) => {
                let (goal, args) = self.adopt(scope, call, env);
                StepKind::Spawn(goal?, args)
            }
            SyntaxStep::Query(call) => {
                let (belief, args) = self.belief_step(scope, call, env, true);
                StepKind::Query(belief?, args)
            }
            SyntaxStep::Remove(call) => {
                let (belief, args) = self.belief_step(scope, call, env, false);
                StepKind::Remove(belief?, args)
            }
            SyntaxStep::Add(call) => {
                let (belief, args) = self.new_belief(scope, call, env);
                StepKind::Add(belief?, args)
            }
            SyntaxStep::Replace(call) => {
                let (belief, args) = self.new_belief(scope, call, env);
                StepKind::Replace(belief?, args)
            }
            SyntaxStep::Await { events, within } => {
                let actor = self.s.agents[usize::from(scope.id.0)].actor;
                let mut patterns = Vec::new();
                for (pattern, span) in self.patterns_with(events, env) {
                    self.perceives(actor, pattern.event, span, false);
                    patterns.push(pattern);
                }
                let within = within.as_ref().and_then(|e| self.time(e, "the time to wait", true));
                StepKind::Await { events: patterns, within }
            }
            SyntaxStep::Wait(time) => StepKind::Wait(self.expr_of(time, Kind::Float(Dim::TIME), env)),
            SyntaxStep::Error => return None,
        };
        Some(Step { kind, span: step.span })
    }

    /// A stimulus or event of the agent's own actor.
    fn act_of(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> Option<StepKind> {
        let local = self.kind_in_agent(scope, &call.name.text);
        let event = self.event(Noun::EventOrStimulus, &call.name, local)?;
        self.owns(self.s.agents[usize::from(scope.id.0)].actor, event, call);
        let fields = self.fields_of(event);
        Some(StepKind::Do(event, self.args(self.noun_of(event), call, &fields, env)))
    }

    pub(super) fn noun_of(&self, event: EventId) -> Noun {
        let stimulus = self.s.events[usize::from(event.0)].stimulus.is_some();
        if stimulus { Noun::Stimulus } else { Noun::Event }
    }

    /// Only the events of the actor that is played can be made.
    pub(super) fn owns(&mut self, actor: ActorId, event: EventId, call: &Call) {
        let from = self.s.events[usize::from(event.0)].from;
        if from != actor && from != NOBODY && actor != NOBODY {
            let (owner, player) = (self.actor_name(from), self.actor_name(actor));
            let issue = roles::not_its_event(&call.name.text, owner, player, call.name.span);
            self.report(issue);
        }
    }

    fn adopt(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> (Option<crate::GoalId>, Vec<Expr>) {
        let goal = self.goal(scope, call);
        let args = call.args.as_deref().unwrap_or_default().iter().map(|a| self.expr(a, env)).collect();
        (goal, args)
    }

    fn belief_step(
        &mut self,
        scope: &Scope,
        call: &Call,
        env: &mut Env,
        binds: bool,
    ) -> (Option<BeliefId>, Vec<Arg>) {
        let belief = self.belief(scope, &call.name);
        let fields = belief.map(|b| self.belief_fields(scope.id, b));
        (belief, self.matched(Noun::Belief, call, fields.as_ref(), env, binds))
    }

    fn new_belief(&mut self, scope: &Scope, call: &Call, env: &mut Env) -> (Option<BeliefId>, Vec<Expr>) {
        let belief = self.belief(scope, &call.name);
        let args = match belief {
            Some(b) => {
                let fields = self.belief_fields(scope.id, b);
                self.args(Noun::Belief, call, &fields, env)
            }
            None => Vec::new(),
        };
        (belief, args)
    }
}

/// Undoes the bindings made since; variables first seen since then stay known, without a value.
fn restore(env: &mut Env, before: &[bool]) {
    for (i, local) in env.locals.iter_mut().enumerate() {
        local.bound = before.get(i).copied().unwrap_or(false);
    }
}
