//! Several programs play one system: what they say to each other arrives in one order, and none waits for more than it asked.

mod common;

use std::{cell::RefCell, rc::Rc};

use common::{ROBOT, ask, emit, go, program, sleep, system, told, wait};
use hrdsl_harness::{
    AwaitedPort, CallRequest, CanceledGoals, GoalEnd, HarnessError, HarnessLoop, HarnessRun,
    MachineDeclaration, MachineEdge, MachineStep, PortDeclaration, PortKind, PortQos, QosDurability,
    QosPolicy, QosReliability, RunTermination, SystemAnswer, SystemArrival, SystemFault, SystemFaultKind,
    SystemPlayer, SystemRequest, WorldStage,
    doubles::{ToldCommand, ToldStep, ToldSystem, ToldWorld},
};
use hrdsl_ir::{test::TestStep, value::SECOND};

type Told = Vec<(i64, u64, SystemAnswer)>;

/// Runs programs `a`, `b`, … for at most a minute; what each was answered.
fn run(
    test: Vec<TestStep>,
    programs: Vec<Vec<ToldStep>>,
    world: Option<ToldWorld>,
) -> (Vec<Told>, HarnessRun) {
    let (scenario, test) = (program(), common::test(test));
    let (systems, answers): (Vec<ToldSystem>, Vec<_>) = programs.into_iter().map(system).unzip();
    let named = ('a'..).map(String::from).zip(systems);
    let players = common::players(&scenario, &test, SystemPlayer::of_programs(&scenario, ROBOT, named));
    let stage = world.map(|world| WorldStage::new(&scenario, Box::new(world)));
    let run = HarnessLoop::new(&scenario, players, stage, 60 * SECOND).run();
    (answers.iter().map(told).collect(), run)
}

fn open(port: u64, kind: PortKind, name: &str) -> SystemRequest {
    open_as(port, kind, name, "std_msgs/Int8", false, 10)
}

fn open_as(port: u64, kind: PortKind, name: &str, of: &str, latched: bool, depth: usize) -> SystemRequest {
    let (name, type_name) = (name.to_owned(), of.to_owned());
    let (kept, qos) = (usize::from(latched), PortQos::default());
    SystemRequest::Open(PortDeclaration { port, kind, name, type_name, kept, depth, qos })
}

/// A publisher or subscriber of ROS 2, at `/n`.
fn open_with(
    port: u64,
    kind: PortKind,
    depth: usize,
    (reliability, durability): (QosReliability, QosDurability),
) -> SystemRequest {
    let qos = PortQos { reliability: Some(reliability), durability: Some(durability) };
    let kept = if durability == QosDurability::TransientLocal { depth } else { 0 };
    let (name, type_name) = ("/n".to_owned(), "std_msgs/msg/Int8".to_owned());
    SystemRequest::Open(PortDeclaration { port, kind, name, type_name, kept, depth, qos })
}

fn publish(port: u64, text: &str) -> SystemRequest {
    SystemRequest::Publish { port, message: text.into() }
}

fn call(port: u64, call: u64, text: &str) -> SystemRequest {
    CallRequest::Begin { port, call, message: text.into() }.into()
}

fn arrivals() -> SystemRequest {
    SystemRequest::Wait { until: None, give_up: None }
}

fn until(until: Option<i64>, give_up: Option<i64>) -> SystemRequest {
    SystemRequest::Wait { until: until.map(|t| t * SECOND), give_up: give_up.map(|t| t * SECOND) }
}

fn message(port: u64, text: &str) -> SystemArrival {
    SystemArrival::Message { port, message: text.into() }
}

fn arrived(arrivals: Vec<SystemArrival>) -> SystemAnswer {
    SystemAnswer::Arrived { arrivals, gave_up: false }
}

fn refused(error: &str) -> SystemAnswer {
    SystemAnswer::Refused { error: error.into(), help: None }
}

/// The answers that are more than `Ok`.
fn said(told: &Told) -> Vec<(i64, u64, SystemAnswer)> {
    told.iter().filter(|(_, _, answer)| *answer != SystemAnswer::Ok).cloned().collect()
}

use PortKind::{ActionClient, ActionServer, Client, Publisher, Server, Subscriber};
use ToldStep::{Ask, Then};

#[test]
fn messages_reach_those_who_subscribed_the_newest_of_a_full_queue() {
    let a = vec![
        Then(sleep(1)),
        Then(open(1, Publisher, "/n")),
        Then(publish(1, "1")),
        Then(publish(1, "2")),
        Then(publish(1, "3")),
        Then(SystemRequest::Done),
    ];
    let waits_at_once = vec![Then(open(5, Subscriber, "/n")), Then(arrivals()), Then(arrivals())];
    let sleeps = vec![
        Then(open_as(7, Subscriber, "/n", "std_msgs/Int8", false, 2)),
        Then(open(8, Subscriber, "/m")),
        Then(sleep(4)),
        Then(arrivals()),
    ];
    let (told, _) = run(Vec::new(), vec![a, waits_at_once, sleeps], None);
    assert_eq!(said(&told[0]), []);
    let each =
        [(1, 1, arrived(vec![message(5, "1")])), (1, 2, arrived(vec![message(5, "2"), message(5, "3")]))];
    assert_eq!(said(&told[1]), each);
    assert_eq!(said(&told[2]), [(4, 3, arrived(vec![message(7, "2"), message(7, "3")]))]);
}

#[test]
fn a_latched_message_is_given_to_those_who_come_later() {
    let a = vec![
        Then(open_as(1, Publisher, "/map", "nav_msgs/Map", true, 1)),
        Then(publish(1, "old")),
        Then(publish(1, "new")),
    ];
    let b = vec![
        Then(sleep(2)),
        Then(open_as(1, Subscriber, "/map", "nav_msgs/Map", false, 1)),
        Then(arrivals()),
        Then(SystemRequest::Close { port: 1 }),
        Then(open_as(1, Subscriber, "/map", "nav_msgs/Map", false, 1)),
        Then(arrivals()),
    ];
    let (told, _) = run(Vec::new(), vec![a, b], None);
    let new = arrived(vec![message(1, "new")]);
    assert_eq!(said(&told[1]), [(2, 2, new.clone()), (2, 5, new)]);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let a = vec![
        Then(open(1, Publisher, "/n")),
        Then(open(1, Publisher, "/m")),
        Then(open_as(2, Subscriber, "/n", "std_msgs/String", false, 1)),
        Then(publish(9, "0")),
        Then(open(3, Subscriber, "/n")),
        Then(publish(3, "0")),
        Then(open(4, Server, "/s")),
        Then(open(5, Server, "/s")),
        Then(call(1, 1, "0")),
        Then(CallRequest::Respond { call: 3, answer: Ok("0".into()) }.into()),
        Then(SystemRequest::Close { port: 8 }),
    ];
    let (told, _) = run(Vec::new(), vec![a], None);
    let expected = [
        (0, 1, refused("the port 1 is open already")),
        (0, 2, refused("the topic `/n` is of type `std_msgs/Int8`, not `std_msgs/String`")),
        (0, 3, refused("no port 9 is open")),
        (0, 5, refused("the port 3 is a subscriber, not a publisher")),
        (0, 7, refused("the service `/s` has a server already")),
        (0, 8, refused("the port 1 is a publisher, which calls nobody")),
        (0, 9, refused("there is no call 3 to answer")),
        (0, 10, refused("no port 8 is open")),
    ];
    assert_eq!(said(&told[0]), expected);
}

/// Who subscribes late gets as much of what was published as both keep, if it asks for that.
#[test]
fn transient_local_messages_are_for_subscribers_that_are_so_too() {
    use QosDurability::{TransientLocal, Volatile};
    use QosReliability::Reliable;
    let publisher = vec![
        Then(open_with(1, Publisher, 3, (Reliable, TransientLocal))),
        Then(publish(1, "1")),
        Then(publish(1, "2")),
        Then(publish(1, "3")),
        Then(publish(1, "4")),
        Then(sleep(1)),
        Then(publish(1, "5")),
        Then(SystemRequest::Done),
    ];
    let late = vec![
        Then(open_with(1, Subscriber, 9, (Reliable, TransientLocal))),
        Then(open_with(2, Subscriber, 2, (Reliable, TransientLocal))),
        Then(open_with(3, Subscriber, 9, (Reliable, Volatile))),
        Then(open_as(4, Subscriber, "/n", "std_msgs/msg/Int8", false, 9)),
        Then(arrivals()),
        Then(arrivals()),
        Then(arrivals()),
        Then(arrivals()),
        Then(arrivals()),
    ];
    let (told, _) = run(Vec::new(), vec![publisher, late], None);
    let kept = [(1, "2"), (1, "3"), (1, "4"), (2, "3"), (2, "4"), (4, "2"), (4, "3"), (4, "4")];
    let messages =
        |all: &[(u64, &str)]| arrived(all.iter().map(|(port, text)| message(*port, text)).collect());
    let said = said(&told[1]);
    assert_eq!(said[0], (0, 4, messages(&kept)));
    let new: Vec<&SystemAnswer> = said[1..].iter().map(|(_, _, answer)| answer).collect();
    assert_eq!(new, [&messages(&[(1, "5")]), &messages(&[(2, "5"), (3, "5"), (4, "5")])]);
}

#[test]
fn who_requests_more_than_is_offered_hears_nothing_and_both_are_told() {
    use QosDurability::{TransientLocal, Volatile};
    use QosReliability::{BestEffort, Reliable};
    let incompatible = |port, policy| SystemArrival::Incompatible { port, policy };
    let publisher = vec![
        Then(open_with(1, Publisher, 1, (BestEffort, Volatile))),
        Then(sleep(1)),
        Then(publish(1, "1")),
        Then(arrivals()),
    ];
    let subscriber = vec![
        Then(open_with(5, Subscriber, 9, (Reliable, Volatile))),
        Then(open_with(6, Subscriber, 9, (BestEffort, TransientLocal))),
        Then(open_with(7, Subscriber, 9, (BestEffort, Volatile))),
        Then(open_as(8, Subscriber, "/n", "std_msgs/msg/Int8", false, 9)),
        Then(arrivals()),
        Then(sleep(2)),
        Then(arrivals()),
    ];
    let (told, _) = run(Vec::new(), vec![publisher, subscriber], None);
    let both = [QosPolicy::Reliability, QosPolicy::Durability];
    assert_eq!(said(&told[0]), [(1, 3, arrived(both.map(|policy| incompatible(1, policy)).to_vec()))]);
    let expected = [
        (0, 4, arrived(vec![incompatible(5, both[0]), incompatible(6, both[1])])),
        (2, 6, arrived(vec![message(7, "1"), message(8, "1")])),
    ];
    assert_eq!(said(&told[1]), expected);
}

#[test]
fn a_service_answers_fails_or_is_not_there() {
    let client = vec![
        Then(open(1, Client, "/add")),
        Then(call(1, 40, "early")),
        Then(arrivals()),
        Then(sleep(1)),
        Then(call(1, 41, "[1,2]")),
        Then(call(1, 42, "[]")),
        Then(arrivals()),
        Then(arrivals()),
        Then(call(1, 43, "[3]")),
        Then(arrivals()),
    ];
    let server = vec![
        Then(sleep(1)),
        Then(open(6, Server, "/add")),
        Then(arrivals()),
        Then(CallRequest::Respond { call: 1, answer: Ok("3".into()) }.into()),
        Then(arrivals()),
        Then(sleep(2)),
        Then(CallRequest::Respond { call: 2, answer: Err("nothing to add".into()) }.into()),
        Then(arrivals()),
        Then(SystemRequest::Done),
    ];
    // The server is served first, so that it is there when the client calls at the same instant.
    let (told, _) = run(Vec::new(), vec![server, client], None);
    let called = |call: u64, text: &str| SystemArrival::Called { port: 6, call, message: text.into() };
    let server = [
        (1, 2, arrived(vec![called(1, "[1,2]")])),
        (1, 4, arrived(vec![called(2, "[]")])),
        (3, 7, arrived(vec![called(3, "[3]")])),
    ];
    assert_eq!(said(&told[0]), server);
    let answered = |call, answer| arrived(vec![SystemArrival::Answered { call, answer }]);
    let client = [
        (0, 2, answered(40, Err("the service `/add` has no server".into()))),
        (1, 6, answered(41, Ok("3".into()))),
        (3, 7, answered(42, Err("nothing to add".into()))),
        (3, 9, answered(43, Err("the server of the service `/add` has gone".into()))),
    ];
    assert_eq!(said(&told[1]), client);
}

#[test]
fn an_action_gives_feedback_and_ends_or_is_canceled() {
    let server = vec![
        Then(open(1, ActionServer, "/move")),
        Then(arrivals()),
        Then(CallRequest::AnswerCancel { call: 1, granted: true, text: String::new() }.into()),
        Then(CallRequest::Accept { call: 1, text: "on the way".into() }.into()),
        Then(CallRequest::Accept { call: 1, text: String::new() }.into()),
        Then(CallRequest::Feedback { call: 1, message: "0.5".into() }.into()),
        Then(sleep(1)),
        Then(finish(1, GoalEnd::Succeeded, "there")),
        Then(arrivals()),
        Then(arrivals()),
        Then(CallRequest::AnswerCancel { call: 2, granted: false, text: "nearly there".into() }.into()),
        Then(arrivals()),
        Then(CallRequest::AnswerCancel { call: 2, granted: true, text: String::new() }.into()),
        Then(finish(2, GoalEnd::Canceled, "")),
    ];
    let client = vec![
        Then(open(1, ActionClient, "/move")),
        Then(call(1, 7, "home")),
        Then(arrivals()),
        Then(arrivals()),
        Then(arrivals()),
        Then(call(1, 7, "away")),
        Then(sleep(2)),
        Then(CallRequest::Cancel(CanceledGoals::Own(7)).into()),
        Then(arrivals()),
        Then(CallRequest::Cancel(CanceledGoals::AllAt(1)).into()),
        Then(arrivals()),
        Then(CallRequest::Cancel(CanceledGoals::Own(7)).into()),
        Then(CallRequest::Cancel(CanceledGoals::AllAt(1)).into()),
        Then(CallRequest::Cancel(CanceledGoals::AllAt(2)).into()),
    ];
    let (told, _) = run(Vec::new(), vec![server, client], None);
    let called = |call, text: &str| SystemArrival::Called { port: 1, call, message: text.into() };
    let canceled = || arrived(vec![SystemArrival::Canceled { port: 1, call: 2 }]);
    let server = [
        (0, 1, arrived(vec![called(1, "home")])),
        (0, 2, refused("nobody asks to cancel the goal 1")),
        (0, 4, refused("the goal 1 was accepted before")),
        (1, 8, arrived(vec![called(2, "away")])),
        (3, 9, canceled()),
        (3, 11, canceled()),
    ];
    assert_eq!(said(&told[0]), server);
    let answered =
        |granted, text: &str| SystemArrival::CancelAnswered { call: 7, granted, text: text.into() };
    let finished = |end, text: &str| {
        let (message, text) = ("{}".into(), text.into());
        SystemArrival::Finished { call: 7, end, message, text }
    };
    let client = [
        (0, 2, arrived(vec![SystemArrival::Accepted { call: 7, text: "on the way".into() }])),
        (0, 3, arrived(vec![SystemArrival::Feedback { call: 7, message: "0.5".into() }])),
        (1, 4, arrived(vec![finished(GoalEnd::Succeeded, "there")])),
        (3, 8, arrived(vec![answered(false, "nearly there")])),
        (3, 10, arrived(vec![answered(true, "")])),
        (3, 13, refused("no port 2 is open")),
    ];
    assert_eq!(said(&told[1]), client);
}

fn finish(call: u64, end: GoalEnd, text: &str) -> SystemRequest {
    CallRequest::Finish { call, end, message: "{}".into(), text: text.into() }.into()
}

#[test]
fn only_a_goal_can_be_accepted_or_canceled() {
    let server = vec![
        Then(open(1, Server, "/add")),
        Then(arrivals()),
        Then(CallRequest::Accept { call: 1, text: String::new() }.into()),
        Then(finish(1, GoalEnd::Aborted, "")),
        Then(CallRequest::Accept { call: 9, text: String::new() }.into()),
    ];
    let client = vec![
        Then(open(1, Client, "/add")),
        Then(call(1, 5, "[]")),
        Then(CallRequest::Cancel(CanceledGoals::Own(5)).into()),
        Then(CallRequest::Cancel(CanceledGoals::AllAt(1)).into()),
    ];
    let (told, _) = run(Vec::new(), vec![server, client], None);
    let expected = [
        (0, 1, arrived(vec![SystemArrival::Called { port: 1, call: 1, message: "[]".into() }])),
        (0, 2, refused("the call 1 asks a service, and is no goal")),
        (0, 3, refused("the call 1 asks a service, and is no goal")),
        (0, 4, refused("there is no call 9 to answer")),
    ];
    assert_eq!(said(&told[0]), expected);
    let expected = [
        (0, 2, refused("the call 5 asks a service, which cannot be canceled")),
        (0, 3, refused("the port 1 is a client, not an action client")),
    ];
    assert_eq!(said(&told[1]), expected);
}

/// A wait for nothing in particular ends by what comes first; an event at the very instant at which it is given up still counts.
#[test]
fn waits_end_by_time_or_by_what_arrives() {
    let takes = ToldCommand { takes: 3 * SECOND, ends: Err("it slipped".into()) };
    let world = ToldWorld::new(Vec::new(), vec![("arm", "go", takes)]);
    let SystemRequest::Command(go) = go() else { panic!() };
    let a = vec![
        Then(SystemRequest::Begin { call: 5, command: go }),
        Then(until(Some(1), Some(2))),
        Then(until(None, Some(2))),
        Then(until(None, Some(4))),
        Then(until(None, Some(4))),
        Then(until(None, Some(5))),
        Then(SystemRequest::Done),
    ];
    let (told, run) = run(vec![wait(2), ask(4)], vec![a], Some(world));
    assert!(matches!(run.ended, RunTermination::Quiescent));
    let nothing = |gave_up| SystemAnswer::Arrived { arrivals: Vec::new(), gave_up };
    let args = [("n".to_owned(), hrdsl_ir::Value::Int(4))].into();
    let asked = SystemArrival::Event { name: "asked".into(), args, time: 2 * SECOND };
    let ended = SystemArrival::Ended { call: 5, how: Err("it slipped".into()) };
    let expected = [
        (1, 1, nothing(false)),
        (2, 2, arrived(vec![asked])),
        (3, 3, arrived(vec![ended])),
        (4, 4, nothing(true)),
        (5, 5, nothing(true)),
    ];
    assert_eq!(said(&told[0]), expected);
}

#[test]
fn who_asks_what_is_open_is_told_of_the_next_change() {
    let a = vec![
        Then(SystemRequest::List),
        Then(arrivals()),
        Then(SystemRequest::List),
        Then(until(Some(3), None)),
    ];
    let b = vec![Then(sleep(1)), Then(open(4, Server, "/s")), Then(sleep(3)), Then(SystemRequest::Done)];
    let (told, _) = run(Vec::new(), vec![a, b], None);
    let listed = SystemAnswer::Listed(vec![hrdsl_harness::PortListing {
        kind: Server,
        name: "/s".into(),
        type_name: "std_msgs/Int8".into(),
        program: "b".into(),
    }]);
    let expected = [
        (0, 0, SystemAnswer::Listed(Vec::new())),
        (1, 1, arrived(vec![SystemArrival::Changed])),
        (1, 2, listed),
        (3, 3, arrived(Vec::new())),
    ];
    assert_eq!(said(&told[0]), expected);
}

/// All hear what their actor hears; none hears what another program of its own actor makes.
#[test]
fn events_reach_every_program_of_the_actor() {
    let a = vec![Then(arrivals()), Then(emit("done")), Then(arrivals())];
    let b = vec![Then(arrivals()), Then(arrivals())];
    let (told, _) = run(vec![wait(1), ask(1)], vec![a, b], None);
    for told in &told {
        let heard = said(told);
        assert_eq!(heard.len(), 1, "{heard:?}");
        assert!(matches!(&heard[0], (1, _, SystemAnswer::Arrived { arrivals, .. }) if arrivals.len() == 1));
    }
}

#[test]
fn a_fault_names_its_program_and_the_others_are_not_at_fault() {
    let fault = SystemFault { message: "it broke".into(), kind: SystemFaultKind::Program };
    let fails = vec![Then(sleep(1)), ToldStep::Fail(fault.clone())];
    let (_, run_of_two) = run(Vec::new(), vec![vec![Ask(sleep(9))], fails.clone()], None);
    let RunTermination::Fault(HarnessError::System(named)) = run_of_two.ended else { panic!() };
    assert_eq!(named.message, "program `b`: it broke");
    let (_, alone) = run(Vec::new(), vec![fails], None);
    let RunTermination::Fault(HarnessError::System(named)) = alone.ended else { panic!() };
    assert_eq!(named, fault);
}

/// The order of the programs decides at one instant, whatever they do.
#[test]
fn programs_are_served_in_their_order() {
    let order = Rc::new(RefCell::new(Vec::new()));
    let talk = |port: u64| {
        vec![
            Then(open(port, Publisher, "/n")),
            Then(open(port + 10, Subscriber, "/n")),
            Then(sleep(1)),
            Then(publish(port, &port.to_string())),
            Then(sleep(1)),
            Then(arrivals()),
        ]
    };
    let (told, _) = run(Vec::new(), vec![talk(1), talk(2), talk(3)], None);
    for told in &told {
        let heard: Vec<String> = told
            .iter()
            .filter_map(|(_, _, answer)| match answer {
                SystemAnswer::Arrived { arrivals, .. } => Some(arrivals),
                _ => None,
            })
            .flatten()
            .map(|a| {
                if let SystemArrival::Message { message, .. } = a {
                    message.to_string()
                } else {
                    String::new()
                }
            })
            .collect();
        order.borrow_mut().push(heard);
    }
    assert_eq!(*order.borrow(), vec![vec!["1", "2", "3"]; 3]);
}

/// What was open in a run is known when it is over, also of programs that have closed it or have ended.
#[test]
fn the_run_tells_who_had_which_port_and_who_waited_in_vain() {
    let awaits = |kind, name: &str, give_up: Option<i64>| {
        let give_up = give_up.map(|t| t * SECOND);
        SystemRequest::Await(AwaitedPort { kind, name: name.to_owned(), type_name: None, give_up })
    };
    let a = vec![
        Then(open(1, Subscriber, "/scan")),
        Then(SystemRequest::Close { port: 1 }),
        Then(open(1, Subscriber, "/scan")),
        Then(awaits(Client, "/plan", None)),
        Then(awaits(Client, "/served", None)),
        Then(awaits(ActionClient, "/short", Some(3))),
        Then(arrivals()),
    ];
    let b = vec![Then(sleep(2)), Then(open(9, Server, "/served")), Then(SystemRequest::Done)];
    let (_, run) = run(vec![wait(9)], vec![a, b], None);
    let uses: Vec<(PortKind, &str, Option<&str>)> =
        run.ports.uses.iter().map(|u| (u.kind, u.name.as_str(), u.program.as_deref())).collect();
    let expected = [
        (Subscriber, "/scan", Some("a")),
        (Server, "/served", Some("b")),
        (Client, "/plan", Some("a")),
        (Client, "/served", Some("a")),
        (ActionClient, "/short", Some("a")),
    ];
    assert_eq!(uses, expected);
    let waits: Vec<(&str, &str, i64)> =
        run.ports.waits.iter().map(|w| (w.program.as_str(), w.name.as_str(), w.since)).collect();
    assert_eq!(waits, [("a", "/plan", 0)]);
}

/// Each step of a machine is a step of the trace; of several programs, each machine is called by its own first.
#[test]
fn state_machines_are_written_down() {
    let edge = MachineEdge { from: "A".into(), outcome: "go".into(), to: "B".into() };
    let declared = MachineDeclaration {
        machine: "M".into(),
        states: vec!["A".into(), "B".into()],
        transitions: vec![edge.clone()],
        outcomes: Vec::new(),
    };
    let a = vec![
        Then(SystemRequest::Machine(MachineStep::Declared(declared))),
        Then(SystemRequest::Machine(MachineStep::Begun { machine: "M".into(), state: "A".into() })),
        Then(sleep(2)),
        Then(SystemRequest::Machine(MachineStep::Moved { machine: "M".into(), edge })),
        Then(emit("done")),
    ];
    let shown = |run: &HarnessRun| -> Vec<String> {
        let scenario = program();
        let text = |s: &hrdsl_trace::TraceStep| {
            let (_, what) = hrdsl_trace::print::who_did_what(&scenario, &s.what);
            format!("{} {what}", s.time / SECOND)
        };
        run.trace.steps.iter().map(text).collect()
    };
    let (_, alone) = run(Vec::new(), vec![a.clone()], None);
    let steps = ["0 M has 2 states and 1 transitions", "0 M begins in A", "2 M: A -go-> B", "2 done"];
    assert_eq!(shown(&alone), steps);
    let (_, of_two) = run(Vec::new(), vec![a, vec![Then(sleep(1))]], None);
    assert_eq!(shown(&of_two)[2], "2 a/M: A -go-> B");
}
