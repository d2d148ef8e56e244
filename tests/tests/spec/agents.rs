//! The pages on agents and the harness are enough to write both again: a reference in Python, made from the pages alone, has
//! the same traces.

use std::{
    fmt::Write as _,
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_bdi::choose::{BeliefSet, explore, factors};
use hrdsl_compiler::{Input, compile};
use hrdsl_ir::{
    Program, Value,
    bdi::{AgentId, Fact},
    suite::Method,
    value::SECOND,
};
use hrdsl_runtime::harness::{AgentPlayer, Ended, Harness, Player};
use hrdsl_trace::What;

use crate::page::root;

/// Each by itself, with its name.
const SCENARIOS: [(&str, &str); 4] = [
    ("agents.hri", include_str!("agents.hri")),
    ("agents_beliefs.hri", include_str!("agents_beliefs.hri")),
    ("agents_control.hri", include_str!("agents_control.hri")),
    ("agents_messages.hri", include_str!("agents_messages.hri")),
];

const LIMIT: i64 = 60 * SECOND;

fn chosen(set: &BeliefSet, agent: u16) -> Vec<Fact> {
    set.facts.iter().filter(|(a, _)| a.0 == agent).map(|(_, f)| f.clone()).collect()
}

fn trace(program: &Program, agents: &[u16], set: &BeliefSet) -> String {
    let play = |n: &u16| -> Box<dyn Player + '_> {
        Box::new(AgentPlayer::new(program, AgentId(*n), &chosen(set, *n), 0))
    };
    let run = Harness::new(program, agents.iter().map(play).collect(), None, LIMIT).run();
    assert!(!matches!(run.ended, Ended::Fault(_)), "{:?}", run.ended);
    let mut lines = String::new();
    for step in &run.trace.steps {
        let What::Event { event, args } = &step.what else { continue };
        let args: String = args.iter().map(|v: &Value| format!(" {v}")).collect();
        let _ = writeln!(lines, "{} {}{args}", step.time, program.event(*event).name);
    }
    lines
}

/// What the reference prints of several casts, each ended by a line `.`: the log, the events, and how the run ended.
fn by_the_pages(program: &Program, text: &str, runs: &[(&[u16], BeliefSet)]) -> String {
    let mut child = Command::new("python3")
        .arg(root().join("tests/tests/spec/agents.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    let cast = |(agents, set): &(&[u16], BeliefSet)| {
        agents
            .iter()
            .map(|a| serde_json::json!({ "agent": a, "chosen": chosen(set, *a) }))
            .collect::<Vec<_>>()
    };
    let runs: Vec<_> = runs.iter().map(cast).collect();
    let given = serde_json::json!({ "program": program, "sources": [text], "runs": runs, "limit": LIMIT });
    child.stdin.take().unwrap().write_all(given.to_string().as_bytes()).unwrap();
    String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap()
}

/// The events of one run, as the reference prints them.
fn events(printed: &str) -> String {
    let lines = printed.lines().filter_map(|line| line.strip_prefix("event "));
    lines.map(|line| format!("{line}\n")).collect()
}

/// How many events happened in the runs of one scenario.
fn compared(name: &str, text: &str) -> usize {
    let compilation = compile(Input { name, text }, &[]);
    let said: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    let program = compilation.program.unwrap_or_else(|| panic!("{name}: {said:#?}"));
    let suite = &program.suites[0];
    let Method::Agents { choose, explore: how, .. } = &suite.method else { panic!("{suite:?}") };
    let sets = explore(&factors(&program, choose).unwrap(), *how, suite.tests, 0).sets;
    let casts: [&[u16]; 5] = [&[0, 1, 2], &[2, 1, 0], &[1, 0], &[0, 2], &[0]];
    let runs: Vec<(&[u16], BeliefSet)> = casts.into_iter().cycle().zip(sets).collect();
    let got = by_the_pages(&program, text, &runs);
    let mut happened = 0;
    for ((agents, set), got) in runs.iter().zip(got.split("\n.\n")) {
        let (expected, got) = (trace(&program, agents, set), events(got));
        let who = format!("{name}: {agents:?} with {}", set.text.join(", "));
        let first = expected.lines().zip(got.lines()).enumerate().find(|(_, (e, g))| e != g);
        assert!(first.is_none(), "{who}: line, hrdsl, reference: {first:?}\n{expected}");
        assert_eq!(expected.lines().count(), got.lines().count(), "{who}\n{expected}\n{got}");
        happened += expected.lines().count();
    }
    happened
}

#[test]
fn the_reference_has_the_same_traces() {
    let happened: usize = SCENARIOS.iter().map(|(name, text)| compared(name, text)).sum();
    assert!(happened > 2000, "only {happened} events happened");
}
