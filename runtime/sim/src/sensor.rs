//! Imperfect sensors: what can be read of the world late, now and then, or wrongly.
//!
//! A sensor takes samples, each with a number. Which sample is read is decided by the time alone, and what is wrong with it by its
//! number: so a reading is the same whoever asks, and how often. The world before time 0 was as it is then.

use std::collections::VecDeque;

use hrdsl_ir::{
    Nanos, Unit, Value,
    sensor::{ImperfectSensor, SensorSource},
    world::{JointMotion, Signal, SignalTerm, World},
};

use crate::{
    chance::{SampleDraws, SensorChance},
    error::SimulationError,
    math::{BodyFrame, wrap},
    odometer::{DriftingOdometer, GroundPose},
    physics::bad,
};

/// So many samples in a row are looked through for one that was not lost: who loses more gives no value.
const MOST_LOST: i64 = 10_000;

/// How many truths are kept at least before it is looked for those that nobody can read any more.
const KEPT: usize = 16;

/// What there is to be sensed at some moment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SensedTruth {
    Signal(Value),
    Ranges(Vec<f64>),
    Base {
        pose: GroundPose,
        velocity: [f64; 3],
    },
    Arm {
        joints: Vec<f64>,
        speeds: Vec<f64>,
        tool: BodyFrame,
        /// How what the arm hangs on was moved from where it was at the start.
        base: BodyFrame,
    },
}

/// All imperfect sensors of a world.
#[derive(Default)]
pub(crate) struct SensorBank {
    sensors: Vec<SensorLine>,
    /// Since when the world has been as it is.
    since: Nanos,
    /// How often a reading that somebody waits for has become another one.
    arrivals: u64,
}

/// One of them, with what it saw.
struct SensorLine {
    data: ImperfectSensor,
    chance: SensorChance,
    /// Counted from 0, in which its draws are the same.
    period: Nanos,
    /// What is was, and since when, the oldest first. What is now is not among it.
    past: VecDeque<(Nanos, SensedTruth)>,
    /// When the past is to be looked through.
    room: usize,
    odometer: Option<DriftingOdometer>,
    /// The motions of an arm's joints.
    joints: Vec<JointMotion>,
    /// The unit of a signal.
    unit: Unit,
    nearest: f64,
    farthest: f64,
    /// Somebody judges what can be read.
    is_watched: bool,
}

impl SensorBank {
    /// The sensors of a world at time 0.
    ///
    /// # Errors
    /// If one is of what does not exist, or has a bad measure.
    pub fn new(
        world: &World,
        signals: &[Signal],
        seed: u64,
        start: &dyn Fn(SensorSource) -> SensedTruth,
    ) -> Result<Self, SimulationError> {
        let mut sensors = Vec::new();
        for sensor in &world.sensors {
            check(sensor, world, signals)?;
            sensors.push(SensorLine::new(sensor, world, signals, (seed, &start(sensor.source))));
        }
        Ok(Self { sensors, since: 0, arrivals: 0 })
    }

    fn line(&self, source: SensorSource) -> Option<&SensorLine> {
        self.sensors.iter().find(|line| line.data.source == source)
    }

    /// Whether something is read otherwise than it is.
    pub fn has(&self, source: SensorSource) -> bool {
        self.line(source).is_some()
    }

    /// The world is about to change: what it is it has been until then.
    pub fn hold(&mut self, until: Nanos, truth: &dyn Fn(SensorSource) -> SensedTruth) {
        let since = self.since;
        for line in &mut self.sensors {
            line.hold((since, until), truth);
        }
    }

    /// The world has changed, in a step of this number.
    pub fn changed(&mut self, at: Nanos, step: u64, pose: &dyn Fn(SensorSource) -> Option<GroundPose>) {
        self.since = at;
        for line in &mut self.sensors {
            if let Some(odometer) = &mut line.odometer
                && let Some(pose) = pose(line.data.source)
            {
                odometer.go_on(step, pose);
            }
        }
    }

    /// What can be read, and when it was so. `None`: no sample has come.
    pub fn reading(
        &self,
        source: SensorSource,
        now: Nanos,
        truth: &dyn Fn(SensorSource) -> SensedTruth,
        corrected: &dyn Fn(&SensedTruth, &[f64]) -> Option<BodyFrame>,
    ) -> Option<(SensedTruth, Nanos)> {
        let line = self.line(source)?;
        let (number, mut draws) = line.sample(now)?;
        let time = line.time_of(number, now);
        // Where nothing has changed yet, it is as it is at the start.
        let is_present = time >= self.since || line.past.is_empty();
        let seen = if is_present { line.believed(truth(source)) } else { line.past_at(time)? };
        Some((line.misread(seen, &mut draws, corrected), time))
    }

    /// When a reading that somebody waits for next becomes another one by itself.
    pub fn next_arrival(&self, now: Nanos, is_resting: bool) -> Option<Nanos> {
        let watched = self.sensors.iter().filter(|line| line.is_watched);
        watched.filter_map(|line| line.next_arrival(now, (self.since, is_resting))).min()
    }

    /// Time passes: counts whether such a reading has become another one.
    pub fn pass(&mut self, from: Nanos, to: Nanos, is_resting: bool) {
        if self.next_arrival(from, is_resting).is_some_and(|next| next <= to) {
            self.arrivals += 1;
        }
    }

    pub fn arrivals(&self) -> u64 {
        self.arrivals
    }
}

impl SensorLine {
    fn new(
        sensor: &ImperfectSensor,
        world: &World,
        signals: &[Signal],
        (seed, start): (u64, &SensedTruth),
    ) -> Self {
        let (mut joints, mut unit, mut limits) = (Vec::new(), Unit::None, (0.0, f64::INFINITY));
        let mut is_watched = false;
        match sensor.source {
            SensorSource::Signal(id) => {
                unit = match signals.get(usize::from(id.0)).map(|s| s.ty) {
                    Some(hrdsl_ir::Type::Float(unit)) => unit,
                    Some(
                        hrdsl_ir::Type::Bool
                        | hrdsl_ir::Type::Int { .. }
                        | hrdsl_ir::Type::Enum(_)
                        | hrdsl_ir::Type::Text
                        | hrdsl_ir::Type::List(_),
                    )
                    | None => Unit::None,
                };
                let reads = |term: &SignalTerm| *term == SignalTerm::Reading(id);
                is_watched = signals.iter().any(|s| s.terms.iter().any(reads));
            }
            SensorSource::Arm(id) => {
                let arm = world.arms.get(usize::from(id.0));
                let of = arm.into_iter().flat_map(|arm| &arm.joints);
                joints = of.filter_map(|j| world.joints.get(usize::from(j.0))).map(|j| j.motion).collect();
            }
            SensorSource::Laser(id) => {
                let laser = world.lasers.get(usize::from(id.0));
                limits = laser.map_or(limits, |laser| (laser.nearest, laser.farthest));
            }
            SensorSource::Base(_) => {}
        }
        let odometer = match (sensor.drift, start) {
            (Some(drift), SensedTruth::Base { pose, .. }) => {
                let chance = SensorChance::new(seed, &format!("drift {}", sensor.name));
                Some(DriftingOdometer::new(drift, chance, *pose))
            }
            (_, SensedTruth::Base { .. } | SensedTruth::Signal(_) | SensedTruth::Ranges(_))
            | (_, SensedTruth::Arm { .. }) => None,
        };
        Self {
            chance: SensorChance::new(seed, &sensor.key()),
            period: sensor.every.unwrap_or(world.step).max(1),
            data: sensor.clone(),
            past: VecDeque::new(),
            room: KEPT,
            odometer,
            joints,
            unit,
            nearest: limits.0,
            farthest: limits.1,
            is_watched,
        }
    }

    /// The newest sample that has come by a time, or was taken and lost.
    fn newest(&self, now: Nanos) -> i64 {
        (now - self.data.late).div_euclid(self.period)
    }

    /// The newest sample that can be read, with the draws that are left of it; `None`: all were lost.
    fn sample(&self, now: Nanos) -> Option<(i64, SampleDraws)> {
        let newest = self.newest(now);
        // A laser loses single beams.
        let dropout =
            if matches!(self.data.source, SensorSource::Laser(_)) { 0.0 } else { self.data.dropout };
        if dropout >= 1.0 {
            return None;
        }
        (0..MOST_LOST).find_map(|back| {
            let mut draws = self.chance.of_sample(newest - back);
            (!draws.happens(dropout)).then_some((newest - back, draws))
        })
    }

    /// What a sample shows is as it was at this time.
    fn time_of(&self, number: i64, now: Nanos) -> Nanos {
        match self.data.every {
            Some(every) => number * every,
            None => (now - self.data.late).min((number + 1) * self.period - 1),
        }
    }

    /// A base that counts its way is where it believes to be.
    fn believed(&self, truth: SensedTruth) -> SensedTruth {
        match (truth, &self.odometer) {
            (SensedTruth::Base { velocity, .. }, Some(odometer)) => {
                SensedTruth::Base { pose: odometer.believed(), velocity }
            }
            (
                truth @ (SensedTruth::Base { .. }
                | SensedTruth::Signal(_)
                | SensedTruth::Ranges(_)
                | SensedTruth::Arm { .. }),
                _,
            ) => truth,
        }
    }

    fn past_at(&self, time: Nanos) -> Option<SensedTruth> {
        let after = self.past.partition_point(|(since, _)| *since <= time);
        self.past.get(after.saturating_sub(1)).map(|(_, truth)| truth.clone())
    }

    fn hold(&mut self, (since, until): (Nanos, Nanos), truth: &dyn Fn(SensorSource) -> SensedTruth) {
        let sampled = match self.data.every {
            Some(every) => (until - 1).div_euclid(every) * every >= since,
            None => true,
        };
        // What was at the start was so before.
        if !sampled && !self.past.is_empty() {
            return;
        }
        let seen = self.believed(truth(self.data.source));
        if self.past.back().is_none_or(|(_, last)| *last != seen) {
            self.past.push_back((since, seen));
        }
        if self.past.len() >= self.room {
            let oldest = self.sample(until).map(|(number, _)| self.time_of(number, until));
            let oldest = oldest.unwrap_or(until);
            while self.past.get(1).is_some_and(|(since, _)| *since <= oldest) {
                self.past.pop_front();
            }
            self.room = KEPT.max(2 * self.past.len());
        }
    }

    fn next_arrival(&self, now: Nanos, (since, is_resting): (Nanos, bool)) -> Option<Nanos> {
        let newest = self.newest(now);
        let boundary = (newest + 1) * self.period + self.data.late;
        if self.data.is_random() {
            return Some(boundary);
        }
        if self.data.every.is_some() {
            let settled = is_resting && newest * self.period >= since;
            return (!settled).then_some(boundary);
        }
        let changes = self.past.iter().map(|(since, _)| *since).chain([since]);
        changes.map(|change| change + self.data.late).find(|change| *change > now)
    }

    /// What a sample shows of the truth.
    fn misread(
        &self,
        truth: SensedTruth,
        draws: &mut SampleDraws,
        corrected: &dyn Fn(&SensedTruth, &[f64]) -> Option<BodyFrame>,
    ) -> SensedTruth {
        let noise = |unit| self.data.deviation(unit);
        match truth {
            SensedTruth::Signal(Value::Bool(b)) => {
                SensedTruth::Signal(Value::Bool(b != draws.happens(self.data.flip)))
            }
            SensedTruth::Signal(Value::Float(x)) => {
                let noisy = x + draws.gaussian(noise(self.unit));
                SensedTruth::Signal(Value::Float(self.outlier(draws).unwrap_or(noisy)))
            }
            SensedTruth::Signal(
                value @ (Value::Int(_) | Value::Symbol(_) | Value::Text(_) | Value::List(_)),
            ) => SensedTruth::Signal(value),
            SensedTruth::Ranges(ranges) => {
                SensedTruth::Ranges(ranges.into_iter().map(|range| self.beam(range, draws)).collect())
            }
            SensedTruth::Base { pose: [x, y, yaw], velocity: [forward, sideways, turn] } => {
                SensedTruth::Base {
                    pose: [
                        x + draws.gaussian(noise(Unit::Metre)),
                        y + draws.gaussian(noise(Unit::Metre)),
                        wrap(yaw + draws.gaussian(noise(Unit::Radian))),
                    ],
                    velocity: [
                        forward + draws.gaussian(noise(Unit::MetrePerSecond)),
                        sideways + draws.gaussian(noise(Unit::MetrePerSecond)),
                        turn + draws.gaussian(noise(Unit::RadianPerSecond)),
                    ],
                }
            }
            SensedTruth::Arm { .. } => self.misread_arm(truth, draws, corrected),
        }
    }

    /// Joints are measured; the tool is where the arm would have it that has its joints so.
    fn misread_arm(
        &self,
        truth: SensedTruth,
        draws: &mut SampleDraws,
        corrected: &dyn Fn(&SensedTruth, &[f64]) -> Option<BodyFrame>,
    ) -> SensedTruth {
        let SensedTruth::Arm { joints, speeds, tool, base } = &truth else { return truth };
        let mut noisy = |values: &[f64], hinge, slider| {
            let each = values.iter().zip(&self.joints).map(|(value, motion)| {
                let unit = if *motion == JointMotion::Hinge { hinge } else { slider };
                value + draws.gaussian(self.data.deviation(unit))
            });
            each.collect::<Vec<f64>>()
        };
        let measured = noisy(joints, Unit::Radian, Unit::Metre);
        let speeds = noisy(speeds, Unit::RadianPerSecond, Unit::MetrePerSecond);
        let tool = if measured == *joints { *tool } else { corrected(&truth, &measured).unwrap_or(*tool) };
        SensedTruth::Arm { joints: measured, speeds, tool, base: *base }
    }

    /// What is read in place of the truth, if that has nothing to do with it.
    fn outlier(&self, draws: &mut SampleDraws) -> Option<f64> {
        let outlier = self.data.outlier?;
        draws.happens(outlier.probability).then(|| draws.between(outlier.lo, outlier.hi))
    }

    fn beam(&self, range: f64, draws: &mut SampleDraws) -> f64 {
        let lost = draws.happens(self.data.dropout);
        let noise = draws.gaussian(self.data.deviation(Unit::Metre));
        let range = self.outlier(draws).unwrap_or(range + noise);
        if lost || range > self.farthest {
            f64::INFINITY
        } else if range < self.nearest {
            f64::NEG_INFINITY
        } else {
            range
        }
    }
}

fn check(sensor: &ImperfectSensor, world: &World, signals: &[Signal]) -> Result<(), SimulationError> {
    let what = || format!("a measure of {} `{}`", sensor.source.sort(), sensor.name);
    let is_probability = |p: f64| (0.0..=1.0).contains(&p);
    let deviations = sensor.noise.iter().map(|noise| noise.deviation);
    let outliers = sensor.outlier.iter();
    let ranges = outliers.clone().all(|o| o.lo.is_finite() && o.hi.is_finite() && o.lo <= o.hi);
    let drifts = sensor.drift.iter().flat_map(|drift| [drift.way, drift.turn]);
    let count = match sensor.source {
        SensorSource::Signal(_) => signals.len(),
        SensorSource::Arm(_) => world.arms.len(),
        SensorSource::Base(_) => world.bases.len(),
        SensorSource::Laser(_) => world.lasers.len(),
    };
    if sensor.source.index() >= count {
        return Err(bad("a sensor".into(), sensor.source.sort(), sensor.source.index()));
    }
    let is_good = sensor.late >= 0
        && sensor.every.is_none_or(|every| every > 0)
        && is_probability(sensor.dropout)
        && is_probability(sensor.flip)
        && ranges
        && outliers.map(|outlier| outlier.probability).all(is_probability)
        && deviations.chain(drifts).all(|x| x.is_finite() && x >= 0.0);
    if is_good { Ok(()) } else { Err(SimulationError::BadNumber { what: what() }) }
}
