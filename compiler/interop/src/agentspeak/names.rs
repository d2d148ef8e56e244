//! Names: what a scenario does not take as a name, or would take for something else, gets another one.

use hrdsl_syntax::token::{KEYWORDS, KeywordClass};
use indexmap::{IndexMap, IndexSet};

pub(crate) use crate::exchange::name::unused;

use super::{
    ast::PredicateIndicator,
    survey::{OccurrenceKind, PredicateKind, PredicateOccurrence, PredicateSurvey},
    system::AgentSpeakSystem,
    tags::AlternativeTags,
    texts::{TextEnumeration, is_text, texts},
    types::{AgentSpeakType, ListLeafType, TyId, UnificationTable},
};

/// Words with a meaning of their own where a name of an agent's program may stand.
const TAKEN: &[&str] = &[
    "wait", "while", "for", "fork", "belief", "goal", "plan", "rule", "min", "max", "abs", "norm", "self",
    "percept", "source",
];

/// An enumeration: the atoms of a class.
#[derive(Debug)]
pub struct AtomEnumeration {
    pub name: String,
    /// As they are in the program, and as they are written.
    pub values: IndexMap<String, String>,
}

/// What everything is called in the scenario.
#[derive(Debug, Default)]
pub struct AgentSpeakNames {
    pub beliefs: IndexMap<PredicateIndicator, String>,
    pub goals: IndexMap<PredicateIndicator, String>,
    /// By agent.
    pub actions: IndexMap<(String, PredicateIndicator), String>,
    pub agents: IndexMap<String, String>,
    pub enums: Vec<AtomEnumeration>,
    /// By class: the strings that are arguments of actions.
    pub texts: IndexMap<TyId, TextEnumeration>,
    /// The tags of values of several types.
    pub tags: AlternativeTags,
    /// Which enumeration the values of a class are of, by its root.
    of: IndexMap<TyId, usize>,
    /// Values that are written with their enumeration.
    ambiguous: IndexSet<String>,
}

impl AgentSpeakNames {
    /// What a belief is called; one that no agent has keeps its own name.
    pub fn belief(&self, key: &PredicateIndicator) -> String {
        self.beliefs.get(key).cloned().unwrap_or_else(|| ident(&key.0))
    }

    /// What a goal is called; one that no agent has keeps its own name.
    pub fn goal(&self, key: &PredicateIndicator) -> String {
        self.goals.get(key).cloned().unwrap_or_else(|| ident(&key.0))
    }
}

/// A name of the language, with its namespace.
fn clean(name: &str) -> String {
    crate::exchange::name::clean(&name.replace("::", "_"))
}

/// The same, and no keyword.
pub fn ident(name: &str) -> String {
    let mut out = clean(name);
    let reserved = KEYWORDS.iter().any(|k| k.word == out && k.class != KeywordClass::Soft);
    if reserved || TAKEN.contains(&out.as_str()) {
        out.push('_');
    }
    out
}

/// The name of a variable: it begins with a capital letter.
pub fn variable(name: &str) -> String {
    let bare = clean(name.trim_start_matches('_'));
    let bare = bare.strip_prefix("x_").map_or(bare.clone(), |digits| format!("X{digits}"));
    let mut chars = bare.chars();
    chars.next().map_or_else(|| "X".to_owned(), |c| c.to_ascii_uppercase().to_string() + chars.as_str())
}

/// The name of a parameter, from that of a variable: `CNPId` is `cnp_id`.
pub fn parameter(name: &str) -> String {
    let chars: Vec<char> = clean(name.trim_start_matches('_')).chars().collect();
    let mut out = String::new();
    for (i, c) in chars.iter().enumerate() {
        let after_small = i > 0 && (chars[i - 1].is_ascii_lowercase() || chars[i - 1].is_ascii_digit());
        let before_small = i > 0
            && chars[i - 1].is_ascii_uppercase()
            && chars.get(i + 1).is_some_and(char::is_ascii_lowercase);
        if c.is_ascii_uppercase() && (after_small || before_small) {
            out.push('_');
        }
        out.push(c.to_ascii_lowercase());
    }
    ident(&out)
}

fn called<'k>(keys: impl Iterator<Item = &'k PredicateIndicator>) -> IndexMap<PredicateIndicator, String> {
    let (mut used, mut names) = (IndexSet::new(), IndexMap::new());
    let mut functors: IndexMap<&str, PredicateIndicator> = IndexMap::new();
    for key in keys {
        // The same name with another number of arguments is another belief or goal.
        let first = functors.entry(&key.0).or_insert_with(|| key.clone()) == key;
        let wanted = if first { ident(&key.0) } else { format!("{}_{}", ident(&key.0), key.1) };
        let name = unused(wanted, &used);
        used.insert(name.clone());
        names.insert(key.clone(), name);
    }
    names
}

impl AgentSpeakNames {
    pub fn new(system: &AgentSpeakSystem, types: &UnificationTable, surveys: &[PredicateSurvey]) -> Self {
        let mut names = Self {
            beliefs: called(types.beliefs.keys()),
            goals: called(types.goals.keys()),
            ..Self::default()
        };
        // What is sent is a belief or a goal by its name alone.
        let is_sent = |key: &PredicateIndicator| {
            let sent =
                |m: &PredicateOccurrence| m.key == *key && matches!(m.what, OccurrenceKind::Sent { .. });
            surveys.iter().any(|s| s.goals.iter().any(sent))
        };
        let beliefs: IndexSet<String> = names.beliefs.values().cloned().collect();
        let goals: IndexSet<String> = names.goals.values().cloned().collect();
        for (_, name) in names.goals.iter_mut().filter(|(key, _)| is_sent(key)) {
            while beliefs.contains(name) {
                *name = unused(format!("{name}_"), &goals);
            }
        }
        let mut used = IndexSet::new();
        for agent in &system.agents {
            let name = unused(ident(&agent.name), &used);
            used.insert(name.clone());
            names.agents.insert(agent.name.clone(), name);
        }
        names.name_actions(system, types, surveys);
        names.name_enums(types, surveys);
        let used = names.enums.iter().map(|e| e.name.clone()).collect();
        names.tags = AlternativeTags::new(&places(types, surveys), types, used);
        names.texts = texts(system, types, surveys, &names);
        names
    }

    /// A stimulus is one actor's: an action that several agents do is several stimuli.
    fn name_actions(
        &mut self,
        system: &AgentSpeakSystem,
        types: &UnificationTable,
        surveys: &[PredicateSurvey],
    ) {
        let plain = called(types.actions.keys());
        let mut used: IndexSet<String> = IndexSet::new();
        for (key, name) in &plain {
            let doers: Vec<&str> = system
                .agents
                .iter()
                .filter(|a| surveys[a.program].actions.contains_key(key))
                .map(|a| a.name.as_str())
                .collect();
            for doer in &doers {
                let wanted = if doers.len() == 1 {
                    name.clone()
                } else {
                    format!("{}_{}", self.agents[*doer], name.trim_end_matches('_'))
                };
                let name = unused(wanted, &used);
                used.insert(name.clone());
                self.actions.insert(((*doer).to_owned(), key.clone()), name);
            }
        }
    }

    /// Classes that share an atom share an enumeration, so that an atom is one value wherever that is possible.
    fn name_enums(&mut self, types: &UnificationTable, surveys: &[PredicateSurvey]) {
        let mut groups: Vec<(IndexSet<String>, Vec<TyId>, IndexSet<String>)> = Vec::new();
        for (hint, place) in places(types, surveys) {
            for ListLeafType { of, .. } in types.leaves(place) {
                let AgentSpeakType::Atoms { names, .. } = types.get(of) else { continue };
                if types.is_of_agents(of) {
                    continue;
                }
                let (mut atoms, mut roots) = (names.clone(), vec![of]);
                let mut hints: IndexSet<String> = [hint.clone()].into_iter().collect();
                let (meets, rest): (Vec<_>, Vec<_>) =
                    groups.into_iter().partition(|(known, ..)| known.iter().any(|a| atoms.contains(a)));
                groups = rest;
                for (known, of, more) in meets.into_iter().rev() {
                    atoms = known.into_iter().chain(atoms).collect();
                    roots.extend(of);
                    hints = more.into_iter().chain(hints).collect();
                }
                groups.push((atoms, roots, hints));
            }
        }
        let beliefs: IndexSet<&String> = self.beliefs.values().collect();
        let mut used = IndexSet::new();
        for (atoms, roots, hints) in groups {
            // A variable that says something names it best.
            let hint = hints.iter().find(|h| h.len() > 1 && h.starts_with(char::is_uppercase));
            let hint = hint.or(hints.first());
            let words = hint.map_or("Value", String::as_str).split('_').filter(|w| !w.is_empty());
            let name = unused(words.map(variable).collect::<String>() + "Kind", &used);
            used.insert(name.clone());
            let mut values: IndexMap<String, String> = IndexMap::new();
            for atom in atoms {
                let mut value = ident(&atom);
                while beliefs.contains(&value) || values.values().any(|v| *v == value) {
                    value.push('_');
                }
                values.insert(atom, value);
            }
            self.of.extend(roots.into_iter().map(|r| (r, self.enums.len())));
            self.enums.push(AtomEnumeration { name, values });
        }
        self.ambiguous = self.agents.values().cloned().collect();
    }

    /// An atom of a class.
    pub fn atom(&self, types: &UnificationTable, id: TyId, atom: &str) -> String {
        match self.of.get(&types.root(id)).map(|i| &self.enums[*i]) {
            None => self.agents.get(atom).cloned().unwrap_or_else(|| atom.to_owned()),
            Some(of) => {
                let value = of.values.get(atom).cloned().unwrap_or_else(|| ident(atom));
                if self.ambiguous.contains(&value) { format!("{}.{value}", of.name) } else { value }
            }
        }
    }

    /// How a type is written.
    pub fn type_of(&self, types: &UnificationTable, leaf: ListLeafType) -> String {
        let of = match types.get(leaf.of) {
            AgentSpeakType::Number { float: true } => "float".to_owned(),
            AgentSpeakType::Text => "string".to_owned(),
            AgentSpeakType::Bool => "bool".to_owned(),
            AgentSpeakType::Atoms { .. } => {
                self.of.get(&leaf.of).map_or_else(|| "agent".to_owned(), |i| self.enums[*i].name.clone())
            }
            AgentSpeakType::Union(_) => {
                self.tags.enumeration(leaf.of).map_or_else(|| "int".to_owned(), |e| e.name.clone())
            }
            AgentSpeakType::Number { float: false }
            | AgentSpeakType::Unknown
            | AgentSpeakType::List(_)
            | AgentSpeakType::Struct(..) => "int".to_owned(),
        };
        format!("{}{of}{}", "[".repeat(leaf.lists), "]".repeat(leaf.lists))
    }

    /// The enumeration that stands for strings where they are arguments of actions.
    pub fn texts_of(&self, types: &UnificationTable, leaf: ListLeafType) -> Option<&TextEnumeration> {
        self.texts.get(&leaf.of).filter(|_| is_text(types, leaf))
    }

    /// All values of enumerations and names of agents, which no parameter may be called.
    pub fn is_value(&self, name: &str) -> bool {
        self.agents.values().any(|a| a == name)
            || self.enums.iter().any(|e| e.values.values().any(|v| v == name))
            || self.tags.enums.iter().any(|e| e.values.contains(name))
            || self.texts.values().any(|e| e.other == name || e.values.values().any(|v| v == name))
    }
}

/// All places where values can be, with what they may be called by: a variable there, or what they are in.
fn places(types: &UnificationTable, surveys: &[PredicateSurvey]) -> Vec<(String, TyId)> {
    let mut all = Vec::new();
    for (sort, of) in [
        (PredicateKind::Belief, &types.beliefs),
        (PredicateKind::Goal, &types.goals),
        (PredicateKind::Action, &types.actions),
    ] {
        for (key, args) in of {
            for (i, place) in args.iter().enumerate() {
                let hint = surveys.iter().find_map(|s| s.hints.get(&(sort, key.clone()))?.get(i)?.clone());
                let hint = hint.map(|h| variable(&h)).filter(|h| h.len() > 1);
                all.push((hint.unwrap_or_else(|| key.0.clone()), *place));
            }
        }
    }
    all.extend(types.annotations.iter().map(|((_, name), id)| (name.clone(), *id)));
    all.extend(types.terms.values().map(|id| ("value".to_owned(), *id)));
    all
}
