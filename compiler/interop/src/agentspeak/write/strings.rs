//! Parts of strings and kinds of terms, which Jason asks for while it runs.

use super::{
    super::{
        ast::{AgentSpeakTerm, TermKind},
        types::AgentSpeakType,
    },
    clause::{ATOM, BindingMode, COMPARE, ClauseFragment, ClauseResult, ClauseTranslator},
};

impl ClauseTranslator<'_> {
    /// `.substring(part, whole, begin, end)`: asks for places if the part is known, and for the part if they are. The
    /// end is the last character that is found, but the one after it of a part that is taken.
    pub(super) fn substring(
        &mut self,
        part: &AgentSpeakTerm,
        whole: &AgentSpeakTerm,
        places: &[AgentSpeakTerm],
    ) -> ClauseResult<ClauseFragment> {
        let Some((begin, end)) = places.split_first() else {
            let (part, whole) = (self.expr(part)?.text, self.expr(whole)?.text);
            return Ok(ClauseFragment::new(format!(".sublist({part}, {whole})"), ATOM));
        };
        let end = end.first();
        if self.is_bound(begin) && !self.is_bound(part) {
            return self.part(whole, begin, end, part);
        }
        if self.is_bound(begin) && !self.is_bound(whole) {
            return self.part(part, begin, end, whole);
        }
        let (part, whole) = (self.expr(part)?.text, self.expr(whole)?.text);
        let found = self.fresh("Places");
        let mut parts = vec![ClauseFragment::new(format!(".occurrences({part}, {whole}, {found})"), ATOM)];
        let mut place = self.value(begin, BindingMode::Pattern)?;
        if place == "_" && end.is_some() {
            place = self.fresh("Begin");
        }
        parts.push(ClauseFragment::new(format!(".member({place}, {found})"), ATOM));
        if let Some(end) = end {
            let length = self.fresh("Length");
            parts.push(ClauseFragment::new(format!(".length({part}, {length})"), ATOM));
            let end = self.value(end, BindingMode::Pattern)?;
            parts.push(ClauseFragment::new(format!("{end} = {place} + {length} - 1"), COMPARE));
        }
        Ok(ClauseFragment::all(parts))
    }

    fn part(
        &mut self,
        of: &AgentSpeakTerm,
        begin: &AgentSpeakTerm,
        end: Option<&AgentSpeakTerm>,
        into: &AgentSpeakTerm,
    ) -> ClauseResult<ClauseFragment> {
        let (of, begin) = (self.expr(of)?.text, self.expr(begin)?.text);
        let mut parts = Vec::new();
        let end = match end {
            Some(end) => self.expr(end)?.text,
            None => {
                let length = self.fresh("Length");
                parts.push(ClauseFragment::new(format!(".length({of}, {length})"), ATOM));
                length
            }
        };
        let into = self.value(into, BindingMode::Pattern)?;
        parts.push(ClauseFragment::new(format!(".slice({of}, {begin}, {end}, {into})"), ATOM));
        Ok(ClauseFragment::all(parts))
    }

    /// Of which kind a term is, and whether it has a value, is known when the program is read.
    pub(super) fn is_of(&mut self, asked: &str, term: &AgentSpeakTerm) -> ClauseResult<bool> {
        let unsure = matches!(&term.kind, TermKind::Var { name, .. } if self.owed.contains_key(name));
        if unsure && !self.is_bound(term) {
            return Err("whether this has a value is known only when it runs".into());
        }
        if asked == ".ground" || !self.is_bound(term) {
            return Ok(asked == ".ground" && self.is_bound(term));
        }
        Ok(match (asked, self.cx.types.get(self.type_of(term)?)) {
            (_, AgentSpeakType::Unknown) => {
                return Err("nothing says of what kind this is".into());
            }
            (".number", ty) => matches!(ty, AgentSpeakType::Number { .. }),
            (".string", ty) => *ty == AgentSpeakType::Text,
            (".list", ty) => matches!(ty, AgentSpeakType::List(_)),
            (_, ty) => matches!(ty, AgentSpeakType::Atoms { .. } | AgentSpeakType::Bool),
        })
    }
}
