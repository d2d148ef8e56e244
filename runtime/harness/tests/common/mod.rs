//! A small scenario, and runs of it on doubles.
#![allow(dead_code, reason = "each file of tests uses what it needs")]

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use hrdsl_harness::{
    ActorPlayer, CommandRequest, HarnessLoop, HarnessRun, RunTermination, ScriptPlayer, SystemAnswer,
    SystemArgument, SystemPlayer, SystemRequest, WorldStage,
    doubles::{ToldClock, ToldStep, ToldSystem, ToldWorld},
};
use hrdsl_ir::{
    Actor, ActorId, Event, EventId, EventPattern, Expr, Nanos, Parameter, Program, Role, Span, Type, Unit,
    Value,
    device::{
        CommandParam, CommandType, Device, DeviceBody, DeviceCommand, DeviceKind, DevicePrimitive,
        DeviceSort, NumberCount,
    },
    event::{Stimulus, StimulusStep},
    test::{Test, TestProvenance, TestScript, TestStep},
    value::SECOND,
    world::{
        ArmId, DeviceCommandId, DeviceId, DeviceKindId, GripperId, RuleTrigger, Signal, SignalId, World,
        WorldRule,
    },
};
use hrdsl_trace::{RunEnd, print};

pub const GUEST: ActorId = ActorId(0);
pub const ROBOT: ActorId = ActorId(1);

/// `ask` is a stimulus that makes `asked(n)`; the robot makes `done`; the world makes `gripped` when the gripper is told to
/// close while `near`. It has an arm that can `go` and a gripper that can `close`.
pub fn program() -> Program {
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
pub fn world(rule: WorldRule) -> World {
    World {
        step: 1_000_000,
        sample: SECOND / 20,
        gravity: [0.0; 3],
        bodies: Vec::new(),
        joints: Vec::new(),
        arms: Vec::new(),
        grippers: Vec::new(),
        bases: Vec::new(),
        lasers: Vec::new(),
        figures: Vec::new(),
        devices: vec![
            Device { name: "arm".into(), kind: DeviceKindId(0), body: DeviceBody::Arm(ArmId(0)) },
            Device { name: "grip".into(), kind: DeviceKindId(1), body: DeviceBody::Gripper(GripperId(0)) },
        ],
        device_kinds: kinds(),
        currents: Vec::new(),
        sensors: Vec::new(),
        rules: vec![rule],
        origin: Span::default(),
    }
}

/// An arm can `go(to, speed?)` and `bend(to)`, a gripper `close`.
pub fn kinds() -> Vec<DeviceKind> {
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
    let kind = |name: &str, sort, commands| DeviceKind {
        name: name.into(),
        doc: String::new(),
        sort,
        commands,
        states: Vec::new(),
    };
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

pub fn test(steps: Vec<TestStep>) -> Test {
    let scripts = TestScript::of_all(steps);
    Test {
        name: "t".into(),
        seed: 1,
        provenance: TestProvenance::default(),
        scripts,
        origin: Span::default(),
    }
}

pub fn ask(n: i64) -> TestStep {
    TestStep::Do { event: EventId(0), args: vec![Value::Int(n)], samples: Vec::new(), meanwhile: false }
}

pub fn wait(seconds: i64) -> TestStep {
    TestStep::Wait { time: seconds * SECOND }
}

pub fn await_done(seconds: i64) -> TestStep {
    let events = vec![EventPattern { event: EventId(2), args: Vec::new() }];
    TestStep::Await { events, within: seconds * SECOND }
}

pub fn sleep(seconds: i64) -> SystemRequest {
    SystemRequest::Sleep { time: seconds * SECOND }
}

pub fn wait_for(event: &str, timeout: Option<i64>) -> SystemRequest {
    SystemRequest::WaitFor { events: vec![event.into()], timeout: timeout.map(|t| t * SECOND) }
}

pub fn emit(event: &str) -> SystemRequest {
    SystemRequest::Emit { event: event.into(), args: BTreeMap::new() }
}

pub fn command(device: &str, command: &str, args: &[(&str, SystemArgument)]) -> SystemRequest {
    let args = args.iter().map(|(name, arg)| ((*name).to_owned(), arg.clone())).collect();
    SystemRequest::Command(CommandRequest { device: device.into(), command: command.into(), args })
}

pub fn go() -> SystemRequest {
    command("arm", "go", &[("to", SystemArgument::Numbers(vec![1.0, 2.0, 3.0]))])
}

pub fn close() -> SystemRequest {
    command("grip", "close", &[])
}

pub type Answers = Rc<RefCell<Vec<(Nanos, u64, SystemAnswer)>>>;

pub fn system(steps: Vec<ToldStep>) -> (ToldSystem, Answers) {
    let system = ToldSystem::new(steps);
    let answers = system.answers.clone();
    (system, answers)
}

/// The players of a test's scripts, and of the system.
pub fn players<'p>(
    program: &'p Program,
    test: &'p Test,
    system: impl ActorPlayer + 'p,
) -> Vec<Box<dyn ActorPlayer + 'p>> {
    let mut players: Vec<Box<dyn ActorPlayer + 'p>> = vec![Box::new(system)];
    players.extend(ScriptPlayer::all(program, test).map(|p| Box::new(p) as Box<dyn ActorPlayer + 'p>));
    players
}

/// Runs a test against a system in a world, for at most a minute.
pub fn run(
    steps: Vec<TestStep>,
    system: ToldSystem,
    world: Option<ToldWorld>,
    clock: Option<ToldClock>,
) -> (Vec<String>, HarnessRun) {
    let (program, test) = (program(), test(steps));
    let players = players(&program, &test, SystemPlayer::new(&program, ROBOT, system));
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

pub fn end(run: &HarnessRun) -> (RunEnd, Nanos) {
    let how = match run.ended {
        RunTermination::Quiescent => RunEnd::Quiescent,
        RunTermination::Limit => RunEnd::Limit,
        RunTermination::Fault(_) => RunEnd::Error,
    };
    (how, run.trace.end / SECOND)
}

/// What it was answered: second, request, answer.
pub fn told(answers: &Answers) -> Vec<(i64, u64, SystemAnswer)> {
    answers.borrow().iter().map(|(time, ticket, answer)| (time / SECOND, *ticket, answer.clone())).collect()
}

pub fn asked(n: i64, time: i64) -> SystemAnswer {
    let args = BTreeMap::from([("n".to_owned(), Value::Int(n))]);
    SystemAnswer::Event { name: "asked".into(), args, time: time * SECOND }
}
