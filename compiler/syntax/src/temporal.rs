//! Formulas in metric temporal logic as requirements: their operators, once for the tree and for all after it.
//!
//! A formula is over events `E`, conditions `C` and times `T`, as a [`RequirementPattern`](crate::RequirementPattern) is. In the tree all its atoms
//! are conditions, whatever their names stand for.

use hrdsl_source::Span;
use serde::Serialize;

use crate::{
    ast::{CallSyntax, ExprSyntax},
    pattern::SentenceMapping,
};

/// A formula where it was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemporalFormula<E, C, T> {
    pub kind: TemporalKind<E, C, T>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemporalKind<E, C, T> {
    Constant(bool),
    /// One of these happens.
    Events(Vec<E>),
    Condition(C),
    Not(Box<TemporalFormula<E, C, T>>),
    Junction(TemporalJunction, Box<[TemporalFormula<E, C, T>; 2]>),
    Look {
        look: TemporalLook,
        #[serde(skip_serializing_if = "Option::is_none")]
        window: Option<TemporalWindow<T>>,
        of: Box<TemporalFormula<E, C, T>>,
    },
    Reach {
        reach: TemporalReach,
        #[serde(skip_serializing_if = "Option::is_none")]
        window: Option<TemporalWindow<T>>,
        /// What holds all the while, and what is reached.
        of: Box<[TemporalFormula<E, C, T>; 2]>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemporalJunction {
    And,
    Or,
    Implies,
}

impl TemporalJunction {
    /// Whether one part alone makes the whole true, or false; and what the first part is then, or must be. The second is what the whole is.
    fn settled(self, truth: bool) -> (bool, bool) {
        match self {
            Self::And => (!truth, truth),
            Self::Or => (truth, truth),
            Self::Implies => (truth, !truth),
        }
    }

    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::And => "and",
            Self::Or => "or",
            Self::Implies => "implies",
        }
    }
}

/// At some moment of a window, or at every one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemporalLook {
    Always,
    Eventually,
    Historically,
    Once,
}

impl TemporalLook {
    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Eventually => "eventually",
            Self::Historically => "historically",
            Self::Once => "once",
        }
    }

    /// Whether it speaks of what is still to come.
    #[must_use]
    pub fn is_ahead(self) -> bool {
        match self {
            Self::Always | Self::Eventually => true,
            Self::Historically | Self::Once => false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemporalReach {
    Until,
    Since,
}

impl TemporalReach {
    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Until => "until",
            Self::Since => "since",
        }
    }
}

/// `[a, b]`: how far from now the operand is looked at, both bounds included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemporalWindow<T> {
    pub from: T,
    pub to: T,
    pub span: Span,
}

/// As it is written.
pub(crate) type PlainFormula = TemporalFormula<CallSyntax, ExprSyntax, ExprSyntax>;

impl<E, C, T> TemporalFormula<E, C, T> {
    pub(crate) fn joined(junction: TemporalJunction, left: Self, right: Self) -> Self {
        let span = left.span.to(right.span);
        Self { kind: TemporalKind::Junction(junction, Box::new([left, right])), span }
    }

    pub(crate) fn reached(
        reach: TemporalReach,
        window: Option<Box<TemporalWindow<T>>>,
        left: Self,
        right: Self,
    ) -> Self {
        let span = left.span.to(right.span);
        let (window, of) = (window.map(|window| *window), Box::new([left, right]));
        Self { kind: TemporalKind::Reach { reach, window, of }, span }
    }

    /// What it is made of, in the order of the text.
    #[must_use]
    pub fn parts(&self) -> &[Self] {
        match &self.kind {
            TemporalKind::Constant(_) | TemporalKind::Events(_) | TemporalKind::Condition(_) => &[],
            TemporalKind::Not(of) | TemporalKind::Look { of, .. } => std::slice::from_ref(of),
            TemporalKind::Junction(_, of) | TemporalKind::Reach { of, .. } => of.as_slice(),
        }
    }

    /// The window of its outermost operator.
    #[must_use]
    pub fn window(&self) -> Option<&TemporalWindow<T>> {
        match &self.kind {
            TemporalKind::Look { window, .. } | TemporalKind::Reach { window, .. } => window.as_ref(),
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..) => None,
        }
    }

    /// It and all that it is made of, outermost first.
    #[must_use]
    pub fn all(&self) -> Vec<&Self> {
        let mut all = vec![self];
        let mut next = 0;
        while let Some(formula) = all.get(next) {
            all.extend(formula.parts());
            next += 1;
        }
        all
    }

    /// Whether its outermost operator looks ahead as far as the run goes.
    #[must_use]
    pub fn looks_without_end(&self) -> bool {
        match &self.kind {
            TemporalKind::Look { look, window: None, .. } => look.is_ahead(),
            TemporalKind::Reach { reach: TemporalReach::Until, window: None, .. } => true,
            TemporalKind::Look { .. }
            | TemporalKind::Reach { .. }
            | TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..) => false,
        }
    }

    /// The events each of which alone meets it each time that it is asked: those of Q, in `always (P implies eventually[a, b] Q)`, with `once`, as what
    /// `until` and `since` reach, and on either side of `or`; the same without the `always`.
    #[must_use]
    pub fn met_by(&self) -> Vec<&E> {
        let mut events = Vec::new();
        self.of_the_run(TemporalLook::Always).unwrap_or(self).add_met_by(true, &mut events);
        events
    }

    /// Adds the events that alone make it true, or false.
    fn add_met_by<'a>(&'a self, truth: bool, out: &mut Vec<&'a E>) {
        match &self.kind {
            TemporalKind::Events(events) if truth => out.extend(events),
            TemporalKind::Events(_) | TemporalKind::Constant(_) | TemporalKind::Condition(_) => {}
            TemporalKind::Not(of) => of.add_met_by(!truth, out),
            TemporalKind::Junction(junction, parts) => {
                let [a, b] = parts.as_ref();
                let (either, first) = junction.settled(truth);
                if either {
                    a.add_met_by(first, out);
                    b.add_met_by(truth, out);
                }
            }
            TemporalKind::Look { look, of, .. } => {
                let some_moment = matches!(look, TemporalLook::Eventually | TemporalLook::Once);
                if some_moment == truth {
                    of.add_met_by(truth, out);
                }
            }
            TemporalKind::Reach { of, .. } if truth => of[1].add_met_by(truth, out),
            TemporalKind::Reach { .. } => {}
        }
    }

    /// The events whose absence alone meets it each time that it is asked, whatever asks: those of Q in `always (P implies not Q)`, under any
    /// operators.
    #[must_use]
    pub fn kept_by_silence_of(&self) -> Vec<&E> {
        let asked = self.of_the_run(TemporalLook::Always).unwrap_or(self);
        if let TemporalKind::Junction(TemporalJunction::Implies, parts) = &asked.kind {
            parts[1].silenced(true).unwrap_or_default()
        } else {
            Vec::new()
        }
    }

    /// The events without which it is true, or false, at each moment, whatever else happens. `None`: there are none such.
    fn silenced(&self, truth: bool) -> Option<Vec<&E>> {
        match &self.kind {
            TemporalKind::Events(events) => (!truth).then(|| events.iter().collect()),
            TemporalKind::Constant(_) | TemporalKind::Condition(_) => None,
            TemporalKind::Not(of) => of.silenced(!truth),
            TemporalKind::Junction(junction, parts) => {
                let [a, b] = parts.as_ref();
                let (either, first) = junction.settled(truth);
                let (a, b) = (a.silenced(first), b.silenced(truth));
                if either { a.or(b) } else { a.zip(b).map(|(a, b)| [a, b].concat()) }
            }
            TemporalKind::Look { of, .. } => of.silenced(truth),
            TemporalKind::Reach { of, .. } => {
                if truth {
                    None
                } else {
                    of[1].silenced(false)
                }
            }
        }
    }

    /// What is asked of the run as a whole, and without an end: of every moment, or of some moment.
    pub(crate) fn of_the_run(&self, look: TemporalLook) -> Option<&Self> {
        match &self.kind {
            TemporalKind::Look { look: is, window: None, of } if *is == look => Some(of),
            TemporalKind::Look { .. }
            | TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..)
            | TemporalKind::Reach { .. } => None,
        }
    }

    pub(crate) fn as_condition(&self) -> Option<&C> {
        if let TemporalKind::Condition(condition) = &self.kind { Some(condition) } else { None }
    }

    /// The events that never happen: those of `always not E`.
    pub(crate) fn banned(&self) -> Option<&[E]> {
        let TemporalKind::Not(of) = &self.of_the_run(TemporalLook::Always)?.kind else { return None };
        if let TemporalKind::Events(events) = &of.kind { Some(events) } else { None }
    }

    /// The events that ask, and those that have to come in time: those of `always (P implies eventually[a, b] Q)`.
    pub(crate) fn demanded(&self) -> Option<[&[E]; 2]> {
        let body = self.of_the_run(TemporalLook::Always)?;
        let TemporalKind::Junction(TemporalJunction::Implies, parts) = &body.kind else { return None };
        let TemporalKind::Look { look: TemporalLook::Eventually, of, .. } = &parts[1].kind else {
            return None;
        };
        let (TemporalKind::Events(asked), TemporalKind::Events(wanted)) = (&parts[0].kind, &of.kind) else {
            return None;
        };
        Some([asked, wanted])
    }

    /// The events without any of which it is never asked: those of P, in `always (P implies Q)`.
    pub(crate) fn triggers(&self) -> &[E] {
        let TemporalKind::Look { look: TemporalLook::Always, window: None, of } = &self.kind else {
            return &[];
        };
        let TemporalKind::Junction(TemporalJunction::Implies, parts) = &of.kind else { return &[] };
        let [asked, _] = parts.as_ref();
        if let TemporalKind::Events(events) = &asked.kind { events } else { &[] }
    }

    pub(crate) fn map<X, N, F, D, U, M>(
        &self,
        cx: &mut X,
        to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
    ) -> TemporalFormula<F, D, U> {
        let kind = match &self.kind {
            TemporalKind::Constant(truth) => TemporalKind::Constant(*truth),
            TemporalKind::Events(events) => TemporalKind::Events((to.events)(cx, events)),
            TemporalKind::Condition(condition) => TemporalKind::Condition((to.condition)(cx, condition)),
            TemporalKind::Not(of) => TemporalKind::Not(Box::new(of.map(cx, to))),
            TemporalKind::Junction(junction, of) => TemporalKind::Junction(*junction, pair(of, cx, to)),
            TemporalKind::Look { look, window, of } => TemporalKind::Look {
                look: *look,
                window: window.as_ref().and_then(|w| w.map(cx, to)),
                of: Box::new(of.map(cx, to)),
            },
            TemporalKind::Reach { reach, window, of } => TemporalKind::Reach {
                reach: *reach,
                window: window.as_ref().and_then(|w| w.map(cx, to)),
                of: pair(of, cx, to),
            },
        };
        TemporalFormula { kind, span: self.span }
    }
}

impl<T> TemporalWindow<T> {
    fn map<X, E, C, N, F, D, U, M>(
        &self,
        cx: &mut X,
        to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
    ) -> Option<TemporalWindow<U>> {
        let (from, until) = ((to.bound)(cx, &self.from), (to.bound)(cx, &self.to));
        Some(TemporalWindow { from: from?, to: until?, span: self.span })
    }
}

fn pair<X, E, C, T, N, F, D, U, M>(
    of: &[TemporalFormula<E, C, T>; 2],
    cx: &mut X,
    to: &SentenceMapping<X, E, C, T, N, F, D, U, M>,
) -> Box<[TemporalFormula<F, D, U>; 2]> {
    let [left, right] = of;
    let left = left.map(cx, to);
    Box::new([left, right.map(cx, to)])
}
