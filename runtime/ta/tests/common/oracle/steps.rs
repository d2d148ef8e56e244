//! The transitions of a state: who takes part by which edge, and the state after it.

use std::cell::{Cell, RefCell};

use hrdsl_ir::{ArgPattern, EventId, expr::Expr};
use hrdsl_ir::{
    Program, Value,
    ta::{
        Automaton, AutomatonId, AutomatonVar, ChannelId, ChannelKind, ClockConstraint, ClockId, Edge,
        EdgeAssignment, Location, LocationKind, ReceiveArg, SyncLabel,
    },
};

use super::{
    Fault, Stop,
    data::{Here, Layout},
    region::{self, Grain, Region},
};

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct State {
    pub at: Vec<u16>,
    pub data: Vec<i64>,
    pub clocks: Region,
}

/// One automaton's part in a transition, with the values of the edge's binders.
#[derive(Clone, Debug)]
pub struct Part {
    pub member: usize,
    pub edge: usize,
    pub binders: Vec<Value>,
    /// Its guard, a bound or an argument has no value: a fault, if the transition is possible otherwise.
    fault: Option<Fault>,
}

/// What an edge that is looked for takes.
#[derive(Clone, Copy, PartialEq)]
enum Over {
    Event(EventId),
    Channel(ChannelId),
}

/// A network, as the interpreter sees it.
pub struct Net<'p> {
    pub layout: Layout<'p>,
    pub grain: Grain,
    /// Nanoseconds.
    pub unit: i64,
    first_clock: Vec<usize>,
    pub clocks: usize,
    statements: Cell<u32>,
}

impl<'p> Net<'p> {
    pub fn new(p: &'p Program, members: &[AutomatonId], grain: Grain, unit: i64) -> Self {
        let layout = Layout::new(p, members);
        let mut clocks = p.clocks.len();
        let mut first_clock = Vec::new();
        for &m in &layout.members {
            first_clock.push(clocks);
            clocks += p.automata[m].clocks.len();
        }
        Self { layout, grain, unit, first_clock, clocks, statements: Cell::new(0) }
    }

    pub fn automaton(&self, member: usize) -> &'p Automaton {
        &self.layout.p.automata[self.layout.members[member]]
    }

    pub fn members(&self) -> usize {
        self.layout.members.len()
    }

    pub fn start(&self) -> State {
        State {
            at: (0..self.members()).map(|m| self.automaton(m).initial.0).collect(),
            data: self.layout.vars.iter().map(|v| v.init).collect(),
            clocks: vec![(0, 0); self.clocks],
        }
    }

    fn location(&self, s: &State, member: usize) -> &'p Location {
        &self.automaton(member).locations[usize::from(s.at[member])]
    }

    fn edge(&self, part: &Part) -> &'p Edge {
        &self.automaton(part.member).edges[part.edge]
    }

    fn clock(&self, member: usize, clock: ClockId) -> usize {
        let (n, shared) = (usize::from(clock.0), self.layout.p.clocks.len());
        if n < shared { n } else { self.first_clock[member] + n - shared }
    }

    fn units(&self, nanos: i64) -> Result<i64, Stop> {
        if nanos % self.unit == 0 {
            return Ok(nanos / self.unit);
        }
        Err(Stop::Outside("a time that is no whole number of units".to_owned()))
    }

    /// Whether all constraints hold. A false one decides, whatever the others are.
    fn allows(&self, s: &State, member: usize, here: &Here, cs: &[ClockConstraint]) -> Result<bool, Stop> {
        let mut fault = None;
        for c in cs {
            let bound = match here.time(&c.bound) {
                Ok(nanos) => self.units(nanos)?,
                Err(stop) => {
                    fault = Some(stop);
                    continue;
                }
            };
            let of = |c: ClockId| s.clocks[self.clock(member, c)];
            let minus = c.minus.map_or((0, 0), of);
            let holds = region::holds(self.grain, of(c.clock), minus, c.op, bound);
            match holds {
                Some(true) => {}
                Some(false) => return Ok(false),
                None => return Err(Stop::Outside(format!("the bound {bound}"))),
            }
        }
        fault.map_or(Ok(true), Err)
    }

    /// The invariants of all locations: the parts over variables and the bounds one after the other, then the clocks.
    pub fn invariants(&self, s: &State) -> Result<bool, Stop> {
        let data = RefCell::new(s.data.clone());
        let here = |m| Here::of_member(&self.layout, &data, m, &[], &self.statements);
        for m in 0..self.members() {
            let location = self.location(s, m);
            if let Some(holds) = &location.holds
                && !here(m).truth(holds)?
            {
                return Ok(false);
            }
            for c in &location.invariant {
                here(m).time(&c.bound)?;
            }
        }
        for m in 0..self.members() {
            if !self.allows(s, m, &here(m), &self.location(s, m).invariant)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether time may pass, invariants aside.
    pub fn patient(&self, s: &State) -> Result<bool, Stop> {
        let normal = (0..self.members()).all(|m| self.location(s, m).kind == LocationKind::Normal);
        Ok(normal && !self.urgent(s)?)
    }

    /// Whether a transition over an urgent channel is possible.
    fn urgent(&self, s: &State) -> Result<bool, Stop> {
        let channels = &self.layout.p.channels;
        for (c, id) in channels.iter().zip((0..).map(ChannelId)).filter(|(c, _)| c.urgent) {
            let possible = match &c.kind {
                ChannelKind::MultiWay(_) => !self.multi_ways(s, id)?.is_empty(),
                ChannelKind::Broadcast => !self.offers(s, id)?.is_empty(),
                ChannelKind::Binary => {
                    let mut any = false;
                    for offer in self.offers(s, id)? {
                        any |= !self.pairs(s, id, &offer)?.is_empty();
                    }
                    any
                }
            };
            if possible {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The bindings with which an edge is open.
    fn ways(&self, s: &State, member: usize, e: usize, received: &[Value]) -> Result<Vec<Part>, Stop> {
        let edge = &self.automaton(member).edges[e];
        let mut found = Vec::new();
        if edge.from.0 != s.at[member] {
            return Ok(found);
        }
        let Some(bound) = bound(&edge.sync, received) else { return Ok(found) };
        let data = RefCell::new(s.data.clone());
        for mut binders in choices(&edge.selects) {
            binders.extend(&bound);
            let here = Here::of_member(&self.layout, &data, member, &binders, &self.statements);
            let guard = edge.guard.as_ref().map_or(Ok(true), |g| here.truth(g));
            if matches!(guard, Ok(false)) {
                continue;
            }
            let clocks = self.allows(s, member, &here, &edge.clock_guard);
            if matches!(clocks, Ok(false)) {
                continue;
            }
            let fault = match guard.and(clocks) {
                Ok(_) => None,
                Err(Stop::Fault(fault)) => Some(fault),
                Err(outside @ Stop::Outside(_)) => return Err(outside),
            };
            found.push(Part { member, edge: e, binders, fault });
        }
        Ok(found)
    }

    /// The open edges by which a member takes an event or accepts.
    fn takers(&self, s: &State, member: usize, over: Over, values: &[Value]) -> Result<Vec<Part>, Stop> {
        let mut found = Vec::new();
        for (e, edge) in self.automaton(member).edges.iter().enumerate() {
            if takes(edge, over) {
                found.extend(self.ways(s, member, e, values)?);
            }
        }
        Ok(found)
    }

    fn offers(&self, s: &State, over: ChannelId) -> Result<Vec<Part>, Stop> {
        let mut found = Vec::new();
        for member in 0..self.members() {
            for (e, edge) in self.automaton(member).edges.iter().enumerate() {
                if matches!(edge.sync, SyncLabel::Offer { channel, .. } if channel == over) {
                    found.extend(self.ways(s, member, e, &[])?);
                }
            }
        }
        Ok(found)
    }

    /// What a sender's arguments are, checked against the parameters.
    fn arguments(&self, s: &State, part: &Part) -> Result<(Over, Vec<Value>), Stop> {
        let data = RefCell::new(s.data.clone());
        let here = Here::of_member(&self.layout, &data, part.member, &part.binders, &self.statements);
        let p = self.layout.p;
        let (over, args) = begun(self.edge(part)).expect("a sender sends or offers");
        let mut values = Vec::new();
        for (at, arg) in args.iter().enumerate() {
            let value = here.value(arg)?;
            let fits = match over {
                Over::Event(e) => p.event(e).params[at].ty.admits(value),
                Over::Channel(c) => admits(&p.channels[usize::from(c.0)].params[at], value),
            };
            if !fits {
                return Err(Stop::Fault(Fault::Argument(at)));
            }
            values.push(value);
        }
        Ok((over, values))
    }

    /// The groups of a binary synchronisation with one offer.
    fn pairs(&self, s: &State, channel: ChannelId, offer: &Part) -> Result<Vec<Vec<Part>>, Stop> {
        if offer.fault.is_some() {
            return Ok(vec![vec![offer.clone()]]);
        }
        let values = match self.arguments(s, offer) {
            Ok((_, values)) => values,
            Err(Stop::Fault(fault)) => return Ok(vec![vec![Part { fault: Some(fault), ..offer.clone() }]]),
            Err(outside) => return Err(outside),
        };
        let mut groups = Vec::new();
        for j in (0..self.members()).filter(|&j| j != offer.member) {
            let accepts = self.takers(s, j, Over::Channel(channel), &values)?;
            groups.extend(accepts.into_iter().map(|a| vec![offer.clone(), a]));
        }
        Ok(groups)
    }

    /// The groups of a broadcast by one sender.
    fn broadcasts(&self, s: &State, sender: &Part) -> Result<Vec<Vec<Part>>, Stop> {
        if sender.fault.is_some() {
            return Ok(vec![vec![sender.clone()]]);
        }
        let (over, values) = match self.arguments(s, sender) {
            Ok(found) => found,
            Err(Stop::Fault(fault)) => return Ok(vec![vec![Part { fault: Some(fault), ..sender.clone() }]]),
            Err(outside) => return Err(outside),
        };
        let mut groups = vec![vec![sender.clone()]];
        for j in (0..self.members()).filter(|&j| j != sender.member) {
            let takers = self.takers(s, j, over, &values)?;
            if !takers.is_empty() {
                groups = product(&groups, &takers);
            }
        }
        Ok(groups)
    }

    /// The groups of a multi-way channel.
    fn multi_ways(&self, s: &State, over: ChannelId) -> Result<Vec<Vec<Part>>, Stop> {
        let ChannelKind::MultiWay(participants) = &self.layout.p.channels[usize::from(over.0)].kind else {
            return Ok(Vec::new());
        };
        let mut groups = vec![Vec::new()];
        for participant in participants {
            let member = self.layout.members.iter().position(|&m| m == usize::from(participant.automaton.0));
            let Some(member) = member else { continue };
            let mut ways = Vec::new();
            for (e, edge) in self.automaton(member).edges.iter().enumerate() {
                if matches!(edge.sync, SyncLabel::Join { channel } if channel == over) {
                    ways.extend(self.ways(s, member, e, &[])?);
                }
            }
            if !ways.is_empty() {
                groups = product(&groups, &ways);
            } else if !participant.optional {
                return Ok(Vec::new());
            }
        }
        groups.retain(|g| !g.is_empty());
        Ok(groups)
    }

    /// All groups that make a transition, committed locations and invariants aside.
    pub fn groups(&self, s: &State) -> Result<Vec<Vec<Part>>, Stop> {
        let mut groups = Vec::new();
        for member in 0..self.members() {
            for (e, edge) in self.automaton(member).edges.iter().enumerate() {
                match &edge.sync {
                    SyncLabel::Internal => {
                        groups.extend(self.ways(s, member, e, &[])?.into_iter().map(|w| vec![w]))
                    }
                    SyncLabel::Send { .. } => {
                        for way in self.ways(s, member, e, &[])? {
                            groups.extend(self.broadcasts(s, &way)?);
                        }
                    }
                    SyncLabel::Offer { channel, .. } => {
                        let kind = &self.layout.p.channels[usize::from(channel.0)].kind;
                        for way in self.ways(s, member, e, &[])? {
                            groups.extend(match kind {
                                ChannelKind::Binary => self.pairs(s, *channel, &way)?,
                                ChannelKind::Broadcast => self.broadcasts(s, &way)?,
                                ChannelKind::MultiWay(_) => Vec::new(),
                            });
                        }
                    }
                    SyncLabel::Receive { .. } | SyncLabel::Accept { .. } | SyncLabel::Join { .. } => {}
                }
            }
        }
        for c in 0..self.layout.p.channels.len() {
            groups.extend(self.multi_ways(s, ChannelId(c as u16))?);
        }
        Ok(groups)
    }

    /// The state after a transition. `None`: a committed location or an invariant forbids it.
    pub fn after(&self, s: &State, group: &[Part]) -> Result<Option<State>, Stop> {
        let committed = |m: usize| self.location(s, m).kind == LocationKind::Committed;
        let calls = |p: &Part| group.len() == 1 && p.fault.is_some() && self.calls_committed(s, p);
        if (0..self.members()).any(committed) && !group.iter().any(|p| committed(p.member) || calls(p)) {
            return Ok(None);
        }
        if let Some(fault) = group.iter().find_map(|p| p.fault.clone()) {
            return Err(Stop::Fault(fault));
        }
        let mut next = s.clone();
        let data = RefCell::new(s.data.clone());
        for part in group {
            let edge = self.edge(part);
            let here = Here::of_member(&self.layout, &data, part.member, &part.binders, &self.statements);
            for update in &edge.updates {
                match update {
                    EdgeAssignment::Assign { place, value } => here.assign(place, value)?,
                    EdgeAssignment::Call { function, args } => {
                        here.call(*function, args)?;
                    }
                    EdgeAssignment::Reset { clock, from, to } => {
                        let to = self.units(here.time(to)?)?;
                        let at = self.clock(part.member, *clock);
                        let old = from.map_or((0, 0), |f| next.clocks[self.clock(part.member, f)]);
                        next.clocks[at] = self.moved(at, old, to)?;
                    }
                }
            }
            next.at[part.member] = edge.to.0;
        }
        next.data = data.into_inner();
        region::tidy(self.grain, &mut next.clocks);
        Ok(self.invariants(&next)?.then_some(next))
    }

    /// Whether an automaton in a committed location has an edge for what this one sends or offers.
    fn calls_committed(&self, s: &State, sender: &Part) -> bool {
        let Some((over, _)) = begun(self.edge(sender)) else { return false };
        (0..self.members()).any(|m| {
            let committed = m != sender.member && self.location(s, m).kind == LocationKind::Committed;
            committed && self.automaton(m).edges.iter().any(|e| e.from.0 == s.at[m] && takes(e, over))
        })
    }

    fn moved(&self, clock: usize, from: (i64, u8), by: i64) -> Result<(i64, u8), Stop> {
        if self.grain.differences && from != (0, 0) && by != 0 {
            return Err(Stop::Outside("a shifted clock where differences are compared".to_owned()));
        }
        if by < 0 && from.0 > self.grain.most {
            return Err(Stop::Outside("a shift back from above all constants".to_owned()));
        }
        if from.0 + by < 0 {
            return Err(Stop::Fault(Fault::Clock(clock)));
        }
        Ok((from.0 + by, from.1))
    }
}

fn product(groups: &[Vec<Part>], ways: &[Part]) -> Vec<Vec<Part>> {
    let with = |g: &Vec<Part>, w: &Part| [g.as_slice(), std::slice::from_ref(w)].concat();
    groups.iter().flat_map(|g| ways.iter().map(move |w| with(g, w))).collect()
}

/// What an edge binds of what it takes. `None`: an argument does not match.
fn bound(sync: &SyncLabel, received: &[Value]) -> Option<Vec<Value>> {
    let args = match sync {
        SyncLabel::Receive { args, .. } | SyncLabel::Accept { args, .. } => args.as_slice(),
        SyncLabel::Internal | SyncLabel::Send { .. } | SyncLabel::Offer { .. } | SyncLabel::Join { .. } => {
            return Some(Vec::new());
        }
    };
    let mut bound = Vec::new();
    for (arg, value) in args.iter().zip(received) {
        match arg {
            ReceiveArg::Bind => bound.push(*value),
            ReceiveArg::Match(ArgPattern::Any) => {}
            ReceiveArg::Match(ArgPattern::Is(want)) if want.key() == value.key() => {}
            ReceiveArg::Match(ArgPattern::Is(_)) => return None,
        }
    }
    Some(bound)
}

fn admits(param: &AutomatonVar, value: Value) -> bool {
    param.number(value).is_some_and(|n| param.lo <= n && n <= param.hi)
}

/// Every choice of values.
fn choices(selects: &[AutomatonVar]) -> Vec<Vec<Value>> {
    let mut all = vec![Vec::new()];
    for x in selects {
        let values: Vec<Value> = (x.lo..=x.hi).filter_map(|n| x.value(n)).collect();
        let with = |old: &Vec<Value>, v: &Value| [old.as_slice(), &[*v]].concat();
        all = all.iter().flat_map(|old| values.iter().map(move |v| with(old, v))).collect();
    }
    all
}

/// What an edge begins that others take part in, with its arguments.
fn begun(edge: &Edge) -> Option<(Over, &[Expr])> {
    let sent = edge.sync.as_send().map(|(event, args)| (Over::Event(event), args));
    sent.or(edge.sync.as_offer().map(|(channel, args)| (Over::Channel(channel), args)))
}

/// Whether an edge takes this event, or accepts over this channel.
fn takes(edge: &Edge, over: Over) -> bool {
    match over {
        Over::Event(event) => edge.sync.as_receive().is_some_and(|(taken, _)| taken == event),
        Over::Channel(channel) => edge.sync.as_accept().is_some_and(|(taken, _)| taken == channel),
    }
}
