//! Which bodies are joined, and which pairs of them the engine is to leave alone.

use hrdsl_ir::world::{BodyId, Joint, World};
use rapier3d::prelude::*;

use super::bodies::index;

/// The joints that can move, between bodies that are rigidly one.
pub struct JointGraph {
    pub edges: Vec<(BodyId, BodyId)>,
    /// By body: a number of the figure that it is of; bodies without joints are figures of their own.
    pub figures: Vec<usize>,
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

    /// By body: a number of the figure that it is of, or of the body that it is one with.
    pub fn bodies_by_robot(&self, roots: &[BodyId]) -> Vec<usize> {
        roots.iter().map(|root| self.figures[index(*root)]).collect()
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

/// Pairs of bodies, by number, that never touch, or in another way than the engine's. It is asked for every pair that is near, in every
/// step: so each pair is a bit of two matrices.
#[derive(Default)]
pub struct ExemptPairs {
    pub bodies: usize,
    /// Those that never touch.
    pub never: Vec<bool>,
    /// Those that the engine leaves out: these, and those that yield.
    pub left_out: Vec<bool>,
}

impl ExemptPairs {
    pub fn of(bodies: usize) -> ExemptPairs {
        ExemptPairs { bodies, never: vec![false; bodies * bodies], left_out: vec![false; bodies * bodies] }
    }

    pub fn has(&self, a: usize, b: usize) -> bool {
        self.never.get(a * self.bodies + b).copied().unwrap_or(false)
    }

    /// Whether the engine leaves them out.
    pub fn is_left_out(&self, a: usize, b: usize) -> bool {
        self.left_out.get(a * self.bodies + b).copied().unwrap_or(false)
    }

    pub fn exempt(&mut self, a: usize, b: usize) {
        for at in [a * self.bodies + b, b * self.bodies + a] {
            self.never[at] = true;
            self.left_out[at] = true;
        }
    }

    pub fn yields(&mut self, a: usize, b: usize) {
        for at in [a * self.bodies + b, b * self.bodies + a] {
            self.left_out[at] = true;
        }
    }
}

impl PhysicsHooks for ExemptPairs {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let number = |handle: ColliderHandle| context.colliders[handle].user_data as usize;
        let at = number(context.collider1) * self.bodies + number(context.collider2);
        let is_left_out = self.left_out.get(at).copied().unwrap_or(false);
        (!is_left_out).then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}
