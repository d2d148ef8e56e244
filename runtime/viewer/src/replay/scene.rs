//! The scene of a recording in the terms of documents.

use std::collections::BTreeMap;

use hrdsl_ir::{Program, solid::SolidMesh};
use hrdsl_recording::scene::{
    RecordedBody, RecordedBodyKind, RecordedLaser, RecordedPose, RecordedScene, RecordedShape, meshes,
};

use crate::{
    columns::FINE,
    document::{BodyKind, SharedAssets, ViewBody, ViewLaser, ViewMesh, ViewScene, ViewShape},
};

/// So many triangles a page has at most: beyond it, boxes stand for the largest meshes.
const MOST_TRIANGLES: usize = 60_000;

pub(super) fn scene(recorded: &RecordedScene) -> ViewScene {
    ViewScene {
        bodies: recorded.bodies.iter().map(body).collect(),
        lasers: recorded.lasers.iter().map(laser).collect(),
        meshes: BTreeMap::new(),
    }
}

fn body(body: &RecordedBody) -> ViewBody {
    ViewBody {
        name: body.name.clone(),
        actor: body.name.split_once('.').map(|(actor, _)| actor.to_owned()),
        kind: match body.kind {
            RecordedBodyKind::Robot => BodyKind::Robot,
            RecordedBodyKind::Person => BodyKind::Person,
            RecordedBodyKind::Thing => BodyKind::Thing,
            RecordedBodyKind::Room => BodyKind::Room,
        },
        shapes: body.shapes.iter().map(shape).collect(),
        pose: body.pose,
        ghost: body.ghost,
        color: None,
    }
}

fn shape(shape: &RecordedShape) -> ViewShape {
    match shape {
        RecordedShape::Box { size, pose } => ViewShape::Box { size: *size, pose: moved(pose) },
        RecordedShape::Sphere { radius, pose } => ViewShape::Sphere { radius: *radius, pose: moved(pose) },
        RecordedShape::Cylinder { radius, length, pose } => {
            ViewShape::Cylinder { radius: *radius, length: *length, pose: moved(pose) }
        }
        RecordedShape::Capsule { radius, length, pose } => {
            ViewShape::Capsule { radius: *radius, length: *length, pose: moved(pose) }
        }
        RecordedShape::Mesh { mesh, extent, pose, .. } => {
            ViewShape::Mesh { mesh: mesh.clone(), scale: None, extent: Some(*extent), pose: moved(pose) }
        }
    }
}

/// None where a shape is at the origin.
fn moved(pose: &RecordedPose) -> Option<RecordedPose> {
    (*pose != [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).then_some(*pose)
}

fn laser(laser: &RecordedLaser) -> ViewLaser {
    let [x, y, z] = laser.at;
    ViewLaser {
        name: laser.name.clone(),
        body: laser.body,
        pose: [x, y, z, 0.0, 0.0, 0.0, 1.0],
        angles: laser.angles,
        beams: u32::from(laser.beams),
        range: laser.range,
        scans: None,
    }
}

/// The meshes of a program that a page has once for all its runs, the small ones first; and how many are too large for it.
#[must_use]
pub fn mesh_assets(program: &Program) -> (SharedAssets, usize) {
    let all: BTreeMap<&str, &SolidMesh> =
        program.world.iter().flat_map(meshes).map(|mesh| (mesh.digest.as_str(), mesh)).collect();
    let mut by_size: Vec<&SolidMesh> = all.into_values().collect();
    by_size.sort_by_key(|mesh| mesh.triangles.len());
    let (mut assets, mut triangles, mut left_out) = (SharedAssets::default(), 0, 0);
    for mesh in by_size {
        triangles += mesh.triangles.len();
        if triangles > MOST_TRIANGLES {
            left_out += 1;
            continue;
        }
        let fine = |x: &f32| (f64::from(*x) * FINE).round() as i64;
        let points = mesh.points.iter().flatten().map(fine).collect();
        let triangles = mesh.triangles.iter().flatten().copied().collect();
        assets.meshes.insert(mesh.digest.clone(), ViewMesh { points, triangles });
    }
    (assets, left_out)
}
