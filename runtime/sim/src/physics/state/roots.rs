//! What bodies hang together: by figure, and over joints that cannot move.

use hrdsl_ir::world::{BodyId, BodyMotion, World};

use super::bodies::{bad, body_id, index};
use crate::{error::SimulationError, math::v3};

/// For each body the figure that it is of.
pub fn figure_of(world: &World) -> Vec<Option<usize>> {
    let mut figures = vec![None; world.bodies.len()];
    for (i, figure) in world.figures.iter().enumerate() {
        let limbs = figure.limbs.iter().flat_map(|limb| [limb.upper, limb.lower].into_iter().chain(limb.end));
        for body in [figure.pelvis, figure.trunk, figure.head].into_iter().chain(limbs) {
            if let Some(slot) = figures.get_mut(index(body)) {
                *slot = Some(i);
            }
        }
    }
    figures
}

/// For each body the one that it is rigidly one with: the topmost over joints that cannot move.
pub fn rigid_roots(world: &World) -> Result<Vec<BodyId>, SimulationError> {
    let count = world.bodies.len();
    let mut above: Vec<Option<BodyId>> = vec![None; count];
    for joint in &world.joints {
        for body in [joint.parent, joint.child] {
            if index(body) >= count {
                return Err(bad(format!("joint `{}`", joint.name), "body", index(body)));
            }
        }
        let numbers = joint.anchor.iter().chain(&joint.axis).chain([&joint.lo, &joint.hi]);
        if !numbers.into_iter().all(|x| x.is_finite()) || v3(joint.axis).norm() < 1e-9 || joint.lo > joint.hi
        {
            return Err(SimulationError::BadNumber { what: format!("a measure of joint `{}`", joint.name) });
        }
        let child = index(joint.child);
        if world.bodies[child].motion != BodyMotion::Dynamic || joint.parent == joint.child {
            return Err(SimulationError::BadChild { joint: joint.name.clone() });
        }
        if joint.is_rigid() && above[child].replace(joint.parent).is_some() {
            return Err(SimulationError::BadChild { joint: joint.name.clone() });
        }
    }
    let root = |start: usize| {
        let mut at = body_id(start);
        for _ in 0..=count {
            match above[index(at)] {
                Some(up) => at = up,
                None => return Ok(at),
            }
        }
        Err(SimulationError::BadChild { joint: world.bodies[start].name.clone() })
    };
    (0..count).map(root).collect()
}
