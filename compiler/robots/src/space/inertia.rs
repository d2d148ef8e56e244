//! Inertia tensors: their principal moments, and whether a body can have them.

/// A symmetric tensor, kg m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InertiaTensor {
    pub ixx: f64,
    pub ixy: f64,
    pub ixz: f64,
    pub iyy: f64,
    pub iyz: f64,
    pub izz: f64,
}

/// How much of the largest moment may be lost to rounding: descriptions write six digits, and less.
const ROUNDING: f64 = 1e-3;
/// Turns of Jacobi's method; three by three is done after five or six rounds of three.
const MOST_TURNS: usize = 36;

impl InertiaTensor {
    /// The moments about the principal axes, the smallest first.
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        let (mut a, mut b, mut c) = (self.ixx, self.iyy, self.izz);
        let (mut ab, mut ac, mut bc) = (self.ixy, self.ixz, self.iyz);
        // Jacobi: a turn in one plane makes its product of inertia 0; the names rotate, so that each plane has its turn.
        for _ in 0..MOST_TURNS {
            if ab != 0.0 {
                let theta = (b - a) / (2.0 * ab);
                let t = theta.signum() / (theta.abs() + libm::sqrt(theta * theta + 1.0));
                let t = if t.is_finite() { t } else { 0.0 };
                let cosine = 1.0 / libm::sqrt(t * t + 1.0);
                let sine = t * cosine;
                (a, b, ab) = (a - t * ab, b + t * ab, 0.0);
                (ac, bc) = (cosine * ac - sine * bc, sine * ac + cosine * bc);
            }
            (a, b, c, ab, ac, bc) = (b, c, a, bc, ab, ac);
        }
        let mut moments = [a, b, c];
        moments.sort_by(f64::total_cmp);
        moments
    }

    /// Why no body has this inertia; `None` if one can have it, or could but for rounding.
    #[must_use]
    pub fn flaw(&self) -> Option<String> {
        let moments @ [small, middle, large] = self.principal_moments();
        let told = moments.map(|m| format!("{m:.3e}")).join(", ");
        if small <= 0.0 || small.is_nan() {
            Some(format!("its principal moments are {told}, and all must be positive"))
        } else if small + middle < large * (1.0 - ROUNDING) {
            Some(format!("its principal moments are {told}, and the largest exceeds the sum of the others"))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::transform::RigidTransform;
    use proptest::prelude::*;

    fn diagonal(moments: [f64; 3], turn: &RigidTransform) -> InertiaTensor {
        let r = turn.rotation;
        let at = |i: usize, j: usize| (0..3).map(|k| r[i][k] * moments[k] * r[j][k]).sum();
        InertiaTensor {
            ixx: at(0, 0),
            ixy: at(0, 1),
            ixz: at(0, 2),
            iyy: at(1, 1),
            iyz: at(1, 2),
            izz: at(2, 2),
        }
    }

    proptest! {
        #[test]
        fn moments_are_found_however_the_body_is_turned(
            mut moments in [-1.0..5.0f64, 0.0..5.0, 0.0..5.0], rpy in [-3.0..3.0f64, -3.0..3.0, -3.0..3.0]
        ) {
            let turned = diagonal(moments, &RigidTransform::from_origin([0.0; 3], rpy));
            moments.sort_by(f64::total_cmp);
            for (found, expected) in turned.principal_moments().iter().zip(moments) {
                prop_assert!((found - expected).abs() < 1e-9, "{:?} {:?}", turned.principal_moments(), moments);
            }
        }
    }

    #[test]
    fn bodies_have_positive_moments_of_which_none_exceeds_the_others() {
        let of = |m| diagonal(m, &RigidTransform::from_origin([0.0; 3], [0.1, 0.2, 0.3]));
        assert_eq!(of([1.0, 1.0, 1.9]).flaw(), None);
        assert_eq!(of([1.0, 1.0, 2.0]).flaw(), None);
        assert!(of([1.0, 1.0, 2.1]).flaw().unwrap().contains("largest"));
        assert!(of([-0.1, 1.0, 1.0]).flaw().unwrap().contains("positive"));
        assert!(InertiaTensor::default().flaw().is_some());
    }
}
