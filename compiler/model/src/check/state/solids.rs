//! Links as solids: their shapes, and how their mass is spread.

use std::collections::BTreeMap;

use hrdsl_ir::{
    solid::{PlacedSolid, SharedData, SolidBody, SolidGeometry, SolidMass, SolidMesh},
    world::Vec3,
};
use hrdsl_robots::{RobotReading, TriangleMesh, UrdfGeometry, UrdfInertial, UrdfLink, UrdfMesh, UrdfShape};

use crate::BodyShape;

/// Makes solids; a mesh that several links have is there once.
#[derive(Default)]
pub(crate) struct SolidMaker {
    /// By digest.
    meshes: BTreeMap<String, SharedData<SolidMesh>>,
}

impl SolidMaker {
    /// A link as a solid, and a sphere about its origin that has all of it.
    pub fn solid(&mut self, link: &UrdfLink, reading: &RobotReading) -> (SolidBody, BodyShape) {
        let shapes: Vec<PlacedSolid> =
            link.collisions.iter().filter_map(|shape| self.placed(shape, reading)).collect();
        let reach = shapes.iter().map(reach).fold(0.0, f64::max);
        let mass = link.inertial.as_ref().filter(|inertial| inertial.mass > 0.0).map(mass_of);
        let solid = SolidBody { shapes, mass, exempt: Vec::new(), origin: link.place.span };
        (solid, BodyShape::Sphere { radius: reach.max(1e-3) })
    }

    fn placed(&mut self, shape: &UrdfShape, reading: &RobotReading) -> Option<PlacedSolid> {
        let plain = |shape| Some(SolidGeometry::Plain(shape));
        let geometry = match &shape.geometry {
            UrdfGeometry::Box { size } => plain(BodyShape::Box { size: *size }),
            UrdfGeometry::Cylinder { radius, length } => {
                plain(BodyShape::Cylinder { radius: *radius, length: *length })
            }
            UrdfGeometry::Sphere { radius } => plain(BodyShape::Sphere { radius: *radius }),
            UrdfGeometry::Capsule { radius, length } => {
                plain(BodyShape::Capsule { radius: *radius, length: *length })
            }
            UrdfGeometry::Mesh(mesh) => self.mesh(mesh, reading).map(SolidGeometry::Mesh),
        };
        let (position, rotation) = (shape.origin.xyz, shape.origin.rpy);
        geometry.map(|geometry| PlacedSolid { position, rotation, geometry })
    }

    fn mesh(&mut self, mesh: &UrdfMesh, reading: &RobotReading) -> Option<SharedData<SolidMesh>> {
        let read: &TriangleMesh = reading.meshes.get(mesh.path.as_ref()?)?;
        let scaled = read.scaled(mesh.scale);
        let digest = scaled.digest();
        let made = self.meshes.entry(digest.clone()).or_insert_with(|| {
            let single = |point: &Vec3| point.map(|x| x as f32);
            let points = scaled.vertices.iter().map(single).collect();
            SharedData::new(SolidMesh { digest, points, triangles: scaled.triangles.clone() })
        });
        Some(made.clone())
    }
}

/// How far a shape reaches from the origin of its body, m.
fn reach(shape: &PlacedSolid) -> f64 {
    let length = |v: Vec3| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let own = match &shape.geometry {
        SolidGeometry::Plain(BodyShape::Box { size }) => length(*size) / 2.0,
        SolidGeometry::Plain(BodyShape::Sphere { radius }) => *radius,
        SolidGeometry::Plain(BodyShape::Capsule { radius, length }) => radius + length / 2.0,
        SolidGeometry::Plain(BodyShape::Cylinder { radius, length: l }) => length([*radius, l / 2.0, 0.0]),
        SolidGeometry::Mesh(mesh) => {
            mesh.points.iter().map(|point| length(point.map(f64::from))).fold(0.0, f64::max)
        }
    };
    length(shape.position) + own
}

/// The tensor is turned into the frame of the link.
fn mass_of(inertial: &UrdfInertial) -> SolidMass {
    let turn = inertial.origin.transform().rotation;
    let i = inertial.inertia;
    let own = [[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]];
    let times = |a: [Vec3; 3], b: [Vec3; 3]| a.map(|row| column_sums(row, b));
    let [[a, b, c], [d, e, f], [g, h, k]] = turn;
    let inertia = times(times(turn, own), [[a, d, g], [b, e, h], [c, f, k]]);
    SolidMass { mass: inertial.mass, centre: inertial.origin.xyz, inertia }
}

fn column_sums([x, y, z]: Vec3, [[a, b, c], [d, e, f], [g, h, i]]: [Vec3; 3]) -> Vec3 {
    [x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i]
}
