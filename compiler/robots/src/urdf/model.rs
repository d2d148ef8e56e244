//! A robot as plain data: links, joints, and what URDF says of them.
//!
//! Lengths in metres, angles in radians, masses in kilograms, as URDF has them.

use crate::{
    fault::RobotPlace,
    space::{
        inertia::InertiaTensor,
        transform::{RigidTransform, RobotVector},
    },
};

/// Index into [`UrdfRobot::links`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct UrdfLinkId(pub usize);

/// Index into [`UrdfRobot::joints`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct UrdfJointId(pub usize);

/// A robot: a tree of links, joined by joints.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfRobot {
    pub name: String,
    /// In the order of the text.
    pub links: Vec<UrdfLink>,
    /// The same.
    pub joints: Vec<UrdfJoint>,
    /// The link that is no joint's child.
    pub root: UrdfLinkId,
    /// All joints, each after that whose child is its parent.
    pub order: Vec<UrdfJointId>,
    pub transmissions: Vec<UrdfTransmission>,
    /// Range sensors of `<gazebo>`: ray, gpu_ray, lidar.
    pub range_sensors: Vec<UrdfRangeSensor>,
    /// Of `robot`.
    pub place: RobotPlace,
}

/// A rigid body, or a mere frame if it has neither mass nor shape.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfLink {
    pub name: String,
    pub inertial: Option<UrdfInertial>,
    /// What touches; several shapes make one body.
    pub collisions: Vec<UrdfShape>,
    /// What is seen.
    pub visuals: Vec<UrdfShape>,
    /// `selfCollide` of the link's `<gazebo>`.
    pub self_collide: Option<bool>,
    /// Of the link's name.
    pub place: RobotPlace,
}

/// Mass, and how it is spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrdfInertial {
    /// The centre of mass, and the axes of the tensor, in the link's frame.
    pub origin: UrdfOrigin,
    pub mass: f64,
    /// About the centre of mass, along the axes of `origin`.
    pub inertia: InertiaTensor,
    pub place: RobotPlace,
}

/// A pose as it is written: a displacement, and roll, pitch, yaw about the fixed axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UrdfOrigin {
    pub xyz: RobotVector,
    pub rpy: RobotVector,
}

impl UrdfOrigin {
    #[must_use]
    pub fn transform(&self) -> RigidTransform {
        RigidTransform::from_origin(self.xyz, self.rpy)
    }
}

/// A `collision` or a `visual`.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfShape {
    pub name: Option<String>,
    /// In the link's frame.
    pub origin: UrdfOrigin,
    pub geometry: UrdfGeometry,
    /// Red, green, blue, alpha, each from 0 to 1; of a `visual` whose material has a colour.
    pub color: Option<[f64; 4]>,
    pub place: RobotPlace,
}

#[derive(Clone, Debug, PartialEq)]
pub enum UrdfGeometry {
    /// Full lengths of the edges.
    Box {
        size: RobotVector,
    },
    /// Along z, centred.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    /// Along z, centred; the length is without the caps.
    Capsule {
        radius: f64,
        length: f64,
    },
    Mesh(UrdfMesh),
}

/// A mesh by its address.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfMesh {
    /// As it is written: `package://…`.
    pub address: String,
    /// The file that it leads to; `None` if that was a fault.
    pub path: Option<String>,
    /// What its points are multiplied by, each coordinate on its own; may mirror.
    pub scale: RobotVector,
    pub place: RobotPlace,
}

/// A joint between two links. At 0 the child's frame is `origin` in the parent's.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfJoint {
    pub name: String,
    pub kind: UrdfJointKind,
    pub parent: UrdfLinkId,
    pub child: UrdfLinkId,
    pub origin: UrdfOrigin,
    /// Of length 1, in the joint's frame; that of a fixed joint means nothing.
    pub axis: RobotVector,
    pub limits: Option<UrdfLimits>,
    pub dynamics: UrdfDynamics,
    pub mimic: Option<UrdfMimic>,
    pub safety: Option<UrdfSafety>,
    /// Of the joint's name.
    pub place: RobotPlace,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UrdfJointKind {
    Fixed,
    /// A hinge between limits.
    Revolute,
    /// A hinge without.
    Continuous,
    /// Along its axis, between limits.
    Prismatic,
    /// Free in space; only of a child of the root.
    Floating,
    /// Free in the plane across its axis; only of a child of the root.
    Planar,
}

impl UrdfJointKind {
    pub const ALL: [Self; 6] =
        [Self::Fixed, Self::Revolute, Self::Continuous, Self::Prismatic, Self::Floating, Self::Planar];

    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Floating => "floating",
            Self::Planar => "planar",
        }
    }

    /// Whether one number says where it is.
    #[must_use]
    pub fn has_one_value(self) -> bool {
        match self {
            Self::Revolute | Self::Continuous | Self::Prismatic => true,
            Self::Fixed | Self::Floating | Self::Planar => false,
        }
    }

    /// Whether its place is limited.
    #[must_use]
    pub fn has_range(self) -> bool {
        match self {
            Self::Revolute | Self::Prismatic => true,
            Self::Fixed | Self::Continuous | Self::Floating | Self::Planar => false,
        }
    }
}

/// Radians or metres, and those a second; newton metres or newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrdfLimits {
    /// 0 where it is not written, as in URDF; of no meaning for a continuous joint.
    pub lower: f64,
    pub upper: f64,
    /// `None` where it is not written.
    pub effort: Option<f64>,
    pub velocity: Option<f64>,
    pub place: RobotPlace,
}

/// Of the joint itself: N m s/rad or N s/m, and N m or N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UrdfDynamics {
    pub damping: f64,
    pub friction: f64,
}

/// The joint is always where another is, times a factor, plus an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrdfMimic {
    pub joint: UrdfJointId,
    pub multiplier: f64,
    pub offset: f64,
    pub place: RobotPlace,
}

/// `safety_controller`: limits that a controller keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrdfSafety {
    pub soft_lower_limit: f64,
    pub soft_upper_limit: f64,
    pub k_position: f64,
    pub k_velocity: f64,
}

/// How motors move joints.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfTransmission {
    pub name: String,
    /// `transmission_interface/SimpleTransmission`; empty if it is not written.
    pub kind: String,
    pub joints: Vec<UrdfTransmissionJoint>,
    pub actuators: Vec<UrdfActuator>,
    pub place: RobotPlace,
}

/// A joint that a transmission moves.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfTransmissionJoint {
    pub joint: UrdfJointId,
    pub hardware_interfaces: Vec<String>,
    pub reduction: Option<f64>,
}

/// A motor.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfActuator {
    pub name: String,
    pub hardware_interfaces: Vec<String>,
    pub reduction: Option<f64>,
}

/// A laser scanner, as Gazebo's extensions describe it.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfRangeSensor {
    pub name: String,
    pub link: UrdfLinkId,
    /// In the link's frame.
    pub origin: UrdfOrigin,
    pub horizontal: UrdfScan,
    /// `None` of a planar scanner.
    pub vertical: Option<UrdfScan>,
    pub range_min: f64,
    pub range_max: f64,
    /// Scans a second.
    pub update_rate: Option<f64>,
    pub place: RobotPlace,
}

/// The beams of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrdfScan {
    pub samples: u32,
    pub min_angle: f64,
    pub max_angle: f64,
}

impl UrdfRobot {
    #[must_use]
    pub fn link(&self, id: UrdfLinkId) -> Option<&UrdfLink> {
        self.links.get(id.0)
    }

    #[must_use]
    pub fn joint(&self, id: UrdfJointId) -> Option<&UrdfJoint> {
        self.joints.get(id.0)
    }

    /// The link of this name.
    #[must_use]
    pub fn link_named(&self, name: &str) -> Option<UrdfLinkId> {
        self.links.iter().position(|link| link.name == name).map(UrdfLinkId)
    }

    /// The joint of this name.
    #[must_use]
    pub fn joint_named(&self, name: &str) -> Option<UrdfJointId> {
        self.joints.iter().position(|joint| joint.name == name).map(UrdfJointId)
    }

    /// The joint whose child is this link; `None` of the root.
    #[must_use]
    pub fn joint_above(&self, link: UrdfLinkId) -> Option<UrdfJointId> {
        self.joints.iter().position(|joint| joint.child == link).map(UrdfJointId)
    }

    /// The joints whose parent is this link, in the order of the text.
    pub fn joints_below(&self, link: UrdfLinkId) -> impl Iterator<Item = UrdfJointId> {
        self.joints
            .iter()
            .enumerate()
            .filter(move |(_, joint)| joint.parent == link)
            .map(|(at, _)| UrdfJointId(at))
    }

    /// The joints from one link down to another; `None` if the second does not lie below the first.
    #[must_use]
    pub fn chain(&self, base: UrdfLinkId, tip: UrdfLinkId) -> Option<Vec<UrdfJointId>> {
        let mut joints = Vec::new();
        let mut at = tip;
        while at != base {
            let id = self.joint_above(at)?;
            joints.push(id);
            at = self.joint(id)?.parent;
        }
        joints.reverse();
        Some(joints)
    }

    /// The mass of all links.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        self.links.iter().filter_map(|link| link.inertial).map(|inertial| inertial.mass).sum()
    }

    /// All shapes with a mesh, and whether they are for collisions.
    pub fn meshes(&self) -> impl Iterator<Item = (&UrdfMesh, bool)> {
        self.links.iter().flat_map(|link| {
            let collisions = link.collisions.iter().map(|shape| (shape, true));
            collisions.chain(link.visuals.iter().map(|shape| (shape, false))).filter_map(
                |(shape, touches)| match &shape.geometry {
                    UrdfGeometry::Mesh(mesh) => Some((mesh, touches)),
                    UrdfGeometry::Box { .. }
                    | UrdfGeometry::Cylinder { .. }
                    | UrdfGeometry::Sphere { .. }
                    | UrdfGeometry::Capsule { .. } => None,
                },
            )
        })
    }
}
