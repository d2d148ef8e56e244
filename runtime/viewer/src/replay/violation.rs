//! Requirements over a recording: the monitors run over it again, and tell all that they do.

use hrdsl_ir::{
    Type, Unit, Value,
    monitor::{Monitor, MonitorEffect, MonitorTrigger, RequirementKind},
    value::seconds,
    world::SignalId,
};
use hrdsl_monitor::{MonitorHappening, MonitorOutcome, MonitorRunner, MonitorVerdict};
use hrdsl_trace::{TraceObserver, TraceStepKind, print};

use super::{
    formula::{self, TapedFormula},
    measure::{self, FoundMeasures},
    run::{ReplayedRun, tick},
};
use crate::{
    columns::differences,
    document::SignalTrack,
    requirement::{ObligationOutcome, ViewObligation, ViewRequirement, ViewVerdict, ViewViolation},
};

/// The requirements, and the values of what they measure that no signal says.
pub(super) fn requirements(run: &ReplayedRun<'_>) -> (Vec<ViewRequirement>, Vec<SignalTrack>) {
    let mut runner = MonitorRunner::new(run.program).recounting();
    for (at, step) in run.trace.steps.iter().enumerate() {
        runner.step(at, step);
    }
    // What a run that broke off did not do, it might have done.
    if run.is_whole {
        runner.end(run.trace.end);
    }
    let monitors = run.program.monitors.iter().zip(runner.recounted());
    let mut values: Vec<SignalTrack> = Vec::new();
    let mut all = Vec::new();
    for (monitor, (verdict, history)) in monitors {
        let looked_at = verdict.first_failure.as_ref().map(|failure| failure.time);
        let looked_at = looked_at.or(verdict.worst_margin.map(|(_, time)| time)).unwrap_or_default();
        let taped = TapedFormula::new(run, monitor);
        let found = measure::measures(run, monitor, taped.as_ref(), looked_at);
        for track in found.values {
            if values.iter().all(|known| known.name != track.name) {
                values.push(track);
            }
        }
        let judged = requirement(run, monitor, taped.as_ref(), &verdict, &history);
        let FoundMeasures { measures, condition, meets, at, .. } = found;
        all.push(ViewRequirement { measures, condition, meets, at, ..judged });
    }
    (all, values)
}

/// The names of what a monitor reads: signals, and events.
fn read(run: &ReplayedRun<'_>, monitor: &Monitor) -> (Vec<String>, Vec<String>) {
    let signals = monitor.signals.iter().map(|id| run.program.signal(*id).name.clone()).collect();
    let on_edges = monitor.edges.iter().flat_map(|edge| match &edge.on {
        MonitorTrigger::Event(patterns) => patterns.as_slice(),
        MonitorTrigger::Becomes { .. } | MonitorTrigger::Sample | MonitorTrigger::Deadline => &[],
    });
    let mut events = Vec::new();
    for pattern in on_edges.chain(formula::events(monitor)) {
        let name = &run.program.event(pattern.event).name;
        if !events.contains(name) {
            events.push(name.clone());
        }
    }
    (signals, events)
}

fn requirement(
    run: &ReplayedRun<'_>,
    monitor: &Monitor,
    taped: Option<&TapedFormula>,
    verdict: &MonitorVerdict,
    history: &[MonitorHappening],
) -> ViewRequirement {
    let (triggers, told) = match taped {
        Some(taped) => taped.told(run),
        None => {
            let triggers = history.iter().filter(|h| h.effects.contains(&MonitorEffect::Trigger));
            (triggers.map(|h| h.time).collect::<Vec<_>>(), told(run, history))
        }
    };
    let unit = monitor.margin_unit().map(|unit| unit.symbol().to_owned());
    let (signals, events) = read(run, monitor);
    ViewRequirement {
        id: monitor.name.clone(),
        title: (!monitor.title.is_empty()).then(|| monitor.title.clone()),
        kind: Some(
            match monitor.kind {
                RequirementKind::Safety => "safety",
                RequirementKind::Functional => "functional",
            }
            .to_owned(),
        ),
        text: Some(monitor.text.clone()),
        verdict: match verdict.outcome {
            MonitorOutcome::Fail => ViewVerdict::Fail,
            MonitorOutcome::Pass | MonitorOutcome::Vacuous | MonitorOutcome::Inconclusive
                if !run.is_whole =>
            {
                ViewVerdict::Error
            }
            MonitorOutcome::Pass => ViewVerdict::Pass,
            MonitorOutcome::Vacuous => ViewVerdict::Vacuous,
            MonitorOutcome::Inconclusive => ViewVerdict::Inconclusive,
        },
        margin: verdict.worst_margin.map(|(margin, _)| margin),
        unit: unit.filter(|unit| !unit.is_empty()),
        triggers: differences(triggers.into_iter().map(|time| tick(time) as i64)),
        obligations: told.obligations,
        violations: told.violations,
        signals,
        events,
        ..ViewRequirement::default()
    }
}

/// The story of one requirement.
#[derive(Default)]
pub(super) struct ToldRequirement {
    pub obligations: Vec<ViewObligation>,
    pub violations: Vec<ViewViolation>,
}

/// What is pending, and the step that made it.
type OpenObligation = Option<(ViewObligation, Option<usize>)>;

fn told(run: &ReplayedRun<'_>, history: &[MonitorHappening]) -> ToldRequirement {
    let mut told = ToldRequirement::default();
    let mut open: OpenObligation = None;
    for happening in history {
        let has = |effect| happening.effects.contains(&effect);
        let now = tick(happening.time);
        if has(MonitorEffect::Fail) {
            told.violations.push(violation(run, happening, &open));
        }
        let outcome = if has(MonitorEffect::Fail) {
            Some(ObligationOutcome::Violated)
        } else if has(MonitorEffect::Discharge) {
            Some(ObligationOutcome::Met)
        } else {
            (!happening.pending).then_some(ObligationOutcome::Dropped)
        };
        if let Some(outcome) = outcome
            && let Some((obligation, _)) = open.take()
        {
            told.obligations.push(ViewObligation { until: Some(now), outcome, ..obligation });
        }
        if has(MonitorEffect::Trigger) && happening.pending && open.is_none() {
            let obligation = ViewObligation {
                from: now,
                until: None,
                deadline: happening.due.map(tick),
                outcome: ObligationOutcome::Pending,
                trigger: happening.step.and_then(|step| step_text(run, step)),
            };
            open = Some((obligation, happening.step));
        }
    }
    told.obligations.extend(open.map(|(obligation, _)| obligation));
    told
}

fn violation(run: &ReplayedRun<'_>, happening: &MonitorHappening, open: &OpenObligation) -> ViewViolation {
    let values: Vec<String> =
        happening.values.iter().map(|(signal, value)| signal_text(run, *signal, *value)).collect();
    let values = values.join(", ");
    let event = happening.step.and_then(|step| step_text(run, step));
    let step = happening.step.and_then(|step| run.trace.steps.get(step));
    let is_event = step.is_some_and(|step| matches!(step.what, TraceStepKind::Event { .. }));
    let text = match (event.filter(|_| is_event), open) {
        (Some(event), _) if values.is_empty() => format!("`{event}` happened."),
        (Some(event), _) => format!("`{event}` happened while {values}."),
        (None, Some((obligation, _))) => {
            let made = obligation.trigger.as_deref().unwrap_or("an obligation");
            format!("Nothing met `{made}`, and its time was over at {} s.", seconds(happening.time))
        }
        (None, None) if values.is_empty() => "It was violated.".to_owned(),
        (None, None) => format!("It was violated by {values}."),
    };
    let steps = open.iter().filter_map(|(_, step)| *step).chain(happening.step);
    ViewViolation {
        t: tick(happening.time),
        text,
        since: open.as_ref().map(|(obligation, _)| obligation.from),
        until: None,
        steps: steps.map(|step| step as u64).collect(),
    }
}

fn step_text(run: &ReplayedRun<'_>, step: usize) -> Option<String> {
    let step = run.trace.steps.get(step)?;
    Some(print::who_did_what(run.program, &step.what).1)
}

pub(super) fn signal_text(run: &ReplayedRun<'_>, signal: SignalId, value: Value) -> String {
    let signal = run.program.signal(signal);
    let unit = match signal.ty {
        Type::Float(unit) => unit,
        Type::Bool | Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_) => Unit::None,
    };
    format!("{} = {}", signal.name, print::value(value, unit))
}
