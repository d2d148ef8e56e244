//! Which goals an agent adopts, by itself or because another asks for them, and which have plans.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AgentMemberKind as Member, ExprSyntaxKind as Syntax, StepSyntaxKind, TriggerSyntaxKind,
};

use crate::check::{
    agents::{agent::AgentScope, phase::AgentsPhase},
    state::{names::GoalEntry, table::OrderedMap},
};
use crate::report::agents::{not_adopted, only_declared};

/// A goal as it is adopted: `table`, `deliver(…)`.
pub(super) fn written(name: &ast::NameSyntax, params: &[ast::ParamSyntax]) -> String {
    if params.is_empty() { name.text.clone() } else { format!("{}(…)", name.text) }
}

/// The agent itself adopts the goal.
pub(super) fn adopts(agent: &ast::AgentSyntax, goal: &str) -> bool {
    let mut found = false;
    for member in &agent.members {
        match &member.kind {
            Member::Goal(call) => found |= call.name.text == goal,
            Member::Plan(plan) => each_step(&plan.body, &mut |step| {
                if let StepSyntaxKind::Achieve { call, .. } | StepSyntaxKind::Spawn(call) = &step.kind {
                    found |= call.name.text == goal;
                }
            }),
            Member::Belief { .. }
            | Member::Rule { .. }
            | Member::GoalType { .. }
            | Member::Allow(_)
            | Member::Error => {}
        }
    }
    found
}

/// The goals whose types are declared: each as it would be adopted.
fn typed_goals(agent: &ast::AgentSyntax) -> BTreeMap<&str, (String, Span)> {
    let mut goals = BTreeMap::new();
    for member in &agent.members {
        if let Member::GoalType { name, params } = &member.kind {
            goals.entry(name.text.as_str()).or_insert_with(|| (written(name, params), name.span));
        }
    }
    goals
}

impl AgentsPhase<'_, '_> {
    /// Plans for goals that nothing adopts: most often one of a goal's plans is misspelt.
    pub(super) fn unadopted(&mut self, scope: &AgentScope, agent: &ast::AgentSyntax) {
        let mut adopted: BTreeSet<&str> = self.asked_goals.clone();
        let mut here: indexmap::IndexSet<&str> = indexmap::IndexSet::new();
        let mut broken = false;
        for member in &agent.members {
            match &member.kind {
                Member::Goal(call) => here.extend([call.name.text.as_str()]),
                Member::Plan(plan) => each_step(&plan.body, &mut |step| {
                    if let StepSyntaxKind::Achieve { call, .. } | StepSyntaxKind::Spawn(call) = &step.kind {
                        here.extend([call.name.text.as_str()]);
                    }
                    // It may have been an adoption.
                    broken |= step.kind == StepSyntaxKind::Error;
                }),
                Member::Belief { .. } | Member::Rule { .. } | Member::GoalType { .. } | Member::Allow(_) => {}
                Member::Error => broken = true,
            }
        }
        let goals = &self.names.goals[usize::from(scope.id.0)];
        if broken || here.iter().any(|goal| !goals.contains_key(*goal)) {
            // An adoption is misspelt, and has its diagnostic: it may be the one that is missing.
            return;
        }
        adopted.extend(here.iter().copied());
        let typed = typed_goals(agent);
        for member in &agent.members {
            if let Member::Plan(plan) = &member.kind
                && plan.trigger.kind == TriggerSyntaxKind::Achieve
                && !adopted.contains(plan.trigger.literal.call.name.text.as_str())
            {
                let name = &plan.trigger.literal.call.name;
                let issue = not_adopted(&name.text, name.span, here.iter().copied());
                let issue = match typed.get(name.text.as_str()) {
                    Some((written, span)) => only_declared(issue, written, *span),
                    None => issue,
                };
                self.report(issue);
            }
        }
    }
}

/// The goals with a plan `+!g`, by the first plan for each.
pub(super) fn achieved(agent: &ast::AgentSyntax) -> OrderedMap<String, GoalEntry> {
    let mut goals = OrderedMap::default();
    for member in &agent.members {
        if let Member::Plan(plan) = &member.kind
            && plan.trigger.kind == TriggerSyntaxKind::Achieve
        {
            let call = &plan.trigger.literal.call;
            let arity = call.args.as_ref().map_or(0, Vec::len);
            let entry = GoalEntry { arity, fields: None, place: call.name.span };
            goals.entry(call.name.text.clone()).or_insert(entry);
        }
    }
    goals
}

/// Calls `f` with each step, those within blocks too.
fn each_step<'a>(steps: &'a [ast::StepSyntax], f: &mut dyn FnMut(&'a ast::StepSyntax)) {
    for step in steps {
        f(step);
        if let StepSyntaxKind::If { then, otherwise, .. } = &step.kind {
            each_step(then, f);
            each_step(otherwise, f);
        } else if let StepSyntaxKind::While { body, .. } | StepSyntaxKind::For { body, .. } = &step.kind {
            each_step(body, f);
        } else if let StepSyntaxKind::Fork { branches, .. } = &step.kind {
            branches.iter().for_each(|b| each_step(b, f));
        }
    }
}

/// The goals that an agent asks others to achieve.
pub(super) fn asked_goals<'a>(agent: &'a ast::AgentSyntax, goals: &mut BTreeSet<&'a str>) {
    for member in &agent.members {
        let Member::Plan(plan) = &member.kind else { continue };
        each_step(&plan.body, &mut |step| {
            let StepSyntaxKind::Internal(call) = &step.kind else { return };
            let args = call.args.as_deref().unwrap_or_default();
            let message = match (call.name.text.as_str(), args) {
                ("send", [_, how, what]) | ("broadcast", [how, what]) => Some((how, what)),
                _ => None,
            };
            if let Some((how, what)) = message
                && matches!(&how.kind, Syntax::Path(p) if p.names.len() == 1 && p.names[0].text == "achieve")
                && let Syntax::Path(name) | Syntax::Call { callee: name, .. } = &what.kind
            {
                goals.extend(name.names.first().map(|n| n.text.as_str()));
            }
        });
    }
}
