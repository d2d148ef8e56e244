//! Quantities that are known: constants, times, amounts and counts, each with what it must be.

use hrdsl_syntax::ast;

use crate::check::{checker::Checker, state::scope::ExprEnv};
use crate::{Dimension, InferredType, Value, report::types};

/// The longest time, in seconds: some thirty years. Twice as much still is a number of nanoseconds.
pub(in crate::check) const MAX_TIME: f64 = 1e9;

/// More bytes than any machine has.
const MAX_DATA: f64 = 1e15;

impl Checker<'_> {
    /// A constant of this kind; `None` with a diagnostic otherwise.
    pub(in crate::check) fn constant(
        &mut self,
        e: &ast::ExprSyntax,
        want: InferredType,
        env: &mut ExprEnv,
    ) -> Option<Value> {
        let e = self.expr_of(e, want, env);
        if e.constant().is_none() && e.ty != InferredType::Unknown {
            self.report(types::not_constant(e.span));
        }
        e.constant().filter(|_| e.ty != InferredType::Unknown)
    }

    /// A constant quantity, in SI units.
    pub(in crate::check) fn quantity_of(&mut self, e: &ast::ExprSyntax, dim: Dimension) -> Option<f64> {
        self.constant(e, InferredType::Float(dim), &mut ExprEnv::constants()).and_then(Value::as_f64)
    }

    /// A constant time in seconds, not negative; or more than zero.
    pub(in crate::check) fn time(&mut self, e: &ast::ExprSyntax, what: &str, positive: bool) -> Option<f64> {
        let t = self.quantity_of(e, Dimension::TIME)?;
        if t < 0.0 || positive && t == 0.0 {
            let rule = if positive { "more than 0 s" } else { "at least 0 s" };
            self.report(types::must_be(what, rule, e.span));
            return None;
        }
        if t > MAX_TIME {
            self.report(types::must_be(what, &format!("at most {MAX_TIME} s"), e.span));
            return None;
        }
        Some(t)
    }

    /// A constant amount of data, in bytes: at least one.
    pub(in crate::check) fn amount_of_data(&mut self, e: &ast::ExprSyntax, what: &str) -> Option<u64> {
        let bytes = self.quantity_of(e, Dimension::DATA)?;
        if (1.0..=MAX_DATA).contains(&bytes) {
            return Some(bytes as u64);
        }
        let rule = if bytes < 1.0 { "at least 1 B".to_owned() } else { format!("at most {MAX_DATA} B") };
        self.report(types::must_be(what, &rule, e.span));
        None
    }

    /// A constant whole number of at least `lo`.
    pub(in crate::check) fn count(&mut self, e: &ast::ExprSyntax, what: &str, lo: i64) -> Option<i64> {
        let Value::Int(n) = self.constant(e, InferredType::Int, &mut ExprEnv::constants())? else {
            return None;
        };
        let most = i64::from(u32::MAX);
        if n < lo || n > most {
            let rule = if n < lo { format!("at least {lo}") } else { format!("at most {most}") };
            self.report(types::must_be(what, &rule, e.span));
            return None;
        }
        Some(n)
    }

    pub(in crate::check) fn more_than_zero(
        &mut self,
        e: &ast::ExprSyntax,
        dim: Dimension,
        what: &str,
    ) -> Option<f64> {
        let x = self.quantity_of(e, dim)?;
        if x <= 0.0 {
            let rule = format!("more than 0 {}", dim.symbol().unwrap_or_default());
            self.report(types::must_be(what, &rule, e.span));
            return None;
        }
        Some(x)
    }
}
