//! The phase of agents: their beliefs and goals, their rules and plans, and what they say to each other.

use std::{
    collections::BTreeSet,
    ops::{Deref, DerefMut},
};

use crate::check::{
    checker::Checker,
    state::{names::AgentNames, phase::CheckPhase},
    template::CheckerPhase,
};

/// Gives what agents have declared. Later phases that speak of it go on from there.
pub(in crate::check) struct AgentsPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    pub(in crate::check) names: AgentNames,
    /// The goals that some message asks somebody to achieve, by name.
    pub(super) asked_goals: BTreeSet<&'a str>,
}

impl<'c, 'a> AgentsPhase<'c, 'a> {
    /// Checks agents, all but their names and what they play.
    pub(in crate::check) fn check(checker: &'c mut Checker<'a>) -> AgentNames {
        let mut names = AgentNames::default();
        checker.s.agents.iter().for_each(|_| names.add());
        let mut phase = Self::over(checker, names);
        if phase.source.reaches(CheckPhase::Agents) {
            phase.agents();
        }
        phase.names
    }

    /// The phase as it was when it gave this.
    pub(in crate::check) fn over(checker: &'c mut Checker<'a>, names: AgentNames) -> Self {
        Self { checker, names, asked_goals: BTreeSet::new() }
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for AgentsPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for AgentsPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for AgentsPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
