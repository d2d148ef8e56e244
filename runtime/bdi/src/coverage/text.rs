//! Items and contexts as text for people, in the language as far as possible.

use hrdsl_ir::{
    Program,
    bdi::{Agent, BeliefId, ContentId, GoalId, PlanStepKind, TriggerOn},
    cover_item::{AgentCoverItem, ApplicableCount},
    known_name,
};

use super::universe::sites;
use crate::show::performative as performative_name;

/// Where an item is, without the [words](hrdsl_ir::suite::CoverItemKind::words) that say of which kind it is: `Human.leg#2`,
/// `Human.table#1 -> leg#2 (step 3)`.
#[must_use]
pub fn place(program: &Program, agent: &Agent, item: AgentCoverItem) -> String {
    let label = |plan: u16| &agent.plan(plan).label;
    let owner = &agent.name;
    match item {
        AgentCoverItem::Selected(plan)
        | AgentCoverItem::Completed(plan)
        | AgentCoverItem::Failed(plan)
        | AgentCoverItem::Context { plan, .. } => format!("{owner}.{}", label(plan)),
        AgentCoverItem::Applicable { on, plans } => {
            let many = match plans {
                ApplicableCount::None => "none",
                ApplicableCount::One => "one",
                ApplicableCount::Many => "many",
            };
            format!("{owner}.{} {many}", trigger(program, agent, on))
        }
        AgentCoverItem::Message { plan, site } => {
            let what = message(program, agent, plan, site);
            format!("{owner}.{}: {what} (step {})", label(plan), site + 1)
        }
        AgentCoverItem::Edge { plan, site, by } => {
            format!("{owner}.{} -> {} (step {})", label(plan), label(by), site + 1)
        }
        AgentCoverItem::Path([a, b, c]) => {
            format!("{owner}: {} > {} > {}", label(a), label(b), label(c))
        }
    }
}

/// `tell seen`
fn message(program: &Program, agent: &Agent, plan: u16, site: u16) -> String {
    let name = |content: ContentId| &program.content(content).name;
    let steps = sites(agent.plan(plan));
    let said = match steps.get(usize::from(site)).map(|s| &s.kind) {
        Some(PlanStepKind::Send { performative, content, .. }) => {
            Some(format!("{} {}", performative_name(*performative), name(*content)))
        }
        Some(PlanStepKind::Ask { content, .. }) => Some(format!("ask {}", name(*content))),
        Some(PlanStepKind::AskAll { content, .. }) => Some(format!("ask_all {}", name(*content))),
        Some(_) | None => None,
    };
    known_name("message in this step", said.as_deref()).to_owned()
}

pub(super) fn belief(agent: &Agent, id: BeliefId) -> &str {
    &agent.belief(id).name
}

pub(super) fn goal(agent: &Agent, id: GoalId) -> &str {
    &agent.goal(id).name
}

/// A trigger without its arguments: `+!leg`, `on discarded`.
#[must_use]
pub fn trigger(program: &Program, agent: &Agent, on: TriggerOn) -> String {
    match on {
        TriggerOn::BeliefAdded(b) => format!("+{}", belief(agent, b)),
        TriggerOn::BeliefRemoved(b) => format!("-{}", belief(agent, b)),
        TriggerOn::GoalAdded(g) => format!("+!{}", goal(agent, g)),
        TriggerOn::GoalFailed(g) => format!("-!{}", goal(agent, g)),
        TriggerOn::TestAdded(b) => format!("+?{}", belief(agent, b)),
        TriggerOn::TestFailed(b) => format!("-?{}", belief(agent, b)),
        TriggerOn::Perceived(e) => format!("on {}", program.event(e).name),
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::Span;
    use hrdsl_ir::{
        Expr,
        bdi::{AgentTerm, BeliefAnnotation, BeliefLiteral, InternalAct, PlanContext},
        expr::BinaryOp,
    };

    use super::{super::fixture, *};
    use crate::show::context;

    fn written(parts: &PlanContext) -> String {
        let program = fixture::program();
        let human = &program.agents[0];
        context(&program, human, &human.plans[0].vars, parts)
    }

    #[test]
    fn contexts_are_written_as_in_the_language() {
        let program = fixture::program();
        let human = &program.agents[0];
        assert_eq!(written(&human.plans[0].context), "wants(N) && N > 0 && not tired");
        assert_eq!(written(&human.plans[3].context), "near(_) || tired");
        let either = human.plans[3].context.clone();
        assert_eq!(written(&PlanContext::Not(Box::new(either.clone()))), "not (near(_) || tired)");
        assert_eq!(
            written(&PlanContext::And(vec![either, fixture::holds(2, vec![])])),
            "(near(_) || tired) && tired"
        );
        let sum = |a, b| Expr::binary(BinaryOp::Add, a, b);
        let product = Expr::binary(BinaryOp::Mul, sum(Expr::Var(0), Expr::int(1)), Expr::Var(1));
        let e = Expr::binary(BinaryOp::Le, product, sum(Expr::Var(0), sum(Expr::Var(1), Expr::float(2.5))));
        assert_eq!(written(&PlanContext::Test(e.clone())), "(N + 1) * M <= N + (M + 2.5)");
        assert_eq!(
            written(&PlanContext::Not(Box::new(PlanContext::Test(Expr::binary(BinaryOp::Or, e.clone(), e))))),
            "not ((N + 1) * M <= N + (M + 2.5) || (N + 1) * M <= N + (M + 2.5))"
        );
    }

    #[test]
    fn annotations_lists_and_internal_actions_are_written() {
        let source =
            AgentTerm::Expr(Expr::Const(hrdsl_ir::Value::Symbol(hrdsl_ir::Symbol::intern("percept"))));
        let literal = BeliefLiteral {
            origin: Span::default(),
            belief: BeliefId(0),
            args: vec![AgentTerm::List(vec![AgentTerm::Var(0)], Some(Box::new(AgentTerm::Any)))],
            annotations: vec![(BeliefAnnotation::Source, source)],
        };
        assert_eq!(written(&PlanContext::Belief(literal)), "wants([N | _])[source(percept)]");
        let count =
            InternalAct::Count { formula: fixture::holds(1, vec![AgentTerm::Any]), out: AgentTerm::Var(1) };
        assert_eq!(written(&PlanContext::Internal(Box::new(count), Span::default())), ".count(near(_), M)");
        let intend = InternalAct::Intend { goal: GoalId(1), args: vec![AgentTerm::Any] };
        assert_eq!(written(&PlanContext::Internal(Box::new(intend), Span::default())), ".intend(leg(_))");
        let unify =
            PlanContext::Unify(AgentTerm::Var(0), Expr::binary(BinaryOp::Sub, Expr::Var(1), Expr::int(1)));
        assert_eq!(written(&unify), "N = M - 1");
    }
}
