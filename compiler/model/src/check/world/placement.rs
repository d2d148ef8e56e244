//! Places of bodies and parts that are said by others: on something, beside it, facing it.

use hrdsl_syntax::ast::{
    self, ExprSyntaxKind, PathSyntax, PlaceSide, PlaceSyntax, TurnSyntax, WorldMemberKind as Member,
};

use crate::check::world::{
    locate::{PlacedThing, PlacementSolver, PlacementSpec, ThingKind, ThingName},
    parts::{PlacedMember, compose},
};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    Dimension,
    noun::Noun,
    report::{types, world::bad_world},
    world::PartFrame,
};

/// Whether a place or a direction is said by something else.
fn is_relative(place: &PlaceSyntax, turn: Option<&TurnSyntax>) -> bool {
    place.on.is_some() || place.beside.is_some() || matches!(turn, Some(TurnSyntax::Facing(_)))
}

/// The place that is said outright.
pub(super) fn outright(place: &PlaceSyntax) -> Option<&ast::ExprSyntax> {
    place.at.as_ref().filter(|_| place.on.is_none())
}

/// The angles that are said outright.
pub(super) fn angles(turn: Option<&TurnSyntax>) -> Option<&ast::ExprSyntax> {
    match turn {
        Some(TurnSyntax::Rotated(angles)) => Some(angles),
        Some(TurnSyntax::Facing(_)) | None => None,
    }
}

fn place_of(member: &Member) -> Option<(&ast::NameSyntax, &PlaceSyntax, Option<&TurnSyntax>)> {
    if let Member::Body(body) = member {
        Some((&body.name, &body.place, body.turn.as_ref()))
    } else if let Member::Part { name, place, turn, .. } = member {
        Some((name, place, turn.as_ref()))
    } else {
        None
    }
}

impl<'a> WorldPhase<'_, 'a> {
    /// Brings to its place what is placed by something else, with all that is in it.
    pub(super) fn place_by_others(&mut self, placed: &mut [PlacedMember<'a>]) {
        let relative =
            |p: &PlacedMember<'_>| place_of(&p.member.kind).is_some_and(|(_, p, t)| is_relative(p, t));
        if !placed.iter().any(relative) {
            return;
        }
        let mut things: Vec<PlacedThing> = Vec::new();
        for p in placed.iter() {
            let Some((name, place, turn)) = place_of(&p.member.kind) else { continue };
            let outer = std::mem::replace(&mut self.templates.given, p.given.clone());
            let before = self.issues.list.len();
            let spec = self.placement(place, turn, &p.prefix);
            self.templates.given = outer;
            if let Some((name, span)) = &p.instance {
                self.said_in(before, Some((name, *span)));
            }
            things.extend(self.thing(name, spec, p));
        }
        let world = self.world_mut();
        let mut solver = PlacementSolver::new(&world.bodies, things);
        solver.solve();
        let (things, issues) = solver.into_parts();
        self.issues.list.extend(issues);
        self.put(&things, placed);
    }

    /// What is placed, with what is known of its pose.
    fn thing(
        &self,
        name: &ast::NameSyntax,
        spec: Option<PlacementSpec>,
        p: &PlacedMember<'a>,
    ) -> Option<PlacedThing> {
        let full = format!("{}{}", p.prefix, name.text);
        let world = self.s.world.as_ref()?;
        let (kind, at, rotation) = if matches!(p.member.kind, Member::Body(_)) {
            let id = usize::from(self.world.names.bodies.get(&full)?);
            let body = world.bodies.get(id).filter(|b| b.span == p.member.span)?;
            (ThingKind::Body(id), body.position, body.rotation)
        } else {
            let id = world.parts.iter().position(|part| part.name == full && part.span == p.member.span)?;
            let inner = world.parts[id].inner;
            (ThingKind::Part(id), inner.at, [0.0, 0.0, inner.yaw])
        };
        Some(PlacedThing::new(
            ThingName { full, span: name.span },
            p.prefix.clone(),
            kind,
            (at, rotation),
            spec,
        ))
    }

    /// What is said of a place; `None`: part of it makes no sense.
    fn placement(
        &mut self,
        place: &PlaceSyntax,
        turn: Option<&TurnSyntax>,
        prefix: &str,
    ) -> Option<PlacementSpec> {
        let on = place.on.as_ref().map(|path| self.landmark(path, prefix));
        let offset = place.at.as_ref().filter(|_| place.on.is_some()).map(|at| self.on_the_top(at));
        let beside = place.beside.as_ref().map(|beside| {
            let of = self.landmark(&beside.of, prefix);
            let by = self.quantity_of(&beside.by, Dimension::LENGTH);
            if by.is_some_and(|by| by < 0.0) {
                self.report(types::must_be("the distance", "at least 0 m", beside.by.span));
            }
            Some((side_direction(beside.side), of?, by.filter(|by| *by >= 0.0)?))
        });
        let facing = match turn {
            Some(TurnSyntax::Facing(path)) => Some(self.landmark(path, prefix)),
            Some(TurnSyntax::Rotated(_)) | None => None,
        };
        Some(PlacementSpec {
            on: on.map_or(Some(None), |on| on.map(Some))?,
            offset: offset.map_or(Some(None), |at| at.map(Some))?,
            beside: beside.map_or(Some(None), |beside| beside.map(Some))?,
            facing: facing.map_or(Some(None), |facing| facing.map(Some))?,
        })
    }

    /// The body or the part by which something is placed.
    fn landmark(&mut self, path: &PathSyntax, prefix: &str) -> Option<ThingName> {
        let full = self.full_name(&path.names, prefix)?;
        let (first, last) = (path.names.first()?, path.names.last()?);
        let span = first.span.to(last.span);
        let names = &self.world.names;
        if !names.is_instance(&full) && names.bodies.get(&full).is_none() {
            self.world_name(Noun::Body, &path.names, prefix);
            return None;
        }
        self.refer_in_world(Noun::Body, &path.names, &full);
        if !full.starts_with(prefix) {
            let message = format!("`{full}` is outside of the part that is placed by it");
            self.report(bad_world(span, message, "place the part itself by it, in the world"));
            return None;
        }
        Some(ThingName { full, span })
    }

    /// `(10 cm, -20 cm)`
    fn on_the_top(&mut self, at: &ast::ExprSyntax) -> Option<[f64; 2]> {
        if let ExprSyntaxKind::Tuple(parts) = &at.kind
            && let [x, y] = parts.as_slice()
        {
            let x = self.quantity_of(x, Dimension::LENGTH);
            return Some([x?, self.quantity_of(y, Dimension::LENGTH)?]);
        }
        if at.kind != ExprSyntaxKind::Error {
            let help = "write two lengths: `(0 m, 0 m)` is its middle, x is ahead, y to the left";
            self.report(bad_world(at.span, "a place on top of something is said by two lengths", help));
        }
        None
    }

    /// Where everything has come to is where it is.
    fn put(&mut self, things: &[PlacedThing], placed: &mut [PlacedMember<'a>]) {
        let world = self.world_mut();
        for thing in things {
            let (at, rotation) = thing.pose();
            match thing.kind() {
                ThingKind::Body(id) => {
                    let body = &mut world.bodies[id];
                    (body.position, body.rotation) = (at, rotation);
                }
                ThingKind::Part(id) => world.parts[id].inner = PartFrame { at, yaw: rotation[2] },
            }
        }
        let mut frames: std::collections::BTreeMap<String, PartFrame> = std::collections::BTreeMap::new();
        frames.insert(String::new(), PartFrame::default());
        let frame = |frames: &std::collections::BTreeMap<String, PartFrame>, name: &str| {
            let outer = name.rsplit_once('.').map_or("", |(outer, _)| outer);
            frames.get(outer).copied().unwrap_or_default()
        };
        // A part comes before what is in it.
        for part in &mut world.parts {
            part.frame = compose(frame(&frames, &part.name), part.inner);
            frames.insert(part.name.clone(), part.frame);
        }
        for body in &mut world.bodies {
            body.frame = frame(&frames, &body.name);
        }
        for p in placed {
            p.frame = frames.get(p.prefix.trim_end_matches('.')).copied().unwrap_or_default();
        }
    }
}

/// As it is seen by what has the side: x is ahead, y to the left.
fn side_direction(side: PlaceSide) -> [f64; 2] {
    match side {
        PlaceSide::Left => [0.0, 1.0],
        PlaceSide::Right => [0.0, -1.0],
        PlaceSide::Ahead => [1.0, 0.0],
        PlaceSide::Behind => [-1.0, 0.0],
    }
}
