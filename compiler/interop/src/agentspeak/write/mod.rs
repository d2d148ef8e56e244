//! Programs to the text of a scenario.
//!
//! # Steps
//! 1. `modes`: which rules can be written, and which of their arguments must have a value
//! 2. `agent`: each agent's members, as far as they can be written (`clause`, `steps`, `internal`)
//! 3. what agents are told and asked is declared where it arrives
//! 4. the text: vocabulary, agents, a suite that runs them together

mod agent;
mod arithmetic;
mod clause;
mod compare;
mod first;
mod internal;
mod modes;
mod print;
mod steps;
mod strings;
mod told;
mod values;
mod wanted;
mod writer;

use indexmap::IndexMap;

use super::{
    ast::PredicateIndicator,
    names::{ident, parameter},
    survey::PredicateKind,
    types::TyId,
};
use agent::TranslatedAgent;
use clause::{ClauseContext, call};
use wanted::WantedArguments;
pub use writer::AgentSpeakTranslator;
use writer::between;

/// The text, not yet formatted, and what is left out or meant otherwise.
pub struct ScenarioDraft {
    pub text: String,
    pub left_out: Vec<(hrdsl_source::Span, String)>,
    pub remarks: Vec<(hrdsl_source::Span, String)>,
}

impl AgentSpeakTranslator<'_> {
    pub fn write(&self) -> ScenarioDraft {
        let (mut left_out, mut remarks) = (Vec::new(), Vec::new());
        let mut agents: Vec<TranslatedAgent> = Vec::new();
        for entry in &self.system.agents {
            let program = &self.system.programs[entry.program];
            let (inputs, rules) = modes::rules(self, entry, program);
            let mut wanted = WantedArguments::new();
            // What one plan wants of a goal changes what its plans are, and what they want of others.
            let agent = loop {
                let cx = ClauseContext {
                    system: self.system,
                    types: &self.inferred.types,
                    left_out: &self.inferred.left_out,
                    names: self.names,
                    inputs: &inputs,
                    wanted: &wanted,
                };
                let agent = agent::agent(&cx, entry, program, &rules);
                if !wanted::enlarge(&mut wanted, &agent.used, &agent.needing) {
                    break agent;
                }
            };
            left_out.extend(agent.left_out.iter().cloned());
            remarks.extend(agent.remarks.iter().cloned());
            agents.push(agent);
        }
        deliver(&mut agents);
        let mut text = format!("scenario {}\n\n", ident(&self.system.name));
        text += &self.vocabulary(&agents);
        for agent in &agents {
            text += &self.agent(agent, &mut remarks);
        }
        let names: Vec<&str> = agents.iter().map(|a| self.names.agents[&a.name].as_str()).collect();
        text += &format!("suite together by agents {} {{ tests 1 }}\n", names.join(", "));
        ScenarioDraft { text, left_out, remarks }
    }

    fn vocabulary(&self, agents: &[TranslatedAgent]) -> String {
        let mut text = String::new();
        for agent in agents {
            text += &format!("actor {} : environment\n", self.names.agents[&agent.name]);
        }
        text.push('\n');
        for of in &self.names.enums {
            let values: Vec<&str> = of.values.values().map(String::as_str).collect();
            text += &format!("enum {} {{ {} }}\n", of.name, values.join(", "));
        }
        for of in &self.names.tags.enums {
            let values: Vec<&str> = of.values.iter().map(String::as_str).collect();
            text += &format!("enum {} {{ {} }}\n", of.name, values.join(", "));
        }
        for of in self.names.texts.values() {
            let values: Vec<&str> =
                of.values.values().chain(of.computed.then_some(&of.other)).map(String::as_str).collect();
            text += &format!("enum {} {{ {} }}\n", of.name, values.join(", "));
        }
        text.push('\n');
        for agent in agents {
            for key in &agent.used.actions {
                let Some(name) = self.names.actions.get(&(agent.name.clone(), key.clone())) else { continue };
                let params = self.params(PredicateKind::Action, key, &self.inferred.types.actions);
                let actor = &self.names.agents[&agent.name];
                text += &format!("stimulus {} by {actor} {{ hold 1 s }}\n", call(name, &params));
            }
        }
        text + "\n"
    }

    /// `name: type` for each single value.
    fn params(
        &self,
        sort: PredicateKind,
        key: &PredicateIndicator,
        places: &IndexMap<PredicateIndicator, Vec<TyId>>,
    ) -> Vec<String> {
        let types = &self.inferred.types;
        let mut used = indexmap::IndexSet::new();
        let mut params = Vec::new();
        for (i, place) in places.get(key).into_iter().flatten().enumerate() {
            let hint = self.surveys.iter().find_map(|s| s.hints.get(&(sort, key.clone()))?.get(i)?.clone());
            let base = hint.map_or_else(|| format!("arg{}", i + 1), |h| parameter(&h));
            let leaves = types.leaves(*place);
            let single = leaves.len() == 1;
            for (k, leaf) in leaves.into_iter().enumerate() {
                let texts = self.names.texts_of(types, leaf).filter(|_| sort == PredicateKind::Action);
                if sort == PredicateKind::Action && texts.is_none() && types.is_for_agents(leaf) {
                    continue;
                }
                let mut name = if single { base.clone() } else { format!("{base}_{}", k + 1) };
                while used.contains(&name) || self.names.is_value(&name) {
                    name.push('_');
                }
                used.insert(name.clone());
                let ty = texts.map_or_else(|| self.names.type_of(types, leaf), |t| t.name.clone());
                params.push(format!("{name}: {ty}"));
            }
        }
        params
    }

    fn agent(&self, agent: &TranslatedAgent, remarks: &mut Vec<(hrdsl_source::Span, String)>) -> String {
        let name = &self.names.agents[&agent.name];
        let mut text = format!("agent {name} plays {name}[jason] {{\n");
        text += &agent.early_rules;
        text += &self.beliefs(agent);
        text += &agent.rules;
        if agent.used.between {
            let b = between(self.names);
            text += &format!("rule {b}(X, Lo, Hi) when Lo <= Hi && X = Lo\n");
            text += &format!("rule {b}(X, Lo, Hi) when Lo < Hi && {b}(X, Lo + 1, Hi)\n");
        }
        text.push('\n');
        for key in agent.used.planned.union(&agent.used.adopted).filter(|k| k.1 > 0) {
            let params = self.params(PredicateKind::Goal, key, &self.inferred.types.goals);
            text += &format!("goal {}\n", call(&self.names.goals[key], &params));
        }
        text.push('\n');
        text += &agent.goals;
        text.push('\n');
        text += &agent.plans;
        for key in agent.used.adopted.difference(&agent.used.planned) {
            let count: usize =
                self.inferred.types.goals[key].iter().map(|p| self.inferred.types.leaves(*p).len()).sum();
            let goal = &self.names.goals[key];
            text += &format!(
                "\n// no plan achieves `{goal}`, so it fails\nplan +!{} {{ .fail }}\n",
                call(goal, &vec!["_".to_owned(); count])
            );
            let place = self.surveys.iter().flat_map(|s| &s.goals).find(|m| m.key == *key).map(|m| m.span);
            let message = format!(
                "no plan of `{}` that is carried over achieves `{}`, so the goal fails",
                agent.name, key.0
            );
            remarks.push((place.unwrap_or_default(), message));
        }
        text + "}\n\n"
    }

    fn beliefs(&self, agent: &TranslatedAgent) -> String {
        let types = &self.inferred.types;
        let mut text = String::new();
        for key in &agent.used.beliefs {
            let params = self.params(PredicateKind::Belief, key, &types.beliefs);
            let mut line = format!("belief {}", call(&self.names.beliefs[key], &params));
            let annotations: Vec<String> = types
                .annotations
                .iter()
                .filter(|((of, name), _)| {
                    of == key && agent.used.annotations.contains(&(of.clone(), name.clone()))
                })
                .filter_map(|((_, name), id)| {
                    let leaf = *types.leaves(*id).first()?;
                    Some(format!("{}: {}", ident(name), self.names.type_of(types, leaf)))
                })
                .collect();
            if !annotations.is_empty() {
                line += &format!(" [{}]", annotations.join(", "));
            }
            if let Some(facts) = agent.facts.get(key) {
                line += &format!(" = {}", facts.join(", "));
            }
            text += &format!("{line}\n");
        }
        text += &agent.no_facts;
        if agent.used.between {
            text += &format!("belief {}(x: int, lo: int, hi: int)\n", between(self.names));
        }
        text + "\n"
    }
}

/// Declares what is told and asked where it arrives.
fn deliver(agents: &mut [TranslatedAgent]) {
    let mut arriving = Vec::new();
    for agent in &*agents {
        arriving.extend(
            agent
                .used
                .sent
                .iter()
                .map(|(to, goal, key)| (agent.name.clone(), to.clone(), *goal, key.clone())),
        );
    }
    // An annotation that one agent knows must be known where its facts come from.
    let annotations: Vec<(PredicateIndicator, String)> =
        agents.iter().flat_map(|a| a.used.annotations.iter().cloned()).collect();
    for (from, to, goal, key) in arriving {
        let all = to.is_none();
        for agent in agents.iter_mut().filter(|a| to.as_ref().map_or(a.name != from, |t| *t == a.name)) {
            if goal && !(all && agent.used.planned.contains(&key)) {
                agent.used.adopted.insert(key.clone());
            } else if !goal {
                agent.used.beliefs.insert(key.clone());
            }
        }
    }
    for agent in agents {
        let known: Vec<_> =
            annotations.iter().filter(|(k, _)| agent.used.beliefs.contains(k)).cloned().collect();
        agent.used.annotations.extend(known);
    }
}
