//! Places, and the simple shapes of bodies.

use serde::{Deserialize, Serialize};

pub type Vec3 = [f64; 3];

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyShape {
    /// Full edge lengths.
    Box {
        size: Vec3,
    },
    Sphere {
        radius: f64,
    },
    /// Along z; length without the caps.
    Capsule {
        radius: f64,
        length: f64,
    },
    /// Along z.
    Cylinder {
        radius: f64,
        length: f64,
    },
}
