//! The same calls give the same bits, in whatever pieces time is advanced; and rest costs nothing.

mod common;
use common::*;
use hrdsl_ir::Expr;
use hrdsl_ir::Nanos;
use hrdsl_ir::world::*;
use hrdsl_sim::{MotorCommand, WorldSimulation};
use proptest::prelude::*;

/// Everything that can be seen of a world, to the bit.
fn bits(sim: &WorldSimulation, world: &World) -> Vec<u64> {
    let mut bits = Vec::new();
    for i in 0..world.bodies.len() {
        let (p, q) = sim.pose(BodyId(i as u16)).unwrap();
        bits.extend(p.iter().chain(&q).map(|x| x.to_bits()));
    }
    bits.extend(sim.joint_positions(ARM).iter().map(|x| x.to_bits()));
    bits.push(float(sim, 0).to_bits());
    bits.push(sim.next_wake().map_or(u64::MAX, |t| t as u64));
    bits
}

/// Runs a fixed script, advancing to each of its times in pieces of the given lengths; what is seen after each part.
fn script(pieces: &[Nanos]) -> Vec<Vec<u64>> {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[number("speed", SignalTerm::JointSpeed(ARM))]).unwrap();
    let hand = named(&world, "person.hand");
    let reach = WorldAction::Move { body: hand, to: at(None, [0.5, 0.1, 0.7]), over: Expr::float(1.5) };
    let mut seen = Vec::new();
    let mut pieces = pieces.iter().cycle();
    let mut until = |sim: &mut WorldSimulation, time: Nanos| {
        while sim.now() < time {
            let piece = pieces.next().copied().unwrap_or(time);
            sim.advance((sim.now() + piece).min(time));
        }
        seen.push(bits(sim, &world));
    };
    until(&mut sim, 7_123_456_789);
    sim.command(move_to(LEGS[0])).unwrap();
    until(&mut sim, 12_000_000_000);
    sim.command(MotorCommand::CloseFingers { gripper: GRIP }).unwrap();
    until(&mut sim, 13_003_000_000);
    sim.command(move_to(OFFER)).unwrap();
    sim.act(&reach, &none).unwrap();
    until(&mut sim, 15_001_234_567);
    sim.act(&WorldAction::Grasp { gripper: GRASP }, &none).unwrap();
    until(&mut sim, 25_000_000_000);
    sim.command(MotorCommand::OpenFingers { gripper: GRIP }).unwrap();
    until(&mut sim, 40_000_000_000);
    seen
}

#[test]
fn two_runs_give_the_same_bits() {
    assert_eq!(script(&[SECOND]), script(&[SECOND]));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_pieces_do_not_matter(pieces in proptest::collection::vec(1_000_000i64..3_000_000_000, 1..8)) {
        prop_assert_eq!(script(&pieces), script(&[100 * SECOND]));
    }
}

#[test]
fn the_world_comes_to_rest_and_wakes() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[number("speed", SignalTerm::JointSpeed(ARM))]).unwrap();
    assert_eq!(sim.next_wake(), Some(STEP));
    settle(&mut sim);
    assert!(sim.now() < 2 * SECOND, "legs that stand need little time: {}", sim.now());
    let still = bits(&sim, &world);
    sim.advance(1_000_000 * SECOND);
    assert_eq!(sim.now(), 1_000_000 * SECOND);
    assert_eq!((sim.next_wake(), bits(&sim, &world)), (None, still));
    sim.command(move_to(OFFER)).unwrap();
    assert_eq!(sim.next_wake(), Some(1_000_000 * SECOND + STEP));
    let before = sim.tool(ARM).unwrap();
    sim.advance(sim.now() + 2 * SECOND);
    assert!(distance(before, sim.tool(ARM).unwrap()) > 0.02);
    settle(&mut sim);
    assert!(distance(OFFER, sim.tool(ARM).unwrap()) < 0.005);
    assert_eq!(float(&sim, 0), 0.0, "at rest nothing moves");
}

#[test]
fn rest_waits_for_what_is_under_way() {
    let world = table();
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    settle(&mut sim);
    let id = sim.command(MotorCommand::CloseFingers { gripper: GRIP }).unwrap();
    let (time, result) = wait(&mut sim, id, |_| {});
    assert!(result.is_ok() && (0.4..=0.51).contains(&time), "{time}");
    settle(&mut sim);
    let slow = WorldAction::Move {
        body: named(&world, "person.hand"),
        to: at(None, [1.0, 0.2, 0.9001]),
        over: Expr::float(30.0),
    };
    let start = sim.now();
    sim.act(&slow, &none).unwrap();
    settle(&mut sim);
    assert!(sim.now() - start >= 30 * SECOND);
}

#[test]
fn what_falls_where_there_is_no_floor_does_not_fall_for_ever() {
    let mut world = table();
    let at = named(&world, "leg1").0 as usize;
    world.bodies[at].position = [2.0, 2.0, 0.5];
    let floor = named(&world, "floor").0 as usize;
    world.bodies[floor].ghost = true;
    let mut sim = WorldSimulation::new(&world, &[]).unwrap();
    settle(&mut sim);
    assert!(sim.now() < 5 * SECOND);
    assert!(sim.pose(BodyId(at as u16)).unwrap().0[2] < -19.0);
}
