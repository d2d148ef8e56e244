//! The report for people.

use std::fmt::Write as _;

use hrdsl_runtime::results::{MutantFate, MutantReport, MutationReport, TestMethod};

/// The report as text: the same for the same campaign.
pub fn text(report: &MutationReport) -> String {
    let mut text = head(report);
    counts(report, &mut text);
    oracles(report, &mut text);
    methods(report, &mut text);
    survivors(report, &mut text);
    let (same, unreached) = if report.about.models {
        (
            "not distinguished: after every observation they allow the same",
            "not reached: no run can be where they are",
        )
    } else {
        (
            "not distinguished: all tests that reach them record the same, which proves nothing",
            "not reached: no test executes them",
        )
    };
    let more = "permissive: they allow more, and less nowhere, so that no run of the model contradicts them";
    let titles = [
        (MutantFate::NotDistinguished, same),
        (MutantFate::Permissive, more),
        (MutantFate::NotReached, unreached),
    ];
    for (fate, title) in titles {
        let all: Vec<&MutantReport> = report.mutants.iter().filter(|m| m.fate == fate).collect();
        if !all.is_empty() {
            let _ = writeln!(text, "\n{title}");
        }
        for mutant in all {
            let _ = writeln!(text, "  {}", line(mutant));
        }
    }
    text
}

fn head(report: &MutationReport) -> String {
    let drawn = report
        .drawn
        .map_or_else(String::new, |drawn| format!(", {drawn} of them drawn by seed {}", report.about.seed));
    let ran: usize = report.mutants.iter().map(|mutant| mutant.ran).sum();
    let how = if report.about.matrix {
        "all tests that reach a mutant"
    } else {
        "each mutant until its first kill"
    };
    let (of, ran) = if report.about.models {
        ("mutants of its models", format!("{ran} recordings judged"))
    } else {
        ("mutants", format!("{ran} runs"))
    };
    let mut text = format!(
        "{}, system {}: {} tests; {} {of} are worth a run{drawn}; {ran}, {how}\n",
        report.about.scenario, report.about.system, report.about.tests, report.worth
    );
    for sentinel in &report.sentinels {
        let by = sentinel.noticed.first().map(|noticed| noticed.test.as_str());
        let by = by.map_or_else(|| "nothing".to_owned(), |test| format!("{test}, as it must"));
        let _ = writeln!(text, "the sentinel of {} is noticed by {by}", sentinel.file);
    }
    if report.interrupted {
        text.push_str("interrupted: what was known is here\n");
    }
    text
}

fn counts(report: &MutationReport, text: &mut String) {
    let counts = &report.counts;
    let rows = [
        ("killed", counts.killed),
        ("survived", counts.survived),
        ("not reached", counts.not_reached),
        ("not distinguished", counts.not_distinguished),
        ("permissive", counts.permissive),
        ("equivalent", counts.equivalent),
        ("duplicate", counts.duplicate),
        ("invalid", counts.invalid),
        ("not run", counts.not_run),
    ];
    text.push('\n');
    for (what, count) in rows.into_iter().filter(|(_, count)| *count > 0) {
        let _ = writeln!(text, "  {what:<18}{count:>6}");
    }
    if let Some(score) = report.score {
        let of = counts.killed + counts.survived + counts.not_reached;
        let _ = writeln!(
            text,
            "  score{:>17.1} % of {of}: killed, of those killed, survived or not reached",
            score * 100.0
        );
    }
}

/// Which methods have a column.
fn columns(report: &MutationReport) -> Vec<TestMethod> {
    let has = |method: &TestMethod| report.methods.iter().any(|score| score.method == *method);
    TestMethod::ALL.into_iter().filter(has).collect()
}

fn oracles(report: &MutationReport, text: &mut String) {
    if report.oracles.is_empty() {
        return;
    }
    let columns = columns(report);
    let first = if report.about.matrix { "" } else { ", in the first test that noticed" };
    let _ = writeln!(text, "\nkilled by oracle{first}");
    let _ = write!(text, "  {:<24}", "");
    for method in &columns {
        let _ = write!(text, "{:>8}", method.word());
    }
    let _ = writeln!(text, "{:>8}{:>8}", "all", "alone");
    for score in &report.oracles {
        let _ = write!(text, "  {:<24}", score.oracle.to_string());
        for method in &columns {
            let _ = write!(text, "{:>8}", score.methods.get(method).copied().unwrap_or(0));
        }
        let _ = writeln!(text, "{:>8}{:>8}", score.killed, score.alone);
    }
}

fn methods(report: &MutationReport, text: &mut String) {
    if report.methods.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<26}{:>8}{:>18}{:>26}",
        "killed by method", "killed", "simulated hours", "killed per simulated hour"
    );
    for score in &report.methods {
        let rate = score.killed_per_hour.map_or_else(|| "–".to_owned(), |rate| format!("{rate:.1}"));
        let _ = writeln!(
            text,
            "  {:<24}{:>8}{:>18.3}{rate:>26}",
            score.method.word(),
            score.killed,
            score.simulated_hours
        );
    }
}

fn survivors(report: &MutationReport, text: &mut String) {
    let all: Vec<&MutantReport> =
        report.mutants.iter().filter(|mutant| mutant.fate == MutantFate::Survived).collect();
    if all.is_empty() {
        return;
    }
    let is_of_model = report.about.models;
    let how = if is_of_model {
        "they allow less somewhere, and no run shows that"
    } else {
        "recorded differently, and no oracle minds"
    };
    let _ = writeln!(text, "\nsurvived: {how}");
    for mutant in all {
        let _ = writeln!(text, "  {}", line(mutant));
        if is_of_model {
            continue;
        }
        match &mutant.difference {
            Some(difference) => {
                let _ = writeln!(
                    text,
                    "      first differs in {} at {:.3} s: {}; the original: {}",
                    difference.test.as_str(),
                    difference.time,
                    difference.mutant,
                    difference.original
                );
            }
            None => text.push_str("      differs in how its runs end only\n"),
        }
        if mutant.proposals.is_empty() {
            text.push_str("      no requirement that was tried would notice\n");
        }
        for proposal in &mutant.proposals {
            let (test, time) = (proposal.test.as_str(), proposal.time);
            let _ = writeln!(text, "      would notice in {test} at {time:.3} s: {}", proposal.pattern);
        }
    }
}

fn line(mutant: &MutantReport) -> String {
    let MutantReport { file, line, number, operator, what, .. } = mutant;
    format!("{file}:{line}  {number}  {operator}: {what}")
}
