//! The text of the scenario.

use hrdsl_source::Span;

use super::{
    ast::{UppaalDeclaration, UppaalExpr, UppaalExprKind, UppaalInstance, UppaalQuery},
    fault::{UppaalFault, fault},
    queries,
    scope::{ChanSym, IndexRange, NameOwner},
    template,
    translation::UppaalTranslation,
};
use crate::exchange::note::NoteSeverity;

impl UppaalTranslation<'_> {
    /// Writes everything; what is in the way is among the faults then.
    pub fn write(&mut self, name: &str, file: &str) -> String {
        let model = self.model;
        let global = template::declarations(&model.declaration, &mut self.faults);
        let mut system = Vec::new();
        for piece in &model.system {
            system.extend(template::declarations(piece, &mut self.faults));
        }
        for template in &model.templates {
            let parsed = template::template(template, &mut self.faults);
            self.templates.push(parsed);
        }
        if !self.faults.is_empty() || !model.begins() {
            return String::new();
        }
        let scenario = self.names.unused(name, NameOwner::All);
        global.iter().for_each(|d| self.declare(d, false));
        system.iter().for_each(|d| self.declare(d, false));
        let network = self.names.unused("model", NameOwner::All);
        self.all_processes(&system);
        if !self.faults.is_empty() {
            return String::new();
        }
        let asked = self.all_queries(&network);
        self.write_bit_functions();
        self.text(&scenario, file, &network, &asked)
    }

    fn all_processes(&mut self, system: &[UppaalDeclaration]) {
        let mut instances: Vec<UppaalInstance> = Vec::new();
        let mut listed = None;
        for decl in system {
            match decl {
                UppaalDeclaration::Instance(instance) => instances.push(instance.clone()),
                UppaalDeclaration::System(names) => listed = Some(names.clone()),
                UppaalDeclaration::Vars(..)
                | UppaalDeclaration::Typedef(..)
                | UppaalDeclaration::Function(_)
                | UppaalDeclaration::Comment(_)
                | UppaalDeclaration::Idle(..) => {}
            }
        }
        let Some(listed) = listed else {
            let span = self.model.system.last().map_or_else(Span::default, super::lex::UppaalFragment::span);
            let message = "there is no line `system …;` that says what the system is made of: write it, with the names of templates or processes".to_owned();
            return self.faults.push(UppaalFault { span, message });
        };
        let mut plans = Vec::new();
        for (name, span) in &listed {
            match self.plans(name, *span, &instances) {
                Ok(made) => plans.extend(made.into_iter().map(|p| (p, *span))),
                Err(fault) => self.faults.push(fault),
            }
        }
        // All names first: what a process declares gives way to them.
        let names: Vec<String> = plans.iter().map(|(p, span)| self.automaton_name(p, *span)).collect();
        for ((plan, _), name) in plans.into_iter().zip(names) {
            let before = self.stopwatches.len();
            self.automaton(plan, name.clone());
            let own: Vec<&String> = self.processes.last().iter().flat_map(|p| &p.clocks).collect();
            for (clock, _) in self.stopwatches.iter_mut().skip(before) {
                if own.contains(&&*clock) {
                    *clock = format!("{name}.{clock}");
                }
            }
        }
        for (clock, span) in &self.stopwatches {
            if self.clock_uses.get(clock).is_some_and(|processes| processes.len() > 1) {
                let message = format!("`{clock}` is stopped by one process and belongs to others, too");
                self.faults.push(UppaalFault { span: *span, message });
            }
        }
    }

    // ── Queries ──

    fn all_queries(&mut self, network: &str) -> Vec<String> {
        self.in_query = true;
        let model = self.model;
        let mut out = Vec::new();
        for (i, query) in model.queries.iter().enumerate() {
            let made = queries::parse(&query.formula).and_then(|ask| self.ask(&ask));
            match made {
                Ok(ask) => {
                    let name = self.names.unused(&format!("q{}", i + 1), NameOwner::All);
                    let title = if query.comment.is_empty() {
                        String::new()
                    } else {
                        format!(" \"{}\"", escaped(&query.comment))
                    };
                    out.push(format!("query {name}{title} of {network} = {ask}"));
                }
                Err(fault) => {
                    let shown = one_line(&query.formula.text());
                    out.push(format!("// not carried over: {}\n//   {shown}", fault.message));
                    self.notes.push((
                        fault.span,
                        NoteSeverity::LeftOut,
                        format!("the query `{shown}`: {}", fault.message),
                    ));
                }
            }
        }
        self.in_query = false;
        out
    }

    fn ask(&mut self, ask: &UppaalQuery) -> Result<String, UppaalFault> {
        Ok(match ask {
            UppaalQuery::Possibly(f) => format!("E<> {}", self.formula(f)?.text),
            UppaalQuery::Invariantly(f) => format!("A[] {}", self.formula(f)?.text),
            UppaalQuery::PotentiallyAlways(f) => format!("E[] {}", self.run_formula(f)?),
            UppaalQuery::Eventually(f) => format!("A<> {}", self.run_formula(f)?),
            UppaalQuery::LeadsTo(f, g) => format!("{} --> {}", self.run_formula(f)?, self.run_formula(g)?),
            UppaalQuery::Sup(when, of) => self.bound_of("sup", when.as_ref(), of)?,
            UppaalQuery::Inf(when, of) => self.bound_of("inf", when.as_ref(), of)?,
        })
    }

    /// A formula about all of a run, in which a scenario does not ask for deadlocks.
    fn run_formula(&mut self, f: &UppaalExpr) -> Result<String, UppaalFault> {
        let mut deadlock = None;
        f.each(&mut |part| {
            if matches!(part.kind, UppaalExprKind::Deadlock) {
                deadlock.get_or_insert(part.span);
            }
        });
        if let Some(span) = deadlock {
            let message = "`deadlock` is asked for in `E<>`, `A[]`, `sup` and `inf` only, not along runs";
            return fault(span, message);
        }
        Ok(self.formula(f)?.text)
    }

    fn bound_of(
        &mut self,
        word: &str,
        when: Option<&UppaalExpr>,
        of: &[UppaalExpr],
    ) -> Result<String, UppaalFault> {
        let when = match when {
            Some(f) => format!("{{ {} }}", self.formula(f)?.text),
            None => String::new(),
        };
        let of =
            of.iter()
                .map(|e| {
                    if self.mentions_clock(e) {
                        self.clock(e)
                    } else {
                        self.expr(e).map(|e| e.into_int().text)
                    }
                })
                .collect::<Result<Vec<_>, _>>()?;
        Ok(format!("{word}{when}: {}", of.join(", ")))
    }

    // ── Text ──

    fn text(&self, scenario: &str, file: &str, network: &str, asked: &[String]) -> String {
        let mut text = format!("// From the UPPAAL model {}.\n", one_line(file));
        text += "// One unit of its time is one second here.\n";
        text += &format!("scenario {scenario}\n\n");
        let renamed =
            self.names.renamed.iter().map(|(_, old, new)| format!("// `{old}` is called `{new}`\n"));
        text.extend(renamed.collect::<indexmap::IndexSet<_>>());
        let arrays = self.arrays.values().filter(|(_, used)| *used).map(|(line, _)| line.clone());
        let said = |c: &ChanSym| self.channel_comments.get(&c.name).cloned().unwrap_or_default();
        let channels = self.channels.iter().map(|c| said(c) + &channel(c));
        section(&mut text, self.lines.iter().cloned().chain(arrays));
        section(&mut text, channels);
        self.functions.iter().for_each(|f| text += &format!("\n{f}\n"));
        for process in &self.processes {
            text += &format!("\n/// {}.\nautomaton {} {{\n", process.doc, process.name);
            if !process.clocks.is_empty() {
                for (clock, said) in &process.clock_comments {
                    let of = if process.clocks.len() == 1 { String::new() } else { format!("{clock}: ") };
                    text += &format!("// {of}{said}\n");
                }
                text += &format!("clock {}\n", process.clocks.join(", "));
            }
            let arrays = process.arrays.values().filter(|(_, used)| *used).map(|(line, _)| line.clone());
            section(&mut text, process.lines.iter().cloned().chain(arrays));
            process.functions.iter().for_each(|f| text += &format!("\n{f}\n"));
            section(&mut text, process.locations.iter().cloned());
            section(&mut text, process.edges.iter().cloned());
            text += "}\n";
        }
        let names: Vec<&str> = self.processes.iter().map(|p| p.name.as_str()).collect();
        text += &format!("\nnetwork {network} = {}\n", names.join(" | "));
        section(&mut text, asked.iter().cloned());
        text
    }
}

fn section(text: &mut String, lines: impl Iterator<Item = String>) {
    let lines: Vec<String> = lines.collect();
    if !lines.is_empty() {
        *text += &format!("\n{}\n", lines.join("\n"));
    }
}

fn channel(channel: &ChanSym) -> String {
    let index = |(i, d): (usize, &IndexRange)| {
        format!("{}: {}..{}", ["i", "j", "k"].get(i).unwrap_or(&"n"), d.lo, d.hi)
    };
    let mut text = format!("channel {}", channel.name);
    if channel.dims.len() > 3 {
        let params = channel.dims.iter().enumerate().map(|(i, d)| format!("i{i}: {}..{}", d.lo, d.hi));
        text += &format!("({})", params.collect::<Vec<_>>().join(", "));
    } else if !channel.dims.is_empty() {
        let params: Vec<String> = channel.dims.iter().enumerate().map(index).collect();
        text += &format!("({})", params.join(", "));
    }
    let words = [("urgent", channel.urgent), ("broadcast", channel.broadcast)];
    let words: Vec<&str> = words.iter().filter(|(_, on)| *on).map(|(w, _)| *w).collect();
    if words.is_empty() { text } else { format!("{text} : {}", words.join(" ")) }
}

fn escaped(text: &str) -> String {
    one_line(text).replace('\\', "\\\\").replace('"', "\\\"")
}

pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
