//! Random worlds: whatever is in them, nothing explodes, everything stays a number, and each run is the same as the one before.
//!
//! `HRDSL_SOAK=1 cargo test --workspace --test random_worlds` tries a thousand of them; `HRDSL_WORLDS` says how many else.

mod common;

use common::{SECOND, body};
use hrdsl_ir::Expr;
use hrdsl_ir::world::*;
use hrdsl_sim::{MotorCommand, SimulationError, WorldSimulation};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// What is put into a world: a shape, where, how heavy, of which kind.
#[derive(Clone, Debug)]
struct Thing {
    shape: BodyShape,
    at: Vec3,
    turn: Vec3,
    mass: f64,
    kind: u8,
}

/// A chain of hinges on a post: directions, lengths, efforts.
#[derive(Clone, Debug)]
struct Chain {
    at: Vec3,
    links: Vec<(u8, f64, f64)>,
}

#[derive(Clone, Debug)]
struct Recipe {
    things: Vec<Thing>,
    chains: Vec<Chain>,
    base: Option<(bool, f64)>,
    goals: Vec<(Vec3, f64)>,
    moves: Vec<(usize, Vec3, f64)>,
}

fn shape() -> impl Strategy<Value = BodyShape> {
    let m = 0.03f64..0.5;
    prop_oneof![
        (m.clone(), m.clone(), m.clone()).prop_map(|(x, y, z)| BodyShape::Box { size: [x, y, z] }),
        (0.02f64..0.3).prop_map(|radius| BodyShape::Sphere { radius }),
        (0.02f64..0.2, m.clone()).prop_map(|(radius, length)| BodyShape::Capsule { radius, length }),
        (0.02f64..0.2, m).prop_map(|(radius, length)| BodyShape::Cylinder { radius, length }),
    ]
}

fn place(far: f64) -> impl Strategy<Value = Vec3> {
    (-far..far, -far..far, 0.4..2.5f64).prop_map(|(x, y, z)| [x, y, z])
}

fn recipe() -> impl Strategy<Value = Recipe> {
    let thing = (shape(), place(2.0), [-3.0f64..3.0, -3.0..3.0, -3.0..3.0], 0.05f64..80.0, 0u8..5)
        .prop_map(|(shape, at, turn, mass, kind)| Thing { shape, at, turn, mass, kind });
    let chain = (place(1.5), proptest::collection::vec((0u8..3, 0.1f64..0.4, 5.0f64..150.0), 1..5))
        .prop_map(|(at, links)| Chain { at, links });
    (
        proptest::collection::vec(thing, 0..10),
        proptest::collection::vec(chain, 0..3),
        proptest::option::of((any::<bool>(), 2.0f64..60.0)),
        proptest::collection::vec((place(2.0), 0.1f64..2.0), 1..6),
        proptest::collection::vec((0usize..10, place(2.0), 0.2f64..2.0), 0..4),
    )
        .prop_map(|(things, chains, base, goals, moves)| Recipe { things, chains, base, goals, moves })
}

/// Adds a chain, with a motor in each hinge, as an arm.
fn add_chain(world: &mut World, chain: &Chain) {
    let id = |world: &World| BodyId(u16::try_from(world.bodies.len() - 1).expect("few bodies"));
    let number = world.arms.len();
    world.bodies.push(body(
        &format!("post{number}"),
        BodyMotion::Fixed,
        BodyShape::Sphere { radius: 0.02 },
        chain.at,
        1.0,
    ));
    let (mut parent, mut at, mut joints) = (id(world), chain.at, Vec::new());
    for (i, (axis, length, effort)) in chain.links.iter().enumerate() {
        let shape = BodyShape::Capsule { radius: 0.02, length: length - 0.06 };
        let middle = [at[0] + length / 2.0, at[1], at[2]];
        let mut link = body(&format!("link{number}_{i}"), BodyMotion::Dynamic, shape, middle, 0.5 + length);
        link.rotation = [0.0, std::f64::consts::FRAC_PI_2, 0.0];
        world.bodies.push(link);
        let (child, name) = (id(world), format!("joint{number}_{i}"));
        let axis = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]][usize::from(*axis)];
        let drive = JointDrive { effort: Some(*effort), rotor: 0.05, ..JointDrive::default() };
        let (motion, anchor, lo, hi) = (JointMotion::Hinge, at, -2.0, 2.0);
        world.joints.push(Joint { name, parent, child, motion, anchor, axis, lo, hi, drive });
        joints.push(JointId(u16::try_from(world.joints.len() - 1).expect("few joints")));
        (parent, at) = (child, [at[0] + length, at[1], at[2]]);
    }
    let (name, tip, tool) = (format!("arm{number}"), parent, [0.0, 0.0, 0.05]);
    let (max_speed, contact_limit, avoids_people, postures) = (1.0, None, false, Vec::new());
    world.arms.push(Arm { name, joints, tip, tool, max_speed, contact_limit, avoids_people, postures });
}

fn world(recipe: &Recipe) -> World {
    let mut world = common::empty();
    world.bodies.push(body(
        "floor",
        BodyMotion::Fixed,
        common::cuboid(10.0, 10.0, 0.1),
        [0.0, 0.0, -0.05],
        1.0,
    ));
    for (i, thing) in recipe.things.iter().enumerate() {
        let motion = match thing.kind {
            0 => BodyMotion::Fixed,
            1 => BodyMotion::Kinematic,
            2 => BodyMotion::Guided,
            _ => BodyMotion::Dynamic,
        };
        let mut made = body(&format!("thing{i}"), motion, thing.shape, thing.at, thing.mass);
        made.rotation = thing.turn;
        made.stiffness = (motion == BodyMotion::Guided).then_some(50e3);
        world.bodies.push(made);
    }
    recipe.chains.iter().for_each(|chain| add_chain(&mut world, chain));
    if let Some((rolls, mass)) = recipe.base {
        let motion = if rolls { BodyMotion::Dynamic } else { BodyMotion::Kinematic };
        let shape = BodyShape::Cylinder { radius: 0.2, length: 0.2 };
        world.bodies.push(body("base", motion, shape, [0.0, 0.0, 0.1], mass));
        let body = BodyId(u16::try_from(world.bodies.len() - 1).expect("few bodies"));
        let (max_speed, max_sideways, max_turn, acceleration) = (1.0, 0.0, 2.0, 2.0);
        let (name, timeout) = ("base".into(), None);
        world.bases.push(Base { name, body, max_speed, max_sideways, max_turn, acceleration, timeout });
    }
    world
}

/// Everything that can be seen of a run, as bits; and whether a joint was torn in it.
fn run(recipe: &Recipe) -> Result<(Vec<u64>, bool), SimulationError> {
    let world = world(recipe);
    let mut sim = WorldSimulation::new(&world, &[])?;
    let mut seen = Vec::new();
    for (i, (goal, v)) in recipe.goals.iter().enumerate() {
        for arm in 0..world.arms.len() {
            let arm = ArmId(u16::try_from(arm).expect("few arms"));
            // Out of reach, or in the way of something: both are answers.
            let _ = sim.command(MotorCommand::ReachPoint { arm, target: *goal, max_speed: None });
        }
        if !world.bases.is_empty() {
            let (forward, sideways, turn) = (goal[0] / 2.0, 0.0, v - 1.0);
            sim.command(MotorCommand::DriveWheels { base: BaseId(0), forward, sideways, turn })
                .expect("a base");
        }
        if let Some((of, to, over)) = recipe.moves.get(i) {
            let at = 1 + of % recipe.things.len().max(1);
            let to = WorldPoint::free(None, to.map(Expr::float));
            let body = BodyId(u16::try_from(at).expect("few bodies"));
            let _ = sim.act(&WorldAction::Move { body, to, over: Expr::float(*over) }, &common::none);
        }
        sim.advance(sim.now() + SECOND);
        // What is led whatever is in its way, or is heavy and fast, may tear a joint, and that is told; nothing else may go wrong.
        assert!(sim.fault().is_none_or(|fault| fault.contains("` is torn")), "{:?} {recipe:?}", sim.fault());
        for at in 0..world.bodies.len() {
            let (place, turn) = sim.pose(BodyId(u16::try_from(at).expect("few bodies"))).expect("a body");
            for x in place.iter().chain(&turn) {
                assert!(x.is_finite(), "{recipe:?}");
                seen.push(x.to_bits());
            }
        }
    }
    Ok((seen, sim.fault().is_some()))
}

/// What is led whatever is in its way goes through a robot on a post, at 18 m/s: the robot is torn from its place, and comes back to it.
#[test]
fn what_tears_a_robot_apart_does_not_fling_it_off() {
    let ball = |radius, at, mass, kind| Thing {
        shape: BodyShape::Sphere { radius },
        at,
        turn: [0.0; 3],
        mass,
        kind,
    };
    // Motors that can lift it, however it hangs then.
    let chain = Chain { at: [0.0, -0.46, 1.5], links: vec![(0, 0.1, 15.0), (0, 0.1, 15.0), (0, 0.37, 15.0)] };
    let recipe = Recipe {
        things: vec![ball(0.216, [-1.08, -1.67, 1.76], 1.0, 1)],
        chains: vec![chain],
        base: None,
        goals: vec![([0.0, 0.0, 0.4], 0.1)],
        moves: vec![(0, [0.59, 0.0, 1.56], 0.2)],
    };
    let world = world(&recipe);
    let mut sim = WorldSimulation::new(&world, &[]).expect("a world");
    let to = WorldPoint::free(None, recipe.moves[0].1.map(Expr::float));
    let push = WorldAction::Move { body: BodyId(1), to, over: Expr::float(0.2) };
    sim.act(&push, &common::none).expect("kinematic");
    let end = BodyId(u16::try_from(world.bodies.len() - 1).expect("few bodies"));
    let start = sim.pose(end).expect("a link").0;
    let (mut fastest, mut farthest) = (0.0f64, 0.0f64);
    while sim.now() < 6 * SECOND {
        sim.advance(sim.now() + common::STEP);
        fastest = fastest.max(sim.measure(&SignalTerm::Speed(BodyRef::Body(end))).as_f64().expect("a speed"));
        farthest = farthest.max(common::distance(sim.pose(end).expect("a link").0, start));
    }
    let back = common::distance(sim.pose(end).expect("a link").0, start);
    println!("{fastest:.1} m/s, {farthest:.2} m off, {back:.3} m in the end");
    // And the run is at fault, by name.
    let fault = sim.fault().unwrap_or_default();
    assert!(
        fault.starts_with("the physics failed: joint `joint0_") && fault.contains("` is torn"),
        "{fault}"
    );
    assert!(farthest > 0.2 && fastest < 40.0 && back < 0.1, "{fastest} {farthest} {back}");
}

/// A thing of 59 kg rolls over a thin one, which it presses a centimetre into the floor. The solver gave it a quarter of a metre a second.
#[test]
fn a_heavy_thing_is_not_flung_off_a_thin_one() {
    let loose = |shape, at, turn, mass| Thing { shape, at, turn, mass, kind: 3 };
    let heavy = BodyShape::Capsule { radius: 0.199_633_978_354_406_74, length: 0.120_263_007_555_452_41 };
    let light = BodyShape::Sphere { radius: 0.103_638_130_801_312_26 };
    let thin = BodyShape::Cylinder { radius: 0.027_324_722_990_548_59, length: 0.223_082_719_555_731_83 };
    let recipe = Recipe {
        things: vec![
            loose(
                heavy,
                [-0.473_335_202_009_513_2, -1.585_586_302_026_359_4, 2.480_938_886_691_850_7],
                [1.427_838_051_403_080_2, -2.864_980_732_737_966_4, 0.914_141_382_371_560_6],
                59.421_693_325_629_185,
            ),
            loose(light, [0.0, -1.083_059_468_885_252_6, 1.795_149_414_986_319_9], [0.0; 3], 0.05),
            loose(
                thin,
                [-1.637_883_567_986_113_7, -0.782_127_733_399_054_2, 0.4],
                [1.845_888_991_678_018_3, 1.011_390_657_751_403_1, 2.635_523_882_017_503],
                6.938_826_410_317_842,
            ),
        ],
        chains: Vec::new(),
        base: None,
        goals: vec![([0.0, 0.0, 0.4], 0.1); 3],
        moves: Vec::new(),
    };
    assert!(!run(&recipe).expect("nothing starts inside of something").1);
}

#[test]
#[expect(clippy::disallowed_methods, reason = "how many worlds are tried is up to whoever runs the test")]
fn nothing_explodes_and_nothing_differs() {
    let usual = if std::env::var_os("HRDSL_SOAK").is_some() { 1000 } else { 300 };
    let cases = std::env::var("HRDSL_WORLDS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual);
    let mut runner = TestRunner::new_with_rng(
        Config { cases, failure_persistence: None, ..Config::default() },
        proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha),
    );
    let (refused, torn) = (std::cell::Cell::new(0), std::cell::Cell::new(0));
    let result = runner.run(&recipe(), |recipe| {
        match run(&recipe) {
            Ok((seen, is_torn)) => {
                torn.set(torn.get() + u32::from(is_torn));
                prop_assert_eq!(run(&recipe).expect("as before"), (seen, is_torn));
            }
            // Things that are drawn inside each other are an error that names them.
            Err(SimulationError::StartsInside { .. }) => refused.set(refused.get() + 1),
            Err(other) => prop_assert!(false, "{}", other),
        }
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{e}"));
    println!(
        "{cases} worlds, {} of them refused since things are inside each other; in {} a joint was torn",
        refused.get(),
        torn.get()
    );
    assert!(refused.get() * 2 < cases && torn.get() * 20 < cases);
}
