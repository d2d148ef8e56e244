//! Expressions and updates of a program as the language writes them, for the labels of pictures.

use hrdsl_ir::{
    Expr, Program, Value,
    expr::{Lvalue, UnaryOp, sign},
    known_name,
    ta::{
        Automaton, AutomatonVar, ClockConstraint, ClockId, ClockOp, Edge, EdgeAssignment, ReceiveArg,
        SyncLabel, TimeSum,
    },
};

use crate::exchange::time::seconds;

/// Shows what an automaton's expressions mean.
pub(crate) struct AutomatonPrinter<'p> {
    pub program: &'p Program,
    pub automaton: &'p Automaton,
    /// The names that an edge binds, in the order of its binders.
    pub binders: Vec<String>,
}

impl<'p> AutomatonPrinter<'p> {
    pub fn of(program: &'p Program, automaton: &'p Automaton) -> Self {
        Self { program, automaton, binders: Vec::new() }
    }

    /// In an edge: with the names of its selects, and of the parameters of what it takes.
    pub fn edge(&self, edge: &Edge) -> Self {
        let mut binders: Vec<String> = edge.selects.iter().map(|s| s.name.clone()).collect();
        let bind = |arg: &ReceiveArg, name: &String| (*arg == ReceiveArg::Bind).then(|| name.clone());
        if let Some((event, args)) = edge.sync.as_receive() {
            let params = &self.program.event(event).params;
            binders.extend(args.iter().zip(params).filter_map(|(arg, param)| bind(arg, &param.name)));
        }
        if let Some((channel, args)) = edge.sync.as_accept() {
            let params = &self.program.channel(channel).params;
            binders.extend(args.iter().zip(params).filter_map(|(arg, param)| bind(arg, &param.name)));
        }
        Self { binders, ..*self }
    }

    fn var(&self, slot: u16) -> &str {
        let slot = usize::from(slot);
        let own = slot.wrapping_sub(self.program.shared.len());
        let bound = own.wrapping_sub(self.automaton.vars.len());
        let of = |v: &'p AutomatonVar| v.name.as_str();
        let shared = self.program.shared.get(slot).map(of);
        let found = shared.or_else(|| self.automaton.vars.get(own).map(of));
        known_name("variable", found.or_else(|| self.binders.get(bound).map(String::as_str)))
    }

    pub fn clock(&self, clock: ClockId) -> &str {
        let at = usize::from(clock.0);
        let own = at.wrapping_sub(self.program.clocks.len());
        let found = self.program.clocks.get(at).or_else(|| self.automaton.clocks.get(own));
        known_name("clock", found.map(String::as_str))
    }

    fn place(&self, place: &Lvalue) -> String {
        if place.indices.is_empty() {
            return self.var(place.slot).to_owned();
        }
        // `q[0].x` is the first of the array: its name without the indices.
        let first = self.var(place.slot);
        let base = first.split('[').next().unwrap_or(first);
        let tail = first.rsplit(']').next().filter(|t| t.starts_with('.')).unwrap_or_default();
        let indices: String = place.indices.iter().map(|i| format!("[{}]", self.expr(&i.at))).collect();
        format!("{base}{indices}{tail}")
    }

    pub fn expr(&self, e: &Expr) -> String {
        self.within(e, 0)
    }

    fn within(&self, e: &Expr, around: u8) -> String {
        let (text, level) = match e {
            Expr::Const(v) => (value(*v), 9),
            Expr::Var(i) => (self.var(*i).to_owned(), 9),
            Expr::Unary(UnaryOp::Not, a) => (format!("not {}", self.within(a, 3)), 3),
            Expr::Unary(UnaryOp::Neg, a) => (format!("-{}", self.within(a, 7)), 6),
            Expr::Binary(op, a, b) => {
                let (sign, level) = sign(*op);
                let left = if level == 4 { 5 } else { level };
                (format!("{} {sign} {}", self.within(a, left), self.within(b, level + 1)), level)
            }
            Expr::If(c, a, b) => {
                (format!("if {} {{ {} }} else {{ {} }}", self.expr(c), self.expr(a), self.expr(b)), 9)
            }
            Expr::Call(f, args) => (self.call(f.name(), args), 9),
            Expr::List(items, _) => {
                let items: Vec<String> = items.iter().map(|i| self.expr(i)).collect();
                (format!("[{}]", items.join(", ")), 9)
            }
            Expr::Element(place) => (self.place(place), 9),
            Expr::Apply(f, args) => (self.call(&self.program.function(*f).name, args), 9),
        };
        if level < around { format!("({text})") } else { text }
    }

    pub fn call(&self, name: &str, args: &[Expr]) -> String {
        let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
        format!("{name}({})", args.join(", "))
    }

    fn time(&self, time: &TimeSum) -> String {
        let mut parts: Vec<String> = time
            .terms
            .iter()
            .map(|t| format!("{} * {}", self.within(&t.value, 6), seconds(t.factor)))
            .collect();
        if time.nanos != 0 || parts.is_empty() {
            parts.push(seconds(time.nanos));
        }
        parts.join(" + ")
    }

    pub fn bound(&self, c: &ClockConstraint) -> String {
        let minus = c.minus.map_or(String::new(), |m| format!(" - {}", self.clock(m)));
        let op = match c.op {
            ClockOp::Lt => "<",
            ClockOp::Le => "<=",
            ClockOp::Eq => "==",
            ClockOp::Ge => ">=",
            ClockOp::Gt => ">",
        };
        format!("{}{minus} {op} {}", self.clock(c.clock), self.time(&c.bound))
    }

    pub fn guard(&self, edge: &Edge) -> Vec<String> {
        let mut parts: Vec<String> = edge.clock_guard.iter().map(|c| self.bound(c)).collect();
        // Beside others it is a part of a conjunction.
        let around = if parts.is_empty() { 0 } else { 2 };
        parts.extend(edge.guard.iter().map(|g| self.within(g, around)));
        parts
    }

    /// `take(1)!`, `take(_)?`, `done`; nothing for an internal edge.
    pub fn sync(&self, edge: &Edge) -> Option<String> {
        let named = |name: &str, args: Vec<String>, sign: &str| {
            let args = if args.is_empty() { String::new() } else { format!("({})", args.join(", ")) };
            Some(format!("{name}{args}{sign}"))
        };
        let sent = |args: &[Expr]| args.iter().map(|a| self.expr(a)).collect();
        let mut bound = self.binders[edge.selects.len().min(self.binders.len())..].iter();
        let mut taken = |args: &[ReceiveArg]| -> Vec<String> {
            let one = |a: &ReceiveArg| match a {
                ReceiveArg::Bind => bound.next().cloned().unwrap_or_default(),
                ReceiveArg::Match(hrdsl_ir::ArgPattern::Any) => "_".to_owned(),
                ReceiveArg::Match(hrdsl_ir::ArgPattern::Is(v)) => value(*v),
            };
            args.iter().map(one).collect()
        };
        let channel = |c: &hrdsl_ir::ta::ChannelId| self.program.channels[usize::from(c.0)].name.as_str();
        match &edge.sync {
            SyncLabel::Internal => None,
            SyncLabel::Send { event, args } => named(&self.program.event(*event).name, sent(args), "!"),
            SyncLabel::Receive { event, args } => named(&self.program.event(*event).name, taken(args), "?"),
            SyncLabel::Offer { channel: c, args } => named(channel(c), sent(args), "!"),
            SyncLabel::Accept { channel: c, args } => named(channel(c), taken(args), "?"),
            SyncLabel::Join { channel: c } => named(channel(c), Vec::new(), ""),
        }
    }

    pub fn update(&self, update: &EdgeAssignment) -> String {
        match update {
            EdgeAssignment::Assign { place, value } => {
                format!("{} = {}", self.place(place), self.expr(value))
            }
            EdgeAssignment::Reset { clock, from: None, to } if *to == TimeSum::ZERO => {
                format!("{} = 0", self.clock(*clock))
            }
            EdgeAssignment::Reset { clock, from, to } => {
                let from = from.map_or(String::new(), |f| format!("{} + ", self.clock(f)));
                format!("{} = {from}{}", self.clock(*clock), self.time(to))
            }
            EdgeAssignment::Call { function, args } => {
                let name = &self.program.functions[usize::from(function.0)].name;
                self.call(name, args)
            }
        }
    }
}

fn value(v: Value) -> String {
    v.to_string()
}
