//! The items of an agent: all that its program does not rule out.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Expr,
    bdi::{Agent, AgentTerm, Plan, PlanContext, PlanStep, PlanStepKind, PlanTrigger, TriggerOn, each_step},
    cover_item::{AgentCoverItem, ApplicableCount},
    suite::ModelGoal,
};

use crate::measure::AgentCounts;

/// The place of so many plans in [`AgentCounts::applicable`].
fn applicable_place(plans: ApplicableCount) -> usize {
    match plans {
        ApplicableCount::None => 0,
        ApplicableCount::One => 1,
        ApplicableCount::Many => 2,
    }
}

impl AgentCounts {
    /// Whether a run with these counts reached an item.
    #[must_use]
    pub fn reaches(&self, item: AgentCoverItem) -> bool {
        let of = |counts: &[u64], plan: u16| counts.get(usize::from(plan)).copied().unwrap_or(0);
        let count = match item {
            AgentCoverItem::Selected(plan) => of(&self.selected, plan),
            AgentCoverItem::Completed(plan) => of(&self.completed, plan),
            AgentCoverItem::Failed(plan) => of(&self.failed, plan),
            AgentCoverItem::Context { plan, holds } => {
                self.contexts.get(usize::from(plan)).map_or(0, |n| n[usize::from(holds)])
            }
            AgentCoverItem::Applicable { on, plans } => {
                self.applicable.get(&on).map_or(0, |n| n[applicable_place(plans)])
            }
            AgentCoverItem::Message { plan, site } => self.sent.get(&(plan, site)).copied().unwrap_or(0),
            AgentCoverItem::Edge { plan, site, by } => {
                self.edges.get(&(plan, site, by)).copied().unwrap_or(0)
            }
            AgentCoverItem::Path(plans) => self.paths.get(&plans).copied().unwrap_or(0),
        };
        count > 0
    }
}

/// The steps of a plan by their site.
#[must_use]
pub fn sites(plan: &Plan) -> Vec<&PlanStep> {
    let mut steps = Vec::new();
    each_step(&plan.body, &mut |step| steps.push(step));
    steps
}

/// The plans of an agent, and their places.
pub(super) fn numbered(agent: &Agent) -> impl Iterator<Item = (u16, &Plan)> {
    (0u16..).zip(&agent.plans)
}

/// All items of an agent, by kind in the order of [`CoverItemKind::ALL`](hrdsl_ir::suite::CoverItemKind::ALL), in each in the order of the text.
#[must_use]
pub fn universe(agent: &Agent) -> Vec<AgentCoverItem> {
    let selected = numbered(agent).map(|(p, _)| AgentCoverItem::Selected(p));
    let completed =
        numbered(agent).filter(|(_, plan)| can_end(plan)).map(|(p, _)| AgentCoverItem::Completed(p));
    let failed =
        numbered(agent).filter(|(_, plan)| !plan.body.is_empty()).map(|(p, _)| AgentCoverItem::Failed(p));
    let mut all: Vec<AgentCoverItem> = selected.chain(completed).chain(failed).collect();
    for holds in [true, false] {
        let with = numbered(agent).filter(|(_, plan)| plan.context != PlanContext::True);
        all.extend(with.map(|(plan, _)| AgentCoverItem::Context { plan, holds }));
    }
    all.extend(applicable(agent));
    for (plan, declared) in numbered(agent) {
        let steps = (0u16..).zip(sites(declared));
        all.extend(
            steps.filter(|(_, s)| sends(&s.kind)).map(|(site, _)| AgentCoverItem::Message { plan, site }),
        );
    }
    all.extend(edges(agent).into_iter().map(|(plan, site, by)| AgentCoverItem::Edge { plan, site, by }));
    all.extend(paths(agent).into_iter().map(AgentCoverItem::Path));
    all
}

/// The items that a goal of a suite asks for; none for one that is not about an agent.
#[must_use]
pub fn items(agent: &Agent, goal: ModelGoal) -> Vec<AgentCoverItem> {
    let is_meant = |item: &AgentCoverItem| match goal {
        ModelGoal::Bins(_) => false,
        ModelGoal::Plans => matches!(item, AgentCoverItem::Selected(_)),
        ModelGoal::Contexts => matches!(item, AgentCoverItem::Context { .. }),
        ModelGoal::Edges => matches!(item, AgentCoverItem::Edge { .. }),
        ModelGoal::Messages => matches!(item, AgentCoverItem::Message { .. }),
        ModelGoal::Paths => matches!(item, AgentCoverItem::Path(_)),
    };
    universe(agent).into_iter().filter(is_meant).collect()
}

/// A body with a step `.fail` of its own never ends well.
fn can_end(plan: &Plan) -> bool {
    plan.body.iter().all(|s| s.kind != PlanStepKind::Fail)
}

fn sends(step: &PlanStepKind) -> bool {
    matches!(step, PlanStepKind::Send { .. } | PlanStepKind::Ask { .. } | PlanStepKind::AskAll { .. })
}

/// How many plans can be applicable, for each trigger in the order of its first plan.
fn applicable(agent: &Agent) -> Vec<AgentCoverItem> {
    let mut items = Vec::new();
    let mut known = BTreeSet::new();
    for plan in agent.plans.iter().filter(|plan| known.insert(plan.trigger.on)) {
        let on = plan.trigger.on;
        let plans: Vec<&Plan> = agent.plans.iter().filter(|p| p.trigger.on == on).collect();
        let always = plans.iter().filter(|p| is_always_applicable(p)).count();
        let can_be = [
            (ApplicableCount::None, always == 0),
            (ApplicableCount::One, always <= 1),
            (ApplicableCount::Many, plans.len() > 1),
        ];
        let can_be = can_be.into_iter().filter(|(_, can)| *can);
        items.extend(can_be.map(|(plans, _)| AgentCoverItem::Applicable { on, plans }));
    }
    items
}

/// Whether the plan is applicable to each event of its trigger: no context, and arguments that match anything.
pub(super) fn is_always_applicable(plan: &Plan) -> bool {
    let mut known = BTreeSet::new();
    let is_open = |term: &AgentTerm| match term {
        AgentTerm::Any => true,
        AgentTerm::Var(v) => known.insert(*v),
        AgentTerm::Expr(_) | AgentTerm::List(..) => false,
    };
    plan.context == PlanContext::True
        && plan.trigger.annotations.is_empty()
        && plan.trigger.args.iter().all(is_open)
}

/// Each step `!g(…)` or `!!g(…)` with each plan for g whose constants are not others than those of the step.
fn edges(agent: &Agent) -> Vec<(u16, u16, u16)> {
    let mut edges = Vec::new();
    for (plan, declared) in numbered(agent) {
        for (site, step) in (0u16..).zip(sites(declared)) {
            let (PlanStepKind::Achieve { goal, args, .. } | PlanStepKind::Spawn { goal, args }) = &step.kind
            else {
                continue;
            };
            let on = TriggerOn::GoalAdded(*goal);
            let can = |(_, by): &(u16, &Plan)| by.trigger.on == on && can_match(&by.trigger, args);
            edges.extend(numbered(agent).filter(can).map(|(by, _)| (plan, site, by)));
        }
    }
    edges
}

/// Whether constants of a trigger rule out what a step calls with.
fn can_match(trigger: &PlanTrigger, args: &[Expr]) -> bool {
    let fits = |(term, arg): (&AgentTerm, &Expr)| match (term, arg) {
        (AgentTerm::Expr(Expr::Const(a)), Expr::Const(b)) => match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => a == b,
            (None, _) | (_, None) => a.key() == b.key(),
        },
        (AgentTerm::Any | AgentTerm::Var(_) | AgentTerm::Expr(_) | AgentTerm::List(..), _) => true,
    };
    trigger.args.iter().zip(args).all(fits)
}

/// Chains of three plans, each called by a step `!g(…)` of the one before.
fn paths(agent: &Agent) -> BTreeSet<[u16; 3]> {
    let mut calls = vec![BTreeSet::new(); agent.plans.len()];
    for (plan, site, by) in edges(agent) {
        let step = sites(&agent.plans[usize::from(plan)])[usize::from(site)];
        if matches!(step.kind, PlanStepKind::Achieve { .. }) {
            calls[usize::from(plan)].insert(by);
        }
    }
    let mut paths = BTreeSet::new();
    for (first, seconds) in (0u16..).zip(&calls) {
        for second in seconds {
            paths.extend(calls[usize::from(*second)].iter().map(|third| [first, *second, *third]));
        }
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};
    use crate::coverage::place;
    use hrdsl_ir::coverage::CrossId;

    fn name(program: &hrdsl_ir::Program, agent: &Agent, item: AgentCoverItem) -> String {
        let (before, after) = item.kind().words();
        format!("{before}{}{after}", place(program, agent, item))
    }

    #[test]
    fn all_that_the_program_does_not_rule_out_is_in_it() {
        let program = fixture::program();
        let human = &program.agents[0];
        let names: Vec<String> = universe(human).iter().map(|i| name(&program, human, *i)).collect();
        let expected = [
            "plan Human.table#1",
            "plan Human.table#2",
            "plan Human.leg#1",
            "plan Human.leg#2",
            "plan Human.leg#3",
            "plan Human.sit#1",
            "plan Human.table#1 completed",
            "plan Human.table#2 completed",
            "plan Human.leg#1 completed",
            "plan Human.leg#2 completed",
            "plan Human.sit#1 completed",
            "plan Human.table#1 failed",
            "plan Human.leg#1 failed",
            "plan Human.leg#2 failed",
            "plan Human.leg#3 failed",
            "plan Human.sit#1 failed",
            "context Human.table#1 true",
            "context Human.leg#1 true",
            "context Human.leg#2 true",
            "context Human.table#1 false",
            "context Human.leg#1 false",
            "context Human.leg#2 false",
            "applicable Human.+!table one",
            "applicable Human.+!table many",
            "applicable Human.+!leg one",
            "applicable Human.+!leg many",
            "applicable Human.on discarded one",
            "message Human.table#1: tell seen (step 2)",
            "edge Human.table#1 -> leg#1 (step 1)",
            "edge Human.table#1 -> leg#3 (step 1)",
            "edge Human.table#1 -> table#1 (step 3)",
            "edge Human.table#1 -> table#2 (step 3)",
            "edge Human.sit#1 -> leg#2 (step 2)",
            "edge Human.sit#1 -> leg#3 (step 2)",
            "path Human: table#1 > table#1 > table#1",
            "path Human: table#1 > table#1 > table#2",
            "path Human: table#1 > table#1 > leg#1",
            "path Human: table#1 > table#1 > leg#3",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn goals_select_items() {
        let program = fixture::program();
        let count = |goal| items(&program.agents[0], goal).len();
        assert_eq!(count(ModelGoal::Plans), 6);
        assert_eq!(count(ModelGoal::Contexts), 6);
        assert_eq!((count(ModelGoal::Edges), count(ModelGoal::Paths)), (6, 4));
        assert_eq!((count(ModelGoal::Messages), count(ModelGoal::Bins(CrossId(0)))), (1, 0));
    }

    #[test]
    fn counts_reach_items() {
        let program = fixture::program();
        let human = &program.agents[0];
        let nothing = AgentCounts::new(human);
        let all = universe(human);
        assert!(all.iter().all(|i| !nothing.reaches(*i)));
        let mut measured = nothing;
        measured.selected[2] = 1;
        measured.completed[1] = 2;
        measured.failed[0] = 1;
        measured.contexts[3] = [1, 0];
        measured.contexts[0] = [0, 4];
        measured.applicable.insert(human.plans[5].trigger.on, [0, 3, 0]);
        measured.sent.insert((0, 1), 1);
        measured.edges.insert((5, 1, 4), 1);
        measured.paths.insert([0, 0, 2], 9);
        let reached = all.iter().filter(|i| measured.reaches(**i)).map(|i| name(&program, human, *i));
        assert_eq!(
            reached.collect::<Vec<_>>(),
            [
                "plan Human.leg#1",
                "plan Human.table#2 completed",
                "plan Human.table#1 failed",
                "context Human.table#1 true",
                "context Human.leg#2 false",
                "applicable Human.on discarded one",
                "message Human.table#1: tell seen (step 2)",
                "edge Human.sit#1 -> leg#3 (step 2)",
                "path Human: table#1 > table#1 > leg#1",
            ]
        );
    }
}
