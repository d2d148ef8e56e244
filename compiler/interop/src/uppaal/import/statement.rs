//! Statements of functions.

use hrdsl_source::Span;

use super::{
    ast::{
        UppaalDeclaration, UppaalDeclarator, UppaalExpr, UppaalInitializer, UppaalStatement,
        UppaalStatementKind, UppaalType,
    },
    declare::var_line,
    fault::{UppaalFault, fault},
    scope::{IndexRange, NameOwner, UppaalScalarType, UppaalScope, UppaalSymbol, UppaalSymbolType, VarSym},
    translation::UppaalTranslation,
};

impl UppaalTranslation<'_> {
    pub fn statements(
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

pub fn local(name: String, ty: UppaalScalarType, dims: Vec<IndexRange>, readonly: bool) -> VarSym {
    VarSym { name, ty, dims, at: Vec::new(), values: None, own: false, local: true, readonly }
}
