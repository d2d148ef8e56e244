//! Poses, joints, contacts and signals of a recording as columns.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Nanos, Type, Value,
    world::{BodyId, BodyRef, JointId, Signal, SignalId, SignalTerm},
};
use hrdsl_recording::scene::{RecordedPose, composed, relative};
use hrdsl_trace::{
    TraceStepKind,
    picture::{BodyKeyframe, ContactKeyframe, JointKeyframe, whole},
};

use super::run::{ReplayedRun, actor_of, tick};
use crate::{
    columns::{FINE, differences, rows, samples},
    document::{ContactTrack, PoseTrack, SignalKind, SignalTrack},
};

/// What a whole number of a signal stands for.
const SCALE: f64 = 1e-4;

fn times<'t>(times: impl Iterator<Item = &'t Nanos>) -> Vec<i64> {
    differences(times.map(|time| tick(*time) as i64))
}

/// The tracks of bodies that move, and of those that they carry.
pub(super) fn poses(run: &ReplayedRun<'_>) -> Vec<PoseTrack> {
    let moved: BTreeMap<usize, &Vec<BodyKeyframe>> =
        run.file.picture.bodies.iter().map(|track| (usize::from(track.body.0), &track.frames)).collect();
    let track = |(at, body): (usize, &hrdsl_recording::scene::RecordedBody)| {
        if let Some(frames) = moved.get(&at) {
            return Some(pose_track(at, frames));
        }
        let frames = moved.get(&body.carrier?)?;
        let carrier = run.scene.bodies.get(body.carrier?)?;
        let within = relative(&carrier.pose, &body.pose);
        let carried: Vec<BodyKeyframe> = frames.iter().map(|frame| carried(frame, &within)).collect();
        Some(pose_track(at, &carried))
    };
    run.scene.bodies.iter().enumerate().filter_map(track).collect()
}

fn pose_of(frame: &BodyKeyframe) -> RecordedPose {
    let ([x, y, z], [i, j, k, w]) =
        (frame.place.map(|n| n as f64 / FINE), frame.turn.map(|n| n as f64 / FINE));
    [x, y, z, i, j, k, w]
}

fn carried(frame: &BodyKeyframe, within: &RecordedPose) -> BodyKeyframe {
    let [x, y, z, turn @ ..] = composed(&pose_of(frame), within);
    let whole = |x: f64| whole(x, FINE);
    BodyKeyframe { time: frame.time, place: [x, y, z].map(whole), turn: turn.map(whole) }
}

fn pose_track(body: usize, frames: &[BodyKeyframe]) -> PoseTrack {
    let places: Vec<i64> = frames.iter().flat_map(|frame| frame.place).collect();
    let turns: Vec<i64> = frames.iter().flat_map(|frame| frame.turn).collect();
    let turns = rows(&turns, 4);
    let is_turning = turns.iter().skip(4).any(|d| *d != 0) || turns.first_chunk() != Some(&[0, 0, 0, 10_000]);
    PoseTrack {
        body,
        t: times(frames.iter().map(|frame| &frame.time)),
        p: rows(&places, 3),
        q: if is_turning { turns } else { Vec::new() },
    }
}

/// Where the middle of a body was, as far as the recording knows.
pub(super) fn place_at(run: &ReplayedRun<'_>, body: usize, time: Nanos) -> Option<[f64; 3]> {
    let start = run.scene.bodies.get(body)?;
    let carrier = start.carrier.and_then(|at| Some((at, run.scene.bodies.get(at)?)));
    let (moving, within) = match carrier {
        Some((at, carrier)) => (at, Some(relative(&carrier.pose, &start.pose))),
        None => (body, None),
    };
    let track = run.file.picture.bodies.iter().find(|track| usize::from(track.body.0) == moving);
    let frame = track.and_then(|track| {
        let before = track.frames.iter().rev().find(|frame| frame.time <= time);
        before.or_else(|| track.frames.first())
    });
    let Some(frame) = frame else { return start.pose.first_chunk().copied() };
    let pose = within.map_or_else(|| pose_of(frame), |within| composed(&pose_of(frame), &within));
    pose.first_chunk().copied()
}

pub(super) fn joints(run: &ReplayedRun<'_>) -> Vec<SignalTrack> {
    let track = |track: &hrdsl_trace::picture::JointKeyframes| {
        let joint = run.scene.joints.get(usize::from(track.joint.0))?;
        let frames: &[JointKeyframe] = &track.frames;
        let mut before = 0;
        let step =
            |frame: &JointKeyframe| Some(frame.position - std::mem::replace(&mut before, frame.position));
        Some(SignalTrack {
            name: joint.name.clone(),
            actor: actor_of(run.program, &joint.name),
            kind: SignalKind::Float,
            unit: Some(joint.unit.clone()),
            scale: Some(SCALE),
            limits: joint.limits,
            linear: true,
            t: times(frames.iter().map(|frame| &frame.time)),
            v: frames.iter().map(step).collect(),
            ..SignalTrack::default()
        })
    };
    run.file.picture.joints.iter().filter_map(track).collect()
}

pub(super) fn contacts(run: &ReplayedRun<'_>) -> Vec<ContactTrack> {
    let track = |track: &hrdsl_trace::picture::ContactKeyframes| {
        let frames: &[ContactKeyframe] = &track.frames;
        let points: Vec<i64> = frames.iter().flat_map(|frame| frame.point).collect();
        let forces: Vec<i64> = frames.iter().flat_map(|frame| frame.force).collect();
        ContactTrack {
            bodies: track.bodies.map(|body| usize::from(body.0)),
            t: times(frames.iter().map(|frame| &frame.time)),
            p: rows(&points, 3),
            f: rows(&forces, 3),
        }
    };
    run.file.picture.contacts.iter().map(track).collect()
}

/// Those signals that the recording has values of.
pub(super) fn signals(run: &ReplayedRun<'_>) -> Vec<SignalTrack> {
    let mut seen: BTreeMap<SignalId, Vec<(Nanos, Value)>> = BTreeMap::new();
    for step in &run.trace.steps {
        if let TraceStepKind::Sample { signal, value } = &step.what {
            seen.entry(*signal).or_default().push((step.time, *value));
        }
    }
    seen.into_iter().map(|(id, values)| signal_track(run, run.program.signal(id), &values)).collect()
}

fn signal_track(run: &ReplayedRun<'_>, signal: &Signal, values: &[(Nanos, Value)]) -> SignalTrack {
    let (kind, unit, names) = match signal.ty {
        Type::Bool => (SignalKind::Bool, "", Vec::new()),
        Type::Int { .. } => (SignalKind::Int, "", Vec::new()),
        Type::Float(unit) => (SignalKind::Float, unit.symbol(), Vec::new()),
        Type::Enum(_) | Type::Text | Type::List(_) => (SignalKind::Enum, "", words(values)),
    };
    let number = |value: &Value| match value {
        Value::Bool(is) => f64::from(u8::from(*is)),
        Value::Int(n) => *n as f64,
        Value::Float(x) => *x,
        Value::Symbol(_) | Value::Text(_) | Value::List(_) => {
            let word = value.to_string();
            names.iter().position(|name| *name == word).map_or(f64::NAN, |at| at as f64)
        }
    };
    let scale = if kind == SignalKind::Float { SCALE } else { 1.0 };
    let v = samples(values.iter().map(|(_, value)| number(value)), scale);
    SignalTrack {
        name: signal.name.clone(),
        actor: signal.terms.iter().find_map(|term| {
            let body = run.scene.bodies.get(*bodies_of(run, term).first()?)?;
            actor_of(run.program, &body.name)
        }),
        kind,
        unit: (!unit.is_empty()).then(|| unit.to_owned()),
        scale: (kind == SignalKind::Float).then_some(SCALE),
        sensor: !signal.to.is_empty(),
        t: times(values.iter().map(|(time, _)| time)),
        v,
        values: names,
        ..SignalTrack::default()
    }
}

/// Numbers that were worked out from signals.
pub(super) fn number_track(name: &str, unit: &str, values: &[(Nanos, f64)]) -> SignalTrack {
    SignalTrack {
        name: name.to_owned(),
        kind: SignalKind::Float,
        unit: (!unit.is_empty()).then(|| unit.to_owned()),
        scale: Some(SCALE),
        t: times(values.iter().map(|(time, _)| time)),
        v: samples(values.iter().map(|(_, value)| *value), SCALE),
        ..SignalTrack::default()
    }
}

/// A truth over time; `None` where nobody knows.
pub(super) fn truth_track(name: &str, values: impl Iterator<Item = (Nanos, Option<bool>)>) -> SignalTrack {
    let mut kept: Vec<(Nanos, Option<bool>)> = Vec::new();
    for (time, value) in values {
        // A tick is the least that is seen: what is true for a shorter while is true for one.
        if kept.last().is_none_or(|(_, before)| *before != value) {
            kept.push((time, value));
        }
    }
    let number = |value: &Option<bool>| value.map_or(f64::NAN, |is| f64::from(u8::from(is)));
    SignalTrack {
        name: name.to_owned(),
        kind: SignalKind::Bool,
        t: times(kept.iter().map(|(time, _)| time)),
        v: samples(kept.iter().map(|(_, value)| number(value)), 1.0),
        ..SignalTrack::default()
    }
}

/// The different values, in the order in which they come.
fn words(values: &[(Nanos, Value)]) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in values.iter().map(|(_, value)| value.to_string()) {
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words
}

/// The places of the bodies that a measurement is about.
pub(super) fn bodies_of(run: &ReplayedRun<'_>, term: &SignalTerm) -> Vec<usize> {
    let of = |body: &BodyRef| -> Option<usize> {
        let id: BodyId = match body {
            BodyRef::Body(id) => *id,
            BodyRef::Current(current) => {
                let world = run.program.world.as_ref()?;
                *world.currents.get(usize::from(current.0))?.of.first()?
            }
        };
        // The recording's own scene may be another one.
        let name = &run.program.world.as_ref()?.bodies.get(usize::from(id.0))?.name;
        run.scene.bodies.iter().position(|body| body.name == *name)
    };
    let world = run.program.world.as_ref();
    let joint = |id: &JointId| {
        let child = world?.joints.get(usize::from(id.0))?.child;
        of(&BodyRef::Body(child))
    };
    let bodies: Vec<&BodyRef> = match term {
        SignalTerm::Distance(a, b)
        | SignalTerm::Range(a, b)
        | SignalTerm::Angle(a, b)
        | SignalTerm::Visible(a, b)
        | SignalTerm::Touches(a, b)
        | SignalTerm::Force(a, b) => vec![a, b],
        SignalTerm::Coordinate(body, _)
        | SignalTerm::Holds(_, body)
        | SignalTerm::Speed(body)
        | SignalTerm::ForceOn(body)
        | SignalTerm::Weight(body)
        | SignalTerm::Tilt(body)
        | SignalTerm::Height(body)
        | SignalTerm::Heading(body)
        | SignalTerm::Orientation(body, _) => vec![body],
        SignalTerm::Pressed { body, by, .. } | SignalTerm::Pressure { body, by, .. } => {
            std::iter::once(body).chain(by).collect()
        }
        SignalTerm::JointRate(id) | SignalTerm::JointPosition(id) | SignalTerm::JointEffort(id) => {
            return joint(id).into_iter().collect();
        }
        SignalTerm::JointSpeed(id) => {
            let arm = world.and_then(|world| world.arms.get(usize::from(id.0)));
            return arm.and_then(|arm| of(&BodyRef::Body(arm.tip))).into_iter().collect();
        }
        SignalTerm::HoldsAny(id) => {
            let hand = world.and_then(|world| world.grippers.get(usize::from(id.0)));
            return hand.and_then(|hand| of(&BodyRef::Body(hand.palm))).into_iter().collect();
        }
        SignalTerm::Nearest { laser, .. } => {
            let laser = world.and_then(|world| world.lasers.get(usize::from(laser.0)));
            return laser.and_then(|laser| of(&BodyRef::Body(laser.body))).into_iter().collect();
        }
        SignalTerm::Delta(..) | SignalTerm::Reading(_) => Vec::new(),
    };
    bodies.into_iter().filter_map(of).collect()
}
