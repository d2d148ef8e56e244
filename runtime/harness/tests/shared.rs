//! What the programs of a system have in common besides their messages: one log, and one tree of parameters.

mod common;

use std::{cell::RefCell, rc::Rc};

use common::{ROBOT, program, sleep, system, told};
use hrdsl_harness::{
    HarnessLoop, HarnessRun, LogRecord, ParameterRequest, ProgramLogLevel, SystemAnswer, SystemPlayer,
    SystemRequest,
    doubles::{
        ToldStep::{self, Then},
        ToldSystem,
    },
};
use hrdsl_ir::value::SECOND;

/// What a program was answered: when, to which of its requests, what.
type Told = Vec<(i64, u64, SystemAnswer)>;

/// Runs programs `a`, `b`, … for at most a minute; what each was answered, if that is more than `Ok`.
fn run(programs: Vec<Vec<ToldStep>>) -> (Vec<Told>, HarnessRun) {
    let (scenario, test) = (program(), common::test(Vec::new()));
    let (systems, answers): (Vec<ToldSystem>, Vec<Rc<RefCell<Told>>>) =
        programs.into_iter().map(system).unzip();
    let named = ('a'..).map(String::from).zip(systems);
    let players = common::players(&scenario, &test, SystemPlayer::of_programs(&scenario, ROBOT, named));
    let run = HarnessLoop::new(&scenario, players, None, 60 * SECOND).run();
    let more = |told: Told| told.into_iter().filter(|(_, _, answer)| *answer != SystemAnswer::Ok).collect();
    (answers.iter().map(|answers| more(told(answers))).collect(), run)
}

/// What warns is kept with its time and its program; nobody hears of it.
#[test]
fn what_programs_log_is_counted_and_what_warns_kept() {
    let log = |level, text: &str| {
        Then(SystemRequest::Log(LogRecord { level, node: "/n".to_owned(), text: text.to_owned() }))
    };
    let a = vec![log(ProgramLogLevel::Info, "ready"), Then(sleep(2)), log(ProgramLogLevel::Warn, "low")];
    let b = vec![Then(sleep(1)), log(ProgramLogLevel::Error, "stuck")];
    let (told, run) = run(vec![a, b]);
    let kept = run.log.first.iter().map(|k| (k.time / SECOND, k.program.as_str(), k.record.text.as_str()));
    assert_eq!(kept.collect::<Vec<_>>(), [(1, "b", "stuck"), (2, "a", "low")]);
    assert_eq!(ProgramLogLevel::ALL.map(|level| run.log.count(level)), [0, 1, 1, 1, 0]);
    assert_eq!(told, [[], []]);
}

/// One tree, in the order of the requests.
#[test]
fn what_one_program_sets_the_others_see() {
    let get = |name: &str| Then(SystemRequest::Parameter(ParameterRequest::Get { name: name.into() }));
    let set = |name: &str, value: &str| {
        Then(SystemRequest::Parameter(ParameterRequest::Set { name: name.into(), value: value.into() }))
    };
    let delete = |name: &str| Then(SystemRequest::Parameter(ParameterRequest::Delete { name: name.into() }));
    let a =
        vec![set("/a/x", "1.50"), Then(sleep(2)), get("/a"), delete("/a/y"), delete("/a/y"), set("/", "1")];
    let b = vec![get("/a/x"), get("/b"), set("/a/y", "[true]"), Then(sleep(3)), get("/")];
    let (told, _) = run(vec![a, b]);
    let json = |text: &str| SystemAnswer::Json(text.into());
    let absent = |name: &str| SystemAnswer::Ended(Err(format!("there is no parameter `{name}`")));
    let error = "the root of the parameters can only be an object".to_owned();
    let both = (2, 2, json(r#"{"x":1.50,"y":[true]}"#));
    let removed = (2, 3, SystemAnswer::Ended(Ok(())));
    let refused = (2, 5, SystemAnswer::Refused { error, help: None });
    assert_eq!(told[0], [both, removed, (2, 4, absent("/a/y")), refused]);
    let seen = [(0, 0, json("1.50")), (0, 1, absent("/b")), (3, 4, json(r#"{"a":{"x":1.50}}"#))];
    assert_eq!(told[1], seen);
}
