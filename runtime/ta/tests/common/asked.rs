//! Asks the engine for goals of the first network.

use hrdsl_ir::Program;
use hrdsl_ta::{
    CompiledNetwork, GoalKind, ObservationOptions, ReachabilityGoal, SearchError, SearchOptions,
    SearchReport, explore,
};

pub fn asked(
    p: &Program,
    goals: &[ReachabilityGoal],
    options: &SearchOptions,
) -> Result<SearchReport, SearchError> {
    let formulas = goals.iter().filter_map(|g| match &g.what {
        GoalKind::Formula(f) => Some(f.clone()),
        GoalKind::Location { .. }
        | GoalKind::Edge { .. }
        | GoalKind::Pair { .. }
        | GoalKind::Use { .. }
        | GoalKind::Condition(_) => None,
    });
    let observe = ObservationOptions { formulas: formulas.collect(), ..ObservationOptions::default() };
    let model = CompiledNetwork::new(p, &p.networks[0], &observe)?;
    explore(&model, goals, options, &|_| true)
}
