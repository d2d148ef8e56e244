//! What stands in the block of a topic, a service or an action: fields that get a value, and rules.

use std::collections::BTreeMap;

use hrdsl_ir::binding::{
    GapValue, MessageGap, MessageRules, MessageScalar, MessageStep, MessageTemplate, place_text,
};
use hrdsl_messages::InterfaceName;
use hrdsl_syntax::ast::{BindingEntry, BindingEntryKind as Entry, FieldSyntax};

use super::{
    BindingScope,
    rules::MessageEnv,
    shape::{FieldShape, MessageShape},
};
use crate::check::checker::Checker;
use crate::{TypedExpr, noun::Noun, report::bindings};

/// Whose entries they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BindingPlace {
    /// Messages go to the programs, so that fields get values.
    pub fields: bool,
    /// Messages come from them, so that rules say what they mean.
    pub rules: bool,
    /// Messages go at a rate, whatever happens.
    pub periodic: bool,
}

impl BindingPlace {
    pub const OUTPUT: Self = Self { fields: false, rules: true, periodic: false };
    pub const SERVICE: Self = Self { fields: true, rules: true, periodic: true };

    pub fn input(periodic: bool) -> Self {
        Self { fields: true, rules: false, periodic }
    }
}

/// What stands in fields, by their places: `pose.position.x`.
pub(super) type FieldValues = BTreeMap<String, MessageGap<TypedExpr>>;

/// What a block comes to.
pub(super) struct BoundEntries {
    pub template: MessageTemplate<TypedExpr>,
    pub rules: MessageRules<TypedExpr>,
}

impl<'a> Checker<'a> {
    /// `read` is the message that comes, `written` the one that goes.
    pub(super) fn entries(
        &mut self,
        scope: BindingScope<'a>,
        place: BindingPlace,
        read: Option<&InterfaceName>,
        written: Option<&InterfaceName>,
        entries: &[BindingEntry],
    ) -> Option<BoundEntries> {
        self.entries_with(scope, place, read, written, entries, FieldValues::new())
    }

    /// The same; fields of which nothing else is said hold what is told.
    pub(super) fn entries_with(
        &mut self,
        scope: BindingScope<'a>,
        place: BindingPlace,
        read: Option<&InterfaceName>,
        written: Option<&InterfaceName>,
        entries: &[BindingEntry],
        told: FieldValues,
    ) -> Option<BoundEntries> {
        let shape = |name: Option<&InterfaceName>| {
            name.map_or(Some(MessageShape { fields: Vec::new() }), |n| MessageShape::new(scope.library, n))
        };
        let (Some(heard), Some(said)) = (shape(read), shape(written)) else {
            let span = entries.first().map(|e| e.span).unwrap_or_default();
            self.report(bindings::too_large(span));
            return None;
        };
        let mut values = FieldValues::new();
        let mut env = MessageEnv::new(&heard);
        let mut rules = Vec::new();
        for entry in entries {
            match &entry.kind {
                Entry::Field { field, value } => {
                    if !place.fields {
                        self.report(bindings::no_fields(entry.span));
                        continue;
                    }
                    let Some((path, scalar)) = self.field_place(&said, field) else { continue };
                    let Some(value) = self.gap_value(scope, place, scalar, value) else { continue };
                    let text = place_text(&path);
                    if values.insert(text.clone(), MessageGap { value, scalar }).is_some() {
                        let issue =
                            crate::report::names::duplicate(Noun::Field, &text, field.path.span, None);
                        self.report(issue.help("give it one value"));
                    }
                }
                Entry::Emit { .. } | Entry::Command { .. } if !place.rules => {
                    self.report(bindings::no_rules(entry.span));
                }
                Entry::Emit { .. } | Entry::Command { .. } => {
                    rules.extend(self.message_rule(scope, &mut env, entry));
                }
                Entry::Error => {}
            }
        }
        for (field, value) in told {
            values.entry(field).or_insert(value);
        }
        let rules = MessageRules { reads: env.reads, rules };
        Some(BoundEntries { template: template(&said, values), rules })
    }

    /// The place in a message that a field names, if it holds one value.
    fn field_place(
        &mut self,
        shape: &MessageShape,
        field: &FieldSyntax,
    ) -> Option<(Vec<MessageStep>, MessageScalar)> {
        let mut path = Vec::new();
        for name in &field.path.names {
            path.push(MessageStep::Field(name.text.clone()));
            if shape.at(&path).is_none() {
                path.pop();
                let known = names_at(shape, &path);
                let near = known.iter().map(String::as_str);
                self.report(bindings::unknown_field(&name.text, &place_text(&path), name.span, near));
                return None;
            }
        }
        if let Some(index) = &field.index {
            let at = self.count(index, "the place in the array", 0)?;
            path.push(MessageStep::Element(u32::try_from(at).unwrap_or(u32::MAX)));
        }
        match shape.at(&path) {
            Some(FieldShape::Scalar(scalar, _)) => Some((path, *scalar)),
            Some(FieldShape::Message(_)) => {
                let parts = names_at(shape, &path);
                self.report(bindings::several_values(&place_text(&path), &parts, field.path.span));
                None
            }
            Some(FieldShape::Array(_) | FieldShape::Sequence { .. }) | None => {
                self.report(bindings::not_one_value(&place_text(&path), field.path.span));
                None
            }
        }
    }
}

/// The fields of what lies at a place.
fn names_at(shape: &MessageShape, path: &[MessageStep]) -> Vec<String> {
    let of = |message: &MessageShape| message.fields.iter().map(|(name, _)| name.clone()).collect();
    if path.is_empty() {
        return of(shape);
    }
    match shape.at(path) {
        Some(FieldShape::Message(message)) => of(message),
        Some(FieldShape::Scalar(..) | FieldShape::Array(_) | FieldShape::Sequence { .. }) | None => {
            Vec::new()
        }
    }
}

/// The text of the message around its values. The time in a header is that of the message, unless something else is said.
fn template(shape: &MessageShape, mut values: FieldValues) -> MessageTemplate<TypedExpr> {
    let mut gaps = Vec::new();
    let text = shape.text(&mut |path| {
        let place = place_text(path);
        let stamp = place == "header.stamp" && matches!(shape.at(path), Some(FieldShape::Scalar(..)));
        let now = || stamp.then_some(MessageGap { value: GapValue::Now, scalar: MessageScalar::Time });
        let gap = values.remove(&place).or_else(now);
        let is_gap = gap.is_some();
        gaps.extend(gap);
        is_gap
    });
    MessageTemplate { text, gaps }
}
