//! What a world knows how to tell of a device: the primitives by which the library declares the states of each kind of device.

use serde::{Deserialize, Serialize};

use crate::device_sort::DeviceSort;

/// Something that a world can tell of a device, as numbers in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceState {
    /// Of an arm: the angle of each joint, from the base.
    JointAngles,
    /// Of an arm: the speed of each joint.
    JointSpeeds,
    /// Of an arm: where its tool point is, and how the tip is turned, as a quaternion x, y, z, w.
    ToolPose,
    /// Of a gripper: how far each finger has moved, m or rad.
    FingerPlaces,
    /// Of a base: x, y, and how it is turned.
    BasePose,
    /// Of a base: how it is turned, as a quaternion x, y, z, w.
    BaseOrientation,
    /// Of a base: forward, to the left, and about the vertical.
    BaseVelocity,
    /// Of a laser: how far each beam comes.
    BeamRanges,
    /// Of a laser: the angles of its first and last beam.
    BeamAngles,
    /// Of a laser: the nearest and the farthest that it sees.
    BeamLimits,
}

impl DeviceState {
    pub const ALL: [DeviceState; 10] = [
        DeviceState::JointAngles,
        DeviceState::JointSpeeds,
        DeviceState::ToolPose,
        DeviceState::FingerPlaces,
        DeviceState::BasePose,
        DeviceState::BaseOrientation,
        DeviceState::BaseVelocity,
        DeviceState::BeamRanges,
        DeviceState::BeamAngles,
        DeviceState::BeamLimits,
    ];

    /// As it is written after `from`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DeviceState::JointAngles => "joint_angles",
            DeviceState::JointSpeeds => "joint_speeds",
            DeviceState::ToolPose => "tool_pose",
            DeviceState::FingerPlaces => "finger_places",
            DeviceState::BasePose => "base_pose",
            DeviceState::BaseOrientation => "base_orientation",
            DeviceState::BaseVelocity => "base_velocity",
            DeviceState::BeamRanges => "beam_ranges",
            DeviceState::BeamAngles => "beam_angles",
            DeviceState::BeamLimits => "beam_limits",
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
            DeviceState::JointAngles | DeviceState::JointSpeeds | DeviceState::ToolPose => DeviceSort::Arm,
            DeviceState::FingerPlaces => DeviceSort::Gripper,
            DeviceState::BasePose | DeviceState::BaseOrientation | DeviceState::BaseVelocity => {
                DeviceSort::Base
            }
            DeviceState::BeamRanges | DeviceState::BeamAngles | DeviceState::BeamLimits => DeviceSort::Laser,
        }
    }

    /// What the numbers are, for those who declare a state.
    #[must_use]
    pub fn numbers(self) -> &'static str {
        match self {
            DeviceState::JointAngles => {
                "the angle of each joint (rad; m where one slides), from the base to the tip"
            }
            DeviceState::JointSpeeds => "the speed of each joint (rad/s; m/s where one slides)",
            DeviceState::ToolPose => {
                "x, y and z of the tool point (m), and how the tip is turned, as a quaternion x, y, z, w"
            }
            DeviceState::FingerPlaces => {
                "how far each finger has moved on its joint (m or rad), in the order of their declaration"
            }
            DeviceState::BasePose => "x and y of its centre in the world (m), and its heading, −π..π",
            DeviceState::BaseOrientation => "the heading as a quaternion x, y, z, w",
            DeviceState::BaseVelocity => "forward and sideways (m/s) and turn (rad/s), as it really moves",
            DeviceState::BeamRanges => {
                "along each beam (m); infinite if nothing is met up to FAR, minus infinite if something is nearer than NEAR"
            }
            DeviceState::BeamAngles => "LO and HI (rad)",
            DeviceState::BeamLimits => "NEAR and FAR (m)",
        }
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
}
