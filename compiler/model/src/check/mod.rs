//! The checker: declares all names, then resolves what is written about them, concern by concern.

mod agent;
mod args;
mod automaton;
mod coverage;
mod edge;
mod env;
mod expr;
mod measure;
mod places;
mod plan;
mod requirement;
mod stimulus;
mod suite;
mod system;
mod table;
mod test;
mod unread;
mod vocabulary;
mod world;
mod world_parts;

use hrdsl_source::{Diagnostic, Span};
use hrdsl_syntax::ast::{self, ItemKind, Name};
use indexmap::IndexMap;

use crate::{
    ActorId, EventId, Expr, Player, Role, Scenario,
    noun::Noun,
    report::names::{duplicate, unknown, wrong_kind},
};
use env::Env;
use table::Table;

/// Resolves and checks a scenario with the modules it uses and files of tests in its vocabulary.
///
/// # Steps
/// 1. [`Checker::vocabulary`]: actors, constants, events, stimuli, shared variables, and the names of agents and automata
/// 2. [`Checker::world`]: bodies with their parts, signals, rules
/// 3. [`Checker::stimuli`]: what stimuli do to the world
/// 4. [`Checker::agents`], [`Checker::automata`]: those who play the actors
/// 5. [`Checker::requirements`], [`Checker::coverage`], [`Checker::suites`], [`Checker::systems`]
/// 6. [`Checker::tests`]
#[must_use]
pub fn resolve(
    scenario: &ast::File,
    modules: &[&ast::File],
    tests: &[&ast::File],
) -> (Scenario, Vec<Diagnostic>) {
    let mut items: Vec<&ast::Item> = modules.iter().flat_map(|m| &m.items).collect();
    let from_modules = items.len();
    items.extend(&scenario.items);
    let mut checker = Checker::new(items, from_modules);
    checker.unread_items = checker.items.iter().any(|i| unread::in_item(&i.kind));
    checker.s.name = scenario.scenario.as_ref().map_or_else(String::new, |n| n.text.clone());
    checker.vocabulary();
    checker.world();
    checker.stimuli();
    checker.agents();
    checker.automata();
    checker.requirements();
    checker.coverage();
    checker.unread_members = checker.agent_decls.iter().any(|a| unread::in_agent(a));
    checker.suites();
    checker.unread_members = false;
    checker.systems();
    checker.tests(tests);
    checker.places();
    (checker.s, distinct(checker.issues))
}

/// A part that is used twice has its faults once.
fn distinct(issues: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut kept: Vec<Diagnostic> = Vec::new();
    for issue in issues {
        if !kept.contains(&issue) {
            kept.push(issue);
        }
    }
    kept
}

/// How far the value of a constant is known.
enum ConstState {
    Unseen,
    /// Its own value is being worked out.
    Open,
    Done(Expr),
}

struct ConstEntry<'a> {
    name: &'a Name,
    value: &'a ast::Expr,
    state: ConstState,
    /// Something reads it.
    used: bool,
}

/// Stands for an actor whose name is unknown, so that nothing else is said about it.
const NOBODY: ActorId = ActorId(u16::MAX);

pub(crate) struct Checker<'a> {
    s: Scenario,
    issues: Vec<Diagnostic>,
    items: Vec<&'a ast::Item>,
    /// The first items come from modules.
    from_modules: usize,
    actors: Table,
    events: Table,
    /// Agents and automata.
    players: Table,
    player_ids: Vec<Player>,
    shared: Table,
    networks: Table,
    points: Table,
    crosses: Table,
    suites: Table,
    parts: IndexMap<&'a str, (&'a ast::Part, Span)>,
    consts: IndexMap<&'a str, ConstEntry<'a>>,
    /// By [`EventId`]: the body of each stimulus.
    bodies: Vec<Option<&'a ast::Stimulus>>,
    agent_decls: Vec<&'a ast::Agent>,
    automaton_decls: Vec<&'a ast::Automaton>,
    /// The beliefs of each agent.
    beliefs: Vec<Table>,
    has_world: bool,
    in_world: world_parts::WorldNames,
    /// A declaration of the scenario, or a member of its world, could not be read.
    unread_items: bool,
    /// A member of the agent or automaton that is being checked could not be read.
    unread_members: bool,
}

impl<'a> Checker<'a> {
    fn new(items: Vec<&'a ast::Item>, from_modules: usize) -> Self {
        let has_world = items.iter().any(|i| matches!(i.kind, ItemKind::World(_)));
        Self {
            s: Scenario::default(),
            issues: Vec::new(),
            items,
            from_modules,
            actors: Table::default(),
            events: Table::default(),
            players: Table::default(),
            player_ids: Vec::new(),
            shared: Table::default(),
            networks: Table::default(),
            points: Table::default(),
            crosses: Table::default(),
            suites: Table::default(),
            parts: IndexMap::new(),
            consts: IndexMap::new(),
            bodies: Vec::new(),
            agent_decls: Vec::new(),
            automaton_decls: Vec::new(),
            beliefs: Vec::new(),
            has_world,
            unread_items: false,
            unread_members: false,
            in_world: world_parts::WorldNames::default(),
        }
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
        match self.actors.get(&name.text) {
            Some(id) => Some(ActorId(id)),
            None => {
                let names: Vec<String> = self.actors.names().map(str::to_owned).collect();
                self.unknown(Noun::Actor, name, &names, None);
                None
            }
        }
    }

    /// An event, a stimulus, or either.
    fn event(&mut self, noun: Noun, name: &Name, local: Option<Noun>) -> Option<EventId> {
        let fits = |c: &Self, id: u16| {
            let is = c.s.events[usize::from(id)].stimulus.is_some();
            noun == Noun::EventOrStimulus || is == (noun == Noun::Stimulus)
        };
        if let Some(id) = self.events.get(&name.text).filter(|id| fits(self, *id)) {
            return Some(EventId(id));
        }
        let names: Vec<String> =
            self.events.entries().filter(|(_, id)| fits(self, *id)).map(|(n, _)| n.to_owned()).collect();
        self.unknown(noun, name, &names, local);
        None
    }

    /// Says that `name` is no `noun`; `local` is what else it is in the place's own scope.
    fn unknown(&mut self, noun: Noun, name: &Name, names: &[String], local: Option<Noun>) {
        let is = local.or_else(|| self.kind_of(&name.text));
        if is.is_none() && unread::may_declare(noun, self.unread_items, self.unread_members) {
            return;
        }
        let names = names.iter().map(String::as_str);
        let issue = match is {
            Some(is) if is != noun => wrong_kind(noun, is, &name.text, name.span, names),
            Some(_) | None => unknown(noun, &name.text, name.span, names),
        };
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
                Player::Agent(_) => Noun::Agent,
                Player::Automaton(_) => Noun::Automaton,
            });
        }
        if self.consts.contains_key(text) {
            return Some(Noun::Constant);
        }
        let tables = [
            (&self.actors, Noun::Actor),
            (&self.shared, Noun::Variable),
            (&self.networks, Noun::Network),
            (&self.points, Noun::Point),
            (&self.crosses, Noun::Cross),
            (&self.suites, Noun::Suite),
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
            Err(first) => {
                issues.push(duplicate(noun, full, span, Some(first)));
                None
            }
        }
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

/// Whether names like this are an agent's variables.
fn is_variable_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_uppercase())
}
