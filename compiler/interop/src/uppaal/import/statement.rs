//! Functions and updates: statements of a scenario.

use std::rc::Rc;

use hrdsl_source::Span;

use super::{
    ast::{BinaryOp, Decl, Expr, ExprKind, Statement, StatementKind},
    declare::var_line,
    expr::place_text,
    fault::{Fault, fault},
    scope::{FunctionSym, Level, Out, Owner, Scalar, Scope, Sym, Ty, VarSym, combinations},
    translation::Cx,
};

impl Cx<'_> {
    // ── Calls ──

    /// The call's text and what it gives.
    pub fn call(&mut self, of: &Expr, args: &[Expr], span: Span) -> Result<(String, Option<Scalar>), Fault> {
        let ExprKind::Name(name) = &of.kind else { return fault(span, "expected the name of a function") };
        let Some(sym) = self.find(name).cloned() else {
            return fault(of.span, format!("there is no function `{name}` here"));
        };
        let Sym::Function(function) = sym else {
            return fault(of.span, format!("`{name}` is {}, not a function", sym.noun()));
        };
        if function.params.len() != args.len() {
            let (want, got) = (function.params.len(), args.len());
            return fault(span, format!("`{name}` has {want} parameters, and is given {got} arguments"));
        }
        let (mut values, mut aliases) = (Vec::new(), Vec::new());
        for ((param, ty), arg) in function.decl.params.iter().zip(&function.params).zip(args) {
            match ty {
                Ty::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                    values.push(self.expr(arg)?.of_type(scalar.is_bool).text);
                }
                Ty::Data(..) => {
                    let readonly = !param.by_reference || param.ty.constant;
                    aliases.push((param.name.clone(), self.alias(arg, readonly)?));
                }
                Ty::Clock(_) | Ty::Chan { .. } | Ty::Void => {
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
    fn alias(&mut self, arg: &Expr, readonly: bool) -> Result<VarSym, Fault> {
        let Sym::Var(mut var) = self.place(arg)? else { return fault(arg.span, "expected a variable") };
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
    ) -> Result<String, Fault> {
        let own = function.own || aliases.iter().any(|(_, v)| v.own);
        let shown: Vec<String> = aliases.iter().map(|(_, v)| place_text(v)).collect();
        let key = format!("{} {} {}", function.own, function.decl.name, shown.join(" "));
        let known = if own { &self.own_specialised } else { &self.specialised };
        if let Some(name) = known.get(&key) {
            return Ok(name.clone());
        }
        let owner = if own { Owner::Process } else { Owner::All };
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
    ) -> Result<(), Fault> {
        if self.writing > 20 {
            return fault(function.decl.span, "a function that calls itself is not supported");
        }
        let mut scope: Scope = aliases.into_iter().map(|(name, v)| (name, Sym::Var(v))).collect();
        if self.writing == 0 {
            self.names.start_function();
        }
        let mut params = Vec::new();
        for (param, ty) in function.decl.params.iter().zip(&function.params) {
            let Ty::Data(scalar, _) = ty else { continue };
            if scope.contains_key(&param.name) {
                continue;
            }
            let written = self.names.fresh(&param.name, param.span, Owner::Function);
            params.push(format!("{written}: {}", scalar.text));
            scope.insert(
                param.name.clone(),
                Sym::Var(local(written, scalar.clone(), Vec::new(), param.ty.constant)),
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

    fn statements(&mut self, all: &[Statement], result: Option<&Scalar>) -> Result<Vec<String>, Fault> {
        self.locals.push(Scope::new());
        let mut lines = Vec::new();
        let written = all.iter().try_for_each(|s| self.statement(s, result, &mut lines));
        self.locals.pop();
        written.map(|()| lines)
    }

    fn nested(&mut self, s: &Statement, result: Option<&Scalar>) -> Result<String, Fault> {
        let all = match &s.kind {
            StatementKind::Block(all) => self.statements(all, result)?,
            _ => self.statements(std::slice::from_ref(s), result)?,
        };
        Ok(format!("{{\n{}\n}}", all.join("\n")))
    }

    fn statement(
        &mut self,
        s: &Statement,
        result: Option<&Scalar>,
        lines: &mut Vec<String>,
    ) -> Result<(), Fault> {
        match &s.kind {
            StatementKind::Empty => {}
            StatementKind::Decl(decl) => self.local_declaration(decl, s.span, lines)?,
            StatementKind::Expr(e) => {
                let mut effects = Vec::new();
                self.effect(e, &mut effects)?;
                lines.extend(effects.into_iter().map(|e| e + ";"));
            }
            StatementKind::Block(all) => {
                let inner = self.statements(all, result)?;
                lines.extend(inner);
            }
            StatementKind::If(c, then, otherwise) => {
                let c = self.condition(c)?;
                let mut text = format!("if {} {}", c.text, self.nested(then, result)?);
                if let Some(otherwise) = otherwise {
                    text += &format!(" else {}", self.nested(otherwise, result)?);
                }
                lines.push(text);
            }
            StatementKind::While(c, body) => {
                let c = self.condition(c)?;
                lines.push(format!("while {} {}", c.text, self.nested(body, result)?));
            }
            StatementKind::DoWhile(body, c) => {
                let again = self.names.unused("again", Owner::Function);
                let body = self.nested(body, result)?;
                let c = self.condition(c)?;
                lines.push(format!("var {again}: bool = true;"));
                let inner = body.strip_prefix('{').and_then(|b| b.strip_suffix('}')).unwrap_or_default();
                lines.push(format!("while {again} {{{inner}{again} = {}\n}}", c.text));
            }
            StatementKind::For(init, c, step, body) => {
                self.for_loop(init, c.as_ref(), step, body, result, lines)?
            }
            StatementKind::ForRange(name, ty, body) => {
                let scalar = self.scalar(ty)?;
                if scalar.is_bool {
                    return fault(ty.span, "`for` over `bool` is not supported: say `int[0,1]`");
                }
                let written = self.names.fresh(name, s.span, Owner::Function);
                let sym = Sym::Var(local(written.clone(), scalar.clone(), Vec::new(), true));
                self.locals.push(Scope::from_iter([(name.clone(), sym)]));
                let body = self.nested(body, result);
                self.locals.pop();
                lines.push(format!("for {written} in {} {}", scalar.text, body?));
            }
            StatementKind::Return(None) => lines.push("return;".to_owned()),
            StatementKind::Return(Some(e)) => {
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
        init: &[Expr],
        c: Option<&Expr>,
        step: &[Expr],
        body: &Statement,
        result: Option<&Scalar>,
        lines: &mut Vec<String>,
    ) -> Result<(), Fault> {
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

    fn local_declaration(&mut self, decl: &Decl, span: Span, lines: &mut Vec<String>) -> Result<(), Fault> {
        let (ty, declarators) = match decl {
            Decl::Vars(ty, declarators) => (ty, declarators),
            Decl::Typedef(ty, declarator) => {
                let ty = self.declared(ty, &declarator.dims)?;
                self.bind_local(&declarator.name, Sym::Type(ty));
                return Ok(());
            }
            Decl::Function(_) | Decl::Instance(_) | Decl::System(_) => {
                return fault(span, "this cannot be declared in a function");
            }
        };
        for declarator in declarators {
            let Ty::Data(scalar, dims) = self.declared(ty, &declarator.dims)? else {
                return fault(declarator.span, "a function has variables only: no clocks and channels");
            };
            let constant = match &declarator.init {
                Some(super::ast::Init::One(e)) if ty.constant && dims.is_empty() => self.expr(e)?.value,
                Some(_) | None => None,
            };
            if let Some(n) = constant {
                self.bind_local(&declarator.name, Sym::Const(scalar.literal(n)));
                continue;
            }
            let init = match &declarator.init {
                Some(super::ast::Init::One(e)) if dims.is_empty() => {
                    self.expr(e)?.of_type(scalar.is_bool).text
                }
                init => self.initial(&scalar, &dims, init.as_ref(), declarator.span)?,
            };
            let written = self.names.fresh(&declarator.name, declarator.span, Owner::Function);
            lines.push(var_line(&written, &scalar, &dims, &init) + ";");
            self.bind_local(&declarator.name, Sym::Var(local(written, scalar, dims, ty.constant)));
        }
        Ok(())
    }

    fn bind_local(&mut self, name: &str, sym: Sym) {
        if let Some(scope) = self.locals.last_mut() {
            scope.insert(name.to_owned(), sym);
        }
    }

    // ── Updates ──

    /// What an expression changes, as actions or statements.
    pub fn effect(&mut self, e: &Expr, out: &mut Vec<String>) -> Result<(), Fault> {
        match &e.kind {
            ExprKind::Assign(op, to, value) => self.assign(*op, to, value, e.span, out),
            ExprKind::Step { up, of } => {
                let to = self.assigned(of)?;
                if to.ty.is_bool || !to.dims.is_empty() {
                    return fault(e.span, "`++` and `--` are for numbers");
                }
                out.push(format!("{} {} 1", place_text(&to), if *up { "+=" } else { "-=" }));
                Ok(())
            }
            ExprKind::Call(of, args) => {
                let (text, _) = self.call(of, args, e.span)?;
                out.push(text);
                Ok(())
            }
            ExprKind::Choice(c, a, b) if self.writing > 0 => {
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
    fn assigned(&mut self, e: &Expr) -> Result<VarSym, Fault> {
        match self.place(e)? {
            Sym::Var(v) if v.readonly => fault(e.span, format!("`{}` cannot be assigned here", v.name)),
            Sym::Var(v) => Ok(v),
            Sym::Clock(_) => {
                fault(e.span, "a function of a scenario cannot set clocks: set them on the transition")
            }
            other => fault(e.span, format!("{} cannot be assigned", other.noun())),
        }
    }

    fn assign(
        &mut self,
        op: Option<BinaryOp>,
        to: &Expr,
        value: &Expr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), Fault> {
        let mut value = value.clone();
        if let ExprKind::Assign(_, inner, _) = &value.kind {
            let inner = (**inner).clone();
            self.effect(&value, out)?;
            value = inner;
        }
        if self.writing == 0 && matches!(self.place(to), Ok(Sym::Clock(_))) {
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
            Some(BinaryOp::Add) => format!("{text} += {}", value.text),
            Some(BinaryOp::Sub) => format!("{text} -= {}", value.text),
            Some(BinaryOp::Mul) => format!("{text} = {text} * {}", value.at(Level::Factor)),
            Some(BinaryOp::Div) => format!("{text} = {text} / {}", value.at(Level::Factor)),
            Some(_) => format!("{text} = {text} % {}", value.at(Level::Atom)),
        });
        Ok(())
    }

    /// `a = b` for whole arrays: each element.
    fn assign_array(
        &mut self,
        to: &VarSym,
        op: Option<BinaryOp>,
        value: &Expr,
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), Fault> {
        let Sym::Var(from) = self.place(value)? else { return fault(value.span, "expected an array") };
        let sizes = |v: &VarSym| v.dims.iter().map(|d| d.count()).collect::<Vec<_>>();
        if op.is_some() || sizes(to) != sizes(&from) || to.ty.is_bool != from.ty.is_bool {
            return fault(span, "arrays are assigned as a whole if they are of one size and type");
        }
        let from_zero = to.dims.iter().map(|d| super::scope::Range { lo: 0, hi: d.count() - 1 });
        for at in combinations(&from_zero.collect::<Vec<_>>()) {
            let element = |v: &VarSym| {
                let at = v.at.iter().cloned().chain(at.iter().map(|n| Out::int(*n))).collect();
                VarSym { at, dims: Vec::new(), ..v.clone() }
            };
            let value = self.value_of(&element(&from));
            out.push(format!("{} = {}", place_text(&element(to)), value.text));
        }
        Ok(())
    }
}

fn local(name: String, ty: Scalar, dims: Vec<super::scope::Range>, readonly: bool) -> VarSym {
    VarSym { name, ty, dims, at: Vec::new(), values: None, own: false, local: true, readonly }
}
