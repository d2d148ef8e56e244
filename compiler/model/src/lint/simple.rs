//! What the search for stuck plans looks into: the constructs whose answers it can make up.

use crate::{Arg, Context, Literal, Plan, Step, StepKind};

/// Whether a plan asks for nothing that is not looked into: annotations, lists, internal actions.
pub(crate) fn is_simple(plan: &Plan) -> bool {
    plan.trigger.annotations.is_empty()
        && is_simple_args(&plan.trigger.args)
        && is_simple_context(&plan.context)
}

fn is_simple_context(context: &Context) -> bool {
    let mut simple = true;
    context.each(&mut |part| {
        simple &= match part {
            Context::Belief(literal) => is_simple_literal(literal),
            Context::Unify(..) | Context::Internal(..) => false,
            Context::True | Context::Not(_) | Context::And(_) | Context::Or(_) | Context::Test(_) => true,
        };
    });
    simple
}

pub(crate) fn is_simple_literal(literal: &Literal) -> bool {
    literal.annotations.is_empty() && is_simple_args(&literal.args)
}

fn is_simple_args(args: &[Arg]) -> bool {
    !args.iter().any(|a| matches!(a, Arg::List(..)))
}

/// Whether what a step binds and changes is known.
pub(crate) fn is_simple_step(step: &Step) -> bool {
    match &step.kind {
        StepKind::Query(literal) => is_simple_literal(literal),
        StepKind::Do { .. }
        | StepKind::Achieve { .. }
        | StepKind::Spawn { .. }
        | StepKind::Add(_)
        | StepKind::Remove(_)
        | StepKind::Replace(_)
        | StepKind::Abolish(_)
        | StepKind::Await { .. }
        | StepKind::Wait { .. }
        | StepKind::Print { .. } => true,
        StepKind::Test(_)
        | StepKind::If { .. }
        | StepKind::While { .. }
        | StepKind::For { .. }
        | StepKind::Fork { .. }
        | StepKind::Send { .. }
        | StepKind::Ask { .. }
        | StepKind::AskAll { .. }
        | StepKind::Control { .. }
        | StepKind::Fail => false,
    }
}
