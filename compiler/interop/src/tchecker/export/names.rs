//! TChecker's names: one scope for all variables, letters, digits and `_`.

use hrdsl_ir::{
    Enumeration, Program,
    ta::{Automaton, AutomatonVar, Network},
};

/// Words that TChecker keeps for itself.
const RESERVED: [&str; 17] = [
    "clock", "edge", "event", "int", "location", "process", "sync", "system", "if", "then", "else", "end",
    "while", "do", "local", "nop", "provided",
];

/// A bounded integer, or an array of them.
pub struct BoundedIntArray {
    pub name: String,
    pub lo: i64,
    pub hi: i64,
    pub inits: Vec<i64>,
    /// Of which its elements are, if they are of one.
    pub enumeration: Option<Enumeration>,
}

pub struct TcheckerNames {
    pub system: String,
    pub processes: Vec<String>,
    /// By process.
    pub locations: Vec<Vec<String>>,
    /// The shared clocks, then each automaton's.
    pub clocks: Vec<String>,
    /// Where each automaton's own clocks start.
    pub first_clock: Vec<usize>,
    pub shared_clocks: usize,
    pub ints: Vec<BoundedIntArray>,
    /// Of each of the network's slots (the shared variables, then each automaton's): its integer, and which element.
    pub slots: Vec<(usize, usize)>,
    /// Where each automaton's own slots start.
    pub first_slot: Vec<usize>,
    pub shared_slots: usize,
    used: Vec<String>,
}

impl TcheckerNames {
    pub fn new(program: &Program, network: &Network, automata: &[&Automaton]) -> Self {
        let mut names = Self {
            system: String::new(),
            processes: Vec::new(),
            locations: Vec::new(),
            clocks: Vec::new(),
            first_clock: Vec::new(),
            shared_clocks: program.clocks.len(),
            ints: Vec::new(),
            slots: Vec::new(),
            first_slot: Vec::new(),
            shared_slots: program.shared.len(),
            used: RESERVED.iter().map(|w| (*w).to_owned()).collect(),
        };
        names.system = names.fresh(&network.name);
        for clock in &program.clocks {
            let name = names.fresh(clock);
            names.clocks.push(name);
        }
        names.variables(&program.shared, "");
        for a in automata {
            let process = names.fresh(&a.name);
            names.first_clock.push(names.clocks.len());
            names.first_slot.push(names.slots.len());
            for clock in &a.clocks {
                let name = names.fresh(&format!("{process}_{clock}"));
                names.clocks.push(name);
            }
            names.variables(&a.vars, &format!("{process}_"));
            let mut own: Vec<String> = Vec::new();
            for l in &a.locations {
                let mut name = clean(&l.name);
                while own.contains(&name) || RESERVED.contains(&name.as_str()) {
                    name.push('_');
                }
                own.push(name);
            }
            names.locations.push(own);
            names.processes.push(process);
        }
        names
    }

    /// Variables whose names differ in an index only are one array.
    fn variables(&mut self, vars: &[AutomatonVar], prefix: &str) {
        let mut last: Option<(String, i64, i64, Option<Enumeration>)> = None;
        for v in vars {
            let array = v.name.contains('[').then(|| {
                let base = v.name.split('[').next().unwrap_or_default();
                let tail = v.name.rsplit(']').next().unwrap_or_default();
                (format!("{base}{tail}"), v.lo, v.hi, v.enumeration)
            });
            match (&array, self.ints.last_mut()) {
                (Some(_), Some(int)) if array == last => int.inits.push(v.init),
                (Some(_) | None, _) => {
                    let wanted = array.as_ref().map_or(v.name.as_str(), |(base, ..)| base);
                    let name = self.fresh(&format!("{prefix}{wanted}"));
                    let (lo, hi, enumeration) = (v.lo, v.hi, v.enumeration);
                    self.ints.push(BoundedIntArray { name, lo, hi, inits: vec![v.init], enumeration });
                }
            }
            let int = self.ints.len() - 1;
            self.slots.push((int, self.ints[int].inits.len() - 1));
            last = array;
        }
    }

    /// A name that nothing has yet.
    pub fn fresh(&mut self, wanted: &str) -> String {
        let mut name = clean(wanted);
        while self.used.contains(&name) {
            name.push('_');
        }
        self.used.push(name.clone());
        name
    }
}

fn clean(name: &str) -> String {
    let mut out: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !out.starts_with(|c: char| c.is_ascii_alphabetic()) || out.to_ascii_lowercase().starts_with("tck") {
        out.insert_str(0, "x_");
    }
    out
}
