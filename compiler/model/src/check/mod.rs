//! The checker: declares all names, then resolves what is written about them, concern by concern.

mod agents;
mod automata;
mod binding;
mod checker;
mod name_spans;
mod players;
mod state;
mod template;
mod testing;
mod unread;
mod value;
mod vocabulary;
mod world;

use hrdsl_messages::MessageLibrary;
use hrdsl_source::Diagnostic;
use hrdsl_syntax::ast::{self, ItemSyntaxKind};

use crate::{Scenario, descriptions::DescriptionLibrary, provenance};
use agents::phase::AgentsPhase;
use automata::phase::AutomataPhase;
use checker::Checker;
use state::{
    names::{CheckedSource, LoneDeclaration},
    phase::CheckPhase,
};
use testing::phase::TestingPhase;
use vocabulary::phase::{DeclaredBodies, VocabularyPhase};
use world::phase::WorldPhase;

pub use agents::internal_table::{ArgumentSlot, INTERNAL_ACTIONS, InternalAction};

/// Resolves and checks a scenario with the modules it uses and files of tests in its vocabulary.
///
/// # Steps
/// 1. [`VocabularyPhase`]: actors, types, constants, events, stimuli, shared variables, templates, the names of agents and
///    automata, which all see; it gives the parts, the bodies of stimuli, and channels
/// 2. [`WorldPhase`], which takes parts and stimuli, and gives the parts that are made from descriptions: what devices can be
///    told, bodies with their parts, signals, rules, and what stimuli do to the world
/// 3. [`AgentsPhase`], which gives what agents have declared
/// 4. [`AutomataPhase`], which takes the channels and gives the networks
/// 5. [`TestingPhase`], which takes all three, and binds systems in a phase of their own for each: requirements, coverage, suites, systems, tests
#[must_use]
pub fn resolve(
    scenario: &ast::FileSyntax,
    modules: &[&ast::FileSyntax],
    tests: &[&ast::FileSyntax],
) -> (Scenario, Vec<Diagnostic>) {
    resolve_part(scenario, modules, tests, KnownSources::default())
}

/// What else a check rests on, besides the texts.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnownSources<'a> {
    /// Some module is not there: nothing is said about parts that it may have.
    pub missing_modules: bool,
    /// The definitions of the versions of ROS that the systems use.
    pub interfaces: &'a [MessageLibrary],
    /// The robots and maps that parts and the world are made from.
    pub descriptions: Option<&'a DescriptionLibrary>,
}

/// The same, with what else is known.
#[must_use]
pub fn resolve_part(
    scenario: &ast::FileSyntax,
    modules: &[&ast::FileSyntax],
    tests: &[&ast::FileSyntax],
    known: KnownSources<'_>,
) -> (Scenario, Vec<Diagnostic>) {
    let items = scenario.items.iter().collect();
    let source = source(items, modules, known);
    let checker = phases(source, scenario.scenario.as_ref(), tests);
    let Checker { s: mut scenario, source, players, world, issues, .. } = checker;
    name_spans::complete(&mut scenario, &source.items, &players, &world.names.signals);
    (scenario, issues.distinct())
}

/// One declaration of a scenario that stands in place of that with this index: only what is said of it is given. It is the
/// only one of its file; of the others no more is looked at than it can speak of.
#[must_use]
pub fn resolve_alone(
    scenario: &ast::FileSyntax,
    (index, declaration): (usize, &ast::ItemSyntax),
    modules: &[&ast::FileSyntax],
    known: KnownSources<'_>,
) -> Vec<Diagnostic> {
    let mut items: Vec<&ast::ItemSyntax> = scenario.items.iter().collect();
    let Some(place) = items.get_mut(index) else { return Vec::new() };
    *place = declaration;
    let file = declaration.span.file;
    let mut source = source(items, modules, known);
    source.alone = Some(LoneDeclaration { file, phase: CheckPhase::of(&declaration.kind) });
    let mut issues = phases(source, scenario.scenario.as_ref(), &[]).issues.distinct();
    issues.retain(|issue| issue.span().file == file);
    issues
}

/// What is checked: what modules share, then the scenario's own items.
fn source<'a>(
    own: Vec<&'a ast::ItemSyntax>,
    modules: &[&'a ast::FileSyntax],
    known: KnownSources<'a>,
) -> CheckedSource<'a> {
    let mut items: Vec<&ast::ItemSyntax> =
        modules.iter().flat_map(|m| &m.items).filter(|i| shared(&i.kind)).collect();
    let from_modules = items.len();
    items.extend(own);
    CheckedSource {
        unread_items: items.iter().any(|i| unread::in_item(&i.kind)),
        items,
        from_modules,
        missing_modules: known.missing_modules,
        interfaces: known.interfaces,
        descriptions: known.descriptions,
        unread_members: false,
        alone: None,
    }
}

fn phases<'a>(
    source: CheckedSource<'a>,
    name: Option<&ast::NameSyntax>,
    tests: &[&ast::FileSyntax],
) -> Checker<'a> {
    let mut checker = Checker::new(source);
    checker.s.name = name.map_or_else(String::new, |n| n.text.clone());
    let DeclaredBodies { parts, stimuli, channels } = VocabularyPhase::check(&mut checker);
    let robots = WorldPhase::check(&mut checker, &parts, &stimuli);
    let agents = AgentsPhase::check(&mut checker);
    let networks = AutomataPhase::check(&mut checker, channels);
    TestingPhase::check(&mut checker, (robots, agents, networks), tests);
    checker.say_without_world();
    checker.s.provenance = provenance::of_events(&checker.s);
    checker
}

/// What a module shares. Anything else in it has a diagnostic, and is not the scenario's.
fn shared(kind: &ItemSyntaxKind) -> bool {
    !matches!(kind, ItemSyntaxKind::World(_) | ItemSyntaxKind::Suite(_) | ItemSyntaxKind::Test(_))
}
