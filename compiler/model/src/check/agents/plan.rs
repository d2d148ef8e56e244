//! Plans: trigger, context, body; each variable must have a value before it is read, from left to right.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, TriggerSyntaxKind};

use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    state::{issues::too_many, scope::ExprEnv, table::MAX_NAMES},
    template::CheckerPhase,
};
use crate::{
    BeliefAnnotation, BeliefId, TriggerOn, TypedContext, TypedPlan, TypedTerm, TypedTrigger,
    noun::Noun,
    report::{agents, names},
};

/// A trigger: what it is on, its arguments and annotations.
type MatchedTrigger = (TriggerOn, Vec<TypedTerm>, Vec<(BeliefAnnotation, TypedTerm)>);

impl AgentsPhase<'_, '_> {
    pub(in crate::check) fn plan(
        &mut self,
        scope: &mut AgentScope,
        plan: &ast::PlanSyntax,
        span: Span,
    ) -> Option<TypedPlan> {
        let (label, atomic) = self.label(scope, plan);
        let mut env = ExprEnv { plan: true, noun: Some(Noun::Variable), ..ExprEnv::default() };
        let trigger = self.trigger(scope, &plan.trigger, &mut env);
        let wanted = trigger
            .as_ref()
            .and_then(|(on, args, _)| self.open_trigger(scope, (*on, args), &plan.trigger, &mut env));
        let context = match &plan.context {
            Some(e) => self.context(scope, e, &mut env),
            None => TypedContext::True,
        };
        let body = self.plan_body(scope, &plan.body, &mut env);
        if let Some(wanted) = &wanted {
            self.close_trigger(scope, wanted, &body, &plan.trigger, &env);
        }
        self.say_unread(&env);
        if env.locals.len() > MAX_NAMES {
            let message = format!("the plan has more than {MAX_NAMES} variables");
            self.report(too_many(message, plan.trigger.span));
        }
        let vars = env.locals.iter().map(|l| l.name.clone()).collect();
        let (on, args, annotations) = trigger?;
        let (origin, name) = (plan.trigger.span, plan.trigger.literal.call.name.span);
        let trigger = TypedTrigger { on, args, annotations, origin, name };
        Some(TypedPlan { label, atomic, trigger, context, body, vars, origin: span })
    }

    fn label(&mut self, scope: &mut AgentScope, plan: &ast::PlanSyntax) -> (String, bool) {
        let trigger = plan.trigger.literal.call.name.text.clone();
        let count = scope.plans_of.entry(trigger.clone()).or_insert(0);
        *count += 1;
        let made = format!("{trigger}#{count}");
        let Some(label) = &plan.label else { return (made, false) };
        self.issues.declare(&mut scope.labels, Noun::Label, &label.name);
        let atomic = match &label.atomic {
            Some(name) if name.text == "atomic" => true,
            Some(name) => {
                self.report(names::unknown(Noun::Annotation, &name.text, name.span, ["atomic"]));
                false
            }
            None => false,
        };
        (label.name.text.clone(), atomic)
    }

    fn trigger(
        &mut self,
        scope: &AgentScope,
        trigger: &ast::TriggerSyntax,
        env: &mut ExprEnv,
    ) -> Option<MatchedTrigger> {
        let literal = &trigger.literal;
        let make: fn(BeliefId) -> TriggerOn = match trigger.kind {
            TriggerSyntaxKind::Added => TriggerOn::BeliefAdded,
            TriggerSyntaxKind::Removed => TriggerOn::BeliefRemoved,
            TriggerSyntaxKind::Test => TriggerOn::TestAdded,
            TriggerSyntaxKind::TestFailed => TriggerOn::TestFailed,
            TriggerSyntaxKind::Achieve | TriggerSyntaxKind::Failed => {
                return self.goal_trigger(scope, trigger, env);
            }
            TriggerSyntaxKind::On => return self.event_trigger(scope, literal, env),
        };
        let literal = self.literal(scope, literal, env, (true, false))?;
        Some((make(literal.belief), literal.args, literal.annotations))
    }

    fn goal_trigger(
        &mut self,
        scope: &AgentScope,
        trigger: &ast::TriggerSyntax,
        env: &mut ExprEnv,
    ) -> Option<MatchedTrigger> {
        let literal = &trigger.literal;
        self.not_negated(literal, "a goal");
        let goal = self.goal(scope, &literal.call);
        let fields = goal.and_then(|g| self.goal_fields(scope.id, g));
        let args = self.matched(Noun::Goal, &literal.call, fields.as_ref(), env, true);
        let annotations = self.matched_annotations(&literal.annotations, Some(&[]), env, true);
        let goal = goal?;
        let achieve = trigger.kind == TriggerSyntaxKind::Achieve;
        let on = if achieve { TriggerOn::GoalAdded(goal) } else { TriggerOn::GoalFailed(goal) };
        Some((on, args, annotations))
    }

    fn event_trigger(
        &mut self,
        scope: &AgentScope,
        literal: &ast::LiteralSyntax,
        env: &mut ExprEnv,
    ) -> Option<MatchedTrigger> {
        let call = &literal.call;
        self.not_negated(literal, "an event");
        if let Some(first) = literal.annotations.first() {
            self.report(agents::not_annotated("an event", first.span));
        }
        let local = self.kind_in_agent(scope, &call.name.text);
        let event = self.event(Noun::EventOrStimulus, &call.name, local);
        let fields = event.map(|e| self.fields_of(e));
        let args = match (&call.args, event) {
            // Without parentheses any arguments will do.
            (None, Some(event)) => vec![TypedTerm::Any; self.arity_of(event)],
            (Some(_), _) | (None, None) => self.matched(Noun::Event, call, fields.as_ref(), env, true),
        };
        let event = event?;
        let actor = self.s.agents[usize::from(scope.id.0)].actor;
        self.perceives(actor, event, call.name.span, false);
        Some((TriggerOn::Perceived(event), args, Vec::new()))
    }

    /// Only beliefs have a strong negation.
    pub(in crate::check) fn not_negated(&mut self, literal: &ast::LiteralSyntax, what: &str) {
        if literal.negated {
            self.report(agents::not_negated(what, literal.span));
        }
    }
}
