//! Conditions of a moment: over what holds at it, what the automaton remembers, and its clocks.

use super::data::GuardQuestion;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum MomentCondition {
    Constant(bool),
    Asked(GuardQuestion),
    /// What is remembered of the moments before.
    Memory(usize),
    Not(Box<MomentCondition>),
    All(Vec<MomentCondition>),
    Any(Vec<MomentCondition>),
}

pub(super) const TRUE: MomentCondition = MomentCondition::Constant(true);
pub(super) const FALSE: MomentCondition = MomentCondition::Constant(false);

pub(super) fn not(of: MomentCondition) -> MomentCondition {
    match of {
        MomentCondition::Constant(truth) => MomentCondition::Constant(!truth),
        MomentCondition::Not(inner) => *inner,
        other => MomentCondition::Not(Box::new(other)),
    }
}

pub(super) fn all(parts: impl IntoIterator<Item = MomentCondition>) -> MomentCondition {
    joined(parts, true)
}

pub(super) fn any(parts: impl IntoIterator<Item = MomentCondition>) -> MomentCondition {
    joined(parts, false)
}

/// `neutral` parts are left out, and one of the opposite decides.
fn joined(parts: impl IntoIterator<Item = MomentCondition>, neutral: bool) -> MomentCondition {
    let mut kept: Vec<MomentCondition> = Vec::new();
    for part in parts {
        match part {
            MomentCondition::Constant(truth) if truth == neutral => {}
            MomentCondition::Constant(truth) => return MomentCondition::Constant(truth),
            part if kept.contains(&part) => {}
            part => kept.push(part),
        }
    }
    match kept.len() {
        0 => MomentCondition::Constant(neutral),
        1 => kept.swap_remove(0),
        _ if neutral => MomentCondition::All(kept),
        _ => MomentCondition::Any(kept),
    }
}

impl MomentCondition {
    pub fn letter(letter: usize) -> Self {
        Self::Asked(GuardQuestion::Letter(letter))
    }

    pub fn at_least(clock: usize, bound: i64) -> Self {
        if bound <= 0 { TRUE } else { Self::Asked(GuardQuestion::AtLeast { clock, bound }) }
    }

    pub fn at_most(clock: usize, bound: i64) -> Self {
        Self::Asked(GuardQuestion::AtMost { clock, bound })
    }

    /// With what is remembered known.
    pub fn remembering(&self, memory: &[bool]) -> Self {
        self.with(&|leaf| match leaf {
            Self::Memory(bit) => memory.get(*bit).map(|truth| Self::Constant(*truth)),
            _ => None,
        })
    }

    /// With the answer to a question known.
    pub fn answered(&self, question: GuardQuestion, answer: bool) -> Self {
        self.with(&|leaf| match leaf {
            Self::Asked(of) if *of == question => Some(Self::Constant(answer)),
            _ => None,
        })
    }

    fn with(&self, known: &dyn Fn(&Self) -> Option<Self>) -> Self {
        match self {
            Self::Constant(_) | Self::Asked(_) | Self::Memory(_) => {
                known(self).unwrap_or_else(|| self.clone())
            }
            Self::Not(of) => not(of.with(known)),
            Self::All(parts) => all(parts.iter().map(|part| part.with(known))),
            Self::Any(parts) => any(parts.iter().map(|part| part.with(known))),
        }
    }

    /// The first question that it asks, in the order in which it is written.
    pub fn question(&self) -> Option<GuardQuestion> {
        match self {
            Self::Constant(_) | Self::Memory(_) => None,
            Self::Asked(question) => Some(*question),
            Self::Not(of) => of.question(),
            Self::All(parts) | Self::Any(parts) => parts.iter().find_map(Self::question),
        }
    }

    /// Its truth, if nothing is left to be asked.
    pub fn truth(&self) -> Option<bool> {
        match self {
            Self::Constant(truth) => Some(*truth),
            Self::Asked(_) | Self::Memory(_) | Self::Not(_) | Self::All(_) | Self::Any(_) => None,
        }
    }
}
