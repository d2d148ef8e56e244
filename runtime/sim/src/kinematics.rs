//! From a place for the tool point to postures of the arm, by damped least squares.
//!
//! Every iteration solves (J Jᵀ + λ² I) y = e for the remaining way e and steps by Jᵀ y (Nakamura and Hanafusa 1986,
//! Wampler 1986). Two weaker wishes guide what the place leaves open: the direction that was up in the tip's frame at the
//! start stays up, so that what is held is carried upright; and, in the null space, the posture stays near the present one
//! and, weaker, near the arm's starting posture, so that postures do not drift from one motion to the next.

use hrdsl_ir::world::{ENDLESS, JointMotion};
use nalgebra::{DMatrix, DVector};

use crate::math::{BodyFrame, RotationQuat, SpaceVector, about, angle_between};

/// A joint as the planner sees it, in the world at the start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KinematicLink {
    pub motion: JointMotion,
    pub anchor: SpaceVector,
    pub axis: SpaceVector,
    pub lo: f64,
    pub hi: f64,
    /// Where it is at the start.
    pub start: f64,
}

/// The geometry of an arm at the start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KinematicChain {
    pub links: Vec<KinematicLink>,
    /// The tool point in the world at the start.
    pub tool: SpaceVector,
}

/// A posture that brings the tool to a place, or the nearest one found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ArmPosture {
    pub joints: Vec<f64>,
    /// Metres from the place.
    pub error: f64,
}

/// What is thought of a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PostureFit {
    Free,
    /// Something is near.
    Narrow,
    Refused,
}

/// A posture that arrives, and is not refused.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AllowedPosture {
    pub joints: Vec<f64>,
    /// Of the palm from upright, rad.
    pub tilt: f64,
    pub is_narrow: bool,
}

/// The postures that were found for a place.
pub(crate) struct FoundPostures {
    pub allowed: Vec<AllowedPosture>,
    /// One that arrives, and was refused.
    pub refused: Option<Vec<f64>>,
    /// Metres from the place of the nearest.
    pub error: f64,
}

/// Where the tool is in a posture, and what each joint's motion does to it.
struct ForwardKinematics {
    tool: SpaceVector,
    up: SpaceVector,
    /// Motion, axis and anchor of each joint.
    joints: Vec<(JointMotion, SpaceVector, SpaceVector)>,
}

/// Good enough: far below what the physics can keep.
const CONVERGED: f64 = 1e-4;
/// What a unit of tilt weighs, in metres.
const TILT: f64 = 0.15;
/// How far from a joint's limits postures are sought, rad.
const MARGIN: f64 = 0.02;
const RESTARTS: u32 = 12;

impl KinematicLink {
    /// Where postures are sought: a joint without limits goes once round.
    fn range(&self) -> (f64, f64) {
        if self.motion == JointMotion::Hinge && self.hi - self.lo >= ENDLESS {
            (self.start - std::f64::consts::PI, self.start + std::f64::consts::PI)
        } else {
            (self.lo, self.hi)
        }
    }

    /// The frame of what hangs on this joint, from that of what it hangs on.
    fn moved(&self, frame: &BodyFrame, to: f64) -> BodyFrame {
        let by = to - self.start;
        match self.motion {
            JointMotion::Hinge => {
                let anchor = frame.point(self.anchor);
                let turn = frame.turn * about(self.axis, by);
                BodyFrame::new(anchor - turn * self.anchor, turn)
            }
            JointMotion::Slider => BodyFrame::new(frame.at + frame.turn * self.axis * by, frame.turn),
        }
    }
}

impl KinematicChain {
    fn forward(&self, q: &[f64]) -> ForwardKinematics {
        let mut frame = BodyFrame::new(SpaceVector::zeros(), RotationQuat::identity());
        let mut joints = Vec::with_capacity(q.len());
        for (link, angle) in self.links.iter().zip(q) {
            joints.push((link.motion, frame.turn * link.axis, frame.point(link.anchor)));
            frame = link.moved(&frame, *angle);
        }
        ForwardKinematics { tool: frame.point(self.tool), up: frame.turn * SpaceVector::z(), joints }
    }

    /// How what hangs on the base, and on each joint, is moved from where it is at zero: one frame more than joints.
    pub fn frames(&self, q: &[f64], base: &BodyFrame) -> Vec<BodyFrame> {
        let mut frames = Vec::with_capacity(q.len() + 1);
        frames.push(*base);
        for (link, angle) in self.links.iter().zip(q) {
            frames.push(link.moved(&frames[frames.len() - 1], *angle));
        }
        frames
    }

    /// The tool point, in the world if the base is where it was at the start.
    pub fn tool_at(&self, q: &[f64]) -> SpaceVector {
        self.forward(q).tool
    }

    /// Postures that bring the tool to `target`, and what is thought of them.
    ///
    /// Tried in order: from the present posture, and if that arrives and is free, no further; from the middle of the limits
    /// and a fixed sequence of postures; then, if none arrives and is allowed, from these postures whatever becomes of the palm.
    pub fn postures(
        &self,
        from: &[f64],
        target: SpaceVector,
        fit: &dyn Fn(&[f64]) -> PostureFit,
    ) -> FoundPostures {
        let mut found = FoundPostures { allowed: Vec::new(), refused: None, error: f64::INFINITY };
        self.add(&mut found, self.descend(from, from, target), fit);
        if found.allowed.iter().any(|posture| !posture.is_narrow) {
            return found;
        }
        // Each with its own posture to stay near: the same one would lead to where the first led.
        for seed in (0..=RESTARTS).map(|n| self.seed(n)) {
            let near: Vec<f64> = from.iter().zip(&seed).map(|(a, b)| (a + b) / 2.0).collect();
            self.add(&mut found, self.descend(&near, &near, target), fit);
        }
        // To keep the palm upright on the way leads now and then to a limit that the place itself does not ask for.
        for n in 0..=RESTARTS {
            if !found.allowed.is_empty() {
                break;
            }
            self.add(&mut found, self.approach(self.within(&self.seed(n)), 160, target), fit);
        }
        found
    }

    fn add(&self, found: &mut FoundPostures, posture: ArmPosture, fit: &dyn Fn(&[f64]) -> PostureFit) {
        found.error = found.error.min(posture.error);
        if posture.error > CONVERGED {
            return;
        }
        let fit = fit(&posture.joints);
        if fit == PostureFit::Refused {
            found.refused.get_or_insert(posture.joints);
            return;
        }
        let tilt = angle_between(&self.forward(&posture.joints).up, &SpaceVector::z());
        let is_narrow = fit == PostureFit::Narrow;
        found.allowed.push(AllowedPosture { joints: posture.joints, tilt, is_narrow });
    }

    /// The middle of the limits, then points of Halton's sequence.
    fn seed(&self, n: u32) -> Vec<f64> {
        const PRIMES: [u32; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
        self.links
            .iter()
            .enumerate()
            .map(|(i, l)| {
                let part = if n == 0 { 0.5 } else { halton(n, PRIMES[i % PRIMES.len()]) };
                let (lo, hi) = l.range();
                lo + part * (hi - lo)
            })
            .collect()
    }

    fn descend(&self, seed: &[f64], near: &[f64], target: SpaceVector) -> ArmPosture {
        let towards_start = |(q, link): (&f64, &KinematicLink)| link.start + (q - link.start) / 1.2;
        let wish: Vec<f64> = near.iter().zip(&self.links).map(towards_start).collect();
        let mut q = self.within(seed);
        for _ in 0..160 {
            self.iterate(&mut q, Some(&wish), target);
        }
        self.approach(q, 60, target)
    }

    /// Goes on to the target from a posture within the limits, in so many steps, whatever becomes of the palm.
    fn approach(&self, mut q: Vec<f64>, steps: u32, target: SpaceVector) -> ArmPosture {
        for _ in 0..steps {
            if (target - self.forward(&q).tool).norm() < CONVERGED / 10.0 {
                break;
            }
            self.iterate(&mut q, None, target);
        }
        let error = (target - self.forward(&q).tool).norm();
        ArmPosture { joints: q, error }
    }

    fn limits(&self, i: usize) -> (f64, f64) {
        let l = &self.links[i];
        let margin = MARGIN.min((l.hi - l.lo) / 4.0);
        (l.lo + margin, l.hi - margin)
    }

    fn within(&self, q: &[f64]) -> Vec<f64> {
        q.iter()
            .enumerate()
            .map(|(i, x)| {
                let (lo, hi) = self.limits(i);
                x.clamp(lo, hi)
            })
            .collect()
    }

    /// One step towards the target; with a wish also upright, and in the null space towards it.
    fn iterate(&self, q: &mut [f64], wish: Option<&[f64]>, target: SpaceVector) {
        let now = self.forward(q);
        let (mut jacobian, error) = task(&now, target, wish.is_some());
        // A joint that the step would push beyond its limit takes no part in the step.
        for _ in 0..3 {
            let step = damped(&jacobian, &error, wish.map(|w| pull(w, q)));
            let blocked: Vec<usize> = (0..q.len())
                .filter(|&i| {
                    let (lo, hi) = self.limits(i);
                    let there = q[i] + step[i];
                    jacobian.column(i).norm_squared() > 0.0
                        && ((there < lo && q[i] <= lo + 1e-9) || (there > hi && q[i] >= hi - 1e-9))
                })
                .collect();
            if blocked.is_empty() {
                for (i, x) in q.iter_mut().enumerate() {
                    let (lo, hi) = self.limits(i);
                    *x = (*x + step[i]).clamp(lo, hi);
                }
                return;
            }
            for i in blocked {
                jacobian.column_mut(i).fill(0.0);
            }
        }
    }
}

/// The Jacobian and the remaining distance: of the place, and if asked of the tilt.
fn task(now: &ForwardKinematics, target: SpaceVector, upright: bool) -> (DMatrix<f64>, DVector<f64>) {
    let rows = if upright { 5 } else { 3 };
    let mut jacobian = DMatrix::zeros(rows, now.joints.len());
    let mut step = target - now.tool;
    let far = step.norm();
    if far > 0.1 {
        step *= 0.1 / far;
    }
    let mut error = DVector::zeros(rows);
    error.rows_mut(0, 3).copy_from(&step);
    for (i, (motion, axis, anchor)) in now.joints.iter().enumerate() {
        let turns = *motion == JointMotion::Hinge;
        let v = if turns { axis.cross(&(now.tool - anchor)) } else { *axis };
        jacobian.view_mut((0, i), (3, 1)).copy_from(&v);
        if upright && turns {
            let t = axis.cross(&now.up) * TILT;
            jacobian[(3, i)] = t.x;
            jacobian[(4, i)] = t.y;
        }
    }
    if upright {
        error[3] = -now.up.x * TILT;
        error[4] = -now.up.y * TILT;
    }
    (jacobian, error)
}

fn pull(wish: &[f64], q: &[f64]) -> DVector<f64> {
    DVector::from_iterator(q.len(), wish.iter().zip(q).map(|(w, x)| 0.2 * (w - x)))
}

/// Jᵀ (J Jᵀ + λ²)⁻¹ e, plus the part of `pull` that does not move the tool; no joint steps by more than 0.2 rad.
fn damped(j: &DMatrix<f64>, error: &DVector<f64>, pull: Option<DVector<f64>>) -> DVector<f64> {
    let mut square = j * j.transpose();
    let damping = 1e-5 + 0.05 * error.norm_squared();
    for i in 0..square.nrows() {
        square[(i, i)] += damping;
    }
    // Positive definite by the damping, so that the decomposition always exists.
    let Some(solver) = square.cholesky() else { return DVector::zeros(j.ncols()) };
    let mut step = j.transpose() * solver.solve(error);
    if let Some(mut pull) = pull {
        for i in 0..pull.len() {
            if j.column(i).norm_squared() == 0.0 {
                pull[i] = 0.0;
            }
        }
        step += &pull - j.transpose() * solver.solve(&(j * &pull));
    }
    let largest = step.amax();
    if largest > 0.2 {
        step *= 0.2 / largest;
    }
    step
}

/// The radical inverse of `n` in a base: 0..1, evenly spread.
fn halton(mut n: u32, base: u32) -> f64 {
    let (mut result, mut part) = (0.0, 1.0);
    while n > 0 {
        part /= f64::from(base);
        result += part * f64::from(n % base);
        n /= base;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Shoulder yaw, shoulder pitch, elbow pitch; two links of 0.4 m, stretched along x.
    fn three() -> KinematicChain {
        let motion = JointMotion::Hinge;
        let link = |x: f64, axis| KinematicLink {
            motion,
            anchor: SpaceVector::new(x, 0.0, 1.0),
            axis,
            lo: -2.5,
            hi: 2.5,
            start: 0.0,
        };
        KinematicChain {
            links: vec![
                link(0.0, SpaceVector::z()),
                link(0.0, SpaceVector::y()),
                link(0.4, SpaceVector::y()),
            ],
            tool: SpaceVector::new(0.8, 0.0, 1.0),
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let chain = three();
        let q = [0.3, -0.5, 0.9];
        let (j, _) = task(&chain.forward(&q), SpaceVector::zeros(), true);
        for i in 0..3 {
            let h = 1e-6;
            let mut more = q;
            more[i] += h;
            let (a, b) = (chain.forward(&q), chain.forward(&more));
            let v = (b.tool - a.tool) / h;
            let t = (b.up - a.up) / h * TILT;
            for row in 0..3 {
                assert!((j[(row, i)] - v[row]).abs() < 1e-5);
            }
            assert!((j[(3, i)] - t.x).abs() < 1e-5 && (j[(4, i)] - t.y).abs() < 1e-5);
        }
    }

    #[test]
    fn what_is_out_of_reach_gives_the_nearest() {
        let found =
            three().postures(&[0.0, 0.3, 0.3], SpaceVector::new(2.0, 0.0, 1.0), &|_| PostureFit::Free);
        assert!(found.allowed.is_empty() && found.refused.is_none());
        assert!((found.error - 1.2).abs() < 0.01, "{}", found.error);
    }

    /// Here every way that keeps the palm upright ends at the limit of the first joint, with the arm turned about.
    #[test]
    fn a_place_that_only_a_tilted_palm_reaches_is_reached() {
        let chain = three();
        let joints = [0.532_975_126_504_515_5, 0.510_019_768_580_971_8, 2.030_049_297_275_211_6];
        let found = chain.postures(&[0.0, 0.1, 0.5], chain.tool_at(&joints), &|_| PostureFit::Free);
        assert!(!found.allowed.is_empty(), "{}", found.error);
    }

    #[test]
    fn what_is_not_allowed_is_not_found() {
        let chain = three();
        let target = chain.tool_at(&[0.4, 0.2, 1.0]);
        for side in [-1.0, 1.0] {
            let fit = |q: &[f64]| if q[2] * side > 0.0 { PostureFit::Free } else { PostureFit::Refused };
            let found = chain.postures(&[0.0, 0.1, 0.5], target, &fit);
            assert!(!found.allowed.is_empty() && found.allowed.iter().all(|p| p.joints[2] * side > 0.0));
        }
        let found = chain.postures(&[0.0, 0.1, 0.5], target, &|_| PostureFit::Refused);
        assert!(found.allowed.is_empty() && found.refused.is_some());
    }

    #[test]
    fn a_slider_goes_along_its_axis() {
        let mut chain = three();
        chain.links[0] = KinematicLink {
            motion: JointMotion::Slider,
            anchor: SpaceVector::zeros(),
            axis: SpaceVector::z(),
            lo: 0.0,
            hi: 0.5,
            start: 0.0,
        };
        let tool = chain.tool_at(&[0.3, 0.0, 0.0]);
        assert!((tool - SpaceVector::new(0.8, 0.0, 1.3)).norm() < 1e-12);
        let found = chain.postures(&[0.0, 0.3, 0.3], SpaceVector::new(0.75, 0.0, 1.4), &|_| PostureFit::Free);
        assert!(!found.allowed.is_empty(), "{}", found.error);
    }

    #[test]
    fn halton_in_base_two() {
        assert_eq!([1, 2, 3, 4].map(|n| halton(n, 2)), [0.5, 0.25, 0.75, 0.125]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn reaches_what_forward_kinematics_reaches(a in -2.0f64..2.0, b in -1.2f64..1.2, c in 0.3f64..2.2) {
            let chain = three();
            let target = chain.tool_at(&[a, b, c]);
            let found = chain.postures(&[0.0, 0.1, 0.5], target, &|_| PostureFit::Free);
            prop_assert!(!found.allowed.is_empty(), "{}", found.error);
            prop_assert!((chain.tool_at(&found.allowed[0].joints) - target).norm() < 2e-4);
            for (q, l) in found.allowed[0].joints.iter().zip(&chain.links) {
                prop_assert!((l.lo..=l.hi).contains(q));
            }
        }
    }
}
