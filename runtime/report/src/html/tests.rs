//! The page holds what is in the results, and nothing that anybody wrote in them is taken for HTML.

use super::*;
use hrdsl_results::{
    BinName, LogCounts, LogSummary, LoggedLevel, LoggedText, ShownReplays, ShownRun, UnreplayedTest,
};

use crate::fixture;

/// Whether every element that must be closed is, in the right order, and no attribute runs away.
fn unbalanced(page: &str) -> Option<String> {
    const VOID: [&str; 5] = ["meta", "link", "input", "br", "!doctype"];
    let mut open: Vec<String> = Vec::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        let Some(end) = rest.find('>') else { return Some("a tag without end".to_owned()) };
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if tag.contains('<') || !tag.matches('"').count().is_multiple_of(2) {
            return Some(format!("<{tag}>"));
        }
        let name = tag.split([' ', '/']).find(|n| !n.is_empty()).unwrap_or("").to_owned();
        if let Some(closed) = tag.strip_prefix('/') {
            if open.pop().as_deref() != Some(closed) {
                return Some(format!("</{closed}>"));
            }
        } else if name == "script" || name == "style" {
            let close = format!("</{name}>");
            let Some(at) = rest.find(&close) else { return Some(name) };
            rest = &rest[at + close.len()..];
        } else if !tag.ends_with('/') && !VOID.contains(&name.as_str()) {
            open.push(name);
        }
    }
    open.pop()
}

#[test]
fn the_check_of_tags_can_fail() {
    assert_eq!(unbalanced("<p><b>x</b></p>"), None);
    assert_eq!(unbalanced("<p><b>x</p></b>"), Some("</p>".to_owned()));
    assert_eq!(unbalanced("<p>"), Some("p".to_owned()));
    assert_eq!(unbalanced("<p a=\"<b>\">"), Some("<p a=\"<b>".to_owned()));
}

#[test]
fn the_page_is_well_formed_and_complete() {
    let results = fixture::campaign(12);
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    for text in [
        "<title>handover: test report</title>",
        "seed 1 · hrdsl 0.1.0",
        "never gripper_closing while distance(person.hand, robot.palm) &lt; 5 cm",
        "the deadline passed",
        "unreachable in the model",
        "none of the 48210 symbolic states of the model meets it",
        "What this campaign does not show",
        "the budget of states was used up",
        "could not &lt;grasp&gt; the leg &amp; gave up",
        "never goes on to line 20",
        "RuntimeError: no leg in the gripper",
        "pairwise: 131 belief sets of 20480 possible",
        "with offset = ",
        "witness of bin",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("<details data-s=").count(), 36);
    assert_eq!(page.matches("<article id=\"v").count(), 4);
    assert_eq!(page.matches("class=\"curve s").count(), 3);
}

#[test]
fn every_link_has_its_target_and_every_table_its_headings() {
    let page = html(&fixture::campaign(12));
    for link in page.split("href=\"#").skip(1) {
        let target = link.split('"').next().unwrap();
        assert_eq!(page.matches(&format!(" id=\"{target}\"")).count(), 1, "{target}");
    }
    assert!(!page.contains("<th>") && page.matches("<th ").count() == page.matches("<th scope=").count());
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let page = html(&fixture::campaign(4));
    for text in ["http:", "https:", "@import", "url(", " src=", "@font-face"] {
        assert!(!page.contains(text), "{text}");
    }
    assert_eq!(page, html(&fixture::campaign(4)));
}

#[test]
fn a_large_campaign_stays_small_enough() {
    let page = html(&fixture::campaign(160));
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
}

#[test]
fn hostile_text_stays_text() {
    let bad = "\"'><script>alert(1)</script><img src=x onerror=alert(1)>\u{1b}[31m{{ seed }}\u{202e}\u{0}";
    let mut results = fixture::campaign(2);
    results.scenario = bad.to_owned();
    results.requirements[0].title = bad.to_owned();
    results.requirements[0].name = bad.into();
    results.suites[0].name = bad.into();
    results.suites[0].notes = vec![bad.to_owned()];
    results.bins[0].bin = bad.to_owned();
    results.code[0].source = bad.to_owned();
    for test in &mut results.tests {
        test.name = bad.into();
        test.suite = bad.into();
        test.error = Some(format!("</pre></details>{bad}"));
        test.steps = vec![bad.to_owned()];
        test.because = vec![bad.to_owned(), bad.to_owned()];
        test.judgement.bins = vec![BinName::new(bad, bad)];
        for verdict in &mut test.judgement.verdicts {
            for step in verdict.failure.iter_mut().flat_map(|f| &mut f.counterexample) {
                step.text = bad.to_owned();
            }
        }
    }
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    assert_eq!(page.matches("<script").count(), 2);
    assert!(!page.contains("<img") && page.contains("&lt;img src=x") && page.contains("{{ seed }}"));
    assert!(!page.chars().any(|c| c == '\u{202e}' || (c.is_control() && c != '\n')));
}

#[test]
fn an_empty_campaign_has_a_page() {
    let mut results = fixture::campaign(1);
    results.tests.clear();
    results.bins.clear();
    results.code.clear();
    results.suites.clear();
    results.requirements.clear();
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    assert!(page.contains("No test violated a requirement.") && page.contains("No test matches."));
}

#[test]
fn many_requirements_are_named_instead_of_having_columns() {
    let mut results = fixture::campaign(3);
    for i in 0..20 {
        let mut requirement = results.requirements[5].clone();
        requirement.name = format!("X{i}").into();
        results.requirements.push(requirement);
    }
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    assert!(page.contains("style=\"--n:0\"") && page.contains("passed: "));
}

#[test]
fn model_coverage_is_a_section_with_reasons() {
    let mut results = fixture::campaign(3);
    assert!(!html(&results).contains("Model coverage"));
    let (coverage, mut explanation) = fixture::model();
    explanation.uncovered[1].reason = "<b>`asked` was 0</b>".into();
    (results.suites[0].model, results.suites[0].explanation) = (Some(coverage), Some(explanation));
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    for text in [
        "<h2>Model coverage</h2>",
        "<b class=\"p\">✓ 3</b> of 5 goals reached in 2 runs",
        "plans selected",
        ">2&#x2f;3</td>",
        "it was selected twice and failed twice",
        "edge Human.table#1 -&gt; leg#2 (step 1)",
        "&lt;b&gt;`asked` was 0&lt;",
        "2 of 5 goals of bdi_tests are reached by none of its tests in the model.",
    ] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn what_was_logged_stands_with_its_test() {
    let mut results = fixture::campaign(3);
    assert!(!html(&results).contains("Logged: "));
    let counts = LogCounts { info: 7, ..LogCounts::default() };
    results.tests[0].log = LogSummary { counts, first: Vec::new() };
    let counts = LogCounts { debug: 1, warn: 3, ..LogCounts::default() };
    let first = vec![LoggedText {
        time: 2.5,
        program: "brain".into(),
        node: "/arm".into(),
        level: LoggedLevel::Warn,
        text: "<b>low\nbattery".into(),
    }];
    results.tests[1].log = LogSummary { counts, first };
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    for text in [
        "<p class=\"note\">Logged: 7 info</p>",
        "<summary>Logged: 1 debug, 3 warn</summary><pre>2.50 s warn &#x2f;arm: &lt;b&gt;low battery\n",
        "and 2 more that warn",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let junit = crate::junit(&results);
    assert!(junit.contains("<property name=\"hrdsl.log\" value=\"1 debug, 3 warn\"/>"), "{junit}");
}

#[test]
fn machines_and_interfaces_are_sections() {
    let mut results = fixture::campaign(3);
    let plain = html(&results);
    assert!(!plain.contains("<h2>State machines</h2>") && !plain.contains("<h2>Interfaces</h2>"));
    (results.machines, results.warnings) = (fixture::machines(), fixture::warnings());
    results.machines[1].states[0].state = "<b>REACH</b>".into();
    results.tests[0].waits = vec![fixture::wait()];
    let page = html(&results);
    assert_eq!(unbalanced(&page), None);
    for text in [
        "<a href=\"#machines\">State machines</a>",
        "<span class=\"id\">SM_ROOT&#x2f;GIVE</span>",
        "2 of 3 states, 2 of 4 transitions <span class=\"note\">ends with stuck</span>",
        "<span class=\"id\">LOST</span> <small class=\"standing o\">never entered</small>",
        "<span class=\"id\">GIVE</span> <small class=\"standing o\">never taken</small></th><td class=\"id\">failed</td>",
        "&lt;b&gt;REACH",
        "<svg class=\"machine\" viewBox=",
        "<title>GIVE -given-&gt; WAIT</title>",
        "<title>GIVE -failed-&gt; LOST: never taken</title>",
        "<g class=\"node missed\"><title>LOST: never reached</title>",
        "1 of 3 states and 2 of 4 transitions of the state machine SM_ROOT were reached by no test.",
        "2 names of the middleware were used by one side only",
        "brain subscribes to &#x2f;scann, which nobody publishes",
        "Did you mean <code>&#x2f;scan</code>?",
        "<code>topic &quot;&#x2f;scann&quot;: sensor_msgs&#x2f;LaserScan in { … }</code>",
        "Topics that nobody subscribes to <small>1</small>",
        "brain waited from 1.50 s to the end for the service &#x2f;plan, which nobody serves",
    ] {
        assert!(page.contains(text), "{text}");
    }
    for link in page.split("href=\"#").skip(1) {
        let target = link.split('"').next().unwrap();
        assert_eq!(page.matches(&format!(" id=\"{target}\"")).count(), 1, "{target}");
    }
}

/// A first failure beside a passing test, and one alone.
fn shown(results: &CampaignResults) -> ShownReplays {
    let mut pairs = results.replay_pairs();
    pairs.truncate(2);
    pairs[1].beside = None;
    let names = [Some(&pairs[0].test), pairs[0].beside.as_ref(), Some(&pairs[1].test)];
    let runs = names.into_iter().flatten().map(|t| ShownRun { test: t.clone(), data: "AAAA".into() });
    ShownReplays { runs: runs.collect(), assets: "BBBB".into(), pairs, ..ShownReplays::default() }
}

#[test]
fn replays_are_opened_by_buttons_and_other_failures_have_their_command() {
    let results = fixture::campaign(12);
    let mut shown = shown(&results);
    let why = "<b>no room".to_owned();
    shown.left_out.push(UnreplayedTest { test: results.tests[3].name.clone(), why });
    let page = html_with(
        &results,
        PageSupplement { replays: Some(&PageReplays { shown: &shown, viewer: "CCCC" }), faults: None },
    );
    assert_eq!(unbalanced(&page), None);
    for place in 1..=2 {
        assert_eq!(page.matches(&format!(" id=\"replay-{place}\"")).count(), 1);
        assert!(page.matches(&format!("data-replay=\"{place}\"")).count() >= 2, "with the test, too");
    }
    let beside = facts::short(&results, shown.pairs[0].beside.as_ref().unwrap());
    for text in [
        format!("▶ Replay {} beside {beside}</button>", shown.pairs[0].requirement),
        format!("no test of the suite passes {}", shown.pairs[1].requirement),
        "id=\"replays-viewer\">CCCC<".to_owned(),
        "id=\"replays-assets\">BBBB<".to_owned(),
        "id=\"replays-run-2\">AAAA<".to_owned(),
        "&lt;b&gt;no room".to_owned(),
        "img-src data: blob:".to_owned(),
    ] {
        assert!(page.contains(&text), "{text}");
    }
    let commands = page.matches("Look: <code>hrdsl view ..&#x2f;scenario.hri --results . ").count();
    assert_eq!(commands + 2, page.matches("Again: <code>").count(), "a button, or the command");
    let plain = html(&results);
    assert!(!plain.contains("data-replay") && !plain.contains("blob:"));
}

#[test]
fn what_is_wrong_in_the_file_of_replays_does_not_get_into_the_page() {
    let mut results = fixture::campaign(3);
    let bad = "</script><script>alert(1)</script>\u{202e}";
    results.scenario = bad.to_owned();
    let mut shown = shown(&results);
    shown.runs[0].data = bad.to_owned();
    shown.runs[0].test = bad.into();
    shown.pairs[0].test = bad.into();
    shown.assets = bad.to_owned();
    let page = html_with(
        &results,
        PageSupplement { replays: Some(&PageReplays { shown: &shown, viewer: "CCCC" }), faults: None },
    );
    assert_eq!(unbalanced(&page), None);
    assert!(!page.contains("<script>alert") && !page.contains('\u{202e}'));
}
