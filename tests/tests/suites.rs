//! The suites by agents of the case studies against the published ones: the same bins with fewer tests.

use std::fs;

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{Program, suite::SuiteMethod};
use hrdsl_runtime::testgen::{GenerateOptions, generate_with};

fn program(example: &str) -> Program {
    let path = format!("{}/../examples/{example}/scenario.hri", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).unwrap();
    compile(InputFile { name: "scenario.hri", text: &text }, &[]).program.unwrap()
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
