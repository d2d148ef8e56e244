//! The simulated world as the harness's world: commands to devices become those of arms and hands, and what they were expected to
//! come to is measured at their end.

use std::collections::BTreeMap;

use hrdsl_harness::{
    BodyPose, CheckedCommand, CommandId, MotionPlanRequest, PlannedTrajectory, SpentTime, ThreadClock,
    WorldAccuracy, WorldBackend,
};
use hrdsl_ir::{
    Nanos, Program, Value,
    device::{DeviceBody, PrimitiveCall},
    device_state::DeviceState,
    world::{BodyId, JointId, SignalId, SignalTerm, Vec3, WorldAction},
};

use crate::{WorldSimulation, command::MotorCommand, error::SimulationError};

/// A [`WorldSimulation`] behind the seam.
pub struct SimulatedWorld {
    sim: WorldSimulation,
    /// Of commands under way: what must be measured at their end.
    expected: BTreeMap<CommandId, CommandExpectation>,
}

struct CommandExpectation {
    term: SignalTerm,
    value: Value,
    otherwise: String,
}

impl SimulatedWorld {
    /// The program's world at its start, in a test with this seed; `None` if the scenario has none.
    ///
    /// # Errors
    /// Why the world cannot be built.
    pub fn new(program: &Program, seed: u64) -> Result<Option<Self>, SimulationError> {
        let Some(world) = &program.world else { return Ok(None) };
        let sim = WorldSimulation::new(world, &program.signals)?.seeded(seed)?;
        Ok(Some(Self { sim, expected: BTreeMap::new() }))
    }

    /// The same, which measures by a clock what its engine takes.
    #[must_use]
    pub fn timed(self, clock: ThreadClock) -> Self {
        Self { sim: self.sim.timed(clock), ..self }
    }
}

/// What a device is to do; `None`: it is for one of another sort to do.
fn meant(body: DeviceBody, call: &PrimitiveCall) -> Option<MotorCommand> {
    // INVARIANT: the checker gives each kind of device the primitives of its own sort; a laser has none.
    let arm = || if let DeviceBody::Arm(arm) = body { Some(arm) } else { None };
    let gripper = || if let DeviceBody::Gripper(gripper) = body { Some(gripper) } else { None };
    let base = || if let DeviceBody::Base(base) = body { Some(base) } else { None };
    Some(match call {
        PrimitiveCall::ReachPoint { to, speed } => {
            MotorCommand::ReachPoint { arm: arm()?, target: *to, max_speed: *speed }
        }
        PrimitiveCall::ReachJoints { to, speed } => {
            MotorCommand::ReachJoints { arm: arm()?, positions: to.clone(), max_speed: *speed }
        }
        PrimitiveCall::FollowJoints { positions, times } => {
            MotorCommand::FollowJoints { arm: arm()?, positions: positions.clone(), times: times.clone() }
        }
        PrimitiveCall::AimJoint { joint, to } => {
            MotorCommand::AimJoint { arm: arm()?, joint: *joint, to: *to }
        }
        PrimitiveCall::StopJoints => MotorCommand::StopJoints { arm: arm()? },
        PrimitiveCall::CloseFingers => MotorCommand::CloseFingers { gripper: gripper()? },
        PrimitiveCall::OpenFingers => MotorCommand::OpenFingers { gripper: gripper()? },
        PrimitiveCall::DriveWheels { forward, sideways, turn } => {
            MotorCommand::DriveWheels { base: base()?, forward: *forward, sideways: *sideways, turn: *turn }
        }
        PrimitiveCall::StopWheels => MotorCommand::StopWheels { base: base()? },
    })
}

impl WorldBackend for SimulatedWorld {
    fn next_wake(&self) -> Option<Nanos> {
        self.sim.next_wake()
    }

    fn advance(&mut self, to: Nanos) {
        self.sim.advance(to);
    }

    fn fault(&self) -> Option<String> {
        self.sim.fault().map(str::to_owned)
    }

    fn accuracy(&self) -> Option<WorldAccuracy> {
        Some(self.sim.accuracy())
    }

    fn engine_time(&self) -> SpentTime {
        self.sim.engine_time()
    }

    fn read(&mut self, signal: SignalId) -> Value {
        self.sim.read(signal)
    }

    fn reading(&mut self, signal: SignalId) -> Value {
        self.sim.reading(signal)
    }

    fn changes(&self) -> Option<u64> {
        Some(self.sim.changes())
    }

    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.sim.act(action, &|i| vars.get(usize::from(i)).copied()).map_err(|e| e.to_string())
    }

    fn command(&mut self, command: &CheckedCommand<'_>) -> Result<CommandId, String> {
        let body = command.device.body;
        let meant = meant(body, &command.call).ok_or("this device cannot do it")?;
        let id = self.sim.command(meant).map_err(|e| e.to_string())?;
        if let Some(expect) = &command.command.expect
            && let Some(term) = expect.measure.of(body)
        {
            let (value, otherwise) = (Value::Bool(expect.is), expect.otherwise.clone());
            self.expected.insert(id, CommandExpectation { term, value, otherwise });
        }
        Ok(id)
    }

    fn state(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        self.sim.told(device, what)
    }

    fn sampled_at(&self, device: DeviceBody) -> Option<Nanos> {
        self.sim.sampled_at(device)
    }

    fn plan(&self, device: DeviceBody, wanted: &MotionPlanRequest) -> Result<PlannedTrajectory, String> {
        match device {
            DeviceBody::Arm(arm) => self.sim.plan(arm, wanted).map_err(|e| e.to_string()),
            DeviceBody::Gripper(_) | DeviceBody::Base(_) | DeviceBody::Laser(_) => {
                Err(format!("a {} plans nothing", device.sort().name()))
            }
        }
    }

    fn poses(&self, tell: &mut dyn FnMut(BodyPose)) {
        self.sim.poses(tell);
    }

    fn joints(&self, tell: &mut dyn FnMut(JointId, f64)) {
        self.sim.joints(tell);
    }

    fn contacts(&self, least: f64, tell: &mut dyn FnMut([BodyId; 2], Vec3)) {
        self.sim.contacts(least, tell);
    }

    fn contact_point(&self, bodies: [BodyId; 2]) -> Option<Vec3> {
        self.sim.contact_point(bodies)
    }

    fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)> {
        let ended = self.sim.finished();
        let ended = ended.into_iter().map(|(id, how)| {
            let expected = self.expected.remove(&id);
            let missed = expected.filter(|e| self.sim.measure(&e.term) != e.value);
            let how = how.map_err(|e| e.to_string());
            (id, how.and_then(|()| missed.map_or(Ok(()), |e| Err(e.otherwise))))
        });
        ended.collect()
    }
}
