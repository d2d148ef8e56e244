//! The summary for a terminal: requirements, first violations, bins, code and errors, in aligned columns.

mod agreement;
mod page;
mod system;
mod triggers;

use hrdsl_results::{
    BinResult, CampaignResults, CoverItemKind, CoverageRatios, RequirementResult, RunMark, SuiteInfo,
    TestResult, VerdictOutcome as Outcome,
};

use crate::{
    facts::{self, BinStatus, ShownOutcome},
    model, text,
};
use agreement::{conformance, predictions};
use page::{LABEL, StyledSpan, TerminalPage, TerminalStyle, left, right};
use system::{interfaces, machines};
pub use triggers::trigger_totals;

/// Bins and errors that are listed, at most.
const BINS: usize = 16;
const ERRORS: usize = 3;
/// Goals of a model that are listed for a suite, at most.
const GOALS: usize = 5;

/// The results on at most `width` columns, with ANSI colours if `color`.
#[must_use]
pub fn summary(results: &CampaignResults, width: usize, color: bool) -> String {
    let mut page = TerminalPage::new(width, color);
    header(&mut page, results);
    requirements(&mut page, results);
    violations(&mut page, results);
    bins(&mut page, results);
    predictions(&mut page, results);
    conformance(&mut page, results);
    models(&mut page, results);
    machines(&mut page, results);
    code(&mut page, results);
    errors(&mut page, results);
    marks(&mut page, results);
    interfaces(&mut page, results);
    page.out
}

/// The verdicts and bins of recordings, as [`summary`] shows those of a campaign.
#[must_use]
pub fn summary_of_recordings(results: &CampaignResults, width: usize, color: bool) -> String {
    let mut page = TerminalPage::new(width, color);
    let scenario = text::line(&results.scenario);
    page.line(&[
        StyledSpan(scenario, TerminalStyle::Bold),
        StyledSpan("   judged from recordings".into(), TerminalStyle::Dim),
    ]);
    totals(&mut page, results, "recording");
    requirements(&mut page, results);
    violations(&mut page, results);
    bins(&mut page, results);
    conformance(&mut page, results);
    machines(&mut page, results);
    errors(&mut page, results);
    page.out
}

fn header(page: &mut TerminalPage, results: &CampaignResults) {
    let scenario = text::line(&results.scenario);
    let about = format!("   seed {}   hrdsl {}", results.seed, text::line(&results.hrdsl));
    page.line(&[StyledSpan(scenario, TerminalStyle::Bold), StyledSpan(about, TerminalStyle::Dim)]);
    totals(page, results, "test");
    if results.interrupted {
        let missing = results.planned.saturating_sub(results.tests.len());
        let what =
            format!("interrupted: {missing} of {} had not ended", text::count(results.planned, "test"));
        page.line(&[StyledSpan(what, TerminalStyle::Warn)]);
    }
}

fn totals(page: &mut TerminalPage, results: &CampaignResults, what: &str) {
    let failing = results.tests.iter().filter(|t| t.has_failed()).count();
    let broken = results.tests.iter().filter(|t| t.error.is_some()).count();
    let simulated: f64 = results.tests.iter().map(|t| t.duration).sum();
    page.line(&[
        StyledSpan(text::count(results.tests.len(), what), TerminalStyle::Plain),
        StyledSpan(", ".into(), TerminalStyle::Plain),
        StyledSpan(
            format!("{failing} with violations"),
            if failing > 0 { TerminalStyle::Bad } else { TerminalStyle::Good },
        ),
        StyledSpan(", ".into(), TerminalStyle::Plain),
        StyledSpan(
            text::count(broken, "error"),
            if broken > 0 { TerminalStyle::Warn } else { TerminalStyle::Good },
        ),
        StyledSpan(format!(", {} simulated", text::stretch(simulated)), TerminalStyle::Plain),
    ]);
}

/// The outcomes with a column: the first three always, the others if there are any.
fn columns(results: &CampaignResults) -> Vec<(Outcome, usize)> {
    let most =
        |o: Outcome| results.requirements.iter().flat_map(|r| &r.tally).map(|t| t.of(o)).max().unwrap_or(0);
    Outcome::ALL
        .into_iter()
        .map(|o| (o, most(o)))
        .filter(|(o, most)| matches!(o, Outcome::Pass | Outcome::Fail | Outcome::Vacuous) || *most > 0)
        .map(|(o, most)| (o, most.to_string().len().max(o.short().len()) + 1))
        .collect()
}

fn requirements(page: &mut TerminalPage, results: &CampaignResults) {
    if results.requirements.is_empty() {
        return;
    }
    let columns = columns(results);
    let numbers = columns.iter().map(|(_, w)| w).sum::<usize>();
    let widest = results.suites.iter().map(|s| text::line(&s.name).chars().count()).max().unwrap_or(0);
    // A name that is a little wider than its numbers moves them apart; one that is much wider is cut.
    let group = numbers.max(widest.min(numbers + 6)) + 2;
    let gap = group - numbers;
    let all: Vec<usize> = (0..results.suites.len()).collect();
    for suites in all.chunks(page.fit(group)) {
        let label = page.label(suites.len(), group);
        page.out.push('\n');
        let mut names = vec![left("Requirements", label, TerminalStyle::Bold)];
        let mut heads = vec![left("", label, TerminalStyle::Plain)];
        for suite in suites {
            let name = text::cut(&text::line(&results.suites[*suite].name), group - 1);
            names.push(right(&name, group, TerminalStyle::Bold));
            heads.push(StyledSpan(" ".repeat(gap), TerminalStyle::Plain));
            heads.extend(columns.iter().map(|(o, w)| right(o.short(), *w, TerminalStyle::Dim)));
        }
        page.line(&names);
        page.line(&heads);
        for requirement in &results.requirements {
            requirement_line(page, requirement, suites, (&columns, gap), label);
        }
    }
    legend(page, &columns);
}

/// What the heads of the columns stand for, on as few lines as fit.
fn legend(page: &mut TerminalPage, columns: &[(Outcome, usize)]) {
    let mut line = String::new();
    for (outcome, _) in columns {
        let mut part = format!("{} {}", outcome.short(), outcome.word());
        if !outcome.meaning().is_empty() {
            part += &format!(" ({})", outcome.meaning());
        }
        if line.is_empty() {
            line = format!("  {part}");
        } else if line.chars().count() + 3 + part.chars().count() > page.width {
            page.line(&[StyledSpan(line, TerminalStyle::Dim)]);
            line = format!("  {part}");
        } else {
            line += &format!(" · {part}");
        }
    }
    page.line(&[StyledSpan(line, TerminalStyle::Dim)]);
}

fn requirement_line(
    page: &mut TerminalPage,
    requirement: &RequirementResult,
    suites: &[usize],
    (columns, gap): (&[(Outcome, usize)], usize),
    label: usize,
) {
    let standing = facts::standing(requirement);
    let name = format!("{} {}", standing.symbol(), text::line(&requirement.name));
    let room = label.saturating_sub(name.chars().count());
    let title = format!(" {}", text::line(&requirement.title));
    let mut cells =
        vec![StyledSpan(name, TerminalStyle::of(standing)), left(&title, room, TerminalStyle::Plain)];
    for suite in suites {
        let tally = requirement.tally.get(*suite).copied().unwrap_or_default();
        cells.push(StyledSpan(" ".repeat(gap), TerminalStyle::Plain));
        for (outcome, width) in columns {
            let number = tally.of(*outcome);
            let marked = matches!(outcome, Outcome::Fail | Outcome::Inconclusive | Outcome::Error);
            let style = match number {
                0 => TerminalStyle::Dim,
                _ if marked => TerminalStyle::of(*outcome),
                _ => TerminalStyle::Plain,
            };
            cells.push(right(&if number == 0 { "·".to_owned() } else { number.to_string() }, *width, style));
        }
    }
    page.line(&cells);
}

fn violations(page: &mut TerminalPage, results: &CampaignResults) {
    let violated: Vec<(&RequirementResult, Vec<(usize, &TestResult)>)> = results
        .requirements
        .iter()
        .map(|r| (r, facts::failing(results, r)))
        .filter(|(_, tests)| !tests.is_empty())
        .collect();
    if violated.is_empty() {
        return;
    }
    page.out.push('\n');
    page.line(&[
        StyledSpan("Violations".into(), TerminalStyle::Bold),
        StyledSpan("  the first of each".into(), TerminalStyle::Dim),
    ]);
    let width = |texts: Vec<String>| texts.iter().map(|t| t.chars().count()).max().unwrap_or(0);
    let names = width(violated.iter().map(|(r, _)| text::line(&r.name)).collect());
    let test_of = |tests: &[(usize, &TestResult)]| text::line(facts::short(results, &tests[0].1.name));
    let tests_width = width(violated.iter().map(|(_, t)| test_of(t)).collect()).min(page.width / 3);
    for (requirement, tests) in &violated {
        let name = format!("✗ {:<names$}  ", text::line(&requirement.name));
        let failure = facts::failure(tests[0].1, &requirement.name);
        let time = failure.map(|(_, f)| text::moment(f.time)).unwrap_or_default();
        let what = failure.map(|(v, f)| facts::in_short(v, f)).unwrap_or_default();
        let others = match tests.len() - 1 {
            0 => String::new(),
            more => format!("  +{more}"),
        };
        let used = name.chars().count() + 9 + 2 + tests_width + 2 + others.chars().count();
        page.line(&[
            StyledSpan(name, TerminalStyle::Bad),
            right(&time, 9, TerminalStyle::Plain),
            StyledSpan("  ".into(), TerminalStyle::Plain),
            left(&test_of(tests), tests_width, TerminalStyle::Plain),
            StyledSpan("  ".into(), TerminalStyle::Plain),
            left(&what, page.width.saturating_sub(used), TerminalStyle::Plain),
            StyledSpan(others, TerminalStyle::Dim),
        ]);
        page.command(results, tests[0].1);
    }
}

fn bins(page: &mut TerminalPage, results: &CampaignResults) {
    if results.bins.is_empty() {
        return;
    }
    let widest = results.suites.iter().map(|s| text::line(&s.name).chars().count()).max().unwrap_or(0);
    let column = widest.clamp(8, 14) + 2;
    let crosses: Vec<&str> = results.bins.iter().map(|b| b.cross.as_str()).collect();
    let is_one = crosses.windows(2).all(|w| w[0] == w[1]);
    let shown: Vec<&BinResult> = if results.bins.len() <= BINS {
        results.bins.iter().collect()
    } else {
        results.bins.iter().filter(|b| BinStatus::of(b) != BinStatus::Hit).take(BINS).collect()
    };
    let all: Vec<usize> = (0..results.suites.len()).collect();
    let is_predicted = all.iter().any(|suite| facts::predicts(results, *suite));
    let what = if is_predicted { "  tests that hit / were predicted to" } else { "  tests that hit" };
    for suites in all.chunks(page.fit(column)) {
        let label = page.label(suites.len(), column);
        page.out.push('\n');
        let mut names = vec![
            StyledSpan("Bins".into(), TerminalStyle::Bold),
            left(what, label.saturating_sub(4), TerminalStyle::Dim),
        ];
        let name = |i: &usize| right(&text::line(&results.suites[*i].name), column, TerminalStyle::Bold);
        names.extend(suites.iter().map(name));
        page.line(&names);
        for bin in &shown {
            bin_line(page, results, bin, suites, (label, column), is_one);
        }
        let mut totals = vec![left(&format!("  hit, of {}", results.bins.len()), label, TerminalStyle::Dim)];
        let total = |i: &usize| {
            let hit = facts::bins_hit(results, *i);
            right(&format!("{hit}{:w$}", "", w = prediction(results, *i)), column, TerminalStyle::Dim)
        };
        totals.extend(suites.iter().map(total));
        page.line(&totals);
    }
}

/// The width of a suite's predictions with their slash; 0 if it has none.
fn prediction(results: &CampaignResults, suite: usize) -> usize {
    let most = results.bins.iter().filter_map(|b| b.predicted.get(suite)).max().copied().unwrap_or(0);
    if most == 0 { 0 } else { most.to_string().len() + 1 }
}

fn bin_line(
    page: &mut TerminalPage,
    results: &CampaignResults,
    bin: &BinResult,
    suites: &[usize],
    (label, column): (usize, usize),
    is_one_cross: bool,
) {
    let state = BinStatus::of(bin);
    let (style, note) = match state {
        BinStatus::Hit => (TerminalStyle::Good, ""),
        BinStatus::Missed => (TerminalStyle::Warn, "  not hit"),
        BinStatus::Unreachable => (TerminalStyle::Dim, "  unreachable in the model"),
        BinStatus::Refuted => (TerminalStyle::Bad, "  hit, yet unreachable in the model"),
    };
    let name = text::line(if is_one_cross { &bin.bin } else { bin.name.as_str() });
    let name = text::cut(&name, label.saturating_sub(3 + note.chars().count()).max(12));
    let rest = label.saturating_sub(2 + name.chars().count());
    let mut cells = vec![
        StyledSpan(format!("{} ", state.symbol()), style),
        StyledSpan(name, TerminalStyle::Plain),
        left(note, rest, style),
    ];
    for suite in suites {
        let hits = bin.hits.get(*suite).copied().unwrap_or(0);
        let predicted = bin.predicted.get(*suite).copied().unwrap_or(0);
        let number = if hits == 0 && predicted == 0 { "·".to_owned() } else { hits.to_string() };
        let shown = if hits == 0 && predicted == 0 { String::new() } else { format!("/{predicted}") };
        let digits = prediction(results, *suite);
        let text = if digits == 0 { number } else { format!("{number}{shown:<digits$}") };
        let style = match (hits, predicted) {
            (0, 0) => TerminalStyle::Dim,
            (0, _) => TerminalStyle::Warn,
            _ => TerminalStyle::Plain,
        };
        cells.push(right(&text, column, style));
    }
    page.line(&cells);
}

/// What the agents' runs reached of their programs: a line for each agent, then the goals that were not reached.
fn models(page: &mut TerminalPage, results: &CampaignResults) {
    const COLUMN: usize = 9;
    for suite in &results.suites {
        let Some(coverage) = &suite.model else { continue };
        page.out.push('\n');
        let goals = format!("  {}/{} goals reached", coverage.goals_reached, coverage.goals);
        page.line(&[
            StyledSpan(format!("Model of {}", text::line(&suite.name)), TerminalStyle::Bold),
            StyledSpan(
                goals,
                if coverage.goals_reached < coverage.goals {
                    TerminalStyle::Warn
                } else {
                    TerminalStyle::Good
                },
            ),
        ]);
        let kinds = model::kinds(coverage);
        for kinds in kinds.chunks(page.fit(COLUMN)) {
            let label = page.label(kinds.len(), COLUMN).min(LABEL + 10);
            let mut heads = vec![left("", label, TerminalStyle::Plain)];
            heads.extend(kinds.iter().map(|k| right(model::short(*k), COLUMN, TerminalStyle::Dim)));
            page.line(&heads);
            for agent in &coverage.agents {
                let mut cells =
                    vec![left(&format!("  {}", text::line(&agent.agent)), label, TerminalStyle::Plain)];
                let cell = |kind: &CoverItemKind| {
                    let tally = model::of(agent, *kind);
                    let style =
                        if tally.reached < tally.all { TerminalStyle::Warn } else { TerminalStyle::Plain };
                    right(&model::ratio(tally), COLUMN, style)
                };
                cells.extend(kinds.iter().map(cell));
                page.line(&cells);
            }
        }
        uncovered(page, suite);
    }
}

fn uncovered(page: &mut TerminalPage, suite: &SuiteInfo) {
    let all = suite.explanation.as_ref().map(|e| e.uncovered.as_slice()).unwrap_or_default();
    for goal in all.iter().take(GOALS) {
        page.line(&[
            StyledSpan("○ ".into(), TerminalStyle::Warn),
            StyledSpan(text::line(&goal.goal.to_string()), TerminalStyle::Plain),
            StyledSpan(format!("  {}", text::line(&goal.reason)), TerminalStyle::Dim),
        ]);
    }
    if all.len() > GOALS {
        page.line(&[StyledSpan(format!("  and {} more", all.len() - GOALS), TerminalStyle::Dim)]);
    }
}

fn code(page: &mut TerminalPage, results: &CampaignResults) {
    let all = facts::code(results);
    if all.lines_total == 0 {
        return;
    }
    let mut entries: Vec<(String, CoverageRatios)> =
        results.suites.iter().map(|s| (text::line(&s.name), s.code)).collect();
    if entries.len() > 1 {
        entries.push(("all".to_owned(), all));
    }
    let column = ((page.width - 10) / entries.len().max(1)).clamp(17, 19);
    for entries in entries.chunks(((page.width - 10) / column).max(1)) {
        page.out.push('\n');
        let mut names = vec![left("Code", 10, TerminalStyle::Bold)];
        names.extend(entries.iter().map(|(name, _)| right(name, column, TerminalStyle::Bold)));
        page.line(&names);
        let ratio = |part: u32, whole: u32, percent: f64| {
            right(&format!("{part}/{whole}  {percent:>5.1} %"), column, TerminalStyle::Plain)
        };
        let mut lines = vec![left("  lines", 10, TerminalStyle::Plain)];
        lines.extend(entries.iter().map(|(_, c)| ratio(c.lines, c.lines_total, c.line_percent())));
        page.line(&lines);
        if all.branches_total > 0 {
            let mut branches = vec![left("  branches", 10, TerminalStyle::Plain)];
            branches
                .extend(entries.iter().map(|(_, c)| ratio(c.branches, c.branches_total, c.branch_percent())));
            page.line(&branches);
        }
    }
}

fn errors(page: &mut TerminalPage, results: &CampaignResults) {
    let broken: Vec<(&TestResult, &str)> =
        results.tests.iter().filter_map(|t| t.error.as_deref().map(|e| (t, e))).collect();
    if broken.is_empty() {
        return;
    }
    page.out.push('\n');
    page.line(&[
        StyledSpan("Errors".into(), TerminalStyle::Bold),
        StyledSpan("  tests that broke off".into(), TerminalStyle::Dim),
    ]);
    for (test, error) in broken.iter().take(ERRORS) {
        let name = text::line(facts::short(results, &test.name));
        let clean = text::clean(error);
        let first = clean.lines().find(|l| !l.trim().is_empty()).map(text::line).unwrap_or_default();
        page.line(&[
            StyledSpan("! ".into(), TerminalStyle::Warn),
            StyledSpan(format!("{}  ", text::cut(&name, page.width / 3)), TerminalStyle::Plain),
            StyledSpan(first, TerminalStyle::Plain),
        ]);
        if let Some(last) = text::clean(&test.output.stderr_end).lines().rfind(|l| !l.trim().is_empty()) {
            page.line(&[StyledSpan(
                format!("  its last line on stderr: {}", text::line(last)),
                TerminalStyle::Dim,
            )]);
        }
        page.command(results, test);
    }
    if broken.len() > ERRORS {
        page.line(&[StyledSpan(format!("  and {} more", broken.len() - ERRORS), TerminalStyle::Dim)]);
    }
}

/// What must be known about some runs to trust them.
fn marks(page: &mut TerminalPage, results: &CampaignResults) {
    for mark in [RunMark::DependsOnLoad, RunMark::OtherProcesses] {
        let marked: Vec<&TestResult> = results.tests.iter().filter(|t| t.marks.contains(&mark)).collect();
        if let Some(first) = marked.first() {
            page.out.push('\n');
            let name = text::line(facts::short(results, &first.name));
            let who = format!(
                "{} ({name}{})",
                text::count(marked.len(), "test"),
                if marked.len() > 1 { ", …" } else { "" }
            );
            page.line(&[StyledSpan("! ".into(), TerminalStyle::Warn), StyledSpan(who, TerminalStyle::Plain)]);
            page.line(&[StyledSpan(format!("  {}", mark.sentence()), TerminalStyle::Plain)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::fixture, *};

    #[test]
    fn the_page_is_as_agreed() {
        let results = fixture::campaign(12);
        assert_eq!(summary(&results, 100, false), include_str!("golden/summary-100.txt"));
        assert_eq!(summary(&results, 80, false), include_str!("golden/summary-80.txt"));
    }

    #[test]
    fn it_fits_the_screen() {
        for (count, widths) in [(12, [60, 80, 100]), (160, [72, 80, 120])] {
            let results = fixture::campaign(count);
            for width in widths {
                let text = summary(&results, width, false);
                let widest = text.lines().map(|l| l.chars().count()).max();
                assert!(widest <= Some(width), "{widest:?} > {width}\n{text}");
            }
            assert!(summary(&results, 100, false).lines().count() <= 71);
        }
    }

    #[test]
    fn colours_only_if_asked_and_only_colours() {
        let results = fixture::campaign(12);
        let plain = summary(&results, 100, false);
        let coloured = summary(&results, 100, true);
        assert!(!plain.contains('\u{1b}') && coloured.contains("\u{1b}[1;31m"));
        assert_eq!(text::clean(&coloured), plain);
    }

    #[test]
    fn hostile_text_cannot_steer_the_terminal() {
        let mut results = fixture::campaign(2);
        results.tests[0].error = Some("\u{1b}[2J\u{1b}]0;owned\u{7}died\u{8}\r\nmore".into());
        results.requirements[0].title = "a\u{1b}[31m\nb".into();
        let text = summary(&results, 100, false);
        assert!(!text.chars().any(|c| c.is_control() && c != '\n'));
        assert!(text.contains("  died\n"));
    }

    #[test]
    fn model_coverage_is_a_table_for_each_agent() {
        let mut results = fixture::campaign(2);
        let (coverage, explanation) = fixture::model();
        (results.suites[0].model, results.suites[0].explanation) = (Some(coverage), Some(explanation));
        let text = summary(&results, 80, false);
        let expected = "
Model of bdi_tests  3/5 goals reached
                                  plans     done    edges
  Human                             2/3      1/2      1/2
○ plan Human.leg#2  `+!leg` came twice: twice a plan before it was selected (`l…
○ bin human_robot.4 legs, bored  `asked` was 0, 1, needs 4
";
        assert!(text.contains(expected), "{text}");
    }

    #[test]
    fn what_was_not_reached_and_where_nobody_met_is_said() {
        let mut results = fixture::campaign(2);
        (results.machines, results.warnings) = (fixture::machines(), fixture::warnings());
        let text = summary(&results, 80, false);
        let machines = "
State machine SM_ROOT  2 of 3 states, 2 of 4 transitions
○ never entered  LOST
○ never taken  GIVE -failed-> LOST
○ never taken  LOST -given_up-> stuck
State machine SM_ROOT/GIVE  1 of 1 state, 1 of 1 transition
";
        assert!(text.contains(machines), "{text}");
        let interfaces = "
Interfaces  where nobody met in any test
! brain subscribes to /scann, which nobody publishes  12 tests
  did you mean /scan? If not, add to the binding: topic \"/scann\": sensor_msgs/LaserScan in { … }
! no program uses the service /gripper, which the binding serves  12 tests
";
        assert!(text.ends_with(interfaces), "{text}");
        assert!(!text.contains("/debug"), "a note is for the page");
        let recordings = summary_of_recordings(&results, 80, false);
        assert!(recordings.contains(machines) && !recordings.contains("Interfaces"), "{recordings}");
    }

    #[test]
    fn nothing_to_say() {
        let mut results = fixture::campaign(1);
        results.tests.clear();
        results.bins.clear();
        results.code.clear();
        results.suites.clear();
        results.requirements.clear();
        assert_eq!(
            summary(&results, 80, false),
            "handover   seed 1   hrdsl 0.1.0\n0 tests, 0 with violations, 0 errors, 0.0 s simulated\n"
        );
    }
}
