//! Networks in TChecker's format: what becomes of every construct, that it can be read again, and what has no counterpart.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_interop::{
    ForeignSource,
    tchecker::{self, export},
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

fn exported(text: &str) -> Result<String, String> {
    let program = program(text);
    export(&program, &program.networks[0])
        .map_err(|all| all.iter().map(|o| o.message.clone()).collect::<Vec<_>>().join("\n"))
}

const NETWORK: &str = "scenario net
actor person : environment
actor robot  : system
enum Mood { calm, hasty }
event asked(mood: Mood) from person to robot
channel take(fork: 0..2)
channel alarm : broadcast
channel done : joint Philosopher | Robot?
var total: clock
var held: bool[3]
var left: 0..5 = 2
fn free(fork: 0..2) -> bool { return not held[fork] }
fn grab(fork: 0..2) {
  var tries: 0..3 = 0;
  while tries < 2 && left > 0 { left -= 1; tries += 1 }
  if free(fork) || left == 0 { held[fork] = true } else { left = 5 }
}
automaton Person plays person {
  clock x
  init location idle { invariant x <= 1500 ms }
  urgent location near
  idle -> near when x >= 500 ms && (left > 2 || left == 0) do asked(hasty); x = 0
  near -> idle select fork: 0..2 when free(fork) do take(fork); grab(fork)
}
automaton Robot plays robot {
  init location ready
  committed location told
  location held_up
  ready -> told on asked(mood) when mood == hasty
  told -> held_up
  held_up -> held_up on alarm when total > 2 s
  held_up -> ready on done do total = left * 1 s
}
automaton Philosopher {
  var mine: 0..2 = 0
  init location thinking
  location eating
  thinking -> eating on take(f) do mine = f
  eating -> thinking on done do held[mine] = false
  eating -> eating do alarm
}
network table = Person | Robot | Philosopher
";

#[test]
fn every_construct_is_exported() {
    insta::assert_snapshot!(exported(&NETWORK.replace("committed ", "")).unwrap());
}

#[test]
fn what_is_exported_can_be_read_again() {
    let text = exported(&NETWORK.replace("committed ", "")).unwrap();
    let source = ForeignSource { name: "table.txt".to_owned(), text };
    let imported = tchecker::import(&source, &tchecker::TcheckerOptions::default()).unwrap();
    let again = program(&imported.text);
    // The automata with their locations; all else is told by the answers to queries.
    let locations = |p: &Program| -> Vec<usize> { p.automata.iter().map(|a| a.locations.len()).collect() };
    assert_eq!(locations(&again), locations(&program(NETWORK)));
    assert_eq!(imported.text.matches("\nquery ").count(), 7);
}

#[test]
fn what_has_no_counterpart_is_told() {
    let wrong = [
        NETWORK.replace("take(fork: 0..2)", "take(fork: 0..2) : urgent").as_str(),
        NETWORK,
        &NETWORK.replace("return not held[fork]", "if held[fork] { return false }; return true"),
    ]
    .map(|text| exported(text).expect_err(text));
    insta::assert_snapshot!(wrong.join("\n"));
}

#[test]
fn pictures_show_everything() {
    let program = program(NETWORK);
    insta::assert_snapshot!("dot", hrdsl_interop::picture::dot(&program, &program.networks[0]));
    insta::assert_snapshot!("mermaid", hrdsl_interop::picture::mermaid(&program, &program.networks[0]));
}
