//! Imperfect sensors: in what the system's readings of the world are worse than the truth.
//!
//! What is judged is always the truth; these say what the program under test gets to know of it, and when.

use serde::{Deserialize, Serialize};

use crate::{
    Unit,
    value::Nanos,
    world_ids::{ArmId, BaseId, LaserId, SignalId},
};

/// A signal or a device that is read late, now and then, or wrongly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImperfectSensor {
    /// `robot.eye`
    pub name: String,
    pub source: SensorSource,
    /// From one sample to the next, counted from time 0; `None`: it is looked at whenever it is read.
    pub every: Option<Nanos>,
    /// From the moment at which a sample is taken until it can be read.
    pub late: Nanos,
    /// Standard deviations of what is added to each sample, by the unit of what they are added to.
    pub noise: Vec<SensorNoise>,
    /// Of a base: how its idea of where it is goes astray.
    pub drift: Option<OdometryDrift>,
    /// With which probability a sample is missing; of a laser: a beam.
    pub dropout: f64,
    /// With which probability a truth is read as the other one.
    pub flip: f64,
    /// How often a quantity, or a beam of a laser, is read as anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlier: Option<SensorOutlier>,
}

impl ImperfectSensor {
    /// The text by which its random draws are told from those of others: `laser robot.eye`.
    #[must_use]
    pub fn key(&self) -> String {
        format!("{} {}", self.source.sort(), self.name)
    }

    /// The standard deviation of what is added to quantities of this unit.
    #[must_use]
    pub fn deviation(&self, unit: Unit) -> f64 {
        self.noise.iter().find(|noise| noise.unit == unit).map_or(0.0, |noise| noise.deviation)
    }

    /// Whether two of its samples may differ though the world stands still.
    #[must_use]
    pub fn is_random(&self) -> bool {
        self.dropout > 0.0
            || self.flip > 0.0
            || self.outlier.is_some_and(|outlier| outlier.probability > 0.0)
            || self.noise.iter().any(|noise| noise.deviation > 0.0)
    }
}

/// What an imperfect sensor reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorSource {
    Signal(SignalId),
    Arm(ArmId),
    Base(BaseId),
    Laser(LaserId),
}

impl SensorSource {
    /// As the member of the world is written that makes it.
    #[must_use]
    pub fn sort(self) -> &'static str {
        match self {
            SensorSource::Signal(_) => "signal",
            SensorSource::Arm(_) => "arm",
            SensorSource::Base(_) => "base",
            SensorSource::Laser(_) => "laser",
        }
    }

    /// Its place among those of its sort.
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(match self {
            SensorSource::Signal(id) => id.0,
            SensorSource::Arm(id) => id.0,
            SensorSource::Base(id) => id.0,
            SensorSource::Laser(id) => id.0,
        })
    }
}

/// `noise 5 mm`: Gaussian, with a mean of 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorNoise {
    /// The SI unit of what it is added to.
    pub unit: Unit,
    pub deviation: f64,
}

/// `outlier 1 % in 0 m .. 5 m`: a reading that has nothing to do with the truth, evenly from a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorOutlier {
    /// Of each sample; of a laser: of each beam of one.
    pub probability: f64,
    /// In the SI unit of what is read.
    pub lo: f64,
    pub hi: f64,
}

/// `drift 2 cm, 1 deg`: errors that add up on the way, independent of each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OdometryDrift {
    /// The standard deviation of the way that is counted after 1 m, m.
    pub way: f64,
    /// That of the turn that is counted after 1 rad, rad.
    pub turn: f64,
}
