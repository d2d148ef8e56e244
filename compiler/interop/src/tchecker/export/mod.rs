//! A network in TChecker's text format.
//!
//! # Steps
//! 1. `names`: all of TChecker's names are global; processes, clocks and integers get theirs
//! 2. `edges`: each edge, select and argument of a channel becomes edges with constant arguments
//! 3. `vectors`, `loops`: binary synchronisations, broadcasts and multi-way channels become `sync` vectors
//! 4. `expr`, `statement`, `value`: without `||`, functions and enumerations, which TChecker has not
//!
//! [`export`] does them all. A unit of time in the file is the greatest in which all constants are whole; a comment at its
//! head says which. Each location has the label `AUTOMATON_LOCATION`, to ask for it.

mod edges;
mod expr;
mod loops;
mod names;
mod statement;
mod value;
mod vectors;

use std::{collections::BTreeMap, fmt::Write};

use hrdsl_ir::{
    Nanos, Program,
    ta::{Automaton, LocationKind, Network},
};

use self::{edges::EdgeInstance, expr::TcheckerExprWriter, names::TcheckerNames};
use crate::exchange::{
    obstacle::ExportObstacle,
    time::{self, seconds},
};

/// The network's file, or all that keeps it from being one.
///
/// # Errors
/// What TChecker cannot say: urgent channels, functions that are more than one expression, numbers that do not fit, …
pub fn export(program: &Program, network: &Network) -> Result<String, Vec<ExportObstacle>> {
    let automata: Vec<&Automaton> =
        network.automata.iter().filter_map(|id| program.automata.get(usize::from(id.0))).collect();
    let mut writer = TcheckerWriter {
        program,
        network,
        names: TcheckerNames::new(program, network, &automata),
        unit: time::unit(program, &automata),
        automata,
        tracked: BTreeMap::new(),
        obstacles: Vec::new(),
        out: String::new(),
    };
    writer.write();
    if writer.obstacles.is_empty() {
        Ok(writer.out)
    } else {
        writer.obstacles.sort_by_key(|o| (o.origin.start, o.message.clone()));
        writer.obstacles.dedup();
        Err(writer.obstacles)
    }
}

struct TcheckerWriter<'p> {
    program: &'p Program,
    network: &'p Network,
    automata: Vec<&'p Automaton>,
    names: TcheckerNames,
    unit: Nanos,
    /// Of processes whose place guards ask for, the variable that says it.
    tracked: BTreeMap<usize, String>,
    obstacles: Vec<ExportObstacle>,
    out: String,
}

impl TcheckerWriter<'_> {
    fn write(&mut self) {
        let _ = writeln!(self.out, "# {}: one unit of time is {}", self.network.name, seconds(self.unit));
        let _ = writeln!(self.out, "system:{}", self.names.system);
        let instances: Vec<Vec<EdgeInstance>> = (0..self.automata.len()).map(|a| self.instances(a)).collect();
        let mut joined = self.vectors(&instances);
        self.track(&mut joined);
        self.variables();
        let mut events: Vec<&str> = joined.edges.iter().flatten().map(|e| e.event.as_str()).collect();
        events.sort_unstable();
        events.dedup();
        for event in events {
            let _ = writeln!(self.out, "event:{event}");
        }
        for a in 0..self.automata.len() {
            self.process(a, &joined.edges[a]);
        }
        for sync in &joined.syncs {
            let _ = writeln!(self.out, "sync:{sync}");
        }
    }

    fn variables(&mut self) {
        for clock in &self.names.clocks {
            let _ = writeln!(self.out, "clock:1:{clock}");
        }
        for int in &self.names.ints {
            let (size, lo, hi) = (int.inits.len(), int.lo, int.hi);
            let init = int.inits[0];
            if int.inits.iter().any(|i| *i != init) {
                let message = format!(
                    "the elements of `{}` start with different values, and TChecker's arrays with one: set them on the first edge, from a committed location",
                    int.name
                );
                self.obstacles.push(ExportObstacle { message, origin: self.network.origin });
            }
            let _ = writeln!(self.out, "int:{size}:{lo}:{hi}:{init}:{}", int.name);
        }
        for (p, name) in &self.tracked {
            let automaton = self.automata[*p];
            let _ = writeln!(
                self.out,
                "int:1:0:{}:{}:{name}",
                automaton.locations.len() - 1,
                automaton.initial.0
            );
        }
    }

    fn process(&mut self, a: usize, edges: &[EdgeInstance]) {
        let automaton = self.automata[a];
        let process = &self.names.processes[a];
        let _ = writeln!(self.out, "process:{process}");
        for (l, location) in automaton.locations.iter().enumerate() {
            let name = &self.names.locations[a][l];
            let mut attributes = Vec::new();
            if usize::from(automaton.initial.0) == l {
                attributes.push("initial:".to_owned());
            }
            match location.kind {
                LocationKind::Normal => {}
                LocationKind::Urgent => attributes.push("urgent:".to_owned()),
                LocationKind::Committed => attributes.push("committed:".to_owned()),
            }
            let exprs = TcheckerExprWriter::new(self.program, &self.names, a, self.unit, &[]);
            let mut parts: Vec<String> = Vec::new();
            for c in &location.invariant {
                match exprs.bound(c) {
                    Ok(text) => parts.push(text),
                    Err(message) => self.obstacles.push(ExportObstacle { message, origin: location.origin }),
                }
            }
            if let Some(clock) = location.stopped.first() {
                let message = format!(
                    "`{}` stands still in `{}`, and TChecker's clocks always run: export to UPPAAL, which has `x' == 0`",
                    exprs.clock(*clock),
                    location.name
                );
                self.obstacles.push(ExportObstacle { message, origin: location.origin });
            }
            if let Some(e) = &location.holds {
                match exprs.conjunction(e) {
                    Ok(all) => parts.extend(all),
                    Err(message) => self.obstacles.push(ExportObstacle { message, origin: location.origin }),
                }
            }
            if !parts.is_empty() {
                attributes.push(format!("invariant: {}", parts.join(" && ")));
            }
            attributes.push(format!("labels: {process}_{name}"));
            let _ = writeln!(self.out, "location:{process}:{name}{{{}}}", attributes.join(" : "));
        }
        for e in edges {
            let name = |l: usize| &self.names.locations[a][l];
            let mut attributes = Vec::new();
            if !e.guard.is_empty() {
                let parts: Vec<&str> = e.guard.iter().map(|part| part.text.as_str()).collect();
                attributes.push(format!("provided: {}", parts.join(" && ")));
            }
            if !e.body.is_empty() {
                attributes.push(format!("do: {}", e.body.join("; ")));
            }
            let attributes =
                if attributes.is_empty() { String::new() } else { format!("{{{}}}", attributes.join(" : ")) };
            let _ =
                writeln!(self.out, "edge:{process}:{}:{}:{}{attributes}", name(e.from), name(e.to), e.event);
        }
    }
}
