//! One HTML page: no network, no fonts, readable without scripts, on paper and in the dark.
//!
//! This module decides what is said; `html/page.html` only lays it out. Every string goes through [`text::clean`] and is
//! escaped as it is written, in one place ([`environment`]), so that nothing can be forgotten.

mod code;
mod drawing;
mod faults;
mod interfaces;
mod machines;
mod model;
mod pieces;
mod replays;
mod tests_list;
mod violations;

use hrdsl_results::{
    BinResult, CampaignResults, GoalReport, GoalStatus, MutationReport, RequirementResult, SuiteInfo,
    TestName, TriggerTotal, VerdictOutcome as Outcome, VerdictTally,
};
use minijinja::{AutoEscape, Environment, Output, State, Value, escape_formatter};
use serde::Serialize;

pub use replays::PageReplays;

use pieces::{ShownRatio, TestLink, branches_of, lines_of};

use crate::{
    facts::{self, BinStatus, ShownOutcome},
    text,
};

/// What a page shows besides the results of a campaign.
#[derive(Clone, Copy, Default)]
pub struct PageSupplement<'a> {
    /// Failures that can be replayed.
    pub replays: Option<&'a PageReplays<'a>>,
    /// Which faults in the code the tests would have noticed.
    pub faults: Option<&'a MutationReport>,
}

/// The results as one page.
#[must_use]
pub fn html(results: &CampaignResults) -> String {
    html_with(results, PageSupplement::default())
}

/// The results as one page, with what is known besides.
#[must_use]
pub fn html_with(results: &CampaignResults, besides: PageSupplement<'_>) -> String {
    let page = ReportPage::of(results, besides);
    let environment = match environment() {
        Ok(environment) => environment,
        Err(e) => return broken(&e),
    };
    let page = environment.get_template("page.html").and_then(|t| t.render(&page));
    page.unwrap_or_else(|e| broken(&e))
}

fn environment() -> Result<Environment<'static>, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.set_formatter(clean_and_escape);
    environment.add_template("page.html", include_str!("html/page.html"))?;
    environment.add_template("parts.html", include_str!("html/parts.html"))?;
    environment.add_global("style", Value::from_safe_string(include_str!("html/page.css").to_owned()));
    let machines = Value::from_safe_string(include_str!("html/machines.css").to_owned());
    environment.add_global("machine_style", machines);
    environment.add_global("script", Value::from_safe_string(include_str!("html/page.js").to_owned()));
    Ok(environment)
}

fn clean_and_escape(
    out: &mut Output<'_>,
    state: &State<'_, '_>,
    value: &Value,
) -> Result<(), minijinja::Error> {
    match value.as_str() {
        Some(text) if !value.is_safe() => escape_formatter(out, state, &Value::from(text::clean(text))),
        Some(_) | None => escape_formatter(out, state, value),
    }
}

/// The template is part of the program, so this page is only for its authors.
fn broken(error: &minijinja::Error) -> String {
    let message = text::clean(&format!("{error:#}")).replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<!doctype html><meta charset=\"utf-8\"><title>hrdsl</title><p>The report cannot be laid out: {message}</p>\n"
    )
}

/// What the page says.
#[derive(Serialize)]
struct ReportPage {
    scenario: String,
    version: String,
    seed: u64,
    conclusion: Vec<StyledText>,
    facts: Vec<HeadlineFigure>,
    gaps: Vec<String>,
    suites: Vec<SuiteSummary>,
    has_code: bool,
    columns: Vec<RequirementColumn>,
    requirements: Vec<RequirementRow>,
    violations: Vec<violations::ViolatedRequirement>,
    faults: Option<faults::FaultSection>,
    bins: Vec<BinGroup>,
    bins_hit: Vec<usize>,
    bins_total: usize,
    goals: Vec<SuiteGoals>,
    models: Vec<model::AgentSuiteSection>,
    machines: Vec<machines::MachineSection>,
    code: Option<code::CodeSection>,
    interfaces: Option<interfaces::InterfaceSection>,
    list: tests_list::TestList,
    replays: Option<replays::ReplaySection>,
}

/// A piece of a sentence with a style class.
#[derive(Serialize)]
struct StyledText {
    class: &'static str,
    text: String,
}

/// A number of the heading.
#[derive(Serialize)]
struct HeadlineFigure {
    class: &'static str,
    value: String,
    of: String,
    label: &'static str,
}

#[derive(Serialize)]
struct SuiteSummary {
    name: String,
    method: &'static str,
    abstract_tests: String,
    tests: u32,
    failing: usize,
    errors: u32,
    simulated: String,
    bins: usize,
    lines: ShownRatio,
    branches: ShownRatio,
    notes: Vec<String>,
}

/// A column of the requirement table.
#[derive(Serialize)]
struct RequirementColumn {
    class: char,
    short: &'static str,
    word: &'static str,
}

/// A row of the requirement table.
#[derive(Serialize)]
struct RequirementRow {
    class: char,
    symbol: &'static str,
    name: String,
    kind: &'static str,
    title: String,
    doc: String,
    text: String,
    standing: String,
    /// How many faults in the code it noticed; empty if that is not known.
    noticed: String,
    /// Its section among the violations, from 1.
    section: usize,
    /// For each suite the number for each column.
    tally: Vec<Vec<u32>>,
    /// How often it was triggered, in all tests.
    triggered: u64,
    margin: Option<WorstMargin>,
}

#[derive(Serialize)]
struct WorstMargin {
    value: String,
    is_negative: bool,
    test: TestLink,
}

#[derive(Serialize)]
struct BinGroup {
    cross: String,
    bins: Vec<BinRow>,
}

#[derive(Serialize)]
struct BinRow {
    class: &'static str,
    symbol: &'static str,
    state: &'static str,
    name: String,
    /// For each suite.
    cells: Vec<BinCell>,
    total: u32,
    first: Option<TestLink>,
    reason: String,
}

#[derive(Serialize)]
struct BinCell {
    hits: u32,
    /// `None`: the suite's model predicts nothing.
    predicted: Option<u32>,
    is_gap: bool,
}

/// The goals of a suite by search.
#[derive(Serialize)]
struct SuiteGoals {
    suite: String,
    reached: Vec<GoalRow>,
    unreachable: Vec<GoalRow>,
    inconclusive: Vec<GoalRow>,
    total: usize,
}

#[derive(Serialize)]
struct GoalRow {
    goal: String,
    reason: String,
}

impl ReportPage {
    fn of(results: &CampaignResults, PageSupplement { replays, faults }: PageSupplement<'_>) -> Self {
        let places = facts::places(results);
        let link = |name: &TestName| TestLink {
            name: facts::short(results, name).to_owned(),
            place: places.get(name).map(|place| place + 1),
        };
        let column = |o: Outcome| RequirementColumn { class: o.letter(), short: o.short(), word: o.word() };
        let suites = 0..results.suites.len();
        ReportPage {
            scenario: results.scenario.clone(),
            version: results.hrdsl.clone(),
            seed: results.seed,
            conclusion: conclusion(results),
            facts: heading(results),
            gaps: facts::gaps(results),
            suites: suites.clone().map(|i| suite(results, i)).collect(),
            has_code: facts::code(results).lines_total > 0,
            columns: Outcome::ALL.into_iter().map(column).collect(),
            requirements: rows(results, faults, &link),
            violations: violations::all(results, replays, &link),
            faults: faults.map(faults::section),
            bins: bin_groups(results, &link),
            bins_hit: suites.map(|i| facts::bins_hit(results, i)).collect(),
            bins_total: results.bins.len(),
            goals: results.suites.iter().filter(|s| !s.goals.is_empty()).map(goals).collect(),
            models: model::all(results),
            machines: machines::all(results, &link),
            code: code::code(results),
            interfaces: interfaces::section(results, &link),
            list: tests_list::list(results, replays),
            replays: replays::section(results, replays),
        }
    }
}

/// What an assessor asks first: which requirements are violated, which held, and about which nothing is known.
fn conclusion(results: &CampaignResults) -> Vec<StyledText> {
    let named = |outcome: Outcome| -> Vec<String> {
        let such = results.requirements.iter().filter(|r| facts::standing(r) == outcome);
        such.map(|r| r.name.to_string()).collect()
    };
    let mut parts = Vec::new();
    let mut say = |class: &'static str, text: String| parts.push(StyledText { class, text });
    if results.interrupted {
        let missing = results.planned.saturating_sub(results.tests.len());
        say(
            "e",
            format!("The campaign was interrupted: {missing} of {} tests are missing.", results.planned),
        );
    }
    let violated = named(Outcome::Fail);
    let held = named(Outcome::Pass);
    if violated.is_empty() {
        say("p", "No test violated a requirement.".to_owned());
    } else {
        let verb = if violated.len() == 1 { "was" } else { "were" };
        say("f", format!("{} {verb} violated.", text::enumeration(&violated)));
    }
    if !held.is_empty() {
        say("p", format!("{} held in every test that checked it.", text::enumeration(&held)));
    }
    for outcome in [Outcome::Inconclusive, Outcome::Error, Outcome::Vacuous] {
        let names = named(outcome);
        let what = match outcome {
            Outcome::Inconclusive => "was inconclusive in every test that triggered it",
            Outcome::Error => "was not decided, since tests broke off",
            Outcome::Vacuous => "was vacuous (never triggered) in every test",
            Outcome::Pass | Outcome::Fail => continue,
        };
        if !names.is_empty() {
            say("o", format!("{} {what}.", text::enumeration(&names)));
        }
    }
    parts
}

fn heading(results: &CampaignResults) -> Vec<HeadlineFigure> {
    let failing = results.tests.iter().filter(|t| t.has_failed()).count();
    let broken = results.tests.iter().filter(|t| t.error.is_some()).count();
    let violated = results.requirements.iter().filter(|r| facts::standing(r) == Outcome::Fail).count();
    let hit = results.bins.iter().filter(|b| b.hits.iter().any(|n| *n > 0)).count();
    let simulated: f64 = results.tests.iter().map(|t| t.duration).sum();
    let code = facts::code(results);
    let alarm = |number: usize, class: &'static str| if number > 0 { class } else { "" };
    let fact = |class, value: String, of: String, label| HeadlineFigure { class, value, of, label };
    let mut facts = vec![
        fact("", results.tests.len().to_string(), String::new(), "tests"),
        fact(alarm(failing, "f"), failing.to_string(), String::new(), "tests with violations"),
        fact(alarm(broken, "e"), broken.to_string(), String::new(), "tests in error"),
        fact(
            alarm(violated, "f"),
            violated.to_string(),
            format!("of {}", results.requirements.len()),
            "requirements violated",
        ),
    ];
    if !results.bins.is_empty() {
        facts.push(fact("", hit.to_string(), format!("of {}", results.bins.len()), "bins hit"));
    }
    if code.lines_total > 0 {
        facts.push(fact(
            "",
            format!("{:.1} %", code.line_percent()),
            String::new(),
            "of the code’s lines executed",
        ));
    }
    facts.push(fact("", text::stretch(simulated), String::new(), "simulated"));
    facts
}

fn suite(results: &CampaignResults, index: usize) -> SuiteSummary {
    let info: &SuiteInfo = &results.suites[index];
    let tests = || results.tests.iter().filter(|t| t.suite == info.name);
    SuiteSummary {
        name: info.name.to_string(),
        method: info.method.word(),
        abstract_tests: info.abstract_tests.map(|n| n.to_string()).unwrap_or_else(|| "–".to_owned()),
        tests: info.tests,
        failing: tests().filter(|t| t.has_failed()).count(),
        errors: info.errors,
        simulated: text::stretch(tests().map(|t| t.duration).sum()),
        bins: facts::bins_hit(results, index),
        lines: lines_of(info.code),
        branches: branches_of(info.code),
        notes: info.notes.clone(),
    }
}

fn rows(
    results: &CampaignResults,
    faults: Option<&MutationReport>,
    link: &dyn Fn(&TestName) -> TestLink,
) -> Vec<RequirementRow> {
    let mut section = 0;
    let row = |requirement: &RequirementResult| {
        let standing = facts::standing(requirement);
        let is_violated = standing == Outcome::Fail;
        section += usize::from(is_violated);
        let total = facts::total(requirement);
        let tally = (0..results.suites.len()).map(|s| {
            let tally = requirement.tally.get(s).copied().unwrap_or_default();
            Outcome::ALL.iter().map(|o| tally.of(*o)).collect()
        });
        RequirementRow {
            class: standing.letter(),
            symbol: standing.symbol(),
            name: requirement.name.to_string(),
            kind: facts::kind(requirement),
            title: requirement.title.clone(),
            doc: requirement.doc.clone(),
            text: requirement.text.clone(),
            standing: in_words(standing, &total),
            noticed: faults.map_or_else(String::new, |found| faults::noticed_by(&requirement.name, found)),
            section: if is_violated { section } else { 0 },
            tally: tally.collect(),
            triggered: TriggerTotal::of(&requirement.name, &results.tests).times,
            margin: requirement.worst_margin.as_ref().map(|m| WorstMargin {
                value: text::margin(m.value, &m.unit),
                is_negative: m.value < 0.0,
                test: link(&m.test),
            }),
        }
    };
    results.requirements.iter().map(row).collect()
}

fn in_words(standing: Outcome, total: &VerdictTally) -> String {
    let checked = match standing {
        Outcome::Fail => {
            format!("violated in {} of {} tests that checked it", total.fail, total.pass + total.fail)
        }
        Outcome::Pass => format!("held in all {} tests that checked it", total.pass),
        Outcome::Vacuous | Outcome::Inconclusive | Outcome::Error => return standing.word().to_owned(),
    };
    if total.inconclusive > 0 {
        format!("{checked}, inconclusive in {}", total.inconclusive)
    } else {
        checked
    }
}

/// The bins by the cross product that they belong to, in order.
fn bin_groups(results: &CampaignResults, link: &dyn Fn(&TestName) -> TestLink) -> Vec<BinGroup> {
    let mut groups: Vec<BinGroup> = Vec::new();
    for bin in &results.bins {
        let row = bin_row(results, bin, link);
        match groups.iter_mut().find(|g| g.cross == bin.cross) {
            Some(group) => group.bins.push(row),
            None => groups.push(BinGroup { cross: bin.cross.clone(), bins: vec![row] }),
        }
    }
    groups
}

fn bin_row(results: &CampaignResults, bin: &BinResult, link: &dyn Fn(&TestName) -> TestLink) -> BinRow {
    let state = BinStatus::of(bin);
    let (class, words) = match state {
        BinStatus::Hit => ("p", "hit"),
        BinStatus::Missed => ("o", "not hit"),
        BinStatus::Unreachable => ("n", "unreachable in the model"),
        BinStatus::Refuted => ("f", "hit, although unreachable in the model"),
    };
    let cell = |s: usize| {
        let hits = bin.hits.get(s).copied().unwrap_or(0);
        let predicted = bin.predicted.get(s).copied().unwrap_or(0);
        BinCell {
            hits,
            predicted: facts::predicts(results, s).then_some(predicted),
            is_gap: hits == 0 && state != BinStatus::Unreachable,
        }
    };
    BinRow {
        class,
        symbol: state.symbol(),
        state: words,
        name: bin.bin.clone(),
        cells: (0..results.suites.len()).map(cell).collect(),
        total: bin.hits.iter().sum(),
        first: bin.first.as_ref().map(link),
        reason: bin.unreachable.clone().unwrap_or_default(),
    }
}

fn goals(suite: &SuiteInfo) -> SuiteGoals {
    let with = |status: GoalStatus| -> Vec<GoalRow> {
        let goal = |g: &GoalReport| GoalRow { goal: g.goal.to_string(), reason: g.reason.clone() };
        suite.goals.iter().filter(|g| g.status == status).map(goal).collect()
    };
    SuiteGoals {
        suite: suite.name.to_string(),
        reached: with(GoalStatus::Reached),
        unreachable: with(GoalStatus::Unreachable),
        inconclusive: with(GoalStatus::Inconclusive),
        total: suite.goals.len(),
    }
}

#[cfg(test)]
mod tests;
