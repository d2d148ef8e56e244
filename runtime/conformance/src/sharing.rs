//! What automata have in common besides events: channels, shared variables, shared clocks.

use std::collections::BTreeSet;

use hrdsl_ir::{
    Expr, Program,
    expr::{FunctionId, Lvalue},
    ta::{Automaton, AutomatonId, ChannelId, ClockConstraint, EdgeAssignment, FunctionStatement, TimeSum},
};

/// Something that automata share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SharedThing {
    Channel(ChannelId),
    /// Of [`Program::shared`].
    Variable(u16),
    /// Of [`Program::clocks`].
    Clock(u16),
}

impl SharedThing {
    pub(crate) fn name(self, program: &Program) -> String {
        let named =
            |what: &str, name: Option<&String>| format!("the {what} `{}`", name.map_or("?", String::as_str));
        match self {
            SharedThing::Channel(id) => named("channel", Some(&program.channel(id).name)),
            SharedThing::Variable(n) => {
                named("variable", program.shared.get(usize::from(n)).map(|v| &v.name))
            }
            SharedThing::Clock(n) => named("clock", program.clocks.get(usize::from(n))),
        }
    }
}

/// What some automata read and write of what is shared. A channel is both.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharedUse {
    reads: BTreeSet<SharedThing>,
    writes: BTreeSet<SharedThing>,
}

impl SharedUse {
    pub(crate) fn of(program: &Program, automata: impl IntoIterator<Item = AutomatonId>) -> Self {
        let mut walk = SharedWalk { program, found: Self::default(), seen: BTreeSet::new() };
        for id in automata {
            walk.automaton(program.automaton(id));
        }
        walk.found
    }

    /// Something that both use, and at least one of them writes.
    pub(crate) fn meets(&self, other: &Self) -> Option<SharedThing> {
        self.depends_on(other).or_else(|| other.depends_on(self))
    }

    /// Something that this reads and the other writes.
    pub(crate) fn depends_on(&self, other: &Self) -> Option<SharedThing> {
        self.reads.intersection(&other.writes).next().copied()
    }
}

struct SharedWalk<'p> {
    program: &'p Program,
    found: SharedUse,
    /// The functions that were looked at.
    seen: BTreeSet<u16>,
}

impl SharedWalk<'_> {
    fn automaton(&mut self, automaton: &Automaton) {
        for location in &automaton.locations {
            self.constraints(&location.invariant);
            location.holds.iter().for_each(|e| self.reads(e));
        }
        for edge in &automaton.edges {
            self.constraints(&edge.clock_guard);
            edge.guard.iter().for_each(|e| self.reads(e));
            edge.sync.given().iter().for_each(|e| self.reads(e));
            if let Some(channel) = edge.sync.channel() {
                self.found.reads.insert(SharedThing::Channel(channel));
                self.found.writes.insert(SharedThing::Channel(channel));
            }
            edge.updates.iter().for_each(|u| self.update(u));
        }
    }

    fn constraints(&mut self, all: &[ClockConstraint]) {
        for constraint in all {
            for clock in constraint.clocks().filter(|c| usize::from(c.0) < self.program.clocks.len()) {
                self.found.reads.insert(SharedThing::Clock(clock.0));
            }
            self.time(&constraint.bound);
        }
    }

    fn time(&mut self, time: &TimeSum) {
        time.terms.iter().for_each(|t| self.reads(&t.value));
    }

    fn update(&mut self, update: &EdgeAssignment) {
        match update {
            EdgeAssignment::Assign { place, value } => {
                self.assign(place);
                self.reads(value);
            }
            EdgeAssignment::Reset { clock, from, to } => {
                let shared = |c: u16| usize::from(c) < self.program.clocks.len();
                if shared(clock.0) {
                    self.found.writes.insert(SharedThing::Clock(clock.0));
                }
                if let Some(from) = from.filter(|c| shared(c.0)) {
                    self.found.reads.insert(SharedThing::Clock(from.0));
                }
                self.time(to);
            }
            EdgeAssignment::Call { function, args } => {
                args.iter().for_each(|a| self.reads(a));
                self.function(*function);
            }
        }
    }

    /// What an assignment may write. The variables of its indices are counted, too, which is more than is so.
    fn assign(&mut self, place: &Lvalue) {
        let count = self.program.shared.len();
        place.each_var(&mut |slot| {
            if usize::from(slot) < count {
                self.found.writes.insert(SharedThing::Variable(slot));
            }
        });
        place.indices.iter().for_each(|i| self.reads(&i.at));
    }

    fn reads(&mut self, e: &Expr) {
        let count = self.program.shared.len();
        e.each_var(&mut |slot| {
            if usize::from(slot) < count {
                self.found.reads.insert(SharedThing::Variable(slot));
            }
        });
        self.calls(e);
    }

    fn calls(&mut self, e: &Expr) {
        match e {
            Expr::Const(_) | Expr::Var(_) => {}
            Expr::Unary(_, a) => self.calls(a),
            Expr::Binary(_, a, b) => {
                self.calls(a);
                self.calls(b);
            }
            Expr::If(c, a, b) => {
                self.calls(c);
                self.calls(a);
                self.calls(b);
            }
            Expr::Call(_, args) => args.iter().for_each(|a| self.calls(a)),
            Expr::List(elements, rest) => {
                elements.iter().for_each(|a| self.calls(a));
                rest.iter().for_each(|a| self.calls(a));
            }
            Expr::Element(place) => place.indices.iter().for_each(|i| self.calls(&i.at)),
            Expr::Apply(function, args) => {
                args.iter().for_each(|a| self.calls(a));
                self.function(*function);
            }
        }
    }

    fn function(&mut self, function: FunctionId) {
        if !self.seen.insert(function.0) {
            return;
        }
        let program = self.program;
        for statement in &program.function(function).body {
            statement.each(&mut |s| {
                s.expressions().into_iter().for_each(|e| self.reads(e));
                match s {
                    FunctionStatement::Assign { place, .. } => self.assign(place),
                    FunctionStatement::Call { function, .. } => self.function(*function),
                    FunctionStatement::If { .. }
                    | FunctionStatement::While { .. }
                    | FunctionStatement::For { .. }
                    | FunctionStatement::Return(_) => {}
                }
            });
        }
    }
}
