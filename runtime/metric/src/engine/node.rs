//! Operators at work: each reads the pieces of its operands and writes its own, as far as they are certain.

use hrdsl_ir::{
    Nanos,
    formula::{MetricFormula, PastWindow},
};

use super::{
    extremum::SlidingExtremum,
    piece::{PieceFeed, SignalPiece, side_by_side},
    reach::{ReachMap, SlidingReach},
};
use crate::robustness::Robustness;

/// What is new of the atoms' signals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtomNews<'a> {
    /// For each atom the next pieces.
    pub pieces: &'a [Vec<SignalPiece>],
    /// They are all that start before this.
    pub known: Nanos,
    /// What follows is not known: from a time on, each atom is taken for what is best, or worst, for the whole.
    pub beyond: Option<(Nanos, Robustness)>,
}

#[derive(Clone, Copy, Debug)]
enum Junction {
    And,
    Or,
    Implies,
}

impl Junction {
    fn of(self, a: Robustness, b: Robustness) -> Robustness {
        match self {
            Self::And => a.min(b),
            Self::Or => a.max(b),
            Self::Implies => (!a).max(b),
        }
    }
}

/// An operator with its operands.
#[derive(Clone, Debug)]
enum OperatorNode {
    Constant {
        start: Nanos,
        value: Robustness,
    },
    /// `positive`: the whole grows with it.
    Atom {
        index: usize,
        positive: bool,
    },
    Not(MetricStream),
    Junction(Junction, MetricStream, MetricStream),
    Extremum(SlidingExtremum, MetricStream),
    Reach(Box<ReachOperands>),
}

/// `since` and `until` are three things in one: φ at the nearest moments, ψ reached in the window behind them, and both together.
#[derive(Clone, Debug)]
struct ReachOperands {
    left: MetricStream,
    right: MetricStream,
    reach: SlidingReach,
    reached: PieceFeed,
    /// φ between now and the window, if there is anything between, with what is new for it.
    near: Option<(SlidingExtremum, Vec<SignalPiece>)>,
    kept: PieceFeed,
}

/// A formula over time, as its atoms become known.
#[derive(Clone, Debug)]
pub(crate) struct MetricStream {
    node: Box<OperatorNode>,
    /// What it has written, and its reader has not yet read.
    pub feed: PieceFeed,
}

impl MetricStream {
    /// `start` is the first moment of the run.
    pub fn new(formula: &MetricFormula, start: Nanos) -> Self {
        Self::with_sign(formula, start, true)
    }

    fn with_sign(formula: &MetricFormula, start: Nanos, positive: bool) -> Self {
        let of = |f: &MetricFormula| Self::with_sign(f, start, positive);
        let not = |f: &MetricFormula| Self::with_sign(f, start, !positive);
        let past = |w: &PastWindow, f: &MetricFormula, least| {
            let width = w.to.map(|to| to - w.from);
            OperatorNode::Extremum(SlidingExtremum::new(start, width, w.from, least), of(f))
        };
        let node = match formula {
            MetricFormula::Constant(truth) => {
                OperatorNode::Constant { start, value: Robustness::of_truth(*truth) }
            }
            MetricFormula::Atom(index) => OperatorNode::Atom { index: *index, positive },
            MetricFormula::Not(a) => OperatorNode::Not(not(a)),
            MetricFormula::And(a, b) => OperatorNode::Junction(Junction::And, of(a), of(b)),
            MetricFormula::Or(a, b) => OperatorNode::Junction(Junction::Or, of(a), of(b)),
            MetricFormula::Implies(a, b) => OperatorNode::Junction(Junction::Implies, not(a), of(b)),
            MetricFormula::Once(w, a) => past(w, a, false),
            MetricFormula::Historically(w, a) => past(w, a, true),
            MetricFormula::Eventually(w, a) => {
                OperatorNode::Extremum(SlidingExtremum::new(start, Some(w.to - w.from), -w.to, false), of(a))
            }
            MetricFormula::Always(w, a) => {
                OperatorNode::Extremum(SlidingExtremum::new(start, Some(w.to - w.from), -w.to, true), of(a))
            }
            MetricFormula::Since(w, a, b) => {
                let width = w.to.map(|to| to - w.from);
                let reach = SlidingReach::new(start, width, w.from, true);
                let near = (w.from > 0).then(|| SlidingExtremum::new(start, Some(w.from - 1), 0, true));
                OperatorNode::Reach(Box::new(ReachOperands::new(start, of(a), of(b), reach, near)))
            }
            MetricFormula::Until(w, a, b) => {
                let reach = SlidingReach::new(start, Some(w.to - w.from), -w.to, false);
                let last = w.from - 1;
                let near = (w.from > 0).then(|| SlidingExtremum::new(start, Some(last), -last, true));
                OperatorNode::Reach(Box::new(ReachOperands::new(start, of(a), of(b), reach, near)))
            }
        };
        Self { node: Box::new(node), feed: PieceFeed::new(start) }
    }

    /// Takes what is new of the atoms, and writes what is certain by it.
    pub fn advance(&mut self, news: AtomNews<'_>) {
        let out = &mut self.feed;
        match &mut *self.node {
            OperatorNode::Constant { start, value } => {
                out.write(*start, *value);
                out.set_known(Nanos::MAX);
            }
            OperatorNode::Atom { index, positive } => {
                news.pieces.get(*index).into_iter().flatten().for_each(|p| out.write(p.start, p.value));
                if let Some((time, value)) = news.beyond {
                    out.write(time, if *positive { value } else { !value });
                }
                out.set_known(news.known);
            }
            OperatorNode::Not(of) => {
                of.advance(news);
                of.feed.all().iter().for_each(|p| out.write(p.start, !p.value));
                out.set_known(of.feed.known());
                of.feed.clear();
            }
            OperatorNode::Junction(junction, a, b) => {
                a.advance(news);
                b.advance(news);
                let junction = *junction;
                let known = side_by_side(&mut a.feed, &mut b.feed, Nanos::MAX, |time, a, b| {
                    out.write(time, junction.of(a, b));
                });
                out.set_known(known);
            }
            OperatorNode::Extremum(window, of) => {
                of.advance(news);
                window.advance(of.feed.all(), of.feed.known(), out);
                of.feed.clear();
            }
            OperatorNode::Reach(operands) => operands.advance(news, out),
        }
    }
}

impl ReachOperands {
    fn new(
        start: Nanos,
        left: MetricStream,
        right: MetricStream,
        reach: SlidingReach,
        near: Option<SlidingExtremum>,
    ) -> Self {
        let (reached, kept) = (PieceFeed::new(start), PieceFeed::new(start));
        Self { left, right, reach, reached, near: near.map(|n| (n, Vec::new())), kept }
    }

    fn advance(&mut self, news: AtomNews<'_>, out: &mut PieceFeed) {
        let Self { left, right, reach, reached, near, kept } = self;
        left.advance(news);
        right.advance(news);
        let mut held = near.as_mut().map(|(_, held)| held);
        let known = side_by_side(&mut left.feed, &mut right.feed, Nanos::MAX, |time, high, low| {
            reach.enter(time, ReachMap { low, high }, reached);
            if let Some(held) = &mut held {
                held.push(SignalPiece { start: time, value: high });
            }
        });
        reach.known(known, reached);
        let Some((near, held)) = near else {
            reached.all().iter().for_each(|p| out.write(p.start, p.value));
            out.set_known(reached.known());
            reached.clear();
            return;
        };
        near.advance(held, known, kept);
        held.clear();
        let known = side_by_side(reached, kept, Nanos::MAX, |time, a, b| out.write(time, a.min(b)));
        out.set_known(known);
    }
}
