//! Takes the file of a run apart, whoever wrote it, and as far as it goes: what is wrong with it is told, and the rest is read.

use std::collections::BTreeMap;

use hrdsl_ir::{
    Nanos,
    world::{BodyId, JointId},
};
use hrdsl_trace::picture::{
    BodyKeyframe, BodyKeyframes, ContactKeyframe, ContactKeyframes, FINE, FORCE, JointKeyframe,
    JointKeyframes, WorldPicture, whole,
};
use serde::Deserialize;
use thiserror::Error;

use crate::{
    channel::RecordingChannel,
    columns::{self, TracksMessage},
    container::{self, ContainedMessage, ContainerError, MAGIC},
    message::{
        ContactsMessage, LinesMessage, RecordedLogLevel, RecordedLogLine, RecordedTopic, TopicsMessage,
        VerdictMessage,
    },
    scene::RecordedScene,
};

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordingFile {
    /// The judged lines, as the recording in text that they are.
    pub text: String,
    pub scene: Option<RecordedScene>,
    pub picture: WorldPicture,
    pub log: Vec<RecordedLogLine>,
    /// What was sent through names of the middleware.
    pub topics: Vec<RecordedTopic>,
    /// At which lines of its code each program was.
    pub lines: Vec<LinesMessage>,
    /// What the run came to when it was made.
    pub verdicts: Vec<VerdictMessage>,
    /// What could not be read, a sentence each.
    pub faults: Vec<String>,
}

/// Why a file is not read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    #[error("this is no MCAP file")]
    NotMcap,
    #[error("this MCAP file has no channel `/hrdsl/header`: hrdsl did not write it{}", because(.0))]
    NotOurs(Vec<String>),
}

fn because(faults: &[String]) -> String {
    faults.first().map_or_else(String::new, |fault| format!(", or {fault}"))
}

/// Whether a file begins as MCAP does.
#[must_use]
pub fn is_mcap(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Whether a file is a recording of hrdsl in the form that other tools play.
#[must_use]
pub fn is_export(bytes: &[u8]) -> bool {
    let (mut is_ours, mut has_columns) = (false, false);
    let looked = container::read(bytes, &mut |message| {
        let channel = RecordingChannel::of_topic(&message.topic);
        is_ours |= channel == Some(RecordingChannel::Header);
        has_columns |= matches!(channel, Some(RecordingChannel::Tracks | RecordingChannel::Samples));
    });
    looked.is_ok() && is_ours && !has_columns
}

/// Reads a file. What is wrong in it ends up among its [faults](RecordingFile::faults).
///
/// # Errors
/// A file of another kind.
pub fn read(bytes: &[u8]) -> Result<RecordingFile, RecordingError> {
    let mut taken = TakenApart::default();
    match container::read(bytes, &mut |message| taken.take(&message)) {
        Ok(()) => {}
        Err(ContainerError::NotMcap) => return Err(RecordingError::NotMcap),
        Err(error) => taken.fault(error.to_string()),
    }
    if !taken.has_header {
        return Err(RecordingError::NotOurs(taken.faults));
    }
    Ok(taken.finish())
}

#[derive(Default)]
struct TakenApart {
    has_header: bool,
    /// Judged lines with their places.
    lines: Vec<(u32, String)>,
    scene: Option<RecordedScene>,
    bodies: BTreeMap<String, Vec<BodyKeyframe>>,
    joints: BTreeMap<String, Vec<JointKeyframe>>,
    contacts: BTreeMap<[String; 2], Vec<ContactKeyframe>>,
    tracks: Vec<TracksMessage>,
    verdicts: Vec<VerdictMessage>,
    topics: Vec<RecordedTopic>,
    code: Vec<LinesMessage>,
    log: Vec<RecordedLogLine>,
    faults: Vec<String>,
}

#[derive(Deserialize)]
struct TransformsMessage {
    transforms: Vec<TransformEntry>,
}

#[derive(Deserialize)]
struct TransformEntry {
    child_frame_id: String,
    translation: BTreeMap<String, f64>,
    rotation: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct JointsMessage {
    joints: Vec<JointEntry>,
}

#[derive(Deserialize)]
struct JointEntry {
    name: String,
    position: f64,
}

#[derive(Deserialize)]
struct LogMessage {
    level: u8,
    message: String,
    name: String,
}

fn log_line(time: Nanos, LogMessage { level, message: text, name: program }: LogMessage) -> RecordedLogLine {
    let level = RecordedLogLevel::ALL.into_iter().find(|known| known.number() == level);
    RecordedLogLine { time, level: level.unwrap_or(RecordedLogLevel::Info), program, text }
}

impl TakenApart {
    /// Each fault once, and not too many.
    fn fault(&mut self, fault: String) {
        if self.faults.len() < 20 && !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }

    fn take(&mut self, message: &ContainedMessage) {
        let Some(channel) = RecordingChannel::of_topic(&message.topic) else { return };
        let time = Nanos::try_from(message.time).unwrap_or(Nanos::MAX);
        let taken = if channel.is_judged() {
            self.has_header |= channel == RecordingChannel::Header;
            std::str::from_utf8(&message.data).map_err(|e| e.to_string()).map(|line| {
                self.lines.push((message.sequence, line.to_owned()));
            })
        } else {
            self.take_seen(channel, time, &message.data).map_err(|e| e.to_string())
        };
        if let Err(why) = taken {
            self.fault(format!("a message on `{}` cannot be read: {why}", channel.topic()));
        }
    }

    fn take_seen(&mut self, channel: RecordingChannel, time: Nanos, data: &[u8]) -> serde_json::Result<()> {
        match channel {
            RecordingChannel::Samples => match columns::lines(&serde_json::from_slice(data)?) {
                Some(lines) => self.lines.extend(lines),
                None => self
                    .fault("the columns of a message on `/hrdsl/samples` are not of one length".to_owned()),
            },
            RecordingChannel::Tracks => self.tracks.push(serde_json::from_slice(data)?),
            RecordingChannel::Verdicts => self.verdicts.push(serde_json::from_slice(data)?),
            RecordingChannel::Scene => self.scene = Some(serde_json::from_slice(data)?),
            RecordingChannel::Transforms => {
                let message: TransformsMessage = serde_json::from_slice(data)?;
                for TransformEntry { child_frame_id, translation, rotation } in message.transforms {
                    let part = |of: &BTreeMap<String, f64>, name| of.get(name).map_or(0, |x| whole(*x, FINE));
                    self.bodies.entry(child_frame_id).or_default().push(BodyKeyframe {
                        time,
                        place: ["x", "y", "z"].map(|name| part(&translation, name)),
                        turn: ["x", "y", "z", "w"].map(|name| part(&rotation, name)),
                    });
                }
            }
            RecordingChannel::Joints => {
                let message: JointsMessage = serde_json::from_slice(data)?;
                for JointEntry { name, position } in message.joints {
                    let frame = JointKeyframe { time, position: whole(position, FINE) };
                    self.joints.entry(name).or_default().push(frame);
                }
            }
            RecordingChannel::Contacts => {
                let message: ContactsMessage = serde_json::from_slice(data)?;
                for contact in message.contacts {
                    let point = contact.point.map(|x| whole(x, FINE));
                    let force = contact.force.map(|x| whole(x, FORCE));
                    let frame = ContactKeyframe { time, point, force };
                    self.contacts.entry(contact.bodies).or_default().push(frame);
                }
            }
            RecordingChannel::Topics => {
                let message: TopicsMessage = serde_json::from_slice(data)?;
                self.topics.extend(message.topics.into_iter().map(|topic| RecordedTopic {
                    name: topic.name,
                    interface: topic.interface,
                    outward: topic.outward,
                    part: topic.part,
                    times: columns::sums(&topic.t),
                    texts: topic.text,
                }));
            }
            RecordingChannel::Lines => self.code.push(serde_json::from_slice(data)?),
            RecordingChannel::Log => self.log.push(log_line(time, serde_json::from_slice(data)?)),
            RecordingChannel::Header
            | RecordingChannel::Events
            | RecordingChannel::Signals
            | RecordingChannel::Machines
            | RecordingChannel::End
            | RecordingChannel::Entities => {}
        }
        Ok(())
    }

    fn finish(mut self) -> RecordingFile {
        // Tools that sort messages by time may have put those of one instant in another order.
        self.lines.sort_by_key(|(place, _)| *place);
        let whole =
            self.lines.iter().enumerate().take_while(|(at, (place, _))| *at as u64 == u64::from(*place));
        let whole = whole.count();
        if whole < self.lines.len() {
            self.fault(format!("the judged line {whole} is missing, and what comes after it is left out"));
            self.lines.truncate(whole);
        }
        let text = self.lines.iter().flat_map(|(_, line)| [line.as_str(), "\n"]).collect();
        let picture = self.picture();
        let Self { scene, log, topics, code: lines, verdicts, faults, .. } = self;
        RecordingFile { text, scene, picture, log, topics, lines, verdicts, faults }
    }

    /// The picture, by the numbers that the scene gives to names.
    fn picture(&mut self) -> WorldPicture {
        let Some(scene) = &self.scene else { return WorldPicture::default() };
        let number = |at: usize| u16::try_from(at).unwrap_or(u16::MAX);
        let body =
            |name: &String| scene.bodies.iter().position(|b| b.name == *name).map(|at| BodyId(number(at)));
        let joint =
            |name: &String| scene.joints.iter().position(|j| j.name == *name).map(|at| JointId(number(at)));
        let (mut picture, is_whole) = columns::picture(scene, &self.tracks);
        for (name, frames) in std::mem::take(&mut self.bodies) {
            // One transform alone is where it starts; and what another carries is told in the frame of that one.
            let Some(id) = body(&name).filter(|_| frames.len() > 1) else { continue };
            let frames = frames.into_iter().skip(1).collect();
            picture.bodies.push(BodyKeyframes { body: id, frames });
        }
        for (name, frames) in std::mem::take(&mut self.joints) {
            picture.joints.extend(joint(&name).map(|joint| JointKeyframes { joint, frames }));
        }
        for ([a, b], frames) in std::mem::take(&mut self.contacts) {
            let (Some(a), Some(b)) = (body(&a), body(&b)) else { continue };
            picture.contacts.push(ContactKeyframes { bodies: [a, b], frames });
        }
        picture.bodies.sort_by_key(|track| track.body);
        picture.joints.sort_by_key(|track| track.joint);
        picture.contacts.sort_by_key(|track| track.bodies);
        if !is_whole {
            self.fault("the columns of a message on `/hrdsl/tracks` are not of one length".to_owned());
        }
        picture
    }
}
