//! A witness told to people: when, who did what, and what changed by it.

use std::fmt::Write as _;

use hrdsl_ir::{
    Nanos, Program, Span, Value,
    ta::{Automaton, ChannelId, ChannelKind, ClockId, EdgeAssignment, Network},
};
use serde::Serialize;

use crate::{
    network::{model::slot_names, semantics::AutomatonMove},
    witness::{
        concrete::clock_name,
        run::{RunEnding, WitnessRun, WitnessRunStep},
    },
};

/// A witness by names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessTrace {
    pub network: String,
    /// The automata, in the network's order.
    pub automata: Vec<String>,
    pub steps: Vec<WitnessTransition>,
    /// When what it shows is so, in seconds.
    pub end: String,
    /// The nanoseconds of it, rounded down.
    pub end_nanos: Nanos,
    pub ending: RunEnding,
}

/// One transition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessTransition {
    /// Since the start, in seconds.
    pub time: String,
    pub nanos: Nanos,
    /// The event or channel, with its arguments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    pub medium: TransitionMedium,
    /// Who takes part, the one that starts it first.
    pub parts: Vec<TransitionParticipant>,
    /// What changed, as `q: 0 -> 1`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<String>,
    /// What clocks were set to, as `x = 0`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TransitionMedium {
    Internal,
    Event,
    /// Over a channel, between two.
    Binary,
    Broadcast,
    /// Over a `joint` channel, between several.
    MultiWay,
}

/// One automaton's part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TransitionParticipant {
    /// Index in the network.
    pub member: usize,
    pub automaton: String,
    /// The number of the edge taken among those of the automaton, from 1.
    pub edge: usize,
    pub from: String,
    pub to: String,
    /// The values of the edge's selects, as `n = 2`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub selected: Vec<String>,
    /// What the edge is written as; known to those who have the text, see [`WitnessTrace::locate`].
    #[serde(flatten)]
    pub source: Option<EdgeSource>,
    /// The place of the edge in the text.
    #[serde(skip)]
    pub origin: Span,
}

/// An edge as its author wrote it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EdgeSource {
    pub file: String,
    /// From 1.
    pub line: u32,
    /// On one line; `None`: it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guard: Option<String>,
}

impl WitnessTrace {
    /// `network` must be the one that was searched.
    #[must_use]
    pub fn from_run(program: &Program, network: &Network, witness: &WitnessRun) -> Self {
        let builder = WitnessTraceBuilder { program, network, slots: slot_names(program, network) };
        let automata = (0..network.automata.len()).map(|m| builder.member(m).name.clone()).collect();
        WitnessTrace {
            network: witness.network.clone(),
            automata,
            steps: witness.steps.iter().map(|s| builder.transition(s, witness.ticks)).collect(),
            end: seconds(witness.end, witness.ticks),
            end_nanos: witness.end.div_euclid(witness.ticks.max(1)),
            ending: witness.ending,
        }
    }

    /// Says of each edge taken how it is written.
    pub fn locate(&mut self, source: &dyn Fn(Span) -> Option<EdgeSource>) {
        self.steps.iter_mut().for_each(|step| step.locate(source));
    }

    /// A table: a line for each transition with its time, what it goes over and who goes where, then what it changes; below it a
    /// line for each edge whose source is known or that selects values.
    #[must_use]
    pub fn text(&self) -> String {
        let wide = |f: &dyn Fn(&WitnessTransition) -> usize| self.steps.iter().map(f).max().unwrap_or(0);
        let time = wide(&|s| s.time.len()).max(self.end.len());
        let who = wide(&|s| s.starter().automaton.chars().count());
        let over = wide(&|s| s.over.as_ref().map_or(0, |o| o.chars().count()));
        let mut out = String::new();
        for (i, step) in self.steps.iter().enumerate() {
            if self.ending == RunEnding::Again(i) {
                let _ = writeln!(out, "{:time$}    from here on again and again:", "");
            }
            let first = &step.starter().automaton;
            let gap = if over == 0 { 0 } else { over + 2 };
            let what = step.over.as_deref().unwrap_or("");
            let moves: Vec<String> = step.parts.iter().enumerate().map(|(n, p)| p.movement(n > 0)).collect();
            let _ = write!(out, "{:>time$} s  {first:who$}  {what:gap$}{}", step.time, moves.join(", "));
            let changes: Vec<&str> = step.variables.iter().chain(&step.clocks).map(String::as_str).collect();
            if !changes.is_empty() {
                let _ = write!(out, "   [{}]", changes.join("; "));
            }
            out.push('\n');
            for line in step.edges() {
                let _ = writeln!(out, "{:time$}      {line}", "");
            }
        }
        let last = self.steps.last().map_or("0", |s| s.time.as_str());
        let wait = (self.end != last).then_some(self.end.as_str());
        match (self.ending, wait) {
            (RunEnding::Reached, None) | (RunEnding::Again(_), _) => {}
            (RunEnding::Reached, Some(end)) => {
                let _ = writeln!(out, "{end:>time$} s  reached after a delay");
            }
            (RunEnding::Stuck, _) => {
                let _ = writeln!(out, "{:>time$} s  nothing more can happen", self.end);
            }
            (RunEnding::Waits, _) => {
                let _ = writeln!(out, "{:>time$} s  time can pass for ever", self.end);
            }
            (RunEnding::Fault, _) => {
                let _ = writeln!(out, "{:>time$} s  what would happen next is the fault", self.end);
            }
        }
        out
    }
}

impl WitnessRun {
    /// A readable printing: its [`WitnessTrace`] as text.
    ///
    /// `network` must be the one that was searched.
    #[must_use]
    pub fn text(&self, program: &Program, network: &Network) -> String {
        WitnessTrace::from_run(program, network, self).text()
    }
}

impl WitnessTransition {
    /// A step of a network by names; its time is in nanoseconds.
    pub(crate) fn from_step(program: &Program, network: &Network, step: &WitnessRunStep) -> Self {
        let slots = slot_names(program, network);
        WitnessTraceBuilder { program, network, slots }.transition(step, 1)
    }

    /// Who starts it: nothing happens by itself.
    fn starter(&self) -> &TransitionParticipant {
        &self.parts[0]
    }

    /// Says of each edge taken how it is written.
    pub fn locate(&mut self, source: &dyn Fn(Span) -> Option<EdgeSource>) {
        self.parts.iter_mut().for_each(|part| part.source = source(part.origin));
    }

    /// Without its time: `asked(false)  Person: outside -> waiting, Door: shut -> moving   [q: 0 -> 1]`.
    #[must_use]
    pub fn summary(&self) -> String {
        let over = self.over.as_ref().map(|over| format!("{over}  ")).unwrap_or_default();
        let moves: Vec<String> = self.parts.iter().map(|p| p.movement(true)).collect();
        let changes: Vec<&str> = self.variables.iter().chain(&self.clocks).map(String::as_str).collect();
        let changes = if changes.is_empty() { String::new() } else { format!("   [{}]", changes.join("; ")) };
        format!("{over}{}{changes}", moves.join(", "))
    }

    /// A line for each edge whose source is known or that selects values.
    #[must_use]
    pub fn edges(&self) -> Vec<String> {
        let told = |p: &&TransitionParticipant| p.source.is_some() || !p.selected.is_empty();
        self.parts.iter().filter(told).map(TransitionParticipant::edge_line).collect()
    }
}

impl TransitionParticipant {
    fn movement(&self, named: bool) -> String {
        let text = if self.from == self.to {
            format!("stays in {}", self.to)
        } else {
            format!("{} -> {}", self.from, self.to)
        };
        if named { format!("{}: {text}", self.automaton) } else { text }
    }

    /// `door.hri:24: Person: outside -> waiting when x >= 10 s with n = 2`
    fn edge_line(&self) -> String {
        let Self { automaton, from, to, .. } = self;
        let place = self.source.as_ref().map(|s| format!("{}:{}: ", s.file, s.line)).unwrap_or_default();
        let guard = self.source.as_ref().and_then(|s| s.guard.as_ref());
        let guard = guard.map(|g| format!(" when {g}")).unwrap_or_default();
        let with = if self.selected.is_empty() { String::new() } else { " with ".to_owned() };
        format!("{place}{automaton}: {from} -> {to}{guard}{with}{}", self.selected.join(", "))
    }
}

struct WitnessTraceBuilder<'a> {
    program: &'a Program,
    network: &'a Network,
    slots: Vec<String>,
}

impl<'a> WitnessTraceBuilder<'a> {
    fn member(&self, m: usize) -> &'a Automaton {
        self.program.automaton(self.network.automata[m])
    }

    fn transition(&self, step: &WitnessRunStep, ticks: i64) -> WitnessTransition {
        let (over, medium) = match (&step.event, &step.channel) {
            (Some((event, args)), _) => {
                (Some(applied(&self.program.event(*event).name, args)), TransitionMedium::Event)
            }
            (None, Some((channel, args))) => {
                let (name, medium) = self.channel(*channel);
                (Some(applied(name, args)), medium)
            }
            (None, None) => (None, TransitionMedium::Internal),
        };
        let changed = step.variables.iter();
        let variables = changed.map(|(slot, from, to)| format!("{}: {from} -> {to}", self.slots[*slot]));
        WitnessTransition {
            time: seconds(step.time, ticks),
            nanos: step.time.div_euclid(ticks.max(1)),
            over,
            medium,
            parts: step.moves.iter().map(|m| self.part(m)).collect(),
            variables: variables.collect(),
            clocks: step.moves.iter().flat_map(|m| self.clocks(m)).collect(),
        }
    }

    fn channel(&self, id: ChannelId) -> (&'a str, TransitionMedium) {
        let channel = self.program.channel(id);
        let medium = match channel.kind {
            ChannelKind::Binary => TransitionMedium::Binary,
            ChannelKind::Broadcast => TransitionMedium::Broadcast,
            ChannelKind::MultiWay(_) => TransitionMedium::MultiWay,
        };
        (&channel.name, medium)
    }

    fn part(&self, m: &AutomatonMove) -> TransitionParticipant {
        let a = self.member(m.automaton);
        let edge = &a.edges[m.edge];
        let [from, to] = [edge.from, edge.to].map(|l| a.location(l).name.clone());
        // The selects are the first of the binders; the others are what was received.
        let selected = edge.selects.iter().zip(&m.binders).map(|(s, value)| format!("{} = {value}", s.name));
        TransitionParticipant {
            member: m.automaton,
            automaton: a.name.clone(),
            edge: m.edge + 1,
            from,
            to,
            selected: selected.collect(),
            source: None,
            origin: edge.origin,
        }
    }

    /// The clocks that an edge sets; a value is shown if it is a constant.
    fn clocks(&self, m: &AutomatonMove) -> Vec<String> {
        let a = self.member(m.automaton);
        let name = |c: ClockId| clock_name(self.program, a, c);
        a.edges[m.edge]
            .updates
            .iter()
            .filter_map(|u| match u {
                EdgeAssignment::Assign { .. } | EdgeAssignment::Call { .. } => None,
                EdgeAssignment::Reset { clock, from, to } => {
                    let time = seconds(to.nanos, 1);
                    let plain = to.terms.is_empty();
                    Some(match (from, plain, to.nanos) {
                        (None, true, 0) => format!("{} = 0", name(*clock)),
                        (None, true, _) => format!("{} = {time} s", name(*clock)),
                        (Some(from), true, 0) => format!("{} = {}", name(*clock), name(*from)),
                        (Some(from), true, _) => format!("{} = {} + {time} s", name(*clock), name(*from)),
                        (_, false, _) => format!("{} set", name(*clock)),
                    })
                }
            })
            .collect()
    }
}

fn applied(name: &str, args: &[Value]) -> String {
    if args.is_empty() {
        return name.to_owned();
    }
    let args: Vec<String> = args.iter().map(ToString::to_string).collect();
    format!("{name}({})", args.join(", "))
}

/// Ticks as seconds, exact for whole nanoseconds.
pub(crate) fn seconds(time: i64, ticks: i64) -> String {
    let ticks = ticks.max(1);
    let (nanos, rest) = (time.div_euclid(ticks), time.rem_euclid(ticks));
    let sign = if nanos < 0 { "-" } else { "" };
    let nanos = nanos.unsigned_abs();
    let mut text = format!("{sign}{}.{:09}", nanos / 1_000_000_000, nanos % 1_000_000_000);
    if rest == 0 {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    } else {
        let _ = write!(text, " + {rest}/{ticks} ns");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_print_as_seconds() {
        assert_eq!(seconds(0, 1), "0");
        assert_eq!(seconds(10_000_000_001, 1), "10.000000001");
        assert_eq!(seconds(1_500_000_000, 1), "1.5");
        assert_eq!(seconds(7, 3), "0.000000002 + 1/3 ns");
        assert_eq!(seconds(-1_500_000_000, 1), "-1.5");
    }
}
