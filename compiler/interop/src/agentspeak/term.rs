//! What a term is: a literal, an atom, an annotation with a value, a message.

use super::ast::{AgentSpeakLiteral, AgentSpeakTerm, TermKind};

/// Why something cannot be carried over.
pub type OmissionReason = String;

/// The literal that a term is.
pub fn literal(of: &AgentSpeakTerm) -> Result<&AgentSpeakLiteral, OmissionReason> {
    if let TermKind::Literal(literal) = &of.kind {
        Ok(literal)
    } else {
        Err("what this is about is known only when it runs".to_owned())
    }
}

/// `name(value)` of an annotation.
pub fn valued(annotation: &AgentSpeakTerm) -> Option<(&str, &AgentSpeakTerm)> {
    match &annotation.kind {
        TermKind::Literal(l) if !l.is_internal() && !l.negated => match l.args.as_slice() {
            [value] => Some((&l.functor, value)),
            _ => None,
        },
        _ => None,
    }
}

/// The performatives that a scenario has; with `true` those about goals.
pub fn performative(name: &str) -> Option<bool> {
    match name {
        "tell" | "untell" | "askOne" | "askAll" => Some(false),
        "achieve" | "unachieve" => Some(true),
        _ => None,
    }
}

/// The atom that a term is; a string counts as one.
pub fn atom(of: &AgentSpeakTerm) -> Option<&str> {
    match &of.kind {
        TermKind::Literal(l) if l.args.is_empty() && !l.negated => Some(&l.functor),
        TermKind::Text(text) => Some(text),
        _ => None,
    }
}

/// Two atoms, or two strings.
pub fn texts<'a>(left: &'a AgentSpeakTerm, right: &'a AgentSpeakTerm) -> Option<(&'a str, &'a str)> {
    let is_text = |t: &AgentSpeakTerm| matches!(t.kind, TermKind::Text(_));
    if is_text(left) == is_text(right) { Some((atom(left)?, atom(right)?)) } else { None }
}

/// What one or more agents are told.
pub struct AgentSpeakMessage<'a> {
    /// `None`: all others.
    pub to: Option<&'a AgentSpeakTerm>,
    pub performative: &'a str,
    pub content: &'a AgentSpeakTerm,
    /// The answer, the time to wait for it in milliseconds.
    pub rest: &'a [AgentSpeakTerm],
}

impl<'a> AgentSpeakMessage<'a> {
    /// Several literals that are sent as a list, one by one.
    pub fn each(&self) -> Option<&'a [AgentSpeakTerm]> {
        match &self.content.kind {
            TermKind::List { items, rest: None } if self.rest.is_empty() => Some(items),
            _ => None,
        }
    }
}

/// The message that `.send` or `.broadcast` sends.
pub fn message(of: &AgentSpeakLiteral) -> Result<AgentSpeakMessage<'_>, OmissionReason> {
    let parts = match (of.functor.as_str(), of.args.as_slice()) {
        (".send", [to, performative, content, rest @ ..]) => Some((Some(to), performative, content, rest)),
        (".broadcast", [performative, content]) => Some((None, performative, content, [].as_slice())),
        _ => None,
    };
    let Some((to, said, content, rest)) = parts else {
        return Err(format!("`{}` has other arguments", of.functor));
    };
    let Some(name) = atom(said) else {
        return Err("of what sort this message is is known only when it runs".to_owned());
    };
    if performative(name).is_none() {
        return Err(format!("hrdsl has no messages of the sort `{name}`"));
    }
    if !rest.is_empty() && !matches!(name, "askOne" | "askAll") {
        return Err(format!("a message of the sort `{name}` has no answer"));
    }
    Ok(AgentSpeakMessage { to, performative: name, content, rest })
}

/// The exponent of a power that is written as a product.
pub fn small_power(exponent: &AgentSpeakTerm) -> Option<usize> {
    match exponent.kind {
        TermKind::Int(n) => usize::try_from(n).ok().filter(|n| (1..=4).contains(n)),
        _ => None,
    }
}
