//! The standard modules, embedded: `std.robots.bert2` is `stdlib/robots/bert2.hri`; and the standard packages of ROS interfaces.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod messages;

pub use messages::{ROS1_PACKAGES, ROS2_PACKAGES};

/// The module that every scenario has without using it: what devices can be told.
pub const DEVICES: &str = "std.devices";

/// All modules: path and text, sorted by path.
pub const MODULES: &[(&str, &str)] = &[
    (DEVICES, include_str!("../devices.hri")),
    ("std.furniture", include_str!("../furniture.hri")),
    ("std.person", include_str!("../person.hri")),
    ("std.requirements", include_str!("../requirements.hri")),
    ("std.robots.bert2", include_str!("../robots/bert2.hri")),
    ("std.robots.mobile", include_str!("../robots/mobile.hri")),
    ("std.robots.tiago", include_str!("../robots/tiago.hri")),
    ("std.sensors", include_str!("../sensors.hri")),
];

/// The text of a module.
#[must_use]
pub fn module(path: &str) -> Option<&'static str> {
    MODULES.iter().find(|(name, _)| *name == path).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    #[test]
    fn modules_are_found_by_path() {
        assert!(super::module("std.person").is_some());
        assert!(super::module("std.persn").is_none());
        assert!(super::MODULES.is_sorted_by_key(|m| m.0));
        assert!(
            super::ROS1_PACKAGES.is_sorted_by_key(|p| p.0) && super::ROS2_PACKAGES.is_sorted_by_key(|p| p.0)
        );
    }
}
