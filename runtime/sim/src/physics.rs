//! The physics engine behind the names of the scenario: bodies by [`BodyId`], in double precision, checked once.
//!
//! A joint whose limits are both zero joins its child rigidly: the two are one body of the engine, with two shapes.

mod contact;
mod surface;

use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{Body, BodyId, BodyMotion, BodyShape, Joint, World};
use rapier3d::prelude::*;

use crate::{
    error::SimError,
    math::{BodyFrame, RotationQuat, SpaceVector, from_pose, from_rpy, from_vector, to_pose, to_vector, v3},
};

/// What a body may touch. The arm does not touch itself, nor the people; a palm does not touch what hands can hold, so
/// that coming near does not knock it over; what is held touches only the surroundings and what lies about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CollisionClass {
    /// The surroundings.
    Scenery,
    /// Part of an articulated figure.
    Limb,
    /// A gripper's palm, with what is joined rigidly to it, on an articulated figure.
    Palm,
    /// Kinematic.
    Actor,
    /// A kinematic or fixed palm.
    ActorPalm,
    /// A dynamic body that no gripper can hold.
    Loose,
    /// A dynamic body that some gripper can hold.
    Thing,
    /// The same, held.
    Held,
}

impl CollisionClass {
    const fn bit(self) -> u32 {
        match self {
            CollisionClass::Scenery => 1,
            CollisionClass::Limb => 2,
            CollisionClass::Palm => 4,
            CollisionClass::Actor => 8,
            CollisionClass::ActorPalm => 16,
            CollisionClass::Loose => 32,
            CollisionClass::Thing => 64,
            CollisionClass::Held => 128,
        }
    }

    fn touches(self) -> u32 {
        use CollisionClass::{Actor, ActorPalm, Held, Limb, Loose, Palm, Scenery, Thing};
        let classes: &[CollisionClass] = match self {
            Scenery => &[Limb, Palm, Loose, Thing, Held],
            Limb => &[Scenery, Loose, Thing],
            Palm => &[Scenery, Loose],
            Actor => &[Loose, Thing],
            ActorPalm => &[Loose],
            Loose => &[Scenery, Limb, Palm, Actor, ActorPalm, Loose, Thing, Held],
            Thing => &[Scenery, Limb, Actor, Loose, Thing, Held],
            Held => &[Scenery, Loose, Thing, Held],
        };
        classes.iter().fold(0, |bits, c| bits | c.bit())
    }

    fn groups(self) -> InteractionGroups {
        InteractionGroups::new(self.bit().into(), self.touches().into(), InteractionTestMode::And)
    }
}

/// One body of the scenario.
struct PhysicsBody {
    handle: RigidBodyHandle,
    collider: ColliderHandle,
    /// Within the engine's body.
    local: BodyFrame,
    start: BodyFrame,
    /// The body that this one is one with.
    root: BodyId,
    motion: BodyMotion,
    ghost: bool,
    shape: BodyShape,
}

pub(crate) struct PhysicsAdapter {
    world: PhysicsWorld,
    parts: Vec<PhysicsBody>,
    /// By [`hrdsl_ir::world::JointId`]; none where the joint is rigid.
    joints: Vec<Option<HingeJoint>>,
}

/// A joint of the engine.
struct HingeJoint {
    handle: ImpulseJointHandle,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
    /// At the start, in the world.
    axis: SpaceVector,
    /// Of the child relative to the parent, at the start.
    parent_start: RotationQuat,
    child_start: RotationQuat,
    /// What the motor aims at: angle and speed.
    aim: Option<(f32, f32)>,
}

/// Added to each limb's inertia, kg·m²: that of the motor's rotor, which a gear multiplies. It also keeps the small
/// bodies between two axes of a shoulder or wrist from being much lighter than their neighbours, which an iterative
/// solver answers with joints that come apart.
const ROTOR: f32 = 0.1;
/// A motor's stiffness (N·m/rad) and damping (N·m·s/rad): so high that a load hardly matters. Their quotient, 1/s, is how
/// fast an error of position is made good; much higher, and the solver's parts of a step overshoot the mean speed.
const STIFFNESS: f32 = 20_000.0;
const DAMPING: f32 = 2_000.0;

impl PhysicsAdapter {
    pub fn new(world: &World) -> Result<PhysicsAdapter, SimError> {
        let roots = rigid_roots(world)?;
        let mut engine = PhysicsWorld::new();
        engine.gravity = to_vector(v3(world.gravity));
        let parameters = &mut engine.integration_parameters;
        parameters.dt = seconds(world.step) as f32;
        // With the rotors below, enough for the tool to be within 1 mm; the cost is in proportion.
        parameters.num_solver_iterations = 4;
        let mut physics = PhysicsAdapter { world: engine, parts: Vec::new(), joints: Vec::new() };
        physics.add_bodies(world, &roots)?;
        for joint in &world.joints {
            let hinge = if is_rigid(joint) { None } else { Some(physics.add_hinge(joint)) };
            physics.joints.push(hinge);
        }
        Ok(physics)
    }

    fn add_bodies(&mut self, world: &World, roots: &[BodyId]) -> Result<(), SimError> {
        let classes = classes(world, roots);
        let driven: Vec<BodyId> = world
            .arms
            .iter()
            .flat_map(|a| &a.joints)
            .filter_map(|id| world.joints.get(usize::from(id.0)))
            .map(|joint| roots[index(joint.child)])
            .collect();
        let handles: Vec<Option<RigidBodyHandle>> = (0..world.bodies.len())
            .map(|i| {
                (index(roots[i]) == i).then(|| self.add_rigid(&world.bodies[i], driven.contains(&body_id(i))))
            })
            .collect();
        for (i, body) in world.bodies.iter().enumerate() {
            let root = roots[i];
            let Some(handle) = handles[index(root)] else {
                return Err(bad(format!("body `{}`", body.name), "body", index(root)));
            };
            let motion = world.bodies[index(root)].motion;
            let start = start_of(body);
            let local = start_of(&world.bodies[index(root)]).inverse().then(&start);
            let collider = ColliderBuilder::new(shape_of(body)?)
                .position(to_pose(&local))
                .mass(if motion == BodyMotion::Dynamic { checked_mass(body)? } else { 0.0 })
                .friction(0.8)
                .sensor(body.ghost)
                .collision_groups(classes[i].groups());
            let bodies = &mut self.world.bodies;
            let collider = self.world.colliders.insert_with_parent(collider, handle, bodies);
            let (ghost, shape) = (body.ghost, body.shape);
            self.parts.push(PhysicsBody { handle, collider, local, start, root, motion, ghost, shape });
        }
        Ok(())
    }

    /// A limb moved by motors has no weight, since they carry it, and a rotor.
    fn add_rigid(&mut self, body: &Body, driven: bool) -> RigidBodyHandle {
        let builder = match body.motion {
            BodyMotion::Fixed => RigidBodyBuilder::fixed(),
            BodyMotion::Dynamic => RigidBodyBuilder::dynamic(),
            BodyMotion::Kinematic => RigidBodyBuilder::kinematic_position_based(),
        };
        let mut builder = builder.pose(to_pose(&start_of(body)));
        if driven && body.motion == BodyMotion::Dynamic {
            let rotor = MassProperties::new(Vector::ZERO, 0.0, Vector::splat(ROTOR));
            builder = builder.gravity_scale(0.0).can_sleep(false).additional_mass_properties(rotor);
        }
        self.world.insert_body(builder)
    }

    fn add_hinge(&mut self, joint: &Joint) -> HingeJoint {
        let axis = v3(joint.axis).normalize();
        let hinge = BodyFrame::new(v3(joint.anchor), x_to(&axis));
        let (parent, child) = (self.root(joint.parent), self.root(joint.child));
        let (p, c) = (&self.parts[index(parent)], &self.parts[index(child)]);
        let mut data = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
            .local_frame1(to_pose(&p.start.inverse().then(&hinge)))
            .local_frame2(to_pose(&c.start.inverse().then(&hinge)))
            .contacts_enabled(false)
            .build();
        data.set_limits(JointAxis::AngX, [joint.lo as f32, joint.hi as f32]);
        let (parent_start, child_start) = (p.start.turn, c.start.turn);
        let (parent, child) = (p.handle, c.handle);
        let handle = self.world.insert_impulse_joint(parent, child, data);
        HingeJoint { handle, parent, child, axis, parent_start, child_start, aim: None }
    }

    // ── Bodies ──

    pub fn root(&self, body: BodyId) -> BodyId {
        self.parts[index(body)].root
    }

    pub fn motion(&self, body: BodyId) -> BodyMotion {
        self.parts[index(body)].motion
    }

    pub fn start(&self, body: BodyId) -> BodyFrame {
        self.parts[index(body)].start
    }

    /// Where the body is.
    pub fn pose(&self, body: BodyId) -> BodyFrame {
        let part = &self.parts[index(body)];
        from_pose(self.world.bodies[part.handle].position()).then(&part.local)
    }

    /// Of the body's centre, m/s.
    pub fn speed(&self, body: BodyId) -> f64 {
        let centre = to_vector(self.pose(body).at);
        from_vector(self.world.bodies[self.parts[index(body)].handle].velocity_at_point(centre)).norm()
    }

    /// A kinematic body will be there at the end of the next step.
    pub fn lead(&mut self, body: BodyId, to: &BodyFrame) {
        let handle = self.parts[index(body)].handle;
        self.world.bodies[handle].set_next_kinematic_position(to_pose(to));
    }

    /// Whether any hand holds the body, and whether one with motors does: these compensate its weight.
    pub fn set_held(&mut self, body: BodyId, held: bool, motorised: bool) {
        let class = if held { CollisionClass::Held } else { CollisionClass::Thing };
        let part = &self.parts[index(body)];
        self.world.colliders[part.collider].set_collision_groups(class.groups());
        self.world.bodies[part.handle].set_gravity_scale(if motorised { 0.0 } else { 1.0 }, true);
    }

    /// Fixes a body to a palm where it is now.
    pub fn attach(&mut self, palm: BodyId, body: BodyId) -> ImpulseJointHandle {
        let (p, b) = (&self.parts[index(palm)], &self.parts[index(body)]);
        let between = from_pose(self.world.bodies[p.handle].position())
            .inverse()
            .then(&from_pose(self.world.bodies[b.handle].position()));
        let data = GenericJointBuilder::new(JointAxesMask::LOCKED_FIXED_AXES)
            .local_frame1(to_pose(&between))
            .contacts_enabled(false)
            .build();
        let (parent, child) = (p.handle, b.handle);
        self.world.insert_impulse_joint(parent, child, data)
    }

    pub fn detach(&mut self, joint: ImpulseJointHandle) {
        self.world.remove_impulse_joint(joint);
    }

    // ── Joints ──

    /// The measured angle, rad.
    pub fn joint_angle(&self, joint: usize) -> f64 {
        let Some(hinge) = &self.joints[joint] else { return 0.0 };
        let turn = |h: RigidBodyHandle| from_pose(self.world.bodies[h].position()).turn;
        let parent = turn(hinge.parent) * hinge.parent_start.inverse();
        let child = turn(hinge.child) * hinge.child_start.inverse();
        crate::math::twist(&(parent.inverse() * child), &hinge.axis)
    }

    /// The measured speed about the axis, rad/s.
    pub fn joint_speed(&self, joint: usize) -> f64 {
        let Some(hinge) = &self.joints[joint] else { return 0.0 };
        let (p, c) = (&self.world.bodies[hinge.parent], &self.world.bodies[hinge.child]);
        let axis = from_pose(p.position()).turn * hinge.parent_start.inverse() * hinge.axis;
        (from_vector(c.angvel()) - from_vector(p.angvel())).dot(&axis)
    }

    /// What the motor aims at: the angle (rad) and the speed (rad/s).
    pub fn drive(&mut self, joint: usize, angle: f64, speed: f64) {
        let Some(hinge) = &mut self.joints[joint] else { return };
        let aim = (angle as f32, speed as f32);
        if hinge.aim.replace(aim) == Some(aim) {
            return;
        }
        if let Some(joint) = self.world.impulse_joints.get_mut(hinge.handle, false) {
            let axis = JointAxis::AngX;
            joint.data.set_motor_model(axis, MotorModel::ForceBased);
            joint.data.set_motor(axis, aim.0, aim.1, STIFFNESS, DAMPING);
        }
    }

    // ── Time ──

    pub fn step(&mut self) {
        self.world.step();
        self.stop_lost();
    }

    /// What has left the scene (say, fallen where there is no floor) stays where it is: it would fall for ever, and the
    /// world never rest.
    fn stop_lost(&mut self) {
        for (_, body) in self.world.bodies.iter_mut() {
            if body.is_dynamic() && body.translation().length() > SCENE {
                body.set_body_type(RigidBodyType::Fixed, false);
            }
        }
    }

    /// Whether no body moves faster than the eye would see.
    pub fn is_quiet(&self) -> bool {
        self.world.bodies.iter().all(|(_, b)| {
            !b.is_dynamic_or_kinematic()
                || (b.linvel().length() < QUIET_LINEAR && b.angvel().length() < QUIET_ANGULAR)
        })
    }

    /// Takes away what little motion is left.
    pub fn freeze(&mut self) {
        let still = RigidBodyVelocity::zero();
        for (_, body) in self.world.bodies.iter_mut() {
            if body.is_dynamic_or_kinematic() {
                body.set_vels(still, false);
            }
        }
    }
}

/// Metres from the origin.
const SCENE: f32 = 20.0;
/// m/s
const QUIET_LINEAR: f32 = 4e-3;
/// rad/s
const QUIET_ANGULAR: f32 = 1.5e-2;

pub(crate) fn index(body: BodyId) -> usize {
    usize::from(body.0)
}

pub(crate) fn body_id(i: usize) -> BodyId {
    BodyId(u16::try_from(i).unwrap_or(u16::MAX))
}

pub(crate) fn bad(what: String, kind: &'static str, index: usize) -> SimError {
    SimError::BadReference { what, kind, index }
}

fn start_of(body: &Body) -> BodyFrame {
    BodyFrame::new(v3(body.position), from_rpy(body.rotation))
}

fn is_rigid(joint: &Joint) -> bool {
    joint.lo == 0.0 && joint.hi == 0.0
}

/// For each body the one that it is rigidly one with: the topmost over joints that cannot move.
fn rigid_roots(world: &World) -> Result<Vec<BodyId>, SimError> {
    let count = world.bodies.len();
    let mut above: Vec<Option<BodyId>> = vec![None; count];
    for joint in &world.joints {
        for body in [joint.parent, joint.child] {
            if index(body) >= count {
                return Err(bad(format!("joint `{}`", joint.name), "body", index(body)));
            }
        }
        let numbers = joint.anchor.iter().chain(&joint.axis).chain([&joint.lo, &joint.hi]);
        if !numbers.into_iter().all(|x| x.is_finite()) || v3(joint.axis).norm() < 1e-9 || joint.lo > joint.hi
        {
            return Err(SimError::BadNumber { what: format!("a measure of joint `{}`", joint.name) });
        }
        let child = index(joint.child);
        if world.bodies[child].motion != BodyMotion::Dynamic || joint.parent == joint.child {
            return Err(SimError::BadChild { joint: joint.name.clone() });
        }
        if is_rigid(joint) && above[child].replace(joint.parent).is_some() {
            return Err(SimError::BadChild { joint: joint.name.clone() });
        }
    }
    let root = |start: usize| {
        let mut at = body_id(start);
        for _ in 0..=count {
            match above[index(at)] {
                Some(up) => at = up,
                None => return Ok(at),
            }
        }
        Err(SimError::BadChild { joint: world.bodies[start].name.clone() })
    };
    (0..count).map(root).collect()
}

fn classes(world: &World, roots: &[BodyId]) -> Vec<CollisionClass> {
    let jointed = |root: BodyId| {
        let ends = world.joints.iter().filter(|j| !is_rigid(j)).flat_map(|j| [j.parent, j.child]);
        ends.into_iter().any(|b| roots[index(b)] == root)
    };
    let palm = |root: BodyId| world.grippers.iter().any(|g| roots[index(g.palm)] == root);
    let holdable = |body: BodyId| world.grippers.iter().any(|g| g.holds.contains(&body));
    (0..world.bodies.len())
        .map(|i| {
            let root = roots[i];
            match (world.bodies[index(root)].motion, palm(root), jointed(root)) {
                (BodyMotion::Dynamic, true, _) => CollisionClass::Palm,
                (BodyMotion::Dynamic | BodyMotion::Fixed, false, true) => CollisionClass::Limb,
                (BodyMotion::Dynamic, false, false) if holdable(body_id(i)) => CollisionClass::Thing,
                (BodyMotion::Dynamic, false, false) => CollisionClass::Loose,
                (BodyMotion::Kinematic, false, _) => CollisionClass::Actor,
                (BodyMotion::Kinematic | BodyMotion::Fixed, true, _) => CollisionClass::ActorPalm,
                (BodyMotion::Fixed, false, false) => CollisionClass::Scenery,
            }
        })
        .collect()
}

fn checked_mass(body: &Body) -> Result<f32, SimError> {
    if body.mass.is_finite() && body.mass > 0.0 {
        Ok(body.mass as f32)
    } else {
        Err(SimError::BadNumber { what: format!("the mass of body `{}`", body.name) })
    }
}

fn shape_of(body: &Body) -> Result<SharedShape, SimError> {
    let measures: Vec<f64> = match body.shape {
        BodyShape::Box { size } => size.to_vec(),
        BodyShape::Sphere { radius } => vec![radius],
        BodyShape::Capsule { radius, length } | BodyShape::Cylinder { radius, length } => {
            vec![radius, length]
        }
    };
    let place = body.position.iter().chain(&body.rotation);
    if measures.iter().any(|m| !m.is_finite() || *m <= 0.0) || !place.into_iter().all(|x| x.is_finite()) {
        return Err(SimError::BadNumber { what: format!("a measure of body `{}`", body.name) });
    }
    let half = |x: f64| (x / 2.0) as f32;
    Ok(match body.shape {
        BodyShape::Box { size } => SharedShape::cuboid(half(size[0]), half(size[1]), half(size[2])),
        BodyShape::Sphere { radius } => SharedShape::ball(radius as f32),
        BodyShape::Capsule { radius, length } => SharedShape::capsule_z(half(length), radius as f32),
        // The engine's cylinder lies along y.
        BodyShape::Cylinder { radius, length } => SharedShape::compound(vec![(
            Pose::from_parts(Vector::ZERO, Rotation::from_xyzw(SQRT_HALF, 0.0, 0.0, SQRT_HALF)),
            SharedShape::cylinder(half(length), radius as f32),
        )]),
    })
}

const SQRT_HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// A rotation that takes the x axis to the given unit vector.
fn x_to(axis: &SpaceVector) -> RotationQuat {
    let turn = SpaceVector::x().cross(axis);
    let angle = crate::math::angle_between(&SpaceVector::x(), axis);
    let about = if turn.norm() < 1e-9 { SpaceVector::z() } else { turn.normalize() };
    crate::math::about(about, angle)
}
