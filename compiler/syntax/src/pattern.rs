//! What requirements say about runs: their patterns (Dwyer, Avrunin and Corbett 1999), once for the tree and for all after it.
//!
//! A pattern is over events `E`, conditions `C` and times `T`: calls and expressions of the text in the tree; resolved events,
//! typed expressions and seconds in the Scenario. Who asks something of every pattern asks one of the methods below, so that a
//! new pattern is known to all of them.

use serde::Serialize;

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RequirementPattern<E, C, T> {
    /// `after T: R within D` and `T causes R within D` (they mean the same)
    Causes { trigger: Vec<E>, response: Vec<E>, within: Option<T> },
    /// `T forbids E until U`
    Forbids { trigger: Vec<E>, forbidden: Vec<E>, until: Vec<E> },
    /// `F precedes T`: no T before the first F
    Precedes { first: Vec<E>, then: Vec<E> },
    /// `never E while P`
    NeverWhile { events: Vec<E>, condition: Option<C> },
    /// `globally P`
    Globally(C),
}

/// The answers that a pattern demands.
pub struct DemandedEvents<'p, E> {
    pub trigger: &'p [E],
    pub response: &'p [E],
}

/// The events that a pattern bans.
pub struct BannedEvents<'p, E> {
    pub events: &'p [E],
    /// From these on; `None`: from the beginning.
    pub from: Option<&'p [E]>,
    pub until: &'p [E],
}

impl<E, C, T> RequirementPattern<E, C, T> {
    /// The events without any of which it says nothing about a run; none if it is about the world alone.
    #[must_use]
    pub fn triggers(&self) -> &[E] {
        match self {
            Self::Causes { trigger, .. } | Self::Forbids { trigger, .. } => trigger,
            Self::NeverWhile { events, .. } | Self::Precedes { then: events, .. } => events,
            Self::Globally(_) => &[],
        }
    }

    /// All events that it names.
    pub fn events(&self) -> impl Iterator<Item = &E> {
        let others: [&[E]; 2] = match self {
            Self::Causes { response, .. } => [response, &[]],
            Self::Forbids { forbidden, until, .. } => [forbidden, until],
            Self::Precedes { first, .. } => [first, &[]],
            Self::NeverWhile { .. } | Self::Globally(_) => [&[], &[]],
        };
        self.triggers().iter().chain(others.into_iter().flatten())
    }

    /// What it says about the world.
    #[must_use]
    pub fn condition(&self) -> Option<&C> {
        match self {
            Self::NeverWhile { condition, .. } => condition.as_ref(),
            Self::Globally(condition) => Some(condition),
            Self::Causes { .. } | Self::Forbids { .. } | Self::Precedes { .. } => None,
        }
    }

    #[must_use]
    pub fn time(&self) -> Option<&T> {
        match self {
            Self::Causes { within, .. } => within.as_ref(),
            Self::Forbids { .. } | Self::Precedes { .. } | Self::NeverWhile { .. } | Self::Globally(_) => {
                None
            }
        }
    }

    /// The truth of its condition with which it can never be violated.
    #[must_use]
    pub fn harmless(&self) -> bool {
        matches!(self, Self::Globally(_))
    }

    /// The condition that holds in every run that keeps to it.
    #[must_use]
    pub fn always(&self) -> Option<&C> {
        if let Self::Globally(condition) = self { Some(condition) } else { None }
    }

    #[must_use]
    pub fn demands(&self) -> Option<DemandedEvents<'_, E>> {
        match self {
            Self::Causes { trigger, response, .. } => Some(DemandedEvents { trigger, response }),
            Self::Forbids { .. } | Self::Precedes { .. } | Self::NeverWhile { .. } | Self::Globally(_) => {
                None
            }
        }
    }

    /// What it bans whatever the world is like.
    #[must_use]
    pub fn bans(&self) -> Option<BannedEvents<'_, E>> {
        match self {
            Self::Forbids { trigger, forbidden, until } => {
                Some(BannedEvents { events: forbidden, from: Some(trigger), until })
            }
            Self::NeverWhile { events, condition: None } => {
                Some(BannedEvents { events, from: None, until: &[] })
            }
            Self::Precedes { first, then } => Some(BannedEvents { events: then, from: None, until: first }),
            Self::NeverWhile { .. } | Self::Causes { .. } | Self::Globally(_) => None,
        }
    }

    /// The same over other events, conditions and times. A time that says nothing is none.
    pub fn map<X, F, D, U>(
        &self,
        cx: &mut X,
        events: fn(&mut X, &[E]) -> Vec<F>,
        condition: fn(&mut X, &C) -> D,
        time: fn(&mut X, &T) -> Option<U>,
    ) -> RequirementPattern<F, D, U> {
        match self {
            Self::Causes { trigger, response, within } => RequirementPattern::Causes {
                trigger: events(cx, trigger),
                response: events(cx, response),
                within: within.as_ref().and_then(|t| time(cx, t)),
            },
            Self::Forbids { trigger, forbidden, until } => RequirementPattern::Forbids {
                trigger: events(cx, trigger),
                forbidden: events(cx, forbidden),
                until: events(cx, until),
            },
            Self::Precedes { first, then } => {
                RequirementPattern::Precedes { first: events(cx, first), then: events(cx, then) }
            }
            Self::NeverWhile { events: list, condition: while_true } => RequirementPattern::NeverWhile {
                events: events(cx, list),
                condition: while_true.as_ref().map(|c| condition(cx, c)),
            },
            Self::Globally(always) => RequirementPattern::Globally(condition(cx, always)),
        }
    }
}
