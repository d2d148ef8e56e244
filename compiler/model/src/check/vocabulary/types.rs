//! Declared types: enumerations and records.

use hrdsl_source::{Enumeration, Span};
use hrdsl_syntax::ast::{NameSyntax, ParamSyntax as SyntaxParam};

use crate::check::{
    state::{
        record::{DeclaredFields, RecordEntry, RecordState},
        table::NameTable,
    },
    template::CheckerPhase,
    vocabulary::phase::VocabularyPhase,
};
use crate::{EnumDecl, noun::Noun, report::names, type_named};

impl<'a> VocabularyPhase<'_, 'a> {
    pub(super) fn declare_enum(&mut self, name: &'a NameSyntax, values: &'a [NameSyntax], span: Span) {
        if self.type_is_taken(name) {
            return;
        }
        for value in values {
            let constant = self.consts.get(value.text.as_str()).map(|c| c.name.span);
            if constant.is_some() {
                self.report(names::duplicate(Noun::Constant, &value.text, value.span, constant));
            }
        }
        if values.is_empty() {
            let help = format!("write `enum {} {{ first, second }}`", name.text);
            self.report(names::missing(name.span, "an enumeration has values", help));
        }
        let mut table = NameTable::default();
        if self.checker.issues.declare(&mut self.checker.types.enums, Noun::Enum, name).is_none() {
            return;
        }
        for value in values {
            self.checker.issues.declare(&mut table, Noun::EnumValue, value);
        }
        let of = Enumeration::intern(&name.text, &table.names().collect::<Vec<_>>());
        for value in values.iter().filter(|v| table.span_of(&v.text) == Some(v.span)) {
            self.types.values.entry(&value.text).or_default().push(of);
        }
        self.s.enums.push(EnumDecl { of, span });
    }

    pub(super) fn declare_record(&mut self, name: &'a NameSyntax, syntax: &'a [SyntaxParam]) {
        if self.type_is_taken(name) {
            return;
        }
        if self.checker.issues.declare(&mut self.checker.types.record_names, Noun::Record, name).is_some() {
            let state = RecordState::Unseen;
            self.types.records.push(RecordEntry {
                name,
                syntax,
                fields: DeclaredFields::default(),
                state,
                size: 0,
            });
        }
    }

    /// Types have one namespace, which the language's own are in too.
    fn type_is_taken(&mut self, name: &NameSyntax) -> bool {
        let first = self.types.enums.get(&name.text).and_then(|id| self.types.enums.span(id));
        let first = first.or_else(|| {
            self.types.record_names.get(&name.text).and_then(|id| self.types.record_names.span(id))
        });
        let taken = first.is_some() || type_named(&name.text).is_some();
        if taken {
            self.report(names::duplicate(Noun::Type, &name.text, name.span, first));
        }
        taken
    }
}
