//! What names with indices and fields stand for, and their values.

use hrdsl_source::Span;

use super::{
    ast::{UppaalExpr, UppaalExprKind, UppaalPlace},
    fault::{UppaalFault, fault},
    scope::{
        ArrayOf, ClockSym, IndexRange, RecordSym, ScenarioExprText, ScenarioPrecedence, UppaalSymbol, VarSym,
        numbered,
    },
    translation::UppaalTranslation,
};

impl UppaalTranslation<'_> {
    pub fn read(&mut self, e: &UppaalExpr) -> Result<ScenarioExprText, UppaalFault> {
        match self.place(e)? {
            UppaalSymbol::Const(out) => Ok(out),
            UppaalSymbol::Var(var) if var.dims.is_empty() => {
                self.read_meta(&var, e.span);
                Ok(self.value_of(&var))
            }
            UppaalSymbol::Record(record) => {
                fault(e.span, format!("`{}` is a record: name one of its fields", record.name))
            }
            UppaalSymbol::Location(text) => Ok(ScenarioExprText::new(text, ScenarioPrecedence::Atom, true)),
            UppaalSymbol::Clock(clock) => fault(
                e.span,
                format!("the clock `{}` may be compared with numbers and clocks only", clock.name),
            ),
            other @ (UppaalSymbol::Var(_)
            | UppaalSymbol::Chan(_)
            | UppaalSymbol::Type(_)
            | UppaalSymbol::Function(_)) => fault(e.span, format!("{} has no value", other.noun())),
        }
    }

    /// The value of a single variable or element.
    pub fn value_of(&mut self, var: &VarSym) -> ScenarioExprText {
        if let Some(values) = &var.values {
            if let Some(n) = constant_element(var, values) {
                return var.ty.literal(n);
            }
            self.use_array(var);
        }
        ScenarioExprText::new(place_text(var), ScenarioPrecedence::Atom, var.ty.is_bool)
    }

    /// What a name with indices stands for.
    pub fn place(&mut self, e: &UppaalExpr) -> Result<UppaalSymbol, UppaalFault> {
        let clocks = self.kind_of(e).is_some_and(UppaalSymbol::has_clocks);
        self.part(e, clocks)
    }

    /// The same of a part of it; `clocks` says whether the whole is a clock, or has one.
    fn part(&mut self, e: &UppaalExpr, clocks: bool) -> Result<UppaalSymbol, UppaalFault> {
        match e.as_place() {
            Some(UppaalPlace::Name(name)) => match self.find(name) {
                Some(sym) => Ok(sym.clone()),
                None if self.in_query && self.processes.iter().any(|p| p.model_name == name) => fault(
                    e.span,
                    format!("`{name}` is a process: `{name}.` and the name of a location or variable"),
                ),
                None => fault(e.span, format!("there is no `{name}` here")),
            },
            Some(UppaalPlace::Index(of, index)) => {
                let sym = self.part(of, clocks)?;
                let mut value = self.expr(index)?.into_int();
                if clocks && let Some(dim) = sym.first_dim() {
                    value = self.clock_index(dim, index, value)?;
                }
                if let Some(dim) = sym.first_dim().filter(|_| self.in_query && value.value.is_none()) {
                    value = self.limited(index, value, dim);
                }
                element(sym, value, index.span)
            }
            Some(UppaalPlace::Field(of, name)) => self.member(of, name, e.span, clocks),
            None => fault(e.span, "expected the name of a variable, a clock or a channel"),
        }
    }

    /// An index in a query, which a scenario must know to be one: elsewhere an index that is none is a fault of the model.
    fn limited(&self, index: &UppaalExpr, value: ScenarioExprText, dim: IndexRange) -> ScenarioExprText {
        if let Some(UppaalSymbol::Var(v)) = self.kind_of(index)
            && dim.lo <= v.ty.lo
            && v.ty.hi <= dim.hi
        {
            return value;
        }
        let text = format!("max({}, min({}, {}))", dim.lo, dim.hi, value.text);
        ScenarioExprText::new(text, ScenarioPrecedence::Atom, false)
    }

    /// `P.x`, `P(1).x`: what a process has of this name; `r.f`: the field of a record.
    fn member(
        &mut self,
        of: &UppaalExpr,
        name: &str,
        span: Span,
        clocks: bool,
    ) -> Result<UppaalSymbol, UppaalFault> {
        if !self.is_process(of) {
            return match self.part(of, clocks)? {
                UppaalSymbol::Record(record) if !record.dims.is_empty() => {
                    fault(span, format!("`{}` is an array of records: an index is missing", record.name))
                }
                UppaalSymbol::Record(record) => match record.fields.get(name) {
                    Some(field) => Ok(field.clone()),
                    None => fault(span, format!("the record `{}` has no field `{name}`", record.name)),
                },
                other => fault(span, format!("{} has no fields", other.noun())),
            };
        }
        let (process, args) = match &of.kind {
            UppaalExprKind::Call(of, args) => {
                (of.root(), args.iter().map(|a| self.constant(a)).collect::<Result<Vec<_>, _>>()?)
            }
            _ => (of.root(), Vec::new()),
        };
        let process = process.unwrap_or_default();
        let Some(found) = self.processes.iter().find(|p| p.model_name == *process && p.args == args) else {
            let message = format!("there is no process `{process}` with these arguments in the system");
            return fault(span, message);
        };
        let Some(sym) = found.scope.get(name) else {
            return fault(span, format!("the process `{process}` has no location or variable `{name}`"));
        };
        let mut sym = sym.clone();
        sym.leaves_mut().into_iter().for_each(|leaf| leaf.belong_to(&found.name));
        Ok(sym)
    }

    /// In queries: whether it names a process.
    pub fn is_process(&self, e: &UppaalExpr) -> bool {
        let of = match &e.kind {
            UppaalExprKind::Call(of, _) => of,
            _ => e,
        };
        let UppaalExprKind::Name(name) = &of.kind else { return false };
        self.in_query && self.processes.iter().any(|p| p.model_name == *name)
    }

    /// What something named is, whatever its indices are.
    pub fn kind_of(&self, e: &UppaalExpr) -> Option<&UppaalSymbol> {
        match e.as_place()? {
            UppaalPlace::Name(name) => self.find(name),
            UppaalPlace::Index(of, _) => self.kind_of(of),
            // What `forall` binds may be an argument of the process: any of its processes has the same clocks.
            UppaalPlace::Field(of, field) if self.is_process(of) => {
                let name = match &of.kind {
                    UppaalExprKind::Call(of, _) => of.root(),
                    _ => of.root(),
                };
                self.processes.iter().find(|p| name == Some(&p.model_name))?.scope.get(field)
            }
            UppaalPlace::Field(of, field) => match self.kind_of(of)? {
                UppaalSymbol::Record(record) => record.fields.get(field),
                _ => None,
            },
        }
    }
}

/// An element of an array.
pub fn element(sym: UppaalSymbol, index: ScenarioExprText, span: Span) -> Result<UppaalSymbol, UppaalFault> {
    let Some(dims) = sym.dims() else { return fault(span, format!("{} has no elements", sym.noun())) };
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
        UppaalSymbol::Record(record) => {
            let each = |(name, field): (String, UppaalSymbol)| {
                element(field, index.clone(), span).map(|field| (name, field))
            };
            let fields = record.fields.into_iter().map(each).collect::<Result<_, _>>()?;
            UppaalSymbol::Record(RecordSym { name: record.name, dims: rest, fields })
        }
        UppaalSymbol::Var(mut v) => {
            v.dims = rest;
            v.at.push(from_zero(index, dim.lo));
            UppaalSymbol::Var(v)
        }
        UppaalSymbol::Clock(c) => {
            // Without a constant it is part of a record of which another field is asked.
            let name = index.value.map_or(c.name.clone(), |n| numbered(&c.name, &[n]));
            UppaalSymbol::Clock(ClockSym { name, dims: rest, own: c.own })
        }
        UppaalSymbol::Chan(mut c) => {
            c.dims = rest;
            c.at.push(index);
            UppaalSymbol::Chan(c)
        }
        other @ (UppaalSymbol::Const(_)
        | UppaalSymbol::Type(_)
        | UppaalSymbol::Function(_)
        | UppaalSymbol::Location(_)) => other,
    })
}

/// Text of a variable with its indices.
pub fn place_text(var: &VarSym) -> String {
    var.at.iter().fold(var.name.clone(), |text, at| format!("{text}[{}]", at.text))
}

/// The element of a constant array, if all indices are constant.
fn constant_element(var: &VarSym, array: &ArrayOf) -> Option<i64> {
    let mut at = 0;
    for (index, size) in var.at.iter().zip(&array.sizes) {
        at = at * size + usize::try_from(index.value?).ok()?;
    }
    array.values.get(at).copied()
}

fn from_zero(index: ScenarioExprText, lo: i64) -> ScenarioExprText {
    match (lo, index.value) {
        (0, _) => index,
        (_, Some(n)) => ScenarioExprText::int(n - lo),
        (lo, None) if lo > 0 => ScenarioExprText::new(
            format!("{} - {lo}", index.at(ScenarioPrecedence::Sum)),
            ScenarioPrecedence::Sum,
            false,
        ),
        (lo, None) => ScenarioExprText::new(
            format!("{} + {}", index.at(ScenarioPrecedence::Sum), lo.unsigned_abs()),
            ScenarioPrecedence::Sum,
            false,
        ),
    }
}
