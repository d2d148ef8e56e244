//! Several programs play one system: what they say to each other arrives in one order, and none waits for more than it asked.

mod common;

use std::{cell::RefCell, rc::Rc};

use common::{ROBOT, ask, emit, go, program, sleep, system, told, wait};
use hrdsl_harness::{
    ActorPlayer, GoalEnd, HarnessError, HarnessLoop, HarnessRun, PortDeclaration, PortKind, RunTermination,
    ScriptPlayer, SystemAnswer, SystemArrival, SystemFault, SystemFaultKind, SystemPlayer, SystemRequest,
    WorldStage,
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
    let players: Vec<Box<dyn ActorPlayer + '_>> = vec![
        Box::new(ScriptPlayer::new(&scenario, &test)),
        Box::new(SystemPlayer::of_programs(&scenario, ROBOT, named)),
    ];
    let stage = world.map(|world| WorldStage::new(&scenario, Box::new(world)));
    let run = HarnessLoop::new(&scenario, players, stage, 60 * SECOND).run();
    (answers.iter().map(told).collect(), run)
}

fn open(port: u64, kind: PortKind, name: &str) -> SystemRequest {
    open_as(port, kind, name, "std_msgs/Int8", false, 10)
}

fn open_as(port: u64, kind: PortKind, name: &str, of: &str, latched: bool, depth: usize) -> SystemRequest {
    let (name, type_name) = (name.to_owned(), of.to_owned());
    SystemRequest::Open(PortDeclaration { port, kind, name, type_name, latched, depth })
}

fn publish(port: u64, text: &str) -> SystemRequest {
    SystemRequest::Publish { port, message: text.into() }
}

fn call(port: u64, call: u64, text: &str) -> SystemRequest {
    SystemRequest::Call { port, call, message: text.into() }
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
        Then(SystemRequest::Respond { call: 3, answer: Ok("0".into()) }),
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
        Then(SystemRequest::Respond { call: 1, answer: Ok("3".into()) }),
        Then(arrivals()),
        Then(sleep(2)),
        Then(SystemRequest::Respond { call: 2, answer: Err("nothing to add".into()) }),
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
        Then(SystemRequest::Feedback { call: 1, message: "0.5".into() }),
        Then(sleep(1)),
        Then(SystemRequest::Finish { call: 1, end: GoalEnd::Succeeded, message: "{}".into() }),
        Then(arrivals()),
        Then(arrivals()),
        Then(SystemRequest::Finish { call: 2, end: GoalEnd::Canceled, message: "{}".into() }),
    ];
    let client = vec![
        Then(open(1, ActionClient, "/move")),
        Then(call(1, 7, "home")),
        Then(arrivals()),
        Then(arrivals()),
        Then(call(1, 7, "away")),
        Then(sleep(2)),
        Then(SystemRequest::Cancel { call: 7 }),
        Then(arrivals()),
        Then(SystemRequest::Cancel { call: 7 }),
    ];
    let (told, _) = run(Vec::new(), vec![server, client], None);
    let called = |call, text: &str| SystemArrival::Called { port: 1, call, message: text.into() };
    let server = [
        (0, 1, arrived(vec![called(1, "home")])),
        (1, 5, arrived(vec![called(2, "away")])),
        (3, 6, arrived(vec![SystemArrival::Canceled { port: 1, call: 2 }])),
    ];
    assert_eq!(said(&told[0]), server);
    let finished = |end| SystemArrival::Finished { call: 7, end, message: "{}".into() };
    let client = [
        (0, 2, arrived(vec![SystemArrival::Feedback { call: 7, message: "0.5".into() }])),
        (1, 3, arrived(vec![finished(GoalEnd::Succeeded)])),
        (3, 7, arrived(vec![finished(GoalEnd::Canceled)])),
    ];
    assert_eq!(said(&told[1]), client);
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
