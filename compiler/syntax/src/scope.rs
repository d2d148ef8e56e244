//! The part of a run that a requirement is about: its scope, and the sentence that scope and pattern make.

use serde::Serialize;

use crate::{
    pattern::{CountBound, RequirementPattern, SentenceMapping},
    temporal::TemporalLook,
};

/// When a requirement's pattern is to hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RequirementScope<E, C> {
    /// In the whole run.
    #[default]
    Whole,
    /// `before E`: up to the first E, if there is one.
    Before(Vec<E>),
    /// `after E`: from the first E on.
    After(Vec<E>),
    /// `between E and E`: from one to the other, if that comes.
    Between(Vec<E>, Vec<E>),
    /// `after E until E`: the same, also if it never comes.
    AfterUntil(Vec<E>, Vec<E>),
    /// `while P`: as long as P holds.
    While(C),
}

impl<E, C> RequirementScope<E, C> {
    pub fn is_whole(&self) -> bool {
        matches!(self, Self::Whole)
    }

    /// What has to happen for there to be such a part of a run, in order.
    fn lists(&self) -> Vec<&[E]> {
        match self {
            Self::Whole | Self::While(_) => Vec::new(),
            Self::Before(events) | Self::After(events) => vec![events],
            Self::Between(from, to) | Self::AfterUntil(from, to) => vec![from, to],
        }
    }

    #[must_use]
    pub fn condition(&self) -> Option<&C> {
        if let Self::While(condition) = self { Some(condition) } else { None }
    }

    fn map<X, T, N, F, D, U, M>(
        &self,
        cx: &mut X,
        to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
    ) -> RequirementScope<F, D> {
        use RequirementScope as To;
        match self {
            Self::Whole => To::Whole,
            Self::Before(events) => To::Before((to.events)(cx, events)),
            Self::After(events) => To::After((to.events)(cx, events)),
            Self::Between(from, until) => To::Between((to.events)(cx, from), (to.events)(cx, until)),
            Self::AfterUntil(from, until) => To::AfterUntil((to.events)(cx, from), (to.events)(cx, until)),
            Self::While(condition) => To::While((to.condition)(cx, condition)),
        }
    }
}

/// A pattern in its scope.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequirementSentence<E, C, T, N> {
    #[serde(flatten)]
    pub pattern: RequirementPattern<E, C, T, N>,
    #[serde(skip_serializing_if = "RequirementScope::is_whole")]
    pub scope: RequirementScope<E, C>,
}

/// The answers that a sentence demands.
pub struct DemandedEvents<'p, E> {
    pub trigger: &'p [E],
    pub response: &'p [E],
}

/// The events that a sentence bans in its scope.
pub struct BannedEvents<'p, E> {
    pub events: &'p [E],
    /// From these on; `None`: from the beginning.
    pub from: Option<&'p [E]>,
    pub until: &'p [E],
}

/// How often events have to happen in a scope, at the least or at the most.
pub struct DemandedCount<'p, E, N> {
    pub events: &'p [E],
    /// `None`: once at the least, or never.
    pub count: Option<&'p N>,
}

impl<E, C, T, N> RequirementSentence<E, C, T, N> {
    /// All events that it names.
    pub fn events(&self) -> impl Iterator<Item = &E> {
        self.pattern.lists().into_iter().chain(self.scope.lists()).flatten()
    }

    /// Lists of events: without any of each it says nothing about a run.
    #[must_use]
    pub fn needs(&self) -> Vec<&[E]> {
        let scope = match &self.scope {
            RequirementScope::Whole | RequirementScope::While(_) => Vec::new(),
            RequirementScope::Before(events) | RequirementScope::After(events) => vec![events.as_slice()],
            RequirementScope::Between(from, to) => vec![from.as_slice(), to],
            RequirementScope::AfterUntil(from, _) => vec![from.as_slice()],
        };
        let triggers = if self.scope_triggers() { &[] } else { self.pattern.triggers() };
        std::iter::once(triggers).chain(scope).filter(|list| !list.is_empty()).collect()
    }

    /// Whether it says something about each part of a run that its scope is, whatever happens there.
    #[must_use]
    pub fn scope_triggers(&self) -> bool {
        let bans = matches!(
            self.pattern,
            RequirementPattern::NeverWhile { condition: None, .. }
                | RequirementPattern::Counts { bound: CountBound::AtMost, .. }
        );
        bans && !self.scope.is_whole()
    }

    /// What it says about the world.
    pub fn conditions(&self) -> impl Iterator<Item = &C> {
        self.pattern.conditions().chain(self.scope.condition())
    }

    pub fn times(&self) -> impl Iterator<Item = &T> {
        self.pattern.times()
    }

    #[must_use]
    pub fn count(&self) -> Option<&N> {
        self.pattern.count()
    }

    /// Whether it can never be violated if its pattern's condition is always true, or never.
    #[must_use]
    pub fn is_harmless(&self, truth: bool) -> bool {
        match self.pattern {
            RequirementPattern::Globally(_) => truth,
            RequirementPattern::NeverWhile { .. } => !truth,
            // It neither becomes true nor ceases to be.
            RequirementPattern::Lasts { bound: crate::LastingBound::AtLeast, .. } => true,
            RequirementPattern::Lasts { bound: crate::LastingBound::AtMost, .. } => !truth,
            // A scope may end before anything is measured.
            RequirementPattern::Eventually { .. } => truth && self.scope.is_whole(),
            RequirementPattern::Causes { .. }
            | RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Formula(_) => false,
        }
    }

    /// The condition that holds in every run that keeps to it.
    #[must_use]
    pub fn always(&self) -> Option<&C> {
        match &self.pattern {
            RequirementPattern::Globally(condition) if self.scope.is_whole() => Some(condition),
            RequirementPattern::Formula(formula) => formula.of_the_run(TemporalLook::Always)?.as_condition(),
            RequirementPattern::Globally(_)
            | RequirementPattern::Causes { .. }
            | RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Eventually { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Lasts { .. } => None,
        }
    }

    /// The condition that holds at least once in its scope, whatever is decided later.
    #[must_use]
    pub fn sometime(&self) -> Option<&C> {
        match &self.pattern {
            RequirementPattern::Eventually { condition, .. } => condition.as_ref(),
            RequirementPattern::Formula(formula) => {
                formula.of_the_run(TemporalLook::Eventually)?.as_condition()
            }
            RequirementPattern::Causes { .. }
            | RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Globally(_)
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Lasts { .. } => None,
        }
    }

    #[must_use]
    pub fn demands(&self) -> Option<DemandedEvents<'_, E>> {
        match &self.pattern {
            RequirementPattern::Causes { trigger, response, .. } => {
                Some(DemandedEvents { trigger, response })
            }
            RequirementPattern::Formula(formula) => {
                let [trigger, response] = formula.demanded()?;
                Some(DemandedEvents { trigger, response })
            }
            RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Globally(_)
            | RequirementPattern::Eventually { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Lasts { .. } => None,
        }
    }

    /// What it bans in its scope whatever the world is like.
    #[must_use]
    pub fn bans(&self) -> Option<BannedEvents<'_, E>> {
        match &self.pattern {
            RequirementPattern::Formula(formula) => {
                Some(BannedEvents { events: formula.banned()?, from: None, until: &[] })
            }
            RequirementPattern::Forbids { trigger, forbidden, until } => {
                Some(BannedEvents { events: forbidden, from: Some(trigger), until })
            }
            RequirementPattern::NeverWhile { events, condition: None } => {
                Some(BannedEvents { events, from: None, until: &[] })
            }
            RequirementPattern::Precedes { first, then, .. } => {
                Some(BannedEvents { events: then, from: None, until: first })
            }
            RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Causes { .. }
            | RequirementPattern::Globally(_)
            | RequirementPattern::Eventually { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Lasts { .. } => None,
        }
    }

    /// The events that have to happen so often in its scope.
    #[must_use]
    pub fn at_least(&self) -> Option<DemandedCount<'_, E, N>> {
        match &self.pattern {
            RequirementPattern::Eventually { events, .. } if !events.is_empty() => {
                Some(DemandedCount { events, count: None })
            }
            RequirementPattern::Counts {
                events,
                bound: CountBound::AtLeast | CountBound::Exactly,
                count,
            } => Some(DemandedCount { events, count: Some(count.as_ref()?) }),
            RequirementPattern::Eventually { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Causes { .. }
            | RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Globally(_)
            | RequirementPattern::Lasts { .. }
            | RequirementPattern::Formula(_) => None,
        }
    }

    /// The events that must not happen more often in its scope.
    #[must_use]
    pub fn at_most(&self) -> Option<DemandedCount<'_, E, N>> {
        match &self.pattern {
            RequirementPattern::NeverWhile { events, condition: None } => {
                Some(DemandedCount { events, count: None })
            }
            RequirementPattern::Counts { events, bound: CountBound::AtMost | CountBound::Exactly, count } => {
                Some(DemandedCount { events, count: Some(count.as_ref()?) })
            }
            RequirementPattern::NeverWhile { .. }
            | RequirementPattern::Counts { .. }
            | RequirementPattern::Eventually { .. }
            | RequirementPattern::Causes { .. }
            | RequirementPattern::Forbids { .. }
            | RequirementPattern::Precedes { .. }
            | RequirementPattern::Globally(_)
            | RequirementPattern::Lasts { .. }
            | RequirementPattern::Formula(_) => None,
        }
    }

    /// The same over other events, conditions, times and numbers.
    pub fn map<X, F, D, U, M>(
        &self,
        cx: &mut X,
        to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
    ) -> RequirementSentence<F, D, U, M> {
        RequirementSentence { pattern: self.pattern.map(cx, to), scope: self.scope.map(cx, to) }
    }
}
