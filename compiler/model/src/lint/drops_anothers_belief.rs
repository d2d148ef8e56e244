//! HR0406: a plan drops the belief that another plan handles, and keeps its own: a copy that was not changed throughout.

use std::collections::BTreeSet;

use hrdsl_source::{Diagnostic, DiagnosticCode, Span};

use super::{
    agent_facts::{AgentFacts, BeliefChange, agents, all_steps, change, literals},
    facts::ScenarioFacts,
    plan_terms::{PlanTerm, may_unify, of_args},
};
use crate::{BeliefId, GoalId, Scenario, TriggerOn, TypedPlan, TypedStepKind, TypedTerm, Value};

/// Sub-goals of sub-goals that are looked into.
const FAR: usize = 400;

/// A belief that a plan is about: of its trigger, or one that its context needs.
struct HandledBeliefs<'a> {
    belief: BeliefId,
    args: &'a [TypedTerm],
    terms: Vec<PlanTerm<'a>>,
    span: Span,
}

impl HandledBeliefs<'_> {
    fn meets(&self, belief: BeliefId, args: &[PlanTerm<'_>], apart: bool) -> bool {
        self.belief == belief && may_unify(&self.terms, args, apart)
    }

    /// As it is written, if that is known.
    fn text(&self, facts: &AgentFacts<'_>, plan: &TypedPlan) -> Option<String> {
        let arg = |arg: &TypedTerm| match PlanTerm::of_arg(arg) {
            PlanTerm::Any => Some("_".to_owned()),
            PlanTerm::Var(var) => plan.vars.get(usize::from(var)).cloned(),
            PlanTerm::Const(value @ (Value::Bool(_) | Value::Int(_) | Value::Symbol(_))) => {
                Some(value.to_string())
            }
            PlanTerm::Const(Value::Float(_) | Value::Text(_) | Value::List(_))
            | PlanTerm::Other(_)
            | PlanTerm::Part => None,
        };
        let args: Vec<String> = self.args.iter().map(arg).collect::<Option<_>>()?;
        let name = &facts.belief(self.belief).name;
        Some(if args.is_empty() { name.clone() } else { format!("{name}({})", args.join(", ")) })
    }
}

fn handled(plan: &TypedPlan) -> Vec<HandledBeliefs<'_>> {
    let trigger = match plan.trigger.on {
        TriggerOn::BeliefAdded(b) => Some((b, plan.trigger.args.as_slice(), plan.trigger.origin)),
        TriggerOn::BeliefRemoved(_)
        | TriggerOn::GoalAdded(_)
        | TriggerOn::GoalFailed(_)
        | TriggerOn::TestAdded(_)
        | TriggerOn::TestFailed(_)
        | TriggerOn::Perceived(_) => None,
    };
    let context = literals(&plan.context).into_iter().filter(|l| !l.negated);
    let all = trigger.into_iter().chain(context.map(|l| (l.belief, l.args, l.span)));
    all.map(|(belief, args, span)| HandledBeliefs { belief, args, terms: of_args(args), span }).collect()
}

pub(crate) fn check<'a>(scenario: &'a Scenario, all: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    for facts in agents(scenario, all) {
        for plan in &facts.agent.plans {
            // Blocks, and removals of what others have told, are no copies of anything.
            let has_blocks = plan.body.iter().any(|s| !s.blocks().is_empty());
            for (at, step) in plan.body.iter().enumerate().filter(|_| !has_blocks) {
                let plain = matches!(&step.kind, TypedStepKind::Remove(l) if l.annotations.is_empty());
                if !plain || !facts.work(facts.size()) {
                    continue;
                }
                if let Some(BeliefChange::Removes(belief, args)) = change(step) {
                    let dropped = DroppedBelief { facts, plan, at, belief, args };
                    issues.extend(dropped.issue(step.origin));
                }
            }
        }
    }
}

/// A plan's step that drops a belief.
struct DroppedBelief<'a> {
    facts: AgentFacts<'a>,
    plan: &'a TypedPlan,
    at: usize,
    belief: BeliefId,
    args: Vec<PlanTerm<'a>>,
}

impl<'a> DroppedBelief<'a> {
    fn issue(&self, span: Span) -> Option<Diagnostic> {
        let own = handled(self.plan);
        if own.iter().any(|h| h.meets(self.belief, &self.args, false))
            || makes(self.plan, self.at, self.belief, &self.args, false)
            || self.made_by_subgoals()
            || self.known_to_callers()
        {
            return None;
        }
        let (kept, other) = own.iter().find_map(|kept| {
            if !self.keeps(kept) {
                return None;
            }
            let other = self.facts.agent.plans.iter().find(|other| self.is_copied(kept, other))?;
            Some((kept, other))
        })?;
        let name = &self.facts.belief(self.belief).name;
        let message =
            format!("this drops a `{name}` that another plan handles, and the plan keeps its own belief");
        let theirs = handled(other).into_iter().find(|h| h.meets(self.belief, &self.args, true))?;
        let issue = Diagnostic::warning(DiagnosticCode::DROPS_ANOTHERS_BELIEF, span, message)
            .label(kept.span, "the plan handles this belief, and nothing drops it")
            .label(theirs.span, "this plan handles the dropped belief, and drops it itself");
        let kept = kept.text(&self.facts, self.plan);
        Some(match kept {
            Some(kept) => issue.help(format!("did you mean `-{kept}`?")).fix(
                format!("drop `{kept}`"),
                span,
                format!("-{kept}"),
                false,
            ),
            None => issue.help("drop the belief that this plan handles"),
        })
    }

    /// Whether the plan looks like a copy of `other`, whose belief it drops in place of `kept`.
    fn is_copied(&self, kept: &HandledBeliefs<'_>, other: &'a TypedPlan) -> bool {
        let owns = !std::ptr::eq(other, self.plan)
            && handled(other).iter().any(|h| h.meets(self.belief, &self.args, true) && consumes(other, h));
        owns && (kept.belief == self.belief || self.same_part(kept, other))
    }

    /// Whether neither this plan nor another one that handles the belief uses it up.
    fn keeps(&self, kept: &HandledBeliefs<'_>) -> bool {
        !consumes(self.plan, kept)
            && !self
                .facts
                .agent
                .plans
                .iter()
                .any(|p| handled(p).iter().any(|h| h.meets(kept.belief, &kept.terms, true) && consumes(p, h)))
    }

    /// Beliefs of different names are taken for copies of each other if they play the same part: both or neither are the
    /// trigger, of triggers of one kind, and they come about alike. What a suite chooses is most often asked, not used up.
    fn same_part(&self, kept: &HandledBeliefs<'_>, other: &TypedPlan) -> bool {
        let is_trigger = |plan: &TypedPlan, belief| plan.trigger.on == TriggerOn::BeliefAdded(belief);
        let alike =
            std::mem::discriminant(&self.plan.trigger.on) == std::mem::discriminant(&other.trigger.on);
        let state = self.plan.body.iter().filter_map(change).any(|c| {
            c.belief() == self.belief && matches!(c, BeliefChange::Adds(..) | BeliefChange::Replaces(..))
        });
        let given = |b| self.facts.is_given(b);
        let added = |b| self.facts.is_added(b);
        alike
            && !state
            && is_trigger(self.plan, kept.belief) == is_trigger(other, self.belief)
            && ((given(kept.belief) && given(self.belief)) || (added(kept.belief) && added(self.belief)))
    }

    /// The sub-goals before it may have added the belief.
    fn made_by_subgoals(&self) -> bool {
        let mut seen = BTreeSet::new();
        let before = &self.plan.body[..self.at];
        before
            .iter()
            .filter_map(|step| step.kind.as_adoption())
            .any(|(goal, _)| self.goal_makes(goal, &mut seen))
    }

    fn goal_makes(&self, goal: GoalId, seen: &mut BTreeSet<GoalId>) -> bool {
        // So many goals may well make it.
        if seen.len() == FAR {
            return true;
        }
        if !seen.insert(goal) {
            return false;
        }
        self.facts.plans(TriggerOn::GoalAdded(goal)).chain(self.facts.plans(TriggerOn::GoalFailed(goal))).any(
            |plan| {
                makes(plan, plan.body.len(), self.belief, &self.args, true)
                    || all_steps(&plan.body)
                        .into_iter()
                        .filter_map(|step| step.kind.as_adoption())
                        .any(|(goal, _)| self.goal_makes(goal, seen))
            },
        )
    }

    /// A plan on the way to this one handles the belief, or has made it.
    fn known_to_callers(&self) -> bool {
        let mut seen = BTreeSet::from([self.plan.origin]);
        let mut open = vec![self.plan];
        while let Some(plan) = open.pop() {
            for caller in callers(&self.facts, plan) {
                if !seen.insert(caller.origin) {
                    continue;
                }
                let knows = handled(caller).iter().any(|h| h.meets(self.belief, &self.args, true))
                    || makes(caller, caller.body.len(), self.belief, &self.args, true);
                if knows {
                    return true;
                }
                open.push(caller);
            }
        }
        false
    }
}

/// Whether a plan takes away or replaces a belief that it handles.
fn consumes(plan: &TypedPlan, handled: &HandledBeliefs<'_>) -> bool {
    all_steps(&plan.body).into_iter().filter_map(change).any(|c| match c {
        BeliefChange::Removes(b, args) => handled.meets(b, &args, false),
        BeliefChange::Replaces(b, _) => handled.belief == b,
        BeliefChange::Adds(..) => false,
    })
}

/// Whether a step before `at` adds a fact that is dropped, or asks for it.
fn makes(plan: &TypedPlan, at: usize, belief: BeliefId, args: &[PlanTerm<'_>], apart: bool) -> bool {
    all_steps(&plan.body[..at]).into_iter().any(|step| match (&step.kind, change(step)) {
        (TypedStepKind::Query(l), _) => l.belief == belief && may_unify(&of_args(&l.args), args, apart),
        (_, Some(BeliefChange::Adds(b, made) | BeliefChange::Replaces(b, made))) => {
            b == belief && may_unify(&made, args, apart)
        }
        (_, Some(BeliefChange::Removes(..)) | None) => false,
    })
}

/// The plans that adopt the plan's goal; a failure plan goes on after the plans for its goal.
fn callers<'a>(facts: &AgentFacts<'a>, plan: &TypedPlan) -> Vec<&'a TypedPlan> {
    let (goal, failed) = match plan.trigger.on {
        TriggerOn::GoalAdded(goal) => (goal, false),
        TriggerOn::GoalFailed(goal) => (goal, true),
        TriggerOn::TestAdded(belief) | TriggerOn::TestFailed(belief) => {
            return facts.askers(belief).map(|(plan, _)| plan).collect();
        }
        TriggerOn::BeliefAdded(_) | TriggerOn::BeliefRemoved(_) | TriggerOn::Perceived(_) => {
            return Vec::new();
        }
    };
    let mut all: Vec<&TypedPlan> = facts.adopters(goal).collect();
    all.sort_by_key(|p| p.origin);
    all.dedup_by_key(|p| p.origin);
    if failed {
        all.extend(facts.plans(TriggerOn::GoalAdded(goal)));
    }
    all
}
