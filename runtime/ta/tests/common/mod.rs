//! Builds programs of timed automata, and the standard families.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod asked;
pub mod counted;
pub mod deadlines;
pub mod families;
pub mod grid;
pub mod processor;

use hrdsl_ir::{
    Actor, ActorId, ArgPattern, Event, EventId, Expr, Parameter, Program, Role, Span, Type, Value,
    expr::{ArrayIndex, BinaryOp, Lvalue},
    ta::{
        Automaton, AutomatonId, AutomatonVar, Channel, ChannelId, ChannelKind, ClockConstraint, ClockId,
        ClockOp, Edge, EdgeAssignment, Location, LocationId, LocationKind, Network, ReceiveArg, SyncLabel,
        TimeSum,
    },
    value::SECOND,
};

/// A program with one network, `all`, of all its automata.
pub fn program() -> Program {
    let actor = |name: &str, role| Actor { name: name.into(), role, origin: Span::default() };
    Program {
        actors: vec![actor("env", Role::Environment), actor("sys", Role::System)],
        networks: vec![Network { name: "all".into(), automata: Vec::new(), origin: Span::default() }],
        ..Program::default()
    }
}

pub fn shared(p: &mut Program, name: &str, lo: i64, hi: i64, init: i64) -> u16 {
    p.shared.push(var(name, lo, hi, init));
    p.shared.len() as u16 - 1
}

pub fn var(name: &str, lo: i64, hi: i64, init: i64) -> AutomatonVar {
    AutomatonVar { name: name.into(), lo, hi, init, is_bool: false, enumeration: None }
}

pub fn event(p: &mut Program, name: &str, params: &[Type]) -> EventId {
    p.events.push(Event {
        name: name.into(),
        params: params.iter().map(|&ty| Parameter { name: "p".into(), ty }).collect(),
        from: ActorId(0),
        to: Vec::new(),
        stimulus: None,
        origin: Span::default(),
    });
    EventId(p.events.len() as u16 - 1)
}

/// A channel with integer parameters of these ranges.
pub fn channel(p: &mut Program, name: &str, kind: ChannelKind, params: &[(i64, i64)]) -> ChannelId {
    p.channels.push(Channel {
        name: name.into(),
        kind,
        urgent: false,
        params: params.iter().map(|&(lo, hi)| var("p", lo, hi, lo)).collect(),
        origin: Span::default(),
    });
    ChannelId(p.channels.len() as u16 - 1)
}

/// An element of an array of `count` variables that begins at `slot`.
pub fn place(slot: u16, at: Expr, count: i64) -> Lvalue {
    Lvalue { slot, indices: vec![ArrayIndex { at, count: count as u16, stride: 1 }] }
}

pub fn element(slot: u16, at: Expr, count: i64) -> Expr {
    Expr::Element(Box::new(place(slot, at, count)))
}

/// An automaton without locations and edges, of one clock for each name.
pub fn automaton(name: &str, clocks: &[&str]) -> Automaton {
    Automaton {
        name: name.into(),
        actor: Some(ActorId(0)),
        clocks: clocks.iter().map(|c| (*c).into()).collect(),
        vars: Vec::new(),
        locations: Vec::new(),
        initial: LocationId(0),
        edges: Vec::new(),
        origin: Span::default(),
    }
}

/// Adds it to the program and its network.
pub fn add(p: &mut Program, a: Automaton) -> AutomatonId {
    p.automata.push(a);
    let id = AutomatonId(p.automata.len() as u16 - 1);
    p.networks[0].automata.push(id);
    id
}

pub fn location(
    a: &mut Automaton,
    name: &str,
    kind: LocationKind,
    invariant: &[ClockConstraint],
) -> LocationId {
    a.locations.push(Location {
        holds: None,
        stopped: Vec::new(),
        name: name.into(),
        kind,
        invariant: invariant.to_vec(),
        origin: Span::default(),
    });
    LocationId(a.locations.len() as u16 - 1)
}

pub fn normal(a: &mut Automaton, name: &str) -> LocationId {
    location(a, name, LocationKind::Normal, &[])
}

/// `clock op n` seconds
pub fn clock(clock: u16, op: ClockOp, n: i64) -> ClockConstraint {
    ClockConstraint { clock: ClockId(clock), minus: None, op, bound: TimeSum::constant(n * SECOND) }
}

/// An edge under construction.
pub struct E(pub Edge);

pub fn edge(from: LocationId, to: LocationId) -> E {
    E(Edge {
        from,
        to,
        selects: Vec::new(),
        clock_guard: Vec::new(),
        guard: None,
        sync: SyncLabel::Internal,
        updates: Vec::new(),
        origin: Span::default(),
    })
}

impl E {
    pub fn clock(mut self, x: u16, op: ClockOp, n: i64) -> Self {
        self.0.clock_guard.push(clock(x, op, n));
        self
    }
    pub fn when(mut self, guard: Expr) -> Self {
        self.0.guard = Some(match self.0.guard.take() {
            None => guard,
            Some(g) => Expr::binary(BinaryOp::And, g, guard),
        });
        self
    }
    pub fn send(mut self, event: EventId) -> Self {
        self.0.sync = SyncLabel::Send { event, args: Vec::new() };
        self
    }
    pub fn send_args(mut self, event: EventId, args: &[Expr]) -> Self {
        self.0.sync = SyncLabel::Send { event, args: args.to_vec() };
        self
    }
    pub fn on(mut self, event: EventId) -> Self {
        self.0.sync = SyncLabel::Receive { event, args: Vec::new() };
        self
    }
    pub fn on_args(mut self, event: EventId, args: &[ReceiveArg]) -> Self {
        self.0.sync = SyncLabel::Receive { event, args: args.to_vec() };
        self
    }
    pub fn offer(mut self, channel: ChannelId, args: &[Expr]) -> Self {
        self.0.sync = SyncLabel::Offer { channel, args: args.to_vec() };
        self
    }
    /// Accepts exactly these arguments.
    pub fn accept(mut self, channel: ChannelId, args: &[i64]) -> Self {
        let is = |n: &i64| ReceiveArg::Match(ArgPattern::Is(Value::Int(*n)));
        self.0.sync = SyncLabel::Accept { channel, args: args.iter().map(is).collect() };
        self
    }
    /// Accepts any argument and binds it.
    pub fn bind(mut self, channel: ChannelId) -> Self {
        self.0.sync = SyncLabel::Accept { channel, args: vec![ReceiveArg::Bind] };
        self
    }
    pub fn join(mut self, channel: ChannelId) -> Self {
        self.0.sync = SyncLabel::Join { channel };
        self
    }
    pub fn put(mut self, place: Lvalue, value: Expr) -> Self {
        self.0.updates.push(EdgeAssignment::Assign { place, value });
        self
    }
    pub fn set(mut self, slot: u16, value: Expr) -> Self {
        self.0.updates.push(EdgeAssignment::Assign { place: Lvalue::slot(slot), value });
        self
    }
    pub fn reset(mut self, clock: u16) -> Self {
        self.0.updates.push(EdgeAssignment::zero(ClockId(clock)));
        self
    }
    pub fn select(mut self, v: AutomatonVar) -> Self {
        self.0.selects.push(v);
        self
    }
    pub fn to(self, a: &mut Automaton) {
        a.edges.push(self.0);
    }
}

pub fn v(i: u16) -> Expr {
    Expr::Var(i)
}

pub fn n(k: i64) -> Expr {
    Expr::int(k)
}

pub fn eq(a: Expr, b: Expr) -> Expr {
    Expr::binary(BinaryOp::Eq, a, b)
}

pub fn bin(op: BinaryOp, a: Expr, b: Expr) -> Expr {
    Expr::binary(op, a, b)
}

pub fn or(a: Expr, b: Expr) -> Expr {
    Expr::binary(BinaryOp::Or, a, b)
}

pub fn and(a: Expr, b: Expr) -> Expr {
    Expr::binary(BinaryOp::And, a, b)
}
