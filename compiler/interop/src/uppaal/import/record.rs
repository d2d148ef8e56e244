//! Records (`struct`): each field is a variable of its own, or an array where the record is in one.

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    ast::{
        UppaalBinaryOperator, UppaalDeclarator, UppaalExpr, UppaalExprKind, UppaalInitializer, UppaalType,
    },
    expr::{all, not},
    fault::{UppaalFault, fault},
    known::ClockEvent,
    scope::{IndexRange, RecordSym, ScenarioExprText, ScenarioPrecedence, UppaalSymbol, UppaalSymbolType},
    translation::UppaalTranslation,
};

impl UppaalTranslation<'_> {
    /// The type of a record.
    pub fn record_type(
        &mut self,
        fields: &[(UppaalType, Vec<UppaalDeclarator>)],
        span: Span,
    ) -> Result<UppaalSymbolType, UppaalFault> {
        let mut out: Vec<(String, UppaalSymbolType)> = Vec::new();
        for (ty, declarators) in fields {
            for declarator in declarators {
                if out.iter().any(|(name, _)| *name == declarator.name) {
                    return fault(declarator.span, format!("there are two fields `{}`", declarator.name));
                }
                let made = self.declared(ty, &declarator.dims)?;
                if matches!(made, UppaalSymbolType::Chan { .. } | UppaalSymbolType::Void) {
                    return fault(declarator.span, "a field of a record is a variable or a clock");
                }
                out.push((declarator.name.clone(), made));
            }
        }
        if out.is_empty() {
            return fault(span, "a record has at least one field");
        }
        Ok(UppaalSymbolType::Record(out, Vec::new()))
    }

    /// What a record is of: each field with what it begins with.
    pub fn record_of(
        &mut self,
        name: &str,
        (fields, dims): (Vec<(String, UppaalSymbolType)>, Vec<IndexRange>),
        (init, span): (Option<&UppaalInitializer>, Span),
        mut make: impl FnMut(&mut Self, &UppaalDeclarator, UppaalSymbolType) -> Result<UppaalSymbol, UppaalFault>,
    ) -> Result<UppaalSymbol, UppaalFault> {
        if let Some(init) = init {
            counted(init, dims.len(), fields.len())?;
        }
        let mut made = IndexMap::new();
        for (at, (field, ty)) in fields.into_iter().enumerate() {
            let init = init.map(|init| projected(init, dims.len(), at, &field)).transpose()?;
            let declarator =
                UppaalDeclarator { name: format!("{name}_{field}"), span, dims: Vec::new(), init };
            let sym = make(self, &declarator, ty.within(&dims))?;
            made.insert(field, sym);
        }
        Ok(UppaalSymbol::Record(RecordSym { name: name.to_owned(), dims, fields: made }))
    }

    /// `a == b`, `a != b` of records: nothing, if they are none.
    pub fn same_records(
        &mut self,
        op: UppaalBinaryOperator,
        a: &UppaalExpr,
        b: &UppaalExpr,
        span: Span,
    ) -> Result<Option<ScenarioExprText>, UppaalFault> {
        let is_record = |cx: &Self, e: &UppaalExpr| {
            matches!(cx.kind_of(e), Some(UppaalSymbol::Record(_))) && !cx.is_process(e)
        };
        let compared = matches!(op, UppaalBinaryOperator::Eq | UppaalBinaryOperator::Ne);
        if !compared || !is_record(self, a) || !is_record(self, b) {
            return Ok(None);
        }
        let (left, right) = (self.place(a)?, self.place(b)?);
        let (left, right) = (left.leaves(), right.leaves());
        let mut parts = Vec::new();
        for pair in left.iter().zip(&right) {
            let (UppaalSymbol::Var(a), UppaalSymbol::Var(b)) = pair else {
                return fault(span, "records with clocks cannot be compared");
            };
            if !a.dims.is_empty() || !b.dims.is_empty() || a.ty.is_bool != b.ty.is_bool {
                return fault(span, "records are compared if all their fields are single values");
            }
            let (a, b) = (self.value_of(a), self.value_of(b));
            let text = format!("{} == {}", a.at(ScenarioPrecedence::Sum), b.at(ScenarioPrecedence::Sum));
            parts.push(match a.value.zip(b.value) {
                Some((a, b)) => ScenarioExprText::bool(a == b),
                None => ScenarioExprText::new(text, ScenarioPrecedence::Comparison, true),
            });
        }
        if left.len() != right.len() {
            return fault(span, "these records have different fields");
        }
        let same = all(parts.into_iter());
        Ok(Some(if op == UppaalBinaryOperator::Eq { same } else { not(&same) }))
    }

    /// `a = b` of records: each field.
    pub fn assign_record(
        &mut self,
        to: &UppaalSymbol,
        value: &UppaalExpr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let UppaalSymbol::Record(from) = self.place(value)? else {
            return fault(value.span, "expected a record");
        };
        let from = UppaalSymbol::Record(from);
        let (to, from) = (to.leaves(), from.leaves());
        if to.len() != from.len() {
            return fault(span, "these records have different fields");
        }
        for pair in to.into_iter().zip(from) {
            match pair {
                (UppaalSymbol::Var(to), UppaalSymbol::Var(from)) => {
                    self.may_be_assigned(to, span)?;
                    self.assign_value(to, from, span, out)?;
                }
                (UppaalSymbol::Clock(to), UppaalSymbol::Clock(from)) if self.writing == 0 => {
                    out.push(format!("{} = {}", to.name, from.name));
                    self.clock_log.push(ClockEvent { clock: from.name.clone(), set: None });
                    self.clock_log.push(ClockEvent { clock: to.name.clone(), set: Some(None) });
                }
                (to, _) => return fault(span, format!("{} cannot be assigned here", to.noun())),
            }
        }
        Ok(())
    }
}

impl UppaalSymbolType {
    /// A single value, or a record of such: functions are given copies of them.
    pub fn is_single(&self) -> bool {
        match self {
            Self::Data(_, dims) => dims.is_empty(),
            Self::Record(fields, dims) => dims.is_empty() && fields.iter().all(|(_, ty)| ty.is_single()),
            Self::Clock(_) | Self::Chan { .. } | Self::Void => false,
        }
    }

    pub fn has_clocks(&self) -> bool {
        match self {
            Self::Clock(_) => true,
            Self::Record(fields, _) => fields.iter().any(|(_, ty)| ty.has_clocks()),
            Self::Data(..) | Self::Chan { .. } | Self::Void => false,
        }
    }

    /// Of an array with these dimensions before its own.
    pub fn within(self, outer: &[IndexRange]) -> Self {
        let with = |dims: Vec<IndexRange>| outer.iter().copied().chain(dims).collect();
        match self {
            Self::Data(scalar, dims) => Self::Data(scalar, with(dims)),
            Self::Clock(dims) => Self::Clock(with(dims)),
            Self::Chan { urgent, broadcast, dims } => Self::Chan { urgent, broadcast, dims: with(dims) },
            Self::Record(fields, dims) => Self::Record(fields, with(dims)),
            Self::Void => Self::Void,
        }
    }
}

/// Every record has as many values as fields.
fn counted(init: &UppaalInitializer, depth: usize, fields: usize) -> Result<(), UppaalFault> {
    match init {
        UppaalInitializer::List(items, _) if depth > 0 => {
            items.iter().try_for_each(|item| counted(item, depth - 1, fields))
        }
        UppaalInitializer::List(items, span) if items.len() != fields => {
            fault(*span, format!("this has {} values, and the record {fields} fields", items.len()))
        }
        UppaalInitializer::Named(_, of) => counted(of, depth, fields),
        UppaalInitializer::List(..) | UppaalInitializer::One(_) => Ok(()),
    }
}

/// What one field begins with, in each record of an array of `depth` dimensions.
fn projected(
    init: &UppaalInitializer,
    depth: usize,
    at: usize,
    name: &str,
) -> Result<UppaalInitializer, UppaalFault> {
    match init {
        UppaalInitializer::List(items, span) if depth > 0 => {
            let items = items.iter().map(|item| projected(item, depth - 1, at, name));
            Ok(UppaalInitializer::List(items.collect::<Result<_, _>>()?, *span))
        }
        UppaalInitializer::List(items, span) => {
            let named = items.iter().find_map(|item| match item {
                UppaalInitializer::Named(field, of) if field == name => Some((**of).clone()),
                UppaalInitializer::Named(..) | UppaalInitializer::One(_) | UppaalInitializer::List(..) => {
                    None
                }
            });
            let placed = items.get(at).filter(|item| !matches!(item, UppaalInitializer::Named(..)));
            match named.or_else(|| placed.cloned()) {
                Some(found) => Ok(found),
                None => fault(*span, format!("the field `{name}` is given no value")),
            }
        }
        UppaalInitializer::One(e) => {
            let kind = UppaalExprKind::Field(Box::new(e.clone()), name.to_owned());
            Ok(UppaalInitializer::One(UppaalExpr { kind, span: e.span }))
        }
        UppaalInitializer::Named(_, of) => projected(of, depth, at, name),
    }
}
