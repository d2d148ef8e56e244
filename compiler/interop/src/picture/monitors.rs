//! Requirements' monitors as pictures, in DOT.

use std::fmt::Write;

use hrdsl_ir::{
    Program, Span,
    monitor::{Monitor, MonitorClockGuard, MonitorEdge, MonitorEffect, MonitorTrigger},
    ta::{Automaton, AutomatonVar, LocationId},
};

use super::{formulas::formula_dot, lines, quoted, show::AutomatonPrinter};
use crate::exchange::time::seconds;

/// All monitors in DOT: a cluster for each. States in which something is pending have a second border; so has what a formula asks of the run.
#[must_use]
pub fn monitors_dot(program: &Program) -> String {
    // What its expressions read are the signals, by their places, and no variables.
    let program = Program { shared: Vec::new(), ..program.clone() };
    let mut out = "digraph monitors {\n  compound = true\n".to_owned();
    out.push_str("  node [shape = box, style = rounded, fontname = \"sans-serif\"]\n");
    out.push_str("  edge [fontname = \"sans-serif\", fontsize = 10]\n");
    for (i, monitor) in program.monitors.iter().enumerate() {
        let label = quoted(&format!("{}: {}", monitor.name, monitor.text));
        let _ = writeln!(out, "  subgraph cluster_{i} {{\n    label = {label}");
        if let Some(formula) = &monitor.formula {
            out.push_str(&formula_dot(&program, i, formula));
            out.push_str("  }\n");
            continue;
        }
        let automaton = with_signals(&program, monitor);
        let show = AutomatonPrinter::of(&program, &automaton);
        let _ = writeln!(out, "    n{i}_start [shape = point]");
        for (s, state) in monitor.states.iter().enumerate() {
            let until = state.deadline.map(|d| format!("until {}", seconds(d)));
            let label = lines(std::iter::once(state.name.clone()).chain(until).collect());
            let double = if state.pending { ", peripheries = 2" } else { "" };
            let _ = writeln!(out, "    n{i}_{s} [label = {label}{double}]");
        }
        let at_start = lines(monitor.at_start.iter().map(|e| effect(*e).to_owned()).collect());
        let _ = writeln!(out, "    n{i}_start -> n{i}_{} [label = {at_start}]", monitor.initial.0);
        for edge in &monitor.edges {
            let label = lines(edge_lines(&show, monitor, edge));
            let _ = writeln!(out, "    n{i}_{} -> n{i}_{} [label = {label}]", edge.from.0, edge.to.0);
        }
        out.push_str("  }\n");
    }
    out.push_str("}\n");
    out
}

/// An automaton whose variables are called as the signals that a monitor reads.
fn with_signals(program: &Program, monitor: &Monitor) -> Automaton {
    let variable = |name: &str| AutomatonVar {
        name: name.to_owned(),
        lo: 0,
        hi: 0,
        init: 0,
        is_bool: false,
        enumeration: None,
    };
    Automaton {
        name: monitor.name.clone(),
        actor: None,
        clocks: Vec::new(),
        vars: monitor.signals.iter().map(|s| variable(&program.signal(*s).name)).collect(),
        locations: Vec::new(),
        initial: LocationId(0),
        edges: Vec::new(),
        origin: Span::default(),
    }
}

/// Cause, guards, effects: each on a line of its own.
fn edge_lines(show: &AutomatonPrinter<'_>, monitor: &Monitor, edge: &MonitorEdge) -> Vec<String> {
    let mut lines = vec![match &edge.on {
        MonitorTrigger::Event(patterns) => {
            patterns.iter().map(|p| show.program.pattern_text(p)).collect::<Vec<_>>().join(" or ")
        }
        MonitorTrigger::Becomes { condition, truth, first } => {
            let name = if *truth { "rising" } else { "falling" };
            let condition = monitor.conditions.get(usize::from(*condition));
            let first = if *first { ", or so from the first" } else { "" };
            format!("{name}({}){first}", condition.map_or_else(String::new, |c| show.expr(c)))
        }
        MonitorTrigger::Sample => "a sample".to_owned(),
        MonitorTrigger::Deadline => "the deadline".to_owned(),
    }];
    lines.extend(edge.guard.as_ref().map(|g| format!("if {}", show.expr(g))));
    lines.extend(edge.clock.map(|clock| match clock {
        MonitorClockGuard::Before(bound) => format!("sooner than {}", seconds(bound)),
        MonitorClockGuard::After(bound) => format!("later than {}", seconds(bound)),
    }));
    if !edge.effects.is_empty() {
        lines.push(edge.effects.iter().map(|e| effect(*e)).collect::<Vec<_>>().join(", "));
    }
    lines
}

fn effect(effect: MonitorEffect) -> &'static str {
    match effect {
        MonitorEffect::ResetClock => "reset",
        MonitorEffect::Trigger => "trigger",
        MonitorEffect::Discharge => "discharge",
        MonitorEffect::Suspect => "suspect",
        MonitorEffect::Fail => "fail",
    }
}
