//! All that the text is made of.

use crate::agentspeak::{
    infer::InferenceOutcome,
    names::{AgentSpeakNames, unused},
    survey::PredicateSurvey,
    system::AgentSpeakSystem,
};

/// All that the text is made of.
pub struct AgentSpeakTranslator<'a> {
    pub system: &'a AgentSpeakSystem,
    pub inferred: &'a InferenceOutcome,
    pub names: &'a AgentSpeakNames,
    pub surveys: &'a [PredicateSurvey],
}

/// The name of the rule that answers with the whole numbers from one to another.
pub fn between(names: &AgentSpeakNames) -> String {
    unused("between".to_owned(), &names.beliefs.values().cloned().collect())
}
