//! UPPAAL's models: the XML of versions 4.1 and 5, with the document type `flat-1_6`, and its queries.
//!
//! # Steps
//! 1. `mod`: what the network uses, the unit of time, channels, shared declarations
//! 2. `slots`, `expr`: variables and expressions
//! 3. `function`: functions, each after those that it calls
//! 4. `automaton`: one template for each automaton, laid out in columns
//! 5. `query`: the queries of the network
//!
//! Events, stimuli and broadcast channels are `broadcast chan`, binary synchronisations are `chan`, each with an array for its
//! arguments. [`export`] does it all.

mod automaton;
mod expr;
mod function;
mod query;
mod slots;

use hrdsl_ir::{
    Enumeration, EventId, Expr, Nanos, Program, Span, Type,
    ta::{
        Automaton, AutomatonId, AutomatonVar, ChannelId, ChannelKind, ChannelParticipant, FunctionId,
        FunctionStatement, Network, Query, QueryFormula, QueryKind, QueryMeasure, SyncLabel,
    },
};
use hrdsl_source::SourceFiles;
use indexmap::{IndexMap, IndexSet};

use self::{
    expr::UppaalExprContext,
    slots::{UppaalNames, UppaalSlotTable},
};
use crate::exchange::{obstacle::ExportObstacle, time};

/// The texts of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UppaalDocument {
    /// The model in XML, with its queries.
    pub text: String,
    /// The queries alone, as a `.q` file has them.
    pub queries: String,
    /// Queries that were left out; the model means the same without them.
    pub left_out: Vec<ExportObstacle>,
}

/// A channel of UPPAAL, or an array of them.
#[derive(Clone, Debug)]
struct UppaalChannel {
    name: String,
    params: Vec<AutomatonVar>,
    broadcast: bool,
    urgent: bool,
}

/// How an automaton's part in a multi-way channel is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MultiWayRole {
    Offer,
    Accept,
    /// It is alone in it.
    Alone,
}

/// All that is known while a network is exported.
struct UppaalExporter<'p> {
    program: &'p Program,
    files: &'p SourceFiles,
    network: &'p Network,
    faults: Vec<ExportObstacle>,
    names: UppaalNames,
    /// What all automata know.
    global: UppaalExprContext,
    events: IndexMap<EventId, UppaalChannel>,
    channels: IndexMap<ChannelId, UppaalChannel>,
    /// Names of templates, by their place in the network.
    processes: Vec<String>,
    /// What automata know, by their place in the network.
    contexts: Vec<UppaalExprContext>,
    /// Names of locations, by automaton in the network.
    locations: Vec<Vec<String>>,
}

/// Exports a network, an index into the program's networks, and the queries about it.
///
/// # Errors
/// Everything that UPPAAL's language cannot say.
pub fn export(program: &Program, network: usize) -> Result<UppaalDocument, Vec<ExportObstacle>> {
    export_with(program, network, &SourceFiles::default())
}

/// As [`export`], with what comments of the scenario's files keep of a model: the rates of locations (`// exponentialrate 2`).
///
/// # Errors
/// As [`export`].
pub fn export_with(
    program: &Program,
    network: usize,
    files: &SourceFiles,
) -> Result<UppaalDocument, Vec<ExportObstacle>> {
    let Some(chosen) = program.networks.get(network) else {
        let message = "there is no such network".to_owned();
        return Err(vec![ExportObstacle { origin: Span::default(), message }]);
    };
    let queries: Vec<&Query> =
        program.queries.iter().filter(|q| usize::from(q.network.0) == network).collect();
    let mut exporter = UppaalExporter::new(program, chosen, files);
    exporter.global.unit = time::unit(program, &exporter.automata().collect::<Vec<_>>());
    let declarations = exporter.declarations();
    let mut functions = exporter.shared_functions(&queries);
    let templates: Vec<String> = (0..chosen.automata.len()).map(|at| exporter.template(at)).collect();
    let (asked, left_out) = exporter.queries(&queries);
    if !exporter.faults.is_empty() {
        let mut faults = exporter.faults;
        faults.sort_by_key(|f| (f.origin.file.0, f.origin.start));
        faults.dedup();
        return Err(faults);
    }
    if !functions.is_empty() {
        functions.insert(0, '\n');
    }
    let mut text = String::from(HEADER);
    text += &element("declaration", &(declarations + &functions));
    templates.iter().for_each(|t| text += t);
    text += &element("system", &format!("system {};\n", exporter.processes.join(", ")));
    text += "  <queries>\n";
    for (formula, comment) in &asked {
        let (formula, comment) = (escaped(formula), escaped(comment));
        text += &format!("    <query>\n      <formula>{formula}</formula>\n");
        text += &format!("      <comment>{comment}</comment>\n    </query>\n");
    }
    text += "  </queries>\n</nta>\n";
    let queries = asked.iter().map(|(f, c)| format!("/*\n{}\n*/\n{f}\n\n", c.replace("*/", "* /"))).collect();
    Ok(UppaalDocument { text, queries, left_out })
}

const HEADER: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
    <!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.6//EN' \
    'http://www.it.uu.se/research/group/darts/uppaal/flat-1_6.dtd'>\n<nta>\n";

fn element(name: &str, text: &str) -> String {
    format!("  <{name}>{}</{name}>\n", escaped(text))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

impl<'p> UppaalExporter<'p> {
    fn new(program: &'p Program, network: &'p Network, files: &'p SourceFiles) -> Self {
        let mut names = UppaalNames::default();
        let automata = network.automata.iter().map(|id| &program.automata[usize::from(id.0)]);
        // Processes keep their names before all others: reports speak of them.
        let processes = automata.map(|a| names.fresh(&a.name)).collect();
        let none = || vec![None; program.functions.len()];
        let of = |v: &AutomatonVar| v.enumeration;
        let global = UppaalExprContext {
            functions: none(),
            results: program.functions.iter().map(|f| f.result.as_ref().and_then(of)).collect(),
            params: program.functions.iter().map(|f| f.params.iter().map(of).collect()).collect(),
            ..UppaalExprContext::default()
        };
        Self {
            program,
            files,
            network,
            faults: Vec::new(),
            names,
            global,
            events: IndexMap::new(),
            channels: IndexMap::new(),
            processes,
            contexts: Vec::new(),
            locations: Vec::new(),
        }
    }

    fn automaton(&self, at: usize) -> &'p Automaton {
        &self.program.automata[usize::from(self.network.automata[at].0)]
    }

    fn automata(&self) -> impl Iterator<Item = &'p Automaton> + use<'p> {
        let program = self.program;
        self.network.automata.iter().map(|id| &program.automata[usize::from(id.0)])
    }

    fn fault(&mut self, span: Span, message: impl Into<String>) {
        self.faults.push(ExportObstacle { origin: span, message: message.into() });
    }

    /// Keeps what was said; notes what could not be.
    fn said<T: Default>(&mut self, what: Result<T, String>, span: Span, place: &str) -> T {
        what.unwrap_or_else(|why| {
            self.fault(span, format!("{place}: UPPAAL cannot say {why}"));
            T::default()
        })
    }

    // ── What all automata know ──

    fn declarations(&mut self) -> String {
        let mut text =
            format!("// The network {} of the scenario {}.\n", self.network.name, self.program.name);
        text += &format!("// One unit of time is {}.\n", duration(self.global.unit));
        text += &self.enumerations();
        let mut slots = UppaalSlotTable::default();
        let lines = slots.declare(&self.program.shared, &mut self.names);
        self.global.slots = slots;
        lines.iter().for_each(|line| text += &format!("{line}\n"));
        for clock in &self.program.clocks {
            let name = self.names.fresh(clock);
            text += &format!("clock {name};\n");
            self.global.clocks.push(name);
        }
        self.media();
        for channel in self.events.values().chain(self.channels.values()) {
            let sizes: String = channel.params.iter().map(|p| format!("[{}]", p.hi - p.lo + 1)).collect();
            let urgent = if channel.urgent { "urgent " } else { "" };
            let broadcast = if channel.broadcast { "broadcast " } else { "" };
            text += &format!("{urgent}{broadcast}chan {}{sizes};\n", channel.name);
        }
        text
    }

    /// A constant for each value of each enumeration.
    fn enumerations(&mut self) -> String {
        let mut all: Vec<Enumeration> = Vec::new();
        let program = self.program;
        let functions =
            program.functions.iter().flat_map(|f| f.params.iter().chain(&f.locals).chain(&f.result));
        let own = self.automata().flat_map(|a| a.vars.iter().chain(a.edges.iter().flat_map(|e| &e.selects)));
        let channels = program.channels.iter().flat_map(|c| &c.params);
        for var in program.shared.iter().chain(functions).chain(own).chain(channels) {
            all.extend(var.enumeration);
        }
        for event in &program.events {
            all.extend(event.params.iter().filter_map(|p| match p.ty {
                Type::Enum(e) => Some(e),
                Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Text | Type::List(_) => None,
            }));
        }
        let mut text = String::new();
        for e in all {
            if self.global.symbols.iter().any(|(known, _)| *known == e) {
                continue;
            }
            text += &format!("// {}\n", e.name());
            let mut names = Vec::new();
            for (n, symbol) in e.values().iter().enumerate() {
                let name = self.names.fresh(symbol.name());
                text += &format!("const int {name} = {n};\n");
                names.push(name);
            }
            self.global.symbols.push((e, names));
        }
        text
    }

    // ── Channels ──

    /// Finds the events and channels that the network uses.
    fn media(&mut self) {
        let syncs: Vec<(&'p SyncLabel, Span)> =
            self.automata().flat_map(|a| a.edges.iter().map(|e| (&e.sync, e.origin))).collect();
        for (sync, span) in syncs {
            if let Some(event) = sync.event() {
                self.event(event, span);
            }
            if let Some(channel) = sync.channel() {
                self.channel(channel);
            }
        }
    }

    fn event(&mut self, id: EventId, span: Span) {
        if self.events.contains_key(&id) {
            return;
        }
        let event = self.program.event(id);
        let mut params = Vec::new();
        for param in &event.params {
            let (lo, hi, is_bool, enumeration) = match param.ty {
                Type::Bool => (0, 1, true, None),
                Type::Int { lo, hi } if hi.checked_sub(lo).is_some_and(|n| n < 10_000) => {
                    (lo, hi, false, None)
                }
                Type::Enum(e) => (0, e.values().len() as i64 - 1, false, Some(e)),
                Type::Int { .. } | Type::Float(_) | Type::Text | Type::List(_) => {
                    let (event, param) = (&event.name, &param.name);
                    self.fault(span, format!("the event `{event}`: its argument `{param}` has no few values that an array of channels could have"));
                    (0, 0, false, None)
                }
            };
            params.push(AutomatonVar { name: param.name.clone(), lo, hi, init: lo, is_bool, enumeration });
        }
        let name = self.names.fresh(&event.name);
        self.events.insert(id, UppaalChannel { name, params, broadcast: true, urgent: false });
    }

    fn channel(&mut self, id: ChannelId) {
        if self.channels.contains_key(&id) {
            return;
        }
        let channel = &self.program.channels[usize::from(id.0)];
        let broadcast = match &channel.kind {
            ChannelKind::Binary => false,
            ChannelKind::Broadcast => true,
            ChannelKind::MultiWay(participants) => match self.multi_way(participants) {
                Some(broadcast) => broadcast,
                None => {
                    let message = format!(
                        "the multi-way channel `{}`: UPPAAL has binary synchronisations of two that must take part, \
                         and broadcasts of one that must, before others that may",
                        channel.name
                    );
                    self.fault(channel.origin, message);
                    false
                }
            },
        };
        let name = self.names.fresh(&channel.name);
        let (params, urgent) = (channel.params.clone(), channel.urgent);
        self.channels.insert(id, UppaalChannel { name, params, broadcast, urgent });
    }

    fn present(&self, participants: &[ChannelParticipant]) -> Vec<ChannelParticipant> {
        participants.iter().filter(|p| self.network.automata.contains(&p.automaton)).copied().collect()
    }

    /// Whether a multi-way channel is a broadcast; `None`: it is neither that nor a binary synchronisation.
    fn multi_way(&self, participants: &[ChannelParticipant]) -> Option<bool> {
        let present = self.present(participants);
        match present.as_slice() {
            [one] if !one.optional => Some(false),
            [a, b] if !a.optional && !b.optional => Some(false),
            [first, rest @ ..] if !first.optional && rest.iter().all(|p| p.optional) => Some(true),
            _ => None,
        }
    }

    fn part(&self, id: ChannelId, automaton: AutomatonId) -> MultiWayRole {
        let ChannelKind::MultiWay(participants) = &self.program.channels[usize::from(id.0)].kind else {
            return MultiWayRole::Alone;
        };
        match self.present(participants).as_slice() {
            [one] if !one.optional => MultiWayRole::Alone,
            [first, ..] if first.automaton == automaton => MultiWayRole::Offer,
            _ => MultiWayRole::Accept,
        }
    }

    // ── Functions ──

    fn shared_functions(&mut self, queries: &[&Query]) -> String {
        let mut called = IndexSet::new();
        let mut note = |f: FunctionId| {
            called.insert(f);
        };
        let program = self.program;
        self.automata().for_each(|a| function::called_by(a, &mut note));
        queries.iter().for_each(|q| called_in(&q.ask, &mut note));
        let mut order = IndexSet::new();
        for id in called {
            if let Err(fault) = function::order(program, id, &mut Vec::new(), &mut order) {
                self.faults.push(fault);
            }
        }
        let shared: Vec<FunctionId> =
            order.into_iter().filter(|id| program.functions[usize::from(id.0)].owner.is_none()).collect();
        let mut context = std::mem::take(&mut self.global);
        let mut names = std::mem::take(&mut self.names);
        let text = self.functions(&shared, &mut context, &mut names);
        (self.global, self.names) = (context, names);
        text
    }
}

/// `50 ms`
fn duration(nanos: Nanos) -> String {
    let units = [(1_000_000_000, "s"), (1_000_000, "ms"), (1_000, "us")];
    let found = units.iter().find(|(n, _)| nanos % n == 0);
    found.map_or_else(|| format!("{nanos} ns"), |(n, unit)| format!("{} {unit}", nanos / n))
}

fn called_in(ask: &QueryKind, note: &mut dyn FnMut(FunctionId)) {
    fn each(formula: &QueryFormula, note: &mut dyn FnMut(FunctionId)) {
        match formula {
            QueryFormula::Data(e) => function::in_expr(e, note),
            QueryFormula::Clock(c) => c.bound.terms.iter().for_each(|t| function::in_expr(&t.value, note)),
            QueryFormula::Not(f) => each(f, note),
            QueryFormula::And(all) | QueryFormula::Or(all) => all.iter().for_each(|f| each(f, note)),
            QueryFormula::At { .. } | QueryFormula::Deadlock => {}
        }
    }
    ask.formulas().into_iter().for_each(|f| each(f, note));
    if let QueryKind::Sup { of, .. } | QueryKind::Inf { of, .. } = ask {
        for measure in of {
            if let QueryMeasure::Data(e) = measure {
                function::in_expr(e, note);
            }
        }
    }
}

/// What an expression or statement needs of the slots of a function: used by both halves of this module.
fn all_exprs<'s>(statement: &'s FunctionStatement, note: &mut dyn FnMut(&'s Expr)) {
    match statement {
        FunctionStatement::Assign { place, value } => {
            place.indices.iter().for_each(|i| note(&i.at));
            note(value);
        }
        FunctionStatement::Call { args, .. } => args.iter().for_each(note),
        FunctionStatement::If { condition, then, otherwise } => {
            note(condition);
            then.iter().chain(otherwise).for_each(|s| all_exprs(s, note));
        }
        FunctionStatement::While { condition, body } => {
            note(condition);
            body.iter().for_each(|s| all_exprs(s, note));
        }
        FunctionStatement::For { lo, hi, body, .. } => {
            note(lo);
            note(hi);
            body.iter().for_each(|s| all_exprs(s, note));
        }
        FunctionStatement::Return(value) => value.iter().for_each(note),
    }
}
