//! HR0802: a loose body with nothing below it that could carry it, so that it falls as soon as a run begins.

use std::collections::BTreeSet;

use hrdsl_ir::world::Gripper;
use hrdsl_source::{Diagnostic, DiagnosticCode};

use super::facts::ScenarioFacts;
use crate::{
    BodyId, BodyMotion, BodyShape, Scenario,
    world::{PartFrame, PartInstance, TypedBody, TypedWorld, sin_cos},
};

/// Beyond so many comparisons nothing is said.
const WORK: usize = 1 << 22;

pub(crate) fn check<'a>(scenario: &'a Scenario, _: &'a ScenarioFacts<'a>, issues: &mut Vec<Diagnostic>) {
    let Some(world) = &scenario.world else { return };
    let straight_down = world.gravity[0] == 0.0 && world.gravity[1] == 0.0 && world.gravity[2] < 0.0;
    if !straight_down {
        return;
    }
    let bodies = placed(world);
    let hollow = hollow(world);
    let loose: Vec<&PlacedBody> = bodies.iter().filter(|b| b.may_fall()).collect();
    if loose.len().saturating_mul(bodies.len() + world.grippers.len() + hollow.len()) > WORK {
        return;
    }
    let furnished = bodies.iter().any(|b| b.body.motion == BodyMotion::Fixed && !b.body.ghost && !b.jointed);
    for falling in loose {
        let below =
            || bodies.iter().filter(|b| !std::ptr::eq(*b, falling) && b.extent.is_below(&falling.extent));
        if below().any(|b| b.carries(falling)) || world.grippers.iter().any(|g| reaches(world, g, falling)) {
            continue;
        }
        let vain = below().find(|b| b.body.motion == BodyMotion::Fixed || b.palm);
        let hollow = hollow.iter().find(|p| falling.extent.is_above(p.frame.at)).copied();
        // A world of loose bodies alone is one in which nothing is meant to lie anywhere.
        if furnished || vain.is_some() || hollow.is_some() {
            issues.push(finding(falling.body, vain, hollow));
        }
    }
}

fn finding(body: &TypedBody, vain: Option<&PlacedBody>, hollow: Option<&PartInstance>) -> Diagnostic {
    let message = format!("nothing carries `{}`: it falls as soon as a run begins", body.name);
    let issue = Diagnostic::warning(DiagnosticCode::NOTHING_CARRIES, body.span, message);
    match (vain, hollow) {
        (Some(below), _) if below.body.ghost => {
            let name = &below.body.name;
            let issue = issue.label(below.body.span, "a ghost: everything passes through it");
            issue.help(format!("drop `ghost` of `{name}`, or put a fixed body under `{}`", body.name))
        }
        (Some(below), _) => issue
            .label(below.body.span, "a gripper's palm: what is graspable passes through it")
            .help(format!("put a fixed body under `{}`", body.name)),
        (None, Some(part)) => issue
            .label(part.span, format!("`{}` has no body: everything passes through it", part.name))
            .help(format!("give the part a fixed body, or put one under `{}`", body.name)),
        (None, None) => issue.help("put a fixed body under it, or move it over one"),
    }
}

fn placed(world: &TypedWorld) -> Vec<PlacedBody<'_>> {
    let jointed: BTreeSet<BodyId> = world.joints.iter().flat_map(|j| [j.parent, j.child]).collect();
    let palms: BTreeSet<BodyId> = world.grippers.iter().map(|g| g.palm).collect();
    let bodies = (0..).map(BodyId).zip(&world.bodies);
    let place = |(id, body)| PlacedBody {
        body,
        extent: BodyExtent::of(body),
        jointed: jointed.contains(&id),
        palm: palms.contains(&id),
    };
    bodies.map(place).collect()
}

/// The parts that are put at a place of their own, and have nothing there.
fn hollow<'a>(world: &'a TypedWorld) -> Vec<&'a PartInstance> {
    let outer = |b: &'a TypedBody| b.name.match_indices('.').map(|(end, _)| &b.name[..end]);
    let full: BTreeSet<&str> = world.bodies.iter().flat_map(outer).collect();
    let hollow = |p: &&PartInstance| p.frame.at != [0.0; 3] && !full.contains(p.name.as_str());
    world.parts.iter().filter(hollow).collect()
}

/// Whether the gripper can take hold of it where it is.
fn reaches(world: &TypedWorld, gripper: &Gripper, falling: &PlacedBody) -> bool {
    let Some(palm) = world.bodies.get(usize::from(gripper.palm.0)) else { return true };
    let tool = rotate(palm.frame.yaw, palm.rotation, gripper.tool);
    let at: [f64; 3] = std::array::from_fn(|i| palm.frame.place(palm.position)[i] + tool[i]);
    falling.extent.distance(at) <= gripper.reach
}

struct PlacedBody<'a> {
    body: &'a TypedBody,
    extent: BodyExtent,
    jointed: bool,
    palm: bool,
}

impl PlacedBody<'_> {
    /// Joints and motors may hold it; a ghost that falls does no harm.
    fn may_fall(&self) -> bool {
        self.body.motion == BodyMotion::Dynamic && !self.jointed && !self.palm && !self.body.ghost
    }

    fn carries(&self, other: &PlacedBody) -> bool {
        !(self.body.ghost || self.palm && other.body.graspable)
    }
}

/// A box along the world's axes around a body at the start.
struct BodyExtent {
    lo: [f64; 3],
    hi: [f64; 3],
}

impl BodyExtent {
    fn of(body: &TypedBody) -> Self {
        let half = match body.shape {
            BodyShape::Box { size } => size.map(|e| e / 2.0),
            BodyShape::Sphere { radius } => [radius; 3],
            BodyShape::Capsule { radius, length } => [radius, radius, radius + length / 2.0],
            BodyShape::Cylinder { radius, length } => [radius, radius, length / 2.0],
        };
        let mut size = [0.0; 3];
        for (axis, half) in half.into_iter().enumerate() {
            let mut along = [0.0; 3];
            along[axis] = half;
            let along = rotate(body.frame.yaw, body.rotation, along);
            for (sum, part) in size.iter_mut().zip(along) {
                *sum += part.abs();
            }
        }
        let centre = body.frame.place(body.position);
        let end = |sign: f64| std::array::from_fn(|i| centre[i] + sign * size[i]);
        Self { lo: end(-1.0), hi: end(1.0) }
    }

    /// Under some of the other, or in it.
    fn is_below(&self, other: &BodyExtent) -> bool {
        let shared = |i: usize| self.lo[i] <= other.hi[i] && other.lo[i] <= self.hi[i];
        shared(0) && shared(1) && self.lo[2] < other.hi[2]
    }

    fn is_above(&self, place: [f64; 3]) -> bool {
        let around = |i: usize| (self.lo[i]..=self.hi[i]).contains(&place[i]);
        around(0) && around(1) && place[2] <= self.hi[2]
    }

    fn distance(&self, place: [f64; 3]) -> f64 {
        let off = |i: usize| (self.lo[i] - place[i]).max(place[i] - self.hi[i]).max(0.0);
        (off(0) * off(0) + off(1) * off(1) + off(2) * off(2)).sqrt()
    }
}

/// A direction of a body, in the world: turned about the fixed axes x, y and z, then with its part.
fn rotate(yaw: f64, [roll, pitch, own_yaw]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = sin_cos(roll);
    let (y, z) = (cos * y - sin * z, sin * y + cos * z);
    let (sin, cos) = sin_cos(pitch);
    let (x, z) = (cos * x + sin * z, cos * z - sin * x);
    let turn = |v, yaw| PartFrame { at: [0.0; 3], yaw }.turn(v);
    turn(turn([x, y, z], own_yaw), yaw)
}
