//! Small worlds for the tests of what drives in them.

use hrdsl_ir::world::*;
use hrdsl_ir::{Nanos, Span};

use crate::{MotorCommand, WorldSimulation};

pub(crate) const SECOND: Nanos = 1_000_000_000;
pub(crate) const BASE: BaseId = BaseId(0);

pub(crate) fn body(name: &str, motion: BodyMotion, shape: BodyShape, position: Vec3) -> Body {
    Body {
        name: name.into(),
        motion,
        shape,
        position,
        rotation: [0.0; 3],
        mass: 1.0,
        stiffness: None,
        ghost: false,
        solid: None,
    }
}

pub(crate) fn cuboid(x: f64, y: f64, z: f64) -> BodyShape {
    BodyShape::Box { size: [x, y, z] }
}

/// A hinge about the vertical.
pub(crate) fn upright_joint(parent: BodyId, child: BodyId, anchor: Vec3, (lo, hi): (f64, f64)) -> Joint {
    let (name, motion, axis) = ("hinge".into(), JointMotion::Hinge, [0.0, 0.0, 1.0]);
    Joint { name, parent, child, motion, anchor, axis, lo, hi, drive: JointDrive::default() }
}

/// A round platform of 20 cm in radius on the ground at the origin, which drives at 1 m/s and turns at 2 rad/s; then what else there
/// is.
pub(crate) fn flat(more: Vec<Body>) -> World {
    let platform = BodyShape::Cylinder { radius: 0.2, length: 0.3 };
    let mut bodies = vec![
        body("ground", BodyMotion::Fixed, cuboid(20.0, 20.0, 0.1), [0.0, 0.0, -0.05]),
        body("platform", BodyMotion::Kinematic, platform, [0.0, 0.0, 0.15]),
    ];
    bodies.extend(more);
    let base = Base {
        name: "base".into(),
        body: BodyId(1),
        max_speed: 1.0,
        max_sideways: 0.0,
        max_turn: 2.0,
        acceleration: 2.0,
        timeout: None,
    };
    World {
        step: 10_000_000,
        sample: 50_000_000,
        gravity: [0.0, 0.0, -9.81],
        bodies,
        joints: Vec::new(),
        arms: Vec::new(),
        grippers: Vec::new(),
        bases: vec![base],
        lasers: Vec::new(),
        figures: Vec::new(),
        devices: Vec::new(),
        device_kinds: Vec::new(),
        currents: Vec::new(),
        sensors: Vec::new(),
        rules: Vec::new(),
        origin: Span::default(),
    }
}

pub(crate) fn built(world: &World) -> WorldSimulation {
    WorldSimulation::new(world, &[]).expect("a world")
}

pub(crate) fn drive(forward: f64, sideways: f64, turn: f64) -> MotorCommand {
    MotorCommand::DriveWheels { base: BASE, forward, sideways, turn }
}

/// Where the base is after so much more time.
pub(crate) fn after(sim: &mut WorldSimulation, time: Nanos) -> [f64; 3] {
    sim.advance(sim.now() + time);
    sim.base_pose(BASE).expect("a base")
}
