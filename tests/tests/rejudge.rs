//! A recording is judged as the run was: monitors and coverage need nothing but the trace.

use std::{fs, path::Path, sync::Mutex};

use hrdsl_compiler::{Input, compile};
use hrdsl_coverage::Collector;
use hrdsl_monitor::{Checker, Outcome};
use hrdsl_runtime::{
    campaign::{Campaign, Cells, ProgramLimits, StopFlag, Supervisor, prepare},
    testgen::generate,
};

#[test]
fn a_recording_is_judged_as_the_run_was() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let dir = root.join("examples/handover");
    let text = fs::read_to_string(dir.join("scenario.hri")).unwrap();
    let program = compile(Input { name: "scenario.hri", text: &text }, &[]).program.unwrap();
    let run = &program.system.as_ref().unwrap().run;
    let env = prepare(run, &dir, &root.join("target/hrdsl-cache"), &|_| {}).unwrap();
    let supervisor = Supervisor::program(env!("CARGO_BIN_EXE_supervise-cell"));
    let campaign = Campaign {
        program: &program,
        cells: Cells::probe(supervisor, &dir, None).unwrap(),
        dir,
        env,
        limits: ProgramLimits::default(),
        variables: Vec::new(),
        keep: None,
        jobs: 2,
        stop: StopFlag::default(),
    };
    let tests: Vec<_> =
        program.suites.iter().flat_map(|s| generate(&program, s, Some(4), 11).unwrap().tests).collect();
    let recordings = Mutex::new(vec![String::new(); tests.len()]);
    let results = campaign
        .run(&tests, |done| {
            recordings.lock().unwrap()[done.index] = done.recording.to_owned();
            Ok(())
        })
        .unwrap()
        .tests;

    let mut outcomes = Vec::new();
    for (result, recording) in results.iter().zip(recordings.into_inner().unwrap()) {
        let (header, trace) = hrdsl_trace::parse::parse(&program, &recording).unwrap();
        assert_eq!(header.test.as_deref(), Some(result.name.as_str()));
        let mut checker = Checker::new(&program);
        trace.replay(&mut checker);
        for (again, first) in checker.verdicts().iter().zip(&result.verdicts) {
            let again_outcome = match again.outcome {
                Outcome::Pass => "pass",
                Outcome::Fail => "fail",
                Outcome::NotChecked => "not_checked",
                Outcome::Open => "open",
            };
            assert_eq!(again_outcome, first.outcome, "{} {}", result.name, first.requirement);
            assert_eq!((again.triggered, again.failures), (first.triggered, first.failures));
            outcomes.push(again_outcome);
        }
        let mut collector = Collector::new(&program);
        trace.replay(&mut collector);
        assert_eq!(collector.finish().cross_names(&program.coverage), result.bins, "{}", result.name);
    }
    outcomes.sort_unstable();
    outcomes.dedup();
    assert!(outcomes.len() >= 3, "tests of one outcome only show little: {outcomes:?}");
}
