//! All that is known while a model is translated: what every step reads and adds to.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    fault::Fault,
    scope::{ChanSym, Names, Scope},
    template::ParsedTemplate,
    xml::Model,
};
use crate::exchange::note::Severity;

/// A process: an automaton of the scenario.
#[derive(Debug)]
pub(crate) struct Process {
    /// As the model calls it, with the values of what it ranges over.
    pub model_name: String,
    pub args: Vec<i64>,
    /// As the scenario calls it.
    pub name: String,
    /// Its parameters, and what it declares.
    pub scope: Scope,
    /// Declarations of its constant arrays, and whether they are needed.
    pub arrays: IndexMap<String, (String, bool)>,
    pub clocks: Vec<String>,
    pub lines: Vec<String>,
    pub functions: Vec<String>,
    pub locations: Vec<String>,
    pub edges: Vec<String>,
    pub doc: String,
}

/// All that is known while a model is translated.
pub(crate) struct Cx<'m> {
    pub model: &'m Model,
    pub templates: Vec<ParsedTemplate>,
    pub faults: Vec<Fault>,
    pub notes: Vec<(Span, Severity, String)>,
    pub names: Names,
    pub global: Scope,
    pub process: Option<Scope>,
    pub locals: Vec<Scope>,
    pub processes: Vec<Process>,
    pub in_query: bool,
    /// How many functions are being written, one called by the other.
    pub writing: usize,
    pub channels: Vec<ChanSym>,
    pub lines: Vec<String>,
    pub functions: Vec<String>,
    pub arrays: IndexMap<String, (String, bool)>,
    pub specialised: IndexMap<String, String>,
    pub own_clocks: Vec<String>,
    pub own_lines: Vec<String>,
    pub own_functions: Vec<String>,
    pub own_arrays: IndexMap<String, (String, bool)>,
    pub own_specialised: IndexMap<String, String>,
}

impl<'m> Cx<'m> {
    pub fn new(model: &'m Model) -> Self {
        Self {
            model,
            templates: Vec::new(),
            faults: Vec::new(),
            notes: Vec::new(),
            names: Names::default(),
            global: Scope::new(),
            process: None,
            locals: Vec::new(),
            processes: Vec::new(),
            in_query: false,
            writing: 0,
            channels: Vec::new(),
            lines: Vec::new(),
            functions: Vec::new(),
            arrays: IndexMap::new(),
            specialised: IndexMap::new(),
            own_clocks: Vec::new(),
            own_lines: Vec::new(),
            own_functions: Vec::new(),
            own_arrays: IndexMap::new(),
            own_specialised: IndexMap::new(),
        }
    }
}
