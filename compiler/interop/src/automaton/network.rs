//! From a goal to memories, clocks, and what becomes of each of its parts.

use hrdsl_ir::formula::{MetricFormula, MetricGoal, MonitorFormula};

use super::{
    ahead::{clauses, looks_ahead},
    condition::{FALSE, MomentCondition, TRUE, all, any, not},
    data::AutomatonObstacle,
    parts::{AutomatonParts, GoalLeaf, GoalTree},
};

/// All that the states of the automaton are made from.
#[derive(Debug)]
pub(super) struct FormulaNetwork<'f> {
    pub parts: AutomatonParts<'f>,
    pub goal: GoalTree,
    /// The bit that says that something was asked; `None`: something always is.
    pub asked: Option<usize>,
}

pub(super) fn network(formula: &MonitorFormula) -> Result<FormulaNetwork<'_>, AutomatonObstacle> {
    let mut builder = NetworkBuilder {
        parts: AutomatonParts::new(&formula.atoms),
        premises: Vec::new(),
        always_asked: false,
    };
    let goal = builder.goal(&formula.goal)?;
    let NetworkBuilder { mut parts, premises, always_asked } = builder;
    let asked = (!always_asked).then(|| {
        let bit = parts.bit("asked".to_owned(), false);
        parts.becomes(bit, any(premises.into_iter().chain([MomentCondition::Memory(bit)])));
        bit
    });
    Ok(FormulaNetwork { parts, goal, asked })
}

struct NetworkBuilder<'f> {
    parts: AutomatonParts<'f>,
    /// What is asked for only where one of these holds.
    premises: Vec<MomentCondition>,
    always_asked: bool,
}

impl NetworkBuilder<'_> {
    fn goal(&mut self, goal: &MetricGoal) -> Result<GoalTree, AutomatonObstacle> {
        let leaf = match goal {
            MetricGoal::And(a, b) => {
                return Ok(GoalTree::And(Box::new(self.goal(a)?), Box::new(self.goal(b)?)));
            }
            MetricGoal::Or(a, b) => {
                return Ok(GoalTree::Or(Box::new(self.goal(a)?), Box::new(self.goal(b)?)));
            }
            MetricGoal::Always(body) => self.always(body)?,
            MetricGoal::Now(body) => {
                self.always_asked = true;
                let first = self.parts.bit("the first moment".to_owned(), true);
                let leaf = self.at_each(body, true, MomentCondition::Memory(first))?;
                GoalLeaf { only_during: Some(first), ..leaf }
            }
            // It has come as soon as it is certain that its opposite has failed.
            MetricGoal::Eventually(body) => {
                self.always_asked = true;
                let opposite = self.at_each(body, false, TRUE)?;
                GoalLeaf {
                    failed: None,
                    met: opposite.failed,
                    pending: Vec::new(),
                    waits: true,
                    only_during: None,
                }
            }
            MetricGoal::Until(a, b) => {
                let (a, b) = (self.now(a)?, self.now(b)?);
                self.decided_by(all([not(a), not(b.clone())]), b, true)
            }
            MetricGoal::Release(a, b) => {
                let (a, b) = (self.now(a)?, self.now(b)?);
                self.decided_by(not(b.clone()), all([a, b]), false)
            }
        };
        Ok(GoalTree::Leaf(leaf))
    }

    fn always(&mut self, body: &MetricFormula) -> Result<GoalLeaf, AutomatonObstacle> {
        match body {
            MetricFormula::Implies(premise, _) if looks_ahead(premise) => {
                return Err(format!(
                    "Whether it is asked is known only later: `{}` looks ahead.",
                    self.parts.text(premise)
                ));
            }
            MetricFormula::Implies(premise, _) => {
                let premise = self.parts.now(premise)?;
                self.premises.push(premise);
            }
            MetricFormula::Constant(_)
            | MetricFormula::Atom(_)
            | MetricFormula::Not(_)
            | MetricFormula::And(..)
            | MetricFormula::Or(..)
            | MetricFormula::Once(..)
            | MetricFormula::Historically(..)
            | MetricFormula::Since(..)
            | MetricFormula::Eventually(..)
            | MetricFormula::Always(..)
            | MetricFormula::Until(..) => self.always_asked = true,
        }
        self.at_each(body, true, TRUE)
    }

    /// The body, or its opposite, at each moment that is asked.
    fn at_each(
        &mut self,
        body: &MetricFormula,
        wanted: bool,
        asked: MomentCondition,
    ) -> Result<GoalLeaf, AutomatonObstacle> {
        let (mut fails, mut pending) = (Vec::new(), Vec::new());
        for clause in clauses(body, wanted)? {
            let (fail, open) = clause.fails(asked.clone(), &mut self.parts)?;
            fails.push(fail);
            pending.extend(open);
        }
        let failed = self.latch("violated", any(fails));
        Ok(GoalLeaf { failed: Some(failed), met: None, pending, waits: false, only_during: None })
    }

    /// The first moment at which one of the two holds decides; up to then it `waits`, or holds.
    fn decided_by(&mut self, fails: MomentCondition, comes_true: MomentCondition, waits: bool) -> GoalLeaf {
        let (failed, met) = (self.latch("violated", FALSE), self.latch("met", FALSE));
        for (latch, when, other) in [(failed, fails, met), (met, comes_true, failed)] {
            let now = all([when, not(MomentCondition::Memory(other))]);
            self.parts.becomes(latch, any([MomentCondition::Memory(latch), now]));
        }
        GoalLeaf { failed: Some(failed), met: Some(met), pending: Vec::new(), waits, only_during: None }
    }

    /// Of the moments before one that decides.
    fn now(&mut self, formula: &MetricFormula) -> Result<MomentCondition, AutomatonObstacle> {
        self.always_asked = true;
        self.parts.now(formula)
    }

    /// A bit that is set when something happens, and stays so.
    fn latch(&mut self, name: &str, when: MomentCondition) -> usize {
        let bit = self.parts.bit(name.to_owned(), false);
        self.parts.becomes(bit, any([MomentCondition::Memory(bit), when]));
        if let Some(of) = self.parts.bits.get_mut(bit) {
            of.is_latch = true;
        }
        bit
    }
}

impl GoalTree {
    /// Whether it holds in a run that ends with these memories, if that is known; and whether nothing can change that.
    pub fn value(&self, memory: &[bool]) -> (Option<bool>, bool) {
        match self {
            Self::Leaf(leaf) => leaf.value(memory),
            Self::And(a, b) => joined(a.value(memory), b.value(memory), true),
            Self::Or(a, b) => joined(a.value(memory), b.value(memory), false),
        }
    }
}

/// Of `and` one that does not hold decides, of `or` one that does.
fn joined(a: (Option<bool>, bool), b: (Option<bool>, bool), together: bool) -> (Option<bool>, bool) {
    let decides = |(truth, is_final): (Option<bool>, bool)| truth == Some(!together) && is_final;
    let truth = match (a.0, b.0) {
        (a, b) if a == Some(!together) || b == Some(!together) => Some(!together),
        (Some(_), Some(_)) => Some(together),
        (_, _) => None,
    };
    (truth, decides(a) || decides(b) || (a.1 && b.1))
}

impl GoalLeaf {
    fn value(&self, memory: &[bool]) -> (Option<bool>, bool) {
        let is_set = |bit: usize| memory.get(bit).copied().unwrap_or_default();
        if self.met.is_some_and(is_set) {
            return (Some(true), true);
        }
        if self.failed.is_some_and(is_set) {
            return (Some(false), true);
        }
        let is_pending = self.pending.iter().any(|bit| is_set(*bit));
        let truth = (!is_pending && !self.waits).then_some(true);
        (truth, !is_pending && self.only_during.is_some_and(|bit| !is_set(bit)))
    }
}
