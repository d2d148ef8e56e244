//! Devices from end to end: what the library declares, commanded through the harness in the simulated world.

use std::collections::BTreeMap;

use hrdsl_compiler::{InputFile, compile};
use hrdsl_harness::{
    ActorPlayer, CommandRequest, HarnessLoop, SystemAnswer, SystemArgument, SystemPlayer, SystemRequest,
    WorldStage,
    doubles::{ToldStep, ToldSystem},
};
use hrdsl_ir::{
    Nanos, Program, Value,
    value::{SECOND, seconds},
};
use hrdsl_sim::SimulatedWorld;

/// A torso with an arm and a hand, nothing to hold, and a command of the scenario's own.
const SCENARIO: &str = r#"scenario bench

use std.robots.bert2

actor robot : system

event setting_out, closing, letting_go from robot

require R1 safety "the hand closes at rest" never (closing or setting_out or letting_go) while speed(robot.palm) > 1 m/s

device gripper {
  /// Lets go, whatever becomes of it.
  command drop do open_fingers
}

world {
  part robot = bert2 at (0 m, 0 m, 0 m)
  on move_to robot.arm emit setting_out
  on close robot.grip emit closing
  on drop robot.grip emit letting_go
}

system robot { run "python3 robot.py" }
"#;

fn program() -> Program {
    let c = compile(InputFile { name: "bench.hri", text: SCENARIO }, &[]);
    c.program.unwrap_or_else(|| panic!("{:#?}", c.diagnostics))
}

fn command(device: &str, command: &str, args: &[(&str, SystemArgument)]) -> SystemRequest {
    let args = args.iter().map(|(name, arg)| ((*name).to_owned(), arg.clone())).collect::<BTreeMap<_, _>>();
    SystemRequest::Command(CommandRequest { device: device.into(), command: command.into(), args })
}

fn move_to(place: [f64; 3], speed: Option<f64>) -> SystemRequest {
    let mut args = vec![("to", SystemArgument::Numbers(place.to_vec()))];
    args.extend(speed.map(|s| ("speed", SystemArgument::Scalar(Value::Float(s)))));
    command("robot.arm", "move_to", &args)
}

/// What the system was answered (when, to which request, what), and the events that happened.
fn run(steps: Vec<ToldStep>) -> (Vec<(Nanos, u64, SystemAnswer)>, Vec<String>) {
    let program = program();
    let system = ToldSystem::new(steps);
    let answers = system.answers.clone();
    let robot = program.actor_named("robot").unwrap();
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![Box::new(SystemPlayer::new(&program, robot, system))];
    let world = SimulatedWorld::new(&program, 0).unwrap().unwrap();
    let stage = WorldStage::new(&program, Box::new(world));
    let run = HarnessLoop::new(&program, players, Some(stage), 60 * SECOND).run();
    let event = |step: &hrdsl_trace::TraceStep| match &step.what {
        hrdsl_trace::TraceStepKind::Event { event, .. } => Some(program.event(*event).name.clone()),
        _ => None,
    };
    let events = run.trace.steps.iter().filter_map(event).collect();
    let answers = answers.borrow().clone();
    (answers, events)
}

fn ended(answers: &[(Nanos, u64, SystemAnswer)], request: u64) -> (f64, Result<(), String>) {
    let (time, _, answer) = answers.iter().find(|(_, ticket, _)| *ticket == request).unwrap();
    match answer {
        SystemAnswer::Ended(how) => (seconds(*time), how.clone()),
        other => panic!("{other:?}"),
    }
}

/// The arm is under way while the hand closes and opens, and each command ends by itself.
#[test]
fn an_arm_and_a_gripper_act_side_by_side() {
    use ToldStep::{Ask, Then};
    let (answers, events) = run(vec![
        Ask(move_to([0.4, -0.3, 0.8], Some(0.05))),
        Ask(command("robot.grip", "close", &[])),
        Ask(SystemRequest::Sleep { time: SECOND }),
        Then(command("robot.grip", "open", &[])),
        Then(command("robot.grip", "drop", &[])),
        Then(SystemRequest::Done),
    ]);
    let (arrived, how) = ended(&answers, 0);
    assert_eq!(how, Ok(()));
    let (closed, how) = ended(&answers, 1);
    assert_eq!(how, Err("the gripper closed on nothing".to_owned()), "as the library says");
    assert!((0.4..1.0).contains(&closed) && arrived > 1.0, "{closed} {arrived}");
    assert_eq!(ended(&answers, 3).1, Ok(()), "it holds nothing");
    assert_eq!(ended(&answers, 4).1, Ok(()));
    assert_eq!(events, ["setting_out", "closing", "letting_go"]);
}

#[test]
fn a_later_command_to_a_device_takes_the_place_of_the_one_before() {
    use ToldStep::{Ask, Then};
    let away = move_to([0.4, -0.3, 0.8], Some(0.05));
    let (answers, _) = run(vec![
        Ask(away),
        Ask(command("robot.grip", "drop", &[])),
        Ask(move_to([0.46, -0.22, 0.76], None)),
        Then(move_to([9.0, 0.0, 0.0], None)),
        Then(SystemRequest::Done),
    ]);
    let how = |request| ended(&answers, request).1;
    assert_eq!(how(0), Err("the command was replaced by a later one".to_owned()));
    assert_eq!((how(1), how(2)), (Ok(()), Ok(())));
    assert!(how(3).unwrap_err().starts_with("the place is out of reach"), "{:?}", how(3));
}

/// The words of a refusal are made of the declarations, those of the scenario's own commands included.
#[test]
fn what_makes_no_sense_is_refused_in_the_words_of_the_declarations() {
    let numbers = |n: &[f64]| SystemArgument::Numbers(n.to_vec());
    let asked = [
        command("robot.leg", "move_to", &[]),
        command("robot.arm", "wave", &[]),
        command("robot.grip", "grab", &[]),
        command("robot.arm", "move_to", &[("speed", SystemArgument::Scalar(Value::Float(0.2)))]),
        command("robot.arm", "move_to", &[("to", numbers(&[1.0, 2.0]))]),
        command("robot.arm", "move_joints", &[("to", numbers(&[0.0; 9])), ("fast", numbers(&[]))]),
    ];
    let (answers, events) = run(asked.into_iter().map(ToldStep::Then).collect());
    let said = |(_, _, answer): &(Nanos, u64, SystemAnswer)| match answer {
        SystemAnswer::Refused { error, help } => format!("{error}; {}", help.clone().unwrap_or_default()),
        other => panic!("{other:?}"),
    };
    let arm = "an arm can move_to(to, speed?), move_joints(to, speed?), follow(positions, times), aim(joint, to), stop";
    let expected = [
        "the world has no device `robot.leg`; devices it can command: robot.arm, robot.grip".to_owned(),
        format!("`robot.arm` is an arm, and cannot `wave`; {arm}"),
        "`robot.grip` is a gripper, and cannot `grab`; a gripper can close, open, drop".to_owned(),
        format!("`move_to` needs `to`: 3 numbers in m; {arm}"),
        "`move_to`: `to` is [1.0, 2.0], but must be 3 numbers in m; ".to_owned(),
        "`move_joints` has no argument `fast`; arguments it can use: to, speed".to_owned(),
    ];
    assert_eq!(answers.iter().map(said).collect::<Vec<_>>(), expected);
    assert_eq!(events, [""; 0]);
}
