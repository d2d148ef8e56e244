//! The states that an automaton can be in, and its edges: what is remembered is gone through, moment after moment.

use std::collections::BTreeMap;

use hrdsl_ir::{formula::MetricFormula, monitor::MonitorOutcome};

use super::{
    condition::MomentCondition,
    data::{
        AutomatonObstacle, FormulaAutomaton, FormulaEdge, FormulaState, GuardQuestion, GuardTest, LetterKind,
    },
    guard::shortened,
    network::FormulaNetwork,
};

/// Nobody would look at more.
const MOST_STATES: usize = 48;
const MOST_ALTERNATIVES: usize = 256;

/// What is remembered; of what is decided for good, what it came to.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum AutomatonState {
    Open(Vec<bool>),
    Decided { holds: bool },
}

/// Guards of the edges of one state, by where they lead and which clocks they set to 0.
type Leaving = BTreeMap<(AutomatonState, Vec<usize>), Vec<Vec<GuardTest>>>;

/// From where, to where, the guard, and the clocks that are set to 0.
type FoundEdge = (usize, usize, Vec<Vec<GuardTest>>, Vec<usize>);

pub(super) fn explored(network: FormulaNetwork<'_>) -> Result<FormulaAutomaton, AutomatonObstacle> {
    let explorer = StateExplorer { network };
    let initial = AutomatonState::Open(explorer.network.parts.bits.iter().map(|bit| bit.initial).collect());
    let (mut states, mut edges) = (vec![initial], Vec::new());
    let mut next = 0;
    while let Some(state) = states.get(next).cloned() {
        for ((target, resets), guard) in explorer.leaving(&state)? {
            let to = states.iter().position(|known| *known == target).unwrap_or_else(|| {
                states.push(target);
                states.len() - 1
            });
            if to != next || !resets.is_empty() {
                edges.push((next, to, shortened(guard), resets));
            }
        }
        if states.len() > MOST_STATES {
            return Err(format!("Its automaton would have more than {MOST_STATES} states."));
        }
        next += 1;
    }
    Ok(explorer.told(&states, edges))
}

struct StateExplorer<'f> {
    network: FormulaNetwork<'f>,
}

/// What follows on a moment, as far as it is known.
struct MomentOutcome {
    /// For each bit.
    next: Vec<MomentCondition>,
    /// For each clock.
    resets: Vec<MomentCondition>,
}

impl MomentOutcome {
    fn answered(&self, question: GuardQuestion, answer: bool) -> Self {
        let all = |of: &[MomentCondition]| of.iter().map(|c| c.answered(question, answer)).collect();
        Self { next: all(&self.next), resets: all(&self.resets) }
    }
}

impl StateExplorer<'_> {
    fn leaving(&self, state: &AutomatonState) -> Result<Leaving, AutomatonObstacle> {
        let mut leaving = Leaving::new();
        let AutomatonState::Open(memory) = state else { return Ok(leaving) };
        let parts = &self.network.parts;
        let next = parts.bits.iter().map(|bit| bit.next.remembering(memory)).collect();
        let resets = parts.resets.iter().map(|reset| reset.remembering(memory)).collect();
        self.split(&MomentOutcome { next, resets }, &mut Vec::new(), &mut leaving)?;
        Ok(leaving)
    }

    /// Asks one question after the other until it is certain what happens.
    fn split(
        &self,
        of: &MomentOutcome,
        path: &mut Vec<GuardTest>,
        leaving: &mut Leaving,
    ) -> Result<(), AutomatonObstacle> {
        let question = match self.certain(of) {
            Ok(what) => {
                leaving.entry(what).or_default().push(path.clone());
                let alternatives: usize = leaving.values().map(Vec::len).sum();
                return if alternatives > MOST_ALTERNATIVES {
                    Err(format!(
                        "A state of its automaton would have more than {MOST_ALTERNATIVES} ways out."
                    ))
                } else {
                    Ok(())
                };
            }
            Err(question) => question,
        };
        for wanted in [true, false] {
            let test = GuardTest { of: question, wanted };
            if !is_possible(path, test) {
                continue;
            }
            let mut known = of.answered(question, wanted);
            for implied in self.implied(test) {
                known = known.answered(implied.of, implied.wanted);
            }
            path.push(test);
            self.split(&known, path, leaving)?;
            path.pop();
        }
        Ok(())
    }

    /// Where it leads, and which clocks that are read there are set to 0; or what has to be asked first.
    fn certain(&self, of: &MomentOutcome) -> Result<(AutomatonState, Vec<usize>), GuardQuestion> {
        let bits = &self.network.parts.bits;
        let asks = |latches: bool| {
            let those = bits.iter().zip(&of.next).filter(move |(bit, _)| bit.is_latch == latches);
            those.into_iter().find_map(|(_, next)| next.question())
        };
        if let Some(question) = asks(true) {
            return Err(question);
        }
        // What is not known yet may leave everything open.
        let memory: Vec<bool> = of.next.iter().map(|next| next.truth().unwrap_or(true)).collect();
        if let (Some(holds), true) = self.network.goal.value(&memory) {
            return Ok((AutomatonState::Decided { holds }, Vec::new()));
        }
        if let Some(question) = asks(false) {
            return Err(question);
        }
        let is_read =
            |clock: usize| bits.iter().zip(&memory).any(|(bit, is_set)| *is_set && bit.clock == Some(clock));
        let mut resets = Vec::new();
        for (clock, reset) in of.resets.iter().enumerate().filter(|(clock, _)| is_read(*clock)) {
            if let Some(question) = reset.question() {
                return Err(question);
            }
            if reset.truth() == Some(true) {
                resets.push(clock);
            }
        }
        Ok((AutomatonState::Open(memory), resets))
    }

    /// What the answer about a letter says of other letters.
    fn implied(&self, test: GuardTest) -> Vec<GuardTest> {
        let letters = &self.network.parts.letters;
        let GuardQuestion::Letter(letter) = test.of else { return Vec::new() };
        let Some(of) = letters.get(letter) else { return Vec::new() };
        let answer = |(other, wanted): (usize, bool)| GuardTest { of: GuardQuestion::Letter(other), wanted };
        let others = letters.iter().enumerate().filter_map(|(other, what)| {
            let atom = |changing: &MetricFormula| match changing {
                MetricFormula::Atom(atom) => Some(*atom),
                _ => None,
            };
            match (&of.what, &what.what) {
                // What begins to hold now holds now, and what ceases to does not.
                (LetterKind::Rising(a), LetterKind::Atom(b)) if test.wanted && atom(a) == Some(*b) => {
                    Some((other, true))
                }
                (LetterKind::Falling(a), LetterKind::Atom(b)) if test.wanted && atom(a) == Some(*b) => {
                    Some((other, false))
                }
                (LetterKind::Atom(a), LetterKind::Rising(b)) if !test.wanted && atom(b) == Some(*a) => {
                    Some((other, false))
                }
                (LetterKind::Atom(a), LetterKind::Falling(b)) if test.wanted && atom(b) == Some(*a) => {
                    Some((other, false))
                }
                (LetterKind::Rising(a), LetterKind::Falling(b))
                | (LetterKind::Falling(a), LetterKind::Rising(b))
                    if test.wanted && a == b =>
                {
                    Some((other, false))
                }
                (_, _) => None,
            }
        });
        others.map(answer).collect()
    }

    fn told(self, states: &[AutomatonState], edges: Vec<FoundEdge>) -> FormulaAutomaton {
        let clocks: Vec<String> = (1..=self.network.parts.resets.len()).map(clock_name).collect();
        let states = states.iter().map(|state| self.state(state)).collect();
        let letters = self.network.parts.letters;
        let edges = edges.into_iter().map(|(from, to, guard, resets)| {
            let text = FormulaAutomaton::guard_text(&clocks, &letters, &guard);
            FormulaEdge { from, to, text, guard, resets }
        });
        let edges = edges.collect();
        FormulaAutomaton { clocks, letters, states, edges }
    }

    fn state(&self, state: &AutomatonState) -> FormulaState {
        let FormulaNetwork { parts, goal, asked } = &self.network;
        let memory = match state {
            AutomatonState::Decided { holds: true } => {
                return FormulaState { name: "met".to_owned(), outcome: MonitorOutcome::Pass };
            }
            AutomatonState::Decided { holds: false } => {
                return FormulaState { name: "violated".to_owned(), outcome: MonitorOutcome::Fail };
            }
            AutomatonState::Open(memory) => memory,
        };
        let was_asked = asked.is_none_or(|bit| memory.get(bit).copied().unwrap_or_default());
        let outcome = match goal.value(memory).0 {
            Some(false) => MonitorOutcome::Fail,
            None => MonitorOutcome::Inconclusive,
            Some(true) if was_asked => MonitorOutcome::Pass,
            Some(true) => MonitorOutcome::Vacuous,
        };
        let set = parts.bits.iter().enumerate().filter(|(bit, _)| memory.get(*bit) == Some(&true));
        let named = set.filter(|(bit, of)| !of.is_latch && Some(*bit) != *asked);
        let mut names: Vec<String> = named.map(|(_, bit)| bit.name.clone()).collect();
        if !was_asked {
            names.push("never triggered".to_owned());
        } else if names.is_empty() {
            names.push(if outcome == MonitorOutcome::Inconclusive { "waiting" } else { "idle" }.to_owned());
        }
        FormulaState { name: names.join(", "), outcome }
    }
}

/// Whether a clock can answer so after what it has answered on the way.
fn is_possible(path: &[GuardTest], test: GuardTest) -> bool {
    let clock_of = |question: GuardQuestion| match question {
        GuardQuestion::AtLeast { clock, .. } | GuardQuestion::AtMost { clock, .. } => Some(clock),
        GuardQuestion::Letter(_) => None,
    };
    let Some(clock) = clock_of(test.of) else { return true };
    let (mut least, mut most) = (0, i64::MAX);
    for known in path.iter().chain([&test]).filter(|known| clock_of(known.of) == Some(clock)) {
        match (known.of, known.wanted) {
            (GuardQuestion::AtLeast { bound, .. }, true) => least = least.max(bound),
            (GuardQuestion::AtLeast { bound, .. }, false) => most = most.min(bound - 1),
            (GuardQuestion::AtMost { bound, .. }, true) => most = most.min(bound),
            (GuardQuestion::AtMost { bound, .. }, false) => least = least.max(bound.saturating_add(1)),
            (GuardQuestion::Letter(_), _) => {}
        }
    }
    least <= most
}

/// `x`, `y`, `z`, then `x4` and so on.
fn clock_name(number: usize) -> String {
    ["x", "y", "z"].get(number - 1).map_or_else(|| format!("x{number}"), |name| (*name).to_owned())
}
