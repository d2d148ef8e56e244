//! Bases: velocities that are set from outside, ramps to them, and the way that a base goes by them.

use std::collections::BTreeSet;

use hrdsl_ir::Nanos;
use hrdsl_ir::value::seconds;
use hrdsl_ir::world::{Base, BodyId, BodyMotion, World};

use hrdsl_harness::CommandId;

use crate::{
    error::{CommandError, SimulationError},
    math::{BodyFrame, SpaceVector, about, wrap},
    physics::{
        CONTROL_PERIOD, PhysicsAdapter, bad, index,
        wheels::{RollingBase, TyrePush},
    },
};

/// How deep a base may come to be in what is fixed, m: more than the engine's single precision makes of bodies that touch, such as
/// a base and the ground.
const TOUCHING: f64 = 1e-3;

/// How much faster than it goes a dynamic base may want to go, m/s and rad/s.
const SLIPS: f64 = 0.1;
const TURN_SLIPS: f64 = 0.3;
/// Below this a dynamic base stands, m/s and rad/s.
const STANDS: f64 = 0.01;
const TURN_STANDS: f64 = 0.02;
/// Tipped farther than this, a base lies on its side, rad: 50°.
const FALLEN: f64 = 0.87;

/// A velocity in the frame of the base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PlanarVelocity {
    /// m/s
    pub forward: f64,
    /// To the left, m/s.
    pub sideways: f64,
    /// To the left, rad/s.
    pub turn: f64,
}

/// Where a base is on its plane: m, m, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlanarPose {
    pub x: f64,
    pub y: f64,
    pub yaw: f64,
}

/// A velocity that was asked for, and when.
#[derive(Clone, Copy, Debug)]
struct VelocitySetPoint {
    at: Nanos,
    velocity: PlanarVelocity,
}

pub(crate) struct BaseControl {
    pub name: String,
    pub body: BodyId,
    limit: PlanarVelocity,
    /// m/s² and rad/s²
    acceleration: f64,
    angular_acceleration: f64,
    timeout: Option<Nanos>,
    /// The body's frame when its yaw is zero, without its place.
    upright: BodyFrame,
    height: f64,
    /// At the last step.
    pose: PlanarPose,
    velocity: PlanarVelocity,
    /// As a dynamic base was measured to move.
    moves: PlanarVelocity,
    /// The one that was in force when the last step began, and those that came after it.
    asked: Vec<VelocitySetPoint>,
    /// Which pairs of its own solid bodies and fixed ones may touch, and how deep, m.
    obstacles: Vec<(BodyId, BodyId, f64)>,
    stopping: Option<CommandId>,
    /// Of a base that can be pushed and toppled.
    wheels: Option<RollingBase>,
    /// How its tyres were last told to push, and until when that holds.
    push: TyrePush,
    pushed_until: Nanos,
    /// Its wheels are braked: it stands.
    is_braked: bool,
    /// It has tipped over, for good.
    has_fallen: bool,
}

impl PlanarVelocity {
    fn is_finite(self) -> bool {
        self.forward.is_finite() && self.sideways.is_finite() && self.turn.is_finite()
    }

    fn within(self, limit: PlanarVelocity) -> PlanarVelocity {
        PlanarVelocity {
            forward: self.forward.clamp(-limit.forward, limit.forward),
            sideways: self.sideways.clamp(-limit.sideways, limit.sideways),
            turn: self.turn.clamp(-limit.turn, limit.turn),
        }
    }

    /// As near to the aim as it comes by changes of so much at most: of speed along the plane, and of the turn.
    fn towards(self, aim: PlanarVelocity, along: f64, about: f64) -> PlanarVelocity {
        let (forward, sideways) = (aim.forward - self.forward, aim.sideways - self.sideways);
        let change = (forward * forward + sideways * sideways).sqrt();
        let turn = aim.turn - self.turn;
        let (mut next, part) = (aim, along / change);
        if change > along {
            next.forward = self.forward + forward * part;
            next.sideways = self.sideways + sideways * part;
        }
        if turn.abs() > about {
            next.turn = self.turn + about.copysign(turn);
        }
        next
    }

    /// Itself, but no farther from another than wheels that slip may be.
    fn near(self, other: PlanarVelocity) -> PlanarVelocity {
        let keep = |own: f64, other: f64, most: f64| own.clamp(other - most, other + most);
        PlanarVelocity {
            forward: keep(self.forward, other.forward, SLIPS),
            sideways: keep(self.sideways, other.sideways, SLIPS),
            turn: keep(self.turn, other.turn, TURN_SLIPS),
        }
    }

    fn is_small(self) -> bool {
        self.forward.abs() < STANDS && self.sideways.abs() < STANDS && self.turn.abs() < TURN_STANDS
    }

    fn middle(self, other: PlanarVelocity) -> PlanarVelocity {
        PlanarVelocity {
            forward: (self.forward + other.forward) / 2.0,
            sideways: (self.sideways + other.sideways) / 2.0,
            turn: (self.turn + other.turn) / 2.0,
        }
    }
}

impl PlanarPose {
    /// After `t` seconds at a velocity. The way is an arc; its chord has the heading of the middle.
    fn after(self, velocity: PlanarVelocity, t: f64) -> PlanarPose {
        let half = velocity.turn * t / 2.0;
        let chord = if half.abs() < 1e-6 { t } else { t * libm::sin(half) / half };
        let (sin, cos) = (libm::sin(self.yaw + half), libm::cos(self.yaw + half));
        PlanarPose {
            x: self.x + chord * (velocity.forward * cos - velocity.sideways * sin),
            y: self.y + chord * (velocity.forward * sin + velocity.sideways * cos),
            yaw: wrap(self.yaw + 2.0 * half),
        }
    }
}

impl BaseControl {
    pub fn new(
        base: &Base,
        world: &World,
        physics: &mut PhysicsAdapter,
    ) -> Result<BaseControl, SimulationError> {
        let what = || format!("base `{}`", base.name);
        let Some(body) = world.bodies.get(index(base.body)) else {
            return Err(bad(what(), "body", index(base.body)));
        };
        let rolls = match body.motion {
            BodyMotion::Kinematic => false,
            BodyMotion::Dynamic => true,
            BodyMotion::Fixed | BodyMotion::Guided => {
                return Err(SimulationError::NotDriven { body: body.name.clone() });
            }
        };
        let positive = [base.max_speed, base.max_turn, base.acceleration];
        if positive.iter().any(|x| !(x.is_finite() && *x > 0.0))
            || !(base.max_sideways.is_finite() && base.max_sideways >= 0.0)
        {
            return Err(SimulationError::BadNumber { what: format!("a limit of {}", what()) });
        }
        let (start, yaw) = (physics.start(base.body), body.rotation[2]);
        let limit =
            PlanarVelocity { forward: base.max_speed, sideways: base.max_sideways, turn: base.max_turn };
        let mut control = BaseControl {
            name: base.name.clone(),
            body: base.body,
            limit,
            acceleration: base.acceleration,
            angular_acceleration: base.acceleration * base.max_turn / base.max_speed,
            timeout: base.timeout,
            upright: BodyFrame::new(SpaceVector::zeros(), about(SpaceVector::z(), -yaw) * start.turn),
            height: start.at.z,
            pose: PlanarPose { x: start.at.x, y: start.at.y, yaw: wrap(yaw) },
            velocity: PlanarVelocity::default(),
            moves: PlanarVelocity::default(),
            asked: Vec::new(),
            obstacles: Vec::new(),
            stopping: None,
            wheels: rolls.then(|| physics.on_wheels(base.body, world)),
            push: TyrePush::default(),
            pushed_until: 0,
            is_braked: false,
            has_fallen: false,
        };
        if !rolls {
            control.obstacles = control.find_obstacles(physics);
        }
        Ok(control)
    }

    fn find_obstacles(&self, physics: &PhysicsAdapter) -> Vec<(BodyId, BodyId, f64)> {
        let own = physics.solids().filter(|b| physics.root(*b) == self.body);
        let fixed: Vec<BodyId> = physics.solids().filter(|b| physics.is_fixed(*b)).collect();
        let pairs = own.flat_map(|own| fixed.iter().map(move |other| (own, *other)));
        pairs
            .map(|(own, other)| (own, other, TOUCHING + physics.depth(own, &physics.pose(own), other)))
            .collect()
    }

    // ── What is asked of it ──

    /// From now on it drives so, as well as it can. The command that it was to stop is given up, and returned.
    pub fn drive(&mut self, now: Nanos, velocity: PlanarVelocity) -> Result<Option<CommandId>, CommandError> {
        if !velocity.is_finite() {
            return Err(CommandError::NotFinite);
        }
        self.ask(now, velocity.within(self.limit));
        Ok(self.stopping.take())
    }

    /// Brakes; an earlier command to do so is returned.
    pub fn stop(&mut self, now: Nanos, id: CommandId) -> Option<CommandId> {
        self.ask(now, PlanarVelocity::default());
        self.stopping.replace(id)
    }

    fn ask(&mut self, now: Nanos, velocity: PlanarVelocity) {
        // Of those of one instant the last counts.
        self.asked.retain(|a| a.at < now);
        self.asked.push(VelocitySetPoint { at: now, velocity });
    }

    /// What is in force at a time.
    fn wanted(&self, at: Nanos) -> PlanarVelocity {
        let last = self.asked.iter().rev().find(|a| a.at <= at);
        let lasts = |a: &&VelocitySetPoint| self.timeout.is_none_or(|t| at < a.at.saturating_add(t));
        last.filter(lasts).map_or_else(PlanarVelocity::default, |a| a.velocity)
    }

    /// When that changes between two times.
    fn changes(&self, from: Nanos, to: Nanos) -> BTreeSet<Nanos> {
        let ends = |a: &VelocitySetPoint| self.timeout.map(|t| a.at.saturating_add(t));
        let times = self.asked.iter().flat_map(|a| [Some(a.at), ends(a)]).flatten();
        times.filter(|t| *t > from && *t < to).collect()
    }

    // ── Steps ──

    /// Goes on for the step between two times, as far as nothing fixed is in the way.
    pub fn go_on(&mut self, from: Nanos, to: Nanos, physics: &mut PhysicsAdapter) {
        let in_force = self.asked.iter().rposition(|a| a.at <= from).unwrap_or(0);
        self.asked.drain(..in_force);
        if self.wheels.is_some() {
            return self.roll_on(from, to, physics);
        }
        if !self.is_busy(from) && self.wanted(to) == PlanarVelocity::default() {
            return;
        }
        let (mut pose, mut velocity, mut at) = (self.pose, self.velocity, from);
        for until in self.changes(from, to).into_iter().chain([to]) {
            let t = seconds(until - at);
            let aim = self.wanted(at);
            let next = velocity.towards(aim, self.acceleration * t, self.angular_acceleration * t);
            pose = pose.after(velocity.middle(next), t);
            (velocity, at) = (next, until);
        }
        (self.pose, self.velocity) = self.unblocked(pose, velocity, physics);
        physics.lead(self.body, &self.frame(self.pose));
    }

    /// Lets the wheels of a dynamic base bring it to the velocity that it is to have when they are told next.
    fn roll_on(&mut self, from: Nanos, to: Nanos, physics: &mut PhysicsAdapter) {
        let Some(wheels) = self.wheels.clone() else { return };
        if !self.has_fallen && physics.tilt(self.body) > FALLEN {
            self.has_fallen = true;
            physics.off_wheels(&wheels);
        }
        if self.has_fallen {
            self.velocity = PlanarVelocity::default();
            return;
        }
        if from >= self.pushed_until {
            self.pushed_until = to.max(from + CONTROL_PERIOD);
            self.push = self.tell_wheels(from, self.pushed_until, &wheels, physics);
        }
        physics.push_by_tyres(&wheels, self.push);
    }

    /// How the tyres are to push between two times.
    fn tell_wheels(
        &mut self,
        from: Nanos,
        to: Nanos,
        wheels: &RollingBase,
        physics: &mut PhysicsAdapter,
    ) -> TyrePush {
        // From where it really is: wheels that slipped take up their speed again.
        let measured = self.measured(wheels, physics);
        let (mut velocity, mut at) = (self.velocity.near(measured), from);
        for until in self.changes(from, to).into_iter().chain([to]) {
            let t = seconds(until - at);
            let aim = self.wanted(at);
            velocity = velocity.towards(aim, self.acceleration * t, self.angular_acceleration * t);
            at = until;
        }
        self.velocity = velocity;
        // Who stands is held by friction, within the engine's own step: arms may then move as on a fixed base.
        let stands = velocity == PlanarVelocity::default();
        if stands != self.is_braked {
            self.is_braked = stands;
            if stands { physics.off_wheels(wheels) } else { physics.on_wheels_again(wheels) }
        }
        if stands {
            return TyrePush::default();
        }
        let h = seconds(to - from);
        let yaw = self.heading(physics) + velocity.turn * h / 2.0;
        let ahead = SpaceVector::new(libm::cos(yaw), libm::sin(yaw), 0.0);
        let left = SpaceVector::new(-ahead.y, ahead.x, 0.0);
        physics.roll(wheels, ahead * velocity.forward + left * velocity.sideways, velocity.turn, h)
    }

    fn measured(&self, wheels: &RollingBase, physics: &PhysicsAdapter) -> PlanarVelocity {
        let (velocity, turn) = physics.rolling_velocity(wheels);
        let yaw = self.heading(physics);
        let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
        let (forward, sideways) = (velocity.x * cos + velocity.y * sin, velocity.y * cos - velocity.x * sin);
        PlanarVelocity { forward, sideways, turn }
    }

    fn heading(&self, physics: &PhysicsAdapter) -> f64 {
        let x = (physics.pose(self.body).turn * self.upright.turn.inverse()) * SpaceVector::x();
        libm::atan2(x.y, x.x)
    }

    /// After a step: takes down where a dynamic base has come to.
    pub fn look(&mut self, physics: &PhysicsAdapter) {
        let Some(wheels) = &self.wheels else { return };
        let at = physics.pose(self.body).at;
        self.moves = self.measured(wheels, physics);
        self.pose = PlanarPose { x: at.x, y: at.y, yaw: self.heading(physics) };
    }

    /// The way as far as it is free: if not all of it, the turn alone, or the way alone, or none. What is blocked of the velocity is
    /// lost.
    fn unblocked(
        &self,
        pose: PlanarPose,
        velocity: PlanarVelocity,
        physics: &PhysicsAdapter,
    ) -> (PlanarPose, PlanarVelocity) {
        let turned = PlanarPose { yaw: pose.yaw, ..self.pose };
        let moved = PlanarPose { yaw: self.pose.yaw, ..pose };
        let turning = PlanarVelocity { turn: velocity.turn, ..PlanarVelocity::default() };
        let moving = PlanarVelocity { turn: 0.0, ..velocity };
        let ways = [(pose, velocity), (turned, turning), (moved, moving)];
        let free = ways.into_iter().find(|(to, _)| self.is_free(*to, physics));
        free.unwrap_or((self.pose, PlanarVelocity::default()))
    }

    /// Whether nothing of it would be deeper in anything fixed than it was at the start, or is now.
    fn is_free(&self, pose: PlanarPose, physics: &PhysicsAdapter) -> bool {
        let now = physics.pose(self.body);
        let motion = self.frame(pose).then(&now.inverse());
        self.obstacles.iter().all(|(own, other, allowed)| {
            let here = physics.pose(*own);
            let depth = physics.depth(*own, &motion.then(&here), *other);
            depth <= *allowed || depth <= physics.depth(*own, &here, *other)
        })
    }

    fn frame(&self, pose: PlanarPose) -> BodyFrame {
        let at = SpaceVector::new(pose.x, pose.y, self.height);
        BodyFrame::new(at, about(SpaceVector::z(), pose.yaw) * self.upright.turn)
    }

    /// Something else has moved the body, to there; it goes on from there, and begins at rest.
    pub fn carried(&mut self, to: &BodyFrame) {
        // The x axis of what is turned about the vertical shows by how much.
        let x = (to.turn * self.upright.turn.inverse()) * SpaceVector::x();
        self.pose = PlanarPose { x: to.at.x, y: to.at.y, yaw: libm::atan2(x.y, x.x) };
        self.height = to.at.z;
        self.velocity = PlanarVelocity::default();
    }

    /// A command to stop has ended when it stands.
    pub fn check_stopped(&mut self) -> Option<(CommandId, Result<(), CommandError>)> {
        let stands = self.velocity == PlanarVelocity::default() && self.velocity().is_small();
        let id = if stands { self.stopping.take() } else { None };
        id.map(|id| (id, Ok(())))
    }

    /// Whether it lies: what it is told to do moves nothing.
    pub fn has_fallen(&self) -> bool {
        self.has_fallen
    }

    pub fn is_busy(&self, now: Nanos) -> bool {
        if self.has_fallen {
            return self.stopping.is_some();
        }
        let none = PlanarVelocity::default();
        self.stopping.is_some() || self.velocity != none || self.wanted(now) != none
    }

    // ── What it tells ──

    pub fn pose(&self) -> PlanarPose {
        self.pose
    }

    /// As it really moves.
    pub fn velocity(&self) -> PlanarVelocity {
        if self.wheels.is_some() { self.moves } else { self.velocity }
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::Expr;
    use hrdsl_ir::world::{Arm, ArmId, JointId, WorldAction, WorldPoint};
    use proptest::prelude::*;

    use super::*;
    use crate::samples::{BASE, SECOND, after, body, built, cuboid, drive, flat, upright_joint};
    use crate::{MotorCommand, WorldSimulation};

    fn velocity(sim: &WorldSimulation) -> [f64; 3] {
        sim.base_velocity(BASE).expect("a base")
    }

    fn wall(x: f64) -> hrdsl_ir::world::Body {
        body("wall", BodyMotion::Fixed, cuboid(0.1, 6.0, 1.0), [x, 0.0, 0.5])
    }

    #[test]
    fn drives_straight_at_its_acceleration() {
        let mut sim = built(&flat(Vec::new()));
        let id = sim.command(drive(0.8, 0.0, 0.0)).expect("a base");
        assert_eq!(sim.finished(), [(id, Ok(()))], "a set-point ends at once");
        // 2 m/s²: 0.4 s to 0.8 m/s.
        let [x, y, yaw] = after(&mut sim, SECOND / 5);
        assert!((x - 0.04).abs() < 1e-6 && y.abs() < 1e-9 && yaw.abs() < 1e-9, "{x}");
        assert!((velocity(&sim)[0] - 0.4).abs() < 1e-9);
        let [x, ..] = after(&mut sim, 4 * SECOND / 5);
        assert!((x - (0.16 + 0.48)).abs() < 1e-6, "{x}");
        let (at, _) = sim.pose(BodyId(1)).expect("a body");
        assert!((at[0] - x).abs() < 1e-5, "the body is where the base says: {at:?}");
    }

    #[test]
    fn turns_in_place() {
        let mut world = flat(Vec::new());
        world.bodies[1].rotation = [0.0, 0.0, 1.0];
        let mut sim = built(&world);
        sim.command(drive(0.0, 0.0, -2.0)).expect("a base");
        // As quick to its limit as the speed is: in half a second.
        let [x, y, yaw] = after(&mut sim, SECOND);
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "{x} {y}");
        assert!((yaw - (1.0 - 1.5)).abs() < 1e-6, "{yaw}");
        let [_, _, yaw] = after(&mut sim, 2 * SECOND);
        assert!((yaw - (1.0 - 5.5 + 2.0 * std::f64::consts::PI)).abs() < 1e-6, "{yaw}");
    }

    #[test]
    fn goes_round_a_circle() {
        let mut sim = built(&flat(Vec::new()));
        sim.command(drive(0.5, 0.0, 1.0)).expect("a base");
        sim.advance(SECOND);
        let [x0, y0, yaw] = sim.base_pose(BASE).expect("a base");
        // Around a point half a metre to the left of it.
        let (cx, cy) = (x0 - 0.5 * libm::sin(yaw), y0 + 0.5 * libm::cos(yaw));
        let [x, y, _] = after(&mut sim, 2 * SECOND);
        assert!(((x - cx).hypot(y - cy) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn limits_are_kept_and_what_cannot_go_sideways_does_not() {
        let mut sim = built(&flat(Vec::new()));
        sim.command(drive(9.0, 9.0, 0.0)).expect("a base");
        let [_, y, _] = after(&mut sim, 2 * SECOND);
        assert_eq!(velocity(&sim), [1.0, 0.0, 0.0]);
        assert!(y.abs() < 1e-9);
        assert_eq!(sim.command(drive(f64::NAN, 0.0, 0.0)), Err(CommandError::NotFinite));
        let mut world = flat(Vec::new());
        world.bases[0].max_sideways = 0.5;
        let mut sim = built(&world);
        sim.command(drive(0.0, 0.3, 0.0)).expect("a base");
        let [x, y, _] = after(&mut sim, 2 * SECOND);
        assert!(x.abs() < 1e-9 && y > 0.5, "{x} {y}");
    }

    #[test]
    fn a_set_point_times_out() {
        let mut world = flat(Vec::new());
        world.bases[0].timeout = Some(SECOND / 2);
        let mut sim = built(&world);
        sim.command(drive(1.0, 0.0, 0.0)).expect("a base");
        // 0.25 m of ramp up to 1 m/s, and as much down.
        let [x, ..] = after(&mut sim, 3 * SECOND);
        assert!((x - 0.5).abs() < 1e-6, "{x}");
        assert_eq!(velocity(&sim), [0.0; 3]);
        assert_eq!(sim.next_wake(), None, "the world is at rest");
    }

    #[test]
    fn it_does_not_matter_where_between_two_steps_a_set_point_comes() {
        let mut sim = built(&flat(Vec::new()));
        sim.advance(3_000_000);
        sim.command(drive(1.0, 0.0, 0.0)).expect("a base");
        sim.advance(10_000_000);
        // 7 ms at 2 m/s².
        assert!((velocity(&sim)[0] - 0.014).abs() < 1e-9, "{:?}", velocity(&sim));
    }

    #[test]
    fn stopping_ends_when_it_stands() {
        let mut sim = built(&flat(Vec::new()));
        sim.command(drive(1.0, 0.0, 0.0)).expect("a base");
        sim.advance(SECOND);
        sim.finished();
        let first = sim.command(MotorCommand::StopWheels { base: BASE }).expect("a base");
        let id = sim.command(MotorCommand::StopWheels { base: BASE }).expect("a base");
        assert_eq!(sim.finished(), [(first, Err(CommandError::Replaced))]);
        sim.advance(SECOND + SECOND / 4);
        assert_eq!(sim.finished(), []);
        sim.advance(2 * SECOND);
        assert_eq!(sim.finished(), [(id, Ok(()))]);
    }

    #[test]
    fn a_wall_stops_it_and_it_turns_away() {
        let mut sim = built(&flat(vec![wall(1.0)]));
        sim.command(drive(1.0, 0.0, 0.0)).expect("a base");
        let [x, y, _] = after(&mut sim, 4 * SECOND);
        // The wall begins at 0.95 m, the base is 0.2 m in radius.
        assert!((0.745..0.7515).contains(&x) && y.abs() < 1e-9, "{x} {y}");
        assert!(velocity(&sim)[0] < 0.05, "its wheels slip: {:?}", velocity(&sim));
        sim.command(drive(0.0, 0.0, 2.0)).expect("a base");
        let [_, _, yaw] = after(&mut sim, SECOND);
        assert!(yaw > 1.4, "{yaw}");
        sim.command(drive(0.5, 0.0, 0.0)).expect("a base");
        let [x, y, _] = after(&mut sim, SECOND);
        assert!(x < 0.7 && y > 0.2, "{x} {y}");
    }

    #[test]
    fn what_it_carries_goes_along_and_hits_walls_with_it() {
        let mast = body("mast", BodyMotion::Dynamic, cuboid(0.1, 0.1, 0.4), [0.3, 0.0, 0.5]);
        let mut world = flat(vec![wall(1.0), mast]);
        let (parent, child) = (BodyId(1), BodyId(3));
        world.joints.push(upright_joint(parent, child, [0.0, 0.0, 0.3], (0.0, 0.0)));
        let mut sim = built(&world);
        sim.command(drive(0.5, 0.0, 0.0)).expect("a base");
        let [x, ..] = after(&mut sim, 4 * SECOND);
        assert!((0.595..0.6015).contains(&x), "{x}");
        let (mast, _) = sim.pose(child).expect("a mast");
        assert!((mast[0] - x - 0.3).abs() < 1e-5, "{mast:?}");
    }

    #[test]
    fn an_arm_is_drawn_along_and_keeps_its_posture() {
        let link = body("link", BodyMotion::Dynamic, cuboid(0.4, 0.05, 0.05), [0.2, 0.0, 0.5]);
        let mut world = flat(vec![link]);
        let (parent, child, tip) = (BodyId(1), BodyId(2), BodyId(2));
        world.joints.push(upright_joint(parent, child, [0.0, 0.0, 0.5], (-2.0, 2.0)));
        let (joints, tool) = (vec![JointId(0)], [0.2, 0.0, 0.0]);
        let (max_speed, contact_limit, avoids_people, postures) = (1.0, None, false, Vec::new());
        world.arms.push(Arm {
            name: "arm".into(),
            joints,
            tip,
            tool,
            max_speed,
            contact_limit,
            avoids_people,
            postures,
        });
        let mut sim = built(&world);
        sim.command(drive(1.0, 0.0, 1.0)).expect("a base");
        for _ in 0..20 {
            let [x, y, yaw] = after(&mut sim, SECOND / 10);
            let angle = sim.joint_positions(ArmId(0))[0];
            assert!(angle.abs() < 0.02, "{angle}");
            let [tx, ty, _] = sim.tool(ArmId(0)).expect("an arm");
            assert!((tx - x - 0.4 * libm::cos(yaw)).hypot(ty - y - 0.4 * libm::sin(yaw)) < 0.02, "{tx} {ty}");
        }
    }

    #[test]
    fn pushes_what_is_loose() {
        let crate_ = body("crate", BodyMotion::Dynamic, cuboid(0.2, 0.2, 0.2), [0.6, 0.0, 0.1]);
        let mut sim = built(&flat(vec![crate_]));
        sim.command(drive(0.5, 0.0, 0.0)).expect("a base");
        let [x, ..] = after(&mut sim, 3 * SECOND);
        let (pushed, _) = sim.pose(BodyId(2)).expect("a crate");
        assert!(x > 1.3 && pushed[0] > x + 0.28, "{x} {pushed:?}");
    }

    #[test]
    fn goes_on_from_where_an_action_put_it() {
        let mut sim = built(&flat(Vec::new()));
        let metres = |x: f64| Expr::Const(hrdsl_ir::Value::Float(x));
        let to = WorldPoint::free(None, [metres(2.0), metres(1.0), metres(0.15)]);
        sim.act(&WorldAction::Move { body: BodyId(1), to, over: metres(1.0) }, &|_| None).expect("kinematic");
        sim.advance(2 * SECOND);
        assert_eq!(sim.base_pose(BASE).map(|[x, y, _]| [x, y]), Some([2.0, 1.0]));
        sim.command(drive(0.5, 0.0, 0.0)).expect("a base");
        let [x, y, _] = after(&mut sim, SECOND);
        assert!(x > 2.4 && (y - 1.0).abs() < 1e-6, "{x} {y}");
    }

    proptest! {
        #[test]
        fn velocities_change_no_faster_than_they_may(
            f in -1.0..1.0, s in -1.0..1.0, t in -2.0..2.0, f2 in -1.0..1.0, s2 in -1.0..1.0, t2 in -2.0..2.0,
            along in 0.0..3.0, about in 0.0..5.0,
        ) {
            let now = PlanarVelocity { forward: f, sideways: s, turn: t };
            let aim = PlanarVelocity { forward: f2, sideways: s2, turn: t2 };
            let next = now.towards(aim, along, about);
            let change = (next.forward - f).hypot(next.sideways - s);
            prop_assert!(change <= along + 1e-9 && (next.turn - t).abs() <= about + 1e-9);
            let left = (f2 - next.forward).hypot(s2 - next.sideways);
            prop_assert!((left + change - (f2 - f).hypot(s2 - s)).abs() < 1e-9, "straight to its aim");
            prop_assert_eq!(now.towards(aim, 9.0, 9.0), aim);
        }
    }
}
