//! What is said about texts that do not fit: code, the text at the place of the fault, message, help, further places.

use std::fmt::Write;

use hrdsl_source::{FileId, SourceFiles};
use hrdsl_syntax::parse;

fn said(text: &str) -> String {
    let mut files = SourceFiles::default();
    let id = files.add("t", text);
    let (_, diagnostics) = parse(FileId(0), text);
    assert!(!diagnostics.is_empty(), "no diagnostic: {text}");
    let mut out = format!("{text}\n");
    for d in diagnostics {
        let _ = write!(
            out,
            "    {} {} at {} `{}`",
            d.code,
            d.message,
            &files.place(d.span())[2..],
            files.text(d.span())
        );
        for label in &d.labels[1..] {
            let _ = write!(out, "; {} {}", &files.place(label.span)[2..], label.text);
        }
        if let Some(help) = d.help {
            let _ = write!(out, "; help: {help}");
        }
        out.push('\n');
    }
    assert_eq!(id, FileId(0));
    out
}

macro_rules! broken {
    ($($name:ident [$($text:literal)*])*) => {$(
        #[test]
        fn $name() {
            let all: Vec<String> = [$($text),*].iter().map(|text| said(text)).collect();
            insta::assert_snapshot!(all.join("\n"));
        }
    )*};
}

broken! {
    lexical [
        "const a = 1 § 2"
        "const a = b & c"
        "event größe from a"
        "event a from µm"
        "const a = “x”"
        "const a = 5 °"
        "const a = x ≤ 3"
        "use a\nrequire R safety \"no end\n never a"
        "require R safety \"a \\q\" never a"
        "const a = 99999999999999999999"
        "system r { run \"a\\"
        "const a = 1 \\== 2"
        "const a = 2 ^ 3"
        "const a = 1 # one\n# two # three\nconst b = 2 ## four"
        "const a = .5"
        "const a = 5."
    ]
    declarations [
        "evnt a from b"
        "automatn P plays p { location a }"
        "const a = 4\nevnt b from c"
        "foo bar"
        "scenario"
        "scenario a b"
        "use a\nscenario b"
        "scenario a\nscenario b"
        "event"
        "event a"
        "event a from\nevent b from c"
        "event or from a"
        "event a, from c"
        "event a(or: bool) from b"
        "event a(x bool) from b"
        "event a(x: bool from b"
        "event a from b c"
        "actor a"
        "const = 4"
        "const a = "
        "const a = 4 4"
        "const a 4"
        "network n = "
        "network n = a, b"
        "var a bool"
        "cover a = count(b) bins none 0"
        "cover a = count(b)"
        "assume at most leg_request within 3 s"
        "assume at least 4 a"
        "world"
        "part x ="
        "}"
    ]
    expressions [
        "const a = 1 +"
        "const a = (1, 2"
        "const a = (1"
        "const a = f(1, 2"
        "const a = 1 < 2 < 3"
        "const a = b = c = d"
        "const a = [1, 2"
        "const a = [1 | ]"
        "const a = [1 | b, c]"
        "const a = ~3 +"
        "const a = .count("
        "const a = if b { 1 }"
        "const a = if b { 1 } else if c { 2 }"
        "const a = b[1"
        "var x: 3 + 4"
        "const a = b | c"
        "const a = ()"
        "const a = 1 .. 2"
        "const a = b."
        "const a = 3 s s"
        "const a = not"
        "const a = or"
    ]
    stimuli [
        "stimulus s by p { emit }"
        "stimulus s by p { hold }"
        "stimulus s by p { leave() }"
        "stimulus s by p { sample x 1 .. 2 }"
        "stimulus s by p { sample x in 1 }"
        "stimulus s { emit a }"
        "stimulus s by p { if a { emit } else { emit b } emit c }"
        "stimulus s by p { if a emit b }"
        "stimulus s by p { emit a"
        "stimulus s by p emit a"
        "stimulus s by p { emit a } }"
    ]
    agents [
        "agent A plays p { plan +!a { ask look(G) } }"
        "agent A plays p { plan +!a { ask\n look(G)\n !b } }"
        "agent A plays p { plan +!a { ask;; b } }"
        "agent A plays p { plan +!a { ; b } }"
        "agent A plays p { plan +!a { ask; = ; b } }"
        "agent A plays p { plan +!a { wait; b } }"
        "agent A plays p { plan +!a { await a or b } }"
        "agent A plays p { plan !a { b } }"
        "agent A plays p { plan +!a when { b } }"
        "agent A plays p { plan +!a b }"
        "agent A plays p { belif x }"
        "agent A plays p { goal table(1) }"
        "agent A plays p { goal !table(leg: 1..4) }"
        "agent A plays p { goal }"
        "agent A plays p { plan +!a { b\n plan +!c { d }\n}"
        "agent A plays p {\n belief x\nagent B plays q { }"
        "agent A plays p {\n plan +!a { x }\n"
        "agent A { belief x }"
        "agent A plays p { plan +!a { x } }\n plan +!b { y }\n}"
        "agent A plays p { belief b [sure] }"
        "agent A plays p { belief b [sure: 0..9 }"
        "agent A plays p { belief b on }"
        "agent A plays p { rule when x }"
        "agent A plays p { rule b(X) }\nagent B plays q { rule b(X) when }"
    ]
    blocks [
        "agent A plays p { plan +!a { if x { b; reach(; c } else { d; = ; e } f } }"
        "agent A plays p { plan +!a { if { b } } }"
        "agent A plays p { plan +!a { if x b } }"
        "agent A plays p { plan +!a { if x { b } else c } }"
        "agent A plays p { plan +!a { else { b } } }"
        "agent A plays p { plan +!a { while x { b } else { c } } }"
        "agent A plays p { plan +!a { while { b; wait } c } }"
        "agent A plays p { plan +!a { for seen(K) b } }"
        "agent A plays p { plan +!a { fork { b } } }"
        "agent A plays p { plan +!a { fork { b } and { c; wait } or { d } e } }"
        "agent A plays p { plan +!a { fork b } }"
        "agent A plays p { plan +!a { if x { b };; c } }"
        "agent A plays p { plan +!a { if x { b c } d } }"
        "agent A plays p { plan +!a { reach(\n if x { b }\n c } }"
        "agent A plays p { plan +!a { if if x { y } else { z } { b; ! } c } }"
        "agent A plays p { plan +!a { if x { while y { for z { wait } } } } }"
        "agent A plays p {\n plan +!a {\n if x { b\n }\n plan +!c { d }\n}"
        "agent A plays p {\n plan +!a {\n if x { b }\n rule c when d\n goal e\n}"
        "agent A plays p { plan +!a { .print( } }"
        "agent A plays p { plan +!a { . print } }"
        "agent A plays p { plan +!a { while.count(b, 1) { } } }"
        "agent A plays p { plan +!a { ask .print(1) } }"
        "agent A plays p { plan +!a { ask\n .print(1)\n !b } }"
        "agent A plays p { plan +!a { X = ; Y == 1 } }"
        "agent A plays p { plan +!a { !b[source(S)]; !!c[source(S)] } }"
        "agent A plays p { plan +!a { ?~; +b[; -c[] } }"
        "agent A plays p { plan @l[atomic +!a { b } }"
    ]
    agentspeak [
        "agent A plays p { wants(2). }"
        "agent A plays p { !start. }"
        "agent A plays p { +!start <- a; b. }"
        "agent A plays p { @l +!start : c <- a; b. }"
        "agent A plays p { belief wants(x: 0..4) = wants(2).\n goal !start. rule b(X) when c(X).\n belief d }"
        "agent A plays p { rule b(X) :- c(X) & d }"
        "agent A plays p { plan +!start : c { a } }"
        "agent A plays p { plan +!start <- a; b. }"
        "agent A plays p { plan +!start when c <- a; b. }"
        "agent A plays p { plan +!start when c { a; b. }\n plan +!b { a. ; b }. }"
        "agent A plays p { plan +!start when b(X) | c(X) { a } }"
    ]
    automata [
        "automaton P plays p { location }"
        "automaton P plays p { a -> }"
        "automaton P plays p { a -> b do }"
        "automaton P plays p { a -> b do x y }"
        "automaton P plays p { a -> b do x == 1 }"
        "automaton P plays p { a -> b when x do y; }\n{"
        "automaton P plays p { a -> b when x on e when y }"
        "automaton P plays p { a -> b on e on f }"
        "automaton P plays p { location a { invariant } }"
        "automaton P plays p { location a { x < 3 } }"
        "automaton P plays p { clck x }"
        "automaton P plays p { committed init location a }"
        "automaton P plays p { true -> b }"
        "automaton P plays p { location a { invariant x < 3\n a -> b\n}"
    ]
    requirements [
        "require"
        "require R"
        "require R safety"
        "require R safety \"a\""
        "require R safety a"
        "require R safety a causes"
        "require R safety a | b causes c"
        "require R safety after a released"
        "require R safety never a when b"
        "require R safety a forbids b"
        "require R safety (a or b causes c"
        "require R safety never a between b"
        "require R safety at most a"
        "require R safety whenever p for 2 s"
        "require R safety a causes b not after 2 s"
        "require R safety never a while p while q"
        "require R safety a forbids b until c until d"
        "require safety a causes b"
    ]
    suites_and_tests [
        "suite s { tests 3 }"
        "suite s by agent A { }"
        "suite s by agents A { choose wants of A }"
        "suite s by agents A { choose one wants A tests 3 }"
        "suite s by agents A { test 3 }"
        "suite s by random { length 5.. }"
        "suite s by agents A { stop 30 }"
        "suite s by agents A { stop after\n minimise 3 tests 3 }"
        "suite s by agents A { reach each 3 reach each plan }"
        "suite s by agents A { explore wise( tests 3 }"
        "suite s by search of t { reach bin of c }"
        "cross c = a * b { bin x when y }"
        "cross c = a, b { }"
        "cross c = a * b { bin \"x\" where y ignore }"
        "test a { await b }"
        "test a { look(true with offset = 3 cm }"
        "test a { look with offset 3 cm; wait 3 s }"
        "test a { seed ?; wait 3 s }"
    ]
    worlds [
        "world { body b: box(1 m) at (0 m, 0 m, 0 m) }"
        "world { body b: fixed box(1 m) }"
        "world { body b: fixed box(1 m) at x mass 1 kg mass 2 kg }"
        "world { step step 10 ms }"
        "world { joint j: a -> b at x axis y }"
        "world { signal s: bool = x }"
        "world { on a when b }"
        "world { bdy b: fixed box(1 m) at x }"
        "world { part p at x }"
        "world { current leg in by a.b }"
        "system r { run python }"
        "system { run \"a\" }"
        "system r { coverage \"a\" \"b\" }"
    ]
}

#[test]
fn nesting_is_limited() {
    let deep = |n: usize| format!("const a = {}1{}\nconst b = 2", "(".repeat(n), ")".repeat(n));
    let (file, diagnostics) = parse(FileId(0), &deep(hrdsl_syntax::MAX_NESTING));
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    assert_eq!(file.items.len(), 2);
    for n in [hrdsl_syntax::MAX_NESTING + 1, 200_000] {
        let (file, diagnostics) = parse(FileId(0), &deep(n));
        assert_eq!(diagnostics.len(), 1, "{diagnostics:?}");
        assert_eq!(diagnostics[0].code.to_string(), "HR0005");
        assert_eq!(file.items.len(), 2, "the next declaration is read");
    }
}

#[test]
fn height_is_limited() {
    let limit = hrdsl_syntax::MAX_HEIGHT as usize;
    let shapes: [fn(usize) -> String; 8] = [
        |n| format!("const a = 1{}", " + 1".repeat(n)),
        |n| format!("const a = {}1", "- ".repeat(n)),
        |n| format!("const a = {}b", "not ".repeat(n)),
        |n| format!("const a = {}b", "!".repeat(n)),
        |n| format!("const a = {}b", "if a { 1 } else { 1 } + ".repeat(n)),
        |n| format!("agent A plays a {{ plan +!a when b{} {{ }} }}", " && (x + 1)".repeat(n)),
        |n| format!("agent A plays a {{ plan +!a {{ {} }} }}", "if b { } else ".repeat(n) + "{ }"),
        |n| format!("agent A plays a {{ rule b when {}c }}", "~c && ".repeat(n)),
    ];
    for shape in shapes {
        let (_, fits) = parse(FileId(0), &shape(limit / 4));
        assert!(fits.is_empty(), "{fits:?}");
        let (_, high) = parse(FileId(0), &shape(200_000));
        assert!(high.iter().any(|d| d.code.to_string() == "HR0005"), "{high:?}");
    }
}

/// Many members are not a high tree, with or without semicolons.
#[test]
fn long_is_not_deep() {
    let members = "a -> b when x > 1 && y < -2 do x = x - 1; y = -1\n".repeat(5_000);
    let text = format!("automaton A plays a {{ location a location b\n{members} }}");
    let (_, diagnostics) = parse(FileId(0), &text);
    assert!(diagnostics.is_empty(), "{:?}", diagnostics[0]);
    let members = "signal s: bool to r = a + b > -1 && not c\n".repeat(5_000);
    let (_, diagnostics) = parse(FileId(0), &format!("world {{ {members} }}"));
    assert!(diagnostics.is_empty(), "{:?}", diagnostics[0]);
    let steps = "-+a(N + 1); !b(-1);".repeat(5_000);
    let (_, diagnostics) = parse(FileId(0), &format!("agent A plays a {{ plan +!a {{ {steps} }} }}"));
    assert!(diagnostics.is_empty(), "{:?}", diagnostics[0]);
    let steps = "if a && b { c } while not d { } fork { .f } and { } fork { } or { g }".repeat(5_000);
    let (_, diagnostics) = parse(FileId(0), &format!("agent A plays a {{ plan +!a {{ {steps} }} }}"));
    assert!(diagnostics.is_empty(), "{:?}", diagnostics[0]);
}
