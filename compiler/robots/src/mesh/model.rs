//! A mesh: points, and triangles between them.

use std::fmt::Write;

use sha2::{Digest, Sha256};

use crate::space::transform::{RobotVector, cross, dot, minus};

/// Points in metres, and triangles as numbers of points, counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Each point once.
    pub vertices: Vec<RobotVector>,
    /// Each has an area.
    pub triangles: Vec<[u32; 3]>,
    /// Which axis the file says points up. The points are as drawn: the tools of ROS do not look at it, and robots are made so.
    pub up_axis: MeshAxis,
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshAxis {
    X,
    Y,
    /// Also of files that do not say.
    Z,
}

impl TriangleMesh {
    /// The corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> Option<[RobotVector; 3]> {
        let [a, b, c] = triangle.map(|at| self.vertices.get(at as usize).copied());
        Some([a?, b?, c?])
    }

    /// Each coordinate multiplied; a mirrored mesh is turned inside out again.
    #[must_use]
    pub fn scaled(&self, scale: RobotVector) -> Self {
        let [a, b, c] = scale;
        let vertices = self.vertices.iter().map(|[x, y, z]| [x * a, y * b, z * c]).collect();
        let mirrored = a * b * c < 0.0;
        let turned = |[i, j, k]: &[u32; 3]| if mirrored { [*i, *k, *j] } else { [*i, *j, *k] };
        Self { vertices, triangles: self.triangles.iter().map(turned).collect(), up_axis: self.up_axis }
    }

    /// Turned so that what the file calls up points along z.
    #[must_use]
    pub fn upright(&self) -> Self {
        let turn = |[x, y, z]: &RobotVector| match self.up_axis {
            MeshAxis::X => [-z, *y, *x],
            MeshAxis::Y => [*x, -z, *y],
            MeshAxis::Z => [*x, *y, *z],
        };
        Self {
            vertices: self.vertices.iter().map(turn).collect(),
            triangles: self.triangles.clone(),
            up_axis: MeshAxis::Z,
        }
    }

    /// The smallest and largest coordinates; `None` without points.
    #[must_use]
    pub fn bounds(&self) -> Option<(RobotVector, RobotVector)> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |([a, b, c], [d, e, f]), [x, y, z]| {
            ([a.min(*x), b.min(*y), c.min(*z)], [d.max(*x), e.max(*y), f.max(*z)])
        }))
    }

    /// The longest edge of the box around it, or 0.
    #[must_use]
    pub fn largest_extent(&self) -> f64 {
        self.bounds().map_or(0.0, |(low, high)| minus(high, low).into_iter().fold(0.0, f64::max))
    }

    /// The area of all triangles, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        let area = |[a, b, c]: [RobotVector; 3]| {
            let normal = cross(minus(b, a), minus(c, a));
            libm::sqrt(dot(normal, normal)) / 2.0
        };
        self.triangles.iter().filter_map(|triangle| self.corners(*triangle)).map(area).sum()
    }

    /// What it encloses, m³, if it is closed; negative if it is inside out.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let part = |[a, b, c]: [RobotVector; 3]| dot(a, cross(b, c)) / 6.0;
        self.triangles.iter().filter_map(|triangle| self.corners(*triangle)).map(part).sum()
    }

    /// A digest of points and triangles, the same wherever and whenever it is computed: the key of a cache.
    #[must_use]
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(b"hrdsl triangle mesh 1");
        hash.update((self.vertices.len() as u64).to_le_bytes());
        for coordinate in self.vertices.iter().flatten() {
            hash.update(coordinate.to_bits().to_le_bytes());
        }
        for corner in self.triangles.iter().flatten() {
            hash.update(corner.to_le_bytes());
        }
        hash.finalize().iter().fold(String::new(), |mut text, byte| {
            // Nothing fails that is written to a text.
            let _ = write!(text, "{byte:02x}");
            text
        })
    }
}
