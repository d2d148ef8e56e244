//! The sorts of devices: what the world has of which devices can be made.

use serde::{Deserialize, Serialize};

/// What the world has of which devices can be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviceSort {
    Arm,
    Gripper,
    Base,
    Laser,
}

impl DeviceSort {
    pub const ALL: [DeviceSort; 4] =
        [DeviceSort::Arm, DeviceSort::Gripper, DeviceSort::Base, DeviceSort::Laser];

    /// As the member of a world or part is written that makes one.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DeviceSort::Arm => "arm",
            DeviceSort::Gripper => "gripper",
            DeviceSort::Base => "base",
            DeviceSort::Laser => "laser",
        }
    }
}
