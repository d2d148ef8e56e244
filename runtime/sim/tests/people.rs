//! People: what a blow comes to, and what it does to them; how they walk, reach and fall.

mod common;

use common::{SECOND, body};
use hrdsl_ir::world::*;
use hrdsl_ir::{Expr, Nanos, Span};
use hrdsl_sim::WorldSimulation;

/// An empty world on a floor.
fn floor(step: Nanos) -> World {
    let mut world = common::table();
    world.step = step;
    world.origin = Span::default();
    world.bodies.truncate(1);
    world.joints.clear();
    world.arms.clear();
    world.grippers.clear();
    world.currents.clear();
    world
}

fn sphere(radius: f64) -> BodyShape {
    BodyShape::Sphere { radius }
}

/// A body region of ISO/TS 15066 (N/m, kg) under a ball that falls on it: the greatest force, and how fast the ball was.
fn blow(stiffness: f64, region: f64, ball: f64, drop: f64, step: Nanos) -> (f64, f64) {
    let mut world = floor(step);
    let mut head = body("head", BodyMotion::Guided, sphere(0.1), [0.0, 0.0, 1.0], region);
    head.stiffness = Some(stiffness);
    world.bodies.push(head);
    let high = 1.0 + 0.1 + 0.05 + drop;
    world.bodies.push(body("ball", BodyMotion::Dynamic, sphere(0.05), [0.0, 0.0, high], ball));
    let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
    let press = SignalTerm::Pressed {
        body: BodyRef::Body(BodyId(1)),
        by: Some(BodyRef::Body(BodyId(2))),
        phase: ContactPhase::Transient,
    };
    // Only the first blow: the ball comes back.
    let (mut most, mut over) = (0.0f64, false);
    while !over {
        sim.advance(sim.now() + step);
        let force = sim.measure(&press).as_f64().expect("a force");
        over = most > 0.0 && force == 0.0;
        most = most.max(force);
        assert!(sim.now() < SECOND, "the ball does not come");
    }
    (most, (2.0 * 9.81 * drop).sqrt())
}

/// ISO/TS 15066:2016, Annex A, table A.3: hand, head, chest, thigh.
const REGIONS: [(&str, f64, f64); 4] =
    [("hand", 75e3, 0.6), ("head", 75e3, 4.4), ("chest", 25e3, 40.0), ("thigh", 50e3, 75.0)];

#[test]
fn a_blow_is_that_of_the_two_mass_formula_at_every_step() {
    for (name, stiffness, region) in REGIONS {
        for ball in [0.3, 2.0, 12.0] {
            for drop in [0.01, 0.05] {
                for step in [10_000_000, 5_000_000, 2_000_000, 1_000_000] {
                    let (most, speed) = blow(stiffness, region, ball, drop, step);
                    // The weight of the ball goes on pressing while it is braked.
                    let expected = common::two_masses(ball, region, stiffness, speed, 9.81 * ball);
                    let off = most / expected - 1.0;
                    println!(
                        "{name} {ball} kg {speed:.2} m/s {step}: {most:.1} N, by the formula {expected:.1} N, {off:+.3}"
                    );
                    assert!(off.abs() < 0.05, "{name} {ball} {drop} {step}: {most} for {expected}");
                }
            }
        }
    }
}

#[test]
fn standing_costs_no_steps() {
    let mut world = floor(10_000_000);
    let mut head = body("head", BodyMotion::Guided, sphere(0.1), [0.0, 0.0, 1.0], 4.4);
    head.stiffness = Some(75e3);
    world.bodies.push(head);
    let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
    common::settle(&mut sim);
    assert!(sim.now() < SECOND);
    let (at, _) = sim.pose(BodyId(1)).expect("a head");
    assert_eq!(at, [0.0, 0.0, 1.0]);
    let to = WorldPoint::free(None, [1.0, 0.5, 1.2].map(Expr::float));
    sim.act(&WorldAction::Move { body: BodyId(1), to, over: Expr::float(1.0) }, &common::none)
        .expect("guided");
    let mut worst = 0.0f64;
    let start = sim.now();
    while sim.now() < start + 2 * SECOND {
        sim.advance(sim.now() + 10_000_000);
        let (at, _) = sim.pose(BodyId(1)).expect("a head");
        let off = (at[1] - at[0] / 2.0).abs();
        worst = worst.max(off);
    }
    let (at, _) = sim.pose(BodyId(1)).expect("a head");
    assert!(worst < 1e-5 && common::distance(at, [1.0, 0.5, 1.2]) < 1e-5, "{worst} {at:?}");
}
