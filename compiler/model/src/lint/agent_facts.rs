//! What the rules on plans ask about an agent: which beliefs come about and how, which goals are adopted, by whom.

use crate::{
    AgentId, BeliefDecl, BeliefId, ChoiceKind, GoalId, Performative, Scenario, TriggerOn, TypedAgent,
    TypedChoiceCondition, TypedContext, TypedPlan, TypedStep, TypedStepKind, TypedTerm,
};
use hrdsl_ir::bdi::each_step;
use hrdsl_source::{Diagnostic, Span, nearest};

use super::{
    agent_index::{AgentIndex, AgentWork, SentMessage},
    facts::ScenarioFacts,
    plan_terms::{PlanTerm, alternatives, may_unify, of_args, of_exprs, of_values},
    triggers::goal_of,
};

/// One agent, with what the scenario says about it.
#[derive(Clone, Copy)]
pub(crate) struct AgentFacts<'a> {
    pub scenario: &'a Scenario,
    pub id: AgentId,
    pub agent: &'a TypedAgent,
    index: &'a AgentIndex<'a>,
    work: &'a AgentWork,
}

/// What is known of the facts of a belief at all times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HeldBeliefs {
    /// Nothing.
    Unknown,
    /// There is one at least.
    Some,
    /// There is just one.
    One,
    /// There is just one for each value of the argument with this index.
    OnePer(u16),
}

/// A belief literal of a context.
#[derive(Clone, Copy)]
pub(crate) struct GroundLiteral<'a> {
    pub belief: BeliefId,
    pub args: &'a [TypedTerm],
    pub span: Span,
    pub negated: bool,
}

impl GroundLiteral<'_> {
    /// The belief's name in the text.
    pub fn name_span(&self, name: &str) -> Span {
        let end = self.span.start + u32::try_from(name.len()).unwrap_or(0);
        Span { end: end.min(self.span.end), ..self.span }
    }
}

/// All agents.
pub(crate) fn agents<'a>(
    scenario: &'a Scenario,
    facts: &'a ScenarioFacts<'a>,
) -> impl Iterator<Item = AgentFacts<'a>> {
    let all = (0..).zip(scenario.agents.iter().zip(&facts.agents));
    all.map(move |(i, (agent, index))| AgentFacts {
        scenario,
        id: AgentId(i),
        agent,
        index,
        work: &facts.work,
    })
}

/// The literals of a context from the left; negated are those under an odd number of `not`.
pub(crate) fn literals(context: &TypedContext) -> Vec<GroundLiteral<'_>> {
    fn collect<'a>(context: &'a TypedContext, negated: bool, all: &mut Vec<GroundLiteral<'a>>) {
        match context {
            TypedContext::True | TypedContext::Test(_) | TypedContext::Unify(..) => {}
            TypedContext::Belief(b) => {
                let (belief, args, span) = (b.belief, b.args.as_slice(), b.origin);
                all.push(GroundLiteral { belief, args, span, negated });
            }
            TypedContext::Internal(action, _) => {
                action.formula().iter().for_each(|inner| collect(inner, negated, all));
            }
            TypedContext::Not(inner) => collect(inner, !negated, all),
            TypedContext::And(parts) | TypedContext::Or(parts) => {
                parts.iter().for_each(|part| collect(part, negated, all));
            }
        }
    }
    let mut all = Vec::new();
    collect(context, false, &mut all);
    all
}

/// What a step does to beliefs.
pub(crate) enum BeliefChange<'a> {
    Adds(BeliefId, Vec<PlanTerm<'a>>),
    /// Leaves this as the only one.
    Replaces(BeliefId, Vec<PlanTerm<'a>>),
    Removes(BeliefId, Vec<PlanTerm<'a>>),
}

impl BeliefChange<'_> {
    pub fn belief(&self) -> BeliefId {
        match self {
            BeliefChange::Adds(b, _) | BeliefChange::Replaces(b, _) | BeliefChange::Removes(b, _) => *b,
        }
    }
}

pub(crate) fn change(step: &TypedStep) -> Option<BeliefChange<'_>> {
    if let TypedStepKind::Replace(a) = &step.kind {
        return Some(BeliefChange::Replaces(a.belief, of_exprs(&a.args)));
    }
    let added = step.kind.as_assertion().map(|a| BeliefChange::Adds(a.belief, of_exprs(&a.args)));
    let removed = || step.kind.as_removal().map(|l| BeliefChange::Removes(l.belief, of_args(&l.args)));
    added.or_else(removed)
}

/// Neither does a belief change in the step, nor time pass.
pub(crate) fn is_quiet(step: &TypedStep) -> bool {
    matches!(step.kind, TypedStepKind::Spawn { .. } | TypedStepKind::Print { .. })
}

/// The steps, those within blocks too, in the order of the text.
pub(crate) fn all_steps(steps: &[TypedStep]) -> Vec<&TypedStep> {
    let mut all = Vec::new();
    each_step(steps, &mut |step| all.push(step));
    all
}

/// How a goal is adopted.
pub(crate) enum GoalAdoption<'a> {
    /// At the start, or in an intention of its own: nobody waits for it.
    Root,
    /// By the step with this number.
    By(&'a TypedPlan, usize),
}

impl<'a> AgentFacts<'a> {
    pub fn belief(&self, id: BeliefId) -> &'a BeliefDecl {
        &self.agent.beliefs[usize::from(id.0)]
    }

    pub fn goal(&self, id: GoalId) -> &'a str {
        &self.agent.goals[usize::from(id.0)].name
    }

    pub fn plans(&self, on: TriggerOn) -> impl Iterator<Item = &'a TypedPlan> + use<'a> {
        let agent = self.agent;
        self.index.plans(on).iter().map(|i| &agent.plans[*i])
    }

    /// Takes so many steps of looking; `false` if there are not that many left for all agents.
    pub fn work(&self, steps: usize) -> bool {
        self.work.take(steps)
    }

    /// How many plans and steps there are.
    pub fn size(&self) -> usize {
        self.index.size
    }

    /// What is sent about a belief of this agent, and by whom.
    fn about(&self, belief: BeliefId) -> impl Iterator<Item = SentMessage> {
        self.index.about_belief[usize::from(belief.0)].iter().copied()
    }

    /// Others may add it: in messages, or as answers to the agent's own.
    pub fn is_told(&self, belief: BeliefId) -> bool {
        self.about(belief).any(|(how, sender)| match how {
            Some(Performative::Tell) => true,
            Some(Performative::AskOne | Performative::AskAll) => sender == self.id,
            Some(Performative::Untell | Performative::Achieve | Performative::Unachieve) | None => false,
        })
    }

    /// Others may withdraw what they have told.
    fn is_untold(&self, belief: BeliefId) -> bool {
        self.about(belief).any(|(how, _)| how == Some(Performative::Untell))
    }

    /// It is perceived.
    pub fn is_percept(&self, belief: BeliefId) -> bool {
        self.belief(belief).percept.is_some()
    }

    /// Some rule derives it.
    pub fn is_derived(&self, belief: BeliefId) -> bool {
        self.index.derived[usize::from(belief.0)]
    }

    /// It comes about without a plan, in a way of which nothing more is known.
    fn is_foreign(&self, belief: BeliefId) -> bool {
        self.is_percept(belief) || self.is_derived(belief) || self.is_told(belief)
    }

    /// Others ask for it, so that the plans for its query run.
    pub fn is_asked(&self, belief: BeliefId) -> bool {
        let asks = |how| matches!(how, None | Some(Performative::AskOne | Performative::AskAll));
        self.about(belief).any(|(how, _)| asks(how))
    }

    /// Some message asks for the goal.
    fn is_requested(&self, goal: GoalId) -> bool {
        self.index.about_goal[usize::from(goal.0)].iter().any(|(how, _)| *how == Some(Performative::Achieve))
    }

    /// The beliefs that plans change.
    pub fn changed(&self) -> impl Iterator<Item = BeliefId> {
        (0..).map(BeliefId).zip(&self.index.changes).filter(|(_, c)| !c.is_empty()).map(|(b, _)| b)
    }

    /// What suites ask of the beliefs that it starts with.
    pub fn choice_conditions(&self) -> impl Iterator<Item = &'a TypedChoiceCondition> {
        self.index.conditions.iter().copied()
    }

    fn is_chosen(&self, belief: BeliefId) -> bool {
        !self.chosen(belief).is_empty()
    }

    /// How suites choose a belief, with the number of each among those in which the agent plays.
    fn chosen(&self, belief: BeliefId) -> &'a [(usize, ChoiceKind)] {
        &self.index.chosen[usize::from(belief.0)]
    }

    fn initial(&self, belief: BeliefId) -> impl Iterator<Item = Vec<PlanTerm<'a>>> {
        let agent = self.agent;
        let facts = self.index.initial[usize::from(belief.0)].iter();
        facts.map(|i| of_values(&agent.initial_beliefs[*i].args))
    }

    /// It holds before any plan has run, in some run.
    pub fn is_given(&self, belief: BeliefId) -> bool {
        self.is_chosen(belief) || self.initial(belief).next().is_some()
    }

    /// A plan adds it.
    pub fn is_added(&self, belief: BeliefId) -> bool {
        self.index
            .changes_of(belief)
            .iter()
            .any(|c| matches!(c, BeliefChange::Adds(..) | BeliefChange::Replaces(..)))
    }

    /// It holds at some time, in some run.
    pub fn comes_about(&self, belief: BeliefId) -> bool {
        self.is_given(belief) || self.is_added(belief) || self.is_foreign(belief)
    }

    /// The beliefs that only plans add which need them, each other's way round too. What nothing adds at all is taken to
    /// hold here: it is said elsewhere.
    pub fn only_from_themselves(&self) -> Vec<BeliefId> {
        let all = || (0..).map(BeliefId).take(self.agent.beliefs.len());
        let mut known: Vec<bool> =
            all().map(|b| self.is_given(b) || !self.is_added(b) || self.is_foreign(b)).collect();
        // By belief: the plans that speak of it, which may run once it is known.
        let mut waiting: Vec<Vec<usize>> = vec![Vec::new(); known.len()];
        for (number, plan) in self.agent.plans.iter().enumerate() {
            let trigger = plan.trigger.on.belief();
            let needed = literals(&plan.context).into_iter().map(|l| l.belief).chain(trigger);
            needed.for_each(|b| waiting[usize::from(b.0)].push(number));
        }
        let mut runs = vec![false; self.agent.plans.len()];
        let mut open: Vec<usize> = (0..runs.len()).collect();
        while let Some(number) = open.pop() {
            let plan = &self.agent.plans[number];
            if runs[number] || !needs_only(plan, &|b| known[usize::from(b.0)]) {
                continue;
            }
            runs[number] = true;
            for change in all_steps(&plan.body).into_iter().filter_map(change) {
                let b = usize::from(change.belief().0);
                let adds = matches!(change, BeliefChange::Adds(..) | BeliefChange::Replaces(..));
                if adds && !std::mem::replace(&mut known[b], true) {
                    open.append(&mut waiting[b]);
                }
            }
        }
        all().filter(|b| !known[usize::from(b.0)]).collect()
    }

    /// A fact that these arguments of a plan match comes about.
    pub fn may_come_about(&self, belief: BeliefId, args: &[PlanTerm<'_>]) -> bool {
        let changes = self.index.changes_of(belief);
        self.is_chosen(belief)
            || self.is_foreign(belief)
            || !self.work(changes.len() + self.index.initial[usize::from(belief.0)].len())
            || self.initial(belief).any(|fact| may_unify(args, &fact, true))
            || changes.iter().any(|c| match c {
                BeliefChange::Adds(_, made) | BeliefChange::Replaces(_, made) => may_unify(args, made, true),
                BeliefChange::Removes(..) => false,
            })
    }

    /// What is certain of a belief's facts.
    pub fn held(&self, belief: BeliefId) -> HeldBeliefs {
        *self.index.held[usize::from(belief.0)].get_or_init(|| self.certain(belief))
    }

    fn certain(&self, belief: BeliefId) -> HeldBeliefs {
        let changes = self.index.changes_of(belief);
        if self.is_foreign(belief)
            || self.is_untold(belief)
            || changes.iter().any(|c| matches!(c, BeliefChange::Removes(..)))
        {
            return HeldBeliefs::Unknown;
        }
        let chosen = self.chosen(belief);
        let always = |kind: ChoiceKind| {
            !chosen.is_empty()
                && chosen.len() == self.index.suites
                && chosen.iter().all(|(_, how)| *how == kind)
        };
        let added = changes.iter().any(|c| matches!(c, BeliefChange::Adds(..)));
        match self.index.initial[usize::from(belief.0)].len() {
            0 if always(ChoiceKind::One) => {
                if added {
                    HeldBeliefs::Some
                } else {
                    HeldBeliefs::One
                }
            }
            0 => match chosen.first() {
                Some((0, ChoiceKind::OnePer(param)))
                    if changes.is_empty() && always(ChoiceKind::OnePer(*param)) =>
                {
                    HeldBeliefs::OnePer(*param)
                }
                Some(_) | None => HeldBeliefs::Unknown,
            },
            1 if !added && !self.is_chosen(belief) => HeldBeliefs::One,
            _ => HeldBeliefs::Some,
        }
    }

    pub fn is_adopted(&self, goal: GoalId) -> bool {
        self.adoptions(goal).next().is_some()
    }

    /// Who adopts a goal.
    pub fn adoptions(&self, goal: GoalId) -> impl Iterator<Item = GoalAdoption<'a>> {
        let agent = self.agent;
        let goal_index = usize::from(goal.0);
        let initial = (0..self.index.initial_goals[goal_index]).map(|_| GoalAdoption::Root);
        let by =
            self.index.adopters(goal).iter().map(|(plan, at)| GoalAdoption::By(&agent.plans[*plan], *at));
        let spawns = self.index.spawned[goal_index].iter().map(|_| GoalAdoption::Root);
        let asked = self.is_requested(goal).then_some(GoalAdoption::Root);
        initial.chain(asked).chain(by).chain(spawns)
    }

    /// The plans that adopt a goal, each as often as it does.
    pub fn adopters(&self, goal: GoalId) -> impl Iterator<Item = &'a TypedPlan> {
        let agent = self.agent;
        let by = self.index.adopters(goal).iter().map(|(plan, _)| plan);
        by.chain(&self.index.spawned[usize::from(goal.0)]).map(|plan| &agent.plans[*plan])
    }

    /// The plans that ask for a belief, with the number of the step.
    pub fn askers(&self, belief: BeliefId) -> impl Iterator<Item = (&'a TypedPlan, usize)> {
        let agent = self.agent;
        let queries = self.index.queries[usize::from(belief.0)].iter();
        queries.map(|(plan, at, _)| (&agent.plans[*plan], *at))
    }

    /// The plan is for a goal that nothing adopts, which has a diagnostic of its own.
    pub fn is_unadopted(&self, plan: &TypedPlan) -> bool {
        goal_of(plan.trigger.on).is_some_and(|goal| !self.is_adopted(goal))
    }

    /// What happens to a belief that a plan waits for never happens.
    pub fn is_dead_trigger(&self, plan: &TypedPlan) -> bool {
        let args = of_args(&plan.trigger.args);
        match plan.trigger.on {
            TriggerOn::BeliefAdded(b) => !self.may_come_about(b, &args),
            TriggerOn::BeliefRemoved(b) => {
                let changes = self.index.changes_of(b);
                let goes = !self.work(changes.len())
                    || changes.iter().any(|c| match c {
                        BeliefChange::Removes(_, removed) => may_unify(&args, removed, true),
                        BeliefChange::Replaces(..) => true,
                        BeliefChange::Adds(..) => false,
                    });
                (!goes && !self.is_foreign(b) && !self.is_untold(b)) || !self.may_come_about(b, &args)
            }
            TriggerOn::TestAdded(b) | TriggerOn::TestFailed(b) => {
                let queries = &self.index.queries[usize::from(b.0)];
                let asked = !self.work(queries.len())
                    || queries.iter().any(|(_, _, q)| may_unify(&args, &of_args(&q.args), true));
                !self.is_asked(b) && !asked
            }
            TriggerOn::GoalAdded(_) | TriggerOn::GoalFailed(_) | TriggerOn::Perceived(_) => false,
        }
    }

    /// Adds the nearest of the beliefs that come about as help, with its fix; `otherwise` if none is near.
    pub fn near_belief(
        &self,
        issue: Diagnostic,
        belief: BeliefId,
        name: Option<Span>,
        otherwise: String,
    ) -> Diagnostic {
        let this = self.belief(belief);
        let fits =
            |id: &BeliefId| self.comes_about(*id) && self.belief(*id).params.len() == this.params.len();
        let ids = (0..).map(BeliefId).take(self.agent.beliefs.len());
        let names = ids.filter(fits).map(|id| self.belief(id).name.as_str());
        let near = self.work(self.agent.beliefs.len()).then(|| nearest(&this.name, names)).flatten();
        let Some(near) = near else { return issue.help(otherwise) };
        let issue = issue.help(format!("did you mean `{near}`? Otherwise, {otherwise}"));
        match name {
            Some(span) => issue.fix(format!("replace `{}` by `{near}`", this.name), span, near, false),
            None => issue,
        }
    }
}

/// Whether the plan can run with these beliefs alone, as far as its trigger and the literals of its context say.
fn needs_only(plan: &TypedPlan, is_known: &dyn Fn(BeliefId) -> bool) -> bool {
    let trigger = if let TriggerOn::BeliefAdded(b) | TriggerOn::BeliefRemoved(b) = plan.trigger.on {
        is_known(b)
    } else {
        true
    };
    let holds = |part: &&TypedContext| {
        if let TypedContext::Belief(literal) = part { is_known(literal.belief) } else { true }
    };
    trigger && alternatives(&plan.context).is_none_or(|all| all.iter().any(|parts| parts.iter().all(holds)))
}

/// A belief or goal with `_` for each argument: `drink(_)`.
pub(crate) fn any_args(name: &str, arity: usize) -> String {
    if arity == 0 { name.to_owned() } else { format!("{name}({})", vec!["_"; arity].join(", ")) }
}
