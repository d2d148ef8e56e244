//! The variables and clocks that queries read: of automata, and shared ones.

use crate::{
    ClockId, Scenario, TypedExpr, TypedFormula, TypedMeasure, TypedMethod, TypedQuery, TypedQueryKind,
    TypedSearchGoal, TypedSuite, VariableRef,
};

/// What is read, by index.
#[derive(Clone, Debug, Default)]
pub(crate) struct QueryRead {
    pub vars: Vec<bool>,
    pub clocks: Vec<bool>,
}

impl QueryRead {
    fn new(vars: usize, clocks: usize) -> Self {
        Self { vars: vec![false; vars], clocks: vec![false; clocks] }
    }
}

pub(crate) struct QueryReads {
    pub shared: QueryRead,
    /// By automaton: its own.
    pub automata: Vec<QueryRead>,
    /// By network: some query is about it.
    pub networks: Vec<bool>,
}

impl QueryReads {
    pub fn of(scenario: &Scenario) -> Self {
        let automata = scenario.automata.iter().map(|a| QueryRead::new(a.vars.len(), a.clocks.len()));
        let mut reads = Self {
            shared: QueryRead::new(scenario.shared.len(), scenario.clocks.len()),
            automata: automata.collect(),
            networks: vec![false; scenario.networks.len()],
        };
        for query in &scenario.queries {
            reads.query(scenario, query);
        }
        for suite in &scenario.suites {
            reads.suite(scenario, suite);
        }
        reads
    }

    /// What the goals of suites by search speak of is read, as what queries speak of is.
    fn suite(&mut self, scenario: &Scenario, suite: &TypedSuite) {
        let TypedMethod::Search { network, goals, .. } = &suite.method else { return };
        let Some(network) = scenario.networks.get(usize::from(network.0)) else { return };
        let automata: Vec<usize> = network.automata.iter().map(|a| usize::from(a.0)).collect();
        let mut reader = QueryReader { automata: &automata, reads: self };
        for goal in goals {
            let TypedSearchGoal::Combinations(all) = goal else { continue };
            all.terms.iter().for_each(|term| reader.data(&term.value));
            all.when.iter().for_each(|when| reader.formula(&when.formula));
        }
    }

    fn query(&mut self, scenario: &Scenario, query: &TypedQuery) {
        let at = usize::from(query.network.0);
        let Some(network) = scenario.networks.get(at) else { return };
        self.networks[at] = true;
        let automata: Vec<usize> = network.automata.iter().map(|a| usize::from(a.0)).collect();
        let mut reader = QueryReader { automata: &automata, reads: self };
        match &query.ask {
            TypedQueryKind::Possibly(f)
            | TypedQueryKind::Invariantly(f)
            | TypedQueryKind::PotentiallyAlways(f)
            | TypedQueryKind::Eventually(f) => {
                reader.formula(f);
            }
            TypedQueryKind::LeadsTo(f, g) => {
                reader.formula(f);
                reader.formula(g);
            }
            TypedQueryKind::Sup { of, when } | TypedQueryKind::Inf { of, when } => {
                reader.formula(when);
                of.iter().for_each(|m| match m {
                    TypedMeasure::Clock(clock) => reader.clock(*clock),
                    TypedMeasure::Data(e) => reader.data(e),
                });
            }
        }
    }
}

/// A query counts the variables and clocks of its automata on, in the network's order; shared clocks come first.
struct QueryReader<'a> {
    automata: &'a [usize],
    reads: &'a mut QueryReads,
}

impl QueryReader<'_> {
    fn formula(&mut self, formula: &TypedFormula) {
        match formula {
            TypedFormula::Data(e) => self.data(e),
            TypedFormula::Clock(bound) => {
                [Some(bound.clock), bound.minus].into_iter().flatten().for_each(|c| self.clock(c));
                bound.bound.terms.iter().for_each(|t| self.data(&t.value));
            }
            TypedFormula::Not(f) => self.formula(f),
            TypedFormula::And(fs) | TypedFormula::Or(fs) => fs.iter().for_each(|f| self.formula(f)),
            TypedFormula::At { .. } | TypedFormula::Deadlock => {}
        }
    }

    fn data(&mut self, e: &TypedExpr) {
        e.each_leaf(&mut |leaf| match leaf {
            VariableRef::Own(i) => {
                mark(self.automata, &mut self.reads.automata, usize::from(i), |r| &mut r.vars)
            }
            VariableRef::Shared(i) => {
                if let Some(read) = self.reads.shared.vars.get_mut(usize::from(i)) {
                    *read = true;
                }
            }
            VariableRef::Local(_) | VariableRef::Signal(_) => {}
        });
    }

    fn clock(&mut self, clock: ClockId) {
        let (at, shared) = (usize::from(clock.0), &mut self.reads.shared.clocks);
        match at.checked_sub(shared.len()) {
            None => shared[at] = true,
            Some(own) => mark(self.automata, &mut self.reads.automata, own, |r| &mut r.clocks),
        }
    }
}

/// Marks what is at this place when those of the automata are put one after the other.
fn mark(
    automata: &[usize],
    reads: &mut [QueryRead],
    mut at: usize,
    of: impl for<'r> Fn(&'r mut QueryRead) -> &'r mut Vec<bool>,
) {
    for automaton in automata {
        let Some(read) = reads.get_mut(*automaton) else { return };
        let all = of(read);
        match all.get_mut(at) {
            Some(read) => {
                *read = true;
                return;
            }
            None => at -= all.len(),
        }
    }
}
