//! What becomes of a goal along a run: each part that looks at every moment keeps one number, or two.

use hrdsl_ir::{
    Nanos,
    formula::{MetricFormula, MetricGoal},
};

use crate::{
    engine::{
        node::{AtomNews, MetricStream},
        piece::{one_by_one, side_by_side},
        reach::ReachMap,
    },
    robustness::Robustness,
};

/// A goal so far.
#[derive(Clone, Debug)]
pub(crate) enum GoalProgress {
    And(Box<GoalProgress>, Box<GoalProgress>),
    Or(Box<GoalProgress>, Box<GoalProgress>),
    Part(Box<GoalPart>),
}

/// What there is to tell of a goal beside its robustness.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GoalTold {
    pub triggered: u32,
    pub failures: u32,
    pub first_failure: Option<Nanos>,
}

impl GoalTold {
    fn fail(&mut self, time: Nanos) {
        self.failures = self.failures.saturating_add(1);
        self.first_failure = self.first_failure.or(Some(time));
    }

    fn trigger(&mut self) {
        self.triggered = self.triggered.saturating_add(1);
    }
}

#[derive(Clone, Debug)]
enum PartKind {
    Now(Option<Robustness>),
    /// The least so far; and whether it holds now, and what it is asked of does.
    Always {
        least: Robustness,
        holds: bool,
        asked: bool,
    },
    Eventually(Robustness),
    /// The moments so far, as one; `dual`: it is the opposite that is asked.
    Until {
        all: ReachMap,
        dual: bool,
        decided: bool,
    },
}

/// One operator that looks at the whole run.
#[derive(Clone, Debug)]
pub(crate) struct GoalPart {
    kind: PartKind,
    /// Of `always (P implies Q)` the P; of `P until Q` the P.
    left: Option<MetricStream>,
    right: MetricStream,
    told: GoalTold,
}

impl GoalProgress {
    pub fn new(goal: &MetricGoal, start: Nanos) -> Self {
        let of = |goal: &MetricGoal| Box::new(Self::new(goal, start));
        let stream = |formula: &MetricFormula| MetricStream::new(formula, start);
        let part = |kind, left: Option<&MetricFormula>, right: &MetricFormula, triggered| {
            let told = GoalTold { triggered, ..GoalTold::default() };
            Self::Part(Box::new(GoalPart { kind, left: left.map(stream), right: stream(right), told }))
        };
        let until = |dual| PartKind::Until { all: ReachMap::IDENTITY, dual, decided: false };
        match goal {
            MetricGoal::And(a, b) => Self::And(of(a), of(b)),
            MetricGoal::Or(a, b) => Self::Or(of(a), of(b)),
            MetricGoal::Now(a) => part(PartKind::Now(None), None, a, 1),
            MetricGoal::Eventually(a) => part(PartKind::Eventually(Robustness::FALSE), None, a, 1),
            MetricGoal::Until(a, b) => part(until(false), Some(a), b, 1),
            MetricGoal::Release(a, b) => part(until(true), Some(a), b, 1),
            MetricGoal::Always(body) => {
                let kind = PartKind::Always { least: Robustness::TRUE, holds: true, asked: false };
                let MetricFormula::Implies(premise, conclusion) = body else {
                    return part(kind, None, body, 1);
                };
                // The premise is read with the other sign than the whole.
                let negated = MetricFormula::Not(premise.clone());
                part(kind, Some(&negated), conclusion, 0)
            }
        }
    }

    /// Takes what is new, of the moments before `limit`.
    pub fn advance(&mut self, news: AtomNews<'_>, limit: Nanos) {
        match self {
            Self::And(a, b) | Self::Or(a, b) => {
                a.advance(news, limit);
                b.advance(news, limit);
            }
            Self::Part(part) => part.advance(news, limit),
        }
    }

    /// The robustness at the end, at the least, or at the most if `upper`.
    pub fn value(&self, upper: bool) -> Robustness {
        match self {
            Self::And(a, b) => a.value(upper).min(b.value(upper)),
            Self::Or(a, b) => a.value(upper).max(b.value(upper)),
            Self::Part(part) => part.value(upper),
        }
    }

    /// Of several parts that have to hold the first that failed counts, of alternatives the last.
    pub fn told(&self) -> GoalTold {
        match self {
            Self::Part(part) => part.told,
            Self::And(a, b) => {
                let (a, b) = (a.told(), b.told());
                let times = [a.first_failure, b.first_failure];
                GoalTold {
                    triggered: a.triggered.saturating_add(b.triggered),
                    failures: a.failures.saturating_add(b.failures),
                    first_failure: times.into_iter().flatten().min(),
                }
            }
            Self::Or(a, b) => {
                let (a, b) = (a.told(), b.told());
                let both = a.first_failure.zip(b.first_failure);
                GoalTold {
                    triggered: a.triggered.saturating_add(b.triggered),
                    failures: a.failures.min(b.failures),
                    first_failure: both.map(|(a, b)| a.max(b)),
                }
            }
        }
    }
}

impl GoalPart {
    fn advance(&mut self, news: AtomNews<'_>, limit: Nanos) {
        let Self { kind, left, right, told } = self;
        right.advance(news);
        let Some(left) = left else {
            one_by_one(&mut right.feed, limit, |time, value| kind.see(time, None, value, told));
            return;
        };
        left.advance(news);
        side_by_side(&mut left.feed, &mut right.feed, limit, |time, left, value| {
            kind.see(time, Some(left), value, told);
        });
    }

    fn value(&self, upper: bool) -> Robustness {
        match &self.kind {
            PartKind::Now(value) => value.unwrap_or(Robustness::of_truth(upper)),
            PartKind::Always { least, .. } => *least,
            PartKind::Eventually(best) => {
                if upper {
                    Robustness::TRUE
                } else {
                    *best
                }
            }
            PartKind::Until { all, dual: true, .. } => !all.low,
            PartKind::Until { all, dual: false, .. } => {
                if upper {
                    all.low.max(all.high)
                } else {
                    all.low
                }
            }
        }
    }
}

impl PartKind {
    /// From `time` on the operands have these values.
    fn see(&mut self, time: Nanos, left: Option<Robustness>, right: Robustness, told: &mut GoalTold) {
        match self {
            Self::Now(value) => {
                if value.is_none() {
                    *value = Some(right);
                    if !right.holds() {
                        told.fail(time);
                    }
                }
            }
            Self::Always { least, holds, asked } => {
                let value = left.map_or(right, |left| left.max(right));
                *least = (*least).min(value);
                if let Some(left) = left {
                    if !left.holds() && !*asked {
                        told.trigger();
                    }
                    *asked = !left.holds();
                }
                if *holds && !value.holds() {
                    told.fail(time);
                }
                *holds = value.holds();
            }
            Self::Eventually(best) => *best = (*best).max(right),
            Self::Until { all, dual, decided } => {
                let left = left.unwrap_or(Robustness::TRUE);
                let map = if *dual {
                    ReachMap { low: !right, high: !left }
                } else {
                    ReachMap { low: right, high: left }
                };
                *all = all.over(map);
                let fails = if *dual { all.low.holds() } else { !all.low.holds() && !all.high.holds() };
                if fails && !*decided {
                    *decided = true;
                    told.fail(time);
                }
            }
        }
    }
}
