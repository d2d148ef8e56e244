//! Random networks of two or three automata.

use hrdsl_ir::{
    ArgPattern, EventId, Expr, Program, Span, Type, Value,
    expr::{ArrayIndex, BinaryOp, Lvalue},
    ta::{
        Automaton, AutomatonFunction, AutomatonId, Channel, ChannelId, ChannelKind, ChannelParticipant,
        ClockConstraint, ClockId, ClockOp, EdgeAssignment, FunctionId, FunctionStatement, LocationId,
        LocationKind, ReceiveArg, SyncLabel, TimeSum, TimeTerm,
    },
    value::SECOND,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{
    E, add, and, automaton, bin, clock, edge, eq, event, location, n, program, shared, v, var,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flavour {
    /// Events alone.
    Events,
    /// All kinds of channels, too.
    Channels,
    /// Arrays, functions, shared clocks, bounds with variables, clocks that are set, faults, too.
    Whole,
    /// Differences of clocks.
    Differences,
}

/// What the networks' variables are.
const S: u16 = 0;
const Q: u16 = 1;
const OWN: u16 = 3;
const BINDERS: u16 = 4;

struct Dice {
    rng: ChaCha8Rng,
    flavour: Flavour,
}

impl Dice {
    fn below(&mut self, n: u32) -> u32 {
        self.rng.random_range(0..n)
    }
    fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }
    fn upto(&mut self, n: u32) -> i64 {
        i64::from(self.below(n + 1))
    }
    fn op(&mut self) -> ClockOp {
        [ClockOp::Lt, ClockOp::Le, ClockOp::Eq, ClockOp::Ge, ClockOp::Gt][self.below(5) as usize]
    }
    fn whole(&self) -> bool {
        self.flavour == Flavour::Whole
    }
}

fn q_at(at: Expr) -> Lvalue {
    Lvalue { slot: Q, indices: vec![ArrayIndex { at, count: 2, stride: 1 }] }
}

fn rem(a: Expr, k: i64) -> Expr {
    bin(BinaryOp::Rem, a, n(k))
}

fn plus(a: Expr, k: i64) -> Expr {
    bin(BinaryOp::Add, a, n(k))
}

/// The network of a seed.
pub fn network(seed: u64, flavour: Flavour) -> Program {
    let mut d = Dice { rng: ChaCha8Rng::seed_from_u64(seed), flavour };
    let mut p = program();
    shared(&mut p, "s", 0, 2, 0);
    shared(&mut p, "q0", 0, 1, 0);
    shared(&mut p, "q1", 0, 1, 1);
    event(&mut p, "e", &[Type::Int { lo: 0, hi: 2 }]);
    let count = if d.one_in(2) { 2 } else { 3 };
    if flavour != Flavour::Events {
        channels(&mut d, &mut p, count);
    }
    if d.whole() {
        functions(&mut p);
        if d.one_in(3) {
            p.clocks.push("total".into());
        }
    }
    for i in 0..count {
        one(&mut d, &mut p, i, count);
    }
    p
}

fn channels(d: &mut Dice, p: &mut Program, count: u16) {
    let mut participants: Vec<ChannelParticipant> =
        (0..count).map(|i| ChannelParticipant { automaton: AutomatonId(i), optional: d.one_in(3) }).collect();
    if d.one_in(3) {
        participants.reverse();
    }
    if d.one_in(3) {
        participants.pop();
    }
    let kinds = [
        ChannelKind::Binary,
        ChannelKind::Binary,
        ChannelKind::Broadcast,
        ChannelKind::MultiWay(participants),
    ];
    for (i, kind) in kinds.into_iter().enumerate() {
        let plain = matches!(kind, ChannelKind::MultiWay(_)) || i == 0;
        let params = if plain { Vec::new() } else { vec![var("p", 0, 1, 0)] };
        let name = ["h", "k", "b", "j"][i].to_owned();
        p.channels.push(Channel { name, kind, urgent: d.one_in(3), params, origin: Span::default() });
    }
}

/// f0: the next of three; f1: turns the array round; f2: as long as …; f3: changes and gives a value.
fn functions(p: &mut Program) {
    let function = |name: &str, params, locals, result, pure, body| AutomatonFunction {
        name: String::from(name),
        owner: None,
        params,
        locals,
        result,
        pure,
        body,
        origin: Span::default(),
    };
    let k = v(OWN);
    let assign = |place, value| FunctionStatement::Assign { place, value };
    let next = FunctionStatement::Return(Some(rem(plus(k.clone(), 1), 3)));
    p.functions.push(function(
        "next",
        vec![var("k", 0, 2, 0)],
        Vec::new(),
        Some(var("r", 0, 2, 0)),
        true,
        vec![next],
    ));
    let swap = vec![
        assign(Lvalue::slot(OWN), Expr::Element(Box::new(q_at(n(0))))),
        assign(q_at(n(0)), Expr::Element(Box::new(q_at(n(1))))),
        assign(q_at(n(1)), k.clone()),
    ];
    p.functions.push(function("swap", Vec::new(), vec![var("t", 0, 1, 0)], None, false, swap));
    let bit = Expr::Element(Box::new(q_at(v(OWN + 1))));
    let count = FunctionStatement::For {
        slot: OWN + 1,
        lo: n(0),
        hi: n(1),
        body: vec![FunctionStatement::If {
            condition: eq(bit, n(1)),
            then: vec![assign(Lvalue::slot(OWN), plus(k.clone(), 1))],
            otherwise: Vec::new(),
        }],
    };
    let down = FunctionStatement::While {
        condition: bin(BinaryOp::Gt, k.clone(), v(S)),
        body: vec![assign(Lvalue::slot(OWN), bin(BinaryOp::Sub, k.clone(), n(1)))],
    };
    let body = vec![assign(Lvalue::slot(OWN), n(0)), count, down, FunctionStatement::Return(Some(k.clone()))];
    let locals = vec![var("sum", 0, 2, 0), var("i", 0, 1, 0)];
    p.functions.push(function("ones", Vec::new(), locals, Some(var("r", 0, 2, 0)), true, body));
    let set = vec![assign(q_at(n(1)), rem(k.clone(), 2)), assign(Lvalue::slot(S), k.clone())];
    p.functions.push(function("store", vec![var("k", 0, 2, 0)], Vec::new(), None, false, set));
}

fn one(d: &mut Dice, p: &mut Program, i: u16, count: u16) {
    let names = ["x", "y"];
    let two = if d.flavour == Flavour::Differences { i == 0 } else { count == 2 && d.one_in(2) };
    let own = if two { 2 } else { 1 };
    let mut a = automaton(&format!("A{i}"), &names[..own]);
    a.vars.push(var("m", 0, 1, 0));
    let clocks = (p.clocks.len() + own) as u16;
    for l in 0..2 + d.below(3) {
        let kind = match d.below(8) {
            0 => LocationKind::Committed,
            1 => LocationKind::Urgent,
            _ => LocationKind::Normal,
        };
        let mut invariant = Vec::new();
        if d.one_in(3) {
            let op = if d.one_in(2) { ClockOp::Lt } else { ClockOp::Le };
            let c = d.below(u32::from(clocks)) as u16;
            invariant.push(clock(c, op, 1 + d.upto(2)));
        }
        if d.whole() && d.one_in(8) {
            invariant.push(clock(d.below(u32::from(clocks)) as u16, d.op(), d.upto(1)));
        }
        if d.flavour == Flavour::Differences && two && d.one_in(5) {
            invariant.push(difference(d));
        }
        let at = location(&mut a, &format!("l{l}"), kind, &invariant);
        if d.whole() && d.one_in(6) {
            let limit = d.upto(2);
            a.locations[usize::from(at.0)].holds = Some(bin(BinaryOp::Le, v(S), n(limit)));
        }
        if d.whole() && d.one_in(5) {
            let op = if d.one_in(2) { ClockOp::Lt } else { ClockOp::Le };
            let bound = timed(d, 1);
            let c = ClockId(d.below(u32::from(clocks)) as u16);
            a.locations[usize::from(at.0)].invariant.push(ClockConstraint {
                clock: c,
                minus: None,
                op,
                bound,
            });
        }
    }
    for _ in 0..3 + d.below(5) {
        random_edge(d, p, &mut a, clocks, two);
    }
    add(p, a);
}

/// A time in which a variable has a part: `base + s` seconds or less.
fn timed(d: &mut Dice, base: i64) -> TimeSum {
    let value = match d.below(40) {
        // A fault, if it is 2.
        0 => Expr::Element(Box::new(q_at(v(S)))),
        n if n % 3 == 0 => v(S),
        n if n % 3 == 1 => v(OWN),
        _ => Expr::Element(Box::new(q_at(v(OWN)))),
    };
    let factor = if d.one_in(4) { -SECOND } else { SECOND };
    TimeSum { nanos: base * SECOND, terms: vec![TimeTerm { factor, value }] }
}

fn difference(d: &mut Dice) -> ClockConstraint {
    let bound = TimeSum::constant((d.upto(5) - 2) * SECOND);
    ClockConstraint { clock: ClockId(0), minus: Some(ClockId(1)), op: d.op(), bound }
}

fn random_edge(d: &mut Dice, p: &Program, a: &mut Automaton, clocks: u16, two: bool) {
    let locations = a.locations.len() as u32;
    let (from, to) = (d.below(locations) as u16, d.below(locations) as u16);
    let mut it = edge(LocationId(from), LocationId(to));
    let selected = d.one_in(4);
    if selected {
        it = it.select(var("k", 0, 2, 0));
    }
    it = synced(d, p, it, selected);
    let mute = match &it.0.sync {
        SyncLabel::Offer { channel, .. } | SyncLabel::Join { channel } => {
            p.channels[usize::from(channel.0)].urgent
        }
        SyncLabel::Accept { channel, .. } => {
            let c = &p.channels[usize::from(channel.0)];
            c.urgent && c.kind != ChannelKind::Broadcast
        }
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Receive { .. } => false,
    };
    while !mute && d.one_in(2) {
        it = it.clock(d.below(u32::from(clocks)) as u16, d.op(), d.upto(3));
    }
    if !mute && d.flavour == Flavour::Differences && two && d.one_in(2) {
        it.0.clock_guard.push(difference(d));
    }
    if !mute && d.whole() && d.one_in(4) {
        let (op, bound) = (d.op(), timed(d, 1));
        let c = ClockId(d.below(u32::from(clocks)) as u16);
        it.0.clock_guard.push(ClockConstraint { clock: c, minus: None, op, bound });
    }
    it = guarded(d, it);
    updated(d, it, clocks, selected).to(a);
}

fn guarded(d: &mut Dice, mut it: E) -> E {
    if d.one_in(3) {
        it = it.when(eq(v(S), n(d.upto(2))));
    }
    if d.one_in(6) {
        it = it.when(eq(v(OWN), n(d.upto(1))));
    }
    if d.whole() && d.one_in(5) {
        let left = match d.below(3) {
            0 => Expr::Apply(FunctionId(0), vec![v(S)]),
            1 => Expr::Apply(FunctionId(2), Vec::new()),
            _ => Expr::Element(Box::new(q_at(if d.one_in(4) { v(S) } else { v(OWN) }))),
        };
        it = it.when(bin(BinaryOp::Ge, left, n(1)));
    }
    it
}

fn synced(d: &mut Dice, p: &Program, it: E, selected: bool) -> E {
    let e = EventId(0);
    let over = |c: u16| ChannelId(c);
    let kinds = if p.channels.is_empty() { 3 } else { 9 };
    let binder = v(BINDERS);
    let mut it = it;
    match d.below(kinds) {
        0 => {}
        1 => {
            let arg = if selected { binder } else { number(d, 3) };
            it = it.send_args(e, &[arg]);
        }
        2 => it = taken(d, it, selected, 2, |args| SyncLabel::Receive { event: EventId(0), args }),
        3 => it.0.sync = SyncLabel::Offer { channel: over(0), args: Vec::new() },
        4 => it.0.sync = SyncLabel::Accept { channel: over(0), args: Vec::new() },
        5 | 6 => {
            let channel = over(1 + d.below(2) as u16);
            let arg = if selected { rem(binder, 2) } else { number(d, 2) };
            if d.one_in(2) {
                it.0.sync = SyncLabel::Offer { channel, args: vec![arg] };
            } else {
                it = taken(d, it, selected, 1, |args| SyncLabel::Accept { channel, args });
            }
        }
        7 => {
            let channel = over(1 + d.below(2) as u16);
            it = taken(d, it, selected, 1, |args| SyncLabel::Accept { channel, args });
        }
        // Only participants join.
        _ if is_participant(p) => it.0.sync = SyncLabel::Join { channel: over(3) },
        _ => {}
    }
    it
}

/// Whether the automaton that comes next is a participant of the multi-way channel.
fn is_participant(p: &Program) -> bool {
    let next = AutomatonId(p.automata.len() as u16);
    p.channels.iter().any(|c| match &c.kind {
        ChannelKind::MultiWay(participants) => participants.iter().any(|q| q.automaton == next),
        ChannelKind::Binary | ChannelKind::Broadcast => false,
    })
}

/// An edge that takes one argument of `0..=most`: any, one value, or bound.
fn taken(
    d: &mut Dice,
    mut it: E,
    selected: bool,
    most: u32,
    sync: impl Fn(Vec<ReceiveArg>) -> SyncLabel,
) -> E {
    let arg = match d.below(3) {
        0 => ReceiveArg::Match(ArgPattern::Any),
        1 => ReceiveArg::Match(ArgPattern::Is(Value::Int(d.upto(most)))),
        _ => ReceiveArg::Bind,
    };
    it.0.sync = sync(vec![arg]);
    if arg == ReceiveArg::Bind {
        let bound = v(BINDERS + u16::from(selected));
        if d.one_in(2) {
            it = it.when(and(bin(BinaryOp::Lt, bound.clone(), n(i64::from(most))), Expr::bool(true)));
        }
        it = it.set(S, bound);
    }
    it
}

/// An expression with a value of `0..k`.
fn number(d: &mut Dice, k: i64) -> Expr {
    match d.below(if d.whole() { 5 } else { 3 }) {
        0 => n(i64::from(d.below(k as u32))),
        1 => rem(v(S), k),
        2 => rem(plus(v(S), 1), k),
        3 => rem(Expr::Apply(FunctionId(2), Vec::new()), k),
        _ => rem(Expr::Element(Box::new(q_at(v(OWN)))), k),
    }
}

fn updated(d: &mut Dice, mut it: E, clocks: u16, selected: bool) -> E {
    if selected && d.one_in(2) {
        it = it.set(S, v(BINDERS));
    }
    if d.one_in(3) {
        let value = number(d, 3);
        it = it.set(S, value);
    }
    if d.one_in(5) {
        it = it.set(OWN, bin(BinaryOp::Sub, n(1), v(OWN)));
    }
    for x in 0..clocks {
        if d.one_in(3) {
            it = it.reset(x);
        }
    }
    if d.whole() {
        it = richly(d, it, clocks);
    }
    it
}

/// Clocks that are set, arrays, functions, and now and then a fault.
fn richly(d: &mut Dice, mut it: E, clocks: u16) -> E {
    let any = |d: &mut Dice| ClockId(d.below(u32::from(clocks)) as u16);
    let mut push = |u: EdgeAssignment| it.0.updates.push(u);
    if d.one_in(6) {
        let to = if d.one_in(3) { timed(d, 1) } else { TimeSum::constant(d.upto(3) * SECOND) };
        push(EdgeAssignment::Reset { clock: any(d), from: None, to });
    }
    if d.one_in(6) {
        let to = TimeSum::constant(if d.one_in(3) { SECOND } else { 0 });
        push(EdgeAssignment::Reset { clock: any(d), from: Some(any(d)), to });
    }
    match d.below(12) {
        0 => push(EdgeAssignment::Call { function: FunctionId(1), args: Vec::new() }),
        1 => push(EdgeAssignment::Call { function: FunctionId(3), args: vec![v(S)] }),
        2 | 3 => push(EdgeAssignment::Assign { place: q_at(v(OWN)), value: rem(v(S), 2) }),
        4 => push(EdgeAssignment::Assign {
            place: Lvalue::slot(S),
            value: Expr::Apply(FunctionId(0), vec![v(S)]),
        }),
        _ => {}
    }
    if d.one_in(60) {
        push(EdgeAssignment::Assign { place: q_at(v(S)), value: n(1) });
    }
    if d.one_in(60) {
        push(EdgeAssignment::Assign { place: Lvalue::slot(S), value: plus(v(S), 1) });
    }
    it
}
