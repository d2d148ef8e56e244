//! Declared types: enumerations, records, arrays, and what a type expression means.

use hrdsl_ir::ListOf;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, NameSyntax, ParamSyntax as SyntaxParam, TypeExpr};

use crate::check::{
    checker::Checker,
    state::{
        issues::too_many,
        record::{DeclaredFields, MAX_PARTS, RecordState},
        scope::ExprEnv,
        table::NameTable,
        template::{KIND_WORDS, is_kind_word},
    },
};
use crate::resolution::type_span;
use crate::{
    InferredType, Parameter, Type, Value,
    noun::Noun,
    report::{automata, names, types},
    type_named, type_names,
    types::TypeLayout,
};

/// How deep records can be in records.
const MAX_RECORDS: usize = 64;

impl<'a> Checker<'a> {
    pub(in crate::check) fn all_records(&mut self) {
        for id in 0..self.types.records.len() {
            self.resolve_record(id, 0);
        }
    }

    /// `outer`: how many records are being resolved that have this one in them.
    fn resolve_record(&mut self, id: usize, outer: usize) {
        if self.types.records[id].state != RecordState::Unseen {
            return;
        }
        let (name, syntax) = (self.types.records[id].name, self.types.records[id].syntax);
        if outer >= MAX_RECORDS {
            let message = format!("records are in records more than {MAX_RECORDS} levels deep");
            self.types.records[id].state = RecordState::Done;
            return self.report(too_many(message, name.span));
        }
        self.types.open_records = outer + 1;
        self.types.records[id].state = RecordState::Open;
        if syntax.is_empty() {
            let help = format!("write `record {} {{ x: length, y: length }}`", name.text);
            self.report(names::missing(name.span, "a record has fields", help));
        }
        let fields = self.fields_as(Noun::Field, syntax);
        self.types.records[id].size = fields.iter().fold(0, |n, (_, l)| n.saturating_add(self.size(l)));
        self.types.records[id].fields = fields;
        self.types.records[id].state = RecordState::Done;
        self.types.open_records = outer;
    }

    /// The fields of a record, which may be needed before its turn; `None` if they need themselves.
    pub(in crate::check) fn record_fields(&mut self, id: u16, name: &NameSyntax) -> Option<DeclaredFields> {
        self.resolve_record(usize::from(id), self.types.open_records);
        let entry = &self.types.records[usize::from(id)];
        if entry.state == RecordState::Open {
            self.report(types::record_cycle(&name.text, name.span));
            return None;
        }
        Some(entry.fields.clone())
    }

    /// Parameters; names are distinct.
    pub(in crate::check) fn fields(&mut self, params: &[SyntaxParam]) -> DeclaredFields {
        self.fields_as(Noun::Parameter, params)
    }

    fn fields_as(&mut self, noun: Noun, params: &[SyntaxParam]) -> DeclaredFields {
        let mut table = NameTable::default();
        let mut resolved = Vec::new();
        for param in params {
            let layout = self.layout(&param.ty).unwrap_or(TypeLayout::Unknown);
            self.issues.declare(&mut table, noun, &param.name);
            resolved.push((param.name.text.clone(), layout));
        }
        resolved.into()
    }

    /// The single values of parameters.
    pub(in crate::check) fn flat(&self, fields: &[(String, TypeLayout)]) -> Vec<Parameter> {
        let mut leaves = Vec::new();
        for (name, layout) in fields {
            self.leaves(name, layout, &mut leaves);
        }
        leaves.into_iter().map(|(name, ty)| Parameter { name, ty }).collect()
    }

    /// The type of one value.
    pub(in crate::check) fn ty(&mut self, ty: &TypeExpr) -> Option<Type> {
        match self.layout(ty)? {
            TypeLayout::Scalar(ty) => Some(ty),
            TypeLayout::Unknown => None,
            layout @ (TypeLayout::Record(_) | TypeLayout::Array(..)) => {
                let got = self.shown_layout(&layout);
                let issue = types::other_shape("the type of one value", &got, type_span(ty));
                self.report(issue.help("write a type such as `bool` or `length`, or a range `0..4`"));
                None
            }
        }
    }

    /// What a type expression means.
    pub(in crate::check) fn layout(&mut self, ty: &TypeExpr) -> Option<TypeLayout> {
        let layout = match ty {
            TypeExpr::Error => return None,
            TypeExpr::Named(name) => self.named_type(name)?,
            TypeExpr::Range(lo, hi) => TypeLayout::Scalar(self.range_type(lo, hi)?),
            TypeExpr::Array(..) => self.array_type(ty)?,
            TypeExpr::List(of) => match self.layout(of)? {
                TypeLayout::Scalar(of) => TypeLayout::Scalar(Type::List(ListOf::new(of))),
                TypeLayout::Unknown => return None,
                other @ (TypeLayout::Record(_) | TypeLayout::Array(..)) => {
                    let got = self.shown_layout(&other);
                    let issue = types::other_shape("the type of one value", &got, type_span(of));
                    self.report(issue.help("the elements of a list are single values, or lists"));
                    return None;
                }
            },
        };
        let size = self.size(&layout);
        if size > MAX_PARTS {
            self.report(types::too_many_parts(size, MAX_PARTS, type_span(ty)));
            return None;
        }
        Some(layout)
    }

    /// `T[2][3]`: two of three; the indices are written in the order of the sizes.
    fn array_type(&mut self, ty: &TypeExpr) -> Option<TypeLayout> {
        let (mut of, mut sizes) = (ty, Vec::new());
        while let TypeExpr::Array(inner, size) = of {
            sizes.push(size);
            of = inner;
        }
        let mut layout = self.layout(of);
        for size in sizes {
            let n = self.count(size, "the size of an array", 1);
            let fits = n.and_then(|n| u16::try_from(n).ok()).filter(|n| usize::from(*n) <= MAX_PARTS);
            if n.is_some() && fits.is_none() {
                let rule = format!("at most {MAX_PARTS}");
                self.report(types::must_be("the size of an array", &rule, size.span));
            }
            layout = layout.zip(fits).map(|(of, n)| TypeLayout::Array(Box::new(of), n));
        }
        layout
    }

    /// How many single values there are.
    pub(in crate::check) fn size(&self, layout: &TypeLayout) -> usize {
        match layout {
            TypeLayout::Scalar(_) => 1,
            TypeLayout::Unknown => 0,
            TypeLayout::Record(id) => self.types.records[usize::from(*id)].size,
            TypeLayout::Array(of, n) => self.size(of).saturating_mul(usize::from(*n)),
        }
    }

    /// Parameters of what is not an agent's: neither strings nor lists.
    pub(in crate::check) fn plain_fields(&mut self, params: &[SyntaxParam]) -> DeclaredFields {
        let fields = self.fields(params);
        for (param, (_, layout)) in params.iter().zip(fields.iter()) {
            self.plain(layout, &param.name.text, type_span(&param.ty));
        }
        fields
    }

    /// Says if a string or list is in something that no agent has.
    pub(in crate::check) fn plain(&mut self, layout: &TypeLayout, name: &str, span: Span) -> bool {
        let mut leaves = Vec::new();
        self.leaves(name, layout, &mut leaves);
        let found = leaves.into_iter().find(|(_, ty)| ty.is_of_agents());
        if let Some((name, ty)) = &found {
            self.report(types::of_agents_only(name, *ty, span));
        }
        found.is_none()
    }

    fn named_type(&mut self, name: &NameSyntax) -> Option<TypeLayout> {
        if name.text == "agent" {
            return Some(TypeLayout::Scalar(Type::Enum(self.players.agent_names)));
        }
        if let Some(ty) = type_named(&name.text) {
            return Some(TypeLayout::Scalar(ty));
        }
        if let Some(id) = self.types.enums.get(&name.text) {
            self.refer(name, self.types.enums.span(id));
            return Some(TypeLayout::Scalar(Type::Enum(self.s.enums[usize::from(id)].of)));
        }
        if let Some(id) = self.types.record_names.get(&name.text) {
            self.refer(name, self.types.record_names.span(id));
            self.resolve_record(usize::from(id), self.types.open_records);
            if self.types.records[usize::from(id)].state == RecordState::Open {
                self.report(types::record_cycle(&name.text, name.span));
                return None;
            }
            // One without fields has a diagnostic.
            return (self.types.records[usize::from(id)].size > 0).then_some(TypeLayout::Record(id));
        }
        if name.text == "clock" {
            self.report(automata::clock_type(name.span));
            return None;
        }
        let mut all = self.type_names();
        if self.templates.given.is_some() {
            all.extend(KIND_WORDS.map(str::to_owned));
        }
        let issue_before = self.issues.list.len();
        self.unknown(Noun::Type, name, &all, None);
        if is_kind_word(&name.text)
            && let Some(issue) = self.issues.list.get_mut(issue_before)
        {
            issue.help = Some("only a template has parameters of this kind".to_owned());
        }
        None
    }

    pub(in crate::check) fn type_names(&self) -> Vec<String> {
        let mut names: Vec<String> = type_names().chain(["agent"]).map(str::to_owned).collect();
        names.extend(self.near_of(&[Noun::Enum]));
        names.extend(self.near_of(&[Noun::Record]));
        names
    }

    fn range_type(&mut self, lo: &ast::ExprSyntax, hi: &ast::ExprSyntax) -> Option<Type> {
        let span = lo.span.to(hi.span);
        let lo = self.constant(lo, InferredType::Int, &mut ExprEnv::constants());
        let hi = self.constant(hi, InferredType::Int, &mut ExprEnv::constants());
        let (Some(Value::Int(lo)), Some(Value::Int(hi))) = (lo, hi) else { return None };
        if lo > hi {
            self.report(types::empty_range(Value::Int(lo), Value::Int(hi), span));
            return None;
        }
        Some(Type::Int { lo, hi })
    }
}
