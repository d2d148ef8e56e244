//! Many of one thing cost in proportion to their number: four times as many, at most five times the work. What is counted is
//! memory that is asked for, which is the same in every run; the times of the same texts are in the bench `many`.

use hrdsl_compiler::{CompilationResult, InputFile, compile};

#[path = "../benches/many/mod.rs"]
mod many;

/// Small texts pay for what is there once, such as the library's names.
const FEW: usize = 500;

fn compiled(text: &str) -> CompilationResult {
    compile(InputFile { name: "many.hri", text }, &[])
}

/// How many times memory is asked for, and how many bytes in all.
fn work(text: &str) -> (u64, u64) {
    let info = allocation_counter::measure(|| drop(compiled(text)));
    (info.count_total, info.bytes_total)
}

#[test]
fn four_times_as_many_cost_at_most_five_times_as_much() {
    let mut wrong = Vec::new();
    for (name, make) in many::SHAPES {
        let (few, many) = (make(FEW), make(4 * FEW));
        // What is kept for the whole process is paid for once.
        drop(compiled(&many));
        let (few, many) = (work(&few), work(&many));
        if many.0 > 5 * few.0 || many.1 > 5 * few.1 {
            wrong.push(format!("{name}: {few:?} became {many:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The many findings of a text are of one kind, or few; they are not about everything else as well.
#[test]
fn what_has_no_world_is_said_once() {
    let text = many::SHAPES.iter().find(|s| s.0 == "requirements without a world").map(|s| s.1(20)).unwrap();
    let c = compiled(&text);
    assert_eq!(c.diagnostics.len(), 1, "{:?}", c.diagnostics);
    assert!(c.diagnostics[0].message.contains("and 39 more need a world"), "{}", c.diagnostics[0].message);
}
