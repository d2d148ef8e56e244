//! The seam to the world: what the harness asks of whatever holds the bodies, be it simulated or not.

use hrdsl_ir::{
    Nanos, Value,
    device::DeviceBody,
    device_state::DeviceState,
    world::{BodyId, JointId, SignalId, Vec3, WorldAction},
};

use crate::{command::CheckedCommand, spent::SpentTime};

/// A world in which actors act. Times are those of the harness's clock; the calls come in the order of time.
pub trait WorldBackend {
    /// When it next changes by itself; `None`: at rest.
    fn next_wake(&self) -> Option<Nanos>;

    /// Time has come to this.
    fn advance(&mut self, to: Nanos);

    /// Why it cannot go on: what it says from now on means nothing. The run ends as an error.
    fn fault(&self) -> Option<String> {
        None
    }

    /// How far it strayed, at worst so far, from what cannot be; `None`: it cannot tell.
    fn accuracy(&self) -> Option<WorldAccuracy> {
        None
    }

    /// What its engine took so far, if it measures that.
    fn engine_time(&self) -> SpentTime {
        SpentTime::default()
    }

    /// The present value of a signal, in the SI unit of its type.
    fn read(&mut self, signal: SignalId) -> Value;

    /// What the system can read of it, which may be late, or wrong: an imperfect sensor.
    fn reading(&mut self, signal: SignalId) -> Value {
        self.read(signal)
    }

    /// A number that is another one whenever a signal may have another value; `None`: nobody knows, and they are read each time.
    fn changes(&self) -> Option<u64> {
        None
    }

    /// Begins an environment actor's action; `vars` are the values of its variables. Does not wait for its end.
    ///
    /// # Errors
    /// Why the world cannot do it.
    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String>;

    /// Begins a command of the system. Does not wait for its end: devices act side by side. A later command to the same device
    /// replaces it.
    ///
    /// # Errors
    /// Why it cannot be done as things are.
    fn command(&mut self, command: &CheckedCommand<'_>) -> Result<CommandId, String>;

    /// What a device tells the system of itself, in SI units; `None`: it cannot tell this.
    fn state(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        let _ = (device, what);
        None
    }

    /// When that was so which it tells; `None`: it is so now.
    fn sampled_at(&self, device: DeviceBody) -> Option<Nanos> {
        let _ = device;
        None
    }

    /// A free path of an arm, with times; nothing moves.
    ///
    /// # Errors
    /// Why there is none.
    fn plan(&self, device: DeviceBody, wanted: &MotionPlanRequest) -> Result<PlannedTrajectory, String> {
        let _ = (device, wanted);
        Err("this device plans nothing".to_owned())
    }

    /// Tells of each body where it is, but of those that rest, or are rigidly one with another; for looking only.
    fn poses(&self, tell: &mut dyn FnMut(BodyPose)) {
        let _ = tell;
    }

    /// Tells where its joints are, but of those that rest, rad or m; for looking only.
    fn joints(&self, tell: &mut dyn FnMut(JointId, f64)) {
        let _ = tell;
    }

    /// Tells which bodies press on each other with at least so much (N), each pair once, in order: the force on the second; for looking only.
    fn contacts(&self, least: f64, tell: &mut dyn FnMut([BodyId; 2], Vec3)) {
        let _ = (least, tell);
    }

    /// Where about two bodies touch, m; `None`: nobody knows.
    fn contact_point(&self, bodies: [BodyId; 2]) -> Option<Vec3> {
        let _ = bodies;
        None
    }

    /// The commands that have ended since the last call, in the order in which they did, and why those failed that did.
    fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)>;
}

/// Where a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose {
    pub body: BodyId,
    /// m
    pub place: Vec3,
    /// A unit quaternion: x, y, z, w.
    pub turn: [f64; 4],
}

/// What a simulation of rigid bodies says of itself: how far it strayed at worst from what cannot be, and where.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldAccuracy {
    /// How deep two bodies of one robot were in each other, m.
    pub self_penetration: Option<(f64, [String; 2])>,
    /// How deep two other bodies were, m.
    pub penetration: Option<(f64, [String; 2])>,
    /// How far a joint was beyond one of its limits, rad or m.
    pub beyond_limit: Option<(f64, String)>,
    /// How far the two sides of a joint were apart, m.
    pub joint_gap: Option<(f64, String)>,
}

/// Where an arm is to be.
#[derive(Clone, Debug, PartialEq)]
pub enum ArmTarget {
    /// The place of its tool point, m.
    Place(Vec3),
    /// The positions of its joints, from the base to the tip, rad or m.
    Posture(Vec<f64>),
}

/// A motion that an arm is asked to plan.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPlanRequest {
    pub to: ArmTarget,
    /// Where it begins, rad or m; `None`: where the arm is.
    pub from: Option<Vec<f64>>,
    /// The greatest speed of each joint, rad/s or m/s, if they are to be slower than they may be.
    pub speeds: Option<Vec<f64>>,
    /// How quickly each joint comes to its speed, in the mean, rad/s² or m/s²; `None`: as in the arm's own motions.
    pub accelerations: Option<Vec<f64>>,
}

/// A trajectory of an arm: a path, and when the arm would be where on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedTrajectory {
    /// The postures between which it is straight, from where it begins to where it ends.
    pub corners: Vec<Vec<f64>>,
    /// Points of the path with their times, of which the first is its beginning and the last its end; corners are rounded.
    pub points: Vec<PlannedPoint>,
}

/// Where an arm is at a time on its path.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPoint {
    /// Seconds from the beginning.
    pub time: f64,
    /// Of each joint, rad or m.
    pub positions: Vec<f64>,
    /// rad/s or m/s
    pub velocities: Vec<f64>,
    /// rad/s² or m/s²
    pub accelerations: Vec<f64>,
}

/// A command under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CommandId(pub u64);
