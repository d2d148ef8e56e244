//! Numbers over time in columns: what changes little from one time to the next takes little room, packed, and less than a message for each.
//!
//! A column of whole numbers has its first value, and then what each differs from the one before. A message has what lies within
//! [`BLOCK`], so that of a file that is cut the beginning can be read.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Nanos,
    world::{BodyId, JointId},
};
use hrdsl_trace::picture::{
    BodyKeyframe, BodyKeyframes, ContactKeyframe, ContactKeyframes, JointKeyframe, JointKeyframes,
    WorldPicture,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{number::write_decimal, scene::RecordedScene};

/// How much of a run a message of columns has.
pub(crate) const BLOCK: Nanos = 60_000_000_000;
/// Samples are written in millionths, which is what signals are measured to.
const MILLION: u64 = 1_000_000;
const BILLION: u64 = 1_000_000_000;

/// Where bodies and joints were, and what pressed on what, for up to a minute.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TracksMessage {
    /// What a whole number in a column of times stands for, in nanoseconds.
    pub tick: i64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyColumns>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointColumns>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactColumns>,
}

/// A body that moves. Between two times its place lies on a line, and its orientation on the shorter arc.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyColumns {
    pub body: String,
    pub t: Vec<i64>,
    /// x, y and z in the world, in tenths of a millimetre.
    pub p: [Vec<i64>; 3],
    /// x, y, z and w of the quaternion, in ten-thousandths.
    pub q: [Vec<i64>; 4],
}

/// A joint that moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointColumns {
    pub joint: String,
    pub t: Vec<i64>,
    /// In ten-thousandths of a radian or a metre.
    pub p: Vec<i64>,
}

/// Two bodies that press on each other, each time until the next; three zeros end the contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactColumns {
    pub bodies: [String; 2],
    pub t: Vec<i64>,
    /// x, y and z in the world, in tenths of a millimetre.
    pub p: [Vec<i64>; 3],
    /// x, y and z of the force on the first of the two, in hundredths of a newton.
    pub f: [Vec<i64>; 3],
}

/// Samples of signals that are decimals, for up to a minute: lines of the text form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SamplesMessage {
    pub signals: Vec<SampleColumns>,
}

/// The samples of a signal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleColumns {
    pub signal: String,
    /// The number of each line, from 0.
    pub line: Vec<i64>,
    /// Nanoseconds.
    pub t: Vec<i64>,
    /// In millionths of the signal's SI unit.
    pub v: Vec<i64>,
}

pub(crate) fn differences(values: impl IntoIterator<Item = i64>) -> Vec<i64> {
    let mut before = 0;
    values.into_iter().map(|value| value.wrapping_sub(std::mem::replace(&mut before, value))).collect()
}

pub(crate) fn sums(differences: &[i64]) -> Vec<i64> {
    let mut sum = 0_i64;
    differences
        .iter()
        .map(|difference| {
            sum = sum.wrapping_add(*difference);
            sum
        })
        .collect()
}

/// Rows of a fixed width as a column for each place.
fn turned<const N: usize>(rows: impl Iterator<Item = [i64; N]> + Clone) -> [Vec<i64>; N] {
    std::array::from_fn(|at| differences(rows.clone().filter_map(|row| row.get(at).copied())))
}

/// The rows of columns; `None` if one is shorter than there are times.
fn rows<const N: usize>(columns: &[Vec<i64>; N], length: usize) -> Option<Vec<[i64; N]>> {
    let columns = columns.each_ref().map(|column| sums(column));
    (0..length)
        .map(|at| {
            let row = columns.each_ref().map(|column| column.get(at).copied());
            row.iter().all(Option::is_some).then(|| row.map(Option::unwrap_or_default))
        })
        .collect()
}

/// The picture in columns, a message for each block of the run, with its first time.
pub(crate) fn tracks(scene: &RecordedScene, picture: &WorldPicture) -> Vec<(Nanos, TracksMessage)> {
    let times = picture
        .bodies
        .iter()
        .flat_map(|track| track.frames.iter().map(|frame| frame.time))
        .chain(picture.joints.iter().flat_map(|track| track.frames.iter().map(|frame| frame.time)))
        .chain(picture.contacts.iter().flat_map(|track| track.frames.iter().map(|frame| frame.time)));
    let mut blocks: BTreeMap<Nanos, Vec<Nanos>> = BTreeMap::new();
    for time in times {
        blocks.entry(time.div_euclid(BLOCK)).or_default().push(time);
    }
    blocks.into_iter().map(|(block, times)| tracks_of(scene, picture, block, &times)).collect()
}

fn tracks_of(
    scene: &RecordedScene,
    picture: &WorldPicture,
    block: Nanos,
    times: &[Nanos],
) -> (Nanos, TracksMessage) {
    let tick = [1_000_000, 1_000].into_iter().find(|tick| times.iter().all(|t| t % tick == 0)).unwrap_or(1);
    let is_here = move |time: Nanos| time.div_euclid(BLOCK) == block;
    let mut message = TracksMessage { tick, ..TracksMessage::default() };
    let body = |id: BodyId| scene.bodies.get(usize::from(id.0)).map(|body| body.name.clone());
    for track in &picture.bodies {
        let frames = track.frames.iter().filter(|frame| is_here(frame.time));
        let Some(body) = body(track.body).filter(|_| frames.clone().next().is_some()) else { continue };
        message.bodies.push(BodyColumns {
            body,
            t: differences(frames.clone().map(|frame| frame.time / tick)),
            p: turned(frames.clone().map(|frame| frame.place)),
            q: turned(frames.map(|frame| frame.turn)),
        });
    }
    for track in &picture.joints {
        let frames = track.frames.iter().filter(|frame| is_here(frame.time));
        let joint = scene.joints.get(usize::from(track.joint.0)).filter(|_| frames.clone().next().is_some());
        let Some(joint) = joint else { continue };
        message.joints.push(JointColumns {
            joint: joint.name.clone(),
            t: differences(frames.clone().map(|frame| frame.time / tick)),
            p: differences(frames.map(|frame| frame.position)),
        });
    }
    for track in &picture.contacts {
        let frames = track.frames.iter().filter(|frame| is_here(frame.time));
        let [a, b] = track.bodies.map(body);
        let (Some(a), Some(b), true) = (a, b, frames.clone().next().is_some()) else { continue };
        message.contacts.push(ContactColumns {
            bodies: [a, b],
            t: differences(frames.clone().map(|frame| frame.time / tick)),
            p: turned(frames.clone().map(|frame| frame.point)),
            f: turned(frames.map(|frame| frame.force)),
        });
    }
    (times.iter().copied().min().unwrap_or_default(), message)
}

/// The picture that messages of columns make together, by the numbers that a scene gives to names; and whether columns are of one length.
pub(crate) fn picture(scene: &RecordedScene, messages: &[TracksMessage]) -> (WorldPicture, bool) {
    let number = |at: usize| u16::try_from(at).unwrap_or(u16::MAX);
    let body = |name: &String| scene.bodies.iter().position(|b| b.name == *name).map(|at| BodyId(number(at)));
    let joint =
        |name: &String| scene.joints.iter().position(|j| j.name == *name).map(|at| JointId(number(at)));
    let mut bodies: BTreeMap<BodyId, Vec<BodyKeyframe>> = BTreeMap::new();
    let mut joints: BTreeMap<JointId, Vec<JointKeyframe>> = BTreeMap::new();
    let mut contacts: BTreeMap<[BodyId; 2], Vec<ContactKeyframe>> = BTreeMap::new();
    let mut is_whole = true;
    for TracksMessage { tick, bodies: b, joints: j, contacts: c } in messages {
        let times = |t: &[i64]| sums(t).into_iter().map(|t| t.wrapping_mul(*tick)).collect::<Vec<_>>();
        for columns in b {
            let read = rows(&columns.p, columns.t.len()).zip(rows(&columns.q, columns.t.len()));
            is_whole &= read.is_some();
            let (Some((places, turns)), Some(body)) = (read, body(&columns.body)) else { continue };
            let frames = times(&columns.t).into_iter().zip(places).zip(turns);
            let frame = |((time, place), turn)| BodyKeyframe { time, place, turn };
            bodies.entry(body).or_default().extend(frames.map(frame));
        }
        for columns in j {
            is_whole &= columns.t.len() == columns.p.len();
            let Some(joint) = joint(&columns.joint) else { continue };
            let frames = times(&columns.t).into_iter().zip(sums(&columns.p));
            let frame = |(time, position)| JointKeyframe { time, position };
            joints.entry(joint).or_default().extend(frames.map(frame));
        }
        for columns in c {
            let read = rows(&columns.p, columns.t.len()).zip(rows(&columns.f, columns.t.len()));
            is_whole &= read.is_some();
            let [a, b] = columns.bodies.each_ref().map(body);
            let (Some((points, forces)), Some(a), Some(b)) = (read, a, b) else { continue };
            let frames = times(&columns.t).into_iter().zip(points).zip(forces);
            let frame = |((time, point), force)| ContactKeyframe { time, point, force };
            contacts.entry([a, b]).or_default().extend(frames.map(frame));
        }
    }
    let picture = WorldPicture {
        bodies: bodies.into_iter().map(|(body, frames)| BodyKeyframes { body, frames }).collect(),
        joints: joints.into_iter().map(|(joint, frames)| JointKeyframes { joint, frames }).collect(),
        contacts: contacts.into_iter().map(|(bodies, frames)| ContactKeyframes { bodies, frames }).collect(),
    };
    (picture, is_whole)
}

/// The samples of a block, gathered.
#[derive(Default)]
pub(crate) struct SampleTable {
    /// By the signals' names as a line has them, in quotes.
    signals: BTreeMap<String, SignalSamples>,
    /// The line that is compared.
    line: String,
}

/// The samples of a signal in a block: of each its line's number, its time (ns) and its value in millionths.
struct SignalSamples {
    signal: String,
    samples: Vec<[i64; 3]>,
}

impl SampleTable {
    /// Whether a line is one of a sample that a column gives back byte for byte; then it is in the table.
    pub fn takes(&mut self, number: usize, line: &str) -> bool {
        let Some((quoted, time, value)) = sample(line) else { return false };
        self.line.clear();
        write_sample(&mut self.line, quoted, time, value);
        if self.line != line {
            return false;
        }
        let sample = [i64::try_from(number).unwrap_or(i64::MAX), time, value];
        if let Some(known) = self.signals.get_mut(quoted) {
            known.samples.push(sample);
            return true;
        }
        let Some(signal) = serde_json::from_str::<String>(quoted).ok() else { return false };
        let is_same = in_quotes(&signal) == quoted;
        if is_same {
            self.signals.insert(quoted.to_owned(), SignalSamples { signal, samples: vec![sample] });
        }
        is_same
    }

    /// The message of the samples; `None` if there are none.
    pub fn message(self) -> Option<SamplesMessage> {
        let columns = |SignalSamples { signal, samples }| {
            let [line, t, v] = turned(samples.into_iter());
            SampleColumns { signal, line, t, v }
        };
        let mut signals: Vec<SampleColumns> = self.signals.into_values().map(columns).collect();
        signals.sort_by(|a, b| a.signal.cmp(&b.signal));
        (!signals.is_empty()).then_some(SamplesMessage { signals })
    }
}

/// The lines of a message with their numbers; `None` if columns are not of one length.
pub(crate) fn lines(message: &SamplesMessage) -> Option<Vec<(u32, String)>> {
    let mut lines = Vec::new();
    for SampleColumns { signal, line, t, v } in &message.signals {
        if line.len() != t.len() || line.len() != v.len() {
            return None;
        }
        let quoted = in_quotes(signal);
        for ((number, time), value) in sums(line).into_iter().zip(sums(t)).zip(sums(v)) {
            let mut text = String::with_capacity(quoted.len() + 48);
            write_sample(&mut text, &quoted, time, value);
            lines.push((u32::try_from(number).ok()?, text));
        }
    }
    Some(lines)
}

/// A line of a sample: its signal in quotes, its time (ns) and its value in millionths.
fn sample(line: &str) -> Option<(&str, i64, i64)> {
    let (time, rest) = line.strip_prefix("{\"t\":")?.split_once(",\"signal\":")?;
    let (quoted, value) = rest.strip_suffix('}')?.rsplit_once(",\"value\":")?;
    Some((quoted, whole(time, BILLION)?, whole(value, MILLION)?))
}

/// A name as the text form has it.
fn in_quotes(signal: &str) -> String {
    serde_json::Value::from(signal).to_string()
}

/// Writes the line that the text form has for a sample.
fn write_sample(line: &mut String, quoted: &str, time: i64, value: i64) {
    line.push_str("{\"t\":");
    write_decimal(line, time, BILLION);
    line.push_str(",\"signal\":");
    line.push_str(quoted);
    line.push_str(",\"value\":");
    write_decimal(line, value, MILLION);
    if value.unsigned_abs().is_multiple_of(MILLION) {
        line.push_str(".0");
    }
    line.push('}');
}

/// A decimal as a whole number of `1/scale`; `None` if it has more digits, or is none.
fn whole(text: &str, scale: u64) -> Option<i64> {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |digits| (-1, digits));
    let (whole, rest) = digits.split_once('.').unwrap_or((digits, ""));
    let width = scale.ilog10() as usize;
    let is_number = |digits: &str| digits.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !is_number(whole) || !is_number(rest) || rest.len() > width {
        return None;
    }
    let missing = u32::try_from(width - rest.len()).ok()?;
    let fraction = if rest.is_empty() { 0 } else { rest.parse::<i64>().ok()? * 10_i64.pow(missing) };
    let whole: i64 = whole.parse().ok()?;
    Some(sign * whole.checked_mul(i64::try_from(scale).ok()?)?.checked_add(fraction)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_taken_that_come_back_byte_for_byte_and_no_others() {
        let taken = [
            "{\"t\":0,\"signal\":\"a \\\"b\\\"\",\"value\":0.0}",
            "{\"t\":0.05,\"signal\":\"distance(x, y)\",\"value\":-0.874184}",
            "{\"t\":0.1,\"signal\":\"distance(x, y)\",\"value\":12.0}",
            "{\"t\":9223372036,\"signal\":\"distance(x, y)\",\"value\":1.5}",
        ];
        let mut table = SampleTable::default();
        for (number, line) in taken.iter().enumerate() {
            assert!(table.takes(number * 3, line), "{line}");
        }
        for line in [
            "{\"t\":0.05,\"signal\":\"a\",\"value\":true}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":\"nan\"}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":3}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":-0.0}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":0.1234567}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":1e300}",
            "{\"t\":0.05,\"signal\":\"a\",\"value\":99999999999999999999.0}",
            "{\"t\":0.050,\"signal\":\"a\",\"value\":1.5}",
            "{\"t\":0.05,\"event\":\"a\"}",
            "",
        ] {
            assert!(!table.takes(0, line), "{line}");
        }
        let message = table.message().unwrap();
        let mut lines = lines(&message).unwrap();
        lines.sort();
        let numbered: Vec<(u32, String)> =
            taken.iter().enumerate().map(|(at, line)| (3 * at as u32, (*line).to_owned())).collect();
        assert_eq!(lines, numbered);
    }

    #[test]
    fn columns_of_different_lengths_are_refused() {
        let columns = SampleColumns { signal: "a".into(), line: vec![1, 1], t: vec![0, 1], v: vec![7] };
        assert_eq!(lines(&SamplesMessage { signals: vec![columns] }), None);
        assert_eq!(rows(&[vec![1], vec![1, 2]], 2), None);
        assert_eq!(rows(&[vec![1, 1], vec![1, 2]], 2), Some(vec![[1, 1], [2, 3]]));
    }
}
