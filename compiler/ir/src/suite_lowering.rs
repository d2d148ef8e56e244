//! Suites over the Program's expressions.

use crate::{
    lowering::{LowerExpr, VariableSlots},
    suite::{
        BeliefChoice, BeliefCondition, CombinationCondition, CombinedTerm, SearchGoal, Suite, SuiteMethod,
        ValueCombinations,
    },
};

/// What becomes of a goal of a suite by search.
pub type LowerGoal<'a, E, T> = &'a dyn Fn(&SearchGoal<E, T>) -> SearchGoal;

impl<E, T> Suite<E, T> {
    /// The suite over the Program's expressions.
    #[must_use]
    pub fn lower(&self, f: LowerExpr<'_, E>, goal: LowerGoal<'_, E, T>) -> Suite {
        Suite {
            name: self.name.clone(),
            method: self.method.lower(f, goal),
            settings: self.settings,
            origin: self.origin,
        }
    }
}

impl<E, T> SuiteMethod<E, T> {
    fn lower(&self, f: LowerExpr<'_, E>, goal: LowerGoal<'_, E, T>) -> SuiteMethod {
        match self {
            SuiteMethod::Agents { players, choose, explore, stop_after, goals, minimise, bounds } => {
                SuiteMethod::Agents {
                    players: players.clone(),
                    choose: choose.iter().map(|c| c.lower(f)).collect(),
                    explore: *explore,
                    stop_after: *stop_after,
                    goals: goals.clone(),
                    minimise: *minimise,
                    bounds: *bounds,
                }
            }
            SuiteMethod::Search { network, goals, witness, delays, diverse } => SuiteMethod::Search {
                network: *network,
                goals: goals.iter().map(goal).collect(),
                witness: *witness,
                delays: *delays,
                diverse: *diverse,
            },
            SuiteMethod::Random { stimuli, awaits, length_lo, length_hi, pause_lo, pause_hi, boundary } => {
                SuiteMethod::Random {
                    stimuli: stimuli.clone(),
                    awaits: awaits.clone(),
                    length_lo: *length_lo,
                    length_hi: *length_hi,
                    pause_lo: *pause_lo,
                    pause_hi: *pause_hi,
                    boundary: *boundary,
                }
            }
        }
    }
}

impl<E> BeliefChoice<E> {
    fn lower(&self, f: LowerExpr<'_, E>) -> BeliefChoice {
        let condition = |c: &BeliefCondition<E>| BeliefCondition {
            context: c.context.lower(f),
            vars: c.vars.clone(),
            origin: c.origin,
        };
        BeliefChoice {
            agent: self.agent,
            belief: self.belief,
            how: self.how,
            condition: self.condition.as_ref().map(condition),
        }
    }
}

impl<E, T> SearchGoal<E, T> {
    /// The goal over slots of its network; `text` gives what stands in the source.
    #[must_use]
    pub fn lower<V>(&self, slots: &dyn VariableSlots<E, V>, text: &dyn Fn(&T) -> String) -> SearchGoal {
        match self {
            SearchGoal::Bins(cross) => SearchGoal::Bins(*cross),
            SearchGoal::Locations => SearchGoal::Locations,
            SearchGoal::Edges => SearchGoal::Edges,
            SearchGoal::Pairs => SearchGoal::Pairs,
            SearchGoal::Uses => SearchGoal::Uses,
            SearchGoal::Values => SearchGoal::Values,
            SearchGoal::Combinations(all) => SearchGoal::Combinations(all.lower(slots, text)),
            SearchGoal::Bounds(step) => SearchGoal::Bounds(*step),
            SearchGoal::Violation(id) => SearchGoal::Violation(*id),
            SearchGoal::Trigger(id) => SearchGoal::Trigger(*id),
            SearchGoal::Query(id) => SearchGoal::Query(*id),
        }
    }
}

impl<E, T> ValueCombinations<E, T> {
    fn lower<V>(&self, slots: &dyn VariableSlots<E, V>, text: &dyn Fn(&T) -> String) -> ValueCombinations {
        let term = |term: &CombinedTerm<E, T>| CombinedTerm {
            text: text(&term.text),
            value: slots.expr(&term.value),
            values: term.values.clone(),
        };
        let condition = |condition: &CombinationCondition<E, T>| CombinationCondition {
            text: text(&condition.text),
            formula: condition.formula.lower(slots),
        };
        ValueCombinations {
            how: self.how,
            terms: self.terms.iter().map(term).collect(),
            when: self.when.as_ref().map(condition),
        }
    }
}
