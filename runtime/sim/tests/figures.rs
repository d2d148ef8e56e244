//! People of `std.person`: how they walk, look, reach, bow, give way and fall.

#[path = "common/scene.rs"]
mod scene;

use hrdsl_ir::world::ArmId;
use hrdsl_sim::MotorCommand;
use proptest::prelude::*;
use scene::Scene;

const FLOOR: &str = "body floor: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)";

fn alone(more: &str, stimuli: &[(&str, &str)]) -> Scene {
    let members = format!(
        "{FLOOR}\npart host = adult(172 cm) at (1 m, 0 m, 0 m) rotated (0 deg, 0 deg, 180 deg)\n{more}"
    );
    Scene::new(&members, stimuli)
}

fn far(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

const BODIES: [&str; 13] = [
    "head",
    "trunk",
    "pelvis",
    "upper_arm",
    "forearm",
    "hand",
    "left_upper_arm",
    "left_forearm",
    "left_hand",
    "thigh",
    "lower_leg",
    "left_thigh",
    "left_lower_leg",
];

fn bodies(scene: &Scene) -> Vec<[f64; 3]> {
    BODIES.iter().map(|b| scene.at(&format!("host.{b}"))).collect()
}

#[test]
fn who_stands_stays_as_drawn() {
    let mut scene = alone("", &[]);
    let drawn = bodies(&scene);
    scene.go_on(3.0, |_| {});
    for ((name, a), b) in BODIES.iter().zip(&drawn).zip(bodies(&scene)) {
        assert!(far(*a, b) < 1e-5, "{name}: {a:?} {b:?}");
    }
    assert_eq!(scene.sim.next_wake(), None, "the world rests");
}

#[test]
fn a_walk_is_as_fast_as_stated_and_ends_where_it_should() {
    let walk = "host.walk_to((-1 m, 0 m, 0 m), (-1 m, 2 m, 0 m), 1.2 m/s)";
    let mut scene = alone("signal pace: speed to robot = speed(host.pelvis)", &[("walk", walk)]);
    let drawn = bodies(&scene);
    scene.act("walk");
    let mut fastest = 0.0f64;
    scene.go_on(6.0, |s| fastest = fastest.max(s.read("pace")));
    let pelvis = scene.at("host.pelvis");
    assert!(far(pelvis, [-1.0, 2.0, drawn[2][2]]) < 2e-3, "{pelvis:?}");
    assert!((1.19..1.25).contains(&fastest), "{fastest}");
    // It looks along y now; the hand is as far ahead as before.
    let hand = scene.at("host.hand");
    assert!(
        (hand[1] - pelvis[1] - 0.344).abs() < 0.01 && (hand[0] - pelvis[0] - 0.2227).abs() < 0.01,
        "{hand:?}"
    );
    assert_eq!(scene.sim.next_wake(), None, "the world rests");
}

#[test]
fn who_looks_closely_bows_with_the_whole_body() {
    let cup = "body cup: fixed box(4 cm, 4 cm, 4 cm) at (0 m, 0 m, 80 cm)
        signal far: length to robot = range(host.head, cup)
        signal off: angle to robot = angle(host.head, cup)";
    let mut scene = alone(cup, &[("look", "host.head.look_at(cup, 10 cm, 55 cm, 20 deg)")]);
    scene.act("look");
    scene.go_on(3.0, |_| {});
    assert!((scene.read("far") - 0.55).abs() < 1e-3, "{}", scene.read("far"));
    assert!((scene.read("off") - 0.349).abs() < 2e-3, "{}", scene.read("off"));
    // The trunk leans, the feet are under the pelvis, on the ground.
    let (head, trunk, pelvis) = (scene.at("host.head"), scene.at("host.trunk"), scene.at("host.pelvis"));
    assert!(
        head[2] < 1.25 && trunk[2] < 1.1 && head[0] < trunk[0] && trunk[0] < pelvis[0],
        "{head:?} {trunk:?} {pelvis:?}"
    );
    let feet = scene.at("host.lower_leg");
    assert!((0.1..0.4).contains(&feet[2]), "{feet:?}");
    assert_eq!(scene.sim.next_wake(), None, "the world rests");
}

#[test]
fn a_hand_goes_as_far_as_the_arm_does() {
    let mut scene = alone(
        "",
        &[
            ("near", "host.hand.move_to((60 cm, 20 cm, 1.1 m), 1 s)"),
            ("look", "host.head.look_at(floor, 0 cm, 1 m, 0 deg)"),
            ("far_off", "host.hand.move_to((-2 m, 0 m, 1 m), 1 s)"),
        ],
    );
    scene.act("near");
    scene.go_on(2.0, |_| {});
    assert!(far(scene.at("host.hand"), [0.6, 0.2, 1.1]) < 1e-4, "{:?}", scene.at("host.hand"));
    // Who looks at something does not walk off to reach something else.
    scene.act("look");
    scene.go_on(3.0, |_| {});
    let before = scene.at("host.pelvis");
    scene.act("far_off");
    scene.go_on(3.0, |_| {});
    assert!(far(scene.at("host.pelvis"), before) < 1e-3);
    let arm = 1.72 * (0.17 + 0.2);
    let reach = far(scene.at("host.hand"), scene.at("host.trunk"));
    assert!(reach < arm + 0.35 && reach > arm - 0.35, "{reach} {arm}");
}

#[test]
fn who_reaches_for_what_is_far_off_walks_up_to_it_and_bows() {
    for (x, y, z) in [(-1.5, 0.5, 0.5), (-1.0, -2.0, 1.2), (3.0, 1.0, 0.2)] {
        let reach = format!("host.hand.move_to(({x} m, {y} m, {z} m), 1 s)");
        let mut scene = alone("", &[("reach", &reach)]);
        scene.act("reach");
        scene.go_on(8.0, |_| {});
        let hand = scene.at("host.hand");
        assert!(far(hand, [x, y, z]) < 5e-3, "{hand:?} {:?}", [x, y, z]);
        assert_eq!(scene.sim.next_wake(), None, "the world rests");
    }
}

#[test]
fn who_walks_into_a_table_stops_there() {
    let table = "body table: fixed box(80 cm, 2 m, 80 cm) at (-50 cm, 0 m, 40 cm)
        signal gap: length to robot = distance(host.pelvis, table)";
    let mut scene = alone(table, &[("walk", "host.walk_to((-2 m, 0 m, 0 m), 1.2 m/s)")]);
    scene.act("walk");
    scene.go_on(6.0, |_| {});
    let pelvis = scene.at("host.pelvis");
    assert!((-0.1..0.2).contains(&pelvis[0]), "{pelvis:?}");
}

/// A heavy ball on a slider is not needed: a kinematic wall comes as fast as it is told to.
fn pushed(way: f64, time: f64) -> Scene {
    let members = "body ram: kinematic box(20 cm, 40 cm, 30 cm) at (0 m, 0 m, 118 cm)
        signal most: force to robot = transient_force(host.trunk) + quasistatic_force(host.trunk)
        signal lying: angle to robot = tilt(host.trunk)";
    let push = format!("ram.move_to(({way} m, 0 m, 118 cm), {time} s)");
    let mut scene = alone(members, &[("push", &push)]);
    scene.act("push");
    scene
}

#[test]
fn a_light_push_is_stood_and_a_harder_one_stepped_back_from() {
    // The trunk's front is at 0.888 m, the ram's face 10 cm ahead of its middle: 1 cm deep.
    let mut scene = pushed(0.798, 2.0);
    let mut most = 0.0f64;
    scene.go_on(4.0, |s| most = most.max(s.read("most")));
    let pelvis = scene.at("host.pelvis");
    assert!(most > 1.0 && (pelvis[0] - 1.0).abs() < 0.05, "{most} {pelvis:?}");
    let mut scene = pushed(1.1, 2.0);
    scene.go_on(6.0, |_| {});
    let pelvis = scene.at("host.pelvis");
    assert!(pelvis[0] > 1.2, "{pelvis:?}");
    assert!(scene.read("lying") < 0.2, "{}", scene.read("lying"));
}

#[test]
fn who_is_struck_hard_falls_for_good() {
    let mut scene = pushed(3.0, 1.0);
    scene.go_on(6.0, |_| {});
    assert!(scene.read("lying") > 1.0, "{}", scene.read("lying"));
    let head = scene.at("host.head");
    assert!(head[2] < 0.4, "{head:?}");
    // Its bodies still hang together: 21 cm apart, and the hand trailed as much as 10 cm behind as it fell.
    let (hand, forearm) = (scene.at("host.hand"), scene.at("host.forearm"));
    assert!(far(hand, forearm) < 0.31, "{hand:?} {forearm:?}");
    // It has come to rest.
    scene.go_on(2.0, |_| {});
    assert!(far(scene.at("host.head"), head) < 1e-3 && far(scene.at("host.hand"), hand) < 1e-3, "{head:?}");
}

#[test]
fn who_is_clamped_is_pressed_and_not_struck() {
    let wall = "body wall: fixed box(20 cm, 4 m, 2 m) at (1.22 m, 0 m, 1 m)
        body ram: kinematic box(20 cm, 40 cm, 30 cm) at (0 m, 0 m, 118 cm)
        signal blow: force to robot = transient_force(host.trunk)
        signal wall_force: force to robot = force(host.trunk, wall)
        signal press: force to robot = quasistatic_force(host.trunk)";
    let mut scene = alone(wall, &[("push", "ram.move_to((80 cm, 0 m, 118 cm), 2 s)")]);
    scene.act("push");
    // It strikes first; the trunk goes the 8 mm to the wall, and is held there.
    let (mut struck, mut held, mut most) = (None, None, 0.0f64);
    scene.go_on(4.0, |s| {
        if s.read("blow") > 0.0 {
            struck.get_or_insert(s.sim.now());
        }
        if s.read("press") > 50.0 {
            held.get_or_insert(s.sim.now());
        }
        // Bones and the wall are rigid: the moment in which they meet is a blow of one step.
        if held.is_some_and(|held| s.sim.now() > held + 100_000_000) {
            most = most.max(s.read("wall_force"));
        }
    });
    let (struck, held) = (struck.expect("a blow"), held.expect("a press"));
    assert!(held - struck < 300_000_000, "{struck} {held}");
    // 3.6 mm of 25 N/mm, and the wall bears no more than that.
    let press = scene.read("press");
    assert!((80.0..100.0).contains(&press) && most < 200.0, "{press} {most}");
}

/// A ram of 8 kg on a slider strikes somebody who stands with the back to a wall, or freely: what is measured, and of which kind it is,
/// is the same at every step.
#[test]
fn clamped_or_free_a_blow_is_the_same_at_every_step() {
    for (wall, gap) in [("touches", 1.1116), ("is near", 1.1216), ("is far", 3.0)] {
        let mut found: Vec<[f64; 2]> = Vec::new();
        for step in [10_000_000, 5_000_000, 2_000_000, 1_000_000] {
            let members = format!(
                "body wall: fixed box(20 cm, 4 m, 2 m) at ({gap} m + 10 cm, 0 m, 1 m)
                body rail: fixed box(10 cm, 10 cm, 10 cm) at (0 m, 0 m, 118 cm)
                body ram: dynamic box(20 cm, 12 cm, 20 cm) at (50 cm, 0 m, 118 cm) mass 8 kg
                joint slide: rail -> ram at (50 cm, 0 m, 118 cm) axis (1, 0, 0) limits -10 cm .. 60 cm effort 200 N
                arm pusher: slide tip ram tool (10 cm, 0 m, 0 m) speed 0.5 rad/s
                signal blow: force to robot = transient_force(host.trunk)
                signal press: force to robot = quasistatic_force(host.trunk)"
            );
            let mut scene = alone(&members, &[]);
            scene.at_step(step);
            let push = MotorCommand::ReachJoints { arm: ArmId(0), positions: vec![0.4], max_speed: None };
            scene.sim.command(push).expect("an arm");
            let (mut blow, mut press) = (0.0f64, 0.0f64);
            let mut begins = None;
            scene.go_on(3.0, |s| {
                let (struck, pressed) = (s.read("blow"), s.read("press"));
                if struck + pressed > 0.0 {
                    begins.get_or_insert(s.sim.now());
                }
                // The blow, and not how the arm pushes on after it.
                if begins.is_none_or(|at| s.sim.now() < at + 400_000_000) {
                    (blow, press) = (blow.max(struck), press.max(pressed));
                }
            });
            println!("wall {wall}, {step}: {blow:.0} N, {press:.0} N");
            found.push([blow, press]);
        }
        // The lesser of the two is within a tenth of the greater one.
        let finest = *found.last().expect("steps");
        let greatest = finest[0].max(finest[1]);
        for of in &found {
            for (one, best) in of.iter().zip(&finest) {
                assert!((one - best).abs() <= 0.1 * greatest, "wall {wall}: {found:?}");
            }
        }
        match wall {
            "touches" => assert!(finest[0] == 0.0 && finest[1] > 150.0, "{found:?}"),
            "is near" => assert!(finest[0] > 150.0 && finest[1] > 30.0, "{found:?}"),
            _ => assert!(finest[0] > 150.0 && finest[1] == 0.0, "{found:?}"),
        }
    }
}

#[test]
fn who_takes_a_leg_bows_and_reaches_for_it() {
    let members = "part host = adult(172 cm) at (1.4 m, 17 cm, 0 m) rotated (0 deg, 0 deg, 180 deg)
       body leg: dynamic box(4 cm, 4 cm, 25 cm) at (48 cm, 17 cm, 110 cm) mass 500 g graspable
       body stand: fixed box(4 cm, 4 cm, 97.5 cm) at (48 cm, 17 cm, 48.75 cm)
       signal off: length to robot = abs(host.head.y - leg.y)
       signal far: length to robot = range(host.head, leg)
       signal angle_off: angle to robot = angle(host.head, leg)
       signal seen: bool to robot = visible(host.head, leg)
       signal gap: length to robot = distance(host.hand, leg)
       signal grip: bool to robot = holds(host.grasp, leg)";
    let mut scene = Scene::new(
        &format!("{FLOOR}\n{members}"),
        &[
            ("ask", "host.walk_to((1.3 m, 20 cm, 0 m), 1 m/s)"),
            ("look", "host.head.look_at(leg, -15 cm, 55 cm, 30 deg)"),
            ("reach", "host.hand.move_to(leg + (5 cm, -10 cm, -5 cm), 800 ms)"),
            ("grip", "host.grasp.grasp()"),
        ],
    );
    for (what, time) in [("ask", 5.0), ("look", 1.0), ("reach", 1.6)] {
        scene.act(what);
        scene.go_on(time, |_| {});
    }
    assert!((scene.read("off") - 0.15).abs() < 1e-3 && (scene.read("far") - 0.55).abs() < 1e-3);
    assert!(
        (scene.read("angle_off") - std::f64::consts::FRAC_PI_6).abs() < 5e-3 && scene.read("seen") == 1.0
    );
    assert!(scene.read("gap") > 0.03 && scene.read("grip") == 0.0, "{}", scene.read("gap"));
    // The hand goes on to what it takes hold of: nobody holds across air.
    scene.act("grip");
    scene.go_on(1.0, |_| {});
    assert!(scene.read("gap") < 5e-3 && scene.read("grip") == 1.0, "{}", scene.read("gap"));
}

/// A hand that was sent exactly to where it is at rest is one of the figure's own again, as any other: it walks on.
#[test]
fn who_has_reached_for_something_can_walk_off() {
    let cup = "body cup: fixed box(4 cm, 4 cm, 4 cm) at (0 m, 0 m, 80 cm)";
    let stimuli = [
        ("look", "host.head.look_at(cup, 10 cm, 55 cm, 20 deg)"),
        ("reach", "host.hand.move_to((-20 cm, 0 m, 80 cm), 1 s)"),
        ("up", "host.hand.move_to(host.trunk + (-20 cm, 0 m, 20 cm), 1 s)"),
        ("walk", "host.walk_to((2 m, 1 m, 0 m), 1.2 m/s)"),
    ];
    for before in [&["look"][..], &["reach"], &["reach", "up"], &["look", "reach", "up"]] {
        let mut scene = alone(cup, &stimuli);
        for stimulus in before {
            scene.act(stimulus);
            scene.go_on(6.5, |_| {});
        }
        scene.act("walk");
        scene.go_on(6.0, |_| {});
        let pelvis = scene.at("host.pelvis");
        assert!((pelvis[0] - 2.0).abs() < 0.01 && (pelvis[1] - 1.0).abs() < 0.01, "{before:?} {pelvis:?}");
    }
}

/// What is stated of a person's motions: it walks at no more than its speed, 1.4 m/s, and no hand is faster than 2 m/s beside its trunk. The hip
/// and the trunk move as it bows, too.
const SPEEDS: [(&str, f64); 5] =
    [("pelvis", 2.6), ("head", 3.4), ("trunk", 2.6), ("hand", 5.0), ("left_hand", 5.0)];

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn nobody_moves_faster_than_people_do(
        acts in proptest::collection::vec((0usize..7, 0.1f64..4.0), 2..9),
    ) {
        let cups = "body cup: fixed box(4 cm, 4 cm, 4 cm) at (0 m, 0 m, 60 cm)
            body can: fixed box(4 cm, 4 cm, 4 cm) at (2 m, -1.5 m, 1.1 m)";
        let pace = |(body, _): &(&str, f64)| format!("\nsignal v_{body}: speed to robot = speed(host.{body})");
        let signals: String = SPEEDS.iter().map(pace).collect();
        let stimuli = [
            ("a", "host.walk_to((-1 m, 1 m, 0 m), 1.4 m/s)"),
            ("b", "host.walk_to((2 m, -1 m, 0 m), (1 m, 0 m, 0 m), 1 m/s)"),
            ("c", "host.turn_to((2 m, 2 m, 0 m))"),
            ("d", "host.head.look_at(cup, 10 cm, 55 cm, 20 deg)"),
            ("e", "host.head.look_at(can, -20 cm, 70 cm, 40 deg)"),
            ("f", "host.hand.move_to((0 m, 0 m, 60 cm), 800 ms)"),
            ("g", "host.hand.move_to((2 m, -1 m, 1.4 m), 500 ms)"),
        ];
        let mut scene = alone(&format!("{cups}{signals}"), &stimuli);
        for (which, time) in &acts {
            scene.act(stimuli[*which].0);
            let mut fastest = [0.0f64; SPEEDS.len()];
            let mut jolt = 0.0f64;
            let mut before = scene.read("v_hand");
            scene.go_on(*time, |s| {
                for ((body, _), fastest) in SPEEDS.iter().zip(&mut fastest) {
                    *fastest = fastest.max(s.read(&format!("v_{body}")));
                }
                jolt = jolt.max((s.read("v_hand") - before).abs());
                before = s.read("v_hand");
            });
            for ((body, most), fastest) in SPEEDS.iter().zip(fastest) {
                prop_assert!(fastest <= *most, "{body} at {fastest} m/s in {} of {acts:?}", stimuli[*which].0);
            }
            // Its muscles draw it with 65 N at most, and it has 0.6 kg.
            prop_assert!(jolt < 1.3, "the hand gains {jolt} m/s in a step, {acts:?}");
        }
    }
}
