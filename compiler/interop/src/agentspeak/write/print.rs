//! What `.print` prints, in the scenario's words.

use super::{
    super::{
        ast::{AgentSpeakTerm, TermKind},
        types::AgentSpeakType,
    },
    clause::{BindingMode, ClauseResult, ClauseTranslator, quoted},
};

impl ClauseTranslator<'_> {
    pub(super) fn print(&mut self, args: &[AgentSpeakTerm]) -> ClauseResult<String> {
        let mut parts: Vec<Result<String, String>> = Vec::new();
        for arg in args {
            self.printed(arg, false, &mut parts)?;
        }
        // Texts next to each other are one.
        let mut merged: Vec<Result<String, String>> = Vec::new();
        for part in parts {
            match (merged.last_mut(), part) {
                (Some(Ok(text)), Ok(more)) => text.push_str(&more),
                (_, part) => merged.push(part),
            }
        }
        let args: Vec<String> = merged.into_iter().map(|p| p.map_or_else(|e| e, |t| quoted(&t))).collect();
        Ok(format!(".print({})", args.join(", ")))
    }

    /// What is printed of a term: texts, and expressions as errors. Within lists and structures strings have quotes.
    fn printed(
        &mut self,
        of: &AgentSpeakTerm,
        within: bool,
        parts: &mut Vec<Result<String, String>>,
    ) -> ClauseResult<()> {
        match &of.kind {
            TermKind::Text(text) if within => parts.push(Ok(format!("\"{text}\""))),
            TermKind::Text(text) => parts.push(Ok(text.clone())),
            TermKind::Literal(l) if !l.is_internal() => {
                parts.push(Ok(format!("{}{}", if l.negated { "~" } else { "" }, l.functor)));
                if !l.args.is_empty() {
                    self.printed_each(["(", ")"], &l.args, parts)?;
                }
            }
            TermKind::List { items, rest: None } => self.printed_each(["[", "]"], items, parts)?,
            TermKind::Any => parts.push(Ok("_".to_owned())),
            TermKind::Var { name, .. } if !self.bound.contains(name) => {
                let message = format!(
                    "`{name}` may have no value here: Jason makes up a name to print, hrdsl prints `_`"
                );
                self.remarks.push((of.span, message));
                parts.push(Ok("_".to_owned()));
            }
            TermKind::Binary { .. } | TermKind::Neg(_) => parts.push(Err(self.expr(of)?.text)),
            _ => self.printed_value(of, within, parts)?,
        }
        Ok(())
    }

    fn printed_each(
        &mut self,
        [open, close]: [&str; 2],
        items: &[AgentSpeakTerm],
        parts: &mut Vec<Result<String, String>>,
    ) -> ClauseResult<()> {
        parts.push(Ok(open.to_owned()));
        for (i, item) in items.iter().enumerate() {
            if i > 0 {
                parts.push(Ok(",".to_owned()));
            }
            self.printed(item, true, parts)?;
        }
        parts.push(Ok(close.to_owned()));
        Ok(())
    }

    fn printed_value(
        &mut self,
        of: &AgentSpeakTerm,
        within: bool,
        parts: &mut Vec<Result<String, String>>,
    ) -> ClauseResult<()> {
        let id = self.type_of(of)?;
        let functor = match self.cx.types.get(id) {
            AgentSpeakType::Struct(functor, _) => Some(functor.clone()),
            _ => None,
        };
        let quote =
            (within && matches!(self.cx.types.get(id), AgentSpeakType::Text)).then(|| Ok("\"".to_owned()));
        let leaves = self.cx.types.leaves(id);
        if leaves.len() > 1 && leaves.iter().all(|l| l.lists > 0) {
            let message = "a list of structures is printed as the lists of their parts";
            self.remarks.push((of.span, message.to_owned()));
        }
        parts.extend(functor.iter().map(|f| Ok(format!("{f}("))));
        parts.extend(quote.clone());
        for (i, value) in self.values(of, BindingMode::Value)?.into_iter().enumerate() {
            if i > 0 {
                parts.push(Ok(",".to_owned()));
            }
            parts.push(Err(value));
        }
        parts.extend(quote);
        parts.extend(functor.iter().map(|_| Ok(")".to_owned())));
        if let TermKind::Var { name, .. } = &of.kind
            && let Some(source) = self.answers.get(name)
        {
            parts.extend([Ok("[source(".to_owned()), source.clone(), Ok(")]".to_owned())]);
        }
        Ok(())
    }
}
