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
        &NETWORK.replace("invariant x <= 1500 ms", "invariant x <= 1500 ms && stopped(total)"),
        &NETWORK.replace("return not held[fork]", "if held[fork] { return false }; return true"),
    ]
    .map(|text| exported(text).expect_err(text));
    insta::assert_snapshot!(wrong.join("\n"));
}

/// A loop from a committed location would let others go on while it is not left: it asks that one of them comes from such a
/// location, too, and where none can, there is no loop.
#[test]
fn who_stays_out_from_a_committed_location_needs_another() {
    let text = exported(NETWORK).unwrap();
    assert!(
        text.contains("edge:Robot:ready:ready:alarm_in\n") && !text.contains("edge:Robot:told:told:alarm_in")
    );
    assert!(!text.contains("_at"), "{text}");
    let text = exported(&NETWORK.replace("  location eating\n", "  committed location eating\n")).unwrap();
    assert!(text.contains("int:1:0:1:0:Philosopher_at\n"), "{text}");
    assert!(text.contains("edge:Robot:told:told:alarm_in{provided: Philosopher_at==1}\n"), "{text}");
    assert!(
        text.contains(
            "edge:Philosopher:thinking:eating:take_0_in{do: Philosopher_mine=0; Philosopher_at=1}\n"
        )
    );
    assert!(text.contains("edge:Philosopher:eating:eating:alarm\n"), "nothing changes: {text}");
}

/// `fridge` is the second value of one enumeration, and the first of another.
#[test]
fn values_of_several_enumerations_are_numbers_of_the_one_that_is_meant() {
    let text = "scenario net
enum Order { feed, fridge }
enum Place { fridge, table }
channel order(what: Order)
channel go(to: Place)
var order_: Order = feed
fn place(of: Order) -> Place { return if of == fridge { fridge } else { table } }
automaton A {
  init location a
  a -> a when order_ != fridge do order(fridge)
  a -> a do go(fridge)
}
automaton B {
  var at: Place = table
  init location b
  b -> b on order(what) do order_ = what; at = place(what)
  b -> b when at == fridge on go(fridge) do order_ = feed
}
network all = A | B
";
    let text = exported(text).unwrap();
    for part in [
        "edge:A:a:a:order_1{provided: order_!=1}",
        "edge:A:a:a:go_0\n",
        "edge:B:b:b:order_1_in{do: order_=1; B_at=(if 1==1 then 0 else 1)}",
        "edge:B:b:b:go_0_in{provided: B_at==0 : do: order_=0}",
    ] {
        assert!(text.contains(part), "{part} is missing:\n{text}");
    }
}

#[test]
fn pictures_show_everything() {
    let program = program(NETWORK);
    insta::assert_snapshot!("dot", hrdsl_interop::picture::dot(&program, &program.networks[0]));
    insta::assert_snapshot!("mermaid", hrdsl_interop::picture::mermaid(&program, &program.networks[0]));
}
