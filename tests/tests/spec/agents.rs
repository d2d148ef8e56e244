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

const SCENARIO: &str = include_str!("agents.hri");

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

/// The traces of several casts, each ended by a line `.`.
fn by_the_pages(program: &Program, runs: &[(&[u16], BeliefSet)]) -> String {
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
    let given = serde_json::json!({ "program": program, "runs": runs, "limit": LIMIT });
    child.stdin.take().unwrap().write_all(given.to_string().as_bytes()).unwrap();
    String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap()
}

#[test]
fn the_reference_has_the_same_traces() {
    let compilation = compile(Input { name: "agents.hri", text: SCENARIO }, &[]);
    let said: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    let program = compilation.program.unwrap_or_else(|| panic!("{said:#?}"));
    let suite = &program.suites[0];
    let Method::Agents { choose, explore: how, .. } = &suite.method else { panic!("{suite:?}") };
    let sets = explore(&factors(&program, choose).unwrap(), *how, suite.tests, 0).sets;
    let casts: [&[u16]; 5] = [&[0, 1, 2], &[2, 1, 0], &[1, 0], &[0, 2], &[0]];
    let runs: Vec<(&[u16], BeliefSet)> = casts.into_iter().cycle().zip(sets).collect();
    let got = by_the_pages(&program, &runs);
    let mut events = 0;
    for ((agents, set), got) in runs.iter().zip(got.split(".\n")) {
        let expected = trace(&program, agents, set);
        let who = format!("{agents:?} with {}", set.text.join(", "));
        let first = expected.lines().zip(got.lines()).enumerate().find(|(_, (e, g))| e != g);
        assert!(first.is_none(), "{who}: line, hrdsl, reference: {first:?}\n{expected}");
        assert_eq!(expected.lines().count(), got.lines().count(), "{who}\n{expected}\n{got}");
        events += expected.lines().count();
    }
    assert!(events > 1500, "only {events} events happened in {} runs", runs.len());
}
