//! Postures of arms, and what an arm goes through on its way to one.

use serde::{Deserialize, Serialize};

/// Angles of an arm's joints that have a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedPosture {
    pub name: String,
    /// From the base to the tip, rad (m of a slider); of a posture with points, those of the last.
    pub angles: Vec<f64>,
    /// What the arm goes through on its way there, the posture itself last; empty: it comes there as it likes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<PosturePoint>,
}

/// Where an arm is to be at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PosturePoint {
    /// Since it began, s.
    pub time: f64,
    /// From the base to the tip, rad (m of a slider).
    pub angles: Vec<f64>,
}
