//! Declarations that everything else speaks of: actors, constants, events, shared variables, and the names of players.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemKind, Name, Param as SyntaxParam, TypeExpr};

use super::{Checker, ConstEntry, ConstState, Env, NOBODY, table::Table};
use crate::{
    Actor, ActorId, Agent, AgentId, Automaton, AutomatonId, Event, Kind, LocationId, Param, Player, Role,
    Stimulus, Type, Value, Var,
    noun::Noun,
    report::{names, roles, types},
};

impl<'a> Checker<'a> {
    pub(super) fn vocabulary(&mut self) {
        for (item, _) in self.each_item() {
            match item {
                ItemKind::Actor { name, role } => self.declare_actor(name, role),
                ItemKind::Const { name, value } => self.declare_const(name, value),
                ItemKind::Part(part) => self.declare_part(part),
                _ => {}
            }
        }
        self.all_consts();
        for (item, span) in self.each_item() {
            match item {
                ItemKind::Event(event) => self.declare_event(event, span),
                ItemKind::Stimulus(stimulus) => self.declare_stimulus(stimulus, span),
                _ => {}
            }
        }
        for (item, span) in self.each_item() {
            match item {
                ItemKind::Agent(agent) => self.declare_agent(agent, span),
                ItemKind::Automaton(automaton) => self.declare_automaton(automaton, span),
                ItemKind::Var(var) => self.declare_shared(var),
                _ => {}
            }
        }
    }

    fn declare_actor(&mut self, name: &Name, role: &Name) {
        let role = match self.choice(Noun::Role, role, &["environment", "system"]) {
            Some(1) => Role::System,
            Some(_) | None => Role::Environment,
        };
        if Self::declare(&mut self.issues, &mut self.actors, Noun::Actor, name).is_some() {
            self.s.actors.push(Actor { name: name.text.clone(), role, span: name.span });
        }
    }

    fn declare_const(&mut self, name: &'a Name, value: &'a ast::Expr) {
        if let Some(first) = self.consts.get(name.text.as_str()) {
            let issue = names::duplicate(Noun::Constant, &name.text, name.span, Some(first.name.span));
            return self.report(issue);
        }
        self.consts.insert(&name.text, ConstEntry { name, value, state: ConstState::Unseen, used: false });
    }

    fn declare_part(&mut self, part: &'a ast::Part) {
        let name = &part.name;
        if let Some((_, first)) = self.parts.get(name.text.as_str()) {
            let issue = names::duplicate(Noun::Part, &name.text, name.span, Some(*first));
            return self.report(issue);
        }
        self.parts.insert(&name.text, (part, name.span));
    }

    fn declare_event(&mut self, event: &'a ast::Event, span: Span) {
        let params = self.params(&event.params);
        let from = self.actor(&event.from);
        let to: Vec<ActorId> = event.to.iter().filter_map(|a| self.actor(a)).collect();
        self.push_event(&event.name, params, from, to, None, span);
    }

    fn declare_stimulus(&mut self, stimulus: &'a ast::Stimulus, span: Span) {
        let params = self.params(&stimulus.params);
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
        self.push_event(&stimulus.name, params, by, Vec::new(), Some(stimulus), span);
    }

    fn push_event(
        &mut self,
        name: &Name,
        params: Vec<Param>,
        from: Option<ActorId>,
        to: Vec<ActorId>,
        stimulus: Option<&'a ast::Stimulus>,
        span: Span,
    ) {
        let noun = if stimulus.is_some() { Noun::Stimulus } else { Noun::Event };
        if Self::declare(&mut self.issues, &mut self.events, noun, name).is_some() {
            // Without its actor, which has a diagnostic, the event still is a name.
            let from = from.unwrap_or(NOBODY);
            let body = stimulus.map(|_| Stimulus::default());
            self.s.events.push(Event { name: name.text.clone(), params, from, to, stimulus: body, span });
            self.bodies.push(stimulus);
        }
    }

    fn declare_agent(&mut self, agent: &'a ast::Agent, span: Span) {
        let actor = self.actor(&agent.plays).unwrap_or(NOBODY);
        if Self::declare(&mut self.issues, &mut self.players, Noun::Agent, &agent.name).is_some() {
            let id = AgentId(u16::try_from(self.s.agents.len()).unwrap_or(u16::MAX));
            self.player_ids.push(Player::Agent(id));
            self.agent_decls.push(agent);
            self.beliefs.push(Table::default());
            self.s.agents.push(Agent {
                name: agent.name.text.clone(),
                actor,
                beliefs: Vec::new(),
                goals: Vec::new(),
                initial_beliefs: Vec::new(),
                initial_goals: Vec::new(),
                plans: Vec::new(),
                span,
            });
        }
    }

    fn declare_automaton(&mut self, automaton: &'a ast::Automaton, span: Span) {
        let actor = self.actor(&automaton.plays).unwrap_or(NOBODY);
        if Self::declare(&mut self.issues, &mut self.players, Noun::Automaton, &automaton.name).is_some() {
            let id = AutomatonId(u16::try_from(self.s.automata.len()).unwrap_or(u16::MAX));
            self.player_ids.push(Player::Automaton(id));
            self.automaton_decls.push(automaton);
            self.s.automata.push(Automaton {
                name: automaton.name.text.clone(),
                actor,
                clocks: Vec::new(),
                vars: Vec::new(),
                locations: Vec::new(),
                initial: LocationId(0),
                edges: Vec::new(),
                span,
            });
        }
    }

    fn declare_shared(&mut self, var: &ast::Var) {
        self.check_free(&Env::constants(), Noun::Variable, &var.name);
        let resolved = self.var(var);
        if Self::declare(&mut self.issues, &mut self.shared, Noun::Variable, &var.name).is_some() {
            self.s.shared.push(resolved);
        }
    }

    /// A variable of an automaton or shared: of a finite type, with a value at the start.
    pub(super) fn var(&mut self, var: &ast::Var) -> Var {
        let ty = self.ty(&var.ty).filter(|ty| self.finite(*ty, "a variable of automata", var.name.span));
        let ty = ty.unwrap_or(Type::Bool);
        let init = var.init.as_ref().and_then(|e| {
            let e = self.expr_for(e, ty, &mut Env::constants());
            if e.constant().is_none() && e.ty != Kind::Unknown {
                self.report(types::not_constant(e.span));
            }
            e.constant()
        });
        let nearest_to_0 = match ty {
            Type::Bool | Type::Float(_) => Value::Bool(false),
            Type::Int { lo, hi } => Value::Int(0.clamp(lo, hi)),
        };
        Var { name: var.name.text.clone(), ty, init: init.unwrap_or(nearest_to_0) }
    }

    /// Parameters; names are distinct.
    pub(super) fn params(&mut self, params: &[SyntaxParam]) -> Vec<Param> {
        let mut table = Table::default();
        let mut resolved = Vec::new();
        for param in params {
            let ty = self.ty(&param.ty).unwrap_or(Type::Bool);
            Self::declare(&mut self.issues, &mut table, Noun::Parameter, &param.name);
            resolved.push(Param { name: param.name.text.clone(), ty });
        }
        resolved
    }

    pub(super) fn ty(&mut self, ty: &TypeExpr) -> Option<Type> {
        match ty {
            TypeExpr::Named(name) => {
                let found = Type::named(&name.text);
                if found.is_none() {
                    let all: Vec<String> = Type::names().map(str::to_owned).collect();
                    self.unknown(Noun::Type, name, &all, None);
                }
                found
            }
            TypeExpr::Range(lo, hi) => {
                let span = lo.span.to(hi.span);
                let lo = self.constant(lo, Kind::Int, &mut Env::constants());
                let hi = self.constant(hi, Kind::Int, &mut Env::constants());
                let (Some(Value::Int(lo)), Some(Value::Int(hi))) = (lo, hi) else { return None };
                if lo > hi {
                    self.report(types::empty_range(Value::Int(lo), Value::Int(hi), span));
                    return None;
                }
                Some(Type::Int { lo, hi })
            }
        }
    }
}
