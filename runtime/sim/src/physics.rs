//! The physics engine behind the names of the scenario: bodies by [`BodyId`], in double precision, checked once.
//!
//! A joint whose limits are both zero joins its child rigidly: the two are one body of the engine, with two shapes.

mod contact;
pub(crate) mod dynamics;
mod energy;
mod guide;
mod joints;
mod losses;
mod pairs;
mod solid;
mod surface;
pub(crate) mod wheels;
mod yielding;

use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{Body, BodyId, BodyMotion, BodyShape, JointMotion, World};
use rapier3d::prelude::*;

use crate::{
    error::SimError,
    math::{BodyFrame, from_pose, from_rpy, from_vector, to_pose, to_vector, v3},
};
use energy::EnergyWatch;
use guide::BodyGuide;
use joints::DrivenJoint;
use losses::JointLosses;
use pairs::{ExemptPairs, JointGraph};
use solid::{SolidExtent, described_mass, solid_shape};
use yielding::YieldingPair;

/// One body of the scenario.
struct PhysicsBody {
    name: String,
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
    /// That of the engine.
    surface: SharedShape,
    /// Of a body that has not just one shape.
    extent: Option<SolidExtent>,
}

impl PhysicsBody {
    /// Whether forces move it.
    fn gives_way(&self) -> bool {
        match self.motion {
            BodyMotion::Dynamic | BodyMotion::Guided => true,
            BodyMotion::Fixed | BodyMotion::Kinematic => false,
        }
    }
}

pub(crate) struct PhysicsAdapter {
    world: PhysicsWorld,
    parts: Vec<PhysicsBody>,
    /// By body: what draws those that are guided.
    guides: Vec<Option<BodyGuide>>,
    yielding: Vec<YieldingPair>,
    /// By [`hrdsl_ir::world::JointId`]; none where the joint is rigid.
    joints: Vec<Option<DrivenJoint>>,
    losses: JointLosses,
    exempt: ExemptPairs,
    energy: EnergyWatch,
    /// Where kinematic bodies will be at the end of the next step.
    led: Vec<(RigidBodyHandle, Pose)>,
    /// The time of a step, s.
    step: f64,
    /// The time of the last part of a step, s, and how often the solver divided it.
    part: (f64, usize),
    /// The corners of the box outside of which a body is lost, m.
    scene: (Vector, Vector),
}

/// How often the solver divides a step. With the rotors of the library's arms enough for the tool to be within 1 mm; the cost
/// is in proportion.
const SUBSTEPS: usize = 4;
/// How often it goes over all joints and contacts in each part: once, and the links of an arm hang apart by millimetres.
const SWEEPS: usize = 2;

impl PhysicsAdapter {
    pub fn new(world: &World) -> Result<PhysicsAdapter, SimError> {
        let roots = rigid_roots(world)?;
        let mut engine = PhysicsWorld::new();
        engine.gravity = to_vector(v3(world.gravity));
        let parameters = &mut engine.integration_parameters;
        parameters.dt = seconds(world.step) as f32;
        parameters.num_solver_iterations = SUBSTEPS;
        parameters.num_internal_pgs_iterations = SWEEPS;
        // It would keep contacts of bodies that have parted by centimetres.
        parameters.contact_recycling = false;
        let mut physics = PhysicsAdapter {
            world: engine,
            parts: Vec::new(),
            guides: Vec::new(),
            yielding: Vec::new(),
            joints: Vec::new(),
            losses: JointLosses::default(),
            exempt: ExemptPairs::default(),
            energy: EnergyWatch::default(),
            led: Vec::new(),
            step: seconds(world.step),
            part: (seconds(world.step), SUBSTEPS),
            scene: (Vector::ZERO, Vector::ZERO),
        };
        physics.add_bodies(world, &roots)?;
        let graph = JointGraph::new(world, &roots);
        for joint in &world.joints {
            let driven = if joint.is_rigid() { None } else { Some(physics.add_joint(joint, world, &graph)) };
            physics.joints.push(driven);
        }
        physics.losses = JointLosses::of(world);
        let figure_of = figure_of(world);
        physics.exempt_overlaps(world, &graph, &figure_of)?;
        physics.find_yielding(world, &figure_of);
        physics.scene = physics.surroundings();
        Ok(physics)
    }

    fn add_bodies(&mut self, world: &World, roots: &[BodyId]) -> Result<(), SimError> {
        let handles: Vec<Option<RigidBodyHandle>> = (0..world.bodies.len())
            .map(|i| (index(roots[i]) == i).then(|| self.add_rigid(body_id(i), world, roots)))
            .collect();
        for (i, body) in world.bodies.iter().enumerate() {
            let root = roots[i];
            let Some(handle) = handles[index(root)] else {
                return Err(bad(format!("body `{}`", body.name), "body", index(root)));
            };
            let motion = world.bodies[index(root)].motion;
            let start = start_of(body);
            let local = start_of(&world.bodies[index(root)]).inverse().then(&start);
            let (surface, extent) = surface_of(body)?;
            let is_moved = matches!(motion, BodyMotion::Dynamic | BodyMotion::Guided);
            let weighs = is_moved && body.solid.is_none();
            let collider = ColliderBuilder::new(surface.clone())
                .position(to_pose(&local))
                .mass(if weighs { checked_mass(body)? } else { 0.0 })
                .friction(0.8)
                .sensor(body.ghost)
                .user_data(i as u128);
            let bodies = &mut self.world.bodies;
            // A mere frame meets nothing, and costs nothing.
            let collider = if extent.as_ref().is_some_and(|extent| extent.is_frame) {
                ColliderHandle::invalid()
            } else {
                self.world.colliders.insert_with_parent(collider, handle, bodies)
            };
            let (ghost, shape) = (body.ghost, body.shape);
            let name = body.name.clone();
            let guided = motion == BodyMotion::Guided && index(root) == i;
            self.guides.push(guided.then(|| BodyGuide::new(body.mass, body.stiffness, start)));
            self.parts.push(PhysicsBody {
                name,
                handle,
                collider,
                local,
                start,
                root,
                motion,
                ghost,
                shape,
                surface,
                extent,
            });
        }
        Ok(())
    }

    /// With the rotors of the motors that turn it.
    fn add_rigid(&mut self, id: BodyId, world: &World, roots: &[BodyId]) -> RigidBodyHandle {
        let body = &world.bodies[index(id)];
        let builder = match body.motion {
            BodyMotion::Fixed => RigidBodyBuilder::fixed(),
            BodyMotion::Dynamic => RigidBodyBuilder::dynamic(),
            BodyMotion::Kinematic => RigidBodyBuilder::kinematic_position_based(),
            // Its own muscles bear its weight.
            BodyMotion::Guided => RigidBodyBuilder::dynamic().gravity_scale(0.0),
        };
        let start = start_of(body);
        let mut builder = builder.pose(to_pose(&start));
        let moved = world.joints.iter().filter(|j| !j.is_rigid() && roots[index(j.child)] == id);
        let driven = |id| world.arms.iter().any(|arm| arm.joints.contains(&id));
        if (0..)
            .zip(&world.joints)
            .any(|(i, j)| !j.is_rigid() && roots[index(j.child)] == id && driven(hrdsl_ir::world::JointId(i)))
        {
            // A motor that holds it goes on working.
            builder = builder.can_sleep(false);
        }
        let rotors = moved.filter(|j| j.motion == JointMotion::Hinge && j.drive.rotor > 0.0);
        let sum: f64 = rotors.clone().map(|j| j.drive.rotor).sum();
        let inertia = rotors.map(joints::rotor_inertia).reduce(|a, b| a + b);
        if let Some(mass) = described_mass(world, roots, id, sum) {
            builder = builder.additional_mass_properties(mass);
        } else if let Some(inertia) = inertia {
            builder = builder.additional_mass_properties(MassProperties::with_inertia_matrix(
                Vector::ZERO,
                0.0,
                inertia,
            ));
        }
        self.world.insert_body(builder)
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

    /// `robot.palm`
    pub fn name(&self, body: BodyId) -> &str {
        &self.parts[index(body)].name
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

    /// How fast a body moves in the frame of another, at its centre, m/s.
    pub fn slip(&self, frame: BodyId, body: BodyId) -> f64 {
        let centre = to_vector(self.pose(body).at);
        let at = |b: BodyId| self.world.bodies[self.parts[index(b)].handle].velocity_at_point(centre);
        from_vector(at(body) - at(frame)).norm()
    }

    /// A kinematic body will be there at the end of the next step; a guided one is to be there.
    pub fn lead(&mut self, body: BodyId, to: &BodyFrame) {
        if self.motion(body) == BodyMotion::Guided {
            return self.guide(body, to);
        }
        self.led.push((self.parts[index(body)].handle, to_pose(to)));
    }

    /// Leads kinematic bodies for a part of a step, of which so much will be over then.
    fn lead_on(&mut self, done: f64) {
        for (handle, to) in &self.led {
            let body = &mut self.world.bodies[*handle];
            let left = (1.0 - done) * self.step;
            // Of the way that is left, as much as this part has of the time.
            let next = if done < 1.0 {
                let (now, part) = (body.position(), (self.part.0 / (left + self.part.0)) as f32);
                Pose::from_parts(
                    now.translation.lerp(to.translation, part),
                    // Without angles, whose functions differ between platforms.
                    now.rotation.lerp(to.rotation, part),
                )
            } else {
                *to
            };
            body.set_next_kinematic_position(next);
        }
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
        let mass = f64::from(self.world.bodies[child].mass());
        self.load(palm, mass);
        self.world.insert_impulse_joint(parent, child, data)
    }

    /// A palm presses what it holds no more; when it does not hold it any longer, it can.
    pub fn hold(&mut self, palm: BodyId, body: BodyId, holds: bool) {
        self.suspend(palm, body, holds);
    }

    /// The force (N) and the torque (N·m) that a joint between bodies bears, as the solver last found them.
    pub fn borne(&self, joint: ImpulseJointHandle) -> (f64, f64) {
        let Some(found) = self.world.impulse_joints.get(joint) else { return (0.0, 0.0) };
        let part = self.part.0 / self.part.1 as f64;
        let norm = |axes: [usize; 3]| {
            axes.iter().map(|i| f64::from(found.impulses[*i]).powi(2)).sum::<f64>().sqrt() / part
        };
        (norm([0, 1, 2]), norm([3, 4, 5]))
    }

    pub fn detach(&mut self, palm: BodyId, joint: ImpulseJointHandle) {
        self.load(palm, 0.0);
        self.world.remove_impulse_joint(joint);
    }

    // ── Time ──

    pub fn step(&mut self) {
        self.keep_gears();
        self.step_parts();
        self.watch_energy();
        self.wind_joints();
        self.stop_lost();
    }

    /// The box around everything that there is at the start, and as far around as things may get in a test.
    fn surroundings(&self) -> (Vector, Vector) {
        let boxes = self.world.colliders.iter().map(|(_, collider)| collider.compute_aabb());
        let around = boxes.reduce(|a, b| a.merged(&b));
        let margin = Vector::splat(SURROUNDINGS);
        around.map_or((-margin, margin), |b| (b.mins - margin, b.maxs + margin))
    }

    /// What has left the scene (say, fallen where there is no floor) stays where it is: it would fall for ever, and the
    /// world never rest.
    fn stop_lost(&mut self) {
        let (low, high) = self.scene;
        for (_, body) in self.world.bodies.iter_mut() {
            let at = body.translation();
            if body.is_dynamic() && (at.min(low) != low || at.max(high) != high) {
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

/// How far from everything else a body is lost, m.
const SURROUNDINGS: f32 = 20.0;
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

/// For each body the figure that it is of.
fn figure_of(world: &World) -> Vec<Option<usize>> {
    let mut figures = vec![None; world.bodies.len()];
    for (i, figure) in world.figures.iter().enumerate() {
        let limbs = figure.limbs.iter().flat_map(|limb| [limb.upper, limb.lower].into_iter().chain(limb.end));
        for body in [figure.pelvis, figure.trunk, figure.head].into_iter().chain(limbs) {
            if let Some(slot) = figures.get_mut(index(body)) {
                *slot = Some(i);
            }
        }
    }
    figures
}

fn start_of(body: &Body) -> BodyFrame {
    BodyFrame::new(v3(body.position), from_rpy(body.rotation))
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
        if joint.is_rigid() && above[child].replace(joint.parent).is_some() {
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

fn checked_mass(body: &Body) -> Result<f32, SimError> {
    if body.mass.is_finite() && body.mass > 0.0 {
        Ok(body.mass as f32)
    } else {
        Err(SimError::BadNumber { what: format!("the mass of body `{}`", body.name) })
    }
}

/// The shape of a body, and what is measured of it if it has several.
fn surface_of(body: &Body) -> Result<(SharedShape, Option<SolidExtent>), SimError> {
    if !body.position.iter().chain(&body.rotation).all(|x| x.is_finite()) {
        return Err(SimError::BadNumber { what: format!("a measure of body `{}`", body.name) });
    }
    match &body.solid {
        Some(solid) => solid_shape(solid, &body.name).map(|(shape, extent)| (shape, Some(extent))),
        None => Ok((shape_of(body.shape, &body.name)?, None)),
    }
}

fn shape_of(shape: BodyShape, name: &str) -> Result<SharedShape, SimError> {
    let measures: Vec<f64> = match shape {
        BodyShape::Box { size } => size.to_vec(),
        BodyShape::Sphere { radius } => vec![radius],
        BodyShape::Capsule { radius, length } | BodyShape::Cylinder { radius, length } => {
            vec![radius, length]
        }
    };
    if measures.iter().any(|m| !m.is_finite() || *m <= 0.0) {
        return Err(SimError::BadNumber { what: format!("a measure of body `{name}`") });
    }
    let half = |x: f64| (x / 2.0) as f32;
    Ok(match shape {
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
