//! What `.print` prints, in the scenario's words.

use super::{
    super::{
        ast::{AgentSpeakTerm, TermKind},
        types::{AgentSpeakType, TyId},
    },
    clause::{BindingMode, ClauseResult, ClauseTranslator, quoted},
};

impl ClauseTranslator<'_> {
    pub(super) fn print(&mut self, args: &[AgentSpeakTerm]) -> ClauseResult<String> {
        let mut parts = Vec::new();
        for arg in args {
            self.printed(arg, false, &mut parts)?;
        }
        let ways = parts.iter().fold(1_usize, |n, p| n.saturating_mul(p.ways()));
        let text = (ways < MOST_TRIED).then(|| printed(parts));
        match text.filter(|text| text.matches(".print(").count() <= MOST_WAYS) {
            Some(text) => Ok(text),
            None => Err(format!("this can be printed in more than {MOST_WAYS} ways").into()),
        }
    }

    /// What is printed of a term: texts, expressions, and choices of them. Within lists and structures strings have quotes.
    fn printed(
        &mut self,
        of: &AgentSpeakTerm,
        within: bool,
        parts: &mut Vec<PrintedPart>,
    ) -> ClauseResult<()> {
        match &of.kind {
            TermKind::Text(text) if within => parts.push(PrintedPart::Text(format!("\"{text}\""))),
            TermKind::Text(text) => parts.push(PrintedPart::Text(text.clone())),
            TermKind::Literal(l) if !l.is_internal() => {
                parts.push(PrintedPart::Text(format!("{}{}", if l.negated { "~" } else { "" }, l.functor)));
                if !l.args.is_empty() {
                    self.printed_each(["(", ")"], &l.args, parts)?;
                }
            }
            TermKind::List { items, rest: None } => self.printed_each(["[", "]"], items, parts)?,
            TermKind::Any => parts.push(PrintedPart::Text("_".to_owned())),
            TermKind::Var { name, .. } if !self.bound.contains(name) => {
                let message = format!(
                    "`{name}` may have no value here: Jason makes up a name to print, hrdsl prints `_`"
                );
                self.remarks.push((of.span, message));
                parts.push(PrintedPart::Text("_".to_owned()));
            }
            TermKind::Binary { .. } | TermKind::Neg(_) => parts.push(PrintedPart::Value(self.expr(of)?.text)),
            _ => self.printed_value(of, within, parts)?,
        }
        Ok(())
    }

    fn printed_each(
        &mut self,
        [open, close]: [&str; 2],
        items: &[AgentSpeakTerm],
        parts: &mut Vec<PrintedPart>,
    ) -> ClauseResult<()> {
        parts.push(PrintedPart::Text(open.to_owned()));
        for (i, item) in items.iter().enumerate() {
            if i > 0 {
                parts.push(PrintedPart::Text(",".to_owned()));
            }
            self.printed(item, true, parts)?;
        }
        parts.push(PrintedPart::Text(close.to_owned()));
        Ok(())
    }

    fn printed_value(
        &mut self,
        of: &AgentSpeakTerm,
        within: bool,
        parts: &mut Vec<PrintedPart>,
    ) -> ClauseResult<()> {
        let id = self.type_of(of)?;
        let leaves = self.cx.types.leaves(id);
        if leaves.len() > 1 && leaves.iter().all(|l| l.lists > 0) {
            let message = "a list of structures is printed as the lists of their parts";
            self.remarks.push((of.span, message.to_owned()));
        }
        let values = self.values(of, BindingMode::Value)?;
        self.shown(id, &values, within, parts)?;
        if let TermKind::Var { name, .. } = &of.kind
            && let Some(source) = self.answers.get(name)
        {
            let source = source.clone().map_or_else(PrintedPart::Value, PrintedPart::Text);
            parts.extend([
                PrintedPart::Text("[source(".to_owned()),
                source,
                PrintedPart::Text(")]".to_owned()),
            ]);
        }
        Ok(())
    }

    /// What is printed of values of a class.
    fn shown(
        &self,
        id: TyId,
        values: &[String],
        within: bool,
        parts: &mut Vec<PrintedPart>,
    ) -> ClauseResult<()> {
        let types = self.cx.types;
        let text = |text: &str| PrintedPart::Text(text.to_owned());
        match types.get(id) {
            AgentSpeakType::Union(all) => {
                let (mut ways, mut at) = (Vec::new(), 1);
                for (i, own) in all.iter().enumerate() {
                    let count = types.leaves(*own).len();
                    let mut way = Vec::new();
                    self.shown(*own, &values[at..at + count], within, &mut way)?;
                    ways.push((format!("{} == {}", values[0], self.cx.names.tag(types, id, i)), way));
                    at += count;
                }
                parts.push(PrintedPart::Choice(ways));
            }
            AgentSpeakType::Struct(functor, args) => {
                parts.push(PrintedPart::Text(format!("{functor}(")));
                let mut at = 0;
                for (i, arg) in args.iter().enumerate() {
                    if i > 0 {
                        parts.push(text(","));
                    }
                    let count = types.leaves(*arg).len();
                    self.shown(*arg, &values[at..at + count], true, parts)?;
                    at += count;
                }
                parts.push(text(")"));
            }
            AgentSpeakType::Text if within => {
                parts.extend([text("\""), PrintedPart::Value(values[0].clone()), text("\"")]);
            }
            AgentSpeakType::List(_)
                if types.leaves(id).iter().any(|l| types.alternatives(l.of).is_some()) =>
            {
                return Err("a list of values of several types cannot be printed".into());
            }
            AgentSpeakType::List(_)
            | AgentSpeakType::Text
            | AgentSpeakType::Unknown
            | AgentSpeakType::Number { .. }
            | AgentSpeakType::Bool
            | AgentSpeakType::Atoms { .. } => {
                for (i, value) in values.iter().enumerate() {
                    if i > 0 {
                        parts.push(text(","));
                    }
                    parts.push(PrintedPart::Value(value.clone()));
                }
            }
        }
        Ok(())
    }
}

/// In so many ways a line is printed at most, by what its values are.
const MOST_WAYS: usize = 32;
/// So many are tried: the same value may be printed twice.
const MOST_TRIED: usize = 2_000;

/// A part of what is printed.
#[derive(Clone, Debug)]
enum PrintedPart {
    Text(String),
    Value(String),
    /// By conditions, of which one holds.
    Choice(Vec<(String, Vec<PrintedPart>)>),
}

impl PrintedPart {
    /// In how many ways it can be printed.
    fn ways(&self) -> usize {
        match self {
            Self::Text(_) | Self::Value(_) => 1,
            Self::Choice(all) => all
                .iter()
                .map(|(_, parts)| parts.iter().fold(1_usize, |n, p| n.saturating_mul(p.ways())))
                .fold(0_usize, usize::saturating_add),
        }
    }
}

/// The step that prints parts; of several ways, a choice.
fn printed(mut parts: Vec<PrintedPart>) -> String {
    let choice = parts.iter().position(|p| matches!(p, PrintedPart::Choice(_)));
    if let Some(at) = choice
        && let PrintedPart::Choice(ways) = parts.remove(at)
    {
        let last = ways.len() - 1;
        let each = ways.into_iter().enumerate().map(|(i, (condition, way))| {
            let mut all: Vec<PrintedPart> = Vec::new();
            for (k, part) in parts.iter().enumerate() {
                if k == at {
                    all.extend(way.clone());
                }
                // The same value once more is of the same type.
                match part {
                    PrintedPart::Choice(again) if again.get(i).is_some_and(|(c, _)| *c == condition) => {
                        all.extend(again[i].1.clone());
                    }
                    part => all.push(part.clone()),
                }
            }
            if at == parts.len() {
                all.extend(way);
            }
            let text = printed(all);
            if i == last { format!("{{ {text} }}") } else { format!("if {condition} {{ {text} }}") }
        });
        return each.collect::<Vec<_>>().join(" else ");
    }
    // Texts next to each other are one.
    let mut merged: Vec<Result<String, String>> = Vec::new();
    for part in parts {
        let part = match part {
            PrintedPart::Text(text) => Ok(text),
            PrintedPart::Value(value) => Err(value),
            PrintedPart::Choice(_) => continue,
        };
        match (merged.last_mut(), part) {
            (Some(Ok(text)), Ok(more)) => text.push_str(&more),
            (_, part) => merged.push(part),
        }
    }
    let args: Vec<String> = merged.into_iter().map(|p| p.map_or_else(|e| e, |t| quoted(&t))).collect();
    format!(".print({})", args.join(", "))
}
