//! What devices tell of themselves, in the messages of a binding.

mod common;

use common::{ROBOT, program, system};
use hrdsl_harness::{
    ActorPlayer, HarnessLoop, HarnessRun, PortDeclaration, PortKind, PortQos, SystemAnswer, SystemArrival,
    SystemPlayer, SystemRequest, WorldStage,
    doubles::{ToldStep, ToldWorld},
};
use hrdsl_ir::{
    Nanos, Program, Span,
    binding::{
        GapValue, MessageGap, MessageScalar, MessageTemplate, MiddlewareBinding, MiddlewareKind, ToldNumbers,
        TopicInput,
    },
    device::{Device, DeviceBody, DeviceKind, DeviceSort},
    device_state::DeviceState,
    value::SECOND,
    world::{DeviceId, DeviceKindId, LaserId},
};

const LASER: DeviceBody = DeviceBody::Laser(LaserId(0));

/// The small scenario, with a laser, and the topic `/scan` from it at 1 Hz.
fn scanning(what: DeviceState) -> (Program, MiddlewareBinding) {
    let mut program = program();
    let mut device = DeviceId(0);
    if let Some(world) = &mut program.world {
        let (name, kind) = ("laser".to_owned(), world.device_kinds.len() as u16);
        let (doc, sort, commands) = (String::new(), DeviceSort::Laser, Vec::new());
        world.device_kinds.push(DeviceKind { name: name.clone(), doc, sort, commands, states: Vec::new() });
        device = DeviceId(world.devices.len() as u16);
        world.devices.push(Device { name, kind: DeviceKindId(kind), body: LASER });
    }
    let told = |numbers| MessageGap {
        value: GapValue::Told { device, what, numbers },
        scalar: MessageScalar::Float,
    };
    let fixed = MessageGap { value: GapValue::Fixed("\"laser\"".into()), scalar: MessageScalar::Text };
    let text = ["{\"frame_id\":", ",\"ranges\":", ",\"first\":", "}"].map(str::to_owned).into();
    let gaps = vec![fixed, told(ToldNumbers::All), told(ToldNumbers::One(1))];
    let input = TopicInput {
        topic: "/scan".into(),
        interface: "sensor_msgs/LaserScan".into(),
        period: Some(SECOND),
        latched: false,
        message: MessageTemplate { text, gaps },
        origin: Span::default(),
    };
    let binding = MiddlewareBinding {
        packages: std::collections::BTreeMap::new(),
        kind: MiddlewareKind::Ros1,
        inputs: vec![input],
        outputs: Vec::new(),
        services: Vec::new(),
        actions: Vec::new(),
        groups: Vec::new(),
        parameters: std::collections::BTreeMap::new(),
        transitions: Vec::new(),
        origin: Span::default(),
    };
    (program, binding)
}

/// The messages that a program heard in three seconds, each with its time in seconds.
fn heard(what: DeviceState) -> (Vec<(Nanos, String)>, HarnessRun) {
    let (program, binding) = scanning(what);
    let wait = || ToldStep::Then(SystemRequest::Wait { until: None, give_up: None });
    let (name, type_name) = ("/scan".to_owned(), "sensor_msgs/LaserScan".to_owned());
    let (kind, qos) = (PortKind::Subscriber, PortQos::default());
    let declared = PortDeclaration { port: 5, kind, name, type_name, kept: 0, depth: 1, qos };
    let mut steps = vec![ToldStep::Then(SystemRequest::Open(declared))];
    steps.extend((0..9).map(|_| wait()));
    let (system, answers) = system(steps);
    let player = SystemPlayer::new(&program, ROBOT, system).with_binding(Some(&binding));
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![Box::new(player)];
    let near = vec![1.0, f64::NEG_INFINITY, 0.25];
    let states = [(0, vec![f64::INFINITY, 2.5]), (3 * SECOND / 2, near)];
    let states = states.map(|(time, numbers)| (time, LASER, DeviceState::BeamRanges, numbers)).to_vec();
    let world = ToldWorld::default().with_states(states);
    let stage = WorldStage::new(&program, Box::new(world));
    let run = HarnessLoop::new(&program, players, Some(stage), 5 * SECOND / 2).run();
    let mut messages = Vec::new();
    for (time, _, answer) in answers.borrow().iter() {
        let SystemAnswer::Arrived { arrivals, .. } = answer else { continue };
        for arrival in arrivals {
            let SystemArrival::Message { message, .. } = arrival else { continue };
            messages.push((time / SECOND, message.to_string()));
        }
    }
    (messages, run)
}

#[test]
fn a_topic_from_a_device_holds_what_it_tells_at_that_moment() {
    let (messages, _) = heard(DeviceState::BeamRanges);
    let far = r#"{"frame_id":"laser","ranges":["inf",2.5],"first":2.5}"#;
    let near = r#"{"frame_id":"laser","ranges":[1.0,"-inf",0.25],"first":"-inf"}"#;
    let later: Vec<_> = messages.iter().filter(|(time, _)| *time > 0).cloned().collect();
    assert_eq!(later, [(1, far.to_owned()), (2, near.to_owned())]);
}

#[test]
fn what_a_device_cannot_tell_is_said() {
    let (messages, run) = heard(DeviceState::JointAngles);
    assert_eq!(messages, []);
    let said = format!("{:?}", run.ended);
    assert!(said.contains("the world does not tell the `joint_angles` of this device"), "{said}");
}
