//! Updates: what an expression changes.

use hrdsl_source::Span;

use super::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind},
    declare::in_range,
    fault::{UppaalFault, fault},
    known::ClockEvent,
    place::place_text,
    scope::{IndexRange, ScenarioExprText, ScenarioPrecedence, UppaalSymbol, VarSym, combinations},
    translation::UppaalTranslation,
};

impl UppaalTranslation<'_> {
    /// What an expression changes, as actions or statements.
    pub fn effect(&mut self, e: &UppaalExpr, out: &mut Vec<String>) -> Result<(), UppaalFault> {
        let (e, after) = self.in_order(e, out)?;
        self.single_effect(&e, out)?;
        out.extend(after);
        Ok(())
    }

    fn single_effect(&mut self, e: &UppaalExpr, out: &mut Vec<String>) -> Result<(), UppaalFault> {
        match &e.kind {
            UppaalExprKind::Assign(op, to, value) => self.assign(*op, to, value, e.span, out),
            UppaalExprKind::Step { up, of, .. } => {
                let to = self.assigned(of)?;
                if to.ty.is_bool || !to.dims.is_empty() {
                    return fault(e.span, "`++` and `--` are for numbers");
                }
                self.mark(&to.name);
                out.push(format!("{} {} 1", place_text(&to), if *up { "+=" } else { "-=" }));
                Ok(())
            }
            UppaalExprKind::Call(of, args) if !self.is_abs(of, args) => {
                if let Some(UppaalSymbol::Function(function)) =
                    of.root().and_then(|name| self.find(name)).cloned()
                    && function.sets_clocks
                    && function.params.len() == args.len()
                {
                    return self.inline(&function, args, e.span, out);
                }
                let (text, _) = self.call(of, args, e.span)?;
                out.push(text);
                Ok(())
            }
            UppaalExprKind::Choice(c, a, b) if self.cases.is_some() => {
                let taken = if self.decide(c)? { a } else { b };
                self.effect(taken, out)
            }
            UppaalExprKind::Choice(c, a, b) if self.writing > 0 => {
                let c = self.condition(c)?;
                let (mut then, mut otherwise) = (Vec::new(), Vec::new());
                self.effect(a, &mut then)?;
                self.effect(b, &mut otherwise)?;
                out.push(format!(
                    "if {} {{ {} }} else {{ {} }}",
                    c.text,
                    then.join("; "),
                    otherwise.join("; ")
                ));
                Ok(())
            }
            _ => match self.expr(e)?.value {
                Some(_) => Ok(()),
                None => fault(e.span, "expected an assignment or the call of a function"),
            },
        }
    }

    /// A variable that may be assigned.
    fn assigned(&mut self, e: &UppaalExpr) -> Result<VarSym, UppaalFault> {
        match self.place(e)? {
            UppaalSymbol::Var(v) => {
                self.may_be_assigned(&v, e.span)?;
                Ok(v)
            }
            UppaalSymbol::Clock(_) => {
                fault(e.span, "a function of a scenario cannot set clocks: set them on the transition")
            }
            other => fault(e.span, format!("{} cannot be assigned", other.noun())),
        }
    }

    /// It is not constant.
    pub fn may_be_assigned(&self, var: &VarSym, span: Span) -> Result<(), UppaalFault> {
        if var.readonly {
            return fault(span, format!("`{}` cannot be assigned here", var.name));
        }
        Ok(())
    }

    fn assign(
        &mut self,
        op: Option<UppaalBinaryOperator>,
        to: &UppaalExpr,
        value: &UppaalExpr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        if self.writing == 0 && self.kind_of(to).is_some_and(UppaalSymbol::is_clock) {
            if op.is_some() {
                return fault(span, "a clock is set by `=`");
            }
            let clock = self.clock(to)?;
            let number = if self.mentions_clock(value) { None } else { self.expr(value)?.into_int().value };
            out.push(format!("{clock} = {}", self.setting(value)?));
            self.clock_log.push(ClockEvent { clock, set: Some(number) });
            return Ok(());
        }
        if op.is_none() && matches!(self.kind_of(to), Some(UppaalSymbol::Record(_))) {
            let to = self.place(to)?;
            return self.assign_record(&to, value, span, out);
        }
        let to = self.assigned(to)?;
        if !to.dims.is_empty() {
            return self.assign_array(&to, op, value, span, out);
        }
        let text = place_text(&to);
        let span_of_value = value.span;
        let value = self.expr(value)?.of_type(to.ty.is_bool);
        if let (None, Some(n)) = (op, value.value) {
            in_range(&to.ty, n, span_of_value)?;
        }
        self.mark(&to.name);
        if to.ty.is_bool && op.is_some() {
            return fault(span, "a bool is assigned by `=`");
        }
        out.push(match op {
            None => format!("{text} = {}", value.text),
            Some(UppaalBinaryOperator::Add) => format!("{text} += {}", value.text),
            Some(UppaalBinaryOperator::Sub) => format!("{text} -= {}", value.text),
            Some(UppaalBinaryOperator::Mul) => {
                format!("{text} = {text} * {}", value.at(ScenarioPrecedence::Factor))
            }
            Some(UppaalBinaryOperator::Div) => {
                format!("{text} = {text} / {}", value.at(ScenarioPrecedence::Factor))
            }
            Some(
                op @ (UppaalBinaryOperator::BitAnd
                | UppaalBinaryOperator::BitOr
                | UppaalBinaryOperator::BitXor
                | UppaalBinaryOperator::ShiftLeft
                | UppaalBinaryOperator::ShiftRight),
            ) => {
                let before = self.value_of(&to);
                format!("{text} = {}", self.on_bits(op, before, value, span)?.text)
            }
            Some(_) => format!("{text} = {text} % {}", value.at(ScenarioPrecedence::Atom)),
        });
        Ok(())
    }

    /// `a = b` for whole arrays: each element.
    fn assign_array(
        &mut self,
        to: &VarSym,
        op: Option<UppaalBinaryOperator>,
        value: &UppaalExpr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let UppaalSymbol::Var(from) = self.place(value)? else {
            return fault(value.span, "expected an array");
        };
        if op.is_some() {
            return fault(span, "arrays are assigned by `=`");
        }
        self.assign_value(to, &from, span, out)
    }

    /// A variable, or each element of an array.
    pub fn assign_value(
        &mut self,
        to: &VarSym,
        from: &VarSym,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        self.mark(&to.name);
        let sizes = |v: &VarSym| v.dims.iter().map(|d| d.count()).collect::<Vec<_>>();
        if sizes(to) != sizes(from) || to.ty.is_bool != from.ty.is_bool {
            return fault(span, "arrays are assigned as a whole if they are of one size and type");
        }
        let from_zero = to.dims.iter().map(|d| IndexRange { lo: 0, hi: d.count() - 1 });
        for at in combinations(&from_zero.collect::<Vec<_>>()) {
            let element = |v: &VarSym| {
                let at = v.at.iter().cloned().chain(at.iter().map(|n| ScenarioExprText::int(*n))).collect();
                VarSym { at, dims: Vec::new(), ..v.clone() }
            };
            let value = self.value_of(&element(from));
            out.push(format!("{} = {}", place_text(&element(to)), value.text));
        }
        Ok(())
    }
}
