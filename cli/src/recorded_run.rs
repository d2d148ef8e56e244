//! Recorded runs of networks: as `prove --json` and `step` print them, or as UPPAAL's symbolic traces (`.xtr`).

use std::path::Path;

use hrdsl_interop::uppaal::{self, UppaalMove, UppaalTrace};
use hrdsl_ir::{
    Nanos, Program,
    ta::{Automaton, AutomatonId, Network},
};
use hrdsl_runtime::prove::{RecordedPart, RecordedStep, RecordedTime, RecordedWalk, RunEnding};
use serde::Deserialize;
use serde_json::Value;

use crate::{fault::CommandFault, files, terminal};

/// A run with what it is called in its file.
pub struct NamedRun {
    /// `requirement R1`; empty: the file is the run.
    pub name: String,
    /// Index into the program's networks.
    pub network: usize,
    pub run: RecordedWalk,
    /// What else is to be said of how it was read.
    pub note: Option<String>,
}

#[derive(Deserialize)]
struct RunJson {
    network: Option<String>,
    #[serde(default)]
    automata: Vec<String>,
    steps: Vec<StepJson>,
    end: Option<String>,
    end_nanos: Option<Nanos>,
    ending: Option<RunEnding>,
}

#[derive(Deserialize)]
struct StepJson {
    time: Option<String>,
    nanos: Option<Nanos>,
    over: Option<String>,
    /// Whoever says it, says all.
    medium: Option<String>,
    parts: Vec<PartJson>,
    variables: Option<Vec<String>>,
}

#[derive(Deserialize)]
struct PartJson {
    automaton: String,
    from: Option<String>,
    to: Option<String>,
    edge: Option<usize>,
    selected: Option<Vec<String>>,
}

/// Reads the runs of a file; those that do not name their network are of the one that was chosen, or of the only one.
///
/// # Errors
/// A file that cannot be read, that has no run, or that speaks of what the scenario does not have.
pub fn read(path: &Path, program: &Program, chosen: &[String]) -> Result<Vec<NamedRun>, CommandFault> {
    let text = files::read(path)?;
    let named = |what: String| format!("{}: {what}", terminal::shown(path));
    let runs = if text.trim_start().starts_with(['{', '[']) {
        of_json(&text, program, chosen)
    } else {
        uppaal::read_trace(&text)
            .map_err(|e| format!("neither JSON nor a trace of UPPAAL (.xtr): {e}"))
            .and_then(|trace| Ok(vec![of_uppaal(&trace, program, chosen)?]))
    };
    runs.map_err(named)
}

fn of_json(text: &str, program: &Program, chosen: &[String]) -> Result<Vec<NamedRun>, String> {
    let document: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    if document.get("steps").is_some() {
        return Ok(vec![of_run(String::new(), document, program, chosen)?]);
    }
    let mut runs = Vec::new();
    let list =
        |value: &Value, key: &str| value.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    for network in list(&document, "networks") {
        for (rows, kind) in [("requirements", "requirement"), ("queries", "query"), ("ranges", "range")] {
            for mut row in list(&network, rows) {
                let name = row.get("name").and_then(Value::as_str).unwrap_or("?").to_owned();
                if let Some(run) = row.get_mut("run").map(Value::take) {
                    runs.push(of_run(format!("{kind} {name}"), run, program, chosen)?);
                }
            }
        }
    }
    if runs.is_empty() {
        return Err(
            "there is no run in it; `hrdsl prove --json` and the command `json` of `hrdsl step` print some"
                .into(),
        );
    }
    Ok(runs)
}

fn of_run(name: String, value: Value, program: &Program, chosen: &[String]) -> Result<NamedRun, String> {
    let place = if name.is_empty() { "the run".to_owned() } else { name.clone() };
    let run: RunJson = serde_json::from_value(value).map_err(|e| format!("{place}: {e}"))?;
    let network = network_of(program, run.network.as_deref(), chosen)?;
    let declared = &program.networks[network];
    let members: Vec<&str> = automata(program, declared).map(|a| a.name.as_str()).collect();
    // Observers only listen: without them it is the same run.
    let observers: Vec<&String> = run.automata.iter().filter(|a| !members.contains(&a.as_str())).collect();
    let mut steps = Vec::new();
    for (number, step) in run.steps.into_iter().enumerate() {
        let whole = step.medium.is_some();
        let mut parts = Vec::new();
        for part in step.parts {
            let Some(member) = members.iter().position(|m| *m == part.automaton) else {
                if observers.contains(&&part.automaton) {
                    continue;
                }
                return Err(format!(
                    "{place}, step {}: `{}` is no automaton of the network `{}`, which has {}",
                    number + 1,
                    part.automaton,
                    declared.name,
                    members.join(", ")
                ));
            };
            let PartJson { from, to, edge, selected, .. } = part;
            let selected = selected.or(edge.and(whole.then(Vec::new)));
            parts.push(RecordedPart { member, from, to, edge, selected });
        }
        let own = |change: &String| {
            !observers
                .iter()
                .any(|o| change.strip_prefix(o.as_str()).is_some_and(|rest| rest.starts_with('.')))
        };
        let variables = step.variables.or(whole.then(Vec::new));
        steps.push(RecordedStep {
            time: moment(step.time.as_deref(), step.nanos)
                .map_err(|e| format!("{place}, step {}: {e}", number + 1))?,
            over: step.over,
            parts,
            variables: variables.map(|all| all.into_iter().filter(own).collect()),
        });
    }
    let end = moment(run.end.as_deref(), run.end_nanos).map_err(|e| format!("{place}, its end: {e}"))?;
    let run = RecordedWalk { steps, end, ending: run.ending };
    Ok(NamedRun { name, network, run, note: None })
}

fn automata<'p>(program: &'p Program, network: &'p Network) -> impl Iterator<Item = &'p Automaton> {
    network.automata.iter().map(|id: &AutomatonId| program.automaton(*id))
}

/// The network of a run: the one that it names, or the one that was chosen, or the only one.
fn network_of(program: &Program, named: Option<&str>, chosen: &[String]) -> Result<usize, String> {
    let known = |name: &str| program.networks.iter().position(|n| n.name == name);
    let all = || program.networks.iter().map(|n| n.name.as_str()).collect::<Vec<_>>().join(", ");
    match (chosen, named) {
        ([name], _) => known(name).ok_or_else(|| format!("no network `{name}`; the scenario has: {}", all())),
        (_, Some(name)) => known(name).ok_or_else(|| {
            format!("it is of a network `{name}`; the scenario has: {} (choose with --network)", all())
        }),
        (_, None) if program.networks.len() == 1 => Ok(0),
        (_, None) if program.networks.is_empty() => Err("the scenario has no network".to_owned()),
        (_, None) => Err(format!("say of which network it is with --network: {}", all())),
    }
}

/// A time: seconds as they are printed, or else nanoseconds.
fn moment(seconds: Option<&str>, nanos: Option<Nanos>) -> Result<Option<RecordedTime>, String> {
    let Some(text) = seconds else { return Ok(nanos.map(RecordedTime::At)) };
    let wrong = || format!("`{text}` is no time in seconds, like `2.5`");
    // What is finer than a nanosecond is printed as a fraction of one.
    let (whole, finer) = text.split_once(" + ").map_or((text, false), |(whole, _)| (whole, true));
    let nanos = exact_nanos(whole.trim()).ok_or_else(wrong)?;
    Ok(Some(if finer { RecordedTime::After(nanos) } else { RecordedTime::At(nanos) }))
}

/// `2.5` seconds in nanoseconds, exactly; `None`: it is no such number, or finer than a nanosecond.
pub fn exact_nanos(text: &str) -> Option<Nanos> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    if !digits(whole) || !digits(fraction) || fraction.len() > 9 {
        return None;
    }
    let fraction: Nanos = format!("{fraction:0<9}").parse().ok()?;
    whole.parse::<Nanos>().ok()?.checked_mul(1_000_000_000)?.checked_add(fraction)
}

/// A trace of UPPAAL of the model that the network was imported from, or exported to: numbers are places in the network.
fn of_uppaal(trace: &UppaalTrace, program: &Program, chosen: &[String]) -> Result<NamedRun, String> {
    let network = network_of(program, None, chosen)?;
    let declared = &program.networks[network];
    let members: Vec<&Automaton> = automata(program, declared).collect();
    let processes = trace.locations.first().map_or(0, Vec::len);
    if trace.locations.iter().any(|l| l.len() != members.len()) {
        return Err(format!(
            "the trace is of {processes} processes, and the network `{}` has {} automata: is it of this model?",
            declared.name,
            members.len()
        ));
    }
    let mut all_named = true;
    let mut steps = Vec::new();
    for (number, moves) in trace.transitions.iter().enumerate() {
        let (before, after) = (&trace.locations[number], &trace.locations[number + 1]);
        let mut parts = Vec::new();
        for m in moves {
            let part = uppaal_part(m, &members, before, after);
            let part = part.map_err(|why| format!("transition {}: {why}", number + 1))?;
            all_named &= part.edge.is_some();
            parts.push(part);
        }
        steps.push(RecordedStep { parts, ..RecordedStep::default() });
    }
    let start = &trace.locations[0];
    let elsewhere = |(m, at): &(&&Automaton, &usize)| usize::from(m.initial.0) != **at;
    if let Some((m, at)) = members.iter().zip(start).find(elsewhere) {
        return Err(format!("the trace starts with `{}` in its location {at}: is it of this model?", m.name));
    }
    let note = (!all_named).then(|| {
        "some edges of the trace are numbered otherwise than here: there, only the locations are compared"
            .to_owned()
    });
    Ok(NamedRun {
        name: String::new(),
        network,
        run: RecordedWalk { steps, ..RecordedWalk::default() },
        note,
    })
}

fn uppaal_part(
    m: &UppaalMove,
    members: &[&Automaton],
    before: &[usize],
    after: &[usize],
) -> Result<RecordedPart, String> {
    let process = m.process;
    let Some(automaton) = members.get(process) else {
        return Err(format!("there is no process {process}; they are numbered from 0"));
    };
    let place = |locations: &[usize]| {
        let at = locations[process];
        let location = automaton.locations.get(at);
        location.ok_or_else(|| format!("`{}` has no location {at}: is it of this model?", automaton.name))
    };
    let (from, to) = (place(before)?, place(after)?);
    // Only an edge between the same locations is the one that is meant.
    let is_it = |e: &&hrdsl_ir::ta::Edge| {
        usize::from(e.from.0) == before[process]
            && usize::from(e.to.0) == after[process]
            && e.selects.len() == m.selects.len()
    };
    let edge = automaton.edges.get(m.edge).filter(is_it);
    let selected = edge.map(|e| {
        let values = e.selects.iter().zip(&m.selects);
        values.filter_map(|(s, n)| Some(format!("{} = {}", s.name, s.value(*n)?))).collect()
    });
    Ok(RecordedPart {
        member: process,
        from: Some(from.name.clone()),
        to: Some(to.name.clone()),
        edge: edge.map(|_| m.edge + 1),
        selected,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_to_the_nanosecond() {
        let read = |text| moment(Some(text), Some(1));
        assert_eq!(read("12"), Ok(Some(RecordedTime::At(12_000_000_000))));
        assert_eq!(read("16.000000001"), Ok(Some(RecordedTime::At(16_000_000_001))));
        assert_eq!(read("0.000000002 + 1/3 ns"), Ok(Some(RecordedTime::After(2))));
        assert_eq!(moment(None, Some(7)), Ok(Some(RecordedTime::At(7))));
        assert_eq!(moment(None, None), Ok(None));
        for wrong in ["", "1.", "-1", "1e3", "0.0000000001", "99999999999999999999"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
