//! Formulas in metric temporal logic in English: what each says, and what each verdict on it means.

use hrdsl_model::{TypedExpr, TypedOccurrence, TypedTemporal};
use hrdsl_syntax::{TemporalJunction, TemporalKind, TemporalLook, TemporalReach, TemporalWindow};

/// A formula, read out. A verdict that it cannot have is none.
pub(crate) struct FormulaReading {
    pub says: String,
    pub pass: String,
    pub fail: Option<String>,
    pub vacuous: Option<String>,
    pub inconclusive: Option<String>,
}

/// Reads formulas out; how events and conditions are shown is somebody else's.
pub(crate) struct FormulaReader<'a> {
    pub any: &'a dyn Fn(&[TypedOccurrence]) -> String,
    pub condition: &'a dyn Fn(&TypedExpr) -> String,
}

/// What may become of a formula, or of its opposite.
#[derive(Clone, Copy)]
struct FormulaProspects {
    /// It can be violated, whatever comes after.
    fails: bool,
    /// The run can end before it is known.
    open: bool,
    /// It is asked only of moments at which something else holds.
    asked: bool,
}

impl FormulaReader<'_> {
    pub fn read(&self, formula: &TypedTemporal) -> FormulaReading {
        let prospects = prospects(formula, false);
        let atoms = formula.all();
        let reads = atoms.iter().any(|f| match &f.kind {
            TemporalKind::Condition(_) => true,
            TemporalKind::Events(events) => events.iter().any(|e| e.as_edge().is_some()),
            TemporalKind::Constant(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..)
            | TemporalKind::Look { .. }
            | TemporalKind::Reach { .. } => false,
        });
        let unasked = prospects
            .asked
            .then(|| "it is never asked for: what stands before `implies` never holds".to_owned());
        let unseen = reads.then(|| "something that it reads is never measured".to_owned());
        let vacuous: Vec<String> = unasked.into_iter().chain(unseen).collect();
        let (fail, open) = match (prospects.fails, &formula.kind) {
            (false, _) => (None, "the run ends before that has come about"),
            (true, TemporalKind::Look { look: TemporalLook::Always, window: None, of }) => (
                Some(format!("there is a moment of which this is not so: {}", self.says(of))),
                "the run ends before it is known of each moment, and none is violated",
            ),
            (true, _) => (
                Some("it is not so, whatever could still come".to_owned()),
                "the run ends before it is known",
            ),
        };
        FormulaReading {
            says: capitalised(&format!("{}.", self.says(formula))),
            pass: if prospects.open {
                "it holds, whatever could have come after the end".to_owned()
            } else {
                "it holds".to_owned()
            },
            fail,
            vacuous: (!vacuous.is_empty()).then(|| vacuous.join("; or ")),
            inconclusive: prospects.open.then(|| open.to_owned()),
        }
    }

    fn says(&self, formula: &TypedTemporal) -> String {
        match &formula.kind {
            TemporalKind::Constant(truth) => truth.to_string(),
            TemporalKind::Events(events) => format!("{} happens", (self.any)(events)),
            TemporalKind::Condition(condition) => format!("{} holds", (self.condition)(condition)),
            TemporalKind::Not(of) => format!("it is not so that {}", self.part(of)),
            TemporalKind::Junction(junction, parts) => {
                let [a, b] = parts.as_ref();
                let (a, b) = (self.part(a), self.part(b));
                match junction {
                    TemporalJunction::And => format!("{a}, and {b}"),
                    TemporalJunction::Or => format!("{a}, or {b}"),
                    TemporalJunction::Implies => format!("whenever {a}, {b}"),
                }
            }
            TemporalKind::Look { look, window, of } => {
                let of = self.part(of);
                let window = window.as_ref();
                match (look, window) {
                    (TemporalLook::Always, None) => format!("at every moment, {of}"),
                    (TemporalLook::Eventually, None) => format!("at some moment, {of}"),
                    (TemporalLook::Once, None) => format!("at some moment up to then, {of}"),
                    (TemporalLook::Historically, None) => format!("at every moment up to then, {of}"),
                    (TemporalLook::Always | TemporalLook::Historically, Some(window)) => {
                        format!("at every moment {}, {of}", span(window, look.is_ahead()))
                    }
                    (TemporalLook::Eventually | TemporalLook::Once, Some(window)) => {
                        format!("at some moment {}, {of}", span(window, look.is_ahead()))
                    }
                }
            }
            TemporalKind::Reach { reach, window, of } => {
                let [held, reached] = of.as_ref();
                let (held, reached) = (self.part(held), self.part(reached));
                let ahead = *reach == TemporalReach::Until;
                let when =
                    window.as_ref().map(|window| format!(" {}", span(window, ahead))).unwrap_or_default();
                if ahead {
                    format!("at some moment{when}, {reached}, and at every moment before that, {held}")
                } else {
                    format!("at some moment{when}, {reached}, and at every moment after that, {held}")
                }
            }
        }
    }

    /// As a part of something else: what is more than an atom is in parentheses.
    fn part(&self, formula: &TypedTemporal) -> String {
        let says = self.says(formula);
        match &formula.kind {
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_) => says,
            TemporalKind::Junction(..) | TemporalKind::Look { .. } | TemporalKind::Reach { .. } => {
                format!("({says})")
            }
        }
    }
}

fn span(window: &TemporalWindow<f64>, ahead: bool) -> String {
    let TemporalWindow { from, to, .. } = window;
    match (ahead, *from == 0.0, from == to) {
        (true, _, true) => format!("{to} s later"),
        (true, true, false) => format!("in the next {to} s"),
        (true, false, false) => format!("from {from} s to {to} s later"),
        (false, _, true) => format!("{to} s before"),
        (false, true, false) => format!("in the last {to} s"),
        (false, false, false) => format!("from {to} s to {from} s before"),
    }
}

/// As a goal of the run; `opposite`: what may become of its opposite.
fn prospects(formula: &TypedTemporal, opposite: bool) -> FormulaProspects {
    let later = looks_ahead(formula);
    match &formula.kind {
        TemporalKind::Not(of) if is_goal(of) => prospects(of, !opposite),
        TemporalKind::Junction(junction, parts) if is_goal(formula) => {
            let [a, b] = parts.as_ref();
            let a = prospects(a, opposite != (*junction == TemporalJunction::Implies));
            let b = prospects(b, opposite);
            let all_of = (*junction == TemporalJunction::And) != opposite;
            FormulaProspects {
                fails: if all_of { a.fails || b.fails } else { a.fails && b.fails },
                open: a.open || b.open,
                asked: a.asked && b.asked,
            }
        }
        TemporalKind::Look { look, window: None, of } if look.is_ahead() => {
            let always = (*look == TemporalLook::Always) != opposite;
            let implies = matches!(of.kind, TemporalKind::Junction(TemporalJunction::Implies, _));
            FormulaProspects { fails: always, open: !always || later, asked: always && implies && !opposite }
        }
        TemporalKind::Reach { reach: TemporalReach::Until, window: None, .. } => {
            FormulaProspects { fails: true, open: !opposite || later, asked: false }
        }
        TemporalKind::Constant(_)
        | TemporalKind::Events(_)
        | TemporalKind::Condition(_)
        | TemporalKind::Not(_)
        | TemporalKind::Junction(..)
        | TemporalKind::Look { .. }
        | TemporalKind::Reach { .. } => FormulaProspects { fails: true, open: later, asked: false },
    }
}

/// Whether something in it looks ahead as far as the run goes.
fn is_goal(formula: &TypedTemporal) -> bool {
    formula.all().iter().any(|part| part.looks_without_end())
}

/// Whether a window in it looks ahead.
fn looks_ahead(formula: &TypedTemporal) -> bool {
    formula.all().iter().any(|part| {
        let ahead = match &part.kind {
            TemporalKind::Look { look, .. } => look.is_ahead(),
            TemporalKind::Reach { reach, .. } => *reach == TemporalReach::Until,
            TemporalKind::Constant(_)
            | TemporalKind::Events(_)
            | TemporalKind::Condition(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..) => false,
        };
        ahead && part.window().is_some()
    })
}

fn capitalised(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}
