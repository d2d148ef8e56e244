//! The world: bodies in world coordinates, signals over primitive measurements, rules.

use hrdsl_ir::{
    Expr, Span, Type, Unit,
    device::{Device, DeviceBody, DeviceKind},
    sensor::SensorSource,
    value::nanos,
    world::{
        ArmId, Axis, BaseId, Body, BodyRef, ContactPhase, DeviceKindId, GripperId, Joint, JointMotion,
        LaserId, RuleTrigger, Signal, SignalId, SignalTerm, World, WorldRule,
    },
};
use hrdsl_model::{self as model, VariableRef, world as from};

use super::expr::{self, LeafSource};

pub(crate) fn world(w: &from::TypedWorld, kinds: &[DeviceKind], signals: &mut SignalTable<'_>) -> World {
    World {
        step: nanos(w.step),
        sample: nanos(w.sample),
        gravity: w.gravity,
        bodies: w.bodies.iter().map(body).collect(),
        joints: w.joints.iter().map(joint).collect(),
        arms: w.arms.clone(),
        grippers: w.grippers.clone(),
        bases: w.bases.clone(),
        lasers: w.lasers.clone(),
        figures: w.figures.clone(),
        currents: w.currents.clone(),
        sensors: w.sensors.clone(),
        devices: devices(w, kinds),
        device_kinds: kinds.to_vec(),
        rules: w.rules.iter().map(|r| rule(r, signals)).collect(),
        origin: w.span,
    }
}

/// The arms, then the grippers, the bases, the lasers.
fn devices(w: &from::TypedWorld, kinds: &[DeviceKind]) -> Vec<Device> {
    let arms = (0..).zip(&w.arms).map(|(i, a)| (&a.name, DeviceBody::Arm(ArmId(i))));
    let grippers = (0..).zip(&w.grippers).map(|(i, g)| (&g.name, DeviceBody::Gripper(GripperId(i))));
    let bases = (0..).zip(&w.bases).map(|(i, b)| (&b.name, DeviceBody::Base(BaseId(i))));
    let lasers = (0..).zip(&w.lasers).map(|(i, l)| (&l.name, DeviceBody::Laser(LaserId(i))));
    let device = |(name, body): (&String, DeviceBody)| {
        let kind = kinds.iter().position(|kind| kind.sort == body.sort())?;
        let kind = DeviceKindId(u16::try_from(kind).ok()?);
        Some(Device { name: name.clone(), kind, body })
    };
    arms.chain(grippers).chain(bases).chain(lasers).filter_map(device).collect()
}

/// In world coordinates: a turn about the vertical adds to the yaw, which is applied last.
fn body(b: &from::TypedBody) -> Body {
    let [roll, pitch, yaw] = b.rotation;
    Body {
        name: b.name.clone(),
        motion: b.motion,
        shape: b.shape,
        position: b.frame.place(b.position),
        rotation: [roll, pitch, yaw + b.frame.yaw],
        mass: b.mass,
        stiffness: b.stiffness,
        ghost: b.ghost,
        solid: b.solid.clone(),
    }
}

fn joint(j: &from::TypedJoint) -> Joint {
    let axis = j.frame.turn(j.axis);
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    Joint {
        name: j.name.clone(),
        parent: j.parent,
        child: j.child,
        motion: j.motion,
        anchor: j.frame.place(j.anchor),
        axis: axis.map(|x| x / length),
        lo: j.lo,
        hi: j.hi,
        drive: j.drive,
    }
}

fn rule(r: &model::TypedWorldRule, signals: &mut SignalTable<'_>) -> WorldRule {
    let mut reader = SignalReader { signals, read: Vec::new(), recorded: false };
    let guard = r.guard.as_ref().map(|g| reader.expr(g));
    let on = match &r.on {
        RuleTrigger::Event(pattern) => RuleTrigger::Event(pattern.clone()),
        RuleTrigger::Commanded { device, command } => {
            RuleTrigger::Commanded { device: *device, command: *command }
        }
        RuleTrigger::Edge { rising, condition, held } => {
            RuleTrigger::Edge { rising: *rising, condition: reader.expr(condition), held: *held }
        }
    };
    let args = r.args.iter().map(|a| reader.expr(a)).collect();
    WorldRule { on, guard, event: r.event, args, signals: reader.read(), origin: r.origin }
}

fn type_of(t: SignalTerm, world: Option<&from::TypedWorld>) -> Type {
    let of_motion = |j: model::JointId, turns, slides| {
        let joint = world.and_then(|world| world.joints.get(usize::from(j.0)));
        Type::Float(if joint.is_some_and(|j| j.motion == JointMotion::Slider) { slides } else { turns })
    };
    match t {
        SignalTerm::Distance(..)
        | SignalTerm::Range(..)
        | SignalTerm::Coordinate(..)
        | SignalTerm::Nearest { .. }
        | SignalTerm::Height(_) => Type::Float(Unit::Metre),
        SignalTerm::Angle(..) | SignalTerm::Heading(_) | SignalTerm::Tilt(_) => Type::Float(Unit::Radian),
        SignalTerm::Pressure { .. } => Type::Float(Unit::Pascal),
        SignalTerm::Force(..)
        | SignalTerm::ForceOn(_)
        | SignalTerm::Weight(_)
        | SignalTerm::Pressed { .. } => Type::Float(Unit::Newton),
        SignalTerm::JointPosition(j) => of_motion(j, Unit::Radian, Unit::Metre),
        SignalTerm::JointRate(j) => of_motion(j, Unit::RadianPerSecond, Unit::MetrePerSecond),
        SignalTerm::JointEffort(j) => of_motion(j, Unit::NewtonMetre, Unit::Newton),
        SignalTerm::Delta(of, _) | SignalTerm::Reading(of) => {
            let of = world.and_then(|world| world.signals.get(usize::from(of.0)));
            of.map_or(Type::Float(Unit::None), |of| of.ty)
        }
        SignalTerm::Orientation(..) => Type::Float(Unit::None),
        SignalTerm::Visible(..)
        | SignalTerm::Touches(..)
        | SignalTerm::Holds(..)
        | SignalTerm::HoldsAny(_) => Type::Bool,
        SignalTerm::JointSpeed(_) => Type::Float(Unit::RadianPerSecond),
        SignalTerm::Speed(_) => Type::Float(Unit::MetrePerSecond),
    }
}

/// A term as it is written in the scenario, with the full names of what it measures.
#[expect(clippy::too_many_lines, reason = "a flat match")]
fn written(term: SignalTerm, world: &from::TypedWorld) -> String {
    let body = |b: BodyRef| match b {
        BodyRef::Body(id) => world.bodies[usize::from(id.0)].name.as_str(),
        BodyRef::Current(id) => world.currents[usize::from(id.0)].name.as_str(),
    };
    let gripper = |g: model::GripperId| world.grippers[usize::from(g.0)].name.as_str();
    let joint = |j: model::JointId| world.joints[usize::from(j.0)].name.as_str();
    let turns = |j: model::JointId| world.joints[usize::from(j.0)].motion == JointMotion::Hinge;
    match term {
        SignalTerm::Distance(a, b) => format!("distance({}, {})", body(a), body(b)),
        SignalTerm::Range(a, b) => format!("range({}, {})", body(a), body(b)),
        SignalTerm::Angle(a, b) => format!("angle({}, {})", body(a), body(b)),
        SignalTerm::Visible(a, b) => format!("visible({}, {})", body(a), body(b)),
        SignalTerm::Coordinate(b, axis) => {
            let axis = match axis {
                Axis::X => "x",
                Axis::Y => "y",
                Axis::Z => "z",
            };
            format!("{}.{axis}", body(b))
        }
        SignalTerm::Holds(g, b) => format!("holds({}, {})", gripper(g), body(b)),
        SignalTerm::HoldsAny(g) => format!("holds({})", gripper(g)),
        SignalTerm::JointSpeed(a) => format!("joint_speed({})", world.arms[usize::from(a.0)].name),
        SignalTerm::JointRate(j) => format!("joint_speed({})", joint(j)),
        SignalTerm::JointPosition(j) if turns(j) => format!("joint_angle({})", joint(j)),
        SignalTerm::JointPosition(j) => format!("joint_position({})", joint(j)),
        SignalTerm::JointEffort(j) if turns(j) => format!("torque({})", joint(j)),
        SignalTerm::JointEffort(j) => format!("joint_effort({})", joint(j)),
        SignalTerm::Touches(a, b) => format!("touches({}, {})", body(a), body(b)),
        SignalTerm::Force(a, b) => format!("force({}, {})", body(a), body(b)),
        SignalTerm::ForceOn(b) => format!("force({})", body(b)),
        SignalTerm::Pressed { body: b, by, phase } => {
            let name = match phase {
                ContactPhase::Transient => "transient_force",
                ContactPhase::QuasiStatic => "quasistatic_force",
            };
            let by = by.map_or_else(String::new, |by| format!(", {}", body(by)));
            format!("{name}({}{by})", body(b))
        }
        SignalTerm::Pressure { body: b, by, area } => {
            let by = by.map_or_else(String::new, |by| format!(", {}", body(by)));
            format!("estimated_pressure({}{by}, {area} m^2)", body(b))
        }
        SignalTerm::Nearest { laser, first, last } => {
            let laser = &world.lasers[usize::from(laser.0)];
            let angle = |beam: u16| (laser.lo + f64::from(beam) * laser.increment()).to_degrees();
            match (first, last) {
                (0, last) if last + 1 == laser.beams => format!("nearest({})", laser.name),
                (first, last) => {
                    format!("nearest({}, {:.3} deg, {:.3} deg)", laser.name, angle(first), angle(last))
                }
            }
        }
        SignalTerm::Weight(b) => format!("weight({})", body(b)),
        SignalTerm::Tilt(b) => format!("tilt({})", body(b)),
        SignalTerm::Height(b) => format!("height({})", body(b)),
        SignalTerm::Delta(of, over) => {
            let of = &world.signals[usize::from(of.0)].name;
            format!("delta({of}, {} s)", hrdsl_ir::value::seconds(over))
        }
        SignalTerm::Reading(of) => format!("reading({})", world.signals[usize::from(of.0)].name),
        SignalTerm::Speed(b) => format!("speed({})", body(b)),
        SignalTerm::Heading(b) => format!("heading({})", body(b)),
        SignalTerm::Orientation(b, part) => format!("orientation({}).{}", body(b), part.name()),
    }
}

/// All signals: those declared, with their ids, then one for each other term that a requirement or rule reads.
pub(crate) struct SignalTable<'a> {
    list: Vec<Signal>,
    world: Option<&'a from::TypedWorld>,
}

impl<'a> SignalTable<'a> {
    pub fn declared(scenario: &'a model::Scenario) -> Self {
        let declared = scenario.world.as_ref().map_or(&[][..], |w| w.signals.as_slice());
        let signal = |s: &from::TypedSignal| {
            let mut terms = Vec::new();
            let value = measured(&s.value, declared, &mut terms);
            let to = s.to.clone();
            let (name, ty) = (s.name.clone(), s.ty);
            Signal { name, ty, to, terms, value, recorded: false, origin: s.span }
        };
        Self { list: declared.iter().map(signal).collect(), world: scenario.world.as_ref() }
    }

    pub fn into_list(self) -> Vec<Signal> {
        self.list
    }

    /// The signal that measures just this term; a new one, named as the term is written, if there is none.
    pub fn of_term(&mut self, term: SignalTerm, span: Span) -> usize {
        // What is measured in its own place is exact, even in what the system reads.
        let sensors = self.world.map_or(&[][..], |world| &world.sensors);
        let is_exact = |at: u16| sensors.iter().all(|s| s.source != SensorSource::Signal(SignalId(at)));
        let is = |s: &Signal| s.terms == [term] && s.value == Expr::Var(0);
        let found = self.list.iter().zip(0u16..).position(|(s, at)| is(s) && is_exact(at));
        if let Some(at) = found {
            return at;
        }
        let name = self.world.map_or_else(String::new, |world| written(term, world));
        self.list.push(Signal {
            name,
            ty: type_of(term, self.world),
            to: Vec::new(),
            terms: vec![term],
            value: Expr::Var(0),
            recorded: false,
            origin: span,
        });
        self.list.len() - 1
    }
}

/// An expression over primitive terms; an earlier signal stands for its own expression.
fn measured(e: &model::TypedExpr, declared: &[from::TypedSignal], terms: &mut Vec<SignalTerm>) -> Expr {
    expr::expr(e, &mut |source| match source {
        LeafSource::Term(t, _) => {
            let at = terms.iter().position(|known| *known == t).unwrap_or_else(|| {
                terms.push(t);
                terms.len() - 1
            });
            Expr::Var(u16::try_from(at).unwrap_or(u16::MAX))
        }
        LeafSource::Leaf(VariableRef::Signal(id)) => {
            measured(&declared[usize::from(id.0)].value, declared, terms)
        }
        LeafSource::Leaf(VariableRef::Local(_) | VariableRef::Own(_) | VariableRef::Shared(_)) => {
            expr::ruled_out("variable in a signal")
        }
    })
}

/// Collects the signals that a requirement or rule reads: `Expr::Var(i)` is the i-th.
pub(crate) struct SignalReader<'s, 'a> {
    signals: &'s mut SignalTable<'a>,
    read: Vec<SignalId>,
    recorded: bool,
}

impl<'s, 'a> SignalReader<'s, 'a> {
    /// For a requirement: what it reads is recorded.
    pub fn new(signals: &'s mut SignalTable<'a>) -> Self {
        Self { signals, read: Vec::new(), recorded: true }
    }

    pub fn expr(&mut self, e: &model::TypedExpr) -> Expr {
        expr::expr(e, &mut |source| {
            let at = match source {
                LeafSource::Term(t, e) => self.signals.of_term(t, e.span),
                LeafSource::Leaf(VariableRef::Signal(id)) => usize::from(id.0),
                LeafSource::Leaf(VariableRef::Local(_) | VariableRef::Own(_) | VariableRef::Shared(_)) => {
                    expr::ruled_out("variable in a requirement or rule")
                }
            };
            self.signals.list[at].recorded |= self.recorded;
            let id = SignalId(u16::try_from(at).unwrap_or(u16::MAX));
            let var = self.read.iter().position(|known| *known == id).unwrap_or_else(|| {
                self.read.push(id);
                self.read.len() - 1
            });
            Expr::Var(u16::try_from(var).unwrap_or(u16::MAX))
        })
    }

    pub fn read(self) -> Vec<SignalId> {
        self.read
    }
}
