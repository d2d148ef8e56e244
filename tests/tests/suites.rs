//! Suites: those of the case studies against the published ones (the same bins with fewer tests), and what suites may ask for and set.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, compile, compile_with};
use hrdsl_ir::{Program, suite::SuiteMethod, test::TestStep};
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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example);
    let text = fs::read_to_string(folder.join("scenario.hri")).unwrap();
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
