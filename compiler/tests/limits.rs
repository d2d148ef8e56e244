//! Texts that would cost time, memory or stack without end: each is answered at once, most with HR0005.

use std::fmt::Write;

use hrdsl_compiler::{CompilationResult, InputFile, compile};

fn codes(text: &str) -> Vec<String> {
    let mut codes: Vec<String> = compiled(text).diagnostics.iter().map(|d| d.code.to_string()).collect();
    codes.dedup();
    codes
}

fn compiled(text: &str) -> CompilationResult {
    compile(InputFile { name: "scenario.hri", text }, &[])
}

fn too_much(text: &str) {
    let codes = codes(text);
    assert!(codes.iter().any(|c| c == "HR0005"), "{codes:?} for {}…", &text[..text.len().min(200)]);
}

/// `make(0)`, `make(1)`, …
fn lines(n: usize, make: impl Fn(usize) -> String) -> String {
    (0..n).fold(String::from("scenario much\n"), |mut all, i| {
        all.push_str(&make(i));
        all
    })
}

#[test]
fn indices_and_fields_in_a_row_are_levels() {
    for n in [1_000, 20_000] {
        too_much(&format!("scenario much\nconst A = b{}\n", "[0]".repeat(n)));
        too_much(&format!("scenario much\nconst A = b[0]{}\n", ".x".repeat(n)));
        too_much(&format!("scenario much\nevent e(x: bool{}) from b\n", "[1]".repeat(n)));
    }
    let few = format!("scenario few\nconst A = 1\nrecord R {{ x: bool{} }}\n", "[1]".repeat(100));
    assert!(compiled(&few).program.is_some(), "{:?}", codes(&few));
}

#[test]
fn a_dotted_name_is_one_level() {
    let text = format!("scenario few\nconst A = {}\n", "a.b || ".repeat(400) + "c.d");
    assert!(!codes(&text).contains(&"HR0005".to_owned()));
}

#[test]
fn a_chain_of_constants_may_be_long() {
    let text = lines(50_000, |i| format!("const A{i} = A{} + 0\n", i + 1)) + "const A50000 = 1\n";
    assert!(compiled(&text).program.is_some(), "{:?}", codes(&text));
    let cycle = lines(50_000, |i| format!("const A{i} = A{}\n", (i + 1) % 50_000));
    assert_eq!(codes(&cycle), ["HR0208"]);
}

#[test]
fn records_in_records_are_levels() {
    too_much(
        &(lines(20_000, |i| format!("record R{i} {{ x: R{} }}\n", i + 1)) + "record R20000 { x: bool }\n"),
    );
    let empty =
        lines(50, |i| format!("record R{i} {{ x: R{}, y: R{} }}\n", i + 1, i + 1)) + "record R50 { }\n";
    assert_eq!(codes(&empty), ["HR0105"]);
}

#[test]
fn tuples_of_tuples_have_at_most_256_values() {
    let text = lines(40, |i| format!("const A{i} = (A{}, A{})\n", i + 1, i + 1)) + "const A40 = 1\n";
    assert_eq!(codes(&text), ["HR0206"]);
}

#[test]
fn what_is_written_out_for_single_values_is_limited() {
    let of = |n: usize| format!("{}abs(ball.x / 1 m){}", "norm((1, 1) * ".repeat(n), ")".repeat(n));
    let text = |n| {
        format!(
            "scenario much\nactor r: system\nworld {{\n  body ball: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n  \
             signal s: number to r = {}\n}}\n",
            of(n)
        )
    };
    assert!(compiled(&text(5)).program.is_some(), "{:?}", codes(&text(5)));
    too_much(&text(40));
}

#[test]
fn parts_in_parts_make_a_limited_world() {
    let part = |i: usize| {
        let uses = ["a", "b", "c", "d"].map(|n| format!("  part {n} = p{} at (0 m, 0 m, 0 m)\n", i + 1));
        format!("part p{i} {{\n{}}}\n", uses.concat())
    };
    let body = "part p14 { body b: fixed sphere(1 m) at (0 m, 0 m, 0 m) }\n";
    too_much(&(lines(14, part) + body + "world { part r = p0 at (0 m, 0 m, 0 m) }\n"));
    too_much(&(lines(14, part) + body));
}

#[test]
fn ids_are_never_wrong() {
    too_much(&(lines(70_000, |i| format!("event e{i} from a\n")) + "actor a: environment\n"));
    too_much(&(lines(70_000, |i| format!("var v{i}: bool = false\n")) + "actor a: environment\n"));
    let plans = (0..70_000).fold(String::new(), |mut all, i| {
        let _ = writeln!(all, "plan +!g{i} {{ }}");
        all
    });
    too_much(&format!("scenario much\nactor a: environment\nagent A plays a {{\n goal !g0\n{plans}}}\n"));
}

#[test]
fn what_stimuli_emit_on_edges_is_limited() {
    let text = format!(
        "scenario much\nactor p: environment\nevent e from p\nstimulus s by p {{ {}}}\nautomaton A plays p {{\n  \
         init location a\n{}}}\n",
        "emit e; ".repeat(400),
        "  a -> a do s\n".repeat(400)
    );
    too_much(&text);
}

#[test]
fn the_static_help_gives_up_in_time() {
    let plans: String = (0..20)
        .map(|i| {
            let goals: Vec<String> = (0..20).map(|j| format!("!g{j}")).collect();
            format!("  plan +!g{i} {{ {} }}\n", goals.join("; "))
        })
        .collect();
    let goals = format!("scenario much\nactor p: environment\nagent A plays p {{\n  goal !g0\n{plans}}}\n");
    assert!(!compiled(&goals).has_errors());
    let beliefs: Vec<String> = (0..14).map(|i| format!("b(X{i})")).collect();
    let beliefs = beliefs.join(" && ");
    let plan = |x: &str| format!("  plan +!g when {beliefs} && b(Y) && Y > 7 && X0 > {x} {{ e }}\n");
    let many = format!(
        "scenario much\nactor p: environment\nevent e from p\nagent A plays p {{\n  belief b(x: 0..9) = b(1)\n  goal !g\n{}{}}}\n",
        plan("X1"),
        plan("X2")
    );
    assert!(!compiled(&many).has_errors(), "{:?}", codes(&many));
}

/// As when a module is missing: the nearest name is looked for only in the first of them.
#[test]
fn many_unknown_names_among_many_names() {
    let text = lines(10_000, |i| format!("event event_{i} from a\nassume at most 1 evnet_{i} within 1 s\n"));
    let c = compiled(&(text + "actor a: environment\n"));
    assert_eq!(c.diagnostics.len(), 10_000);
    assert!(c.diagnostics[0].help.is_some() && c.diagnostics[9_999].help.is_none());
}

/// An error at a character of several bytes points between characters.
#[test]
fn a_label_is_not_within_a_character() {
    let c = compiled("scenario s\nagent A plays b { plan +!go { ask é s } }\n");
    for span in c.diagnostics.iter().flat_map(|d| d.labels.iter().map(|l| l.span)) {
        assert!(c.files.get(span.file).is_some_and(|f| f.text.get(span.range()).is_some()), "{span:?}");
    }
}

#[test]
fn a_part_in_itself_is_not_taken_apart_again() {
    let part = "part p {\n  part a = p at (0 m, 0 m, 0 m)\n  part b = p at (0 m, 0 m, 0 m)\n}\n";
    let world = "world { part w = p at (0 m, 0 m, 0 m) }\n";
    assert_eq!(codes(&format!("scenario much\n{part}{world}")), ["HR0801"]);
}
