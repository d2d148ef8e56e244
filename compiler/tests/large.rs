//! The scenario that the bench compiles is well formed: no errors, no warnings, and a Program.

use hrdsl_compiler::{InputFile, compile};

#[path = "../benches/large/mod.rs"]
mod large;

#[test]
fn the_generated_scenario_is_well_formed() {
    let text = large::scenario(2_000);
    assert!(text.lines().count() >= 2_000);
    let c = compile(InputFile { name: "line.hri", text: &text }, &[]);
    let said: Vec<String> = c
        .diagnostics
        .iter()
        .map(|d| format!("{} {} {}", c.files.place(d.span()), d.code, d.message))
        .collect();
    assert!(said.is_empty(), "{said:#?}");
    assert!(c.program.is_some());
}
