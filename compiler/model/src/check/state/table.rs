//! One namespace: names in the order of their declaration, with ids and places.

use hrdsl_source::Span;
use indexmap::IndexMap;
use rustc_hash::FxBuildHasher;

/// In the order of insertion, whatever the hashes.
pub(crate) type OrderedMap<K, V> = IndexMap<K, V, FxBuildHasher>;

/// The most names that one table holds: ids are 16 bits wide, and the last number stands for nothing.
pub(crate) const MAX_NAMES: usize = u16::MAX as usize;

#[derive(Clone, Debug, Default)]
pub(crate) struct NameTable {
    entries: OrderedMap<String, Span>,
    overflown: bool,
}

/// Why a name was not entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RefusedName {
    /// It is there already, declared here.
    Taken(Span),
    /// There is no room; said of the first name only.
    Full { first: bool },
}

impl NameTable {
    /// Enters a new name.
    pub fn insert(&mut self, name: &str, span: Span) -> Result<u16, RefusedName> {
        if let Some(first) = self.entries.get(name) {
            return Err(RefusedName::Taken(*first));
        }
        match u16::try_from(self.entries.len()) {
            Ok(id) if self.entries.len() < MAX_NAMES => {
                self.entries.insert(name.to_owned(), span);
                Ok(id)
            }
            Ok(_) | Err(_) => Err(RefusedName::Full { first: !std::mem::replace(&mut self.overflown, true) }),
        }
    }

    pub fn get(&self, name: &str) -> Option<u16> {
        self.entries.get_index_of(name).and_then(|i| u16::try_from(i).ok())
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    /// Names with their ids.
    pub fn entries(&self) -> impl Iterator<Item = (&str, u16)> {
        self.names().zip(0..=u16::MAX)
    }

    /// Where a name was first declared.
    pub fn span_of(&self, name: &str) -> Option<Span> {
        self.entries.get(name).copied()
    }

    pub fn span(&self, id: u16) -> Option<Span> {
        self.entries.get_index(usize::from(id)).map(|(_, span)| *span)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_end_before_they_would_be_wrong() {
        let mut table = NameTable::default();
        for i in 0..MAX_NAMES {
            assert_eq!(table.insert(&format!("e{i}"), Span::default()), Ok(u16::try_from(i).unwrap()));
        }
        assert_eq!(table.insert("e7", Span::default()), Err(RefusedName::Taken(Span::default())));
        assert_eq!(table.insert("more", Span::default()), Err(RefusedName::Full { first: true }));
        assert_eq!(table.insert("yet", Span::default()), Err(RefusedName::Full { first: false }));
        assert_eq!((table.get("e65534"), table.get("more")), (Some(65_534), None));
    }
}
