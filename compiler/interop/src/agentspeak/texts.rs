//! Strings that are arguments of actions: a stimulus has none, and so they become an enumeration of those that the programs have.

use indexmap::{IndexMap, IndexSet};

use super::{
    ast::{
        AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakStep, AgentSpeakStepKind, TermKind, each_step,
        each_term,
    },
    names::{AgentSpeakNames, ident, unused, variable},
    survey::{PredicateKind, PredicateSurvey},
    system::AgentSpeakSystem,
    term::atom,
    types::{AgentSpeakType, ListLeafType, TyId, UnificationTable},
};

/// The strings of a class, as an enumeration.
#[derive(Debug)]
pub struct TextEnumeration {
    pub name: String,
    /// As they stand in the programs, with their quotes, and as they are written.
    pub values: IndexMap<String, String>,
    /// For all others.
    pub other: String,
    /// Some action is done with a string that is not written there.
    pub computed: bool,
}

impl TextEnumeration {
    /// The value for a string that is written so.
    pub fn expr(&self, of: &str) -> String {
        let written = |value: &String| format!("{}.{value}", self.name);
        if let Some(value) = self.values.get(of) {
            return written(value);
        }
        let cases = self
            .values
            .iter()
            .map(|(text, value)| format!("if {of} == {text} {{ {} }} else ", written(value)));
        cases.collect::<String>() + &format!("{{ {} }}", written(&self.other))
    }
}

/// The enumerations of all strings that are arguments of actions, by class.
pub fn texts(
    system: &AgentSpeakSystem,
    types: &UnificationTable,
    surveys: &[PredicateSurvey],
    names: &AgentSpeakNames,
) -> IndexMap<TyId, TextEnumeration> {
    let (mut all, mut enums) = (IndexMap::new(), IndexSet::new());
    enums.extend(names.enums.iter().map(|e| e.name.clone()));
    enums.extend(names.tags.enums.iter().map(|e| e.name.clone()));
    let computed = computed(system, types);
    for (key, places) in &types.actions {
        for (i, place) in places.iter().enumerate() {
            for leaf in types.leaves(*place) {
                if !is_text(types, leaf) || all.contains_key(&leaf.of) {
                    continue;
                }
                let mut values = IndexMap::new();
                for (span, id) in &types.terms {
                    let Some(text) = constant(system.files.text(*span)) else { continue };
                    if types.root(*id) == leaf.of && !values.contains_key(&text) {
                        let used: IndexSet<String> = values.values().cloned().collect();
                        let value = unused(ident(text.trim_matches('"')), &used);
                        values.insert(text, value);
                    }
                }
                if values.is_empty() {
                    continue;
                }
                let hint = surveys
                    .iter()
                    .find_map(|s| s.hints.get(&(PredicateKind::Action, key.clone()))?.get(i)?.clone())
                    .filter(|h| h.len() > 1);
                let words = hint.unwrap_or_else(|| key.0.clone());
                let words = words.split('_').filter(|w| !w.is_empty());
                let name = unused(words.map(variable).collect::<String>() + "Text", &enums);
                enums.insert(name.clone());
                let other = unused("other".to_owned(), &values.values().cloned().collect());
                let computed = computed.contains(&leaf.of);
                all.insert(leaf.of, TextEnumeration { name, values, other, computed });
            }
        }
    }
    all
}

/// The string that a term is, with its quotes; an atom among strings is one, too.
fn constant(text: &str) -> Option<String> {
    let is_atom = text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if is_atom { Some(format!("\"{text}\"")) } else { text.starts_with('"').then(|| text.to_owned()) }
}

/// Whether it is a single string.
pub fn is_text(types: &UnificationTable, leaf: ListLeafType) -> bool {
    leaf.lists == 0 && *types.get(leaf.of) == AgentSpeakType::Text
}

/// The classes of strings of which an action has one that is not written there.
fn computed(system: &AgentSpeakSystem, types: &UnificationTable) -> IndexSet<TyId> {
    let mut found = IndexSet::new();
    for item in system.programs.iter().flat_map(|p| &p.items) {
        if let AgentSpeakItemKind::Plan(plan) = &item.kind {
            actions(&plan.body, &mut |action| {
                for arg in &action.args {
                    each_term(arg, &mut |t| {
                        if let Some(id) = types.terms.get(&t.span)
                            && !matches!(&t.kind, TermKind::Text(_))
                            && atom(t).is_none()
                        {
                            found.extend(types.leaves(*id).into_iter().map(|l| l.of));
                        }
                    });
                }
            });
        }
    }
    found
}

/// Calls `f` with each action of the environment.
fn actions(steps: &[AgentSpeakStep], f: &mut dyn FnMut(&AgentSpeakLiteral)) {
    each_step(steps, &mut |step| {
        let AgentSpeakStepKind::Action(action) = &step.kind else { return };
        for arg in &action.args {
            if let TermKind::Body(body) = &arg.kind {
                actions(body, f);
            }
        }
        if !action.is_internal() {
            f(action);
        }
    });
}
