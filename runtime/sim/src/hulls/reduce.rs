//! Hulls with fewer corners: those that lie farthest outside are taken first, so that little is left out.

use rapier3d::parry::{query::PointQuery, shape::Triangle, transformation::try_convex_hull};
use rapier3d::prelude::*;

/// The most corners of a hull.
const MOST_CORNERS: usize = 64;
/// With how many it begins: the outermost in directions that are spread evenly.
const FIRST_CORNERS: usize = 26;

/// At most [`MOST_CORNERS`] of a hull's corners, and how far the others lie outside of their hull, at most, m.
pub(super) fn reduced(corners: &[Vector]) -> (Vec<Vector>, f32) {
    if corners.len() <= MOST_CORNERS {
        return (corners.to_vec(), 0.0);
    }
    let mut taken: Vec<usize> = Vec::new();
    for direction in directions() {
        let along = |at: &usize| corners.get(*at).map_or(f32::MIN, |p| p.dot(direction));
        let outermost = (0..corners.len()).max_by(|a, b| along(a).total_cmp(&along(b)));
        taken.extend(outermost.filter(|at| !taken.contains(at)));
    }
    loop {
        let chosen: Vec<Vector> = taken.iter().filter_map(|at| corners.get(*at).copied()).collect();
        let Ok((points, faces)) = try_convex_hull(&chosen) else { return (corners.to_vec(), 0.0) };
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
            None => {
                let off = corners.iter().map(|p| outside(*p, &points, &faces)).fold(0.0, f32::max);
                return (chosen, off);
            }
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

/// How far a point lies outside of a hull, m; 0 within. The engine's own answer is off by centimetres where a point touches.
fn outside(p: Vector, points: &[Vector], faces: &[[u32; 3]]) -> f32 {
    if beyond(p, points, faces) <= 0.0 {
        return 0.0;
    }
    let point = |at: u32| points.get(at as usize).copied().unwrap_or(Vector::ZERO);
    let far = |face: &[u32; 3]| {
        let [a, b, c] = face.map(point);
        Triangle::new(a, b, c).distance_to_local_point(p, true)
    };
    faces.iter().map(far).fold(f32::MAX, f32::min)
}

/// The faces, edges and corners of a cube.
fn directions() -> impl Iterator<Item = Vector> {
    let side = |n: usize| n as f32 - 1.0;
    let all = (0..27).filter(|n| *n != 13).take(FIRST_CORNERS);
    all.map(move |n| Vector::new(side(n / 9), side(n / 3 % 3), side(n % 3)).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rapier3d::parry::query;

    fn round_bar() -> Vec<Vector> {
        let corner = |i: usize| {
            let angle = std::f32::consts::TAU * (i / 2) as f32 / 200.0;
            Vector::new(0.06 * libm::cosf(angle), 0.06 * libm::sinf(angle), (i % 2) as f32 * 0.1)
        };
        (0..400).map(corner).collect()
    }

    #[test]
    fn a_round_bar_loses_a_millimetre() {
        let (few, off) = reduced(&round_bar());
        assert_eq!(few.len(), MOST_CORNERS);
        assert!(off > 2e-4 && off < 1.5e-3, "{off}");
    }

    #[test]
    fn the_engine_measures_distances_between_hulls() {
        let (few, _) = reduced(&round_bar());
        let (points, faces) = try_convex_hull(&few).expect("a hull");
        let hull = SharedShape::convex_hull(&few).expect("a hull");
        let mut worst = 0.0f32;
        for i in 0..2000 {
            let along = |k: usize| ((i * k) as f32 * 0.618_034).fract() * 0.4 - 0.2;
            let place = Vector::new(along(1), along(3), along(7) + 0.05);
            let exact = (outside(place, &points, &faces) - 0.01).max(0.0);
            let ball = SharedShape::ball(0.01);
            let at = Pose::from_parts(place, Rotation::IDENTITY);
            let found = query::distance(&Pose::IDENTITY, &*hull, &at, &*ball).expect("a distance").distance;
            let cube = SharedShape::cuboid(0.01, 0.01, 0.01);
            let contact = query::contact(&Pose::IDENTITY, &*hull, &at, &*cube, 0.02).expect("an answer");
            let touches = contact.is_some_and(|c| c.dist <= 0.0);
            assert!(!touches || exact < 0.01, "{place} {exact}");
            worst = worst.max((found - exact).abs());
        }
        assert!(worst < 1e-3, "{worst}");
    }
}
