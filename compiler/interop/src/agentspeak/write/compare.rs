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
        let pairs = l
            .iter()
            .zip(&r)
            .filter(|(l, r)| l != r)
            .map(|(l, r)| ClauseFragment::new(format!("{l} == {r}"), COMPARE));
        let same = ClauseFragment::all(pairs.collect());
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
        let mut cases = Vec::new();
        for (a, a_tag, x) in &left {
            for (b, b_tag, y) in &right {
                let mut parts: Vec<ClauseFragment> = [a_tag, b_tag]
                    .into_iter()
                    .flatten()
                    .map(|t| ClauseFragment::new(t.clone(), COMPARE))
                    .collect();
                if a.rank() != b.rank() {
                    if holds(op, a.rank().cmp(&b.rank())) == Some(true) {
                        cases.push(ClauseFragment::all(parts));
                    }
                } else if let (AlternativeSort::Number, AlternativeSort::Number) = (a, b) {
                    parts.push(ClauseFragment::new(format!("{x} {sign} {y}"), COMPARE));
                    cases.push(ClauseFragment::all(parts));
                } else {
                    return Err("which of two values that are no numbers is less is not known".into());
                }
            }
        }
        let cases: Vec<String> = cases.into_iter().map(|c| c.at(COMPARE)).collect();
        Ok(if cases.is_empty() {
            ClauseFragment::new("false", ATOM)
        } else {
            ClauseFragment::new(cases.join(" || "), OR)
        })
    }

    /// Of which sorts a term may be, each with the test of its tag and the number that it is then.
    fn alternatives_of(
        &mut self,
        of: &AgentSpeakTerm,
    ) -> ClauseResult<Vec<(AlternativeSort, Option<String>, String)>> {
        let (types, id) = (self.cx.types, self.type_of(of)?);
        let Some(all) = types.alternatives(id).filter(|_| self.own_alternative(of, id).is_none()) else {
            let text = self.expr(of)?.at(SUM);
            return Ok(vec![(AlternativeSort::Number, None, text)]);
        };
        let values = self.values(of, BindingMode::Value)?;
        let (mut found, mut at) = (Vec::new(), 1);
        for (i, own) in all.iter().enumerate() {
            let tag = format!("{} == {}", values[0], self.cx.names.tag(types, id, i));
            found.extend(types.get(*own).sort().map(|sort| (sort, Some(tag), values[at].clone())));
            at += types.leaves(*own).len();
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
