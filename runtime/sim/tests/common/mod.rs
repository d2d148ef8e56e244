//! The table and its people as a world by hand, with the numbers of `std.robots.bert2` and `std.person`.
#![allow(dead_code, reason = "each test binary uses its own part")]

use hrdsl_ir::world::*;
use hrdsl_ir::{Expr, Nanos, Span, Type, Unit, Value};
use hrdsl_sim::{CommandError, CommandId, MotorCommand, WorldSimulation};

pub const SECOND: Nanos = 1_000_000_000;
pub const STEP: Nanos = 10_000_000;

pub const REST: Vec3 = [0.46, -0.22, 0.76];
pub const LEGS: [Vec3; 4] =
    [[0.3, -0.3, 0.5555], [0.3, -0.38, 0.5555], [0.3, -0.46, 0.5555], [0.3, -0.54, 0.5555]];
pub const OFFER: Vec3 = [0.48, 0.17, 0.705];
pub const DISCARD: Vec3 = [0.15, 0.45, 0.65];

pub const ARM: ArmId = ArmId(0);
pub const GRIP: GripperId = GripperId(0);
pub const GRASP: GripperId = GripperId(1);

/// Degrees.
fn deg(x: f64) -> f64 {
    x.to_radians()
}

pub fn body(name: &str, motion: BodyMotion, shape: BodyShape, position: Vec3, mass: f64) -> Body {
    Body {
        name: name.into(),
        motion,
        shape,
        position,
        rotation: [0.0; 3],
        mass,
        stiffness: None,
        ghost: false,
        solid: None,
    }
}

pub fn cuboid(x: f64, y: f64, z: f64) -> BodyShape {
    BodyShape::Box { size: [x, y, z] }
}

/// What moves a joint of the robot.
fn drive_of(joint: &str) -> JointDrive {
    let effort = match joint {
        "robot.hip_rotor" | "robot.hip_flexor" => 150.0,
        "robot.shoulder_flexor" | "robot.shoulder_abduction" => 80.0,
        "robot.humeral_rotation" | "robot.elbow_flexor" => 40.0,
        _ => 12.0,
    };
    JointDrive { effort: Some(effort), rotor: 0.1, ..JointDrive::default() }
}

struct Maker {
    world: World,
}

impl Maker {
    fn body(&mut self, name: &str, motion: BodyMotion, shape: BodyShape, at: Vec3, mass: f64) -> BodyId {
        self.world.bodies.push(body(name, motion, shape, at, mass));
        BodyId(self.world.bodies.len() as u16 - 1)
    }

    fn ghost(&mut self, name: &str, radius: f64, at: Vec3, mass: f64) -> BodyId {
        let id = self.body(name, BodyMotion::Dynamic, BodyShape::Sphere { radius }, at, mass);
        self.world.bodies[id.0 as usize].ghost = true;
        id
    }

    fn joint(&mut self, name: &str, parent: BodyId, child: BodyId, at: Vec3, axis: Vec3, limits: (f64, f64)) {
        let (lo, hi) = (deg(limits.0), deg(limits.1));
        let (motion, drive) = (JointMotion::Hinge, drive_of(name));
        self.world.joints.push(Joint {
            name: name.into(),
            parent,
            child,
            motion,
            anchor: at,
            axis,
            lo,
            hi,
            drive,
        });
    }

    fn bert2(&mut self) {
        use BodyMotion::{Dynamic, Fixed};
        let capsule = |radius, length| BodyShape::Capsule { radius, length };
        let torso = self.body("robot.torso", Fixed, cuboid(0.20, 0.35, 0.60), [0.0, 0.0, 0.30], 1.0);
        let waist = BodyShape::Cylinder { radius: 0.08, length: 0.10 };
        let waist = self.body("robot.waist", Dynamic, waist, [0.0, 0.0, 0.65], 4.0);
        let chest = self.body("robot.chest", Dynamic, cuboid(0.18, 0.30, 0.40), [0.0, 0.0, 0.92], 8.0);
        let shoulder = self.ghost("robot.shoulder", 0.06, [0.0, -0.22, 1.08], 1.5);
        let cap = self.ghost("robot.shoulder_cap", 0.06, [0.0, -0.22, 1.06], 1.5);
        let upper = self.body("robot.upper_arm", Dynamic, capsule(0.04, 0.20), [0.0, -0.22, 0.90], 1.8);
        let elbow = self.body("robot.elbow", Dynamic, capsule(0.035, 0.09), [0.075, -0.22, 0.76], 1.0);
        let forearm = self.body("robot.forearm", Dynamic, capsule(0.03, 0.11), [0.225, -0.22, 0.76], 0.8);
        for b in [elbow, forearm] {
            self.world.bodies[b.0 as usize].rotation = [0.0, deg(90.0), 0.0];
        }
        let wrist = self.ghost("robot.wrist", 0.03, [0.30, -0.22, 0.76], 0.4);
        let palm = self.body("robot.palm", Dynamic, cuboid(0.04, 0.08, 0.08), [0.38, -0.22, 0.76], 0.4);
        for (name, y, inwards) in [("robot.finger_left", -0.18, -1.0), ("robot.finger_right", -0.26, 1.0)] {
            let finger = self.body(name, Dynamic, cuboid(0.08, 0.01, 0.03), [0.44, y, 0.76], 0.05);
            let drive = JointDrive { effort: Some(40.0), rotor: 0.1, ..JointDrive::default() };
            let (motion, anchor, axis) = (JointMotion::Slider, [0.40, y, 0.76], [0.0, inwards, 0.0]);
            let (name, parent, child) = (name.into(), palm, finger);
            self.world.joints.push(Joint {
                name,
                parent,
                child,
                motion,
                anchor,
                axis,
                lo: 0.0,
                hi: 0.03,
                drive,
            });
        }
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let (no_x, no_y) = ([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]);
        self.joint("robot.hip_rotor", torso, waist, [0.0, 0.0, 0.60], z, (-60.0, 60.0));
        self.joint("robot.hip_flexor", waist, chest, [0.0, 0.0, 0.70], y, (-10.0, 35.0));
        self.joint("robot.shoulder_flexor", chest, shoulder, [0.0, -0.22, 1.08], no_y, (-60.0, 110.0));
        self.joint("robot.shoulder_abduction", shoulder, cap, [0.0, -0.22, 1.08], no_x, (-35.0, 80.0));
        self.joint("robot.humeral_rotation", cap, upper, [0.0, -0.22, 1.00], z, (-80.0, 80.0));
        self.joint("robot.elbow_flexor", upper, elbow, [0.0, -0.22, 0.76], no_y, (-85.0, 50.0));
        self.joint("robot.wrist_pronation", elbow, forearm, [0.15, -0.22, 0.76], x, (-85.0, 85.0));
        self.joint("robot.wrist_abduction", forearm, wrist, [0.30, -0.22, 0.76], z, (-40.0, 40.0));
        self.joint("robot.wrist_flexor", wrist, palm, [0.30, -0.22, 0.76], y, (-70.0, 70.0));
        self.world.arms.push(Arm {
            name: "robot.arm".into(),
            joints: (2..11).map(JointId).collect(),
            tip: palm,
            tool: [0.08, 0.0, 0.0],
            max_speed: 0.2,
            contact_limit: None,
            avoids_people: false,
            postures: Vec::new(),
        });
        self.gripper("robot.grip", palm, [0.08, 0.0, 0.0], 0.04, 500_000_000);
        self.world.grippers[0].fingers = vec![JointId(0), JointId(1)];
    }

    fn person(&mut self) {
        use BodyMotion::Kinematic;
        let head =
            self.body("person.head", Kinematic, BodyShape::Sphere { radius: 0.10 }, [1.25, 0.17, 1.35], 1.0);
        self.world.bodies[head.0 as usize].rotation = [0.0, 0.0, deg(180.0)];
        let hand =
            self.body("person.hand", Kinematic, BodyShape::Sphere { radius: 0.04 }, [1.0, 0.2, 0.9], 1.0);
        self.gripper("person.grasp", hand, [0.0; 3], 0.10, 100_000_000);
    }

    fn gripper(&mut self, name: &str, palm: BodyId, tool: Vec3, reach: f64, delay: Nanos) {
        let name = name.into();
        let (force, fingers, holds) = (40.0, Vec::new(), Vec::new());
        self.world.grippers.push(Gripper {
            name,
            palm,
            fingers,
            reversed: Vec::new(),
            tool,
            reach,
            delay,
            force,
            holds,
        });
    }
}

/// Nothing at all.
pub fn empty() -> World {
    World {
        step: STEP,
        sample: 50_000_000,
        gravity: [0.0, 0.0, -9.81],
        bodies: Vec::new(),
        joints: Vec::new(),
        arms: Vec::new(),
        grippers: Vec::new(),
        bases: Vec::new(),
        lasers: Vec::new(),
        figures: Vec::new(),
        devices: Vec::new(),
        device_kinds: Vec::new(),
        currents: Vec::new(),
        sensors: Vec::new(),
        rules: Vec::new(),
        origin: Span::default(),
    }
}

/// Robot, person, a stand with four legs on it, a box for what is discarded.
pub fn table() -> World {
    let mut m = Maker { world: empty() };
    m.body("floor", BodyMotion::Fixed, cuboid(6.0, 6.0, 0.10), [0.0, 0.0, -0.05], 1.0);
    m.body("stand", BodyMotion::Fixed, cuboid(0.20, 0.40, 0.4305), [0.3, -0.42, 0.21525], 1.0);
    m.bert2();
    m.person();
    let legs: Vec<BodyId> = LEGS
        .iter()
        .enumerate()
        .map(|(i, at)| {
            m.body(&format!("leg{}", i + 1), BodyMotion::Dynamic, cuboid(0.04, 0.04, 0.25), *at, 0.5)
        })
        .collect();
    for gripper in &mut m.world.grippers {
        gripper.holds.clone_from(&legs);
    }
    m.world.currents.push(CurrentBody { name: "leg".into(), of: legs, by: GRIP });
    m.world
}

pub fn named(world: &World, name: &str) -> BodyId {
    BodyId(world.bodies.iter().position(|b| b.name == name).unwrap() as u16)
}

pub fn signal(name: &str, ty: Type, terms: Vec<SignalTerm>, value: Expr) -> Signal {
    Signal { name: name.into(), ty, to: Vec::new(), terms, value, recorded: true, origin: Span::default() }
}

pub fn number(name: &str, term: SignalTerm) -> Signal {
    signal(name, Type::Float(Unit::Metre), vec![term], Expr::Var(0))
}

pub fn truth(name: &str, term: SignalTerm) -> Signal {
    signal(name, Type::Bool, vec![term], Expr::Var(0))
}

pub fn float(sim: &WorldSimulation, i: u16) -> f64 {
    sim.read(SignalId(i)).as_f64().unwrap()
}

pub fn boolean(sim: &WorldSimulation, i: u16) -> bool {
    sim.read(SignalId(i)).as_bool().unwrap()
}

pub fn none(_: u16) -> Option<Value> {
    None
}

pub fn at(of: Option<BodyRef>, place: Vec3) -> WorldPoint {
    WorldPoint::free(of, place.map(Expr::float))
}

pub fn move_to(target: Vec3) -> MotorCommand {
    MotorCommand::ReachPoint { arm: ARM, target, max_speed: None }
}

/// Runs until the command ends; gives the seconds it took.
pub fn wait(
    sim: &mut WorldSimulation,
    id: CommandId,
    mut each: impl FnMut(&WorldSimulation),
) -> (f64, Result<(), CommandError>) {
    let start = sim.now();
    loop {
        let Some(next) = sim.next_wake() else { panic!("the world rests, but a command is under way") };
        sim.advance(next);
        each(sim);
        if let Some((_, result)) = sim.finished().into_iter().find(|(done, _)| *done == id) {
            return ((sim.now() - start) as f64 / 1e9, result);
        }
        assert!(sim.now() - start < 60 * SECOND, "takes too long");
    }
}

pub fn run(sim: &mut WorldSimulation, command: MotorCommand) -> f64 {
    let what = format!("{command:?}");
    let id = sim.command(command).unwrap_or_else(|e| panic!("{what}: {e}"));
    let (time, result) = wait(sim, id, |_| {});
    result.unwrap_or_else(|e| panic!("{what}: {e}, tool at {:?}", sim.tool(ARM)));
    time
}

/// Runs until nothing moves.
pub fn settle(sim: &mut WorldSimulation) {
    let start = sim.now();
    while let Some(next) = sim.next_wake() {
        assert!(next - start < 600 * SECOND, "never comes to rest");
        sim.advance(next);
    }
}

pub fn distance(a: Vec3, b: Vec3) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Fetches the first leg and holds it out.
pub fn offer(sim: &mut WorldSimulation) {
    let [x, y, z] = LEGS[0];
    run(sim, move_to(LEGS[0]));
    run(sim, MotorCommand::CloseFingers { gripper: GRIP });
    run(sim, move_to([x, y, z + 0.15]));
    run(sim, move_to(OFFER));
}

/// Two masses and a spring between them, N: a robot of `robot` kg that meets at `speed` m/s somebody of whom the blow feels `region` kg, and whose
/// surface has this `stiffness` (N/m), while its drive goes on pushing with `drive` N.
pub fn two_masses(robot: f64, region: f64, stiffness: f64, speed: f64, drive: f64) -> f64 {
    two_masses_pushed_late(robot, region, stiffness, speed, drive, 0.0)
}

/// As [`two_masses`], N, where the drive pushes only from `late` s after they meet, and before the blow is at its peak.
pub fn two_masses_pushed_late(
    robot: f64,
    region: f64,
    stiffness: f64,
    speed: f64,
    drive: f64,
    late: f64,
) -> f64 {
    let reduced = 1.0 / (1.0 / robot + 1.0 / region);
    let push = drive * reduced / robot;
    let phase = late * (stiffness / reduced).sqrt();
    push + (speed * (stiffness * reduced).sqrt() - push * libm::sin(phase)).hypot(push * libm::cos(phase))
}

/// The postures of a free arm on its way there, one for each step.
pub fn way_to_the_offer() -> Vec<Vec<f64>> {
    let mut free = WorldSimulation::new(&table(), &[]).unwrap();
    let id = free.command(move_to(OFFER)).unwrap();
    let mut way = Vec::new();
    wait(&mut free, id, |sim| way.push(sim.joint_positions(ARM).to_vec())).1.unwrap();
    way
}
