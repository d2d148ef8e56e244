//! What was decided, for people and for programs.

use hrdsl_ir::Program;
use hrdsl_runtime::prove::{SearchStatistics, WitnessTrace};
use serde::Serialize;

use super::{
    clock::megabytes,
    table::{ProofRow, PropertyKind, PropertyVerdict},
};
use crate::fault::CommandFault;

/// A table for each network: name, verdict, what it says, what it took; below it the bounds, and the runs if wanted.
#[must_use]
pub fn human(rows: &[ProofRow], trace: bool) -> String {
    let wide = |f: &dyn Fn(&ProofRow) -> usize| rows.iter().map(f).max().unwrap_or(0);
    let (name, verdict) = (wide(&|r| r.name.chars().count()), wide(&|r| r.verdict.words().len()));
    let mut out = String::new();
    let mut network = None;
    for (n, row) in rows.iter().enumerate() {
        if network != Some(&row.network) {
            let gap = if network.is_some() { "\n" } else { "" };
            out += &format!("{gap}network {}\n", row.network);
            network = Some(&row.network);
        }
        let what = if row.title.is_empty() { &row.text } else { &row.title };
        out += &format!("  {:name$}  {:verdict$}  {what}\n", row.name, row.verdict.words());
        let margin = " ".repeat(name + verdict + 6);
        for bound in &row.bounds {
            out += &format!("{margin}{bound}\n");
        }
        let cost = (!row.joint).then(|| format!("({})", took(row)));
        let said: Vec<String> = row.remark.iter().cloned().chain(cost).collect();
        if !said.is_empty() {
            out += &format!("{margin}{}\n", said.join("  "));
        }
        if let Some(told) = row.trace.as_ref().filter(|_| trace) {
            for line in told.text().lines() {
                out += &format!("    {line}\n");
            }
        }
        let last = rows.get(n + 1).is_none_or(|next| next.network != row.network);
        let together: Vec<&ProofRow> = rows.iter().filter(|r| r.joint && r.network == row.network).collect();
        if let Some(first) = together.first().filter(|_| last) {
            out += &format!("  {} queries in one search  ({})\n", together.len(), took(first));
        }
    }
    out + &format!("\n{}\n", summary(rows))
}

/// `15 states, 12 discrete, 14 visited, 20 transitions, 0.1 MB, 0.02 s`
fn took(row: &ProofRow) -> String {
    let time = seconds(row.time.as_secs_f64());
    let Some(s) = row.statistics else { return time };
    let states = format!("{} {}", s.stored, if s.stored == 1 { "state" } else { "states" });
    let (discrete, visited, transitions) = (s.discrete_states, s.visited, s.transitions);
    let memory = megabytes(s.bytes);
    format!("{states}, {discrete} discrete, {visited} visited, {transitions} transitions, {memory}, {time}")
}

fn seconds(t: f64) -> String {
    if t < 10.0 { format!("{t:.2} s") } else { format!("{t:.0} s") }
}

/// `3 hold, 1 violated, 1 inconclusive`
fn summary(rows: &[ProofRow]) -> String {
    let count = |v: PropertyVerdict| rows.iter().filter(|r| r.verdict == v).count();
    let kinds = [
        (PropertyVerdict::Holds, "hold"),
        (PropertyVerdict::Violated, "violated"),
        (PropertyVerdict::Satisfied, "satisfied"),
        (PropertyVerdict::NotSatisfied, "not satisfied"),
        (PropertyVerdict::Answered, "answered"),
        (PropertyVerdict::NotOnTheModel, "not on the model"),
        (PropertyVerdict::Fault, "with a fault of the model"),
        (PropertyVerdict::Inconclusive, "inconclusive"),
    ];
    let parts = kinds.iter().map(|(v, words)| (count(*v), words)).filter(|(n, _)| *n > 0);
    parts.map(|(n, words)| format!("{n} {words}")).collect::<Vec<_>>().join(", ")
}

#[derive(Serialize)]
struct ProofDocument<'r> {
    format: &'static str,
    version: u32,
    scenario: &'r str,
    networks: Vec<NetworkRows<'r>>,
}

#[derive(Serialize)]
struct NetworkRows<'r> {
    network: &'r str,
    requirements: Vec<RowJson<'r>>,
    queries: Vec<RowJson<'r>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ranges: Vec<RowJson<'r>>,
    searches: Vec<SearchJson<'r>>,
}

/// What was decided in one go, with what it took.
#[derive(Serialize)]
struct SearchJson<'r> {
    #[serde(rename = "for")]
    names: Vec<&'r str>,
    #[serde(skip)]
    joint: bool,
    #[serde(flatten)]
    statistics: Option<SearchStatistics>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
}

#[derive(Serialize)]
struct RowJson<'r> {
    name: &'r str,
    title: &'r str,
    text: &'r str,
    verdict: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    remark: Option<&'r str>,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    bounds: &'r [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<&'r WitnessTrace>,
}

/// The same as one document; without times, unless they are asked for, so that it is the same each time.
///
/// # Errors
/// What cannot be printed.
pub fn json(program: &Program, rows: &[ProofRow], timings: bool) -> Result<String, CommandFault> {
    crate::files::json(&document(program, rows, timings))
}

/// That document on one line.
///
/// # Errors
/// The same.
pub fn line(program: &Program, rows: &[ProofRow], timings: bool) -> Result<String, CommandFault> {
    let text = serde_json::to_string(&document(program, rows, timings)).map_err(|e| e.to_string())?;
    Ok(text + "\n")
}

fn document<'r>(program: &'r Program, rows: &'r [ProofRow], timings: bool) -> ProofDocument<'r> {
    let mut networks: Vec<NetworkRows<'_>> = Vec::new();
    for row in rows {
        if networks.last().is_none_or(|n| n.network != row.network) {
            networks.push(NetworkRows {
                network: &row.network,
                requirements: vec![],
                queries: vec![],
                ranges: vec![],
                searches: vec![],
            });
        }
        let Some(last) = networks.last_mut() else { continue };
        match last.searches.iter_mut().find(|s| row.joint && s.joint) {
            Some(search) => search.names.push(&row.name),
            None => last.searches.push(search(row, timings)),
        }
        match row.kind {
            PropertyKind::Requirement => last.requirements.push(of(row)),
            PropertyKind::Query => last.queries.push(of(row)),
            PropertyKind::Range => last.ranges.push(of(row)),
        }
    }
    ProofDocument { format: "hrdsl-prove", version: 3, scenario: &program.name, networks }
}

fn search(row: &ProofRow, timings: bool) -> SearchJson<'_> {
    let seconds = timings.then_some(row.time.as_secs_f64());
    SearchJson { names: vec![&row.name], joint: row.joint, statistics: row.statistics, seconds }
}

fn of(row: &ProofRow) -> RowJson<'_> {
    RowJson {
        name: &row.name,
        title: &row.title,
        text: &row.text,
        verdict: row.verdict.key(),
        remark: row.remark.as_deref(),
        bounds: &row.bounds,
        run: row.trace.as_ref(),
    }
}
