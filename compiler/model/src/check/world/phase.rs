//! The phase of the world: what devices can be told, the bodies with their parts, signals, rules, and what stimuli do to them.

use std::ops::{Deref, DerefMut};

use hrdsl_syntax::ast;

use crate::check::{
    checker::Checker,
    state::{phase::CheckPhase, robot::PlacedRobot, solids::SolidMaker},
    template::CheckerPhase,
    vocabulary::phase::DeclaredParts,
};

/// Takes the parts and the bodies of stimuli as they are written, and gives the parts of the world that are made from descriptions.
pub(in crate::check) struct WorldPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    pub(super) parts: &'c DeclaredParts<'a>,
    /// The parts that are being taken apart, the outermost first.
    pub(super) open_parts: Vec<&'a str>,
    /// Those of the world that is being built.
    pub(super) robots: Vec<PlacedRobot>,
    /// Makes their bodies.
    pub(super) solids: SolidMaker,
}

impl<'c, 'a> WorldPhase<'c, 'a> {
    /// Checks devices, the world with its parts, and stimuli.
    pub(in crate::check) fn check(
        checker: &'c mut Checker<'a>,
        parts: &'c DeclaredParts<'a>,
        stimuli: &[Option<&'a ast::StimulusSyntax>],
    ) -> Vec<PlacedRobot> {
        let (open_parts, robots, solids) = (Vec::new(), Vec::new(), SolidMaker::default());
        let mut phase = Self { checker, parts, open_parts, robots, solids };
        phase.devices();
        phase.world();
        if phase.source.reaches(CheckPhase::Stimuli) {
            phase.stimuli(stimuli);
        }
        phase.robots
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for WorldPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for WorldPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for WorldPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
