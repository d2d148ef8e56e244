//! Scripts of several actors: what they do at once in a run, and how each method of generation makes them.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_harness::{ActorPlayer, HarnessLoop, ScriptPlayer};
use hrdsl_ir::{Program, test::Test, value::SECOND};
use hrdsl_runtime::testgen::{generate, write};
use hrdsl_trace::print;

const STREET: &str = "scenario street
    actor child : environment
    actor dog   : environment
    actor robot : system
    event near     from robot
    event whistled from child to dog
    stimulus sing by child { hold 10 s }
    stimulus run(fast: bool) by child { sample far in 1 m .. 2 m; hold 2 s }
    stimulus whistle by child { emit whistled }
    stimulus follow by dog { hold 3 s }
    assume at most 2 whistled
    agent Child plays child {
      goal !play
      plan +!play { fork { sing } and { wait 1 s; run(true); whistle } }
      plan on near { run(false) }
    }
    agent Dog plays dog {
      plan on whistled { wait 2 s; follow }
      plan on run(Fast) when not Fast { follow }
    }
    automaton Robot plays robot {
      clock x
      init location idle { invariant x <= 20 s }
      location passed
      idle -> passed when x >= 20 s do near
    }
    automaton Boy plays child {
      clock x
      init location still
      location away
      still -> away when x >= 4 s do run(true)
      away  -> away when x >= 9 s do whistle
    }
    automaton Puppy plays dog {
      clock x
      init location still
      location called
      location there
      still  -> called on whistled do x = 0
      called -> there when x >= 1 s do follow
    }
    network yard = Boy | Puppy
    suite acted    by agents Child, Dog, Robot { horizon 60 s; tests 1 }
    suite searched by search of yard { reach each location }
    suite drawn    by random { stimuli whistle, follow; await whistled; await near; length 12..12; pause 0 s .. 3 s; tests 20 }";

fn program(tests: &[&str]) -> Program {
    let tests: Vec<InputFile<'_>> = tests.iter().map(|text| InputFile { name: "t.hri", text }).collect();
    let compiled = compile(InputFile { name: "street.hri", text: STREET }, &tests);
    compiled.program.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics))
}

/// What a suite makes, without what is the same for all tests.
fn made(suite: &str) -> (Program, Vec<Test>, String) {
    let program = program(&[]);
    let suite = program.suites.iter().find(|s| s.name == suite).unwrap();
    let tests = generate(&program, suite, None, 0).unwrap().tests;
    let text = write(&program, &tests);
    (program, tests, text)
}

/// What happens when a test runs, and its seconds.
fn run(program: &Program, test: &Test) -> Vec<String> {
    let players = ScriptPlayer::all(program, test).map(|p| Box::new(p) as Box<dyn ActorPlayer + '_>);
    let run = HarnessLoop::new(program, players.collect(), None, 60 * SECOND).run();
    let line = |step: &hrdsl_trace::TraceStep| {
        let (who, what) = print::who_did_what(program, &step.what);
        format!("{} {who} {what}", step.time / SECOND)
    };
    let mut lines: Vec<String> = run.trace.steps.iter().map(line).collect();
    lines.push(format!("{} {:?}", run.trace.end / SECOND, run.ended));
    lines
}

#[test]
fn scripts_run_at_once_and_hear_each_other() {
    let program = program(&["test both {
        child { meanwhile sing; run(true) with far = 1 m; whistle }
        dog { await run(_) within 60 s; wait 1 s; meanwhile follow; await whistled within 60 s; follow }
      }
      test alone { child { await near within 5 s; whistle } }
      test silent { child { } dog { } }"]);
    assert_eq!(
        run(&program, &program.tests[0]),
        [
            "0 child sing",
            "0 child run(fast: true)",
            "1 dog follow",
            "2 child whistle",
            "2 child whistled",
            "2 dog follow",
            "10 Quiescent",
        ]
    );
    assert_eq!(run(&program, &program.tests[1]), ["5 child whistle", "5 child whistled", "5 Quiescent"]);
    assert_eq!(run(&program, &program.tests[2]), ["0 Quiescent"]);
}

/// The child sings for 10 s, and does not stop to run; the dog hears the child.
#[test]
fn a_run_of_agents_is_split_by_actor() {
    let (_, tests, text) = made("acted");
    assert_eq!(tests.len(), 1, "{text}");
    let scripts = text.split_once("  child {").unwrap().1;
    let drawn = |line: &str| line.split(" with ").next().unwrap().trim().to_owned();
    let lines: Vec<String> = scripts.lines().map(drawn).filter(|line| !line.is_empty()).collect();
    assert_eq!(
        lines,
        [
            "meanwhile sing",
            "wait 1 s",
            "run(true)",
            "whistle",
            "await near within 60 s",
            "run(false)",
            "}",
            "dog {",
            "await whistled within 60 s",
            "wait 2 s",
            "follow",
            "await run(_) within 60 s",
            "follow",
            "}",
            "}"
        ]
    );
}

/// Holds take no time in the run of a network: nothing is done meanwhile, and the automata wait for each other.
#[test]
fn a_witness_is_split_by_actor() {
    let (_, _, text) = made("searched");
    let last = text.rsplit("test searched.").next().unwrap();
    let steps = last.split_once("  child {").unwrap().1;
    let lines: Vec<&str> = steps.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let [wait, run, rest, whistle, ..] = lines[..] else { panic!("{text}") };
    assert_eq!(wait, "wait 4 s");
    assert!(run.starts_with("run(true) with far = ") && rest == "wait 3 s" && whistle == "whistle", "{text}");
    let dog = last.split_once("  dog {").unwrap().1;
    let lines: Vec<&str> = dog.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    assert_eq!(lines, ["await whistled within 60 s", "wait 1 s", "follow", "}", "}"]);
}

/// The dog never awaits what it does itself; `near` is awaited by both; `whistled` happens twice at most, and 12 steps are drawn.
#[test]
fn a_random_sequence_is_split_by_actor() {
    let (program, tests, text) = made("drawn");
    assert!(text.matches("child {").count() > 15 && text.matches("dog {").count() > 15, "{text}");
    for test in text.split("\ntest ").skip(1) {
        assert!(test.matches("whistle\n").count() <= 2, "{test}");
        let (child, dog) = test.split_once("  dog {").unwrap_or((test, ""));
        assert!(
            !child.contains("follow") && !child.contains("await whistled") && !dog.contains("whistle\n"),
            "{test}"
        );
    }
    assert!(text.contains("await near") && text.contains("await whistled"), "{text}");
    // What is written is what was made.
    let again = self::program(&[&text]);
    let scripts = |tests: &[Test]| tests.iter().map(|t| t.scripts.clone()).collect::<Vec<_>>();
    assert_eq!(scripts(&again.tests), scripts(&tests));
    assert_eq!(write(&again, &again.tests), write(&program, &tests));
}
