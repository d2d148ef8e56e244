//! Makes the file of a run. The same run gives the same bytes.

use std::collections::BTreeMap;

use hrdsl_ir::Nanos;
use hrdsl_trace::{
    Trace, TraceStepKind,
    picture::{BodyKeyframe, WorldPicture},
};
use serde_json::json;

use crate::{
    channel::RecordingChannel,
    container::ContainerWriter,
    foxglove::{self, WORLD},
    message::{RecordedLogLine, VerdictMessage},
    number::decimal,
    scene::RecordedScene,
    schema,
};

/// What is known of a run when it is over.
#[derive(Clone, Copy, Debug)]
pub struct RunOnFile<'a> {
    pub trace: &'a Trace,
    /// The trace as a recording in text.
    pub text: &'a str,
    pub scene: &'a RecordedScene,
    pub picture: &'a WorldPicture,
    pub log: &'a [RecordedLogLine],
    pub verdicts: &'a [VerdictMessage],
}

/// A message that is to be written.
struct PlannedMessage {
    time: Nanos,
    channel: RecordingChannel,
    /// Of a judged one, its line; 0 of others.
    sequence: usize,
    data: Vec<u8>,
}

/// The file, as bytes.
///
/// # Errors
/// That the run is too large for the format.
pub fn write(run: &RunOnFile<'_>) -> Result<Vec<u8>, String> {
    let mut seen = seen(run);
    seen.sort_by_key(|message| message.time);
    file(&[judged(run), seen]).map_err(|e| format!("the recording cannot be written: {e}"))
}

/// Each part in chunks of its own: what is alike is packed together, and if a file is cut, what is judged is still there.
fn file(parts: &[Vec<PlannedMessage>; 2]) -> std::io::Result<Vec<u8>> {
    let mut writer = ContainerWriter::new(concat!("hrdsl ", env!("CARGO_PKG_VERSION")));
    let mut channels = BTreeMap::new();
    for channel in RecordingChannel::ALL {
        if parts.iter().flatten().any(|message| message.channel == channel) {
            let (name, schema) = schema::of_channel(channel);
            channels.insert(channel, writer.channel(channel.topic(), name, &schema.to_string()));
        }
    }
    for part in parts {
        for message in part {
            let Some(channel) = channels.get(&message.channel).copied() else { continue };
            let time = message.time.max(0).unsigned_abs();
            let sequence = u32::try_from(message.sequence).unwrap_or(u32::MAX);
            writer.message(channel, sequence, time, &message.data)?;
        }
        writer.close_chunk()?;
    }
    writer.finish()
}

/// The lines of the text form, each on the channel of what it says.
fn judged(run: &RunOnFile<'_>) -> Vec<PlannedMessage> {
    let lines: Vec<&str> = run.text.lines().collect();
    let message = |(at, line): (usize, &&str)| {
        let step = at.checked_sub(1).and_then(|step| run.trace.steps.get(step));
        let (time, channel) = match step {
            Some(step) => (step.time, channel_of(&step.what)),
            None if at == 0 => (0, RecordingChannel::Header),
            None => (run.trace.end, RecordingChannel::End),
        };
        PlannedMessage { time, channel, sequence: at, data: line.as_bytes().to_vec() }
    };
    lines.iter().enumerate().map(message).collect()
}

fn channel_of(what: &TraceStepKind) -> RecordingChannel {
    match what {
        TraceStepKind::Event { .. } => RecordingChannel::Events,
        TraceStepKind::Sample { .. } => RecordingChannel::Signals,
        TraceStepKind::Machine(_) => RecordingChannel::Machines,
    }
}

/// All that is not judged.
fn seen(run: &RunOnFile<'_>) -> Vec<PlannedMessage> {
    let message =
        |time, channel, data: String| PlannedMessage { time, channel, sequence: 0, data: data.into() };
    let mut planned = Vec::new();
    if !run.scene.bodies.is_empty() {
        let scene = serde_json::to_string(run.scene).unwrap_or_default();
        planned.push(message(0, RecordingChannel::Scene, scene));
        planned.push(message(0, RecordingChannel::Entities, foxglove::entities(run.scene).to_string()));
        let start = foxglove::start_transforms(run.scene).to_string();
        planned.push(message(0, RecordingChannel::Transforms, start));
    }
    let by_time = |all: BTreeMap<Nanos, Vec<String>>, channel, put: &dyn Fn(Nanos, String) -> String| {
        let put = |(time, parts): (Nanos, Vec<String>)| message(time, channel, put(time, parts.join(",")));
        all.into_iter().map(put).collect::<Vec<_>>()
    };
    planned.extend(by_time(transforms(run), RecordingChannel::Transforms, &|_, parts| {
        format!("{{\"transforms\":[{parts}]}}")
    }));
    planned.extend(by_time(joints(run), RecordingChannel::Joints, &|time, parts| {
        format!("{{\"timestamp\":{},\"joints\":[{parts}]}}", timestamp(time))
    }));
    planned.extend(by_time(contacts(run), RecordingChannel::Contacts, &|_, parts| {
        format!("{{\"contacts\":[{parts}]}}")
    }));
    planned.extend(run.log.iter().map(|entry| {
        let data = json!({
            "timestamp": { "sec": entry.time / SECOND, "nsec": entry.time % SECOND },
            "level": entry.level.number(),
            "message": entry.text,
            "name": entry.program,
            "file": "",
            "line": 0,
        });
        message(entry.time, RecordingChannel::Log, data.to_string())
    }));
    planned.extend(run.verdicts.iter().map(|verdict| {
        let data = serde_json::to_string(verdict).unwrap_or_default();
        message(run.trace.end, RecordingChannel::Verdicts, data)
    }));
    planned
}

const SECOND: Nanos = 1_000_000_000;

fn timestamp(time: Nanos) -> String {
    format!("{{\"sec\":{},\"nsec\":{}}}", time / SECOND, time % SECOND)
}

fn fine(n: i64) -> String {
    decimal(n, 10_000)
}

fn vector([x, y, z]: [i64; 3]) -> String {
    format!("{{\"x\":{},\"y\":{},\"z\":{}}}", fine(x), fine(y), fine(z))
}

fn text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The transforms of each time, in the order of bodies.
fn transforms(run: &RunOnFile<'_>) -> BTreeMap<Nanos, Vec<String>> {
    let mut all: BTreeMap<Nanos, Vec<String>> = BTreeMap::new();
    for track in &run.picture.bodies {
        let Some(body) = run.scene.bodies.get(usize::from(track.body.0)) else { continue };
        let name = text(&body.name);
        for BodyKeyframe { time, place, turn: [i, j, k, w] } in &track.frames {
            all.entry(*time).or_default().push(format!(
                "{{\"timestamp\":{},\"parent_frame_id\":\"{WORLD}\",\"child_frame_id\":{name},\"translation\":{},\
                 \"rotation\":{{\"x\":{},\"y\":{},\"z\":{},\"w\":{}}}}}",
                timestamp(*time),
                vector(*place),
                fine(*i),
                fine(*j),
                fine(*k),
                fine(*w),
            ));
        }
    }
    all
}

fn joints(run: &RunOnFile<'_>) -> BTreeMap<Nanos, Vec<String>> {
    let mut all: BTreeMap<Nanos, Vec<String>> = BTreeMap::new();
    for track in &run.picture.joints {
        let Some(joint) = run.scene.joints.get(usize::from(track.joint.0)) else { continue };
        let name = text(&joint.name);
        for frame in &track.frames {
            let part = format!("{{\"name\":{name},\"position\":{}}}", fine(frame.position));
            all.entry(frame.time).or_default().push(part);
        }
    }
    all
}

fn contacts(run: &RunOnFile<'_>) -> BTreeMap<Nanos, Vec<String>> {
    let mut all: BTreeMap<Nanos, Vec<String>> = BTreeMap::new();
    for track in &run.picture.contacts {
        let [a, b] = track.bodies.map(|body| run.scene.bodies.get(usize::from(body.0)));
        let (Some(a), Some(b)) = (a, b) else { continue };
        let names = format!("{},{}", text(&a.name), text(&b.name));
        for frame in &track.frames {
            let [x, y, z] = frame.point.map(fine);
            let [i, j, k] = frame.force.map(|n| decimal(n, 100));
            all.entry(frame.time)
                .or_default()
                .push(format!("{{\"bodies\":[{names}],\"point\":[{x},{y},{z}],\"force\":[{i},{j},{k}]}}"));
        }
    }
    all
}
