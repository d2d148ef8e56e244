//! Goals along the flow of control and data: edge pairs and def-use pairs.

use hrdsl_ir::{
    Expr, Program,
    expr::Lvalue,
    ta::{Automaton, Edge, EdgeAssignment, FunctionId, FunctionStatement, Network},
};
use hrdsl_results::SuiteGoalId;
use hrdsl_ta::{GoalKind, ReachabilityGoal};

use crate::{
    covers::WitnessedGoal,
    named::{NamedGoal, declared, edge_name, is_generated},
};

/// Two edges of which the second leaves where the first leads to. If generated edges lie between, the last of these stands
/// for the first.
pub fn pairs(index: usize, automaton: &Automaton) -> Vec<NamedGoal> {
    let all = declared(automaton);
    let mut named = Vec::new();
    for (i, first) in &all {
        let lasts = last_edges(automaton, *first);
        for (j, second) in &all {
            let from = automaton.edges[*second].from;
            let firsts: Vec<usize> =
                lasts.iter().copied().filter(|last| automaton.edges[*last].to == from).collect();
            if firsts.is_empty() {
                continue;
            }
            let goal = |first: &usize| ReachabilityGoal {
                what: GoalKind::Pair { automaton: index, first: *first, second: *second },
                settled: false,
            };
            named.push(NamedGoal {
                id: SuiteGoalId::EdgePair(format!(
                    "{}: {}, {}",
                    automaton.name,
                    edge_name(automaton, *i, *first),
                    edge_name(automaton, *j, *second)
                )),
                alternatives: firsts.iter().map(goal).collect(),
                shown: firsts.iter().map(|f| WitnessedGoal::Pair(index, *f, *second)).collect(),
                monitor: None,
            });
        }
    }
    named
}

/// The edges after which the automaton is in a declared location again.
fn last_edges(automaton: &Automaton, edge: usize) -> Vec<usize> {
    let (mut open, mut seen, mut last) = (vec![edge], vec![edge], Vec::new());
    while let Some(edge) = open.pop() {
        let to = automaton.edges[edge].to;
        if !is_generated(&automaton.locations[usize::from(to.0)].name) {
            last.push(edge);
            continue;
        }
        for (next, _) in automaton.edges.iter().enumerate().filter(|(_, e)| e.from == to) {
            if !seen.contains(&next) {
                seen.push(next);
                open.push(next);
            }
        }
    }
    last.sort_unstable();
    last
}

/// An edge with what it defines and reads, as slots of the network.
struct EdgeDataFlow {
    automaton: usize,
    edge: usize,
    name: String,
    defines: Vec<usize>,
    reads: Vec<usize>,
}

/// Each definition of a variable with each edge that may read it: the initial value is a definition, too.
pub fn uses(program: &Program, network: &Network) -> Vec<NamedGoal> {
    let names = hrdsl_ta::slot_names(program, network);
    let traffic = traffic(program, network);
    let mut named = Vec::new();
    for (slot, name) in names.iter().enumerate().filter(|(_, n)| !is_generated(n)) {
        let users: Vec<&EdgeDataFlow> = traffic.iter().filter(|t| t.reads.contains(&slot)).collect();
        let setters = traffic.iter().filter(|t| t.defines.contains(&slot)).map(Some);
        for setter in std::iter::once(None).chain(setters) {
            let from = setter.map_or("its first value".to_owned(), |t| format!("set by {}", t.name));
            for user in &users {
                let what = GoalKind::Use {
                    slot,
                    definition: setter.map(|t| (t.automaton, t.edge)),
                    user: (user.automaton, user.edge),
                };
                let id = SuiteGoalId::DefUsePair(format!("{name}: {from}, read by {}", user.name));
                named.push(NamedGoal::one(id, what, false, WitnessedGoal::Nothing));
            }
        }
    }
    named
}

fn traffic(program: &Program, network: &Network) -> Vec<EdgeDataFlow> {
    let shared = program.shared.len();
    let mut base = shared;
    let mut all = Vec::new();
    for (index, id) in network.automata.iter().enumerate() {
        let automaton = &program.automata[usize::from(id.0)];
        let own = automaton.vars.len();
        // What a slot of the automaton is in the network; binders are nothing.
        let to_network = |slot: usize| match slot {
            s if s < shared => Some(s),
            s if s < shared + own => Some(base + s - shared),
            _ => None,
        };
        for (number, edge) in declared(automaton) {
            let (mut defines, mut reads) = (Vec::new(), Vec::new());
            let mut flow =
                DataFlowCollector { program, defines: &mut defines, reads: &mut reads, open: Vec::new() };
            flow.edge(&automaton.edges[edge]);
            let network_slots = |slots: Vec<usize>| {
                let mut slots: Vec<usize> = slots.into_iter().filter_map(&to_network).collect();
                slots.sort_unstable();
                slots.dedup();
                slots
            };
            all.push(EdgeDataFlow {
                automaton: index,
                edge,
                name: format!("{}: {}", automaton.name, edge_name(automaton, number, edge)),
                defines: network_slots(defines),
                reads: network_slots(reads),
            });
        }
        base += own;
    }
    all
}

/// Collects what an edge may define and read, through the functions that it calls.
struct DataFlowCollector<'a> {
    program: &'a Program,
    defines: &'a mut Vec<usize>,
    reads: &'a mut Vec<usize>,
    /// The functions that are being looked at.
    open: Vec<FunctionId>,
}

impl DataFlowCollector<'_> {
    fn edge(&mut self, edge: &Edge) {
        edge.guard.iter().for_each(|e| self.read(e));
        for c in &edge.clock_guard {
            c.bound.terms.iter().for_each(|t| self.read(&t.value));
        }
        edge.sync.given().iter().for_each(|e| self.read(e));
        for update in &edge.updates {
            match update {
                EdgeAssignment::Assign { place, value } => {
                    self.read(value);
                    self.define(place);
                }
                EdgeAssignment::Reset { to, .. } => to.terms.iter().for_each(|t| self.read(&t.value)),
                EdgeAssignment::Call { function, args } => {
                    args.iter().for_each(|e| self.read(e));
                    self.call(*function);
                }
            }
        }
    }

    fn define(&mut self, place: &Lvalue) {
        let mut slots = Vec::new();
        let bare = Lvalue { slot: place.slot, indices: place.indices.iter().map(constant_index).collect() };
        bare.each_var(&mut |slot| slots.push(usize::from(slot)));
        self.defines.extend(slots);
        place.indices.iter().for_each(|i| self.read(&i.at));
    }

    fn read(&mut self, e: &Expr) {
        let mut slots = Vec::new();
        e.each_var(&mut |slot| slots.push(usize::from(slot)));
        self.reads.extend(slots);
        let mut called = Vec::new();
        calls(e, &mut called);
        called.into_iter().for_each(|f| self.call(f));
    }

    /// What the body does to variables that are not its own. Its locals have slots beyond those of its owner.
    fn call(&mut self, id: FunctionId) {
        let Some(function) = self.program.functions.get(usize::from(id.0)) else { return };
        if self.open.contains(&id) {
            return;
        }
        self.open.push(id);
        let owned = function.owner.and_then(|a| self.program.automata.get(usize::from(a.0)));
        let visible = self.program.shared.len() + owned.map_or(0, |a| a.vars.len());
        let (mut defines, mut reads) = (Vec::new(), Vec::new());
        let mut inner = DataFlowCollector {
            program: self.program,
            defines: &mut defines,
            reads: &mut reads,
            open: self.open.clone(),
        };
        inner.statements(&function.body);
        self.defines.extend(defines.into_iter().filter(|s| *s < visible));
        self.reads.extend(reads.into_iter().filter(|s| *s < visible));
        self.open.pop();
    }

    fn statements(&mut self, body: &[FunctionStatement]) {
        for statement in body {
            match statement {
                FunctionStatement::Assign { place, value } => {
                    self.read(value);
                    self.define(place);
                }
                FunctionStatement::Call { function, args } => {
                    args.iter().for_each(|e| self.read(e));
                    self.call(*function);
                }
                FunctionStatement::If { condition, then, otherwise } => {
                    self.read(condition);
                    self.statements(then);
                    self.statements(otherwise);
                }
                FunctionStatement::While { condition, body } => {
                    self.read(condition);
                    self.statements(body);
                }
                FunctionStatement::For { lo, hi, body, .. } => {
                    self.read(lo);
                    self.read(hi);
                    self.statements(body);
                }
                FunctionStatement::Return(value) => value.iter().for_each(|e| self.read(e)),
            }
        }
    }
}

/// The same index without what it reads: only which elements there are counts.
fn constant_index(index: &hrdsl_ir::expr::ArrayIndex) -> hrdsl_ir::expr::ArrayIndex {
    hrdsl_ir::expr::ArrayIndex { at: Expr::int(0), count: index.count, stride: index.stride }
}

fn calls(e: &Expr, out: &mut Vec<FunctionId>) {
    match e {
        Expr::Const(_) | Expr::Var(_) => {}
        Expr::Unary(_, a) => calls(a, out),
        Expr::Binary(_, a, b) => {
            calls(a, out);
            calls(b, out);
        }
        Expr::If(c, a, b) => {
            calls(c, out);
            calls(a, out);
            calls(b, out);
        }
        Expr::Call(_, args) => args.iter().for_each(|a| calls(a, out)),
        Expr::List(items, rest) => {
            items.iter().for_each(|a| calls(a, out));
            rest.iter().for_each(|a| calls(a, out));
        }
        Expr::Element(place) => place.indices.iter().for_each(|i| calls(&i.at, out)),
        Expr::Apply(function, args) => {
            out.push(*function);
            args.iter().for_each(|a| calls(a, out));
        }
    }
}
