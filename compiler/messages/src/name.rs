//! Names of interfaces, and what ROS allows names to be.

use std::fmt;

use serde::Serialize;

/// Which of the two generations of ROS a text is written for: their syntaxes, names and implied types differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub enum RosVersion {
    #[serde(rename = "1")]
    Ros1,
    #[serde(rename = "2")]
    Ros2,
}

impl fmt::Display for RosVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ros1 => "ROS 1",
            Self::Ros2 => "ROS 2",
        })
    }
}

/// The part of a package that a definition lies in: its folder, and the namespace of what is generated from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum InterfaceSpace {
    Msg,
    Srv,
    Action,
}

impl InterfaceSpace {
    pub const ALL: [Self; 3] = [Self::Msg, Self::Srv, Self::Action];

    /// The folder, which is also what its files end in.
    #[must_use]
    pub fn folder(self) -> &'static str {
        match self {
            Self::Msg => "msg",
            Self::Srv => "srv",
            Self::Action => "action",
        }
    }

    /// What such a file defines.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Msg => "message",
            Self::Srv => "service",
            Self::Action => "action",
        }
    }

    /// The space of this folder.
    #[must_use]
    pub fn of_folder(folder: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.folder() == folder)
    }
}

/// Which interface: its package, its part of the package, its own name.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InterfaceName {
    pub package: String,
    pub space: InterfaceSpace,
    pub name: String,
}

impl InterfaceName {
    #[must_use]
    pub fn new(package: impl Into<String>, space: InterfaceSpace, name: impl Into<String>) -> Self {
        Self { package: package.into(), space, name: name.into() }
    }

    #[must_use]
    pub fn message(package: impl Into<String>, name: impl Into<String>) -> Self {
        Self::new(package, InterfaceSpace::Msg, name)
    }

    /// From `PACKAGE/NAME`, in the space that the place asks for, or from `PACKAGE/msg/NAME`, which says it itself.
    #[must_use]
    pub fn read(written: &str, space: InterfaceSpace) -> Option<Self> {
        let (package, rest) = written.split_once('/')?;
        let (space, name) = match rest.split_once('/') {
            Some((folder, name)) => (InterfaceSpace::of_folder(folder)?, name),
            None => (space, rest),
        };
        (is_identifier(package) && is_identifier(name)).then(|| Self::new(package, space, name))
    }

    /// As this version's tools print it: `sensor_msgs/LaserScan`, `sensor_msgs/msg/LaserScan`.
    #[must_use]
    pub fn written(&self, version: RosVersion) -> String {
        let Self { package, space, name } = self;
        match version {
            RosVersion::Ros1 => format!("{package}/{name}"),
            RosVersion::Ros2 => format!("{package}/{}/{name}", space.folder()),
        }
    }

    /// As it is written in a field: the space is left out where it is `msg`.
    #[must_use]
    pub fn in_field(&self, version: RosVersion) -> String {
        match (version, self.space) {
            (RosVersion::Ros2, InterfaceSpace::Srv | InterfaceSpace::Action) => self.written(version),
            (RosVersion::Ros1, _) | (RosVersion::Ros2, InterfaceSpace::Msg) => {
                format!("{}/{}", self.package, self.name)
            }
        }
    }
}

/// What a name is of; each has its own rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedPart {
    Package,
    Interface,
    Field,
    Constant,
}

impl NamedPart {
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Package => "package",
            Self::Interface => "interface",
            Self::Field => "field",
            Self::Constant => "constant",
        }
    }

    /// The rule in words, if the name breaks it.
    #[must_use]
    pub fn broken_rule(self, version: RosVersion, name: &str) -> Option<&'static str> {
        if name.len() > crate::limits::MOST_NAME_BYTES {
            return Some("names have at most 255 characters");
        }
        match (version, self) {
            (RosVersion::Ros1, Self::Package | Self::Interface | Self::Field | Self::Constant) => {
                (!is_identifier(name)).then_some("a letter comes first, then letters, digits and `_`")
            }
            (RosVersion::Ros2, Self::Package | Self::Field) => {
                let fits = is_snake(name, |c| c.is_ascii_lowercase());
                (!fits).then_some(
                    "a small letter comes first, then small letters, digits and single `_` between them",
                )
            }
            (RosVersion::Ros2, Self::Interface) => {
                let fits = name.starts_with(|c: char| c.is_ascii_uppercase())
                    && name.chars().all(|c| c.is_ascii_alphanumeric());
                (!fits).then_some("a capital letter comes first, then letters and digits")
            }
            (RosVersion::Ros2, Self::Constant) => {
                let fits = is_snake(name, |c| c.is_ascii_uppercase());
                (!fits).then_some(
                    "a capital letter comes first, then capital letters, digits and single `_` between them",
                )
            }
        }
    }
}

/// A letter, then letters, digits and `_`.
pub(crate) fn is_identifier(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Letters of one case and digits, with single `_` between them.
fn is_snake(name: &str, is_letter: fn(char) -> bool) -> bool {
    name.starts_with(is_letter)
        && !name.ends_with('_')
        && !name.contains("__")
        && name.chars().all(|c| is_letter(c) || c.is_ascii_digit() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_in_both_forms_and_written_in_that_of_their_version() {
        let scan = InterfaceName::message("sensor_msgs", "LaserScan");
        for written in ["sensor_msgs/LaserScan", "sensor_msgs/msg/LaserScan"] {
            assert_eq!(InterfaceName::read(written, InterfaceSpace::Msg), Some(scan.clone()));
        }
        assert_eq!(scan.written(RosVersion::Ros1), "sensor_msgs/LaserScan");
        assert_eq!(scan.written(RosVersion::Ros2), "sensor_msgs/msg/LaserScan");
        for written in ["LaserScan", "", "a/b/c", "a/msg/", "/B", "a/msg/B/C", "a b/C"] {
            assert_eq!(InterfaceName::read(written, InterfaceSpace::Msg), None, "{written}");
        }
    }

    #[test]
    fn each_version_has_its_rules() {
        use NamedPart::{Constant, Field, Interface, Package};
        let fits = |version, part: NamedPart, name: &str| part.broken_rule(version, name).is_none();
        for (part, name) in [(Field, "D"), (Field, "a__b_"), (Interface, "foo_bar"), (Constant, "lower")] {
            assert!(fits(RosVersion::Ros1, part, name), "{name}");
            assert!(!fits(RosVersion::Ros2, part, name), "{name}");
        }
        for (part, name) in [(Field, "d_1"), (Interface, "Float32"), (Constant, "A_1"), (Package, "tf2_msgs")]
        {
            assert!(fits(RosVersion::Ros1, part, name) && fits(RosVersion::Ros2, part, name), "{name}");
        }
        for name in ["", "1a", "_a", "ä", "a-b"] {
            assert!(!fits(RosVersion::Ros1, Field, name) && !fits(RosVersion::Ros2, Field, name), "{name}");
        }
        assert!(!fits(RosVersion::Ros1, Field, &"a".repeat(256)));
    }
}
