//! Automata: clocks, variables, locations; and networks.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, AutomatonMemberKind as Member, ItemKind, Name, Sort};

use super::{Checker, Declared, Env, env::Local, table::Table};
use crate::{
    ActorId, AutomatonId, ClockOp, Leaf, Location, LocationId, Network, Player, noun::Noun, report::automata,
    types::Layout,
};

/// The names of one automaton.
pub(super) struct Scope {
    /// Into the scenario's automata.
    pub index: usize,
    pub actor: ActorId,
    pub clocks: Table,
    /// The single values of the variables.
    pub vars: Table,
    /// Of the variables that have several.
    pub layouts: Vec<(String, Layout)>,
    pub locations: Table,
    /// What its edges see besides what they bind.
    pub env: Env,
}

impl Checker<'_> {
    pub(super) fn automata(&mut self) {
        self.templates_of(Sort::Automaton, |c, template| {
            let ItemKind::Automaton(syntax) = template.kind else { return };
            let index = c.s.automata.len();
            let plain = Declared { syntax, given: None, instance: None };
            c.push_automaton(&plain, template.name, template.name.span);
            c.automaton(index, syntax);
            c.s.automata.truncate(index);
        });
        for (index, automaton) in self.automaton_decls.clone().into_iter().enumerate() {
            let place = automaton.instance.map(|i| (&i.name, i.span));
            self.as_instance(automaton.given, place, |c| c.automaton(index, automaton.syntax));
        }
        for (item, span) in self.each_item() {
            if let ItemKind::Network { name, automata } = item {
                self.network(name, automata, span);
            }
        }
    }

    fn automaton(&mut self, index: usize, automaton: &ast::Automaton) {
        let actor = self.s.automata[index].actor;
        let mut scope = Scope {
            index,
            actor,
            clocks: Table::default(),
            vars: Table::default(),
            layouts: Vec::new(),
            locations: Table::default(),
            env: Env::default(),
        };
        self.unread_members = super::unread::in_automaton(automaton);
        for member in &automaton.members {
            match &member.kind {
                Member::Clock(clocks) => {
                    for clock in clocks {
                        self.clock(index, clock, &mut scope);
                    }
                }
                Member::Var(var) => self.own_var(index, var, &mut scope),
                Member::Location { .. } | Member::Edge(_) | Member::Allow(_) | Member::Error => {}
            }
        }
        scope.env = self.automaton_env(&scope);
        self.locations(index, automaton, &mut scope);
        for member in &automaton.members {
            if let Member::Edge(edge) = &member.kind {
                let edge = self.edge(&scope, edge, member.span);
                self.s.automata[index].edges.extend(edge);
            }
        }
        self.unread_members = false;
    }

    fn clock(&mut self, index: usize, clock: &Name, scope: &mut Scope) {
        self.check_free(&self.automaton_env(scope), Noun::Clock, clock);
        if scope.vars.get(&clock.text).is_none() && scope.clocks.insert(&clock.text, clock.span).is_ok() {
            self.s.automata[index].clocks.push(clock.text.clone());
        }
    }

    fn own_var(&mut self, index: usize, var: &ast::Var, scope: &mut Scope) {
        self.check_free(&self.automaton_env(scope), Noun::Clock, &var.name);
        let (layout, vars) = self.var(var);
        if scope.clocks.get(&var.name.text).is_some() {
            return;
        }
        for var in vars {
            if scope.vars.insert(&var.name, var.span).is_ok() {
                self.s.automata[index].vars.push(var);
            }
        }
        if !matches!(layout, Layout::Scalar(_)) {
            scope.layouts.push((var.name.text.clone(), layout));
        }
    }

    /// What the automaton's expressions can see: its variables, clocks (only in bounds), and the shared variables.
    fn automaton_env(&self, scope: &Scope) -> Env {
        let layouts = scope.layouts.clone();
        let mut env = Env { noun: Some(Noun::Variable), layouts, ..Env::default() };
        for (name, i) in scope.vars.entries() {
            let own = local(name, Noun::Variable, Some(Leaf::Own(i)));
            let ty = self.s.automata[scope.index].vars[usize::from(i)].ty;
            env.locals.push(Local { ty: ty.kind(), range: ty.range(), ..own });
        }
        for (name, _) in scope.clocks.entries() {
            env.locals.push(local(name, Noun::Clock, None));
        }
        for (i, var) in (0..).zip(&self.s.shared) {
            if env.find(&var.name).is_none() {
                let shared = local(&var.name, Noun::Variable, Some(Leaf::Shared(i)));
                env.locals.push(Local { ty: var.ty.kind(), range: var.ty.range(), ..shared });
            }
        }
        for (name, layout) in &self.shared_layouts {
            if env.find(name).is_none() {
                env.declare_layout(name, layout.clone());
            }
        }
        env
    }

    fn locations(&mut self, index: usize, automaton: &ast::Automaton, scope: &mut Scope) {
        let mut initial: Option<(LocationId, Span)> = None;
        let mut broken = false;
        for member in &automaton.members {
            broken |= matches!(member.kind, Member::Error);
            let Member::Location { init, kind, name, invariant } = &member.kind else { continue };
            let mut bounds = Vec::new();
            if let Some(e) = invariant {
                let mut env = scope.env.clone();
                for part in super::edge::conjuncts(e) {
                    let bound = self.clock_bound(part, scope, &mut env);
                    match bound {
                        Some(Some(b)) if b.minus.is_none() && matches!(b.op, ClockOp::Lt | ClockOp::Le) => {
                            bounds.push(b);
                        }
                        Some(None) => {}
                        Some(Some(_)) => self.report(automata::bad_invariant(part.span)),
                        None => {
                            let known = self.issues.len();
                            self.expr_of(part, crate::Kind::Bool, &mut env);
                            // A name that does not exist is said before what an invariant is.
                            if self.issues.len() == known && !self.unread_members {
                                self.report(automata::bad_invariant(part.span));
                            }
                        }
                    }
                }
            }
            let Some(id) = Self::declare(&mut self.issues, &mut scope.locations, Noun::Location, name) else {
                continue;
            };
            if *init {
                match initial {
                    None => initial = Some((LocationId(id), name.span)),
                    Some((_, first)) => self.report(automata::second_initial(&name.text, name.span, first)),
                }
            }
            let location =
                Location { name: name.text.clone(), kind: *kind, invariant: bounds, span: member.span };
            self.s.automata[index].locations.push(location);
        }
        match initial {
            Some((id, _)) => self.s.automata[index].initial = id,
            None if broken => {}
            None => self.report(automata::no_initial(&automaton.name.text, automaton.name.span)),
        }
    }

    fn network(&mut self, name: &Name, automata: &[Name], span: Span) {
        let mut ids: Vec<AutomatonId> = Vec::new();
        let mut seen = Table::default();
        for automaton in automata {
            let player = self.players.get(&automaton.text).map(|id| self.player_ids[usize::from(id)]);
            if let Some(Player::Automaton(id)) = player {
                if Self::declare(&mut self.issues, &mut seen, Noun::Automaton, automaton).is_some() {
                    ids.push(id);
                }
                continue;
            }
            let names: Vec<String> = self.s.automata.iter().map(|a| a.name.clone()).collect();
            self.unknown(Noun::Automaton, automaton, &names, None);
        }
        if Self::declare(&mut self.issues, &mut self.networks, Noun::Network, name).is_some() {
            self.s.networks.push(Network { name: name.text.clone(), automata: ids, span });
        }
    }
}

fn local(name: &str, noun: Noun, leaf: Option<Leaf>) -> Local {
    Local { name: name.to_owned(), noun, leaf, ty: crate::Kind::Unknown, range: None, bound: true }
}
