//! What stands in the block of a topic, a service or an action: fields that get a value, and rules.

use hrdsl_ir::binding::{MessageRules, MessageTemplate};
use hrdsl_messages::InterfaceName;
use hrdsl_syntax::ast::{BindingEntry, BindingEntryKind as Entry};

use super::{
    fields::{FieldValues, GivenFields},
    rules::MessageEnv,
    scope::BindingPlace,
    shape::MessageShape,
};
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{TypedExpr, report::bindings};

/// What a block comes to.
pub(super) struct BoundEntries {
    pub template: MessageTemplate<TypedExpr>,
    pub rules: MessageRules<TypedExpr>,
}

impl<'a> BindingPhase<'_, 'a> {
    /// `read` is the message that comes, `written` the one that goes.
    pub(super) fn entries(
        &mut self,
        place: BindingPlace,
        read: Option<&InterfaceName>,
        written: Option<&InterfaceName>,
        entries: &[BindingEntry],
    ) -> Option<BoundEntries> {
        self.entries_with(place, read, written, entries, FieldValues::new())
    }

    /// The same; fields of which nothing else is said hold what is told.
    pub(super) fn entries_with(
        &mut self,
        place: BindingPlace,
        read: Option<&InterfaceName>,
        written: Option<&InterfaceName>,
        entries: &[BindingEntry],
        told: FieldValues,
    ) -> Option<BoundEntries> {
        let shape = |name: Option<&InterfaceName>| {
            name.map_or(Some(MessageShape::default()), |n| MessageShape::new(self.library, n))
        };
        let (Some(heard), Some(said)) = (shape(read), shape(written)) else {
            let span = entries.first().map(|e| e.span).unwrap_or_default();
            self.report(bindings::too_large(span));
            return None;
        };
        let mut given = GivenFields::default();
        let mut env = MessageEnv::new(&heard);
        let mut rules = Vec::new();
        for entry in entries {
            match &entry.kind {
                Entry::Field { .. } if !place.fields => self.report(bindings::no_fields(entry.span)),
                Entry::Field { field, value, when } => {
                    let condition = when.as_ref().map(|when| self.field_condition(place, when, &mut env));
                    self.field_value(place, &said, (field, value, condition), &mut given);
                }
                Entry::Joint { .. } if !place.joints => self.report(bindings::no_joints(entry.span)),
                Entry::Emit { .. } | Entry::Command { .. } if !place.rules => {
                    self.report(bindings::no_rules(entry.span));
                }
                Entry::Emit { .. } | Entry::Command { .. } => {
                    rules.extend(self.message_rule(&mut env, entry));
                }
                Entry::Joint { .. } | Entry::Error => {}
            }
        }
        given.or_told(told);
        let (template, conditions) = given.template(&said);
        Some(BoundEntries { template, rules: MessageRules { reads: env.reads, rules, conditions } })
    }
}
