//! The checker: the scenario so far, what several phases know, and what all of them ask.

use std::collections::BTreeSet;

use hrdsl_ir::known_name;
use hrdsl_source::{Diagnostic, Enumeration, Span};
use hrdsl_syntax::ast::{self, ItemSyntaxKind, NameSyntax};

use super::{
    state::{
        issues::IssueList,
        names::{
            CheckedSource, ConstEntry, EventNames, PlayerNames, SharedNames, TemplateNames, TypeNames,
            WorldState,
        },
        table::{NameTable, OrderedMap},
        template::TemplateArgument,
        world::WorldNames,
    },
    unread,
};
use crate::{
    ActorId, ArgPattern, CoverpointId, DefinedType, EventId, InferredType, NameDefinition, Resolutions, Role,
    Scenario,
    measures::MEASURES,
    noun::Noun,
    report::{
        names::{unknown, wrong_kind},
        types,
    },
};

/// Stands for an actor whose name is unknown, so that nothing else is said about it.
pub(super) const NOBODY: ActorId = ActorId(u16::MAX);

/// What [`Noun::EventOrStimulus`] means.
pub(super) const EVENTS: [Noun; 2] = [Noun::Event, Noun::Stimulus];

/// The scenario so far, and what is known for the rest of it by more than one phase.
pub(crate) struct Checker<'a> {
    pub(super) s: Scenario,
    pub(super) issues: IssueList,
    pub(super) source: CheckedSource<'a>,
    // the vocabulary
    pub(super) actors: NameTable,
    pub(super) consts: OrderedMap<&'a str, ConstEntry<'a>>,
    pub(super) types: TypeNames<'a>,
    pub(super) templates: TemplateNames<'a>,
    pub(super) events: EventNames,
    pub(super) players: PlayerNames<'a>,
    pub(super) shared: SharedNames,
    // the world
    pub(super) world: WorldState,
    // what is met on the way
    /// The variables of agents without a value that were read since this was emptied.
    pub(super) unbound: BTreeSet<String>,
    /// Coverpoints, which templates can be given.
    pub(super) points: NameTable,
}

impl<'a> Checker<'a> {
    pub(super) fn new(source: CheckedSource<'a>) -> Self {
        let exists = source.items.iter().any(|i| matches!(i.kind, ItemSyntaxKind::World(_)));
        Self {
            s: Scenario { names: Resolutions::of_items(&source.items), ..Scenario::default() },
            issues: IssueList::default(),
            source,
            actors: NameTable::default(),
            consts: OrderedMap::default(),
            types: TypeNames::default(),
            templates: TemplateNames::default(),
            events: EventNames::default(),
            players: PlayerNames {
                table: NameTable::default(),
                ids: Vec::new(),
                agents: Vec::new(),
                automata: Vec::new(),
                agent_names: Enumeration::intern("agent", &["self", "percept"]),
            },
            shared: SharedNames::default(),
            world: WorldState { exists, names: WorldNames::default(), missed: Vec::new() },
            unbound: BTreeSet::new(),
            points: NameTable::default(),
        }
    }

    /// A name means what is declared there.
    pub(super) fn refer(&mut self, name: &NameSyntax, place: Option<Span>) {
        if let Some(place) = place {
            self.s.names.refer(name.span, place);
        }
    }

    /// A name is that of a part of the declaration whose name stands there: a field, a parameter.
    pub(super) fn refer_within(&mut self, name: &NameSyntax, place: Span, noun: Noun) {
        let whole = self.s.names.defined_at(place).map(|definition| definition.whole);
        let part = whole.and_then(|whole| self.s.names.named_in(whole, noun, &name.text));
        self.refer(name, part);
    }

    /// A variable that is declared where it first stands.
    pub(super) fn define_here(&mut self, name: &NameSyntax, ty: InferredType) {
        let inferred = |ty: InferredType| DefinedType::Inferred(ty.to_string());
        self.s.names.define(NameDefinition {
            noun: Noun::Variable.word(),
            name: name.text.clone(),
            place: name.span,
            whole: name.span,
            ty: if ty == InferredType::Unknown { DefinedType::None } else { inferred(ty) },
            doc: String::new(),
        });
    }

    pub(super) fn report(&mut self, issue: Diagnostic) {
        self.issues.list.push(issue);
    }

    /// All items' kinds, with the spans of the items. Independent of `self`, so that it can be walked while checking.
    pub(super) fn each_item(&self) -> impl Iterator<Item = (&'a ItemSyntaxKind, Span)> + use<'a> {
        let items: Vec<&'a ast::ItemSyntax> = self.source.items.clone();
        items.into_iter().map(|i| (&i.kind, i.span))
    }

    // ── names that are visible everywhere ──

    pub(super) fn actor(&mut self, name: &NameSyntax) -> Option<ActorId> {
        match self.given(&name.text) {
            Some(TemplateArgument::Actor(id)) => {
                let id = *id;
                self.refer_given(name);
                return Some(id);
            }
            Some(TemplateArgument::Unknown) => {
                self.refer_given(name);
                return Some(NOBODY);
            }
            Some(
                TemplateArgument::Value(_)
                | TemplateArgument::Events(_)
                | TemplateArgument::Thing(..)
                | TemplateArgument::Point(_),
            )
            | None => {}
        }
        match self.actors.get(&name.text) {
            Some(id) => {
                self.refer(name, self.actors.span(id));
                Some(ActorId(id))
            }
            None => {
                let names = self.near_of(&[Noun::Actor]);
                self.unknown(Noun::Actor, name, &names, None);
                None
            }
        }
    }

    /// An event, a stimulus, or either.
    pub(super) fn event(&mut self, noun: Noun, name: &NameSyntax, local: Option<Noun>) -> Option<EventId> {
        match self.given(&name.text) {
            Some(TemplateArgument::Events(patterns)) => {
                if let [only] = patterns.as_slice()
                    && only.args.iter().all(|a| *a == ArgPattern::Any)
                {
                    let event = only.event;
                    self.refer_given(name);
                    return Some(event);
                }
                self.report(types::several_events(&name.text, name.span));
                return None;
            }
            Some(TemplateArgument::Unknown) => {
                self.refer_given(name);
                return None;
            }
            Some(
                TemplateArgument::Value(_)
                | TemplateArgument::Actor(_)
                | TemplateArgument::Thing(..)
                | TemplateArgument::Point(_),
            )
            | None => {}
        }
        let fits = |c: &Self, id: u16| {
            let is = c.s.events[usize::from(id)].stimulus.is_some();
            noun == Noun::EventOrStimulus || is == (noun == Noun::Stimulus)
        };
        if let Some(id) = self.events.table.get(&name.text).filter(|id| fits(self, *id)) {
            self.refer(name, self.events.table.span(id));
            return Some(EventId(id));
        }
        let either = noun == Noun::EventOrStimulus;
        let mut names = self.near_of(if either { &EVENTS } else { std::slice::from_ref(&noun) });
        if either {
            names.extend(self.given_names(Noun::Event));
        }
        self.unknown(noun, name, &names, local);
        None
    }

    /// A coverpoint.
    pub(super) fn point_named(&mut self, name: &NameSyntax) -> Option<CoverpointId> {
        match self.given(&name.text) {
            Some(TemplateArgument::Point(id)) => {
                let id = *id;
                self.refer_given(name);
                return Some(id);
            }
            Some(TemplateArgument::Unknown) => {
                self.refer_given(name);
                return None;
            }
            Some(
                TemplateArgument::Value(_)
                | TemplateArgument::Events(_)
                | TemplateArgument::Actor(_)
                | TemplateArgument::Thing(..),
            )
            | None => {}
        }
        let found = self.points.get(&name.text).map(CoverpointId);
        self.refer(name, self.points.span_of(&name.text));
        if found.is_none() {
            let mut all = self.near_of(&[Noun::Point]);
            all.extend(self.given_names(Noun::Point));
            self.unknown(Noun::Point, name, &all, None);
        }
        found
    }

    /// Says that `name` is no `noun`; `local` is what else it is in the place's own scope.
    pub(super) fn unknown(&mut self, noun: Noun, name: &NameSyntax, names: &[String], local: Option<Noun>) {
        if self.templates.broken_instances.contains(&name.text) {
            return;
        }
        let is = local.or_else(|| self.kind_of(&name.text));
        let known = local.is_some() || is.is_some_and(|is| is == noun || !is.is_apart());
        if !known && unread::may_declare(noun, self.source.unread_items, self.source.unread_members) {
            return;
        }
        let helpless = !self.issues.compares();
        self.issues.compared += names.len();
        let names = names.iter().map(String::as_str).filter(|_| !helpless);
        let mut issue = match is {
            Some(is) if is != noun => wrong_kind(noun, is, &name.text, name.span, names),
            Some(_) | None => unknown(noun, &name.text, name.span, names),
        };
        if helpless {
            issue.help = None;
        } else if noun == Noun::EventOrStimulus && MEASURES.contains(&name.text.as_str()) {
            // Somebody wrote a condition where something has to happen.
            let help = format!(
                "`{0}` measures the world, and nothing happens by it: write `globally !{0}(…)`, `rising({0}(…))`, or `… while {0}(…)`",
                name.text
            );
            issue = issue.help(help);
        }
        self.report(issue);
    }

    /// What a globally visible name is: a parameter of the template hides others, and the world's parts are made, not declared.
    pub(super) fn kind_of(&self, text: &str) -> Option<Noun> {
        if self.given(text).is_some() {
            return Some(Noun::Parameter);
        }
        self.s.names.kind_of(text).or_else(|| self.world.names.kind_of(text))
    }

    /// Whether a name is of something that other declarations speak of in their expressions, if wrongly.
    pub(super) fn is_spoken_of(&self, name: &str) -> bool {
        self.kind_of(name).is_some_and(|is| !is.is_apart())
    }

    /// The names that a misspelt one may have been meant to be; none after many misspelt names, since looking for the
    /// nearest takes time that grows with both.
    pub(super) fn near<'n>(&self, names: impl Iterator<Item = &'n str>) -> Vec<String> {
        if self.issues.compares() { names.map(str::to_owned).collect() } else { Vec::new() }
    }

    /// The same: those of these kinds that are visible everywhere.
    pub(super) fn near_of(&self, nouns: &[Noun]) -> Vec<String> {
        if self.issues.compares() { self.near(self.s.names.names_of(nouns).into_iter()) } else { Vec::new() }
    }

    /// A word that is one of a fixed list.
    pub(super) fn choice(&mut self, noun: Noun, name: &NameSyntax, words: &[&str]) -> Option<usize> {
        let found = words.iter().position(|w| *w == name.text);
        if found.is_none() {
            self.report(unknown(noun, &name.text, name.span, words.iter().copied()));
        }
        found
    }

    pub(super) fn role_of(&self, actor: ActorId) -> Role {
        self.s.actors.get(usize::from(actor.0)).map_or(Role::Environment, |a| a.role)
    }

    pub(super) fn actor_name(&self, actor: ActorId) -> &str {
        known_name("actor", self.s.actors.get(usize::from(actor.0)).map(|a| a.name.as_str()))
    }
}
