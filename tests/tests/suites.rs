//! Suites: those of the case studies against the published ones (the same bins with fewer tests), and what suites may ask for and set.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, compile, compile_with};
use hrdsl_ir::{
    Program,
    suite::SuiteMethod,
    test::{Test, TestStep},
};
use hrdsl_runtime::testgen::{GenerateOptions, generate_with};

/// The modules of an example, but for that of its system: suites are made from the models alone.
struct ExampleModules(PathBuf);

impl ModuleLoader for ExampleModules {
    fn load(&self, _from: &str, path: &str) -> Result<ModuleText, String> {
        let text = if path == "robot.hri" {
            "// The system.\n".to_owned()
        } else {
            fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())?
        };
        Ok(ModuleText { name: path.to_owned(), text })
    }
}

fn program(example: &str) -> Program {
    program_with(example, "")
}

/// With more suites behind the example's.
fn program_with(example: &str, suites: &str) -> Program {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example);
    let text = fs::read_to_string(folder.join("scenario.hri")).unwrap() + suites;
    let modules = ExampleModules(folder);
    compile_with(InputFile { name: "scenario.hri", text: &text }, &[], &modules).program.unwrap()
}

/// How many tests a covering array of pairs gives, without more at random, and how many of them are needed for all bins
/// and plans that they reach.
fn pairwise(example: &str, bins: usize) -> (usize, usize) {
    let program = program(example);
    let suite = program.suites.iter().find(|s| matches!(s.method, SuiteMethod::Agents { .. })).unwrap();
    let options = GenerateOptions { count: Some(1), ..GenerateOptions::default() };
    let whole = generate_with(&program, suite, options).unwrap();
    let options = GenerateOptions { minimise: Some(true), count: Some(1000), ..options };
    let least = generate_with(&program, suite, options).unwrap();
    let mut predicted: Vec<&hrdsl_ir::coverage::BinName> =
        least.tests.iter().flat_map(|t| &t.provenance.predicts).collect();
    predicted.sort();
    predicted.dedup();
    assert_eq!(predicted.len(), bins, "{predicted:?}");
    (whole.abstract_tests, least.abstract_tests)
}

/// 131 abstract tests in the paper.
#[test]
fn the_handover_has_its_fourteen_bins() {
    let (pairs, least) = pairwise("handover", 14);
    assert!(pairs < 131 && least <= 14, "{pairs} {least}");
}

/// 62 abstract tests in the paper.
#[test]
fn home_care_has_its_six_bins() {
    let (pairs, least) = pairwise("homecare", 6);
    assert!(pairs < 62 && least <= 6, "{pairs} {least}");
}

/// Thirteen beliefs of three values, and one test for each set of them; so long as they are not cut, tests have all pairs.
fn thirteen(explore: &str) -> Program {
    let each = |f: &dyn Fn(usize) -> String, between: &str| (0..13).map(f).collect::<Vec<_>>().join(between);
    let text = format!(
        "scenario s
        actor person : environment
        actor robot  : system
        event shown(n: 0..2) from person to robot
        stimulus show(n: 0..2) by person {{ emit shown(n) }}
        agent A plays person {{
          {}
          goal !go
          plan +!go when {} {{ {} }}
        }}
        suite all by agents A {{ {}; explore {explore} }}",
        each(&|i| format!("belief b{i}(n: 0..2)"), "\n"),
        each(&|i| format!("b{i}(X{i})"), " && "),
        each(&|i| format!("show(X{i})"), "; "),
        each(&|i| format!("choose one b{i} of A"), "; "),
    );
    let compiled = compile(InputFile { name: "s.hri", text: &text }, &[]);
    compiled.program.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics))
}

#[test]
fn tests_that_are_too_few_for_all_pairs_are_warned_of() {
    let program = thirteen("pairwise");
    let made = |count, minimise| {
        let options = GenerateOptions { count: Some(count), minimise, ..GenerateOptions::default() };
        generate_with(&program, &program.suites[0], options).unwrap()
    };
    let few = made(14, None);
    let lost = few.lost_tuples.unwrap();
    assert_eq!((lost.strength, lost.all, lost.needed), (2, 13 * 12 / 2 * 9, 15));
    // What is lost is counted from the tests' own origins.
    let sets: Vec<Vec<i64>> = few
        .origins
        .iter()
        .map(|o| o.beliefs.facts.iter().filter_map(|(_, fact)| fact.args[0].as_int()).collect())
        .collect();
    let mut pairs = BTreeSet::new();
    for set in &sets {
        pairs.extend((0..13).flat_map(|f| (0..f).map(move |g| (f, g, set[f], set[g]))));
    }
    assert_eq!(lost.lost, lost.all - pairs.len());
    let warning = format!(
        "warning: {} of 702 pairs of alternatives are in none of the 14 tests; `tests 15` is enough for all",
        lost.lost
    );
    assert!(few.notes.contains(&warning), "{:?}", few.notes);
    for (count, minimise) in [(lost.needed as u32, None), (40, None), (3, Some(true))] {
        let enough = made(count, minimise);
        assert_eq!(enough.lost_tuples, None, "{count}");
        assert!(enough.notes.iter().all(|note| !note.contains("warning")), "{:?}", enough.notes);
    }
    assert_eq!(made(lost.needed as u32, None).abstract_tests, 15);
    let program = thirteen("random");
    let options = GenerateOptions { count: Some(3), ..GenerateOptions::default() };
    assert_eq!(generate_with(&program, &program.suites[0], options).unwrap().lost_tuples, None);
}

/// A counter up to 1000 is no variable of few values; the robot never says `never`.
#[test]
fn a_search_reaches_each_value_after_the_warm_up() {
    let text = "scenario s
        actor person : environment
        actor robot  : system
        enum Pace { slow, fast, never }
        event asked(pace: Pace) from person to robot
        stimulus ask(pace: Pace) by person { emit asked(pace) }
        var asks: 0..1000
        automaton Visitor plays person {
          var hurry: bool = false
          clock x
          init location idle
          location gone
          idle -> gone when x >= 1 s do ask(fast); hurry = true; asks += 1
        }
        automaton Robot plays robot {
          var heard: Pace = slow
          init location waiting
          waiting -> waiting on asked(how) do heard = how
        }
        network party = Visitor | Robot
        suite each by search of party { reach each value; tests 2; warmup 2500 ms }";
    let compiled = compile(InputFile { name: "s.hri", text }, &[]);
    let program = compiled.program.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics));
    let made = generate_with(&program, &program.suites[0], GenerateOptions::default()).unwrap();
    let fates: Vec<(String, String)> =
        made.goals.iter().map(|g| (g.goal.to_string(), format!("{:?}", g.status))).collect();
    let of = |status: &str| -> Vec<&str> {
        fates.iter().filter(|(_, s)| s == status).map(|(name, _)| name.as_str()).collect()
    };
    assert_eq!(
        of("Reached"),
        [
            "value Visitor.hurry = false",
            "value Visitor.hurry = true",
            "value Robot.heard = slow",
            "value Robot.heard = fast"
        ]
    );
    assert_eq!(of("Unreachable"), ["value Robot.heard = never"]);
    for test in &made.tests {
        let steps = &test.scripts[0].steps;
        assert_eq!(steps[0], TestStep::Wait { time: 2_500_000_000 }, "{steps:?}");
    }
}

/// What the tests show a robot of each leg: whether the person looks at it, reaches for it and holds it when they say that they are
/// ready.
fn outcomes(tests: &[Test]) -> BTreeSet<(usize, [bool; 3])> {
    let mut seen = BTreeSet::new();
    let program = program("handover");
    for test in tests {
        let (mut leg, mut done) = (0, [None; 3]);
        for step in test.scripts.iter().flat_map(|script| &script.steps) {
            let TestStep::Do { event, args, .. } = step else { continue };
            let ok = args.first().and_then(|arg| arg.as_bool());
            match program.event(*event).name.as_str() {
                "ask_leg" => (leg, done) = (leg + 1, [None; 3]),
                "look" => done = [ok, None, None],
                "reach" if done[0].is_some() => done[1] = ok,
                "grip" if done[1].is_some() => done[2] = ok,
                "say_ready" => {
                    if let [Some(looks), Some(reaches), Some(grips)] = done {
                        seen.insert((leg, [looks, reaches, grips]));
                    }
                }
                _ => {}
            }
        }
    }
    seen
}

/// The shortest witnesses choose that nobody looks, reaches and holds; four legs have 32 outcomes.
#[test]
fn a_search_shows_the_outcomes_that_it_is_asked_for() {
    let usual = "reach each bin of human_robot; reach each location; reach each edge; tests 200";
    let suites = format!(
        "\nsuite usual by search of table {{ {usual} }}
        suite several by search of table {{ {usual}; diverse 3 }}
        suite pairs by search of table {{
          {usual}; reach each pair of gaze_, pressure_, location_ when Robot.decide
        }}
        suite all by search of table {{
          {usual}; reach each combination of Robot.legs, gaze_, pressure_, location_ when Robot.decide
        }}"
    );
    let program = program_with("handover", &suites);
    let shown = |name: &str| {
        let suite = program.suites.iter().find(|s| s.name == name).unwrap();
        let made = generate_with(&program, suite, GenerateOptions::default()).unwrap();
        let outcomes = outcomes(&made.tests);
        let of_sensors: BTreeSet<[bool; 3]> = outcomes.iter().map(|o| o.1).collect();
        (outcomes.len(), of_sensors.len(), made.abstract_tests)
    };
    assert_eq!(shown("usual"), shown("ta_tests"));
    assert_eq!(shown("usual"), (6, 2, 17));
    assert_eq!(shown("all"), (32, 8, 42));
    let (few, pairs) = (shown("several"), shown("pairs"));
    assert!(few.0 > 6 && few.1 > 2 && few.2 <= 17 * 3, "{few:?}");
    assert!(pairs.1 >= 4 && pairs.2 < 42, "{pairs:?}");
}
