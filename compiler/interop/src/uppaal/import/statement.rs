//! Functions and updates: statements of a scenario.

use std::rc::Rc;

use hrdsl_source::Span;

use super::{
    ast::{
        UppaalDeclaration, UppaalDeclarator, UppaalExpr, UppaalExprKind, UppaalInitializer, UppaalParameter,
        UppaalStatement, UppaalStatementKind, UppaalType,
    },
    declare::var_line,
    fault::{UppaalFault, fault},
    place::place_text,
    scope::{
        FunctionSym, IndexRange, NameOwner, UppaalScalarType, UppaalScope, UppaalSymbol, UppaalSymbolType,
        VarSym,
    },
    translation::UppaalTranslation,
};

impl UppaalTranslation<'_> {
    // ── Calls ──

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
                    aliases.push((param.name.clone(), self.alias(arg, readonly)?));
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

    /// What a parameter that is a reference stands for.
    fn alias(&mut self, arg: &UppaalExpr, readonly: bool) -> Result<UppaalSymbol, UppaalFault> {
        let mut sym = self.place(arg)?;
        for leaf in sym.leaves() {
            let UppaalSymbol::Var(var) = leaf else { return fault(arg.span, "expected a variable") };
            if var.local {
                return fault(arg.span, "a variable of a function cannot be given as a reference");
            }
            if var.at.iter().any(|i| i.value.is_none()) {
                return fault(arg.span, "the index of what is given as a reference must be constant");
            }
            if var.values.is_some() {
                self.use_array(var);
            }
        }
        if readonly {
            sym.make_readonly();
        }
        Ok(sym)
    }

    /// One function for each combination of what its references stand for.
    fn specialised(
        &mut self,
        function: &Rc<FunctionSym>,
        aliases: Vec<(String, UppaalSymbol)>,
    ) -> Result<String, UppaalFault> {
        let is_own = |sym: &UppaalSymbol| {
            sym.leaves().into_iter().any(|leaf| matches!(leaf, UppaalSymbol::Var(v) if v.own))
        };
        let own = function.own || aliases.iter().any(|(_, sym)| is_own(sym));
        let shown: Vec<String> = aliases.iter().map(|(_, sym)| alias_text(sym)).collect();
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
        aliases: Vec<(String, UppaalSymbol)>,
        own: bool,
    ) -> Result<(), UppaalFault> {
        if self.writing > 20 {
            return fault(function.decl.span, "a function that calls itself is not supported");
        }
        if function.result.is_some() && !function.decl.body.last().is_some_and(UppaalStatement::returns) {
            let message = format!("`{}` can end without `return`, and has no value then", function.decl.name);
            return fault(function.decl.span, message);
        }
        let mut scope: UppaalScope = aliases.into_iter().collect();
        if self.writing == 0 {
            self.names.start_function();
        }
        let mut params = Vec::new();
        for (param, ty) in function.decl.params.iter().zip(&function.params) {
            if scope.contains_key(&param.name) {
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

    // ── Statements ──

    fn statements(
        &mut self,
        all: &[UppaalStatement],
        result: Option<&UppaalScalarType>,
    ) -> Result<Vec<String>, UppaalFault> {
        self.locals.push(UppaalScope::new());
        let mut lines = Vec::new();
        let written = all.iter().try_for_each(|s| self.statement(s, result, &mut lines));
        self.locals.pop();
        written.map(|()| lines)
    }

    fn nested(
        &mut self,
        s: &UppaalStatement,
        result: Option<&UppaalScalarType>,
    ) -> Result<String, UppaalFault> {
        let all = match &s.kind {
            UppaalStatementKind::Block(all) => self.statements(all, result)?,
            _ => self.statements(std::slice::from_ref(s), result)?,
        };
        Ok(format!("{{\n{}\n}}", all.join("\n")))
    }

    fn statement(
        &mut self,
        s: &UppaalStatement,
        result: Option<&UppaalScalarType>,
        lines: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        match &s.kind {
            UppaalStatementKind::Empty => {}
            UppaalStatementKind::Decl(decl) => self.local_declaration(decl, s.span, lines)?,
            UppaalStatementKind::Expr(e) => {
                let mut effects = Vec::new();
                self.effect(e, &mut effects)?;
                lines.extend(effects.into_iter().map(|e| e + ";"));
            }
            UppaalStatementKind::Block(all) => {
                let inner = self.statements(all, result)?;
                lines.extend(inner);
            }
            UppaalStatementKind::If(c, then, otherwise) => {
                let c = self.tested(c, lines)?;
                let mut text = format!("if {c} {}", self.nested(then, result)?);
                if let Some(otherwise) = otherwise {
                    text += &format!(" else {}", self.nested(otherwise, result)?);
                }
                lines.push(text);
            }
            UppaalStatementKind::While(c, body) => self.while_loop(c, body, false, result, lines)?,
            UppaalStatementKind::DoWhile(body, c) => self.while_loop(c, body, true, result, lines)?,
            UppaalStatementKind::For(init, c, step, body) => {
                self.for_loop(init, c.as_ref(), step, body, result, lines)?
            }
            UppaalStatementKind::ForRange(name, ty, body) => {
                let scalar = self.scalar(ty)?;
                if scalar.is_bool {
                    return fault(ty.span, "`for` over `bool` is not supported: say `int[0,1]`");
                }
                let written = self.names.fresh(name, s.span, NameOwner::Function);
                let sym = UppaalSymbol::Var(local(written.clone(), scalar.clone(), Vec::new(), true));
                self.locals.push(UppaalScope::from_iter([(name.clone(), sym)]));
                let body = self.nested(body, result);
                self.locals.pop();
                lines.push(format!("for {written} in {} {}", scalar.text, body?));
            }
            UppaalStatementKind::Return(None) => lines.push("return;".to_owned()),
            UppaalStatementKind::Return(Some(e)) => self.return_statement(e, s.span, result, lines)?,
        }
        Ok(())
    }

    fn return_statement(
        &mut self,
        e: &UppaalExpr,
        span: Span,
        result: Option<&UppaalScalarType>,
        lines: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let Some(result) = result else { return fault(span, "this function has no value (`void`)") };
        let mut effects = Vec::new();
        let (value, after) = self.value_in_order(e, &mut effects)?;
        let value = value.of_type(result.is_bool).text;
        lines.extend(effects.into_iter().map(|e| e + ";"));
        if after.is_empty() {
            lines.push(format!("return {value};"));
            return Ok(());
        }
        let given = self.names.unused("given", NameOwner::Function);
        lines.push(format!("var {given}: {} = {value};", result.text));
        lines.extend(after.into_iter().map(|e| e + ";"));
        lines.push(format!("return {given};"));
        Ok(())
    }

    /// `while`, and `do`, whose first round is not asked for.
    fn while_loop(
        &mut self,
        c: &UppaalExpr,
        body: &UppaalStatement,
        first: bool,
        result: Option<&UppaalScalarType>,
        lines: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let again = first.then(|| self.names.unused("again", NameOwner::Function));
        let (mut before, block) = (Vec::new(), self.nested(body, result)?);
        let (c, after) = self.value_in_order(c, &mut before)?;
        let c = c.into_bool().text;
        if again.is_none() && before.is_empty() && after.is_empty() {
            lines.push(format!("while {c} {block}"));
            return Ok(());
        }
        let starts = if first { "true" } else { &c };
        let again = again.unwrap_or_else(|| self.names.unused("again", NameOwner::Function));
        if !first {
            lines.extend(before.iter().map(|e| format!("{e};")));
        }
        lines.push(format!("var {again}: bool = {starts};"));
        if !first {
            lines.extend(after.iter().map(|e| format!("{e};")));
        }
        let once_more = ordered(&before, &format!("{again} = {c}"), &after);
        lines.push(format!("while {again} {{{}{once_more}}}", inner(&block)));
        Ok(())
    }

    /// A condition, before which stands what it changes.
    fn tested(&mut self, c: &UppaalExpr, lines: &mut Vec<String>) -> Result<String, UppaalFault> {
        let mut effects = Vec::new();
        let (c, after) = self.value_in_order(c, &mut effects)?;
        let c = c.into_bool().text;
        lines.extend(effects.into_iter().map(|e| e + ";"));
        if after.is_empty() {
            return Ok(c);
        }
        let holds = self.names.unused("is_so", NameOwner::Function);
        lines.push(format!("var {holds}: bool = {c};"));
        lines.extend(after.into_iter().map(|e| e + ";"));
        Ok(holds)
    }

    fn for_loop(
        &mut self,
        init: &[UppaalExpr],
        c: Option<&UppaalExpr>,
        step: &[UppaalExpr],
        body: &UppaalStatement,
        result: Option<&UppaalScalarType>,
        lines: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let mut effects = Vec::new();
        init.iter().try_for_each(|e| self.effect(e, &mut effects))?;
        lines.extend(effects.drain(..).map(|e| e + ";"));
        let c = match c {
            Some(c) => self.condition(c)?.text,
            None => "true".to_owned(),
        };
        let body = self.nested(body, result)?;
        step.iter().try_for_each(|e| self.effect(e, &mut effects))?;
        let step = effects.iter().map(|e| format!("{e};\n")).collect::<String>();
        lines.push(format!("while {c} {{{}{step}}}", inner(&body)));
        Ok(())
    }

    fn local_declaration(
        &mut self,
        decl: &UppaalDeclaration,
        span: Span,
        lines: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let (ty, declarators) = match decl {
            UppaalDeclaration::Vars(ty, declarators) => (ty, declarators),
            UppaalDeclaration::Typedef(ty, declarator) => {
                let ty = self.declared(ty, &declarator.dims)?;
                self.bind_local(&declarator.name, UppaalSymbol::Type(ty));
                return Ok(());
            }
            UppaalDeclaration::Function(_)
            | UppaalDeclaration::Instance(_)
            | UppaalDeclaration::System(_)
            | UppaalDeclaration::Comment(_)
            | UppaalDeclaration::Idle(..) => {
                return fault(span, "this cannot be declared in a function");
            }
        };
        for declarator in declarators {
            let made = self.declared(ty, &declarator.dims)?;
            let sym = self.local_symbol(ty, declarator, made, lines)?;
            self.bind_local(&declarator.name, sym);
        }
        Ok(())
    }

    fn local_symbol(
        &mut self,
        ty: &UppaalType,
        declarator: &UppaalDeclarator,
        made: UppaalSymbolType,
        lines: &mut Vec<String>,
    ) -> Result<UppaalSymbol, UppaalFault> {
        let UppaalDeclarator { name, span, init, .. } = declarator;
        let (scalar, dims) = match made {
            UppaalSymbolType::Data(scalar, dims) => (scalar, dims),
            UppaalSymbolType::Record(fields, dims) => {
                let init = (init.as_ref(), *span);
                return self.record_of(name, (fields, dims), init, |cx, field, made| {
                    cx.local_symbol(ty, field, made, lines)
                });
            }
            UppaalSymbolType::Clock(_) | UppaalSymbolType::Chan { .. } | UppaalSymbolType::Void => {
                return fault(*span, "a function has variables only: no clocks and channels");
            }
        };
        let constant = match init {
            Some(UppaalInitializer::One(e)) if ty.constant && dims.is_empty() => self.expr(e)?.value,
            Some(_) | None => None,
        };
        if let Some(n) = constant {
            return Ok(UppaalSymbol::Const(scalar.literal(n)));
        }
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let init = match init {
            Some(UppaalInitializer::One(e)) if dims.is_empty() => {
                let (value, effects) = self.value_in_order(e, &mut before)?;
                after = effects;
                value.of_type(scalar.is_bool).text
            }
            init => self.initial(&scalar, &dims, init.as_ref(), *span)?,
        };
        let written = self.names.fresh(name, *span, NameOwner::Function);
        lines.extend(before.into_iter().map(|e| e + ";"));
        lines.push(var_line(&written, &scalar, &dims, &init) + ";");
        lines.extend(after.into_iter().map(|e| e + ";"));
        Ok(UppaalSymbol::Var(local(written, scalar, dims, ty.constant)))
    }

    fn bind_local(&mut self, name: &str, sym: UppaalSymbol) {
        if let Some(scope) = self.locals.last_mut() {
            scope.insert(name.to_owned(), sym);
        }
    }
}

/// What stands between the braces of a block.
fn inner(block: &str) -> &str {
    block.strip_prefix('{').and_then(|b| b.strip_suffix('}')).unwrap_or_default()
}

/// Statements one after the other.
fn ordered(before: &[String], between: &str, after: &[String]) -> String {
    let all = before.iter().map(String::as_str).chain([between]).chain(after.iter().map(String::as_str));
    all.map(|e| format!("{e};\n")).collect()
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

fn local(name: String, ty: UppaalScalarType, dims: Vec<IndexRange>, readonly: bool) -> VarSym {
    VarSym { name, ty, dims, at: Vec::new(), values: None, own: false, local: true, readonly }
}
