//! A goal over one run: what comes of it, carried along while the atoms become known.

use hrdsl_ir::{
    Nanos,
    formula::{MetricFormula, MetricGoal},
    monitor::MonitorOutcome,
};

use crate::{
    engine::{
        node::{AtomNews, MetricStream},
        piece::SignalPiece,
    },
    fold::GoalProgress,
    measured::outcome_of_measured,
    robustness::Robustness,
};

/// So many pieces are taken at once, which is faster than one by one and gives the same.
const BLOCK: usize = 1024;

/// What a goal comes to on a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricOutcome {
    pub outcome: MonitorOutcome,
    /// The robustness is at least this, whatever comes after the end.
    pub lower: Robustness,
    /// It is at most this.
    pub upper: Robustness,
    /// How often what is asked of every moment was asked at all: of `always (P implies Q)`, how often P became true.
    pub triggered: u32,
    /// How often it became violated.
    pub failures: u32,
    pub first_failure: Option<Nanos>,
    /// When a comparison first had no value: what has not failed is inconclusive then.
    pub unvalued: Option<Nanos>,
}

impl MetricOutcome {
    /// That of a run in which the formula has no first moment: one of its signals never had a value.
    pub const UNSEEN: Self = Self {
        outcome: MonitorOutcome::Vacuous,
        lower: Robustness::FALSE,
        upper: Robustness::TRUE,
        triggered: 0,
        failures: 0,
        first_failure: None,
        unvalued: None,
    };

    /// The same of a run in which a comparison had no value from this moment on.
    pub(crate) fn given(self, unvalued: Option<Nanos>) -> Self {
        let outcome = outcome_of_measured(self.outcome, unvalued);
        Self { outcome, unvalued, ..self }
    }

    /// By how much it holds at the least, or fails at the least; `None`: that is open, or infinite.
    #[must_use]
    pub fn margin(&self) -> Option<f64> {
        let bound = match self.outcome {
            MonitorOutcome::Pass => self.lower,
            MonitorOutcome::Fail => self.upper,
            MonitorOutcome::Vacuous | MonitorOutcome::Inconclusive => return None,
        };
        Some(bound.number()).filter(|n| n.is_finite())
    }
}

/// A goal at work on one run.
#[derive(Clone, Debug)]
pub struct MetricEvaluator {
    goal: GoalProgress,
    /// For each atom, its value now and its pieces that the goal has not yet taken.
    atoms: Vec<Robustness>,
    news: Vec<Vec<SignalPiece>>,
    waiting: usize,
}

impl MetricEvaluator {
    /// `atoms` are the values at the first moment, `start`.
    #[must_use]
    pub fn new(goal: &MetricGoal, start: Nanos, atoms: &[Robustness]) -> Self {
        Self {
            goal: GoalProgress::new(goal, start),
            atoms: atoms.to_vec(),
            news: atoms.iter().map(|value| vec![SignalPiece { start, value: *value }]).collect(),
            waiting: 0,
        }
    }

    /// From `time` on the atom has this value; for each atom, times are in order and later than the start.
    #[inline]
    pub fn change(&mut self, atom: usize, time: Nanos, value: Robustness) {
        if let (Some(now), Some(news)) = (self.atoms.get_mut(atom), self.news.get_mut(atom))
            && *now != value
        {
            *now = value;
            news.push(SignalPiece { start: time, value });
            self.waiting += 1;
        }
    }

    /// There are no more changes before `known`. They are taken together with later ones, if there are few.
    #[inline]
    pub fn advance(&mut self, known: Nanos) {
        if self.waiting >= BLOCK {
            self.advance_now(known);
        }
    }

    /// There are no more changes before `known`, and what comes of them is found at once.
    pub fn advance_now(&mut self, known: Nanos) {
        // What windows in the past say of later moments may lie beyond the end.
        self.goal.advance(AtomNews { pieces: &self.news, known, beyond: None }, known);
        self.news.iter_mut().for_each(Vec::clear);
        self.waiting = 0;
    }

    /// When it became violated first, as far as that is certain of what was taken.
    pub(crate) fn first_failure(&self) -> Option<Nanos> {
        self.goal.told().first_failure
    }

    /// The run has ended; its last moment is `end`.
    #[must_use]
    pub fn finish(mut self, end: Nanos) -> MetricOutcome {
        let after = end.saturating_add(1);
        self.advance_now(after);
        let with = |beyond: Robustness| {
            let mut goal = self.goal.clone();
            let nothing = vec![Vec::new(); self.atoms.len()];
            let beyond = Some((after, beyond));
            goal.advance(AtomNews { pieces: &nothing, known: Nanos::MAX, beyond }, after);
            goal
        };
        let (worst, best) = (with(Robustness::FALSE), with(Robustness::TRUE));
        let (lower, upper) = (worst.value(false), best.value(true));
        // What is certain whatever comes is what the best that can come does not mend.
        let told = best.told();
        let outcome = if !upper.holds() {
            MonitorOutcome::Fail
        } else if !lower.holds() {
            MonitorOutcome::Inconclusive
        } else if told.triggered == 0 {
            MonitorOutcome::Vacuous
        } else {
            MonitorOutcome::Pass
        };
        let failed = outcome == MonitorOutcome::Fail;
        MetricOutcome {
            outcome,
            lower,
            upper,
            triggered: told.triggered,
            failures: if failed { told.failures.max(1) } else { 0 },
            first_failure: told.first_failure.filter(|_| failed),
            unvalued: None,
        }
    }
}

/// The bounds of a formula's robustness at every moment up to the end.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustnessOverTime {
    pub lower: Vec<SignalPiece>,
    pub upper: Vec<SignalPiece>,
}

/// A formula at every moment from `start` to `end`; each atom has a piece at `start`, and others in order.
#[must_use]
pub fn robustness_over_time(
    formula: &MetricFormula,
    atoms: &[Vec<SignalPiece>],
    (start, end): (Nanos, Nanos),
) -> RobustnessOverTime {
    let after = end.saturating_add(1);
    let mut stream = MetricStream::new(formula, start);
    stream.advance(AtomNews { pieces: atoms, known: after, beyond: None });
    let nothing = vec![Vec::new(); atoms.len()];
    let with = |beyond: Robustness| {
        let mut stream = stream.clone();
        stream.advance(AtomNews { pieces: &nothing, known: Nanos::MAX, beyond: Some((after, beyond)) });
        stream.feed.all().iter().filter(|p| p.start <= end).copied().collect()
    };
    RobustnessOverTime { lower: with(Robustness::FALSE), upper: with(Robustness::TRUE) }
}
