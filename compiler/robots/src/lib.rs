//! Descriptions of robots: URDF, xacro, SRDF, meshes and occupancy maps, read, resolved and checked, as plain data.
//!
//! 1. [`PackageTable`] knows the folders that `package://` and `$(find …)` lead to; [`PackageTable::search`] finds them;
//! 2. [`read_robot`] takes a [`RobotRequest`] and reads everything through a [`RobotReader`]: it expands xacro, reads links and
//!    joints, checks them, and reads the meshes and the SRDF;
//! 3. the [`RobotReading`] has the [`UrdfRobot`], its [`TriangleMesh`]es, the [`SrdfSemantics`], and a [`RobotFault`] for whatever
//!    is wrong;
//! 4. [`UrdfRobot::link_poses`] says where the links are for given values of the joints;
//! 5. [`read_map`] makes an occupancy map to an [`OccupancyMap`] of walls.
//!
//! Nothing here knows a clock, chance, or the file system. Faults are told by their place and a help; the codes that diagnostics
//! have are given to them where they are reported ([`RobotFault::diagnostic`]).
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod fault;
mod files;
pub mod limits;
mod map;
mod mesh;
mod robot;
mod space;
mod srdf;
mod urdf;
mod xacro;
mod xml;
mod yaml;

pub use fault::{RobotFault, RobotFaultKind, RobotPlace};
pub use files::{
    package::PackageTable,
    reader::{RobotEntry, RobotReader},
};
pub use map::read::{MapMode, MapWall, OccupancyMap, read_map};
pub use mesh::{
    model::{MeshAxis, TriangleMesh},
    read_mesh,
};
pub use robot::{MeshChoice, RobotReading, RobotRequest, expanded_text, read_robot};
pub use space::{
    inertia::InertiaTensor,
    transform::{RigidTransform, RobotVector},
};
pub use srdf::model::{
    SrdfChain, SrdfDisabledPair, SrdfEndEffector, SrdfGroup, SrdfPassiveJoint, SrdfSemantics, SrdfState,
    SrdfVirtualJoint, SrdfVirtualKind,
};
pub use urdf::model::{
    UrdfActuator, UrdfDynamics, UrdfGeometry, UrdfInertial, UrdfJoint, UrdfJointId, UrdfJointKind,
    UrdfLimits, UrdfLink, UrdfLinkId, UrdfMesh, UrdfMimic, UrdfOrigin, UrdfRangeSensor, UrdfRobot,
    UrdfSafety, UrdfScan, UrdfShape, UrdfTransmission, UrdfTransmissionJoint,
};
