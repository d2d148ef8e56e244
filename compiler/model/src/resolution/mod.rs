//! The resolution table: of each use of a name its definition, of each definition what it is, its type and its documentation.
//!
//! The definitions are read off the syntax ([`definitions`]); the uses are told by the checker as it resolves them. What a
//! template's parameter is used for is known once, however many instances there are; a use may then have several definitions.
//! Whoever misses a name asks here what it is instead, and which names of the kind there are ([`global`]); the lints ask whether
//! a name is used.

mod definitions;
mod global;

pub(crate) use definitions::{of_sort, type_span};

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::{FileId, Span};
use hrdsl_syntax::ast;
use serde::Serialize;

use crate::noun::Noun;
use global::GlobalNames;

/// A name that is declared.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NameDefinition {
    /// What it is the name of, in the words of the diagnostics: `event`, `belief`.
    pub noun: &'static str,
    pub name: String,
    /// Where the name stands; this is what [`Resolutions`] knows the definition by.
    pub place: Span,
    /// The whole declaration.
    pub whole: Span,
    pub ty: DefinedType,
    /// The `///` lines before it, joined by newlines.
    pub doc: String,
}

/// What is known of the type of what is defined.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DefinedType {
    /// It has none: an actor, a network.
    #[default]
    None,
    /// As it is written there.
    Written(Span),
    /// It follows from its value: `a length`.
    Inferred(String),
}

/// Which name means what.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Resolutions {
    definitions: BTreeMap<Span, NameDefinition>,
    /// The definitions that are visible everywhere, by noun and name.
    #[serde(skip)]
    everywhere: GlobalNames,
    /// By use: the places of the definitions.
    uses: BTreeMap<Span, BTreeSet<Span>>,
    /// By definition: the uses.
    used: BTreeMap<Span, BTreeSet<Span>>,
}

impl Resolutions {
    /// The definitions of these items, and no use yet.
    pub(crate) fn of_items(items: &[&ast::ItemSyntax]) -> Self {
        let (definitions, everywhere) = definitions::of_items(items);
        let definitions = definitions.into_iter().map(|d| (d.place, d)).collect();
        Self { definitions, everywhere, ..Self::default() }
    }

    /// What one declaration declares.
    #[must_use]
    pub fn of_declaration(item: &ast::ItemSyntax) -> Self {
        Self::of_items(&[item])
    }

    /// A name means what is declared there.
    pub(crate) fn refer(&mut self, from: Span, to: Span) {
        if from != to {
            self.uses.entry(from).or_default().insert(to);
            self.used.entry(to).or_default().insert(from);
        }
    }

    /// A name that is declared where it first stands: a plan's variable, what an edge binds.
    pub(crate) fn define(&mut self, definition: NameDefinition) {
        self.definitions.entry(definition.place).or_insert(definition);
    }

    /// What is known of the type of what is declared there.
    pub(crate) fn infer(&mut self, place: Span, ty: String) {
        if let Some(definition) = self.definitions.get_mut(&place)
            && definition.ty == DefinedType::None
        {
            definition.ty = DefinedType::Inferred(ty);
        }
    }

    /// All definitions, by place.
    pub fn definitions(&self) -> impl Iterator<Item = &NameDefinition> {
        self.definitions.values()
    }

    /// What a name that is visible everywhere is of, wherever it is declared.
    pub(crate) fn kind_of(&self, name: &str) -> Option<Noun> {
        self.everywhere.kind_of(name)
    }

    /// The names of these kinds that are visible everywhere, in the order of the text, those of modules first.
    pub(crate) fn names_of(&self, nouns: &[Noun]) -> Vec<&str> {
        self.everywhere.names(nouns)
    }

    /// What is declared of this kind, visible everywhere, in the same order.
    pub(crate) fn all_of(&self, noun: Noun) -> impl Iterator<Item = &NameDefinition> {
        self.everywhere.places(noun).filter_map(|place| self.definitions.get(&place))
    }

    /// Where a name is declared within a declaration.
    pub(crate) fn named_in(&self, whole: Span, noun: Noun, name: &str) -> Option<Span> {
        let from = Span { end: whole.start, ..whole };
        let within = self
            .definitions
            .range(from..)
            .take_while(|(place, _)| place.file == whole.file && place.end <= whole.end);
        let mut found = within.filter(|(_, d)| d.noun == noun.word() && d.name == name);
        found.next().map(|(place, _)| *place)
    }

    /// What is declared there.
    #[must_use]
    pub fn defined_at(&self, place: Span) -> Option<&NameDefinition> {
        self.definitions.get(&place)
    }

    /// What the name at this place of a file means: of a use its definitions, of a definition itself.
    pub fn at(&self, file: FileId, offset: usize) -> impl Iterator<Item = &NameDefinition> {
        let holds = move |span: &Span| {
            span.file == file && (span.start as usize) <= offset && offset < span.end as usize
        };
        let used = self.uses.iter().filter(move |(from, _)| holds(from)).flat_map(|(_, to)| to);
        let places: BTreeSet<Span> =
            used.copied().chain(self.definitions.keys().copied().filter(move |p| holds(p))).collect();
        places.into_iter().filter_map(|place| self.definitions.get(&place))
    }

    /// Where a name means what is declared there.
    pub fn uses_of(&self, place: Span) -> impl Iterator<Item = Span> {
        self.used.get(&place).into_iter().flatten().copied()
    }

    /// Whether any name means what is declared there.
    #[must_use]
    pub fn is_used(&self, place: Span) -> bool {
        self.used.contains_key(&place)
    }
}
