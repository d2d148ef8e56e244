//! Laser scanners: how far it is along each beam.

use std::f64::consts::TAU;

use hrdsl_ir::world::{Laser, World};

use crate::{
    error::SimulationError,
    math::{BodyFrame, RotationQuat, SpaceVector, v3},
    physics::{PhysicsAdapter, bad, index},
};

/// Checks that a scan can be made.
pub(crate) fn check(laser: &Laser, world: &World) -> Result<(), SimulationError> {
    let what = || format!("laser `{}`", laser.name);
    if index(laser.body) >= world.bodies.len() {
        return Err(bad(what(), "body", index(laser.body)));
    }
    let measures = [laser.lo, laser.hi, laser.nearest, laser.farthest];
    let finite = measures.iter().chain(&laser.at).all(|x| x.is_finite());
    if !finite || laser.lo > laser.hi || laser.nearest < 0.0 || laser.farthest <= 0.0 || laser.beams == 0 {
        return Err(SimulationError::BadNumber { what: format!("a measure of {}", what()) });
    }
    Ok(())
}

/// The distance along each beam, m: infinite where nothing is met up to the farthest that it measures, minus infinity where something
/// is nearer than the nearest (REP 117).
pub(crate) fn scan(laser: &Laser, physics: &PhysicsAdapter) -> Vec<f64> {
    match laser.beams.checked_sub(1) {
        Some(last) => ranges(laser, (0, last), physics),
        None => Vec::new(),
    }
}

/// The least of the distances along some of the beams, from one to another.
pub(crate) fn nearest(laser: &Laser, beams: (u16, u16), physics: &PhysicsAdapter) -> f64 {
    ranges(laser, beams, physics).into_iter().fold(f64::INFINITY, f64::min)
}

/// Those of some of the beams alone: the others are not cast.
fn ranges(laser: &Laser, (from, last): (u16, u16), physics: &PhysicsAdapter) -> Vec<f64> {
    let eye = physics.pose(laser.body).then(&BodyFrame::new(v3(laser.at), RotationQuat::identity()));
    let directions: Vec<SpaceVector> =
        (from..=last).map(|i| eye.turn * direction(laser.lo + f64::from(i) * laser.increment())).collect();
    let mut ranges = vec![f64::INFINITY; directions.len()];
    let (own, back) = (physics.root(laser.body), eye.inverse());
    for body in physics.solids().filter(|b| physics.root(*b) != own) {
        let (centre, radius) = physics.sphere_around(body);
        let ranger = physics.ranger(body);
        for beams in beams_near(laser, back.point(centre), radius).into_iter().flatten() {
            let [skipped, end] = [beams.0, beams.1].map(|beam| beam.saturating_sub(usize::from(from)));
            for (range, direction) in ranges.iter_mut().zip(&directions).take(end).skip(skipped) {
                let found = ranger(eye.at, *direction, range.min(laser.farthest));
                *range = found.unwrap_or(*range);
            }
        }
    }
    for range in &mut ranges {
        if *range < laser.nearest {
            *range = f64::NEG_INFINITY;
        }
    }
    ranges
}

fn direction(angle: f64) -> SpaceVector {
    SpaceVector::new(libm::cos(angle), libm::sin(angle), 0.0)
}

/// The beams that may meet a sphere in the laser's frame: from one up to, but not with, another. There are up to three such pieces,
/// since angles go round.
fn beams_near(laser: &Laser, centre: SpaceVector, radius: f64) -> [Option<(usize, usize)>; 3] {
    let away = (centre.x * centre.x + centre.y * centre.y).sqrt();
    if centre.z.abs() > radius || away - radius > laser.farthest {
        return [None; 3];
    }
    let count = usize::from(laser.beams);
    let step = laser.increment();
    if away <= radius || step <= 0.0 {
        return [Some((0, count)), None, None];
    }
    let (to, half) = (libm::atan2(centre.y, centre.x), libm::asin(radius / away));
    let to = laser.lo + (to - laser.lo).rem_euclid(TAU);
    // One beam more on either side makes good what rounding may cost.
    let place = |angle: f64| ((angle - laser.lo) / step).clamp(-2.0, count as f64 + 1.0);
    [-1.0, 0.0, 1.0].map(|turns| {
        let to = to + turns * TAU;
        let first = (place(to - half).floor() - 1.0).max(0.0) as usize;
        let end = ((place(to + half).ceil() + 2.0).max(0.0) as usize).min(count);
        (first < end).then_some((first, end))
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use hrdsl_ir::world::{Body, BodyId, BodyMotion, BodyShape, LaserId, SignalTerm};
    use proptest::prelude::*;

    use super::*;
    use crate::samples::{SECOND, body, built, cuboid, drive, flat};

    fn laser(beams: u16, lo: f64, hi: f64) -> Laser {
        let at = [0.0, 0.0, 0.1];
        Laser { name: "laser".into(), body: BodyId(1), at, lo, hi, beams, nearest: 0.1, farthest: 5.0 }
    }

    fn scanned(laser: Laser, more: Vec<Body>) -> Vec<f64> {
        let mut world = flat(more);
        world.lasers.push(laser);
        built(&world).scan(LaserId(0)).expect("a laser")
    }

    fn near(got: f64, want: f64) -> bool {
        (got - want).abs() < 1e-4
    }

    #[test]
    fn sees_a_box_where_it_is_and_neither_itself_nor_the_ground() {
        let box_ = body("box", BodyMotion::Fixed, cuboid(0.2, 0.2, 1.0), [0.0, 1.1, 0.5]);
        let ranges = scanned(laser(5, 0.0, PI), vec![box_]);
        assert!(near(ranges[2], 1.0), "{ranges:?}");
        for beam in [0, 1, 3, 4] {
            assert_eq!(ranges[beam], f64::INFINITY, "{ranges:?}");
        }
    }

    #[test]
    fn the_nearest_hides_what_is_behind_and_ghosts_hide_nothing() {
        let post = BodyShape::Cylinder { radius: 0.1, length: 1.0 };
        let mut ghost = body("ghost", BodyMotion::Fixed, cuboid(0.1, 1.0, 1.0), [0.5, 0.0, 0.5]);
        ghost.ghost = true;
        let wall = body("wall", BodyMotion::Fixed, cuboid(0.2, 6.0, 1.0), [3.1, 0.0, 0.5]);
        let post = body("post", BodyMotion::Fixed, post, [2.0, 0.0, 0.5]);
        let ranges = scanned(laser(3, -0.5, 0.5), vec![wall, ghost, post]);
        assert!(near(ranges[1], 1.9), "{ranges:?}");
        assert!(near(ranges[0], 3.0 / libm::cos(0.5)) && near(ranges[2], ranges[0]), "{ranges:?}");
    }

    #[test]
    fn what_is_too_far_is_not_seen_and_what_is_too_near_is_told_apart() {
        let wall = |name, x| body(name, BodyMotion::Fixed, cuboid(0.1, 1.0, 1.0), [x, 0.0, 0.5]);
        let mut wide = laser(2, 0.0, PI);
        wide.nearest = 0.5;
        let ranges = scanned(wide, vec![wall("far", 5.2), wall("close", -0.3)]);
        assert_eq!(ranges, [f64::INFINITY, f64::NEG_INFINITY]);
    }

    #[test]
    fn goes_along_with_its_base() {
        let wall = body("wall", BodyMotion::Fixed, cuboid(0.2, 9.0, 1.0), [3.1, 0.0, 0.5]);
        let mut world = flat(vec![wall]);
        world.lasers.push(laser(1, FRAC_PI_2, FRAC_PI_2));
        let mut sim = built(&world);
        assert_eq!(sim.scan(LaserId(0)), Some(vec![f64::INFINITY]));
        sim.command(drive(0.0, 0.0, -1.0)).expect("a base");
        // Until the beam to the left is the way that the base looked at first.
        sim.advance(2 * SECOND);
        let yaw = sim.base_pose(crate::samples::BASE).expect("a base")[2];
        let ranges = sim.scan(LaserId(0)).expect("a laser");
        assert!(near(ranges[0], 3.0 / libm::cos(FRAC_PI_2 + yaw)), "{ranges:?} at {yaw}");
    }

    #[test]
    fn the_nearest_of_some_beams_is_the_least_of_their_ranges() {
        let mut world = flat(vec![
            body("wall", BodyMotion::Fixed, cuboid(0.2, 9.0, 1.0), [3.1, 0.0, 0.5]),
            body(
                "post",
                BodyMotion::Fixed,
                BodyShape::Cylinder { radius: 0.1, length: 1.0 },
                [1.2, 1.2, 0.5],
            ),
        ]);
        world.lasers.push(laser(181, -FRAC_PI_2, FRAC_PI_2));
        let sim = built(&world);
        let ranges = sim.scan(LaserId(0)).expect("a laser");
        let laser = &world.lasers[0];
        let degrees = f64::to_radians;
        for (from, to, beams) in [(-90.0, 90.0, (0, 180)), (-30.0, 30.0, (60, 120)), (10.0, 10.0, (100, 100))]
        {
            let found = laser.beams_between(degrees(from), degrees(to)).expect("beams");
            assert_eq!(found, beams);
            let least =
                ranges[usize::from(beams.0)..=usize::from(beams.1)].iter().copied().fold(9.0, f64::min);
            let term = SignalTerm::Nearest { laser: LaserId(0), first: beams.0, last: beams.1 };
            assert_eq!(sim.measure(&term).as_f64(), Some(least), "{from} to {to}");
        }
        // The wall ahead, and the post to the left of it.
        let least = |from, to| {
            let (first, last) = laser.beams_between(degrees(from), degrees(to)).expect("beams");
            sim.measure(&SignalTerm::Nearest { laser: LaserId(0), first, last }).as_f64().expect("a number")
        };
        assert!(near(least(-30.0, 30.0), 3.0) && near(least(40.0, 50.0), f64::hypot(1.2, 1.2) - 0.1));
        assert_eq!(least(-90.0, -80.0), f64::INFINITY);
        assert_eq!(laser.beams_between(degrees(0.2), degrees(0.8)), None);
        assert_eq!(laser.beams_between(degrees(30.0), degrees(-30.0)), None);
    }

    proptest! {
        /// That only beams near a body are cast at it changes nothing.
        #[test]
        fn no_beam_is_left_out(
            x in -3.0..3.0, y in -3.0..3.0, radius in 0.05..1.0, lo in -7.0..6.0, wide in 0.0..TAU, beams in 1u16..80
        ) {
            prop_assume!(f64::hypot(x, y) > radius + 0.2);
            let laser = laser(beams, lo, lo + wide);
            let ball = body("ball", BodyMotion::Fixed, BodyShape::Sphere { radius }, [x, y, 0.25]);
            let ranges = scanned(laser.clone(), vec![ball]);
            for (beam, range) in (0u16..).zip(ranges) {
                let angle = laser.lo + f64::from(beam) * laser.increment();
                let along = x * libm::cos(angle) + y * libm::sin(angle);
                let beside = (y * libm::cos(angle) - x * libm::sin(angle)).abs();
                if along > 0.0 && beside < radius - 1e-3 {
                    let want = along - (radius * radius - beside * beside).sqrt();
                    prop_assert!((range - want).abs() < 1e-2, "beam {beam}: {range} for {want}");
                } else if along < 0.0 || beside > radius + 1e-3 {
                    prop_assert_eq!(range, f64::INFINITY);
                }
            }
        }
    }
}
