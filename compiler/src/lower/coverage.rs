//! Coverage points and cross products.

use hrdsl_ir::coverage::{Coverage, Point};
use hrdsl_model as model;

use super::vocabulary::patterns;

pub(crate) fn coverage(scenario: &model::Scenario) -> Coverage {
    let point = |p: &model::CoverPoint| Point {
        name: p.name.clone(),
        count: patterns(&p.count),
        bins: p.bins.clone(),
        origin: p.span,
    };
    Coverage { points: scenario.points.iter().map(point).collect(), crosses: scenario.crosses.clone() }
}
