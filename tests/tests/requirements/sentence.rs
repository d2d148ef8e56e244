//! Sentences: requirements as people write them, and as the pages speak of them.

use std::fmt;

use hrdsl_ir::{Nanos, value::SECOND};
use hrdsl_monitor::MonitorOutcome;

use crate::dice::Dice;

/// A condition: `p`, `q`, `not p`, `not q`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cond {
    pub signal: usize,
    pub holds: bool,
}

/// What stands for an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Atom {
    Event(u16),
    Edge { rising: bool, of: Cond },
}

pub(crate) type Atoms = Vec<Atom>;

#[derive(Clone, Debug)]
pub(crate) enum Pattern {
    Causes(Atoms, Atoms, Option<Nanos>, Option<Nanos>),
    Forbids(Atoms, Atoms, Atoms),
    Precedes(Atoms, Atoms, Option<Nanos>, Option<Nanos>),
    Never(Atoms, Option<Cond>),
    Always(Cond),
    Eventually(Atoms, Option<Nanos>),
    EventuallyHolds(Cond, Option<Nanos>),
    AtMost(usize, Atoms),
    AtLeast(usize, Atoms),
    Exactly(usize, Atoms),
    LastsAtLeast(Cond, Nanos),
    LastsAtMost(Cond, Nanos),
}

#[derive(Clone, Debug)]
pub(crate) enum Scope {
    Whole,
    Before(Atoms),
    After(Atoms),
    Between(Atoms, Atoms),
    AfterUntil(Atoms, Atoms),
    While(Cond),
}

#[derive(Clone, Debug)]
pub(crate) struct Sentence {
    pub pattern: Pattern,
    pub scope: Scope,
}

fn cond(dice: &mut Dice) -> Cond {
    Cond { signal: dice.below(2), holds: dice.below(3) > 0 }
}

fn atom(dice: &mut Dice) -> Atom {
    if dice.below(4) == 0 {
        Atom::Edge { rising: dice.below(2) == 0, of: cond(dice) }
    } else {
        Atom::Event(dice.below(3) as u16)
    }
}

fn atoms(dice: &mut Dice) -> Atoms {
    let more = dice.below(4) == 0;
    (0..1 + usize::from(more)).map(|_| atom(dice)).collect()
}

fn time(dice: &mut Dice) -> Nanos {
    dice.pick(&[SECOND / 2, SECOND, SECOND, 2 * SECOND, 3 * SECOND])
}

fn maybe(dice: &mut Dice) -> Option<Nanos> {
    (dice.below(2) == 0).then(|| time(dice))
}

impl Sentence {
    /// The n-th: each pattern comes in each scope.
    pub fn random(dice: &mut Dice, n: usize) -> Self {
        let pattern = match n % 12 {
            0 => {
                let (early, late) = (maybe(dice), maybe(dice));
                let early = early.filter(|e| late.is_none_or(|l| *e <= l));
                Pattern::Causes(atoms(dice), atoms(dice), early, late)
            }
            1 => Pattern::Forbids(atoms(dice), atoms(dice), atoms(dice)),
            2 => {
                let early = maybe(dice);
                let late = maybe(dice).filter(|_| early.is_none());
                Pattern::Precedes(atoms(dice), atoms(dice), early, late)
            }
            3 => Pattern::Never(atoms(dice), (dice.below(2) == 0).then(|| cond(dice))),
            4 => Pattern::Always(cond(dice)),
            5 => Pattern::Eventually(atoms(dice), maybe(dice)),
            6 => Pattern::EventuallyHolds(cond(dice), maybe(dice)),
            7 => Pattern::AtMost(dice.below(3), atoms(dice)),
            8 => Pattern::AtLeast(1 + dice.below(3), atoms(dice)),
            9 => Pattern::Exactly(1 + dice.below(2), atoms(dice)),
            10 => Pattern::LastsAtLeast(cond(dice), time(dice)),
            _ => Pattern::LastsAtMost(cond(dice), time(dice)),
        };
        let scope = match n / 12 % 6 {
            0 => Scope::Whole,
            1 => Scope::Before(atoms(dice)),
            2 => Scope::After(atoms(dice)),
            3 => Scope::Between(atoms(dice), atoms(dice)),
            4 => Scope::AfterUntil(atoms(dice), atoms(dice)),
            // `never E while P` has its own.
            _ if matches!(pattern, Pattern::Never(..)) => Scope::Whole,
            _ => Scope::While(cond(dice)),
        };
        Self { pattern, scope }
    }

    /// Its words without what they are about.
    pub fn form(&self) -> String {
        let pattern = match &self.pattern {
            Pattern::Causes(_, _, early, late) => {
                format!("causes{}{}", early.map_or("", |_| " not before"), late.map_or("", |_| " within"))
            }
            Pattern::Forbids(..) => "forbids".to_owned(),
            Pattern::Precedes(_, _, early, late) => {
                format!("precedes{}{}", early.map_or("", |_| " not before"), late.map_or("", |_| " within"))
            }
            Pattern::Never(_, None) => "never".to_owned(),
            Pattern::Never(_, Some(_)) => "never while".to_owned(),
            Pattern::Always(_) => "always".to_owned(),
            Pattern::Eventually(_, late) | Pattern::EventuallyHolds(_, late) => {
                format!("eventually{}", late.map_or("", |_| " within"))
            }
            Pattern::AtMost(0, _) => "never".to_owned(),
            Pattern::AtMost(..) => "at most".to_owned(),
            Pattern::AtLeast(..) => "at least".to_owned(),
            Pattern::Exactly(..) => "exactly".to_owned(),
            Pattern::LastsAtLeast(..) => "for at least".to_owned(),
            Pattern::LastsAtMost(..) => "for at most".to_owned(),
        };
        let scope = match &self.scope {
            Scope::Whole => "globally",
            Scope::Before(_) => "before",
            Scope::After(_) => "after",
            Scope::Between(..) => "between",
            Scope::AfterUntil(..) => "after until",
            Scope::While(_) => "while",
        };
        format!("{pattern}, {scope}")
    }

    /// The conditions whose changes it watches, in the order in which they come at one instant.
    pub fn watched(&self) -> Vec<Cond> {
        let mut all = Vec::new();
        match &self.scope {
            Scope::Whole => {}
            Scope::Before(a) | Scope::After(a) => edges(a, &mut all),
            Scope::Between(a, b) | Scope::AfterUntil(a, b) => {
                edges(a, &mut all);
                edges(b, &mut all);
            }
            Scope::While(c) => add(*c, &mut all),
        }
        match &self.pattern {
            Pattern::Causes(a, b, ..) | Pattern::Precedes(a, b, ..) => {
                edges(a, &mut all);
                edges(b, &mut all);
            }
            Pattern::Forbids(a, b, c) => {
                edges(a, &mut all);
                edges(b, &mut all);
                edges(c, &mut all);
            }
            Pattern::Never(a, _)
            | Pattern::Eventually(a, _)
            | Pattern::AtMost(_, a)
            | Pattern::AtLeast(_, a)
            | Pattern::Exactly(_, a) => edges(a, &mut all),
            Pattern::Always(_) | Pattern::EventuallyHolds(..) => {}
            Pattern::LastsAtLeast(c, _) | Pattern::LastsAtMost(c, _) => add(*c, &mut all),
        }
        all
    }

    pub fn reads(&self, signal: usize) -> bool {
        let own = match &self.pattern {
            Pattern::Never(_, Some(c)) | Pattern::Always(c) | Pattern::EventuallyHolds(c, _) => {
                c.signal == signal
            }
            Pattern::Never(_, None)
            | Pattern::Causes(..)
            | Pattern::Forbids(..)
            | Pattern::Precedes(..)
            | Pattern::Eventually(..)
            | Pattern::AtMost(..)
            | Pattern::AtLeast(..)
            | Pattern::Exactly(..)
            | Pattern::LastsAtLeast(..)
            | Pattern::LastsAtMost(..) => false,
        };
        own || self.watched().iter().any(|c| c.signal == signal)
    }

    /// The signal whose comparison is asked at this event: that of `never E while P`.
    pub fn asks_at(&self, event: u16) -> Option<usize> {
        match &self.pattern {
            Pattern::Never(of, Some(c)) => of.contains(&Atom::Event(event)).then_some(c.signal),
            _ => None,
        }
    }

    /// Whether a comparison of this signal is asked when an instant is over.
    pub fn asks_at_samples(&self, signal: usize) -> bool {
        let only_at_events =
            |c: &Cond, of: &Atoms| c.signal == signal && of.iter().all(|a| matches!(a, Atom::Event(_)));
        let is_watched = self.watched().iter().any(|c| c.signal == signal);
        match &self.pattern {
            Pattern::Never(of, Some(c)) if only_at_events(c, of) => is_watched,
            _ => self.reads(signal),
        }
    }

    pub fn names(&self, event: u16) -> bool {
        self.lists().into_iter().flatten().any(|a| *a == Atom::Event(event))
    }

    fn lists(&self) -> Vec<&Atoms> {
        let mut all = match &self.pattern {
            Pattern::Causes(a, b, ..) | Pattern::Precedes(a, b, ..) => vec![a, b],
            Pattern::Forbids(a, b, c) => vec![a, b, c],
            Pattern::Never(a, _)
            | Pattern::Eventually(a, _)
            | Pattern::AtMost(_, a)
            | Pattern::AtLeast(_, a)
            | Pattern::Exactly(_, a) => vec![a],
            Pattern::Always(_)
            | Pattern::EventuallyHolds(..)
            | Pattern::LastsAtLeast(..)
            | Pattern::LastsAtMost(..) => Vec::new(),
        };
        match &self.scope {
            Scope::Whole | Scope::While(_) => {}
            Scope::Before(a) | Scope::After(a) => all.push(a),
            Scope::Between(a, b) | Scope::AfterUntil(a, b) => all.extend([a, b]),
        }
        all
    }
}

fn add(c: Cond, all: &mut Vec<Cond>) {
    if !all.contains(&c) {
        all.push(c);
    }
}

fn edges(atoms: &Atoms, all: &mut Vec<Cond>) {
    for atom in atoms {
        if let Atom::Edge { of, .. } = atom {
            add(*of, all);
        }
    }
}

/// The verdicts that a form can have.
pub(crate) fn can_be(form: &str, outcome: MonitorOutcome) -> bool {
    let (pattern, scope) = form.split_once(", ").unwrap();
    let counts_if_closed = matches!(scope, "before" | "between");
    match outcome {
        // Without a deadline an answer may always come, until its scope is over.
        MonitorOutcome::Fail => {
            !(scope_is_endless(scope) && matches!(pattern, "causes" | "eventually" | "at least"))
        }
        MonitorOutcome::Pass => !(pattern == "never" && scope == "globally"),
        // What its scope begins with, or the whole run, is checked in every run.
        MonitorOutcome::Vacuous => {
            !(matches!(pattern, "eventually" | "eventually within" | "at least" | "exactly")
                && matches!(scope, "globally" | "before"))
        }
        MonitorOutcome::Inconclusive => {
            counts_if_closed
                || pattern.starts_with("causes")
                || pattern.starts_with("eventually")
                || matches!(pattern, "at least" | "exactly" | "for at least" | "for at most")
        }
    }
}

fn scope_is_endless(scope: &str) -> bool {
    matches!(scope, "globally" | "after")
}

impl fmt::Display for Cond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.holds { "" } else { "not " }, ["p", "q"][self.signal])
    }
}

impl fmt::Display for Atom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Atom::Event(e) => f.write_str(["a", "b", "c", "d"][usize::from(*e)]),
            Atom::Edge { rising: true, of } => write!(f, "rising({of})"),
            Atom::Edge { rising: false, of } => write!(f, "falling({of})"),
        }
    }
}

fn any(atoms: &Atoms) -> String {
    let all: Vec<String> = atoms.iter().map(ToString::to_string).collect();
    if all.len() == 1 { all.concat() } else { format!("({})", all.join(" or ")) }
}

fn ms(word: &str, time: Option<Nanos>) -> String {
    time.map_or_else(String::new, |t| format!(" {word} {} ms", t / 1_000_000))
}

impl fmt::Display for Sentence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.pattern {
            Pattern::Causes(t, r, early, late) => {
                write!(f, "{} causes {}{}{}", any(t), any(r), ms("not before", *early), ms("within", *late))?;
            }
            Pattern::Forbids(t, e, u) => write!(f, "{} forbids {} until {}", any(t), any(e), any(u))?,
            Pattern::Precedes(a, t, early, late) => {
                write!(
                    f,
                    "{} precedes {}{}{}",
                    any(a),
                    any(t),
                    ms("not before", *early),
                    ms("within", *late)
                )?;
            }
            Pattern::Never(e, None) => write!(f, "never {}", any(e))?,
            Pattern::Never(e, Some(c)) => write!(f, "never {} while {c}", any(e))?,
            Pattern::Always(c) => write!(f, "always {c}")?,
            Pattern::Eventually(e, late) => write!(f, "eventually {}{}", any(e), ms("within", *late))?,
            Pattern::EventuallyHolds(c, late) => write!(f, "eventually {c}{}", ms("within", *late))?,
            Pattern::AtMost(n, e) => write!(f, "at most {n} {}", any(e))?,
            Pattern::AtLeast(n, e) => write!(f, "at least {n} {}", any(e))?,
            Pattern::Exactly(n, e) => write!(f, "exactly {n} {}", any(e))?,
            Pattern::LastsAtLeast(c, t) => write!(f, "whenever {c}{}", ms("for at least", Some(*t)))?,
            Pattern::LastsAtMost(c, t) => write!(f, "whenever {c}{}", ms("for at most", Some(*t)))?,
        }
        match &self.scope {
            Scope::Whole => Ok(()),
            Scope::Before(a) => write!(f, " before {}", any(a)),
            Scope::After(a) => write!(f, " after {}", any(a)),
            Scope::Between(a, b) => write!(f, " between {} and {}", any(a), any(b)),
            Scope::AfterUntil(a, b) => write!(f, " after {} until {}", any(a), any(b)),
            Scope::While(c) => write!(f, " while {c}"),
        }
    }
}
