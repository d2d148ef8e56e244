//! What devices tell of themselves: each state has a name, by which programs ask for it, and is of one sort of device.

use serde::{Deserialize, Serialize};

use crate::device::DeviceSort;

/// Something that a device tells the system of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceState {
    /// Of an arm: the angle of each joint.
    Joints,
    /// Of an arm: the speed of each joint.
    Speeds,
    /// Of an arm: where its tool point is.
    Tool,
    /// Of a base: x, y, and how it is turned.
    Pose,
    /// Of a base: how it is turned, as a quaternion x, y, z, w.
    Orientation,
    /// Of a base: forward, to the left, and about the vertical.
    Velocity,
    /// Of a laser: how far each beam comes.
    Ranges,
    /// Of a laser: the angles of its first and last beam.
    Angles,
    /// Of a laser: the nearest and the farthest that it sees.
    Limits,
}

impl DeviceState {
    pub const ALL: [DeviceState; 9] = [
        DeviceState::Joints,
        DeviceState::Speeds,
        DeviceState::Tool,
        DeviceState::Pose,
        DeviceState::Orientation,
        DeviceState::Velocity,
        DeviceState::Ranges,
        DeviceState::Angles,
        DeviceState::Limits,
    ];

    /// As a program asks for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DeviceState::Joints => "joints",
            DeviceState::Speeds => "speeds",
            DeviceState::Tool => "tool",
            DeviceState::Pose => "pose",
            DeviceState::Orientation => "orientation",
            DeviceState::Velocity => "velocity",
            DeviceState::Ranges => "ranges",
            DeviceState::Angles => "angles",
            DeviceState::Limits => "limits",
        }
    }

    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|state| state.name() == name)
    }

    /// Whose it is.
    #[must_use]
    pub fn sort(self) -> DeviceSort {
        match self {
            DeviceState::Joints | DeviceState::Speeds | DeviceState::Tool => DeviceSort::Arm,
            DeviceState::Pose | DeviceState::Orientation | DeviceState::Velocity => DeviceSort::Base,
            DeviceState::Ranges | DeviceState::Angles | DeviceState::Limits => DeviceSort::Laser,
        }
    }

    /// What each sort of device can tell: ``an arm can tell `joints`, `speeds` and `tool`, …, a gripper nothing``.
    #[must_use]
    pub fn of_all_sorts() -> String {
        let sorts = [DeviceSort::Arm, DeviceSort::Base, DeviceSort::Laser, DeviceSort::Gripper];
        let mut told = Vec::new();
        for (at, sort) in sorts.into_iter().enumerate() {
            let own = Self::ALL.into_iter().filter(|state| state.sort() == sort);
            let names: Vec<String> = own.map(|state| format!("`{}`", state.name())).collect();
            let names = match names.as_slice() {
                [] => "nothing".to_owned(),
                [one] => one.clone(),
                [first @ .., last] => format!("{} and {last}", first.join(", ")),
            };
            let article = if sort == DeviceSort::Arm { "an" } else { "a" };
            let can = if at == 0 { "can tell " } else { "" };
            told.push(format!("{article} {} {can}{names}", sort.name()));
        }
        told.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_found_and_stored_by_their_names() {
        for state in DeviceState::ALL {
            assert_eq!(DeviceState::named(state.name()), Some(state));
            assert_eq!(serde_json::to_value(state).unwrap(), state.name());
        }
        assert_eq!(DeviceState::named("mood"), None);
    }

    #[test]
    fn who_asks_in_vain_is_told_what_there_is() {
        assert_eq!(
            DeviceState::of_all_sorts(),
            "an arm can tell `joints`, `speeds` and `tool`, a base `pose`, `orientation` and `velocity`, a laser \
             `ranges`, `angles` and `limits`, a gripper nothing"
        );
    }
}
