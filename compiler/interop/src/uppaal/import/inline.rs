//! Functions that set clocks, which those of a scenario cannot: their statements stand on the edge that calls them.
//!
//! They are gone through as far as they are known: loops with constant bounds round by round, local variables with constant values.
//! What is decided by the state alone is a case of the edge (`cases`).

use std::rc::Rc;

use hrdsl_source::Span;
use indexmap::IndexMap;

use super::{
    ast::{
        UppaalDeclaration, UppaalExpr, UppaalExprKind, UppaalFunction, UppaalInitializer, UppaalStatement,
        UppaalStatementKind,
    },
    expr::fold,
    fault::{UppaalFault, fault},
    scope::{FunctionSym, UppaalScalarType, UppaalScope, UppaalSymbol, UppaalSymbolType},
    translation::UppaalTranslation,
};

/// How many rounds a loop may have.
const MAX_ROUNDS: usize = 1024;

/// Whether the function goes on after a statement.
#[derive(Clone, Copy, PartialEq, Eq)]
enum InlinedFlow {
    On,
    Returned,
}

/// Local variables whose values are known, with their types.
type KnownLocals = IndexMap<String, UppaalScalarType>;

impl UppaalTranslation<'_> {
    /// Whether a function sets clocks, itself or by what it calls.
    pub fn sets_clocks(&self, decl: &UppaalFunction, params: &[UppaalSymbolType]) -> bool {
        let has_clocks = |ty: &UppaalSymbolType| ty.has_clocks();
        let of_clocks = |name: &str| match decl.params.iter().position(|p| p.name == name) {
            Some(at) => params.get(at).is_some_and(has_clocks),
            None => matches!(self.find(name), Some(sym) if sym.has_clocks()),
        };
        let is_clock = |to: &UppaalExpr| match self.kind_of(to) {
            Some(sym) if !decl.params.iter().any(|p| to.root() == Some(&p.name)) => sym.has_clocks(),
            Some(_) | None => to.root().is_some_and(of_clocks),
        };
        let mut found = params.iter().any(has_clocks);
        decl.body.iter().for_each(|s| {
            s.each(&mut |e| match &e.kind {
                UppaalExprKind::Assign(_, to, _) => found |= is_clock(to),
                UppaalExprKind::Call(of, _) => {
                    let called = of.root().and_then(|name| self.find(name));
                    found |= matches!(called, Some(UppaalSymbol::Function(f)) if f.sets_clocks);
                }
                _ => {}
            });
        });
        found
    }

    /// Writes what a call does.
    pub fn inline(
        &mut self,
        function: &Rc<FunctionSym>,
        args: &[UppaalExpr],
        span: Span,
        out: &mut Vec<String>,
    ) -> Result<(), UppaalFault> {
        if self.writing > 0 || self.cases.is_none() {
            return fault(span, "a function that sets clocks is called on transitions only");
        }
        if self.inlining > 20 {
            return fault(span, "a function that calls itself is not supported");
        }
        let mut scope = UppaalScope::new();
        for ((param, ty), arg) in function.decl.params.iter().zip(&function.params).zip(args) {
            let sym = match ty {
                UppaalSymbolType::Data(scalar, dims) if dims.is_empty() && !param.by_reference => {
                    UppaalSymbol::Const(self.expr(arg)?.of_type(scalar.is_bool))
                }
                UppaalSymbolType::Data(..)
                | UppaalSymbolType::Clock(_)
                | UppaalSymbolType::Chan { .. }
                | UppaalSymbolType::Record(..)
                | UppaalSymbolType::Void => {
                    let mut sym = self.place(arg)?;
                    if !param.by_reference || param.ty.constant {
                        sym.make_readonly();
                    }
                    sym
                }
            };
            scope.insert(param.name.clone(), sym);
        }
        self.changes_no_argument(function, args)?;
        let locals = std::mem::replace(&mut self.locals, vec![scope]);
        let process = if function.own { None } else { self.process.take() };
        self.inlining += 1;
        let done = self.run_all(&function.decl.body, &mut KnownLocals::new(), out);
        self.inlining -= 1;
        self.locals = locals;
        if process.is_some() {
            self.process = process;
        }
        done.map(|_| ())
    }

    /// Arguments are written where they are read: nothing of them may have changed by then.
    fn changes_no_argument(&self, function: &FunctionSym, args: &[UppaalExpr]) -> Result<(), UppaalFault> {
        for ((param, ty), arg) in function.decl.params.iter().zip(&function.params).zip(args) {
            let mut names = Vec::new();
            let mut named = |e: &UppaalExpr| {
                if let UppaalExprKind::Name(name) = &e.kind {
                    names.push(name.clone());
                }
            };
            // Of a reference the indices are evaluated when it is given.
            let is_copy = !param.by_reference && ty.is_single();
            arg.each(&mut |e| match &e.kind {
                _ if is_copy => named(e),
                UppaalExprKind::Index(_, index) => index.each(&mut named),
                _ => {}
            });
            let is_changed = |to: &UppaalExpr| {
                to.root().is_some_and(|root| {
                    names.iter().any(|name| name == root) || is_copy && root == param.name
                })
            };
            let mut changed = false;
            function.decl.body.iter().for_each(|s| {
                s.each(&mut |e| match &e.kind {
                    UppaalExprKind::Assign(_, to, _) | UppaalExprKind::Step { of: to, .. } => {
                        changed |= is_changed(to);
                    }
                    UppaalExprKind::Call(..) if !names.is_empty() => {
                        changed |= names
                            .iter()
                            .any(|n| matches!(self.find(n), Some(UppaalSymbol::Var(v)) if !v.readonly));
                    }
                    _ => {}
                });
            });
            if changed {
                let message = format!(
                    "the function `{}` sets clocks, and what it is given for `{}` changes in it: give it a constant",
                    function.decl.name, param.name
                );
                return fault(arg.span, message);
            }
        }
        Ok(())
    }

    fn run_all(
        &mut self,
        all: &[UppaalStatement],
        known: &mut KnownLocals,
        out: &mut Vec<String>,
    ) -> Result<InlinedFlow, UppaalFault> {
        self.locals.push(UppaalScope::new());
        let mut flow = Ok(InlinedFlow::On);
        for s in all {
            flow = self.run(s, known, out);
            if !matches!(flow, Ok(InlinedFlow::On)) {
                break;
            }
        }
        self.locals.pop();
        flow
    }

    fn run(
        &mut self,
        s: &UppaalStatement,
        known: &mut KnownLocals,
        out: &mut Vec<String>,
    ) -> Result<InlinedFlow, UppaalFault> {
        match &s.kind {
            UppaalStatementKind::Empty => Ok(InlinedFlow::On),
            UppaalStatementKind::Decl(decl) => self.known_local(decl, s.span, known),
            UppaalStatementKind::Expr(e) => {
                if !self.set_known(e, known)? {
                    self.effect(e, out)?;
                }
                Ok(InlinedFlow::On)
            }
            UppaalStatementKind::Block(all) => self.run_all(all, known, out),
            UppaalStatementKind::If(c, then, otherwise) => match (self.decide(c)?, otherwise) {
                (true, _) => self.run_all(std::slice::from_ref(then), known, out),
                (false, Some(otherwise)) => self.run_all(std::slice::from_ref(otherwise), known, out),
                (false, None) => Ok(InlinedFlow::On),
            },
            UppaalStatementKind::While(c, body) => self.rounds(Some(c), &[], body, known, out),
            UppaalStatementKind::DoWhile(body, c) => {
                match self.run_all(std::slice::from_ref(body), known, out)? {
                    InlinedFlow::On => self.rounds(Some(c), &[], body, known, out),
                    InlinedFlow::Returned => Ok(InlinedFlow::Returned),
                }
            }
            UppaalStatementKind::For(init, c, step, body) => {
                for e in init {
                    if !self.set_known(e, known)? {
                        self.effect(e, out)?;
                    }
                }
                self.rounds(c.as_ref(), step, body, known, out)
            }
            UppaalStatementKind::ForRange(name, ty, body) => {
                let scalar = self.scalar(ty)?;
                for n in scalar.lo..=scalar.hi {
                    let sym = UppaalSymbol::Const(scalar.literal(n));
                    self.locals.push(UppaalScope::from_iter([(name.clone(), sym)]));
                    let flow = self.run_all(std::slice::from_ref(body), known, out);
                    self.locals.pop();
                    if flow? == InlinedFlow::Returned {
                        return Ok(InlinedFlow::Returned);
                    }
                }
                Ok(InlinedFlow::On)
            }
            // Nobody takes the value: it is called for its effect.
            UppaalStatementKind::Return(_) => Ok(InlinedFlow::Returned),
        }
    }

    fn rounds(
        &mut self,
        c: Option<&UppaalExpr>,
        step: &[UppaalExpr],
        body: &UppaalStatement,
        known: &mut KnownLocals,
        out: &mut Vec<String>,
    ) -> Result<InlinedFlow, UppaalFault> {
        for _ in 0..MAX_ROUNDS {
            if let Some(c) = c {
                match self.condition(c)?.value {
                    Some(0) => return Ok(InlinedFlow::On),
                    Some(_) => {}
                    None => {
                        return fault(
                            c.span,
                            "in a function that sets clocks, how often a loop runs must be constant",
                        );
                    }
                }
            }
            if self.run_all(std::slice::from_ref(body), known, out)? == InlinedFlow::Returned {
                return Ok(InlinedFlow::Returned);
            }
            for e in step {
                if !self.set_known(e, known)? {
                    self.effect(e, out)?;
                }
            }
        }
        fault(body.span, format!("this loop has more than {MAX_ROUNDS} rounds"))
    }

    fn known_local(
        &mut self,
        decl: &UppaalDeclaration,
        span: Span,
        known: &mut KnownLocals,
    ) -> Result<InlinedFlow, UppaalFault> {
        let UppaalDeclaration::Vars(ty, declarators) = decl else {
            return fault(span, "a function that sets clocks has variables only");
        };
        for declarator in declarators {
            let UppaalSymbolType::Data(scalar, dims) = self.declared(ty, &declarator.dims)? else {
                return fault(declarator.span, "a function has variables only: no clocks and channels");
            };
            let value = match &declarator.init {
                _ if !dims.is_empty() => None,
                None => Some(scalar.default()),
                Some(UppaalInitializer::One(e)) => self.expr(e)?.of_type(scalar.is_bool).value,
                Some(UppaalInitializer::List(..) | UppaalInitializer::Named(..)) => None,
            };
            let Some(n) = value else { return unknown(declarator.span, &declarator.name) };
            if let Some(scope) = self.locals.last_mut() {
                scope.insert(declarator.name.clone(), UppaalSymbol::Const(scalar.literal(n)));
            }
            known.insert(declarator.name.clone(), scalar);
        }
        Ok(InlinedFlow::On)
    }

    /// Sets a local variable; gives false if the expression sets none.
    fn set_known(&mut self, e: &UppaalExpr, known: &KnownLocals) -> Result<bool, UppaalFault> {
        let to = match &e.kind {
            UppaalExprKind::Assign(_, to, _) | UppaalExprKind::Step { of: to, .. } => to,
            _ => return Ok(false),
        };
        let UppaalExprKind::Name(name) = &to.kind else { return Ok(false) };
        let Some(scalar) = known.get(name).cloned() else { return Ok(false) };
        let Some(UppaalSymbol::Const(before)) = self.find(name).cloned() else { return Ok(false) };
        let before = before.value.unwrap_or_default();
        let after = match &e.kind {
            UppaalExprKind::Step { up, .. } => Some(if *up { before + 1 } else { before - 1 }),
            UppaalExprKind::Assign(op, _, value) => {
                let value = self.expr(value)?.of_type(scalar.is_bool).value;
                match (op, value) {
                    (Some(op), Some(value)) => Some(fold(*op, before, value, e.span)?),
                    (None, value) => value,
                    (Some(_), None) => None,
                }
            }
            _ => None,
        };
        let Some(n) = after else { return unknown(e.span, name) };
        super::declare::in_range(&scalar, n, e.span)?;
        if let Some(scope) = self.locals.iter_mut().rev().find(|scope| scope.contains_key(name)) {
            scope.insert(name.clone(), UppaalSymbol::Const(scalar.literal(n)));
        }
        Ok(true)
    }
}

fn unknown<T>(span: Span, name: &str) -> Result<T, UppaalFault> {
    let message = format!(
        "the value of `{name}` must be constant in a function that sets clocks: make it a variable of the template"
    );
    fault(span, message)
}
