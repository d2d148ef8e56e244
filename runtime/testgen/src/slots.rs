//! From the numbers that an automaton has for its variables and clocks to those of its network.

use hrdsl_ir::{
    Expr, Program, Value,
    expr::{ArrayIndex, Lvalue},
    ta::{Automaton, ClockConstraint, ClockId, Network, TimeSum, TimeTerm},
};

/// Where the variables and clocks of a network's automata lie.
pub struct NetworkNumbers {
    shared: usize,
    shared_clocks: usize,
    /// By member: its first own slot and how many it has, and its first own clock.
    members: Vec<(usize, usize, usize)>,
}

impl NetworkNumbers {
    pub fn of(program: &Program, network: &Network) -> Self {
        let (mut slot, mut clock) = (program.shared.len(), program.clocks.len());
        let mut members = Vec::new();
        for id in &network.automata {
            let automaton = program.automaton(*id);
            members.push((slot, automaton.vars.len(), clock));
            slot += automaton.vars.len();
            clock += automaton.clocks.len();
        }
        Self { shared: program.shared.len(), shared_clocks: program.clocks.len(), members }
    }

    /// A clock of a member.
    pub fn clock(&self, member: usize, clock: ClockId) -> Option<ClockId> {
        let at = usize::from(clock.0);
        let of_network = match at.checked_sub(self.shared_clocks) {
            None => at,
            Some(own) => self.members.get(member)?.2 + own,
        };
        u16::try_from(of_network).ok().map(ClockId)
    }

    /// An expression of a member, whose selects have these values. `None`: it reads what an edge receives.
    pub fn expr(&self, member: usize, selects: &[Value], e: &Expr) -> Option<Expr> {
        let one = |e: &Expr| self.expr(member, selects, e);
        let boxed = |e: &Expr| one(e).map(Box::new);
        let list = |es: &[Expr]| es.iter().map(one).collect::<Option<Vec<Expr>>>();
        Some(match e {
            Expr::Const(value) => Expr::Const(*value),
            Expr::Var(slot) => self.variable(member, selects, *slot)?,
            Expr::Unary(op, a) => Expr::Unary(*op, boxed(a)?),
            Expr::Binary(op, a, b) => Expr::Binary(*op, boxed(a)?, boxed(b)?),
            Expr::If(c, a, b) => Expr::If(boxed(c)?, boxed(a)?, boxed(b)?),
            Expr::Call(function, args) => Expr::Call(*function, list(args)?),
            Expr::List(elements, rest) => {
                let rest = match rest {
                    Some(rest) => Some(boxed(rest)?),
                    None => None,
                };
                Expr::List(list(elements)?, rest)
            }
            Expr::Element(place) => {
                let Expr::Var(slot) = self.variable(member, selects, place.slot)? else { return None };
                let index =
                    |i: &ArrayIndex| Some(ArrayIndex { at: one(&i.at)?, count: i.count, stride: i.stride });
                let indices = place.indices.iter().map(index).collect::<Option<_>>()?;
                Expr::Element(Box::new(Lvalue { slot, indices }))
            }
            Expr::Apply(function, args) => Expr::Apply(*function, list(args)?),
        })
    }

    /// Slots of an automaton are shared variables, own ones, selects, and what it receives.
    fn variable(&self, member: usize, selects: &[Value], slot: u16) -> Option<Expr> {
        let at = usize::from(slot);
        let (first, own, _) = *self.members.get(member)?;
        let Some(own_at) = at.checked_sub(self.shared) else { return Some(Expr::Var(slot)) };
        match own_at.checked_sub(own) {
            None => u16::try_from(first + own_at).ok().map(Expr::Var),
            Some(select) => selects.get(select).map(|value| Expr::Const(*value)),
        }
    }

    pub fn time(&self, member: usize, selects: &[Value], time: &TimeSum) -> Option<TimeSum> {
        let term =
            |t: &TimeTerm| Some(TimeTerm { factor: t.factor, value: self.expr(member, selects, &t.value)? });
        let terms = time.terms.iter().map(term).collect::<Option<_>>()?;
        Some(TimeSum { nanos: time.nanos, terms })
    }

    pub fn constraint(
        &self,
        member: usize,
        selects: &[Value],
        c: &ClockConstraint,
    ) -> Option<ClockConstraint> {
        let minus = match c.minus {
            Some(minus) => Some(self.clock(member, minus)?),
            None => None,
        };
        Some(ClockConstraint {
            clock: self.clock(member, c.clock)?,
            minus,
            op: c.op,
            bound: self.time(member, selects, &c.bound)?,
        })
    }
}

/// The name of a clock of an automaton.
pub fn clock_name<'p>(program: &'p Program, automaton: &'p Automaton, clock: ClockId) -> &'p str {
    let names = program.clocks.iter().chain(&automaton.clocks);
    names.map(String::as_str).nth(usize::from(clock.0)).unwrap_or("clock")
}
