//! What a requirement compares with a limit, as far as it can be drawn.

use hrdsl_ir::{
    Nanos, Type, Unit,
    monitor::{Monitor, MonitorEffect, MonitorTrigger},
    world::{RuleTrigger, SignalId, WorldRule},
};

use super::{
    about,
    compared::{LimitComparison, in_condition, in_margin},
    derived,
    run::ReplayedRun,
    tracks::number_track,
};
use crate::{
    document::SignalTrack,
    requirement::{MeasureKind, ViewMeasure},
};

/// What a requirement measures, and the values of what no signal of the scenario says.
#[derive(Default)]
pub(super) struct FoundMeasures {
    pub measures: Vec<ViewMeasure>,
    pub values: Vec<SignalTrack>,
}

/// The comparisons in a monitor's margin; without one, those by which the world tells the events that violate it. `at` is the instant
/// that is looked at first.
pub(super) fn measures(run: &ReplayedRun<'_>, monitor: &Monitor, at: Nanos) -> FoundMeasures {
    let mut compared = Vec::new();
    if let Some(margin) = &monitor.margin {
        in_margin(&margin.value, &mut compared);
    }
    let mut found = FoundMeasures::default();
    let mut measures: Vec<(f64, ViewMeasure)> = Vec::new();
    for one in &compared {
        let Some((measure, values)) = judged(run, &monitor.signals, one, at) else { continue };
        let value = derived::value_at(run, &monitor.signals, &one.measured, at).unwrap_or(f64::NAN);
        measures.push((one.margin(value), measure));
        found.values.extend(values);
    }
    // The first is drawn: the one that is worst then.
    measures.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    found.measures = measures.into_iter().map(|(_, measure)| measure).collect();
    if compared.is_empty() {
        found.measures = told_by_events(run, monitor, at);
    }
    found
}

fn judged(
    run: &ReplayedRun<'_>,
    signals: &[SignalId],
    one: &LimitComparison,
    at: Nanos,
) -> Option<(ViewMeasure, Option<SignalTrack>)> {
    let name = derived::text(run, signals, &one.measured)?;
    let unit = unit_of(run, signals, one);
    let is_known = run.program.signals.iter().any(|signal| signal.recorded && signal.name == name);
    let values = (!is_known).then(|| {
        let values = derived::values(run, signals, &one.measured);
        number_track(&name, unit.symbol(), &values)
    });
    let subject = about::subject(run, signals, &one.measured, at);
    let measure = ViewMeasure {
        kind: subject.kind,
        name,
        bodies: subject.bodies,
        within: subject.within,
        axes: subject.axes,
        relation: one.relation,
        limit: one.limit,
        unit: (!unit.symbol().is_empty()).then(|| unit.symbol().to_owned()),
        tells: None,
        points: None,
    };
    Some((measure, values.filter(|track| !track.t.is_empty())))
}

/// The unit of the first signal that is read.
fn unit_of(run: &ReplayedRun<'_>, signals: &[SignalId], one: &LimitComparison) -> Unit {
    let first = about::slots(&one.measured).first().and_then(|slot| signals.get(usize::from(*slot)));
    match first.map(|id| run.program.signal(*id).ty) {
        Some(Type::Float(unit)) => unit,
        Some(Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_)) | None => Unit::None,
    }
}

/// `never fell`, where the world tells `fell` by one comparison: what that is about, for looking only.
fn told_by_events(run: &ReplayedRun<'_>, monitor: &Monitor, at: Nanos) -> Vec<ViewMeasure> {
    let violating = monitor.edges.iter().filter(|edge| edge.effects.contains(&MonitorEffect::Fail));
    let patterns = violating.flat_map(|edge| match &edge.on {
        MonitorTrigger::Event(patterns) => patterns.as_slice(),
        MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => &[],
    });
    let mut events = Vec::new();
    for pattern in patterns {
        if !events.contains(&pattern.event) {
            events.push(pattern.event);
        }
    }
    let rules = run.program.world.iter().flat_map(|world| &world.rules);
    let told = rules.filter(|rule| events.contains(&rule.event) && rule.guard.is_none());
    told.filter_map(|rule| told_by(run, rule, at)).collect()
}

fn told_by(run: &ReplayedRun<'_>, rule: &WorldRule, at: Nanos) -> Option<ViewMeasure> {
    let RuleTrigger::Edge { rising, condition, .. } = &rule.on else { return None };
    let one = in_condition(condition, !rising)?;
    let (measure, _) = judged(run, &rule.signals, &one, at)?;
    // Nobody recorded it; these the page works out from the poses.
    let is_seen = matches!(measure.kind, MeasureKind::Tilt | MeasureKind::Way) && !measure.bodies.is_empty();
    let tells = Some(run.program.event(rule.event).name.clone());
    is_seen.then_some(ViewMeasure { tells, ..measure })
}
