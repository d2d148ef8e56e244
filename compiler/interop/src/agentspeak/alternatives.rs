//! Places at which values of several types meet: such a value is a tag, which says of what type it is, and the parts of all
//! its alternatives. The parts of those that it is not have a fixed value, so that two values are equal if all parts are.

use super::types::{AgentSpeakType, TyId, TypeClash, UnificationTable};

/// Of what sort a value is. Those of one sort are of one type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AlternativeSort {
    Number,
    Text,
    Truth,
    Atom,
    List,
    /// A structure, by its functor and the number of its arguments.
    Structure(String, usize),
}

impl AlternativeSort {
    /// Where values of this sort stand among those of others in Jason's order; those of the same rank are compared by their
    /// names.
    pub fn rank(&self) -> u8 {
        match self {
            Self::Number => 0,
            Self::Text => 1,
            Self::List => 2,
            Self::Truth | Self::Atom | Self::Structure(..) => 3,
        }
    }

    /// What the tag is called.
    pub fn word(&self) -> String {
        match self {
            Self::Number => "number".to_owned(),
            Self::Text => "text".to_owned(),
            Self::Truth => "truth".to_owned(),
            Self::Atom => "atom".to_owned(),
            Self::List => "list".to_owned(),
            Self::Structure(functor, count) => format!("{functor}_{count}"),
        }
    }
}

impl AgentSpeakType {
    /// Of what sort its values are; `None`: nothing is known, or they are of several.
    pub fn sort(&self) -> Option<AlternativeSort> {
        match self {
            Self::Unknown | Self::Union(_) => None,
            Self::Number { .. } => Some(AlternativeSort::Number),
            Self::Text => Some(AlternativeSort::Text),
            Self::Bool => Some(AlternativeSort::Truth),
            Self::Atoms { .. } => Some(AlternativeSort::Atom),
            Self::List(_) => Some(AlternativeSort::List),
            Self::Struct(functor, args) => Some(AlternativeSort::Structure(functor.clone(), args.len())),
        }
    }
}

impl UnificationTable {
    /// The alternatives of a class of values of several types.
    pub fn alternatives(&self, id: TyId) -> Option<&[TyId]> {
        match self.get(id) {
            AgentSpeakType::Union(all) => Some(all),
            AgentSpeakType::Unknown
            | AgentSpeakType::Number { .. }
            | AgentSpeakType::Text
            | AgentSpeakType::Bool
            | AgentSpeakType::Atoms { .. }
            | AgentSpeakType::List(_)
            | AgentSpeakType::Struct(..) => None,
        }
    }

    /// The alternative of a sort, with its index.
    pub fn alternative(&self, id: TyId, sort: &AlternativeSort) -> Option<(usize, TyId)> {
        let all = self.alternatives(id)?;
        all.iter().copied().enumerate().find(|(_, a)| self.get(*a).sort().as_ref() == Some(sort))
    }

    /// Whether values of two classes are of different sorts, or of several.
    pub(super) fn differ(&self, a: TyId, b: TyId) -> bool {
        let is_union = |id: TyId| self.alternatives(id).is_some();
        is_union(a) || is_union(b) || self.get(a).sort() != self.get(b).sort()
    }

    /// Makes one class of two with values of different sorts.
    pub(super) fn join(&mut self, a: TyId, b: TyId) -> Result<(), TypeClash> {
        let (mut all, mut pairs) = (self.apart(a), Vec::new());
        for more in self.apart(b) {
            let sort = self.get(more).sort();
            match all.iter().find(|known| self.get(**known).sort() == sort) {
                Some(known) => pairs.push((*known, more)),
                None => all.push(more),
            }
        }
        self.replace(a, b, AgentSpeakType::Union(all))?;
        pairs.into_iter().try_for_each(|(x, y)| self.unify(x, y))
    }

    /// The alternatives of a class; of one with one type alone, a class of its own with that type.
    fn apart(&mut self, id: TyId) -> Vec<TyId> {
        match self.alternatives(id) {
            Some(all) => all.to_vec(),
            None => {
                let ty = self.get(id).clone();
                vec![self.add(ty)]
            }
        }
    }

    /// Makes two classes one, unless each has a type and these differ.
    pub fn meet(&mut self, a: TyId, b: TyId) -> Result<(), TypeClash> {
        match (self.get(a).sort(), self.get(b).sort()) {
            (Some(x), Some(y)) if x != y => Err(format!("{} meets {}", self.describe(a), self.describe(b))),
            _ => self.unify(a, b),
        }
    }

    /// Values of a class stand where those of another are needed: of several alternatives that one is meant, and the classes
    /// stay two.
    pub fn demand(&mut self, id: TyId, needed: TyId) -> Result<(), TypeClash> {
        let (Some(_), Some(sort)) = (self.alternatives(id), self.get(needed).sort()) else {
            return self.meet(needed, id);
        };
        let Some((_, found)) = self.alternative(id, &sort) else {
            return Err(format!("{} meets {}", self.describe(needed), self.describe(id)));
        };
        match (self.get(found).clone(), self.get(needed).clone()) {
            (AgentSpeakType::Number { .. }, _) => self.decimals.push((id, needed)),
            (AgentSpeakType::Atoms { .. }, ty @ AgentSpeakType::Atoms { .. }) => {
                let same = self.add(ty);
                self.unify(found, same)?;
            }
            (AgentSpeakType::List(x), AgentSpeakType::List(y)) => self.unify(x, y)?,
            (AgentSpeakType::Struct(_, x), AgentSpeakType::Struct(_, y)) => {
                x.into_iter().zip(y).try_for_each(|(x, y)| self.unify(x, y))?;
            }
            (
                AgentSpeakType::Text
                | AgentSpeakType::Bool
                | AgentSpeakType::Atoms { .. }
                | AgentSpeakType::List(_)
                | AgentSpeakType::Struct(..)
                | AgentSpeakType::Unknown
                | AgentSpeakType::Union(_),
                _,
            ) => {}
        }
        Ok(())
    }

    /// The numbers of a class, or of its alternatives.
    fn numbers(&self, id: TyId) -> Option<TyId> {
        match self.get(id) {
            AgentSpeakType::Number { .. } => Some(self.root(id)),
            _ => self.alternative(id, &AlternativeSort::Number).map(|(_, number)| self.root(number)),
        }
    }

    /// Numbers that are computed from others have decimals if those do, and the other way round.
    pub fn settle_decimals(&mut self) {
        let links = self.decimals.clone();
        let has_decimals = |t: &Self, id: TyId| *t.get(id) == AgentSpeakType::Number { float: true };
        loop {
            let mut changed = false;
            for (a, b) in &links {
                let (Some(a), Some(b)) = (self.numbers(*a), self.numbers(*b)) else { continue };
                if has_decimals(self, a) != has_decimals(self, b) {
                    for id in [a, b] {
                        self.give_decimals(id);
                    }
                    changed = true;
                }
            }
            if !changed {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atoms(types: &mut UnificationTable, name: &str) -> TyId {
        types.add(AgentSpeakType::Atoms { names: [name.to_owned()].into_iter().collect(), agent: false })
    }

    #[test]
    fn values_of_two_types_are_a_tag_and_two_parts() {
        let mut types = UnificationTable::default();
        let (place, number, atom) = (types.fresh(), types.number(false), atoms(&mut types, "x"));
        types.unify(place, number).unwrap();
        types.unify(place, atom).unwrap();
        assert_eq!(types.leaves(place).len(), 3);
        let (again, text) = (atoms(&mut types, "y"), types.add(AgentSpeakType::Text));
        types.unify(again, place).unwrap();
        assert_eq!(types.leaves(again).len(), 3);
        types.unify(text, again).unwrap();
        assert_eq!(types.leaves(number).len(), 4);
        assert!(types.meet(number, atom).is_ok());
    }

    #[test]
    fn what_needs_a_number_takes_that_alternative_alone() {
        let mut types = UnificationTable::default();
        let (place, atom) = (types.number(true), atoms(&mut types, "x"));
        types.unify(place, atom).unwrap();
        let result = types.number(false);
        types.demand(place, result).unwrap();
        let text = types.add(AgentSpeakType::Text);
        assert!(types.demand(place, text).is_err());
        types.settle_decimals();
        assert_eq!(*types.get(result), AgentSpeakType::Number { float: true });
        let other = atoms(&mut types, "y");
        assert!(types.meet(result, other).is_err());
    }

    #[test]
    fn an_alternative_does_not_contain_the_whole() {
        let mut types = UnificationTable::default();
        let (place, leaf) = (types.fresh(), atoms(&mut types, "leaf"));
        types.unify(place, leaf).unwrap();
        let node = types.add(AgentSpeakType::Struct("node".to_owned(), vec![place]));
        assert!(types.unify(place, node).is_err());
    }
}
