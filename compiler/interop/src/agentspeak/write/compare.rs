//! Comparisons in the scenario's words.

use std::cmp::Ordering;

use super::{
    super::{
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
        let is_empty =
            |t: &AgentSpeakTerm| matches!(&t.kind, TermKind::List { items, rest: None } if items.is_empty());
        if let Some(list) = [(left, right), (right, left)].iter().find(|(_, r)| is_empty(r)).map(|(l, _)| *l)
        {
            let empty =
                ClauseFragment::new(format!(".empty({})", self.values(list, BindingMode::Value)?[0]), ATOM);
            return Ok(if sign == "==" {
                empty
            } else {
                ClauseFragment::new(format!("not {}", empty.text), NOT)
            });
        }
        let id = self.type_of(left)?;
        if !self.cx.types.is_compound(id) {
            let (l, r) = (self.expr(left)?, self.expr(right)?);
            return Ok(ClauseFragment::new(format!("{} {sign} {}", l.at(SUM), r.at(SUM)), COMPARE));
        }
        let (l, r) = (self.values(left, BindingMode::Value)?, self.values(right, BindingMode::Value)?);
        let pairs =
            l.iter().zip(&r).map(|(l, r)| ClauseFragment::new(format!("{l} {sign} {r}"), COMPARE)).collect();
        if sign == "==" {
            return Ok(ClauseFragment::all(pairs));
        }
        let pairs: Vec<String> = pairs.into_iter().map(|p: ClauseFragment| p.text).collect();
        Ok(ClauseFragment::new(pairs.join(" || "), OR))
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
