//! Which bodies may touch: all that are solid, but for neighbours on a joint, and pairs of one figure that overlap by design.

use std::collections::BTreeSet;

use hrdsl_ir::world::{BodyId, Joint, World};
use rapier3d::parry;
use rapier3d::prelude::*;

use super::{PhysicsAdapter, body_id, index};
use crate::{error::SimError, math::to_pose};

/// How near two bodies of one figure may be at the start to count as overlapping, m.
const NEAR: f32 = 1e-3;
/// How deep other bodies may be in each other at the start, m: what stands on something is placed by eye.
const SUNK: f32 = 5e-3;

/// The joints that can move, between bodies that are rigidly one.
pub(super) struct JointGraph {
    edges: Vec<(BodyId, BodyId)>,
    /// By body: a number of the figure that it is of; bodies without joints are figures of their own.
    figures: Vec<usize>,
}

impl JointGraph {
    pub fn new(world: &World, roots: &[BodyId]) -> JointGraph {
        let moving = world.joints.iter().filter(|j| !j.is_rigid());
        let edges: Vec<_> = moving.map(|j| (roots[index(j.parent)], roots[index(j.child)])).collect();
        let mut figures: Vec<usize> = roots.iter().map(|root| index(*root)).collect();
        for (parent, child) in &edges {
            let (into, from) = (figures[index(*parent)], figures[index(*child)]);
            figures.iter_mut().filter(|f| **f == from).for_each(|f| *f = into);
        }
        JointGraph { edges, figures }
    }

    /// The bodies on the child's side of a joint, the child first. Of a joint that closes a loop, all of the figure.
    pub fn beyond(&self, joint: &Joint, parent: BodyId, child: BodyId) -> Vec<BodyId> {
        debug_assert!(!joint.is_rigid());
        let mut found = vec![child];
        let mut next = 0;
        while let Some(at) = found.get(next).copied() {
            next += 1;
            for (a, b) in &self.edges {
                let is_this = (*a, *b) == (parent, child);
                let other = if *a == at { *b } else { *a };
                if (*a == at || *b == at) && !is_this && !found.contains(&other) {
                    found.push(other);
                }
            }
        }
        found
    }
}

/// Pairs of bodies, by number, the smaller first, that never touch.
#[derive(Default)]
pub(super) struct ExemptPairs {
    pairs: BTreeSet<(u128, u128)>,
    /// Those that touch in another way than the engine's.
    yielding: BTreeSet<(u128, u128)>,
}

impl ExemptPairs {
    fn has(&self, a: u128, b: u128) -> bool {
        self.pairs.contains(&(a.min(b), a.max(b)))
    }

    pub fn yields(&mut self, a: usize, b: usize) {
        self.yielding.insert((a.min(b) as u128, a.max(b) as u128));
    }
}

impl PhysicsHooks for ExemptPairs {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let number = |handle: ColliderHandle| context.colliders[handle].user_data;
        let (a, b) = (number(context.collider1), number(context.collider2));
        let exempt = self.has(a, b) || self.yielding.contains(&(a.min(b), a.max(b)));
        (!exempt).then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

impl PhysicsAdapter {
    /// Finds the pairs of one figure that overlap at the start.
    ///
    /// # Errors
    /// If other bodies do, of which one can move.
    pub(super) fn exempt_overlaps(
        &mut self,
        world: &World,
        graph: &JointGraph,
        figure_of: &[Option<usize>],
    ) -> Result<(), SimError> {
        self.exempt_apart(world);
        for a in 0..self.parts.len() {
            for b in a + 1..self.parts.len() {
                if self.parts[a].ghost || self.parts[b].ghost || self.parts[a].root == self.parts[b].root {
                    continue;
                }
                if figure_of[a].is_some() && figure_of[a] == figure_of[b] {
                    self.exempt(a, b);
                    continue;
                }
                let depth = self.start_depth(a, b);
                if graph.figures[a] == graph.figures[b] {
                    if depth > -NEAR {
                        self.exempt(a, b);
                    }
                } else if depth > SUNK && [a, b].iter().any(|i| self.parts[*i].gives_way()) {
                    let name = |i: usize| world.bodies[i].name.clone();
                    return Err(SimError::StartsInside {
                        body: name(a),
                        other: name(b),
                        depth: f64::from(depth),
                    });
                }
            }
        }
        Ok(())
    }

    /// The pairs that descriptions say are never to be looked at together.
    fn exempt_apart(&mut self, world: &World) {
        for (a, body) in world.bodies.iter().enumerate() {
            let Some(solid) = &body.solid else { continue };
            for b in solid.exempt.iter().map(|b| index(*b)).filter(|b| *b < world.bodies.len()) {
                self.exempt.pairs.insert((a.min(b) as u128, a.max(b) as u128));
                self.filter(a);
                self.filter(b);
            }
        }
    }

    fn exempt(&mut self, a: usize, b: usize) {
        self.exempt.pairs.insert((a as u128, b as u128));
        self.filter(a);
        self.filter(b);
    }

    pub(super) fn filter(&mut self, part: usize) {
        if let Some(collider) = self.world.colliders.get_mut(self.parts[part].collider) {
            collider.set_active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
        }
    }

    /// How deep two bodies are in each other at the start, m; negative: how far apart, if that is less than [`NEAR`].
    fn start_depth(&self, a: usize, b: usize) -> f32 {
        let shape = |i: usize| &*self.parts[i].surface;
        let (pa, pb) = (to_pose(&self.parts[a].start), to_pose(&self.parts[b].start));
        let contact = parry::query::contact(&pa, shape(a), &pb, shape(b), NEAR).ok().flatten();
        contact.map_or(f32::NEG_INFINITY, |c| -c.dist)
    }

    /// Whether two bodies could touch.
    pub fn may_touch(&self, a: BodyId, b: BodyId) -> bool {
        let (pa, pb) = (&self.parts[index(a)], &self.parts[index(b)]);
        !pa.ghost
            && !pb.ghost
            && pa.root != pb.root
            && (pa.gives_way() || pb.gives_way())
            && !self.exempt.has(index(a) as u128, index(b) as u128)
            && !self.are_neighbours(pa.root, pb.root)
    }

    /// Whether a joint that can move is between two bodies.
    fn are_neighbours(&self, a: BodyId, b: BodyId) -> bool {
        let (a, b) = (self.parts[index(a)].handle, self.parts[index(b)].handle);
        let mut joints = self.world.impulse_joints.attached_joints(a);
        joints.any(|(first, second, _, _)| first == b || second == b)
    }

    /// All bodies that are rigidly one with a body, itself among them.
    pub fn one_with(&self, root: BodyId) -> impl Iterator<Item = BodyId> + '_ {
        (0..self.parts.len()).map(body_id).filter(move |b| self.parts[index(*b)].root == root)
    }
}
