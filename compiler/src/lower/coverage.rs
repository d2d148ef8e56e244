//! Coverage points and cross products.

use hrdsl_ir::coverage::{Bin, Condition, Coverage, Cross, CrossBin, Point, PointId};
use hrdsl_model as model;

use super::vocabulary::patterns;

pub(crate) fn coverage(scenario: &model::Scenario) -> Coverage {
    let bin = |b: &model::Bin| Bin { name: b.name.clone(), lo: b.lo, hi: b.hi };
    let point = |p: &model::CoverPoint| Point {
        name: p.name.clone(),
        count: patterns(&p.count),
        bins: p.bins.iter().map(bin).collect(),
        origin: p.span,
    };
    let cross_bin = |(name, when, span): &(String, model::Condition, hrdsl_ir::Span)| CrossBin {
        name: name.clone(),
        when: condition(when),
        origin: *span,
    };
    let cross = |c: &model::Cross| Cross {
        name: c.name.clone(),
        points: c.points.iter().map(|p| PointId(p.0)).collect(),
        bins: c.bins.iter().map(cross_bin).collect(),
        ignore: c.ignore.iter().map(condition).collect(),
        origin: c.span,
    };
    Coverage {
        points: scenario.points.iter().map(point).collect(),
        crosses: scenario.crosses.iter().map(cross).collect(),
    }
}

fn condition(c: &model::Condition) -> Condition {
    match c {
        model::Condition::In(point, bin) => Condition::In { point: PointId(point.0), bin: *bin },
        model::Condition::Not(c) => Condition::Not(Box::new(condition(c))),
        model::Condition::And(cs) => Condition::And(cs.iter().map(condition).collect()),
        model::Condition::Or(cs) => Condition::Or(cs.iter().map(condition).collect()),
    }
}
