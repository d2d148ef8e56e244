//! Networks as UPPAAL's models: what becomes of each construct, that they can be read again, and what is refused.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource,
    uppaal::{self, UppaalDocument, export},
};
use hrdsl_ir::Program;

fn program(text: &str) -> Program {
    let compilation = compile(InputFile { name: "model.hri", text }, &[]);
    let wrong: Vec<String> = compilation
        .diagnostics
        .iter()
        .filter(|d| d.is_error())
        .map(|d| format!("{}: {} {}", compilation.files.place(d.span()), d.code, d.message))
        .collect();
    assert!(wrong.is_empty(), "{}\n{text}", wrong.join("\n"));
    compilation.program.expect("there are no errors")
}

fn exported(text: &str) -> UppaalDocument {
    export(&program(text), 0).unwrap_or_else(|e| panic!("{e:?}"))
}

fn again(exported: &UppaalDocument) -> String {
    let source = ForeignSource { name: "again.xml".to_owned(), text: exported.text.clone() };
    uppaal::import(&source, None, &uppaal::UppaalOptions::default())
        .unwrap_or_else(|e| panic!("{e:?}\n{}", exported.text))
        .text
}

const NETWORK: &str = "scenario net
actor person : environment
actor robot  : system
enum Mood { calm, hasty }
event asked(mood: Mood, twice: bool) from person to robot
channel take(fork: 1..3)
channel alarm : urgent broadcast
channel both : joint P | Q
channel some : joint P | Q?
var total: clock
var held: bool[3]
var left: 0..5 = 2
fn free(fork: 0..2) -> bool { return not held[fork] }
fn grab(fork: 0..2) {
  for k in 0..2 { if k == fork { held[k] = true } }
  while left > 3 { left -= 1 }
}
automaton P plays person {
  clock x
  var mood: Mood = calm
  init location a { invariant x <= 1.5 s && left < 5 && stopped(total) }
  committed location b
  urgent location c
  a -> b select f: 1..3 when x >= 500 ms && free(f - 1) do take(f); grab(f - 1); x = 250 ms
  b -> c do asked(mood, left > 1); mood = hasty
  c -> a on both do x = 0
  c -> a on some do x = left * 250 ms
  a -> a do alarm
}
automaton Q plays robot {
  init location a
  location b
  a -> b on take(f) when f > 1 do left = f
  b -> a on asked(calm, t) when t
  b -> a on asked(_, false)
  a -> a on both
  b -> b on some
  b -> b on alarm
}
network n = P | Q
";

#[test]
fn each_construct_is_exported_and_read_again() {
    let exported = exported(NETWORK);
    for part in [
        "// One unit of time is 250 ms.",
        "const int hasty = 1;",
        "bool held[3] = { false, false, false };",
        "broadcast chan asked[2][2];",
        "urgent broadcast chan alarm;",
        "chan take[3];",
        "x &lt;= 6 &amp;&amp; total' == 0 &amp;&amp; left &lt; 5",
        "take[f - 1]!",
        "asked[mood][(left &gt; 1 ? 1 : 0)]!",
        "asked[calm][twice]?",
        "twice == 1",
        "both!",
        "both?",
        "broadcast chan some;",
        "system P, Q;",
    ] {
        assert!(exported.text.contains(part), "{part} is missing:\n{}", exported.text);
    }
    program(&again(&exported));
}

#[test]
fn what_cannot_be_said_is_listed() {
    let text = NETWORK
        .replace("x = 250 ms", "x = total")
        .replace("both : joint P | Q", "both : joint P? | Q?")
        .replace("a { invariant x <= 1.5 s", "a { invariant x >= 0 s");
    let faults = export(&program(&text), 0).expect_err("there are three faults");
    let said: Vec<&str> = faults.iter().map(|f| f.message.as_str()).collect();
    assert_eq!(said.len(), 3, "{said:?}");
    for part in ["multi-way channel `both`", "lower bound", "set to another clock"] {
        assert!(said.iter().any(|s| s.contains(part)), "{part}: {said:?}");
    }
}

#[test]
fn times_that_do_not_fit_are_errors() {
    let text = NETWORK.replace("x = 250 ms", "x = 1 ns");
    let faults = export(&program(&text), 0).expect_err("a nanosecond is too short a unit");
    assert!(faults.iter().any(|f| f.message.contains("31 bits")), "{faults:?}");
}
