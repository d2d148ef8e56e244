//! Queries: names of the automata of a network, formulas split into locations, clock bounds and data.

use std::rc::Rc;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, BinaryOp, ExprSyntaxKind as Syntax, ItemSyntaxKind, NameSyntax, UnaryOp};

use crate::check::{
    automata::phase::AutomataPhase,
    state::{
        scope::{ExprEnv, LocalName, NameScope},
        table::OrderedMap,
    },
    value::{
        linear::{LinearTime, linear},
        operands::each_path,
    },
};
use crate::check::{state::phase::CheckPhase, template::CheckerPhase};
use crate::{
    ClockId, ClockOp, Dimension, InferredType, LocationId, NetworkId, PlayerRef, TypedClockConstraint,
    TypedExprKind, TypedFormula, TypedMeasure, TypedQuery, TypedQueryKind, VariableRef,
    expr::ComparisonOp,
    noun::Noun,
    report::{names, queries},
};

/// What the names of a network stand for.
#[derive(Default)]
pub(super) struct QueryNetwork {
    name: String,
    /// In the network's order.
    automata: Vec<String>,
    locations: OrderedMap<String, (u16, LocationId)>,
    /// Shared ones by their names, others as `Automaton.clock`.
    clocks: OrderedMap<String, ClockId>,
    /// A location in which a clock stands still.
    stands: Option<String>,
    /// Variables: shared ones by their names, others as `Automaton.variable`.
    env: ExprEnv,
    /// The same, and each location as a bool. Their numbers follow those of the variables, in the network's order.
    pub(super) values: ExprEnv,
}

/// One side of a comparison: clocks with their signs, and what remains.
#[derive(Default)]
struct QuerySum<'e> {
    plus: Vec<ClockId>,
    minus: Vec<ClockId>,
    /// Each with whether it is subtracted.
    rest: Vec<(&'e ast::ExprSyntax, bool)>,
}

impl AutomataPhase<'_, '_> {
    pub(in crate::check) fn queries(&mut self) {
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Query(query) = item {
                let looked_at = self.source.looks_at(CheckPhase::Queries, span);
                let resolved = if looked_at { self.query(query, span) } else { None };
                let (issues, table) = (&mut self.checker.issues, &mut self.networks.queries);
                let new = issues.declare(table, Noun::Query, &query.name).is_some();
                self.s.queries.extend(resolved.filter(|_| new));
            }
        }
        self.combinations();
        self.say_impure();
    }

    fn query(&mut self, query: &ast::QuerySyntax, span: Span) -> Option<TypedQuery> {
        let network = self.networks.table.get(&query.network.text).map(NetworkId);
        self.refer(&query.network, self.networks.table.span_of(&query.network.text));
        let Some(network) = network else {
            let all = self.near_of(&[Noun::Network]);
            self.unknown(Noun::Network, &query.network, &all, None);
            return None;
        };
        let mut net = self.net(network);
        let ask = self.query_ask(&query.ask, &mut net);
        Some(TypedQuery {
            name: query.name.text.clone(),
            title: query.title.as_ref().map_or_else(String::new, |t| t.text.clone()),
            text: query.span,
            network,
            ask,
            origin: span,
        })
    }

    fn query_ask(&mut self, ask: &ast::FormulaSyntax, net: &mut QueryNetwork) -> TypedQueryKind {
        let always = || TypedFormula::And(Vec::new());
        match ask {
            ast::FormulaSyntax::Possibly(f) => TypedQueryKind::Possibly(self.formula(f, net)),
            ast::FormulaSyntax::Invariantly(f) => TypedQueryKind::Invariantly(self.formula(f, net)),
            ast::FormulaSyntax::PotentiallyAlways(f) => {
                TypedQueryKind::PotentiallyAlways(self.run_formula(f, net))
            }
            ast::FormulaSyntax::Eventually(f) => TypedQueryKind::Eventually(self.run_formula(f, net)),
            ast::FormulaSyntax::LeadsTo(f, g) => {
                let f = self.run_formula(f, net);
                TypedQueryKind::LeadsTo(f, self.run_formula(g, net))
            }
            ast::FormulaSyntax::Sup { when, of } => {
                let when = when.as_ref().map_or_else(always, |f| self.formula(f, net));
                TypedQueryKind::Sup { of: self.measures(of, net), when }
            }
            ast::FormulaSyntax::Inf { when, of } => {
                let when = when.as_ref().map_or_else(always, |f| self.formula(f, net));
                TypedQueryKind::Inf { of: self.measures(of, net), when }
            }
        }
    }

    // ── names ──

    pub(super) fn net(&self, id: NetworkId) -> QueryNetwork {
        let network = &self.s.networks[usize::from(id.0)];
        let mut net = QueryNetwork {
            name: network.name.clone(),
            stands: self.s.stopping_location(network),
            env: ExprEnv {
                noun: Some(Noun::Variable),
                shared: self.shared.scope.clone(),
                ..ExprEnv::default()
            },
            ..QueryNetwork::default()
        };
        for clock in self.shared.scope.clocks.keys() {
            add_clock(&mut net.clocks, clock.clone());
        }
        let mut own = NameScope::default();
        for (place, automaton) in (0u16..).zip(&network.automata) {
            let at = usize::from(automaton.0);
            let of = &self.s.automata[at].name;
            net.automata.push(of.clone());
            for (number, location) in (0u16..).zip(&self.s.automata[at].locations) {
                net.locations.insert(format!("{of}.{}", location.name), (place, LocationId(number)));
            }
            let Some(scope) = self.scopes.get(&at) else { continue };
            for local in scope.names.values() {
                let name = format!("{of}.{}", local.name);
                // INVARIANT: the number of a leaf is the name's place in the scope.
                let leaf = u16::try_from(own.names.len()).ok().map(VariableRef::Own);
                own.names.insert(name.clone(), LocalName { name, leaf, ..local.clone() });
            }
            for (name, layout) in &scope.layouts {
                own.layouts.insert(format!("{of}.{name}"), layout.clone());
            }
            for (name, function) in &scope.functions {
                own.functions.insert(format!("{of}.{name}"), function.clone());
            }
            for clock in scope.clocks.keys() {
                add_clock(&mut net.clocks, format!("{of}.{clock}"));
            }
        }
        net.env.own = Rc::new(own.clone());
        for name in net.locations.keys() {
            let number = u16::try_from(own.names.len()).ok().map(VariableRef::Own);
            let local = LocalName {
                name: name.clone(),
                noun: Noun::Location,
                leaf: number,
                ty: InferredType::Bool,
                range: None,
                bound: true,
                place: Span::default(),
            };
            own.names.insert(name.clone(), local);
        }
        net.values = ExprEnv { own: Rc::new(own), ..net.env.clone() };
        net
    }

    /// Whether all names are known, and are variables, locations, constants or functions; says what is not.
    pub(super) fn data_names(&mut self, e: &ast::ExprSyntax, net: &QueryNetwork) -> bool {
        let mut known = true;
        each_path(e, &mut |path| known &= self.data_name(path, net));
        known
    }

    fn data_name(&mut self, path: &ast::PathSyntax, net: &QueryNetwork) -> bool {
        let whole = joined(&path.names);
        if net.clocks.contains_key(&whole) {
            self.report(queries::clock_value(&whole, path.span));
            return false;
        }
        match path.names.as_slice() {
            [name] => {
                if name.text == "deadlock" {
                    self.report(queries::state_value(&name.text, path.span));
                    return false;
                }
                let known = net.env.find(&name.text).is_some() || net.env.layout(&name.text).is_some();
                if known || self.has_value(&name.text) {
                    return true;
                }
                let Some(automaton) = net.automata.iter().find(|a| net.knows(a, &name.text)) else {
                    return true;
                };
                self.report(queries::bare_member(automaton, &name.text, name.span));
                false
            }
            [automaton, member, ..] if self.is_automaton(automaton) => {
                if !self.has_member(automaton, member, net) {
                    return false;
                }
                true
            }
            [..] => true,
        }
    }

    fn is_automaton(&self, name: &NameSyntax) -> bool {
        let id = self.players.table.get(&name.text).map(|id| self.players.ids[usize::from(id)]);
        matches!(id, Some(PlayerRef::Automaton(_))) && self.types.enums.get(&name.text).is_none()
    }

    /// A name is that of a location, variable or clock of an automaton.
    fn refer_member(&mut self, automaton: &NameSyntax, member: &NameSyntax) {
        let Some(at) = self.s.automata.iter().position(|a| a.name == automaton.text) else { return };
        let Some(scope) = self.scopes.get(&at).cloned() else { return };
        let known = ExprEnv { own: scope.clone(), ..ExprEnv::default() };
        let place = known.place_of(&member.text).or_else(|| scope.locations.get(&member.text).copied());
        self.refer(member, place);
    }

    /// Whether the automaton is in the network and has something of this name, and one thing only.
    fn has_member(&mut self, automaton: &NameSyntax, member: &NameSyntax, net: &QueryNetwork) -> bool {
        if !net.automata.contains(&automaton.text) {
            let issue = queries::not_in_network(&automaton.text, &net.name, &net.automata, automaton.span);
            self.report(issue);
            return false;
        }
        let name = format!("{}.{}", automaton.text, member.text);
        let variable = net.env.find(&name).is_some() || net.env.layout(&name).is_some();
        let location = net.locations.contains_key(&name);
        if variable && location {
            self.report(queries::location_and_variable(&automaton.text, &member.text, member.span));
            return false;
        }
        let known = variable || location || net.clocks.contains_key(&name);
        self.refer(automaton, self.players.table.span_of(&automaton.text));
        self.refer_member(automaton, member);
        if !known && !self.source.unread_items {
            let all = net.members_of(&automaton.text);
            let near = all.iter().map(String::as_str);
            self.report(names::unknown(Noun::Member, &member.text, member.span, near));
        }
        known
    }

    // ── formulas ──

    pub(super) fn formula(&mut self, e: &ast::ExprSyntax, net: &mut QueryNetwork) -> TypedFormula {
        if let Syntax::Unary { op: UnaryOp::Not, operand } = &e.kind {
            return TypedFormula::Not(Box::new(self.formula(operand, net)));
        }
        if let Syntax::Path(path) = &e.kind {
            return self.state(path, net).unwrap_or_else(|| self.data(e, net));
        }
        let Syntax::Binary { op, left, right } = &e.kind else { return self.data(e, net) };
        let join: fn(Vec<TypedFormula>) -> TypedFormula = if *op == BinaryOp::And {
            TypedFormula::And
        } else if *op == BinaryOp::Or {
            TypedFormula::Or
        } else {
            let clocks = self.clock_formula(*op, (left, right), e.span, net);
            return clocks.unwrap_or_else(|| self.data(e, net));
        };
        let left = self.formula(left, net);
        joined_by(join, left, self.formula(right, net))
    }

    /// A formula about all of a run. Zones are told apart too little there to know of deadlocks.
    fn run_formula(&mut self, e: &ast::ExprSyntax, net: &mut QueryNetwork) -> TypedFormula {
        let formula = self.formula(e, net);
        if !formula.asks_deadlock() {
            return formula;
        }
        let mut place = None;
        each_path(e, &mut |path| {
            if joined(&path.names) == "deadlock" {
                place.get_or_insert(path.span);
            }
        });
        self.report(queries::deadlock_along_run(place.unwrap_or(e.span)));
        nothing()
    }

    /// `deadlock`, or `Automaton.location`.
    fn state(&mut self, path: &ast::PathSyntax, net: &QueryNetwork) -> Option<TypedFormula> {
        match path.names.as_slice() {
            [name] if name.text == "deadlock" => Some(TypedFormula::Deadlock),
            [automaton, member] if self.is_automaton(automaton) => {
                let whole = joined(&path.names);
                let (place, location) = *net.locations.get(&whole)?;
                if !self.has_member(automaton, member, net) {
                    return Some(nothing());
                }
                Some(TypedFormula::At { automaton: place, location })
            }
            _ => None,
        }
    }

    fn data(&mut self, e: &ast::ExprSyntax, net: &mut QueryNetwork) -> TypedFormula {
        if !self.data_names(e, net) {
            return nothing();
        }
        TypedFormula::Data(self.expr_of(e, InferredType::Bool, &mut net.values))
    }

    fn measures(&mut self, of: &[ast::ExprSyntax], net: &mut QueryNetwork) -> Vec<TypedMeasure> {
        let mut measures = Vec::new();
        for e in of {
            if let Some(clock) = clock_named(e, net) {
                measures.push(TypedMeasure::Clock(clock));
            } else if self.data_names(e, net) {
                measures.push(TypedMeasure::Data(self.expr_of(e, InferredType::Int, &mut net.values)));
            }
        }
        measures
    }

    // ── clocks ──

    /// The times of `clocks op times`, as one sum on the right of the comparison. `None`: reported.
    fn times_on_the_right(&mut self, sum: &QuerySum<'_>, net: &mut QueryNetwork) -> Option<LinearTime> {
        // What is left of `clocks op times` moves to the right: its signs change.
        let mut bound = LinearTime::default();
        for (e, subtracted) in &sum.rest {
            let factor = if *subtracted { 1.0 } else { -1.0 };
            if !self.data_names(e, net) {
                return None;
            }
            let time = self.expr_of(e, InferredType::Float(Dimension::TIME), &mut net.values);
            if time.kind == TypedExprKind::Error {
                return None;
            }
            match linear(&time) {
                Ok(sum) => bound.add(sum, factor),
                Err(at) => {
                    if at.is_some() {
                        self.report(queries::not_linear(e.span));
                    }
                    return None;
                }
            }
        }
        Some(bound)
    }

    /// A comparison in which there is a clock. `None`: there is none.
    fn clock_formula(
        &mut self,
        op: BinaryOp,
        (left, right): (&ast::ExprSyntax, &ast::ExprSyntax),
        span: Span,
        net: &mut QueryNetwork,
    ) -> Option<TypedFormula> {
        let op = ComparisonOp::of(op)?;
        let mut sum = QuerySum::default();
        sum.add(left, false, net);
        sum.add(right, true, net);
        if sum.plus.is_empty() && sum.minus.is_empty() {
            return None;
        }
        let ops: &[ClockOp] = match op {
            ComparisonOp::Lt => &[ClockOp::Lt],
            ComparisonOp::Le => &[ClockOp::Le],
            ComparisonOp::Eq => &[ClockOp::Eq],
            ComparisonOp::Ge => &[ClockOp::Ge],
            ComparisonOp::Gt => &[ClockOp::Gt],
            ComparisonOp::Ne => &[ClockOp::Lt, ClockOp::Gt],
        };
        let Some(bound) = self.times_on_the_right(&sum, net) else { return Some(nothing()) };
        let (clock, minus, flipped) = match (sum.plus.as_slice(), sum.minus.as_slice()) {
            ([x], []) => (*x, None, false),
            ([x], [y]) => {
                net.stands.iter().for_each(|at| self.report(queries::clocks_compared(at, span)));
                (*x, Some(*y), false)
            }
            ([], [y]) => (*y, None, true),
            _ => {
                self.report(queries::clock_sum(span));
                return Some(nothing());
            }
        };
        let Some(bound) = self.time_of(bound, if flipped { -1.0 } else { 1.0 }, span) else {
            return Some(nothing());
        };
        let one = |op: &ClockOp| {
            let op = if flipped { mirrored(*op) } else { *op };
            TypedFormula::Clock(TypedClockConstraint { clock, minus, op, bound: bound.clone() })
        };
        Some(match ops {
            [only] => one(only),
            several => TypedFormula::Or(several.iter().map(one).collect()),
        })
    }
}

impl QueryNetwork {
    fn knows(&self, automaton: &str, member: &str) -> bool {
        let name = format!("{automaton}.{member}");
        self.locations.contains_key(&name)
            || self.clocks.contains_key(&name)
            || self.env.find(&name).is_some()
            || self.env.layout(&name).is_some()
    }

    fn members_of(&self, automaton: &str) -> Vec<String> {
        let prefix = format!("{automaton}.");
        let whole = |name: &str| name.strip_prefix(&prefix).map(str::to_owned);
        let vars = self.env.own.names.keys().filter(|n| !n.contains('['));
        let arrays = self.env.own.layouts.keys();
        let all = self.locations.keys().chain(self.clocks.keys()).chain(vars).chain(arrays);
        all.filter_map(|name| whole(name)).collect()
    }
}

impl<'e> QuerySum<'e> {
    fn add(&mut self, e: &'e ast::ExprSyntax, negative: bool, net: &QueryNetwork) {
        if let Some(clock) = clock_named(e, net) {
            if negative {
                self.minus.push(clock)
            } else {
                self.plus.push(clock)
            }
            return;
        }
        if let Syntax::Binary { op: op @ (BinaryOp::Add | BinaryOp::Sub), left, right } = &e.kind {
            self.add(left, negative, net);
            self.add(right, negative != (*op == BinaryOp::Sub), net);
        } else {
            self.rest.push((e, negative));
        }
    }
}

fn add_clock(clocks: &mut OrderedMap<String, ClockId>, name: String) {
    let id = ClockId(u16::try_from(clocks.len()).unwrap_or(u16::MAX));
    clocks.insert(name, id);
}

/// Stands for a formula with a diagnostic.
fn nothing() -> TypedFormula {
    TypedFormula::Or(Vec::new())
}

fn joined_by(
    join: fn(Vec<TypedFormula>) -> TypedFormula,
    left: TypedFormula,
    right: TypedFormula,
) -> TypedFormula {
    // `a and b and c` is one conjunction of three.
    let parts = match (join(Vec::new()), left) {
        (TypedFormula::And(_), TypedFormula::And(mut parts))
        | (TypedFormula::Or(_), TypedFormula::Or(mut parts))
            if !parts.is_empty() =>
        {
            parts.push(right);
            parts
        }
        (_, left) => vec![left, right],
    };
    join(parts)
}

fn joined(names: &[NameSyntax]) -> String {
    names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(".")
}

/// The clock that an expression names: `x`, `P.x`, `x[2]`.
fn clock_named(e: &ast::ExprSyntax, net: &QueryNetwork) -> Option<ClockId> {
    let name = if let Syntax::Index { of, index } = &e.kind
        && let (Syntax::Path(path), Syntax::Int(n)) = (&of.kind, &index.kind)
    {
        format!("{}[{n}]", joined(&path.names))
    } else if let Syntax::Path(path) = &e.kind {
        joined(&path.names)
    } else {
        return None;
    };
    net.clocks.get(&name).copied()
}

fn mirrored(op: ClockOp) -> ClockOp {
    match op {
        ClockOp::Lt => ClockOp::Gt,
        ClockOp::Le => ClockOp::Ge,
        ClockOp::Eq => ClockOp::Eq,
        ClockOp::Ge => ClockOp::Le,
        ClockOp::Gt => ClockOp::Lt,
    }
}
