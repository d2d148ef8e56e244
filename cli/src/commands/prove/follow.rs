//! `hrdsl prove --follow`: whether recorded runs are runs of the network, and where they leave it.

use hrdsl_ir::Program;
use hrdsl_runtime::prove::{
    FollowDeparture, FollowOutcome, ModelError, NetworkWalk, RecordedWalk, WalkOption, WitnessTransition,
    follow,
};
use hrdsl_source::printable;
use serde::Serialize;

use super::ProveArgs;
use crate::{
    edge_sources::EdgeSources, exit::CommandExit, fault::CommandFault, files, recorded_run, terminal,
};

/// What became of one run.
#[derive(Serialize)]
struct FollowedRun {
    /// What the file calls it.
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    network: String,
    steps: usize,
    is_run: bool,
    /// The fault of the model that it leads to, if it was recorded to lead to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    leaves: Option<Departure>,
}

#[derive(Serialize)]
struct Departure {
    /// From 1; one more than there are steps: the end.
    step: usize,
    why: String,
    /// When the network can be there, without a transition.
    #[serde(skip_serializing_if = "Option::is_none")]
    stays: Option<String>,
    enabled: Vec<EnabledInstead>,
}

#[derive(Serialize)]
struct EnabledInstead {
    /// When, since the start.
    when: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
    #[serde(flatten)]
    transition: WitnessTransition,
}

#[derive(Serialize)]
struct FollowDocument<'r> {
    format: &'static str,
    version: u32,
    scenario: &'r str,
    runs: &'r [FollowedRun],
}

/// # Errors
/// A file, or a network that cannot be walked through.
pub fn run(
    args: &ProveArgs,
    trace: &std::path::Path,
    program: &Program,
    sources: &EdgeSources<'_>,
) -> Result<CommandExit, CommandFault> {
    let mut followed = Vec::new();
    for recorded in recorded_run::read(trace, program, &args.network)? {
        let network = &program.networks[recorded.network];
        let followed_run = NetworkWalk::new(program, network).and_then(|walk| leaving(&walk, &recorded.run));
        let (outcome, renumbered) = match followed_run {
            Ok(found) => found,
            Err(ModelError::Question(what)) => return Err(format!("{}: {what}", terminal::shown(trace))),
            Err(fault) => {
                terminal::say_line(format_args!("network `{}`: {fault}", network.name));
                return Ok(CommandExit::Errors);
            }
        };
        let (leaves, fault) = match outcome {
            FollowOutcome::Run => (None, None),
            FollowOutcome::Fault(fault) => (None, Some(fault.to_string())),
            FollowOutcome::Leaves(departure) => (Some(told(*departure, sources)), None),
        };
        let note = recorded.note.or_else(|| renumbered.then(|| RENUMBERED.to_owned()));
        followed.push(FollowedRun {
            name: recorded.name,
            network: network.name.clone(),
            steps: recorded.run.steps.len(),
            is_run: leaves.is_none(),
            fault,
            note,
            leaves,
        });
    }
    if args.json {
        let document =
            FollowDocument { format: "hrdsl-follow", version: 1, scenario: &program.name, runs: &followed };
        terminal::print_data(&files::json(&document)?)?;
    } else {
        let text: String = followed.iter().map(human).collect();
        terminal::print(&printable(&text))?;
    }
    Ok(if followed.iter().all(|r| r.is_run) { CommandExit::Ok } else { CommandExit::Findings })
}

const RENUMBERED: &str = "its edges have other numbers here: only what they do is compared";

/// Whether a run is one of the network, or where it leaves it; and whether that is so only when the numbers of its edges are not looked at, which change
/// where an edge is added.
fn leaving(walk: &NetworkWalk<'_>, run: &RecordedWalk) -> Result<(FollowOutcome, bool), ModelError> {
    let first = match follow(walk, run)? {
        FollowOutcome::Leaves(first) => first,
        is_run @ (FollowOutcome::Run | FollowOutcome::Fault(_)) => return Ok((is_run, false)),
    };
    let mut plain = run.clone();
    plain.steps.iter_mut().flat_map(|s| &mut s.parts).for_each(|p| p.edge = None);
    match follow(walk, &plain)? {
        FollowOutcome::Leaves(later) if later.step <= first.step => Ok((FollowOutcome::Leaves(first), false)),
        other @ (FollowOutcome::Run | FollowOutcome::Fault(_) | FollowOutcome::Leaves(_)) => {
            Ok((other, true))
        }
    }
}

fn told(departure: FollowDeparture, sources: &EdgeSources<'_>) -> Departure {
    let enabled = |option: WalkOption| {
        let mut transition = option.told;
        transition.locate(&|origin| sources.at(origin));
        let fault = option.fault.map(|f| f.to_string());
        EnabledInstead { when: option.time.to_string(), fault, transition }
    };
    Departure {
        step: departure.step,
        why: departure.why,
        stays: departure.stays.map(|s| s.during()),
        enabled: departure.enabled.into_iter().map(enabled).collect(),
    }
}

fn human(run: &FollowedRun) -> String {
    let of = if run.name.is_empty() { String::new() } else { format!("{}: ", run.name) };
    let steps = format!("{} {}", run.steps, if run.steps == 1 { "step" } else { "steps" });
    let mut out = match &run.leaves {
        None => {
            let fault = run.fault.iter().map(|f| format!("  and then a fault of the model: {f}\n"));
            format!("{of}a run of the network {} ({steps})\n{}", run.network, fault.collect::<String>())
        }
        Some(left) if left.step > run.steps => {
            format!("{of}leaves the network {} at its end, after {steps}: {}\n", run.network, left.why)
        }
        Some(left) => {
            format!(
                "{of}leaves the network {} at step {} of {}: {}\n",
                run.network, left.step, run.steps, left.why
            )
        }
    };
    if let Some(note) = &run.note {
        out += &format!("  note: {note}\n");
    }
    let Some(left) = &run.leaves else { return out };
    if let Some(stays) = &left.stays {
        out += &format!("  the network can be there {stays}\n");
    }
    if left.enabled.is_empty() {
        out += "  nothing can happen there\n";
    } else {
        out += "  what can happen there:\n";
    }
    let wide = left.enabled.iter().map(|e| e.when.chars().count()).max().unwrap_or(0);
    for option in &left.enabled {
        let what = match &option.fault {
            Some(fault) => format!("fault of the model: {fault}"),
            None => option.transition.summary(),
        };
        out += &format!("    {:wide$}  {what}\n", option.when);
        for line in option.transition.edges() {
            out += &format!("    {:wide$}    {line}\n", "");
        }
    }
    out
}
