//! What an arm would touch in a posture: itself and what it carries, the surroundings, and what lies about.

use hrdsl_ir::world::BodyId;
use rapier3d::math::Pose;
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};

use crate::{
    kinematics::KinematicChain,
    math::{BodyFrame, to_pose},
    physics::PhysicsAdapter,
};

/// How far planned motions keep off what they must not touch, m.
const CLEARANCE: f32 = 5e-3;
/// How deep what the arm carries may be in something at its goal, m: it is put down there.
const PUT_DOWN: f32 = 3e-3;
/// How much nearer the arm may come to what it touches already, m.
const SLACK: f32 = 1e-3;

/// The bodies that an arm moves, and what carries each.
#[derive(Clone, Debug)]
pub(crate) struct ArmFigure {
    /// The body, and how many of the arm's joints move it.
    pub bodies: Vec<(BodyId, usize)>,
    /// The bodies that lead those that the joints turn, the tip's last.
    pub links: Vec<BodyId>,
    /// What the first joint hangs on.
    pub base: BodyId,
}

/// A body of the arm as it would be moved.
struct MovedBody {
    body: BodyId,
    above: usize,
    /// Where it would be if the joints above it were at zero and the base at its start.
    at_zero: BodyFrame,
}

struct Obstacle {
    body: BodyId,
    pose: Pose,
    around: Aabb,
}

/// How near two bodies may come; in general [`CLEARANCE`].
struct NarrowPair {
    moved: usize,
    other: PairSide,
    least: f32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum PairSide {
    Obstacle(usize),
    Own(usize),
}

/// The surroundings of an arm at one moment, for a planner that asks about postures.
pub(crate) struct ArmClearance<'a> {
    physics: &'a PhysicsAdapter,
    chain: &'a KinematicChain,
    base: BodyFrame,
    moved: Vec<MovedBody>,
    obstacles: Vec<Obstacle>,
    /// Pairs of moved bodies that could touch.
    own: Vec<(usize, usize)>,
    held: Vec<BodyId>,
    narrow: Vec<NarrowPair>,
}

impl<'a> ArmClearance<'a> {
    /// `held` is what moves with the tip; `is_known` says which bodies the planner knows.
    pub fn new(
        figure: &ArmFigure,
        chain: &'a KinematicChain,
        physics: &'a PhysicsAdapter,
        held: &[BodyId],
        is_known: &dyn Fn(BodyId) -> bool,
    ) -> ArmClearance<'a> {
        let moved = figure.moved(physics, held);
        let is_moved = |b: BodyId| moved.iter().any(|m| m.body == b);
        let known = physics.solids().filter(|b| !is_moved(*b) && is_known(*b));
        let obstacles = known.map(|body| Obstacle::now(body, physics)).collect();
        let mut own = Vec::new();
        for (i, a) in moved.iter().enumerate() {
            for (j, b) in moved.iter().enumerate().skip(i + 1) {
                // What is held rides on the last link, and touches that by its hand.
                let apart = a.above != b.above;
                if apart && physics.may_touch(a.body, b.body) {
                    own.push((i, j));
                }
            }
        }
        let base = physics.pose(figure.base).then(&physics.start(figure.base).inverse());
        ArmClearance { physics, chain, base, moved, obstacles, own, held: held.to_vec(), narrow: Vec::new() }
    }

    /// Lets the arm be as near to things as it is in the posture from which it sets out.
    pub fn allow_start(&mut self, posture: &[f64]) {
        self.allow(posture, SLACK);
    }

    /// Lets the arm come as near to things as it shall be in the end; gives what [`forget`](Self::forget) wants.
    pub fn allow_goal(&mut self, posture: &[f64]) -> usize {
        let before = self.narrow.len();
        self.allow(posture, SLACK / 2.0);
        before
    }

    /// Takes back what was allowed since then.
    pub fn forget(&mut self, before: usize) {
        self.narrow.truncate(before);
    }

    fn allow(&mut self, posture: &[f64], slack: f32) {
        let mut near = Vec::new();
        self.visit(posture, &mut |moved, other, distance| {
            near.push(NarrowPair { moved, other, least: distance - slack });
            true
        });
        self.narrow.append(&mut near);
    }

    /// The first two bodies that a goal must not bring together: it may be narrow there, and what the arm carries may touch.
    pub fn goal_conflict(&self, posture: &[f64]) -> Option<(BodyId, BodyId)> {
        let touches =
            |moved: usize| if self.held.contains(&self.moved[moved].body) { -PUT_DOWN } else { 0.0 };
        self.search(posture, &touches)
    }

    /// The first two bodies that would be too near each other in a posture on the way.
    pub fn conflict(&self, posture: &[f64]) -> Option<(BodyId, BodyId)> {
        self.search(posture, &|_| CLEARANCE)
    }

    /// The first pair that is nearer than this, and than is allowed.
    fn search(&self, posture: &[f64], least: &dyn Fn(usize) -> f32) -> Option<(BodyId, BodyId)> {
        let mut found = None;
        self.visit(posture, &mut |moved, other, distance| {
            let same = |n: &&NarrowPair| n.moved == moved && n.other == other;
            let narrow = self.narrow.iter().filter(same);
            if distance < narrow.fold(least(moved), |least, n| least.min(n.least)) {
                let other = match other {
                    PairSide::Obstacle(i) => self.obstacles[i].body,
                    PairSide::Own(i) => self.moved[i].body,
                };
                found = Some((self.moved[moved].body, other));
            }
            found.is_none()
        });
        found
    }

    /// Tells of all pairs that are nearer than [`CLEARANCE`], with their distances, until it is told to stop.
    fn visit(&self, posture: &[f64], tell: &mut dyn FnMut(usize, PairSide, f32) -> bool) {
        let frames = self.chain.frames(posture, &self.base);
        let poses: Vec<Pose> =
            self.moved.iter().map(|m| to_pose(&frames[m.above].then(&m.at_zero))).collect();
        let boxes: Vec<Aabb> = self
            .moved
            .iter()
            .zip(&poses)
            .map(|(m, pose)| self.physics.aabb(m.body, pose).loosened(CLEARANCE))
            .collect();
        for (i, moved) in self.moved.iter().enumerate() {
            for (j, obstacle) in self.obstacles.iter().enumerate() {
                if boxes[i].intersects(&obstacle.around)
                    && self.physics.may_touch(moved.body, obstacle.body)
                    && let Some(distance) =
                        self.physics.gap(moved.body, &poses[i], obstacle.body, &obstacle.pose, CLEARANCE)
                    && !tell(i, PairSide::Obstacle(j), distance)
                {
                    return;
                }
            }
        }
        for (i, j) in &self.own {
            let (a, b) = (&self.moved[*i], &self.moved[*j]);
            if boxes[*i].intersects(&boxes[*j])
                && let Some(distance) = self.physics.gap(a.body, &poses[*i], b.body, &poses[*j], CLEARANCE)
                && !tell(*i, PairSide::Own(*j), distance)
            {
                return;
            }
        }
    }
}

impl Obstacle {
    fn now(body: BodyId, physics: &PhysicsAdapter) -> Obstacle {
        let pose = to_pose(&physics.pose(body));
        Obstacle { body, pose, around: physics.aabb(body, &pose) }
    }
}

impl ArmFigure {
    /// What hangs on the arm by joints of its own, such as fingers, and what it holds, is moved as it is now.
    fn moved(&self, physics: &PhysicsAdapter, held: &[BodyId]) -> Vec<MovedBody> {
        let solid = self.bodies.iter().filter(|(b, _)| !physics.is_ghost(*b));
        let held = held.iter().map(|b| (*b, self.links.len()));
        let all = solid.copied().chain(held);
        all.map(|(body, above)| {
            let link = self.links[above - 1];
            let at_zero = if physics.root(body) == physics.root(link) {
                physics.start(body)
            } else {
                let carried = physics.pose(link).inverse().then(&physics.pose(body));
                physics.start(link).then(&carried)
            };
            MovedBody { body, above, at_zero }
        })
        .collect()
    }

    /// What each joint of an arm moves, by the numbers of the joints from the base to the tip.
    pub fn new(joints: &[usize], base: BodyId, physics: &PhysicsAdapter) -> ArmFigure {
        let carried: Vec<Vec<BodyId>> = joints.iter().map(|j| physics.carried_by(*j)).collect();
        let links = joints.iter().map(|j| physics.child_of(*j)).collect();
        let above = |root: BodyId| carried.iter().filter(|c| c.contains(&root)).count();
        let all = carried.first().into_iter().flatten();
        let bodies = all.flat_map(|root| physics.one_with(*root).map(|b| (b, above(*root)))).collect();
        ArmFigure { bodies, links, base }
    }

    /// Whether a body is of the arm.
    pub fn has(&self, body: BodyId) -> bool {
        self.bodies.iter().any(|(b, _)| *b == body)
    }
}
