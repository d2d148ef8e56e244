//! What a suite by search asks for, as goals of the search: one name for each, and what a run must show.

use hrdsl_ir::{
    Expr, Program,
    coverage::{Condition, Cross},
    expr::Place,
    suite::SearchGoal,
    ta::{Ask, Automaton, AutomatonId, Edge, FunctionId, LocationId, Network, Statement, Sync, Update},
};
use hrdsl_ta::{Counter, Goal, GoalKind, StateFormula};

use super::covers::Shown;
use crate::prove;

/// A goal with its name for people. It is reached if one of the ways to it is.
pub struct Named {
    pub name: String,
    pub ways: Vec<Goal>,
    /// Each with the way of the same place.
    pub shown: Vec<Shown>,
    /// Index of the requirement whose observer it needs.
    pub monitor: Option<usize>,
}

impl Named {
    fn one(name: String, what: GoalKind, settled: bool, shown: Shown) -> Self {
        Self { name, ways: vec![Goal { what, settled }], shown: vec![shown], monitor: None }
    }
}

/// The goals of a suite, each once.
pub fn goals(program: &Program, network: &Network, asked: &[SearchGoal]) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    for goal in asked.iter().flat_map(|g| of(program, network, g)) {
        if all.iter().all(|known| known.name != goal.name) {
            all.push(goal);
        }
    }
    all
}

/// One counter for each coverage point, up to where its bins no longer tell numbers apart.
pub fn counters(program: &Program) -> Vec<Counter> {
    let cap = |point: &hrdsl_ir::coverage::Point| {
        point.bins.iter().map(|b| b.hi.map_or(b.lo, |hi| hi + 1).max(b.lo)).max().unwrap_or(0)
    };
    let counter =
        |point: &hrdsl_ir::coverage::Point| Counter { patterns: point.count.clone(), cap: cap(point) };
    program.coverage.points.iter().map(counter).collect()
}

fn of(program: &Program, network: &Network, goal: &SearchGoal) -> Vec<Named> {
    match goal {
        SearchGoal::Bins { cross } => {
            program.coverage.crosses.get(*cross as usize).map_or_else(Vec::new, |c| bins(program, c))
        }
        SearchGoal::Locations => each_automaton(program, network, locations),
        SearchGoal::Edges => each_automaton(program, network, edges),
        SearchGoal::Pairs => each_automaton(program, network, pairs),
        SearchGoal::Uses => uses(program, network),
        SearchGoal::Violation { monitor } => requirement(program, *monitor, "violation", Shown::Violation),
        SearchGoal::Trigger { monitor } => requirement(program, *monitor, "trigger", Shown::Trigger),
        SearchGoal::Query { query } => {
            let Some(query) = program.queries.get(usize::from(*query)) else { return Vec::new() };
            let Ask::Possibly(formula) = &query.ask else { return Vec::new() };
            let goal = prove::of_formula(formula);
            vec![Named::one(format!("query {}", query.name), goal.what, false, Shown::Nothing)]
        }
    }
}

fn requirement(program: &Program, monitor: u16, what: &str, shown: fn(usize) -> Shown) -> Vec<Named> {
    let at = usize::from(monitor);
    let Some(requirement) = program.monitors.get(at) else { return Vec::new() };
    let name = format!("{what} of {}", requirement.name);
    vec![Named { name, ways: Vec::new(), shown: vec![shown(at)], monitor: Some(at) }]
}

fn each_automaton(
    program: &Program,
    network: &Network,
    f: impl Fn(usize, &Automaton) -> Vec<Named>,
) -> Vec<Named> {
    let of = |(index, id): (usize, &AutomatonId)| f(index, &program.automata[id.0 as usize]);
    network.automata.iter().enumerate().flat_map(of).collect()
}

fn locations(index: usize, automaton: &Automaton) -> Vec<Named> {
    let ids = (0u16..).map(LocationId).zip(&automaton.locations);
    let named = ids.filter(|(_, l)| !is_generated(&l.name)).map(|(location, l)| {
        let what = GoalKind::Location { automaton: index, location };
        let name = format!("location {}.{}", automaton.name, l.name);
        Named::one(name, what, false, Shown::Location(index, location))
    });
    named.collect()
}

fn edges(index: usize, automaton: &Automaton) -> Vec<Named> {
    let named = declared(automaton).into_iter().map(|(number, edge)| {
        let what = GoalKind::Edge { automaton: index, edge };
        let name = format!("edge {}: {}", automaton.name, edge_name(automaton, number, edge));
        Named::one(name, what, false, Shown::Edge(index, edge))
    });
    named.collect()
}

/// Two edges of which the second leaves where the first leads to. If generated edges lie between, the last of these stands
/// for the first.
fn pairs(index: usize, automaton: &Automaton) -> Vec<Named> {
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
            let way = |first: &usize| Goal {
                what: GoalKind::Pair { automaton: index, first: *first, second: *second },
                settled: false,
            };
            named.push(Named {
                name: format!(
                    "pair {}: {}, {}",
                    automaton.name,
                    edge_name(automaton, *i, *first),
                    edge_name(automaton, *j, *second)
                ),
                ways: firsts.iter().map(way).collect(),
                shown: firsts.iter().map(|f| Shown::Pair(index, *f, *second)).collect(),
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

/// Edges that were written, with their numbers in the source from 1.
fn declared(automaton: &Automaton) -> Vec<(usize, usize)> {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let written = automaton.edges.iter().enumerate().filter(|(_, e)| !is_generated(name(e.from)));
    (1..).zip(written.map(|(edge, _)| edge)).collect()
}

/// `sense -> decide (edge 3)`
fn edge_name(automaton: &Automaton, number: usize, edge: usize) -> String {
    let name = |id: LocationId| automaton.locations[usize::from(id.0)].name.as_str();
    let e = &automaton.edges[edge];
    format!("{} -> {} (edge {number})", name(e.from), name(final_target(automaton, e.to)))
}

/// Locations that the compiler put into an edge have a `~` in their name; so have variables.
fn is_generated(name: &str) -> bool {
    name.contains('~')
}

/// Where an edge leads to in the source: through generated locations.
fn final_target(automaton: &Automaton, mut to: LocationId) -> LocationId {
    for _ in 0..automaton.locations.len() {
        if !is_generated(&automaton.locations[to.0 as usize].name) {
            break;
        }
        let Some(next) = automaton.edges.iter().find(|e| e.from == to) else { break };
        to = next.to;
    }
    to
}

// ── bins ──

/// What the goal of a bin is called, by the bin's name.
#[must_use]
pub fn bin_goal(bin: &str) -> String {
    format!("bin {bin}")
}

/// A bin holds where its condition does and none of the cross's `ignore`s.
fn bins(program: &Program, cross: &Cross) -> Vec<Named> {
    let ignored = cross.ignore.iter().map(|c| StateFormula::Not(Box::new(formula(program, c))));
    let ignored: Vec<StateFormula> = ignored.collect();
    let named = cross.bins.iter().map(|bin| {
        let mut all = vec![formula(program, &bin.when)];
        all.extend(ignored.iter().cloned());
        let name = hrdsl_coverage::name::bin(&cross.name, &bin.name);
        Named::one(bin_goal(&name), GoalKind::Condition(StateFormula::And(all)), true, Shown::Bin(name))
    });
    named.collect()
}

/// The condition over the counters: counter i is point i.
fn formula(program: &Program, condition: &Condition) -> StateFormula {
    match condition {
        Condition::In { point, bin } => {
            let point = point.0 as usize;
            let bin = &program.coverage.points[point].bins[*bin as usize];
            StateFormula::CounterIn { counter: point, lo: bin.lo, hi: bin.hi }
        }
        Condition::Not(c) => StateFormula::Not(Box::new(formula(program, c))),
        Condition::And(cs) => StateFormula::And(cs.iter().map(|c| formula(program, c)).collect()),
        Condition::Or(cs) => StateFormula::Or(cs.iter().map(|c| formula(program, c)).collect()),
    }
}

// ── uses ──

/// An edge with what it defines and reads, as slots of the network.
struct Traffic {
    automaton: usize,
    edge: usize,
    name: String,
    defines: Vec<usize>,
    reads: Vec<usize>,
}

/// Each definition of a variable with each edge that may read it: the initial value is a definition, too.
fn uses(program: &Program, network: &Network) -> Vec<Named> {
    let names = hrdsl_ta::slot_names(program, network);
    let traffic = traffic(program, network);
    let mut named = Vec::new();
    for (slot, name) in names.iter().enumerate().filter(|(_, n)| !is_generated(n)) {
        let users: Vec<&Traffic> = traffic.iter().filter(|t| t.reads.contains(&slot)).collect();
        let setters = traffic.iter().filter(|t| t.defines.contains(&slot)).map(Some);
        for setter in std::iter::once(None).chain(setters) {
            let from = setter.map_or("its first value".to_owned(), |t| format!("set by {}", t.name));
            for user in &users {
                let what = GoalKind::Use {
                    slot,
                    definition: setter.map(|t| (t.automaton, t.edge)),
                    user: (user.automaton, user.edge),
                };
                let name = format!("use of {name}: {from}, read by {}", user.name);
                named.push(Named::one(name, what, false, Shown::Nothing));
            }
        }
    }
    named
}

fn traffic(program: &Program, network: &Network) -> Vec<Traffic> {
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
            let mut flow = Flow { program, defines: &mut defines, reads: &mut reads, open: Vec::new() };
            flow.edge(&automaton.edges[edge]);
            let network_slots = |slots: Vec<usize>| {
                let mut slots: Vec<usize> = slots.into_iter().filter_map(&to_network).collect();
                slots.sort_unstable();
                slots.dedup();
                slots
            };
            all.push(Traffic {
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
struct Flow<'a> {
    program: &'a Program,
    defines: &'a mut Vec<usize>,
    reads: &'a mut Vec<usize>,
    /// The functions that are being looked at.
    open: Vec<FunctionId>,
}

impl Flow<'_> {
    fn edge(&mut self, edge: &Edge) {
        edge.guard.iter().for_each(|e| self.read(e));
        for c in &edge.clock_guard {
            c.bound.terms.iter().for_each(|t| self.read(&t.value));
        }
        match &edge.sync {
            Sync::Send { args, .. } | Sync::Offer { args, .. } => args.iter().for_each(|e| self.read(e)),
            Sync::Internal | Sync::Receive { .. } | Sync::Accept { .. } | Sync::Join { .. } => {}
        }
        for update in &edge.updates {
            match update {
                Update::Assign { place, value } => {
                    self.read(value);
                    self.define(place);
                }
                Update::Reset { to, .. } => to.terms.iter().for_each(|t| self.read(&t.value)),
                Update::Call { function, args } => {
                    args.iter().for_each(|e| self.read(e));
                    self.call(*function);
                }
            }
        }
    }

    fn define(&mut self, place: &Place) {
        let mut slots = Vec::new();
        let bare = Place { slot: place.slot, indices: place.indices.iter().map(constant_index).collect() };
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
        let mut inner = Flow {
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

    fn statements(&mut self, body: &[Statement]) {
        for statement in body {
            match statement {
                Statement::Assign { place, value } => {
                    self.read(value);
                    self.define(place);
                }
                Statement::Call { function, args } => {
                    args.iter().for_each(|e| self.read(e));
                    self.call(*function);
                }
                Statement::If { condition, then, otherwise } => {
                    self.read(condition);
                    self.statements(then);
                    self.statements(otherwise);
                }
                Statement::While { condition, body } => {
                    self.read(condition);
                    self.statements(body);
                }
                Statement::For { lo, hi, body, .. } => {
                    self.read(lo);
                    self.read(hi);
                    self.statements(body);
                }
                Statement::Return(value) => value.iter().for_each(|e| self.read(e)),
            }
        }
    }
}

/// The same index without what it reads: only which elements there are counts.
fn constant_index(index: &hrdsl_ir::expr::Index) -> hrdsl_ir::expr::Index {
    hrdsl_ir::expr::Index { at: Expr::int(0), count: index.count, stride: index.stride }
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
