//! The loop on doubles of its seams: a world, a system and a clock that do what they are told.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use hrdsl_harness::{
    ActorPlayer, CommandRequest, HarnessError, HarnessLoop, HarnessRun, RunTermination, ScriptPlayer,
    SystemAnswer, SystemArgument, SystemFault, SystemFaultKind, SystemPlayer, SystemRequest, WorldStage,
    doubles::{ToldClock, ToldCommand, ToldStep, ToldSystem, ToldWorld},
};
use hrdsl_ir::{
    Actor, ActorId, Event, EventId, EventPattern, Expr, Nanos, Parameter, Program, Role, Span, Type, Unit,
    Value,
    device::{
        CommandParam, CommandType, Device, DeviceBody, DeviceCommand, DeviceKind, DevicePrimitive,
        DeviceSort, NumberCount,
    },
    event::{Stimulus, StimulusStep},
    test::{Test, TestProvenance, TestStep},
    value::SECOND,
    world::{
        ArmId, DeviceCommandId, DeviceId, DeviceKindId, GripperId, RuleTrigger, Signal, SignalId, World,
        WorldRule,
    },
};
use hrdsl_trace::{RunEnd, TraceStepKind, print};

const GUEST: ActorId = ActorId(0);
const ROBOT: ActorId = ActorId(1);

/// `ask` is a stimulus that makes `asked(n)`; the robot makes `done`; the world makes `gripped` when the gripper is told to
/// close while `near`. It has an arm that can `go` and a gripper that can `close`.
fn program() -> Program {
    let event = |name: &str, from, params: &[&str], stimulus| Event {
        name: name.into(),
        params: params
            .iter()
            .map(|p| Parameter { name: (*p).into(), ty: Type::Int { lo: 0, hi: 9 } })
            .collect(),
        from,
        to: Vec::new(),
        stimulus,
        origin: Span::default(),
    };
    let emit = StimulusStep::Emit { event: EventId(1), args: vec![Expr::Var(0)] };
    let ask = Stimulus { samples: Vec::new(), steps: vec![emit] };
    let actor = |name: &str, role| Actor { name: name.into(), role, origin: Span::default() };
    let near = Signal {
        name: "near".into(),
        ty: Type::Bool,
        to: vec![ROBOT],
        terms: Vec::new(),
        value: Expr::bool(true),
        recorded: true,
        origin: Span::default(),
    };
    let rule = WorldRule {
        on: RuleTrigger::Commanded { device: DeviceId(1), command: DeviceCommandId(0) },
        guard: Some(Expr::Var(0)),
        event: EventId(3),
        args: Vec::new(),
        signals: vec![SignalId(0)],
        origin: Span::default(),
    };
    Program {
        name: "seams".into(),
        actors: vec![actor("guest", Role::Environment), actor("robot", Role::System)],
        events: vec![
            event("ask", GUEST, &["n"], Some(ask)),
            event("asked", GUEST, &["n"], None),
            event("done", ROBOT, &[], None),
            event("gripped", GUEST, &[], None),
        ],
        signals: vec![near],
        world: Some(world(rule)),
        ..Program::default()
    }
}

/// A world with an arm and a gripper.
fn world(rule: WorldRule) -> World {
    World {
        step: 1_000_000,
        sample: SECOND / 20,
        gravity: [0.0; 3],
        bodies: Vec::new(),
        joints: Vec::new(),
        arms: Vec::new(),
        grippers: Vec::new(),
        devices: vec![
            Device { name: "arm".into(), kind: DeviceKindId(0), body: DeviceBody::Arm(ArmId(0)) },
            Device { name: "grip".into(), kind: DeviceKindId(1), body: DeviceBody::Gripper(GripperId(0)) },
        ],
        device_kinds: kinds(),
        currents: Vec::new(),
        rules: vec![rule],
        origin: Span::default(),
    }
}

/// An arm can `go(to, speed?)` and `bend(to)`, a gripper `close`.
fn kinds() -> Vec<DeviceKind> {
    let param = |name: &str, unit, count, optional| CommandParam {
        name: name.into(),
        ty: CommandType { unit, count },
        optional,
    };
    let command = |name: &str, params, primitive| DeviceCommand {
        name: name.into(),
        doc: String::new(),
        params,
        primitive,
        expect: None,
    };
    let kind =
        |name: &str, sort, commands| DeviceKind { name: name.into(), doc: String::new(), sort, commands };
    let to = param("to", Unit::Metre, NumberCount::Array(3), false);
    let speed = param("speed", Unit::RadianPerSecond, NumberCount::One, true);
    let angles = param("to", Unit::Radian, NumberCount::List, false);
    let arm = vec![
        command("go", vec![to, speed], DevicePrimitive::ReachPoint),
        command("bend", vec![angles], DevicePrimitive::ReachJoints),
    ];
    let gripper = vec![command("close", Vec::new(), DevicePrimitive::CloseFingers)];
    vec![kind("arm", DeviceSort::Arm, arm), kind("gripper", DeviceSort::Gripper, gripper)]
}

fn test(steps: Vec<TestStep>) -> Test {
    Test { name: "t".into(), seed: 1, provenance: TestProvenance::default(), steps, origin: Span::default() }
}

fn ask(n: i64) -> TestStep {
    TestStep::Do { event: EventId(0), args: vec![Value::Int(n)], samples: Vec::new() }
}

fn wait(seconds: i64) -> TestStep {
    TestStep::Wait { time: seconds * SECOND }
}

fn await_done(seconds: i64) -> TestStep {
    let events = vec![EventPattern { event: EventId(2), args: Vec::new() }];
    TestStep::Await { events, within: seconds * SECOND }
}

fn sleep(seconds: i64) -> SystemRequest {
    SystemRequest::Sleep { time: seconds * SECOND }
}

fn wait_for(event: &str, timeout: Option<i64>) -> SystemRequest {
    SystemRequest::WaitFor { events: vec![event.into()], timeout: timeout.map(|t| t * SECOND) }
}

fn emit(event: &str) -> SystemRequest {
    SystemRequest::Emit { event: event.into(), args: BTreeMap::new() }
}

fn command(device: &str, command: &str, args: &[(&str, SystemArgument)]) -> SystemRequest {
    let args = args.iter().map(|(name, arg)| ((*name).to_owned(), arg.clone())).collect();
    SystemRequest::Command(CommandRequest { device: device.into(), command: command.into(), args })
}

fn go() -> SystemRequest {
    command("arm", "go", &[("to", SystemArgument::Numbers(vec![1.0, 2.0, 3.0]))])
}

fn close() -> SystemRequest {
    command("grip", "close", &[])
}

type Answers = Rc<RefCell<Vec<(Nanos, u64, SystemAnswer)>>>;

fn system(steps: Vec<ToldStep>) -> (ToldSystem, Answers) {
    let system = ToldSystem::new(steps);
    let answers = system.answers.clone();
    (system, answers)
}

/// Runs a test against a system in a world, for at most a minute.
fn run(
    steps: Vec<TestStep>,
    system: ToldSystem,
    world: Option<ToldWorld>,
    clock: Option<ToldClock>,
) -> (Vec<String>, HarnessRun) {
    let (program, test) = (program(), test(steps));
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![
        Box::new(ScriptPlayer::new(&program, &test)),
        Box::new(SystemPlayer::new(&program, ROBOT, system)),
    ];
    let stage = world.map(|world| WorldStage::new(&program, Box::new(world)));
    let mut harness = HarnessLoop::new(&program, players, stage, 60 * SECOND);
    if let Some(clock) = clock {
        harness = harness.with_clock(Box::new(clock));
    }
    let run = harness.run();
    let line = |step: &hrdsl_trace::TraceStep| {
        let (who, what) = print::who_did_what(&program, &step.what);
        format!("{} {who} {what}", step.time / SECOND)
    };
    (run.trace.steps.iter().map(line).collect(), run)
}

fn end(run: &HarnessRun) -> (RunEnd, Nanos) {
    let how = match run.ended {
        RunTermination::Quiescent => RunEnd::Quiescent,
        RunTermination::Limit => RunEnd::Limit,
        RunTermination::Fault(_) => RunEnd::Error,
    };
    (how, run.trace.end / SECOND)
}

/// What it was answered: second, request, answer.
fn told(answers: &Answers) -> Vec<(i64, u64, SystemAnswer)> {
    answers.borrow().iter().map(|(time, ticket, answer)| (time / SECOND, *ticket, answer.clone())).collect()
}

fn asked(n: i64, time: i64) -> SystemAnswer {
    let args = BTreeMap::from([("n".to_owned(), Value::Int(n))]);
    SystemAnswer::Event { name: "asked".into(), args, time: time * SECOND }
}

#[test]
fn a_system_in_lock_step_hears_and_answers() {
    use SystemAnswer::{Ok, TimedOut};
    use ToldStep::Then;
    let (system, answers) = system(vec![
        Then(wait_for("asked", Some(9))),
        Then(sleep(2)),
        Then(emit("done")),
        Then(wait_for("asked", Some(3))),
        Then(SystemRequest::Done),
    ]);
    let (lines, run) = run(vec![wait(1), ask(4), await_done(10)], system, None, None);
    assert_eq!(lines, ["1 guest ask(n: 4)", "1 guest asked(n: 4)", "3 robot done"]);
    assert_eq!(end(&run), (RunEnd::Quiescent, 6));
    assert_eq!(told(&answers), [(1, 0, asked(4, 1)), (3, 1, Ok), (3, 2, Ok), (6, 3, TimedOut)]);
}

/// Requests need not block: four are open at once, and each is answered when its time has come.
#[test]
fn a_system_may_ask_on_before_it_is_answered() {
    use SystemAnswer::{Ended, Ok, TimedOut};
    use ToldStep::{Ask, Then};
    let (system, answers) = system(vec![
        Ask(sleep(5)),
        Ask(go()),
        Ask(wait_for("asked", None)),
        Ask(wait_for("done", Some(1))),
        Ask(wait_for("asked", Some(1))),
        Ask(SystemRequest::Now),
        Then(SystemRequest::Done),
    ]);
    let takes = ToldCommand { takes: 3 * SECOND, ends: Err("it slipped".into()) };
    let world = ToldWorld::new(Vec::new(), vec![("arm", "go", takes)]);
    let seen = world.seen.clone();
    let (_, run) = run(vec![wait(2), ask(1), ask(2)], system, Some(world), None);
    assert_eq!(end(&run), (RunEnd::Quiescent, 5));
    let told = told(&answers);
    assert!(matches!(told[0], (0, 3, SystemAnswer::Refused { .. })), "its own events it does not hear");
    let slipped = Ended(Err("it slipped".into()));
    assert_eq!(told[1..], [(0, 5, Ok), (1, 4, TimedOut), (2, 2, asked(1, 2)), (3, 1, slipped), (5, 0, Ok)]);
    assert_eq!(*seen.borrow(), [(0, "arm go ReachPoint { to: [1.0, 2.0, 3.0], speed: None }".to_owned())]);
}

#[test]
fn of_several_that_wait_the_first_takes_the_event() {
    use ToldStep::{Ask, Then};
    let (system, answers) = system(vec![
        Ask(wait_for("asked", None)),
        Ask(wait_for("asked", None)),
        Then(wait_for("asked", None)),
        Then(SystemRequest::Done),
    ]);
    let (_, run) = run(vec![ask(1), wait(1), ask(2), wait(1), ask(3)], system, None, None);
    assert_eq!(end(&run), (RunEnd::Quiescent, 2));
    assert_eq!(told(&answers), [(0, 0, asked(1, 0)), (1, 1, asked(2, 1)), (2, 2, asked(3, 2))]);
}

#[test]
fn the_world_is_sampled_read_and_answers_to_commands() {
    use SystemAnswer::{Ended, Ok as Fine, Value as Is};
    use ToldStep::Then;
    let near = SignalId(0);
    let closes = ToldCommand { takes: 0, ends: Ok(()) };
    let world = ToldWorld::new(
        vec![(0, near, Value::Bool(false)), (4 * SECOND, near, Value::Bool(true))],
        vec![("grip", "close", closes)],
    );
    let read = || SystemRequest::Read { signal: "near".into() };
    let (system, answers) = system(vec![
        Then(read()),
        Then(close()),
        Then(sleep(6)),
        Then(read()),
        Then(close()),
        Then(command("grip", "sing", &[])),
        Then(SystemRequest::Done),
    ]);
    let (lines, run) = run(vec![wait(7)], system, Some(world), None);
    let expected = ["0 signal near = false", "4 signal near = true", "6 guest gripped"];
    assert_eq!(lines, expected, "the first close met nothing");
    assert_eq!(end(&run), (RunEnd::Quiescent, 7));
    let refused = SystemAnswer::Refused {
        error: "`grip` is a gripper, and cannot `sing`".into(),
        help: Some("a gripper can close".into()),
    };
    let expected = [
        (0, 0, Is(Value::Bool(false))),
        (0, 1, Ended(Ok(()))),
        (6, 2, Fine),
        (6, 3, Is(Value::Bool(true))),
        (6, 4, Ended(Ok(()))),
        (6, 5, refused),
    ];
    assert_eq!(told(&answers), expected);
}

#[test]
fn without_a_world_nothing_can_be_read_or_commanded() {
    use ToldStep::Then;
    let read = SystemRequest::Read { signal: "near".into() };
    let other = SystemRequest::Read { signal: "far".into() };
    let (system, answers) = system(vec![
        Then(read),
        Then(other),
        Then(go()),
        Then(emit("asked")),
        Then(wait_for("done", None)),
        Then(SystemRequest::Done),
    ]);
    run(vec![], system, None, None);
    let error = |(_, _, answer)| match answer {
        SystemAnswer::Refused { error, help } => format!("{error}: {}", help.unwrap_or_default()),
        other => panic!("{other:?}"),
    };
    let errors: Vec<String> = told(&answers).into_iter().map(error).collect();
    assert_eq!(
        errors,
        [
            "there is no world to read signals from: ",
            "no signal `far` that this actor can read: signals it can use: near",
            "there is no world to act in: ",
            "no event `asked` that this actor makes: events it can use: done",
            "no event `done` that this actor can hear: events it can use: asked, gripped",
        ]
    );
}

/// Devices act side by side: each command is answered when it ends, whatever the others do.
#[test]
fn commands_to_several_devices_run_at_once() {
    use SystemAnswer::{Ended, Ok as Fine};
    use ToldStep::{Ask, Then};
    let takes = |seconds: i64| ToldCommand { takes: seconds * SECOND, ends: Ok(()) };
    let world = ToldWorld::new(Vec::new(), vec![("arm", "go", takes(5)), ("grip", "close", takes(2))]);
    let (system, answers) =
        system(vec![Ask(go()), Ask(close()), Ask(sleep(3)), Then(close()), Then(SystemRequest::Done)]);
    let (_, run) = run(vec![], system, Some(world), None);
    assert_eq!(end(&run), (RunEnd::Quiescent, 7));
    let ended = || Ended(Ok(()));
    assert_eq!(told(&answers), [(2, 1, ended()), (3, 2, Fine), (5, 0, ended()), (7, 3, ended())]);
}

#[test]
fn what_makes_no_sense_of_a_device_is_refused_with_what_it_can() {
    use SystemArgument::{Numbers, Scalar, Text};
    use ToldStep::Then;
    let to = ("to", Numbers(vec![1.0, 2.0, 3.0]));
    let asked = [
        command("leg", "go", &[]),
        command("arm", "wave", &[]),
        command("arm", "go", &[]),
        command("arm", "go", &[("to", Numbers(vec![1.0, 2.0]))]),
        command("arm", "go", &[("to", Scalar(Value::Float(1.0)))]),
        command("arm", "go", &[to.clone(), ("speed", Text("fast".into()))]),
        command("arm", "go", &[to.clone(), ("sped", Scalar(Value::Float(1.0)))]),
        command("arm", "bend", &[("to", Text("there".into()))]),
        command("grip", "close", std::slice::from_ref(&to)),
    ];
    let (system, answers) = system(asked.into_iter().map(Then).collect());
    let world = ToldWorld::default();
    let seen = world.seen.clone();
    run(vec![], system, Some(world), None);
    let said = |(_, _, answer)| match answer {
        SystemAnswer::Refused { error, help } => format!("{error}: {}", help.unwrap_or_default()),
        other => panic!("{other:?}"),
    };
    let said: Vec<String> = told(&answers).into_iter().map(said).collect();
    let expected = [
        "the world has no device `leg`: devices it can command: arm, grip",
        "`arm` is an arm, and cannot `wave`: an arm can go(to, speed?), bend(to)",
        "`go` needs `to`: 3 numbers in m: an arm can go(to, speed?), bend(to)",
        "`go`: `to` is [1.0, 2.0], but must be 3 numbers in m: ",
        "`go`: `to` is 1, but must be 3 numbers in m: ",
        "`go`: `speed` is \"fast\", but must be a number in rad/s: ",
        "`go` has no argument `sped`: arguments it can use: to, speed",
        "`bend`: `to` is \"there\", but must be a list of numbers in rad: ",
        "`close` has no argument `to`: ",
    ];
    assert_eq!(said, expected);
    assert!(seen.borrow().is_empty(), "the world hears of none of them");
}

#[test]
fn a_system_that_fails_ends_the_run() {
    use ToldStep::{Fail, Then};
    let fault = SystemFault { message: "it burns".into(), kind: SystemFaultKind::Program };
    let (system, _) = system(vec![Then(sleep(3)), Then(wait_for("asked", Some(0))), Fail(fault.clone())]);
    let (_, run) = run(vec![wait(9)], system, None, None);
    assert!(matches!(&run.ended, RunTermination::Fault(HarnessError::System(found)) if *found == fault));
    assert_eq!(run.trace.end, 3 * SECOND, "as soon as it may");
}

#[test]
fn a_system_that_never_lets_time_pass_ends_the_run() {
    let steps = (0..=100_000).map(|_| ToldStep::Then(sleep(0)));
    let (system, _) = system(steps.collect());
    let (_, run) = run(vec![wait(9)], system, None, None);
    let RunTermination::Fault(HarnessError::System(fault)) = &run.ended else { panic!("{:?}", run.ended) };
    assert!(
        fault.message.contains("100000 requests without letting simulated time pass (at 0 s)"),
        "{fault}"
    );
}

/// Where the outside owns time, it stands where the outside lets it, and nothing that is due before is missed.
#[test]
fn an_outside_clock_is_followed() {
    use ToldStep::Then;
    let (told_system, answers) =
        system(vec![Then(sleep(4)), Then(emit("done")), Then(wait_for("asked", None))]);
    let clock = ToldClock { stops: [1, 2, 3, 7, 59].map(|s| s * SECOND).into() };
    let (lines, found) = run(vec![wait(2), ask(0), wait(7)], told_system, None, Some(clock));
    assert_eq!(lines, ["2 guest ask(n: 0)", "2 guest asked(n: 0)", "4 robot done"]);
    // With nothing due any more the outside might still say something, until the time is over.
    assert_eq!(end(&found), (RunEnd::Limit, 60));
    assert_eq!(told(&answers)[2], (4, 2, asked(0, 2)));
    let (system, _) = system(vec![Then(wait_for("asked", None))]);
    let own = run(vec![], system, None, None).1;
    assert_eq!(end(&own), (RunEnd::Quiescent, 0), "the harness's own clock has nothing to wait for");
}

#[test]
fn a_run_ends_at_its_limit_with_what_happens_then() {
    use ToldStep::Then;
    let (system, answers) = system(vec![Then(sleep(60)), Then(emit("done")), Then(sleep(1))]);
    let (lines, run) = run(vec![], system, None, None);
    assert_eq!(lines, ["60 robot done"]);
    assert_eq!(end(&run), (RunEnd::Limit, 60));
    assert_eq!(told(&answers).len(), 2);
    assert!(matches!(run.trace.steps[0].what, TraceStepKind::Event { event: EventId(2), .. }));
}
