//! What the conditions of choices (`choose … where F`) say of beliefs: asked of each agent's belief base as it starts.

use std::{collections::BTreeSet, sync::Arc};

use hrdsl_ir::{
    Program,
    abstract_test::BeliefSet,
    bdi::{Agent, AgentId, BeliefId, InitialFact, PlanContext},
    suite::{BeliefChoice, BeliefCondition},
};

use super::factors::{BeliefFactor, ChooseError};
use crate::{
    belief::{BeliefBase, FactAnnotations, GroundArguments, sourced, typed},
    check,
    dice::AgentRng,
    mind::{AgentIdentity, MentalState, PeerTable},
    query::{BeliefQueryError, QuerySolver},
};

/// Whether all conditions of the choices allow the set, in a run of these agents.
///
/// # Errors
/// An agent or condition that cannot be asked.
pub fn allows(
    program: &Program,
    agents: &[AgentId],
    choices: &[BeliefChoice],
    set: &BeliefSet,
) -> Result<bool, ChooseError> {
    let mut judge = ConditionEvaluator::new(program, agents, choices)?;
    Ok((0..judge.questions.len()).all(|q| judge.holds(q, &mut set.facts.iter().map(|(a, f)| (*a, f)))))
}

/// A condition, and whom it is asked.
struct AskedCondition<'p> {
    /// Into the minds.
    mind: usize,
    condition: &'p BeliefCondition,
    /// The beliefs that its answer may depend on.
    reads: BTreeSet<BeliefId>,
}

/// Answers the conditions of a suite's choices.
pub(super) struct ConditionEvaluator<'p> {
    minds: Vec<MentalState<'p>>,
    /// What each of them believes without any choice.
    initial: Vec<BeliefBase>,
    questions: Vec<AskedCondition<'p>>,
    solver: QuerySolver<'p>,
    /// Why a condition had no answer, not even "none".
    pub fault: Option<BeliefQueryError>,
}

impl<'p> ConditionEvaluator<'p> {
    /// `agents`: those of the run, in order.
    pub fn new(
        program: &'p Program,
        agents: &[AgentId],
        choices: &'p [BeliefChoice],
    ) -> Result<Self, ChooseError> {
        let mut judge = Self {
            minds: Vec::new(),
            initial: Vec::new(),
            questions: Vec::new(),
            solver: QuerySolver::default(),
            fault: None,
        };
        for choice in choices {
            let Some(condition) = &choice.condition else { continue };
            let agent = check::agent(program, choice.agent)
                .map_err(|why| ChooseError::Malformed { why: why.to_string() })?;
            if !check::formula(program, agent, &condition.context, condition.vars.len()) {
                let why = format!("the condition of a choice of {} is ill-formed", agent.name);
                return Err(ChooseError::Malformed { why });
            }
            let mind = judge.mind(program, agent, choice.agent, agents);
            let reads = reads(agent, &condition.context);
            judge.questions.push(AskedCondition { mind, condition, reads });
        }
        Ok(judge)
    }

    fn mind(&mut self, program: &'p Program, agent: &'p Agent, id: AgentId, agents: &[AgentId]) -> usize {
        if let Some(there) = self.minds.iter().position(|m| m.me.id == id) {
            return there;
        }
        let mut all = agents.to_vec();
        if !all.contains(&id) {
            all.push(id);
        }
        let peers = Arc::new(PeerTable::new(program, all.iter().copied()));
        let at = all.iter().position(|a| *a == id).unwrap_or(0);
        let me = AgentIdentity {
            name: peers.agents[at].0,
            place: u16::try_from(at).unwrap_or(u16::MAX),
            id,
            peers,
        };
        let mut mind = MentalState::new(program, Some(agent), me);
        agent.initial_beliefs.iter().for_each(|fact| believe(&mut mind, fact));
        self.initial.push(mind.beliefs.clone());
        self.minds.push(mind);
        self.minds.len() - 1
    }

    /// For each condition the factors that its answer may depend on.
    pub fn scopes(&self, factors: &[BeliefFactor]) -> Vec<Vec<usize>> {
        let concerns = |question: &AskedCondition<'_>, factor: &BeliefFactor| {
            let mut facts = factor.alternatives.iter().flat_map(|a| &a.facts);
            factor.agent == self.minds[question.mind].me.id
                && facts.any(|f| question.reads.contains(&f.belief))
        };
        let scope = |q| (0..factors.len()).filter(|f| concerns(q, &factors[*f])).collect();
        self.questions.iter().map(scope).collect()
    }

    /// Whether the condition of this number has an answer with these chosen facts. Each time is time 0, and chance starts
    /// with the seed 0.
    pub fn holds(
        &mut self,
        question: usize,
        chosen: &mut dyn Iterator<Item = (AgentId, &InitialFact)>,
    ) -> bool {
        let AskedCondition { mind: at, condition, .. } = &self.questions[question];
        let mind = &mut self.minds[*at];
        mind.beliefs.clone_from(&self.initial[*at]);
        for (agent, fact) in chosen {
            if agent == mind.me.id {
                believe(mind, fact);
            }
        }
        let mut dice = AgentRng::new(0, u64::from(mind.me.id.0) + 1);
        self.solver.open(condition.vars.len());
        match self.solver.solve(mind, &mut dice, &condition.context) {
            Ok(holds) => holds,
            Err(fault) => {
                self.fault.get_or_insert(fault);
                false
            }
        }
    }
}

/// As an agent does when it starts; a fact that does not fit its declaration is left out.
fn believe(mind: &mut MentalState<'_>, fact: &InitialFact) {
    let declared = mind.agent.belief(fact.belief);
    if let Some(args) = typed(&declared.params, GroundArguments::from_slice(&fact.args)) {
        let annotations = sourced(FactAnnotations::from_slice(&fact.annotations));
        mind.beliefs.insert(fact.belief, &args, annotations);
    }
}

/// The beliefs that a formula asks, itself and through rules.
fn reads(agent: &Agent, formula: &PlanContext) -> BTreeSet<BeliefId> {
    let mut reads = BTreeSet::new();
    let mut open = vec![formula];
    while let Some(formula) = open.pop() {
        match formula {
            PlanContext::True | PlanContext::Test(_) | PlanContext::Unify(..) => {}
            PlanContext::Belief(literal) => {
                if reads.insert(literal.belief) {
                    open.extend(agent.rules.iter().filter(|r| r.belief == literal.belief).map(|r| &r.body));
                }
            }
            PlanContext::Not(inner) => open.push(inner),
            PlanContext::And(all) | PlanContext::Or(all) => open.extend(all),
            PlanContext::Internal(action, _) => open.extend(action.formula()),
        }
    }
    reads
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::Span;
    use hrdsl_ir::{
        ActorId, Expr, Parameter, Type, Value,
        bdi::{AgentTerm, BeliefDecl, BeliefLiteral, BeliefRule},
        expr::BinaryOp,
        suite::{ChoiceKind, ExploreMode},
    };

    use super::*;
    use crate::choose::{BeliefExplorer, factors};

    const N: Type = Type::Int { lo: 0, hi: 3 };

    fn literal(belief: u16, args: Vec<AgentTerm>) -> PlanContext {
        PlanContext::Belief(BeliefLiteral {
            origin: Span::default(),
            belief: BeliefId(belief),
            args,
            annotations: vec![],
        })
    }

    fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
        Expr::Binary(op, Box::new(left), Box::new(right))
    }

    /// `wants(n)`, `tired`, `limit(n)`, of which `limit(2)` is held, and `rule most(N) when wants(N) && not tired`
    fn program() -> Program {
        let belief = |name: &str, params: usize| BeliefDecl {
            negates: None,
            name: name.into(),
            params: vec![Parameter { name: "n".into(), ty: N }; params],
            annotations: vec![],
            percept: None,
            origin: Default::default(),
        };
        let body = PlanContext::And(vec![
            literal(0, vec![AgentTerm::Var(0)]),
            PlanContext::Not(Box::new(literal(1, vec![]))),
        ]);
        let agent = Agent {
            name: "Human".into(),
            actor: ActorId(0),
            beliefs: vec![belief("wants", 1), belief("tired", 0), belief("limit", 1), belief("most", 1)],
            goals: vec![],
            rules: vec![BeliefRule {
                head: Span::default(),
                belief: BeliefId(3),
                args: vec![AgentTerm::Var(0)],
                body,
                vars: vec!["N".into()],
                origin: Default::default(),
            }],
            jason: false,
            initial_beliefs: vec![InitialFact {
                belief: BeliefId(2),
                args: vec![Value::Int(2)],
                annotations: vec![],
            }],
            initial_goals: vec![],
            plans: vec![],
            origin: Default::default(),
        };
        Program { agents: vec![agent], ..Program::default() }
    }

    fn choices(context: Option<PlanContext>) -> Vec<BeliefChoice> {
        let condition = context.map(|context| BeliefCondition {
            context,
            vars: vec!["X".into(), "Y".into()],
            origin: Default::default(),
        });
        let choice = |belief, how, condition| BeliefChoice {
            agent: AgentId(0),
            belief: BeliefId(belief),
            how,
            condition,
        };
        vec![choice(0, ChoiceKind::One, condition), choice(1, ChoiceKind::Any, None)]
    }

    fn explored(context: Option<PlanContext>) -> Result<Vec<String>, String> {
        let (program, choices) = (program(), choices(context));
        let factors = factors(&program, &choices).unwrap();
        let settings = (ExploreMode::Exhaustive, 100, 0);
        let mut explorer = BeliefExplorer::of(&program, &[AgentId(0)], &choices, &factors, settings)
            .map_err(|e| e.to_string())?;
        let sets = explorer.next_batch();
        for set in &sets {
            assert!(allows(&program, &[AgentId(0)], &choices, set).unwrap());
        }
        Ok(sets.iter().map(|set| set.text.join(" ")).collect())
    }

    /// `most(X) && limit(Y) && X <= Y`, or what comes last.
    fn at_most(last: Expr) -> PlanContext {
        PlanContext::And(vec![
            literal(3, vec![AgentTerm::Var(0)]),
            literal(2, vec![AgentTerm::Var(1)]),
            PlanContext::Test(last),
        ])
    }

    #[test]
    fn conditions_are_asked_of_initial_and_chosen_beliefs_through_rules() {
        let below = at_most(binary(BinaryOp::Le, Expr::Var(0), Expr::Var(1)));
        assert_eq!(explored(Some(below.clone())).unwrap(), ["wants(0)", "wants(1)", "wants(2)"]);
        assert_eq!(explored(Some(PlanContext::Not(Box::new(below)))).unwrap().len(), 5);
        assert_eq!(explored(None).unwrap().len(), 8);
    }

    #[test]
    fn a_condition_without_a_value_allows_nothing_and_is_told() {
        let by_zero = binary(BinaryOp::Div, Expr::Const(Value::Int(1)), Expr::Var(0));
        let not_zero = at_most(binary(BinaryOp::Ge, by_zero, Expr::Const(Value::Int(0))));
        assert_eq!(explored(Some(not_zero)).unwrap(), ["wants(1)", "wants(2)", "wants(3)"]);
        let zero = binary(BinaryOp::Sub, Expr::Var(0), Expr::Var(0));
        let always = binary(BinaryOp::Eq, binary(BinaryOp::Div, Expr::Var(0), zero), Expr::Var(0));
        let error = explored(Some(at_most(always))).unwrap_err();
        assert_eq!(error, "no belief set fulfils what `where` says of wants, tired: division by zero");
    }

    #[test]
    fn what_cannot_be_asked_is_refused() {
        let error = explored(Some(literal(9, vec![]))).unwrap_err();
        assert_eq!(error, "the condition of a choice of Human is ill-formed");
        let error = explored(Some(literal(0, vec![AgentTerm::Var(7)]))).unwrap_err();
        assert!(error.ends_with("is ill-formed"), "{error}");
    }
}
