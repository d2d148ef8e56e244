//! The topics over which goals go in ROS 1: here they do not, so that whoever spoke over these would neither be heard nor hear
//! anything. That is told, whichever end comes first.

use crate::{port::PortDeclaration, system::graph::MessageGraph};

/// The last parts of their names, below that of the action.
const TOPICS: [&str; 5] = ["goal", "cancel", "status", "feedback", "result"];

/// # Errors
/// The topic, and the action whose it is, if both would be open.
pub(super) fn refuse(declared: &PortDeclaration, graph: &MessageGraph) -> Result<(), String> {
    let name = declared.name.as_str();
    match declared.kind.sort() {
        "topic" => {
            let (action, last) = name.rsplit_once('/').unwrap_or_default();
            let is_of_action = TOPICS.contains(&last) && graph.has(action, "action");
            if is_of_action { Err(sentence(name, action)) } else { Ok(()) }
        }
        "action" => {
            let mut topics = TOPICS.iter().map(|last| format!("{name}/{last}"));
            let taken = topics.find(|topic| graph.has(topic, "topic"));
            taken.map_or(Ok(()), |topic| Err(sentence(&topic, name)))
        }
        _ => Ok(()),
    }
}

fn sentence(topic: &str, action: &str) -> String {
    format!(
        "the topic `{topic}` is one of the action `{action}`, whose goals do not go over topics here: use `actionlib` \
         at both ends, or topics at both ends"
    )
}
