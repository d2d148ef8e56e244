//! How much what is judged depends on the physics step: the same four scenes at 10, 5, 2.5 and 1.25 ms. It is what the default of 10 ms,
//! and how often the solver divides it, rest on: `cargo test -p hrdsl-sim --test convergence -- --nocapture` prints the table.

mod common;
#[path = "common/scene.rs"]
mod scene;

use common::*;
use hrdsl_ir::Nanos;
use hrdsl_ir::world::*;
use hrdsl_sim::{MotorCommand, WorldSimulation};
use scene::Scene;

/// ns
const STEPS: [Nanos; 4] = [10_000_000, 5_000_000, 2_500_000, 1_250_000];

/// What is measured of a scene at one step: by name, in the unit that it is told in.
type Measures = Vec<(&'static str, f64)>;

/// Of each measure: how much it may change from one step to the finest.
type Tolerances = [f64];

/// Measures a scene at each step, prints it, and holds it to what it is at the finest.
fn converges(scene: &str, tolerances: &Tolerances, measure: impl Fn(Nanos) -> Measures) {
    let found: Vec<Measures> = STEPS.iter().map(|step| measure(*step)).collect();
    let finest = found.last().expect("steps");
    for (step, measures) in STEPS.iter().zip(&found) {
        let told: Vec<String> = measures.iter().map(|(name, x)| format!("{name} {x:.4}")).collect();
        println!("{scene} at {:.2} ms: {}", *step as f64 / 1e6, told.join(", "));
        for (((name, x), (_, best)), tolerance) in measures.iter().zip(finest).zip(tolerances) {
            assert!(
                (x - best).abs() <= *tolerance,
                "{scene} at {step} ns: {name} {x}, and {best} at the finest"
            );
        }
    }
}

fn advance(sim: &mut WorldSimulation, step: Nanos, until: Nanos, mut each: impl FnMut(&WorldSimulation)) {
    while sim.now() < until {
        sim.advance(sim.now() + step);
        each(sim);
    }
}

/// A leg is taken from its stand and held out.
#[test]
fn a_leg_that_is_held_out() {
    converges("hand-over", &[0.05, 1.0, 0.2, 1e-3, 0.1], |step| {
        let mut world = table();
        world.step = step;
        let speed = number("speed", SignalTerm::JointSpeed(ARM));
        let mut sim = WorldSimulation::new(&world, &[speed]).expect("a world");
        let mut fastest = 0.0f64;
        let mut go = |sim: &mut WorldSimulation, command: MotorCommand| {
            let id = sim.command(command).expect("it can");
            loop {
                sim.advance(sim.now() + step);
                fastest = fastest.max(float(sim, 0));
                if let Some((_, result)) = sim.finished().into_iter().find(|(ended, _)| *ended == id) {
                    result.expect("it does");
                    break;
                }
                assert!(sim.now() < 300 * SECOND, "it does not end");
            }
        };
        let [x, y, z] = LEGS[0];
        go(&mut sim, move_to([x, y, z]));
        go(&mut sim, MotorCommand::CloseFingers { gripper: GRIP });
        go(&mut sim, move_to([x, y, z + 0.15]));
        go(&mut sim, move_to(OFFER));
        let arrived = sim.now();
        let until = arrived + 2 * SECOND;
        advance(&mut sim, step, until, |_| {});
        let leg = sim.pose(named(&world, "leg1")).expect("a leg").0;
        let accuracy = sim.accuracy();
        vec![
            ("time s", arrived as f64 / 1e9),
            ("leg off mm", 1e3 * distance(leg, OFFER)),
            ("leg height mm", 1e3 * (leg[2] - OFFER[2])),
            ("fastest joint rad/s", fastest),
            ("self-penetration mm", 1e3 * accuracy.self_penetration.map_or(0.0, |p| p.0)),
        ]
    });
}

/// A base drives at a box, shoves it, and stops.
#[test]
fn a_box_that_is_shoved() {
    converges("base", &[3.0, 6.0, 0.1], |step| {
        let members = "body floor: fixed box(20 m, 20 m, 10 cm) at (0 m, 0 m, -5 cm)
            body chassis: dynamic box(40 cm, 40 cm, 20 cm) at (0 m, 0 m, 10 cm) mass 20 kg
            body parcel: dynamic box(30 cm, 30 cm, 30 cm) at (80 cm, 0 m, 15 cm) mass 3 kg
            base wheels: chassis speed 1 m/s turn 2 rad/s acceleration 1 m/s^2";
        let scene = Scene::new(members, &[]);
        let mut world = scene.program.world.clone().expect("a world");
        world.step = step;
        let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
        let drive =
            |forward| MotorCommand::DriveWheels { base: BaseId(0), forward, sideways: 0.0, turn: 0.0 };
        sim.command(drive(0.4)).expect("a base");
        advance(&mut sim, step, 4 * SECOND, |_| {});
        sim.command(drive(0.0)).expect("a base");
        advance(&mut sim, step, 7 * SECOND, |_| {});
        let at = |name| sim.pose(named(&world, name)).expect("a body").0;
        vec![
            ("base cm", 1e2 * at("chassis")[0]),
            ("box cm", 1e2 * at("parcel")[0]),
            ("box height mm", 1e3 * at("parcel")[2]),
        ]
    });
}

/// How far a ram must push a mast of 10 kg, whose foot is 30 cm wide, so that it topples: as far at every step.
#[test]
fn a_mast_that_topples() {
    let topples = |far: f64, step: Nanos| {
        let members = "body floor: fixed box(20 m, 20 m, 10 cm) at (0 m, 0 m, -5 cm)
            body mast: dynamic box(30 cm, 30 cm, 1.2 m) at (0 m, 0 m, 60 cm) mass 10 kg
            body ram: kinematic box(10 cm, 20 cm, 20 cm) at (-40 cm, 0 m, 1 m)";
        let scene = Scene::new(members, &[]);
        let mut world = scene.program.world.clone().expect("a world");
        world.step = step;
        let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
        let ram = named(&world, "ram");
        // Where the two faces meet, and so far on.
        let to = at(None, [-0.2 + far, 0.0, 1.0]);
        let action = WorldAction::Move { body: ram, to, over: hrdsl_ir::Expr::float(1.0) };
        sim.act(&action, &none).expect("kinematic");
        advance(&mut sim, step, 4 * SECOND, |_| {});
        sim.pose(named(&world, "mast")).expect("a mast").0[2] < 0.5
    };
    let mut found = Vec::new();
    for step in STEPS {
        let least = (0..40).map(|i| f64::from(i) * 0.02).find(|far| topples(*far, step));
        println!("mast at {:.2} ms: topples from a push of {least:?} m", step as f64 / 1e6);
        found.push(least.expect("it topples"));
    }
    let finest = *found.last().expect("steps");
    assert!(found.iter().all(|far| (far - finest).abs() < 0.041), "{found:?}");
}
