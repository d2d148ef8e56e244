//! Tags of values of several types: enumerations with a value for each alternative; and what stands in the parts of the
//! alternatives that a value is not.

use indexmap::{IndexMap, IndexSet};

use super::{
    names::{AgentSpeakNames, ident, unused, variable},
    types::{AgentSpeakType, ListLeafType, TyId, UnificationTable},
};

/// An enumeration of tags.
#[derive(Debug)]
pub struct TagEnumeration {
    pub name: String,
    pub values: IndexSet<String>,
}

/// The tags of all classes of values of several types.
#[derive(Debug, Default)]
pub struct AlternativeTags {
    pub enums: Vec<TagEnumeration>,
    /// By class: the enumeration, and the value for each alternative.
    of: IndexMap<TyId, (usize, Vec<String>)>,
}

impl AlternativeTags {
    /// Those of the classes of these places, each with what it may be called by. Classes with the same alternatives share an
    /// enumeration.
    pub fn new(
        places: &[(String, TyId)],
        types: &UnificationTable,
        mut used: IndexSet<String>,
    ) -> AlternativeTags {
        let mut tags = AlternativeTags::default();
        for (hint, place) in places {
            for ListLeafType { of, .. } in types.leaves(*place) {
                let Some(all) = types.alternatives(of).filter(|_| !tags.of.contains_key(&of)) else {
                    continue;
                };
                let mut values: Vec<String> = Vec::new();
                for sort in all.iter().filter_map(|a| types.get(*a).sort()) {
                    values.push(unused(ident(&sort.word()), &values.iter().cloned().collect()));
                }
                let set: IndexSet<String> = values.iter().cloned().collect();
                let known = tags.enums.iter().position(|e| e.values == set);
                let index = known.unwrap_or_else(|| {
                    let words = hint.split('_').filter(|w| !w.is_empty());
                    let name = unused(words.map(variable).collect::<String>() + "Tag", &used);
                    used.insert(name.clone());
                    tags.enums.push(TagEnumeration { name, values: set });
                    tags.enums.len() - 1
                });
                tags.of.insert(of, (index, values));
            }
        }
        tags
    }

    /// The enumeration of a class's tags.
    pub fn enumeration(&self, root: TyId) -> Option<&TagEnumeration> {
        self.of.get(&root).map(|(index, _)| &self.enums[*index])
    }
}

impl AgentSpeakNames {
    /// The tag of an alternative of a class.
    pub fn tag(&self, types: &UnificationTable, id: TyId, alternative: usize) -> String {
        let (index, values) = &self.tags.of[&types.root(id)];
        format!("{}.{}", self.tags.enums[*index].name, values[alternative])
    }

    /// What stands in a part of an alternative that a value is not.
    pub fn nothing(&self, types: &UnificationTable, leaf: ListLeafType) -> String {
        if leaf.lists > 0 {
            return "[]".to_owned();
        }
        match types.get(leaf.of) {
            AgentSpeakType::Number { float: true } => "0.0".to_owned(),
            AgentSpeakType::Text => "\"\"".to_owned(),
            AgentSpeakType::Bool => "false".to_owned(),
            AgentSpeakType::Atoms { .. } if types.is_of_agents(leaf.of) => {
                self.agents.values().next().cloned().unwrap_or_default()
            }
            AgentSpeakType::Atoms { names, .. } => {
                names.first().map_or_else(String::new, |first| self.atom(types, leaf.of, first))
            }
            AgentSpeakType::Union(_) => self.tag(types, leaf.of, 0),
            AgentSpeakType::Number { float: false }
            | AgentSpeakType::Unknown
            | AgentSpeakType::List(_)
            | AgentSpeakType::Struct(..) => "0".to_owned(),
        }
    }
}
