//! Clocks: those that all automata share, what clocks are compared with, and what they are set to.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, AccessSyntax, ExprSyntaxKind as Syntax, NameSyntax};

use crate::check::{
    automata::{automaton::EdgeScope, phase::AutomataPhase},
    state::scope::ExprEnv,
    template::CheckerPhase,
    value::{
        linear::{LinearTime, linear},
        operands::{calls, names_in},
    },
};
use crate::{
    BinaryOp, ClockId, ClockOp, Dimension, InferredType, TypedClockConstraint, TypedTime, TypedUpdate,
    UnaryOp, Value,
    expr::ComparisonOp,
    noun::Noun,
    report::{automata, types},
};

/// A sum of clocks, each with its sign, and of a time.
#[derive(Default)]
struct ClockSum {
    clocks: Vec<(ClockId, i8)>,
    time: LinearTime,
}

impl ClockSum {
    fn add(&mut self, clock: ClockId, sign: i8) {
        match self.clocks.iter_mut().find(|(c, _)| *c == clock) {
            Some((_, known)) => *known = known.saturating_add(sign),
            None => self.clocks.push((clock, sign)),
        }
    }

    /// The clocks that do not cancel out, in the order of the text.
    fn left(&self) -> Vec<(ClockId, i8)> {
        self.clocks.iter().copied().filter(|(_, sign)| *sign != 0).collect()
    }
}

impl AutomataPhase<'_, '_> {
    /// The clock of this name: `x`, `t[1]`.
    fn clock_named(&self, name: &str, scope: &EdgeScope) -> Option<ClockId> {
        let own = || {
            let shared = u16::try_from(self.s.clocks.len()).unwrap_or(u16::MAX);
            scope.clocks.get(name).map(|i| shared.saturating_add(i))
        };
        self.shared.clocks.get(name).or_else(own).map(ClockId)
    }

    /// The clock that an expression is. `None`: it is none; `Some(None)`: it has a diagnostic.
    fn clock_of(
        &mut self,
        e: &ast::ExprSyntax,
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<Option<ClockId>> {
        let (mut of, mut indices) = (e, Vec::new());
        while let Syntax::Index { of: inner, index } = &of.kind {
            indices.push(&**index);
            of = inner;
        }
        indices.reverse();
        let Syntax::Path(path) = &of.kind else { return None };
        let [name] = path.names.as_slice() else { return None };
        is_clock(name, env).then(|| self.clock_at(name, &indices, scope, env))
    }

    /// The clock of a name and constant indices.
    fn clock_at(
        &mut self,
        name: &NameSyntax,
        indices: &[&ast::ExprSyntax],
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<ClockId> {
        self.refer(name, env.place_of(&name.text));
        let sizes = env.shared.clock_arrays.get(&name.text).cloned().unwrap_or_default();
        if sizes.len() != indices.len() {
            self.report(automata::clock_indices(&name.text, sizes.len(), name.span));
            return None;
        }
        let mut full = name.text.clone();
        for (index, size) in indices.iter().zip(sizes) {
            let Value::Int(i) = self.constant(index, InferredType::Int, env)? else { return None };
            if i < 0 || i >= i64::from(size) {
                let at = crate::TypedExpr::value(Value::Int(i), InferredType::Int, index.span);
                self.report(types::bad_index(&at, i64::from(size) - 1));
                return None;
            }
            full = format!("{full}[{i}]");
        }
        self.clock_named(&full, scope)
    }

    /// Adds an expression to a sum of clocks and times. `None`: it has a diagnostic.
    fn add_to(
        &mut self,
        sum: &mut ClockSum,
        e: &ast::ExprSyntax,
        sign: i8,
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<()> {
        if let Some(clock) = self.clock_of(e, scope, env) {
            sum.add(clock?, sign);
            return Some(());
        }
        if mentions_clock(e, env) {
            if let Syntax::Binary { op: op @ (BinaryOp::Add | BinaryOp::Sub), left, right } = &e.kind {
                let right_sign = if *op == BinaryOp::Add { sign } else { -sign };
                let left = self.add_to(sum, left, sign, scope, env);
                return self.add_to(sum, right, right_sign, scope, env).and(left);
            }
            if let Syntax::Unary { op: UnaryOp::Neg, operand } = &e.kind {
                return self.add_to(sum, operand, -sign, scope, env);
            }
        }
        let e = self.expr_of(e, InferredType::Float(Dimension::TIME), env);
        match linear(&e) {
            Ok(time) => sum.time.add(time, f64::from(sign)),
            Err(Some(span)) => {
                self.report(automata::not_linear(span));
                return None;
            }
            Err(None) => return None,
        }
        Some(())
    }

    /// A time in nanoseconds.
    pub(in crate::check) fn time_of(&mut self, time: LinearTime, sign: f64, span: Span) -> Option<TypedTime> {
        match time.time(sign) {
            Ok(time) => Some(time),
            Err(why) => {
                self.report(automata::bad_time(why, span));
                None
            }
        }
    }

    // ── bounds ──

    /// A comparison of a clock, or of the difference of two, with a time. `None`: there is no clock in it, or it is no
    /// comparison; `Some(None)`: it is a bound, but a wrong one.
    pub(in crate::check) fn clock_bound(
        &mut self,
        e: &ast::ExprSyntax,
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<Option<TypedClockConstraint>> {
        let Syntax::Binary { op, left, right } = &e.kind else { return None };
        let op = clock_op(ComparisonOp::of(*op)?);
        if !mentions_clock(left, env) && !mentions_clock(right, env) {
            return None;
        }
        if op.is_none() {
            self.report(automata::clock_comparison("!=", e.span));
        }
        let mut sum = ClockSum::default();
        let left = self.add_to(&mut sum, left, 1, scope, env);
        let right = self.add_to(&mut sum, right, -1, scope, env);
        let Some((op, _)) = op.zip(left.and(right)) else { return Some(None) };
        // INVARIANT: `Σ clocks + time op 0`; the first clock gets the sign +.
        let clocks = sum.left();
        let (clock, minus, flipped) = match clocks.as_slice() {
            [(x, sign @ (1 | -1))] => (*x, None, *sign < 0),
            [(x, 1), (y, -1)] => (*x, Some(*y), false),
            [(x, -1), (y, 1)] => (*x, Some(*y), true),
            _ => {
                self.report(automata::clock_sum(e.span));
                return Some(None);
            }
        };
        let (op, sign) = if flipped { (mirrored(op), 1.0) } else { (op, -1.0) };
        let bound = self.time_of(sum.time, sign, e.span);
        Some(bound.map(|bound| TypedClockConstraint { clock, minus, op, bound }))
    }

    /// `stopped(x)`: the clock that stands still. `None`: it is something else; `Some(None)`: it has a diagnostic.
    pub(in crate::check) fn stopped_clock(
        &mut self,
        e: &ast::ExprSyntax,
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<Option<ClockId>> {
        // A function of this name is what it was.
        if env.function("stopped").is_some() || !calls(e, "stopped") {
            return None;
        }
        let Syntax::Call { callee, args } = &e.kind else {
            self.report(automata::stopped_within(e.span));
            return Some(None);
        };
        if callee.names.last().is_none_or(|name| name.text != "stopped") {
            self.report(automata::stopped_within(e.span));
            return Some(None);
        }
        let clock = match args.as_slice() {
            [clock] => self.clock_of(clock, scope, env),
            _ => None,
        };
        if clock.is_none() {
            self.report(automata::stopped_what(e.span));
        }
        Some(clock.flatten())
    }

    // ── updates ──

    /// `x = 0`, `x = n * 1 s`, `x = y + 2 s`, `x += 1 s`, `t[0] = 0`
    pub(in crate::check) fn set_clock(
        &mut self,
        (target, access): (&NameSyntax, &[AccessSyntax]),
        op: Option<BinaryOp>,
        value: &ast::ExprSyntax,
        scope: &EdgeScope,
        env: &mut ExprEnv,
    ) -> Option<TypedUpdate> {
        let mut indices = Vec::new();
        for step in access {
            match step {
                AccessSyntax::Index(e) => indices.push(e),
                AccessSyntax::Field(_) => {
                    self.report(automata::clock_set(&target.text, target.span));
                    return None;
                }
            }
        }
        let clock = self.clock_at(target, &indices, scope, env)?;
        if op.is_none() && value.kind == Syntax::Int(0) {
            return Some(TypedUpdate::Reset { clock, from: None, to: TypedTime::default() });
        }
        let mut sum = ClockSum::default();
        self.add_to(&mut sum, value, if op == Some(BinaryOp::Sub) { -1 } else { 1 }, scope, env)?;
        let from = match (op, sum.left().as_slice()) {
            (None, []) => None,
            (Some(_), []) => Some(clock),
            (None, [(from, 1)]) => Some(*from),
            (_, _) => {
                self.report(automata::clock_set(&target.text, value.span));
                return None;
            }
        };
        let to = self.time_of(sum.time, 1.0, value.span)?;
        if from.is_none() && to.fixed().is_some_and(|t| t < 0) {
            self.report(types::must_be("what a clock is set to", "at least 0 s", value.span));
            return None;
        }
        Some(TypedUpdate::Reset { clock, from, to })
    }
}

/// Whether a name is a clock's, or that of an array of clocks.
pub(in crate::check) fn is_clock(name: &NameSyntax, env: &ExprEnv) -> bool {
    env.find(&name.text).is_some_and(|l| l.noun == Noun::Clock)
}

pub(in crate::check) fn mentions_clock(e: &ast::ExprSyntax, env: &ExprEnv) -> bool {
    names_in(e).into_iter().any(|name| is_clock(name, env))
}

/// How clocks are compared; `None`: they are not compared by `!=`.
fn clock_op(op: ComparisonOp) -> Option<ClockOp> {
    match op {
        ComparisonOp::Lt => Some(ClockOp::Lt),
        ComparisonOp::Le => Some(ClockOp::Le),
        ComparisonOp::Eq => Some(ClockOp::Eq),
        ComparisonOp::Ge => Some(ClockOp::Ge),
        ComparisonOp::Gt => Some(ClockOp::Gt),
        ComparisonOp::Ne => None,
    }
}

/// What an operator is when both sides change their signs.
fn mirrored(op: ClockOp) -> ClockOp {
    match op {
        ClockOp::Lt => ClockOp::Gt,
        ClockOp::Le => ClockOp::Ge,
        ClockOp::Eq => ClockOp::Eq,
        ClockOp::Ge => ClockOp::Le,
        ClockOp::Gt => ClockOp::Lt,
    }
}
