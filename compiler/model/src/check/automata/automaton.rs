//! Automata: clocks, variables, locations; and networks.

use std::rc::Rc;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, AutomatonMemberKind as Member, ItemSyntaxKind, NameSyntax, TemplateSyntaxKind,
};

use crate::check::state::phase::CheckPhase;
use crate::check::{
    automata::{edge, phase::AutomataPhase},
    state::{
        issues::too_many,
        names::DeclaredPlayer,
        scope::{ExprEnv, IndexedArrays},
        table::{MAX_NAMES, NameTable},
    },
    template::CheckerPhase,
    unread,
};
use crate::{
    ActorId, AutomatonId, LocationId, Network, PlayerRef, TypedLocation, TypedStimulusStep, TypedSync,
    VariableRef, noun::Noun, report::automata, types::TypeLayout,
};

/// The names of one automaton.
pub(in crate::check) struct EdgeScope {
    /// Into the scenario's automata.
    pub index: usize,
    pub actor: Option<ActorId>,
    /// Its own.
    pub clocks: NameTable,
    /// The single values of the variables.
    pub vars: NameTable,
    pub locations: NameTable,
    /// What its edges see besides what they bind.
    pub env: ExprEnv,
}

/// The most events that the stimuli on the edges of one automaton emit.
const MAX_MADE: usize = 10_000;

fn emissions(steps: &[TypedStimulusStep]) -> usize {
    let of = |step: &TypedStimulusStep| match step {
        TypedStimulusStep::Emit { .. } => 1,
        TypedStimulusStep::If { then, otherwise, .. } => emissions(then) + emissions(otherwise),
        TypedStimulusStep::Hold { .. } | TypedStimulusStep::Act(_) => 0,
    };
    steps.iter().map(of).sum()
}

impl AutomataPhase<'_, '_> {
    pub(in crate::check) fn automata(&mut self) {
        self.shared_functions();
        self.templates_of(TemplateSyntaxKind::Automaton, |c, template| {
            let ItemSyntaxKind::Automaton(syntax) = template.kind else { return };
            let index = c.s.automata.len();
            let functions = c.s.functions.len();
            let plain = DeclaredPlayer { syntax, given: None, instance: None };
            c.push_automaton(&plain, template.name, template.name.span);
            c.automaton(index, syntax, true);
            c.s.automata.truncate(index);
            c.s.functions.truncate(functions);
        });
        for (index, automaton) in self.players.automata.clone().into_iter().enumerate() {
            let place = automaton.instance.map(|i| (&i.name, i.span));
            let looked_at = |c: &Self, at| c.source.looks_at(CheckPhase::Automata, at);
            let whole = looked_at(self, automaton.syntax.name.span)
                || automaton.instance.is_some_and(|i| looked_at(self, i.span));
            self.as_instance(automaton.given, place, |c| c.automaton(index, automaton.syntax, whole));
        }
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Network { name, automata } = item {
                self.network(name, automata, span);
            }
        }
    }

    /// Clocks, variables, functions and locations; edges too, if it is looked at as a `whole`.
    fn automaton(&mut self, index: usize, automaton: &ast::AutomatonSyntax, whole: bool) {
        let actor = self.s.automata[index].actor;
        let mut scope = EdgeScope {
            index,
            actor,
            clocks: NameTable::default(),
            vars: NameTable::default(),
            locations: NameTable::default(),
            env: ExprEnv {
                noun: Some(Noun::Variable),
                shared: self.shared.scope.clone(),
                elements: IndexedArrays::Variables,
                ..ExprEnv::default()
            },
        };
        self.source.unread_members = unread::in_automaton(automaton);
        for member in &automaton.members {
            match &member.kind {
                Member::Clock(clocks) => {
                    for clock in clocks {
                        self.clock(index, clock, &mut scope);
                    }
                }
                Member::Var(var) => self.own_var(index, var, &mut scope),
                Member::Location { .. }
                | Member::Edge(_)
                | Member::Function(_)
                | Member::Allow(_)
                | Member::Error => {}
            }
        }
        self.own_functions(index, automaton, &mut scope.env);
        self.locations(index, automaton, &mut scope);
        for member in &automaton.members {
            if let Member::Edge(edge) = &member.kind
                && whole
            {
                let edge = self.edge(&scope, edge, member.span);
                self.s.automata[index].edges.extend(edge);
            }
        }
        let mut own = scope.env.own.clone();
        let locations = scope.locations.entries();
        Rc::make_mut(&mut own).locations =
            locations.filter_map(|(name, id)| Some((name.to_owned(), scope.locations.span(id)?))).collect();
        self.scopes.insert(index, own);
        self.say_impure();
        self.source.unread_members = false;
        self.made(&self.s.automata[index], automaton.name.span).into_iter().for_each(|i| self.report(i));
    }

    /// What the stimuli on edges emit becomes locations and variables, of which there can be too many.
    fn made(&self, automaton: &crate::TypedAutomaton, span: Span) -> Option<hrdsl_source::Diagnostic> {
        let (mut locations, mut vars) =
            (automaton.locations.len(), automaton.vars.len() + self.s.shared.len());
        let mut bound = 0;
        for edge in &automaton.edges {
            bound = bound.max(edge.selects.len());
            let event = match &edge.sync {
                TypedSync::Internal | TypedSync::Join { .. } => continue,
                TypedSync::Offer { channel, .. } | TypedSync::Accept { channel, .. } => {
                    let params = self.s.channels[usize::from(channel.0)].params.len();
                    bound = bound.max(edge.selects.len() + params);
                    continue;
                }
                TypedSync::Send { event, .. } | TypedSync::Receive { event, .. } => event,
            };
            let event = &self.s.events[usize::from(event.0)];
            bound = bound.max(edge.selects.len() + event.params.len());
            let emitted = event.stimulus.as_ref().map_or(0, |s| emissions(&s.steps));
            if emitted > 0 && matches!(edge.sync, TypedSync::Send { .. }) {
                locations = locations.saturating_add(emitted);
                vars += event.params.len();
            }
        }
        let name = &automaton.name;
        if locations > automaton.locations.len() + MAX_MADE {
            let message = format!("the stimuli on the edges of `{name}` emit more than {MAX_MADE} events");
            return Some(too_many(message, span));
        }
        if automaton.clocks.len() + self.s.clocks.len() > MAX_NAMES {
            let message = format!("`{name}` sees more than {} clocks", MAX_NAMES);
            return Some(too_many(message, span));
        }
        (vars + bound > MAX_NAMES)
            .then(|| too_many(format!("`{name}` sees more than {} variables", MAX_NAMES), span))
    }

    fn clock(&mut self, index: usize, clock: &NameSyntax, scope: &mut EdgeScope) {
        self.check_free(&scope.env, Noun::Clock, clock);
        if scope.vars.get(&clock.text).is_none() && scope.clocks.insert(&clock.text, clock.span).is_ok() {
            Rc::make_mut(&mut scope.env.own).add_clock(&clock.text, clock.span);
            self.s.automata[index].clocks.push(clock.text.clone());
        }
    }

    fn own_var(&mut self, index: usize, var: &ast::VarSyntax, scope: &mut EdgeScope) {
        self.check_free(&scope.env, Noun::Clock, &var.name);
        let (layout, vars) = self.var(var);
        if scope.clocks.get(&var.name.text).is_some() {
            return;
        }
        let place = var.name.span;
        for var in vars {
            if let Ok(i) = scope.vars.insert(&var.name, place) {
                Rc::make_mut(&mut scope.env.own).add_variable(VariableRef::Own(i), &var, place);
                self.s.automata[index].vars.push(var);
            }
        }
        if !matches!(layout, TypeLayout::Scalar(_)) {
            Rc::make_mut(&mut scope.env.own).layouts.insert(var.name.text.clone(), layout);
        }
    }

    fn locations(&mut self, index: usize, automaton: &ast::AutomatonSyntax, scope: &mut EdgeScope) {
        let mut initial: Option<(LocationId, Span)> = None;
        let mut broken = false;
        for member in &automaton.members {
            broken |= matches!(member.kind, Member::Error);
            let Member::Location { init, kind, name, invariant } = &member.kind else { continue };
            let mut env = scope.env.clone();
            let edge::Conjunction { bounds, data, mut stopped, .. } =
                self.conjunction(scope, invariant.as_ref(), &mut env);
            stopped.sort_unstable_by_key(|(clock, _)| *clock);
            stopped.dedup_by_key(|(clock, _)| *clock);
            let Some(id) = self.issues.declare(&mut scope.locations, Noun::Location, name) else {
                continue;
            };
            if *init {
                match initial {
                    None => initial = Some((LocationId(id), name.span)),
                    Some((_, first)) => self.report(automata::second_initial(&name.text, name.span, first)),
                }
            }
            self.s.automata[index].locations.push(TypedLocation {
                name: name.text.clone(),
                kind: *kind,
                invariant: bounds,
                holds: data.into_iter().reduce(edge::and),
                stopped: stopped.into_iter().map(|(clock, _)| clock).collect(),
                origin: member.span,
            });
        }
        match initial {
            Some((id, _)) => self.s.automata[index].initial = id,
            None if broken => {}
            None => self.report(automata::no_initial(&automaton.name.text, automaton.name.span)),
        }
    }

    fn network(&mut self, name: &NameSyntax, automata: &[NameSyntax], span: Span) {
        let mut ids: Vec<AutomatonId> = Vec::new();
        let mut seen = NameTable::default();
        for automaton in automata {
            let player = self.players.table.get(&automaton.text).map(|id| self.players.ids[usize::from(id)]);
            if let Some(PlayerRef::Automaton(id)) = player {
                self.refer(automaton, self.players.table.span_of(&automaton.text));
                if self.issues.declare(&mut seen, Noun::Automaton, automaton).is_some() {
                    ids.push(id);
                }
                continue;
            }
            let names = self.near_of(&[Noun::Automaton]);
            self.unknown(Noun::Automaton, automaton, &names, None);
        }
        if self.checker.issues.declare(&mut self.networks.table, Noun::Network, name).is_some() {
            self.s.networks.push(Network { name: name.text.clone(), automata: ids, origin: span });
        }
    }
}
