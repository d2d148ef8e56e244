//! The planner: a posture that brings the tool to a place, and a path to it that touches nothing.
//!
//! Where the straight path is not free, trees grow from both ends towards each other and towards random postures (RRT-Connect;
//! Kuffner and LaValle 2000); the path found is then shortened between random points. The random numbers are the same in every
//! search, so that the same question has the same answer.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use hrdsl_ir::world::BodyId;

use crate::{
    clearance::ArmClearance,
    kinematics::{AllowedPosture, KinematicChain, KinematicLink, PostureFit},
    math::SpaceVector,
    route::{JointRoute, between, span},
};

/// How closely paths are looked at, rad or m.
const GRAIN: f64 = 0.01;
/// How far a tree grows at once, rad or m.
const GROWTH: f64 = 0.15;
/// How often trees grow before the search is given up.
const GROWTHS: usize = 3000;
/// How often a path is tried to be shortened.
const SHORTCUTS: usize = 120;
/// To how many postures paths are searched.
const POSTURES: usize = 3;

/// How many seconds of path a radian of tilt is worth, beyond what counts as upright (rad).
const TILT: f64 = 30.0;
const UPRIGHT: f64 = 0.1;
/// And how many a posture is worth that keeps off everything.
const NARROW: f64 = 10.0;

/// Why there is no path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoRoute {
    /// Metres from the place of the nearest posture.
    Unreachable(f64),
    /// What would touch what.
    Obstructed(BodyId, BodyId),
}

/// An arm in its surroundings.
pub(crate) struct RoutePlanner<'a> {
    pub chain: &'a KinematicChain,
    pub clearance: ArmClearance<'a>,
    /// The full speed of each joint, rad/s or m/s.
    pub speeds: &'a [f64],
}

impl RoutePlanner<'_> {
    /// A path of the tool to a place, from a posture.
    pub fn reach_place(&mut self, from: &[f64], target: SpaceVector) -> Result<JointRoute, NoRoute> {
        self.clearance.allow_start(from);
        let mut found = self.chain.postures(from, target, &|q| {
            if self.clearance.goal_conflict(q).is_some() {
                PostureFit::Refused
            } else if self.clearance.conflict(q).is_some() {
                PostureFit::Narrow
            } else {
                PostureFit::Free
            }
        });
        let cost = |p: &AllowedPosture| {
            let narrow = if p.is_narrow { NARROW } else { 0.0 };
            span(from, &p.joints, self.speeds) + TILT * (p.tilt - UPRIGHT).max(0.0) + narrow
        };
        found.allowed.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let touching = found.refused.and_then(|q| self.clearance.goal_conflict(&q));
        let mut why = touching.map_or(NoRoute::Unreachable(found.error), |(a, b)| NoRoute::Obstructed(a, b));
        let near = found.allowed.iter().take(POSTURES).map(|posture| &posture.joints);
        let mut best: Option<JointRoute> = None;
        for to in near {
            if let Some(route) = self.straight(from, to) {
                return Ok(route);
            }
            match self.around(from, to) {
                Ok(route) if best.as_ref().is_none_or(|b| route.length() < b.length()) => best = Some(route),
                Ok(_) => {}
                Err(no_route) => why = no_route,
            }
        }
        best.ok_or(why)
    }

    /// A path to a posture.
    pub fn reach_posture(&mut self, from: &[f64], to: &[f64]) -> Result<JointRoute, NoRoute> {
        self.clearance.allow_start(from);
        if let Some((a, b)) = self.clearance.goal_conflict(to) {
            return Err(NoRoute::Obstructed(a, b));
        }
        self.straight(from, to).map_or_else(|| self.around(from, to), Ok)
    }

    /// The straight path, if it is free.
    fn straight(&mut self, from: &[f64], to: &[f64]) -> Option<JointRoute> {
        let before = self.clearance.allow_goal(to);
        let free = self.is_free(from, to);
        self.clearance.forget(before);
        free.then(|| self.route(vec![from.to_vec(), to.to_vec()]))
    }

    fn route(&self, points: Vec<Vec<f64>>) -> JointRoute {
        JointRoute::new(points, self.speeds)
    }

    /// What is first in the way on the straight line.
    fn blocked(&self, from: &[f64], to: &[f64]) -> Option<(BodyId, BodyId)> {
        let steps = grains(from, to);
        (1..=steps).find_map(|step| self.conflict_at(from, to, step, steps))
    }

    /// Whether nothing is in the way on the straight line. What is there is found soonest at its end, and then by halves.
    fn is_free(&self, from: &[f64], to: &[f64]) -> bool {
        let steps = grains(from, to);
        by_halves(steps).all(|step| self.conflict_at(from, to, step, steps).is_none())
    }

    fn conflict_at(&self, from: &[f64], to: &[f64], step: usize, steps: usize) -> Option<(BodyId, BodyId)> {
        self.clearance.conflict(&between(from, to, step as f64 / steps as f64))
    }

    fn around(&mut self, from: &[f64], to: &[f64]) -> Result<JointRoute, NoRoute> {
        let before = self.clearance.allow_goal(to);
        let found = self.connect(from, to).map(|points| self.smooth(self.shortened(points)));
        // What is in the way is told only if there is no other.
        let obstruction = if found.is_none() { self.blocked(from, to) } else { None };
        self.clearance.forget(before);
        let (a, b) = obstruction.unwrap_or((BodyId(0), BodyId(0)));
        found.ok_or(NoRoute::Obstructed(a, b))
    }

    /// With corners as round as is free.
    fn smooth(&self, points: Vec<Vec<f64>>) -> JointRoute {
        let route = self.route(points);
        let free = |route: &JointRoute| {
            let steps = (route.length() * self.fastest() / GRAIN).ceil().max(1.0) as usize;
            let parts = (0..=steps).map(|i| route.length() * i as f64 / steps as f64);
            parts.map(|s| route.at(s)).all(|q| self.clearance.conflict(&q).is_none())
        };
        let rounded = [1.0, 0.5, 0.2].into_iter().map(|part| route.sharper(part)).find(free);
        rounded.unwrap_or_else(|| route.sharper(0.05))
    }

    fn fastest(&self) -> f64 {
        self.speeds.iter().fold(1e-6, |a, b| a.max(*b))
    }

    /// Grows two trees until they meet.
    fn connect(&self, from: &[f64], to: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut trees = [PostureTree::new(from), PostureTree::new(to)];
        for n in 0..GROWTHS {
            let (grows, other) = (n % 2, 1 - n % 2);
            let wanted = self.chain.links.iter().map(|link| drawn(link, &mut random)).collect::<Vec<_>>();
            let Some(new) = trees[grows].grow(&wanted, |a, b| self.is_free(a, b)) else { continue };
            let there = trees[grows].nodes[new].0.clone();
            while let Some(next) = trees[other].grow(&there, |a, b| self.is_free(a, b)) {
                if trees[other].nodes[next].0 == there {
                    let mut first = trees[grows].back(new);
                    let mut second = trees[other].back(next);
                    if grows == 1 {
                        std::mem::swap(&mut first, &mut second);
                    }
                    first.reverse();
                    first.extend(second.into_iter().skip(1));
                    return Some(first);
                }
            }
        }
        None
    }

    fn shortened(&self, mut points: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..SHORTCUTS {
            if points.len() < 3 {
                break;
            }
            let route = self.route(points.clone()).sharper(0.0);
            let (a, b) = (part(&mut random) * route.length(), part(&mut random) * route.length());
            let (a, b) = (a.min(b), a.max(b));
            let (start, end) = (route.at(a), route.at(b));
            if span(&start, &end, self.speeds) + 1e-9 < b - a && self.is_free(&start, &end) {
                let before = route.points_where(|along| along < a);
                let after = route.points_where(|along| along > b);
                points = before.chain([start, end]).chain(after).collect();
            }
        }
        points
    }
}

/// At how many points a line between two postures is looked at.
fn grains(from: &[f64], to: &[f64]) -> usize {
    let ones = vec![1.0; from.len()];
    (span(from, to, &ones) / GRAIN).ceil().max(1.0) as usize
}

/// The numbers from 1 to the last: that one first, then the middle, the middles of the halves, and so on.
fn by_halves(last: usize) -> impl Iterator<Item = usize> {
    let widest = last.next_power_of_two() / 2;
    let strides = std::iter::successors((widest > 0).then_some(widest), |s| (*s > 1).then_some(s / 2));
    std::iter::once(last).chain(strides.flat_map(move |stride| (stride..last).step_by(2 * stride)))
}

/// Postures that can be reached from the first, each from the one that it names.
struct PostureTree {
    nodes: Vec<(Vec<f64>, usize)>,
}

impl PostureTree {
    fn new(root: &[f64]) -> PostureTree {
        PostureTree { nodes: vec![(root.to_vec(), 0)] }
    }

    /// Grows by one step from the nearest posture towards another, which it reaches if it is near enough; `None`: the step
    /// is not free.
    fn grow(&mut self, towards: &[f64], is_free: impl Fn(&[f64], &[f64]) -> bool) -> Option<usize> {
        let far = |q: &[f64]| q.iter().zip(towards).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let nearest =
            (0..self.nodes.len()).min_by(|a, b| far(&self.nodes[*a].0).total_cmp(&far(&self.nodes[*b].0)))?;
        let distance = far(&self.nodes[nearest].0).sqrt();
        let step = if distance <= GROWTH {
            towards.to_vec()
        } else {
            between(&self.nodes[nearest].0, towards, GROWTH / distance)
        };
        if distance == 0.0 || !is_free(&self.nodes[nearest].0, &step) {
            return None;
        }
        self.nodes.push((step, nearest));
        Some(self.nodes.len() - 1)
    }

    /// The path from a posture back to the root.
    fn back(&self, from: usize) -> Vec<Vec<f64>> {
        let mut path = vec![self.nodes[from].0.clone()];
        let mut at = from;
        while at != 0 {
            at = self.nodes[at].1;
            path.push(self.nodes[at].0.clone());
        }
        path
    }
}

/// 0..1
fn part(random: &mut ChaCha8Rng) -> f64 {
    f64::from(random.next_u32()) / f64::from(u32::MAX)
}

fn drawn(link: &KinematicLink, random: &mut ChaCha8Rng) -> f64 {
    link.lo + part(random) * (link.hi - link.lo)
}

#[cfg(test)]
mod tests {
    use super::by_halves;

    #[test]
    fn halves_leave_nothing_out_and_take_nothing_twice() {
        assert_eq!(by_halves(8).collect::<Vec<_>>(), [8, 4, 2, 6, 1, 3, 5, 7]);
        for last in 1..200 {
            let mut all: Vec<usize> = by_halves(last).collect();
            all.sort_unstable();
            assert_eq!(all, (1..=last).collect::<Vec<_>>());
        }
    }
}
