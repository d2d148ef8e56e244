//! Robots that strike or clamp somebody: how much the force depends on the physics step.
//!
//! `cargo test -p hrdsl-sim --test robot_blows -- --nocapture` prints the table.

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
    /// The body that is met first, and what its speed is measured on.
    region: &'static str,
    striker: &'static str,
}

#[derive(Clone, Copy)]
enum RobotMove {
    Reach([f64; 3]),
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
    wall: "",
    does: RobotMove::Reach([0.8, -0.22, 1.15]),
    region: "trunk",
    striker: "palm",
};

const TIAGO_ARM: Encounter = Encounter {
    robot: "tiago",
    module: "use std.robots.tiago",
    host: "(86 cm, -20 cm, 0 m)",
    wall: "",
    does: RobotMove::Reach([0.9, -0.2, 1.1]),
    region: "trunk",
    striker: "palm",
};

/// It goes backwards, so that its base is the first to come, and meets one leg.
const TIAGO_BASE: Encounter = Encounter {
    robot: "tiago",
    module: "use std.robots.tiago",
    host: "(-80 cm, -9.5 cm, 0 m) rotated (0 deg, 0 deg, 180 deg)",
    wall: "body wall: fixed box(20 cm, 60 cm, 40 cm) at (-95.7 cm, 0 m, 20 cm)",
    does: RobotMove::Drive(-0.4),
    region: "lower_leg",
    striker: "chassis",
};

impl Encounter {
    fn blow(&self, is_at_wall: bool, step: Nanos) -> FoundBlow {
        let (robot, host, region, striker) = (self.robot, self.host, self.region, self.striker);
        let wall = if is_at_wall { self.wall } else { "" };
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
        if let RobotMove::Reach(target) = self.does {
            let reach = MotorCommand::ReachPoint { arm: arm(&scene), target, max_speed: None };
            scene.sim.command(reach).expect("an arm");
        }
        let mut found = FoundBlow { transient: 0.0, quasi_static: 0.0, speed: 0.0 };
        let (mut begun, mut pace) = (None, 0.0);
        while begun.is_none_or(|at| scene.sim.now() < at + BLOW) {
            assert!(scene.sim.now() < 8_000_000_000, "{robot}.{striker} does not come");
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
                if begun.is_none_or(|at| s.sim.now() < at + BLOW) {
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
        }
        found
    }
}

/// The one that reaches.
fn arm(scene: &Scene) -> ArmId {
    scene.sim.arm_named("robot.arm").expect("an arm")
}

/// How hard an arm strikes depends on how its motors push meanwhile, and so on how often they are told: at 10 ms the blow is off by more than a tenth.
#[test]
fn an_arm_strikes_about_as_hard_at_every_step() {
    assert!(BERT2_ARM.converges(false, 0.25).iter().all(|blow| blow.transient > 50.0));
    assert!(TIAGO_ARM.converges(false, 0.25).iter().all(|blow| blow.transient > 10.0));
}

#[test]
fn a_base_strikes_as_hard_at_every_step() {
    let free = TIAGO_BASE.converges(false, 0.1);
    let clamped = TIAGO_BASE.converges(true, 0.2);
    // Who stands at a wall is clamped, and pressed harder.
    assert!(
        free.iter().zip(&clamped).all(|(free, wall)| free.quasi_static == 0.0 && wall.peak() > free.peak())
    );
}
