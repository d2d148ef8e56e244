//! What a process keeps for ever: the names of enumerations' values, the enumerations and the types of lists that it has met,
//! each once. Checking the same text again adds nothing; editing it adds what is new in it.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_source::InternedTotals;

fn scenario(values: &str) -> String {
    format!(
        "scenario s\nactor person : environment\nactor robot : system\nenum Pace {{ {values} }}\n\
         event asked(pace: Pace) from person to robot\nstimulus ask(pace: Pace) by person {{ emit asked(pace) }}\n\
         agent Human plays person {{ belief heard(all: [Pace]) plan +!start {{ ask({first}) }} }}\n",
        first = values.split(',').next().unwrap_or("")
    )
}

fn check(text: &str) {
    let compiled = compile(InputFile { name: "s.hri", text }, &[]);
    assert!(compiled.program.is_some(), "{:#?}", compiled.diagnostics);
}

/// One test, since the totals are the whole process's.
#[test]
fn only_what_is_new_is_kept() {
    check(&scenario("slow, fast"));
    let before = InternedTotals::now();
    for _ in 0..1_000 {
        check(&scenario("slow, fast"));
    }
    assert_eq!(InternedTotals::now(), before, "the same text again must add nothing");
    let (edits, word) = (200, "x".repeat(200));
    for length in 1..=edits {
        check(&scenario(&format!("slow, {}", &word[..length])));
    }
    let after = InternedTotals::now();
    assert_eq!(after.names - before.names, edits, "an edit of a value adds one name");
    assert_eq!(after.enumerations - before.enumerations, edits, "and one enumeration");
}
