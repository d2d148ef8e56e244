//! UPPAAL's models to scenarios: what they become, and what is refused.
//!
//! `HRDSL_UPDATE=1 cargo test -p hrdsl-interop --test uppaal_import` writes the expected text anew; the difference is read.
#![allow(clippy::disallowed_methods, reason = "tests read files")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource, ImportedScenario, NoteSeverity, SyntaxError,
    uppaal::{UppaalOptions, import},
};
use hrdsl_source::FileId;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/uppaal")
}

fn file(name: &str) -> ForeignSource {
    ForeignSource { name: name.to_owned(), text: fs::read_to_string(root().join(name)).unwrap() }
}

fn handover() -> ImportedScenario {
    import(&file("handover.xml"), Some(&file("handover.q")), &UppaalOptions::default()).unwrap()
}

/// A model of one template `P` with two locations, `a` and `b`.
fn model(global: &str, parameters: &str, local: &str, labels: &[(&str, &str)], system: &str) -> String {
    let escaped = |t: &str| t.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let label = |(kind, text): &(&str, &str)| format!("<label kind=\"{kind}\">{}</label>", escaped(text));
    let of =
        |kinds: &[&str]| -> String { labels.iter().filter(|l| kinds.contains(&l.0)).map(label).collect() };
    format!(
        "<nta><declaration>{}</declaration><template><name>P</name><parameter>{}</parameter>\n\
         <declaration>{}</declaration>\n<location id=\"a\"><name>a</name>{}</location><location id=\"b\"/>\n\
         <init ref=\"a\"/><transition><source ref=\"a\"/><target ref=\"b\"/>\n{}</transition></template>\n\
         <system>{}</system></nta>",
        escaped(global),
        escaped(parameters),
        escaped(local),
        of(&["invariant"]),
        of(&["select", "guard", "synchronisation", "assignment"]),
        escaped(system),
    )
}

fn from_text(text: &str, queries: &str) -> Result<ImportedScenario, Vec<SyntaxError>> {
    let model = ForeignSource { name: "m.xml".to_owned(), text: text.to_owned() };
    let queries = ForeignSource { name: "m.q".to_owned(), text: queries.to_owned() };
    import(&model, Some(&queries), &UppaalOptions::default())
}

fn edges(global: &str, local: &str, labels: &[(&str, &str)]) -> String {
    let imported =
        from_text(&model(global, "", local, labels, "system P;"), "").unwrap_or_else(|e| panic!("{e:?}"));
    is_readable(&imported.text);
    let edges = imported.text.lines().filter(|l| l.trim_start().starts_with("a -> "));
    edges.map(str::trim).collect::<Vec<_>>().join("\n")
}

/// The text can be read, and is in the style of the language.
fn is_readable(text: &str) {
    let (_, diagnostics) = hrdsl_syntax::parse(FileId(0), text);
    let said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
    assert_eq!(said, Vec::<String>::new(), "{text}");
    assert_eq!(hrdsl_syntax::format(text).unwrap(), text);
}

fn compiles(text: &str) {
    let compilation = compile(InputFile { name: "m.hri", text }, &[]);
    let wrong: Vec<String> = compilation
        .diagnostics
        .iter()
        .filter(|d| d.is_error())
        .map(|d| format!("{}: {} {}", compilation.files.place(d.span()), d.code, d.message))
        .collect();
    assert!(wrong.is_empty(), "{}\n{text}", wrong.join("\n"));
}

#[test]
fn handover_becomes_the_expected_scenario() {
    let imported = handover();
    is_readable(&imported.text);
    let path = root().join("handover.hri");
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(&path, &imported.text).unwrap();
    }
    assert_eq!(imported.text, fs::read_to_string(path).unwrap_or_default());
    let left_out: Vec<_> = imported.notes.iter().filter(|n| n.severity == NoteSeverity::LeftOut).collect();
    assert_eq!(left_out.len(), 1);
    assert!(left_out[0].message.contains("`Pr`"), "{}", left_out[0].message);
    assert_eq!((left_out[0].file.as_str(), left_out[0].column), ("handover.q", 1));
}

#[test]
fn handover_has_no_errors() {
    compiles(&handover().text);
}

#[test]
fn clocks_under_or_become_several_edges() {
    let made = edges("int n;", "clock x, y;", &[("guard", "x < 3 or (y >= n + 1 and n > 0)")]);
    assert_eq!(made, "a -> l1 when x < 3 s\na -> l1 when y >= (n + 1) * 1 s && n > 0");
    let made = edges("int n;", "clock x, y;", &[("guard", "x - x < n && y - x > x - x")]);
    assert_eq!(made, "a -> l1 when y - x > 0 s && 0 - n < 0");
    let made = edges("", "clock x;", &[("guard", "x != 4")]);
    assert_eq!(made, "a -> l1 when x < 4 s\na -> l1 when x > 4 s");
    let made = edges("", "clock x, y;", &[("guard", "!(x - y <= 2 || 7 > y)")]);
    assert_eq!(made, "a -> l1 when x - y > 2 s && y >= 7 s");
    let made = edges("bool b;", "clock x;", &[("guard", "b ? x > 1 : 2 < x")]);
    assert_eq!(made, "a -> l1 when x > 1 s && b\na -> l1 when x > 2 s && not b");
}

#[test]
fn bools_and_numbers_are_told_apart() {
    let made =
        edges("int[0,3] n; bool b;", "", &[("guard", "n and b == 1"), ("assignment", "b := n, n = b + 1")]);
    let want =
        "a -> l1 when n != 0 && if b { 1 } else { 0 } == 1 do b = n != 0; n = if b { 1 } else { 0 } + 1";
    assert_eq!(made, want);
}

#[test]
fn words_bind_looser_than_assignments_and_marks_tighter() {
    let made = edges("bool p, q, r;", "", &[("guard", "p || q and not r == p imply q")]);
    assert_eq!(made, "a -> l1 when (p || q) && not (r == p) imply q");
    let made = edges("int n, k;", "", &[("assignment", "n = k = n <? 3 >? k, k++, --n, n *= k + 1")]);
    assert_eq!(made, "a -> l1 do k = max(min(n, 3), k); n = k; k += 1; n -= 1; n = n * (k + 1)");
}

#[test]
fn quantifiers_are_expanded() {
    let global = "typedef int[1,3] id; bool f[id]; int n;";
    let labels = [("guard", "forall (i : id) f[i] || i == 2")];
    let made = edges(global, "", &labels);
    assert_eq!(made, "a -> l1 when f[0] && f[2]");
    compiles(&from_text(&model(global, "", "", &labels, "system P;"), "").unwrap().text);
}

/// Each idiom becomes a formula that checks; what it answers is a test of the command line.
#[test]
fn locations_are_counted() {
    let text = model("", "const int[0,2] i", "", &[], "system P;");
    let idioms = [
        ("A[] (sum(i : int[0,2]) P(i).a) <= 1", "if P0.a { 1 } else { 0 } + if P1.a { 1 } else { 0 } + "),
        ("A[] P(0).a + P(1).a + P(2).a <= 1", "if P0.a { 1 } else { 0 } + if P1.a { 1 } else { 0 } + "),
        ("E<> P(0).a == 1", "if P0.a { 1 } else { 0 } == 1"),
        ("E<> P(0).a == P(1).a", "P0.a == P1.a"),
        ("E<> (P(0).a ? P(1).a : P(2).a)", "if P0.a { P1.a } else { P2.a }"),
        ("E<> (P(0).a ? 1 : 2) > 1", "if P0.a { 1 } else { 2 } > 1"),
    ];
    for (query, expected) in idioms {
        let imported = from_text(&text, query).unwrap_or_else(|e| panic!("{query}: {e:?}"));
        let made = imported.text.lines().find(|l| l.starts_with("query ")).unwrap_or_default();
        assert!(made.contains(expected), "{query}: {made}");
        is_readable(&imported.text);
        compiles(&imported.text);
    }
}

#[test]
fn the_old_language_is_read() {
    let text = model(
        "const N 5; const M := 3; int[0,N] i := 2; chan c[N];",
        "const k; int &r",
        "clock x; const D k * 2;",
        &[("invariant", "x <= D, i < 9"), ("guard", "x >= M, i > 1"), ("assignment", "x := 0, r := k")],
        "Q := P(2, i); system Q;",
    );
    let text = text.replace("const D k * 2;", "const int D := k * 2;").replace("const k;", "const int k;");
    let imported = from_text(&text, "").unwrap_or_else(|e| panic!("{e:?}"));
    is_readable(&imported.text);
    assert!(imported.text.contains("init location a { invariant x <= 4 s && i < 9 }"), "{}", imported.text);
    assert!(imported.text.contains("when x >= M * 1 s && i > 1 do x = 0; i = 2"), "{}", imported.text);
    compiles(&imported.text);
}

#[test]
fn templates_are_instantiated() {
    let global = "typedef int[0,1] id; chan c[2][id]; int v[3]; clock w; void up(int &n) { n++; } \
                  int pick(const int a[3], int i) { return a[i]; }";
    let labels = [
        ("guard", "w > 2 && pick(v, k) == 0"),
        ("synchronisation", "d[k]!"),
        ("assignment", "up(r), up(mine), count -= 1, t = 0"),
    ];
    let text = model(
        global,
        "const id k, int &r, chan &d[id], clock &t, int count",
        "int mine;",
        &labels,
        "Q(const id j) = P(j, v[j + 1], c[1], w, 7); R = P(1, v[0], c[0], w, 3); system R, Q;",
    );
    let imported =
        from_text(&text, "E<> Q(1).a and R.count < 3 \n A[] forall (i : id) Q(i).mine == 0 ").unwrap();
    is_readable(&imported.text);
    assert!(imported.text.contains("network model = R | Q0 | Q1"), "{}", imported.text);
    assert!(imported.text.contains("E<> Q1.a && R.count < 3"), "{}", imported.text);
    assert!(imported.text.contains("A[] Q0.mine == 0 && Q1.mine == 0"), "{}", imported.text);
    compiles(&imported.text);
}

#[test]
fn statements_become_statements() {
    let global = "int[0,9] m[2][3] = { { 1, 2, 3 }, { 4, 5, 6 } }; const int[0,5] T[3] = { 5, 0, 2 };\n\
        int total(int upto) { int n = 0, i; for (i = 0; i < upto; i++) { n += m[1][i]; if (n > 20) return n; } \
        do { n--; } while (n > 9); while (n % 2 == 1) n = n / 2; \
        for (j : int[0,2]) { int[0,5] t = T[j]; if (t > 0) n = n + t; else { n++; } } return n >? 0; }\n\
        void swap(int &x, int &y) { int h = x; x = y; y = h; }";
    let labels = [("guard", "total(2) > 1"), ("assignment", "swap(m[0][1], m[1][2]), m[0][T[2]] = 3")];
    let imported = from_text(&model(global, "", "", &labels, "system P;"), "").unwrap();
    is_readable(&imported.text);
    assert!(imported.text.contains("m_2[0][2] = 3"), "{}", imported.text);
    compiles(&imported.text);
}

/// After flattening, the fields of a record are variables of their own.
#[test]
fn one_field_may_change_while_another_is_written() {
    let global = "typedef struct { int u; int v; } pair_t; pair_t p = { 1, 2 }; pair_t q[2];";
    let labels = [("assignment", "p.u = p.v--, q[1].u = q[0].v++")];
    let imported = from_text(&model(global, "", "", &labels, "system P;"), "").unwrap();
    assert!(imported.text.contains("p_u = p_v; p_v -= 1; q_u[1] = q_v[0]; q_v[0] += 1"), "{}", imported.text);
    compiles(&imported.text);
    for same in ["p.u = p.u--", "q[1].u = q[0].u++", "p.u = p.v-- + p.v"] {
        let errors = from_text(&model(global, "", "", &[("assignment", same)], "system P;"), "").unwrap_err();
        let why = "is changed within this statement and read elsewhere in it";
        assert!(errors.iter().any(|e| e.message.contains(why)), "{same}: {errors:?}");
    }
}

#[test]
fn a_sum_that_takes_its_comparison_in_is_warned_of() {
    let warned = |asked: &str| {
        let imported = from_text(&model("int a[3];", "", "", &[], "system P;"), asked).unwrap();
        compiles(&imported.text);
        imported.notes.iter().filter(|n| n.message.contains("`sum` goes as far as it can")).count()
    };
    assert_eq!(warned("A[] sum(i : int[0,2]) a[i] <= 1"), 1);
    assert_eq!(warned("A[] (sum(i : int[0,2]) a[i]) <= 1"), 0);
    assert_eq!(warned("A[] (sum(i : int[0,2]) (a[i] > 0)) <= 1"), 0);
}

#[test]
fn a_deadlock_along_runs_is_left_out() {
    let asked = "A<> deadlock\nP.a --> deadlock\nE<> deadlock";
    let imported = from_text(&model("", "", "", &[], "system P;"), asked).unwrap();
    compiles(&imported.text);
    assert!(imported.text.contains("E<> deadlock"), "{}", imported.text);
    let left: Vec<u32> =
        imported.notes.iter().filter(|n| n.message.contains("not along runs")).map(|n| n.line).collect();
    assert_eq!(left, [1, 2], "{:?}", imported.notes);
    assert!(imported.text.contains("//   A<> deadlock"), "{}", imported.text);
}

#[test]
fn clocks_are_not_compared_in_queries_where_one_stands() {
    let process = "process P() { clock x, y; state a, b { x' == 0 }; init a; trans a -> b {}, b -> a { guard x >= 2; }; }";
    let model = ForeignSource { name: "m.xta".to_owned(), text: format!("{process} system P;") };
    let asked = "E<> P.a and P.x - P.y < 1\nE<> P.a and P.y < 1".to_owned();
    let queries = ForeignSource { name: "m.q".to_owned(), text: asked };
    let imported = import(&model, Some(&queries), &UppaalOptions::default()).unwrap();
    compiles(&imported.text);
    assert!(imported.text.contains("stopped(x)"), "{}", imported.text);
    let left = imported.notes.iter().filter(|n| n.message.contains("where clocks stand still"));
    assert_eq!(left.map(|n| n.line).collect::<Vec<u32>>(), [1], "{:?}", imported.notes);
}

#[test]
fn names_that_mean_something_else_are_changed() {
    let text = model(
        "int actor, when, P2; clock after;",
        "",
        "int when;",
        &[("guard", "when < actor && after > 1")],
        "system P;",
    );
    let imported = from_text(&text, "").unwrap();
    is_readable(&imported.text);
    assert!(imported.text.contains("when after_ > 1 s && when_3 < actor_"), "{}", imported.text);
    assert!(
        imported.notes.iter().any(|n| n.message == "`actor` is called `actor_`: the language has that word"),
        "{:?}",
        imported.notes
    );
}

/// What is refused names what is in the way, and its place.
#[test]
fn what_a_scenario_cannot_say_is_refused_by_name() {
    let bad = [
        ("hybrid clock x;", "`hybrid`"),
        ("scalar[0] s;", "at least one value"),
        ("typedef struct { chan c; } s;", "a field of a record is a variable or a clock"),
        ("struct { int a; bool b; } s = { 1 };", "this has 1 values, and the record 2 fields"),
        ("struct { int a; } s; int n = s;", "`s` is a record: name one of its fields"),
        ("struct { int a; } s; int n = s.b;", "the record `s` has no field `b`"),
        ("double d;", "`double`"),
        ("chan a, b; chan priority a < b;", "`chan priority`"),
        ("int n = 1 << 40;", "bits are shifted by 0 to 31 places"),
        ("int n = m;", "there is no `m`"),
        ("int[0,3] n = 4;", "4 is not in the range 0..3"),
        ("int f() { return f(); }", "the function `f` calls itself, which none may: write a loop"),
        ("void f() { f(); }", "the function `f` calls itself"),
        ("clock x; int f() { x = 0; return 1; } int n = f();", "`f` sets clocks"),
        ("int a[1000];", "256"),
        ("void f() { int n; n = n++ + 1; }", "`n` is changed within this statement and read elsewhere in it"),
        ("bool b; int n; void f() { b = b && n++ > 1; }", "in a part that is not always evaluated"),
        ("int x = ;", "expected an expression, found `;`"),
        ("int x = 0x0F;", "`0x0F` is no number: UPPAAL's are decimal; write `15`"),
        ("int x = 12ms;", "`12ms` is no number: UPPAAL's are decimal; a space or an operator is missing"),
        ("int x = ~1;", "found `~`, which is no operator of UPPAAL: `-1 - x` is `x` with every bit changed"),
        ("int sum(int a) { return a; }", "`sum` is a word of UPPAAL's language: choose another name"),
        ("/* open", "not closed"),
    ];
    for (global, why) in bad {
        let errors = from_text(&model(global, "", "", &[], "system P;"), "").unwrap_err();
        assert!(errors.iter().any(|e| e.message.contains(why)), "{global}: {errors:?}");
        assert!(
            errors.iter().all(|e| e.file == "m.xml" && e.line == 1 && e.column > 18),
            "{global}: {errors:?}"
        );
    }
    let whole = [
        (model("", "", "", &[], "system P < P;"), "priorities of processes"),
        (model("", "", "", &[], "P1 = P();"), "no line `system"),
        (model("", "", "", &[], "system Q;"), "there is no template or process `Q`"),
        (model("", "int n", "", &[], "system P;"), "stands for more than"),
        (model("", "chan &c", "", &[], "system P;"), "needs an argument for `c`"),
        (model("", "", "clock x;", &[("invariant", "x' == 2")], "system P;"), "the rate 2 is not supported"),
        (model("", "", "clock x;", &[("guard", "x' == 0")], "system P;"), "a part of invariants only"),
        (
            model("", "", "clock x;", &[("invariant", "x < 1 || x > 2")], "system P;"),
            "an invariant over clocks",
        ),
        (
            model(
                "urgent chan c;",
                "",
                "clock x;",
                &[("synchronisation", "c!"), ("guard", "x > 1")],
                "system P;",
            ),
            "urgent",
        ),
        (
            model("", "", "clock c;", &[("guard", "c <= 2147483647")], "system P;"),
            "the time 2147483647 is too long: one unit of time is a second",
        ),
        (model("", "", "", &[], "system P;").replace("<init ref=\"a\"/>", ""), "no initial location"),
        (branching("", ""), "no branch leads out of this branchpoint"),
        (branching("c", "<target ref=\"c\"/>"), "not to another branchpoint"),
        (
            branching("c", "<target ref=\"b\"/><label kind=\"guard\">n &lt; 3</label>"),
            "before the branchpoint",
        ),
        (model("", "", "", &[], "system P;").replace("<init", "<blob/><init"), "an element `blob`"),
    ];
    for (text, why) in whole {
        let errors = from_text(&text, "").unwrap_err();
        assert!(errors.iter().any(|e| e.message.contains(why)), "{why}: {errors:?}");
    }
}

/// A model whose transition leads to a branchpoint `c`, with a second one from there or elsewhere.
fn branching(from: &str, rest: &str) -> String {
    let second = format!("<transition><source ref=\"{from}\"/>{rest}</transition>");
    let second = if from.is_empty() { "" } else { &second };
    model("int n; clock x;", "", "", &[("guard", "x > 1"), ("assignment", "n = 1")], "system P;")
        .replace("<init", "<branchpoint id=\"c\"/><init")
        .replace("<target ref=\"b\"/>\n", "<target ref=\"c\"/>\n")
        .replace("</template>", &format!("{second}</template>"))
}

#[test]
fn each_branch_of_a_branchpoint_may_be_taken() {
    let branch = |to: &str, weight: &str, labels: &str| {
        format!(
            "<transition><source ref=\"c\"/><target ref=\"{to}\"/>{labels}<label kind=\"probability\">{weight}</label></transition>"
        )
    };
    let branches =
        branch("a", "1", "<label kind=\"assignment\">n = n + 1, x = 0</label>") + &branch("b", "9", "");
    let text = branching("", "").replace("</template>", &format!("{branches}</template>"));
    let imported = from_text(&text, "E<> n == 2").unwrap_or_else(|e| panic!("{e:?}"));
    compiles(&imported.text);
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let edges: Vec<String> =
        imported.text.lines().map(words).filter(|line| line.starts_with("a -> ")).collect();
    assert_eq!(edges, ["a -> a when x > 1 s do n = 1; n = n + 1; x = 0", "a -> l1 when x > 1 s do n = 1"]);
    let kept: Vec<String> = imported.text.lines().map(words).filter(|l| l.starts_with("// prob")).collect();
    assert_eq!(kept, ["// probability 1", "// probability 9"]);
    assert_eq!(imported.notes.len(), 1, "{:?}", imported.notes);
    assert_eq!(imported.notes[0].severity, NoteSeverity::Info);
}

/// What only other tools of UPPAAL ask stands in comments.
#[test]
fn what_is_asked_by_games_and_statistics_alone_is_kept_as_comments() {
    let text = model("", "", "clock x;", &[("guard", "x > 1")], "system P;")
        .replace("<transition>", "<transition controllable=\"false\">")
        .replace(
            "<location id=\"b\"/>",
            "<location id=\"b\"><label kind=\"exponentialrate\">1:5</label></location>",
        );
    let imported = from_text(&text, "").unwrap_or_else(|e| panic!("{e:?}"));
    compiles(&imported.text);
    let said: Vec<&str> = imported.notes.iter().map(|note| note.message.as_str()).collect();
    assert!(
        said.len() == 2
            && said[0].starts_with("`exponentialrate` is kept")
            && said[1].starts_with("`controllable=\"false\"` of a transition is kept"),
        "{said:?}"
    );
    assert!(imported.text.contains("  // exponentialrate 1:5\n  location l1\n"), "{}", imported.text);
    assert!(imported.text.contains("  // controllable=\"false\"\n  a -> l1"), "{}", imported.text);
}

#[test]
fn queries_that_cannot_be_asked_are_left_out() {
    let text = model("int n; clock x;", "", "", &[], "system P;");
    let asked = "E<> P.a\nsimulate [<=10] { n }\nA[] P.c\n//\nE[] n < 3 and x <= 4\nP.a --> deadlock\nE<> n\nsup{P.a}: x, n\n\
                 E[<=10; 20](max: n)\nstrategy s = control: A<> P.a\nA<> not P.a \\\n  and n == 0";
    let imported = from_text(&text, asked).unwrap();
    is_readable(&imported.text);
    let queries: Vec<&str> = imported.text.lines().filter(|l| l.starts_with("query")).collect();
    assert_eq!(queries.len(), 5, "{}", imported.text);
    assert!(imported.text.contains("A<> not P.a && n == 0"), "{}", imported.text);
    assert!(imported.text.contains("sup { P.a }: x, n"), "{}", imported.text);
    let left_out: Vec<u32> =
        imported.notes.iter().filter(|n| n.severity == NoteSeverity::LeftOut).map(|n| n.line).collect();
    assert_eq!(left_out, [2, 3, 6, 9, 10]);
    compiles(&imported.text);
}

#[test]
fn comments_of_declarations_stay_with_them() {
    let global = "/* The system.\n * It counts. */\n\nconst int N = 2; // how far\ntypedef int[0,N] id; // who\n\
        int n, // counted\n k; /* kept */ chan c; // told\n// nothing follows\n\
        // ------\nconst int T[2] = { 1, 2 }; // table\n\
        /** Adds one. */ void up() { n++; /* not this */ }\n// Sets all.\nvoid all() { x = 0; }";
    let global = global.replace("void all", "clock x; // ran\nvoid all");
    let local = "// since it began\nclock t; int own; // its own\nclock u;";
    let text =
        model(&global, "", local, &[("assignment", "up(), all(), k = T[n]")], "// The line.\nsystem P;");
    let imported = from_text(&text, "").unwrap_or_else(|e| panic!("{e:?}"));
    is_readable(&imported.text);
    compiles(&imported.text);
    for expected in [
        "// The system.\n// It counts.\n// how far\nconst N = 2\n// who\n// counted\n// kept\nvar n: ",
        "// told\nchannel c\n",
        "// nothing follows\n// table\nvar T: ",
        "// Adds one.\nfn up() {\n  n += 1\n}",
        "// Sets all.\n// ran\nvar x: clock",
        "  // t: since it began\n  clock t, u\n",
        "  // its own\n  var own: ",
    ] {
        assert!(imported.text.contains(expected), "{expected}\n\n{}", imported.text);
    }
}

#[test]
fn places_are_those_of_the_file() {
    let text = model("", "", "clock x;", &[("guard", "x > 1 &&\n  x < nothing")], "system P;");
    let errors = from_text(&text, "").unwrap_err();
    let (line, at) =
        text.lines().enumerate().find_map(|(i, l)| l.find("nothing").map(|at| (i + 1, at + 1))).unwrap();
    assert_eq!((errors[0].line as usize, errors[0].column as usize), (line, at), "{errors:?}");
}
