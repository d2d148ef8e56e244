//! The statements of an edge as actions and functions, and the guard that keeps its assignments within their ranges.
//!
//! In TChecker an edge with an assignment out of range cannot be taken; in a scenario that is a fault of the model. So the
//! edge gets a guard, where the ranges do not show that it needs none.

use super::{
    ast::{TcheckerExpr, TcheckerExprKind, TcheckerOperator, TcheckerStatement, TcheckerStatementKind},
    expr::{ScenarioExprWriter, constant},
    parse::TcheckerFault,
};

/// What the statements of one edge become.
#[derive(Default)]
pub struct TranslatedEffect {
    /// The actions, in order.
    pub actions: Vec<String>,
    /// Functions that the actions call: their names and bodies.
    pub functions: Vec<(String, String)>,
    /// Conditions under which all assignments stay in range.
    pub guards: Vec<String>,
    /// An assignment whose range could not be told beforehand.
    pub unguarded: Option<usize>,
}

/// Translates the statements of one edge; `function` gives names to new functions.
pub fn effect(
    exprs: &ScenarioExprWriter<'_>,
    (provided, body): (&[TcheckerExpr], &[TcheckerStatement]),
    function: &mut dyn FnMut() -> String,
) -> Result<TranslatedEffect, TcheckerFault> {
    let mut effect = TranslatedEffect::default();
    let mut known = SymbolicStore::default();
    let plain = body.iter().all(|s| matches!(s.kind, TcheckerStatementKind::Assign { .. }));
    let mut run: Vec<&TcheckerStatement> = Vec::new();
    for statement in body {
        match &statement.kind {
            TcheckerStatementKind::Assign { name, index, value } => {
                match exprs.clock(&lvalue(name, index, statement.at))? {
                    Some(clock) => {
                        flush(exprs, &mut run, &mut effect, function)?;
                        effect.actions.push(format!("{clock} = {}", exprs.clock_value(value)?));
                    }
                    None if plain => {
                        range(exprs, provided, &mut known, statement, &mut effect)?;
                        let target = exprs.target(name, index.as_ref(), statement.at)?;
                        effect.actions.push(format!("{target} = {}", exprs.integer(value)?));
                    }
                    None => run.push(statement),
                }
            }
            TcheckerStatementKind::If { .. }
            | TcheckerStatementKind::While { .. }
            | TcheckerStatementKind::Local { .. } => run.push(statement),
        }
    }
    flush(exprs, &mut run, &mut effect, function)?;
    if !plain {
        effect.unguarded = body.first().map(|s| s.at);
    }
    Ok(effect)
}

fn lvalue(name: &str, index: &Option<TcheckerExpr>, at: usize) -> TcheckerExpr {
    TcheckerExpr { kind: TcheckerExprKind::Name(name.to_owned(), index.clone().map(Box::new)), at }
}

/// Statements on integers become a function.
fn flush(
    exprs: &ScenarioExprWriter<'_>,
    run: &mut Vec<&TcheckerStatement>,
    effect: &mut TranslatedEffect,
    function: &mut dyn FnMut() -> String,
) -> Result<(), TcheckerFault> {
    if run.is_empty() {
        return Ok(());
    }
    let mut text = String::new();
    for statement in run.drain(..) {
        write(exprs, statement, &mut text)?;
    }
    let name = function();
    effect.actions.push(format!("{name}()"));
    effect.functions.push((name, text));
    Ok(())
}

fn block(exprs: &ScenarioExprWriter<'_>, body: &[TcheckerStatement]) -> Result<String, TcheckerFault> {
    let mut text = String::new();
    body.iter().try_for_each(|s| write(exprs, s, &mut text))?;
    Ok(format!("{{\n{text}}}"))
}

fn write(
    exprs: &ScenarioExprWriter<'_>,
    statement: &TcheckerStatement,
    out: &mut String,
) -> Result<(), TcheckerFault> {
    let text = match &statement.kind {
        TcheckerStatementKind::Assign { name, index, value } => {
            if exprs.clock(&lvalue(name, index, statement.at))?.is_some() {
                let message = "a clock is set under a condition: a scenario sets clocks on edges only";
                return Err(TcheckerFault { at: statement.at, message: message.to_owned() });
            }
            format!("{} = {};", exprs.target(name, index.as_ref(), statement.at)?, exprs.integer(value)?)
        }
        TcheckerStatementKind::If { condition, then, otherwise } => {
            let other = match otherwise.as_slice() {
                [] => String::new(),
                some => format!(" else {}", block(exprs, some)?),
            };
            format!("if {} {}{other}", exprs.boolean(condition)?, block(exprs, then)?)
        }
        TcheckerStatementKind::While { condition, body } => {
            format!("while {} {}", exprs.boolean(condition)?, block(exprs, body)?)
        }
        TcheckerStatementKind::Local { name, size, init } => {
            let of = "-2147483648..2147483647";
            match (size.as_ref().map(|s| (constant(s), s)), init) {
                (Some((Some(n), _)), _) => format!("var {name}: ({of})[{n}];"),
                (Some((None, size)), _) => {
                    return Err(TcheckerFault {
                        at: size.at,
                        message: "the size of an array is a constant".to_owned(),
                    });
                }
                // A local variable starts with a constant; what it is given is assigned.
                (None, Some(value)) => format!("var {name}: {of};\n{name} = {};", exprs.integer(value)?),
                (None, None) => format!("var {name}: {of};"),
            }
        }
    };
    out.push_str(&text);
    out.push('\n');
    Ok(())
}

// ── Ranges ──

/// What variables are, in terms of what they were before the edge.
#[derive(Default)]
struct SymbolicStore {
    values: Vec<(String, Option<i64>, TcheckerExpr)>,
    /// Arrays of which some element, nobody knows which, was assigned.
    blurred: Vec<String>,
}

impl SymbolicStore {
    /// The expression in what was before; `None`: it reads an element that cannot be told.
    fn before(&self, e: &TcheckerExpr) -> Option<TcheckerExpr> {
        let sub = |e: &TcheckerExpr| self.before(e).map(Box::new);
        let kind = match &e.kind {
            TcheckerExprKind::Int(n) => TcheckerExprKind::Int(*n),
            TcheckerExprKind::Name(name, index) => {
                let at = index.as_ref().map(|i| constant(i));
                let touched = self.values.iter().rev().find(|(n, ..)| n == name);
                match (touched, at) {
                    (None, _) if !self.blurred.contains(name) => {
                        let index = match index {
                            Some(i) => Some(sub(i)?),
                            None => None,
                        };
                        TcheckerExprKind::Name(name.clone(), index)
                    }
                    (Some(_), Some(Some(_)) | None) if !self.blurred.contains(name) => {
                        let at = at.flatten();
                        match self.values.iter().rev().find(|(n, i, _)| n == name && *i == at) {
                            Some((_, _, value)) => return Some(value.clone()),
                            None => return Some(e.clone()),
                        }
                    }
                    (Some(_) | None, _) => return None,
                }
            }
            TcheckerExprKind::Neg(a) => TcheckerExprKind::Neg(sub(a)?),
            TcheckerExprKind::Not(a) => TcheckerExprKind::Not(sub(a)?),
            TcheckerExprKind::Binary(op, a, b) => TcheckerExprKind::Binary(*op, sub(a)?, sub(b)?),
            TcheckerExprKind::If(c, a, b) => TcheckerExprKind::If(sub(c)?, sub(a)?, sub(b)?),
        };
        Some(TcheckerExpr { kind, at: e.at })
    }
}

/// Notes an assignment, with the guard that keeps it in range.
fn range(
    exprs: &ScenarioExprWriter<'_>,
    provided: &[TcheckerExpr],
    known: &mut SymbolicStore,
    s: &TcheckerStatement,
    effect: &mut TranslatedEffect,
) -> Result<(), TcheckerFault> {
    let TcheckerStatementKind::Assign { name, index, value } = &s.kind else { return Ok(()) };
    let Some(int) = exprs.model.ints.iter().find(|i| i.of.name == *name) else { return Ok(()) };
    match known.before(value) {
        None => effect.unguarded = effect.unguarded.or(Some(s.at)),
        Some(before) => {
            let interval = exprs.interval(&before, provided);
            let bound = |op: TcheckerOperator, n: i64| TcheckerExpr {
                kind: TcheckerExprKind::Binary(
                    op,
                    Box::new(before.clone()),
                    Box::new(TcheckerExpr { kind: TcheckerExprKind::Int(n), at: s.at }),
                ),
                at: s.at,
            };
            if interval.is_none_or(|(lo, _)| lo < int.lo) {
                effect.guards.push(exprs.boolean(&bound(TcheckerOperator::Ge, int.lo))?);
            }
            if interval.is_none_or(|(_, hi)| hi > int.hi) {
                effect.guards.push(exprs.boolean(&bound(TcheckerOperator::Le, int.hi))?);
            }
            match index.as_ref().map(constant) {
                None => known.values.push((name.clone(), None, before)),
                Some(Some(n)) => known.values.push((name.clone(), Some(n), before)),
                Some(None) => known.blurred.push(name.clone()),
            }
        }
    }
    if known.before(value).is_none() {
        known.blurred.push(name.clone());
    }
    Ok(())
}
