//! Places in a message: the fields and elements that are named, be it where they get values or where rules read them.

use hrdsl_ir::binding::{MessageStep, place_text};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax, FieldSyntax, NameSyntax, PathSyntax};

use super::{
    rules::MessageEnv,
    shape::{FieldShape, MessageShape},
};
use crate::check::state::scope::ExprEnv;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    InferredType, Value,
    report::{bindings, types},
};

/// The function that says how long a sequence is.
const LENGTH: &str = "length";

/// A step to a place, as it is written.
pub(super) enum WrittenStep<'e> {
    Field(&'e NameSyntax),
    Element(&'e ast::ExprSyntax),
}

/// `people[0].position.x` where it gets a value.
pub(super) fn steps_of_field(field: &FieldSyntax) -> Vec<WrittenStep<'_>> {
    let mut steps: Vec<WrittenStep<'_>> = field.path.names.iter().map(WrittenStep::Field).collect();
    for element in &field.elements {
        steps.push(WrittenStep::Element(&element.index));
        steps.extend(element.names.iter().map(WrittenStep::Field));
    }
    steps
}

/// The same in an expression; `None`: it is no place.
pub(super) fn steps_of(e: &ast::ExprSyntax) -> Option<Vec<WrittenStep<'_>>> {
    if let Syntax::Path(path) = &e.kind {
        return Some(path.names.iter().map(WrittenStep::Field).collect());
    }
    let (of, step) = if let Syntax::Index { of, index } = &e.kind {
        (of, WrittenStep::Element(index))
    } else if let Syntax::Field { of, name } = &e.kind {
        (of, WrittenStep::Field(name))
    } else {
        return None;
    };
    let mut steps = steps_of(of)?;
    steps.push(step);
    Some(steps)
}

/// The fields of what lies at a place.
pub(super) fn names_at(shape: &MessageShape, path: &[MessageStep]) -> Vec<String> {
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

impl BindingPhase<'_, '_> {
    /// The place, if it is one of the message; says where the way leaves it.
    pub(super) fn place(
        &mut self,
        shape: &MessageShape,
        steps: &[WrittenStep<'_>],
    ) -> Option<Vec<MessageStep>> {
        let mut path = Vec::new();
        for step in steps {
            match step {
                WrittenStep::Field(name) => {
                    path.push(MessageStep::Field(name.text.clone()));
                    if shape.at(&path).is_none() {
                        path.pop();
                        self.no_such_field(shape, &path, name);
                        return None;
                    }
                }
                WrittenStep::Element(index) => {
                    let at = self.element_index(shape, &path, index)?;
                    path.push(MessageStep::Element(at));
                }
            }
        }
        Some(path)
    }

    fn no_such_field(&mut self, shape: &MessageShape, path: &[MessageStep], name: &NameSyntax) {
        let of = place_text(path);
        let known = names_at(shape, path);
        let issue = bindings::unknown_field(&name.text, &of, name.span, known.iter().map(String::as_str));
        let has_elements = shape.at(path).is_some_and(|at| at.last_index().is_some());
        self.report(if has_elements {
            issue.help(format!("name an element, counted from 0: `{of}[0].{}`", name.text))
        } else {
            issue
        });
    }

    /// Which element is meant; says so if the array cannot have it.
    fn element_index(
        &mut self,
        shape: &MessageShape,
        path: &[MessageStep],
        index: &ast::ExprSyntax,
    ) -> Option<u32> {
        let Some(last) = shape.at(path).and_then(FieldShape::last_index) else {
            let message = format!("`{}` has no elements", place_text(path));
            self.report(types::no_elements(message, index.span));
            return None;
        };
        let at = self.expr_of(index, InferredType::Int, &mut ExprEnv::constants());
        let Value::Int(n) = at.constant()? else { return None };
        if !(0..=last).contains(&n) {
            self.report(types::bad_index(&at, last));
            return None;
        }
        u32::try_from(n).ok()
    }

    /// The expression with all places of the message in it as names of what rules read: `ranges[3]` becomes one name, and so does
    /// `length(ranges)`. `None`: one of them is no place of the message, which is said.
    pub(super) fn placed(
        &mut self,
        e: &ast::ExprSyntax,
        env: &mut MessageEnv<'_>,
    ) -> Option<ast::ExprSyntax> {
        let mut part = |e: &ast::ExprSyntax| self.placed(e, env);
        let boxed = |e: ast::ExprSyntax| Box::new(e);
        let kind = match &e.kind {
            Syntax::Path(_) | Syntax::Index { .. } | Syntax::Field { .. } => {
                return self.read_place(e, env);
            }
            Syntax::Call { callee, args } => {
                if let ([name], [of]) = (callee.names.as_slice(), args.as_slice())
                    && name.text == LENGTH
                {
                    return self.read_length(of, e.span, env);
                }
                let args = args.iter().map(part).collect::<Option<_>>()?;
                Syntax::Call { callee: callee.clone(), args }
            }
            Syntax::Unary { op, operand } => Syntax::Unary { op: *op, operand: boxed(part(operand)?) },
            Syntax::Binary { op, left, right } => {
                let (left, right) = (part(left), part(right));
                Syntax::Binary { op: *op, left: boxed(left?), right: boxed(right?) }
            }
            Syntax::If { condition, then, otherwise } => Syntax::If {
                condition: boxed(part(condition)?),
                then: boxed(part(then)?),
                otherwise: boxed(part(otherwise)?),
            },
            Syntax::Tuple(parts) => Syntax::Tuple(parts.iter().map(part).collect::<Option<_>>()?),
            Syntax::Bool(_) | Syntax::Int(_) | Syntax::Float(_) | Syntax::Text(_) => return Some(e.clone()),
            Syntax::Quantity { .. } | Syntax::Any | Syntax::Internal(_) => return Some(e.clone()),
            Syntax::List { .. } | Syntax::Strong(_) | Syntax::Annotated { .. } => return Some(e.clone()),
            Syntax::Unify { .. } | Syntax::Error => return Some(e.clone()),
        };
        Some(ast::ExprSyntax { kind, span: e.span })
    }

    /// Several expressions; `None`: something is wrong with one.
    pub(super) fn all_placed(
        &mut self,
        all: &[ast::ExprSyntax],
        env: &mut MessageEnv<'_>,
    ) -> Option<Vec<ast::ExprSyntax>> {
        let placed: Vec<Option<ast::ExprSyntax>> = all.iter().map(|e| self.placed(e, env)).collect();
        placed.into_iter().collect()
    }

    fn read_place(&mut self, e: &ast::ExprSyntax, env: &mut MessageEnv<'_>) -> Option<ast::ExprSyntax> {
        let Some(steps) = steps_of(e) else { return Some(e.clone()) };
        if !env.begins_in(&steps) {
            return Some(e.clone());
        }
        let path = self.place(env.shape, &steps)?;
        match env.shape.at(&path)? {
            FieldShape::Scalar(scalar, _) => {
                let Some(name) = env.read(path.clone(), *scalar) else {
                    self.report(bindings::unread_time(&place_text(&path), e.span));
                    return None;
                };
                Some(named(&name, e.span))
            }
            FieldShape::Message(_) => {
                let parts = names_at(env.shape, &path);
                self.report(bindings::several_values(&place_text(&path), &parts, e.span));
                None
            }
            FieldShape::Array(_) | FieldShape::Sequence { .. } => {
                self.report(bindings::unread_sequence(&place_text(&path), e.span));
                None
            }
        }
    }

    /// `length(ranges)`
    fn read_length(
        &mut self,
        of: &ast::ExprSyntax,
        span: Span,
        env: &mut MessageEnv<'_>,
    ) -> Option<ast::ExprSyntax> {
        let steps = steps_of(of).filter(|steps| env.begins_in(steps));
        let Some(steps) = steps else {
            self.report(bindings::no_sequence(of.span));
            return None;
        };
        let path = self.place(env.shape, &steps)?;
        if env.shape.at(&path).and_then(FieldShape::last_index).is_none() {
            self.report(bindings::no_sequence(of.span));
            return None;
        }
        Some(named(&env.read_length(path), span))
    }
}

/// A name, whatever is in it.
fn named(text: &str, span: Span) -> ast::ExprSyntax {
    let names = vec![NameSyntax { text: text.to_owned(), span }];
    ast::ExprSyntax { kind: Syntax::Path(PathSyntax { names, span }), span }
}
