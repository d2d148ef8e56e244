//! Terms as values: each of as many as the class of the term has parts.

use super::{
    super::{
        alternatives::AlternativeSort,
        ast::{AgentSpeakLiteral, AgentSpeakTerm, TermKind},
        types::{AgentSpeakType, TyId},
    },
    clause::{
        ATOM, BindingMode, ClauseFailure, ClauseFragment, ClauseResult, ClauseTranslator, SUM, float_text,
        quoted,
    },
};

impl ClauseTranslator<'_> {
    /// The single values of which a term consists.
    pub fn values(&mut self, of: &AgentSpeakTerm, want: BindingMode) -> ClauseResult<Vec<String>> {
        let id = self.type_of(of)?;
        self.values_as(of, id, want)
    }

    /// The same, where the term is of a class that may be an alternative of its own.
    fn values_as(&mut self, of: &AgentSpeakTerm, id: TyId, want: BindingMode) -> ClauseResult<Vec<String>> {
        let types = self.cx.types;
        match &of.kind {
            TermKind::Any if want == BindingMode::Value => Err(ClauseFailure::Unbound("_".to_owned())),
            TermKind::Any => Ok(vec!["_".to_owned(); types.leaves(id).len()]),
            TermKind::Var { name, .. } => {
                if !self.bound.contains(name) {
                    if want == BindingMode::Value {
                        return Err(ClauseFailure::Unbound(name.clone()));
                    }
                    self.bound.insert(name.clone());
                }
                let name = self.var(name);
                let count = types.leaves(id).len();
                Ok(if count == 1 { vec![name] } else { (1..=count).map(|i| format!("{name}_{i}")).collect() })
            }
            _ if types.alternatives(id).is_some() => self.tagged(of, id, want),
            TermKind::Literal(l) if matches!(types.get(id), AgentSpeakType::Struct(..)) => {
                let parts = l.args.iter().map(|a| self.values(a, want)).collect::<ClauseResult<Vec<_>>>()?;
                Ok(parts.concat())
            }
            TermKind::List { items, rest } => {
                let items = items.iter().map(|i| self.values(i, want)).collect::<ClauseResult<Vec<_>>>()?;
                let rest = rest.as_ref().map(|r| self.part(r, want, &AlternativeSort::List)).transpose()?;
                let leaf = |k: usize| {
                    let items: Vec<&str> = items.iter().map(|i| i[k].as_str()).collect();
                    match &rest {
                        Some(rest) => format!("[{} | {}]", items.join(", "), rest[k]),
                        None => format!("[{}]", items.join(", ")),
                    }
                };
                Ok((0..types.leaves(id).len()).map(leaf).collect())
            }
            _ => Ok(vec![self.expr_as(of, id)?.text]),
        }
    }

    /// A term that is a single value.
    pub fn value(&mut self, of: &AgentSpeakTerm, want: BindingMode) -> ClauseResult<String> {
        match <[String; 1]>::try_from(self.values(of, want)?) {
            Ok([one]) => Ok(one),
            Err(_) => Err("a structure cannot stand here".into()),
        }
    }

    /// An expression, whose variables have values.
    pub fn expr(&mut self, of: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let id = self.type_of(of)?;
        if self.cx.types.alternatives(id).is_some()
            && let Some((_, own)) = self.own_alternative(of, id)
        {
            return self.expr_as(of, own);
        }
        self.expr_as(of, id)
    }

    fn expr_as(&mut self, of: &AgentSpeakTerm, id: TyId) -> ClauseResult<ClauseFragment> {
        let float = matches!(self.cx.types.get(id), AgentSpeakType::Number { float: true });
        let signed = |text: String| {
            if text.starts_with('-') {
                ClauseFragment::new(text, SUM)
            } else {
                ClauseFragment::new(text, ATOM)
            }
        };
        Ok(match &of.kind {
            TermKind::Int(n) if float => signed(format!("{n}.0")),
            TermKind::Int(n) => signed(n.to_string()),
            TermKind::Float(x) => signed(float_text(*x)),
            TermKind::Text(text) if matches!(self.cx.types.get(id), AgentSpeakType::Atoms { .. }) => {
                ClauseFragment::new(self.cx.names.atom(self.cx.types, id, text), ATOM)
            }
            TermKind::Text(text) => ClauseFragment::new(quoted(text), ATOM),
            TermKind::Literal(l) if l.args.is_empty() && *self.cx.types.get(id) == AgentSpeakType::Text => {
                ClauseFragment::new(quoted(&l.functor), ATOM)
            }
            TermKind::Bool(b) => ClauseFragment::new(b.to_string(), ATOM),
            TermKind::Neg(inner) => ClauseFragment::new(format!("-{}", self.number(inner)?.at(ATOM)), SUM),
            TermKind::Literal(l) if l.functor == "math.pi" => {
                ClauseFragment::new(float_text(std::f64::consts::PI), ATOM)
            }
            TermKind::Literal(l) if l.functor == "math.e" => {
                ClauseFragment::new(float_text(std::f64::consts::E), ATOM)
            }
            TermKind::Literal(l) if l.is_internal() && !is_expression(l) => {
                ClauseFragment::new(self.asked_first(l)?, ATOM)
            }
            TermKind::Literal(l) if l.is_internal() => {
                let args =
                    l.args.iter().map(|a| Ok(self.number(a)?.text)).collect::<ClauseResult<Vec<_>>>()?;
                let name = l.functor.trim_start_matches("math.");
                ClauseFragment::new(format!("{name}({})", args.join(", ")), ATOM)
            }
            TermKind::Literal(l) if l.args.is_empty() => {
                ClauseFragment::new(self.cx.names.atom(self.cx.types, id, &l.functor), ATOM)
            }
            TermKind::Binary { op, left, right } if op.is_arithmetic() => {
                self.arithmetic(*op, left, right, float)?
            }
            TermKind::Var { .. } | TermKind::Any | TermKind::List { .. } => {
                ClauseFragment::new(self.value(of, BindingMode::Value)?, ATOM)
            }
            TermKind::Literal(_)
            | TermKind::Binary { .. }
            | TermKind::Not(_)
            | TermKind::Body(_)
            | TermKind::Trigger(_)
            | TermKind::Plan => return Err("this is no single value".into()),
        })
    }

    /// The alternative of a class of values of several types that a term is, if that is no variable.
    pub(super) fn own_alternative(&self, of: &AgentSpeakTerm, id: TyId) -> Option<(usize, TyId)> {
        let sorts: Vec<AlternativeSort> = match &of.kind {
            TermKind::Int(_) | TermKind::Float(_) | TermKind::Neg(_) | TermKind::Binary { .. } => {
                vec![AlternativeSort::Number]
            }
            TermKind::Text(_) => vec![AlternativeSort::Text, AlternativeSort::Atom],
            TermKind::Bool(_) => vec![AlternativeSort::Truth],
            TermKind::Literal(l) if l.is_internal() => vec![AlternativeSort::Number],
            TermKind::Literal(l) if l.args.is_empty() => vec![AlternativeSort::Atom, AlternativeSort::Text],
            TermKind::Literal(l) => vec![AlternativeSort::Structure(l.functor.clone(), l.args.len())],
            TermKind::List { .. } => vec![AlternativeSort::List],
            TermKind::Any
            | TermKind::Var { .. }
            | TermKind::Not(_)
            | TermKind::Body(_)
            | TermKind::Trigger(_)
            | TermKind::Plan => Vec::new(),
        };
        sorts.iter().find_map(|sort| self.cx.types.alternative(id, sort))
    }

    /// A value of one of several types: its tag, its parts, and nothing in those of the others.
    fn tagged(&mut self, of: &AgentSpeakTerm, id: TyId, want: BindingMode) -> ClauseResult<Vec<String>> {
        let types = self.cx.types;
        let (index, own) = self.own_alternative(of, id).ok_or("values of several types meet here")?;
        let mut all = vec![self.cx.names.tag(types, id, index)];
        for other in types.alternatives(id).unwrap_or_default() {
            if *other == own {
                all.extend(self.values_as(of, own, want)?);
            } else {
                all.extend(types.leaves(*other).into_iter().map(|l| self.cx.names.nothing(types, l)));
            }
        }
        Ok(all)
    }

    /// The parts of a term where a value of that sort is due. Of a variable for several, its tag is asked first.
    pub(super) fn part(
        &mut self,
        of: &AgentSpeakTerm,
        want: BindingMode,
        sort: &AlternativeSort,
    ) -> ClauseResult<Vec<String>> {
        let (types, id) = (self.cx.types, self.type_of(of)?);
        let Some(all) = types.alternatives(id) else { return self.values(of, want) };
        let (index, own) = types.alternative(id, sort).ok_or("values of several types meet here")?;
        let before = all[..index].iter().map(|a| types.leaves(*a).len()).sum::<usize>() + 1;
        let range = before..before + types.leaves(own).len();
        let tag = self.cx.names.tag(types, id, index);
        match &of.kind {
            TermKind::Any => Ok(self.values(of, want)?[range].to_vec()),
            TermKind::Var { name, .. } if self.bound.contains(name) || want == BindingMode::Value => {
                let values = self.values(of, BindingMode::Value)?;
                self.first.push(format!("{} == {tag}", values[0]));
                Ok(values[range].to_vec())
            }
            TermKind::Var { .. } => {
                let values = self.values(of, BindingMode::Pattern)?;
                self.first.push(format!("{} = {tag}", values[0]));
                for (i, (value, leaf)) in values.iter().zip(types.leaves(id)).enumerate().skip(1) {
                    if !range.contains(&i) {
                        self.first.push(format!("{value} = {}", self.cx.names.nothing(types, leaf)));
                    }
                }
                Ok(values[range].to_vec())
            }
            _ => self.values_as(of, own, want),
        }
    }

    /// One value where one of that sort is due.
    pub(super) fn single(
        &mut self,
        of: &AgentSpeakTerm,
        want: BindingMode,
        sort: &AlternativeSort,
    ) -> ClauseResult<String> {
        match <[String; 1]>::try_from(self.part(of, want, sort)?) {
            Ok([one]) => Ok(one),
            Err(_) => Err("a structure cannot stand here".into()),
        }
    }

    /// A value that is of several types cannot stand here.
    pub(super) fn no_choice(&self, of: &AgentSpeakTerm) -> ClauseResult<()> {
        match self.cx.types.alternatives(self.type_of(of)?) {
            Some(_) => Err("values of several types meet here".into()),
            None => Ok(()),
        }
    }

    /// Nor can lists whose elements are.
    pub(super) fn of_one_type(&self, of: &AgentSpeakTerm) -> ClauseResult<()> {
        let leaves = self.cx.types.leaves(self.type_of(of)?);
        if leaves.iter().any(|l| self.cx.types.alternatives(l.of).is_some()) {
            return Err("values of several types meet here".into());
        }
        Ok(())
    }

    /// An expression where a number is due.
    pub(super) fn number(&mut self, of: &AgentSpeakTerm) -> ClauseResult<ClauseFragment> {
        let id = self.type_of(of)?;
        if self.cx.types.alternatives(id).is_none() || !matches!(of.kind, TermKind::Var { .. }) {
            return self.expr(of);
        }
        let text = self.single(of, BindingMode::Value, &AlternativeSort::Number)?;
        let message = "where this is no number Jason goes on with `NaN`; here what it is computed for fails";
        self.remarks.push((of.span, message.to_owned()));
        Ok(ClauseFragment::new(text, ATOM))
    }
}

/// Whether an internal function is one of expressions, too.
fn is_expression(of: &AgentSpeakLiteral) -> bool {
    matches!((of.functor.as_str(), of.args.len()), ("math.abs", 1) | ("math.min" | "math.max", 2))
}
