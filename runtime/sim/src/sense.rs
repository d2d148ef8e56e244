//! Sensors: the value of every primitive term, now.

use hrdsl_ir::world::{
    Axis, BodyId, BodyRef, CurrentBody, Laser, QuaternionPart, Signal, SignalId, SignalTerm, World,
};
use hrdsl_ir::{Nanos, Type, Value, sensor::SensorSource};

use crate::{
    arm::ArmControl,
    error::SimulationError,
    hand::HandSet,
    laser,
    mover::sight_angle,
    past::SignalPast,
    physics::{PhysicsAdapter, bad, index},
    sensor::{SensedTruth, SensorBank},
};

/// What sensors can see of the world.
pub(crate) struct SensorView<'a> {
    pub physics: &'a PhysicsAdapter,
    pub hands: &'a HandSet,
    pub arms: &'a [ArmControl],
    pub currents: &'a [CurrentBody],
    pub lasers: &'a [Laser],
    pub signals: &'a [Signal],
    pub past: &'a SignalPast,
    /// The time of the last physics step.
    pub now: Nanos,
    pub sensors: &'a SensorBank,
    /// The time that has come.
    pub clock: Nanos,
}

impl SensorView<'_> {
    /// The body that a name stands for now.
    pub fn body(&self, body: BodyRef) -> BodyId {
        match body {
            BodyRef::Body(id) => id,
            BodyRef::Current(id) => self.current(&self.currents[usize::from(id.0)]),
        }
    }

    fn current(&self, current: &CurrentBody) -> BodyId {
        let of = &current.of;
        let held = self.hands.held_by(usize::from(current.by.0)).filter(|b| of.contains(b));
        let untaken = || of.iter().copied().find(|b| !self.hands.was_taken(*b));
        // INVARIANT: a current has bodies; checked when the world was made.
        held.or_else(untaken).unwrap_or(of[of.len() - 1])
    }

    pub fn signal(&self, signal: &Signal) -> Value {
        let term = |i: u16| signal.terms.get(usize::from(i)).map(|t| self.term(t));
        signal.value.eval(&term).unwrap_or_else(|_| without_value(signal.ty))
    }

    /// What can be read of a signal.
    pub fn reading(&self, of: SignalId) -> Value {
        let Some(signal) = self.signals.get(usize::from(of.0)) else { return Value::Float(f64::NAN) };
        let source = SensorSource::Signal(of);
        if !self.sensors.has(source) {
            return self.signal(signal);
        }
        let truth = |_| SensedTruth::Signal(self.signal(signal));
        match self.sensors.reading(source, self.clock, &truth, &|_, _| None) {
            Some((SensedTruth::Signal(value), _)) => value,
            Some((SensedTruth::Ranges(_) | SensedTruth::Base { .. } | SensedTruth::Arm { .. }, _)) | None => {
                without_value(signal.ty)
            }
        }
    }

    /// By how much a signal has changed in the time before now.
    fn delta(&self, of: SignalId, over: Nanos) -> f64 {
        let signal = self.signals.get(usize::from(of.0));
        let now = signal.and_then(|s| self.signal(s).as_f64()).unwrap_or(f64::NAN);
        now - self.past.at(of, self.now - over).unwrap_or(now)
    }

    /// How hard others, or one of them, press on a body, N.
    fn force(&self, on: BodyRef, by: Option<BodyRef>) -> f64 {
        match by {
            Some(by) => self.physics.force_between(self.body(on), self.body(by)),
            None => self.physics.force_on(self.body(on)),
        }
    }

    #[expect(clippy::too_many_lines, reason = "a flat match")]
    pub fn term(&self, term: &SignalTerm) -> Value {
        match *term {
            SignalTerm::Distance(a, b) => Value::Float(self.physics.distance(self.body(a), self.body(b))),
            SignalTerm::Range(a, b) => {
                let (a, b) = (self.physics.pose(self.body(a)), self.physics.pose(self.body(b)));
                Value::Float((b.at - a.at).norm())
            }
            SignalTerm::Angle(a, b) => {
                let (a, b) = (self.physics.pose(self.body(a)), self.physics.pose(self.body(b)));
                Value::Float(sight_angle(&a, b.at))
            }
            SignalTerm::Visible(a, b) => Value::Bool(self.physics.visible(self.body(a), self.body(b))),
            SignalTerm::Coordinate(b, axis) => {
                let at = self.physics.pose(self.body(b)).at;
                Value::Float(match axis {
                    Axis::X => at.x,
                    Axis::Y => at.y,
                    Axis::Z => at.z,
                })
            }
            SignalTerm::Holds(g, b) => {
                Value::Bool(self.hands.held_by(usize::from(g.0)) == Some(self.body(b)))
            }
            SignalTerm::HoldsAny(g) => Value::Bool(self.hands.held_by(usize::from(g.0)).is_some()),
            SignalTerm::JointSpeed(a) => Value::Float(self.arms[usize::from(a.0)].speed(self.physics)),
            SignalTerm::JointRate(j) => Value::Float(self.physics.joint_speed(usize::from(j.0))),
            SignalTerm::JointPosition(j) => Value::Float(self.physics.joint_position(usize::from(j.0))),
            SignalTerm::JointEffort(j) => Value::Float(self.physics.joint_effort(usize::from(j.0))),
            SignalTerm::Touches(a, b) => Value::Bool(self.physics.touches(self.body(a), self.body(b))),
            SignalTerm::Force(a, b) => Value::Float(self.force(a, Some(b))),
            SignalTerm::ForceOn(b) => Value::Float(self.force(b, None)),
            SignalTerm::Pressed { body, by, phase } => {
                Value::Float(self.physics.pressed(self.body(body), by.map(|by| self.body(by)), phase))
            }
            SignalTerm::Pressure { body, by, area } => Value::Float(self.force(body, by) / area),
            SignalTerm::Nearest { laser, first, last } => {
                let laser = &self.lasers[usize::from(laser.0)];
                Value::Float(laser::nearest(laser, (first, last), self.physics))
            }
            SignalTerm::Weight(b) => Value::Float(self.physics.load_on(self.body(b))),
            SignalTerm::Tilt(b) => Value::Float(self.physics.tilt(self.body(b))),
            SignalTerm::Height(b) => Value::Float(self.physics.lowest(self.body(b))),
            SignalTerm::Delta(of, over) => Value::Float(self.delta(of, over)),
            SignalTerm::Reading(of) => self.reading(of),
            SignalTerm::Speed(b) => Value::Float(self.physics.speed(self.body(b))),
            SignalTerm::Heading(b) => {
                let ahead = self.physics.pose(self.body(b)).x_axis();
                Value::Float(libm::atan2(ahead.y, ahead.x))
            }
            SignalTerm::Orientation(b, part) => {
                let turn = self.physics.pose(self.body(b)).turn;
                let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
                Value::Float(
                    sign * match part {
                        QuaternionPart::X => turn.i,
                        QuaternionPart::Y => turn.j,
                        QuaternionPart::Z => turn.k,
                        QuaternionPart::W => turn.w,
                    },
                )
            }
        }
    }
}

/// What stands for a value that there is none of.
fn without_value(ty: Type) -> Value {
    match ty {
        Type::Bool => Value::Bool(false),
        Type::Int { lo, .. } => Value::Int(lo),
        // No signal is a string or a list.
        Type::Float(_) | Type::Text | Type::List(_) => Value::Float(f64::NAN),
        Type::Enum(e) => e.values().first().map_or(Value::Float(f64::NAN), |s| Value::Symbol(*s)),
    }
}

/// Checks that everything a signal or a current names exists.
pub(crate) fn check(world: &World, signals: &[Signal]) -> Result<(), SimulationError> {
    for current in &world.currents {
        let what = || format!("current `{}`", current.name);
        if current.of.is_empty() {
            return Err(bad(what(), "body", 0));
        }
        exists(usize::from(current.by.0), world.grippers.len(), "gripper", what)?;
        for body in &current.of {
            exists(index(*body), world.bodies.len(), "body", what)?;
        }
    }
    // A difference is of a signal before, so that none is of itself.
    for (at, signal) in signals.iter().enumerate() {
        let what = || format!("signal `{}`", signal.name);
        for term in &signal.terms {
            check_term(term, world, at, what)?;
        }
    }
    Ok(())
}

/// Checks that what a measurement is of exists, where there are so many signals.
pub(crate) fn check_term(
    term: &SignalTerm,
    world: &World,
    signals: usize,
    what: impl Fn() -> String,
) -> Result<(), SimulationError> {
    let gripper = |i: u16| exists(usize::from(i), world.grippers.len(), "gripper", &what);
    match *term {
        SignalTerm::Distance(a, b)
        | SignalTerm::Range(a, b)
        | SignalTerm::Angle(a, b)
        | SignalTerm::Touches(a, b)
        | SignalTerm::Force(a, b)
        | SignalTerm::Visible(a, b) => {
            check_body(a, world, &what)?;
            check_body(b, world, &what)
        }
        SignalTerm::Coordinate(b, _)
        | SignalTerm::Speed(b)
        | SignalTerm::Heading(b)
        | SignalTerm::ForceOn(b)
        | SignalTerm::Weight(b)
        | SignalTerm::Tilt(b)
        | SignalTerm::Height(b)
        | SignalTerm::Orientation(b, _) => check_body(b, world, &what),
        SignalTerm::Holds(g, b) => {
            gripper(g.0)?;
            check_body(b, world, &what)
        }
        SignalTerm::Pressed { body, by, .. } => {
            check_body(body, world, &what)?;
            by.map_or(Ok(()), |by| check_body(by, world, &what))
        }
        SignalTerm::Pressure { body, by, area } => {
            if !(area.is_finite() && area > 0.0) {
                return Err(SimulationError::BadNumber {
                    what: format!("the area of a pressure in {}", what()),
                });
            }
            check_body(body, world, &what)?;
            by.map_or(Ok(()), |by| check_body(by, world, &what))
        }
        SignalTerm::Nearest { laser, first, last } => {
            exists(usize::from(laser.0), world.lasers.len(), "laser", &what)?;
            let beams = usize::from(world.lasers[usize::from(laser.0)].beams);
            exists(usize::from(last), beams, "beam", &what)?;
            if first <= last { Ok(()) } else { Err(bad(what(), "beam", usize::from(first))) }
        }
        SignalTerm::HoldsAny(g) => gripper(g.0),
        SignalTerm::JointSpeed(a) => exists(usize::from(a.0), world.arms.len(), "arm", &what),
        SignalTerm::JointRate(j) | SignalTerm::JointPosition(j) | SignalTerm::JointEffort(j) => {
            exists(usize::from(j.0), world.joints.len(), "joint", &what)
        }
        SignalTerm::Delta(of, _) | SignalTerm::Reading(of) => {
            exists(usize::from(of.0), signals, "signal", &what)
        }
    }
}

/// Checks that a body that is referred to exists.
pub(crate) fn check_body(
    b: BodyRef,
    world: &World,
    what: impl Fn() -> String,
) -> Result<(), SimulationError> {
    match b {
        BodyRef::Body(id) => exists(index(id), world.bodies.len(), "body", what),
        BodyRef::Current(id) => exists(usize::from(id.0), world.currents.len(), "current", what),
    }
}

fn exists(
    at: usize,
    count: usize,
    kind: &'static str,
    what: impl Fn() -> String,
) -> Result<(), SimulationError> {
    if at < count { Ok(()) } else { Err(bad(what(), kind, at)) }
}
