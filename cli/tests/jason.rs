//! What Jason 3.3.2 prints, `hrdsl run` prints: small programs with their output, and the list of those that differ.
//!
//! Each line of `jason/programs.jsonl` is a program: `agents` (name → source) and `prints` (`[agent, line]`, a line being `prints TEXT`
//! or `do ACTION`), recorded with Jason 3.3.2 on Java 17, one run each, until nothing more happened. Those in `jason/departures.txt` differ,
//! each with the construct of "Where this departs from Jason" (`spec/agents-semantics.md`), or of "What becomes of programs of Jason"
//! (`spec/cli.md`) that it differs by.

mod support;

use std::{collections::BTreeMap, fs, sync::Mutex, thread};

use serde_json::Value;
use support::{command, root};

/// By agent, what it prints and does.
type AgentLines = BTreeMap<String, Vec<String>>;

struct JasonProgram {
    name: String,
    agents: Vec<(String, String)>,
    prints: AgentLines,
}

/// Names of agents begin with a capital letter here; elements of lists have a space between them.
fn alike(text: &str) -> String {
    text.replace(", ", ",").to_lowercase()
}

fn programs() -> Vec<JasonProgram> {
    let text = fs::read_to_string(root().join("cli/tests/jason/programs.jsonl")).unwrap();
    let read = |line: &str| {
        let program: Value = serde_json::from_str(line).unwrap();
        let word = |v: &Value| v.as_str().unwrap().to_owned();
        let mut prints = AgentLines::new();
        for line in program["prints"].as_array().unwrap() {
            prints.entry(word(&line[0])).or_default().push(alike(line[1].as_str().unwrap()));
        }
        let agents =
            program["agents"].as_object().unwrap().iter().map(|(n, s)| (n.clone(), word(s))).collect();
        JasonProgram { name: word(&program["name"]), agents, prints }
    };
    text.lines().map(read).collect()
}

/// What the program prints here, and what is said about it.
fn printed(program: &JasonProgram) -> (AgentLines, String) {
    let folder = tempfile::tempdir().unwrap();
    let mut run = command();
    run.arg("run").arg("--json").args(["--until", "60 s"]).current_dir(folder.path());
    for (agent, source) in &program.agents {
        fs::write(folder.path().join(format!("{agent}.asl")), source).unwrap();
        run.arg(format!("{agent}.asl"));
    }
    let out = run.output().unwrap();
    let mut lines = AgentLines::new();
    for line in support::stdout(&out).lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        let kind = if line["kind"] == "does" { "do" } else { "prints" };
        let text = alike(&format!("{kind} {}", line["text"].as_str().unwrap()));
        lines.entry(line["agent"].as_str().unwrap().to_lowercase()).or_default().push(text);
    }
    (lines, support::stderr(&out))
}

/// The programs that differ, each with what they differ by.
fn departures() -> BTreeMap<String, String> {
    let text = fs::read_to_string(root().join("cli/tests/jason/departures.txt")).unwrap();
    let rows = text.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
    rows.map(|l| l.split_once(": ").unwrap()).map(|(n, why)| (n.to_owned(), why.to_owned())).collect()
}

#[test]
fn programs_print_what_jason_prints() {
    let (programs, known) = (programs(), departures());
    let page = ["agents-semantics.md", "cli.md"]
        .map(|p| fs::read_to_string(root().join("spec").join(p)).unwrap())
        .concat();
    for (name, why) in &known {
        assert!(programs.iter().any(|p| p.name == *name), "there is no program {name}");
        assert!(page.contains(&format!("\n| {why} |")), "{name}: no row of the tables is about {why}");
    }
    let wrong = Mutex::new(Vec::new());
    let (one, other) = programs.split_at(programs.len() / 2);
    thread::scope(|scope| {
        for half in [one, other] {
            let (known, wrong) = (&known, &wrong);
            scope.spawn(move || {
                for program in half {
                    let (lines, said) = printed(program);
                    let fault = match (lines == program.prints, known.get(&program.name)) {
                        (true, Some(_)) => "it prints what Jason prints: take it off the list".to_owned(),
                        (false, None) => format!("Jason: {:?}\nhere:  {lines:?}\n{said}", program.prints),
                        (false, Some(_))
                            if !said.contains(": warning: ") && !said.contains(": left out: ") =>
                        {
                            format!("nothing is said of it:\n{said}")
                        }
                        (true, None) | (false, Some(_)) => continue,
                    };
                    wrong.lock().unwrap().push(format!("{}: {fault}", program.name));
                }
            });
        }
    });
    let mut wrong = wrong.into_inner().unwrap();
    wrong.sort();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), programs.len(), wrong.join("\n"));
    assert!(
        programs.len() - known.len() >= 187,
        "{} of {} agree",
        programs.len() - known.len(),
        programs.len()
    );
}
