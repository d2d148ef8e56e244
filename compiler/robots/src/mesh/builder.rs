//! Triangles put together: equal points become one, and what has no area is left out.

use rustc_hash::FxHashMap;

use super::model::{MeshAxis, TriangleMesh};
use crate::{
    limits::MOST_TRIANGLES,
    space::transform::{RobotVector, cross, minus},
};

#[derive(Default)]
pub(super) struct MeshBuilder {
    vertices: Vec<RobotVector>,
    triangles: Vec<[u32; 3]>,
    /// By their bits; never walked through.
    numbers: FxHashMap<[u64; 3], u32>,
}

impl MeshBuilder {
    /// Adds a triangle by its corners.
    pub fn triangle(&mut self, corners: [RobotVector; 3]) -> Result<(), String> {
        if self.triangles.len() >= MOST_TRIANGLES {
            return Err(format!("it has more than {MOST_TRIANGLES} triangles"));
        }
        if corners.iter().flatten().any(|coordinate| !coordinate.is_finite()) {
            return Err("a coordinate is not finite".to_owned());
        }
        let [a, b, c] = corners;
        let normal = cross(minus(b, a), minus(c, a));
        if normal.iter().all(|part| *part == 0.0) {
            return Ok(());
        }
        let triangle = corners.map(|corner| self.vertex(corner));
        self.triangles.push(triangle);
        Ok(())
    }

    /// Adds a convex polygon, as a fan from its first corner.
    pub fn polygon(&mut self, corners: &[RobotVector]) -> Result<(), String> {
        let Some((first, rest)) = corners.split_first() else { return Ok(()) };
        for pair in rest.windows(2) {
            if let [b, c] = pair {
                self.triangle([*first, *b, *c])?;
            }
        }
        Ok(())
    }

    fn vertex(&mut self, point: RobotVector) -> u32 {
        // -0 becomes 0, so that equal points have equal bits.
        let point = point.map(|coordinate| coordinate + 0.0);
        let next = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        let number = *self.numbers.entry(point.map(f64::to_bits)).or_insert(next);
        if number == next {
            self.vertices.push(point);
        }
        number
    }

    pub fn finish(self, up_axis: MeshAxis) -> TriangleMesh {
        TriangleMesh { vertices: self.vertices, triangles: self.triangles, up_axis }
    }
}
