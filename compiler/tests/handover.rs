//! The reference scenario.

use hrdsl_compiler::{Compilation, Input, compile};

const SCENARIO: &str = include_str!("../../examples/handover/scenario.hri");

fn compiled(text: &str) -> Compilation {
    compile(Input { name: "scenario.hri", text }, &[])
}

fn listing(c: &Compilation) -> String {
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
