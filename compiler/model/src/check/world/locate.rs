//! From what is said of places to where everything is: each thing after those by which it is placed.

use std::collections::BTreeMap;

use hrdsl_source::{Diagnostic, Span};

use super::extent::{LevelTop, PlacedShape, TurnMatrix, turned};
use super::parts::compose;
use crate::{
    report::world::bad_world,
    world::{PartFrame, TypedBody, sin_cos},
};

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

/// What is placed beside one thing and faces another comes to its place step by step; this many are far more than it takes.
const ROUNDS: usize = 64;

/// A full name, and where it was written.
#[derive(Clone)]
pub(super) struct ThingName {
    pub full: String,
    pub span: Span,
}

/// What is said of a place.
#[derive(Clone, Default)]
pub(super) struct PlacementSpec {
    pub on: Option<ThingName>,
    /// From the middle of the top, in the frame of what has it.
    pub offset: Option<[f64; 2]>,
    /// In which direction of what, and how far from surface to surface.
    pub beside: Option<([f64; 2], ThingName, f64)>,
    pub facing: Option<ThingName>,
}

#[derive(Clone, Copy)]
pub(super) enum ThingKind {
    /// Index into the world's bodies.
    Body(usize),
    /// Index into the world's parts.
    Part(usize),
}

/// A place and angles, in the coordinates of the part that the thing is in.
type ThingPose = ([f64; 3], [f64; 3]);

/// A body or a part of the world on its way to its place.
pub(super) struct PlacedThing {
    name: ThingName,
    /// `shelf.`, or empty: the part that it is in.
    scope: String,
    kind: ThingKind,
    pose: ThingPose,
    spec: Option<PlacementSpec>,
    state: LocateState,
}

#[derive(Clone, Copy, PartialEq)]
enum LocateState {
    New,
    /// What it is placed by is being looked for.
    Open,
    Done,
    Failed,
}

impl PlacedThing {
    pub fn new(
        name: ThingName,
        scope: String,
        kind: ThingKind,
        pose: ThingPose,
        spec: Option<PlacementSpec>,
    ) -> Self {
        Self { name, scope, kind, pose, spec, state: LocateState::New }
    }

    pub fn kind(&self) -> ThingKind {
        self.kind
    }

    pub fn pose(&self) -> ThingPose {
        self.pose
    }
}

/// Something by which another thing is placed, in that thing's coordinates.
struct KnownLandmark {
    at: [f64; 3],
    /// Where its x axis points on the ground.
    heading: f64,
    shapes: Vec<PlacedShape>,
}

impl KnownLandmark {
    fn reach(&self, direction: [f64; 3]) -> f64 {
        reach(&self.shapes, direction)
    }

    /// The world's direction of one of its own, on the ground.
    fn turn(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        PartFrame { at: [0.0; 3], yaw: self.heading }.turn([x, y, 0.0])
    }

    /// The highest of its tops.
    fn top(&self) -> Option<LevelTop> {
        let highest = self.reach(UP);
        let is_highest = |shape: &&PlacedShape| shape.reach(UP) > highest - 1e-9;
        self.shapes.iter().filter(is_highest).find_map(PlacedShape::top)
    }
}

fn reach(shapes: &[PlacedShape], direction: [f64; 3]) -> f64 {
    shapes.iter().map(|shape| shape.reach(direction)).reduce(f64::max).unwrap_or(0.0)
}

/// Finds where all things are.
pub(super) struct PlacementSolver<'w> {
    bodies: &'w [TypedBody],
    things: Vec<PlacedThing>,
    by_name: BTreeMap<String, usize>,
    issues: Vec<Diagnostic>,
}

impl<'w> PlacementSolver<'w> {
    pub fn new(bodies: &'w [TypedBody], things: Vec<PlacedThing>) -> Self {
        let mut by_name = BTreeMap::new();
        for (at, thing) in things.iter().enumerate() {
            by_name.entry(thing.name.full.clone()).or_insert(at);
        }
        Self { bodies, things, by_name, issues: Vec::new() }
    }

    pub fn solve(&mut self) {
        for at in 0..self.things.len() {
            self.locate(at, &mut Vec::new());
        }
    }

    pub fn into_parts(self) -> (Vec<PlacedThing>, Vec<Diagnostic>) {
        (self.things, self.issues)
    }

    /// Finds where a thing is; `None`: nobody can know.
    fn locate(&mut self, at: usize, trail: &mut Vec<usize>) -> Option<()> {
        match self.things[at].state {
            LocateState::Done => return Some(()),
            LocateState::Failed => return None,
            LocateState::Open => {
                self.cycle(at, trail);
                return None;
            }
            LocateState::New => {}
        }
        self.things[at].state = LocateState::Open;
        trail.push(at);
        let pose = self.find(at, trail);
        trail.pop();
        let thing = &mut self.things[at];
        thing.state = if pose.is_some() { LocateState::Done } else { LocateState::Failed };
        thing.pose = pose.unwrap_or(thing.pose);
        pose.map(drop)
    }

    fn cycle(&mut self, at: usize, trail: &[usize]) {
        let from = trail.iter().position(|other| *other == at).unwrap_or(0);
        let mut names: Vec<String> =
            trail.iter().skip(from).map(|i| format!("`{}`", self.things[*i].name.full)).collect();
        names.push(format!("`{}`", self.things[at].name.full));
        let message = match names.len() {
            2 => format!("{} is placed by itself", names[0]),
            _ => format!("each of these is placed by the next: {}", names.join(", ")),
        };
        let help = "give one of them a place of its own: `at (…)`";
        self.issues.push(bad_world(self.things[at].name.span, message, help));
    }

    fn find(&mut self, at: usize, trail: &mut Vec<usize>) -> Option<ThingPose> {
        let spec = self.things[at].spec.clone()?;
        let scope = self.things[at].scope.clone();
        let on = self.known(spec.on.as_ref(), &scope, trail)?;
        let beside = self.known(spec.beside.as_ref().map(|(_, of, _)| of), &scope, trail)?;
        let facing = self.known(spec.facing.as_ref(), &scope, trail)?;
        let (mut place, mut rotation) = self.things[at].pose;
        if on.is_none() && beside.is_none() && facing.is_none() {
            return Some((place, rotation));
        }
        let own = self.own_shapes(at, trail)?;
        let top = match (&on, &spec.on) {
            (Some(on), Some(name)) => Some(self.level(on, name)?),
            _ => None,
        };
        for _ in 0..ROUNDS {
            let own = OwnExtent { shapes: &own, yaw: if facing.is_some() { rotation[2] } else { 0.0 } };
            if let Some((on, top)) = on.as_ref().zip(top.as_ref()) {
                let offset = on.turn(spec.offset.unwrap_or_default());
                place =
                    [top.middle[0] + offset[0], top.middle[1] + offset[1], on.reach(UP) + own.reach(DOWN)];
            }
            if let Some((of, (side, _, by))) = beside.as_ref().zip(spec.beside.as_ref()) {
                let away = of.turn(*side);
                // From its origin to its surface, the distance, and from the surface of the other to its origin.
                let far = of.reach(away) - super::extent::dot(of.at, away) + by + own.reach(away.map(|x| -x));
                let height = if on.is_some() { place[2] } else { own.reach(DOWN) - of.reach(DOWN) };
                place = [of.at[0] + far * away[0], of.at[1] + far * away[1], height];
            }
            let Some(facing) = &facing else { break };
            let yaw = self.yaw_towards(at, place, facing)?;
            if rotation == [0.0, 0.0, yaw] {
                break;
            }
            rotation = [0.0, 0.0, yaw];
        }
        if let Some(top) = &top {
            self.must_be_over(at, &spec, top, place)?;
        }
        Some((place, rotation))
    }

    /// In which direction a thing looks that faces another.
    fn yaw_towards(&mut self, at: usize, place: [f64; 3], facing: &KnownLandmark) -> Option<f64> {
        let (x, y) = (facing.at[0] - place[0], facing.at[1] - place[1]);
        if x.abs().max(y.abs()) > 1e-9 {
            return Some(libm::atan2(y, x));
        }
        let name = &self.things[at].name;
        let message = format!("`{}` is where it should face, which is no direction", name.full);
        self.issues.push(bad_world(name.span, message, "write `rotated (0 deg, 0 deg, …)`"));
        None
    }

    fn level(&mut self, on: &KnownLandmark, name: &ThingName) -> Option<LevelTop> {
        let top = on.top();
        if top.is_none() {
            let what = if on.shapes.is_empty() { "has no solid body" } else { "has no level top" };
            let message = format!("`{}` {what} to stand on", name.full);
            let help = "name a box, or an upright cylinder; or give a place: `at (…)`";
            self.issues.push(bad_world(name.span, message, help));
        }
        top
    }

    /// What is on something is over it with its origin: else it would be beside it, in the air.
    fn must_be_over(
        &mut self,
        at: usize,
        spec: &PlacementSpec,
        top: &LevelTop,
        place: [f64; 3],
    ) -> Option<()> {
        if top.is_under(place) {
            return Some(());
        }
        let (name, on) = (&self.things[at].name, spec.on.as_ref()?);
        let message = format!("`{}` would be beside `{}`, not on it", name.full, on.full);
        let help = format!("its top is {}; lengths on it count from the middle", top.size());
        self.issues.push(bad_world(name.span, message, help));
        None
    }

    /// What is said by name, once that is located. The outer `None`: it cannot be.
    #[expect(clippy::option_option, reason = "nothing said, and said in vain, are two things")]
    fn known(
        &mut self,
        name: Option<&ThingName>,
        scope: &str,
        trail: &mut Vec<usize>,
    ) -> Option<Option<KnownLandmark>> {
        let Some(name) = name else { return Some(None) };
        let (at, turn) = self.pose_in(&name.full, scope, trail)?;
        let heading = libm::atan2(turn[1][0], turn[0][0]);
        let shapes = self.shapes_in(&name.full, scope, trail)?;
        Some(Some(KnownLandmark { at, heading, shapes }))
    }

    /// Where a thing is in the coordinates of a part that it is in, be it over others.
    fn pose_in(&mut self, full: &str, scope: &str, trail: &mut Vec<usize>) -> Option<([f64; 3], TurnMatrix)> {
        let mut frame = PartFrame::default();
        let rest = full.strip_prefix(scope)?;
        for (dot, _) in rest.match_indices('.') {
            let (at, rotation) = self.located(&full[..scope.len() + dot], trail)?;
            frame = compose(frame, PartFrame { at, yaw: rotation[2] });
        }
        let (at, [roll, pitch, yaw]) = self.located(full, trail)?;
        Some((frame.place(at), turned([roll, pitch, yaw + frame.yaw])))
    }

    fn located(&mut self, full: &str, trail: &mut Vec<usize>) -> Option<ThingPose> {
        let at = *self.by_name.get(full)?;
        self.locate(at, trail)?;
        Some(self.things[at].pose)
    }

    /// The shapes of a body, or of all that is solid in a part.
    fn shapes_in(&mut self, full: &str, scope: &str, trail: &mut Vec<usize>) -> Option<Vec<PlacedShape>> {
        let at = *self.by_name.get(full)?;
        if let ThingKind::Body(id) = self.things[at].kind {
            let (at, turn) = self.pose_in(full, scope, trail)?;
            return Some(vec![PlacedShape { shape: self.bodies[id].shape, at, turn }]);
        }
        let inside = format!("{full}.");
        let solid = |thing: &PlacedThing| match thing.kind {
            ThingKind::Body(id) if thing.name.full.starts_with(&inside) && !self.bodies[id].ghost => {
                Some((thing.name.full.clone(), self.bodies[id].shape))
            }
            ThingKind::Body(_) | ThingKind::Part(_) => None,
        };
        let solids: Vec<_> = self.things.iter().filter_map(solid).collect();
        let mut shapes = Vec::new();
        for (name, shape) in solids {
            let (at, turn) = self.pose_in(&name, scope, trail)?;
            shapes.push(PlacedShape { shape, at, turn });
        }
        Some(shapes)
    }

    /// The shapes of a thing about its own origin. A body's angles are in them; a part's turn is not.
    fn own_shapes(&mut self, at: usize, trail: &mut Vec<usize>) -> Option<Vec<PlacedShape>> {
        let thing = &self.things[at];
        let facing = thing.spec.as_ref().is_some_and(|spec| spec.facing.is_some());
        match thing.kind {
            ThingKind::Body(id) => {
                let turn = turned(if facing { [0.0; 3] } else { thing.pose.1 });
                Some(vec![PlacedShape { shape: self.bodies[id].shape, at: [0.0; 3], turn }])
            }
            ThingKind::Part(_) => {
                let (full, yaw) = (thing.name.full.clone(), thing.pose.1[2]);
                let shapes = self.inner_shapes(&full, trail)?;
                Some(if facing { shapes } else { shapes.into_iter().map(|s| turned_by(s, yaw)).collect() })
            }
        }
    }

    fn inner_shapes(&mut self, full: &str, trail: &mut Vec<usize>) -> Option<Vec<PlacedShape>> {
        self.shapes_in(full, &format!("{full}."), trail)
    }
}

/// A shape of a part that is turned about its origin.
fn turned_by(shape: PlacedShape, yaw: f64) -> PlacedShape {
    let frame = PartFrame { at: [0.0; 3], yaw };
    let (sin, cos) = sin_cos(yaw);
    let [x, y, z] = shape.turn;
    let row = |a: f64, b: f64| [0, 1, 2].map(|n: usize| a * x[n] + b * y[n]);
    PlacedShape { at: frame.place(shape.at), turn: [row(cos, -sin), row(sin, cos), z], ..shape }
}

/// What is placed, turned about the vertical.
struct OwnExtent<'s> {
    shapes: &'s [PlacedShape],
    yaw: f64,
}

impl OwnExtent<'_> {
    fn reach(&self, direction: [f64; 3]) -> f64 {
        let back = PartFrame { at: [0.0; 3], yaw: -self.yaw };
        reach(self.shapes, back.turn(direction))
    }
}
