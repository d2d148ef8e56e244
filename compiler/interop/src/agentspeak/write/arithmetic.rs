//! Sums, products and powers.

use super::{
    super::{
        ast::{AgentSpeakOperator, AgentSpeakTerm, TermKind},
        term::small_power,
    },
    clause::{ATOM, ClauseFragment, ClauseResult, ClauseTranslator, PRODUCT, SUM, is_number},
};

impl ClauseTranslator<'_> {
    pub(super) fn arithmetic(
        &mut self,
        op: AgentSpeakOperator,
        left: &AgentSpeakTerm,
        right: &AgentSpeakTerm,
        float: bool,
    ) -> ClauseResult<ClauseFragment> {
        if op == AgentSpeakOperator::Pow {
            return self.power(left, right);
        }
        let (mut l, mut r) = (self.number(left)?, self.number(right)?);
        if op == AgentSpeakOperator::Div {
            // Whole numbers would be divided without a rest.
            for (piece, of) in [(&mut l, left), (&mut r, right)] {
                if matches!(of.kind, TermKind::Int(_)) && !piece.text.contains('.') {
                    piece.text += ".0";
                }
            }
        }
        let (sign, level, right_level) = match op {
            AgentSpeakOperator::Add => ("+", SUM, PRODUCT),
            AgentSpeakOperator::Sub => ("-", SUM, PRODUCT),
            AgentSpeakOperator::Mul => ("*", PRODUCT, ATOM),
            AgentSpeakOperator::Mod => ("%", PRODUCT, ATOM),
            AgentSpeakOperator::IntDiv if float => {
                return Err("`div` of numbers that may have decimals".into());
            }
            AgentSpeakOperator::Div if [left, right].iter().all(|t| !is_number(t)) => {
                let text = format!("1.0 * {} / {}", l.at(ATOM), r.at(ATOM));
                return Ok(ClauseFragment::new(text, PRODUCT));
            }
            AgentSpeakOperator::IntDiv | AgentSpeakOperator::Div => ("/", PRODUCT, ATOM),
            AgentSpeakOperator::Pow
            | AgentSpeakOperator::Or
            | AgentSpeakOperator::And
            | AgentSpeakOperator::Less
            | AgentSpeakOperator::LessEqual
            | AgentSpeakOperator::Greater
            | AgentSpeakOperator::GreaterEqual
            | AgentSpeakOperator::Equal
            | AgentSpeakOperator::Different
            | AgentSpeakOperator::Unify
            | AgentSpeakOperator::NotUnify
            | AgentSpeakOperator::Univ => return Err("a formula stands where a value should".into()),
        };
        Ok(ClauseFragment::new(format!("{} {sign} {}", l.at(level), r.at(right_level)), level))
    }

    fn power(&mut self, base: &AgentSpeakTerm, exponent: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let base = self.number(base)?;
        if let Some(n) = small_power(exponent) {
            return Ok(ClauseFragment::new(vec![base.at(ATOM); n].join(" * "), PRODUCT));
        }
        let exponent = self.number(exponent)?.text;
        let power = self.fresh("Power");
        self.first.push(format!(".power({}, {exponent}, {power})", base.text));
        Ok(ClauseFragment::new(power, ATOM))
    }
}
