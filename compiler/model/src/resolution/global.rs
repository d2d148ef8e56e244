//! The names that are visible everywhere, by what they are of, in the order of the text.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::Span;
use indexmap::IndexMap;
use rustc_hash::FxBuildHasher;

use crate::noun::Noun;

/// What a name that is visible everywhere can be of. A name may be of several: the first of these is what it is said to be.
const KINDS: [Noun; 18] = [
    Noun::Event,
    Noun::Stimulus,
    Noun::Agent,
    Noun::Automaton,
    Noun::Constant,
    Noun::EnumValue,
    Noun::Template,
    Noun::Actor,
    Noun::Variable,
    Noun::Channel,
    Noun::Network,
    Noun::Query,
    Noun::Requirement,
    Noun::Point,
    Noun::Cross,
    Noun::Suite,
    Noun::Enum,
    Noun::Record,
];

/// The names that are visible everywhere, and where they are declared.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct GlobalNames {
    by_noun: BTreeMap<Noun, IndexMap<String, DeclaredGlobal, FxBuildHasher>>,
    count: usize,
}

/// Several enumerations may have a value of the same name, and several sorts of templates.
#[derive(Clone, Debug, Default, PartialEq)]
struct DeclaredGlobal {
    /// How many names were declared before it was for the first time.
    order: usize,
    places: Vec<Span>,
}

impl GlobalNames {
    /// Enters a name after those that stand before it.
    pub(super) fn enter(&mut self, noun: Noun, name: &str, place: Span) {
        let order = self.count;
        self.count += 1;
        let names = self.by_noun.entry(noun).or_default();
        match names.get_mut(name) {
            Some(known) => known.places.push(place),
            None => drop(names.insert(name.to_owned(), DeclaredGlobal { order, places: vec![place] })),
        }
    }

    /// What a name is of.
    pub(super) fn kind_of(&self, name: &str) -> Option<Noun> {
        let has = |noun: &Noun| self.by_noun.get(noun).is_some_and(|names| names.contains_key(name));
        KINDS.into_iter().find(has)
    }

    /// The names of these kinds.
    pub(super) fn names(&self, nouns: &[Noun]) -> Vec<&str> {
        let all = nouns.iter().filter_map(|noun| self.by_noun.get(noun)).flatten();
        let mut found: Vec<(usize, &str)> = all.map(|(name, of)| (of.order, name.as_str())).collect();
        // Those of one kind are in order already, each once.
        if nouns.len() > 1 {
            found.sort_unstable();
            let mut seen = BTreeSet::new();
            found.retain(|(_, name)| seen.insert(*name));
        }
        found.into_iter().map(|(_, name)| name).collect()
    }

    /// Where the names of a kind are declared.
    pub(super) fn places(&self, noun: Noun) -> impl Iterator<Item = Span> {
        self.by_noun.get(&noun).into_iter().flatten().flat_map(|(_, of)| of.places.iter().copied())
    }
}
