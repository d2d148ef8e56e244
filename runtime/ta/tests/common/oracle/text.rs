//! A program as text that a person can read: nearly `.hri`.

use std::fmt::Write as _;

use hrdsl_ir::{
    Expr, Program,
    expr::{BinaryOp, Lvalue, UnaryOp},
    ta::{
        Automaton, AutomatonFunction, AutomatonVar, ChannelKind, ClockConstraint, ClockId, ClockOp, Edge,
        EdgeAssignment, FunctionStatement, Location, LocationKind, ReceiveArg, SyncLabel, TimeSum,
    },
};

/// The names of what `Expr::Var` and clocks stand for.
struct Names {
    slots: Vec<String>,
    clocks: Vec<String>,
}

impl Names {
    fn new(p: &Program, a: Option<&Automaton>, more: &[&[AutomatonVar]]) -> Self {
        let own = a.map_or(&[][..], |a| &a.vars);
        let vars = p.shared.iter().chain(own).chain(more.iter().copied().flatten());
        let clocks = p.clocks.iter().chain(a.map_or(&[][..], |a| &a.clocks));
        Self { slots: vars.map(|v| v.name.clone()).collect(), clocks: clocks.cloned().collect() }
    }

    fn slot(&self, at: u16) -> String {
        self.slots.get(usize::from(at)).cloned().unwrap_or_else(|| format!("p{at}"))
    }

    fn clock(&self, c: ClockId) -> &str {
        &self.clocks[usize::from(c.0)]
    }

    fn place(&self, p: &Lvalue) -> String {
        let index = |i: &hrdsl_ir::expr::ArrayIndex| format!("[{} of {}]", self.expr(&i.at), i.count);
        self.slot(p.slot) + &p.indices.iter().map(index).collect::<String>()
    }

    fn list(&self, es: &[Expr]) -> String {
        es.iter().map(|e| self.expr(e)).collect::<Vec<_>>().join(", ")
    }

    fn expr(&self, e: &Expr) -> String {
        match e {
            Expr::Const(v) => v.to_string(),
            Expr::Var(i) => self.slot(*i),
            Expr::Unary(UnaryOp::Not, a) => format!("!({})", self.expr(a)),
            Expr::Unary(UnaryOp::Neg, a) => format!("-({})", self.expr(a)),
            Expr::Binary(op, a, b) => format!("({} {} {})", self.expr(a), sign(*op), self.expr(b)),
            Expr::If(c, a, b) => {
                format!("if {} {{ {} }} else {{ {} }}", self.expr(c), self.expr(a), self.expr(b))
            }
            Expr::Call(f, args) => format!("{f:?}({})", self.list(args)),
            Expr::List(args, _) => format!("[{}]", self.list(args)),
            Expr::Element(p) => self.place(p),
            Expr::Apply(f, args) => format!("f{}({})", f.0, self.list(args)),
        }
    }

    fn time(&self, t: &TimeSum) -> String {
        let mut text = format!("{} s", t.nanos as f64 / 1e9);
        for term in &t.terms {
            let _ = write!(text, " + {} * {} s", self.expr(&term.value), term.factor as f64 / 1e9);
        }
        text
    }

    fn bounds(&self, cs: &[ClockConstraint]) -> Vec<String> {
        let one = |c: &ClockConstraint| {
            let op = match c.op {
                ClockOp::Lt => "<",
                ClockOp::Le => "<=",
                ClockOp::Eq => "==",
                ClockOp::Ge => ">=",
                ClockOp::Gt => ">",
            };
            let minus = c.minus.map_or(String::new(), |m| format!(" - {}", self.clock(m)));
            format!("{}{minus} {op} {}", self.clock(c.clock), self.time(&c.bound))
        };
        cs.iter().map(one).collect()
    }

    fn update(&self, u: &EdgeAssignment) -> String {
        match u {
            EdgeAssignment::Assign { place, value } => {
                format!("{} = {}", self.place(place), self.expr(value))
            }
            EdgeAssignment::Call { function, args } => format!("f{}({})", function.0, self.list(args)),
            EdgeAssignment::Reset { clock, from, to } => {
                let from = from.map_or(String::new(), |f| format!("{} + ", self.clock(f)));
                format!("{} = {from}{}", self.clock(*clock), self.time(to))
            }
        }
    }

    fn body(&self, body: &[FunctionStatement]) -> String {
        let one = |s: &FunctionStatement| match s {
            FunctionStatement::Assign { place, value } => {
                format!("{} = {};", self.place(place), self.expr(value))
            }
            FunctionStatement::Call { function, args } => format!("f{}({});", function.0, self.list(args)),
            FunctionStatement::If { condition, then, otherwise } => format!(
                "if {} {{ {} }} else {{ {} }}",
                self.expr(condition),
                self.body(then),
                self.body(otherwise)
            ),
            FunctionStatement::While { condition, body } => {
                format!("while {} {{ {} }}", self.expr(condition), self.body(body))
            }
            FunctionStatement::For { slot, lo, hi, body } => format!(
                "for {} in {}..{} {{ {} }}",
                self.slot(*slot),
                self.expr(lo),
                self.expr(hi),
                self.body(body)
            ),
            FunctionStatement::Return(e) => {
                format!("return {};", e.as_ref().map_or(String::new(), |e| self.expr(e)))
            }
        };
        body.iter().map(one).collect::<Vec<_>>().join(" ")
    }
}

fn sign(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Rem => "%",
        BinaryOp::Eq => "==",
        BinaryOp::Ne => "!=",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
        BinaryOp::And => "&&",
        BinaryOp::Or => "||",
    }
}

/// The whole program: its automata and what they share.
pub fn program(p: &Program) -> String {
    let mut text = String::new();
    for v in &p.shared {
        let _ = writeln!(text, "var {}: {}..{} = {}", v.name, v.lo, v.hi, v.init);
    }
    for c in &p.clocks {
        let _ = writeln!(text, "var {c}: clock");
    }
    for c in &p.channels {
        let params: Vec<_> = c.params.iter().map(|v| format!("{}..{}", v.lo, v.hi)).collect();
        let urgent = if c.urgent { "urgent " } else { "" };
        let kind = match &c.kind {
            ChannelKind::Binary => String::new(),
            ChannelKind::Broadcast => "broadcast".to_owned(),
            ChannelKind::MultiWay(participants) => {
                let one = |q: &hrdsl_ir::ta::ChannelParticipant| {
                    let name = &p.automata[usize::from(q.automaton.0)].name;
                    format!("{name}{}", if q.optional { "?" } else { "" })
                };
                format!("joint {}", participants.iter().map(one).collect::<Vec<_>>().join(" | "))
            }
        };
        let _ = writeln!(text, "channel {}({}) : {urgent}{kind}", c.name, params.join(", "));
    }
    for (i, f) in p.functions.iter().enumerate() {
        function(p, i, f, &mut text);
    }
    for a in &p.automata {
        automaton(p, a, &mut text);
    }
    text
}

fn function(p: &Program, at: usize, f: &AutomatonFunction, text: &mut String) {
    let owner = f.owner.map(|o| &p.automata[usize::from(o.0)]);
    let names = Names::new(p, owner, &[&f.params, &f.locals]);
    let _ =
        writeln!(text, "fn f{at} {} of {:?} {{ {} }}", f.name, owner.map(|o| &o.name), names.body(&f.body));
}

fn automaton(p: &Program, a: &Automaton, text: &mut String) {
    let names = Names::new(p, Some(a), &[]);
    let _ = writeln!(text, "automaton {} {{\n  clock {}", a.name, a.clocks.join(", "));
    for v in &a.vars {
        let _ = writeln!(text, "  var {}: {}..{} = {}", v.name, v.lo, v.hi, v.init);
    }
    for (i, l) in a.locations.iter().enumerate() {
        location(&names, l, if i == usize::from(a.initial.0) { "init " } else { "" }, text);
    }
    for (i, e) in a.edges.iter().enumerate() {
        let _ = writeln!(text, "  {}", edge(p, a, i, e));
    }
    text.push_str("}\n");
}

fn location(names: &Names, l: &Location, init: &str, text: &mut String) {
    let kind = match l.kind {
        LocationKind::Normal => "",
        LocationKind::Urgent => "urgent ",
        LocationKind::Committed => "committed ",
    };
    let mut parts = names.bounds(&l.invariant);
    parts.extend(l.holds.iter().map(|e| names.expr(e)));
    let _ = writeln!(text, "  {init}{kind}location {} {{ {} }}", l.name, parts.join(" && "));
}

fn named(name: &str) -> AutomatonVar {
    AutomatonVar { name: name.to_owned(), lo: 0, hi: 0, init: 0, is_bool: false, enumeration: None }
}

/// One edge of an automaton.
pub fn edge(p: &Program, a: &Automaton, at: usize, e: &Edge) -> String {
    let takes = match &e.sync {
        SyncLabel::Receive { args, .. } | SyncLabel::Accept { args, .. } => args.as_slice(),
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Offer { .. } | SyncLabel::Join { .. } => {
            &[]
        }
    };
    let binds = takes.iter().filter(|t| matches!(t, ReceiveArg::Bind)).count();
    let bound: Vec<AutomatonVar> = (0..binds).map(|i| named(&format!("b{i}"))).collect();
    let names = Names::new(p, Some(a), &[&e.selects, &bound]);
    let place = |l: hrdsl_ir::ta::LocationId| &a.locations[usize::from(l.0)].name;
    let mut text = format!("{} -> {}", place(e.from), place(e.to));
    for s in &e.selects {
        let _ = write!(text, " select {}: {}..{}", s.name, s.lo, s.hi);
    }
    let mut guard = names.bounds(&e.clock_guard);
    guard.extend(e.guard.iter().map(|g| names.expr(g)));
    if !guard.is_empty() {
        let _ = write!(text, " when {}", guard.join(" && "));
    }
    let channel = |c: &hrdsl_ir::ta::ChannelId| &p.channels[usize::from(c.0)].name;
    let mut actions = Vec::new();
    match &e.sync {
        SyncLabel::Internal => {}
        SyncLabel::Send { event, args } => {
            actions.push(format!("{}({})", p.event(*event).name, names.list(args)))
        }
        SyncLabel::Offer { channel: c, args } => {
            actions.push(format!("{}({})", channel(c), names.list(args)))
        }
        SyncLabel::Receive { event, args } => {
            let _ = write!(text, " on {}({args:?})", p.event(*event).name);
        }
        SyncLabel::Accept { channel: c, args } => {
            let _ = write!(text, " on {}({args:?})", channel(c));
        }
        SyncLabel::Join { channel: c } => {
            let _ = write!(text, " on {}", channel(c));
        }
    }
    actions.extend(e.updates.iter().map(|u| names.update(u)));
    if !actions.is_empty() {
        let _ = write!(text, " do {}", actions.join("; "));
    }
    format!("{text}   // edge {at}")
}
