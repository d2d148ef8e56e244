//! What a requirement compares with limits, as far as it can be drawn, and how that makes it up.

use hrdsl_ir::{
    Nanos, Type, Unit,
    monitor::{Monitor, MonitorEffect, MonitorTrigger},
    value::seconds,
    world::{RuleTrigger, SignalId, WorldRule},
};

use super::{
    about,
    asked::{KeptCondition, LimitComparison},
    derived,
    formula::{self, TapedFormula},
    run::ReplayedRun,
    tracks::number_track,
};
use crate::{
    document::SignalTrack,
    requirement::{MeasureKind, ViewCondition, ViewMeasure},
};

/// What a requirement measures, how it is put together, and the values of what no signal of the scenario says.
#[derive(Default)]
pub(super) struct FoundMeasures {
    pub measures: Vec<ViewMeasure>,
    pub condition: Option<ViewCondition>,
    /// It is what meets an obligation.
    pub meets: bool,
    /// It is asked when one of these events happens.
    pub at: Vec<String>,
    pub values: Vec<SignalTrack>,
}

/// What a monitor asks for: in a formula, by what violates it, or else by its margin; without comparisons in them, by how the world tells the
/// events that violate it; and else by what meets an obligation. `at` is the instant that is looked at first.
pub(super) fn measures(
    run: &ReplayedRun<'_>,
    monitor: &Monitor,
    taped: Option<&TapedFormula>,
    at: Nanos,
) -> FoundMeasures {
    let reader =
        || MeasureReader { run, signals: &monitor.signals, text: &monitor.text, at, tells: None, taped };
    let kept = formula::asked(monitor)
        .or_else(|| kept(monitor))
        .or_else(|| monitor.margin.as_ref().and_then(|margin| KeptCondition::of_margin(&margin.value)));
    let first = kept.as_ref().map(|asked| reader().read(asked)).unwrap_or_default();
    if !first.measures.is_empty() {
        return FoundMeasures { at: asked_at(run, monitor), ..first };
    }
    let told = told_by_events(run, monitor, at);
    if !told.measures.is_empty() {
        return told;
    }
    if first.condition.is_some() {
        return FoundMeasures { at: asked_at(run, monitor), ..first };
    }
    let meeting = meeting(monitor).map(|asked| reader().read(&asked)).unwrap_or_default();
    FoundMeasures { meets: true, ..meeting }
}

/// What must be so, or the requirement is violated.
fn kept(monitor: &Monitor) -> Option<KeptCondition> {
    let mut parts = Vec::new();
    for edge in monitor.edges.iter().filter(|edge| edge.effects.contains(&MonitorEffect::Fail)) {
        let condition = match &edge.on {
            MonitorTrigger::Becomes { condition, truth, .. } => {
                monitor.conditions.get(usize::from(*condition)).map(|of| KeptCondition::of(of, !truth))
            }
            MonitorTrigger::Event(_) | MonitorTrigger::Sample | MonitorTrigger::Deadline => None,
        };
        let guard = edge.guard.as_ref().map(|guard| KeptCondition::of(guard, false));
        let both: Vec<KeptCondition> = condition.into_iter().chain(guard).collect();
        if !both.is_empty() {
            parts.push(KeptCondition::joined(false, both));
        }
    }
    (!parts.is_empty()).then(|| KeptCondition::joined(true, parts))
}

/// The events at which a monitor asks for what must be so, if it asks at no other time.
fn asked_at(run: &ReplayedRun<'_>, monitor: &Monitor) -> Vec<String> {
    let mut events: Vec<String> = Vec::new();
    for edge in monitor.edges.iter().filter(|edge| edge.effects.contains(&MonitorEffect::Fail)) {
        let MonitorTrigger::Event(patterns) = &edge.on else { return Vec::new() };
        for name in patterns.iter().map(|pattern| &run.program.event(pattern.event).name) {
            if !events.contains(name) {
                events.push(name.clone());
            }
        }
    }
    events
}

/// What meets an obligation, besides events.
fn meeting(monitor: &Monitor) -> Option<KeptCondition> {
    let mut parts = Vec::new();
    for edge in monitor.edges.iter().filter(|edge| edge.effects.contains(&MonitorEffect::Discharge)) {
        match &edge.on {
            MonitorTrigger::Becomes { condition, truth, .. } => {
                parts.extend(
                    monitor.conditions.get(usize::from(*condition)).map(|of| KeptCondition::of(of, *truth)),
                );
            }
            MonitorTrigger::Sample => {
                parts.extend(edge.guard.iter().map(|guard| KeptCondition::of(guard, true)))
            }
            MonitorTrigger::Event(_) | MonitorTrigger::Deadline => {}
        }
    }
    (!parts.is_empty()).then(|| KeptCondition::joined(false, parts))
}

/// Reads what is asked for over one list of signals.
#[derive(Clone, Copy)]
struct MeasureReader<'r, 'p> {
    run: &'r ReplayedRun<'p>,
    signals: &'r [SignalId],
    /// As the scenario has it, if that is known.
    text: &'r str,
    at: Nanos,
    /// The event that the world tells by it: nobody recorded the values.
    tells: Option<&'r str>,
    taped: Option<&'r TapedFormula>,
}

impl MeasureReader<'_, '_> {
    fn read(self, asked: &KeptCondition) -> FoundMeasures {
        let mut found = FoundMeasures::default();
        let mut margins = Vec::new();
        found.condition = self.condition(asked, &mut found, &mut margins);
        // The first is looked at: the one that is worst then.
        let mut order: Vec<usize> = (0..found.measures.len()).collect();
        let margin = |place: &usize| margins.get(*place).copied().unwrap_or(f64::NAN);
        order.sort_by(|a, b| margin(a).total_cmp(&margin(b)));
        found.measures = order.iter().filter_map(|place| found.measures.get(*place).cloned()).collect();
        if let Some(condition) = &mut found.condition {
            place_measures(condition, &order);
        }
        // Nothing more is said of the only measure.
        found.condition = found.condition.filter(|of| !matches!(of, ViewCondition::Measure { .. }));
        found
    }

    fn condition(
        self,
        asked: &KeptCondition,
        found: &mut FoundMeasures,
        margins: &mut Vec<f64>,
    ) -> Option<ViewCondition> {
        let mut all = |parts: &[KeptCondition]| -> Vec<ViewCondition> {
            parts.iter().filter_map(|part| self.condition(part, found, margins)).collect()
        };
        match asked {
            KeptCondition::All(parts) => {
                let of = all(parts);
                (!of.is_empty()).then_some(ViewCondition::All { of })
            }
            KeptCondition::Any(parts) => {
                let of = all(parts);
                (!of.is_empty()).then_some(ViewCondition::Any { of })
            }
            KeptCondition::Compared(one) => self.compared(one, found, margins),
            KeptCondition::Truth(expr, truth) => {
                let text = derived::text(self.run, self.signals, expr)?;
                let signal = Some(text.clone()).filter(|name| is_recorded(self.run, name));
                Some(ViewCondition::Fact { text, negated: !truth, signal })
            }
            KeptCondition::Happens(text, truth) => {
                Some(ViewCondition::Fact { text: text.clone(), negated: !truth, signal: None })
            }
            KeptCondition::Window { text, truth, formula, of } => {
                let of = all(of);
                let track = self.taped.zip(formula.as_ref()).map(|(taped, formula)| {
                    let name = taped.text(formula);
                    taped.truth(&name, formula)
                });
                let signal = track.as_ref().map(|track| track.name.clone());
                found.values.extend(track);
                Some(ViewCondition::Window { text: text.clone(), negated: !truth, signal, of })
            }
        }
    }

    fn compared(
        self,
        one: &LimitComparison,
        found: &mut FoundMeasures,
        margins: &mut Vec<f64>,
    ) -> Option<ViewCondition> {
        let (measure, values) = self.measure(one)?;
        let known = found.measures.iter().position(|other| *other == measure);
        let place = known.unwrap_or(found.measures.len());
        if known.is_none() {
            let value = derived::value_at(self.run, self.signals, &one.measured, self.at).unwrap_or(f64::NAN);
            margins.push(one.margin(value));
            found.measures.push(measure);
            found.values.extend(values);
        }
        Some(ViewCondition::Measure { measure: place })
    }

    /// `None`: it has no text, or nobody can say what its values were.
    fn measure(self, one: &LimitComparison) -> Option<(ViewMeasure, Option<SignalTrack>)> {
        let name = derived::text(self.run, self.signals, &one.measured)?;
        let unit = self.unit(one);
        let values = (!is_recorded(self.run, &name)).then(|| {
            let values = derived::values(self.run, self.signals, &one.measured);
            number_track(&name, unit.symbol(), &values)
        });
        let values = values.filter(|track| !track.t.is_empty());
        let subject = about::subject(self.run, self.signals, &one.measured, self.at);
        if self.tells.is_some() && !is_seen(subject.kind, &subject.bodies) {
            return None;
        }
        let measure = ViewMeasure {
            kind: subject.kind,
            name,
            bodies: subject.bodies,
            within: subject.within,
            axes: subject.axes,
            place: subject.place,
            relation: one.relation,
            limit: one.limit,
            unit: (!unit.symbol().is_empty()).then(|| unit.symbol().to_owned()),
            shown: self.run.units.shown(unit, one.limit, self.text),
            tells: self.tells.map(str::to_owned),
            points: None,
        };
        Some((measure, values))
    }

    /// The unit of the first signal that is read.
    fn unit(self, one: &LimitComparison) -> Unit {
        let first = about::slots(&one.measured).first().and_then(|slot| self.signals.get(usize::from(*slot)));
        match first.map(|id| self.run.program.signal(*id).ty) {
            Some(Type::Float(unit)) => unit,
            Some(Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_)) | None => {
                Unit::None
            }
        }
    }
}

/// Whether the page can work out, from where bodies are, what nobody recorded.
fn is_seen(kind: MeasureKind, bodies: &[usize]) -> bool {
    match kind {
        MeasureKind::Tilt
        | MeasureKind::Way
        | MeasureKind::Coordinate
        | MeasureKind::Offset
        | MeasureKind::Angle
        | MeasureKind::Range => !bodies.is_empty(),
        MeasureKind::Distance
        | MeasureKind::Height
        | MeasureKind::Speed
        | MeasureKind::Force
        | MeasureKind::Signal => false,
    }
}

fn is_recorded(run: &ReplayedRun<'_>, name: &str) -> bool {
    run.program.signals.iter().any(|signal| signal.recorded && signal.name == name)
}

/// Measures have other places now: `order` says which of those from before is in each.
fn place_measures(condition: &mut ViewCondition, order: &[usize]) {
    match condition {
        ViewCondition::Measure { measure } => {
            *measure = order.iter().position(|before| before == measure).unwrap_or(*measure);
        }
        ViewCondition::All { of }
        | ViewCondition::Any { of }
        | ViewCondition::Window { of, .. }
        | ViewCondition::Told { of, .. } => of.iter_mut().for_each(|part| place_measures(part, order)),
        ViewCondition::Fact { .. } => {}
    }
}

/// `never fell`, where the world tells `fell` by comparisons: what these are about, for looking only.
fn told_by_events(run: &ReplayedRun<'_>, monitor: &Monitor, at: Nanos) -> FoundMeasures {
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
    let mut all = FoundMeasures::default();
    let mut parts = Vec::new();
    for found in told.map(|rule| told_by(run, rule, at)) {
        let before = all.measures.len();
        if let Some(mut condition) = found.condition {
            let shift: Vec<usize> =
                (0..before + found.measures.len()).map(|place| place.wrapping_sub(before)).collect();
            place_measures(&mut condition, &shift);
            parts.push(condition);
        }
        all.measures.extend(found.measures);
    }
    all.condition = if parts.len() > 1 { Some(ViewCondition::All { of: parts }) } else { parts.pop() };
    all
}

fn told_by(run: &ReplayedRun<'_>, rule: &WorldRule, at: Nanos) -> FoundMeasures {
    let RuleTrigger::Edge { rising, condition, held } = &rule.on else { return FoundMeasures::default() };
    let event = &run.program.event(rule.event).name;
    let (signals, tells) = (&rule.signals[..], Some(event.as_str()));
    let reader = MeasureReader { run, signals, text: "", at, tells, taped: None };
    let found = reader.read(&KeptCondition::of(condition, !rising));
    if found.measures.is_empty() {
        return FoundMeasures::default();
    }
    let of = vec![found.condition.unwrap_or(ViewCondition::Measure { measure: 0 })];
    let held = (*held > 0).then(|| seconds(*held));
    FoundMeasures {
        condition: Some(ViewCondition::Told { event: event.clone(), held, of }),
        values: Vec::new(),
        ..found
    }
}
