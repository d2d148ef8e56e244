//! One namespace: names in the order of their declaration, with ids and places.

use hrdsl_source::Span;
use indexmap::IndexMap;

#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    entries: IndexMap<String, Span>,
}

impl Table {
    /// Enters a new name. A name that is there already gives the place of its declaration.
    pub fn insert(&mut self, name: &str, span: Span) -> Result<u16, Span> {
        if let Some(first) = self.entries.get(name) {
            return Err(*first);
        }
        self.entries.insert(name.to_owned(), span);
        Ok(u16::try_from(self.entries.len() - 1).unwrap_or(u16::MAX))
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
