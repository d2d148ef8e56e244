//! Expressions: what they are in the scenario. Bools and numbers, which UPPAAL mixes, are told apart.

use hrdsl_source::Span;

use super::{
    ast::{BinaryOp, Expr, ExprKind, Quantifier, Type},
    fault::{Fault, fault, unsupported},
    scope::{ArrayOf, ChanSym, ClockSym, Level, Out, Scalar, Scope, Sym, Ty, VarSym, numbered},
    translation::Cx,
};

/// How many parts `forall`, `exists` and `sum` may become.
const MAX_PARTS: i64 = 1024;

impl Cx<'_> {
    pub fn find(&self, name: &str) -> Option<&Sym> {
        let scopes = self.locals.iter().rev().chain(&self.process).chain([&self.global]);
        scopes.into_iter().find_map(|s| s.get(name))
    }

    /// A constant number.
    pub fn constant(&mut self, e: &Expr) -> Result<i64, Fault> {
        match self.expr(e)?.value {
            Some(n) => Ok(n),
            None => fault(e.span, "this must be constant"),
        }
    }

    pub fn condition(&mut self, e: &Expr) -> Result<Out, Fault> {
        Ok(self.expr(e)?.into_bool())
    }

    pub fn expr(&mut self, e: &Expr) -> Result<Out, Fault> {
        match &e.kind {
            ExprKind::Int(n) => Ok(Out::int(*n)),
            ExprKind::Bool(b) => Ok(Out::bool(*b)),
            ExprKind::Name(_) | ExprKind::Index(..) | ExprKind::Field(..) => self.read(e),
            ExprKind::Neg(of) => self.negative(of),
            ExprKind::Not(of) => {
                let of = self.condition(of)?;
                Ok(not(&of))
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, e.span),
            ExprKind::Choice(c, a, b) => self.choice(c, a, b),
            ExprKind::Call(of, args) => self.call(of, args, e.span).and_then(|(text, result)| {
                let Some(result) = result else {
                    return fault(e.span, "this function has no value (`void`)");
                };
                Ok(Out::new(text, Level::Atom, result.is_bool))
            }),
            ExprKind::Quantified(q, name, ty, of) => self.quantified(*q, name, ty, of),
            ExprKind::Assign(..) => fault(
                e.span,
                "an assignment within an expression is not supported: write it before, \
                 or put parentheses around what is assigned (`and`, `or` and `not` bind looser than `=`)",
            ),
            ExprKind::Step { .. } => fault(
                e.span,
                "`++` and `--` within an expression are not supported: write them as an assignment of their own",
            ),
            ExprKind::Rate => Err(unsupported(e.span, "rates of clocks (`x'`)")),
            ExprKind::Deadlock if self.in_query => Ok(Out::new("deadlock".to_owned(), Level::Atom, true)),
            ExprKind::Deadlock => fault(e.span, "`deadlock` may be asked in queries only"),
        }
    }

    fn negative(&mut self, of: &Expr) -> Result<Out, Fault> {
        let of = self.expr(of)?.into_int();
        if let Some(n) = of.value.filter(|_| of.text.bytes().all(|b| b.is_ascii_digit())) {
            return Ok(Out::int(-n));
        }
        let text = format!("-{}", of.at(Level::Atom));
        Ok(Out { value: of.value.map(|n| -n), ..Out::new(text, Level::Factor, false) })
    }

    fn choice(&mut self, c: &Expr, a: &Expr, b: &Expr) -> Result<Out, Fault> {
        let c = self.condition(c)?;
        let (a, b) = (self.expr(a)?, self.expr(b)?);
        let is_bool = a.is_bool && b.is_bool;
        let (a, b) = (a.of_type(is_bool), b.of_type(is_bool));
        if let Some(c) = c.value {
            return Ok(if c != 0 { a } else { b });
        }
        let text = format!("if {} {{ {} }} else {{ {} }}", c.text, a.text, b.text);
        Ok(Out::new(text, Level::Atom, is_bool))
    }

    fn binary(&mut self, op: BinaryOp, a: &Expr, b: &Expr, span: Span) -> Result<Out, Fault> {
        let (a, b) = (self.expr(a)?, self.expr(b)?);
        let both_bools = a.is_bool && b.is_bool;
        let (sign, level, of_bools) = match op {
            BinaryOp::Or => ("||", Level::Or, true),
            BinaryOp::And => ("&&", Level::And, true),
            BinaryOp::Imply => ("imply", Level::Imply, true),
            BinaryOp::Eq => ("==", Level::Comparison, both_bools),
            BinaryOp::Ne => ("!=", Level::Comparison, both_bools),
            BinaryOp::Lt => ("<", Level::Comparison, false),
            BinaryOp::Le => ("<=", Level::Comparison, false),
            BinaryOp::Gt => (">", Level::Comparison, false),
            BinaryOp::Ge => (">=", Level::Comparison, false),
            BinaryOp::Add => ("+", Level::Sum, false),
            BinaryOp::Sub => ("-", Level::Sum, false),
            BinaryOp::Mul => ("*", Level::Product, false),
            BinaryOp::Div => ("/", Level::Product, false),
            BinaryOp::Rem => ("%", Level::Product, false),
            BinaryOp::Min => ("min", Level::Atom, false),
            BinaryOp::Max => ("max", Level::Atom, false),
        };
        let (a, b) = (a.of_type(of_bools), b.of_type(of_bools));
        let value = a.value.zip(b.value).map(|(a, b)| fold(op, a, b, span)).transpose()?;
        if value.is_none() && matches!(op, BinaryOp::And | BinaryOp::Or) {
            let both = [a, b].into_iter();
            return Ok(if op == BinaryOp::And { all(both) } else { any(both) });
        }
        let is_bool = level <= Level::Comparison;
        let text = match op {
            BinaryOp::Min | BinaryOp::Max => format!("{sign}({}, {})", a.text, b.text),
            BinaryOp::Imply => format!("{} imply {}", a.at(Level::Or), b.at(Level::Or)),
            BinaryOp::Or | BinaryOp::And | BinaryOp::Add | BinaryOp::Mul => {
                format!("{} {sign} {}", a.at(level), b.at(level))
            }
            BinaryOp::Sub | BinaryOp::Div => format!("{} {sign} {}", a.at(level), b.at(next(level))),
            // After `%` a sign is not the beginning of an operand.
            BinaryOp::Rem => format!("{} % {}", a.at(level), b.at(Level::Atom)),
            BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                format!("{} {sign} {}", a.at(Level::Sum), b.at(Level::Sum))
            }
        };
        Ok(Out { text, level, is_bool, value })
    }

    fn quantified(&mut self, q: Quantifier, name: &str, ty: &Type, of: &Expr) -> Result<Out, Fault> {
        let parts = self.parts(name, ty, |cx| cx.expr(of))?;
        if q == Quantifier::Sum {
            let parts = parts.into_iter().map(Out::into_int);
            return Ok(joined(parts, "+", Level::Sum, Out::int(0), |a, b| a.checked_add(b)));
        }
        let parts = parts.into_iter().map(Out::into_bool);
        Ok(if q == Quantifier::Forall { all(parts) } else { any(parts) })
    }

    /// What is made of each value of a type.
    pub fn parts<T>(
        &mut self,
        name: &str,
        ty: &Type,
        make: impl Fn(&mut Self) -> Result<T, Fault>,
    ) -> Result<Vec<T>, Fault> {
        let scalar = self.scalar(ty)?;
        if scalar.hi - scalar.lo >= MAX_PARTS {
            return fault(ty.span, format!("this has more than {MAX_PARTS} values"));
        }
        let mut parts = Vec::new();
        for n in scalar.lo..=scalar.hi {
            self.locals.push(Scope::from_iter([(name.to_owned(), Sym::Const(scalar.literal(n)))]));
            let part = make(self);
            self.locals.pop();
            parts.push(part?);
        }
        Ok(parts)
    }

    // ── Places ──

    fn read(&mut self, e: &Expr) -> Result<Out, Fault> {
        match self.place(e)? {
            Sym::Const(out) => Ok(out),
            Sym::Var(var) if var.dims.is_empty() => Ok(self.value_of(&var)),
            Sym::Location(text) => Ok(Out::new(text, Level::Atom, true)),
            Sym::Clock(clock) => fault(
                e.span,
                format!("the clock `{}` may be compared with numbers and clocks only", clock.name),
            ),
            other @ (Sym::Var(_) | Sym::Chan(_) | Sym::Type(_) | Sym::Function(_)) => {
                fault(e.span, format!("{} has no value", other.noun()))
            }
        }
    }

    /// The value of a single variable or element.
    pub fn value_of(&mut self, var: &VarSym) -> Out {
        if let Some(values) = &var.values {
            if let Some(n) = element(var, values) {
                return var.ty.literal(n);
            }
            self.use_array(var);
        }
        Out::new(place_text(var), Level::Atom, var.ty.is_bool)
    }

    /// What a name with indices stands for.
    pub fn place(&mut self, e: &Expr) -> Result<Sym, Fault> {
        match &e.kind {
            ExprKind::Name(name) => match self.find(name) {
                Some(sym) => Ok(sym.clone()),
                None if self.in_query && self.processes.iter().any(|p| p.model_name == *name) => fault(
                    e.span,
                    format!("`{name}` is a process: `{name}.` and the name of a location or variable"),
                ),
                None => fault(e.span, format!("there is no `{name}` here")),
            },
            ExprKind::Index(of, index) => {
                let sym = self.place(of)?;
                let index_span = index.span;
                let index = self.expr(index)?.into_int();
                self.element(sym, index, index_span)
            }
            ExprKind::Field(of, name) => self.member(of, name, e.span),
            ExprKind::Int(_)
            | ExprKind::Bool(_)
            | ExprKind::Neg(_)
            | ExprKind::Not(_)
            | ExprKind::Binary(..)
            | ExprKind::Choice(..)
            | ExprKind::Call(..)
            | ExprKind::Assign(..)
            | ExprKind::Step { .. }
            | ExprKind::Quantified(..)
            | ExprKind::Rate
            | ExprKind::Deadlock => fault(e.span, "expected the name of a variable, a clock or a channel"),
        }
    }

    fn element(&mut self, sym: Sym, index: Out, span: Span) -> Result<Sym, Fault> {
        let dims = match &sym {
            Sym::Var(v) => &v.dims,
            Sym::Clock(c) => &c.dims,
            Sym::Chan(c) => &c.dims,
            Sym::Const(_) | Sym::Type(_) | Sym::Function(_) | Sym::Location(_) => {
                return fault(span, format!("{} has no elements", sym.noun()));
            }
        };
        let Some((dim, rest)) = dims.split_first() else {
            return fault(span, format!("{} has no more elements", sym.noun()));
        };
        if let Some(n) = index.value
            && !(dim.lo..=dim.hi).contains(&n)
        {
            return fault(span, format!("{n} is none of the indices {}..{}", dim.lo, dim.hi));
        }
        let (dim, rest) = (*dim, rest.to_vec());
        Ok(match sym {
            Sym::Var(mut v) => {
                v.dims = rest;
                v.at.push(from_zero(index, dim.lo));
                Sym::Var(v)
            }
            Sym::Clock(c) => {
                let Some(n) = index.value else {
                    return fault(span, "the index of an array of clocks must be constant");
                };
                Sym::Clock(ClockSym { name: numbered(&c.name, &[n]), dims: rest, own: c.own })
            }
            Sym::Chan(mut c) => {
                c.dims = rest;
                c.at.push(index);
                Sym::Chan(c)
            }
            other @ (Sym::Const(_) | Sym::Type(_) | Sym::Function(_) | Sym::Location(_)) => other,
        })
    }

    /// `P.x`, `P(1).x`: what a process has of this name.
    fn member(&mut self, of: &Expr, name: &str, span: Span) -> Result<Sym, Fault> {
        let (process, args) = match &of.kind {
            ExprKind::Name(process) => (process, Vec::new()),
            ExprKind::Call(of, args) if self.in_query => {
                let ExprKind::Name(process) = &of.kind else { return fault(span, "expected a process") };
                let args = args.iter().map(|a| self.constant(a)).collect::<Result<Vec<_>, _>>()?;
                (process, args)
            }
            _ => return Err(unsupported(span, "records (`struct`)")),
        };
        if !self.in_query {
            return Err(unsupported(span, "records (`struct`)"));
        }
        let Some(found) = self.processes.iter().position(|p| p.model_name == *process && p.args == args)
        else {
            return fault(
                span,
                format!("there is no process `{process}` with these arguments in the system"),
            );
        };
        let found = &self.processes[found];
        let Some(sym) = found.scope.get(name) else {
            return fault(span, format!("the process `{process}` has no location or variable `{name}`"));
        };
        let automaton = &found.name;
        Ok(match sym.clone() {
            Sym::Var(v) if v.own => Sym::Var(VarSym { name: format!("{automaton}.{}", v.name), ..v }),
            Sym::Clock(c) if c.own => Sym::Clock(ClockSym { name: format!("{automaton}.{}", c.name), ..c }),
            Sym::Location(l) => Sym::Location(format!("{automaton}.{l}")),
            other @ (Sym::Const(_)
            | Sym::Var(_)
            | Sym::Clock(_)
            | Sym::Chan(_)
            | Sym::Type(_)
            | Sym::Function(_)) => other,
        })
    }

    // ── Types ──

    /// The type of single values.
    pub fn scalar(&mut self, ty: &Type) -> Result<Scalar, Fault> {
        match self.ty(ty)? {
            Ty::Data(scalar, dims) if dims.is_empty() => Ok(scalar),
            Ty::Data(..) | Ty::Clock(_) | Ty::Chan { .. } | Ty::Void => {
                fault(ty.span, "expected a type of single values: `bool`, or integers of a range")
            }
        }
    }

    pub fn channel<'s>(&mut self, sym: &'s Sym, span: Span) -> Result<&'s ChanSym, Fault> {
        match sym {
            Sym::Chan(c) if c.dims.is_empty() => Ok(c),
            Sym::Chan(c) => fault(span, format!("`{}` is an array of channels: an index is missing", c.name)),
            other => fault(span, format!("expected a channel, found {}", other.noun())),
        }
    }
}

/// Text of a variable with its indices.
pub fn place_text(var: &VarSym) -> String {
    var.at.iter().fold(var.name.clone(), |text, at| format!("{text}[{}]", at.text))
}

/// The element of a constant array, if all indices are constant.
fn element(var: &VarSym, array: &ArrayOf) -> Option<i64> {
    let mut at = 0;
    for (index, size) in var.at.iter().zip(&array.sizes) {
        at = at * size + usize::try_from(index.value?).ok()?;
    }
    array.values.get(at).copied()
}

fn from_zero(index: Out, lo: i64) -> Out {
    match (lo, index.value) {
        (0, _) => index,
        (_, Some(n)) => Out::int(n - lo),
        (lo, None) if lo > 0 => Out::new(format!("{} - {lo}", index.at(Level::Sum)), Level::Sum, false),
        (lo, None) => {
            Out::new(format!("{} + {}", index.at(Level::Sum), lo.unsigned_abs()), Level::Sum, false)
        }
    }
}

fn next(level: Level) -> Level {
    match level {
        Level::Sum => Level::Product,
        Level::Product => Level::Factor,
        Level::Imply
        | Level::Or
        | Level::And
        | Level::Not
        | Level::Comparison
        | Level::Factor
        | Level::Atom => Level::Atom,
    }
}

pub fn not(of: &Out) -> Out {
    match of.value {
        Some(n) => Out::bool(n == 0),
        None => Out::new(format!("not {}", of.at(Level::Atom)), Level::Not, true),
    }
}

fn joined(
    parts: impl Iterator<Item = Out>,
    sign: &str,
    level: Level,
    none: Out,
    fold: impl Fn(i64, i64) -> Option<i64>,
) -> Out {
    parts
        .reduce(|a, b| {
            let value = a.value.zip(b.value).and_then(|(a, b)| fold(a, b));
            let text = format!("{} {sign} {}", a.at(level), b.at(level));
            Out { value, ..Out::new(text, level, none.is_bool) }
        })
        .unwrap_or(none)
}

/// The conjunction; what is certainly true is left out.
pub fn all(parts: impl Iterator<Item = Out>) -> Out {
    let parts: Vec<Out> = parts.filter(|p| p.value != Some(1)).collect();
    match parts.iter().find(|p| p.value == Some(0)) {
        Some(_) => Out::bool(false),
        None => joined(parts.into_iter(), "&&", Level::And, Out::bool(true), |a, b| Some(a & b)),
    }
}

/// The disjunction; what is certainly false is left out.
pub fn any(parts: impl Iterator<Item = Out>) -> Out {
    let parts: Vec<Out> = parts.filter(|p| p.value != Some(0)).collect();
    match parts.iter().find(|p| p.value == Some(1)) {
        Some(_) => Out::bool(true),
        None => joined(parts.into_iter(), "||", Level::Or, Out::bool(false), |a, b| Some(a | b)),
    }
}

fn fold(op: BinaryOp, a: i64, b: i64, span: Span) -> Result<i64, Fault> {
    let value = match op {
        BinaryOp::Add => a.checked_add(b),
        BinaryOp::Sub => a.checked_sub(b),
        BinaryOp::Mul => a.checked_mul(b),
        BinaryOp::Div if b == 0 => return fault(span, "this divides by zero"),
        BinaryOp::Rem if b == 0 => return fault(span, "this divides by zero"),
        BinaryOp::Div => a.checked_div(b),
        BinaryOp::Rem => a.checked_rem(b),
        BinaryOp::Min => Some(a.min(b)),
        BinaryOp::Max => Some(a.max(b)),
        BinaryOp::Eq => Some(i64::from(a == b)),
        BinaryOp::Ne => Some(i64::from(a != b)),
        BinaryOp::Lt => Some(i64::from(a < b)),
        BinaryOp::Le => Some(i64::from(a <= b)),
        BinaryOp::Gt => Some(i64::from(a > b)),
        BinaryOp::Ge => Some(i64::from(a >= b)),
        BinaryOp::And => Some(i64::from(a != 0 && b != 0)),
        BinaryOp::Or => Some(i64::from(a != 0 || b != 0)),
        BinaryOp::Imply => Some(i64::from(a == 0 || b != 0)),
    };
    value
        .filter(|n| i32::try_from(*n).is_ok())
        .ok_or_else(|| Fault { span, message: "this is larger than UPPAAL's integers".to_owned() })
}
