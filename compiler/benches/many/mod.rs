//! Texts with many of one thing: distinct, twice the same, wrong, or unused. Each takes time and memory in proportion to its
//! length, or is refused with an error that says so.

use std::fmt::Write;

/// A name, and the text with so many of it.
pub type Shape = (&'static str, fn(usize) -> String);

const HEAD: &str = "scenario many
actor p : environment
actor r : system
event e from p to r
event f from r to p
stimulus s by p { emit e }
";

/// `make(0)`, `make(1)`, … between two texts.
fn all(before: &str, n: usize, make: impl Fn(usize) -> String, after: &str) -> String {
    let mut text = format!("{HEAD}{before}");
    for i in 0..n {
        text.push_str(&make(i));
    }
    text + after
}

/// `make(0)` sep `make(1)` …, on lines of ten.
fn list(n: usize, separator: &str, make: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for i in 0..n {
        let between = if i == 0 { "" } else { separator };
        let _ = write!(text, "{between}{}{}", if i % 10 == 9 { "\n  " } else { " " }, make(i));
    }
    text
}

fn agent(n: usize, before: &str, make: impl Fn(usize) -> String) -> String {
    all(&format!("agent A plays p {{\n{before}"), n, make, "}\nsuite a by agents A { }\n")
}

fn automaton(n: usize, before: &str, make: impl Fn(usize) -> String) -> String {
    let before = format!("automaton A plays p {{\n{before}");
    all(&before, n, make, "}\nnetwork net = A\nsuite a by search of net { reach each edge }\n")
}

fn world(n: usize, make: impl Fn(usize) -> String) -> String {
    all("world {\n", n, make, "}\n")
}

/// Everything that may be declared many times, and that may be wrong many times.
pub const SHAPES: &[Shape] = &[
    ("events", |n| all("", n, |i| format!("event e{i} from p to r\n"), "")),
    ("the same event", |n| all("", n, |_| "event again from p to r\n".into(), "")),
    ("events in one declaration", |n| {
        all(&format!("event {} from p to r\n", list(n, ",", |i| format!("e{i}"))), 0, |_| String::new(), "")
    }),
    ("parameters", |n| {
        all(
            &format!("event many({}) from p to r\n", list(n, ",", |i| format!("x{i}: bool"))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("the same parameter", |n| {
        all(
            &format!("event many({}) from p to r\n", list(n, ",", |_| "x: bool".into())),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("stimuli", |n| all("", n, |i| format!("stimulus s{i} by p {{ emit e }}\n"), "")),
    ("steps of a stimulus", |n| all("stimulus many by p {\n", n, |_| "emit e;\n".into(), "hold 1 s }\n")),
    ("actors", |n| all("", n, |i| format!("actor a{i} : environment\n"), "")),
    ("the same actor", |n| all("", n, |_| "actor a : environment\n".into(), "")),
    ("constants", |n| all("", n, |i| format!("const A{i} = {i}\n"), "")),
    ("the same constant", |n| all("", n, |_| "const A = 1\n".into(), "")),
    ("a sum of constants", |n| all("const A0 = 1\n", n, |i| format!("const A{} = A{i} + 1\n", i + 1), "")),
    ("names of an enumeration", |n| {
        all(
            &format!("enum E {{ {} }}\nvar v: E\n", list(n, ",", |i| format!("name_{i}"))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("the same name of an enumeration", |n| {
        all(
            &format!("enum E {{ {} }}\nvar v: E\n", list(n, ",", |_| "again".into())),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("enumerations", |n| all("", n, |i| format!("enum E{i} {{ one_{i}, two }}\n"), "")),
    ("records", |n| all("", n, |i| format!("record R{i} {{ x: bool }}\n"), "")),
    ("fields", |n| {
        all(
            &format!("record R {{ {} }}\n", list(n, ",", |i| format!("x{i}: bool"))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("variables", |n| all("", n, |i| format!("var v{i}: bool = false\n"), "")),
    ("the same variable", |n| all("", n, |_| "var v: bool = false\n".into(), "")),
    ("functions", |n| all("", n, |i| format!("fn f{i}() -> bool {{ return true }}\n"), "")),
    ("functions that call", |n| {
        all(
            "fn f0() -> bool { return true }\n",
            n,
            |i| format!("fn f{}() -> bool {{ return f{i}() }}\n", i + 1),
            "",
        )
    }),
    ("statements", |n| all("var v: bool\nfn f() {\n", n, |_| "  v = true;\n".into(), "}\n")),
    ("channels", |n| all("", n, |i| format!("channel c{i}\n"), "")),
    ("agents", |n| all("", n, |i| format!("agent A{i} plays p {{\n  goal !g\n  plan +!g {{ s }}\n}}\n"), "")),
    ("the same agent", |n| all("", n, |_| "agent A plays p {\n  goal !g\n  plan +!g { s }\n}\n".into(), "")),
    ("agents in a suite", |n| {
        all(
            "",
            n,
            |i| {
                format!(
                    "agent A{i} plays p {{\n  belief b(x: 0..3) = b({})\n  goal !g\n  plan +!g when b(2) {{ s }}\n}}\n",
                    i % 4
                )
            },
            &format!("suite all by agents {} {{ }}\n", list(n, ",", |i| format!("A{i}"))),
        )
    }),
    ("plans of many goals", |n| agent(n, "  goal !g0\n", |i| format!("  plan +!g{i} {{ !g{} }}\n", i + 1))),
    ("plans of one goal", |n| {
        agent(n, "  belief b(x: 0..9) = b(1)\n  goal !g\n", |i| {
            format!("  plan +!g when b({}) {{ s }}\n", i % 10)
        })
    }),
    ("the same plan", |n| agent(n, "  goal !g\n", |_| "  plan +!g { s }\n".into())),
    ("plans for an event", |n| {
        agent(n, "  belief b(x: 0..9) = b(1)\n", |i| format!("  plan on f when b({}) {{ s }}\n", i % 10))
    }),
    ("steps of a plan", |n| {
        agent(n, "  goal !g\n  plan +!g {\n", |_| "s;\n".into()).replacen("}\nsuite", "s } }\nsuite", 1)
    }),
    ("steps that bind", |n| {
        agent(n, "  belief b(x: 0..9) = b(1)\n  goal !g\n  plan +!g {\n", |i| format!("?b(X{i});\n"))
            .replacen("}\nsuite", "s } }\nsuite", 1)
    }),
    ("beliefs", |n| agent(n, "", |i| format!("  belief b{i}(x: 0..9) = b{i}(1)\n"))),
    ("the same belief", |n| agent(n, "", |_| "  belief b(x: 0..9) = b(1)\n".into())),
    ("beliefs that plans change", |n| {
        agent(n, "  goal !g\n", |i| {
            format!("  belief b{i}(x: 0..9)\n  plan +!g when b{i}(X) {{ -+b{i}(X) }}\n")
        })
    }),
    ("goals", |n| agent(n, "  plan +!g { s }\n", |_| "  goal !g\n".into())),
    ("rules", |n| {
        agent(
            n,
            "  belief b(x: 0..9) = b(1)\n  belief c(x: 0..9)\n  goal !g\n  plan +!g when c(X) { s }\n",
            |_| "  rule c(X) :- b(X)\n".into(),
        )
    }),
    ("automata", |n| {
        all("", n, |i| format!("automaton A{i} plays p {{\n  init location l\n  l -> l do e\n}}\n"), "")
    }),
    ("the same automaton", |n| {
        all("", n, |_| "automaton A plays p {\n  init location l\n  l -> l do e\n}\n".into(), "")
    }),
    ("automata in a network", |n| {
        all(
            "",
            n,
            |i| format!("automaton A{i} {{\n  init location l\n}}\n"),
            &format!("network all = {}\n", list(n, " |", |i| format!("A{i}"))),
        )
    }),
    ("instances", |n| {
        all(
            "automaton T(n: 0..9) plays p {\n  init location l\n  l -> l do e\n}\n",
            n,
            |i| format!("automaton A{i} = T({})\n", i % 10),
            "",
        )
    }),
    ("locations", |n| {
        automaton(n, "  init location l0\n", |i| {
            format!("  location l{}\n  l{i} -> l{} do e\n", i + 1, i + 1)
        })
    }),
    ("the same location", |n| automaton(n, "  init location l\n", |_| "  location again\n".into())),
    ("unreached locations", |n| automaton(n, "  init location l\n", |i| format!("  location l{i}\n"))),
    ("edges", |n| {
        automaton(n, "  init location l\n  var v: 0..9\n", |i| {
            format!("  l -> l when v == {} do e; v = {}\n", i % 10, i % 7)
        })
    }),
    ("edges of committed locations", |n| {
        automaton(n, "  init committed location l0\n", |i| {
            format!("  committed location l{}\n  l{i} -> l{}\n", i + 1, i + 1)
        })
    }),
    ("clocks", |n| {
        automaton(n, "  init location l\n", |i| {
            format!("  clock x{i}\n  l -> l when x{i} > 1 s do e; x{i} = 0\n")
        })
    }),
    ("clocks that nothing reads", |n| automaton(n, "  init location l\n", |i| format!("  clock x{i}\n"))),
    ("own variables", |n| {
        automaton(n, "  init location l\n", |i| {
            format!("  var v{i}: 0..9\n  l -> l when v{i} > 1 do e; v{i} = 0\n")
        })
    }),
    ("variables that nothing reads", |n| {
        automaton(n, "  init location l\n", |i| format!("  var v{i}: 0..9\n"))
    }),
    ("networks", |n| all("automaton A {\n  init location l\n}\n", n, |i| format!("network n{i} = A\n"), "")),
    ("queries", |n| {
        all(
            "automaton A {\n  init location l\n  var v: 0..9\n}\nnetwork net = A\n",
            n,
            |i| format!("query q{i} of net = E<> A.l and A.v == {}\n", i % 10),
            "",
        )
    }),
    ("the same query", |n| {
        all(
            "automaton A {\n  init location l\n}\nnetwork net = A\n",
            n,
            |_| "query q of net = E<> A.l\n".into(),
            "",
        )
    }),
    ("requirements", |n| {
        all("", n, |i| format!("require R{i} safety e causes f within {} s\n", 1 + i % 9), "")
    }),
    ("the same requirement", |n| all("", n, |_| "require R safety e causes f within 1 s\n".into(), "")),
    ("requirements without a world", |n| {
        all("", n, |i| format!("require R{i} safety globally distance(a, b) > 1 m\n"), "")
    }),
    ("assumptions", |n| all("", n, |_| "assume at most 3 e within 10 s\n".into(), "")),
    ("events of a requirement", |n| {
        all(
            &format!("require R safety e causes {} within 1 s\n", list(n, " or", |_| "f".into())),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("points", |n| all("", n, |i| format!("cover c{i} = count(e) bins none = 0, some = 1..\n"), "")),
    ("the same point", |n| all("", n, |_| "cover c = count(e) bins none = 0, some = 1..\n".into(), "")),
    ("bins of a point", |n| {
        all(
            &format!("cover c = count(e) bins {}\n", list(n, ",", |i| format!("b{i} = {i}"))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("bins of a point that overlap", |n| {
        all(
            &format!("cover c = count(e) bins {}\n", list(n, ",", |i| format!("b{i} = 0.."))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("the same bin of a point", |n| {
        all(
            &format!("cover c = count(e) bins {}\n", list(n, ",", |i| format!("b = {i}"))),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("bins of a cross", |n| {
        all(
            &format!(
                "cover c = count(e) bins {}\ncover d = count(f) bins none = 0, some = 1..\ncross x = c * d {{\n",
                list(40, ",", |i| format!("b{i} = {i}"))
            ),
            n,
            |i| format!("  bin \"{i}\" when c.b{} && not c.b{}\n", i % 40, (i / 40) % 40),
            "}\n",
        )
    }),
    ("the same bin of a cross", |n| {
        all(
            "cover c = count(e) bins none = 0, some = 1..\ncross x = c {\n",
            n,
            |i| format!("  bin \"{i}\" when c.none\n"),
            "}\n",
        )
    }),
    ("crosses", |n| {
        all(
            "cover c = count(e) bins none = 0, some = 1..\n",
            n,
            |i| format!("cross x{i} = c {{ bin \"one\" when c.some }}\n"),
            "",
        )
    }),
    ("a cross of two", |n| {
        all(
            &format!(
                "cover c = count(e) bins {}\ncover d = count(f) bins {}\ncross x = c * d {{ }}\n",
                list(n, ",", |i| format!("b{i} = {i}")),
                list(n, ",", |i| format!("b{i} = {i}"))
            ),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("suites", |n| all("", n, |i| format!("suite s{i} by random {{ stimuli s }}\n"), "")),
    ("stimuli of a suite", |n| {
        all(
            &format!("suite a by random {{ stimuli {} }}\n", list(n, ",", |_| "s".into())),
            0,
            |_| String::new(),
            "",
        )
    }),
    ("tests", |n| all("", n, |i| format!("test a.t{i} {{ s }}\n"), "")),
    ("the same test", |n| all("", n, |_| "test a.t { s }\n".into(), "")),
    ("steps of a test", |n| all("test a.t {\n", n, |_| "  s\n  await f within 1 s\n".into(), "}\n")),
    ("bodies", |n| world(n, |i| format!("  body b{i}: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n"))),
    ("the same body", |n| world(n, |_| "  body b: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n".into())),
    ("signals", |n| {
        all(
            "world {\n  body b: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n",
            n,
            |i| format!("  signal s{i}: bool to r = b.z > {i} m\n"),
            "}\n",
        )
    }),
    ("signals of signals", |n| {
        all(
            "world {\n  body b: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n  signal s0: bool to r = b.z > 1 m\n",
            n,
            |i| format!("  signal s{}: bool to r = s{i}\n", i + 1),
            "}\n",
        )
    }),
    ("rules of the world", |n| {
        all(
            "world {\n  body b: fixed sphere(1 m) at (0 m, 0 m, 0 m)\n",
            n,
            |_| "  on f emit e\n".into(),
            "}\n",
        )
    }),
    ("parts", |n| {
        all("", n, |i| format!("part p{i} {{ body b: fixed sphere(1 m) at (0 m, 0 m, 0 m) }}\n"), "")
    }),
    ("uses of a part", |n| {
        all(
            "part q { body b: fixed sphere(1 m) at (0 m, 0 m, 0 m) }\nworld {\n",
            n,
            |i| format!("  part q{i} = q at (0 m, 0 m, 0 m)\n"),
            "}\n",
        )
    }),
    ("uses of a module", |n| all("", n, |_| "use std.person\n".into(), "")),
    ("missing modules", |n| all("", n, |i| format!("use std.persn_{i}\n"), "")),
    ("missing files", |n| all("", n, |i| format!("use \"file_{i}.hri\"\n"), "")),
    ("unknown events", |n| all("", n, |i| format!("assume at most 1 evnet_{i} within 1 s\n"), "")),
    ("unknown names in plans", |n| {
        agent(n, "  goal !g\n", |i| format!("  plan +!g when b{i}(X) {{ s{i} }}\n"))
    }),
    ("unknown characters", |n| all("", n, |_| "§\n".into(), "")),
    ("text that is no declaration", |n| all("", n, |_| "nonsense here\n".into(), "")),
    ("steps that are none", |n| agent(n, "  goal !g\n", |_| "  plan +!g { s s ; ; ? }\n".into())),
    ("open braces", |n| all("", n, |_| "agent A plays p {\n".into(), "")),
    ("closing braces", |n| all("", n, |_| "}\n".into(), "")),
    ("allowances", |n| all("", n, |i| format!("allow HR0107 \"later\"\nconst A{i} = {i}\n"), "")),
    ("useless allowances", |n| {
        all("", n, |i| format!("allow HR0107 \"later\"\nassume at most {} e within 1 s\n", 1 + i % 9), "")
    }),
    ("unused declarations and words", |n| {
        all("", n, |i| format!("const A{i} = {i} // A{i}\nvar v{i}: 0..3\n"), "")
    }),
    ("awaits in vain", |n| agent(n, "  goal !g\n", |_| "  plan +!g { await f within 1 s }\n".into())),
    ("messages", |n| {
        all(
            "agent B plays p {\n  belief told(x: 0..9)\n  goal !g\n  plan +!g when told(_) { s }\n}\nagent A plays p {\n  goal !g\n  plan +!g {\n",
            n,
            |i| format!("tell told({}) to B;\n", i % 10),
            "s } }\nsuite a by agents A, B { }\n",
        )
    }),
    ("one long line", |n| all("", n, |i| format!("const A{i} = nothing; "), "\n")),
];
