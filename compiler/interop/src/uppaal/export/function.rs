//! Functions, each after those that it calls.

use std::fmt::Write;

use hrdsl_ir::{
    Expr, Program,
    ta::{Automaton, AutomatonFunction, EdgeAssignment, FunctionId, FunctionStatement, TimeSum},
};
use indexmap::IndexSet;

use super::{
    UppaalExporter, all_exprs,
    expr::{UppaalExprContext, UppaalPrecedence, UppaalTextResult},
    slots::{UppaalNames, UppaalSlotTable, slot, ty},
};
use crate::exchange::obstacle::ExportObstacle;

/// The functions that an expression calls.
pub fn in_expr(e: &Expr, note: &mut dyn FnMut(FunctionId)) {
    match e {
        Expr::Const(_) | Expr::Var(_) => {}
        Expr::Unary(_, a) => in_expr(a, note),
        Expr::Binary(_, a, b) => {
            in_expr(a, note);
            in_expr(b, note);
        }
        Expr::If(c, a, b) => {
            in_expr(c, note);
            in_expr(a, note);
            in_expr(b, note);
        }
        Expr::Call(_, args) => args.iter().for_each(|a| in_expr(a, note)),
        Expr::List(elements, rest) => {
            elements.iter().for_each(|e| in_expr(e, note));
            rest.iter().for_each(|e| in_expr(e, note));
        }
        Expr::Element(place) => place.indices.iter().for_each(|i| in_expr(&i.at, note)),
        Expr::Apply(function, args) => {
            note(*function);
            args.iter().for_each(|a| in_expr(a, note));
        }
    }
}

/// The functions that an automaton calls itself.
pub fn called_by(automaton: &Automaton, note: &mut dyn FnMut(FunctionId)) {
    let in_time =
        |t: &TimeSum, note: &mut dyn FnMut(FunctionId)| t.terms.iter().for_each(|t| in_expr(&t.value, note));
    for location in &automaton.locations {
        location.invariant.iter().for_each(|c| in_time(&c.bound, note));
        location.holds.iter().for_each(|e| in_expr(e, note));
    }
    for edge in &automaton.edges {
        edge.clock_guard.iter().for_each(|c| in_time(&c.bound, note));
        edge.guard.iter().for_each(|e| in_expr(e, note));
        edge.sync.given().iter().for_each(|e| in_expr(e, note));
        for update in &edge.updates {
            match update {
                EdgeAssignment::Assign { place, value } => {
                    place.indices.iter().for_each(|i| in_expr(&i.at, note));
                    in_expr(value, note);
                }
                EdgeAssignment::Reset { to, .. } => in_time(to, note),
                EdgeAssignment::Call { function, args } => {
                    note(*function);
                    args.iter().for_each(|e| in_expr(e, note));
                }
            }
        }
    }
}

fn calls(function: &AutomatonFunction) -> IndexSet<FunctionId> {
    let mut called = IndexSet::new();
    fn statements(all: &[FunctionStatement], called: &mut IndexSet<FunctionId>) {
        for statement in all {
            match statement {
                FunctionStatement::Call { function, .. } => {
                    called.insert(*function);
                }
                FunctionStatement::If { then, otherwise, .. } => {
                    statements(then, called);
                    statements(otherwise, called);
                }
                FunctionStatement::While { body, .. } | FunctionStatement::For { body, .. } => {
                    statements(body, called)
                }
                FunctionStatement::Assign { .. } | FunctionStatement::Return(_) => {}
            }
        }
    }
    statements(&function.body, &mut called);
    function.body.iter().for_each(|s| {
        all_exprs(s, &mut |e| {
            in_expr(e, &mut |f| {
                called.insert(f);
            });
        });
    });
    called
}

/// Adds a function after those that it calls.
pub fn order(
    program: &Program,
    id: FunctionId,
    above: &mut Vec<FunctionId>,
    out: &mut IndexSet<FunctionId>,
) -> Result<(), ExportObstacle> {
    let function = &program.functions[usize::from(id.0)];
    if above.contains(&id) {
        let message = format!("the function `{}` calls itself: UPPAAL's functions cannot", function.name);
        return Err(ExportObstacle { origin: function.origin, message });
    }
    if out.contains(&id) {
        return Ok(());
    }
    above.push(id);
    for called in calls(function) {
        order(program, called, above, out)?;
    }
    above.pop();
    out.insert(id);
    Ok(())
}

impl UppaalExporter<'_> {
    /// The texts of functions; their names become known to the context.
    pub fn functions(
        &mut self,
        ids: &[FunctionId],
        context: &mut UppaalExprContext,
        names: &mut UppaalNames,
    ) -> String {
        let program = self.program;
        let mut text = String::new();
        for id in ids {
            let function = &program.functions[usize::from(id.0)];
            let name = names.fresh(&function.name);
            let written = UppaalFunctionWriter::new(context.clone(), names.clone()).function(function, &name);
            let place = format!("the function `{}`", function.name);
            text += &self.said(written, function.origin, &place);
            context.functions[usize::from(id.0)] = Some(name);
        }
        text
    }
}

struct UppaalFunctionWriter {
    context: UppaalExprContext,
    names: UppaalNames,
    /// Declarations of variables that the scenario does not have.
    extra: Vec<String>,
    result: Option<hrdsl_ir::Enumeration>,
}

impl UppaalFunctionWriter {
    fn new(context: UppaalExprContext, names: UppaalNames) -> Self {
        Self { context, names, extra: Vec::new(), result: None }
    }

    fn function(mut self, function: &AutomatonFunction, name: &str) -> UppaalTextResult<String> {
        let mut slots = UppaalSlotTable::default();
        let mut params = Vec::new();
        for param in &function.params {
            let name = self.names.fresh(&param.name);
            params.push(format!("{} {name}", ty(param)));
            slots.slots.push(super::slots::UppaalSlot { text: name, ..slot(param) });
        }
        let first = self.context.slots.slots.len() + function.params.len();
        let locals = slots.declare(&function.locals, &mut self.names);
        self.context.slots.append(slots);
        self.result = function.result.as_ref().and_then(|r| r.enumeration);
        let body = self.statements(&function.body, 1)?;
        // The variable of a `for` over constants is declared by the loop.
        let looped = loops(&function.body);
        let is_used = |line: &&String| {
            let slots = self.context.slots.slots.iter().enumerate().skip(first);
            let of = slots.filter(|(_, s)| line.contains(&format!(" {} =", s.text))).map(|(i, _)| i).next();
            of.is_none_or(|slot| !looped.contains(&slot))
        };
        let result = function.result.as_ref().map_or_else(|| "void".to_owned(), ty);
        let mut text = format!("{result} {name}({}) {{\n", params.join(", "));
        for line in locals.iter().filter(is_used).chain(&self.extra) {
            let _ = writeln!(text, "  {line}");
        }
        Ok(text + &body + "}\n")
    }

    fn statements(&mut self, all: &[FunctionStatement], depth: usize) -> UppaalTextResult<String> {
        all.iter().map(|s| self.statement(s, depth)).collect()
    }

    fn statement(&mut self, statement: &FunctionStatement, depth: usize) -> UppaalTextResult<String> {
        let pad = "  ".repeat(depth);
        let expr = |cx: &UppaalExprContext, e: &Expr| cx.expr(e, None).map(|t| t.text);
        Ok(match statement {
            FunctionStatement::Assign { place, value } => {
                let of = self.context.enumeration_of(place);
                let (to, value) = (self.context.place(place)?, self.context.expr(value, of)?);
                format!("{pad}{to} = {};\n", value.text)
            }
            FunctionStatement::Call { function, args } => {
                format!("{pad}{};\n", self.context.apply(function.0, args)?)
            }
            FunctionStatement::If { condition, then, otherwise } => {
                let mut text = format!("{pad}if ({}) {{\n", expr(&self.context, condition)?);
                text += &self.statements(then, depth + 1)?;
                if !otherwise.is_empty() {
                    text += &format!("{pad}}} else {{\n");
                    text += &self.statements(otherwise, depth + 1)?;
                }
                text + &pad + "}\n"
            }
            FunctionStatement::While { condition, body } => {
                let condition = expr(&self.context, condition)?;
                format!("{pad}while ({condition}) {{\n{}{pad}}}\n", self.statements(body, depth + 1)?)
            }
            FunctionStatement::For { slot, lo, hi, body } => self.for_loop(*slot, lo, hi, body, depth)?,
            FunctionStatement::Return(None) => format!("{pad}return;\n"),
            FunctionStatement::Return(Some(value)) => {
                format!("{pad}return {};\n", self.context.expr(value, self.result)?.text)
            }
        })
    }

    fn for_loop(
        &mut self,
        slot: u16,
        lo: &Expr,
        hi: &Expr,
        body: &[FunctionStatement],
        depth: usize,
    ) -> UppaalTextResult<String> {
        let pad = "  ".repeat(depth);
        let (from, to) = (self.context.expr(lo, None)?, self.context.expr(hi, None)?);
        let known =
            self.context.slots.slots.get(usize::from(slot)).ok_or("a variable that is not known here")?;
        let name = known.text.clone();
        if is_constant(lo, hi) {
            let body = self.statements(body, depth + 1)?;
            return Ok(format!("{pad}for ({name} : int[{},{}]) {{\n{body}{pad}}}\n", from.text, to.text));
        }
        // The bounds are evaluated once, and the variable never leaves its range.
        let (next, last) = (self.names.fresh("next"), self.names.fresh("last"));
        self.extra.push(format!("int[-2147483647,2147483647] {next}, {last};"));
        let body = self.statements(body, depth + 1)?;
        let mut text = format!("{pad}{last} = {};\n", to.text);
        text += &format!(
            "{pad}for ({next} = {}; {next} <= {last}; {next}++) {{\n",
            from.at(UppaalPrecedence::Sum)
        );
        text += &format!("{pad}  {name} = {next};\n{body}{pad}}}\n");
        Ok(text)
    }
}

fn is_constant(lo: &Expr, hi: &Expr) -> bool {
    matches!((lo, hi), (Expr::Const(a), Expr::Const(b)) if a.as_int() <= b.as_int())
}

/// Slots of loops that declare their variable.
fn loops(all: &[FunctionStatement]) -> IndexSet<usize> {
    let mut out = IndexSet::new();
    for statement in all {
        match statement {
            FunctionStatement::For { slot, lo, hi, body } => {
                if is_constant(lo, hi) {
                    out.insert(usize::from(*slot));
                }
                out.extend(loops(body));
            }
            FunctionStatement::While { body, .. } => out.extend(loops(body)),
            FunctionStatement::If { then, otherwise, .. } => {
                out.extend(loops(then));
                out.extend(loops(otherwise));
            }
            FunctionStatement::Assign { .. }
            | FunctionStatement::Call { .. }
            | FunctionStatement::Return(_) => {}
        }
    }
    out
}
