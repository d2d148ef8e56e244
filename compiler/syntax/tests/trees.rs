//! What small texts become, one snapshot for each construct: lists with the node's sort first, without spans.

use hrdsl_source::FileId;
use hrdsl_syntax::parse;
use serde_json::Value;

/// The tree of a text that must be without fault; an item per line.
fn tree(text: &str) -> String {
    let (file, diagnostics) = parse(FileId(0), text);
    assert!(diagnostics.is_empty(), "{text}\n{diagnostics:#?}");
    let scenario = file.scenario.map(|s| format!("scenario {}\n", s.text)).unwrap_or_default();
    let items = file.items.iter().map(|item| {
        let doc = if item.doc.is_empty() { String::new() } else { format!("{:?} ", item.doc) };
        format!("{doc}{}\n", show(&serde_json::to_value(&item.kind).expect("trees are plain data")))
    });
    scenario + &items.collect::<String>()
}

fn show(value: &Value) -> String {
    match value {
        Value::Null => "-".to_owned(),
        Value::String(s) => s.clone(),
        Value::Bool(_) | Value::Number(_) => value.to_string(),
        Value::Array(list) => format!("[{}]", list.iter().map(show).collect::<Vec<_>>().join(" ")),
        Value::Object(map) => {
            let named: Vec<_> = map.iter().filter(|(key, _)| *key != "span").collect();
            match named.as_slice() {
                [(key, text)] if *key == "text" || *key == "kind" => show(text),
                [(key, Value::Array(names))] if *key == "names" => {
                    names.iter().map(show).collect::<Vec<_>>().join(".")
                }
                [(key, inner)] => format!("({key} {})", show(inner)),
                several => {
                    let parts = several.iter().filter(|(key, value)| *key != "doc" || *value != "");
                    let parts: Vec<_> = parts.map(|(key, value)| format!("{key}={}", show(value))).collect();
                    format!("{{{}}}", parts.join(" "))
                }
            }
        }
    }
}

macro_rules! trees {
    ($($name:ident $text:literal)*) => {$(
        #[test]
        fn $name() {
            insta::assert_snapshot!(tree($text));
        }
    )*};
}

trees! {
    vocabulary r#"
/// Dropped: a file has no doc comment.
scenario s
use std.robots.bert2
actor person : environment
actor robot
  : system
/// In metres.
/// Two lines.
const REACH = 4 + 2 * 10 cm
event plain from a
event full(gaze: bool, leg: 0..LEGS - 1,) from a to b, c; event third() from a
"#
    expressions r#"
const a = 1 + 2 * 3 - -4 % 5
const b = not x && y or z == 1 && !w
const c = (1, -2.5, 3e)
const d = 50 %
const e = 7 % 2 + 10 m/s - 5cm
const f = if a < b { 1 } else { if c { 2 } else { 3 } }
const g = f(x, _, a.b.c) + abs(-(y))
const h = !!true || false and not not x
const i = 1.5e3 + 0.25 rad/s / 2
const j = a.system.part * (1) >= x.y
"#
    stimulus r#"
/// The person asks.
stimulus ask(ok: bool, n: 0..3) by person {
  sample offset in if ok { 10 cm .. 20 cm } else { if n > 1 { 1 m .. 2 m } else { 3 m .. 4 m } }
  sample dy in -10 cm .. if ok { 1 cm } else { 2 cm }
  emit leg_request emit decided(true); hold 5 s
  person.hand.move_to(leg + (dx, dy, dz), 800 ms)
  if ok { person.grasp.grasp() } else { hold 1 s; if n > 2 { emit x } }
  hold.sample.emit()
}
stimulus nothing() by person { }
"#
    agent r#"
agent Human plays person {
  /// Chosen.
  belief wants(legs: 0..LEGS)
  belief asked(legs: 0..LEGS) = asked(0), asked(1); belief away goal !table
  plan +!table when asked(N) && N < 4 { ask; !a; !!b(1); ?c(X); +d; -e(_); -+f(N + 1); }
  plan @again -!leg(_) { await released | discarded(true) within 120 s; wait 10 s; await x }
  plan +b { }
  plan -b { }
  plan +?b(X) when if X { true } else { false } { leave }
  plan on look(G) { reach; hold(1) }
}
"#
    beliefs r#"
agent Human plays person {
  belief seen(leg: 1..4) [sure: 0..100, at: time]
  belief light(gaze: bool) on sensed
  belief all(what: [int], who: agent, ranges: [[0..4]], text: string) [why: string] on told = all([1, -2], self, [], "x")[why("y"), source(Robot)], ~all([], percept, [[1]], "")
  rule near(L) when at(L, D) && D < 3 m
  rule ~near(_)
  rule path(X, [X | T])[sure(5)] when not .member(X, T)
  goal deliver(leg: 1..4) goal table goal !table
}
"#
    plans r#"
agent Human plays person {
  plan @one[atomic] +!deliver(L)[source(S), sure(9)] when ~broken(L) && X = L + 1 && .count(seen(_), N) && N > 2 { }
  plan @two -?at(_, _) { .fail }
  plan +?at(L, D) { }
  plan +seen(L)[source(percept)] when .empty([]) { }
  plan -~seen(L) { }
  plan on offered { }
}
"#
    steps r#"
agent Human plays person {
  plan +!a {
    !fetch(L) within 10 s; !!watch; ?at(L, D); ?(D < 2 m && near(_)); ?~b[source(self)]; D2 = D + 1 m; X = [H | T]
    ; +seen(L)[sure(90)]; -seen(_)[source(Robot)]; -+wants(2); -~b; .abolish(seen(_)); .drop_all_desires; .suspend;
    .send(Robot, tell, seen(1)[sure(2)]); .ask(Robot, at(L, Where), 5 s); .findall(L, seen(L), All); .print("saw ", All)
  }
}
"#
    blocks r#"
agent Human plays person {
  plan +!a {
    if near(L) && X > 2 { a; b; } else if F { c } else { d }
    if if x { y } else { z } { } else { }; if x { a }
    while not done { while (b) { c } d }
    for seen(K) { };
    fork { a } and { b; c } and { }
    fork { if x { a } } or { b };
    last
  }
  plan +!b { while .count(b(_), 1) { for .member(X, L) { } } .print(x) }
  plan +!c { while_ = 3; for_(x); forks }
}
"#
    terms r#"
const a = ["x", [], [1, 2 | b], .f, .f(1)]
const b = ~c(1) && not ~d && ~e[source(self)]
const c = d(X)[source(S)] && e[source(S)] && f[source(S), at(T)] && g[i][j].x
const d = e = f + 1 && g(h = 2)
const e = a .b + c
  .d - f[0]
  .x
"#
    automaton r#"
var away: bool = false
automaton P plays person {
  clock x, y
  var left: 0..LEGS = 0; var g: bool
  init committed location start
  urgent location mid { invariant x <= 3 s && y < 2 s; }
  location idle { }
  start -> mid
  /// Three parts, in any order.
  mid -> idle on e(p) when x >= 3 s && left > 0 select n: 0..4, b: bool do left = n; x = 0; ask(b);
  idle -> mid do left -= 1; left += 2 idle -> idle when n == 4 idle -> start do go; ; location last
}
network table = P | Robot
"#
    channels r#"
channel take(fork: 0..4), free
channel hurry : urgent channel tick : broadcast channel alarm(n: 0..3) : urgent broadcast
channel done : joint P | Q? | R
channel more : urgent joint P?
automaton P { init location a  a -> a on done  fn f(i: 0..3) { if i > 0 { return } g(i) } }
"#
    queries r#"
query live "title" of net = P.a --> Q.b
query most of net = sup{P.a}: P.x, q[0]
query none of net = A[] not deadlock imply P.x <= 3 s
"#
    requirements r#"
require R1 functional "in time" after decided(_): (released or discarded) within DEADLINE
require R2 functional sensed(true, true) causes released or discarded
require R3 safety (a or b(_)) forbids c until (d or e)
require R4 safety a or b causes c within 10 s
require R5 safety "x" never closing while distance(p.hand, r.palm) < 5 cm
require R6 safety never (a or b)
require R7 safety globally speed(arm) < 0.25 rad/s
require R8 functional a causes b not before 1 s within 2 s before c
require R9 safety a precedes b within 2 s after c until (d or e)
require R10 functional eventually a or b within 3 s between c and d
require R11 safety at most N (a or b) while x < 1
require R12 safety exactly 2 a after b
require R13 safety at least 2 a
require R14 safety never a while x < 1 before b
require R15 safety whenever x < 1 for at least 2 s
require R16 safety rising(x < 1) forbids b until falling(x < 1)
require R17 safety always x < 1 after c
require R18 safety exactly causes always
require R19 safety formula always (a implies eventually[0 s, 10 s] (b(_) or -(x + 1) < 3))
require R20 safety formula not p since[0 s, 2 s] a and historically q implies once[1 s, 2 s] (x) > 2
assume at most 4 leg_request within 300 s
assume at most LEGS (a or b(1))
assume at most 2 reach or c within 1 s
"#
    coverage r#"
cover legs = count(leg_request) bins none = 0, few = 1..3, one = 1, four = 4..
cover both = count(a or decided(true)) bins no = 0
cross c = legs * both {
  bin "four \"legs\"" when legs.four && not both.no
  ignore when legs.none
}
"#
    suites r#"
suite s by agents Human, Robot {
  choose one wants of Human choose any shows of Human per leg where wants(L) && not L > 2
  explore pairwise tests 160 horizon 300 s; patience 60 s
}
suite t by search of table { reach each bin of c; reach each location reach each edge }
suite v by search of table { reach each combination of Robot.legs, gaze && not away when Robot.decide; reach each pair of a, b[1] reach each bound by 10 ms diverse 3 }
suite q by random { stimuli ask boundary 0.25 }
suite w by agents Human {
  explore wise(3) stop after 30 minimise reach each plan; reach each context reach each message reach each path
  explore learn
}
suite r by random { stimuli ask, look await offered | gone length 5..20 pause 0 s .. 10 s tests 3 }
"#
    tests r#"
test bdi_tests.t017 { seed 17 method agents because "wants(2)" predicts "a, b\n\\" look(true) with offset = 15 cm, d = -1 cm; await released | discarded within 60 s; wait 10 s }
test a.b {
  seed 1
  ask
  ask look(true)
  go with n = 3 ask()
}
test together {
  child { meanwhile sing; run(true) with x = 1 m }
  dog { await run(_) within 3 s wait 1 s }
  cat { }
}
"#
    world r#"
part p {
  /// A palm.
  body palm: dynamic box(4 cm, 8 cm, 8 cm) at (0 m, 0 m, 0 m) graspable mass 0.4 kg ghost rotated (0 deg, 0 deg, 1 deg)
  joint j: torso -> palm at (0 m, 0 m, 0 m) axis (0, 0, 1) limits -60 deg .. 60 deg
  arm a: j, k tip palm tool (8 cm, 0 m, 0 m) speed 0.2 rad/s
  gripper g: palm tool (8 cm, 0 m, 0 m) reach 4 cm delay 500 ms
}
world {
  step 10 ms sample 50 ms gravity (0, 0, -9.81)
  part robot = p at (0 m, 0 m, 0 m) rotated (0 deg, 0 deg, 90 deg)
  current leg in leg1, p.leg2 by robot.g
  signal gaze: bool to robot, person = abs(x) <= 20 cm
    && visible(a, b)
  on sense when range(a.b, c.d) < 2 m emit sensed(gaze)
  on close robot.g emit closing on open robot.g emit opening
  on close emit closed
  on open(x) when x emit f
}
system robot { run "python3 robot.py" coverage "a.py", "b.py" limit 300 s budget 10 s }
"#
    devices r#"
/// A hand.
device gripper {
  /// Closes.
  command close do close_fingers expect holds else "nothing"; command open do open_fingers expect not holds else "more"
  command reach(speed: length[3]?, to: [angle]) do step
  /// How far.
  state fingers from finger_places
}
"#
}

/// Spans of names, units and nodes are those of the text.
#[test]
fn spans() {
    let text = "const SPEED = (0.25 rad/s) + 3 % \nrequire R safety never a(1) or b while x.y";
    let (file, _) = parse(FileId(0), text);
    let mut spans = Vec::new();
    collect(&serde_json::to_value(&file).expect("trees are plain data"), text, &mut spans);
    insta::assert_snapshot!(spans.join("\n"));
}

fn collect(value: &Value, text: &str, spans: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            if let Some(span) = map.get("span") {
                let at =
                    |key: &str| span[key].as_u64().and_then(|n| usize::try_from(n).ok()).expect("a number");
                spans.push(format!("[{}]", &text[at("start")..at("end")]));
            }
            map.values().for_each(|v| collect(v, text, spans));
        }
        Value::Array(list) => list.iter().for_each(|v| collect(v, text, spans)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[test]
fn the_reference_scenario_is_read_whole() {
    let (file, diagnostics) = parse(FileId(0), include_str!("../../../examples/handover/scenario.hri"));
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(file.scenario.map(|s| s.text).as_deref(), Some("handover"));
    assert!(file.items.len() > 40);
}

#[test]
fn every_form_of_agents_is_read() {
    let (file, diagnostics) = parse(FileId(0), include_str!("texts/agents.hri"));
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let tree = serde_json::to_string(&file).expect("trees are plain data");
    for form in [
        "goal_type",
        "rule",
        "annotated",
        "strong",
        "internal",
        "unify",
        "list",
        "text",
        "while",
        "for",
        "fork",
        "within",
        "test_failed",
        "stop_after",
        "minimise",
        "reach_each",
    ] {
        assert!(tree.contains(&format!("\"{form}\"")), "{form}");
    }
}
