//! The phase of testing: what is judged, what is covered, and how tests are made.

use std::ops::{Deref, DerefMut};

use hrdsl_syntax::ast;

use crate::check::{
    checker::Checker,
    state::{
        names::{AgentNames, NetworkNames},
        phase::CheckPhase,
        robot::PlacedRobot,
        table::NameTable,
    },
    template::CheckerPhase,
};

/// The last phase: nothing is declared in it that others speak of.
pub(in crate::check) struct TestingPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    /// The parts of the world that are made from descriptions.
    pub(super) robots: Vec<PlacedRobot>,
    pub(super) agents: AgentNames,
    pub(super) networks: NetworkNames,
    pub(super) requirements: NameTable,
    pub(super) crosses: NameTable,
    pub(super) suites: NameTable,
    /// The suite that is being checked names a player that does not exist.
    pub(super) unknown_player: bool,
}

impl<'c, 'a> TestingPhase<'c, 'a> {
    /// Checks requirements, coverage, suites and systems, then the tests of the scenario and of the files of tests.
    pub(in crate::check) fn check(
        checker: &'c mut Checker<'a>,
        (robots, agents, networks): (Vec<PlacedRobot>, AgentNames, NetworkNames),
        tests: &[&ast::FileSyntax],
    ) {
        let mut phase = Self {
            checker,
            robots,
            agents,
            networks,
            requirements: NameTable::default(),
            crosses: NameTable::default(),
            suites: NameTable::default(),
            unknown_player: false,
        };
        if phase.source.reaches(CheckPhase::Requirements) {
            phase.requirements();
        }
        if phase.source.reaches(CheckPhase::Coverage) {
            phase.coverage();
        }
        if phase.source.reaches(CheckPhase::Suites) {
            phase.suites();
        }
        if phase.source.reaches(CheckPhase::Systems) {
            phase.systems();
        }
        phase.tests(tests);
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for TestingPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for TestingPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for TestingPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
