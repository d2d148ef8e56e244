//! What is told: its annotations.

use super::{
    super::{
        ast::{AgentSpeakLiteral, AgentSpeakTerm},
        term::{AgentSpeakMessage, valued},
    },
    clause::ClauseTranslator,
};

impl ClauseTranslator<'_> {
    /// The annotations that are sent, too: those of what is told, but for its source, which is who tells it.
    pub(super) fn told_annotations(
        &mut self,
        message: &AgentSpeakMessage<'_>,
        of: &AgentSpeakLiteral,
    ) -> Vec<AgentSpeakTerm> {
        let is_told = message.performative == "tell";
        let (kept, dropped): (Vec<&AgentSpeakTerm>, Vec<&AgentSpeakTerm>) = of
            .annotations
            .iter()
            .partition(|a| is_told && valued(a).is_some_and(|(name, _)| name != "source"));
        if let Some(first) = dropped.first() {
            let message = if is_told {
                "of the annotations of what is told those with one value are sent, and not the source"
            } else {
                "only what is told has annotations in hrdsl: these are dropped"
            };
            self.remarks.push((first.span, message.to_owned()));
        }
        kept.into_iter().cloned().collect()
    }
}
