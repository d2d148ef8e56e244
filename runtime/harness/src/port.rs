//! What programs of a system open to speak with each other: topics, services and actions, as data.

use std::{fmt, sync::Arc};

use hrdsl_ir::Nanos;

/// A message as its maker wrote it: the text of a JSON value, which nobody here looks into.
pub type MessageText = Arc<str>;

/// What a program does at a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PortKind {
    Publisher,
    Subscriber,
    Server,
    Client,
    ActionServer,
    ActionClient,
}

impl PortKind {
    /// What is at the name: those of one sort find each other.
    #[must_use]
    pub fn sort(self) -> &'static str {
        match self {
            PortKind::Publisher | PortKind::Subscriber => "topic",
            PortKind::Server | PortKind::Client => "service",
            PortKind::ActionServer | PortKind::ActionClient => "action",
        }
    }

    /// With its article, for sentences.
    pub(super) fn noun(self) -> &'static str {
        match self {
            PortKind::Publisher => "a publisher",
            PortKind::Subscriber => "a subscriber",
            PortKind::Server => "a server",
            PortKind::Client => "a client",
            PortKind::ActionServer => "an action server",
            PortKind::ActionClient => "an action client",
        }
    }

    /// What it takes at the same name for one of this kind to be of use.
    #[must_use]
    pub fn counterpart(self) -> Self {
        match self {
            PortKind::Publisher => PortKind::Subscriber,
            PortKind::Subscriber => PortKind::Publisher,
            PortKind::Server => PortKind::Client,
            PortKind::Client => PortKind::Server,
            PortKind::ActionServer => PortKind::ActionClient,
            PortKind::ActionClient => PortKind::ActionServer,
        }
    }
}

impl fmt::Display for PortKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            PortKind::Publisher => "publisher",
            PortKind::Subscriber => "subscriber",
            PortKind::Server => "server",
            PortKind::Client => "client",
            PortKind::ActionServer => "action server",
            PortKind::ActionClient => "action client",
        })
    }
}

/// A port that a program opens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortDeclaration {
    /// The program's own number for it.
    pub port: u64,
    pub kind: PortKind,
    /// `/scan`
    pub name: String,
    /// `sensor_msgs/LaserScan`; compared, and not understood.
    pub type_name: String,
    /// Of a publisher: so many of its last messages are given to those who subscribe later.
    pub kept: usize,
    /// Of a subscriber: so many messages wait for it at most; of more, the oldest are lost.
    pub depth: usize,
    /// Of a publisher what it offers, of a subscriber what it requests.
    pub qos: PortQos,
}

/// Qualities of service that decide who hears whom, as in ROS 2; what is not said fits everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortQos {
    pub reliability: Option<QosReliability>,
    pub durability: Option<QosDurability>,
}

/// Whether messages may be lost on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QosReliability {
    BestEffort,
    Reliable,
}

/// Whether what was published before is for those who subscribe later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QosDurability {
    Volatile,
    TransientLocal,
}

/// Why a publisher and a subscriber do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QosPolicy {
    Reliability,
    Durability,
}

impl PortQos {
    /// The policy of which a subscriber requests more than this publisher offers, if there is one.
    #[must_use]
    pub fn lacks(self, requested: PortQos) -> Option<QosPolicy> {
        if self.reliability == Some(QosReliability::BestEffort)
            && requested.reliability == Some(QosReliability::Reliable)
        {
            Some(QosPolicy::Reliability)
        } else if self.durability == Some(QosDurability::Volatile)
            && requested.durability == Some(QosDurability::TransientLocal)
        {
            Some(QosPolicy::Durability)
        } else {
            None
        }
    }
}

/// How the goal of an action ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalEnd {
    Succeeded,
    Aborted,
    Canceled,
    Rejected,
}

impl GoalEnd {
    /// It in a word.
    pub(crate) fn word(self) -> &'static str {
        match self {
            GoalEnd::Succeeded => "succeeded",
            GoalEnd::Aborted => "aborted",
            GoalEnd::Canceled => "canceled",
            GoalEnd::Rejected => "rejected",
        }
    }
}

/// Something at a name, for those who ask what there is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortListing {
    pub kind: PortKind,
    pub name: String,
    pub type_name: String,
    /// The program that has it.
    pub program: String,
}

/// A program waits until its counterpart is there: a server, or somebody who publishes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AwaitedPort {
    /// What the program is to the name.
    pub kind: PortKind,
    pub name: String,
    /// None: it does not say.
    pub type_name: Option<String>,
    /// When it stops waiting; `None`: never.
    pub give_up: Option<Nanos>,
}

/// What was open in a run at some time, and what was awaited in vain until its end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PortHistory {
    /// In order; each once, however often it was opened.
    pub uses: Vec<PortUse>,
    pub waits: Vec<VainWait>,
}

/// A program had a port of this kind at this name, or waited for its counterpart.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PortUse {
    pub kind: PortKind,
    pub name: String,
    /// `None`: the scenario's own.
    pub program: Option<String>,
    /// `None`: it did not say.
    pub type_name: Option<String>,
}

/// A program waited until the run was over for a counterpart that never came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VainWait {
    pub program: String,
    /// What the program was to the name.
    pub kind: PortKind,
    pub name: String,
    pub since: Nanos,
}
