//! The channels of a recording: their topics, and which schema the messages of each have.

/// One channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum RecordingChannel {
    Header,
    Events,
    Signals,
    Samples,
    Machines,
    End,
    Verdicts,
    Scene,
    Tracks,
    Contacts,
    Entities,
    Transforms,
    Joints,
    Topics,
    Lines,
    Log,
}

impl RecordingChannel {
    pub const ALL: [RecordingChannel; 16] = [
        RecordingChannel::Header,
        RecordingChannel::Events,
        RecordingChannel::Signals,
        RecordingChannel::Samples,
        RecordingChannel::Machines,
        RecordingChannel::End,
        RecordingChannel::Verdicts,
        RecordingChannel::Scene,
        RecordingChannel::Tracks,
        RecordingChannel::Contacts,
        RecordingChannel::Entities,
        RecordingChannel::Transforms,
        RecordingChannel::Joints,
        RecordingChannel::Topics,
        RecordingChannel::Lines,
        RecordingChannel::Log,
    ];

    pub fn topic(self) -> &'static str {
        match self {
            RecordingChannel::Header => "/hrdsl/header",
            RecordingChannel::Events => "/hrdsl/events",
            RecordingChannel::Signals => "/hrdsl/signals",
            RecordingChannel::Samples => "/hrdsl/samples",
            RecordingChannel::Machines => "/hrdsl/machines",
            RecordingChannel::End => "/hrdsl/end",
            RecordingChannel::Verdicts => "/hrdsl/verdicts",
            RecordingChannel::Scene => "/hrdsl/scene",
            RecordingChannel::Tracks => "/hrdsl/tracks",
            RecordingChannel::Contacts => "/hrdsl/contacts",
            RecordingChannel::Entities => "/scene",
            RecordingChannel::Transforms => "/tf",
            RecordingChannel::Joints => "/joint_states",
            RecordingChannel::Topics => "/hrdsl/topics",
            RecordingChannel::Lines => "/hrdsl/lines",
            RecordingChannel::Log => "/log",
        }
    }

    pub fn of_topic(topic: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|channel| channel.topic() == topic)
    }

    /// Whether its messages are lines of the text form.
    pub fn is_judged(self) -> bool {
        match self {
            RecordingChannel::Header
            | RecordingChannel::Events
            | RecordingChannel::Signals
            | RecordingChannel::Machines
            | RecordingChannel::End => true,
            RecordingChannel::Samples
            | RecordingChannel::Verdicts
            | RecordingChannel::Scene
            | RecordingChannel::Tracks
            | RecordingChannel::Contacts
            | RecordingChannel::Entities
            | RecordingChannel::Transforms
            | RecordingChannel::Joints
            | RecordingChannel::Topics
            | RecordingChannel::Lines
            | RecordingChannel::Log => false,
        }
    }
}
