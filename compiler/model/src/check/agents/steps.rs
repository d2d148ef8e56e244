//! The steps of plans.

use hrdsl_syntax::ast::{self, CallSyntax, StepSyntaxKind as Syntax};

use crate::check::{
    agents::{
        agent::AgentScope,
        context::{known, restore},
        phase::AgentsPhase,
    },
    state::scope::ExprEnv,
    template::CheckerPhase,
    value::quantity::MAX_TIME,
};
use crate::{
    Dimension, GoalId, InferredType, TypedContext, TypedExpr, TypedStep, TypedStepKind, Value, noun::Noun,
    report::types,
};

impl AgentsPhase<'_, '_> {
    pub(in crate::check) fn plan_body(
        &mut self,
        scope: &AgentScope,
        steps: &[ast::StepSyntax],
        env: &mut ExprEnv,
    ) -> Vec<TypedStep> {
        let step = |s: &ast::StepSyntax| Some(TypedStep { kind: self.step(scope, s, env)?, origin: s.span });
        steps.iter().filter_map(step).collect()
    }

    fn step(
        &mut self,
        scope: &AgentScope,
        step: &ast::StepSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedStepKind> {
        Some(match &step.kind {
            Syntax::Do(call) => self.act_of(scope, call, env)?,
            Syntax::Achieve { call, within } => {
                let (goal, args) = self.adopt(scope, call, true, env);
                let within = within.as_ref().map(|e| self.duration(e, "the time for the goal", env));
                TypedStepKind::Achieve { goal: goal?, args, within }
            }
            Syntax::Spawn(call) => {
                let (goal, args) = self.adopt(scope, call, false, env);
                TypedStepKind::Spawn { goal: goal?, args }
            }
            Syntax::Query(literal) => {
                TypedStepKind::Query(self.literal(scope, literal, env, (true, true))?)
            }
            Syntax::Test(formula) => TypedStepKind::Test(self.context(scope, formula, env)),
            Syntax::Unify { left, right } => TypedStepKind::Test(self.unify(left, right, env)),
            Syntax::Add(literal) => TypedStepKind::Add(self.assertion(scope, literal, env)?),
            Syntax::Remove(literal) => {
                TypedStepKind::Remove(self.literal(scope, literal, env, (true, false))?)
            }
            Syntax::Replace(literal) => TypedStepKind::Replace(self.assertion(scope, literal, env)?),
            Syntax::Await { events, within } => {
                let actor = self.s.agents[usize::from(scope.id.0)].actor;
                let mut patterns = Vec::new();
                for (pattern, span) in self.patterns_with(events, env) {
                    self.perceives(actor, pattern.event, span, false);
                    patterns.push(pattern);
                }
                let within = within.as_ref().map(|e| self.duration(e, "the time to wait", env));
                TypedStepKind::Await { events: patterns, within }
            }
            Syntax::Wait(time) => {
                TypedStepKind::Wait { seconds: self.expr_of(time, InferredType::Float(Dimension::TIME), env) }
            }
            Syntax::Internal(call) => self.internal_step(scope, call, env)?,
            Syntax::If { condition, then, otherwise } => {
                self.if_step(scope, condition, (then, otherwise), step.span, env)
            }
            Syntax::While { condition, body } => {
                let (condition, body) = self.loop_step(scope, condition, body, env);
                TypedStepKind::While { condition, body }
            }
            Syntax::For { condition, body } => {
                let (condition, body) = self.loop_step(scope, condition, body, env);
                TypedStepKind::For { condition, body }
            }
            Syntax::Fork { all, branches } => {
                // What a branch binds is its own.
                let before = known(env);
                let mut done = Vec::new();
                for branch in branches {
                    done.push(self.plan_body(scope, branch, env));
                    restore(env, &before);
                }
                TypedStepKind::Fork { branches: done, all: *all }
            }
            Syntax::Error => return None,
        })
    }

    /// After it a variable has a value if both ways give it one.
    fn if_step(
        &mut self,
        scope: &AgentScope,
        condition: &ast::ExprSyntax,
        (then, otherwise): (&[ast::StepSyntax], &[ast::StepSyntax]),
        span: hrdsl_source::Span,
        env: &mut ExprEnv,
    ) -> TypedStepKind {
        let before = known(env);
        let condition_span = condition.span;
        let condition = self.context(scope, condition, env);
        let then = self.plan_body(scope, then, env);
        let after_then = known(env);
        restore(env, &before);
        let otherwise = self.plan_body(scope, otherwise, env);
        let after_otherwise = known(env);
        let span = if condition_span.file == span.file { condition_span } else { span };
        self.join(&after_then, &after_otherwise, span, env);
        TypedStepKind::If { condition, then, otherwise }
    }

    /// What a loop binds is open again each time, and after it.
    fn loop_step(
        &mut self,
        scope: &AgentScope,
        condition: &ast::ExprSyntax,
        body: &[ast::StepSyntax],
        env: &mut ExprEnv,
    ) -> (TypedContext, Vec<TypedStep>) {
        let before = known(env);
        let condition = self.context(scope, condition, env);
        let body = self.plan_body(scope, body, env);
        restore(env, &before);
        (condition, body)
    }

    /// A time; one that is known must be positive.
    pub(in crate::check) fn duration(
        &mut self,
        e: &ast::ExprSyntax,
        what: &str,
        env: &mut ExprEnv,
    ) -> TypedExpr {
        let time = self.expr_of(e, InferredType::Float(Dimension::TIME), env);
        if let Some(t) = time.constant().and_then(Value::as_f64) {
            if t <= 0.0 {
                self.report(types::must_be(what, "more than 0 s", e.span));
            } else if t > MAX_TIME {
                self.report(types::must_be(what, &format!("at most {MAX_TIME} s"), e.span));
            }
        }
        time
    }

    /// A stimulus or event of the agent's own actor.
    fn act_of(&mut self, scope: &AgentScope, call: &CallSyntax, env: &mut ExprEnv) -> Option<TypedStepKind> {
        let local = self.kind_in_agent(scope, &call.name.text);
        let event = self.event(Noun::EventOrStimulus, &call.name, local)?;
        let (actor, noun) = (self.s.agents[usize::from(scope.id.0)].actor, self.noun_of(event));
        self.owns(actor, event, call);
        let fields = self.fields_of(event);
        let args = self.args(noun, call, &fields, env);
        Some(TypedStepKind::Do { event, args })
    }

    fn adopt(
        &mut self,
        scope: &AgentScope,
        call: &CallSyntax,
        waits: bool,
        env: &mut ExprEnv,
    ) -> (Option<GoalId>, Vec<TypedExpr>) {
        let goal = self.goal(scope, call);
        let fields = goal.and_then(|g| self.goal_fields(scope.id, g));
        let (opened, ungiven) = match goal.filter(|_| waits) {
            Some(goal) => self.open_args(scope, goal, call, fields.as_ref(), env),
            None => (call.clone(), Vec::new()),
        };
        let args = match fields {
            Some(fields) => self.args(Noun::Goal, &opened, &fields, env),
            None => opened.args.as_deref().unwrap_or_default().iter().map(|a| self.expr(a, env)).collect(),
        };
        self.say_ungiven(&call.name.text, ungiven);
        (goal, args)
    }
}
