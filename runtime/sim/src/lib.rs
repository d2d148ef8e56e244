//! The physics world: bodies, devices and sensors from data, stepped in simulated time.
//!
//! # Steps
//! 1. [`WorldSimulation::new`] builds the world of a scenario.
//! 2. Environment actors change it by [`WorldSimulation::act`], the system actor by [`WorldSimulation::command`].
//! 3. [`WorldSimulation::advance`] brings it to a time: in physics steps while anything moves, at once while everything rests.
//! 4. [`WorldSimulation::read`] gives a signal's value, [`WorldSimulation::finished`] the commands that have ended.
//!
//! [`SimulatedWorld`] is such a world for the harness.
//!
//! # What is idealised
//! - Links of an arm are joined by constraints that are solved step by step: they hang apart by up to a millimetre.
//! - What is kinematic may tear joints, which then give way and come together again; torn 10 cm apart the run is at fault.
//! - A motor's rotor is added to its link's inertia about all axes.
//! - What a hand holds is fixed to the palm by a joint that bears as much as friction would, and slips beyond.
//! - An arm's planner knows exactly where everything is but people, and by choice where these are, too.
//! - People are bodies that springs draw along their script, and whose surfaces are springs: what pushes them moves them. A body that is
//!   declared `kinematic` is pushed by nothing.
//! - A base drives as it is told, pushes what is loose, and stops before what is fixed; a dynamic one stands on wheels that slip, and topples.
//! - A body farther than 20 m from all that there was at the start is lost, and stops there.
//!
//! # Determinism
//! The same calls give the same bits, on every platform with IEEE 754 arithmetic. The physics runs on a grid of steps
//! that begins when the world leaves its rest, so that it does not matter in which pieces time is advanced; what is asked
//! for between two steps takes effect from then on. The engine computes in single precision.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod arm;
mod base;
mod chance;
mod clearance;
mod command;
mod error;
mod figure;
mod hand;
mod hulls;
mod kinematics;
mod laser;
mod math;
mod motion;
mod mover;
mod odometer;
mod past;
mod physics;
mod picture;
mod planner;
mod profile;
mod reading;
mod report;
mod rigidity;
mod route;
#[cfg(test)]
mod samples;
mod sense;
mod sensor;
mod world;

use hrdsl_ir::world::{
    ArmId, BaseId, BodyId, BodyMotion, FigureId, GripperId, Signal, SignalId, SignalTerm, World, WorldAction,
    WorldPoint,
};
use hrdsl_ir::{Expr, Nanos, Value};

use arm::{ArmControl, ArmMoment};
use base::{BaseControl, PlanarVelocity};
pub use command::MotorCommand;
pub use error::{CommandError, SimulationError};
use figure::FigureControl;
use hand::HandSet;
use hrdsl_harness::ThreadClock;
pub use hrdsl_harness::{
    ArmTarget, CommandId, MotionPlanRequest, PlannedTrajectory, SpentTime, WorldAccuracy,
};
pub use hulls::{HullStore, warm_hulls};
use math::{BodyFrame, SpaceVector};
use mover::{KinematicPath, LookRequest};
use past::SignalPast;
use physics::{PhysicsAdapter, bad, index};
use sense::SensorView;
use sensor::SensorBank;
pub use world::SimulatedWorld;

/// How long nothing may have moved before the world counts as at rest.
const REST_AFTER: Nanos = 300_000_000;

/// A running world.
pub struct WorldSimulation {
    world: World,
    signals: Vec<Signal>,
    past: SignalPast,
    sensors: SensorBank,
    physics: PhysicsAdapter,
    arms: Vec<ArmControl>,
    /// By arm: the hands that it moves.
    arm_hands: Vec<Vec<usize>>,
    hands: HandSet,
    bases: Vec<BaseControl>,
    figures: Vec<FigureControl>,
    /// By body.
    paths: Vec<Option<KinematicPath>>,
    now: Nanos,
    /// When the physics was last brought up to date, and when it will be next; none at rest.
    last: Nanos,
    next: Option<Nanos>,
    /// For how long nothing has moved.
    quiet: Nanos,
    /// How many physics steps there were. Whatever is measured changes in these alone.
    steps: u64,
    commands: u64,
    finished: Vec<(CommandId, Result<(), CommandError>)>,
}

type VariableLookup<'a> = &'a dyn Fn(u16) -> Option<Value>;

impl WorldSimulation {
    /// Builds the world, at time 0.
    ///
    /// # Errors
    /// If the data refer to what does not exist, an arm's joints do not form a chain, or a measure is not positive.
    pub fn new(world: &World, signals: &[Signal]) -> Result<WorldSimulation, SimulationError> {
        if world.step <= 0 {
            return Err(SimulationError::BadNumber { what: "the physics step".into() });
        }
        for gripper in &world.grippers {
            if index(gripper.palm) >= world.bodies.len() {
                return Err(bad(format!("gripper `{}`", gripper.name), "body", index(gripper.palm)));
            }
        }
        sense::check(world, signals)?;
        let mut physics = PhysicsAdapter::new(world)?;
        let arms = world.arms.iter().map(|a| ArmControl::new(a, world, &physics));
        let arms = arms.collect::<Result<Vec<_>, _>>()?;
        let hands = HandSet::new(world, &mut physics)?;
        let moved = |arm: &ArmControl| {
            let palms = world.grippers.iter().enumerate().filter(|(_, g)| arm.moves(g.palm));
            palms.map(|(i, _)| i).collect::<Vec<usize>>()
        };
        let arm_hands = arms.iter().map(moved).collect();
        let bases = world.bases.iter().map(|b| BaseControl::new(b, world, &mut physics));
        let bases = bases.collect::<Result<Vec<_>, _>>()?;
        let figures = world.figures.iter().map(|f| FigureControl::new(f, world, &physics));
        let figures = figures.collect::<Result<Vec<_>, _>>()?;
        world.lasers.iter().try_for_each(|laser| laser::check(laser, world))?;
        let mut sim = WorldSimulation {
            past: SignalPast::new(signals),
            sensors: SensorBank::default(),
            paths: vec![None; world.bodies.len()],
            world: world.clone(),
            signals: signals.to_vec(),
            physics,
            arms,
            arm_hands,
            hands,
            bases,
            figures,
            now: 0,
            last: 0,
            next: Some(world.step),
            quiet: 0,
            steps: 0,
            commands: 0,
            finished: Vec::new(),
        };
        sim.remember(0);
        sim.seeded(0)
    }

    /// Takes down what later differences are of.
    fn remember(&mut self, now: Nanos) {
        let read = |s: SignalId| self.read(s).as_f64().unwrap_or(f64::NAN);
        let values: Vec<f64> = self.past.signals().map(read).collect();
        self.past.note(now, &values);
    }

    /// The simulated time.
    #[must_use]
    pub fn now(&self) -> Nanos {
        self.now
    }

    /// Why the world cannot go on: the physics has failed, and what it says means nothing any more.
    #[must_use]
    pub fn fault(&self) -> Option<&str> {
        self.physics.fault()
    }

    /// How far the physics strayed at worst from what cannot be.
    #[must_use]
    pub fn accuracy(&self) -> WorldAccuracy {
        let found = self.physics.accuracy();
        let pair = |(depth, a, b): (f64, usize, usize)| {
            let name =
                |at: usize| self.world.bodies.get(at).map_or_else(String::new, |body| body.name.clone());
            (depth, [name(a), name(b)])
        };
        let joint = |(by, at): (f64, usize)| {
            (by, self.world.joints.get(at).map_or_else(String::new, |joint| joint.name.clone()))
        };
        WorldAccuracy {
            self_penetration: found.own.map(pair),
            penetration: found.others.map(pair),
            beyond_limit: found.beyond.map(joint),
            joint_gap: found.apart.map(joint),
        }
    }

    /// The same world, which measures by a clock what its engine takes.
    #[must_use]
    pub fn timed(mut self, clock: ThreadClock) -> Self {
        self.physics.clock = Some(clock);
        self
    }

    /// What the engine's steps took so far, if they are measured.
    #[must_use]
    pub fn engine_time(&self) -> SpentTime {
        self.physics.engine_time
    }

    /// A step of the engine and nothing else, with each motor as it was last driven: what a step costs at the very least. The time
    /// stays where it is.
    pub fn step_bare(&mut self) {
        self.physics.step_bare();
    }

    /// How many physics steps there were. Signals and measurements change in these alone.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// When the world next changes by itself: at the next physics step, or never while everything rests; and what is judged of
    /// its sensors.
    #[must_use]
    pub fn next_wake(&self) -> Option<Nanos> {
        self.next.into_iter().chain(self.sensors.next_arrival(self.now, self.next.is_none())).min()
    }

    /// Brings the world to a time; does nothing if that is past.
    pub fn advance(&mut self, to: Nanos) {
        self.sensors.pass(self.now, to, self.next.is_none());
        while let Some(next) = self.next.filter(|n| *n <= to) {
            self.step(next);
        }
        self.now = self.now.max(to);
    }

    fn step(&mut self, next: Nanos) {
        self.before_change(next);
        let mut asleep = Vec::with_capacity(self.arms.len());
        for (arm, hands) in self.arms.iter().zip(&self.arm_hands) {
            // An arm of two is not woken by what the other one holds.
            let held = self.hands.held_by_robot(arm.base(), &self.physics);
            let is_used = self.hands.is_any_busy(hands);
            asleep.push(arm.sleeps(&held, is_used, &mut self.physics));
        }
        let sleeps = |joint: usize| self.arms.iter().zip(&asleep).any(|(arm, a)| *a && arm.has_joint(joint));
        self.physics.release_motors(sleeps);
        for (arm, is_asleep) in self.arms.iter_mut().zip(&asleep) {
            if *is_asleep {
                arm.rest();
            } else {
                arm.drive(self.last, next, &mut self.physics);
            }
        }
        for base in &mut self.bases {
            // An action moves the body in its stead.
            match &self.paths[index(base.body)] {
                Some(path) => base.carried(&path.at(next)),
                None => base.go_on(self.last, next, &mut self.physics),
            }
        }
        for figure in &mut self.figures {
            figure.drive(self.last, next, &mut self.physics);
        }
        for (i, slot) in self.paths.iter_mut().enumerate() {
            if let Some(path) = slot {
                self.physics.lead(physics::body_id(i), &path.at(next));
                if path.is_over(next) {
                    *slot = None;
                }
            }
        }
        self.physics.step();
        for base in &mut self.bases {
            base.look(&self.physics);
        }
        self.steps += 1;
        self.last = next;
        self.now = self.now.max(next);
        for (i, arm) in self.arms.iter_mut().enumerate() {
            let held = self.hands.held_by_any(&self.arm_hands[i]);
            self.finished.extend(arm.check_arrival(&held, &self.physics));
        }
        let reaching = self.hands.update(next, self.world.step, &mut self.physics, &mut self.finished);
        for (hand, by) in reaching {
            self.reach_on(hand, by);
        }
        self.finished.extend(self.bases.iter_mut().filter_map(BaseControl::check_stopped));
        self.after_change(next);
        self.remember(next);
        self.rest_or_go_on(next);
    }

    fn rest_or_go_on(&mut self, at: Nanos) {
        let busy = self.arms.iter().any(ArmControl::is_busy)
            || self.hands.is_busy()
            || self.figures.iter().any(FigureControl::is_busy)
            || self.bases.iter().any(|base| base.is_busy(at))
            || self.paths.iter().any(Option::is_some);
        self.quiet = if busy || !self.physics.is_quiet() { 0 } else { self.quiet + self.world.step };
        // Differences to what was change as long as that is still in motion.
        if self.quiet >= REST_AFTER.max(self.past.longest()) {
            self.physics.freeze();
            self.remember(at);
            self.past.rest();
            self.next = None;
        } else {
            self.next = Some(at + self.world.step);
        }
    }

    fn wake(&mut self) {
        self.quiet = 0;
        if self.next.is_none() {
            self.last = self.now;
            self.next = Some(self.now + self.world.step);
        }
    }

    fn view(&self) -> SensorView<'_> {
        SensorView {
            physics: &self.physics,
            hands: &self.hands,
            arms: &self.arms,
            currents: &self.world.currents,
            lasers: &self.world.lasers,
            signals: &self.signals,
            past: &self.past,
            sensors: &self.sensors,
            now: self.last,
            clock: self.now,
        }
    }

    /// The value of a signal at the last physics step.
    ///
    /// Where its expression has no value (a division by zero, a signal that does not exist) it is `false`, the least
    /// integer of its range, not a number, or the first symbol of its enumeration.
    #[must_use]
    pub fn read(&self, signal: SignalId) -> Value {
        match self.signals.get(usize::from(signal.0)) {
            Some(signal) => self.view().signal(signal),
            None => Value::Float(f64::NAN),
        }
    }

    /// The value of a measurement at the last physics step; of what the world does not have, not a number.
    #[must_use]
    pub fn measure(&self, term: &SignalTerm) -> Value {
        let exists = sense::check_term(term, &self.world, self.signals.len(), String::new).is_ok();
        if exists { self.view().term(term) } else { Value::Float(f64::NAN) }
    }

    // ── Environment actors ──

    /// Begins an action of an environment actor; `var` gives the variables of its stimulus.
    ///
    /// # Errors
    /// If an expression has no finite value, or the body is not kinematic, or what is named does not exist.
    pub fn act(&mut self, action: &WorldAction, var: VariableLookup<'_>) -> Result<(), SimulationError> {
        match action {
            WorldAction::Move { body, to, over } => {
                let from = self.moved(*body)?;
                let to = self.place(to, var)?;
                let over = number(over, var, "the time of a move")?;
                self.send(*body, from, BodyFrame::new(to, from.turn), over)?;
            }
            WorldAction::Look { body, at, offset, distance, angle } => {
                let from = self.moved(*body)?;
                sense::check_body(*at, &self.world, || "a look".into())?;
                let target = self.physics.pose(self.view().body(*at)).at;
                let offset = number(offset, var, "the offset of a look")?;
                let distance = number(distance, var, "the distance of a look")?.max(0.0);
                let angle = number(angle, var, "the angle of a look")?.abs();
                let facing = self.physics.start(*body).x_axis();
                let bows = self.figures.iter().any(|figure| figure.has(*body));
                let to = mover::look(&from, facing, &LookRequest { target, offset, distance, angle, bows });
                self.send(*body, from, to, mover::LOOK_TIME)?;
            }
            WorldAction::Grasp { gripper } => {
                let hand = self.hand(*gripper).ok_or_else(|| no_gripper(*gripper))?;
                let replaced = self.hands.close(hand, self.now, None, true, &mut self.physics);
                self.replaced(replaced);
            }
            WorldAction::LetGo { gripper } => {
                let hand = self.hand(*gripper).ok_or_else(|| no_gripper(*gripper))?;
                let replaced = self.hands.open(hand, self.now, None, &mut self.physics);
                self.replaced(replaced);
            }
            WorldAction::Walk { figure, along, speed } => {
                let along = along.iter().map(|to| self.place(to, var)).collect::<Result<Vec<_>, _>>()?;
                let speed = number(speed, var, "the speed of a walk")?;
                if speed <= 0.0 {
                    return Err(SimulationError::BadNumber { what: "the speed of a walk".into() });
                }
                let along: Vec<[f64; 2]> = along.iter().map(|to| [to.x, to.y]).collect();
                self.figure(*figure)?.walk_along(&along, speed);
            }
            WorldAction::Turn { figure, to } => {
                let to = self.place(to, var)?;
                self.figure(*figure)?.turn_to([to.x, to.y]);
            }
        }
        self.wake();
        Ok(())
    }

    fn figure(&mut self, figure: FigureId) -> Result<&mut FigureControl, SimulationError> {
        let at = usize::from(figure.0);
        self.figures.get_mut(at).ok_or_else(|| bad("an action".into(), "figure", at))
    }

    /// Where a kinematic or guided body is at this moment, on its path.
    fn moved(&self, body: BodyId) -> Result<BodyFrame, SimulationError> {
        let Some(data) = self.world.bodies.get(index(body)) else {
            return Err(bad("an action".into(), "body", index(body)));
        };
        if !matches!(data.motion, BodyMotion::Kinematic | BodyMotion::Guided) {
            return Err(SimulationError::NotMoved { body: data.name.clone() });
        }
        Ok(match &self.paths[index(body)] {
            Some(path) => path.at(self.now),
            None => self.physics.aim(body),
        })
    }

    fn send(
        &mut self,
        body: BodyId,
        from: BodyFrame,
        to: BodyFrame,
        over: f64,
    ) -> Result<(), SimulationError> {
        if let Some(figure) = self.figures.iter_mut().find(|figure| figure.has(body)) {
            return figure.send(body, to, over, &self.physics);
        }
        self.paths[index(body)] = Some(KinematicPath::new(from, to, self.now, over));
        Ok(())
    }

    /// A hand that would take hold of something goes on towards it.
    fn reach_on(&mut self, hand: BodyId, by: SpaceVector) {
        let aim = self.physics.aim(hand);
        let to = BodyFrame::new(aim.at + by, aim.turn);
        // INVARIANT: hands can be sent.
        let _ = self.send(hand, aim, to, 0.0);
        self.wake();
    }

    fn place(&self, point: &WorldPoint, var: VariableLookup<'_>) -> Result<SpaceVector, SimulationError> {
        let mut offset = SpaceVector::zeros();
        for (i, expr) in point.offset.iter().enumerate() {
            offset[i] = number(expr, var, "a place")?;
        }
        let mut place = offset;
        if let Some(of) = point.of {
            sense::check_body(of, &self.world, || "a place".into())?;
            place += self.physics.pose(self.view().body(of)).at;
        }
        for [low, high] in &point.within {
            let (low, high) = (self.place(low, var)?, self.place(high, var)?);
            // Of an empty box the upper end counts.
            place = place.sup(&low).inf(&high);
        }
        Ok(place)
    }

    // ── The system actor ──

    /// Begins a command of the system actor; one to the same device that is still under way is replaced.
    ///
    /// # Errors
    /// If it cannot be begun: out of reach, beyond the limits, not a number, no such device.
    #[expect(clippy::too_many_lines, reason = "a flat match, an arm for each command")]
    pub fn command(&mut self, command: MotorCommand) -> Result<CommandId, CommandError> {
        let id = CommandId(self.commands);
        let mut moves = true;
        let replaced = match command {
            MotorCommand::ReachPoint { arm, target, max_speed } => {
                let at = self.arm(arm, max_speed)?;
                if target.iter().any(|x| !x.is_finite()) {
                    return Err(CommandError::NotFinite);
                }
                let route = self.arms[at].plan_place(target, max_speed, &self.moment(at))?;
                self.arms[at].go(id, route, Some(target))
            }
            MotorCommand::ReachJoints { arm, positions, max_speed } => {
                let at = self.arm(arm, max_speed)?;
                if positions.iter().any(|x| !x.is_finite()) {
                    return Err(CommandError::NotFinite);
                }
                self.arms[at].check(&positions, &self.world)?;
                let route = self.arms[at].plan_posture(&positions, max_speed, &self.moment(at))?;
                self.arms[at].go(id, route, None)
            }
            MotorCommand::FollowJoints { arm, positions, times } => {
                let at = self.arm(arm, None)?;
                let track = self.arms[at].track(&positions, &times, &self.world)?;
                self.arms[at].follow(id, track)
            }
            MotorCommand::AimJoint { arm, joint, to } => {
                let at = self.arm(arm, None)?;
                let replaced = self.arms[at].aim_joint(joint, to, &self.world)?;
                self.finished.push((id, Ok(())));
                replaced
            }
            MotorCommand::StopJoints { arm } => {
                let at = self.arm(arm, None)?;
                self.arms[at].halt(id)
            }
            MotorCommand::OpenFingers { gripper } => {
                let hand = self.hand(gripper).ok_or(CommandError::NoSuchGripper)?;
                self.hands.open(hand, self.now, Some(id), &mut self.physics)
            }
            MotorCommand::CloseFingers { gripper } => {
                let hand = self.hand(gripper).ok_or(CommandError::NoSuchGripper)?;
                self.hands.close(hand, self.now, Some(id), false, &mut self.physics)
            }
            MotorCommand::DriveWheels { base, forward, sideways, turn } => {
                let now = self.now;
                let base = self.base_mut(base)?;
                let replaced = base.drive(now, PlanarVelocity { forward, sideways, turn })?;
                // Code that does not know that its robot lies goes on driving; the world may rest.
                moves = !base.has_fallen();
                self.finished.push((id, Ok(())));
                replaced
            }
            MotorCommand::StopWheels { base } => {
                let now = self.now;
                self.base_mut(base)?.stop(now, id)
            }
        };
        self.commands += 1;
        self.replaced(replaced);
        if moves {
            self.wake();
        }
        Ok(id)
    }

    fn arm(&self, arm: ArmId, max_speed: Option<f64>) -> Result<usize, CommandError> {
        let at = usize::from(arm.0);
        if at >= self.arms.len() {
            return Err(CommandError::NoSuchArm);
        }
        if max_speed.is_some_and(|v| !(v.is_finite() && v > 0.0)) {
            return Err(CommandError::BadSpeed);
        }
        Ok(at)
    }

    fn hand(&self, gripper: GripperId) -> Option<usize> {
        Some(usize::from(gripper.0)).filter(|at| *at < self.hands.count())
    }

    fn base_mut(&mut self, base: BaseId) -> Result<&mut BaseControl, CommandError> {
        self.bases.get_mut(usize::from(base.0)).ok_or(CommandError::NoSuchBase)
    }

    fn replaced(&mut self, id: Option<CommandId>) {
        self.finished.extend(id.map(|id| (id, Err(CommandError::Replaced))));
    }

    /// A free path of an arm, from the posture in which it would stop now if no other one is asked for.
    ///
    /// # Errors
    /// That the target is out of reach or beyond limits, that there is no free path, or that numbers make no sense.
    pub fn plan(&self, arm: ArmId, wanted: &MotionPlanRequest) -> Result<PlannedTrajectory, CommandError> {
        let at = self.arm(arm, None)?;
        self.arms[at].plan_motion(wanted, &self.world, &self.moment(at))
    }

    /// What the planner of an arm knows: everything, but where people are only if it avoids them. What hangs on a joint of its own, such
    /// as a door, and is in the arm's hand goes its own way: it is neither carried nor avoided.
    fn moment(&self, arm: usize) -> ArmMoment<'_> {
        let bases = &self.bases;
        let sees_people = self.world.arms.get(arm).is_some_and(|arm| arm.avoids_people);
        let held = self.hands.held_by_any(&self.arm_hands[arm]);
        let (hung, carried): (Vec<BodyId>, Vec<BodyId>) =
            held.into_iter().partition(|body| self.hands.is_hung(*body));
        let hung: Vec<BodyId> = hung.into_iter().map(|body| self.physics.root(body)).collect();
        let is_known = move |body: BodyId| {
            let root = self.physics.root(body);
            let is_seen = match self.physics.motion(root) {
                BodyMotion::Fixed | BodyMotion::Dynamic => true,
                BodyMotion::Kinematic | BodyMotion::Guided => {
                    sees_people || bases.iter().any(|b| b.body == root)
                }
            };
            is_seen && !hung.contains(&root)
        };
        ArmMoment { physics: &self.physics, held: carried, is_known: Box::new(is_known) }
    }

    /// The commands that have ended since the last call, in the order in which they did (arms before hands, hands before bases).
    pub fn finished(&mut self) -> Vec<(CommandId, Result<(), CommandError>)> {
        std::mem::take(&mut self.finished)
    }
}

fn no_gripper(gripper: GripperId) -> SimulationError {
    bad("an action".into(), "gripper", usize::from(gripper.0))
}

fn number(expr: &Expr, var: VariableLookup<'_>, what: &str) -> Result<f64, SimulationError> {
    let value = expr.eval(var).map_err(|error| SimulationError::Eval { what: what.into(), error })?;
    match value.as_f64() {
        Some(x) if x.is_finite() => Ok(x),
        Some(_) | None => Err(SimulationError::BadNumber { what: what.into() }),
    }
}
