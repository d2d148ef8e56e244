//! Internal actions that stand where a value is due, such as `.length(L) > 2`: they are asked first.

use super::{
    super::ast::{AgentSpeakLiteral, AgentSpeakTerm},
    clause::{ATOM, BindingMode, ClauseFragment, ClauseResult, ClauseTranslator},
};

impl ClauseTranslator<'_> {
    /// An internal action as a value: it is asked before what it stands in.
    pub(super) fn asked_first(&mut self, of: &AgentSpeakLiteral) -> ClauseResult<String> {
        let (action, text) = match (of.functor.as_str(), of.args.as_slice()) {
            (".count", [formula]) => {
                let before = self.bound.clone();
                let text = self.formula(formula).map(|f| f.text);
                self.bound = before;
                (".count", text?)
            }
            (_, [list]) => (".length", self.values(list, BindingMode::Value)?[0].clone()),
            _ => return Err("this is no single value".into()),
        };
        let name = self.fresh(if action == ".count" { "Count" } else { "Length" });
        self.first.push(format!("{action}({text}, {name})"));
        Ok(name)
    }

    /// A formula, with what it asks first.
    pub fn formula(&mut self, of: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let outer = std::mem::take(&mut self.first);
        let written = self.formula_alone(of);
        let first = std::mem::replace(&mut self.first, outer);
        let written = written?;
        if first.is_empty() {
            return Ok(written);
        }
        let asked = first.into_iter().map(|text| ClauseFragment::new(text, ATOM));
        Ok(ClauseFragment::all(asked.chain([written]).collect()))
    }

    /// Where nothing can be asked first nothing may have to be.
    pub(super) fn asks_nothing_first(&mut self) -> ClauseResult<()> {
        match std::mem::take(&mut self.first).first() {
            None => Ok(()),
            Some(text) => Err(format!("`{text}` has to be asked first, and cannot be here").into()),
        }
    }
}
