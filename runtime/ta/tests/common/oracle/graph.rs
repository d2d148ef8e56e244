//! The graph of regions of a network, and what holds in it.

use std::{
    cell::{Cell, RefCell},
    collections::{BTreeMap, BTreeSet, VecDeque},
};

use hrdsl_ir::{
    Program, Value,
    expr::{EvalError, EvalScope},
    ta::{
        ClockConstraint, EdgeAssignment, FunctionId, Location, Network, QueryFormula, TimeSum,
        located_automaton,
    },
};
use rustc_hash::FxHashMap;

use super::{
    Fault, Stop,
    data::Here,
    region::{self, Grain},
    steps::{Net, Part, State},
};

/// How much a network may need.
#[derive(Clone, Copy)]
pub struct Limits {
    pub states: usize,
    /// The greatest constant that a bound with variables may become, in units.
    pub bound: i64,
    /// Formulas compare differences of clocks.
    pub differences: bool,
}

/// All that can be reached.
pub struct Graph<'p> {
    pub net: Net<'p>,
    /// The invariants hold at the start.
    pub starts: bool,
    pub states: Vec<State>,
    /// The next region in time: itself, where time can pass for ever and changes nothing.
    delay: Vec<Option<usize>>,
    acts: Vec<Vec<usize>>,
    /// How a state was come upon first.
    parent: Vec<Option<(usize, String)>>,
    /// The edges that are taken, each with a state after it.
    pub edges: BTreeMap<(usize, usize), usize>,
    /// Each with the state in which it is met.
    pub faults: Vec<(usize, Fault)>,
    deadlock: Vec<bool>,
}

/// Makes every region that can be reached. `Err`: why the network is not for this.
pub fn explore<'p>(p: &'p Program, network: &Network, limits: Limits) -> Result<Graph<'p>, String> {
    let (unit, grain) = grain(p, limits);
    let net = Net::new(p, &network.automata, grain, unit);
    let mut g = Graph {
        net,
        starts: true,
        states: Vec::new(),
        delay: Vec::new(),
        acts: Vec::new(),
        parent: Vec::new(),
        edges: BTreeMap::new(),
        faults: Vec::new(),
        deadlock: Vec::new(),
    };
    let start = g.net.start();
    match g.net.invariants(&start) {
        Ok(true) => {}
        Ok(false) => {
            g.starts = false;
            return Ok(g);
        }
        Err(Stop::Fault(fault)) => {
            g.states.push(start);
            g.parent.push(None);
            g.faults.push((0, fault));
            return Ok(g);
        }
        Err(Stop::Outside(why)) => return Err(why),
    }
    g.fill(start, limits)?;
    g.find_deadlocks();
    Ok(g)
}

/// The unit of all times, in nanoseconds, and what is told apart.
fn grain(p: &Program, limits: Limits) -> (i64, Grain) {
    // Formulas count in seconds.
    let (mut unit, mut most, mut set, mut differences) = (1_000_000_000, 0, 0, limits.differences);
    let mut time = |t: &TimeSum, most: &mut i64| {
        unit = t.terms.iter().fold(gcd(unit, t.nanos), |u, term| gcd(u, term.factor));
        *most = (*most).max(t.nanos.abs());
    };
    let locations = |a: &'_ hrdsl_ir::ta::Automaton| {
        a.locations.iter().flat_map(|l: &Location| l.invariant.clone()).collect::<Vec<_>>()
    };
    for a in &p.automata {
        let guards = a.edges.iter().flat_map(|e| e.clock_guard.clone());
        for c in locations(a).into_iter().chain(guards) {
            let ClockConstraint { minus, bound, .. } = c;
            differences |= minus.is_some();
            time(&bound, &mut most);
        }
        for u in a.edges.iter().flat_map(|e| &e.updates) {
            if let EdgeAssignment::Reset { to, .. } = u {
                time(to, &mut set);
            }
        }
    }
    let most = (most / unit).max(limits.bound);
    // INVARIANT: a clock that is set comes nearer to the others by at most what it is set to.
    let most = if differences { most + set / unit } else { most };
    (unit, Grain { most, differences })
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

impl Graph<'_> {
    fn fill(&mut self, start: State, limits: Limits) -> Result<(), String> {
        let mut index = FxHashMap::default();
        index.insert(start.clone(), 0usize);
        self.push(start, None);
        let mut now = 0;
        while now < self.states.len() {
            if self.states.len() > limits.states {
                return Err("too many states".to_owned());
            }
            let s = self.states[now].clone();
            if let Some(next) = self.checked(now, Self::passed(&self.net, &s))?.flatten() {
                let at = self.enter(&mut index, next, now, || "time".to_owned());
                self.delay[now] = Some(at);
            }
            let groups = self.net.groups(&s).map_err(why)?;
            for group in groups {
                let after = self.net.after(&s, &group);
                if let Some(next) = self.checked(now, after)?.flatten() {
                    let at = self.enter(&mut index, next, now, || said(&group));
                    self.acts[now].push(at);
                    for p in &group {
                        self.edges.entry((p.member, p.edge)).or_insert(at);
                    }
                }
            }
            now += 1;
        }
        Ok(())
    }

    /// The state after the least delay that changes anything.
    fn passed(net: &Net, s: &State) -> Result<Option<State>, Stop> {
        if !net.patient(s)? {
            return Ok(None);
        }
        let clocks = region::later(net.grain, &s.clocks);
        let next = State { clocks, ..s.clone() };
        Ok(net.invariants(&next)?.then_some(next))
    }

    fn checked<T>(&mut self, now: usize, found: Result<T, Stop>) -> Result<Option<T>, String> {
        match found {
            Ok(found) => Ok(Some(found)),
            Err(Stop::Fault(fault)) => {
                self.faults.push((now, fault));
                Ok(None)
            }
            Err(outside @ Stop::Outside(_)) => Err(why(outside)),
        }
    }

    fn push(&mut self, s: State, parent: Option<(usize, String)>) {
        self.states.push(s);
        self.delay.push(None);
        self.acts.push(Vec::new());
        self.parent.push(parent);
    }

    fn enter(
        &mut self,
        index: &mut FxHashMap<State, usize>,
        next: State,
        from: usize,
        how: impl FnOnce() -> String,
    ) -> usize {
        if let Some(&at) = index.get(&next) {
            return at;
        }
        let at = self.states.len();
        index.insert(next.clone(), at);
        self.push(next, Some((from, how())));
        at
    }

    fn find_deadlocks(&mut self) {
        self.deadlock = self.acts.iter().map(Vec::is_empty).collect();
        // A chain of delays is followed backwards until nothing changes.
        loop {
            let lost: Vec<usize> = (0..self.states.len())
                .filter(|&s| self.deadlock[s] && self.delay[s].is_some_and(|d| !self.deadlock[d]))
                .collect();
            if lost.is_empty() {
                return;
            }
            lost.into_iter().for_each(|s| self.deadlock[s] = false);
        }
    }

    /// The locations and variables of all states.
    pub fn vectors(&self) -> BTreeSet<(Vec<u16>, Vec<i64>)> {
        self.states.iter().map(|s| (s.at.clone(), s.data.clone())).collect()
    }

    pub fn locations(&self) -> BTreeSet<(usize, u16)> {
        self.states.iter().flat_map(|s| s.at.iter().copied().enumerate()).collect()
    }

    /// Whether a formula holds in a state.
    pub fn holds(&self, at: usize, f: &QueryFormula) -> Result<bool, Stop> {
        let s = &self.states[at];
        match f {
            QueryFormula::At { automaton, location } => Ok(s.at[usize::from(*automaton)] == location.0),
            QueryFormula::Data(e) => {
                let (data, statements) = (RefCell::new(s.data.clone()), Cell::new(0));
                let data = Here::of_query(&self.net.layout, &data, &statements);
                Ok(e.eval_in(&Whole { data, at: &s.at })?.as_bool().ok_or(EvalError::Type)?)
            }
            QueryFormula::Clock(c) => {
                let of = |c: hrdsl_ir::ta::ClockId| s.clocks[usize::from(c.0)];
                let minus = c.minus.map_or((0, 0), of);
                if c.bound.nanos % self.net.unit != 0 || !c.bound.terms.is_empty() {
                    return Err(Stop::Outside(
                        "a bound of a query that is no whole number of units".to_owned(),
                    ));
                }
                let bound = c.bound.nanos / self.net.unit;
                region::holds(self.net.grain, of(c.clock), minus, c.op, bound)
                    .ok_or_else(|| Stop::Outside(format!("the bound {bound} of a query")))
            }
            QueryFormula::Deadlock => Ok(self.deadlock[at]),
            QueryFormula::Not(f) => Ok(!self.holds(at, f)?),
            QueryFormula::And(fs) => fs.iter().try_fold(true, |all, f| Ok(all && self.holds(at, f)?)),
            QueryFormula::Or(fs) => fs.iter().try_fold(false, |any, f| Ok(any || self.holds(at, f)?)),
        }
    }

    fn marked(&self, f: &QueryFormula) -> Result<Vec<bool>, String> {
        (0..self.states.len()).map(|s| self.holds(s, f).map_err(why)).collect()
    }

    /// `E<> f`
    pub fn possibly(&self, f: &QueryFormula) -> Result<bool, String> {
        Ok(self.marked(f)?.contains(&true))
    }

    /// The states from which a maximal run stays where the formula is `sign`.
    fn staying(&self, f: &QueryFormula, sign: bool) -> Result<Vec<bool>, String> {
        let mut stays: Vec<bool> = self.marked(f)?.into_iter().map(|m| m == sign).collect();
        loop {
            let lost: Vec<usize> =
                (0..stays.len()).filter(|&s| stays[s] && !self.goes_on(s, &stays)).collect();
            if lost.is_empty() {
                return Ok(stays);
            }
            lost.into_iter().for_each(|s| stays[s] = false);
        }
    }

    /// Nothing can happen any more, or something that stays among the states.
    fn goes_on(&self, s: usize, among: &[bool]) -> bool {
        let mut next = self.acts[s].iter().chain(&self.delay[s]).peekable();
        next.peek().is_none() || next.any(|&n| among[n])
    }

    /// `E[] f`
    pub fn always(&self, f: &QueryFormula) -> Result<bool, String> {
        Ok(self.staying(f, true)?[0])
    }

    /// `A<> f`
    pub fn eventually(&self, f: &QueryFormula) -> Result<bool, String> {
        Ok(!self.staying(f, false)?[0])
    }

    /// `f --> g`
    pub fn leads_to(&self, f: &QueryFormula, g: &QueryFormula) -> Result<bool, String> {
        let (from, stays) = (self.marked(f)?, self.staying(g, false)?);
        Ok(!from.into_iter().zip(stays).any(|(f, s)| f && s))
    }

    /// The least number of transitions to each state.
    pub fn lengths(&self) -> Vec<usize> {
        let mut lengths = vec![usize::MAX; self.states.len()];
        let mut waiting = VecDeque::from([(0, 0)]);
        while let Some((at, length)) = waiting.pop_front() {
            if lengths[at] <= length {
                continue;
            }
            lengths[at] = length;
            // Time takes no transition.
            waiting.extend(self.acts[at].iter().map(|&next| (next, length + 1)));
            if let Some(next) = self.delay[at] {
                waiting.push_front((next, length));
            }
        }
        lengths
    }

    /// The least and the greatest value of a clock where a formula holds, in units, each with whether it is attained (otherwise the
    /// clock comes as near as one likes). The inner `None`: it is beyond what is told apart.
    #[allow(clippy::type_complexity, reason = "two bounds, each of which may not be known")]
    pub fn extremes(
        &self,
        clock: usize,
        f: &QueryFormula,
    ) -> Result<Option<[Option<(i64, bool)>; 2]>, String> {
        let most = self.net.grain.most;
        let marked = self.marked(f)?;
        let held = self.states.iter().zip(marked).filter(|(_, marked)| *marked);
        let values: Vec<(i64, bool)> =
            held.map(|(s, _)| (s.clocks[clock].0, s.clocks[clock].1 > 0)).collect();
        let known = |(whole, above): (i64, bool)| whole < most || (whole == most && !above);
        let Some(&least) = values.iter().min() else { return Ok(None) };
        let greatest = values.iter().copied().max().unwrap_or(least);
        let least = known(least).then_some((least.0, !least.1));
        let greatest = known(greatest).then_some((greatest.0 + i64::from(greatest.1), !greatest.1));
        Ok(Some([least, greatest]))
    }

    /// The values of a variable where a formula holds.
    pub fn values(&self, slot: usize, f: &QueryFormula) -> Result<BTreeSet<i64>, String> {
        let marked = self.marked(f)?;
        let held = self.states.iter().zip(marked).filter(|(_, marked)| *marked);
        Ok(held.map(|(s, _)| s.data[slot]).collect())
    }

    /// How a state is come upon.
    pub fn path(&self, mut at: usize) -> String {
        let mut lines = vec![format!("{:?}", self.states[at])];
        while let Some((from, how)) = &self.parent[at] {
            at = *from;
            lines.push(format!("  {how}"));
            lines.push(format!("{:?}", self.states[at]));
        }
        lines.reverse();
        lines.join("\n")
    }
}

fn said(group: &[Part]) -> String {
    let one = |p: &Part| format!("{}.{} {:?}", p.member, p.edge, p.binders);
    group.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn why(stop: Stop) -> String {
    match stop {
        Stop::Fault(fault) => format!("{fault:?}"),
        Stop::Outside(why) => why,
    }
}

/// What a query sees: the variables, and where the automata are.
struct Whole<'a> {
    data: Here<'a>,
    at: &'a [u16],
}

impl EvalScope for Whole<'_> {
    fn var(&self, slot: u16) -> Option<Value> {
        match located_automaton(slot, self.at.len()) {
            Some(m) => Some(Value::Int(i64::from(self.at[usize::from(m)]))),
            None => self.data.var(slot),
        }
    }

    fn apply(&self, function: FunctionId, args: &[Value]) -> Result<Value, EvalError> {
        self.data.apply(function, args)
    }
}
