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
    columns::{self, BLOCK, SampleTable, TracksMessage},
    container::ContainerWriter,
    foxglove::{self, WORLD},
    message::{LinesMessage, RecordedLogLine, RecordedTopic, TopicColumns, TopicsMessage, VerdictMessage},
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
    pub topics: &'a [RecordedTopic],
    pub lines: &'a [LinesMessage],
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

/// For whom a file is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordingForm {
    /// What changes over time lies in [`columns`](crate::columns), which take a third of the room. Other tools show the scene at its start.
    #[default]
    Columns,
    /// Each change is a message that other tools know.
    Messages,
}

/// The file, as bytes, in columns.
///
/// # Errors
/// That the run is too large for the format.
pub fn write(run: &RunOnFile<'_>) -> Result<Vec<u8>, String> {
    write_as(run, RecordingForm::Columns)
}

/// The file, as bytes, in one of its forms. Both read back to the same.
///
/// # Errors
/// That the run is too large for the format.
pub fn write_as(run: &RunOnFile<'_>, form: RecordingForm) -> Result<Vec<u8>, String> {
    let (mut seen, judged) = (seen(run, form), judged(run));
    seen.sort_by_key(|message| message.time);
    let judged = match form {
        RecordingForm::Columns => in_columns(judged),
        RecordingForm::Messages => judged,
    };
    file(&[judged, seen]).map_err(|e| format!("the recording cannot be written: {e}"))
}

/// Lines of samples in columns, block by block; the others as they are.
fn in_columns(lines: Vec<PlannedMessage>) -> Vec<PlannedMessage> {
    let mut planned = Vec::with_capacity(lines.len());
    let (mut table, mut begun) = (SampleTable::default(), 0);
    let close = |table: SampleTable, time, planned: &mut Vec<PlannedMessage>| {
        let Some(message) = table.message() else { return };
        let data = serde_json::to_vec(&message).unwrap_or_default();
        planned.push(PlannedMessage { time, channel: RecordingChannel::Samples, sequence: 0, data });
    };
    for line in lines {
        if line.time.div_euclid(BLOCK) != begun / BLOCK {
            close(std::mem::take(&mut table), begun, &mut planned);
            begun = line.time.div_euclid(BLOCK) * BLOCK;
        }
        let is_sample = line.channel == RecordingChannel::Signals;
        let text = std::str::from_utf8(&line.data).unwrap_or_default();
        if !(is_sample && table.takes(line.sequence, text)) {
            planned.push(line);
        }
    }
    close(table, begun, &mut planned);
    planned
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
            if message.channel == RecordingChannel::Tracks {
                // Of a file that is cut, the minutes before can be shown.
                writer.close_chunk()?;
            }
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
fn seen(run: &RunOnFile<'_>, form: RecordingForm) -> Vec<PlannedMessage> {
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
    planned.extend(match form {
        RecordingForm::Columns => in_tracks(run),
        RecordingForm::Messages => as_messages(run),
    });
    if !run.topics.is_empty() {
        let topics = run.topics.iter().map(|topic| TopicColumns {
            name: topic.name.clone(),
            interface: topic.interface.clone(),
            outward: topic.outward,
            part: topic.part,
            t: columns::differences(topic.times.iter().copied()),
            text: topic.texts.clone(),
        });
        let data = serde_json::to_string(&TopicsMessage { topics: topics.collect() }).unwrap_or_default();
        planned.push(message(run.trace.end, RecordingChannel::Topics, data));
    }
    planned.extend(run.lines.iter().map(|lines| {
        let data = serde_json::to_string(lines).unwrap_or_default();
        message(run.trace.end, RecordingChannel::Lines, data)
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

/// What changes, in columns.
fn in_tracks(run: &RunOnFile<'_>) -> Vec<PlannedMessage> {
    let planned = |(time, message): (Nanos, TracksMessage)| {
        let data = serde_json::to_vec(&message).unwrap_or_default();
        PlannedMessage { time, channel: RecordingChannel::Tracks, sequence: 0, data }
    };
    columns::tracks(run.scene, run.picture).into_iter().map(planned).collect()
}

/// What changes, in messages that other tools know.
fn as_messages(run: &RunOnFile<'_>) -> Vec<PlannedMessage> {
    let mut planned = Vec::new();
    let by_time = |all: BTreeMap<Nanos, Vec<String>>, channel, put: &dyn Fn(Nanos, String) -> String| {
        let put = |(time, parts): (Nanos, Vec<String>)| PlannedMessage {
            time,
            channel,
            sequence: 0,
            data: put(time, parts.join(",")).into(),
        };
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
