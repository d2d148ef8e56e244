//! Rules: which can be written, and which arguments of a belief with rules must have a value. A fixed point: at first none
//! must; what a clause reads before it has a value, or never gives one, must.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    clause::{
        BindingMode, COMPARE, ClauseContext, ClauseFailure, ClauseFragment, ClauseResult, ClauseTranslator,
        PredicateUsage,
    },
    writer::AgentSpeakTranslator,
};
use crate::agentspeak::{
    ast::{
        AgentSpeakItem, AgentSpeakItemKind, AgentSpeakLiteral, AgentSpeakProgram, AgentSpeakTerm,
        PredicateIndicator, TermKind, has_any, variables,
    },
    system::AgentSpeakAgent,
};

pub type InputArguments = IndexMap<PredicateIndicator, BTreeSet<usize>>;

/// What became of the rules: the text of each, or why it is left out.
pub type TranslatedRules = IndexMap<Span, Result<(String, PredicateUsage), String>>;

/// The rules of a program.
pub fn rules(
    writer: &AgentSpeakTranslator<'_>,
    entry: &AgentSpeakAgent,
    program: &AgentSpeakProgram,
) -> (InputArguments, TranslatedRules) {
    let all: Vec<AgentSpeakClause<'_>> = program.items.iter().filter_map(clause_of).collect();
    let mut done: TranslatedRules = IndexMap::new();
    for (span, ..) in &all {
        if let Some(reason) = writer.inferred.left_out.get(span) {
            done.insert(*span, Err(reason.clone()));
        }
    }
    loop {
        let mut inputs = InputArguments::new();
        let written = fixed_point(writer, entry, &all, &done, &mut inputs);
        let failed: Vec<_> =
            written.iter().filter_map(|(s, w)| Some((*s, w.as_ref().err()?.reason()))).collect();
        if failed.is_empty() {
            done.extend(written.into_iter().filter_map(|(s, w)| Some((s, Ok(w.ok()?)))));
            return (inputs, done);
        }
        done.extend(failed.into_iter().map(|(s, reason)| (s, Err(reason))));
    }
}

/// The place, head and body of a rule.
type AgentSpeakClause<'p> = (Span, &'p AgentSpeakLiteral, Option<&'p AgentSpeakTerm>);

/// A belief with open places holds whatever is there: it is a rule without a body.
fn clause_of(item: &AgentSpeakItem) -> Option<AgentSpeakClause<'_>> {
    match &item.kind {
        AgentSpeakItemKind::Rule { head, body } => Some((item.span, head, Some(body))),
        AgentSpeakItemKind::Belief(head)
            if head.args.iter().any(|a| has_any(a) || !variables(a).is_empty()) =>
        {
            Some((item.span, head, None))
        }
        AgentSpeakItemKind::Belief(_)
        | AgentSpeakItemKind::Goal(_)
        | AgentSpeakItemKind::Plan(_)
        | AgentSpeakItemKind::Skipped(_)
        | AgentSpeakItemKind::Broken(_) => None,
    }
}

type RuleAttempts = Vec<(Span, ClauseResult<(String, PredicateUsage)>)>;

fn fixed_point(
    writer: &AgentSpeakTranslator<'_>,
    entry: &AgentSpeakAgent,
    all: &[AgentSpeakClause<'_>],
    done: &TranslatedRules,
    inputs: &mut InputArguments,
) -> RuleAttempts {
    let wanted = super::wanted::WantedArguments::new();
    loop {
        let before = inputs.clone();
        let mut written = Vec::new();
        for (span, head, body) in all.iter().filter(|(s, ..)| !done.contains_key(s)) {
            let known = inputs.clone();
            let cx = ClauseContext {
                system: writer.system,
                types: &writer.inferred.types,
                left_out: &writer.inferred.left_out,
                names: writer.names,
                inputs: &known,
                wanted: &wanted,
            };
            let mut clause = ClauseTranslator::new(&cx, &entry.name, PredicateUsage::default());
            let needed = inputs.entry(head.key()).or_default();
            let result = rule(&mut clause, head, *body, needed);
            written.push((*span, result.map(|text| (text, clause.used))));
        }
        if *inputs == before {
            return written;
        }
    }
}

/// Writes a rule; what must have a value that was not known to goes into `inputs`.
fn rule(
    clause: &mut ClauseTranslator<'_>,
    head: &AgentSpeakLiteral,
    body: Option<&AgentSpeakTerm>,
    inputs: &mut BTreeSet<usize>,
) -> ClauseResult<String> {
    for (i, arg) in head.args.iter().enumerate() {
        if inputs.contains(&i) {
            clause.bound.extend(variables(arg));
        }
    }
    let body = body.filter(|b| !matches!(b.kind, TermKind::Bool(true)));
    let written = body.map(|b| clause.formula(b)).transpose();
    if let Err(ClauseFailure::Unbound(name)) = &written {
        // Where it is again it is compared with the first.
        inputs.extend(head.args.iter().position(|a| variables(a).contains(name)));
    }
    let mut parts: Vec<ClauseFragment> = written?.into_iter().collect();
    for (i, arg) in head.args.iter().enumerate() {
        if variables(arg).iter().any(|v| !clause.bound.contains(v)) || has_any(arg) {
            inputs.insert(i);
            clause.bound.extend(variables(arg));
        }
    }
    let text = clause.head(head, &mut parts)?;
    clause.asks_nothing_first()?;
    let body =
        if parts.is_empty() { String::new() } else { format!(" when {}", ClauseFragment::all(parts).text) };
    Ok(format!("rule {text}{body}"))
}

impl ClauseTranslator<'_> {
    /// A rule's head: what is open there gets a name, and a variable that is there twice is compared after the body.
    fn head(&mut self, head: &AgentSpeakLiteral, parts: &mut Vec<ClauseFragment>) -> ClauseResult<String> {
        if !head.annotations.is_empty() {
            return Err("the head of a rule has no annotations in hrdsl".into());
        }
        let mut args: Vec<String> = Vec::new();
        let mut seen: Vec<String> = Vec::new();
        for arg in &head.args {
            let again = matches!(&arg.kind, TermKind::Var { name, .. } if seen.contains(name));
            seen.extend(variables(arg));
            for value in self.values(arg, BindingMode::Pattern)? {
                if value == "_" {
                    args.push(self.fresh("Any"));
                } else if again {
                    let same = self.fresh("Same");
                    parts.push(ClauseFragment::new(format!("{same} = {value}"), COMPARE));
                    args.push(same);
                } else {
                    args.push(value);
                }
            }
        }
        let key = head.key();
        let name = self.cx.names.belief(&key);
        self.used.beliefs.insert(key);
        Ok(format!("{}{}", if head.negated { "~" } else { "" }, super::clause::call(&name, &args)))
    }
}
