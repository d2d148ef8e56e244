//! Agents: beliefs, goals, and what holds at the start.

use hrdsl_source::Diagnostic;
use hrdsl_syntax::ast::{self, AgentMemberKind as Member, Call, ItemKind, Sort, StepKind, TriggerKind};

use indexmap::IndexSet;

use super::{
    Checker, Declared, Env,
    layout::Fields,
    table::{MAX_NAMES, Map, Table},
};
use crate::{
    AgentId, Belief, BeliefId, Context, Goal, GoalId, Kind, Value,
    noun::Noun,
    report::{
        agents::{no_plan, not_adopted},
        names, types,
    },
};

/// The names of one agent.
pub(super) struct Scope {
    pub id: AgentId,
    /// The goals that some plan achieves, with the number of their arguments.
    pub goals: Map<String, usize>,
    /// Explicit labels of plans.
    pub labels: Table,
    /// How many plans each trigger's name has had so far.
    pub plans_of: Map<String, usize>,
}

impl Checker<'_> {
    pub(super) fn agents(&mut self) {
        self.templates_of(Sort::Agent, |c, template| {
            let ItemKind::Agent(syntax) = template.kind else { return };
            let index = c.s.agents.len();
            let plain = Declared { syntax, given: None, instance: None };
            c.push_agent(&plain, template.name, template.name.span);
            c.declare_beliefs(index, syntax);
            c.agent(index, syntax);
            c.s.agents.truncate(index);
            c.beliefs.truncate(index);
            c.belief_fields.truncate(index);
        });
        let decls = self.agent_decls.clone();
        for (index, agent) in decls.iter().enumerate() {
            let place = agent.instance.map(|i| (&i.name, i.span));
            self.as_instance(agent.given.clone(), place, |c| c.declare_beliefs(index, agent.syntax));
        }
        for (index, agent) in decls.iter().enumerate() {
            let place = agent.instance.map(|i| (&i.name, i.span));
            self.as_instance(agent.given.clone(), place, |c| c.agent(index, agent.syntax));
        }
    }

    fn declare_beliefs(&mut self, index: usize, agent: &ast::Agent) {
        for member in &agent.members {
            let Member::Belief { name, params, .. } = &member.kind else { continue };
            let fields = self.fields(params);
            if Self::declare(&mut self.issues, &mut self.beliefs[index], Noun::Belief, name).is_some() {
                let params = self.flat(&fields);
                self.belief_fields[index].push(fields);
                let belief = Belief { name: name.text.clone(), params, span: member.span };
                self.s.agents[index].beliefs.push(belief);
            }
        }
    }

    fn agent(&mut self, index: usize, agent: &ast::Agent) {
        let id = AgentId(u16::try_from(index).unwrap_or(u16::MAX));
        let mut goals = achieved(agent);
        if goals.len() > MAX_NAMES {
            let message = format!("there are more than {MAX_NAMES} goals in `{}`", agent.name.text);
            self.report(super::too_many(message, agent.name.span));
            goals.truncate(MAX_NAMES);
        }
        self.s.agents[index].goals = goals
            .iter()
            .map(|(name, n)| Goal { name: name.clone(), arity: u16::try_from(*n).unwrap_or(u16::MAX) })
            .collect();
        let mut scope = Scope { id, goals, labels: Table::default(), plans_of: Map::default() };
        self.unread_members = super::unread::in_agent(agent);
        for member in &agent.members {
            match &member.kind {
                Member::Belief { name, initial, .. } => {
                    for fact in initial {
                        self.initial_belief(&scope, name, fact);
                    }
                }
                Member::Goal(call) => self.initial_goal(&scope, call),
                Member::Plan(plan) => {
                    let plan = self.plan(&mut scope, plan, member.span);
                    self.s.agents[index].plans.extend(plan);
                }
                Member::Allow(_) | Member::Error => {}
            }
        }
        self.unadopted(&scope, agent);
        self.unread_members = false;
    }

    /// Plans for goals that nothing adopts: most often one of a goal's plans is misspelt.
    fn unadopted(&mut self, scope: &Scope, agent: &ast::Agent) {
        let mut adopted: IndexSet<&str> = IndexSet::new();
        for member in &agent.members {
            match &member.kind {
                Member::Goal(call) => adopted.extend([call.name.text.as_str()]),
                Member::Plan(plan) => {
                    for step in &plan.body {
                        match &step.kind {
                            StepKind::Achieve(call) | StepKind::Spawn(call) => {
                                adopted.extend([call.name.text.as_str()])
                            }
                            // It may have been an adoption.
                            StepKind::Error => return,
                            _ => {}
                        }
                    }
                }
                Member::Belief { .. } | Member::Allow(_) => {}
                Member::Error => return,
            }
        }
        if adopted.iter().any(|goal| !scope.goals.contains_key(*goal)) {
            // An adoption is misspelt, and has its diagnostic: it may be the one that is missing.
            return;
        }
        for member in &agent.members {
            if let Member::Plan(plan) = &member.kind
                && plan.trigger.kind == TriggerKind::Achieve
                && !adopted.contains(plan.trigger.call.name.text.as_str())
            {
                let name = &plan.trigger.call.name;
                self.report(not_adopted(&name.text, name.span, adopted.iter().copied()));
            }
        }
    }

    /// `= had(0)`: the fact must be of the belief that is being declared.
    fn initial_belief(&mut self, scope: &Scope, declared: &ast::Name, fact: &Call) {
        let Some(belief) = self.belief(scope, &fact.name) else { return };
        if fact.name.text != declared.text {
            let name = &fact.name;
            let near = [declared.text.as_str()];
            self.report(
                names::unknown(Noun::Belief, &name.text, name.span, near)
                    .label(declared.span, "declared here"),
            );
        }
        let fields = self.belief_fields(scope.id, belief);
        let args = self.ground(Noun::Belief, fact, &fields);
        if let Some(args) = args {
            self.s.agents[usize::from(scope.id.0)].initial_beliefs.push((belief, args));
        }
    }

    fn initial_goal(&mut self, scope: &Scope, call: &Call) {
        let Some(goal) = self.goal(scope, call) else { return };
        let mut args = Vec::new();
        for arg in call.args.as_deref().unwrap_or_default() {
            args.extend(self.constant(arg, Kind::Unknown, &mut Env::constants()));
        }
        self.s.agents[usize::from(scope.id.0)].initial_goals.push((goal, args));
    }

    /// Constant arguments.
    fn ground(&mut self, noun: Noun, call: &Call, fields: &Fields) -> Option<Vec<Value>> {
        let args = self.args(noun, call, fields, &mut Env::constants());
        for arg in &args {
            if arg.constant().is_none() && arg.ty != Kind::Unknown {
                self.report(types::not_constant(arg.span));
            }
        }
        let values: Option<Vec<Value>> = args.iter().map(crate::Expr::constant).collect();
        let whole = call.args.as_ref().map_or(0, Vec::len) == fields.len();
        values.filter(|_| whole)
    }

    pub(super) fn belief_fields(&self, agent: AgentId, belief: BeliefId) -> Fields {
        self.belief_fields[usize::from(agent.0)][usize::from(belief.0)].clone()
    }

    pub(super) fn belief(&mut self, scope: &Scope, name: &ast::Name) -> Option<BeliefId> {
        let table = &self.beliefs[usize::from(scope.id.0)];
        if let Some(id) = table.get(&name.text) {
            return Some(BeliefId(id));
        }
        let names: Vec<String> = table.names().map(str::to_owned).collect();
        let local = scope.goals.contains_key(&name.text).then_some(Noun::Goal);
        self.unknown(Noun::Belief, name, &names, local);
        None
    }

    /// What a name is within the agent.
    pub(super) fn kind_in_agent(&self, scope: &Scope, text: &str) -> Option<Noun> {
        if self.beliefs[usize::from(scope.id.0)].get(text).is_some() {
            return Some(Noun::Belief);
        }
        scope.goals.contains_key(text).then_some(Noun::Goal)
    }

    /// A goal with its number of arguments; there must be a plan for it.
    pub(super) fn goal(&mut self, scope: &Scope, call: &Call) -> Option<GoalId> {
        let name = &call.name;
        let Some((index, _, arity)) = scope.goals.get_full(&name.text) else {
            let helpless = self.compared > super::MAX_COMPARED;
            let goals: Vec<&str> = scope.goals.keys().map(String::as_str).filter(|_| !helpless).collect();
            self.compared += goals.len();
            let is = self.kind_in_agent(scope, &name.text).or_else(|| self.kind_of(&name.text));
            let issue = match is {
                Some(is) => names::wrong_kind(Noun::Goal, is, &name.text, name.span, goals),
                None if self.unread_members => return None,
                None => no_plan(&name.text, name.span, goals),
            };
            let issue = Diagnostic { help: issue.help.filter(|_| !helpless), ..issue };
            self.report(issue);
            return None;
        };
        let got = call.args.as_ref().map_or(0, Vec::len);
        if got != *arity {
            self.report(types::counts(Noun::Goal, &name.text, *arity, got, call.span));
            return None;
        }
        Some(GoalId(u16::try_from(index).unwrap_or(u16::MAX)))
    }

    /// Several contexts as one.
    pub(super) fn all_of(mut contexts: Vec<Context>) -> Context {
        match contexts.len() {
            0 => Context::True,
            1 => contexts.remove(0),
            _ => Context::And(contexts),
        }
    }
}

/// The goals with a plan `+!g`, by the first plan for each.
fn achieved(agent: &ast::Agent) -> Map<String, usize> {
    let mut goals = Map::default();
    for member in &agent.members {
        if let Member::Plan(plan) = &member.kind
            && plan.trigger.kind == TriggerKind::Achieve
        {
            let call = &plan.trigger.call;
            let arity = call.args.as_ref().map_or(0, Vec::len);
            goals.entry(call.name.text.clone()).or_insert(arity);
        }
    }
    goals
}
