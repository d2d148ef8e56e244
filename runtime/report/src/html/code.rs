//! Code coverage: the chart of accumulated lines, and the source with what executed each line.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_results::{CampaignResults, CodeFile, SuiteInfo};
use serde::Serialize;

use super::pieces::{ShownRatio, branches_of, lines_of};
use crate::{facts, text};

#[derive(Serialize)]
pub struct CodeSection {
    lines: ShownRatio,
    branches: ShownRatio,
    chart: Option<CoverageChart>,
    files: Vec<CoveredFile>,
}

#[derive(Serialize)]
struct CoveredFile {
    name: String,
    lines: ShownRatio,
    branches: ShownRatio,
    missed_lines: String,
    missed_branches: usize,
    /// The suites have a column each, if it is known which test executed what.
    is_per_suite: bool,
    rows: Vec<CodeLine>,
}

#[derive(Serialize)]
struct CodeLine {
    number: usize,
    /// `h` executed, `m` missed, `b` executed with a missed branch, or nothing to execute.
    class: &'static str,
    symbol: &'static str,
    /// Tests that executed it: all, and those of each suite.
    tests: Option<u32>,
    suites: Vec<u32>,
    text: String,
    note: String,
}

/// `None` if no code was measured.
pub fn code(results: &CampaignResults) -> Option<CodeSection> {
    let all = facts::code(results);
    if results.code.is_empty() {
        return None;
    }
    Some(CodeSection {
        lines: lines_of(all),
        branches: branches_of(all),
        chart: chart(&results.suites, &|suite| measured(results, suite)),
        files: results.code.iter().map(|f| file(results, f)).collect(),
    })
}

fn file(results: &CampaignResults, file: &CodeFile) -> CoveredFile {
    let is_executed = file.lines.iter().any(|(_, tests)| *tests > 0);
    let missed = file.lines.iter().filter(|(_, tests)| *tests == 0).map(|(line, _)| *line);
    CoveredFile {
        name: file.file.clone(),
        lines: lines_of(file.ratios),
        branches: branches_of(file.ratios),
        missed_lines: text::ranges(missed),
        missed_branches: file.missed_branches.len(),
        is_per_suite: is_executed && results.suites.len() > 1,
        rows: if file.source.is_empty() { Vec::new() } else { rows(file) },
    }
}

fn rows(file: &CodeFile) -> Vec<CodeLine> {
    let counts = file.lines.iter().zip(&file.suites);
    let counts: BTreeMap<u32, (u32, &Vec<u32>)> =
        counts.map(|((line, tests), suites)| (*line, (*tests, suites))).collect();
    let row = |(text, number): (&str, u32)| {
        let count = counts.get(&number).map(|(tests, _)| *tests);
        let missed = file.missed_branches.iter().filter(|(from, _)| *from == number).map(|(_, to)| *to);
        let missed: BTreeSet<i32> = missed.collect();
        let (class, symbol) = match count {
            None => ("", ""),
            Some(0) => ("m", "○"),
            Some(_) if !missed.is_empty() => ("b", "◐"),
            Some(_) => ("h", ""),
        };
        CodeLine {
            number: number as usize,
            class,
            symbol,
            tests: count,
            suites: counts.get(&number).map(|(_, suites)| suites.to_vec()).unwrap_or_default(),
            text: text.to_owned(),
            note: if class == "b" { note(&missed) } else { String::new() },
        }
    };
    file.source.lines().zip(1u32..).map(row).collect()
}

/// Where a line never went on to.
fn note(missed: &BTreeSet<i32>) -> String {
    let lines: Vec<String> = missed.iter().filter(|to| **to >= 0).map(|to| format!("line {to}")).collect();
    let mut ways = Vec::new();
    if !lines.is_empty() {
        ways.push(format!("never goes on to {}", text::enumeration(&lines)));
    }
    if missed.iter().any(|to| *to < 0) {
        ways.push("never ends here".to_owned());
    }
    ways.join("; ")
}

/// The accumulated percentage of lines after each test, with each test's own as a dot.
#[derive(Serialize)]
struct CoverageChart {
    width: u32,
    height: u32,
    left: String,
    right: String,
    bottom: String,
    title: String,
    grid: Vec<ChartTick>,
    ticks: Vec<ChartTick>,
    curves: Vec<ChartCurve>,
}

#[derive(Serialize)]
struct ChartTick {
    at: String,
    label: String,
}

#[derive(Serialize)]
struct ChartCurve {
    /// Which of the styles for suites.
    style: usize,
    name: String,
    last: String,
    line: String,
    dots: String,
    label_y: String,
    end_x: String,
    end_y: String,
}

const STYLES: usize = 6;
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 48.0;
const RIGHT: f64 = 800.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 286.0;
/// Labels at the ends of the curves are at least so far apart.
const LABEL: f64 = 17.0;

/// From the place in a suite and a percentage to the picture.
struct ChartScale {
    tests: f64,
    least: f64,
}

impl ChartScale {
    fn x(&self, test: usize) -> f64 {
        LEFT + (RIGHT - LEFT) * test as f64 / self.tests
    }

    fn y(&self, percent: f64) -> f64 {
        BOTTOM - (BOTTOM - TOP) * (percent - self.least) / (100.0 - self.least)
    }
}

/// For each test of a suite whether its code was measured: a program that dies at once may leave nothing to measure.
fn measured(results: &CampaignResults, suite: &SuiteInfo) -> Vec<bool> {
    results.tests.iter().filter(|t| t.suite == suite.name).map(|t| t.code.lines_total > 0).collect()
}

fn chart(suites: &[SuiteInfo], measured: &dyn Fn(&SuiteInfo) -> Vec<bool>) -> Option<CoverageChart> {
    let most = suites.iter().map(|s| s.code_accumulated.len()).max().filter(|most| *most > 0)?;
    let suites: Vec<(&SuiteInfo, Vec<bool>)> = suites.iter().map(|s| (s, measured(s))).collect();
    let alone =
        suites.iter().flat_map(|(s, m)| s.code_per_test.iter().zip(m).filter(|(_, m)| **m).map(|(v, _)| *v));
    let first = suites.iter().filter_map(|(s, _)| s.code_accumulated.first().copied());
    let least = alone.chain(first).filter(|v| v.is_finite()).fold(100.0, f64::min);
    let scale = ChartScale { tests: most as f64, least: ((least / 10.0).floor() * 10.0).clamp(0.0, 90.0) };
    let step = if scale.least >= 80.0 { 5 } else { 10 };
    let tick = |at: f64, label: String| ChartTick { at: coordinate(at), label };
    let drawn = suites.iter().enumerate().filter(|(_, (s, _))| !s.code_accumulated.is_empty());
    let mut curves: Vec<ChartCurve> = drawn.map(|(i, (s, measured))| curve(i, s, measured, &scale)).collect();
    place_labels(&mut curves);
    let says = |c: &ChartCurve| format!("{} ends at {} %", c.name, c.last);
    let says: Vec<String> = curves.iter().map(says).collect();
    Some(CoverageChart {
        width: WIDTH as u32,
        height: HEIGHT as u32,
        left: coordinate(LEFT),
        right: coordinate(RIGHT),
        bottom: coordinate(BOTTOM),
        title: format!("Accumulated line coverage after each test: {}", text::enumeration(&says)),
        grid: (scale.least as u32..=100)
            .step_by(step)
            .map(|p| tick(scale.y(f64::from(p)), p.to_string()))
            .collect(),
        ticks: tests_at(most).into_iter().map(|t| tick(scale.x(t), t.to_string())).collect(),
        curves,
    })
}

/// About eight round numbers of tests.
fn tests_at(most: usize) -> Vec<usize> {
    let step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].into_iter().find(|s| most / s <= 8).unwrap_or(most);
    (1..=most / step).map(|i| i * step).collect()
}

fn coordinate(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

fn curve(index: usize, suite: &SuiteInfo, measured: &[bool], scale: &ChartScale) -> ChartCurve {
    let style = index % STYLES;
    let mut line = String::new();
    let mut last_y = String::new();
    for (test, percent) in (1..).zip(&suite.code_accumulated) {
        let y = coordinate(scale.y(*percent));
        if line.is_empty() {
            line = format!("M{} {y}", coordinate(scale.x(test)));
        } else if y != last_y {
            line += &format!("H{}V{y}", coordinate(scale.x(test)));
        }
        last_y = y;
    }
    let end = scale.x(suite.code_accumulated.len());
    line += &format!("H{}", coordinate(end));
    let dot = |(test, percent): (usize, &f64)| {
        let at = format!("M{} {}", coordinate(scale.x(test)), coordinate(scale.y(*percent)));
        // Round and square line ends draw dots by themselves; the other shapes are drawn.
        at + ["h0", "h0", "m-2.5-2.5l5 5m0-5l-5 5", "m-3 2.5h6l-3-5z", "m-3 0h6m-3-3v6", "m0-3l3 3-3 3-3-3z"]
            [style]
    };
    let dots = (1..).zip(&suite.code_per_test).zip(measured).filter(|(_, m)| **m);
    let last = suite.code_accumulated.last().copied().unwrap_or(0.0);
    ChartCurve {
        style,
        name: suite.name.to_string(),
        last: format!("{last:.1}"),
        line,
        dots: dots.map(|(dot_at, _)| dot(dot_at)).collect(),
        label_y: coordinate(scale.y(last)),
        end_x: coordinate(end),
        end_y: last_y,
    }
}

/// Moves the labels at the curves' ends apart, from the lowest curve up and, where there is no room, down again.
fn place_labels(curves: &mut [ChartCurve]) {
    let mut order: Vec<(f64, usize)> =
        curves.iter().enumerate().map(|(i, c)| (c.label_y.parse().unwrap_or(BOTTOM), i)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
    for i in 1..order.len() {
        order[i].0 = order[i].0.min(order[i - 1].0 - LABEL);
    }
    let mut above = TOP;
    for (y, _) in order.iter_mut().rev() {
        *y = y.max(above);
        above = *y + LABEL;
    }
    for (y, curve) in order {
        curves[curve].label_y = coordinate(y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suite(name: &str, accumulated: &[f64]) -> SuiteInfo {
        let mut info = crate::fixture::campaign(1).suites[0].clone();
        info.name = name.into();
        info.code_accumulated = accumulated.to_vec();
        info.code_per_test = accumulated.to_vec();
        info
    }

    fn all(suite: &SuiteInfo) -> Vec<bool> {
        vec![true; suite.code_per_test.len()]
    }

    #[test]
    fn tests_without_a_measurement_have_no_dot() {
        let chart = chart(&[suite("a", &[50.0, 60.0, 100.0])], &|_| vec![true, false, true]).unwrap();
        assert_eq!(chart.curves[0].dots.matches('M').count(), 2);
    }

    #[test]
    fn curves_that_end_together_have_labels_apart() {
        let chart =
            chart(&[suite("a", &[50.0, 99.8]), suite("b", &[99.9]), suite("c", &[100.0])], &all).unwrap();
        let mut ys: Vec<f64> = chart.curves.iter().map(|c| c.label_y.parse().unwrap()).collect();
        assert!(ys.iter().all(|y| *y >= TOP && *y <= BOTTOM));
        ys.sort_by(f64::total_cmp);
        assert!(ys.windows(2).all(|w| w[1] - w[0] >= LABEL - 0.11));
    }

    #[test]
    fn the_picture_is_to_scale() {
        let chart = chart(&[suite("a", &[40.0, 100.0])], &all).unwrap();
        assert_eq!(
            chart.curves[0].line,
            format!("M{} {BOTTOM}H{RIGHT}V{TOP}H{RIGHT}", LEFT + (RIGHT - LEFT) / 2.0)
        );
        assert_eq!(chart.grid.len(), 7);
        assert!(super::chart(&[suite("a", &[])], &all).is_none());
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(tests_at(160), [20, 40, 60, 80, 100, 120, 140, 160]);
        assert_eq!(tests_at(3), [1, 2, 3]);
        assert_eq!(tests_at(50), [10, 20, 30, 40, 50]);
    }

    #[test]
    fn a_missed_branch_says_where_it_would_go() {
        assert_eq!(note(&BTreeSet::from([-3, 7, 9])), "never goes on to line 7 and line 9; never ends here");
    }
}
