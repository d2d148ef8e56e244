//! Hulls with fewer corners: those that lie farthest outside are taken first, so that little is left out.

use rapier3d::parry::transformation::try_convex_hull;
use rapier3d::prelude::*;

/// The most corners of a hull.
const MOST_CORNERS: usize = 64;
/// With how many it begins: the outermost in directions that are spread evenly.
const FIRST_CORNERS: usize = 26;

/// At most [`MOST_CORNERS`] of a hull's corners.
pub(super) fn reduced(corners: &[Vector]) -> Vec<Vector> {
    if corners.len() <= MOST_CORNERS {
        return corners.to_vec();
    }
    let mut taken: Vec<usize> = Vec::new();
    for direction in directions() {
        let along = |at: &usize| corners.get(*at).map_or(f32::MIN, |p| p.dot(direction));
        let outermost = (0..corners.len()).max_by(|a, b| along(a).total_cmp(&along(b)));
        taken.extend(outermost.filter(|at| !taken.contains(at)));
    }
    loop {
        let chosen: Vec<Vector> = taken.iter().filter_map(|at| corners.get(*at).copied()).collect();
        let Ok((points, faces)) = try_convex_hull(&chosen) else { return corners.to_vec() };
        let off = |(at, p): (usize, &Vector)| (at, beyond(*p, &points, &faces));
        let farthest = corners
            .iter()
            .enumerate()
            .map(off)
            .filter(|(at, off)| *off > 0.0 && !taken.contains(at))
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
            .map(|(at, _)| at);
        match farthest.filter(|_| taken.len() < MOST_CORNERS) {
            Some(at) => taken.push(at),
            None => return chosen,
        }
    }
}

/// How far a point lies above the face that it is farthest above, m; negative within.
fn beyond(p: Vector, points: &[Vector], faces: &[[u32; 3]]) -> f32 {
    let point = |at: u32| points.get(at as usize).copied().unwrap_or(Vector::ZERO);
    let over = |face: &[u32; 3]| {
        let [a, b, c] = face.map(point);
        let normal = (b - a).cross(c - a);
        let length = normal.length();
        if length > 0.0 { (p - a).dot(normal) / length } else { f32::MIN }
    };
    faces.iter().map(over).fold(f32::MIN, f32::max)
}

/// The faces, edges and corners of a cube.
fn directions() -> impl Iterator<Item = Vector> {
    let side = |n: usize| n as f32 - 1.0;
    let all = (0..27).filter(|n| *n != 13).take(FIRST_CORNERS);
    all.map(move |n| Vector::new(side(n / 9), side(n / 3 % 3), side(n % 3)).normalize())
}
