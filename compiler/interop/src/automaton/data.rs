//! What the automaton of a formula is, as data.

use hrdsl_ir::{formula::MetricFormula, monitor::MonitorOutcome, value::Nanos};
use serde::{Serialize, Serializer};

use crate::exchange::time::seconds;

/// A formula as an automaton. It begins at the first moment, in its first state, with all clocks at 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormulaAutomaton {
    /// Their names.
    pub clocks: Vec<String>,
    /// What its guards ask of a moment.
    pub letters: Vec<FormulaLetter>,
    pub states: Vec<FormulaState>,
    /// At most one of those that leave a state has a guard that holds at a moment.
    pub edges: Vec<FormulaEdge>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormulaLetter {
    /// As the language writes it.
    pub text: String,
    pub what: LetterKind,
}

/// What a letter is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LetterKind {
    /// The formula's atom of this number holds.
    Atom(usize),
    /// This holds, and did not at the moment before; never at the first.
    Rising(MetricFormula),
    /// This does not hold, and did at the moment before; never at the first.
    Falling(MetricFormula),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FormulaState {
    pub name: String,
    /// What a run comes to that ends in it.
    #[serde(serialize_with = "as_word")]
    pub outcome: MonitorOutcome,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormulaEdge {
    pub from: usize,
    pub to: usize,
    /// The guard, as it is read.
    pub text: String,
    /// One of these has to hold, each of which is all of its tests. What holds always has one without tests.
    pub guard: Vec<Vec<GuardTest>>,
    /// These clocks are set to 0.
    pub resets: Vec<usize>,
}

/// A question, and the answer that is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct GuardTest {
    pub of: GuardQuestion,
    pub wanted: bool,
}

/// What can be asked of a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GuardQuestion {
    /// Whether this letter holds.
    Letter(usize),
    /// Whether a clock reads at least so much.
    AtLeast { clock: usize, bound: Nanos },
    /// Whether a clock reads at most so much.
    AtMost { clock: usize, bound: Nanos },
}

/// What keeps a formula from being an automaton, as a sentence.
pub type AutomatonObstacle = String;

impl FormulaAutomaton {
    /// A guard as the language would write it.
    pub(super) fn guard_text(
        clocks: &[String],
        letters: &[FormulaLetter],
        guard: &[Vec<GuardTest>],
    ) -> String {
        let named = |names: &[String], clock: usize| names.get(clock).cloned().unwrap_or_default();
        let test = |test: &GuardTest| match (test.of, test.wanted) {
            (GuardQuestion::Letter(letter), wanted) => {
                let text = letters.get(letter).map_or("", |l| l.text.as_str());
                let text = if text.contains(' ') && !wanted { format!("({text})") } else { text.to_owned() };
                if wanted { text } else { format!("not {text}") }
            }
            (GuardQuestion::AtLeast { clock, bound }, wanted) => {
                format!("{} {} {}", named(clocks, clock), if wanted { ">=" } else { "<" }, seconds(bound))
            }
            (GuardQuestion::AtMost { clock, bound }, wanted) => {
                format!("{} {} {}", named(clocks, clock), if wanted { "<=" } else { ">" }, seconds(bound))
            }
        };
        let all = |tests: &Vec<GuardTest>| {
            if tests.is_empty() {
                return "always".to_owned();
            }
            tests.iter().map(test).collect::<Vec<_>>().join(" and ")
        };
        guard.iter().map(all).collect::<Vec<_>>().join(" or ")
    }
}

fn as_word<S: Serializer>(outcome: &MonitorOutcome, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(outcome)
}
