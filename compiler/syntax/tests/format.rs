//! What is formatted is the same text to the parser, keeps its comments, and is formatted once and for all.

#![allow(clippy::disallowed_methods, reason = "the texts are files")]

use std::fs;
use std::path::{Path, PathBuf};

use hrdsl_source::FileId;
use hrdsl_syntax::token::KEYWORDS;
use hrdsl_syntax::{format, parse};
use proptest::prelude::*;
use serde_json::Value;

use pieces::{Piece, code, comments, pieces};

mod pieces;

// ── The texts: every file and every block of the specification that can be read ──

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            files(&path, extension, found);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
}

fn texts() -> Vec<(String, String)> {
    let (mut scenarios, mut pages) = (Vec::new(), Vec::new());
    files(&root(), "hri", &mut scenarios);
    files(&root().join("spec"), "md", &mut pages);
    let mut texts = Vec::new();
    for path in scenarios {
        texts.push((path.display().to_string(), fs::read_to_string(&path).unwrap()));
    }
    for path in pages {
        let page = fs::read_to_string(&path).unwrap();
        for (n, block) in page.split("```hri").skip(1).enumerate() {
            let (_, code) = block.split_once('\n').unwrap();
            let code = code.split("```").next().unwrap();
            texts.push((format!("{} {n}", path.display()), code.to_owned()));
        }
    }
    texts.retain(|(_, text)| parse(FileId(0), text).1.is_empty());
    texts
}

// ── What must stay ──

/// The tree without spans.
fn tree(text: &str) -> Value {
    let (file, diagnostics) = parse(FileId(0), text);
    assert!(diagnostics.is_empty(), "{text}\n{diagnostics:#?}");
    let mut tree = serde_json::to_value(&file).unwrap();
    erase(&mut tree);
    tree
}

fn erase(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.remove("span");
            map.values_mut().for_each(erase);
        }
        Value::Array(list) => list.iter_mut().for_each(erase),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// Formats, and checks what holds for every text without faults.
fn checked(name: &str, text: &str) -> String {
    let result = format(text).unwrap_or_else(|d| panic!("{name}: {d:#?}\n{text}"));
    assert_eq!(tree(&result), tree(text), "{name}: the tree\n{text}\n----\n{result}");
    assert_eq!(code(&result), code(text), "{name}: the tokens\n{result}");
    assert_eq!(comments(&result), comments(text), "{name}: the comments\n{result}");
    let again = format(&result).unwrap();
    assert!(again == result, "{name}: not stable\n{result}\n----\n{again}");
    for line in result.lines() {
        assert_eq!(line, line.trim_end(), "{name}: blanks at the end");
    }
    assert!(!result.contains("\n\n\n"), "{name}: empty lines\n{result}");
    // What stands in a comment is its author's.
    let opened =
        |pair: &[Piece<'_>]| matches!(pair, [Piece::Code("{"), Piece::Blank(b)] if b.starts_with("\n\n"));
    assert!(!pieces(&result).windows(2).any(opened), "{name}: an empty line after `{{`\n{result}");
    assert!(result.is_empty() || (result.ends_with('\n') && !result.ends_with("\n\n")), "{name}: the end");
    result
}

#[test]
fn every_text() {
    let texts = texts();
    assert!(texts.len() > 60, "{} texts", texts.len());
    for (name, text) in texts {
        checked(&name, &text);
    }
}

#[test]
fn the_examples_are_formatted() {
    let mut found = Vec::new();
    files(&root().join("examples"), "hri", &mut found);
    assert!(!found.is_empty());
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        assert!(checked("", &text) == text, "{} is not formatted: run `hrdsl fmt examples`", path.display());
    }
}

#[test]
fn every_form_of_agents_is_among_the_texts() {
    let found = texts().into_iter().find(|(name, _)| name.ends_with("tests/texts/agents.hri"));
    let (name, text) = found.expect("the file is read without fault");
    insta::assert_snapshot!(checked(&name, &text));
}

#[test]
fn the_page_of_the_style_is_written_in_it() {
    let page = fs::read_to_string(root().join("spec/style.md")).unwrap();
    let block = page.split("```hri\n").nth(1).unwrap().split("```").next().unwrap();
    assert_eq!(checked("style.md", block), block);
}

/// As if somebody else had typed it: other blanks, other line ends, more empty lines.
#[test]
fn blanks_do_not_matter() {
    for (name, text) in texts() {
        let plain = format(&text).unwrap();
        let typed: String = pieces(&plain)
            .into_iter()
            .map(|piece| match piece {
                Piece::Blank(blank) if blank.contains("\n\n") => " \r\n\n\t\n\r\n   ".to_owned(),
                Piece::Blank(blank) if blank.contains('\n') => "\t\r\n".to_owned(),
                Piece::Blank(_) => " \t ".to_owned(),
                Piece::Comment(text) | Piece::Code(text) => text.to_owned(),
            })
            .collect();
        assert_eq!(format(&format!("\u{feff}{typed}")).unwrap(), plain, "{name}");
    }
}

/// Words that are names of stimuli where they are alone on a line of a test.
const STEPS: [&str; 8] = ["await", "wait", "seed", "method", "because", "predicts", "meanwhile", "with"];

/// A line must not end here: a number takes its unit on the same line only, a name after a dot is any word.
fn holds(before: &str) -> bool {
    before.starts_with(|c: char| c.is_ascii_digit()) || matches!(before, "%" | ".") || STEPS.contains(&before)
}

/// The text with other line ends; `None` if that has made it another text.
fn mangled(text: &str, picks: &[u8]) -> Option<String> {
    let mut picks = picks.iter().cycle();
    let mut out = String::new();
    let mut before = "";
    let mut commented = false;
    for piece in pieces(text) {
        match piece {
            Piece::Blank(blank) => {
                let pick = picks.next().copied().unwrap_or(0);
                let line = blank.contains('\n');
                out.push_str(match pick {
                    0..=2 if line && !commented && !holds(before) => " ",
                    3 if !line && !holds(before) => "\n",
                    4 if line => "\n\n\n",
                    5 if !line => "   ",
                    _ => blank,
                });
            }
            Piece::Comment(comment) => out.push_str(comment),
            Piece::Code(code) => {
                out.push_str(code);
                before = code;
            }
        }
        if !matches!(piece, Piece::Blank(_)) {
            commented = matches!(piece, Piece::Comment(_));
        }
    }
    parse(FileId(0), &out).1.is_empty().then_some(out)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn line_ends(at in any::<prop::sample::Index>(), picks in prop::collection::vec(0..40_u8, 50..200)) {
        let texts = texts();
        let (name, text) = at.get(&texts);
        // A word that starts a line may be taken for a declaration: such a text has other faults, and is left out.
        if let Some(mangled) = mangled(text, &picks) {
            prop_assert_eq!(tree(&mangled), tree(text));
            checked(name, &mangled);
        }
    }

    /// Names of any length, so that lines break in all sorts of places.
    #[test]
    fn long_names(at in any::<prop::sample::Index>(), picks in prop::collection::vec(0..60_usize, 20..80)) {
        let texts = texts();
        let (name, text) = at.get(&texts);
        let mut lengths = picks.iter().cycle();
        let keyword = |word: &str| KEYWORDS.iter().any(|k| k.word == word);
        let mut renamed = String::new();
        for piece in pieces(text) {
            let (Piece::Blank(piece) | Piece::Comment(piece) | Piece::Code(piece)) = piece;
            renamed.push_str(piece);
            if piece.starts_with(|c: char| c.is_ascii_alphabetic()) && !keyword(piece) {
                let length = lengths.next().copied().unwrap_or(0);
                renamed.push_str(&"_of_a_long_name".repeat(5)[..length]);
            }
        }
        let picks: Vec<u8> = picks.iter().map(|p| *p as u8).collect();
        for text in [mangled(&renamed, &picks), mangled(&renamed, &[9])].into_iter().flatten() {
            checked(name, &text);
        }
    }

    /// Comments anywhere between two tokens stay, in their order.
    #[test]
    fn comments_anywhere(at in any::<prop::sample::Index>(), picks in prop::collection::vec(0..30_u8, 50..200)) {
        let texts = texts();
        let (name, text) = at.get(&texts);
        let mut picks = picks.iter().cycle();
        let mut commented = String::new();
        let mut before = "";
        for piece in pieces(text) {
            match piece {
                Piece::Code(code) | Piece::Comment(code) => {
                    commented.push_str(code);
                    before = code;
                }
                Piece::Blank(blank) => {
                    let pick = picks.next().copied().unwrap_or(0);
                    let plain = holds(before) || before.starts_with("//");
                    match pick {
                        0 if !plain => commented.push_str(" // at the end\n"),
                        1 if !plain => commented.push_str("\n\n// alone\n// twice\n\n"),
                        _ => commented.push_str(blank),
                    }
                }
            }
        }
        if parse(FileId(0), &commented).1.is_empty() {
            checked(name, &commented);
        }
    }
}

/// The share of mangled texts that are still the same scenario: were it small, the properties would say little.
#[test]
fn most_mangled_texts_are_checked() {
    let texts = texts();
    let kept =
        texts.iter().filter(|(_, text)| mangled(text, &[9, 3, 9, 1, 9, 9, 4, 9, 2, 9, 9]).is_some()).count();
    assert!(kept * 2 > texts.len(), "{kept} of {}", texts.len());
}

#[test]
fn faults_change_nothing() {
    for text in ["event", "agent A plays p {", "const a = $", "const s = \"a", "scenario a b"] {
        let diagnostics = format(text).expect_err(text);
        assert_eq!(diagnostics, parse(FileId(0), text).1);
        assert!(!diagnostics.is_empty());
    }
}

/// A list of thousands of elements on one line, and thousands of blocks in a row.
#[test]
fn long_texts() {
    let list = format!("suite s by random {{ stimuli {} }}", vec!["a_stimulus"; 20_000].join(", "));
    assert!(checked("list", &list).lines().all(|l| l.len() <= 110));
    let scenario = fs::read_to_string(root().join("examples/handover/scenario.hri")).unwrap();
    checked("scenarios", &scenario.replace("scenario handover\n", "").repeat(20));
}

// ── The style, construct by construct ──

macro_rules! styles {
    ($($name:ident $text:literal)*) => {$(
        #[test]
        fn $name() {
            insta::assert_snapshot!(checked(stringify!($name), $text));
        }
    )*};
}

styles! {
    empty ""
    only_comments "\n\n  // one\n\n\n   /// two  \n//three\n\n"
    vocabulary r#"

/// A head.
scenario    s ;


use std . robots.bert2;use "people.hri"
allow HR0107    "why"
actor person:environment
actor the_robot
  : system   // the code
enum Order{feed,clean,}
enum Longer {
  feed, clean,
  rest   // none
}
enum Nothing{
}
record Pose{x:length,y:length}
record Wide{ x:length, // to the front
  y:length }
const A=4
const LONG=2*(3+-1)   // six
const LIST = f(1,-2,3,)
event a,b(x:bool)from p to r
event much_longer(x:bool,n:0..4,) from p   to r,q
event an_extraordinarily_long_name(gaze: bool, pressure: bool, location: bool) from sensors to robot
event c from p
"#
    expressions r#"
const a=1+2*3- -4%5
const b=not x&&y or z==1&&! w
const c=(1,-2.5,3 e)
const d=50%
const e = 7%2+10m/s-5cm
const f=if a<b{1}else{if c {2} else{3}}
const g=f(x,_,a.b . c)+abs(-(y))
const h=!!true||false and not not x
const h2=! !true||! ( x )
const i=1.5e3+0.25   rad/s/2 + 3 m/s^2
const j=a.system.part*(1)>=x.y
const k=if a {1} else if b {2} else {3}
const l=seen[i+1] .at[0].x-1
const m = 7
  % 2
const n = aaaaaaaaaaaaaaaaaaaaaaaaaa && bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb && (cccccccccccccccccccccc || dddddddddddddddddd) && eeeeeeeeee
const o = distance(person.hand.position, robot.finger_left.position) + distance(person.head.position, robot.finger_right.position)
const p = a
  && b
const q = f(a,
  b)
const r = f(
  a, g(b,
  c),
  d)
const s = a // one
  // two
  + b
"#
    stimulus r#"
/// The person asks.
stimulus ask(ok:bool,n:0 .. 3)by person{
  sample offset in if ok{10cm..20cm}else{if n>1{1m..2m}else{3m..4m}}
  sample dy in - 10 cm..if ok {1cm} else {2cm}
  emit leg_request emit decided ( true );hold 5s;

  person.hand.move_to(leg+(dx,dy,dz),800ms)
  if ok{person.grasp.grasp()}else{hold 1s;if n>2{emit x}}
  if ok { emit a } else if n > 1 {
    emit b } else { }
  if n > 1 { emit a } else if n > 2 { emit b } else { emit c }
}
stimulus nothing()by person{
}
stimulus say(ok: bool) by person { sample long_name in 10 cm .. 20 cm; person.hand.move_to(leg, 800 ms); hold 1 s }
"#
    agent r#"
agent Human(n:0..4,e:event)plays person{

  /// Chosen.
  belief wants(legs:0..LEGS);
  belief asked(legs:0..LEGS-1)=asked(0),asked(1); belief away goal!table
  belief near=near

  allow HR0107 "why"
  plan+!table when asked(N)&&N<4{ask;! a;!!b(1);?c(X);+d;-e(_);-+f(N+1);}
  plan@again-!leg(_){await released|discarded(true)within 120s;wait 10s;await x}
  plan + b{}
  plan-b{
  }
  plan +?b(X)when if X {true} else {false}{leave}
  plan on look ( G ){reach;hold(1)}
  plan on grip{reach} // why

  plan +!long when shows(L, G, P, X) && fickle_at(L) { look(G); reach(X); grip(P); say_ready; grip(false); !settle(1) }
  plan +!long
    when shows(L, G, P, X) && fickle_at(L) { look(G); reach(X); grip(P); say_ready; grip(false); !settle }
  plan +!long when shows(Leg, Gaze, Pressure, Location) && fickle_at(Leg) && another_belief(Leg) && yet_another_one(Leg) { a; b }
  plan +!open {
    ask; look(true);
    // then
    leave;

  }
}
agent B=Human(3,asked)
agent Long=Human(3,asked)
"#
    beliefs r#"
agent Human plays person{
  belief seen(leg:1..4)[sure:0..100,at:time]on e=seen(1)[ sure ( 9 ) , source(self) ],~ seen(2)
  belief light(gaze:bool)on sensed
  belief near[why:string]
  belief all(what:[ int ],who:agent,r:[[0..4]])=all([1,- 2],[ ],[[1 ] ])
  belief much_longer_than_the_others(first_parameter: 0..4, second_parameter: 0..4) [sure: 0..100, at: time] on an_event = much_longer_than_the_others(1, 2)[sure(9)], much_longer_than_the_others(2, 3)
  rule near(L)when at(L,D)&&D<3m
  rule ~ path(X,[X|T]) [sure(5)]when not .member(X,T)
  rule short
  rule connected_to(X, Y) when linked_directly(X, Y) || linked_directly(X, Somewhere_else) && connected_to(Somewhere_else, Y) && not broken(X)
  goal deliver(leg:1..4);goal table goal!table
}
"#
    steps r#"
agent Human plays person [ jason ]{
  plan@one [ atomic ]+! deliver ( L ) [ source(S),sure(9) ]when ~ broken(L)&&X=L+1&& .count(seen(_),N)&&N>2{}
  plan- ? at(_,_){.fail}
  plan -~seen(L)[source ( percept )]when .empty([ ]){.print ;}
  plan +!a{
    !fetch(L)within 10s;!! watch;? at(L,D);?( D<2m&&near(_) );?~ b[source(self)];D2=D+1m
    ;X=[H|T];+seen(L) [ sure(90) ];- seen(_)[source(Robot)];-+wants(2);-~b;.abolish(seen(_));.suspend
    ;.send(Robot,tell,seen(1)[sure(2)]);.print("saw ",All,);Y=if a{1}else{2};Z=([1,2])
  }
  plan +!b { .findall(Leg_that_was_seen, seen(Leg_that_was_seen)[source(percept), sure(100)], All_the_legs_seen); .print("saw ", All_the_legs_seen) }
}
"#
    blocks r#"
agent Human plays person{
  plan +!a{if near(L)&&X>2{a;b;}else if F{c}else{d};e}
  plan +!b {
    if near(L)&&X>2 { a;
      b }
    else if F {c} else { d }
    if x{};if y{a}else{};if z{a} if z{b};c;
    while not done{while(b){c}
      d}
    while .count(b(_),1) { for .member ( X,[1,2] ){} }
    for seen(K){ }
    fork{a}and{b;c}and{}
    fork {if x{a}
    }or{ b // why
    };last
    // at the end
  }
  plan +!c when x {
    if if x{y}else{z}{a}
    if near(Leg) && at(Leg, Distance) && Distance < 3 m && not broken(Leg) && wanted(Leg) && not seen(Leg) && free(Leg) {
      reach(Leg); grip(Leg)
    } else if far(Leg) { walk(Leg); reach(Leg); grip(Leg); say_that_it_is_in_the_hand(Leg); !settle(Leg) within 10 s; wait 3 s }
    while not done { // until done

      // first
      a

      ;

      b
    }

    for seen(K)
    { a } fork { a; b } and { c }
    // then
    fork { reach(Leg); grip(Leg); say_ready; !settle(Leg) within 10 s } or { wait 100 s; .print("nothing happened") } or { await gone }
    if x { a } // one
    else { b } // two
  }
}
"#
    automaton r#"
var away:bool=false
var location_  :bool
var seen: bool[4]
var grid:(0..4)[LEGS+1]
automaton P(n: 0..4) plays person{
  clock x,y
  var left:0..LEGS=0;var g:bool
  init committed location start
  urgent location mid{invariant x<=3s&&y<2s;}
  location idle{ }
  location broken {
    invariant x <= 1 s
  }

  start->idle when x>=3s do ask;left=left-1;x=0;
  idle->a_long_name select n:0..4,g:bool on look(g)
  mid -> mid do a[i] . x=3;; n+=1
  mid->mid
  mid -> idle when x >= 3 s && left > 0 && not pressure_ && not location_ && gaze_ on a_long_event_name(g, p, l) do left = left - 1; x = 0
}
network table=P|Q
automaton Q=P(3)
"#
    channels r#"
channel take(fork:0..4),free(fork:0..4)
channel hurry:urgent
channel tick:broadcast
channel alarm(n:0..3):urgent broadcast
channel done:joint P|Q?|R?
channel more:urgent joint P?|Q
var total:clock
var t:clock[3]
fn front()->0..4{return q[0]}
fn push(e:0..4){var i:0..5=0;while i<5{q[i]=e;i+=1}for k in 0..3{if q[k]>2{q[k]=0}else if q[k]==1{return}else{push2(k)}}}
automaton P{
clock x
init location a{invariant x<=n*1s&&n>0}
fn full()->bool{return q[n]>1}
a->b select i:0..4 when x-y<=q[i]*1s+2s&&full() on take(i) do push(2);x=0;y=3s;x=y+n*1s
b->a on done
}
query live "title" of net=P.a-->Q.b
query other of net=E<>P.a and not deadlock
query most of net=sup{P.a}:P.x,q[0]
query least of net=inf:P.x
query all of net=A[]P.a imply Q.b
"#
    requirements r#"
require R1 functional "a leg is released or discarded in time" after decided ( _ ):(released or discarded)within DEADLINE
require R2 functional "short"
  sensed(true,true,true)causes released
require R3 functional (a or b) forbids c until d
require R5 safety "the gripper does not close on a hand" never gripper_closing while min(distance(person.hand, robot.finger_left), 3 m) < 5 cm
require R6(e:event) safety globally speed<0.25rad/s
require R7=R6(asked)
require R8 functional "a formula that is longer than a line, so that it has to be broken somewhere" formula always(asked implies(not rising( near )since[0s,30s]offered)and eventually [0 s,10s](released(_)or-x+1<3))
assume at most 4 leg_request within 300s
assume at most
  4 (a or b)
"#
    coverage r#"
cover legs=count(leg_request)bins none=0,one=1,few=2..3,four=4..
cover ok=count( decided(true) or x )bins no=0,
  some=1 ..
cover m(e:event)=count(e)bins some=1..
cover n=m(asked)
cross c(a:cover)=legs*ok{
  bin "4 legs"when legs.four&&ok.some
  bin "a few legs, whatever" when legs.few;
  allow HR0107 "why"
  ignore when legs.none
}
"#
    suites r#"
suite s by agents Human,Robot{
  choose one wants of Human choose any shows of Human per leg where wants(L)&&not L>2
  explore pairwise;tests 160;horizon 300s
  patience 60s
}
suite t by search of table{reach each bin of c;reach each edge reach each pair of a,b&&c when R.x&&c reach each bound by 10ms;diverse 3}
suite r by random{stimuli ask,look;await offered|gone;length 5 .. 20;pause 0s..10s;boundary 0.5;tests 3}
"#
    tests r#"
test bdi_tests.t017{seed 17 method agents;because "wants(2)";predicts "a, b\n\\"}
test a.b{
  seed 1;ask
  look(true)with offset=15cm,d=-1cm;
  await released|discarded within 60s
  wait 10s
  look(true) with offset = 15 cm, distance = 55 cm, angle = 20 deg, another = 1 m, one_more = 2 m, and_the_last = 3 m
}
test together{child{meanwhile   sing;run(true)
await a within 3s}dog{wait 1s}
  cat{}}
"#
    world r#"
part p(n:0..4){
  /// A palm.
  body palm:dynamic box(4cm,8cm,8cm)at(0m,0m,0m)graspable mass 0.4kg ghost rotated(0deg,0deg,1deg)
  joint j:torso->palm at(0m,0m,0m)axis(0,0,1)limits -60deg..60deg
  joint hinge_of_the_door:frame->leaf at(0m,0m,0m)axis(0,0,1)limits 0deg..110deg damping 2Nms/rad   friction 1Nm
  arm a:j,k tip palm tool(8cm,0m,0m)speed 0.2rad/s
  arm arm: hip_rotor, hip_flexor, shoulder_flexor, shoulder_abduction, humeral_rotation, elbow_flexor, wrist_pronation, wrist_abduction tip palm tool (8 cm, 0 cm, 0 cm) speed 0.2 rad/s
  gripper g:palm tool(8cm,0m,0m)reach 4cm delay 500ms
  base b:palm speed 1m/s turn 1rad/s acceleration 1m/s^2
  base wheels: the_platform_of_it speed 0.5 m/s sideways 0.25 m/s turn 90 deg/s acceleration 0.5 m/s^2 timeout 500 ms
  laser l:palm at(0m,0m,0m)angles-90deg..90deg beams 181 range 5cm..10m
  laser scanner: the_platform_of_it at (20 cm, 0 m, 0.5 * height) angles -135 deg .. 135 deg beams 271 range 5 cm .. 10 m
}
world{

  step 10ms // fine
  sample 50 ms       // coarse
  gravity(0,0,-9.81)

  part robot=p(3)at(0m,0m,0m)rotated(0deg,0deg,90deg)
  part me=q at(0m,0m,0m)
  current leg in leg1,p.leg2 by robot.g
  signal gaze:bool to robot,person=abs(x)<=20cm
    &&visible(a,b)
  signal gaze: bool to robot = abs(person.head.y - leg.y) <= 20 cm && range(person.head, leg) <= 60 cm && angle(person.head, leg) < 40 deg
  on sense when range(a.b,c.d)<2m emit sensed(gaze)
  on close robot.g emit closing on open robot.g emit opening
  on open ( x )when x emit f

}
system robot{run "python3 robot.py" coverage "a.py","b.py";limit 300s;budget 10s}
"#
    sensors r#"
part p{
  base b:palm speed 1m/s turn 1rad/s acceleration 1m/s^2 every 20ms drift 2cm,1deg
  base wheels: the_platform_of_it speed 0.5 m/s sideways 0.25 m/s turn 90 deg/s acceleration 0.5 m/s^2 timeout 500 ms noise 1cm,0.5deg , 1cm/s
  arm a:j,k tip palm tool(8cm,0m,0m)speed 0.2rad/s contact 60N avoids   people noise 0.1deg late 5ms
  laser l:palm at(0m,0m,0m)angles-90deg..90deg beams 181 range 5cm..10m dropout 0.5% outlier 1%  late LAG noise 1cm
}
world{
  signal near:bool to robot=distance(a,b)<10cm flip 1% every 100ms late 50ms
  signal a_name_that_is_rather_long: length to robot, person = distance(person.hand, robot.palm) every 50 ms late 20 ms noise 5 mm
   dropout 2 %
  signal gap:length to robot=x outlier 1%in 0m..5m late 20ms
  signal n:0..9 to robot=if x{7%late}else{7%2}
}
"#
    places r#"
world{
  body a:fixed box(1m,1m,1m)on table at(10cm,-20cm)mass 1kg
  body b:fixed box(1m,1m,1m)left of a.b by 5cm facing robot ghost
  body c:fixed box(1m,1m,1m)on table behind a by D
  part left=p(1)ahead of right by 1m facing left
  part right=p right of behind by 1m rotated(0deg,0deg,1deg)
  part behind=p behind ahead by 1m
  part ahead=p on a facing b
}
"#
    devices r#"
/// A hand.
device   gripper{/// Closes.
command close do close_fingers expect holds else"the gripper closed on nothing"
  command open do   open_fingers expect not holds else "the gripper still holds something, and this is a long line";command wave do wave

}
device laser{state   near from beam_ranges}
device arm{ command go ( to:length [3] ? ,speed : angular_speed ? )do reach_point
command turn(to:[angle],speed:angular_speed)
  do reach_joints }
"#
    bindings r#"
system robot{run"python3 robot.py" ros1{
topic "/cmd_vel":geometry_msgs/Twist out drives robot.base
topic"/scan":sensor_msgs/LaserScan in at 10Hz from robot.laser{header.frame_id="front_laser"}
  topic "/joint_states" : sensor_msgs/JointState in at 20 Hz from robot.arm latched
  topic "/a_topic_with_a_long_name/in_a_name_space" : nav_msgs/Odometry in at 20 Hz from a_part.of_the_robot.base latched
}}
"#
    binding_values r#"
part crane{posture   home:arm at[ 0 deg,- 90deg ]
posture up :robot . arm at [turn]}
system robot{run"python3 robot.py" ros1{
topic "/c/*":std_msgs/Float64 out drives crane.arm{"slew"=turn;"luff"   =wrist}
topic "/p":geometry_msgs/PoseArray in at 1Hz{poses [ 0 ] . position . x=1;data=[1,2 ,3]
covariance[ 7 ]=length( a )}
  service "/s":std_srvs/SetBool{success=true when data;success=false}
topic "/scan":sensor_msgs/LaserScan out{emit near when length(ranges)>3&&ranges [3]<0.4
  emit far(points[ 0 ].x)}
group "c" plans crane.arm   acceleration 2rad/s^2 tip"hook"{"slew"=turn
"luff"=wrist}
parameter   "/a"=[1,2]
}}
"#
    functions r#"
fn front()->0..4{return q[0]}
fn pop()->0..4{var first:0..4=q[0];var i:0..5;while i<4{q[i]=q[i+1];i+=1}q[4]=0;len-=1;return first}
fn lines(a:0..4,b:bool){
var first:0..4=q[0];
var second : bool = false; // a comment
// another
while i<4{q[i]=q[i+1];i+=1}

q[4]=0;len-=1
; if a > b { return } else if c { x = 1;
 y = 2 } else { f(1) }
for k in 0..3 {
 for j in 0..k-1 { swap(k,j) } }
}
automaton A{
init location a
fn f(a:0..3,b:bool)->bool{return a>2&&b}
fn g(a:0..3){
q[a].x=a;n-=2
}
a->a when f(1,true)do g(2)
}
"#
    comments_everywhere r#"// head
scenario s // name
// ── Agents ── the people
agent A plays p { // opens

  // first
  belief a // one
  belief longer // two
  // between

  // alone
  plan +!x { a; // a
    // b
    b }
  // last

} // closed
// end"#
}
