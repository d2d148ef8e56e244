//! The checker: declares all names, then resolves what is written about them, concern by concern.

mod agent;
mod args;
mod assign;
mod automaton;
mod channel;
mod clock;
mod combine;
mod context;
mod coverage;
mod device;
mod due;
mod edge;
mod env;
mod expr;
mod function;
mod given;
mod internal;
mod internal_table;
mod item;
mod layout;
mod linear;
mod list;
mod lookup;
mod measure;
mod message;
mod place;
mod places;
mod plan;
mod query;
mod range;
mod requirement;
mod rule;
mod statement;
mod steps;
mod stimulus;
mod suite;
mod system;
mod table;
mod terms;
mod test;
mod unread;
mod vocabulary;
mod world;
mod world_parts;

use crate::DefinedType;
use crate::Definition;
use crate::Kind;
use crate::Resolutions;
use std::{
    collections::{BTreeMap, BTreeSet},
    rc::Rc,
};

use hrdsl_source::{Code, Diagnostic, Enumeration, Span};
use hrdsl_syntax::ast::{self, Instance, ItemKind, Name, Sort};

use crate::{
    ActorId, ArgPattern, EventId, PlayerRef, PointId, Role, Scenario,
    noun::Noun,
    report::{
        names::{duplicate, unknown, wrong_kind},
        types,
    },
};
use env::Env;
use given::{Given, Givens, Template};
pub use internal_table::{INTERNAL_ACTIONS, InternalAction, Slot};
use item::Item;
pub(crate) use layout::type_span;
use layout::{Fields, RecordEntry};
pub(crate) use linear::BadTime;
use table::{MAX_NAMES, Map, Refused, Table};

/// Resolves and checks a scenario with the modules it uses and files of tests in its vocabulary.
///
/// # Steps
/// 1. [`Checker::vocabulary`]: actors, types, constants, events, stimuli, shared variables, templates, the names of
///    agents and automata, and channels
/// 2. [`Checker::devices`], [`Checker::world`]: what devices can be told; bodies with their parts, signals, rules
/// 3. [`Checker::stimuli`]: what stimuli do to the world
/// 4. [`Checker::agents`], [`Checker::automata`]: those who play the actors
/// 5. [`Checker::queries`], [`Checker::requirements`], [`Checker::coverage`], [`Checker::suites`], [`Checker::systems`]
/// 6. [`Checker::tests`]
#[must_use]
pub fn resolve(
    scenario: &ast::File,
    modules: &[&ast::File],
    tests: &[&ast::File],
) -> (Scenario, Vec<Diagnostic>) {
    resolve_part(scenario, modules, tests, false)
}

/// The same, where some module may be `missing`: nothing is said about parts that it may have.
#[must_use]
pub fn resolve_part(
    scenario: &ast::File,
    modules: &[&ast::File],
    tests: &[&ast::File],
    missing: bool,
) -> (Scenario, Vec<Diagnostic>) {
    let mut items: Vec<&ast::Item> =
        modules.iter().flat_map(|m| &m.items).filter(|i| shared(&i.kind)).collect();
    let from_modules = items.len();
    items.extend(&scenario.items);
    let mut checker = Checker::new(items, from_modules);
    checker.missing_modules = missing;
    checker.s.names = Resolutions::of_items(&checker.items);
    checker.unread_items = checker.items.iter().any(|i| unread::in_item(&i.kind));
    checker.s.name = scenario.scenario.as_ref().map_or_else(String::new, |n| n.text.clone());
    checker.vocabulary();
    checker.devices();
    checker.world();
    checker.stimuli();
    checker.agents();
    checker.automata();
    checker.queries();
    checker.requirements();
    checker.coverage();
    checker.unread_members = checker.agent_decls.iter().any(|a| unread::in_agent(a.syntax));
    checker.suites();
    checker.unread_members = false;
    checker.systems();
    checker.tests(tests);
    checker.say_without_world();
    checker.places();
    (checker.s, distinct(checker.issues))
}

/// What a module shares. Anything else in it has a diagnostic, and is not the scenario's.
fn shared(kind: &ItemKind) -> bool {
    !matches!(kind, ItemKind::World(_) | ItemKind::System(_) | ItemKind::Suite(_) | ItemKind::Test(_))
}

/// A part that is used twice has its faults once.
fn distinct(issues: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut seen: BTreeSet<(Span, Code, String)> = BTreeSet::new();
    issues.into_iter().filter(|i| seen.insert((i.span(), i.code, i.message.clone()))).collect()
}

/// How far the value of a constant is known.
enum ConstState {
    Unseen,
    /// Its own value is being worked out.
    Open,
    Done(Item),
}

struct ConstEntry<'a> {
    name: &'a Name,
    value: &'a ast::Expr,
    state: ConstState,
}

/// Stands for an actor whose name is unknown, so that nothing else is said about it.
const NOBODY: ActorId = ActorId(u16::MAX);

/// An agent or automaton: as written, and if it is an instance of a template, what is given.
pub(crate) struct Declared<'a, T> {
    pub syntax: &'a T,
    pub given: Option<Rc<Givens>>,
    pub instance: Option<&'a Instance>,
}

impl<T> Clone for Declared<'_, T> {
    fn clone(&self) -> Self {
        Self { syntax: self.syntax, given: self.given.clone(), instance: self.instance }
    }
}

pub(crate) struct Checker<'a> {
    s: Scenario,
    issues: Vec<Diagnostic>,
    items: Vec<&'a ast::Item>,
    /// The first items come from modules.
    from_modules: usize,
    actors: Table,
    enums: Table,
    /// By their bare names: the values of enumerations.
    values: Map<&'a str, Vec<Enumeration>>,
    record_names: Table,
    records: Vec<RecordEntry<'a>>,
    /// How many records are being resolved, each in the one before.
    open_records: usize,
    /// By sort and name.
    templates: Map<(Sort, &'a str), Template<'a>>,
    /// Instances that could not be made: nothing is said about their names.
    broken_instances: BTreeSet<String>,
    /// What the parameters stand for in the instance that is being checked.
    given: Option<Rc<Givens>>,
    /// A template is being checked by itself, with some values.
    by_itself: bool,
    events: Table,
    /// By [`EventId`]: the parameters as declared.
    event_fields: Vec<Fields>,
    /// Agents and automata.
    players: Table,
    player_ids: Vec<PlayerRef>,
    /// The single values of the shared variables.
    shared: Table,
    shared_names: Table,
    /// What every automaton sees of them, and of the shared clocks.
    shared_scope: Rc<env::Scope>,
    /// What is known of the functions that are being checked.
    functions: function::Functions,
    shared_clocks: Table,
    channels: Table,
    /// Some party of these joint channels has a diagnostic.
    vague_channels: BTreeSet<String>,
    /// By [`ChannelId`](crate::ChannelId): the parameters as declared.
    channel_fields: Vec<Fields>,
    networks: Table,
    queries: Table,
    requirement_names: Table,
    /// By the place in the scenario's automata: what the edges of each see.
    automaton_scopes: BTreeMap<usize, Rc<env::Scope>>,
    points: Table,
    crosses: Table,
    suites: Table,
    parts: Map<&'a str, (&'a ast::Part, Span)>,
    consts: Map<&'a str, ConstEntry<'a>>,
    /// By [`EventId`]: the body of each stimulus.
    bodies: Vec<Option<&'a ast::Stimulus>>,
    agent_decls: Vec<Declared<'a, ast::Agent>>,
    automaton_decls: Vec<Declared<'a, ast::Automaton>>,
    /// The beliefs of each agent, and their parameters as declared.
    beliefs: Vec<Table>,
    belief_fields: Vec<Vec<Fields>>,
    /// The goals of each agent.
    goal_tables: Vec<Map<String, agent::GoalEntry>>,
    /// By agent and belief: what its rules need of its arguments.
    modes: BTreeMap<(u16, u16), Vec<rule::Mode>>,
    /// The goals that some message asks somebody to achieve, by name.
    asked_goals: BTreeSet<&'a str>,
    /// The names of all agents, `self` and `percept`.
    agent_names: Enumeration,
    /// The variables without a value that were read since this was emptied.
    unbound: BTreeSet<String>,
    has_world: bool,
    /// The parts that are being taken apart, the outermost first.
    open_parts: Vec<&'a str>,
    in_world: world_parts::WorldNames,
    /// What needs a world where the scenario has none: one cause, which is said once.
    without_world: Vec<(Span, String)>,
    /// A module is missing, which may have the parts that are used.
    missing_modules: bool,
    /// The suite that is being checked names a player that does not exist.
    unknown_player: bool,
    /// A declaration of the scenario, or a member of its world, could not be read.
    unread_items: bool,
    /// A member of the agent or automaton that is being checked could not be read.
    unread_members: bool,
    /// How many names were looked at for those that were misspelt.
    compared: usize,
    /// How many nodes of expressions may still be copied.
    copies: usize,
    /// The codes and places of the first issues; see [`Checker::as_instance`].
    said: BTreeSet<(Code, Span)>,
    said_of: usize,
}

/// After so many comparisons no nearest names are looked for.
const MAX_COMPARED: usize = 500_000;

impl<'a> Checker<'a> {
    fn new(items: Vec<&'a ast::Item>, from_modules: usize) -> Self {
        let has_world = items.iter().any(|i| matches!(i.kind, ItemKind::World(_)));
        Self {
            s: Scenario::default(),
            issues: Vec::new(),
            items,
            from_modules,
            actors: Table::default(),
            enums: Table::default(),
            values: Map::default(),
            record_names: Table::default(),
            records: Vec::new(),
            open_records: 0,
            templates: Map::default(),
            without_world: Vec::new(),
            broken_instances: BTreeSet::new(),
            given: None,
            by_itself: false,
            events: Table::default(),
            event_fields: Vec::new(),
            players: Table::default(),
            player_ids: Vec::new(),
            shared: Table::default(),
            shared_names: Table::default(),
            shared_scope: Rc::default(),
            functions: function::Functions::default(),
            shared_clocks: Table::default(),
            channels: Table::default(),
            vague_channels: BTreeSet::new(),
            channel_fields: Vec::new(),
            networks: Table::default(),
            queries: Table::default(),
            requirement_names: Table::default(),
            automaton_scopes: BTreeMap::new(),
            points: Table::default(),
            crosses: Table::default(),
            suites: Table::default(),
            parts: Map::default(),
            consts: Map::default(),
            bodies: Vec::new(),
            agent_decls: Vec::new(),
            automaton_decls: Vec::new(),
            beliefs: Vec::new(),
            belief_fields: Vec::new(),
            goal_tables: Vec::new(),
            modes: BTreeMap::new(),
            asked_goals: BTreeSet::new(),
            agent_names: Enumeration::intern("agent", &["self", "percept"]),
            unbound: BTreeSet::new(),
            has_world,
            open_parts: Vec::new(),
            missing_modules: false,
            unknown_player: false,
            unread_items: false,
            unread_members: false,
            compared: 0,
            copies: item::MAX_COPIES,
            said: BTreeSet::new(),
            said_of: 0,
            in_world: world_parts::WorldNames::default(),
        }
    }

    /// A name means what is declared there.
    fn refer(&mut self, name: &Name, place: Option<Span>) {
        if let Some(place) = place {
            self.s.names.refer(name.span, place);
        }
    }

    /// A name is that of a part of the declaration whose name stands there: a field, a parameter.
    fn refer_within(&mut self, name: &Name, place: Span, noun: &str) {
        let whole = self.s.names.defined_at(place).map(|definition| definition.whole);
        let part = whole.and_then(|whole| self.s.names.named_in(whole, noun, &name.text));
        self.refer(name, part);
    }

    /// A variable that is declared where it first stands.
    fn define_here(&mut self, name: &Name, ty: Kind) {
        let inferred = |ty: Kind| DefinedType::Inferred(ty.to_string());
        self.s.names.define(Definition {
            noun: "variable",
            name: name.text.clone(),
            place: name.span,
            whole: name.span,
            ty: if ty == Kind::Unknown { DefinedType::None } else { inferred(ty) },
            doc: String::new(),
        });
    }

    fn report(&mut self, issue: Diagnostic) {
        self.issues.push(issue);
    }

    /// All items' kinds, with the spans of the items. Independent of `self`, so that it can be walked while checking.
    fn each_item(&self) -> impl Iterator<Item = (&'a ItemKind, Span)> + use<'a> {
        let items: Vec<&'a ast::Item> = self.items.clone();
        items.into_iter().map(|i| (&i.kind, i.span))
    }

    // ── names that are visible everywhere ──

    fn actor(&mut self, name: &Name) -> Option<ActorId> {
        match self.given(&name.text) {
            Some(Given::Actor(id)) => {
                let id = *id;
                self.refer_given(name);
                return Some(id);
            }
            Some(Given::Unknown) => {
                self.refer_given(name);
                return Some(NOBODY);
            }
            Some(Given::Value(_) | Given::Events(_) | Given::Thing(..) | Given::Point(_)) | None => {}
        }
        match self.actors.get(&name.text) {
            Some(id) => {
                self.refer(name, self.actors.span(id));
                Some(ActorId(id))
            }
            None => {
                let names = self.near(self.actors.names());
                self.unknown(Noun::Actor, name, &names, None);
                None
            }
        }
    }

    /// An event, a stimulus, or either.
    fn event(&mut self, noun: Noun, name: &Name, local: Option<Noun>) -> Option<EventId> {
        match self.given(&name.text) {
            Some(Given::Events(patterns)) => {
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
            Some(Given::Unknown) => {
                self.refer_given(name);
                return None;
            }
            Some(Given::Value(_) | Given::Actor(_) | Given::Thing(..) | Given::Point(_)) | None => {}
        }
        let fits = |c: &Self, id: u16| {
            let is = c.s.events[usize::from(id)].stimulus.is_some();
            noun == Noun::EventOrStimulus || is == (noun == Noun::Stimulus)
        };
        if let Some(id) = self.events.get(&name.text).filter(|id| fits(self, *id)) {
            self.refer(name, self.events.span(id));
            return Some(EventId(id));
        }
        let mut names = self.near(self.events.entries().filter(|(_, id)| fits(self, *id)).map(|(n, _)| n));
        if noun == Noun::EventOrStimulus {
            names.extend(self.given_names(Noun::Event));
        }
        self.unknown(noun, name, &names, local);
        None
    }

    /// A coverage point.
    fn point_named(&mut self, name: &Name) -> Option<PointId> {
        match self.given(&name.text) {
            Some(Given::Point(id)) => {
                let id = *id;
                self.refer_given(name);
                return Some(id);
            }
            Some(Given::Unknown) => {
                self.refer_given(name);
                return None;
            }
            Some(Given::Value(_) | Given::Events(_) | Given::Actor(_) | Given::Thing(..)) | None => {}
        }
        let found = self.points.get(&name.text).map(PointId);
        self.refer(name, self.points.span_of(&name.text));
        if found.is_none() {
            let mut all = self.near(self.points.names());
            all.extend(self.given_names(Noun::Point));
            self.unknown(Noun::Point, name, &all, None);
        }
        found
    }

    /// Says that `name` is no `noun`; `local` is what else it is in the place's own scope.
    fn unknown(&mut self, noun: Noun, name: &Name, names: &[String], local: Option<Noun>) {
        if self.broken_instances.contains(&name.text) {
            return;
        }
        let is = local.or_else(|| self.kind_of(&name.text));
        if is.is_none() && unread::may_declare(noun, self.unread_items, self.unread_members) {
            return;
        }
        let helpless = self.compared > MAX_COMPARED;
        self.compared += names.len();
        let names = names.iter().map(String::as_str).filter(|_| !helpless);
        let mut issue = match is {
            Some(is) if is != noun => wrong_kind(noun, is, &name.text, name.span, names),
            Some(_) | None => unknown(noun, &name.text, name.span, names),
        };
        if helpless {
            issue.help = None;
        }
        self.report(issue);
    }

    /// What a globally visible name is.
    fn kind_of(&self, text: &str) -> Option<Noun> {
        if let Some(id) = self.events.get(text) {
            let stimulus = self.s.events[usize::from(id)].stimulus.is_some();
            return Some(if stimulus { Noun::Stimulus } else { Noun::Event });
        }
        if let Some(id) = self.players.get(text) {
            return Some(match self.player_ids[usize::from(id)] {
                PlayerRef::Agent(_) => Noun::Agent,
                PlayerRef::Automaton(_) => Noun::Automaton,
            });
        }
        if self.consts.contains_key(text) {
            return Some(Noun::Constant);
        }
        if self.given(text).is_some() {
            return Some(Noun::Parameter);
        }
        if self.values.contains_key(text) {
            return Some(Noun::EnumValue);
        }
        if self.is_template(text) {
            return Some(Noun::Template);
        }
        let tables = [
            (&self.actors, Noun::Actor),
            (&self.shared_names, Noun::Variable),
            (&self.channels, Noun::Channel),
            (&self.networks, Noun::Network),
            (&self.queries, Noun::Query),
            (&self.requirement_names, Noun::Requirement),
            (&self.points, Noun::Point),
            (&self.crosses, Noun::Cross),
            (&self.suites, Noun::Suite),
            (&self.enums, Noun::Enum),
            (&self.record_names, Noun::Record),
        ];
        let found = tables.iter().find(|(t, _)| t.get(text).is_some()).map(|(_, noun)| *noun);
        found.or_else(|| self.in_world.kind_of(text))
    }

    /// Enters a name into a table and gives its id, which is that of the next element of the table's vector.
    fn declare(issues: &mut Vec<Diagnostic>, table: &mut Table, noun: Noun, name: &Name) -> Option<u16> {
        Self::declare_as(issues, table, noun, &name.text, name.span)
    }

    fn declare_as(
        issues: &mut Vec<Diagnostic>,
        table: &mut Table,
        noun: Noun,
        full: &str,
        span: Span,
    ) -> Option<u16> {
        match table.insert(full, span) {
            Ok(id) => Some(id),
            Err(refused) => {
                issues.extend(said_of(refused, noun, full, span));
                None
            }
        }
    }

    /// The names that a misspelt one may have been meant to be; none after many misspelt names, since looking for the
    /// nearest takes time that grows with both.
    fn near<'n>(&self, names: impl Iterator<Item = &'n str>) -> Vec<String> {
        if self.compared > MAX_COMPARED { Vec::new() } else { names.map(str::to_owned).collect() }
    }

    /// A word that is one of a fixed list.
    fn choice(&mut self, noun: Noun, name: &Name, words: &[&str]) -> Option<usize> {
        let found = words.iter().position(|w| *w == name.text);
        if found.is_none() {
            self.report(unknown(noun, &name.text, name.span, words.iter().copied()));
        }
        found
    }

    fn role_of(&self, actor: ActorId) -> Role {
        self.s.actors.get(usize::from(actor.0)).map_or(Role::Environment, |a| a.role)
    }

    fn actor_name(&self, actor: ActorId) -> &str {
        self.s.actors.get(usize::from(actor.0)).map_or("?", |a| a.name.as_str())
    }
}

/// What is to be said of a name that was not entered.
fn said_of(refused: Refused, noun: Noun, name: &str, span: Span) -> Option<Diagnostic> {
    match refused {
        Refused::Taken(first) => Some(duplicate(noun, name, span, Some(first))),
        Refused::Full { first: true } => {
            let message = format!("there are more than {MAX_NAMES} {}", noun.plural());
            Some(too_many(message, span))
        }
        Refused::Full { first: false } => None,
    }
}

/// HR0005: more than can be looked at.
fn too_many(message: String, span: Span) -> Diagnostic {
    Diagnostic::error(Code::TOO_DEEP, span, message).help("divide it into several scenarios, or say less")
}

/// Whether names like this are an agent's variables.
fn is_variable_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_uppercase())
}
