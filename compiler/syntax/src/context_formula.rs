//! What the grammar's actions build formulas with: as long as an operand is an expression, so is what is made of it.

use hrdsl_source::{Diagnostic, DiagnosticCode};

use crate::{
    ast::{BinaryOp, ExprSyntax, ExprSyntaxKind, UnaryOp},
    context::ParseContext,
    temporal::{PlainFormula, TemporalFormula, TemporalKind, TemporalLook, TemporalWindow},
};

impl ParseContext<'_> {
    pub(crate) fn formula_atom(&self, atom: ExprSyntax) -> PlainFormula {
        let span = atom.span;
        let kind = if let ExprSyntaxKind::Bool(truth) = atom.kind {
            TemporalKind::Constant(truth)
        } else {
            TemporalKind::Condition(atom)
        };
        TemporalFormula { kind, span }
    }

    pub(crate) fn formula_not(&self, start: u32, of: Box<PlainFormula>) -> PlainFormula {
        let span = self.span(start, of.span.end);
        TemporalFormula { kind: TemporalKind::Not(of), span }
    }

    pub(crate) fn formula_looking(
        &self,
        start: u32,
        look: TemporalLook,
        window: Option<Box<TemporalWindow<ExprSyntax>>>,
        of: Box<PlainFormula>,
    ) -> PlainFormula {
        let span = self.span(start, of.span.end);
        TemporalFormula { kind: TemporalKind::Look { look, window: window.map(|w| *w), of }, span }
    }

    pub(crate) fn formula_minus(&mut self, start: u32, of: Box<PlainFormula>) -> PlainFormula {
        let of = self.operand(*of);
        self.formula_atom(self.unary(UnaryOp::Neg, start, of))
    }

    pub(crate) fn formula_binary(
        &mut self,
        op: BinaryOp,
        left: Box<PlainFormula>,
        right: Box<PlainFormula>,
    ) -> PlainFormula {
        let (left, right) = (self.operand(*left), self.operand(*right));
        self.formula_atom(self.binary(op, left, right))
    }

    /// The parentheses are in the span and leave no other trace.
    pub(crate) fn formula_group(&self, start: u32, of: Box<PlainFormula>, end: u32) -> PlainFormula {
        let span = self.span(start, end);
        match of.kind {
            TemporalKind::Condition(e) => self.formula_atom(self.group(start, e, end)),
            kind => TemporalFormula { kind, span },
        }
    }

    /// What is compared or reckoned with: an expression.
    fn operand(&mut self, of: PlainFormula) -> ExprSyntax {
        let kind = match of.kind {
            TemporalKind::Condition(e) => return ExprSyntax { span: of.span, ..e },
            TemporalKind::Constant(truth) => ExprSyntaxKind::Bool(truth),
            TemporalKind::Events(_)
            | TemporalKind::Not(_)
            | TemporalKind::Junction(..)
            | TemporalKind::Look { .. }
            | TemporalKind::Reach { .. } => {
                self.diagnostics.push(
                    Diagnostic::error(
                        DiagnosticCode::SYNTAX,
                        of.span,
                        "a formula holds or not, and is no number",
                    )
                    .help("compare numbers, and join what comes of it: `x < 3 and y > 2`"),
                );
                ExprSyntaxKind::Error
            }
        };
        ExprSyntax { kind, span: of.span }
    }
}
