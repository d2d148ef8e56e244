//! The belief base: ground facts by name, oldest first, each at most once.

use hrdsl_ir::{
    Param, Type, Value,
    bdi::{Agent, BeliefId, Fact},
};

use crate::{event::Ground, unify::same};

/// The facts of one name, as rows of one flat table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    arity: usize,
    len: usize,
    values: Vec<Value>,
}

impl Rows {
    /// The row of this index, which must be less than their number.
    fn row(&self, index: usize) -> &[Value] {
        &self.values[index * self.arity..(index + 1) * self.arity]
    }

    pub fn iter(&self) -> impl Iterator<Item = &[Value]> {
        (0..self.len).map(|index| self.row(index))
    }

    fn position(&self, fact: &[Value]) -> Option<usize> {
        self.iter().position(|row| row.iter().zip(fact).all(|(a, b)| same(*a, *b)))
    }

    /// Adds the fact as the youngest; `false` if it is there already.
    pub fn insert(&mut self, fact: &[Value]) -> bool {
        if self.position(fact).is_some() {
            return false;
        }
        self.values.extend_from_slice(fact);
        self.len += 1;
        true
    }

    pub fn remove(&mut self, index: usize) -> Ground {
        self.len -= 1;
        self.values.drain(index * self.arity..(index + 1) * self.arity).collect()
    }

    /// Leaves this fact alone; gives the facts that were removed, oldest first, and whether it was added.
    pub fn replace(&mut self, fact: &[Value]) -> (Vec<Ground>, bool) {
        let kept = self.position(fact);
        let removed = (0..self.len).filter(|i| Some(*i) != kept).map(|i| Ground::from_slice(self.row(i)));
        let removed = removed.collect();
        self.values.clear();
        self.values.extend_from_slice(fact);
        self.len = 1;
        (removed, kept.is_none())
    }
}

/// All that an agent believes.
#[derive(Clone, Debug, Default)]
pub(crate) struct BeliefBase {
    rows: Vec<Rows>,
}

impl BeliefBase {
    pub fn new(agent: &Agent) -> Self {
        let rows = agent.beliefs.iter();
        Self { rows: rows.map(|b| Rows { arity: b.params.len(), ..Rows::default() }).collect() }
    }

    /// The facts of this name; the id must be one of the agent's.
    pub fn of(&self, belief: BeliefId) -> &Rows {
        &self.rows[belief.0 as usize]
    }

    pub fn of_mut(&mut self, belief: BeliefId) -> &mut Rows {
        &mut self.rows[belief.0 as usize]
    }

    /// All facts, by the order of their declarations, then oldest first.
    pub fn facts(&self) -> impl Iterator<Item = Fact> {
        (0u16..).zip(&self.rows).flat_map(|(id, rows)| {
            rows.iter().map(move |row| Fact { belief: BeliefId(id), args: row.to_vec() })
        })
    }
}

/// The arguments as the parameters' types have them, an integer made a float where one is due; `None` if their number,
/// a type or a range is wrong.
pub(crate) fn typed(params: &[Param], mut args: Ground) -> Option<Ground> {
    if params.len() != args.len() {
        return None;
    }
    for (param, arg) in params.iter().zip(&mut args) {
        if let (Type::Float(_), Value::Int(n)) = (param.ty, *arg) {
            *arg = Value::Float(n as f64);
        }
        if !param.ty.admits(*arg) {
            return None;
        }
    }
    Some(args)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Enumeration, Symbol, Unit};

    use super::*;

    fn rows(arity: usize, facts: &[&[i64]]) -> Rows {
        let mut rows = Rows { arity, ..Rows::default() };
        for fact in facts {
            rows.insert(&fact.iter().map(|n| Value::Int(*n)).collect::<Vec<_>>());
        }
        rows
    }

    fn ints(rows: &Rows) -> Vec<Vec<i64>> {
        rows.iter().map(|r| r.iter().filter_map(|v| v.as_int()).collect()).collect()
    }

    #[test]
    fn facts_are_held_once_in_the_order_they_came() {
        let mut r = rows(2, &[&[3, 1], &[1, 2], &[3, 1]]);
        assert_eq!(ints(&r), [[3, 1], [1, 2]]);
        assert!(!r.insert(&[Value::Int(1), Value::Int(2)]));
        assert_eq!(r.remove(0).as_slice(), [Value::Int(3), Value::Int(1)]);
        assert!(r.insert(&[Value::Int(3), Value::Int(1)]));
        assert_eq!(ints(&r), [[1, 2], [3, 1]]);
    }

    #[test]
    fn a_fact_without_arguments_is_held_or_not() {
        let mut r = rows(0, &[]);
        assert!(r.insert(&[]));
        assert!(!r.insert(&[]));
        assert_eq!(r.len, 1);
        r.remove(0);
        assert_eq!(r.len, 0);
    }

    #[test]
    fn replacing_tells_the_net_change() {
        let mut r = rows(1, &[&[1], &[2], &[3]]);
        let (removed, added) = r.replace(&[Value::Int(2)]);
        assert_eq!((removed.len(), added), (2, false));
        assert_eq!(ints(&r), [[2]]);
        let (removed, added) = r.replace(&[Value::Int(4)]);
        assert_eq!((removed[0].as_slice(), added), (&[Value::Int(2)][..], true));
        assert_eq!(r.replace(&[Value::Int(4)]), (vec![], false));
    }

    #[test]
    fn arguments_take_the_types_of_parameters() {
        let params = [
            Param { name: "a".into(), ty: Type::Float(Unit::Metre) },
            Param { name: "b".into(), ty: Type::Int { lo: 0, hi: 4 } },
        ];
        let args = |a, b| Ground::from_slice(&[a, b]);
        assert_eq!(
            typed(&params, args(Value::Int(2), Value::Int(4))),
            Some(args(Value::Float(2.0), Value::Int(4)))
        );
        assert_eq!(typed(&params, args(Value::Int(2), Value::Int(5))), None);
        assert_eq!(typed(&params, args(Value::Bool(true), Value::Int(1))), None);
        assert_eq!(typed(&params, Ground::from_slice(&[Value::Int(1)])), None);
        let hand = Type::Enum(Enumeration::intern("Hand", &["left", "right"]));
        let params = [Param { name: "hand".into(), ty: hand }];
        let arg = |name| Ground::from_slice(&[Value::Symbol(Symbol::intern(name))]);
        assert_eq!(typed(&params, arg("left")), Some(arg("left")));
        assert_eq!(typed(&params, arg("middle")), None);
        assert_eq!(typed(&params, Ground::from_slice(&[Value::Int(0)])), None);
    }
}
