//! Functions and updates: statements of a scenario.

use std::rc::Rc;

use hrdsl_source::Span;

use super::{
    ast::{
        UppaalBinaryOperator, UppaalDeclaration, UppaalExpr, UppaalExprKind, UppaalStatement,
        UppaalStatementKind,
    },
    declare::var_line,
    expr::place_text,
    fault::{UppaalFault, fault},
    scope::{
        FunctionSym, NameOwner, ScenarioExprText, ScenarioPrecedence, UppaalScalarType, UppaalScope,
        UppaalSymbol, UppaalSymbolType, VarSym, combinations,
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
        let (mut values, mut aliases) = (Vec::new(), Vec::new());
        for ((param, ty), arg) in function.decl.params.iter().zip(&function.params).zip(args) {
            match ty {
                UppaalSymbolType::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                    values.push(self.expr(arg)?.of_type(scalar.is_bool).text);
                }
                UppaalSymbolType::Data(..) => {
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
    fn alias(&mut self, arg: &UppaalExpr, readonly: bool) -> Result<VarSym, UppaalFault> {
        let UppaalSymbol::Var(mut var) = self.place(arg)? else {
            return fault(arg.span, "expected a variable");
        };
        if var.local {
            return fault(arg.span, "a variable of a function cannot be given as a reference");
        }
        if var.at.iter().any(|i| i.value.is_none()) {
            return fault(arg.span, "the index of what is given as a reference must be constant");
        }
        if var.values.is_some() {
            self.use_array(&var);
        }
        var.readonly |= readonly;
        Ok(var)
    }

    /// One function for each combination of what its references stand for.
    fn specialised(
        &mut self,
        function: &Rc<FunctionSym>,
        aliases: Vec<(String, VarSym)>,
    ) -> Result<String, UppaalFault> {
        let own = function.own || aliases.iter().any(|(_, v)| v.own);
        let shown: Vec<String> = aliases.iter().map(|(_, v)| place_text(v)).collect();
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
        aliases: Vec<(String, VarSym)>,
        own: bool,
    ) -> Result<(), UppaalFault> {
        if self.writing > 20 {
            return fault(function.decl.span, "a function that calls itself is not supported");
        }
        let mut scope: UppaalScope =
            aliases.into_iter().map(|(name, v)| (name, UppaalSymbol::Var(v))).collect();
        if self.writing == 0 {
            self.names.start_function();
        }
        let mut params = Vec::new();
        for (param, ty) in function.decl.params.iter().zip(&function.params) {
            let UppaalSymbolType::Data(scalar, _) = ty else { continue };
            if scope.contains_key(&param.name) {
                continue;
            }
            let written = self.names.fresh(&param.name, param.span, NameOwner::Function);
            params.push(format!("{written}: {}", scalar.text));
            scope.insert(
                param.name.clone(),
                UppaalSymbol::Var(local(written, scalar.clone(), Vec::new(), param.ty.constant)),
            );
        }
        // What the function knows: nothing of where it is called.
        let locals = std::mem::replace(&mut self.locals, vec![scope]);
        let process = if function.own { None } else { self.process.take() };
        self.writing += 1;
        let body = self.statements(&function.decl.body, function.result.as_ref());
        self.writing -= 1;
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
                let c = self.condition(c)?;
                let mut text = format!("if {} {}", c.text, self.nested(then, result)?);
                if let Some(otherwise) = otherwise {
                    text += &format!(" else {}", self.nested(otherwise, result)?);
                }
                lines.push(text);
            }
            UppaalStatementKind::While(c, body) => {
                let c = self.condition(c)?;
                lines.push(format!("while {} {}", c.text, self.nested(body, result)?));
            }
            UppaalStatementKind::DoWhile(body, c) => {
                let again = self.names.unused("again", NameOwner::Function);
                let body = self.nested(body, result)?;
                let c = self.condition(c)?;
                lines.push(format!("var {again}: bool = true;"));
                let inner = body.strip_prefix('{').and_then(|b| b.strip_suffix('}')).unwrap_or_default();
                lines.push(format!("while {again} {{{inner}{again} = {}\n}}", c.text));
            }
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
            UppaalStatementKind::Return(Some(e)) => {
                let Some(result) = result else {
                    return fault(s.span, "this function has no value (`void`)");
                };
                let value = self.expr(e)?.of_type(result.is_bool);
                lines.push(format!("return {};", value.text));
            }
        }
        Ok(())
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
        let inner = self.nested(body, result)?;
        step.iter().try_for_each(|e| self.effect(e, &mut effects))?;
        let step = effects.iter().map(|e| format!("{e};\n")).collect::<String>();
        let inner = inner.strip_prefix('{').and_then(|i| i.strip_suffix('}')).unwrap_or_default();
        lines.push(format!("while {c} {{{inner}{step}}}"));
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
            | UppaalDeclaration::System(_) => {
                return fault(span, "this cannot be declared in a function");
            }
        };
        for declarator in declarators {
            let UppaalSymbolType::Data(scalar, dims) = self.declared(ty, &declarator.dims)? else {
                return fault(declarator.span, "a function has variables only: no clocks and channels");
            };
            let constant = match &declarator.init {
                Some(super::ast::UppaalInitializer::One(e)) if ty.constant && dims.is_empty() => {
                    self.expr(e)?.value
                }
                Some(_) | None => None,
            };
            if let Some(n) = constant {
                self.bind_local(&declarator.name, UppaalSymbol::Const(scalar.literal(n)));
                continue;
            }
            let init = match &declarator.init {
                Some(super::ast::UppaalInitializer::One(e)) if dims.is_empty() => {
                    self.expr(e)?.of_type(scalar.is_bool).text
                }
                init => self.initial(&scalar, &dims, init.as_ref(), declarator.span)?,
            };
            let written = self.names.fresh(&declarator.name, declarator.span, NameOwner::Function);
            lines.push(var_line(&written, &scalar, &dims, &init) + ";");
            self.bind_local(&declarator.name, UppaalSymbol::Var(local(written, scalar, dims, ty.constant)));
        }
        Ok(())
    }

    fn bind_local(&mut self, name: &str, sym: UppaalSymbol) {
        if let Some(scope) = self.locals.last_mut() {
            scope.insert(name.to_owned(), sym);
        }
    }

    // ── Updates ──

    /// What an expression changes, as actions or statements.
    pub fn effect(&mut self, e: &UppaalExpr, out: &mut Vec<String>) -> Result<(), UppaalFault> {
        match &e.kind {
            UppaalExprKind::Assign(op, to, value) => self.assign(*op, to, value, e.span, out),
            UppaalExprKind::Step { up, of } => {
                let to = self.assigned(of)?;
                if to.ty.is_bool || !to.dims.is_empty() {
                    return fault(e.span, "`++` and `--` are for numbers");
                }
                out.push(format!("{} {} 1", place_text(&to), if *up { "+=" } else { "-=" }));
                Ok(())
            }
            UppaalExprKind::Call(of, args) => {
                let (text, _) = self.call(of, args, e.span)?;
                out.push(text);
                Ok(())
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
            UppaalSymbol::Var(v) if v.readonly => {
                fault(e.span, format!("`{}` cannot be assigned here", v.name))
            }
            UppaalSymbol::Var(v) => Ok(v),
            UppaalSymbol::Clock(_) => {
                fault(e.span, "a function of a scenario cannot set clocks: set them on the transition")
            }
            other => fault(e.span, format!("{} cannot be assigned", other.noun())),
        }
    }

    fn assign(
        &mut self,
        op: Option<UppaalBinaryOperator>,
        to: &UppaalExpr,
        value: &UppaalExpr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        let mut value = value.clone();
        if let UppaalExprKind::Assign(_, inner, _) = &value.kind {
            let inner = (**inner).clone();
            self.effect(&value, out)?;
            value = inner;
        }
        if self.writing == 0 && matches!(self.place(to), Ok(UppaalSymbol::Clock(_))) {
            if op.is_some() {
                return fault(span, "a clock is set by `=`");
            }
            let clock = self.clock(to)?;
            out.push(format!("{clock} = {}", self.setting(&value)?));
            return Ok(());
        }
        let to = self.assigned(to)?;
        if !to.dims.is_empty() {
            return self.assign_array(&to, op, &value, span, out);
        }
        let text = place_text(&to);
        let value = self.expr(&value)?.of_type(to.ty.is_bool);
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
        let sizes = |v: &VarSym| v.dims.iter().map(|d| d.count()).collect::<Vec<_>>();
        if op.is_some() || sizes(to) != sizes(&from) || to.ty.is_bool != from.ty.is_bool {
            return fault(span, "arrays are assigned as a whole if they are of one size and type");
        }
        let from_zero = to.dims.iter().map(|d| super::scope::IndexRange { lo: 0, hi: d.count() - 1 });
        for at in combinations(&from_zero.collect::<Vec<_>>()) {
            let element = |v: &VarSym| {
                let at = v.at.iter().cloned().chain(at.iter().map(|n| ScenarioExprText::int(*n))).collect();
                VarSym { at, dims: Vec::new(), ..v.clone() }
            };
            let value = self.value_of(&element(&from));
            out.push(format!("{} = {}", place_text(&element(to)), value.text));
        }
        Ok(())
    }
}

fn local(name: String, ty: UppaalScalarType, dims: Vec<super::scope::IndexRange>, readonly: bool) -> VarSym {
    VarSym { name, ty, dims, at: Vec::new(), values: None, own: false, local: true, readonly }
}
