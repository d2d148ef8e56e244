//! A witness as a picture: a sequence diagram of Mermaid, and the same as a graph for DOT.

use std::fmt::Write as _;

use crate::witness::{
    run::RunEnding,
    trace::{TransitionMedium, WitnessTrace, WitnessTransition},
};

impl WitnessTrace {
    /// A sequence diagram for Mermaid: automata are participants; who starts an event or channel sends an arrow to each
    /// that takes part; delays and what is internal are notes.
    #[must_use]
    pub fn mermaid(&self) -> String {
        let mut out = String::from("sequenceDiagram\n");
        for (i, name) in self.automata.iter().enumerate() {
            let _ = writeln!(out, "  participant a{i} as {}", plain(name));
        }
        let all = self.span();
        let mut last = "0";
        let mut looping = false;
        for (i, step) in self.steps.iter().enumerate() {
            if self.ending == RunEnding::Again(i) {
                out.push_str("  loop for ever\n");
                looping = true;
            }
            if step.time != last {
                let _ = writeln!(out, "  Note over {all}: {} s", step.time);
                last = &step.time;
            }
            mermaid_step(step, &mut out);
        }
        if looping {
            out.push_str("  end\n");
        }
        if let Some(word) = self.last_word() {
            let _ = writeln!(out, "  Note over {all}: {} s, {word}", self.end);
        } else if self.end != last && !looping {
            let _ = writeln!(out, "  Note over {all}: {} s", self.end);
        }
        out
    }

    /// A graph for DOT: a column for each automaton with a node for each place where it is, an arrow for each event or
    /// channel.
    #[must_use]
    pub fn dot(&self) -> String {
        let mut out = String::from("digraph sequence {\n  rankdir = TB;\n  node [shape = box];\n");
        let mut at: Vec<String> = Vec::new();
        for (i, name) in self.automata.iter().enumerate() {
            let _ = writeln!(out, "  a{i} [label = {}, shape = plaintext];", quoted(name));
            at.push(format!("a{i}"));
        }
        let _ = writeln!(out, "  {{ rank = same; {} }}", at.join("; "));
        for (n, step) in self.steps.iter().enumerate() {
            let now = |m: usize| format!("s{n}_{m}");
            for p in &step.parts {
                let label = format!("{} s\n{}", step.time, p.to);
                let _ = writeln!(out, "  {} [label = {}];", now(p.member), quoted(&label));
                let changes: Vec<&str> = step.variables.iter().map(String::as_str).collect();
                let own = step.parts.first().is_some_and(|f| f.member == p.member) && !changes.is_empty();
                let label =
                    if own { format!(" [label = {}]", quoted(&changes.join("\n"))) } else { String::new() };
                if let Some(before) = at.get_mut(p.member) {
                    let _ = writeln!(out, "  {before} -> {}{label};", now(p.member));
                    *before = now(p.member);
                }
            }
            let ranks: Vec<String> = step.parts.iter().map(|p| now(p.member)).collect();
            let _ = writeln!(out, "  {{ rank = same; {} }}", ranks.join("; "));
            let Some((first, others)) = step.parts.split_first() else { continue };
            for p in others {
                let label = step.over.as_deref().unwrap_or("");
                let style = if step.medium == TransitionMedium::Binary { "solid" } else { "dashed" };
                let ends = format!("{} -> {}", now(first.member), now(p.member));
                let _ = writeln!(out, "  {ends} [label = {}, style = {style}];", quoted(label));
            }
        }
        if let Some(word) = self.last_word() {
            let _ = writeln!(out, "  label = {};", quoted(&format!("{} s: {word}", self.end)));
        }
        out.push_str("}\n");
        out
    }

    fn last_word(&self) -> Option<&'static str> {
        match self.ending {
            RunEnding::Reached | RunEnding::Again(_) => None,
            RunEnding::Stuck => Some("nothing more can happen"),
            RunEnding::Waits => Some("time can pass for ever"),
            RunEnding::Fault => Some("what would happen next is a fault of the model"),
        }
    }

    /// All participants, for a note over them.
    fn span(&self) -> String {
        match self.automata.len() {
            0 | 1 => "a0".to_owned(),
            n => format!("a0,a{}", n - 1),
        }
    }
}

fn mermaid_step(step: &WitnessTransition, out: &mut String) {
    let Some((first, others)) = step.parts.split_first() else { return };
    let from = first.member;
    if let Some(over) = &step.over {
        // A binary synchronisation is one arrow that both wait for; what is broadcast does not wait.
        let arrow = match step.medium {
            TransitionMedium::Binary | TransitionMedium::MultiWay | TransitionMedium::Internal => "->>",
            TransitionMedium::Event | TransitionMedium::Broadcast => "-)",
        };
        for p in others {
            let _ = writeln!(out, "  a{from}{arrow}a{}: {}", p.member, plain(over));
        }
        if others.is_empty() {
            let _ = writeln!(out, "  a{from}{arrow}a{from}: {}", plain(over));
        }
    }
    for (n, p) in step.parts.iter().enumerate() {
        let mut facts = Vec::new();
        if p.from != p.to {
            facts.push(format!("{} → {}", p.from, p.to));
        }
        if n == 0 {
            facts.extend(step.variables.iter().map(|v| v.replace("->", "→")));
        }
        if !facts.is_empty() {
            let _ = writeln!(out, "  Note over a{}: {}", p.member, plain(&facts.join(", ")));
        }
    }
}

/// Text without what Mermaid takes for signs of its own.
fn plain(text: &str) -> String {
    text.replace(';', ",").replace('#', "no. ").replace('\n', " ")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}
