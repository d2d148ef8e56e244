//! The belief base: ground facts by name, oldest first, each at most once, with their annotations.

use hrdsl_ir::{
    Parameter, Type, Value,
    bdi::{Agent, BeliefAnnotation, BeliefId, InitialFact, source_self},
    list::same,
};
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};

/// Ground arguments.
pub(crate) type GroundArguments = SmallVec<[Value; 4]>;

/// What is said about a fact.
pub type FactAnnotations = SmallVec<[(BeliefAnnotation, Value); 1]>;

/// From this many rows on, those with a given first argument are found through a table.
const INDEXED: usize = 32;

/// The facts of one name, as rows of one flat table. A row that is removed stays, dead, until half of them are and
/// another comes: rows keep their places until then.
#[derive(Clone, Debug, Default)]
pub(crate) struct FactTable {
    arity: usize,
    live: usize,
    /// Annotations of all facts.
    held: usize,
    values: Vec<Value>,
    /// By row; a dead one has none.
    annotations: Vec<FactAnnotations>,
    /// The rows before this one are dead.
    start: usize,
    /// Its facts are asked newest first.
    newest_first: bool,
    /// The rows before this one were held at the start.
    initial: usize,
    /// Rows by [`hash`] of the first argument, upwards, dead ones too; made when there are many.
    index: Option<FxHashMap<u64, Vec<u32>>>,
}

/// Equal for values that match.
fn hash(value: Value) -> u64 {
    match value {
        Value::Int(_) | Value::Float(_) => {
            let x = value.as_f64().unwrap_or(0.0);
            if x == 0.0 { 1 } else { x.to_bits() }
        }
        // Lists of whole numbers and of floats may match.
        Value::List(list) => 2 + list.len() as u64,
        Value::Bool(_) | Value::Symbol(_) | Value::Text(_) => value.key().1 ^ 0x5bd1,
    }
}

/// The annotations without those that are written again.
fn distinct(all: FactAnnotations) -> FactAnnotations {
    if all.len() < 2 {
        return all;
    }
    let mut each = FactAnnotations::new();
    for (what, value) in all {
        if !each.iter().any(|(w, v)| *w == what && same(*v, value)) {
            each.push((what, value));
        }
    }
    each
}

/// What taking a source away did.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FactWithdrawal {
    /// The fact did not have it.
    Nothing,
    /// The fact has other sources.
    Source,
    /// It was the last, and the fact left, with these annotations.
    Fact(FactAnnotations),
}

/// Goes through live rows, upwards or downwards.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FactCursor {
    All(usize),
    /// A place in the index's list.
    Keyed(u64, usize),
    /// Downwards: before this row, down to the floor. The initial ones may be a part of their own.
    Down {
        at: u32,
        floor: u32,
        initial: bool,
    },
    /// The same in the index's list, before this place in it.
    KeyedDown {
        key: u64,
        at: u32,
        floor: u32,
        initial: bool,
    },
}

impl FactCursor {
    /// Whether these are the facts held at the start, which some rules come before.
    pub fn is_initial(self) -> bool {
        match self {
            FactCursor::All(_) | FactCursor::Keyed(..) => false,
            FactCursor::Down { initial, .. } | FactCursor::KeyedDown { initial, .. } => initial,
        }
    }
}

impl FactTable {
    /// The row of this index, which must be one that a cursor gave.
    pub fn row(&self, index: usize) -> &[Value] {
        &self.values[index * self.arity..(index + 1) * self.arity]
    }

    pub fn annotations(&self, index: usize) -> &FactAnnotations {
        &self.annotations[index]
    }

    pub fn len(&self) -> usize {
        self.live
    }

    /// How many annotations its facts have, each at least one.
    pub fn held(&self) -> usize {
        self.held
    }

    /// From the row that is asked first; if the first argument is known, perhaps only rows that have it.
    pub fn cursor(&self, first: Option<Value>) -> FactCursor {
        if self.newest_first {
            return self.down(first, 0, self.annotations.len(), false);
        }
        match (&self.index, first) {
            (Some(_), Some(value)) => FactCursor::Keyed(hash(value), 0),
            _ => FactCursor::All(self.start),
        }
    }

    /// The facts that came after the start, newest first.
    pub fn later(&self, first: Option<Value>) -> FactCursor {
        self.down(first, self.initial, self.annotations.len(), false)
    }

    /// The facts held at the start, in the order of the text.
    pub fn initial(&self, first: Option<Value>) -> FactCursor {
        self.down(first, 0, self.initial, true)
    }

    fn down(&self, first: Option<Value>, floor: usize, end: usize, initial: bool) -> FactCursor {
        let floor = floor as u32;
        match (&self.index, first) {
            (Some(index), Some(value)) => {
                let key = hash(value);
                let at = index.get(&key).map_or(0, |rows| rows.partition_point(|r| (*r as usize) < end));
                FactCursor::KeyedDown { key, at: at as u32, floor, initial }
            }
            _ => FactCursor::Down { at: end as u32, floor, initial },
        }
    }

    /// What is held now was held at the start.
    fn begin(&mut self) {
        self.initial = self.annotations.len();
    }

    /// The live rows, in the order in which they are asked.
    pub fn asked(&self) -> Vec<usize> {
        let mut rows: Vec<usize> = self.iter().collect();
        if self.newest_first {
            rows.reverse();
        }
        rows
    }

    /// The next live row.
    #[inline]
    pub fn next(&self, cursor: &mut FactCursor) -> Option<usize> {
        match cursor {
            FactCursor::All(at) => {
                while *at < self.annotations.len() {
                    let row = *at;
                    *at += 1;
                    if !self.annotations[row].is_empty() {
                        return Some(row);
                    }
                }
                None
            }
            FactCursor::Keyed(key, at) => {
                let rows = self.index.as_ref()?.get(key)?;
                while let Some(row) = rows.get(*at) {
                    *at += 1;
                    if !self.annotations[*row as usize].is_empty() {
                        return Some(*row as usize);
                    }
                }
                None
            }
            FactCursor::Down { .. } | FactCursor::KeyedDown { .. } => self.next_down(cursor),
        }
    }

    /// The same, downwards. Apart, so that the loops upwards stay small.
    #[inline(never)]
    fn next_down(&self, cursor: &mut FactCursor) -> Option<usize> {
        match cursor {
            FactCursor::All(_) | FactCursor::Keyed(..) => None,
            FactCursor::Down { at, floor, .. } => {
                while *at > *floor {
                    *at -= 1;
                    if !self.annotations[*at as usize].is_empty() {
                        return Some(*at as usize);
                    }
                }
                None
            }
            FactCursor::KeyedDown { key, at, floor, .. } => {
                let rows = self.index.as_ref()?.get(key)?;
                while *at > 0 {
                    *at -= 1;
                    let row = *rows.get(*at as usize)?;
                    if row < *floor {
                        return None;
                    }
                    if !self.annotations[row as usize].is_empty() {
                        return Some(row as usize);
                    }
                }
                None
            }
        }
    }

    /// The live rows.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let mut cursor = FactCursor::All(self.start);
        std::iter::from_fn(move || self.next(&mut cursor))
    }

    fn position(&self, fact: &[Value]) -> Option<usize> {
        let mut cursor = self.cursor(fact.first().copied());
        while let Some(row) = self.next(&mut cursor) {
            if self.row(row).iter().zip(fact).all(|(a, b)| same(*a, *b)) {
                return Some(row);
            }
        }
        None
    }

    /// Adds the fact as the youngest, or its annotations to the fact that is held; gives the annotations that are new.
    pub fn insert(&mut self, fact: &[Value], annotations: FactAnnotations) -> FactAnnotations {
        let Some(row) = self.position(fact) else {
            let annotations = distinct(annotations);
            if self.annotations.len() > 2 * self.live + INDEXED {
                self.compact();
            }
            let row = self.annotations.len() as u32;
            self.values.extend_from_slice(fact);
            self.held += annotations.len();
            self.annotations.push(annotations.clone());
            self.live += 1;
            if let (Some(index), Some(first)) = (&mut self.index, fact.first()) {
                index.entry(hash(*first)).or_default().push(row);
            } else if self.live > INDEXED && self.arity > 0 {
                self.make_index();
            }
            return annotations;
        };
        let held = &mut self.annotations[row];
        let mut new = FactAnnotations::new();
        for (what, value) in annotations {
            if !held.iter().any(|(w, v)| *w == what && same(*v, value)) {
                held.push((what, value));
                new.push((what, value));
            }
        }
        self.held += new.len();
        new
    }

    /// Takes a source away from a row; the fact leaves when that was the last one.
    pub fn withdraw(&mut self, row: usize, source: Value) -> FactWithdrawal {
        let held = &mut self.annotations[row];
        let is_it = |(what, value): &(BeliefAnnotation, Value)| {
            *what == BeliefAnnotation::Source && same(*value, source)
        };
        let sources = held.iter().filter(|(what, _)| *what == BeliefAnnotation::Source).count();
        if !held.iter().any(is_it) {
            return FactWithdrawal::Nothing;
        }
        if sources == 1 {
            return FactWithdrawal::Fact(self.remove(row));
        }
        held.retain(|a| !is_it(a));
        self.held -= 1;
        FactWithdrawal::Source
    }

    /// Takes the fact out; gives the annotations that it had.
    pub fn remove(&mut self, row: usize) -> FactAnnotations {
        let had = std::mem::take(&mut self.annotations[row]);
        self.live -= 1;
        self.held -= had.len();
        while self.start < self.annotations.len() && self.annotations[self.start].is_empty() {
            self.start += 1;
        }
        had
    }

    fn compact(&mut self) {
        let mut values = Vec::with_capacity(self.live * self.arity);
        let mut annotations = Vec::with_capacity(self.live);
        let kept_before = self.annotations.iter().take(self.initial).filter(|a| !a.is_empty()).count();
        for row in 0..self.annotations.len() {
            if !self.annotations[row].is_empty() {
                values.extend_from_slice(self.row(row));
                annotations.push(std::mem::take(&mut self.annotations[row]));
            }
        }
        self.initial = kept_before;
        (self.values, self.annotations, self.start) = (values, annotations, 0);
        if self.index.is_some() {
            self.make_index();
        }
    }

    fn make_index(&mut self) {
        let mut index: FxHashMap<u64, Vec<u32>> = FxHashMap::default();
        for row in self.iter() {
            index.entry(hash(self.row(row)[0])).or_default().push(row as u32);
        }
        self.index = Some(index);
    }

    /// The fact's row, if it is held, and all other facts.
    pub fn others(&self, fact: &[Value]) -> SmallVec<[usize; 4]> {
        let kept = self.position(fact);
        self.iter().filter(|row| Some(*row) != kept).collect()
    }
}

/// All that an agent believes.
#[derive(Clone, Debug, Default)]
pub(crate) struct BeliefBase {
    rows: Vec<FactTable>,
    /// Annotations of all facts.
    held: usize,
}

impl BeliefBase {
    pub fn new(agent: &Agent) -> Self {
        let newest_first = agent.jason;
        let rows = agent.beliefs.iter();
        Self {
            rows: rows
                .map(|b| FactTable { arity: b.params.len(), newest_first, ..FactTable::default() })
                .collect(),
            held: 0,
        }
    }

    /// What is held now was held at the start.
    pub fn begin(&mut self) {
        self.rows.iter_mut().for_each(FactTable::begin);
    }

    /// The facts of this name; the id must be one of the agent's.
    pub fn of(&self, belief: BeliefId) -> &FactTable {
        &self.rows[belief.0 as usize]
    }

    /// See [`FactTable::insert`].
    pub fn insert(
        &mut self,
        belief: BeliefId,
        fact: &[Value],
        annotations: FactAnnotations,
    ) -> FactAnnotations {
        self.change(belief, |rows| rows.insert(fact, annotations))
    }

    /// See [`FactTable::remove`].
    pub fn remove(&mut self, belief: BeliefId, row: usize) -> FactAnnotations {
        self.change(belief, |rows| rows.remove(row))
    }

    /// See [`FactTable::withdraw`].
    pub fn withdraw(&mut self, belief: BeliefId, row: usize, source: Value) -> FactWithdrawal {
        self.change(belief, |rows| rows.withdraw(row, source))
    }

    fn change<T>(&mut self, belief: BeliefId, edit: impl FnOnce(&mut FactTable) -> T) -> T {
        let rows = &mut self.rows[belief.0 as usize];
        let before = rows.held;
        let done = edit(rows);
        self.held = self.held - before + rows.held;
        done
    }

    /// How many annotations all facts have, each at least one.
    pub fn held(&self) -> usize {
        self.held
    }

    pub fn all(&self) -> &[FactTable] {
        &self.rows
    }

    /// All facts, by the order of their declarations, then oldest first.
    pub fn facts(&self) -> impl Iterator<Item = InitialFact> {
        (0u16..).zip(&self.rows).flat_map(|(id, rows)| {
            rows.iter().map(move |row| InitialFact {
                belief: BeliefId(id),
                args: rows.row(row).to_vec(),
                annotations: rows.annotations(row).to_vec(),
            })
        })
    }
}

/// The annotations of a fact that the choice of this number picks for as many terms: the last term's changes fastest. There are
/// `held ^ terms` choices.
pub(crate) fn picked(mut choice_no: usize, held: usize, terms: usize) -> SmallVec<[usize; 4]> {
    let mut picked = SmallVec::from_elem(0, terms);
    for place in picked.iter_mut().rev() {
        *place = choice_no % held;
        choice_no /= held;
    }
    picked
}

/// `[source(self)]`
pub(crate) fn own() -> FactAnnotations {
    from(Value::Symbol(source_self()))
}

/// `[source(S)]`
pub(crate) fn from(source: Value) -> FactAnnotations {
    smallvec![(BeliefAnnotation::Source, source)]
}

/// With `source(self)`, if no source is among them.
pub(crate) fn sourced(mut annotations: FactAnnotations) -> FactAnnotations {
    if !annotations.iter().any(|(what, _)| *what == BeliefAnnotation::Source) {
        annotations.push((BeliefAnnotation::Source, Value::Symbol(source_self())));
    }
    annotations
}

/// The arguments as the parameters' types have them, an integer made a float where one is due; `None` if their number,
/// a type or a range is wrong.
pub(crate) fn typed(params: &[Parameter], mut args: GroundArguments) -> Option<GroundArguments> {
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
    use proptest::prelude::*;

    use super::*;

    fn rows(arity: usize, facts: &[&[i64]]) -> FactTable {
        let mut rows = FactTable { arity, ..FactTable::default() };
        for fact in facts {
            rows.insert(&values(fact), own());
        }
        rows
    }

    fn values(fact: &[i64]) -> Vec<Value> {
        fact.iter().map(|n| Value::Int(*n)).collect()
    }

    fn ints(rows: &FactTable) -> Vec<Vec<i64>> {
        rows.iter().map(|r| rows.row(r).iter().filter_map(|v| v.as_int()).collect()).collect()
    }

    fn told(by: &str) -> FactAnnotations {
        from(Value::Symbol(Symbol::intern(by)))
    }

    #[test]
    fn facts_are_held_once_in_the_order_they_came() {
        let mut r = rows(2, &[&[3, 1], &[1, 2], &[3, 1]]);
        assert_eq!(ints(&r), [[3, 1], [1, 2]]);
        assert!(r.insert(&values(&[1, 2]), own()).is_empty());
        r.remove(0);
        assert_eq!(r.insert(&values(&[3, 1]), own()), own());
        assert_eq!(ints(&r), [[1, 2], [3, 1]]);
    }

    #[test]
    fn a_fact_without_arguments_is_held_or_not() {
        let mut r = rows(0, &[]);
        assert!(!r.insert(&[], own()).is_empty());
        assert!(r.insert(&[], own()).is_empty());
        assert_eq!(r.len(), 1);
        r.remove(0);
        assert_eq!((r.len(), r.iter().count()), (0, 0));
    }

    #[test]
    fn a_fact_leaves_with_its_last_source() {
        let mut r = rows(1, &[&[1]]);
        assert_eq!(r.insert(&values(&[1]), told("Robot")), told("Robot"));
        assert!(r.insert(&values(&[1]), told("Robot")).is_empty());
        assert_eq!(r.annotations(0).len(), 2);
        assert_eq!(r.withdraw(0, Value::Symbol(source_self())), FactWithdrawal::Source);
        assert_eq!(r.withdraw(0, Value::Symbol(source_self())), FactWithdrawal::Nothing);
        let robot = Value::Symbol(Symbol::intern("Robot"));
        assert_eq!(r.withdraw(0, robot), FactWithdrawal::Fact(told("Robot")));
        assert_eq!(r.len(), 0);
    }

    #[test]
    fn arguments_take_the_types_of_parameters() {
        let params = [
            Parameter { name: "a".into(), ty: Type::Float(Unit::Metre) },
            Parameter { name: "b".into(), ty: Type::Int { lo: 0, hi: 4 } },
        ];
        let args = |a, b| GroundArguments::from_slice(&[a, b]);
        assert_eq!(
            typed(&params, args(Value::Int(2), Value::Int(4))),
            Some(args(Value::Float(2.0), Value::Int(4)))
        );
        assert_eq!(typed(&params, args(Value::Int(2), Value::Int(5))), None);
        assert_eq!(typed(&params, args(Value::Bool(true), Value::Int(1))), None);
        assert_eq!(typed(&params, GroundArguments::from_slice(&[Value::Int(1)])), None);
        let hand = Type::Enum(Enumeration::intern("Hand", &["left", "right"]));
        let params = [Parameter { name: "hand".into(), ty: hand }];
        let arg = |name| GroundArguments::from_slice(&[Value::Symbol(Symbol::intern(name))]);
        assert_eq!(typed(&params, arg("left")), Some(arg("left")));
        assert_eq!(typed(&params, arg("middle")), None);
    }

    proptest! {
        /// Against a plain list, past the sizes where tables are made and dead rows swept away.
        #[test]
        fn rows_are_a_list_of_different_facts(ops in prop::collection::vec((any::<bool>(), 0i64..60, 0i64..3), 0..400)) {
            let mut rows = rows(2, &[]);
            let mut list: Vec<Vec<i64>> = vec![];
            for (add, a, b) in ops {
                let fact = vec![a, b];
                let at = list.iter().position(|f| *f == fact);
                if add {
                    prop_assert_eq!(rows.insert(&values(&fact), own()).is_empty(), at.is_some());
                    if at.is_none() { list.push(fact); }
                } else {
                    let row = rows.position(&values(&fact));
                    prop_assert_eq!(row.is_some(), at.is_some());
                    if let (Some(row), Some(at)) = (row, at) { rows.remove(row); list.remove(at); }
                }
                prop_assert_eq!(rows.len(), list.len());
            }
            prop_assert_eq!(&ints(&rows), &list);
            let mut cursor = rows.cursor(Some(Value::Float(7.0)));
            let mut found = vec![];
            while let Some(row) = rows.next(&mut cursor) {
                if same(rows.row(row)[0], Value::Int(7)) { found.push(rows.row(row)[1].as_int().unwrap()); }
            }
            let expected: Vec<i64> = list.iter().filter(|f| f[0] == 7).map(|f| f[1]).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
