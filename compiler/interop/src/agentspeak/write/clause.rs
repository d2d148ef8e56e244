//! A plan, rule or fact in the scenario's words: terms and formulas, with what has a value where.

use std::collections::BTreeSet;

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::super::{
    alternatives::AlternativeSort,
    ast::{
        AgentSpeakFormula, AgentSpeakLiteral, AgentSpeakOperator, AgentSpeakTerm, PredicateIndicator,
        TermKind, each_term,
    },
    names::{AgentSpeakNames, ident, unused, variable},
    system::AgentSpeakSystem,
    term::{OmissionReason, valued},
    types::{TyId, UnificationTable},
};
use super::wanted::WantedArguments;

/// What all clauses of a program need to know.
pub struct ClauseContext<'a> {
    pub system: &'a AgentSpeakSystem,
    pub types: &'a UnificationTable,
    pub left_out: &'a IndexMap<Span, OmissionReason>,
    pub names: &'a AgentSpeakNames,
    /// Of beliefs with rules, the arguments that must have a value.
    pub inputs: &'a IndexMap<PredicateIndicator, BTreeSet<usize>>,
    /// Of goals, the arguments that are open where the goal is adopted.
    pub wanted: &'a WantedArguments,
}

/// Why something cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClauseFailure {
    /// A variable without a value is read.
    Unbound(String),
    Other(OmissionReason),
}

impl ClauseFailure {
    pub fn reason(&self) -> OmissionReason {
        match self {
            Self::Unbound(name) if name == "_" => "`_` has no value, and one is needed here".to_owned(),
            Self::Unbound(name) => format!("`{name}` has no value here"),
            Self::Other(reason) => reason.clone(),
        }
    }
}

impl From<String> for ClauseFailure {
    fn from(reason: String) -> Self {
        Self::Other(reason)
    }
}

impl From<&str> for ClauseFailure {
    fn from(reason: &str) -> Self {
        Self::Other(reason.to_owned())
    }
}

pub type ClauseResult<T> = Result<T, ClauseFailure>;

/// What an agent's clauses speak of, as far as they are carried over.
#[derive(Clone, Debug, Default)]
pub struct PredicateUsage {
    pub beliefs: IndexSet<PredicateIndicator>,
    pub annotations: IndexSet<(PredicateIndicator, String)>,
    /// Goals that are adopted, or asked about.
    pub adopted: IndexSet<PredicateIndicator>,
    /// Goals with a plan.
    pub planned: IndexSet<PredicateIndicator>,
    pub actions: IndexSet<PredicateIndicator>,
    /// To whom, whether of a goal, about what.
    pub sent: IndexSet<(Option<String>, bool, PredicateIndicator)>,
    /// Whether the rule of whole numbers from one to another is needed.
    pub between: bool,
    /// Arguments of goals that are open; `true`: the value is taken.
    pub wanted: IndexSet<(PredicateIndicator, usize, bool)>,
}

/// Whether terms may bind variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingMode {
    Pattern,
    Value,
}

/// A piece of text, and how tight its loosest operator is.
#[derive(Clone, Debug)]
pub struct ClauseFragment {
    pub text: String,
    pub level: u8,
}

pub const OR: u8 = 1;
pub const AND: u8 = 2;
pub const NOT: u8 = 3;
pub const COMPARE: u8 = 4;
pub const SUM: u8 = 5;
pub const PRODUCT: u8 = 6;
pub const ATOM: u8 = 8;

impl ClauseFragment {
    pub fn new(text: impl Into<String>, level: u8) -> Self {
        Self { text: text.into(), level }
    }

    /// In parentheses, if it is looser than `level`.
    pub fn at(self, level: u8) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text }
    }

    /// Several, all of which must hold.
    pub fn all(parts: Vec<Self>) -> Self {
        match <[Self; 1]>::try_from(parts) {
            Ok([one]) => one,
            Err(parts) if parts.is_empty() => Self::new("true", ATOM),
            Err(parts) => {
                let parts: Vec<String> = parts.into_iter().map(|p| p.at(AND)).collect();
                Self::new(parts.join(" && "), AND)
            }
        }
    }
}

pub struct ClauseTranslator<'a> {
    pub cx: &'a ClauseContext<'a>,
    pub agent: &'a str,
    /// Variables that have a value.
    pub bound: BTreeSet<String>,
    vars: IndexMap<String, String>,
    fresh: usize,
    pub used: PredicateUsage,
    /// Places that are carried over otherwise than they were meant, with what is to be said.
    pub remarks: Vec<(Span, String)>,
    /// Variables that hold an agent's answer, with the agent: its name in the program, or how it is written as an error.
    pub answers: IndexMap<String, Result<String, String>>,
    /// Internal actions that are values of what is written, to be asked before it.
    pub first: Vec<String>,
    /// In how many choices with the steps that come after them the present one is.
    pub continued: usize,
    /// In a plan for a goal: the variables that it is to give a value, each with whether that is taken.
    pub owed: IndexMap<String, bool>,
}

impl<'a> ClauseTranslator<'a> {
    pub fn new(cx: &'a ClauseContext<'a>, agent: &'a str, used: PredicateUsage) -> Self {
        let (bound, vars) = (BTreeSet::new(), IndexMap::new());
        Self {
            cx,
            agent,
            bound,
            vars,
            fresh: 0,
            used,
            remarks: Vec::new(),
            answers: IndexMap::new(),
            continued: 0,
            owed: IndexMap::new(),
            first: Vec::new(),
        }
    }

    /// A variable that the program does not have.
    pub fn fresh(&mut self, hint: &str) -> String {
        self.fresh += 1;
        let used = self.vars.values().cloned().collect();
        let name = unused(format!("{hint}{}", self.fresh), &used);
        self.vars.insert(format!(" {name}"), name.clone());
        name
    }

    pub(super) fn var(&mut self, name: &str) -> String {
        if let Some(found) = self.vars.get(name) {
            return found.clone();
        }
        let used = self.vars.values().cloned().collect();
        let written = unused(variable(name), &used);
        self.vars.insert(name.to_owned(), written.clone());
        written
    }

    pub fn type_of(&self, of: &AgentSpeakTerm) -> ClauseResult<TyId> {
        self.cx.types.terms.get(&of.span).copied().ok_or_else(|| ClauseFailure::from("this has no type"))
    }

    /// Whether all variables of a term have values.
    pub fn is_bound(&self, of: &AgentSpeakTerm) -> bool {
        let mut all = true;
        each_term(of, &mut |t| match &t.kind {
            TermKind::Any => all = false,
            TermKind::Var { name, .. } => all &= self.bound.contains(name),
            _ => {}
        });
        all
    }

    // ── Formulas ──

    pub(super) fn formula_alone(&mut self, of: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let Some(formula) = of.as_formula() else { return Err("this is no formula".into()) };
        match formula {
            AgentSpeakFormula::Truth(b) => Ok(ClauseFragment::new(b.to_string(), ATOM)),
            AgentSpeakFormula::Literal(l) if l.is_internal() => self.internal_formula(l),
            AgentSpeakFormula::Literal(l) => {
                Ok(ClauseFragment::new(self.belief(l, BindingMode::Pattern)?, ATOM))
            }
            AgentSpeakFormula::Not(inner) => {
                let before = self.bound.clone();
                let inner = self.formula(inner);
                self.bound = before;
                Ok(ClauseFragment::new(format!("not {}", inner?.at(ATOM)), NOT))
            }
            AgentSpeakFormula::Connective { op: AgentSpeakOperator::And, left, right } => {
                let (l, r) = (self.formula(left)?, self.formula(right)?);
                Ok(ClauseFragment::new(format!("{} && {}", l.at(AND), r.at(AND)), AND))
            }
            AgentSpeakFormula::Connective { left, right, .. } => {
                let before = self.bound.clone();
                let l = self.formula(left)?;
                let after = std::mem::replace(&mut self.bound, before);
                let r = self.formula(right)?;
                self.bound = self.bound.intersection(&after).cloned().collect();
                Ok(ClauseFragment::new(format!("{} || {}", l.at(OR), r.at(OR)), OR))
            }
            AgentSpeakFormula::Relation { op: AgentSpeakOperator::Unify, left, right } => {
                self.unify(left, right)
            }
            AgentSpeakFormula::Relation { op, left, right } => self.compare(op, left, right),
        }
    }

    /// `l = r`: one of them has a value, the other is matched with it.
    pub fn unify(&mut self, left: &AgentSpeakTerm, right: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        // If neither has a value, what is to be computed is at fault.
        let computed = |t: &AgentSpeakTerm| matches!(t.kind, TermKind::Binary { .. } | TermKind::Neg(_));
        let swap = !self.is_bound(right) && (self.is_bound(left) || computed(left));
        let (pattern, value) = if swap { (right, left) } else { (left, right) };
        let values = self.values(value, BindingMode::Value)?;
        let patterns = self.values(pattern, BindingMode::Pattern)?;
        let pairs = patterns.iter().zip(&values).filter(|(p, v)| p != v);
        Ok(ClauseFragment::all(
            pairs.map(|(p, v)| ClauseFragment::new(format!("{p} = {v}"), COMPARE)).collect(),
        ))
    }

    /// `~b(…)[…]`
    pub fn belief(&mut self, of: &AgentSpeakLiteral, want: BindingMode) -> ClauseResult<String> {
        let key = of.key();
        if want == BindingMode::Pattern
            && let Some(inputs) = self.cx.inputs.get(&key)
        {
            for arg in inputs.iter().filter_map(|i| of.args.get(*i)) {
                if !self.is_bound(arg) {
                    self.values(arg, BindingMode::Value)?;
                }
            }
        }
        let args = of.args.iter().map(|a| self.values(a, want)).collect::<ClauseResult<Vec<_>>>()?.concat();
        self.used.beliefs.insert(key.clone());
        let annotations = self.annotations(of, &key, want)?;
        let name = self.cx.names.belief(&key);
        Ok(format!("{}{}{annotations}", if of.negated { "~" } else { "" }, call(&name, &args)))
    }

    fn annotations(
        &mut self,
        of: &AgentSpeakLiteral,
        key: &PredicateIndicator,
        want: BindingMode,
    ) -> ClauseResult<String> {
        let mut all = Vec::new();
        for annotation in &of.annotations {
            let Some((name, value)) = valued(annotation) else {
                self.remarks.push((annotation.span, "an annotation without one value is dropped".to_owned()));
                continue;
            };
            let written = if name == "source" { name.to_owned() } else { ident(name) };
            if name != "source" {
                self.used.annotations.insert((key.clone(), name.to_owned()));
            }
            let value = if name == "source" {
                self.single(value, want, &AlternativeSort::Atom)?
            } else {
                self.value(value, want)?
            };
            all.push(format!("{written}({value})"));
        }
        Ok(if all.is_empty() { String::new() } else { format!("[{}]", all.join(", ")) })
    }

    /// `g(…)`, without its sign. Annotations but the source are dropped.
    pub fn goal(&mut self, of: &AgentSpeakLiteral, want: BindingMode) -> ClauseResult<String> {
        let args = of.args.iter().map(|a| self.values(a, want)).collect::<ClauseResult<Vec<_>>>()?;
        self.goal_with(of, &args.concat(), want)
    }

    /// The same, with its arguments as they are written.
    pub fn goal_with(
        &mut self,
        of: &AgentSpeakLiteral,
        args: &[String],
        want: BindingMode,
    ) -> ClauseResult<String> {
        let mut source = String::new();
        for annotation in &of.annotations {
            match valued(annotation) {
                Some(("source", value)) if want == BindingMode::Pattern => {
                    source = format!("[source({})]", self.single(value, want, &AlternativeSort::Atom)?);
                }
                Some(("source", _)) => {}
                Some(("hard_deadline", time)) if want == BindingMode::Value && is_number(time) => {}
                _ => self.remarks.push((
                    annotation.span,
                    "of a goal's annotations only the source is carried over".to_owned(),
                )),
            }
        }
        let name = self.cx.names.goal(&of.key());
        Ok(call(&name, args) + &source)
    }
}

/// `f(a, b)`, or `f`
pub fn call(name: &str, args: &[String]) -> String {
    if args.is_empty() { name.to_owned() } else { format!("{name}({})", args.join(", ")) }
}

/// A text as the scenario writes it.
pub fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out + "\""
}

pub(super) fn float_text(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        Some((number, exponent)) if !number.contains('.') => format!("{number}.0e{exponent}"),
        _ => text,
    }
}

pub(super) fn is_number(of: &AgentSpeakTerm) -> bool {
    matches!(of.kind, TermKind::Int(_) | TermKind::Float(_))
}
