//! What requirements say about runs: their patterns (Dwyer, Avrunin and Corbett 1999), once for the tree and for all after it.
//!
//! A pattern is over events `E`, conditions `C`, times `T` and numbers `N`: calls and expressions of the text in the tree;
//! resolved events, typed expressions, seconds and whole numbers in the Scenario. With its scope it is a
//! [`RequirementSentence`](crate::RequirementSentence), and who asks something of every pattern asks a method of that.

use serde::Serialize;

use crate::{
    ast::{CallSyntax, ExprSyntax},
    temporal::{TemporalFormula, TemporalKind},
};

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RequirementPattern<E, C, T, N> {
    /// `after T: R within D` and `T causes R not before D within D` (they mean the same)
    Causes {
        trigger: Vec<E>,
        response: Vec<E>,
        #[serde(skip_serializing_if = "Option::is_none")]
        not_before: Option<T>,
        within: Option<T>,
    },
    /// `T forbids E until U`
    Forbids { trigger: Vec<E>, forbidden: Vec<E>, until: Vec<E> },
    /// `F precedes T not before D`, `F precedes T within D`: no T before the first F, nor sooner, nor later after it
    Precedes {
        first: Vec<E>,
        then: Vec<E>,
        #[serde(skip_serializing_if = "Option::is_none")]
        not_before: Option<T>,
        #[serde(skip_serializing_if = "Option::is_none")]
        within: Option<T>,
    },
    /// `never E while P`
    NeverWhile { events: Vec<E>, condition: Option<C> },
    /// `globally P`, `always P`
    Globally(C),
    /// `eventually E within D`, `eventually P within D`. In the tree it is a condition, whatever its names stand for.
    Eventually { events: Vec<E>, condition: Option<C>, within: Option<T> },
    /// `at most N E`. `None`: the number is not known.
    Counts { events: Vec<E>, bound: CountBound, count: Option<N> },
    /// `whenever P for at least D`. `None`: the time is not known.
    Lasts { condition: C, bound: LastingBound, time: Option<T> },
    /// `formula F`. In the tree its events are conditions, whatever its names stand for.
    Formula(TemporalFormula<E, C, T>),
}

/// As it is written, without its scope.
pub(crate) type PlainPattern = RequirementPattern<CallSyntax, ExprSyntax, ExprSyntax, ExprSyntax>;

/// How an event's number is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CountBound {
    AtLeast,
    Exactly,
    AtMost,
}

/// How the time for which a condition holds is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LastingBound {
    AtLeast,
    AtMost,
}

/// How the parts of a sentence are translated. A time or a number that says nothing is none.
pub struct SentenceMapping<X, E, C, T, N, F, D, U, M> {
    pub events: fn(&mut X, &[E]) -> Vec<F>,
    pub condition: fn(&mut X, &C) -> D,
    pub time: fn(&mut X, &T) -> Option<U>,
    /// That of a window, which may be zero.
    pub bound: fn(&mut X, &T) -> Option<U>,
    pub count: fn(&mut X, &N, CountBound) -> Option<M>,
}

impl<E, C, T, N> RequirementPattern<E, C, T, N> {
    /// The lists of events that it names, in the order of the text.
    pub(crate) fn lists(&self) -> Vec<&[E]> {
        match self {
            Self::Causes { trigger, response, .. } => vec![trigger, response],
            Self::Forbids { trigger, forbidden, until } => vec![trigger, forbidden, until],
            Self::Precedes { first, then, .. } => vec![first, then],
            Self::NeverWhile { events, .. }
            | Self::Eventually { events, .. }
            | Self::Counts { events, .. } => vec![events],
            Self::Globally(_) | Self::Lasts { .. } => Vec::new(),
            Self::Formula(formula) => {
                let parts = formula.all().into_iter();
                parts
                    .filter_map(
                        |f| if let TemporalKind::Events(e) = &f.kind { Some(e.as_slice()) } else { None },
                    )
                    .collect()
            }
        }
    }

    /// The events without any of which it says nothing about a run; none if it speaks without them, too.
    pub(crate) fn triggers(&self) -> &[E] {
        match self {
            Self::Causes { trigger, .. } | Self::Forbids { trigger, .. } => trigger,
            Self::NeverWhile { events, .. }
            | Self::Precedes { then: events, .. }
            | Self::Counts { events, bound: CountBound::AtMost, .. } => events,
            Self::Globally(_)
            | Self::Eventually { .. }
            | Self::Counts { bound: CountBound::AtLeast | CountBound::Exactly, .. }
            | Self::Lasts { .. } => &[],
            Self::Formula(formula) => formula.triggers(),
        }
    }

    /// What it says about the world, in one condition.
    #[must_use]
    pub fn condition(&self) -> Option<&C> {
        match self {
            Self::NeverWhile { condition, .. } | Self::Eventually { condition, .. } => condition.as_ref(),
            Self::Globally(condition) | Self::Lasts { condition, .. } => Some(condition),
            Self::Causes { .. }
            | Self::Forbids { .. }
            | Self::Precedes { .. }
            | Self::Counts { .. }
            | Self::Formula(_) => None,
        }
    }

    /// Its formula, if it is one, and all that that is made of.
    fn formulas(&self) -> Vec<&TemporalFormula<E, C, T>> {
        if let Self::Formula(formula) = self { formula.all() } else { Vec::new() }
    }

    /// All that it says about the world.
    pub(crate) fn conditions(&self) -> impl Iterator<Item = &C> {
        let formulas = self.formulas().into_iter();
        let atoms =
            formulas.filter_map(|f| if let TemporalKind::Condition(c) = &f.kind { Some(c) } else { None });
        self.condition().into_iter().chain(atoms)
    }

    pub(crate) fn times(&self) -> impl Iterator<Item = &T> {
        let times: [Option<&T>; 2] = match self {
            Self::Causes { not_before, within, .. } | Self::Precedes { not_before, within, .. } => {
                [not_before.as_ref(), within.as_ref()]
            }
            Self::Eventually { within: time, .. } | Self::Lasts { time, .. } => [time.as_ref(), None],
            Self::Forbids { .. }
            | Self::NeverWhile { .. }
            | Self::Globally(_)
            | Self::Counts { .. }
            | Self::Formula(_) => [None, None],
        };
        let windows = self.formulas().into_iter().filter_map(TemporalFormula::window);
        times.into_iter().flatten().chain(windows.flat_map(|w| [&w.from, &w.to]))
    }

    pub(crate) fn count(&self) -> Option<&N> {
        if let Self::Counts { count, .. } = self { count.as_ref() } else { None }
    }

    pub(crate) fn map<X, F, D, U, M>(
        &self,
        cx: &mut X,
        to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
    ) -> RequirementPattern<F, D, U, M> {
        use RequirementPattern as To;
        let time = |cx: &mut X, t: &Option<T>| t.as_ref().and_then(|t| (to.time)(cx, t));
        let maybe = |cx: &mut X, c: &Option<C>| c.as_ref().map(|c| (to.condition)(cx, c));
        match self {
            Self::Causes { trigger, response, not_before, within } => To::Causes {
                trigger: (to.events)(cx, trigger),
                response: (to.events)(cx, response),
                not_before: time(cx, not_before),
                within: time(cx, within),
            },
            Self::Forbids { trigger, forbidden, until } => To::Forbids {
                trigger: (to.events)(cx, trigger),
                forbidden: (to.events)(cx, forbidden),
                until: (to.events)(cx, until),
            },
            Self::Precedes { first, then, not_before, within } => To::Precedes {
                first: (to.events)(cx, first),
                then: (to.events)(cx, then),
                not_before: time(cx, not_before),
                within: time(cx, within),
            },
            Self::NeverWhile { events, condition } => {
                To::NeverWhile { events: (to.events)(cx, events), condition: maybe(cx, condition) }
            }
            Self::Globally(always) => To::Globally((to.condition)(cx, always)),
            Self::Eventually { events, condition, within } => To::Eventually {
                events: (to.events)(cx, events),
                condition: maybe(cx, condition),
                within: time(cx, within),
            },
            Self::Counts { events, bound, count } => To::Counts {
                events: (to.events)(cx, events),
                bound: *bound,
                count: count.as_ref().and_then(|n| (to.count)(cx, n, *bound)),
            },
            Self::Lasts { condition, bound, time: lasts } => {
                To::Lasts { condition: (to.condition)(cx, condition), bound: *bound, time: time(cx, lasts) }
            }
            Self::Formula(formula) => To::Formula(formula.map(cx, to)),
        }
    }
}
