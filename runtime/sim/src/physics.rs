//! The physics engine behind the names of the scenario: bodies by [`BodyId`], in double precision, checked once.
//!
//! A joint whose limits are both zero joins its child rigidly: the two are one body of the engine, with two shapes.

mod contact;
mod division;
pub(crate) mod dynamics;
mod energy;
mod guide;
mod joints;
mod losses;
mod pairs;
mod retry;
mod seen;
mod state;
mod stops;
mod surface;
pub(crate) mod wheels;
mod yielding;

pub(crate) use joints::ArmSleep;
pub(crate) use state::{
    accuracy::AccuracyWatch,
    adapter::PhysicsAdapter,
    bodies::{bad, body_id, index},
};

use hrdsl_harness::SpentTime;
use hrdsl_ir::Nanos;
use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{Body, BodyId, BodyMotion, Joint, JointId, JointMotion, World};
use rapier3d::prelude::*;

use crate::{
    error::SimulationError,
    math::{BodyFrame, from_pose, from_vector, to_pose, to_vector, v3},
};
use state::{
    adapter::PhysicsBody,
    before::MotionBefore,
    bodies::start_of,
    energy::EnergyWatch,
    guide::BodyGuide,
    loads::ContactLoads,
    losses::JointLosses,
    pairs::{ExemptPairs, JointGraph},
    place::JointedBodies,
    roots::{figure_of, rigid_roots},
    solid::{described_mass, surface_of},
    yielding::YieldingPairs,
};
use stops::UNNOTICED;

/// How often the motors of arms and wheels are told what to do, ns; in a world with longer steps, once in each. Between that their
/// efforts stay, as those of a real controller do: how hard a robot strikes must not depend on the step.
pub(crate) const CONTROL_PERIOD: Nanos = 10_000_000;

/// How often the solver divides a step in which anything is awake that is not drawn. With the rotors of the library's arms enough for the tool to be within 1 mm; the cost
/// is in proportion.
const SUBSTEPS: usize = 4;
/// How often it goes over all joints and contacts in each part: once, and the links of an arm hang apart by millimetres.
const SWEEPS: usize = 2;
/// The same of a world with a robot from a description. Nobody says how heavy its rotors are, and its links may be light: what a motor
/// does must come to the end of a chain of seven joints within the step, or the arm shakes with all the strength that it has. A few
/// robots still do with four.
const SWEEPS_OF_DESCRIBED: usize = 8;

/// How deep rigid bodies may be in each other before the solver puts them apart, m: the engine's own five millimetres would be seen.
const ALLOWED_DEPTH: f32 = 5e-4;
/// How fast it then does so: as so much of the depth in a second, 1/s. Faster, and bodies that are found inside of each other leap apart.
const PARTS_AT: f32 = 20.0;
/// So much damped that contacts are soft in nothing but that. The engine's own are springs in proportion to the masses: fingers of 50 g
/// that press with 40 N would be millimetres inside of what they hold.
const CONTACT_DAMPING: f32 = 100.0;

/// How contacts bear what presses on them.
fn contact_softness() -> SpringCoefficients<f32> {
    SpringCoefficients {
        natural_frequency: 2.0 * CONTACT_DAMPING * PARTS_AT / std::f32::consts::TAU,
        damping_ratio: CONTACT_DAMPING,
    }
}

impl PhysicsAdapter {
    pub fn new(world: &World) -> Result<PhysicsAdapter, SimulationError> {
        let roots = rigid_roots(world)?;
        let mut engine = PhysicsWorld::new();
        engine.gravity = to_vector(v3(world.gravity));
        let parameters = &mut engine.integration_parameters;
        parameters.dt = seconds(world.step) as f32;
        parameters.num_solver_iterations = SUBSTEPS;
        parameters.num_internal_pgs_iterations = sweeps(world);
        // It would keep contacts of bodies that have parted by centimetres.
        parameters.contact_recycling = false;
        parameters.normalized_allowed_linear_error = ALLOWED_DEPTH;
        parameters.contact_softness = contact_softness();
        parameters.static_contact_softness = contact_softness();
        let mut physics = PhysicsAdapter {
            world: engine,
            parts: Vec::new(),
            boxes: Vec::new(),
            guides: Vec::new(),
            yielding: YieldingPairs::default(),
            fallen: Vec::new(),
            joints: Vec::new(),
            jointed: JointedBodies::default(),
            losses: JointLosses::default(),
            loads: ContactLoads::default(),
            exempt: ExemptPairs::of(world.bodies.len()),
            energy: EnergyWatch::default(),
            accuracy: AccuracyWatch::default(),
            robots: Vec::new(),
            led: Vec::new(),
            before: MotionBefore::default(),
            step: seconds(world.step),
            sweeps: sweeps(world),
            pressed: 0,
            mended: (0.0, 0),
            deepest: 0.0,
            part: (seconds(world.step), SUBSTEPS),
            solved: vec![(seconds(world.step), SUBSTEPS); world.bodies.len()],
            scene: (Vector::ZERO, Vector::ZERO),
            clock: None,
            engine_time: SpentTime::default(),
        };
        physics.add_bodies(world, &roots)?;
        let graph = JointGraph::new(world, &roots);
        for joint in &world.joints {
            let driven = if joint.is_rigid() { None } else { Some(physics.add_joint(joint, world, &graph)) };
            physics.joints.push(driven);
        }
        physics.robots = graph.bodies_by_robot(&roots);
        physics.losses = JointLosses::of(world);
        let figure_of = figure_of(world);
        physics.exempt_overlaps(world, &graph, &figure_of)?;
        physics.find_yielding(world, &figure_of);
        physics.scene = physics.surroundings();
        physics.look_at_boxes();
        Ok(physics)
    }

    fn add_bodies(&mut self, world: &World, roots: &[BodyId]) -> Result<(), SimulationError> {
        let figure_of = figure_of(world);
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
            let has_muscles = figure_of[i].is_some();
            self.guides.push(guided.then(|| BodyGuide::new(body, start, has_muscles)));
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
                radius: surface.compute_local_bounding_sphere().radius(),
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
        let is_finger = |id| world.grippers.iter().any(|gripper| gripper.fingers.contains(&id));
        let driven = |id| world.arms.iter().any(|arm| arm.joints.contains(&id));
        // The engine would stop a door that swings slowly.
        let is_passive =
            |id, joint: &Joint| !is_finger(id) && world.bodies[index(joint.child)].solid.is_none();
        if (0..).zip(&world.joints).any(|(i, j)| {
            let number = JointId(i);
            !j.is_rigid() && roots[index(j.child)] == id && (driven(number) || is_passive(number, j))
        }) {
            // Its arm says when it may: a motor that holds it goes on working.
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
    pub(super) fn lead_on(&mut self, done: f64) {
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

    /// Fixes a body to a palm where it is now; what is not carried is borne by a joint of its own.
    pub fn attach(&mut self, palm: BodyId, body: BodyId, is_carried: bool) -> ImpulseJointHandle {
        let (p, b) = (&self.parts[index(palm)], &self.parts[index(body)]);
        let between = from_pose(self.world.bodies[p.handle].position())
            .inverse()
            .then(&from_pose(self.world.bodies[b.handle].position()));
        let data = GenericJointBuilder::new(JointAxesMask::LOCKED_FIXED_AXES)
            .local_frame1(to_pose(&between))
            .contacts_enabled(false)
            .build();
        let (parent, child) = (p.handle, b.handle);
        self.wake_robot(palm);
        let mass = if is_carried { f64::from(self.world.bodies[child].mass()) } else { 0.0 };
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
        let held = self.parts.iter().position(|part| part.handle == found.body2());
        let (time, substeps) = held.map_or(self.part, |at| self.solved[at]);
        let part = time / substeps as f64;
        let norm = |axes: [usize; 3]| {
            axes.iter().map(|i| f64::from(found.impulses[*i]).powi(2)).sum::<f64>().sqrt() / part
        };
        (norm([0, 1, 2]), norm([3, 4, 5]))
    }

    pub fn detach(&mut self, palm: BodyId, joint: ImpulseJointHandle) {
        self.load(palm, 0.0);
        self.wake_robot(palm);
        self.world.remove_impulse_joint(joint);
    }

    /// Whether joints hold two bodies together, by others or not.
    pub fn are_joined(&self, a: BodyId, b: BodyId) -> bool {
        self.robots[index(a)] == self.robots[index(b)]
    }

    /// Wakes all that is joined to a body.
    fn wake_robot(&mut self, of: BodyId) {
        let robot = self.robots[index(of)];
        for (part, own) in self.parts.iter().zip(&self.robots) {
            if let Some(body) =
                self.world.bodies.get_mut(part.handle).filter(|b| *own == robot && b.is_sleeping())
            {
                body.wake_up(true);
            }
        }
    }

    // ── Time ──

    pub fn step(&mut self) {
        self.keep_gears();
        self.step_parts();
        self.note_solved();
        self.watch_energy();
        self.wind_joints();
        self.watch_accuracy();
        self.stop_lost();
    }

    /// How often the solver has to divide the next step: not at all while only people move, who have neither joints nor anything
    /// that lies on them.
    pub(super) fn substeps(&self) -> usize {
        let loose = |(part, guide): (&PhysicsBody, &Option<BodyGuide>)| {
            let body = &self.world.bodies[part.handle];
            guide.is_none() && body.is_dynamic() && !body.is_sleeping()
        };
        if self.parts.iter().zip(&self.guides).any(loose) { SUBSTEPS } else { 1 }
    }

    /// Notes for whom the solver was at work in the last part of the step.
    fn note_solved(&mut self) {
        for (solved, part) in self.solved.iter_mut().zip(&self.parts).filter(|(_, part)| part.gives_way()) {
            if !self.world.bodies[part.handle].is_sleeping() {
                *solved = self.part;
            }
        }
    }

    fn watch_accuracy(&mut self) {
        self.pressed = self.pressed.saturating_sub(1);
        for joint in 0..self.joints.len() {
            if self.joints[joint].is_some() && !self.is_asleep(joint) {
                let (at, limits) = (self.joint_position(joint), self.joint_limits(joint));
                let beyond =
                    self.joints[joint].as_ref().map_or(0.0, |driven| driven.beyond(at - driven.start));
                if beyond > UNNOTICED {
                    self.notice_press();
                }
                if let Some(driven) = &mut self.joints[joint] {
                    driven.ends.beyond = beyond;
                }
                self.accuracy.look_at_joint(joint, at, limits);
            }
        }
    }

    /// How far the engine strayed at worst from what cannot be.
    pub fn accuracy(&self) -> &AccuracyWatch {
        &self.accuracy
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
        let is_lost = |body: &RigidBody| {
            let at = body.translation();
            body.is_dynamic() && (at.min(low) != low || at.max(high) != high)
        };
        // What is taken to be changed the engine looks at again.
        if !self.world.bodies.iter().any(|(_, body)| is_lost(body)) {
            return;
        }
        for (_, body) in self.world.bodies.iter_mut() {
            if is_lost(body) {
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

fn sweeps(world: &World) -> usize {
    let is_link = |body: &Body| body.motion == BodyMotion::Dynamic && body.solid.is_some();
    if world.bodies.iter().any(is_link) { SWEEPS_OF_DESCRIBED } else { SWEEPS }
}

fn checked_mass(body: &Body) -> Result<f32, SimulationError> {
    if body.mass.is_finite() && body.mass > 0.0 {
        Ok(body.mass as f32)
    } else {
        Err(SimulationError::BadNumber { what: format!("the mass of body `{}`", body.name) })
    }
}
