//! Functions: their calls, and how often each is written.

use std::rc::Rc;

use hrdsl_source::Span;

use super::{
    ast::{UppaalExpr, UppaalExprKind, UppaalParameter, UppaalStatement},
    declare::INT,
    fault::{UppaalFault, fault},
    place::place_text,
    scope::{
        FunctionSym, NameOwner, ScenarioExprText, ScenarioPrecedence, UppaalScalarType, UppaalScope,
        UppaalSymbol, UppaalSymbolType,
    },
    statement::local,
    translation::UppaalTranslation,
};

/// A parameter that is not a copy: what it stands for, and how many of its indices the function is given.
pub struct FunctionAlias {
    name: String,
    sym: UppaalSymbol,
    indices: usize,
}

impl UppaalTranslation<'_> {
    /// The call's text and what it gives.
    pub fn call(
        &mut self,
        of: &UppaalExpr,
        args: &[UppaalExpr],
        span: Span,
    ) -> Result<(String, Option<UppaalScalarType>), UppaalFault> {
        let UppaalExprKind::Name(name) = &of.kind else {
            return fault(span, "expected the name of a function");
        };
        if self.declaring.as_ref() == Some(name) {
            let message = format!("the function `{name}` calls itself, which none may: write a loop");
            return fault(of.span, message);
        }
        let Some(sym) = self.find(name).cloned() else {
            return fault(of.span, format!("there is no function `{name}` here"));
        };
        let UppaalSymbol::Function(function) = sym else {
            return fault(of.span, format!("`{name}` is {}, not a function", sym.noun()));
        };
        if function.params.len() != args.len() {
            let (want, got) = (function.params.len(), args.len());
            return fault(span, format!("`{name}` has {want} parameters, and is given {got} arguments"));
        }
        if function.sets_clocks {
            let message =
                format!("`{name}` sets clocks: it is called as an update of its own, and has no value");
            return fault(span, message);
        }
        self.mark_function(&function, args, 0);
        let (mut values, mut aliases) = (Vec::new(), Vec::new());
        for ((param, ty), arg) in function.decl.params.iter().zip(&function.params).zip(args) {
            match ty {
                UppaalSymbolType::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                    values.push(self.expr(arg)?.of_type(scalar.is_bool).text);
                }
                UppaalSymbolType::Record(..) if ty.is_single() && !param.by_reference => {
                    let sym = self.place(arg)?;
                    for leaf in sym.leaves() {
                        match leaf {
                            UppaalSymbol::Var(v) => values.push(self.value_of(v).text),
                            UppaalSymbol::Const(out) => values.push(out.text.clone()),
                            other => {
                                return fault(arg.span, format!("expected a record, found {}", other.noun()));
                            }
                        }
                    }
                }
                UppaalSymbolType::Data(..) | UppaalSymbolType::Record(..) => {
                    let readonly = !param.by_reference || param.ty.constant;
                    let (sym, indices) = self.alias(arg, readonly)?;
                    aliases.push(FunctionAlias { name: param.name.clone(), sym, indices: indices.len() });
                    values.extend(indices);
                }
                UppaalSymbolType::Clock(_) | UppaalSymbolType::Chan { .. } | UppaalSymbolType::Void => {
                    return fault(
                        arg.span,
                        "only variables can be given to functions, no clocks and channels",
                    );
                }
            }
        }
        let text = match &function.name {
            Some(written) => written.clone(),
            None => self.specialised(&function, aliases)?,
        };
        Ok((format!("{text}({})", values.join(", ")), function.result.clone()))
    }

    /// What a parameter that is a reference stands for, and its indices that are not constant: the function is given them.
    fn alias(
        &mut self,
        arg: &UppaalExpr,
        readonly: bool,
    ) -> Result<(UppaalSymbol, Vec<String>), UppaalFault> {
        let mut sym = self.place(arg)?;
        let mut indices: Vec<String> = Vec::new();
        for leaf in sym.leaves_mut() {
            let UppaalSymbol::Var(var) = leaf else { return fault(arg.span, "expected a variable") };
            if var.local {
                return fault(arg.span, "a variable of a function cannot be given as a reference");
            }
            for at in var.at.iter_mut().filter(|at| at.value.is_none()) {
                let known = indices.iter().position(|text| *text == at.text);
                let number = known.unwrap_or(indices.len());
                if known.is_none() {
                    indices.push(at.text.clone());
                }
                *at = ScenarioExprText::new(given_index(number), ScenarioPrecedence::Atom, false);
            }
            if var.values.is_some() {
                self.use_array(var);
            }
        }
        if readonly {
            sym.make_readonly();
        }
        Ok((sym, indices))
    }

    /// One function for each combination of what its references stand for.
    fn specialised(
        &mut self,
        function: &Rc<FunctionSym>,
        aliases: Vec<FunctionAlias>,
    ) -> Result<String, UppaalFault> {
        let is_own = |sym: &UppaalSymbol| {
            sym.leaves().into_iter().any(|leaf| matches!(leaf, UppaalSymbol::Var(v) if v.own))
        };
        let own = function.own || aliases.iter().any(|alias| is_own(&alias.sym));
        let shown: Vec<String> = aliases.iter().map(|alias| alias_text(&alias.sym)).collect();
        let key = format!("{} {} {}", function.own, function.decl.name, shown.join(" "));
        let known = if own { &self.own_specialised } else { &self.specialised };
        if let Some(name) = known.get(&key) {
            return Ok(name.clone());
        }
        let owner = if own { NameOwner::Process } else { NameOwner::All };
        let name = self.names.unused(&format!("{}_{}", function.decl.name, shown.join("_")), owner);
        let known = if own { &mut self.own_specialised } else { &mut self.specialised };
        known.insert(key, name.clone());
        self.write_function(function, &name, aliases, own)?;
        Ok(name)
    }

    /// Writes a function; `own` says whether it goes to the process.
    pub fn write_function(
        &mut self,
        function: &Rc<FunctionSym>,
        name: &str,
        aliases: Vec<FunctionAlias>,
        own: bool,
    ) -> Result<(), UppaalFault> {
        if self.writing > 20 {
            return fault(function.decl.span, "a function that calls itself is not supported");
        }
        if function.result.is_some() && !function.decl.body.last().is_some_and(UppaalStatement::returns) {
            let message = format!("`{}` can end without `return`, and has no value then", function.decl.name);
            return fault(function.decl.span, message);
        }
        let mut scope = UppaalScope::new();
        if self.writing == 0 {
            self.names.start_function();
        }
        let mut params = Vec::new();
        for (param, ty) in function.decl.params.iter().zip(&function.params) {
            if let Some(alias) = aliases.iter().find(|alias| alias.name == param.name) {
                let mut sym = alias.sym.clone();
                for number in 0..alias.indices {
                    let written = self.names.unused(&format!("{}_at", param.name), NameOwner::Function);
                    params.push(format!("{written}: {}..{}", INT.0, INT.1));
                    sym.leaves_mut()
                        .into_iter()
                        .for_each(|leaf| index_by(leaf, &given_index(number), &written));
                }
                scope.insert(param.name.clone(), sym);
                continue;
            }
            let sym = self.parameter(param, ty.clone(), &param.name, &mut params)?;
            scope.insert(param.name.clone(), sym);
        }
        // What the function knows: nothing of where it is called.
        let locals = std::mem::replace(&mut self.locals, vec![scope]);
        let process = if function.own { None } else { self.process.take() };
        let cases = self.cases.take();
        self.writing += 1;
        let body = self.statements(&function.decl.body, function.result.as_ref());
        self.writing -= 1;
        self.cases = cases;
        self.locals = locals;
        if process.is_some() {
            self.process = process;
        }
        let result = function.result.as_ref().map(|r| format!(" -> {}", r.text)).unwrap_or_default();
        let text = format!("fn {name}({}){result} {{\n{}\n}}", params.join(", "), body?.join("\n"));
        if own {
            self.own_functions.push(text)
        } else {
            self.functions.push(text)
        }
        Ok(())
    }

    /// A parameter that is a copy; of a record each field is one.
    fn parameter(
        &mut self,
        param: &UppaalParameter,
        ty: UppaalSymbolType,
        name: &str,
        params: &mut Vec<String>,
    ) -> Result<UppaalSymbol, UppaalFault> {
        match ty {
            UppaalSymbolType::Data(scalar, _) => {
                let written = self.names.fresh(name, param.span, NameOwner::Function);
                params.push(format!("{written}: {}", scalar.text));
                Ok(UppaalSymbol::Var(local(written, scalar, Vec::new(), param.ty.constant)))
            }
            UppaalSymbolType::Record(fields, dims) => {
                let none = (None, param.span);
                self.record_of(name, (fields, dims), none, |cx, field, ty| {
                    cx.parameter(param, ty, &field.name, params)
                })
            }
            UppaalSymbolType::Clock(_) | UppaalSymbolType::Chan { .. } | UppaalSymbolType::Void => {
                fault(param.span, "only variables can be given to functions, no clocks and channels")
            }
        }
    }
}

/// How an index that a function is given is written until it has a name.
fn given_index(number: usize) -> String {
    format!("@{number}")
}

fn index_by(sym: &mut UppaalSymbol, given: &str, name: &str) {
    if let UppaalSymbol::Var(var) = sym {
        for at in var.at.iter_mut().filter(|at| at.text == given) {
            name.clone_into(&mut at.text);
        }
    }
}

/// How a reference is told apart from others.
fn alias_text(sym: &UppaalSymbol) -> String {
    match sym {
        UppaalSymbol::Var(v) => place_text(v),
        UppaalSymbol::Record(r) => r.fields.values().map(alias_text).collect::<Vec<_>>().join("_"),
        UppaalSymbol::Const(_)
        | UppaalSymbol::Clock(_)
        | UppaalSymbol::Chan(_)
        | UppaalSymbol::Type(_)
        | UppaalSymbol::Function(_)
        | UppaalSymbol::Location(_) => sym.noun().to_owned(),
    }
}
