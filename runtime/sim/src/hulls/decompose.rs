//! A mesh in convex pieces: one, if it nearly is convex; otherwise those of V-HACD (Mamou, Lengyel and Peters 2016).

use hrdsl_ir::solid::SolidMesh;
use rapier3d::parry::transformation::{
    try_convex_hull,
    vhacd::{VHACD, VHACDParameters},
    voxelization::FillMode,
};
use rapier3d::prelude::*;

use super::{ConvexPiece, MeshHulls, reduce::reduced};

/// A mesh fills its hull but for this part: then the hull takes its place.
const NEARLY_CONVEX: f32 = 0.05;
/// Into how many cells the longest side of a mesh is divided.
const CELLS: u32 = 64;
/// How far from convex a piece may be, as a part of the volume of the mesh.
const CONCAVITY: f32 = 0.01;
/// The most pieces of one mesh.
const MOST_PIECES: u32 = 12;
/// The least thickness of what takes the place of a flat mesh, m.
const THIN: f32 = 1e-3;

/// What the result depends on besides the mesh; part of the key under which it is kept.
pub(super) const PARAMETERS: &str = "hulls-1-0.05-64-0.01-12-64";

pub(super) fn decompose(mesh: &SolidMesh) -> MeshHulls {
    let points: Vec<Vector> = mesh.points.iter().map(|[x, y, z]| Vector::new(*x, *y, *z)).collect();
    let whole = try_convex_hull(&points).ok().filter(|(corners, faces)| volume(corners, faces) > 0.0);
    let Some((corners, faces)) = whole else { return flat(&points) };
    let (filled, hull) = (volume(&points, &mesh.triangles).abs(), volume(&corners, &faces).abs());
    let parts = if hull - filled < NEARLY_CONVEX * hull && filled < 1.01 * hull {
        vec![corners]
    } else {
        pieces(&points, &mesh.triangles, corners)
    };
    let (mut pieces, mut error) = (Vec::new(), 0.0f32);
    for part in parts {
        let (corners, off) = reduced(&part);
        if let Some(piece) = ConvexPiece::new(corners) {
            error = error.max(off);
            pieces.push(piece);
        }
    }
    if pieces.is_empty() { flat(&points) } else { MeshHulls { pieces, error } }
}

/// The corners of the hull of each piece; those of the whole, if there is none.
fn pieces(points: &[Vector], triangles: &[[u32; 3]], whole: Vec<Vector>) -> Vec<Vec<Vector>> {
    let parameters = VHACDParameters {
        concavity: CONCAVITY,
        resolution: CELLS,
        max_convex_hulls: MOST_PIECES,
        fill_mode: FillMode::FloodFill { detect_cavities: false },
        ..VHACDParameters::default()
    };
    let found = VHACD::decompose(&parameters, points, triangles, true);
    let surfaces = found.compute_primitive_intersections(points, triangles);
    let hull = |points: &Vec<Vector>| try_convex_hull(points).ok().map(|(corners, _)| corners);
    let hulls: Vec<Vec<Vector>> = surfaces.iter().filter_map(hull).collect();
    if hulls.is_empty() { vec![whole] } else { hulls }
}

/// What triangles enclose, m³.
fn volume(points: &[Vector], triangles: &[[u32; 3]]) -> f32 {
    let point = |at: u32| points.get(at as usize).copied().unwrap_or(Vector::ZERO);
    // In double precision: small parts of large sums.
    let part = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|at| point(at).as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(part).sum::<f64>() as f32
}

/// A flat mesh is a thin box.
fn flat(points: &[Vector]) -> MeshHulls {
    let first = points.first().copied().unwrap_or(Vector::ZERO);
    let low = points.iter().fold(first, |low, p| low.min(*p));
    let high = points.iter().fold(first, |high, p| high.max(*p));
    let (middle, half) = ((low + high) / 2.0, ((high - low) / 2.0).max(Vector::splat(THIN / 2.0)));
    let corner = |i: u8| {
        let side = |bit: u8| if i & bit == 0 { -1.0 } else { 1.0 };
        middle + half * Vector::new(side(1), side(2), side(4))
    };
    let pieces = ConvexPiece::new((0..8).map(corner).collect()).into_iter().collect();
    MeshHulls { pieces, error: 0.0 }
}
