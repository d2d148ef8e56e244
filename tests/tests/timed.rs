//! The conformance suite of automata: each section of `spec/timed` is a small network with queries and their answers. The
//! interpreter of clock regions and the search must both give them.
//!
//! A block `hri,net` is a scenario. The comment on the line of a query is its answer: `// holds`, `// fails`, or `// fault` if
//! the model is at fault.

#[path = "timed/answers.rs"]
mod answers;
#[path = "../../runtime/ta/tests/common/oracle/mod.rs"]
mod oracle;
#[path = "spec/page.rs"]
#[allow(dead_code, reason = "the pages of the specification need the rest")]
mod page;

use std::{collections::BTreeSet, fs};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::Program;

use page::{Block, pages, root, shown, split};

/// As many networks as there must be.
const ENOUGH: usize = 90;

#[test]
fn every_network_has_its_answers() {
    let (mut faults, mut networks) = (Vec::new(), 0);
    let mut seen = BTreeSet::new();
    for path in pages(&root().join("spec/timed")) {
        let text = fs::read_to_string(&path).unwrap();
        for block in split(&text).0 {
            let place = format!("{}:{}", shown(&path), block.line);
            networks += 1;
            if !seen.insert(block.text.clone()) {
                faults.push(format!("{place}: the same network twice"));
            }
            faults.extend(checked(&block).into_iter().map(|f| format!("{place}: {f}")));
        }
    }
    assert!(faults.is_empty(), "{} faults in {networks} networks:\n{}", faults.len(), faults.join("\n"));
    assert!(networks >= ENOUGH, "only {networks} networks of {ENOUGH}");
}

/// What is wrong with a network.
fn checked(block: &Block) -> Vec<String> {
    if block.info != "hri,net" {
        return vec![format!("a block `{}`, not `hri,net`", block.info)];
    }
    let program = match compiled(&block.text) {
        Ok(program) => program,
        Err(said) => return vec![said],
    };
    let mut faults = Vec::new();
    if program.queries.is_empty() {
        faults.push("no query".to_owned());
    }
    for query in &program.queries {
        let line = block.text[..query.origin.start as usize].matches('\n').count();
        let text = block.text.lines().nth(line).unwrap_or_default();
        let expected = text.rsplit_once("// ").map_or("no answer", |(_, answer)| answer.trim());
        for (by, got) in [
            ("regions", answers::by_regions(&program, query)),
            ("search", answers::by_search(&program, query)),
        ] {
            if got != expected {
                faults.push(format!("{}: {expected} is expected, the {by} say: {got}", text.trim()));
            }
        }
    }
    faults
}

fn compiled(text: &str) -> Result<Program, String> {
    let compilation = compile(InputFile { name: "network.hri", text }, &[]);
    let errors = compilation.diagnostics.iter().filter(|d| d.is_error());
    let said: Vec<String> =
        errors.map(|d| format!("{} {}: {}", compilation.files.place(d.span()), d.code, d.message)).collect();
    if said.is_empty() { compilation.program.ok_or("no program".to_owned()) } else { Err(said.join("\n")) }
}
