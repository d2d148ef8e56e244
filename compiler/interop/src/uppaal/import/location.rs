//! Locations: their names, kinds, invariants, and which clocks stand still in them.

use indexmap::IndexMap;

use super::{
    fault::{UppaalFault, fault},
    process::doc,
    scope::{NameOwner, UppaalSymbol},
    stopwatch::StoppedClocks,
    translation::UppaalTranslation,
    write::one_line,
    xml::{UppaalLocation, UppaalLocationKind, UppaalTemplate},
};
use crate::{
    exchange::note::NoteSeverity,
    uppaal::rate::{RATE_COMMENT, with_values},
};

impl UppaalTranslation<'_> {
    pub fn location_names(&mut self, template: &UppaalTemplate) -> Vec<String> {
        let mut names = IndexMap::new();
        // Names of the model first: a nameless location gives way.
        for (i, location) in template.locations.iter().enumerate() {
            if let Some(name) = &location.name {
                names.insert(i, self.names.fresh(name, location.span, NameOwner::Process));
            }
        }
        let mut all = Vec::new();
        for i in 0..template.locations.len() {
            let name = names.get(&i).cloned();
            all.push(name.unwrap_or_else(|| self.names.unused(&format!("l{i}"), NameOwner::Process)));
        }
        all
    }

    pub fn location(
        &mut self,
        location: &UppaalLocation,
        name: &str,
        is_initial: bool,
        stopped: &StoppedClocks,
    ) -> Result<String, UppaalFault> {
        let mut text = doc(&location.comment);
        if !location.rate.trim().is_empty() {
            text += &format!("{RATE_COMMENT}{}\n", self.rate(&location.rate));
            let message = "`exponentialrate` is kept as a comment: only statistical model checking asks how fast a location is left";
            self.notes.push((location.span, NoteSeverity::Info, message.to_owned()));
        }
        if is_initial {
            text += "init ";
        }
        text += match location.kind {
            UppaalLocationKind::Normal => "",
            UppaalLocationKind::Urgent => "urgent ",
            UppaalLocationKind::Committed => "committed ",
        };
        text += &format!("location {name}");
        let mut parts = Vec::new();
        if let Some(invariant) = &stopped.invariant {
            let alternatives = self.alternatives(invariant)?;
            let [only] = alternatives.as_slice() else {
                return fault(invariant.span, "an invariant over clocks cannot have `or`, `not ==` or `!=`");
            };
            let condition = only.text().unwrap_or_else(|| "false".to_owned());
            let joined = condition.contains("||") && !stopped.stands.is_empty();
            parts.push(if joined { format!("({condition})") } else { condition });
        }
        self.clocks_stand |= !stopped.stands.is_empty();
        parts.extend(stopped.stands.iter().map(|clock| format!("stopped({clock})")));
        parts.retain(|part| !part.is_empty());
        if !parts.is_empty() {
            text += &format!(" {{ invariant {} }}", parts.join(" && "));
        }
        Ok(text)
    }

    /// A rate in which constants, which the scenario calls otherwise or puts in, are numbers.
    fn rate(&self, text: &str) -> String {
        with_values(&one_line(text), |name| match self.find(name) {
            Some(UppaalSymbol::Const(constant)) => constant.value,
            Some(_) | None => None,
        })
    }
}
