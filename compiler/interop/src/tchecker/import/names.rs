//! What everything is called in the scenario: TChecker's names may have dots, and may be our keywords.

use hrdsl_syntax::token::KEYWORDS;
use indexmap::IndexSet;

use super::ast::{ByteOffset, TcheckerModel};
use crate::exchange::name::{clean, unused};

/// Words with a meaning of their own in expressions.
const TAKEN: [&str; 6] = ["min", "max", "abs", "norm", "deadlock", "int"];

/// The scenario's names, by the places of what they name in the model.
pub struct TcheckerScenarioNames {
    pub scenario: String,
    pub network: String,
    pub processes: Vec<String>,
    /// By process.
    pub locations: Vec<Vec<String>>,
    /// Each element of each clock.
    pub clocks: Vec<Vec<String>>,
    pub ints: Vec<String>,
    pub channels: Vec<String>,
    /// Everything that has another name: what it is, both names, the place.
    pub changed: Vec<(&'static str, String, String, ByteOffset)>,
    used: IndexSet<String>,
}

impl TcheckerScenarioNames {
    pub fn new(model: &TcheckerModel) -> Self {
        let mut names = Self {
            scenario: ident(&model.name),
            network: String::new(),
            processes: Vec::new(),
            locations: Vec::new(),
            clocks: Vec::new(),
            ints: Vec::new(),
            channels: Vec::new(),
            changed: Vec::new(),
            used: IndexSet::new(),
        };
        for p in &model.processes {
            let name = names.give("process", &p.name, p.at);
            names.processes.push(name);
        }
        for int in &model.ints {
            let name = names.give("integer", &int.of.name, int.of.at);
            names.ints.push(name);
        }
        for clock in &model.clocks {
            let elements = (0..clock.size).map(|i| match clock.size {
                1 => names.give("clock", &clock.name, clock.at),
                _ => names.fresh(&format!("{}_{i}", clock.name)),
            });
            let elements = elements.collect();
            names.clocks.push(elements);
        }
        for sync in &model.syncs {
            let mut events: Vec<&str> = sync.participants.iter().map(|p| p.event.as_str()).collect();
            events.dedup();
            let name = names.fresh(&events.join("_"));
            names.channels.push(name);
        }
        for p in &model.processes {
            let mut used = names.used.clone();
            let mut own = Vec::new();
            for l in &p.locations {
                let name = unused(ident(&l.name), &used);
                names.note("location", &l.name, &name, l.at);
                used.insert(name.clone());
                own.push(name);
            }
            names.locations.push(own);
        }
        names.network = names.fresh("all");
        names
    }

    /// A new name for the whole scenario.
    pub fn fresh(&mut self, wanted: &str) -> String {
        let name = unused(ident(wanted), &self.used);
        self.used.insert(name.clone());
        name
    }

    fn give(&mut self, what: &'static str, old: &str, at: ByteOffset) -> String {
        let name = self.fresh(old);
        self.note(what, old, &name, at);
        name
    }

    fn note(&mut self, what: &'static str, old: &str, new: &str, at: ByteOffset) {
        if old != new {
            self.changed.push((what, old.to_owned(), new.to_owned(), at));
        }
    }
}

/// The same as a name of the language, and no word of it.
fn ident(name: &str) -> String {
    let mut out = clean(name);
    if KEYWORDS.iter().any(|k| k.word == out) || TAKEN.contains(&out.as_str()) {
        out.push('_');
    }
    out
}
