//! Comparisons in the scenario's words.

use std::cmp::Ordering;

use super::{
    super::{
        alternatives::AlternativeSort,
        ast::{AgentSpeakOperator, AgentSpeakOperatorSort, AgentSpeakTerm, TermKind},
        term::texts,
    },
    clause::{ATOM, BindingMode, COMPARE, ClauseFragment, ClauseResult, ClauseTranslator, NOT, OR, SUM},
};

/// What a term is if it is of one sort.
struct TaggedParts {
    sort: AlternativeSort,
    /// The test of its tag, if it may be of another.
    test: Option<String>,
    parts: Vec<String>,
}

impl ClauseTranslator<'_> {
    pub(super) fn compare(
        &mut self,
        op: AgentSpeakOperator,
        left: &AgentSpeakTerm,
        right: &AgentSpeakTerm,
    ) -> ClauseResult<ClauseFragment> {
        if let Some(holds) = self.decided(op, left, right) {
            return Ok(ClauseFragment::new(holds.to_string(), ATOM));
        }
        let sign = match op {
            AgentSpeakOperator::Less => "<",
            AgentSpeakOperator::LessEqual => "<=",
            AgentSpeakOperator::Greater => ">",
            AgentSpeakOperator::GreaterEqual => ">=",
            AgentSpeakOperator::Equal => "==",
            AgentSpeakOperator::Different | AgentSpeakOperator::NotUnify => "!=",
            _ => return Err("this is no formula".into()),
        };
        let id = self.type_of(left)?;
        let choices =
            [left, right].map(|t| self.type_of(t).is_ok_and(|id| self.cx.types.alternatives(id).is_some()));
        if op.sort() == AgentSpeakOperatorSort::Order && choices != [false, false] {
            return self.ordered(sign, op, [left, right]);
        }
        let is_empty =
            |t: &AgentSpeakTerm| matches!(&t.kind, TermKind::List { items, rest: None } if items.is_empty());
        if let Some(list) = [(left, right), (right, left)].iter().find(|(_, r)| is_empty(r)).map(|(l, _)| *l)
            && choices == [false, false]
        {
            let empty =
                ClauseFragment::new(format!(".empty({})", self.values(list, BindingMode::Value)?[0]), ATOM);
            return Ok(if sign == "==" {
                empty
            } else {
                ClauseFragment::new(format!("not {}", empty.text), NOT)
            });
        }
        if !self.cx.types.is_compound(id) {
            let (l, r) = (self.expr(left)?, self.expr(right)?);
            return Ok(ClauseFragment::new(format!("{} {sign} {}", l.at(SUM), r.at(SUM)), COMPARE));
        }
        let (l, r) = (self.values(left, BindingMode::Value)?, self.values(right, BindingMode::Value)?);
        let same = same(&l, &r);
        // Of several parts that differ, each would be an answer of its own.
        Ok(if sign == "==" { same } else { ClauseFragment::new(format!("not ({})", same.text), NOT) })
    }

    /// Which of two values is less, of which one at least is of several types: numbers come first, then strings, then lists.
    fn ordered(
        &mut self,
        sign: &str,
        op: AgentSpeakOperator,
        sides: [&AgentSpeakTerm; 2],
    ) -> ClauseResult<ClauseFragment> {
        let (left, right) = (self.alternatives_of(sides[0])?, self.alternatives_of(sides[1])?);
        let (mut cases, mut is_unknown) = (Vec::new(), false);
        for a in &left {
            for b in &right {
                let tests = [&a.test, &b.test].into_iter().flatten();
                let mut parts: Vec<ClauseFragment> =
                    tests.map(|t| ClauseFragment::new(t.clone(), COMPARE)).collect();
                if a.sort.rank() != b.sort.rank() {
                    if holds(op, a.sort.rank().cmp(&b.sort.rank())) == Some(true) {
                        cases.push(ClauseFragment::all(parts));
                    }
                } else if let (AlternativeSort::Number, AlternativeSort::Number) = (&a.sort, &b.sort) {
                    parts.push(ClauseFragment::new(format!("{} {sign} {}", a.parts[0], b.parts[0]), COMPARE));
                    cases.push(ClauseFragment::all(parts));
                } else {
                    is_unknown = true;
                    if a.sort == b.sort && holds(op, Ordering::Equal) == Some(true) {
                        parts.push(same(&a.parts, &b.parts));
                        cases.push(ClauseFragment::all(parts));
                    }
                }
            }
        }
        if is_unknown {
            let message = "which of two values that are no numbers is less is not known: of two that differ, this never holds";
            self.remarks.push((sides[0].span, message.to_owned()));
        }
        let cases: Vec<String> = cases.into_iter().map(|c| c.at(COMPARE)).collect();
        Ok(if cases.is_empty() {
            ClauseFragment::new("false", ATOM)
        } else {
            ClauseFragment::new(cases.join(" || "), OR)
        })
    }

    /// What a term may be.
    fn alternatives_of(&mut self, of: &AgentSpeakTerm) -> ClauseResult<Vec<TaggedParts>> {
        let (types, id) = (self.cx.types, self.type_of(of)?);
        let Some(all) = types.alternatives(id).filter(|_| self.own_alternative(of, id).is_none()) else {
            let parts = vec![self.expr(of)?.at(SUM)];
            return Ok(vec![TaggedParts { sort: AlternativeSort::Number, test: None, parts }]);
        };
        let values = self.values(of, BindingMode::Value)?;
        let (mut found, mut at) = (Vec::new(), 1);
        for (i, own) in all.iter().enumerate() {
            let test = format!("{} == {}", values[0], self.cx.names.tag(types, id, i));
            let end = at + types.leaves(*own).len();
            let parts = values[at..end].to_vec();
            found.extend(types.get(*own).sort().map(|sort| TaggedParts { sort, test: Some(test), parts }));
            at = end;
        }
        Ok(found)
    }

    /// A comparison of which the outcome is known: of two texts, or of a variable without a value, which stands above every
    /// number in Jason.
    fn decided(
        &mut self,
        op: AgentSpeakOperator,
        left: &AgentSpeakTerm,
        right: &AgentSpeakTerm,
    ) -> Option<bool> {
        if op.sort() == AgentSpeakOperatorSort::Order
            && let Some((l, r)) = texts(left, right)
        {
            return holds(op, l.cmp(r));
        }
        let open = |c: &Self, t: &AgentSpeakTerm| matches!(&t.kind, TermKind::Var { name, .. } if !c.bound.contains(name));
        let (span, order) = match (open(self, left), open(self, right)) {
            (true, false) if self.is_bound(right) => (left.span, Ordering::Greater),
            (false, true) if self.is_bound(left) => (right.span, Ordering::Less),
            _ => return None,
        };
        let holds = holds(op, order)?;
        let always = if holds { "always holds" } else { "never holds" };
        let message =
            format!("the variable has no value here, and stands above every number, so that this {always}");
        self.remarks.push((span, message));
        Some(holds)
    }
}

/// That all parts are the same.
fn same(left: &[String], right: &[String]) -> ClauseFragment {
    let pairs = left.iter().zip(right).filter(|(l, r)| l != r);
    ClauseFragment::all(pairs.map(|(l, r)| ClauseFragment::new(format!("{l} == {r}"), COMPARE)).collect())
}

/// Whether a comparison holds of two terms in this order; `None`: it is none.
fn holds(op: AgentSpeakOperator, order: Ordering) -> Option<bool> {
    match op {
        AgentSpeakOperator::Less => Some(order.is_lt()),
        AgentSpeakOperator::LessEqual => Some(order.is_le()),
        AgentSpeakOperator::Greater => Some(order.is_gt()),
        AgentSpeakOperator::GreaterEqual => Some(order.is_ge()),
        AgentSpeakOperator::Equal => Some(order.is_eq()),
        AgentSpeakOperator::Different => Some(order.is_ne()),
        AgentSpeakOperator::NotUnify
        | AgentSpeakOperator::Or
        | AgentSpeakOperator::And
        | AgentSpeakOperator::Unify
        | AgentSpeakOperator::Univ
        | AgentSpeakOperator::Add
        | AgentSpeakOperator::Sub
        | AgentSpeakOperator::Mul
        | AgentSpeakOperator::Div
        | AgentSpeakOperator::IntDiv
        | AgentSpeakOperator::Mod
        | AgentSpeakOperator::Pow => None,
    }
}
