//! The request that opens a port, and the words in it.

use hrdsl_harness::{PortDeclaration, PortKind, PortQos, QosDurability, QosReliability};
use serde::{Deserialize, Serialize};

/// How many messages wait for a subscriber that does not say.
const DEPTH: usize = 1_000;

/// Be a publisher, subscriber, server or client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenRequest {
    pub port: u64,
    pub kind: WrittenPortKind,
    pub name: String,
    #[serde(rename = "type")]
    pub type_name: String,
    /// Of a publisher: its last message is given to whoever subscribes later.
    #[serde(default)]
    pub latched: bool,
    /// Of a subscriber: so many messages wait for it; of a publisher that is `transient_local`: so many are kept for later subscribers.
    #[serde(default)]
    pub depth: Option<usize>,
    #[serde(default)]
    pub reliability: Option<WrittenReliability>,
    #[serde(default)]
    pub durability: Option<WrittenDurability>,
    /// Whether the program waits for a reply.
    #[serde(default = "super::yes")]
    pub reply: bool,
}

/// A [`PortKind`] as the protocol writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrittenPortKind {
    Publisher,
    Subscriber,
    Server,
    Client,
    ActionServer,
    ActionClient,
}

/// A [`QosReliability`] as the protocol writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrittenReliability {
    BestEffort,
    Reliable,
}

/// A [`QosDurability`] as the protocol writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrittenDurability {
    Volatile,
    TransientLocal,
}

impl From<WrittenPortKind> for PortKind {
    fn from(kind: WrittenPortKind) -> Self {
        match kind {
            WrittenPortKind::Publisher => PortKind::Publisher,
            WrittenPortKind::Subscriber => PortKind::Subscriber,
            WrittenPortKind::Server => PortKind::Server,
            WrittenPortKind::Client => PortKind::Client,
            WrittenPortKind::ActionServer => PortKind::ActionServer,
            WrittenPortKind::ActionClient => PortKind::ActionClient,
        }
    }
}

impl OpenRequest {
    /// Why it makes no sense whatever the scenario, if it does not.
    pub(super) fn fault(&self) -> Option<String> {
        (self.name.is_empty() || self.type_name.is_empty())
            .then(|| "a port needs a `name` and a `type`".to_owned())
    }
}

impl From<OpenRequest> for PortDeclaration {
    fn from(open: OpenRequest) -> Self {
        let reliability = open.reliability.map(|reliability| match reliability {
            WrittenReliability::BestEffort => QosReliability::BestEffort,
            WrittenReliability::Reliable => QosReliability::Reliable,
        });
        let durability = open.durability.map(|durability| match durability {
            WrittenDurability::Volatile => QosDurability::Volatile,
            WrittenDurability::TransientLocal => QosDurability::TransientLocal,
        });
        let kept = match durability {
            Some(QosDurability::TransientLocal) => open.depth.unwrap_or(DEPTH),
            Some(QosDurability::Volatile) | None => usize::from(open.latched),
        };
        PortDeclaration {
            port: open.port,
            kind: open.kind.into(),
            name: open.name,
            type_name: open.type_name,
            kept,
            depth: open.depth.unwrap_or(DEPTH),
            qos: PortQos { reliability, durability },
        }
    }
}
