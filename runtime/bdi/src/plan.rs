//! The plan library: which plans are relevant to a trigger, which may leave early, and the rules.

use hrdsl_ir::{
    EventId, Program, Span,
    bdi::{
        Agent, AgentId, AgentTerm, BeliefDecl, BeliefId, BeliefRule, GoalId, MessageSubject, Performative,
        Plan, PlanContext, PlanStepKind, TriggerOn, each_step,
    },
};
use smallvec::SmallVec;

use crate::code::{PlanLine, PlanOp, compile};

/// An agent's plans, indexed by what triggers them.
#[derive(Debug, Default)]
pub(crate) struct PlanLibrary<'p> {
    plans: &'p [Plan],
    beliefs: usize,
    goals: usize,
    /// The relevant plans in source order, by [`place`](Self::place).
    relevant: Vec<SmallVec<[u16; 4]>>,
    code: Vec<Vec<PlanLine<'p>>>,
    /// Whether the trigger's terms are different variables, so that they match any values.
    plain: Vec<bool>,
    /// Whether the plan's frame may be dropped as soon as its body is finished, even below a sub-goal.
    leaves_early: Vec<bool>,
    /// By belief.
    rules: Vec<Vec<&'p BeliefRule>>,
    /// By belief, if it matters: how many of its rules stand before it in the text.
    early: Vec<usize>,
    /// The beliefs that hold the arguments of an event, by event.
    percepts: Vec<SmallVec<[BeliefId; 1]>>,
}

impl<'p> PlanLibrary<'p> {
    pub fn new(program: &Program, id: AgentId, agent: &'p Agent) -> Self {
        let (beliefs, goals) = (agent.beliefs.len(), agent.goals.len());
        let mut library = Self { plans: &agent.plans, beliefs, goals, ..Self::default() };
        library.relevant.resize(4 * beliefs + 2 * goals + program.events.len(), SmallVec::new());
        for (index, plan) in (0u16..).zip(&agent.plans) {
            let place = library.place(plan.trigger.on);
            if let Some(plans) = library.relevant.get_mut(place) {
                plans.push(index);
            }
        }
        library.plain = agent.plans.iter().map(is_plain).collect();
        library.code = agent.plans.iter().map(|p| compile(&p.body).unwrap_or_default()).collect();
        library.rules.resize(beliefs, Vec::new());
        for rule in &agent.rules {
            library.rules[usize::from(rule.belief.0)].push(rule);
        }
        if agent.jason {
            let early = |(rules, belief): (&Vec<&BeliefRule>, &BeliefDecl)| {
                rules
                    .iter()
                    .filter(|r| r.origin.file == belief.origin.file && r.origin.start < belief.origin.start)
                    .count()
            };
            library.early = library.rules.iter().zip(&agent.beliefs).map(early).collect();
        }
        library.percepts.resize(program.events.len(), SmallVec::new());
        for (belief, declared) in (0u16..).zip(&agent.beliefs) {
            if let Some(event) = declared.percept {
                library.percepts[usize::from(event.0)].push(BeliefId(belief));
            }
        }
        let named = named_goals(program, id, agent);
        let may_leave = |p| library.may_leave_early(p, &named, agent.jason);
        library.leaves_early = agent.plans.iter().map(may_leave).collect();
        library
    }

    fn may_leave_early(&self, plan: &Plan, named: &[bool], jason: bool) -> bool {
        !plan.atomic && self.is_forgotten(plan, named, jason)
    }

    fn is_forgotten(&self, plan: &Plan, named: &[bool], jason: bool) -> bool {
        match plan.trigger.on {
            // The failure of a later sub-goal, or whoever names the goal, would have to find it.
            TriggerOn::GoalAdded(goal) => {
                self.relevant(TriggerOn::GoalFailed(goal)).is_empty() && !named[usize::from(goal.0)]
            }
            TriggerOn::GoalFailed(goal) => !named[usize::from(goal.0)],
            // Its end carries the answer.
            TriggerOn::TestAdded(_) | TriggerOn::TestFailed(_) => false,
            // A later failure may end with it.
            TriggerOn::BeliefAdded(belief) | TriggerOn::BeliefRemoved(belief) => {
                !jason || self.relevant(TriggerOn::BeliefRemoved(belief)).is_empty()
            }
            TriggerOn::Perceived(_) => true,
        }
    }

    fn place(&self, on: TriggerOn) -> usize {
        let goals = 4 * self.beliefs;
        match on {
            TriggerOn::BeliefAdded(b) => usize::from(b.0),
            TriggerOn::BeliefRemoved(b) => self.beliefs + usize::from(b.0),
            TriggerOn::TestAdded(b) => 2 * self.beliefs + usize::from(b.0),
            TriggerOn::TestFailed(b) => 3 * self.beliefs + usize::from(b.0),
            TriggerOn::GoalAdded(g) => goals + usize::from(g.0),
            TriggerOn::GoalFailed(g) => goals + self.goals + usize::from(g.0),
            TriggerOn::Perceived(e) => goals + 2 * self.goals + usize::from(e.0),
        }
    }

    /// The plans with this trigger, in source order.
    pub fn relevant(&self, on: TriggerOn) -> &[u16] {
        self.relevant.get(self.place(on)).map_or(&[], |plans| plans.as_slice())
    }

    /// The plan of this index, which must be one of the library's.
    pub fn plan(&self, index: u16) -> &'p Plan {
        &self.plans[usize::from(index)]
    }

    pub fn is_plain(&self, index: u16) -> bool {
        self.plain[usize::from(index)]
    }

    pub fn code(&self, index: u16) -> &[PlanLine<'p>] {
        &self.code[usize::from(index)]
    }

    /// The event that the step at this line makes, or the stimulus that it does.
    pub fn event_at(&self, index: u16, line: u16) -> Option<EventId> {
        let op = &self.code.get(usize::from(index))?.get(usize::from(line))?.op;
        if let PlanOp::Plain(PlanStepKind::Do { event, .. }) = op { Some(*event) } else { None }
    }

    /// Where the step at this line stands.
    pub fn origin_at(&self, index: u16, line: u16) -> Option<Span> {
        Some(self.code.get(usize::from(index))?.get(usize::from(line))?.origin)
    }

    pub fn leaves_early(&self, index: u16) -> bool {
        self.leaves_early[usize::from(index)]
    }

    pub fn rules(&self, belief: BeliefId) -> &[&'p BeliefRule] {
        &self.rules[usize::from(belief.0)]
    }

    /// How many of a belief's rules are asked before the facts that it is held with at the start.
    pub fn early(&self, belief: BeliefId) -> usize {
        self.early.get(usize::from(belief.0)).copied().unwrap_or(0)
    }

    pub fn percepts(&self, event: EventId) -> &[BeliefId] {
        self.percepts.get(usize::from(event.0)).map_or(&[], |p| p.as_slice())
    }
}

fn is_plain(plan: &Plan) -> bool {
    let variable = |term: &AgentTerm| if let AgentTerm::Var(v) = term { Some(*v) } else { None };
    let vars: Option<Vec<u16>> = plan.trigger.args.iter().map(variable).collect();
    let different = |v: Vec<u16>| v.iter().enumerate().all(|(i, a)| !v[..i].contains(a));
    plan.trigger.annotations.is_empty() && vars.is_some_and(different)
}

/// By goal: an internal action asks for it or changes it, or another agent may take it back.
fn named_goals(program: &Program, id: AgentId, agent: &Agent) -> Vec<bool> {
    let mut named = vec![false; agent.goals.len()];
    for plan in &agent.plans {
        in_context(&plan.context, &mut named);
        each_step(&plan.body, &mut |step| {
            if let PlanStepKind::Control { goal: Some((goal, _)), .. } = &step.kind {
                name(*goal, &mut named);
            } else if let Some(condition) = step.condition() {
                in_context(condition, &mut named);
            }
        });
    }
    agent.rules.iter().for_each(|rule| in_context(&rule.body, &mut named));
    let all = program.agents.iter().flat_map(|a| &a.plans);
    for plan in all {
        each_step(&plan.body, &mut |step| {
            if let PlanStepKind::Send { performative: Performative::Unachieve, content, .. } = &step.kind
                && let Some(content) = program.contents.get(usize::from(content.0))
                && let Some(Some(MessageSubject::Goal(goal))) = content.of.get(usize::from(id.0))
            {
                name(*goal, &mut named);
            }
        });
    }
    named
}

fn name(goal: GoalId, named: &mut [bool]) {
    if let Some(named) = named.get_mut(usize::from(goal.0)) {
        *named = true;
    }
}

fn in_context(context: &PlanContext, named: &mut [bool]) {
    context.each(&mut |part| {
        if let PlanContext::Internal(action, _) = part
            && let Some((goal, _)) = action.goal()
        {
            name(goal, named);
        }
    });
}
