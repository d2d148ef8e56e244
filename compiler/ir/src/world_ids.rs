//! The numbers of what a world has.

use serde::{Deserialize, Serialize};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub struct $name(pub u16);
    )* };
}

ids! {
    /// Index into [`World::bodies`](crate::world::World::bodies).
    BodyId,
    /// Index into [`World::joints`](crate::world::World::joints).
    JointId,
    /// Index into [`World::arms`](crate::world::World::arms).
    ArmId,
    /// Index into [`World::grippers`](crate::world::World::grippers).
    GripperId,
    /// Index into [`World::bases`](crate::world::World::bases).
    BaseId,
    /// Index into [`World::lasers`](crate::world::World::lasers).
    LaserId,
    /// Index into [`World::figures`](crate::world::World::figures).
    FigureId,
    /// Index into [`World::devices`](crate::world::World::devices).
    DeviceId,
    /// Index into [`World::device_kinds`](crate::world::World::device_kinds).
    DeviceKindId,
    /// Index into [`DeviceKind::commands`](crate::device::DeviceKind::commands).
    DeviceCommandId,
    /// Index into [`World::currents`](crate::world::World::currents).
    CurrentId,
    /// Index into [`Program::signals`](crate::Program::signals).
    SignalId,
}

/// A body, named outright or as [`CurrentBody`](crate::world::CurrentBody).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyRef {
    Body(BodyId),
    Current(CurrentId),
}
