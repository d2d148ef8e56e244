//! Robots that strike or clamp somebody: how much the force depends on the physics step.
//!
//! `cargo test -p hrdsl-sim --test robot_blows -- --nocapture` prints the table.

mod common;
#[path = "common/scene.rs"]
mod scene;

use hrdsl_ir::Nanos;
use hrdsl_ir::world::{ArmId, BaseId};
use hrdsl_sim::MotorCommand;
use scene::Scene;

/// ns
const STEPS: [Nanos; 4] = [10_000_000, 5_000_000, 2_000_000, 1_000_000];
/// How often a base is told to go on, ns.
const TELLS: Nanos = 100_000_000;
/// How long an arm has for coming to where it strikes from, s.
const READY: f64 = 6.0;
/// The blow, and not how the robot pushes on after it, ns.
const BLOW: Nanos = 60_000_000;

/// A robot, somebody with the back to it, and what is in front of them.
struct Encounter {
    robot: &'static str,
    /// The library's module that has it.
    module: &'static str,
    /// Where they stand, and which way they look, as a piece of text.
    host: &'static str,
    /// What they stand at, if they do, a few millimetres before them.
    wall: &'static str,
    does: RobotMove,
    /// How long it is looked at, from the first touch on, if there is a wall, ns: an arm presses somebody to it only after the blow.
    pressed: Nanos,
    /// The body that is met first, and what its speed is measured on.
    region: &'static str,
    striker: &'static str,
}

#[derive(Clone, Copy)]
enum RobotMove {
    /// From a place in front of the chest to one in it, straight.
    Reach { from: [f64; 3], to: [f64; 3] },
    /// m/s
    Drive(f64),
}

/// What was found at one step.
struct FoundBlow {
    /// The greatest force on the region while it was struck, and while it was clamped, N.
    transient: f64,
    quasi_static: f64,
    /// How fast the striker was in the step before, m/s.
    speed: f64,
}

impl FoundBlow {
    fn peak(&self) -> f64 {
        self.transient.max(self.quasi_static)
    }
}

const BERT2_ARM: Encounter = Encounter {
    robot: "bert2",
    module: "use std.robots.bert2",
    host: "(75 cm, -22 cm, 0 m)",
    wall: "body wall: fixed box(20 cm, 30 cm, 60 cm) at (96.5 cm, -22 cm, 120 cm)",
    pressed: 800_000_000,
    does: RobotMove::Reach { from: [0.4, -0.22, 1.15], to: [0.8, -0.22, 1.15] },
    region: "trunk",
    striker: "palm",
};

const TIAGO_ARM: Encounter = Encounter {
    robot: "tiago",
    module: "use std.robots.tiago",
    host: "(86 cm, -20 cm, 0 m)",
    wall: "body wall: fixed box(20 cm, 30 cm, 60 cm) at (107.5 cm, -20 cm, 120 cm)",
    pressed: 800_000_000,
    does: RobotMove::Reach { from: [0.55, -0.2, 1.15], to: [0.9, -0.2, 1.15] },
    region: "trunk",
    striker: "palm",
};

/// It goes backwards, so that its base is the first to come, and meets one leg.
const TIAGO_BASE: Encounter = Encounter {
    robot: "tiago",
    module: "use std.robots.tiago",
    host: "(-80 cm, -9.5 cm, 0 m) rotated (0 deg, 0 deg, 180 deg)",
    wall: "body wall: fixed box(20 cm, 60 cm, 40 cm) at (-95.7 cm, 0 m, 20 cm)",
    pressed: BLOW,
    does: RobotMove::Drive(-0.4),
    region: "lower_leg",
    striker: "chassis",
};

impl Encounter {
    fn blow(&self, is_at_wall: bool, step: Nanos) -> FoundBlow {
        let (robot, host, region, striker) = (self.robot, self.host, self.region, self.striker);
        let (wall, looked) = if is_at_wall { (self.wall, self.pressed) } else { ("", BLOW) };
        let members = format!(
            "body floor: fixed box(10 m, 10 m, 10 cm) at (0 m, 0 m, -5 cm)
            part robot = {robot} at (0 m, 0 m, 0 m)
            part host = adult(172 cm) at {host}
            {wall}
            signal blow: force to robot = transient_force(host.{region})
            signal press: force to robot = quasistatic_force(host.{region})
            signal pace: speed to robot = speed(robot.{striker})"
        );
        let mut scene = Scene::with(self.module, &members, &[]);
        scene.at_step(step);
        scene.go_on(0.5, |_| {});
        if let RobotMove::Reach { from, to } = self.does {
            let reach = |target| MotorCommand::ReachPoint { arm: arm(&scene), target, max_speed: None };
            let (first, then) = (reach(from), reach(to));
            scene.sim.command(first).expect("an arm");
            scene.go_on(READY, |_| {});
            let ends = scene.sim.finished();
            assert!(ends.iter().all(|(_, end)| end.is_ok()) && ends.len() == 1, "{ends:?}");
            scene.sim.command(then).expect("an arm");
        }
        let mut found = FoundBlow { transient: 0.0, quasi_static: 0.0, speed: 0.0 };
        let (mut begun, mut pace, ready) = (None, 0.0, scene.sim.now());
        while begun.is_none_or(|at| scene.sim.now() < at + looked) {
            assert!(scene.sim.now() < ready + 8_000_000_000, "{robot}.{striker} does not come");
            if let RobotMove::Drive(forward) = self.does {
                let drive = MotorCommand::DriveWheels { base: BaseId(0), forward, sideways: 0.0, turn: 0.0 };
                scene.sim.command(drive).expect("a base");
            }
            scene.go_on(TELLS as f64 / 1e9, |s| {
                let (blow, press) = (s.read("blow"), s.read("press"));
                if begun.is_none() && blow + press > 0.0 {
                    begun = Some(s.sim.now());
                    found.speed = pace;
                }
                pace = s.read("pace");
                if begun.is_none_or(|at| s.sim.now() < at + looked) {
                    found.transient = found.transient.max(blow);
                    found.quasi_static = found.quasi_static.max(press);
                }
            });
        }
        found
    }

    /// The blows at each step, which are off by no more than so much of that at the finest.
    fn converges(&self, is_at_wall: bool, tolerance: f64) -> Vec<FoundBlow> {
        let place = if is_at_wall { "at a wall" } else { "free" };
        let found: Vec<FoundBlow> = STEPS.iter().map(|step| self.blow(is_at_wall, *step)).collect();
        for (step, blow) in STEPS.iter().zip(&found) {
            println!(
                "{} {} on a {} that stands {place}, {} ms: {:.1} N transient, {:.1} N quasi-static, {:.3} m/s",
                self.robot,
                self.striker,
                self.region,
                step / 1_000_000,
                blow.transient,
                blow.quasi_static,
                blow.speed
            );
        }
        let finest = found.last().expect("steps");
        for blow in &found {
            let off = blow.peak() / finest.peak() - 1.0;
            assert!(off.abs() <= tolerance, "{} {} {place}: {off:+.3}", self.robot, self.striker);
            let pressed = blow.quasi_static - finest.quasi_static;
            assert!(
                pressed.abs() <= tolerance * finest.quasi_static,
                "{} {place}: {pressed:+.1} N",
                self.robot
            );
        }
        found
    }
}

/// The one that reaches.
fn arm(scene: &Scene) -> ArmId {
    scene.sim.arm_named("robot.arm").expect("an arm")
}

#[test]
fn an_arm_strikes_as_hard_at_every_step() {
    for (arm, least) in [(BERT2_ARM, 200.0), (TIAGO_ARM, 30.0)] {
        let free = arm.converges(false, 0.03);
        assert!(free.iter().all(|blow| blow.transient > least && blow.quasi_static == 0.0));
        assert!(arm.converges(true, 0.1).iter().all(|blow| blow.quasi_static > 0.0));
    }
}

#[test]
fn a_base_strikes_as_hard_at_every_step() {
    let free = TIAGO_BASE.converges(false, 0.1);
    // All of TIAGo; a lower leg by ISO/TS 15066:2016, table A.3; tyres that push as hard as they grip, since the blow brakes the base.
    let robot = weight_of_tiago();
    let expected = common::two_masses(robot, 75.0, 60e3, 0.4, 0.8 * robot * 9.81);
    println!("two masses, {robot:.1} kg and 75 kg: {expected:.1} N");
    for blow in &free {
        assert!((blow.transient / expected - 1.0).abs() < 0.1, "{} for {expected}", blow.transient);
    }
    let clamped = TIAGO_BASE.converges(true, 0.1);
    // Who stands at a wall is clamped, and pressed harder.
    assert!(
        free.iter().zip(&clamped).all(|(free, wall)| free.quasi_static == 0.0 && wall.peak() > free.peak())
    );
}

/// kg
fn weight_of_tiago() -> f64 {
    let scene = Scene::with(TIAGO_BASE.module, "part robot = tiago at (0 m, 0 m, 0 m)", &[]);
    scene.program.world.expect("a world").bodies.iter().map(|body| body.mass).sum()
}
