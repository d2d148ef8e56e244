//! The reference scenario.

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_ir::Provenance;

const SCENARIO: &str = include_str!("../../examples/handover/scenario.hri");

fn compiled(text: &str) -> CompilationResult {
    compile(InputFile { name: "scenario.hri", text }, &[])
}

fn listing(c: &CompilationResult) -> String {
    let line = |d: &hrdsl_source::Diagnostic| {
        let (place, text) = (c.files.place(d.span()), c.files.text(d.span()));
        format!("{place}: {} {} [{text}] help: {}\n", d.code, d.message, d.help.as_deref().unwrap_or("-"))
    };
    c.diagnostics.iter().map(line).collect()
}

#[test]
fn it_compiles_without_a_word() {
    let c = compiled(SCENARIO);
    assert_eq!(listing(&c), "");
    assert!(c.program.is_some());
}

#[test]
fn its_program_means_what_it_says() {
    let p = compiled(SCENARIO).program.unwrap();
    let names = |signals: &[hrdsl_ir::world::Signal], recorded: bool| -> Vec<String> {
        signals.iter().filter(|s| s.recorded == recorded).map(|s| s.name.clone()).collect()
    };
    let for_the_world = [
        "range(person.head, robot.torso)",
        "touches(leg1, stand)",
        "tilt(leg1)",
        "touches(leg2, stand)",
        "tilt(leg2)",
        "touches(leg3, stand)",
        "tilt(leg3)",
        "touches(leg4, stand)",
        "tilt(leg4)",
    ];
    assert_eq!(names(&p.signals, false), for_the_world);
    let whose = |name: &str| p.provenance(p.event_named(name).unwrap());
    assert_eq!(whose("released"), Provenance::Said);
    assert_eq!(whose("gripper_closing"), Provenance::Commanded);
    assert_eq!(whose("leg_request"), Provenance::Played);
    assert_eq!(whose("let_go"), Provenance::Seen);
    // The code asks, and somebody must be there to be sensed.
    assert_eq!(whose("sensed"), Provenance::Seen);
    assert!(names(&p.signals, true).iter().any(|n| n == "joint_speed(robot.arm)"));
    let world = p.world.as_ref().unwrap();
    let graspable = |g: &hrdsl_ir::world::Gripper| g.holds.len();
    assert_eq!(world.grippers.iter().map(graspable).collect::<Vec<_>>(), [4, 4, 4]);
    // Asking is a stimulus and the event that it emits: two edges with a committed location between them.
    let person = p.automata.iter().find(|a| a.name == "Person").unwrap();
    let asks = person.locations.iter().position(|l| l.name == "idle.asked~1").unwrap();
    let sent = |e: &&hrdsl_ir::ta::Edge| match &e.sync {
        hrdsl_ir::ta::SyncLabel::Send { event, .. } => p.event(*event).name.clone(),
        hrdsl_ir::ta::SyncLabel::Offer { .. }
        | hrdsl_ir::ta::SyncLabel::Accept { .. }
        | hrdsl_ir::ta::SyncLabel::Join { .. }
        | hrdsl_ir::ta::SyncLabel::Internal
        | hrdsl_ir::ta::SyncLabel::Receive { .. } => String::new(),
    };
    let into = person.edges.iter().find(|e| usize::from(e.to.0) == asks).unwrap();
    let out = person.edges.iter().find(|e| usize::from(e.from.0) == asks).unwrap();
    assert_eq!((sent(&into), sent(&out)), ("ask_leg".to_owned(), "leg_request".to_owned()));
    assert_eq!(into.updates.len(), 2);
    let labels: Vec<&str> = p.agents[0].plans.iter().map(|p| p.label.as_str()).collect();
    assert_eq!(labels[..3], ["table#1", "table#2", "reach_out#1"]);
    assert_eq!(p.coverage.crosses[0].bins.len(), 14);
}

/// Whatever is missing, the compiler says so, and does not break.
#[test]
fn no_line_is_needed_to_survive() {
    let lines: Vec<&str> = SCENARIO.lines().collect();
    for missing in 0..lines.len() {
        let mut left = lines.clone();
        left.remove(missing);
        let without = compiled(&left.join("\n"));
        assert_eq!(without.program.is_none(), without.has_errors());
        let start = compiled(&lines[..missing].join("\n"));
        assert_eq!(start.program.is_none(), start.has_errors());
    }
}

/// Two runs say and make the same, to the byte.
#[test]
fn compiling_is_deterministic() {
    let twice = [(); 2].map(|()| format!("{:?}", compiled(&SCENARIO.replace("person", "persn"))));
    assert_eq!(twice[0], twice[1]);
}
