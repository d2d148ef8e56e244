//! Fields that get values, one or several at once; and the text of the message around them.

use std::collections::BTreeMap;

use hrdsl_ir::binding::{
    GapCase, GapValue, MessageGap, MessageScalar, MessageStep, MessageTemplate, place_text,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, FieldSyntax};

use super::{
    places::steps_of_field,
    scope::BindingPlace,
    shape::{FieldShape, MessageGaps, MessageShape},
};
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    TypedExpr,
    noun::Noun,
    report::{names, types},
};

/// The most elements that a sequence may be given.
pub(super) const MOST_ELEMENTS: u32 = 10_000;

/// What stands in fields, by their places: `pose.position.x`.
pub(super) type FieldValues = BTreeMap<String, MessageGap<TypedExpr>>;

/// What the fields of a message are given.
#[derive(Default)]
pub(super) struct GivenFields {
    /// What may stand at each place, in the order of the text.
    cases: BTreeMap<String, Vec<GapCase<TypedExpr>>>,
    /// On which the cases depend.
    conditions: Vec<TypedExpr>,
    /// How many elements sequences have of which single ones are given, by their places.
    lengths: BTreeMap<String, u32>,
}

impl GivenFields {
    /// Whether something else is said of a field already, in whole or in part, so that it can be given no more.
    fn is_taken(&self, place: &str) -> bool {
        let within = |outer: &str, inner: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let is_open = |cases: &[GapCase<TypedExpr>]| cases.iter().all(|case| case.condition.is_some());
        let takes = |(known, cases): (&String, &Vec<GapCase<TypedExpr>>)| {
            (within(known, place) || within(place, known)) && !(known == place && is_open(cases))
        };
        self.cases.iter().any(takes)
    }

    fn add(&mut self, path: &[MessageStep], gap: MessageGap<TypedExpr>, condition: Option<TypedExpr>) {
        for (before, step) in path.iter().enumerate() {
            if let (MessageStep::Element(at), Some(whole)) = (step, path.get(..before)) {
                let length = self.lengths.entry(place_text(whole)).or_default();
                *length = at.saturating_add(1).max(*length);
            }
        }
        let condition = condition.map(|condition| {
            self.conditions.push(condition);
            u16::try_from(self.conditions.len() - 1).unwrap_or(u16::MAX)
        });
        self.cases.entry(place_text(path)).or_default().push(GapCase { condition, gap });
    }

    /// Fields of which nothing else is said hold what is told.
    pub fn or_told(&mut self, told: FieldValues) {
        for (place, gap) in told {
            if !self.is_taken(&place) {
                self.cases.entry(place).or_default().push(GapCase { condition: None, gap });
            }
        }
    }

    /// The text of the message around its values, and the conditions. The time in each header is that of the message,
    /// unless something else is said.
    pub fn template(self, shape: &MessageShape) -> (MessageTemplate<TypedExpr>, Vec<TypedExpr>) {
        let mut filling = FilledShape { shape, given: self, gaps: Vec::new() };
        let text = shape.text(&mut filling);
        (MessageTemplate { text, gaps: filling.gaps }, filling.given.conditions)
    }
}

/// A message whose fields at these places hold single values.
pub(super) fn template_of(shape: &MessageShape, values: FieldValues) -> MessageTemplate<TypedExpr> {
    let mut given = GivenFields::default();
    given.or_told(values);
    given.template(shape).0
}

/// `[`, the values, `]`
pub(super) fn row_of(gaps: Vec<MessageGap<TypedExpr>>) -> MessageTemplate<TypedExpr> {
    let mut text = vec!["[".to_owned()];
    text.extend((1..gaps.len()).map(|_| ",".to_owned()));
    match gaps.len() {
        0 => text = vec!["[]".to_owned()],
        _ => text.push("]".to_owned()),
    }
    MessageTemplate { text, gaps }
}

/// The gaps in a message, while its text is written.
struct FilledShape<'s> {
    shape: &'s MessageShape,
    given: GivenFields,
    gaps: Vec<MessageGap<TypedExpr>>,
}

impl MessageGaps for FilledShape<'_> {
    fn is_gap(&mut self, path: &[MessageStep]) -> bool {
        let place = place_text(path);
        let shape = self.shape.at(path);
        let in_header = place == "header.stamp" || place.ends_with(".header.stamp");
        let stamp = in_header && matches!(shape, Some(FieldShape::Scalar(..)));
        let mut cases = self.given.cases.remove(&place).unwrap_or_default();
        if cases.first().is_some_and(|case| case.condition.is_none()) {
            self.gaps.extend(cases.pop().map(|case| case.gap));
            return true;
        }
        if !cases.is_empty() {
            let otherwise = shape.map(FieldShape::default_text).unwrap_or_default();
            let value = GapValue::Chosen { cases, otherwise };
            self.gaps.push(MessageGap { value, scalar: MessageScalar::Text });
            return true;
        }
        if stamp {
            self.gaps.push(MessageGap { value: GapValue::Now, scalar: MessageScalar::Time });
        }
        stamp
    }

    fn length(&self, path: &[MessageStep]) -> u32 {
        self.given.lengths.get(&place_text(path)).copied().unwrap_or_default()
    }
}

impl<'a> BindingPhase<'_, 'a> {
    /// `FIELD = VALUE`, perhaps under a condition.
    pub(super) fn field_value(
        &mut self,
        place: BindingPlace,
        shape: &MessageShape,
        (field, value, condition): (&FieldSyntax, &ast::ExprSyntax, Option<TypedExpr>),
        given: &mut GivenFields,
    ) -> Option<()> {
        let path = self.place(shape, &steps_of_field(field))?;
        let text = place_text(&path);
        let span = written_span(field);
        if given.is_taken(&text) {
            let issue = names::duplicate(Noun::Field, &text, span, None);
            self.report(issue.help("give it one value"));
            return None;
        }
        self.within_sequences(shape, &path, span)?;
        let field = shape.at(&path)?;
        let gap = match field {
            FieldShape::Scalar(scalar, _) => {
                let value = self.gap_value(place, *scalar, value)?;
                MessageGap { value, scalar: *scalar }
            }
            FieldShape::Message(message) => self.message_value(place, (message, &text, span), value)?,
            FieldShape::Array(_) | FieldShape::Sequence { .. } => {
                self.row_value(place, (field, &text, span), value)?
            }
        };
        given.add(&path, gap, condition);
        Some(())
    }

    /// A message that is sent has not more elements than anybody can need.
    fn within_sequences(&mut self, shape: &MessageShape, path: &[MessageStep], span: Span) -> Option<()> {
        for (before, step) in path.iter().enumerate() {
            let of = path.get(..before).and_then(|of| shape.at(of));
            let is_sequence = matches!(of, Some(FieldShape::Sequence { .. }));
            if matches!(step, MessageStep::Element(at) if is_sequence && *at >= MOST_ELEMENTS) {
                let rule = format!("at most {}", MOST_ELEMENTS - 1);
                self.report(types::must_be("the index in a sequence that is sent", &rule, span));
                return None;
            }
        }
        Some(())
    }
}

/// From the field's first name to its last index.
fn written_span(field: &FieldSyntax) -> Span {
    let end =
        |element: &ast::ElementSyntax| element.names.last().map_or(element.index.span, |name| name.span);
    field.elements.last().map_or(field.path.span, |last| field.path.span.to(end(last)))
}
