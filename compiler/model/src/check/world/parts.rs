//! Names of the world, and the instantiation of parts.

use std::rc::Rc;

use hrdsl_source::{Diagnostic, Span};
use hrdsl_syntax::ast::{self, NameSyntax, WorldMember, WorldMemberKind as Member};

use crate::check::{
    state::{issues::too_many, item::ExprItem, scope::ExprEnv, template::TemplateArguments},
    world::placement::{angles, outright},
};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    Dimension, InferredType,
    noun::Noun,
    report::{types, world::bad_world},
    world::{PartFrame, PartInstance},
};

/// The most members of the world, those of its parts included each time that they are used.
const MAX_MEMBERS: usize = 100_000;

/// How deep parts can be in parts.
const MAX_DEPTH: usize = 16;

/// A member of the world, or of a part of it.
#[derive(Clone)]
pub(crate) struct PlacedMember<'a> {
    /// `robot.`, or empty
    pub prefix: String,
    pub frame: PartFrame,
    pub member: &'a WorldMember,
    /// What the parameters of its part stand for.
    pub given: Option<Rc<TemplateArguments>>,
    /// The part of the world that gives them.
    pub instance: Option<(NameSyntax, Span)>,
}

impl<'a> PlacedMember<'a> {
    /// As it stands in the text.
    pub fn alone(member: &'a WorldMember) -> Self {
        Self { prefix: String::new(), frame: PartFrame::default(), member, given: None, instance: None }
    }
}

impl<'a> WorldPhase<'_, 'a> {
    /// The world's members and those of its parts, in source order, parts in place of their use.
    pub(in crate::check) fn flatten(
        &mut self,
        members: &'a [WorldMember],
        prefix: &str,
        frame: PartFrame,
        instance: Option<(NameSyntax, Span)>,
    ) -> Vec<PlacedMember<'a>> {
        let mut all = Vec::new();
        for member in members {
            self.world.names.members += 1;
            if self.world.names.members > MAX_MEMBERS {
                if self.world.names.members == MAX_MEMBERS + 1 {
                    let message =
                        format!("the world has more than {MAX_MEMBERS} members, with those of its parts");
                    self.report(too_many(message, member.span));
                }
                return all;
            }
            if matches!(member.kind, Member::Allow(_)) {
                continue;
            }
            let (given, instance) = (self.templates.given.clone(), instance.clone());
            all.push(PlacedMember { prefix: prefix.to_owned(), frame, member, given, instance });
            all.extend(self.flatten_part(member, prefix, frame));
        }
        all
    }

    /// The members of a part that another, or the world, has.
    fn flatten_part(
        &mut self,
        member: &'a WorldMember,
        prefix: &str,
        frame: PartFrame,
    ) -> Vec<PlacedMember<'a>> {
        let Member::Part { name, of, args, place, turn } = &member.kind else { return Vec::new() };
        let inner = self.frame(outright(place), angles(turn.as_ref()));
        let full = format!("{prefix}{}", name.text);
        let instances = &mut self.checker.world.names.instances;
        let noun = Noun::PartInstance;
        let new = self.checker.issues.declare_as(instances, noun, &full, name.span).is_some();
        let Some(part) = self.part(of) else {
            self.world.names.broken.insert(full);
            return Vec::new();
        };
        let Ok(given) = self.given_part(part, of, args.as_deref(), prefix) else {
            self.world.names.broken.insert(full);
            return Vec::new();
        };
        if !new {
            return Vec::new();
        }
        let frame = compose(frame, inner);
        let placed = PartInstance { name: full.clone(), frame, inner, span: member.span };
        self.world_mut().parts.push(placed);
        let end = args.iter().flatten().last().map_or(of.span, |a| a.span);
        let here = NameSyntax { text: full.clone(), span: name.span };
        let instance = given.is_some().then(|| (here, name.span.to(end)));
        let outer = std::mem::replace(&mut self.templates.given, given);
        let (before, prefix) = (self.issues.list.len(), format!("{full}."));
        self.open_parts.push(&part.name.text);
        let mut inner = self.flatten(&part.members, &prefix, frame, instance.clone());
        if let Some(member) = part.description.as_deref() {
            let (given, instance) = (self.templates.given.clone(), instance.clone());
            inner.insert(0, PlacedMember { prefix, frame, member, given, instance });
        }
        self.open_parts.pop();
        self.templates.given = outer;
        if let Some((name, span)) = &instance {
            self.said_in(before, Some((name, *span)));
        }
        inner
    }

    /// What the arguments give for a part's parameters.
    fn given_part(
        &mut self,
        part: &ast::PartSyntax,
        of: &NameSyntax,
        args: Option<&[ast::ExprSyntax]>,
        prefix: &str,
    ) -> Result<Option<Rc<TemplateArguments>>, ()> {
        match (&part.params, args) {
            (None, None) => Ok(None),
            (params, args) => {
                let (params, args) = (params.as_deref().unwrap_or_default(), args.unwrap_or_default());
                let span = of.span.to(args.last().map_or(of.span, |a| a.span));
                // What is named in the world may not be there yet.
                self.bind(&part.name, params, args, span, &ExprEnv::measured(prefix), false)
                    .map(Some)
                    .ok_or(())
            }
        }
    }

    fn part(&mut self, of: &NameSyntax) -> Option<&'a ast::PartSyntax> {
        let Some((part, _)) = self.parts.get(of.text.as_str()) else {
            let names = self.near_of(&[Noun::Part]);
            if self.source.unread_items || self.source.missing_modules {
                return None;
            }
            // A part often has the name of an actor or of its instance, which would say nothing.
            let said = self.issues.list.len();
            self.unknown(Noun::Part, of, &names, Some(Noun::Part));
            if let Some(issue) = self.checker.issues.list.get_mut(said) {
                crate::report::world::missing_part(issue, &of.text, self.parts.is_empty());
            }
            return None;
        };
        // A part in itself would be doubled at each level if it is there twice.
        if self.open_parts.contains(&of.text.as_str()) {
            let message = format!("the part `{}` contains itself", of.text);
            self.report(bad_world(of.span, message, "remove it from its own members"));
            return None;
        }
        if self.open_parts.len() >= MAX_DEPTH {
            let message = format!("parts are in parts more than {MAX_DEPTH} levels deep");
            self.report(bad_world(of.span, message, "put the parts side by side in the world"));
            return None;
        }
        let part = *part;
        self.refer(of, Some(part.name.span));
        Some(part)
    }

    /// `at (…) rotated (0 deg, 0 deg, 90 deg)`
    fn frame(&mut self, at: Option<&ast::ExprSyntax>, rotated: Option<&ast::ExprSyntax>) -> PartFrame {
        let position = at.and_then(|at| self.vector(at, InferredType::Float(Dimension::LENGTH)));
        let position = position.unwrap_or_default();
        let angles =
            rotated.and_then(|r| self.vector(r, InferredType::Float(Dimension::ANGLE))).unwrap_or_default();
        if let (Some(rotated), true) = (rotated, angles[0] != 0.0 || angles[1] != 0.0) {
            self.report(bad_world(
                rotated.span,
                "a part can only be turned about the vertical",
                "write `rotated (0 deg, 0 deg, …)`",
            ));
        }
        PartFrame { at: position, yaw: angles[2] }
    }

    /// Three constants of one kind.
    pub(in crate::check) fn vector(&mut self, e: &ast::ExprSyntax, want: InferredType) -> Option<[f64; 3]> {
        if let ast::ExprSyntaxKind::Tuple(parts) = &e.kind
            && parts.len() == 3
        {
            let mut vector = [0.0; 3];
            for (slot, part) in vector.iter_mut().zip(parts) {
                *slot = self.constant(part, want, &mut ExprEnv::constants())?.as_f64()?;
            }
            return Some(vector);
        }
        let mut values = Vec::new();
        let known = self.issues.list.len();
        let item = self.item(e, &mut ExprEnv::constants());
        let whole = matches!(item, ExprItem::Array(..) | ExprItem::Tuple(..));
        item.flatten(&mut values);
        if !whole || values.len() != 3 {
            if self.issues.list.len() == known && e.kind != ast::ExprSyntaxKind::Error {
                self.report(not_a_vector(want, e.span));
            }
            return None;
        }
        let mut vector = [0.0; 3];
        for (slot, value) in vector.iter_mut().zip(values) {
            let value = self.fit(value, want, &mut ExprEnv::constants());
            if value.constant().is_none() && value.ty != InferredType::Unknown {
                self.report(types::not_constant(value.span));
            }
            *slot = value.constant()?.as_f64()?;
        }
        Some(vector)
    }
}

fn not_a_vector(want: InferredType, span: Span) -> Diagnostic {
    let unit = want.dim().and_then(Dimension::symbol).unwrap_or_default();
    let zero = format!("0 {unit}");
    let zero = zero.trim();
    types::no_value("this", span).help(format!("three numbers are needed: `({zero}, {zero}, {zero})`"))
}

/// The frame of `inner`, which is given in the coordinates of `outer`, in the world.
pub(super) fn compose(outer: PartFrame, inner: PartFrame) -> PartFrame {
    PartFrame { at: outer.place(inner.at), yaw: outer.yaw + inner.yaw }
}
