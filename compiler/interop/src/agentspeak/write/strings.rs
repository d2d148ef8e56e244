//! Parts of strings and kinds of terms, which Jason asks for while it runs.

use super::{
    super::{
        alternatives::AlternativeSort,
        ast::{AgentSpeakTerm, TermKind},
    },
    clause::{ATOM, BindingMode, COMPARE, ClauseFragment, ClauseResult, ClauseTranslator, OR},
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
            return self.piece(whole, begin, end, part);
        }
        if self.is_bound(begin) && !self.is_bound(whole) {
            return self.piece(part, begin, end, whole);
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

    fn piece(
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

    /// Of which kind a term is, and whether it has a value, is known when the program is read, or its tag says so.
    pub(super) fn is_of(&mut self, asked: &str, term: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let constant = |holds: bool| Ok(ClauseFragment::new(holds.to_string(), ATOM));
        let unsure = matches!(&term.kind, TermKind::Var { name, .. } if self.owed.contains_key(name));
        if unsure && !self.is_bound(term) {
            return Err("whether this has a value is known only when it runs".into());
        }
        if asked == ".ground" || !self.is_bound(term) {
            return constant(asked == ".ground" && self.is_bound(term));
        }
        let (types, id) = (self.cx.types, self.type_of(term)?);
        let Some(all) = types.alternatives(id) else {
            let sort = types.get(id).sort().ok_or("nothing says of what kind this is")?;
            return constant(is_asked(asked, &sort));
        };
        if let Some((_, own)) = self.own_alternative(term, id) {
            return constant(types.get(own).sort().is_some_and(|s| is_asked(asked, &s)));
        }
        let tag = self.values(term, BindingMode::Value)?[0].clone();
        let hold: Vec<usize> = (0..all.len())
            .filter(|i| types.get(all[*i]).sort().is_some_and(|s| is_asked(asked, &s)))
            .collect();
        if hold.is_empty() || hold.len() == all.len() {
            return constant(!hold.is_empty());
        }
        let tests: Vec<String> =
            hold.iter().map(|i| format!("{tag} == {}", self.cx.names.tag(types, id, *i))).collect();
        Ok(ClauseFragment::new(tests.join(" || "), if tests.len() > 1 { OR } else { COMPARE }))
    }
}

/// Whether values of a sort are what is asked for.
fn is_asked(asked: &str, sort: &AlternativeSort) -> bool {
    match sort {
        AlternativeSort::Number => asked == ".number",
        AlternativeSort::Text => asked == ".string",
        AlternativeSort::List => matches!(asked, ".list" | ".structure"),
        AlternativeSort::Truth | AlternativeSort::Atom => matches!(asked, ".atom" | ".literal"),
        AlternativeSort::Structure(..) => matches!(asked, ".structure" | ".literal"),
    }
}
