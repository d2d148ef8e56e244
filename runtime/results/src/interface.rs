//! Names of the system's middleware at which somebody is alone: a program without its counterpart, or the scenario without a program.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::names::TestName;

/// What a program is to a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InterfaceRole {
    Subscriber,
    Publisher,
    Client,
    Server,
    ActionClient,
    ActionServer,
}

impl InterfaceRole {
    /// `topic`, `service` or `action`.
    #[must_use]
    pub fn sort(self) -> &'static str {
        match self {
            InterfaceRole::Subscriber | InterfaceRole::Publisher => "topic",
            InterfaceRole::Client | InterfaceRole::Server => "service",
            InterfaceRole::ActionClient | InterfaceRole::ActionServer => "action",
        }
    }

    /// What others do not do for it.
    fn lack(self) -> &'static str {
        match self {
            InterfaceRole::Subscriber => "which nobody publishes",
            InterfaceRole::Publisher => "which nobody subscribes to",
            InterfaceRole::Client | InterfaceRole::ActionClient => "which nobody serves",
            InterfaceRole::Server | InterfaceRole::ActionServer => "which nobody uses",
        }
    }
}

/// How somebody is alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InterfaceFault {
    /// Programs need somebody at the name, and nobody is there.
    Unserved,
    /// The binding names it, and no program does.
    Unused,
    /// Programs publish what nobody hears: a note, and often right.
    Unheard,
}

/// A name at which nobody met in any test.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct InterfaceWarning {
    pub fault: InterfaceFault,
    /// What the programs are to the name; of an unused one, what no program is.
    pub role: InterfaceRole,
    pub name: String,
    /// `sensor_msgs/LaserScan`; `None`: no program said.
    #[serde(rename = "type")]
    pub type_name: Option<String>,
    /// In order; none of an unused name.
    pub programs: Vec<String>,
    /// A name at which the other side is, and which may have been meant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<String>,
    /// What to add to the binding, up to the values that only its author knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<String>,
    /// Tests in which it was so.
    pub tests: u32,
    /// The first of these, by the alphabet.
    pub first: TestName,
}

impl InterfaceWarning {
    /// Whether it is worth a word, and no more.
    #[must_use]
    pub fn is_note(&self) -> bool {
        self.fault == InterfaceFault::Unheard
    }

    /// The sentence about it, without a full stop.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Self { role, name, .. } = self;
        let (sort, lack, who) = (role.sort(), role.lack(), self.programs.join(", "));
        let does = |one: &'static str, many| if self.programs.len() > 1 { many } else { one };
        match self.fault {
            InterfaceFault::Unused => match role {
                InterfaceRole::Subscriber => {
                    format!("no program subscribes to {name}, which the binding publishes")
                }
                InterfaceRole::Publisher => format!("no program publishes {name}, which the binding hears"),
                InterfaceRole::Client
                | InterfaceRole::Server
                | InterfaceRole::ActionClient
                | InterfaceRole::ActionServer => {
                    format!("no program uses the {sort} {name}, which the binding serves")
                }
            },
            InterfaceFault::Unserved | InterfaceFault::Unheard => match role {
                InterfaceRole::Subscriber => {
                    format!("{who} {} to {name}, {lack}", does("subscribes", "subscribe"))
                }
                InterfaceRole::Publisher => {
                    format!("{who} {} {name}, {lack}", does("publishes", "publish"))
                }
                InterfaceRole::Client
                | InterfaceRole::Server
                | InterfaceRole::ActionClient
                | InterfaceRole::ActionServer => {
                    format!("{who} {} the {sort} {name}, {lack}", does("uses", "use"))
                }
            },
        }
    }

    /// What to do about it; nothing, if nobody knows.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        match (&self.near, &self.line) {
            (Some(near), Some(line)) => {
                Some(format!("did you mean {near}? If not, add to the binding: {line}"))
            }
            (Some(near), None) => Some(format!("did you mean {near}?")),
            (None, Some(line)) => Some(format!("add to the binding: {line}")),
            (None, None) => None,
        }
    }
}

/// A program that waited until its test was over for somebody who never came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnservedWait {
    pub program: String,
    /// What the program was to the name.
    pub role: InterfaceRole,
    pub name: String,
    /// Seconds.
    pub since: f64,
}

impl UnservedWait {
    /// The sentence about it, without a full stop.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Self { program, role, name, since } = self;
        let what = match role {
            InterfaceRole::Subscriber => "a message of the topic",
            InterfaceRole::Publisher => "a subscriber of the topic",
            InterfaceRole::Client => "the service",
            InterfaceRole::Server => "a client of the service",
            InterfaceRole::ActionClient => "the action",
            InterfaceRole::ActionServer => "a client of the action",
        };
        format!("{program} waited from {since:.2} s to the end for {what} {name}, {}", role.lack())
    }
}
