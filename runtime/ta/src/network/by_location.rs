//! What is known of clocks location by location, laid out for a look at a whole discrete state.

use super::parts::{CompiledAutomaton, CompiledLocation};

/// Rows of items by member and location, end to end.
pub(crate) struct LocationTable<T> {
    items: Vec<T>,
    /// By location, those of the first member first: where its items lie.
    places: Vec<(u32, u32)>,
    /// By member: where its locations begin.
    members: Vec<u32>,
}

impl<T> LocationTable<T> {
    /// The items of each location.
    pub(crate) fn new<I: IntoIterator<Item = T>>(
        rows: impl IntoIterator<Item = impl IntoIterator<Item = I>>,
    ) -> Self {
        let (mut items, mut places, mut members) = (Vec::new(), Vec::new(), Vec::new());
        for locations in rows {
            members.push(places.len() as u32);
            for row in locations {
                let begin = items.len() as u32;
                items.extend(row);
                places.push((begin, items.len() as u32));
            }
        }
        Self { items, places, members }
    }

    /// As [`new`](Self::new), of a network's automata.
    pub(crate) fn of<I: IntoIterator<Item = T>>(
        members: &[CompiledAutomaton],
        row: impl Fn(&CompiledLocation) -> I,
    ) -> Self {
        Self::new(members.iter().map(|m| m.locations.iter().map(&row)))
    }

    /// A table of the same form.
    pub(crate) fn try_map<U>(&self, f: impl FnMut(&T) -> Option<U>) -> Option<LocationTable<U>> {
        let items = self.items.iter().map(f).collect::<Option<_>>()?;
        Some(LocationTable { items, places: self.places.clone(), members: self.members.clone() })
    }

    /// The rows of a discrete state, member by member.
    #[inline]
    pub(crate) fn rows(&self, state: &[i64]) -> impl Iterator<Item = &[T]> {
        self.members.iter().zip(state).map(|(&first, &at)| {
            let (begin, end) = self.places[first as usize + at as usize];
            &self.items[begin as usize..end as usize]
        })
    }

    /// All items.
    pub(crate) fn items(&self) -> &[T] {
        &self.items
    }

    /// The most items that a state can have in all.
    pub(crate) fn most(&self) -> usize {
        let ends = self.members.iter().skip(1).copied().chain([self.places.len() as u32]);
        let rows =
            self.members.iter().zip(ends).map(|(&first, end)| &self.places[first as usize..end as usize]);
        rows.filter_map(|row| row.iter().map(|(begin, end)| end - begin).max()).sum::<u32>() as usize
    }
}
