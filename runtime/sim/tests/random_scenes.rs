//! Random scenes: people, robots, doors and things of the library, wherever chance puts them and whatever it has them do. Nothing
//! explodes, everything stays a number, joints stay whole, and each run is the same as the one before.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test random_scenes` tries a thousand of them; `HRDSL_WORLDS` says how many else.

mod common;
#[path = "common/scene.rs"]
mod scene;

use common::SECOND;
use hrdsl_ir::world::{ArmId, BaseId, BodyId, GripperId, Vec3, World};
use hrdsl_sim::MotorCommand;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use scene::Scene;

/// Cells of 1.4 m, three by three: whoever goes somewhere meets others.
const CELLS: usize = 9;

/// What stands in a cell.
#[derive(Clone, Copy, Debug)]
enum Piece {
    Adult(u8),
    Child(u8),
    Bert2,
    Tiago,
    Turtlebot,
    Door,
    Drawer,
    Wall,
    /// So many boxes on each other, of so many kg each.
    Stack(u8, f64),
    /// A ball of so many kg that falls from above.
    Ball(f64),
    /// A box that slides on a rail, and one that is geared to it.
    Geared(f64),
}

/// What a person, or a robot, does in a second.
#[derive(Clone, Debug)]
struct Deed {
    kind: u8,
    to: Vec3,
    pace: f64,
}

#[derive(Clone, Debug)]
struct Recipe {
    /// Each in its cell, turned by so many degrees.
    pieces: Vec<(Piece, f64)>,
    cells: Vec<usize>,
    /// By second, and by piece.
    deeds: Vec<Vec<Deed>>,
}

fn piece() -> impl Strategy<Value = Piece> {
    prop_oneof![
        3 => (150u8..195).prop_map(Piece::Adult),
        1 => (90u8..140).prop_map(Piece::Child),
        1 => Just(Piece::Bert2),
        1 => Just(Piece::Tiago),
        1 => Just(Piece::Turtlebot),
        1 => Just(Piece::Door),
        1 => Just(Piece::Drawer),
        1 => Just(Piece::Wall),
        2 => (1u8..5, 0.1f64..30.0).prop_map(|(n, mass)| Piece::Stack(n, mass)),
        1 => (0.1f64..40.0).prop_map(Piece::Ball),
        1 => (0.5f64..2.0).prop_map(Piece::Geared),
    ]
}

fn deed() -> impl Strategy<Value = Deed> {
    (0u8..6, [-2.0f64..2.0, -2.0..2.0, 0.2..1.8], 0.2f64..2.0).prop_map(|(kind, to, pace)| Deed {
        kind,
        to,
        pace,
    })
}

fn recipe() -> impl Strategy<Value = Recipe> {
    proptest::collection::vec((piece(), -180.0f64..180.0), 2..9).prop_flat_map(|pieces| {
        let n = pieces.len();
        let cells = proptest::sample::subsequence((0..CELLS).collect::<Vec<_>>(), n).prop_shuffle();
        let deeds = proptest::collection::vec(proptest::collection::vec(deed(), n), 3..8);
        (Just(pieces), cells, deeds).prop_map(|(pieces, cells, deeds)| Recipe { pieces, cells, deeds })
    })
}

/// The middle of a cell, m.
fn middle(cell: usize) -> (f64, f64) {
    (1.4 * (cell % 3) as f64 - 1.4, 1.4 * (cell / 3) as f64 - 1.4)
}

/// What stands in the world for a piece, as text.
fn members(i: usize, piece: Piece, (x, y): (f64, f64), turn: f64) -> String {
    let at = format!("at ({x:.3} m, {y:.3} m, 0 m) rotated (0 deg, 0 deg, {turn:.2} deg)");
    match piece {
        Piece::Adult(height) => format!("part p{i} = adult({height} cm) {at}\n"),
        Piece::Child(height) => format!("part p{i} = child({height} cm) {at}\n"),
        Piece::Bert2 => format!("part p{i} = bert2 {at}\n"),
        Piece::Tiago => format!("part p{i} = tiago {at}\n"),
        Piece::Turtlebot => format!("part p{i} = turtlebot {at}\n"),
        Piece::Door => format!("part p{i} = door(90 cm, 2 m) {at}\n"),
        Piece::Drawer => format!("part p{i} = drawer(50 cm, 90 cm) {at}\n"),
        Piece::Wall => format!(
            "body p{i}: fixed box(1.6 m, 10 cm, 1 m) at ({x:.3} m, {y:.3} m, 50 cm) rotated (0 deg, 0 deg, {turn:.2} deg)\n"
        ),
        Piece::Stack(n, mass) => (0..n)
            .map(|k| {
                let z = 10.0 + 20.2 * f64::from(k);
                format!("body p{i}_{k}: dynamic box(30 cm, 30 cm, 20 cm) at ({x:.3} m, {y:.3} m, {z:.1} cm) mass {mass:.3} kg\n")
            })
            .collect(),
        Piece::Ball(mass) => {
            format!("body p{i}: dynamic sphere(15 cm) at ({x:.3} m, {y:.3} m, 2 m) mass {mass:.3} kg\n")
        }
        Piece::Geared(ratio) => geared(i, (x, y), ratio),
    }
}

/// A slide that a weight draws down, and a second one that goes as far, times `ratio`.
fn geared(i: usize, (x, y): (f64, f64), ratio: f64) -> String {
    let (left, right) = (y - 0.25, y + 0.25);
    format!(
        "body p{i}: fixed box(10 cm, 60 cm, 5 cm) at ({x:.3} m, {y:.3} m, 1.6 m)\n\
         body a{i}: dynamic box(10 cm, 20 cm, 10 cm) at ({x:.3} m, {left:.3} m, 1.2 m) mass 2 kg\n\
         body b{i}: dynamic box(10 cm, 20 cm, 10 cm) at ({x:.3} m, {right:.3} m, 1.2 m) mass 1 kg\n\
         joint s{i}: p{i} -> a{i} at ({x:.3} m, {left:.3} m, 1.2 m) axis (0, 0, 1) limits -30 cm .. 30 cm damping 5 Ns/m\n\
         joint t{i}: p{i} -> b{i} at ({x:.3} m, {right:.3} m, 1.2 m) axis (0, 0, 1) limits -70 cm .. 70 cm mimic s{i} times {ratio:.2}\n"
    )
}

/// What `someone` makes of a person in a second, as the actions of a stimulus.
fn action(i: usize, deed: &Deed) -> String {
    let [x, y, z] = deed.to;
    let (walk, time) = (format!("({x:.3} m, {y:.3} m, 0 m)"), 200.0 + 1000.0 * deed.pace);
    match deed.kind {
        0 | 1 => format!("p{i}.walk_to({walk}, {:.2} m/s)", deed.pace),
        2 => format!("p{i}.turn_to({walk})"),
        3 => format!("p{i}.hand.move_to(({x:.3} m, {y:.3} m, {z:.3} m), {time:.0} ms)"),
        4 => format!("p{i}.head.move_to(({x:.3} m, {y:.3} m, {z:.3} m), {time:.0} ms)"),
        _ => format!("p{i}.grasp.grasp()"),
    }
}

fn is_person(piece: Piece) -> bool {
    matches!(piece, Piece::Adult(_) | Piece::Child(_))
}

fn built(recipe: &Recipe) -> Scene {
    let mut text = String::from("body floor: fixed box(14 m, 14 m, 10 cm) at (0 m, 0 m, -5 cm)\n");
    for (i, (piece, turn)) in recipe.pieces.iter().enumerate() {
        text += &members(i, *piece, middle(recipe.cells[i]), *turn);
    }
    let mut stimuli = Vec::new();
    for (second, deeds) in recipe.deeds.iter().enumerate() {
        for (i, deed) in deeds.iter().enumerate().filter(|(i, _)| is_person(recipe.pieces[*i].0)) {
            stimuli.push((format!("deed_{second}_{i}"), action(i, deed)));
        }
    }
    let stimuli: Vec<(&str, &str)> = stimuli.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    Scene::with(
        "use std.furniture\nuse std.robots.bert2\nuse std.robots.tiago\nuse std.robots.mobile",
        &text,
        &stimuli,
    )
}

/// What every robot is told at the beginning of a second: that something cannot be done is an answer.
fn command(scene: &mut Scene, world: &World, deeds: &[Deed]) {
    let id = |n: usize| u16::try_from(n).expect("few devices");
    for arm in 0..world.arms.len() {
        let deed = &deeds[arm % deeds.len()];
        let arm = ArmId(id(arm));
        let _ = match deed.kind {
            0..=3 => scene.sim.command(MotorCommand::ReachPoint { arm, target: deed.to, max_speed: None }),
            4 => scene.sim.command(MotorCommand::StopJoints { arm }),
            _ => scene.sim.command(MotorCommand::AimJoint { arm, joint: 1.0, to: deed.pace }),
        };
    }
    for gripper in 0..world.grippers.len() {
        let gripper = GripperId(id(gripper));
        let close = deeds[usize::from(gripper.0) % deeds.len()].kind.is_multiple_of(2);
        let _ = scene.sim.command(if close {
            MotorCommand::CloseFingers { gripper }
        } else {
            MotorCommand::OpenFingers { gripper }
        });
    }
    for base in 0..world.bases.len() {
        let deed = &deeds[base % deeds.len()];
        let (forward, turn) = (deed.pace * deed.to[0].signum(), deed.to[1] / 2.0);
        let wheels = MotorCommand::DriveWheels { base: BaseId(id(base)), forward, sideways: 0.0, turn };
        let _ = scene.sim.command(wheels);
    }
}

/// How a run went: everything that can be seen of it, as bits; and how much its joints and contacts gave way.
#[derive(Debug, PartialEq)]
struct SceneRun {
    seen: Vec<u64>,
    torn: bool,
    gap: f64,
    beyond: f64,
    sunk: f64,
}

fn run(recipe: &Recipe) -> SceneRun {
    let mut scene = built(recipe);
    let world = scene.program.world.clone().expect("a world");
    let mut seen = Vec::new();
    for (second, deeds) in recipe.deeds.iter().enumerate() {
        for i in (0..recipe.pieces.len()).filter(|i| is_person(recipe.pieces[*i].0)) {
            scene.act(&format!("deed_{second}_{i}"));
        }
        command(&mut scene, &world, deeds);
        scene.sim.advance(scene.sim.now() + SECOND);
        let fault = scene.sim.fault();
        assert!(fault.is_none_or(|fault| fault.contains("` is torn")), "{fault:?} {recipe:?}");
        for at in 0..world.bodies.len() {
            let (place, turn) =
                scene.sim.pose(BodyId(u16::try_from(at).expect("few bodies"))).expect("a body");
            for x in place.iter().chain(&turn) {
                assert!(x.is_finite(), "{recipe:?}");
                seen.push(x.to_bits());
            }
        }
    }
    let found = scene.sim.accuracy();
    SceneRun {
        seen,
        torn: scene.sim.fault().is_some(),
        gap: found.joint_gap.map_or(0.0, |(gap, _)| gap),
        beyond: found.beyond_limit.map_or(0.0, |(beyond, _)| beyond),
        sunk: found.penetration.map_or(0.0, |(deep, ..)| deep),
    }
}

#[test]
#[expect(clippy::disallowed_methods, reason = "how many scenes are tried is up to whoever runs the test")]
fn scenes_hold_together_and_repeat() {
    let usual = if std::env::var_os("HRDSL_SOAK").is_some() { 1000 } else { 30 };
    let cases = std::env::var("HRDSL_WORLDS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual);
    let rng = proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha);
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 0, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, rng);
    let runs = std::cell::RefCell::new(Vec::new());
    let result = runner.run(&recipe(), |recipe| {
        let first = run(&recipe);
        prop_assert_eq!(&run(&recipe), &first);
        if first.gap > 0.02 || first.sunk > 0.05 || first.torn {
            println!(
                "{:.1} mm apart, {:.1} mm deep, torn: {} {recipe:?}",
                first.gap * 1e3,
                first.sunk * 1e3,
                first.torn
            );
        }
        runs.borrow_mut().push(first);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{e}"));
    let runs = runs.into_inner();
    let torn = runs.iter().filter(|run| run.torn).count();
    let worst = |of: fn(&SceneRun) -> f64| runs.iter().filter(|run| !run.torn).map(of).fold(0.0, f64::max);
    println!(
        "{cases} scenes: in {torn} a joint was torn; else joints are at most {:.1} mm apart and {:.1} mrad or mm beyond their limits, bodies {:.1} mm in each other",
        worst(|run| run.gap) * 1e3,
        worst(|run| run.beyond) * 1e3,
        worst(|run| run.sunk) * 1e3
    );
    assert!(worst(|run| run.beyond) < 1e-3);
    assert!(torn * 100 < runs.len() && worst(|run| run.gap) < 0.05 && worst(|run| run.sunk) < 0.01);
}
