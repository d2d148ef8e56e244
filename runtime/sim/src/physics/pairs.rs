//! Which bodies may touch: all that are solid, but for neighbours on a joint, and pairs of one figure that overlap by design.

use hrdsl_ir::world::{BodyId, World};
use rapier3d::parry;
use rapier3d::prelude::*;

use super::state::{
    adapter::PhysicsAdapter,
    bodies::{body_id, index},
    pairs::JointGraph,
};
use crate::{error::SimulationError, math::to_pose};

/// How near two bodies of one figure may be at the start to count as overlapping, m.
const NEAR: f32 = 1e-3;
/// How deep other bodies may be in each other at the start, m: what stands on something is placed by eye.
const SUNK: f32 = 5e-3;
/// How many figures have a group of the engine's.
const FIGURE_GROUPS: u32 = 31;

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
    ) -> Result<(), SimulationError> {
        self.exempt_apart(world);
        self.group_figures(figure_of);
        for a in 0..self.parts.len() {
            for b in a + 1..self.parts.len() {
                if self.parts[a].ghost || self.parts[b].ghost || self.parts[a].root == self.parts[b].root {
                    continue;
                }
                if figure_of[a].is_some() && figure_of[a] == figure_of[b] {
                    self.exempt.exempt(a, b);
                    continue;
                }
                let depth = self.start_depth(a, b);
                if graph.figures[a] == graph.figures[b] {
                    if depth > -NEAR {
                        self.exempt(a, b);
                    }
                } else if depth > SUNK && [a, b].iter().any(|i| self.parts[*i].gives_way()) {
                    let name = |i: usize| world.bodies[i].name.clone();
                    return Err(SimulationError::StartsInside {
                        body: name(a),
                        other: name(b),
                        depth: f64::from(depth),
                    });
                }
            }
        }
        Ok(())
    }

    /// Bodies of one figure never meet. There are many such pairs, always near each other: the engine's groups leave them out at a
    /// glance. It has 32 groups, of which the first is everybody's; figures beyond are asked for each time.
    fn group_figures(&mut self, figure_of: &[Option<usize>]) {
        for (part, figure) in figure_of.iter().enumerate() {
            let Some(figure) = figure else { continue };
            if let Some(group) = u32::try_from(*figure).ok().filter(|figure| *figure < FIGURE_GROUPS) {
                let own = Group::from_bits_truncate(2 << group);
                let groups =
                    InteractionGroups::new(own, Group::ALL.difference(own), InteractionTestMode::And);
                if let Some(collider) = self.world.colliders.get_mut(self.parts[part].collider) {
                    collider.set_collision_groups(groups);
                }
            } else {
                self.filter(part);
            }
        }
    }

    /// The pairs that descriptions say are never to be looked at together.
    fn exempt_apart(&mut self, world: &World) {
        for (a, body) in world.bodies.iter().enumerate() {
            let Some(solid) = &body.solid else { continue };
            for b in solid.exempt.iter().map(|b| index(*b)).filter(|b| *b < world.bodies.len()) {
                self.exempt.exempt(a, b);
                self.filter(a);
                self.filter(b);
            }
        }
    }

    fn exempt(&mut self, a: usize, b: usize) {
        self.exempt.exempt(a, b);
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
            && !self.exempt.has(index(a), index(b))
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
