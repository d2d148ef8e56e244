//! JUnit XML, for continuous integration: a suite of tests is a `testsuite`, a test a `testcase`.
//!
//! Times are simulated ones, and there is neither a time of writing nor a random identifier, so that equal results give
//! equal bytes. A test that broke off is an `error` even if it violated a requirement before.

use std::{fmt::Write as _, time::Duration};

use hrdsl_results::{CampaignResults, TestResult, VerdictResult};
use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

use crate::{
    facts::{self, ShownOutcome},
    model, text,
};

/// Steps of a counterexample that are printed; the last ones, since they violate.
const COUNTEREXAMPLE: usize = 20;

/// The results as JUnit XML.
#[must_use]
pub fn junit(results: &CampaignResults) -> String {
    let mut report = Report::new(text::line(&results.scenario));
    report.set_time(simulated(results.tests.iter()));
    for suite in suites(results) {
        report.add_test_suite(test_suite(results, suite));
    }
    // Writing into memory fails only if the text cannot be XML, which `clean` rules out.
    report.to_string().unwrap_or_else(|e| {
        let message = e.to_string().replace("--", "- -");
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites errors=\"1\"><!-- {message} --></testsuites>\n")
    })
}

/// The names of all suites: the declared ones, then others that tests belong to.
fn suites(results: &CampaignResults) -> Vec<&str> {
    let mut names: Vec<&str> = results.suites.iter().map(|s| s.name.as_str()).collect();
    for test in &results.tests {
        if !names.contains(&test.suite.as_str()) {
            names.push(&test.suite);
        }
    }
    names
}

fn simulated<'a>(tests: impl Iterator<Item = &'a TestResult>) -> Duration {
    let seconds: f64 = tests.map(|t| t.duration).sum();
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

fn test_suite(results: &CampaignResults, name: &str) -> TestSuite {
    let tests = || results.tests.iter().filter(|t| t.suite == name);
    let mut suite = TestSuite::new(text::line(name));
    suite.set_time(simulated(tests()));
    suite.add_property(Property::new("hrdsl.version", text::line(&results.hrdsl)));
    suite.add_property(Property::new("hrdsl.seed", results.seed.to_string()));
    if results.interrupted {
        let missing = results.planned.saturating_sub(results.tests.len());
        suite.add_property(Property::new(
            "hrdsl.interrupted",
            format!("{missing} of {} tests missing", results.planned),
        ));
    }
    for warning in facts::warnings(results) {
        suite.add_property(Property::new("hrdsl.warning", text::line(&warning.sentence())));
    }
    if let Some(info) = results.suites.iter().find(|s| s.name == name) {
        suite.add_property(Property::new("hrdsl.method", text::line(info.method.word())));
        if let Some(number) = info.abstract_tests {
            suite.add_property(Property::new("hrdsl.abstract_tests", number.to_string()));
        }
        if let Some(coverage) = &info.model {
            let goals = format!("{}/{}", coverage.goals_reached, coverage.goals);
            suite.add_property(Property::new("hrdsl.model_goals", goals));
            for agent in &coverage.agents {
                let tally = |k| format!("{} {}", model::short(k), model::ratio(model::of(agent, k)));
                let tallies: Vec<String> = model::kinds(coverage).into_iter().map(tally).collect();
                let name = format!("hrdsl.model.{}", text::line(&agent.agent));
                suite.add_property(Property::new(name, tallies.join(", ")));
            }
        }
        for machine in facts::machines_of(results, &info.name) {
            let name = format!("hrdsl.machine.{}", text::line(&machine.machine));
            suite.add_property(Property::new(name, facts::machine_in_short(&machine)));
        }
        if info.code.lines_total > 0 {
            suite.add_property(Property::new(
                "hrdsl.line_coverage",
                format!("{:.1}", info.code.line_percent()),
            ));
            suite.add_property(Property::new(
                "hrdsl.branch_coverage",
                format!("{:.1}", info.code.branch_percent()),
            ));
        }
    }
    suite.add_test_cases(tests().map(|t| test_case(results, t)));
    suite
}

fn test_case(results: &CampaignResults, test: &TestResult) -> TestCase {
    let mut case = TestCase::new(text::line(facts::short(results, &test.name)), status(results, test));
    case.set_classname(format!("{}.{}", text::line(&results.scenario), text::line(&test.suite)));
    case.set_time(simulated([test].into_iter()));
    case.set_assertions(test.judgement.verdicts.iter().filter(|v| v.triggered > 0).count());
    case.add_property(Property::new("hrdsl.seed", test.seed.to_string()));
    case.add_property(Property::new("hrdsl.ended", test.ended.word()));
    let verdict = |v: &VerdictResult| format!("{}: {}", text::line(&v.requirement), v.outcome.word());
    let verdicts: Vec<String> = test.judgement.verdicts.iter().map(verdict).collect();
    case.add_property(Property::new("hrdsl.verdicts", verdicts.join(", ")));
    for note in facts::notes(test) {
        case.add_property(Property::new("hrdsl.mark", text::line(&note)));
    }
    if !test.log.is_empty() {
        case.add_property(Property::new("hrdsl.log", test.log.in_short()));
    }
    if !test.output.stderr_end.is_empty() {
        case.set_system_err(text::clean(&test.output.stderr_end));
    }
    let bins: Vec<String> = test.judgement.bins.iter().map(|b| text::line(b.as_str())).collect();
    if !bins.is_empty() {
        case.add_property(Property::new("hrdsl.bins", bins.join(", ")));
    }
    case
}

fn status(results: &CampaignResults, test: &TestResult) -> TestCaseStatus {
    let violated: Vec<String> = results
        .requirements
        .iter()
        .filter(|r| facts::violates(test, &r.name))
        .map(|r| text::line(&r.name))
        .collect();
    let violations = violations(results, test);
    if let Some(error) = &test.error {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
        status.set_type("broken test");
        status.set_message(text::cut(&text::line(error), 200));
        let error = text::ends(&text::clean(error));
        status.set_description(format!("{error}\n{violations}{}{}", steps(test), again(results, test)));
        return status;
    }
    if violated.is_empty() {
        return TestCaseStatus::success();
    }
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_type("requirement violated");
    status.set_message(format!("{} violated", text::enumeration(&violated)));
    status.set_description(format!("{violations}{}{}", steps(test), again(results, test)));
    status
}

/// Every violated requirement with its time and counterexample.
fn violations(results: &CampaignResults, test: &TestResult) -> String {
    let mut out = String::new();
    for requirement in &results.requirements {
        if !facts::violates(test, &requirement.name) {
            continue;
        }
        let name = text::line(&requirement.name);
        let _ = writeln!(out, "{name} ({}): {}", facts::kind(requirement), text::line(&requirement.title));
        let _ = writeln!(out, "  {}", text::line(&requirement.text));
        let Some((verdict, failure)) = facts::failure(test, &requirement.name) else { continue };
        let how = format!("violated at {}. {}", text::moment(failure.time), facts::how(failure));
        let _ = writeln!(out, "  {}", how.trim_end());
        if let Some((value, unit)) = &verdict.worst_margin {
            let _ = writeln!(out, "  worst margin {}", text::margin(*value, unit));
        }
        let left_out = failure.counterexample.len().saturating_sub(COUNTEREXAMPLE);
        if left_out > 0 {
            let _ = writeln!(out, "  … {} before", text::count(left_out, "step"));
        }
        for step in &failure.counterexample[left_out..] {
            let _ = writeln!(out, "  {:>10}  {}", text::moment(step.time), text::line(&step.text));
        }
        if failure.deadline {
            let _ = writeln!(out, "  {:>10}  the deadline passed", text::moment(failure.time));
        }
        out.push('\n');
    }
    out
}

fn steps(test: &TestResult) -> String {
    if test.steps.is_empty() {
        return String::new();
    }
    let mut out = format!("test {} (seed {})\n", text::line(&test.name), test.seed);
    for step in &test.steps {
        let _ = writeln!(out, "  {}", text::line(step));
    }
    out
}

/// How to run it again.
fn again(results: &CampaignResults, test: &TestResult) -> String {
    let Some(command) = results.rerun_of(test) else { return String::new() };
    format!("to run it again, in the folder of the results:\n  {}\n", text::line(&command))
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};

    #[test]
    fn suites_tests_failures_and_errors_are_counted() {
        let results = fixture::campaign(12);
        let xml = junit(&results);
        let errors = results.tests.iter().filter(|t| t.error.is_some()).count();
        let failures = results.tests.iter().filter(|t| t.error.is_none() && t.has_failed()).count();
        assert!(errors > 0 && failures > 0);
        assert!(xml.contains(&format!(
            "<testsuites name=\"handover\" tests=\"36\" failures=\"{failures}\" errors=\"{errors}\" time="
        )));
        assert_eq!(xml.matches("<testsuite ").count(), 3);
        assert_eq!(xml.matches("<testcase ").count(), 36);
        assert_eq!(xml.matches("<failure ").count(), failures);
        assert_eq!(xml.matches("<error ").count(), errors);
    }

    #[test]
    fn the_page_is_as_agreed() {
        assert_eq!(junit(&fixture::campaign(7)), include_str!("golden/junit.xml"));
    }

    #[test]
    fn model_coverage_is_a_property_of_its_suite() {
        let mut results = fixture::campaign(2);
        let (coverage, explanation) = fixture::model();
        (results.suites[0].model, results.suites[0].explanation) = (Some(coverage), Some(explanation));
        let xml = junit(&results);
        assert!(xml.contains("name=\"hrdsl.model_goals\" value=\"3/5\""));
        assert!(xml.contains("name=\"hrdsl.model.Human\" value=\"plans 2/3, done 1/2, edges 1/2\""));
    }

    #[test]
    fn machines_and_warnings_are_properties_of_suites_and_waits_of_tests() {
        let mut results = fixture::campaign(2);
        (results.machines, results.warnings) = (fixture::machines(), fixture::warnings());
        results.tests[0].waits = vec![fixture::wait()];
        let xml = junit(&results);
        let has =
            |name: &str, value: &str| xml.matches(&format!("name=\"{name}\" value=\"{value}\"")).count();
        assert_eq!(has("hrdsl.machine.SM_ROOT", "2 of 3 states, 2 of 4 transitions"), 1);
        assert_eq!(has("hrdsl.machine.SM_ROOT", "1 of 3 states, 0 of 4 transitions"), 1);
        assert_eq!(has("hrdsl.warning", "brain subscribes to /scann, which nobody publishes"), 3);
        let wait = "brain waited from 1.50 s to the end for the service /plan, which nobody serves";
        assert_eq!(has("hrdsl.mark", wait), 1);
    }

    #[test]
    fn nothing_depends_on_the_clock() {
        let results = fixture::campaign(12);
        let xml = junit(&results);
        assert_eq!(xml, junit(&results));
        assert!(!xml.contains("timestamp") && !xml.contains("uuid"));
    }

    #[test]
    fn hostile_text_stays_text() {
        let mut results = fixture::campaign(2);
        results.tests[0].name = "handover.<script>alert('x')</script>]]>&\u{0}".into();
        results.tests[0].error = Some("\u{1b}[31mTraceback\u{1b}[0m\u{0}\u{ffff}\n<boom a=\"b\">]]>".into());
        results.requirements[0].title = "<!-- & --> \"quoted\"\u{8}".into();
        let xml = junit(&results);
        assert!(!xml.contains("<script>") && !xml.contains("<boom") && !xml.contains("<!--"));
        assert!(xml.contains("&lt;script&gt;") && xml.contains("Traceback\u{fffd}\n&lt;boom"));
        assert!(xml.chars().all(|c| c == '\n' || (c >= ' ' && !matches!(c, '\u{fffe}' | '\u{ffff}'))));
        // No more markup than the writer's own: every `<` opens one of its tags.
        let own = ["?xml", "testsuite", "testcase", "propert", "failure", "error", "/"];
        assert!(xml.split('<').skip(1).all(|tag| own.iter().any(|o| tag.starts_with(o))));
    }

    #[test]
    fn no_time_and_no_tests_are_fine() {
        let mut results = fixture::campaign(1);
        results.tests[0].duration = f64::NAN;
        results.tests[1].duration = -1.0;
        results.tests[2].suite = "elsewhere".into();
        assert!(junit(&results).contains("<testsuite name=\"elsewhere\""));
        results.tests.clear();
        assert!(junit(&results).contains("tests=\"0\""));
    }
}
