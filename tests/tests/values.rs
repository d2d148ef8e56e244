//! What records, arrays, vectors and enumerations mean when they run: compared with arrays, structures and f64 of Rust.

use hrdsl_bdi::{AgentAction, AgentSociety};
use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    Program, Symbol, Value,
    bdi::AgentId,
    ta::{AutomatonId, LocationId},
    value::SECOND,
};
use hrdsl_runtime::testgen::{generate, write};
use hrdsl_ta::{
    CompiledNetwork, GoalKind, GoalOutcome, ObservationOptions, ReachabilityGoal, SearchBudget,
    SearchOptions, VirtualTimePlayer, check, explore,
};

const ACTORS: &str = "actor person : environment\nactor robot : system\n";

fn program(text: &str, tests: &[&str]) -> Program {
    let text = format!("scenario small\n{ACTORS}{text}");
    let tests: Vec<InputFile<'_>> =
        tests.iter().map(|text| InputFile { name: "t.tests.hri", text }).collect();
    let c = compile(InputFile { name: "small.hri", text: &text }, &tests);
    let errors = c.diagnostics.iter().filter(|d| d.is_error());
    let said: Vec<String> = errors.map(|d| format!("{} {}", c.files.place(d.span()), d.message)).collect();
    assert_eq!(said, Vec::<String>::new(), "{text}");
    c.program.unwrap()
}

// ── assignments, against an interpreter on arrays ──

/// A small generator of numbers, so that the programs are the same everywhere.
struct Draw(u64);

impl Draw {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap() % n
    }
}

/// `a: (0..3)[3]`, `g: (0..3)[2][3]`, `legs: Leg[2]`, `i: 0..2`, `j: 0..1`.
#[derive(Clone, Default)]
struct Memory {
    a: [i64; 3],
    g: [[i64; 3]; 2],
    legs: [(bool, i64); 2],
    i: usize,
    j: usize,
}

const VARIABLES: &str = "record Leg { held: bool, count: 0..3 }\nautomaton A plays robot {\n  var a: (0..3)[3]\n  var g: (0..3)[2][3]\n\
    var legs: Leg[2]\n  var i: 0..2\n  var j: 0..1\n";

impl Memory {
    fn flat(&self) -> Vec<Value> {
        let mut all: Vec<Value> =
            self.a.iter().chain(self.g.iter().flatten()).map(|n| Value::Int(*n)).collect();
        all.extend(self.legs.iter().flat_map(|(held, n)| [Value::Bool(*held), Value::Int(*n)]));
        all.extend([self.i, self.j].map(|n| Value::Int(i64::try_from(n).unwrap())));
        all
    }

    /// An index of an array of three or two: its text and value.
    fn index(&self, d: &mut Draw, three: bool) -> (String, usize) {
        match (d.below(5), three) {
            (0, true) => ("i".to_owned(), self.i),
            (1, true) => ("2 - i".to_owned(), 2 - self.i),
            (2, true) => ("min(a[0], 2)".to_owned(), usize::try_from(self.a[0].min(2)).unwrap()),
            (3, true) => ("(i + j) % 3".to_owned(), (self.i + self.j) % 3),
            (0 | 3, false) => ("j".to_owned(), self.j),
            (1, false) => ("1 - j".to_owned(), 1 - self.j),
            (2, false) => ("i / 2".to_owned(), self.i / 2),
            (_, three) => {
                let n = d.below(if three { 3 } else { 2 });
                (n.to_string(), n)
            }
        }
    }

    /// An element: its text and value.
    fn element(&self, d: &mut Draw) -> (String, i64) {
        let ((x, i), (y, j)) = (self.index(d, true), self.index(d, false));
        match d.below(3) {
            0 => (format!("a[{x}]"), self.a[i]),
            1 => (format!("g[{y}][{x}]"), self.g[j][i]),
            _ => (format!("legs[{y}].count"), self.legs[j].1),
        }
    }

    /// A number of 0..3.
    fn number(&self, d: &mut Draw) -> (String, i64) {
        let ((x, a), (y, b)) = (self.element(d), self.element(d));
        match d.below(6) {
            0 => (x, a),
            1 => (format!("({x} + {y}) % 4"), (a + b) % 4),
            2 => (format!("max({x}, {y})"), a.max(b)),
            3 => (
                format!("if {x} < {y} {{ {y} - {x} }} else {{ 3 - {x} }}"),
                if a < b { b - a } else { 3 - a },
            ),
            4 => (format!("abs({x} - {y})"), (a - b).abs()),
            _ => {
                let n = d.below(4);
                (n.to_string(), i64::try_from(n).unwrap())
            }
        }
    }

    fn truth(&self, d: &mut Draw) -> (String, bool) {
        let ((x, a), (y, j), (z, i)) = (self.number(d), self.index(d, false), self.index(d, true));
        match d.below(6) {
            0 => (format!("legs[{y}].held"), self.legs[j].0),
            1 => (format!("g[{y}] == a"), self.g[j] == self.a),
            2 => (format!("legs[0] != legs[{y}]"), self.legs[0] != self.legs[j]),
            3 => (format!("legs[{y}] == (true, {x})"), self.legs[j] == (true, a)),
            4 => (format!("a[{z}] >= {x}"), self.a[i] >= a),
            _ => (format!("a != (0, 1, {x})"), self.a != [0, 1, a]),
        }
    }

    /// Does a random assignment, and tells its text; `None` if it would read what it sets.
    fn assign(&mut self, d: &mut Draw) -> Option<String> {
        let ((x, i), (y, j)) = (self.index(d, true), self.index(d, false));
        let ((n, v), (t, b)) = (self.number(d), self.truth(d));
        let reads = |index: &str, of: &str| index.contains(of);
        Some(match d.below(11) {
            0 if !reads(&x, "a[") => {
                self.a[i] = v;
                format!("a[{x}] = {n}")
            }
            1 => {
                self.g[j][i] = v;
                format!("g[{y}][{x}] = {n}")
            }
            2 => {
                self.legs[j].0 = b;
                format!("legs[{y}].held = {t}")
            }
            3 if !n.contains("legs[") && !t.contains("legs[") => {
                self.legs[j] = (b, v);
                format!("legs[{y}] = ({t}, {n})")
            }
            4 => {
                self.a = self.g[j];
                format!("a = g[{y}]")
            }
            5 => {
                self.g[j] = self.a;
                format!("g[{y}] = a")
            }
            6 => {
                self.a = [self.a[1], self.a[2], v];
                if n.contains("a[") {
                    return None;
                }
                format!("a = (a[1], a[2], {n})")
            }
            7 => {
                self.i = usize::try_from(v.min(2)).unwrap();
                format!("i = min({n}, 2)")
            }
            8 => {
                self.j = usize::from(b);
                format!("j = if {t} {{ 1 }} else {{ 0 }}")
            }
            9 if b => {
                self.legs = [(false, v), (b, 1)];
                if n.contains("legs[") {
                    return None;
                }
                format!("legs = ((false, {n}), Leg(true, 1))")
            }
            10 if self.a[i] < 3 && !reads(&x, "a[") => {
                self.a[i] += 1;
                format!("a[{x}] += 1")
            }
            _ => return None,
        })
    }
}

/// Random assignments, one on each edge: their text, and what they leave.
fn assignments(seed: u64) -> (Vec<String>, Memory) {
    let (mut d, mut memory, mut texts) = (Draw(seed), Memory::default(), Vec::new());
    while texts.len() < 12 {
        let mut next = memory.clone();
        if let Some(text) = next.assign(&mut d) {
            memory = next;
            texts.push(text);
        }
    }
    (texts, memory)
}

#[test]
fn assignments_leave_what_they_would_leave_in_arrays() {
    for seed in 0..150 {
        let (texts, memory) = assignments(seed);
        let mut text = VARIABLES.to_owned();
        for at in 0..=texts.len() {
            let init = if at == 0 { "init " } else { "" };
            text += &format!("  {init}location l{at}\n");
        }
        for (at, assignment) in texts.iter().enumerate() {
            text += &format!("  l{at} -> l{} do {assignment}\n", at + 1);
        }
        text += "}\nnetwork n = A\n";
        let p = program(&text, &[]);
        let mut player = VirtualTimePlayer::new(&p, AutomatonId(0));
        player.run(0, &mut Vec::new()).unwrap();
        assert_eq!(player.location(), Some(LocationId(u16::try_from(texts.len()).unwrap())));
        let want = memory.flat();
        let got: Vec<Value> =
            (0..want.len()).map(|i| player.variable(u16::try_from(i).unwrap()).unwrap()).collect();
        assert_eq!(got, want, "{text}");
        // The search stores one state for each assignment.
        let goal = ReachabilityGoal {
            what: GoalKind::Location {
                automaton: 0,
                location: LocationId(u16::try_from(texts.len()).unwrap()),
            },
            settled: true,
        };
        let report = check(&p, &p.networks[0], &[goal], &[], &[], SearchBudget::default()).unwrap();
        assert!(matches!(report.goals[0], GoalOutcome::Reached(_)));
    }
}

/// The same automaton by hand, without arrays and records, has as many states.
#[test]
fn arrays_and_single_variables_have_the_same_states() {
    let whole = "event put(at: 0..2, l: Leg) from person\nrecord Leg { held: bool, count: 0..1 }\n\
        automaton P plays person {\n  init location a\n  a -> a select i: 0..2, h: bool do put(i, (h, 1))\n}\n\
        automaton R plays robot {\n  clock x\n  var legs: Leg[3] = ((false, 1), (false, 0), (true, 0))\n  var last: Leg\n  init location a\n\
          a -> a when legs[i] != l on put(i, l) do legs[i] = l; last = legs[2 - i]; x = 0\n}\nnetwork n = P | R\n";
    let mut by_hand = String::from(
        "event put(at: 0..2, held: bool, count: 0..1) from person\n\
        automaton P plays person {\n  init location a\n  a -> a select i: 0..2, h: bool do put(i, h, 1)\n}\n\
        automaton R plays robot {\n  clock x\n  var h0: bool\n  var c0: 0..1 = 1\n  var h1: bool\n  var c1: 0..1\n  var h2: bool = true\n  var c2: 0..1\n\
          var hl: bool\n  var cl: 0..1\n  init location a\n",
    );
    for i in 0..3 {
        by_hand += &format!(
            "  a -> a when h{i} != h || c{i} != c on put({i}, h, c) do h{i} = h; c{i} = c; hl = h{0}; cl = c{0}; x = 0\n",
            2 - i
        );
    }
    by_hand += "}\nnetwork n = P | R\n";
    let states = |text: &str| {
        let p = program(text, &[]);
        // What nothing reads is kept, too.
        let options = SearchOptions { reduce: false, ..SearchOptions::reference() };
        let model = CompiledNetwork::new(&p, &p.networks[0], &ObservationOptions::default()).unwrap();
        let report = explore(&model, &[], &options, &|_| true).unwrap();
        assert!(report.complete);
        (report.states_stored, report.discrete_states)
    };
    let found = states(whole);
    assert!(found.1 > 10, "{found:?}");
    assert_eq!(found, states(&by_hand));
}

// ── agents ──

const AGENT: &str = "enum Order { feed, clean }\nrecord Cell { col: 0..3, row: 0..3 }\nrecord Job { at: Cell, what: Order, done: bool[2] }\n\
    event seen(c: Cell) from robot to person\nevent went(c: Cell, o: Order, n: 0..9) from person\nstimulus go(j: Job) by person { emit went(j.at, j.what, j.at.col + j.at.row) }\n\
    agent A plays person {\n  belief at(c: Cell) = at((1, 2))\n  belief job(j: Job) = job(((1, 2), clean, (true, false))), job((Cell(3, 0), feed, (false, true)))\n\
      belief list(o: Order[2], n: 0..3) = list((feed, clean), 1)\n  goal !start\n\
      plan +!start when at((X, _)) && list((_, O), N) && job(J) && J.what == O && J.at == (X, N + 1) { go(J); !rest(X, O) }\n\
      plan +!rest(X, clean) when at(P) && job(((C, R), feed, (_, D))) && D { -+at((P.row, P.col)); go(((C, R), feed, (D, not D))); !last }\n\
      plan +!last when at(P) && not at((1, 2)) { -+at(P); ?at(Q); go((Q, clean, (Q == P, Q != (2, 1)))) }\n\
      plan on seen(P) when at(P) { -+at((0, 0)); went(P, feed, 9) }\n  plan on seen(P) { went((P.row, 3), clean, 0) }\n}\n\
    suite s by agents A { tests 4 }\n";

fn cell(col: i64, row: i64) -> [Value; 2] {
    [Value::Int(col), Value::Int(row)]
}

#[test]
fn an_agent_matches_keeps_and_says_records() {
    let p = program(AGENT, &[]);
    let mut society = AgentSociety::new(&p, &[(AgentId(0), Vec::new())], 0);
    let mut done: Vec<(String, Vec<Value>)> = Vec::new();
    let step = |society: &mut AgentSociety<'_>, done: &mut Vec<(String, Vec<Value>)>, now: i64| loop {
        let mut out: Vec<(usize, AgentAction)> = Vec::new();
        society.run(now, &mut out);
        if out.is_empty() {
            break;
        }
        for (agent, action) in out {
            done.push((p.event(action.event).name.clone(), action.args.clone()));
            society.stimulus_done(agent, action.token, now);
        }
    };
    step(&mut society, &mut done, 0);
    let seen = p.event_named("seen").unwrap();
    society.perceive(0, seen, &cell(2, 1));
    step(&mut society, &mut done, SECOND);
    society.perceive(0, seen, &cell(2, 1));
    step(&mut society, &mut done, 2 * SECOND);
    let symbol = |name: &str| Value::Symbol(Symbol::intern(name));
    let job = |c: [Value; 2], what: &str, a: bool, b: bool| {
        ("go".to_owned(), vec![c[0], c[1], symbol(what), Value::Bool(a), Value::Bool(b)])
    };
    let went = |c: [Value; 2], what: &str, n: i64| {
        ("went".to_owned(), vec![c[0], c[1], symbol(what), Value::Int(n)])
    };
    let want = [
        job(cell(1, 2), "clean", true, false),
        job(cell(3, 0), "feed", true, false),
        job(cell(2, 1), "clean", true, false),
        went(cell(2, 1), "feed", 9),
        went(cell(1, 3), "clean", 0),
    ];
    assert_eq!(done, want);
}

/// Generated, written, read again: the same text.
#[test]
fn tests_with_records_are_written_and_read_to_the_same_bytes() {
    let more = "record Pose { x: length, y: length, heading: angle }\nrecord One { c: Cell }\nstimulus moved(to_: Pose) by person { hold 1 s }\n\
        stimulus odd(one: One[1], n: (0..3)[1], o: Order[2]) by person { sample f in 1 m .. 2 m hold 1 s }\nevent big(p: One, o: Order) from robot to person\n\
        suite r by random { stimuli odd, go\n await big((( 1, 2)), feed) | big(_, clean) | big\n length 6..9 tests 6 }\n\
        test small.h { moved((1.0 m, 2.0 m, 0.0 rad)) odd((Cell(1, 2)), 3, (feed, clean)) odd(One((1, 2)), (3), (clean, clean)) with f = 1.5 m\n\
          await big((1, 2), feed) | big(One((3, _)), Order.clean) within 3 s }\n";
    let text = format!("{AGENT}{more}");
    let p = program(&text, &[]);
    let mut tests = p.tests.clone();
    for suite in &p.suites {
        tests.extend(generate(&p, suite, None, 7).unwrap().tests);
    }
    assert!(tests.len() >= 6, "{}", tests.len());
    let written = write(&p, &tests[1..]);
    assert!(written.contains("odd("), "{written}");
    let again = program(&text, &[&written]);
    assert_eq!(write(&again, &again.tests[1..]), written);
    let steps = |p: &Program| p.tests.iter().map(|t| t.scripts.clone()).collect::<Vec<_>>();
    assert_eq!(steps(&again), tests.iter().map(|t| t.scripts.clone()).collect::<Vec<_>>());
    let by_hand = write(&p, &tests[..1]);
    for step in [
        "moved((1.0 m, 2.0 m, 0.0 rad))",
        "odd((((1, 2))), (3), (feed, clean))",
        "await big(((1, 2)), feed) | big(((3, _)), clean) within 3 s",
    ] {
        assert!(by_hand.contains(step), "{by_hand}");
    }
}
