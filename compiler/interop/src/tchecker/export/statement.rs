//! Statements: assignments, resets of clocks, and functions put in where they are called.

use hrdsl_ir::{
    Expr,
    ta::{EdgeAssignment, FunctionStatement},
};

use super::{
    expr::{LocalText, MAX_DEPTH, TcheckerExprWriter},
    value::TcheckerTextResult,
};

impl TcheckerExprWriter<'_> {
    /// The statements of an update.
    ///
    /// # Errors
    /// What TChecker cannot say.
    pub fn update(
        &self,
        update: &EdgeAssignment,
        fresh: &mut dyn FnMut(&str) -> String,
    ) -> Result<Vec<String>, String> {
        match update {
            EdgeAssignment::Assign { place, value } => {
                let of = self.enumeration_of(place.slot);
                Ok(vec![format!("{}={}", self.place(place, 0)?, self.int(value, of, 0)?)])
            }
            EdgeAssignment::Reset { clock, from, to } => {
                let from = from.map_or(String::new(), |f| format!("{}+", self.clock(f)));
                Ok(vec![format!("{}={from}{}", self.clock(*clock), self.time(to)?)])
            }
            EdgeAssignment::Call { function, args } => self.called(usize::from(function.0), args, 0, fresh),
        }
    }

    /// An update function, put in where it is called: its parameters and locals become local variables.
    fn called(
        &self,
        function: usize,
        args: &[Expr],
        depth: u8,
        fresh: &mut dyn FnMut(&str) -> String,
    ) -> Result<Vec<String>, String> {
        let Some(f) = self.program.functions.get(function) else {
            return Err("a function is not there".to_owned());
        };
        if depth > MAX_DEPTH {
            return Err("functions are nested too deep to be inserted".to_owned());
        }
        if f.locals.iter().any(|l| l.name.contains('[')) {
            return Err(format!(
                "the function `{}` has an array of its own, which cannot be put in: make it a variable of the automaton",
                f.name
            ));
        }
        let mut out = Vec::new();
        let mut texts = Vec::new();
        for (i, var) in f.params.iter().chain(&f.locals).enumerate() {
            let name = fresh(&var.name);
            let init = match args.get(i).filter(|_| i < f.params.len()) {
                Some(arg) => self.int(arg, var.enumeration, depth)?,
                None => var.init.to_string(),
            };
            out.push(format!("local {name}={init}"));
            texts.push(LocalText { text: name, of: var.enumeration });
        }
        let inner = self.inside(f, &texts);
        let body = match f.body.split_last() {
            Some((FunctionStatement::Return(None), rest)) => rest,
            Some(_) | None => &f.body,
        };
        inner.statements(body, depth + 1, fresh, &mut out)?;
        Ok(out)
    }

    fn statements(
        &self,
        body: &[FunctionStatement],
        depth: u8,
        fresh: &mut dyn FnMut(&str) -> String,
        out: &mut Vec<String>,
    ) -> Result<(), String> {
        for statement in body {
            match statement {
                FunctionStatement::Assign { place, value } => {
                    let of = self.enumeration_of(place.slot);
                    out.push(format!("{}={}", self.place(place, depth)?, self.int(value, of, depth)?));
                }
                FunctionStatement::Call { function, args } => {
                    out.extend(self.called(usize::from(function.0), args, depth, fresh)?);
                }
                FunctionStatement::If { condition, then, otherwise } => {
                    let (mut a, mut b) = (Vec::new(), Vec::new());
                    self.statements(then, depth, fresh, &mut a)?;
                    self.statements(otherwise, depth, fresh, &mut b)?;
                    let tail = if b.is_empty() { String::new() } else { format!(" else {}", b.join("; ")) };
                    let then = if a.is_empty() { "nop".to_owned() } else { a.join("; ") };
                    out.push(format!("if {} then {then}{tail} end", self.all(condition, depth)?));
                }
                FunctionStatement::While { condition, body } => {
                    let mut inner = Vec::new();
                    self.statements(body, depth, fresh, &mut inner)?;
                    out.push(format!("while {} do {} end", self.all(condition, depth)?, inner.join("; ")));
                }
                FunctionStatement::For { slot, lo, hi, body } => {
                    let (at, last) = (self.var(*slot)?, fresh("last"));
                    out.push(format!("local {last}={}", self.int(hi, None, depth)?));
                    out.push(format!("{at}={}", self.int(lo, None, depth)?));
                    let mut inner = Vec::new();
                    self.statements(body, depth, fresh, &mut inner)?;
                    inner.push(format!("{at}={at}+1"));
                    out.push(format!("while {at}<={last} do {} end", inner.join("; ")));
                }
                FunctionStatement::Return(_) => {
                    return Err("a function returns before its end, and TChecker has no `return`: put the rest under `if`".to_owned());
                }
            }
        }
        Ok(())
    }

    fn all(&self, condition: &Expr, depth: u8) -> TcheckerTextResult {
        let mut parts = Vec::new();
        self.conjuncts(condition, depth, &mut parts)?;
        Ok(if parts.is_empty() { "1==1".to_owned() } else { parts.join(" && ") })
    }
}
