//! The dynamics of an arm as its controller knows them: which torques give its joints which accelerations.
//!
//! For joints with axes z and anchors p, and bodies with masses m, centres c and inertias I, the torques of accelerations q̈ are
//! M q̈ + h (Siciliano et al., *Robotics*, 2009, section 7.2): M is the sum of m JᵥᵀJᵥ + JωᵀI Jω over the bodies, where the columns of
//! Jᵥ are z × (c − p) and those of Jω are z; h is what weight and the present speeds ask for. What the arm carries that is not of
//! it, the controller does not know.

use hrdsl_ir::world::JointMotion;
use nalgebra::{DMatrix, DVector, Matrix3};
use rapier3d::prelude::*;

use super::state::{adapter::PhysicsAdapter, joint::DrivenJoint};
use crate::math::{SpaceVector, from_vector};

/// The numbers of an arm's joints, from the base to the tip, and its bodies with how many of the joints move each.
#[derive(Clone, Debug)]
pub(crate) struct ArmDynamics {
    joints: Vec<usize>,
    bodies: Vec<(RigidBodyHandle, usize)>,
    sums: InertiaSums,
}

/// A joint, now.
struct MovingAxis {
    motion: JointMotion,
    axis: SpaceVector,
    anchor: SpaceVector,
    speed: f64,
}

/// How what hangs on a joint moves without any acceleration of the joints themselves.
#[derive(Clone, Copy)]
struct LinkMotion {
    at: SpaceVector,
    turn: SpaceVector,
    turn_rate: SpaceVector,
    rate: SpaceVector,
}

/// What a joint bears besides its motor, on its child: a force (N) at its anchor, and a torque (N·m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct BorneLoad {
    pub force: SpaceVector,
    pub torque: SpaceVector,
}

/// What the dynamics say of one moment.
pub(crate) struct ArmEquation {
    pub inertia: DMatrix<f64>,
    pub bias: DVector<f64>,
    /// By joint: the weight that it bears.
    pub borne: Vec<BorneLoad>,
}

impl ArmDynamics {
    pub fn new(joints: &[usize], physics: &PhysicsAdapter) -> ArmDynamics {
        let driven = |j: &usize| physics.joints[*j].as_ref();
        let mut bodies: Vec<(RigidBodyHandle, usize)> = Vec::new();
        for joint in joints.iter().filter_map(driven) {
            for handle in &joint.carried {
                match bodies.iter_mut().find(|(known, _)| known == handle) {
                    Some((_, above)) => *above += 1,
                    None => bodies.push((*handle, 1)),
                }
            }
        }
        ArmDynamics { joints: joints.to_vec(), bodies, sums: InertiaSums::default() }
    }

    /// Torques (N·m) and forces (N) that give accelerations, and those that only keep up what is.
    pub fn equation(&mut self, physics: &PhysicsAdapter) -> ArmEquation {
        let mut axes: Vec<MovingAxis> = Vec::with_capacity(self.joints.len());
        let driven = self.joints.iter().filter_map(|j| physics.joints[*j].as_ref().map(|d| (j, d)));
        axes.extend(driven.map(|(j, d)| physics.moving_axis(*j, d)));
        let links = link_motions(&axes, -from_vector(physics.world.gravity));
        let n = axes.len();
        let nothing = BorneLoad { force: SpaceVector::zeros(), torque: SpaceVector::zeros() };
        let sums = &mut self.sums;
        sums.begin(n);
        let mut borne = vec![nothing; n];
        for (handle, above) in &self.bodies {
            let Some(link) = links.get(above - 1) else { continue };
            let body = &physics.world.bodies[*handle];
            sums.add(&axes[..*above], link, body);
            let weight = from_vector(physics.world.gravity) * -f64::from(body.mass());
            for (load, axis) in borne.iter_mut().zip(&axes[..*above]) {
                load.force += weight;
                load.torque += (from_vector(body.center_of_mass()) - axis.anchor).cross(&weight);
            }
        }
        let driven = self.joints.iter().filter_map(|j| physics.joints[*j].as_ref());
        for ((load, axis), driven) in borne.iter_mut().zip(&axes).zip(driven) {
            load.leave_to_motor(axis, from_vector(physics.world.bodies[driven.child].center_of_mass()));
        }
        let inertia = DMatrix::from_fn(n, n, |i, j| sums.lower[i.max(j) * n + i.min(j)]);
        ArmEquation { inertia, bias: DVector::from_column_slice(&sums.bias), borne }
    }
}

impl BorneLoad {
    /// Takes off what the motor does: a torque about the axis, or a push through the middle of the child.
    fn leave_to_motor(&mut self, axis: &MovingAxis, middle: SpaceVector) {
        match axis.motion {
            JointMotion::Hinge => self.torque -= axis.axis * axis.axis.dot(&self.torque),
            JointMotion::Slider => {
                let push = axis.axis * axis.axis.dot(&self.force);
                self.force -= push;
                self.torque -= (middle - axis.anchor).cross(&push);
            }
        }
    }
}

/// What is added up over the bodies: of the inertia, which is symmetric, the part on and below the diagonal, in rows.
#[derive(Clone, Debug, Default)]
struct InertiaSums {
    lower: Vec<f64>,
    bias: Vec<f64>,
    /// The columns of Jᵥ and Jω of the body that is looked at, each in its three coordinates.
    columns: [Vec<f64>; 6],
}

impl InertiaSums {
    /// Begins anew, for so many joints.
    fn begin(&mut self, joints: usize) {
        for (sums, size) in [(&mut self.lower, joints * joints), (&mut self.bias, joints)] {
            sums.clear();
            sums.resize(size, 0.0);
        }
    }

    fn add(&mut self, axes: &[MovingAxis], link: &LinkMotion, body: &RigidBody) {
        let (mass, centre) = (f64::from(body.mass()), from_vector(body.center_of_mass()));
        let inertia = world_inertia(body);
        let arm = centre - link.at;
        let rate = link.rate + link.turn_rate.cross(&arm) + link.turn.cross(&link.turn.cross(&arm));
        let force = rate * mass;
        let torque = inertia * link.turn_rate + link.turn.cross(&(inertia * link.turn));
        self.columns.iter_mut().for_each(Vec::clear);
        let rows = self.lower.chunks_exact_mut(self.bias.len().max(1));
        for (i, (axis, row)) in axes.iter().zip(rows).enumerate() {
            let (v, w) = match axis.motion {
                JointMotion::Hinge => (axis.axis.cross(&(centre - axis.anchor)), axis.axis),
                JointMotion::Slider => (axis.axis, SpaceVector::zeros()),
            };
            self.columns.iter_mut().zip(v.iter().chain(&w)).for_each(|(column, x)| column.push(*x));
            self.bias[i] += v.dot(&force) + w.dot(&torque);
            let (mv, iw) = (v * mass, inertia * w);
            let [vx, vy, vz, wx, wy, wz] = self.columns.each_ref().map(|column| &column[..=i]);
            for (j, sum) in row[..=i].iter_mut().enumerate() {
                // As products of vectors, but several at a time.
                *sum += (mv.x * vx[j] + mv.y * vy[j] + mv.z * vz[j])
                    + (iw.x * wx[j] + iw.y * wy[j] + iw.z * wz[j]);
            }
        }
    }
}

impl PhysicsAdapter {
    fn moving_axis(&self, joint: usize, driven: &DrivenJoint) -> MovingAxis {
        let (axis, anchor) = (driven.place.axis, driven.place.anchor);
        MovingAxis { motion: driven.motion, axis, anchor, speed: self.joint_speed(joint) }
    }
}

/// `against` is the acceleration that stands for the weight: everything is as if the base rose with it.
fn link_motions(axes: &[MovingAxis], against: SpaceVector) -> Vec<LinkMotion> {
    let zero = SpaceVector::zeros();
    let mut last = LinkMotion { at: zero, turn: zero, turn_rate: zero, rate: against };
    let mut links = Vec::with_capacity(axes.len());
    for (i, a) in axes.iter().enumerate() {
        if i == 0 {
            last.at = a.anchor;
        }
        let way = a.anchor - last.at;
        let mut rate = last.rate + last.turn_rate.cross(&way) + last.turn.cross(&last.turn.cross(&way));
        let (mut turn, mut turn_rate) = (last.turn, last.turn_rate);
        match a.motion {
            JointMotion::Hinge => {
                turn += a.axis * a.speed;
                turn_rate += last.turn.cross(&(a.axis * a.speed));
            }
            JointMotion::Slider => rate += last.turn.cross(&(a.axis * (2.0 * a.speed))),
        }
        last = LinkMotion { at: a.anchor, turn, turn_rate, rate };
        links.push(last);
    }
    links
}

fn world_inertia(body: &RigidBody) -> Matrix3<f64> {
    let local = body.mass_properties().local_mprops.reconstruct_inertia_matrix();
    let turn = crate::math::from_pose(body.position()).turn.to_rotation_matrix();
    let column = |i: usize| from_vector(local.col(i));
    let local = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    turn.matrix() * local * turn.matrix().transpose()
}
