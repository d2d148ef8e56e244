//! An edge of the model that is several of the scenario: one for each case of what only the state decides.
//!
//! Which clock of an array an index chooses, and whether a function sets a clock, depends on variables. A scenario knows the clock
//! beforehand; so the edge is written once for each case, and its guard asks for it. Guards are asked before all updates: what
//! updates depend on in such a way must be the same then and there, or it is refused.

use hrdsl_source::Span;

use super::{
    ast::{UppaalExpr, UppaalExprKind},
    expr::not,
    fault::{UppaalFault, fault},
    known::EdgeCases,
    scope::{FunctionSym, IndexRange, ScenarioExprText, ScenarioPrecedence, UppaalSymbol, VarSym},
    translation::UppaalTranslation,
};
use crate::exchange::note::NoteSeverity;

/// How many edges one transition may become by its cases.
const MAX_CASES: usize = 256;

impl UppaalTranslation<'_> {
    /// Every case of an edge, which `write` writes.
    pub fn every_case<T>(
        &mut self,
        span: Span,
        receives: bool,
        mut write: impl FnMut(&mut Self) -> Result<T, UppaalFault>,
    ) -> Result<Vec<T>, UppaalFault> {
        let mut all = Vec::new();
        let mut case = Some(EdgeCases::first(receives));
        while let Some(this) = case {
            if all.len() == MAX_CASES {
                return fault(span, format!("this transition has more than {MAX_CASES} cases"));
            }
            self.cases = Some(this);
            let written = write(self);
            case = self.cases.take().and_then(EdgeCases::following);
            all.push(written?);
        }
        Ok(all)
    }

    /// One of these numbers, each of them in a case of its own.
    pub fn choice_of(&mut self, lo: i64, hi: i64) -> Option<i64> {
        let count = usize::try_from(hi - lo + 1).ok()?;
        let chosen = self.cases.as_mut()?.choose(count);
        Some(lo + i64::try_from(chosen).ok()?)
    }

    /// The index of an array of clocks.
    pub fn clock_index(
        &mut self,
        dim: IndexRange,
        index: &UppaalExpr,
        value: ScenarioExprText,
    ) -> Result<ScenarioExprText, UppaalFault> {
        if value.value.is_some() {
            return Ok(value);
        }
        if self.cases.is_none() {
            return fault(index.span, "the index of an array of clocks must be constant here");
        }
        self.stable(index)?;
        if let Some(n) = self.known(&value.text) {
            return Ok(ScenarioExprText::int(n));
        }
        let n = self.choice_of(dim.lo, dim.hi).unwrap_or(dim.lo);
        let text = format!("{} == {n}", value.at(ScenarioPrecedence::Sum));
        self.found(value.text, n, ScenarioExprText::new(text, ScenarioPrecedence::Comparison, true));
        Ok(ScenarioExprText::int(n))
    }

    /// Whether a condition holds, each way in a case of its own.
    pub fn decide(&mut self, e: &UppaalExpr) -> Result<bool, UppaalFault> {
        let condition = self.condition(e)?;
        if let Some(n) = condition.value.or_else(|| self.known(&condition.text)) {
            return Ok(n != 0);
        }
        self.stable(e)?;
        let n = self.choice_of(0, 1).unwrap_or(0);
        let asked = if n == 1 { condition.clone() } else { not(&condition) };
        self.found(condition.text, n, asked);
        Ok(n == 1)
    }

    fn known(&self, text: &str) -> Option<i64> {
        let known = &self.cases.as_ref()?.known;
        known.iter().find(|(of, _)| of == text).map(|(_, n)| *n)
    }

    fn found(&mut self, text: String, n: i64, asked: ScenarioExprText) {
        if let Some(cases) = &mut self.cases {
            cases.known.push((text, n));
            cases.conditions.push(asked);
        }
    }

    /// Nothing that the expression reads changes between the guard and here.
    fn stable(&mut self, e: &UppaalExpr) -> Result<(), UppaalFault> {
        let Some(cases) = self.cases.as_ref().filter(|cases| cases.in_updates) else { return Ok(()) };
        let mut wrong = None;
        let why = "a clock that is set depends on";
        e.each(&mut |part| match &part.kind {
            UppaalExprKind::Call(..) if cases.receives || !cases.assigned.is_empty() => {
                wrong = Some(format!("{why} a function, which may read what the same transition changes"));
            }
            UppaalExprKind::Name(name) => match self.find(name) {
                Some(UppaalSymbol::Var(v)) if cases.assigned.contains(&v.name) => {
                    wrong = Some(format!("{why} `{name}`, which the same transition has changed: set it first"));
                }
                Some(UppaalSymbol::Var(v)) if cases.receives && !v.own && !v.local && v.values.is_none() => {
                    wrong = Some(format!(
                        "{why} the shared variable `{name}`, which whoever offers the channel may change in the same moment: \
                         set the clock on a transition of its own, after a committed location"
                    ));
                }
                _ => {}
            },
            _ => {}
        });
        match wrong {
            Some(message) => fault(e.span, message),
            None => Ok(()),
        }
    }

    /// Notes that a variable has been assigned on the way through an edge.
    pub fn mark(&mut self, name: &str) {
        if self.writing == 0
            && let Some(cases) = &mut self.cases
        {
            cases.assigned.insert(name.to_owned());
        }
    }

    /// The same for all that a function assigns.
    pub fn mark_function(&mut self, function: &FunctionSym, args: &[UppaalExpr], depth: usize) {
        if self.cases.is_none() || self.writing > 0 || depth > 20 {
            return;
        }
        let (mut roots, mut calls) = (Vec::new(), Vec::new());
        function.decl.body.iter().for_each(|s| {
            s.each(&mut |e| match &e.kind {
                UppaalExprKind::Assign(_, to, _) | UppaalExprKind::Step { of: to, .. } => {
                    roots.extend(to.root().map(str::to_owned));
                }
                UppaalExprKind::Call(of, args) => {
                    roots.extend(args.iter().filter_map(UppaalExpr::root).map(str::to_owned));
                    calls.extend(of.root().map(|name| (name.to_owned(), args.clone())));
                }
                _ => {}
            });
        });
        roots.extend(args.iter().filter_map(UppaalExpr::root).map(str::to_owned));
        for root in roots {
            let leaves: Vec<String> =
                self.find(&root).into_iter().flat_map(UppaalSymbol::leaves).filter_map(named).collect();
            leaves.iter().for_each(|name| self.mark(name));
        }
        for (name, args) in calls {
            if let Some(UppaalSymbol::Function(called)) = self.find(&name).cloned() {
                self.mark_function(&called, &args, depth + 1);
            }
        }
    }

    /// A `meta` variable is not part of UPPAAL's states: whoever reads it must have set it in the same transition.
    pub fn read_meta(&mut self, var: &VarSym, span: Span) {
        if !self.metas.contains(&var.name) || self.writing > 0 {
            return;
        }
        let is_set = self
            .cases
            .as_ref()
            .is_some_and(|cases| cases.in_updates && (cases.receives || cases.assigned.contains(&var.name)));
        if !is_set {
            let message = format!(
                "the `meta` variable `{}` is read where this transition has not set it: \
                 here it keeps its value, and UPPAAL's states are without it",
                var.name
            );
            self.notes.push((span, NoteSeverity::Warning, message));
        }
    }
}

fn named(sym: &UppaalSymbol) -> Option<String> {
    match sym {
        UppaalSymbol::Var(v) => Some(v.name.clone()),
        _ => None,
    }
}
