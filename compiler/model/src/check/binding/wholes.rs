//! Fields that hold several values, and get all of them at once: rows, and messages in the message.

use hrdsl_ir::{
    binding::{GapRead, GapValue, MessageGap, MessageScalar},
    world::QuaternionPart,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax};

use super::{
    fields::{FieldValues, MOST_ELEMENTS, row_of, template_of},
    scope::BindingPlace,
    shape::{FieldShape, MessageShape},
};
use crate::check::state::item::ExprItem;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::noun::Noun;
use crate::{
    Axis, BodyRef, Dimension, InferredType, SignalTerm, TypedExpr, TypedExprKind,
    report::{bindings, types},
};

/// Several values, as they are given.
enum GivenParts<'e> {
    /// `[a, b]`, `(x, y, z)`
    Written(&'e [ast::ExprSyntax]),
    /// A name or an expression of several parts.
    Worked(Vec<TypedExpr>, Vec<GapRead>),
}

impl GivenParts<'_> {
    fn count(&self) -> usize {
        match self {
            GivenParts::Written(parts) => parts.len(),
            GivenParts::Worked(parts, _) => parts.len(),
        }
    }
}

/// What a message of geometry says of a body.
enum BodyAspect {
    Place,
    Orientation,
    /// The fields of its place and of its orientation.
    Both(&'static str, &'static str),
    /// On the ground.
    Planar,
}

/// What a body's name stands for in a message.
fn aspect(message: &MessageShape) -> Option<BodyAspect> {
    let interface = message.interface.as_ref().filter(|name| name.package == "geometry_msgs")?;
    match interface.name.as_str() {
        "Point" | "Point32" | "Vector3" => Some(BodyAspect::Place),
        "Quaternion" => Some(BodyAspect::Orientation),
        "Pose" => Some(BodyAspect::Both("position", "orientation")),
        "Transform" => Some(BodyAspect::Both("translation", "rotation")),
        "Pose2D" => Some(BodyAspect::Planar),
        _ => None,
    }
}

impl<'a> BindingPhase<'_, 'a> {
    /// What the elements of an array or a sequence hold: `[a, b]`, `(x, y, z)`, or a constant of several parts.
    pub(super) fn row_value(
        &mut self,
        place: BindingPlace,
        (whole, text, span): (&FieldShape, &str, Span),
        value: &ast::ExprSyntax,
    ) -> Option<MessageGap<TypedExpr>> {
        let Some(parts) = self.given_parts(value)? else {
            self.report(bindings::not_one_value(text, span));
            return None;
        };
        self.fitting_count(whole, parts.count(), value.span)?;
        let element = match whole {
            FieldShape::Array(elements) => elements.first(),
            FieldShape::Sequence { of, .. } => Some(&**of),
            FieldShape::Scalar(..) | FieldShape::Message(_) => None,
        };
        let scalar = match element {
            Some(FieldShape::Scalar(scalar, _)) => *scalar,
            Some(FieldShape::Message(message)) => {
                let parts: Vec<String> = message.fields.iter().map(|(name, _)| name.clone()).collect();
                self.report(bindings::several_values(&format!("{text}[0]"), &parts, span));
                return None;
            }
            Some(FieldShape::Array(_) | FieldShape::Sequence { .. }) | None => return None,
        };
        let scalars = vec![scalar; parts.count()];
        let gaps = self.gaps_of(place, parts, &scalars)?;
        Some(whole_gap(GapValue::Whole(row_of(gaps))))
    }

    /// What a message in the message holds: where a body is, a heading, or a value for each field.
    pub(super) fn message_value(
        &mut self,
        place: BindingPlace,
        (message, text, span): (&MessageShape, &str, Span),
        value: &ast::ExprSyntax,
    ) -> Option<MessageGap<TypedExpr>> {
        let aspect = aspect(message);
        if let (Some(aspect), Some(body)) = (&aspect, self.body_meant(value)) {
            let values = body_values(aspect, body, value.span);
            return Some(whole_gap(GapValue::Whole(template_of(message, values))));
        }
        match (&aspect, &value.kind) {
            (Some(BodyAspect::Both(..) | BodyAspect::Planar), Syntax::Path(path)) => {
                self.body_ref(&path.names, "")?;
            }
            (Some(BodyAspect::Orientation), kind) if !matches!(kind, Syntax::Tuple(_)) => {
                let value = self.gap_value(place, MessageScalar::Heading, value)?;
                return Some(MessageGap { value, scalar: MessageScalar::Heading });
            }
            (Some(_) | None, _) => {}
        }
        let names: Vec<String> = message.fields.iter().map(|(name, _)| name.clone()).collect();
        let scalar = |(_, shape): &(String, FieldShape)| match shape {
            FieldShape::Scalar(scalar, _) => Some(*scalar),
            FieldShape::Message(_) | FieldShape::Array(_) | FieldShape::Sequence { .. } => None,
        };
        let scalars: Option<Vec<MessageScalar>> = message.fields.iter().map(scalar).collect();
        let parts = match &scalars {
            Some(_) => self.given_parts(value)?,
            None => None,
        };
        let (Some(scalars), Some(parts)) = (scalars, parts) else {
            self.report(bindings::no_whole(text, &names, aspect.is_some(), span));
            return None;
        };
        if parts.count() != scalars.len() {
            let want = format!("a value for each of its {} fields", scalars.len());
            self.report(types::other_shape(&want, &format!("a row of {}", parts.count()), value.span));
            return None;
        }
        let gaps = self.gaps_of(place, parts, &scalars)?;
        let values = names.into_iter().zip(gaps).collect();
        Some(whole_gap(GapValue::Whole(template_of(message, values))))
    }

    /// `None`: something is wrong with it, which is said. `Some(None)`: it is one value.
    #[expect(clippy::option_option, reason = "the outer one is a fault that has been said")]
    fn given_parts<'e>(&mut self, value: &'e ast::ExprSyntax) -> Option<Option<GivenParts<'e>>> {
        if let Syntax::List { items, rest: None } | Syntax::Tuple(items) = &value.kind {
            return Some(Some(GivenParts::Written(items)));
        }
        let (mut env, reads) = self.heard_arguments(self.actor);
        let item = self.item(value, &mut env);
        if item.is_unknown() {
            return None;
        }
        match item {
            ExprItem::One(_) | ExprItem::Record(..) => Some(None),
            ExprItem::Array(..) | ExprItem::Tuple(..) => {
                let mut parts = Vec::new();
                item.flatten(&mut parts);
                Some(Some(GivenParts::Worked(parts, reads)))
            }
        }
    }

    /// A value for each part, of its kind.
    fn gaps_of(
        &mut self,
        place: BindingPlace,
        parts: GivenParts<'_>,
        scalars: &[MessageScalar],
    ) -> Option<Vec<MessageGap<TypedExpr>>> {
        let gaps: Vec<Option<MessageGap<TypedExpr>>> = match parts {
            GivenParts::Written(items) => {
                let gap = |(item, scalar): (&ast::ExprSyntax, &MessageScalar)| {
                    let value = self.gap_value(place, *scalar, item)?;
                    Some(MessageGap { value, scalar: *scalar })
                };
                items.iter().zip(scalars).map(gap).collect()
            }
            GivenParts::Worked(values, reads) => {
                let gap = |(value, scalar): (TypedExpr, &MessageScalar)| {
                    let value = self.read_value(value, *scalar, &reads)?;
                    Some(MessageGap { value, scalar: *scalar })
                };
                values.into_iter().zip(scalars).map(gap).collect()
            }
        };
        gaps.into_iter().collect()
    }

    /// Says so if an array cannot have so many elements.
    fn fitting_count(&mut self, whole: &FieldShape, count: usize, span: Span) -> Option<()> {
        let most = whole.last_index().map_or(0, |last| last + 1).min(i64::from(MOST_ELEMENTS));
        let exact = matches!(whole, FieldShape::Array(_));
        let count = i64::try_from(count).unwrap_or(i64::MAX);
        if count == most || (!exact && count < most) {
            return Some(());
        }
        let want = if exact { format!("a row of {most}") } else { format!("a row of at most {most}") };
        self.report(types::other_shape(&want, &format!("one of {count}"), span));
        None
    }

    /// The body that a value names, or that the base drives which it names.
    fn body_meant(&mut self, value: &ast::ExprSyntax) -> Option<BodyRef> {
        let Syntax::Path(path) = &value.kind else { return None };
        let full = self.full_name(&path.names, "")?;
        let base = self.world.names.bases.get(&full);
        let driven = base.and_then(|id| self.s.world.as_ref()?.bases.get(usize::from(id)));
        let body =
            driven.map(|base| BodyRef::Body(base.body)).or_else(|| self.world.names.body_ref(&full))?;
        self.refer_in_world(Noun::Body, &path.names, &full);
        Some(body)
    }
}

/// What a message says of a body, by its fields.
fn body_values(aspect: &BodyAspect, body: BodyRef, span: Span) -> FieldValues {
    let mut values = FieldValues::new();
    let mut add = |field: String, term: SignalTerm, dim: Dimension| {
        let value = TypedExpr { kind: TypedExprKind::Term(term), ty: InferredType::Float(dim), span };
        let value = GapValue::Value { value, reads: Vec::new() };
        values.insert(field, MessageGap { value, scalar: MessageScalar::Float });
    };
    let axes = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];
    let (place, turn) = match aspect {
        BodyAspect::Place => (Some(String::new()), None),
        BodyAspect::Orientation => (None, Some(String::new())),
        BodyAspect::Both(place, turn) => (Some(format!("{place}.")), Some(format!("{turn}."))),
        BodyAspect::Planar => {
            for (name, axis) in axes.into_iter().take(2) {
                add(name.to_owned(), SignalTerm::Coordinate(body, axis), Dimension::LENGTH);
            }
            add("theta".to_owned(), SignalTerm::Heading(body), Dimension::ANGLE);
            (None, None)
        }
    };
    if let Some(before) = place {
        for (name, axis) in axes {
            add(format!("{before}{name}"), SignalTerm::Coordinate(body, axis), Dimension::LENGTH);
        }
    }
    if let Some(before) = turn {
        for part in QuaternionPart::ALL {
            let field = format!("{before}{}", part.name());
            add(field, SignalTerm::Orientation(body, part), Dimension::NUMBER);
        }
    }
    values
}

/// What stands where several values do.
fn whole_gap(value: GapValue<TypedExpr>) -> MessageGap<TypedExpr> {
    MessageGap { value, scalar: MessageScalar::Text }
}
