//! A fault costs the declaration, member or step that it is in, and nothing else.

use hrdsl_source::FileId;
use hrdsl_syntax::ast::{
    AgentMemberKind, AgentSyntax, AutomatonMemberKind, AutomatonSyntax, DeviceMemberKind, ExprSyntaxKind,
    FileSyntax, FunctionSyntax, ItemSyntaxKind, StatementSyntax, StatementSyntaxKind, StepSyntax,
    StepSyntaxKind, StimulusStepKind, SuiteMemberKind, TestMemberKind, WorldMemberKind,
};
use hrdsl_syntax::parse;

const SCENARIO: &str = include_str!("../../../examples/handover/scenario.hri");

/// The scenario with one replacement, and how many diagnostics it has.
fn with(from: &str, to: &str) -> (FileSyntax, usize) {
    assert!(SCENARIO.contains(from), "{from}");
    let (file, diagnostics) = parse(FileId(0), &SCENARIO.replacen(from, to, 1));
    assert!(!diagnostics.is_empty());
    (file, diagnostics.len())
}

fn errors(file: &FileSyntax) -> usize {
    file.items.iter().filter(|i| i.kind == ItemSyntaxKind::Error).count()
}

fn whole() -> FileSyntax {
    parse(FileId(0), SCENARIO).0
}

fn agent<'f>(file: &'f FileSyntax, name: &str) -> &'f AgentSyntax {
    let found = file.items.iter().find_map(|i| match &i.kind {
        ItemSyntaxKind::Agent(a) if a.name.text == name => Some(a),
        _ => None,
    });
    found.expect("the agent is there")
}

fn automaton<'f>(file: &'f FileSyntax, name: &str) -> &'f AutomatonSyntax {
    let found = file.items.iter().find_map(|i| match &i.kind {
        ItemSyntaxKind::Automaton(a) if a.name.text == name => Some(a),
        _ => None,
    });
    found.expect("the automaton is there")
}

#[test]
fn a_broken_step_costs_that_step() {
    let (file, n) = with(
        "look(G); reach(X); grip(P); say_ready; !settle }",
        "look(G); reach(; grip(P); say_ready; !settle }",
    );
    assert_eq!((n, errors(&file), file.items.len()), (1, 0, whole().items.len()));
    let (all, reference) = (whole(), agent(&file, "Human"));
    assert_eq!(reference.members.len(), agent(&all, "Human").members.len());
    let bodies: Vec<_> = reference
        .members
        .iter()
        .filter_map(|m| match &m.kind {
            AgentMemberKind::Plan(plan) => Some(&plan.body),
            AgentMemberKind::Belief { .. }
            | AgentMemberKind::Rule { .. }
            | AgentMemberKind::GoalType { .. }
            | AgentMemberKind::Goal(_)
            | AgentMemberKind::Allow(_)
            | AgentMemberKind::Error => None,
        })
        .collect();
    let broken: Vec<_> =
        bodies.iter().filter(|b| b.iter().any(|s| s.kind == StepSyntaxKind::Error)).collect();
    assert_eq!(broken.len(), 1);
    assert_eq!(broken[0].len(), 5, "the four other steps are there");
}

/// The steps of the plan of a text with one agent, a word for each: what is in blocks in brackets.
fn steps(text: &str) -> (String, usize) {
    fn all(steps: &[StepSyntax]) -> String {
        steps.iter().map(|s| one(&s.kind)).collect::<Vec<_>>().join(" ")
    }
    fn one(kind: &StepSyntaxKind) -> String {
        match kind {
            StepSyntaxKind::Do(call) | StepSyntaxKind::Achieve { call, .. } | StepSyntaxKind::Spawn(call) => {
                call.name.text.clone()
            }
            StepSyntaxKind::Internal(call) => format!(".{}", call.name.text),
            StepSyntaxKind::Query(l)
            | StepSyntaxKind::Add(l)
            | StepSyntaxKind::Remove(l)
            | StepSyntaxKind::Replace(l) => l.call.name.text.clone(),
            StepSyntaxKind::Test(_) => "test".to_owned(),
            StepSyntaxKind::Unify { .. } => "unify".to_owned(),
            StepSyntaxKind::Await { .. } => "await".to_owned(),
            StepSyntaxKind::Wait(_) => "wait".to_owned(),
            StepSyntaxKind::If { then, otherwise, .. } => format!("if[{}][{}]", all(then), all(otherwise)),
            StepSyntaxKind::While { body, .. } => format!("while[{}]", all(body)),
            StepSyntaxKind::For { body, .. } => format!("for[{}]", all(body)),
            StepSyntaxKind::Fork { all: and, branches } => {
                let branches: String = branches.iter().map(|b| format!("[{}]", all(b))).collect();
                format!("{}{branches}", if *and { "and" } else { "or" })
            }
            StepSyntaxKind::Error => "-".to_owned(),
        }
    }
    let text = format!("agent A plays p {{ plan +!a {{ {text} }} }}");
    let (file, diagnostics) = parse(FileId(0), &text);
    let AgentMemberKind::Plan(plan) = &agent(&file, "A").members[0].kind else { panic!("{text}") };
    (all(&plan.body), diagnostics.len())
}

#[test]
fn a_bad_step_in_a_block_costs_that_step() {
    for (text, expected, faults) in [
        ("a; if x { b; c(; d } else { e; = ; f } g", "a if[b - d][e - f] g", 2),
        ("if x { b } else if y { c; ! } else { d; ? } e", "if[b][if[c -][d -]] e", 2),
        ("while x { a; for y { b; ! ; c }; d } e", "while[a for[b - c] d] e", 1),
        ("fork { a; ! } and { b } and { ?; c }; d", "and[a -][b][- c] d", 2),
        ("fork { a } or { b; wait }", "or[a][b -]", 1),
        ("if if x { y } else { z } { a; ! ; b } c", "if[a - b][] c", 1),
        ("if x { a; if y { b; if z { c; !; d } e } f } g", "if[a if[b if[c - d][] e][] f][] g", 1),
    ] {
        assert_eq!(steps(text), (expected.to_owned(), faults), "{text}");
    }
}

/// The blocks of a step whose head is bad are read for their faults, and the steps after it stay.
#[test]
fn a_bad_head_costs_that_step() {
    for (text, expected, faults) in [
        ("a; if { b; ! } c", "a - c", 2),
        ("while x && { b } c; d", "- c d", 1),
        ("fork { a } and { b } or { c } d", "- d", 1),
        ("fork { a } b", "- b", 1),
        ("if x { a } else b; c", "if[a][] - c", 1),
        ("while x a; b", "- b", 1),
        ("reach(y\n while x { a }\n b", "- while[a] b", 1),
        ("reach(\n !b; c", "- c", 1),
    ] {
        assert_eq!(steps(text), (expected.to_owned(), faults), "{text}");
    }
}

#[test]
fn missing_semicolons_and_full_stops_cost_nothing() {
    for (text, expected, faults) in [
        ("a if x { b c } d; e", "a if[b c][] d e", 2),
        ("a while x { b }; while y { c } d", "a while[b] while[c] d", 1),
        ("a\n .print(1)\n .fail", "a .print .fail", 2),
        ("a .print(1); ?b(1) .fail; wait 5 s\n .fail", "a .print b .fail wait .fail", 3),
        ("a; b.", "a b", 1),
        ("if x { a. } b.; c", "if[a][] b c", 2),
        ("if x { a };; b", "if[a][] b", 1),
    ] {
        assert_eq!(steps(text), (expected.to_owned(), faults), "{text}");
    }
}

#[test]
fn new_members_are_found_after_broken_ones() {
    let text = "agent A plays p {
      belief b(x
      rule c(X) when d(X)
      goal 5 rule e
      rule when f
      goal g(x: int) plan +!h { a
      rule i when j
      goal k }
    suite s by random { tests ?
      stop after 3
      explore 5
      minimise
      reach each plan }";
    let (file, diagnostics) = parse(FileId(0), text);
    let kinds: Vec<_> = agent(&file, "A")
        .members
        .iter()
        .map(|m| match &m.kind {
            AgentMemberKind::Belief { .. } => "belief",
            AgentMemberKind::Rule { .. } => "rule",
            AgentMemberKind::GoalType { .. } => "type",
            AgentMemberKind::Goal(_) => "goal",
            AgentMemberKind::Plan(_) => "plan",
            AgentMemberKind::Allow(_) => "allow",
            AgentMemberKind::Error => "-",
        })
        .collect();
    assert_eq!(kinds, ["-", "rule", "-", "rule", "-", "type", "plan", "rule", "type"], "{diagnostics:#?}");
    let ItemSyntaxKind::Suite(suite) = &file.items[1].kind else { panic!("a suite") };
    let broken = suite.members.iter().filter(|m| m.kind == SuiteMemberKind::Error).count();
    assert_eq!((suite.members.len(), broken), (5, 2), "{diagnostics:#?}");
}

#[test]
fn a_missing_semicolon_costs_nothing() {
    let (file, n) = with(
        "look(G); reach(X); grip(P); say_ready; !settle }",
        "look(G) reach(X); grip(P) say_ready; !settle }",
    );
    assert_eq!(n, 2);
    let names = |a: &AgentSyntax| format!("{a:?}").matches("Step {").count();
    assert_eq!(names(agent(&file, "Human")), names(agent(&whole(), "Human")));
}

#[test]
fn a_broken_member_costs_that_member() {
    let (file, n) = with("  clock t\n", "  clck t\n");
    assert_eq!(n, 1);
    let broken = automaton(&file, "Person");
    assert_eq!(broken.members.len(), automaton(&whole(), "Person").members.len());
    assert_eq!(broken.members.iter().filter(|m| m.kind == AutomatonMemberKind::Error).count(), 1);
}

#[test]
fn a_broken_edge_costs_that_edge() {
    let (file, n) = with("offered -> waiting do t = 0", "offered -> waiting when t = do t = 0; x = 1");
    assert_eq!(n, 1);
    let broken = automaton(&file, "Person");
    assert_eq!(broken.members.len(), automaton(&whole(), "Person").members.len());
}

#[test]
fn a_broken_header_costs_the_declaration() {
    let (file, n) = with("agent Human plays person {", "agent Human person {");
    assert_eq!((n, errors(&file), file.items.len()), (1, 1, whole().items.len()));
}

#[test]
fn a_missing_brace_is_put_in() {
    for (from, to) in [
        ("  plan -!leg(_) { leave }", "  plan -!leg(_) { leave"),
        ("  goal !table", "  goal !table }"),
        ("location shown { invariant t <= 2 s }", "location shown { invariant t <= 2 s"),
        ("  tests 160\n}\nsuite ta", "  tests 160\nsuite ta"),
    ] {
        let (file, n) = with(from, to);
        assert!(n <= 2, "{to}: {n}");
        assert!(file.items.len() >= whole().items.len(), "{to}");
        assert!(agent(&file, "Sensors").members.len() > 8, "{to}");
    }
}

#[test]
fn a_misspelt_keyword_is_understood() {
    let (file, n) = with("agent Human plays", "agnet Human plays");
    assert_eq!((n, errors(&file)), (1, 0));
    assert!(agent(&file, "Human").members.len() > 10);
}

#[test]
fn names_survive_their_broken_values() {
    let (file, _) = with("const LEGS     = 4", "const LEGS = 4 +");
    assert!(
        file.items.iter().any(|i| matches!(&i.kind,
        ItemSyntaxKind::Const { name, value } if name.text == "LEGS" && value.kind == ExprSyntaxKind::Error))
    );
    let (file, _) =
        with("sensed(true, true, true) causes handed_over", "sensed(true, true, true) cause released");
    assert!(file.items.iter().any(|i| matches!(&i.kind,
        ItemSyntaxKind::Require(r) if r.name.text == "R2" && r.title.is_some() && r.pattern.kind.is_none())));
}

#[test]
fn a_missing_keyword_costs_its_own_declaration() {
    let (file, n) = with("event bored ", "bored ");
    // The declaration before it is kept; what could not be read has its place in the tree.
    assert_eq!((n, errors(&file), file.items.len()), (1, 1, whole().items.len()));
}

#[test]
fn a_broken_step_costs_itself_in_an_actors_block() {
    let text =
        "test t { seed 1\n  child { run(; wait 3 s\n    meanwhile wait 3 s\n    sing }\n  dog { bark }\n}\n";
    let (file, diagnostics) = parse(FileId(0), text);
    assert_eq!((errors(&file), diagnostics.len()), (0, 2), "{diagnostics:#?}");
    let ItemSyntaxKind::Test(test) = &file.items[0].kind else { panic!("{file:?}") };
    let blocks = test.members.iter().filter_map(|member| match &member.kind {
        TestMemberKind::Script { actor, members } => {
            let broken = members.iter().filter(|m| m.kind == TestMemberKind::Error).count();
            Some((actor.text.as_str(), members.len(), broken))
        }
        _ => None,
    });
    assert_eq!(blocks.collect::<Vec<_>>(), [("child", 4, 2), ("dog", 1, 0)]);
}

#[test]
fn every_sort_of_block_recovers() {
    let text = r#"
stimulus s by p { emit a; hold; emit b; if x { emit; emit c } else { hold 1 s } emit d }
cross c = a * b { bin "a" when; bin "b" when x ignore y ignore when z }
suite u by random { tests; length 1..2; paus 3 s horizon 4 s }
test t { seed 1 look(; wait 3 s
  await x; ask }
world { step 1 ms
  body a fixed
  body b: fixed box(1 m) at x mass
  on close emit
  sample 2 ms }
system r { run x limit 3 s }
device arm { command a; command b(to: length[3] do x
  command c do x expect; command d do x }
"#;
    let (file, diagnostics) = parse(FileId(0), text);
    assert_eq!(errors(&file), 0, "{diagnostics:#?}");
    assert_eq!(file.items.len(), 7);
    for item in &file.items {
        match &item.kind {
            ItemSyntaxKind::Stimulus(s) => {
                assert_eq!(s.body.len(), 5);
                assert!(s.body[1].kind == StimulusStepKind::Error, "hold");
                assert!(matches!(&s.body[3].kind,
                    StimulusStepKind::If { then, otherwise, .. } if then.len() == 2 && otherwise.len() == 1));
            }
            ItemSyntaxKind::Cross(c) => assert_eq!(c.members.len(), 4),
            ItemSyntaxKind::Suite(s) => assert_eq!(s.members.len(), 4),
            ItemSyntaxKind::Test(t) => {
                assert_eq!(t.members.len(), 5);
                assert_eq!(t.members.iter().filter(|m| m.kind == TestMemberKind::Error).count(), 2);
            }
            ItemSyntaxKind::World(w) => {
                assert_eq!(w.members.len(), 5);
                assert!(matches!(w.members[4].kind, WorldMemberKind::Sample(_)));
            }
            ItemSyntaxKind::System(s) => assert_eq!(s.members.len(), 2),
            ItemSyntaxKind::Device(d) => {
                let broken = d.members.iter().map(|m| m.kind == DeviceMemberKind::Error);
                assert_eq!(broken.collect::<Vec<_>>(), [true, true, true, false]);
            }
            other => panic!("{other:?}"),
        }
    }
}

/// The functions of a file and of its automata.
fn functions(file: &FileSyntax) -> Vec<&FunctionSyntax> {
    let mut found = Vec::new();
    for item in &file.items {
        match &item.kind {
            ItemSyntaxKind::Function(f) => found.push(f),
            ItemSyntaxKind::Automaton(a) => found.extend(a.members.iter().filter_map(|m| match &m.kind {
                AutomatonMemberKind::Function(f) => Some(f),
                _ => None,
            })),
            _ => {}
        }
    }
    found
}

/// The statements, those in blocks too, and how many of them could not be read.
fn statements(of: &[StatementSyntax]) -> (usize, usize) {
    let inner = |parts: &[&[StatementSyntax]]| {
        parts.iter().map(|p| statements(p)).fold((1, 0), |(n, bad), (m, b)| (n + m, bad + b))
    };
    of.iter().fold((0, 0), |(n, bad), s| {
        let (m, b) = match &s.kind {
            StatementSyntaxKind::If { then, otherwise, .. } => inner(&[then, otherwise]),
            StatementSyntaxKind::While { body, .. } | StatementSyntaxKind::For { body, .. } => inner(&[body]),
            StatementSyntaxKind::Error => (1, 1),
            StatementSyntaxKind::Var(_)
            | StatementSyntaxKind::Assign { .. }
            | StatementSyntaxKind::Call(_)
            | StatementSyntaxKind::Return(_) => (1, 0),
        };
        (n + m, bad + b)
    })
}

#[test]
fn a_broken_statement_costs_that_statement() {
    let text = "\
fn a(n: 0..3) -> bool {
  var i: 0..3 = ;
  i = 1;
  if n > { i = 2 } else if n == 1 { i = ; n = 2 } else { f( }
  while n > 1 { i = 3; return + }
  for k of 0..3 { g(k) }
  i = 4
  j = 5;;
  return true
}
fn b() { return }
automaton A {
  fn c(n: 0..3) -> bool { i = = 2; return true }
  init location x
  fn d() { for i in 0..2 { n += ; m = 1 } }
  x -> x
}
";
    let (file, diagnostics) = parse(FileId(0), text);
    let found: Vec<(&str, usize, bool, (usize, usize))> = functions(&file)
        .into_iter()
        .map(|f| (f.name.text.as_str(), f.params.len(), f.result.is_some(), statements(&f.body)))
        .collect();
    assert_eq!(
        found,
        [("a", 1, true, (10, 4)), ("b", 0, false, (1, 0)), ("c", 1, true, (2, 1)), ("d", 0, false, (3, 1)),],
        "{diagnostics:#?}"
    );
    assert_eq!(errors(&file), 0);
    assert_eq!(automaton(&file, "A").members.len(), 4);
    let lines: Vec<usize> =
        diagnostics.iter().map(|d| text[..d.span().start as usize].matches('\n').count() + 1).collect();
    assert_eq!(lines, [2, 4, 4, 4, 5, 6, 8, 8, 13, 15], "{diagnostics:#?}");
}

/// The rest of the line is a comment, and nothing else is lost.
#[test]
fn a_hash_is_a_comment() {
    let (file, n) = with("const LEGS     = 4", "const LEGS = 4 # { the legs, (");
    assert_eq!((n, errors(&file)), (1, 0));
    assert_eq!(file.items.len(), whole().items.len());
}
