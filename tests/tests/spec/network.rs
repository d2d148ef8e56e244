//! The page on automata is enough to tell what a network can do: a reference in Python, made from the page alone, that makes
//! every state reaches the goals that the search reaches, and no others.

use std::{
    collections::BTreeSet,
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::Program;
use hrdsl_runtime::{results::GoalStatus, testgen::generate};

use crate::page::root;

const SCENARIO: &str = include_str!("network.hri");
const CHANNELS: &str = include_str!("network_channels.hri");

/// `edge Robot: w -> v (edge 1)` is `edge Robot 1`: as the reference says it.
fn short(goal: &str) -> String {
    match (goal.split_once(':'), goal.split_once("(edge ")) {
        (Some((automaton, _)), Some((_, number))) => format!("{automaton} {}", number.trim_end_matches(')')),
        _ => goal.to_owned(),
    }
}

#[test]
fn the_reference_reaches_the_same_goals() {
    let (reached, unreachable) = compared("network.hri", SCENARIO);
    assert!(reached.len() > 25 && unreachable.len() > 6, "{reached:?}\n{unreachable:?}");
}

#[test]
fn the_reference_reaches_the_same_goals_over_channels() {
    let (reached, unreachable) = compared("network_channels.hri", CHANNELS);
    assert!(reached.len() > 20 && unreachable.len() > 10, "{reached:?}\n{unreachable:?}");
}

/// The goals that both reach, and those that neither does.
fn compared(name: &str, text: &str) -> (BTreeSet<String>, BTreeSet<String>) {
    let compilation = compile(InputFile { name, text }, &[]);
    let said: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    let program = compilation.program.unwrap_or_else(|| panic!("{said:#?}"));
    let generated = generate(&program, &program.suites[0], None, 0).unwrap();
    let of = |status| -> BTreeSet<String> {
        generated.goals.iter().filter(|g| g.status == status).map(|g| short(&g.goal.to_string())).collect()
    };
    let (reached, unreachable) = (of(GoalStatus::Reached), of(GoalStatus::Unreachable));
    let got = by_the_page(&program);
    let (more, less): (Vec<_>, Vec<_>) =
        (reached.difference(&got).collect(), got.difference(&reached).collect());
    assert!(more.is_empty() && less.is_empty(), "the search alone: {more:?}\nthe reference alone: {less:?}");
    assert_eq!(reached.len() + unreachable.len(), generated.goals.len());
    (reached, unreachable)
}

fn by_the_page(program: &Program) -> BTreeSet<String> {
    let mut child = Command::new("python3")
        .arg(root().join("tests/tests/spec/network.py"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    let given = serde_json::json!({ "program": program });
    child.stdin.take().unwrap().write_all(given.to_string().as_bytes()).unwrap();
    let got = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    got.lines().map(str::to_owned).collect()
}
