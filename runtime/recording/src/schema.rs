//! The schemas of messages, in JSON Schema: hrdsl's own, made from [`message`](crate::message) and [`scene`](crate::scene), and those of others.

use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::{Value, json};

use crate::{
    channel::RecordingChannel,
    columns::{SamplesMessage, TracksMessage},
    foxglove,
    message::{
        ContactsMessage, EndMessage, EventMessage, HeaderMessage, LinesMessage, MachineMessage,
        SignalMessage, TopicsMessage, VerdictMessage,
    },
    scene::RecordedScene,
};

/// The name and the schema of a channel's messages.
pub(crate) fn of_channel(channel: RecordingChannel) -> (&'static str, Value) {
    match channel {
        RecordingChannel::Header => ("hrdsl.Header", own::<HeaderMessage>()),
        RecordingChannel::Events => ("hrdsl.Event", own::<EventMessage>()),
        RecordingChannel::Signals => ("hrdsl.Signal", own::<SignalMessage>()),
        RecordingChannel::Samples => ("hrdsl.Samples", own::<SamplesMessage>()),
        RecordingChannel::Machines => ("hrdsl.Machine", own::<MachineMessage>()),
        RecordingChannel::End => ("hrdsl.End", own::<EndMessage>()),
        RecordingChannel::Verdicts => ("hrdsl.Verdict", own::<VerdictMessage>()),
        RecordingChannel::Scene => ("hrdsl.Scene", own::<RecordedScene>()),
        RecordingChannel::Tracks => ("hrdsl.Tracks", own::<TracksMessage>()),
        RecordingChannel::Contacts => ("hrdsl.Contacts", own::<ContactsMessage>()),
        RecordingChannel::Entities => ("foxglove.SceneUpdate", foxglove::scene_update()),
        RecordingChannel::Transforms => ("foxglove.FrameTransforms", foxglove::frame_transforms()),
        RecordingChannel::Joints => ("foxglove.JointStates", foxglove::joint_states()),
        RecordingChannel::Topics => ("hrdsl.Topics", own::<TopicsMessage>()),
        RecordingChannel::Lines => ("hrdsl.Lines", own::<LinesMessage>()),
        RecordingChannel::Log => ("foxglove.Log", foxglove::log()),
    }
}

fn own<T: JsonSchema>() -> Value {
    Value::from(SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>())
}

/// hrdsl's own schemas as one document, by the topics of their channels, as text that ends in a line break.
///
/// # Errors
/// None that is known: the schemas are plain data.
pub fn published() -> Result<String, serde_json::Error> {
    let all = RecordingChannel::ALL.into_iter().map(|channel| (channel, of_channel(channel)));
    let own = all.filter(|(_, (name, _))| name.starts_with("hrdsl."));
    let channels: serde_json::Map<String, Value> = own
        .map(|(channel, (name, schema))| {
            (channel.topic().to_owned(), json!({ "name": name, "schema": schema }))
        })
        .collect();
    let document = json!({ "format": "hrdsl-recording-schemas", "version": 1, "channels": channels });
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}
