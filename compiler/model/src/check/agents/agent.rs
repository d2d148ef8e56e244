//! Agents: beliefs, goals, and what holds at the start.

use hrdsl_source::{Diagnostic, Span};
use hrdsl_syntax::ast::{self, AgentMemberKind as Member, CallSyntax, ItemSyntaxKind, TemplateSyntaxKind};

use crate::check::state::phase::CheckPhase;
use crate::check::{
    agents::{
        adoption::{achieved, adopts, asked_goals, written},
        phase::AgentsPhase,
    },
    state::{
        issues::too_many,
        names::{DeclaredPlayer, GoalEntry},
        record::DeclaredFields,
        scope::ExprEnv,
        table::{MAX_NAMES, NameTable, OrderedMap},
        template::DeclaredTemplate,
    },
    template::CheckerPhase,
    unread,
};
use crate::{
    AgentId, BeliefDecl, BeliefId, GoalDecl, GoalId, InferredType, InitialFact, MessageSubject, Parameter,
    TypedContext, Value,
    noun::Noun,
    report::{
        agents::{no_plan, only_declared},
        names, types,
    },
};

/// The names of one agent.
pub(in crate::check) struct AgentScope {
    pub id: AgentId,
    /// Explicit labels of plans.
    pub labels: NameTable,
    /// How many plans each trigger's name has had so far.
    pub plans_of: OrderedMap<String, usize>,
}

impl AgentScope {
    fn new(index: usize) -> Self {
        Self::of(AgentId(u16::try_from(index).unwrap_or(u16::MAX)))
    }

    pub fn of(id: AgentId) -> Self {
        Self { id, labels: NameTable::default(), plans_of: OrderedMap::default() }
    }
}

impl<'a> AgentsPhase<'_, 'a> {
    pub(in crate::check) fn agents(&mut self) {
        for (item, _) in self.each_item() {
            if let ItemSyntaxKind::Agent(agent) = item {
                asked_goals(agent, &mut self.asked_goals);
            }
        }
        // All names come first, since agents send each other messages; those of templates before those of instances, so
        // that a fault of a template is said of the template.
        self.templates_of(TemplateSyntaxKind::Agent, |c, template| c.template_agent(template, false));
        let decls = self.players.agents.clone();
        let each = |c: &mut Self, check: &dyn Fn(&mut Self, usize, &'a ast::AgentSyntax)| {
            for (index, agent) in decls.iter().enumerate() {
                let place = agent.instance.map(|i| (&i.name, i.span));
                c.as_instance(agent.given.clone(), place, |c| check(c, index, agent.syntax));
            }
        };
        each(self, &|c, index, agent| c.declare_members(index, agent));
        self.templates_of(TemplateSyntaxKind::Agent, |c, template| {
            if c.source.looks_at(CheckPhase::Agents, template.name.span) {
                c.template_agent(template, true);
            }
        });
        each(self, &|c, index, agent| c.agent_rules(&AgentScope::new(index), agent));
        each(self, &|c, index, agent| {
            let looked_at = |at| c.source.looks_at(CheckPhase::Agents, at);
            let instance = decls[index].instance.is_some_and(|i| looked_at(i.span));
            if instance || looked_at(agent.name.span) {
                c.agent(index, agent);
            }
        });
        self.resolve_contents();
    }

    /// Looks at a template by itself: at its declarations, or at all.
    fn template_agent(&mut self, template: DeclaredTemplate<'a>, whole: bool) {
        let ItemSyntaxKind::Agent(syntax) = template.kind else { return };
        let (index, contents) = (self.s.agents.len(), self.s.contents.len());
        let plain = DeclaredPlayer { syntax, given: None, instance: None };
        self.push_agent(&plain, template.name, template.name.span);
        self.names.add();
        self.declare_members(index, syntax);
        if whole {
            self.agent_rules(&AgentScope::new(index), syntax);
            self.agent(index, syntax);
        }
        self.s.agents.truncate(index);
        self.s.contents.truncate(contents);
        self.names.truncate(index);
    }

    /// Beliefs and goals with their types.
    fn declare_members(&mut self, index: usize, agent: &'a ast::AgentSyntax) {
        for member in &agent.members {
            if let Member::Belief { name, params, annotations, on, .. } = &member.kind {
                self.declare_belief(index, (name, params, annotations), on.as_ref(), member.span);
            }
        }
        let mut goals = achieved(agent);
        if goals.len() > MAX_NAMES {
            let message = format!("there are more than {MAX_NAMES} goals in `{}`", agent.name.text);
            self.report(too_many(message, agent.name.span));
            goals.truncate(MAX_NAMES);
        }
        self.names.goals[index] = goals;
        self.declare_goals(index, agent);
        let entries = self.names.goals[index].clone();
        self.s.agents[index].goals = entries
            .iter()
            .map(|(name, entry)| {
                let params = entry.fields.as_ref().map(|f| self.flat(f));
                let arity = params.as_ref().map_or(entry.arity, Vec::len);
                GoalDecl { name: name.clone(), arity: u16::try_from(arity).unwrap_or(u16::MAX), params }
            })
            .collect();
    }

    fn declare_belief(
        &mut self,
        index: usize,
        (name, params, annotations): (&ast::NameSyntax, &[ast::ParamSyntax], &[ast::ParamSyntax]),
        on: Option<&ast::NameSyntax>,
        span: Span,
    ) {
        let fields = self.fields(params);
        let mut marks = Vec::new();
        let mut table = NameTable::default();
        for mark in annotations {
            let ty = self.ty(&mark.ty);
            if mark.name.text == "source" {
                let issue = names::duplicate(Noun::Annotation, "source", mark.name.span, None);
                self.report(issue.help("every fact has its sources: leave it out"));
                continue;
            }
            self.issues.declare(&mut table, Noun::Annotation, &mark.name);
            if let Some(ty) = ty {
                marks.push(Parameter { name: mark.name.text.clone(), ty });
            }
        }
        let percept = on.and_then(|event| self.percept(index, event, &fields));
        if self.checker.issues.declare(&mut self.names.beliefs[index], Noun::Belief, name).is_some() {
            let params = self.flat(&fields);
            self.names.belief_fields[index].push(fields);
            let (name, annotations) = (name.text.clone(), marks);
            let belief = BeliefDecl { name, params, annotations, percept, negates: None, origin: span };
            self.s.agents[index].beliefs.push(belief);
        }
    }

    /// `on sensed`: the event whose arguments the belief holds.
    fn percept(
        &mut self,
        index: usize,
        name: &ast::NameSyntax,
        fields: &DeclaredFields,
    ) -> Option<crate::EventId> {
        let event = self.event(Noun::EventOrStimulus, name, None)?;
        let actor = self.s.agents[index].actor;
        self.perceives(actor, event, name.span, false);
        let types = |params: &[Parameter]| params.iter().map(|p| p.ty).collect::<Vec<_>>();
        let (ours, theirs) = (self.flat(fields), &self.s.events[usize::from(event.0)].params);
        let known = fields.iter().all(|(_, l)| *l != crate::types::TypeLayout::Unknown);
        if known && types(&ours) != types(theirs) {
            let params: Vec<String> = self.fields_of(event).iter().map(|(n, _)| n.clone()).collect();
            let message = format!("the belief has other parameters than the event `{}`", name.text);
            let issue = Diagnostic::error(hrdsl_source::DiagnosticCode::TYPE_MISMATCH, name.span, message);
            let declared = self.events.table.span_of(&name.text);
            let issue = match params.as_slice() {
                [] => issue.help("declare it without parameters"),
                params => {
                    issue.help(format!("declare it with those of the event: `({})`", params.join(", ")))
                }
            };
            self.report(match declared {
                Some(span) => issue.label(span, "the event is declared here"),
                None => issue,
            });
        }
        Some(event)
    }

    /// `goal deliver(leg: 1..4)`
    fn declare_goals(&mut self, index: usize, agent: &ast::AgentSyntax) {
        let mut table = NameTable::default();
        for member in &agent.members {
            let Member::GoalType { name, params } = &member.kind else { continue };
            let fields = self.fields(params);
            if self.issues.declare(&mut table, Noun::Goal, name).is_none() {
                continue;
            }
            match self.names.goals[index].get_mut(&name.text) {
                Some(entry) => {
                    *entry = GoalEntry { arity: fields.len(), fields: Some(fields), place: name.span }
                }
                None if unread::in_agent(agent) => {}
                None => {
                    let goals: Vec<String> = self.names.goals[index].keys().cloned().collect();
                    let issue = no_plan(&name.text, name.span, goals.iter().map(String::as_str));
                    let is_adopted =
                        adopts(agent, &name.text) || self.asked_goals.contains(name.text.as_str());
                    let issue = if is_adopted {
                        issue
                    } else {
                        only_declared(issue, &written(name, params), name.span)
                    };
                    self.report(issue);
                }
            }
        }
    }

    fn agent(&mut self, index: usize, agent: &ast::AgentSyntax) {
        self.source.unread_members = unread::in_agent(agent);
        loop {
            let (issues, before) = (self.issues.list.len(), self.names.wanted.clone());
            self.members(index, agent);
            if self.names.wanted == before {
                break;
            }
            // Plans for goals that give values are looked at with what was found out about these.
            self.issues.list.truncate(issues);
            let it = &mut self.s.agents[index];
            it.initial_beliefs.clear();
            it.initial_goals.clear();
            it.plans.clear();
        }
        self.unadopted(&AgentScope::new(index), agent);
        self.source.unread_members = false;
    }

    /// What holds at the start, and the plans.
    fn members(&mut self, index: usize, agent: &ast::AgentSyntax) {
        let mut scope = AgentScope::new(index);
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
                Member::Rule { .. } | Member::GoalType { .. } | Member::Allow(_) | Member::Error => {}
            }
        }
    }

    /// `= had(0)`: the fact must be of the belief that is being declared.
    fn initial_belief(&mut self, scope: &AgentScope, declared: &ast::NameSyntax, fact: &ast::LiteralSyntax) {
        let Some(belief) = self.belief_or_negation(scope, fact) else { return };
        let name = &fact.call.name;
        if name.text != declared.text {
            let near = [declared.text.as_str()];
            self.report(
                names::unknown(Noun::Belief, &name.text, name.span, near)
                    .label(declared.span, "declared here"),
            );
        }
        let fields = self.belief_fields(scope.id, belief);
        let args = self.ground(Noun::Belief, &fact.call, &fields);
        let marks = self.annotations_of(scope, belief);
        let mut annotations = Vec::new();
        for e in &fact.annotations {
            let Some((annotation, value, ty)) = self.annotation(e, Some(&marks)) else { continue };
            let value = self.expr_for(value, ty, &mut ExprEnv::constants());
            if value.constant().is_none() && value.ty != InferredType::Unknown {
                self.report(types::not_constant(value.span));
            }
            annotations.extend(value.constant().map(|v| (annotation, v)));
        }
        if let Some(args) = args {
            let facts = &mut self.s.agents[usize::from(scope.id.0)].initial_beliefs;
            facts.push(InitialFact { belief, args, annotations });
        }
    }

    fn initial_goal(&mut self, scope: &AgentScope, call: &CallSyntax) {
        let Some(goal) = self.goal(scope, call) else { return };
        let args = match self.goal_fields(scope.id, goal) {
            Some(fields) => self.ground(Noun::Goal, call, &fields).unwrap_or_default(),
            None => {
                let mut args = Vec::new();
                for arg in call.args.as_deref().unwrap_or_default() {
                    args.extend(self.constant(arg, InferredType::Unknown, &mut ExprEnv::constants()));
                }
                args
            }
        };
        self.s.agents[usize::from(scope.id.0)].initial_goals.push((goal, args));
    }

    /// Constant arguments.
    fn ground(&mut self, noun: Noun, call: &CallSyntax, fields: &DeclaredFields) -> Option<Vec<Value>> {
        let args = self.args(noun, call, fields, &mut ExprEnv::constants());
        for arg in &args {
            if arg.constant().is_none() && arg.ty != InferredType::Unknown {
                self.report(types::not_constant(arg.span));
            }
        }
        let values: Option<Vec<Value>> = args.iter().map(crate::TypedExpr::constant).collect();
        let whole = call.args.as_ref().map_or(0, Vec::len) == fields.len();
        values.filter(|_| whole)
    }

    pub(in crate::check) fn belief_fields(&self, agent: AgentId, belief: BeliefId) -> DeclaredFields {
        self.names.belief_fields[usize::from(agent.0)][usize::from(belief.0)].clone()
    }

    pub(in crate::check) fn goal_fields(&self, agent: AgentId, goal: GoalId) -> Option<DeclaredFields> {
        let (_, entry) = self.names.goals[usize::from(agent.0)].get_index(usize::from(goal.0))?;
        entry.fields.clone()
    }

    /// The belief that a literal is of: a declared one, or its strong negation.
    pub(in crate::check) fn belief_or_negation(
        &mut self,
        scope: &AgentScope,
        literal: &ast::LiteralSyntax,
    ) -> Option<BeliefId> {
        let belief = self.belief(scope, &literal.call.name)?;
        if literal.negated { self.negation(scope.id, belief) } else { Some(belief) }
    }

    /// The strong negation of a belief, which is made when it is first used.
    pub(in crate::check) fn negation(&mut self, agent: AgentId, belief: BeliefId) -> Option<BeliefId> {
        let index = usize::from(agent.0);
        let plain = &self.s.agents[index].beliefs[usize::from(belief.0)];
        let name = format!("~{}", plain.name);
        if let Some(id) = self.names.beliefs[index].get(&name) {
            return Some(BeliefId(id));
        }
        let negation = BeliefDecl { name, percept: None, negates: Some(belief), ..plain.clone() };
        let (issues, table) = (&mut self.checker.issues, &mut self.names.beliefs[index]);
        let id = issues.declare_as(table, Noun::Belief, &negation.name, negation.origin)?;
        let fields = self.belief_fields(agent, belief);
        self.names.belief_fields[index].push(fields);
        self.s.agents[index].beliefs.push(negation);
        Some(BeliefId(id))
    }

    pub(super) fn belief(&mut self, scope: &AgentScope, name: &ast::NameSyntax) -> Option<BeliefId> {
        let table = &self.names.beliefs[usize::from(scope.id.0)];
        if let Some(id) = table.get(&name.text) {
            let place = table.span(id);
            self.refer(name, place);
            return Some(BeliefId(id));
        }
        let names: Vec<String> = table.names().filter(|n| !n.starts_with('~')).map(str::to_owned).collect();
        let is_goal = self.names.goals[usize::from(scope.id.0)].contains_key(&name.text);
        self.unknown(Noun::Belief, name, &names, is_goal.then_some(Noun::Goal));
        None
    }

    /// What a name is within the agent.
    pub(in crate::check) fn kind_in_agent(&self, scope: &AgentScope, text: &str) -> Option<Noun> {
        self.kind_of_agent(scope.id, text)
    }

    /// What a name is within some agent.
    pub(in crate::check) fn kind_of_agent(&self, agent: AgentId, text: &str) -> Option<Noun> {
        let index = usize::from(agent.0);
        if self.names.beliefs[index].get(text).is_some() {
            return Some(Noun::Belief);
        }
        self.names.goals[index].contains_key(text).then_some(Noun::Goal)
    }

    /// A goal with its number of arguments; there must be a plan for it.
    pub(in crate::check) fn goal(&mut self, scope: &AgentScope, call: &CallSyntax) -> Option<GoalId> {
        let name = &call.name;
        let goals = &self.names.goals[usize::from(scope.id.0)];
        let Some((index, _, entry)) = goals.get_full(&name.text) else {
            let helpless = !self.issues.compares();
            let goals = self.near(goals.keys().map(String::as_str));
            self.issues.compared += goals.len();
            let near = goals.iter().map(String::as_str);
            let elsewhere = || self.kind_of(&name.text).filter(|is| !is.is_apart());
            let is = self.kind_in_agent(scope, &name.text).or_else(elsewhere);
            let issue = match is {
                Some(is) => names::wrong_kind(Noun::Goal, is, &name.text, name.span, near),
                None if self.source.unread_members => return None,
                None => no_plan(&name.text, name.span, near),
            };
            let issue = Diagnostic { help: issue.help.filter(|_| !helpless), ..issue };
            self.report(issue);
            return None;
        };
        let (got, arity) = (call.args.as_ref().map_or(0, Vec::len), entry.arity);
        let place = entry.place;
        if got != arity {
            let issue = match &entry.fields {
                Some(fields) => {
                    let names: Vec<&str> = fields.iter().map(|(n, _)| n.as_str()).collect();
                    types::arity(Noun::Goal, &name.text, &names, got, call.span)
                }
                None => types::counts(Noun::Goal, &name.text, arity, got, call.span),
            };
            self.report(issue);
            return None;
        }
        self.refer(name, Some(place));
        Some(GoalId(u16::try_from(index).unwrap_or(u16::MAX)))
    }

    /// Several contexts as one.
    pub(in crate::check) fn all_of(mut contexts: Vec<TypedContext>) -> TypedContext {
        match contexts.len() {
            0 => TypedContext::True,
            1 => contexts.remove(0),
            _ => TypedContext::And(contexts),
        }
    }

    /// What each message's content is to each agent.
    fn resolve_contents(&mut self) {
        let all = self.s.contents.iter().zip(&self.s.speech);
        let contents: Vec<(String, bool, usize)> =
            all.map(|(c, speech)| (c.name.clone(), speech.is_goal, speech.arity)).collect();
        let all = || (0u16..).map(AgentId).take(self.players.agents.len());
        let agents: Vec<AgentId> = all().collect();
        for (at, (name, is_goal, arity)) in contents.into_iter().enumerate() {
            let of = agents.iter().map(|agent| self.subject(*agent, &name, is_goal, arity)).collect();
            self.s.contents[at].of = of;
        }
    }

    fn subject(&mut self, agent: AgentId, name: &str, is_goal: bool, arity: usize) -> Option<MessageSubject> {
        let index = usize::from(agent.0);
        if is_goal {
            let id = self.names.goals[index].get_index_of(name)?;
            let fits = usize::from(self.s.agents[index].goals.get(id)?.arity) == arity;
            return u16::try_from(id).ok().filter(|_| fits).map(|id| MessageSubject::Goal(GoalId(id)));
        }
        let plain = BeliefId(self.names.beliefs[index].get(name.trim_start_matches('~'))?);
        let belief = if name.starts_with('~') { self.negation(agent, plain)? } else { plain };
        let fits = self.s.agents[index].beliefs[usize::from(belief.0)].params.len() == arity;
        fits.then_some(MessageSubject::Belief(belief))
    }
}
