//! What the system can read of a running world: the truth, or what imperfect sensors make of it.

use hrdsl_ir::{
    Nanos, Value,
    device::DeviceBody,
    device_state::DeviceState,
    sensor::SensorSource,
    world::{ArmId, SignalId},
};

use crate::{
    WorldSimulation,
    error::SimulationError,
    math::{BodyFrame, RotationQuat, SpaceVector, about},
    sensor::{SensedTruth, SensorBank},
};

impl WorldSimulation {
    /// The same at its start, with the chance of its sensors from a seed.
    ///
    /// # Errors
    /// If a sensor is of what does not exist, or has a bad measure.
    pub fn seeded(mut self, seed: u64) -> Result<Self, SimulationError> {
        let truth = |source| self.truth(source);
        self.sensors = SensorBank::new(&self.world, &self.signals, seed, &truth)?;
        Ok(self)
    }

    /// Another number whenever something that is judged may have another value.
    #[must_use]
    pub fn changes(&self) -> u64 {
        self.steps + self.sensors.arrivals()
    }

    /// The world is about to change.
    pub(crate) fn before_change(&mut self, next: Nanos) {
        let mut sensors = std::mem::take(&mut self.sensors);
        sensors.hold(next, &|source| self.truth(source));
        self.sensors = sensors;
    }

    /// The world has changed.
    pub(crate) fn after_change(&mut self, now: Nanos) {
        let mut sensors = std::mem::take(&mut self.sensors);
        let pose = |source| match source {
            SensorSource::Base(base) => self.base_pose(base),
            SensorSource::Signal(_) | SensorSource::Arm(_) | SensorSource::Laser(_) => None,
        };
        sensors.changed(now, self.steps, &pose);
        self.sensors = sensors;
    }

    /// What the system can read of a signal at this time.
    #[must_use]
    pub fn reading(&self, signal: SignalId) -> Value {
        self.view().reading(signal)
    }

    /// When that was so which the system can read of a device at this time; `None`: it is so now, or there is nothing to read.
    #[must_use]
    pub fn sampled_at(&self, device: DeviceBody) -> Option<Nanos> {
        self.sensed(device.source()?)?.map(|(_, time)| time)
    }

    /// What is true of a device; `None`: it has no such state.
    fn state(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        match (device, what) {
            (DeviceBody::Arm(arm), DeviceState::JointAngles) => Some(self.joint_positions(arm)),
            (DeviceBody::Arm(arm), DeviceState::JointSpeeds) => Some(self.joint_speeds(arm)),
            (DeviceBody::Arm(arm), DeviceState::ToolPose) => self.tool_pose(arm).map(Vec::from),
            (DeviceBody::Gripper(gripper), DeviceState::FingerPlaces) => Some(self.finger_places(gripper)),
            (DeviceBody::Base(base), DeviceState::BasePose) => self.base_pose(base).map(Vec::from),
            (DeviceBody::Base(base), DeviceState::BaseOrientation) => {
                self.base_orientation(base).map(Vec::from)
            }
            (DeviceBody::Base(base), DeviceState::BaseVelocity) => self.base_velocity(base).map(Vec::from),
            (DeviceBody::Laser(laser), DeviceState::BeamRanges) => self.scan(laser),
            (DeviceBody::Laser(laser), DeviceState::BeamAngles) => {
                self.laser(laser).map(|l| vec![l.lo, l.hi])
            }
            (DeviceBody::Laser(laser), DeviceState::BeamLimits) => {
                self.laser(laser).map(|l| vec![l.nearest, l.farthest])
            }
            (DeviceBody::Arm(_) | DeviceBody::Gripper(_) | DeviceBody::Base(_) | DeviceBody::Laser(_), _) => {
                None
            }
        }
    }

    /// What a device tells the system of itself; `None`: it cannot tell this.
    #[must_use]
    pub fn told(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        let exact = self.state(device, what)?;
        // What a laser is, is known.
        if matches!(device, DeviceBody::Laser(_)) && what != DeviceState::BeamRanges {
            return Some(exact);
        }
        let Some(source) = device.source() else { return Some(exact) };
        let Some(sensed) = self.sensed(source) else { return Some(exact) };
        let Some((seen, _)) = sensed else { return Some(vec![f64::NAN; exact.len()]) };
        Some(match (seen, what) {
            (SensedTruth::Ranges(ranges), _) => ranges,
            (SensedTruth::Base { velocity, .. }, DeviceState::BaseVelocity) => velocity.to_vec(),
            (SensedTruth::Base { pose: [_, _, yaw], .. }, DeviceState::BaseOrientation) => {
                let turn = about(SpaceVector::z(), yaw);
                vec![turn.i, turn.j, turn.k, turn.w]
            }
            (SensedTruth::Base { pose, .. }, _) => pose.to_vec(),
            (SensedTruth::Arm { speeds, .. }, DeviceState::JointSpeeds) => speeds,
            (SensedTruth::Arm { tool, .. }, DeviceState::ToolPose) => seven(&tool).to_vec(),
            (SensedTruth::Arm { joints, .. }, _) => joints,
            (SensedTruth::Signal(_), _) => exact,
        })
    }

    /// What an imperfect sensor shows; the outer `None`: it is exact.
    #[expect(clippy::option_option, reason = "an exact sensor, and one that shows nothing, are two things")]
    fn sensed(&self, source: SensorSource) -> Option<Option<(SensedTruth, Nanos)>> {
        if !self.sensors.has(source) {
            return None;
        }
        let corrected = |truth: &SensedTruth, measured: &[f64]| self.corrected(source, truth, measured);
        Some(self.sensors.reading(source, self.now, &|source| self.truth(source), &corrected))
    }

    fn truth(&self, source: SensorSource) -> SensedTruth {
        match source {
            SensorSource::Signal(id) => SensedTruth::Signal(self.read(id)),
            SensorSource::Laser(id) => SensedTruth::Ranges(self.scan(id).unwrap_or_default()),
            SensorSource::Base(id) => SensedTruth::Base {
                pose: self.base_pose(id).unwrap_or_default(),
                velocity: self.base_velocity(id).unwrap_or_default(),
            },
            SensorSource::Arm(id) => SensedTruth::Arm {
                joints: self.joint_positions(id),
                speeds: self.joint_speeds(id),
                tool: self.tool_frame(id).unwrap_or_else(identity),
                base: self.arms.get(usize::from(id.0)).map_or_else(identity, |arm| arm.moved(&self.physics)),
            },
        }
    }

    /// Where an arm's tool point is, turned as its tip is.
    pub(crate) fn tool_frame(&self, arm: ArmId) -> Option<BodyFrame> {
        let at = self.arms.get(usize::from(arm.0))?.tool_at(&self.physics);
        let tip = self.world.arms.get(usize::from(arm.0))?.tip;
        Some(BodyFrame::new(at, self.physics.pose(tip).turn))
    }

    /// Where the tool would be if the joints were as they are measured.
    fn corrected(&self, source: SensorSource, truth: &SensedTruth, measured: &[f64]) -> Option<BodyFrame> {
        match (source, truth) {
            (SensorSource::Arm(id), SensedTruth::Arm { joints, tool, base, .. }) => {
                let arm = self.arms.get(usize::from(id.0))?;
                Some(arm.carried(base, (joints, measured)).then(tool))
            }
            (
                SensorSource::Signal(_)
                | SensorSource::Arm(_)
                | SensorSource::Base(_)
                | SensorSource::Laser(_),
                SensedTruth::Signal(_)
                | SensedTruth::Ranges(_)
                | SensedTruth::Base { .. }
                | SensedTruth::Arm { .. },
            ) => None,
        }
    }
}

fn identity() -> BodyFrame {
    BodyFrame::new(SpaceVector::zeros(), RotationQuat::identity())
}

/// A place, and a unit quaternion x, y, z, w.
fn seven(frame: &BodyFrame) -> [f64; 7] {
    let (at, turn) = (frame.at, frame.turn);
    [at.x, at.y, at.z, turn.i, turn.j, turn.k, turn.w]
}
