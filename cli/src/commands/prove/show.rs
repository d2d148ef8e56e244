//! What was decided, for people and for programs.

use hrdsl_ir::Program;
use hrdsl_runtime::prove::WitnessTrace;
use serde::Serialize;

use super::table::{ProofRow, PropertyKind, PropertyVerdict};
use crate::fault::CommandFault;

/// A table for each network: name, verdict, what it says, what it took; below it the bounds, and the runs if wanted.
#[must_use]
pub fn human(rows: &[ProofRow], trace: bool) -> String {
    let wide = |f: &dyn Fn(&ProofRow) -> usize| rows.iter().map(f).max().unwrap_or(0);
    let (name, verdict) = (wide(&|r| r.name.chars().count()), wide(&|r| r.verdict.words().len()));
    let mut out = String::new();
    let mut network = None;
    for row in rows {
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
        let time = seconds(row.time.as_secs_f64());
        let took = row.states.map_or(time.clone(), |n| format!("{}, {time}", states(n)));
        match &row.remark {
            Some(remark) => out += &format!("{margin}{remark}  ({took})\n"),
            None => out += &format!("{margin}({took})\n"),
        }
        if let Some(told) = row.trace.as_ref().filter(|_| trace) {
            for line in told.text().lines() {
                out += &format!("    {line}\n");
            }
        }
    }
    out + &format!("\n{}\n", summary(rows))
}

fn states(n: usize) -> String {
    format!("{n} {}", if n == 1 { "state" } else { "states" })
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
    states: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<&'r WitnessTrace>,
}

/// The same as one document; without times, so that it is the same each time.
///
/// # Errors
/// What cannot be printed.
pub fn json(program: &Program, rows: &[ProofRow]) -> Result<String, CommandFault> {
    let mut networks: Vec<NetworkRows<'_>> = Vec::new();
    for row in rows {
        if networks.last().is_none_or(|n| n.network != row.network) {
            networks.push(NetworkRows { network: &row.network, requirements: vec![], queries: vec![] });
        }
        let Some(last) = networks.last_mut() else { continue };
        match row.kind {
            PropertyKind::Requirement => last.requirements.push(of(row)),
            PropertyKind::Query => last.queries.push(of(row)),
        }
    }
    let document = ProofDocument { format: "hrdsl-prove", version: 2, scenario: &program.name, networks };
    crate::files::json(&document)
}

fn of(row: &ProofRow) -> RowJson<'_> {
    RowJson {
        name: &row.name,
        title: &row.title,
        text: &row.text,
        verdict: row.verdict.key(),
        remark: row.remark.as_deref(),
        bounds: &row.bounds,
        states: row.states,
        run: row.trace.as_ref(),
    }
}
