//! What the search for stuck plans looks into: the constructs whose answers it can make up.

use crate::{TypedContext, TypedLiteral, TypedPlan, TypedStep, TypedStepKind, TypedTerm};

/// Whether a plan asks for nothing that is not looked into: annotations, lists, internal actions.
pub(crate) fn is_simple(plan: &TypedPlan) -> bool {
    plan.trigger.annotations.is_empty()
        && is_simple_args(&plan.trigger.args)
        && is_simple_context(&plan.context)
}

fn is_simple_context(context: &TypedContext) -> bool {
    let mut simple = true;
    context.each(&mut |part| {
        simple &= match part {
            TypedContext::Belief(literal) => is_simple_literal(literal),
            TypedContext::Unify(..) | TypedContext::Internal(..) => false,
            TypedContext::True
            | TypedContext::Not(_)
            | TypedContext::And(_)
            | TypedContext::Or(_)
            | TypedContext::Test(_) => true,
        };
    });
    simple
}

pub(crate) fn is_simple_literal(literal: &TypedLiteral) -> bool {
    literal.annotations.is_empty() && is_simple_args(&literal.args)
}

fn is_simple_args(args: &[TypedTerm]) -> bool {
    !args.iter().any(|a| matches!(a, TypedTerm::List(..)))
}

/// Whether what a step binds and changes is known.
pub(crate) fn is_simple_step(step: &TypedStep) -> bool {
    match &step.kind {
        TypedStepKind::Query(literal) => is_simple_literal(literal),
        TypedStepKind::Do { .. }
        | TypedStepKind::Achieve { .. }
        | TypedStepKind::Spawn { .. }
        | TypedStepKind::Add(_)
        | TypedStepKind::Remove(_)
        | TypedStepKind::Replace(_)
        | TypedStepKind::Abolish(_)
        | TypedStepKind::Await { .. }
        | TypedStepKind::Wait { .. }
        | TypedStepKind::Print { .. } => true,
        TypedStepKind::Test(_)
        | TypedStepKind::If { .. }
        | TypedStepKind::While { .. }
        | TypedStepKind::For { .. }
        | TypedStepKind::Fork { .. }
        | TypedStepKind::Send { .. }
        | TypedStepKind::Ask { .. }
        | TypedStepKind::AskAll { .. }
        | TypedStepKind::Control { .. }
        | TypedStepKind::Fail => false,
    }
}
