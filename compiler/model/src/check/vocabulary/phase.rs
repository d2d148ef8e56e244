//! The phase of the vocabulary: what everything else speaks of.

use std::ops::{Deref, DerefMut};

use hrdsl_source::Span;
use hrdsl_syntax::ast;

use crate::check::{
    checker::Checker,
    state::{
        names::ChannelNames,
        table::{NameTable, OrderedMap},
    },
    template::CheckerPhase,
};

/// Parts of the world by name, each with where that stands.
pub(in crate::check) type DeclaredParts<'a> = OrderedMap<&'a str, (&'a ast::PartSyntax, Span)>;

/// What is declared and only looked at later.
pub(in crate::check) struct DeclaredBodies<'a> {
    pub parts: DeclaredParts<'a>,
    /// By [`EventId`](crate::EventId): the body of each stimulus.
    pub stimuli: Vec<Option<&'a ast::StimulusSyntax>>,
    pub channels: ChannelNames,
}

/// The first phase: it enters names where all phases see them, and gives what is for one phase alone.
pub(in crate::check) struct VocabularyPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    pub(super) parts: DeclaredParts<'a>,
    pub(super) stimuli: Vec<Option<&'a ast::StimulusSyntax>>,
    /// The single values of the variables that all automata share.
    pub(super) shared_values: NameTable,
}

impl<'c, 'a> VocabularyPhase<'c, 'a> {
    /// Checks actors, types, constants, events, shared variables, templates, the names of agents and automata, then channels.
    pub(in crate::check) fn check(checker: &'c mut Checker<'a>) -> DeclaredBodies<'a> {
        let (parts, stimuli, shared_values) = (OrderedMap::default(), Vec::new(), NameTable::default());
        let mut phase = Self { checker, parts, stimuli, shared_values };
        phase.names();
        let channels = phase.channels();
        DeclaredBodies { parts: phase.parts, stimuli: phase.stimuli, channels }
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for VocabularyPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for VocabularyPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for VocabularyPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
