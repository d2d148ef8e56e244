//! A network as a picture: each automaton's locations and edges, in DOT (Graphviz) or as a Mermaid state diagram; monitors in DOT.

mod monitors;
mod show;

use std::fmt::Write;

use hrdsl_ir::{
    Program,
    ta::{Automaton, Edge, LocationKind, Network},
};

pub use self::monitors::monitors_dot;
use self::show::AutomatonPrinter;

/// The network in DOT: a cluster for each automaton. Committed locations are marked `C`, urgent ones `U`.
#[must_use]
pub fn dot(program: &Program, network: &Network) -> String {
    let mut out = format!("digraph {} {{\n", quoted(&network.name));
    out.push_str("  compound = true\n  node [shape = box, style = rounded, fontname = \"sans-serif\"]\n");
    out.push_str("  edge [fontname = \"sans-serif\", fontsize = 10]\n");
    for (i, automaton) in members(program, network) {
        let _ =
            writeln!(out, "  subgraph cluster_{i} {{\n    label = {}", quoted(&title(program, automaton)));
        let show = AutomatonPrinter::of(program, automaton);
        let _ = writeln!(out, "    n{i}_start [shape = point]");
        for (l, location) in automaton.locations.iter().enumerate() {
            let label = lines(location_lines(&show, l, automaton));
            let double = if location.kind == LocationKind::Normal { "" } else { ", peripheries = 2" };
            let _ = writeln!(out, "    n{i}_{l} [label = {label}{double}]");
        }
        let _ = writeln!(out, "    n{i}_start -> n{i}_{}", automaton.initial.0);
        for edge in &automaton.edges {
            let label = lines(edge_lines(&show, edge));
            let _ = writeln!(out, "    n{i}_{} -> n{i}_{} [label = {label}]", edge.from.0, edge.to.0);
        }
        out.push_str("  }\n");
    }
    out.push_str("}\n");
    out
}

/// The network as a Mermaid `stateDiagram-v2`: a composite state for each automaton.
#[must_use]
pub fn mermaid(program: &Program, network: &Network) -> String {
    let mut out = String::from("stateDiagram-v2\n");
    for (i, automaton) in members(program, network) {
        let show = AutomatonPrinter::of(program, automaton);
        let _ = writeln!(out, "  state \"{}\" as a{i} {{", escaped(&title(program, automaton)));
        for l in 0..automaton.locations.len() {
            let text = location_lines(&show, l, automaton).join("<br>");
            let _ = writeln!(out, "    state \"{}\" as a{i}_{l}", escaped(&text));
        }
        let _ = writeln!(out, "    [*] --> a{i}_{}", automaton.initial.0);
        for edge in &automaton.edges {
            let label = edge_lines(&show, edge).join("<br>");
            let label = if label.is_empty() { String::new() } else { format!(" : {}", escaped(&label)) };
            let _ = writeln!(out, "    a{i}_{} --> a{i}_{}{label}", edge.from.0, edge.to.0);
        }
        out.push_str("  }\n");
    }
    out
}

fn members<'p>(program: &'p Program, network: &'p Network) -> impl Iterator<Item = (usize, &'p Automaton)> {
    network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0))).enumerate()
}

fn title(program: &Program, automaton: &Automaton) -> String {
    let plays = automaton.actor.map_or(String::new(), |a| format!(" plays {}", program.actor(a).name));
    format!("{}{plays}", automaton.name)
}

fn location_lines(show: &AutomatonPrinter<'_>, l: usize, automaton: &Automaton) -> Vec<String> {
    let location = &automaton.locations[l];
    let mark = match location.kind {
        LocationKind::Normal => "",
        LocationKind::Urgent => " (U)",
        LocationKind::Committed => " (C)",
    };
    let mut lines = vec![format!("{}{mark}", location.name)];
    let bounds = location.invariant.iter().map(|c| show.bound(c));
    let stands = location.stopped.iter().map(|c| format!("stopped({})", show.clock(*c)));
    let holds = location.holds.iter().map(|e| show.expr(e));
    let invariant: Vec<String> = bounds.chain(holds).chain(stands).collect();
    if !invariant.is_empty() {
        lines.push(invariant.join(" && "));
    }
    lines
}

/// Select, guard, synchronisation, updates: each on a line of its own.
fn edge_lines(show: &AutomatonPrinter<'_>, edge: &Edge) -> Vec<String> {
    let show = show.edge(edge);
    let mut lines = Vec::new();
    for s in &edge.selects {
        let range = match (s.enumeration, s.is_bool) {
            (Some(e), _) => e.values().iter().map(|v| v.name()).collect::<Vec<_>>().join(", "),
            (None, true) => "bool".to_owned(),
            (None, false) => format!("{}..{}", s.lo, s.hi),
        };
        lines.push(format!("select {}: {range}", s.name));
    }
    let guard = show.guard(edge);
    if !guard.is_empty() {
        lines.push(guard.join(" && "));
    }
    lines.extend(show.sync(edge));
    if !edge.updates.is_empty() {
        lines.push(edge.updates.iter().map(|u| show.update(u)).collect::<Vec<_>>().join("; "));
    }
    lines
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

fn lines(lines: Vec<String>) -> String {
    let escaped: Vec<String> = lines.iter().map(|l| l.replace('\\', "\\\\").replace('"', "\\\"")).collect();
    format!("\"{}\"", escaped.join("\\n"))
}

/// Mermaid ends a label at `;` and takes `#` for an entity; `:` and braces mean something, too.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            ';' | '#' | ':' | '"' | '{' | '}' => {
                let _ = write!(out, "#{};", c as u32);
            }
            c => out.push(c),
        }
    }
    out
}
