//! The pages on agents and the harness are enough to write both again: a reference in Python, made from the pages alone, has
//! the same log, the same events and the same end, line by line.

use std::{
    fmt::Write as _,
    io::Write as _,
    process::{Command, Stdio},
};

use hrdsl_bdi::{
    CYCLE_LIMIT, LogDetail,
    choose::{explore, factors},
};
use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    Program, Span, Value,
    abstract_test::BeliefSet,
    bdi::AgentId,
    suite::{PlayerRef, SuiteMethod},
    value::SECOND,
};
use hrdsl_runtime::{
    harness::{HarnessError, RunTermination},
    testgen::model_run::{LogLine, ModelRunOptions, model_run},
};
use hrdsl_trace::TraceStepKind;

use crate::page::root;

#[path = "../../../runtime/bdi/tests/programs/random.rs"]
mod random;

/// Each by itself, with its name.
const SCENARIOS: [(&str, &str); 4] = [
    ("agents.hri", include_str!("agents.hri")),
    ("agents_beliefs.hri", include_str!("agents_beliefs.hri")),
    ("agents_control.hri", include_str!("agents_control.hri")),
    ("agents_messages.hri", include_str!("agents_messages.hri")),
];

pub const LIMIT: i64 = 60 * SECOND;

/// Cycles at one instant of programs that may never come to rest.
const FEW: u64 = 1500;

/// Agents that play together, with what is chosen for them.
pub type Cast = (Vec<u16>, BeliefSet);

/// What a run prints: the log, what happened, how it ended.
pub fn printed(program: &Program, text: &str, (agents, set): &Cast, cycles: u64) -> String {
    let players: Vec<PlayerRef> = agents.iter().map(|n| PlayerRef::Agent(AgentId(*n))).collect();
    let how = ModelRunOptions { seed: 0, horizon: LIMIT, detail: LogDetail::Steps, cycles };
    let run = model_run(program, &players, &set.facts, &how);
    let mut out = String::new();
    for line in &run.log {
        let _ = writeln!(out, "{}{}", line.line(), place(line, text));
    }
    for step in &run.trace.steps {
        let TraceStepKind::Event { event, args } = &step.what else { continue };
        let args: String = args.iter().map(|v: &Value| format!(" {v}")).collect();
        let _ = writeln!(out, "event {} {}{args}", step.time, program.event(*event).name);
    }
    let _ = writeln!(out, "ended: {}", ended(&run.ended));
    out
}

/// ` (line 12)` after a failure.
fn place(line: &LogLine, text: &str) -> String {
    let failed = line.kind == "failed";
    let number =
        |span: &Span| text.as_bytes()[..span.start as usize].iter().filter(|b| **b == b'\n').count() + 1;
    line.origin.as_ref().filter(|_| failed).map_or_else(String::new, |s| format!(" (line {})", number(s)))
}

fn ended(ended: &RunTermination) -> String {
    match ended {
        RunTermination::Quiescent => "quiescent".to_owned(),
        RunTermination::Limit => "horizon".to_owned(),
        RunTermination::Fault(HarnessError::Model(text)) => {
            let agent = || text.split('`').nth(1).expect("the fault names an agent");
            match () {
                () if text.contains("livelock") => format!("livelock of {}", agent()),
                () if text.contains("cycle bound") => format!("cycle bound of {}", agent()),
                () if text.contains("events at one instant") => "too many events".to_owned(),
                () => text.clone(),
            }
        }
        RunTermination::Fault(other) => other.to_string(),
    }
}

/// What the reference prints of each cast.
pub fn by_the_pages(program: &Program, text: &str, runs: &[Cast], cycles: u64) -> Vec<String> {
    let mut child = Command::new("python3")
        .arg(root().join("tests/tests/spec/agents.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is there");
    let cast = |(agents, set): &Cast| {
        let one = |agent: &u16| {
            let chosen = set.facts.iter().filter(|(a, _)| a.0 == *agent).map(|(_, f)| f);
            serde_json::json!({ "agent": agent, "chosen": chosen.collect::<Vec<_>>() })
        };
        agents.iter().map(one).collect::<Vec<_>>()
    };
    let runs: Vec<_> = runs.iter().map(cast).collect();
    let given = serde_json::json!({ "program": program, "sources": [text], "runs": runs, "limit": LIMIT,
        "cycles": cycles });
    child.stdin.take().unwrap().write_all(given.to_string().as_bytes()).unwrap();
    let all = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    all.split_terminator("\n.\n").map(|run| format!("{run}\n")).collect()
}

/// The first line in which two runs differ, with some lines before it.
pub fn difference(ours: &str, theirs: &str) -> Option<String> {
    if ours == theirs {
        return None;
    }
    let (a, b): (Vec<&str>, Vec<&str>) = (ours.lines().collect(), theirs.lines().collect());
    let at = (0..).find(|i| a.get(*i) != b.get(*i)).unwrap_or(0);
    let before = a[at.saturating_sub(8)..at].join("\n");
    let (ours, theirs) = (a.get(at).unwrap_or(&"(end)"), b.get(at).unwrap_or(&"(end)"));
    Some(format!("{before}\n  hrdsl:     {ours}\n  reference: {theirs}"))
}

/// How many events happened in the runs of one scenario.
fn compared(name: &str, text: &str) -> usize {
    let compilation = compile(InputFile { name, text }, &[]);
    let said: Vec<_> = compilation.diagnostics.iter().filter(|d| d.is_error()).collect();
    let program = compilation.program.unwrap_or_else(|| panic!("{name}: {said:#?}"));
    let suite = &program.suites[0];
    let SuiteMethod::Agents { choose, explore: how, .. } = &suite.method else { panic!("{suite:?}") };
    let sets = explore(&factors(&program, choose).unwrap(), *how, suite.settings.tests, 0).sets;
    let casts: [&[u16]; 5] = [&[0, 1, 2], &[2, 1, 0], &[1, 0], &[0, 2], &[0]];
    let runs: Vec<Cast> = casts.into_iter().map(<[u16]>::to_vec).cycle().zip(sets).collect();
    let got = by_the_pages(&program, text, &runs, CYCLE_LIMIT);
    let mut happened = 0;
    for (cast, got) in runs.iter().zip(&got) {
        let expected = printed(&program, text, cast, CYCLE_LIMIT);
        let who = format!("{name}: {:?} with {}", cast.0, cast.1.text.join(", "));
        if let Some(difference) = difference(&expected, got) {
            panic!("{who}\n{difference}");
        }
        happened += expected.lines().filter(|l| l.starts_with("event ")).count();
    }
    assert_eq!(runs.len(), got.len(), "{name}");
    happened
}

#[test]
fn the_reference_has_the_same_log() {
    let happened: usize = SCENARIOS.iter().map(|(name, text)| compared(name, text)).sum();
    assert!(happened > 2000, "only {happened} events happened");
}

/// Programs that nobody wrote: the rules meet in ways that nobody thought of.
#[test]
fn the_reference_has_the_same_log_of_random_programs() {
    let mut lines = 0;
    for seed in 0..80 {
        let agents = 2 + (seed % 3) as u16;
        let program = random::society(seed, agents);
        let cast: Cast = ((0..agents).collect(), BeliefSet::default());
        let ours = printed(&program, "", &cast, FEW);
        let theirs = by_the_pages(&program, "", &[cast], FEW);
        if let Some(difference) = difference(&ours, theirs.first().map_or("", String::as_str)) {
            panic!("seed {seed}\n{difference}");
        }
        lines += ours.lines().count();
    }
    assert!(lines > 3000, "only {lines} lines");
}

/// The harness with one thread and with many: the same log, events and end.
#[test]
fn one_thread_and_many_run_models_alike() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, many) = (pool(1), pool(4));
    for seed in 0..100 {
        let program = random::society(seed, 40);
        let cast: Cast = ((0..40).collect(), BeliefSet::default());
        let alone = one.install(|| printed(&program, "", &cast, FEW));
        assert_eq!(many.install(|| printed(&program, "", &cast, FEW)), alone, "seed {seed}");
    }
}
