//! Declarations that everything else speaks of: actors, constants, events, shared variables, and the names of players.

mod channel;
mod clock;
pub(in crate::check) mod phase;
mod types;

use std::rc::Rc;

use hrdsl_source::{Enumeration, Span};
use hrdsl_syntax::ast::{self, InstanceSyntax, ItemSyntaxKind, NameSyntax, TemplateSyntaxKind};

use crate::check::{
    checker::NOBODY,
    state::{
        names::{ConstEntry, ConstState, DeclaredPlayer},
        record::DeclaredFields,
        scope::ExprEnv,
        template::TemplateArguments,
    },
    template::{CheckerPhase, template},
    vocabulary::phase::VocabularyPhase,
};
use crate::{
    Actor, ActorId, AgentId, AutomatonId, PlayerRef, Role, TypedEvent, TypedStimulus, VariableRef,
    noun::Noun,
    report::{names, roles},
    types::TypeLayout,
};

impl<'a> VocabularyPhase<'_, 'a> {
    /// The names of all agents, `self` and `percept`: the values of the type `agent`.
    fn name_agents(&mut self) {
        let named = |(item, _): (&'a ItemSyntaxKind, Span)| {
            if let ItemSyntaxKind::Agent(agent) = item {
                return agent.params.is_none().then_some(agent.name.text.as_str());
            }
            let ItemSyntaxKind::Instance(instance) = item else { return None };
            (instance.sort == TemplateSyntaxKind::Agent).then_some(instance.name.text.as_str())
        };
        let names: Vec<&str> = self.each_item().filter_map(named).chain(["self", "percept"]).collect();
        self.players.agent_names = Enumeration::intern("agent", &names);
    }

    /// Declares all but channels.
    pub(super) fn names(&mut self) {
        self.name_agents();
        for (item, _) in self.each_item() {
            if let ItemSyntaxKind::Actor { name, role } = item {
                self.declare_actor(name, role);
            } else if let ItemSyntaxKind::Const { name, value } = item {
                self.declare_const(name, value);
            } else if let ItemSyntaxKind::Part(part) = item {
                self.declare_part(part);
            } else if let ItemSyntaxKind::Record { name, fields } = item {
                self.declare_record(name, fields);
            }
        }
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Enum { name, values } = item {
                self.declare_enum(name, values, span);
            }
        }
        self.declare_templates();
        self.all_records();
        self.all_consts();
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Event(event) = item {
                self.declare_events(event, span);
            } else if let ItemSyntaxKind::Stimulus(stimulus) = item {
                self.declare_stimulus(stimulus, span);
            }
        }
        for (item, span) in self.each_item() {
            if template(item).is_some() {
                continue;
            }
            if let ItemSyntaxKind::Instance(instance) = item {
                self.declare_instance(instance, span);
            } else if let ItemSyntaxKind::Var(var) = item {
                self.declare_shared(var, span);
            } else {
                self.declare_player(item, None, span);
            }
        }
    }

    /// An agent or automaton, if it is one; with the instance that it is of a template, and what that gives.
    fn declare_player(
        &mut self,
        item: &'a ItemSyntaxKind,
        of: Option<(&'a InstanceSyntax, Rc<TemplateArguments>)>,
        span: Span,
    ) {
        let (instance, given) = of.unzip();
        let named = |plain: &'a NameSyntax| instance.map_or(plain, |instance| &instance.name);
        if let ItemSyntaxKind::Agent(syntax) = item {
            let declared = DeclaredPlayer { syntax, given, instance };
            self.declare_agent(declared, named(&syntax.name), span);
        } else if let ItemSyntaxKind::Automaton(syntax) = item {
            let declared = DeclaredPlayer { syntax, given, instance };
            self.declare_automaton(declared, named(&syntax.name), span);
        }
    }

    /// An instance of a template of agents or automata.
    fn declare_instance(&mut self, instance: &'a InstanceSyntax, span: Span) {
        if !matches!(instance.sort, TemplateSyntaxKind::Agent | TemplateSyntaxKind::Automaton) {
            return;
        }
        let Some((template, given)) = self.instance(instance, &ExprEnv::constants()) else { return };
        self.declare_player(template.kind, Some((instance, given)), span);
    }

    fn declare_templates(&mut self) {
        for (item, _) in self.each_item() {
            let Some((sort, template)) = template(item) else { continue };
            let name = template.name;
            let key = (sort, name.text.as_str());
            if let Some(first) = self.templates.declared.get(&key) {
                let issue = names::duplicate(Noun::Template, &name.text, name.span, Some(first.name.span));
                self.report(issue);
                continue;
            }
            self.templates.declared.insert(key, template);
        }
    }

    fn declare_actor(&mut self, name: &NameSyntax, role: &NameSyntax) {
        let role = match self.choice(Noun::Role, role, &["environment", "system"]) {
            Some(1) => Role::System,
            Some(_) | None => Role::Environment,
        };
        if self.checker.issues.declare(&mut self.checker.actors, Noun::Actor, name).is_some() {
            self.s.actors.push(Actor { name: name.text.clone(), role, origin: name.span });
        }
    }

    fn declare_const(&mut self, name: &'a NameSyntax, value: &'a ast::ExprSyntax) {
        if let Some(first) = self.consts.get(name.text.as_str()) {
            let issue = names::duplicate(Noun::Constant, &name.text, name.span, Some(first.name.span));
            return self.report(issue);
        }
        self.consts.insert(&name.text, ConstEntry { name, value, state: ConstState::Unseen });
    }

    fn declare_part(&mut self, part: &'a ast::PartSyntax) {
        let name = &part.name;
        if let Some((_, first)) = self.parts.get(name.text.as_str()) {
            let issue = names::duplicate(Noun::Part, &name.text, name.span, Some(*first));
            return self.report(issue);
        }
        self.parts.insert(&name.text, (part, name.span));
    }

    fn declare_events(&mut self, event: &'a ast::EventSyntax, span: Span) {
        let from = self.actor(&event.from);
        let to: Vec<ActorId> = event.to.iter().filter_map(|a| self.actor(a)).collect();
        for one in &event.names {
            let fields = self.plain_fields(&one.params);
            let span = if event.names.len() == 1 { span } else { one.name.span };
            self.push_event(&one.name, fields, from, to.clone(), None, span);
        }
    }

    fn declare_stimulus(&mut self, stimulus: &'a ast::StimulusSyntax, span: Span) {
        let fields = self.plain_fields(&stimulus.params);
        let by = self.actor(&stimulus.by);
        if let Some(actor) = by.filter(|a| self.role_of(*a) == Role::System) {
            let issue = roles::stimulus_by_system(self.actor_name(actor), stimulus.by.span);
            let near: Vec<&str> = self
                .s
                .actors
                .iter()
                .filter(|a| a.role == Role::Environment)
                .map(|a| a.name.as_str())
                .collect();
            let issue = match near.as_slice() {
                [] => issue,
                _ => issue.help(format!("a stimulus is done by the environment: `{}`", near.join("`, `"))),
            };
            self.report(issue);
        }
        self.push_event(&stimulus.name, fields, by, Vec::new(), Some(stimulus), span);
    }

    fn push_event(
        &mut self,
        name: &NameSyntax,
        fields: DeclaredFields,
        from: Option<ActorId>,
        to: Vec<ActorId>,
        stimulus: Option<&'a ast::StimulusSyntax>,
        span: Span,
    ) {
        let noun = if stimulus.is_some() { Noun::Stimulus } else { Noun::Event };
        if self.checker.issues.declare(&mut self.checker.events.table, noun, name).is_some() {
            // Without its actor, which has a diagnostic, the event still is a name.
            let from = from.unwrap_or(NOBODY);
            let body = stimulus.map(|_| TypedStimulus { samples: Vec::new(), steps: Vec::new() });
            let params = self.flat(&fields);
            self.events.fields.push(fields);
            self.s.events.push(TypedEvent {
                name: name.text.clone(),
                params,
                from,
                to,
                stimulus: body,
                origin: span,
            });
            self.stimuli.push(stimulus);
        }
    }

    fn declare_agent(&mut self, agent: DeclaredPlayer<'a, ast::AgentSyntax>, name: &NameSyntax, span: Span) {
        self.not_a_template(TemplateSyntaxKind::Agent, name);
        if self.checker.issues.declare(&mut self.checker.players.table, Noun::Agent, name).is_some() {
            let id = AgentId(u16::try_from(self.s.agents.len()).unwrap_or(u16::MAX));
            self.players.ids.push(PlayerRef::Agent(id));
            self.push_agent(&agent, name, span);
            self.players.agents.push(agent);
        }
    }

    fn declare_automaton(
        &mut self,
        automaton: DeclaredPlayer<'a, ast::AutomatonSyntax>,
        name: &NameSyntax,
        span: Span,
    ) {
        self.not_a_template(TemplateSyntaxKind::Automaton, name);
        if self.checker.issues.declare(&mut self.checker.players.table, Noun::Automaton, name).is_some() {
            let id = AutomatonId(u16::try_from(self.s.automata.len()).unwrap_or(u16::MAX));
            self.players.ids.push(PlayerRef::Automaton(id));
            self.push_automaton(&automaton, name, span);
            self.players.automata.push(automaton);
        }
    }

    fn declare_shared(&mut self, var: &ast::VarSyntax, span: Span) {
        self.check_free(&ExprEnv::constants(), Noun::Variable, &var.name);
        let (issues, names) = (&mut self.checker.issues, &mut self.checker.shared.names);
        if issues.declare(names, Noun::Variable, &var.name).is_none() {
            return;
        }
        if self.declare_shared_clocks(var, span) {
            return;
        }
        let (layout, vars) = self.var(var);
        let place = var.name.span;
        for var in vars {
            // The parts of one variable have names that no other can have.
            let (issues, table) = (&mut self.checker.issues, &mut self.shared_values);
            let Some(i) = issues.declare_as(table, Noun::Variable, &var.name, place) else {
                return;
            };
            Rc::make_mut(&mut self.shared.scope).add_variable(VariableRef::Shared(i), &var, place);
            self.s.shared.push(var);
        }
        if !matches!(layout, TypeLayout::Scalar(_)) {
            Rc::make_mut(&mut self.shared.scope).layouts.insert(var.name.text.clone(), layout);
        }
    }
}
