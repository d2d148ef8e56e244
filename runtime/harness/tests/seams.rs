//! The loop on doubles of its seams: a world, a system and a clock that do what they are told.

mod common;

use common::{
    ask, asked, await_done, close, command, emit, end, go, run, sleep, system, told, wait, wait_for,
};
use hrdsl_harness::{
    HarnessError, RunTermination, SystemAnswer, SystemArgument, SystemFault, SystemFaultKind, SystemRequest,
    doubles::{ToldClock, ToldCommand, ToldStep, ToldWorld},
};
use hrdsl_ir::{EventId, Value, value::SECOND, world::SignalId};
use hrdsl_trace::{RunEnd, TraceStepKind};

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
