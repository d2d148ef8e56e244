//! The phase of automata: from channels to networks and what is asked of them.

use std::{
    collections::BTreeMap,
    ops::{Deref, DerefMut},
    rc::Rc,
};

use crate::check::{
    checker::Checker,
    state::{
        names::{ChannelNames, NetworkNames},
        phase::CheckPhase,
        scope::NameScope,
    },
    template::CheckerPhase,
};

/// Takes the channels that are declared, and gives the networks.
pub(in crate::check) struct AutomataPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    pub(super) channels: ChannelNames,
    pub(super) networks: NetworkNames,
    /// By the place in the scenario's automata: what the edges of each see.
    pub(super) scopes: BTreeMap<usize, Rc<NameScope>>,
}

impl<'c, 'a> AutomataPhase<'c, 'a> {
    /// Checks automata with the functions that they share, networks, and the queries on those.
    pub(in crate::check) fn check(checker: &'c mut Checker<'a>, channels: ChannelNames) -> NetworkNames {
        let (networks, scopes) = (NetworkNames::default(), BTreeMap::new());
        let mut phase = Self { checker, channels, networks, scopes };
        if phase.source.reaches(CheckPhase::Automata) {
            phase.automata();
        }
        if phase.source.reaches(CheckPhase::Queries) {
            phase.queries();
        }
        phase.networks
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for AutomataPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for AutomataPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for AutomataPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
