//! All that is known while a model is translated: what every step reads and adds to.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::{
    ast::UppaalBinaryOperator,
    fault::UppaalFault,
    known::{ClockEvent, EdgeCases},
    scope::{ChanSym, UppaalScenarioNames, UppaalScope},
    template::ParsedTemplate,
    xml::UppaalModel,
};
use crate::exchange::note::NoteSeverity;

/// A process: an automaton of the scenario.
#[derive(Debug)]
pub(crate) struct UppaalProcess {
    /// As the model calls it, with the values of what it ranges over.
    pub model_name: String,
    pub args: Vec<i64>,
    /// As the scenario calls it.
    pub name: String,
    /// Its parameters, and what it declares.
    pub scope: UppaalScope,
    /// Declarations of its constant arrays, and whether they are needed.
    pub arrays: IndexMap<String, (String, bool)>,
    pub clocks: Vec<String>,
    pub clock_comments: Vec<(String, String)>,
    pub lines: Vec<String>,
    pub functions: Vec<String>,
    pub locations: Vec<String>,
    pub edges: Vec<String>,
    pub doc: String,
}

/// All that is known while a model is translated.
pub(crate) struct UppaalTranslation<'m> {
    pub model: &'m UppaalModel,
    pub templates: Vec<ParsedTemplate>,
    pub faults: Vec<UppaalFault>,
    /// The names of declarations that are at fault.
    pub undeclared: BTreeSet<String>,
    pub notes: Vec<(Span, NoteSeverity, String)>,
    pub names: UppaalScenarioNames,
    pub global: UppaalScope,
    pub process: Option<UppaalScope>,
    pub locals: Vec<UppaalScope>,
    pub processes: Vec<UppaalProcess>,
    pub in_query: bool,
    /// The function whose declaration is being read: it is not known yet.
    pub declaring: Option<String>,
    /// How many functions are being written, one called by the other.
    pub writing: usize,
    /// The same of those that set clocks, and whose statements stand on the edge.
    pub inlining: usize,
    pub channels: Vec<ChanSym>,
    pub lines: Vec<String>,
    pub functions: Vec<String>,
    /// What is said of the declaration that comes next.
    pub said: Vec<String>,
    /// Comments before channels, by their names.
    pub channel_comments: BTreeMap<String, String>,
    /// Comments of clocks of the process.
    pub own_clock_comments: Vec<(String, String)>,
    /// The functions for operations on bits that are in the text, by what they do; written last.
    pub bit_functions: Vec<(UppaalBinaryOperator, String)>,
    /// The `meta` variables.
    pub metas: IndexSet<String>,
    /// Clocks that are stopped somewhere, as queries call them where they belong to a process, and where.
    pub stopwatches: Vec<(String, Span)>,
    /// In some location of the scenario a clock stands still.
    pub clocks_stand: bool,
    /// Those that stand where what is being written begins.
    pub standing: BTreeMap<String, i64>,
    /// What happens to clocks in what is being written, in order.
    pub clock_log: Vec<ClockEvent>,
    /// Which processes have to do with a clock.
    pub clock_uses: BTreeMap<String, BTreeSet<usize>>,
    /// What is decided of the edge that is being written.
    pub cases: Option<EdgeCases>,
    pub arrays: IndexMap<String, (String, bool)>,
    pub specialised: IndexMap<String, String>,
    pub own_clocks: Vec<String>,
    pub own_lines: Vec<String>,
    pub own_functions: Vec<String>,
    pub own_arrays: IndexMap<String, (String, bool)>,
    pub own_specialised: IndexMap<String, String>,
}

impl<'m> UppaalTranslation<'m> {
    pub fn new(model: &'m UppaalModel) -> Self {
        Self {
            model,
            templates: Vec::new(),
            faults: Vec::new(),
            undeclared: BTreeSet::new(),
            notes: Vec::new(),
            names: UppaalScenarioNames::default(),
            global: super::scope::built_in(),
            process: None,
            locals: Vec::new(),
            processes: Vec::new(),
            in_query: false,
            declaring: None,
            writing: 0,
            inlining: 0,
            channels: Vec::new(),
            lines: Vec::new(),
            functions: Vec::new(),
            said: Vec::new(),
            channel_comments: BTreeMap::new(),
            own_clock_comments: Vec::new(),
            bit_functions: Vec::new(),
            metas: IndexSet::new(),
            stopwatches: Vec::new(),
            clocks_stand: false,
            standing: BTreeMap::new(),
            clock_log: Vec::new(),
            clock_uses: BTreeMap::new(),
            cases: None,
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
