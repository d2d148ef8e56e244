//! One automaton as a template: locations in columns by their distance from the first, and edges.

use std::collections::VecDeque;

use hrdsl_ir::ArgPattern;
use hrdsl_ir::ta::{
    Automaton, AutomatonVar, ClockOp, Edge, EdgeAssignment, FunctionId, Location, LocationKind, ReceiveArg,
    SyncLabel,
};
use indexmap::IndexSet;

use super::{
    MultiWayRole, UppaalChannel, UppaalExporter, escaped,
    expr::{UppaalExprContext, UppaalExprText, UppaalPrecedence, UppaalTextResult},
    function,
    slots::{UppaalNames, UppaalSlot, UppaalSlotTable, slot},
};
use crate::uppaal::rate::rate_before;

/// How far apart locations are drawn.
const COLUMN: i32 = 250;
const ROW: i32 = 130;

impl UppaalExporter<'_> {
    /// The template of the automaton at this place of the network.
    pub fn template(&mut self, at: usize) -> String {
        let automaton = self.automaton(at);
        let mut names = self.names.clone();
        let mut context = self.global.clone();
        let mut slots = UppaalSlotTable::default();
        let mut lines = slots.declare(&automaton.vars, &mut names);
        context.slots.append(slots);
        for clock in &automaton.clocks {
            let name = names.fresh(clock);
            lines.push(format!("clock {name};"));
            context.clocks.push(name);
        }
        let mut declaration: String = lines.iter().map(|l| format!("{l}\n")).collect();
        declaration += &self.own_functions(at, &mut context, &mut names);
        let locations: Vec<String> = automaton.locations.iter().map(|l| names.fresh(&l.name)).collect();
        let mut text = format!("  <template>\n    <name>{}</name>\n", self.processes[at]);
        text += &format!("    <declaration>{}</declaration>\n", escaped(&declaration));
        let layout = layout(automaton);
        for (i, location) in automaton.locations.iter().enumerate() {
            let id = self.first_id(at) + i;
            text += &self.location(automaton, location, id, (&locations[i], layout[i]), &context);
        }
        let initial = self.first_id(at) + usize::from(automaton.initial.0);
        text += &format!("    <init ref=\"id{initial}\"/>\n");
        for edge in &automaton.edges {
            text += &self.edge(at, edge, &context, &names, &layout);
        }
        self.contexts.push(context);
        self.locations.push(locations);
        text + "  </template>\n"
    }

    /// The number of its first location: no two of the document have the same.
    fn first_id(&self, at: usize) -> usize {
        (0..at).map(|before| self.automaton(before).locations.len()).sum()
    }

    /// The functions that know the automaton's own variables.
    fn own_functions(
        &mut self,
        at: usize,
        context: &mut UppaalExprContext,
        names: &mut UppaalNames,
    ) -> String {
        let program = self.program;
        let mut called = IndexSet::new();
        function::called_by(self.automaton(at), &mut |f| {
            called.insert(f);
        });
        let mut order = IndexSet::new();
        for id in called {
            // A function that calls itself has been noted with the shared ones.
            if function::order(program, id, &mut Vec::new(), &mut order).is_err() {
                return String::new();
            }
        }
        let owned =
            |id: &FunctionId| program.functions[usize::from(id.0)].owner == Some(self.network.automata[at]);
        let own: Vec<FunctionId> = order.into_iter().filter(owned).collect();
        self.functions(&own, context, names)
    }

    fn location(
        &mut self,
        automaton: &Automaton,
        location: &Location,
        id: usize,
        (name, (x, y)): (&str, (i32, i32)),
        context: &UppaalExprContext,
    ) -> String {
        let place = format!("the location `{}` of `{}`", location.name, automaton.name);
        let mut text = format!("    <location id=\"id{id}\" x=\"{x}\" y=\"{y}\">\n");
        text += &format!("      <name x=\"{}\" y=\"{}\">{name}</name>\n", x - 10, y - 34);
        let invariant = invariant(location, context);
        let invariant = self.said(invariant, location.origin, &place);
        text += &label("invariant", &invariant, x - 10, y + 15);
        let rate = rate_before(self.files, location.origin);
        text += &label("exponentialrate", &rate.unwrap_or_default(), x - 10, y + 32);
        text += match location.kind {
            LocationKind::Normal => "",
            LocationKind::Urgent => "      <urgent/>\n",
            LocationKind::Committed => "      <committed/>\n",
        };
        text + "    </location>\n"
    }

    fn edge(
        &mut self,
        at: usize,
        edge: &Edge,
        context: &UppaalExprContext,
        names: &UppaalNames,
        layout: &[(i32, i32)],
    ) -> String {
        let mut binders =
            EdgeSelections { context: context.clone(), names: names.clone(), selects: Vec::new() };
        edge.selects.iter().for_each(|s| {
            binders.bind(s);
        });
        let automaton = self.automaton(at);
        let ends = |id: hrdsl_ir::ta::LocationId| &automaton.locations[usize::from(id.0)].name;
        let place = format!("the edge `{} -> {}` of `{}`", ends(edge.from), ends(edge.to), automaton.name);
        let sync = self.sync(at, &edge.sync, &mut binders);
        let sync = self.said(sync, edge.origin, &place);
        let guard = guard(edge, &binders.context);
        let guard = self.said(guard, edge.origin, &place);
        let updates = updates(&edge.updates, &binders.context);
        let updates = self.said(updates, edge.origin, &place);
        let ((ax, ay), (bx, by)) = (layout[usize::from(edge.from.0)], layout[usize::from(edge.to.0)]);
        let (x, y) = (i32::midpoint(ax, bx), i32::midpoint(ay, by));
        let mut text = String::from("    <transition>\n");
        let first = self.first_id(at);
        let (from, to) = (first + usize::from(edge.from.0), first + usize::from(edge.to.0));
        text += &format!("      <source ref=\"id{from}\"/>\n      <target ref=\"id{to}\"/>\n");
        text += &label("select", &binders.selects.join(", "), x - 60, y - 50);
        text += &label("guard", &guard, x - 60, y - 34);
        text += &label("synchronisation", &sync, x - 60, y - 18);
        text += &label("assignment", &updates, x - 60, y - 2);
        if edge.from == edge.to {
            text += &format!("      <nail x=\"{}\" y=\"{}\"/>\n", ax - 40, ay + 50);
            text += &format!("      <nail x=\"{}\" y=\"{}\"/>\n", ax + 40, ay + 50);
        }
        text + "    </transition>\n"
    }

    fn sync(&self, at: usize, sync: &SyncLabel, binders: &mut EdgeSelections) -> UppaalTextResult<String> {
        let id = self.network.automata[at];
        match sync {
            SyncLabel::Internal => Ok(String::new()),
            SyncLabel::Send { event, args } => offer(self.events.get(event), args, &binders.context),
            SyncLabel::Offer { channel, args } => offer(self.channels.get(channel), args, &binders.context),
            SyncLabel::Receive { event, args } => accept(self.events.get(event), args, binders),
            SyncLabel::Accept { channel, args } => accept(self.channels.get(channel), args, binders),
            SyncLabel::Join { channel } => {
                let known = self.channels.get(channel).ok_or("a channel that is not known here")?;
                Ok(match self.part(*channel, id) {
                    MultiWayRole::Offer => format!("{}!", known.name),
                    MultiWayRole::Accept => format!("{}?", known.name),
                    MultiWayRole::Alone if known.urgent => {
                        return Err("an urgent channel of one automaton".to_owned());
                    }
                    MultiWayRole::Alone => String::new(),
                })
            }
        }
    }
}

/// What an edge selects: the scenario's selects, then what it binds.
struct EdgeSelections {
    context: UppaalExprContext,
    names: UppaalNames,
    selects: Vec<String>,
}

impl EdgeSelections {
    /// Adds a select; it is the next variable of the edge's expressions.
    fn bind(&mut self, var: &AutomatonVar) -> String {
        let name = self.select(var);
        self.context.slots.slots.push(UppaalSlot { text: name.clone(), as_number: var.is_bool, ..slot(var) });
        name
    }

    fn select(&mut self, var: &AutomatonVar) -> String {
        let name = self.names.fresh(&var.name);
        self.selects.push(format!("{name} : int[{},{}]", var.lo, var.hi));
        name
    }
}

fn offer(
    channel: Option<&UppaalChannel>,
    args: &[hrdsl_ir::Expr],
    context: &UppaalExprContext,
) -> UppaalTextResult<String> {
    let channel = channel.ok_or("a channel that is not known here")?;
    let mut text = channel.name.clone();
    for (param, arg) in channel.params.iter().zip(args) {
        let arg = context.expr(arg, param.enumeration)?;
        let arg = match (param.is_bool, arg.text.as_str()) {
            (true, "true") => UppaalExprText::new("1", UppaalPrecedence::Atom),
            (true, "false") => UppaalExprText::new("0", UppaalPrecedence::Atom),
            (true, _) => UppaalExprText::new(
                format!("({} ? 1 : 0)", arg.at(UppaalPrecedence::Or)),
                UppaalPrecedence::Atom,
            ),
            (false, _) => arg,
        };
        text += &format!("[{}]", from_zero(&arg, param.lo));
    }
    Ok(text + "!")
}

fn accept(
    channel: Option<&UppaalChannel>,
    args: &[ReceiveArg],
    binders: &mut EdgeSelections,
) -> UppaalTextResult<String> {
    let channel = channel.ok_or("a channel that is not known here")?;
    let mut text = channel.name.clone();
    for (param, arg) in channel.params.iter().zip(args) {
        let index = match arg {
            ReceiveArg::Match(ArgPattern::Is(hrdsl_ir::Value::Bool(b))) => i64::from(*b).to_string(),
            ReceiveArg::Match(ArgPattern::Is(value)) => {
                from_zero(&binders.context.constant(*value, param.enumeration)?, param.lo)
            }
            ReceiveArg::Match(ArgPattern::Any) => {
                from_zero(&UppaalExprText::new(binders.select(param), UppaalPrecedence::Atom), param.lo)
            }
            ReceiveArg::Bind => {
                from_zero(&UppaalExprText::new(binders.bind(param), UppaalPrecedence::Atom), param.lo)
            }
        };
        text += &format!("[{index}]");
    }
    Ok(text + "?")
}

/// An index: UPPAAL's arrays begin at 0.
fn from_zero(value: &UppaalExprText, lo: i64) -> String {
    match (lo, value.text.parse::<i64>()) {
        (0, _) => value.text.clone(),
        (lo, Ok(n)) => (n - lo).to_string(),
        (lo, Err(_)) if lo > 0 => format!("{} - {lo}", value.at(UppaalPrecedence::Sum)),
        (lo, Err(_)) => format!("{} + {}", value.at(UppaalPrecedence::Sum), lo.unsigned_abs()),
    }
}

fn invariant(location: &Location, context: &UppaalExprContext) -> UppaalTextResult<String> {
    let mut parts = Vec::new();
    for constraint in &location.invariant {
        match constraint.op {
            ClockOp::Lt | ClockOp::Le => parts.push(context.constraint(constraint)?),
            ClockOp::Eq | ClockOp::Ge | ClockOp::Gt => {
                return Err("an invariant with a lower bound of a clock".to_owned());
            }
        }
    }
    for clock in &location.stopped {
        let name = context.clocks.get(usize::from(clock.0)).ok_or("a clock that is not known here")?;
        parts.push(format!("{name}' == 0"));
    }
    if let Some(holds) = &location.holds {
        parts.push(context.expr(holds, None)?.at(UppaalPrecedence::And));
    }
    Ok(parts.join(" && "))
}

fn guard(edge: &Edge, context: &UppaalExprContext) -> UppaalTextResult<String> {
    let mut parts =
        edge.clock_guard.iter().map(|c| context.constraint(c)).collect::<UppaalTextResult<Vec<_>>>()?;
    if let Some(guard) = &edge.guard {
        parts.push(context.expr(guard, None)?.at(UppaalPrecedence::And));
    }
    Ok(parts.join(" && "))
}

fn updates(all: &[EdgeAssignment], context: &UppaalExprContext) -> UppaalTextResult<String> {
    let mut parts = Vec::new();
    for update in all {
        parts.push(match update {
            EdgeAssignment::Assign { place, value } => {
                let value = context.expr(value, context.enumeration_of(place))?;
                format!("{} = {}", context.place(place)?, value.text)
            }
            EdgeAssignment::Reset { from: Some(_), .. } => {
                return Err("that a clock is set to another clock: it sets clocks to integers".to_owned());
            }
            EdgeAssignment::Reset { clock, from: None, to } => {
                let name =
                    context.clocks.get(usize::from(clock.0)).ok_or("a clock that is not known here")?;
                format!("{name} = {}", context.time(to)?.text)
            }
            EdgeAssignment::Call { function, args } => context.apply(function.0, args)?,
        });
    }
    Ok(parts.join(", "))
}

fn label(kind: &str, text: &str, x: i32, y: i32) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("      <label kind=\"{kind}\" x=\"{x}\" y=\"{y}\">{}</label>\n", escaped(text))
}

/// Where each location is drawn: its column is its distance from the first.
fn layout(automaton: &Automaton) -> Vec<(i32, i32)> {
    let count = automaton.locations.len();
    let mut column: Vec<Option<i32>> = vec![None; count];
    let mut queue = VecDeque::from([usize::from(automaton.initial.0)]);
    if let Some(first) = column.get_mut(usize::from(automaton.initial.0)) {
        *first = Some(0);
    }
    while let Some(at) = queue.pop_front() {
        let next = column[at].map(|c| c + 1);
        for edge in automaton.edges.iter().filter(|e| usize::from(e.from.0) == at) {
            let to = usize::from(edge.to.0);
            if column[to].is_none() {
                column[to] = next;
                queue.push_back(to);
            }
        }
    }
    // What cannot be reached stands in a column of its own.
    let rest = column.iter().flatten().max().map_or(0, |c| c + 1);
    let columns: Vec<i32> = column.into_iter().map(|c| c.unwrap_or(rest)).collect();
    let row = |i: usize| columns[..i].iter().filter(|c| **c == columns[i]).count() as i32;
    (0..count).map(|i| (columns[i] * COLUMN, row(i) * ROW)).collect()
}
