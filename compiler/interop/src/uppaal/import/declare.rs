//! Declarations: types, constants, variables, clocks, channels, functions.

use std::rc::Rc;

use hrdsl_source::Span;

use super::{
    ast::{
        UppaalBaseType, UppaalDeclaration, UppaalDeclarator, UppaalDimension, UppaalExprKind,
        UppaalInitializer, UppaalParameter, UppaalType,
    },
    fault::{UppaalFault, fault},
    scope::{
        ArrayOf, ChanSym, ClockSym, FunctionSym, IndexRange, NameOwner, ScenarioExprText, ScenarioPrecedence,
        UppaalScalarType, UppaalSymbol, UppaalSymbolType, VarSym, combinations, numbered,
    },
    translation::UppaalTranslation,
};
use crate::exchange::note::NoteSeverity;

/// Single values that one declaration may have.
const MAX_VALUES: i64 = 256;

/// UPPAAL's integers without a range.
pub const INT: (i64, i64) = (-32768, 32767);

impl UppaalTranslation<'_> {
    // ── Types ──

    pub fn ty(&mut self, ty: &UppaalType) -> Result<UppaalSymbolType, UppaalFault> {
        match &ty.base {
            UppaalBaseType::Int(None) => {
                Ok(UppaalSymbolType::Data(UppaalScalarType::range(INT.0, INT.1), Vec::new()))
            }
            UppaalBaseType::Int(Some(bounds)) => {
                let (lo, hi) = (self.expr(&bounds.0)?.into_int(), self.expr(&bounds.1)?.into_int());
                let (Some(l), Some(h)) = (lo.value, hi.value) else {
                    return fault(ty.span, "the bounds of a type must be constant");
                };
                if l > h {
                    return fault(ty.span, format!("the range {l}..{h} is empty"));
                }
                let text = format!("{}..{}", lo.at(ScenarioPrecedence::Sum), hi.at(ScenarioPrecedence::Sum));
                Ok(UppaalSymbolType::Data(
                    UppaalScalarType { text, ..UppaalScalarType::range(l, h) },
                    Vec::new(),
                ))
            }
            UppaalBaseType::Bool => Ok(UppaalSymbolType::Data(UppaalScalarType::bool(), Vec::new())),
            UppaalBaseType::Clock => Ok(UppaalSymbolType::Clock(Vec::new())),
            UppaalBaseType::Chan => {
                let (urgent, broadcast) = (ty.urgent, ty.broadcast);
                Ok(UppaalSymbolType::Chan { urgent, broadcast, dims: Vec::new() })
            }
            UppaalBaseType::Void => Ok(UppaalSymbolType::Void),
            // Its values may only be compared: numbers are as good, though no symmetry is made use of.
            UppaalBaseType::Scalar(size) => match self.constant(size)? {
                n @ 1.. => Ok(UppaalSymbolType::Data(UppaalScalarType::range(0, n - 1), Vec::new())),
                n => fault(ty.span, format!("a scalar set has at least one value, not {n}")),
            },
            UppaalBaseType::Struct(fields) => self.record_type(fields, ty.span),
            UppaalBaseType::Named(name) => match self.find(name).cloned() {
                Some(UppaalSymbol::Type(UppaalSymbolType::Chan { urgent, broadcast, dims })) => {
                    let (urgent, broadcast) = (urgent || ty.urgent, broadcast || ty.broadcast);
                    Ok(UppaalSymbolType::Chan { urgent, broadcast, dims })
                }
                Some(UppaalSymbol::Type(ty)) => Ok(ty),
                Some(other) => fault(ty.span, format!("`{name}` is {}, not a type", other.noun())),
                None => fault(ty.span, format!("there is no type `{name}`")),
            },
        }
    }

    /// A type with the dimensions that stand after the name.
    pub fn declared(
        &mut self,
        ty: &UppaalType,
        dims: &[UppaalDimension],
    ) -> Result<UppaalSymbolType, UppaalFault> {
        let own = dims.iter().map(|d| self.dim(d)).collect::<Result<Vec<_>, _>>()?;
        let out = self.ty(ty)?.within(&own);
        match &out {
            UppaalSymbolType::Data(_, dims) | UppaalSymbolType::Clock(dims) => limited(dims, ty.span)?,
            UppaalSymbolType::Chan { .. } | UppaalSymbolType::Record(..) | UppaalSymbolType::Void => {}
        }
        Ok(out)
    }

    fn dim(&mut self, dim: &UppaalDimension) -> Result<IndexRange, UppaalFault> {
        let size = match dim {
            UppaalDimension::Of(ty) => {
                let scalar = self.scalar(ty)?;
                return Ok(IndexRange { lo: scalar.lo, hi: scalar.hi });
            }
            UppaalDimension::Size(e) => e,
        };
        if let UppaalExprKind::Name(name) = &size.kind
            && let Some(UppaalSymbol::Type(ty)) = self.find(name)
        {
            return match ty {
                UppaalSymbolType::Data(scalar, dims) if dims.is_empty() => {
                    Ok(IndexRange { lo: scalar.lo, hi: scalar.hi })
                }
                UppaalSymbolType::Data(..)
                | UppaalSymbolType::Clock(_)
                | UppaalSymbolType::Chan { .. }
                | UppaalSymbolType::Record(..)
                | UppaalSymbolType::Void => fault(size.span, format!("`{name}` is no type of indices")),
            };
        }
        match self.constant(size)? {
            n @ 1.. => Ok(IndexRange { lo: 0, hi: n - 1 }),
            n => fault(size.span, format!("an array has at least one element, not {n}")),
        }
    }

    // ── Declarations ──

    /// Declares for all (`own` is false) or in the process that is being written.
    pub fn declare(&mut self, decl: &UppaalDeclaration, own: bool) {
        let said = match decl {
            UppaalDeclaration::Comment(lines) => {
                self.said.clone_from(lines);
                return;
            }
            _ => std::mem::take(&mut self.said),
        };
        let before = self.written(own);
        self.declare_one(decl, own);
        if !said.is_empty() && self.faults.is_empty() {
            self.comment(&said, before, own);
        }
    }

    fn declare_one(&mut self, decl: &UppaalDeclaration, own: bool) {
        let declared = match decl {
            UppaalDeclaration::Vars(ty, declarators) => {
                for declarator in declarators {
                    if let Err(fault) = self.variable(ty, declarator, own) {
                        self.undeclared.insert(declarator.name.clone());
                        self.faults.push(fault);
                    }
                }
                Ok(())
            }
            UppaalDeclaration::Typedef(ty, declarator) => self.declared(ty, &declarator.dims).map(|ty| {
                self.bind(&declarator.name, UppaalSymbol::Type(ty), own);
            }),
            UppaalDeclaration::Function(function) => self.declare_function(function, own),
            UppaalDeclaration::Instance(i) if own => {
                fault(i.span, "a process is made in the system's declarations")
            }
            UppaalDeclaration::Instance(_) | UppaalDeclaration::System(_) | UppaalDeclaration::Comment(_) => {
                Ok(())
            }
            UppaalDeclaration::Idle(span, what) => {
                self.notes.push((*span, NoteSeverity::LeftOut, (*what).to_owned()));
                Ok(())
            }
        };
        if let Err(fault) = declared {
            self.undeclared.extend(match decl {
                UppaalDeclaration::Typedef(_, declarator) => Some(declarator.name.clone()),
                UppaalDeclaration::Function(function) => Some(function.name.clone()),
                UppaalDeclaration::Vars(..)
                | UppaalDeclaration::Instance(_)
                | UppaalDeclaration::System(_)
                | UppaalDeclaration::Comment(_)
                | UppaalDeclaration::Idle(..) => None,
            });
            self.faults.push(fault);
        }
    }

    pub fn bind(&mut self, name: &str, sym: UppaalSymbol, own: bool) {
        let scope = match &mut self.process {
            Some(process) if own => process,
            Some(_) | None => &mut self.global,
        };
        scope.insert(name.to_owned(), sym);
    }

    fn owner(own: bool) -> NameOwner {
        if own { NameOwner::Process } else { NameOwner::All }
    }

    fn variable(
        &mut self,
        ty: &UppaalType,
        declarator: &UppaalDeclarator,
        own: bool,
    ) -> Result<(), UppaalFault> {
        let made = self.declared(ty, &declarator.dims)?;
        let sym = self.symbol(ty, declarator, made, own)?;
        self.bind(&declarator.name, sym, own);
        Ok(())
    }

    /// What a declared name stands for, whose type is `made`.
    fn symbol(
        &mut self,
        ty: &UppaalType,
        declarator: &UppaalDeclarator,
        made: UppaalSymbolType,
        own: bool,
    ) -> Result<UppaalSymbol, UppaalFault> {
        let UppaalDeclarator { name, span, init, .. } = declarator;
        Ok(match made {
            UppaalSymbolType::Data(scalar, dims) if ty.constant => {
                limited(&dims, *span)?;
                self.constant_sym(declarator, scalar, dims, own)?
            }
            UppaalSymbolType::Data(scalar, dims) => {
                limited(&dims, *span)?;
                let written = self.names.fresh(name, *span, Self::owner(own));
                let init = self.initial(&scalar, &dims, init.as_ref(), *span)?;
                let line = var_line(&written, &scalar, &dims, &init);
                self.add_line(line, own);
                if ty.meta {
                    self.metas.insert(written.clone());
                }
                let (at, values) = (Vec::new(), None);
                let (local, readonly) = (false, false);
                UppaalSymbol::Var(VarSym {
                    name: written,
                    ty: scalar,
                    dims,
                    at,
                    values,
                    own,
                    local,
                    readonly,
                })
            }
            UppaalSymbolType::Clock(dims) => {
                limited(&dims, *span)?;
                self.clock_sym(name, *span, dims, own)
            }
            UppaalSymbolType::Record(fields, dims) => {
                let of = (fields, dims);
                self.record_of(name, of, (init.as_ref(), *span), |cx, field, made| {
                    cx.symbol(ty, field, made, own)
                })?
            }
            UppaalSymbolType::Chan { urgent, broadcast, dims } => {
                let written = self.names.fresh(name, *span, NameOwner::All);
                if own {
                    return fault(*span, "a channel is declared for all, not in a template");
                }
                let chan = ChanSym { name: written, dims, at: Vec::new(), urgent, broadcast };
                self.channels.push(chan.clone());
                UppaalSymbol::Chan(chan)
            }
            UppaalSymbolType::Void => return fault(*span, "a variable cannot be `void`"),
        })
    }

    fn clock_sym(&mut self, name: &str, span: Span, dims: Vec<IndexRange>, own: bool) -> UppaalSymbol {
        let written = self.names.fresh(name, span, Self::owner(own));
        for at in combinations(&dims) {
            // Elements of arrays are clocks of their own.
            let clock = numbered(&written, &at);
            if !at.is_empty() {
                self.names.unused(&clock, Self::owner(own));
            }
            if own {
                self.own_clocks.push(clock);
            } else {
                self.lines.push(format!("var {clock}: clock"));
            }
        }
        UppaalSymbol::Clock(ClockSym { name: written, dims, own })
    }

    fn constant_sym(
        &mut self,
        declarator: &UppaalDeclarator,
        scalar: UppaalScalarType,
        dims: Vec<IndexRange>,
        own: bool,
    ) -> Result<UppaalSymbol, UppaalFault> {
        let UppaalDeclarator { name, span, init, .. } = declarator;
        let Some(init) = init else { return fault(*span, format!("the constant `{name}` has no value")) };
        if dims.is_empty() {
            let UppaalInitializer::One(e) = init else { return fault(*span, "expected one value") };
            let value = self.expr(e)?.of_type(scalar.is_bool);
            let Some(n) = value.value else { return fault(e.span, "this must be constant") };
            in_range(&scalar, n, e.span)?;
            if own {
                return Ok(UppaalSymbol::Const(scalar.literal(n)));
            }
            let written = self.names.fresh(name, *span, NameOwner::All);
            self.lines.push(format!("const {written} = {}", value.text));
            let out = ScenarioExprText::new(written, ScenarioPrecedence::Atom, scalar.is_bool);
            return Ok(UppaalSymbol::Const(ScenarioExprText { value: Some(n), ..out }));
        }
        let written = self.names.fresh(name, *span, Self::owner(own));
        self.constant_array(written, scalar, dims, init, own, *span)
    }

    /// A constant array is written as a variable that nothing assigns, if an index is not constant.
    fn constant_array(
        &mut self,
        name: String,
        scalar: UppaalScalarType,
        dims: Vec<IndexRange>,
        init: &UppaalInitializer,
        own: bool,
        span: Span,
    ) -> Result<UppaalSymbol, UppaalFault> {
        let text = self.initial(&scalar, &dims, Some(init), span)?;
        let mut values = Vec::new();
        self.flat(&scalar, &dims, Some(init), span, &mut values)?;
        let (lo, hi) = (values.iter().min().copied(), values.iter().max().copied());
        let narrow = match (lo.zip(hi), scalar.is_bool) {
            (Some((lo, hi)), false) => UppaalScalarType::range(lo, hi),
            (Some(_) | None, _) => scalar,
        };
        let line = var_line(&name, &narrow, &dims, &text);
        let arrays = if own { &mut self.own_arrays } else { &mut self.arrays };
        arrays.insert(name.clone(), (line, false));
        let sizes = dims.iter().map(|d| usize::try_from(d.count()).unwrap_or(0)).collect();
        Ok(UppaalSymbol::Var(VarSym {
            name,
            ty: narrow,
            dims,
            at: Vec::new(),
            values: Some(Rc::new(ArrayOf { sizes, values })),
            own,
            local: false,
            readonly: true,
        }))
    }

    /// Notes that a constant array is read with an index that is not constant.
    pub fn use_array(&mut self, var: &VarSym) {
        // In queries the name stands after that of the process.
        let (process, name) = var.name.split_once('.').unwrap_or(("", &var.name));
        let process = self.processes.iter_mut().find(|p| p.name == process);
        let arrays = match process {
            Some(process) => &mut process.arrays,
            None if var.own => &mut self.own_arrays,
            None => &mut self.arrays,
        };
        if let Some(entry) = arrays.get_mut(name) {
            entry.1 = true;
        }
    }

    fn add_line(&mut self, line: String, own: bool) {
        if own { self.own_lines.push(line) } else { self.lines.push(line) }
    }

    /// The value that a variable starts with; tuples for arrays.
    pub fn initial(
        &mut self,
        scalar: &UppaalScalarType,
        dims: &[IndexRange],
        init: Option<&UppaalInitializer>,
        span: Span,
    ) -> Result<String, UppaalFault> {
        let Some((dim, rest)) = dims.split_first() else {
            return match init {
                None => Ok(scalar.literal(scalar.default()).text),
                Some(UppaalInitializer::One(e)) => {
                    let value = self.expr(e)?.of_type(scalar.is_bool);
                    let Some(n) = value.value else { return fault(e.span, "this must be constant") };
                    in_range(scalar, n, e.span)?;
                    Ok(value.text)
                }
                Some(UppaalInitializer::List(_, span)) => fault(*span, "expected one value, not a list"),
                Some(UppaalInitializer::Named(name, _)) => fault(span, format!("`{name}` is no field here")),
            };
        };
        let items = listed(init, *dim, span)?;
        let parts = (0..dim.count())
            .map(|i| {
                let item = items.and_then(|all| all.get(usize::try_from(i).unwrap_or(0)));
                self.initial(scalar, rest, item, span)
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(if parts.len() == 1 { parts.concat() } else { format!("({})", parts.join(", ")) })
    }

    fn flat(
        &mut self,
        scalar: &UppaalScalarType,
        dims: &[IndexRange],
        init: Option<&UppaalInitializer>,
        span: Span,
        out: &mut Vec<i64>,
    ) -> Result<(), UppaalFault> {
        let Some((dim, rest)) = dims.split_first() else {
            out.push(match init {
                Some(UppaalInitializer::One(e)) => self.constant(e)?,
                Some(UppaalInitializer::List(..) | UppaalInitializer::Named(..)) | None => scalar.default(),
            });
            return Ok(());
        };
        let items = listed(init, *dim, span)?;
        for i in 0..dim.count() {
            let item = items.and_then(|all| all.get(usize::try_from(i).unwrap_or(0)));
            self.flat(scalar, rest, item, span, out)?;
        }
        Ok(())
    }

    // ── Functions ──

    fn declare_function(&mut self, decl: &super::ast::UppaalFunction, own: bool) -> Result<(), UppaalFault> {
        let params =
            decl.params.iter().map(|p| self.declared(&p.ty, &p.dims)).collect::<Result<Vec<_>, _>>()?;
        let result = match self.ty(&decl.ty)? {
            UppaalSymbolType::Void => None,
            UppaalSymbolType::Data(scalar, dims) if dims.is_empty() => Some(scalar),
            UppaalSymbolType::Data(..)
            | UppaalSymbolType::Clock(_)
            | UppaalSymbolType::Chan { .. }
            | UppaalSymbolType::Record(..) => {
                return fault(decl.ty.span, "a function gives a single value, or is `void`");
            }
        };
        let is_plain = |(p, ty): (&UppaalParameter, &UppaalSymbolType)| !p.by_reference && ty.is_single();
        let sets_clocks = self.sets_clocks(decl, &params);
        let plain = !sets_clocks && decl.params.iter().zip(&params).all(is_plain);
        let name = plain.then(|| self.names.fresh(&decl.name, decl.span, Self::owner(own)));
        let decl = decl.clone();
        let function = Rc::new(FunctionSym { decl, params, result, own, sets_clocks, name: name.clone() });
        let mut written = Ok(());
        if let Some(name) = name {
            self.declaring = Some(function.decl.name.clone());
            written = self.write_function(&function, &name, Vec::new(), own);
            self.declaring = None;
        }
        let name = function.decl.name.clone();
        // Whatever is wrong with it, calls of it are not.
        self.bind(&name, UppaalSymbol::Function(function), own);
        written
    }
}

fn listed(
    init: Option<&UppaalInitializer>,
    dim: IndexRange,
    span: Span,
) -> Result<Option<&[UppaalInitializer]>, UppaalFault> {
    match init {
        None => Ok(None),
        Some(UppaalInitializer::List(all, _)) if all.len() as i64 == dim.count() => Ok(Some(all)),
        Some(UppaalInitializer::List(all, span)) => {
            fault(*span, format!("this has {} values, and the array {}", all.len(), dim.count()))
        }
        Some(UppaalInitializer::One(_) | UppaalInitializer::Named(..)) => {
            fault(span, "an array is given its values in braces")
        }
    }
}

pub fn in_range(scalar: &UppaalScalarType, n: i64, span: Span) -> Result<(), UppaalFault> {
    if (scalar.lo..=scalar.hi).contains(&n) {
        return Ok(());
    }
    fault(span, format!("{n} is not in the range {}..{}", scalar.lo, scalar.hi))
}

fn limited(dims: &[IndexRange], span: Span) -> Result<(), UppaalFault> {
    let count = dims.iter().try_fold(1i64, |n, d| n.checked_mul(d.count()));
    match count {
        Some(1..=MAX_VALUES) => Ok(()),
        Some(_) | None => fault(span, format!("an array of more than {MAX_VALUES} values is not supported")),
    }
}

pub fn type_text(scalar: &UppaalScalarType, dims: &[IndexRange]) -> String {
    if dims.is_empty() {
        return scalar.text.clone();
    }
    let of = if scalar.is_bool { scalar.text.clone() } else { format!("({})", scalar.text) };
    dims.iter().fold(of, |text, d| format!("{text}[{}]", d.count()))
}

pub fn var_line(name: &str, scalar: &UppaalScalarType, dims: &[IndexRange], init: &str) -> String {
    format!("var {name}: {} = {init}", type_text(scalar, dims))
}
