//! Ways through the postures of an arm: straight lines with rounded corners, and trajectories given from outside.

/// How far before a corner its rounding begins at most, in seconds at full speed.
const ROUNDING: f64 = 0.2;

/// How far around a corner, beyond its rounding, a path is slow, in seconds at full speed.
const CORNER: f64 = 0.01;
/// The least speed at a corner, as a part of the full one.
const SLOWEST: f64 = 0.05;

/// How far two postures are apart: the seconds that the slowest joint takes at its full speed.
pub(crate) fn span(a: &[f64], b: &[f64], speeds: &[f64]) -> f64 {
    a.iter().zip(b).zip(speeds).fold(0.0, |most, ((a, b), v)| f64::max(most, (a - b).abs() / v))
}

/// The posture between two, 0 the first and 1 the second.
pub(crate) fn between(a: &[f64], b: &[f64], part: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect()
}

/// A path through at least one posture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointRoute {
    points: Vec<Vec<f64>>,
    /// How far each of them is from the first along the path, in seconds at full speed.
    along: Vec<f64>,
    rounding: f64,
}

impl JointRoute {
    pub fn new(points: Vec<Vec<f64>>, speeds: &[f64]) -> JointRoute {
        let mut along = vec![0.0];
        for pair in points.windows(2) {
            let so_far = along[along.len() - 1];
            along.push(so_far + span(&pair[0], &pair[1], speeds));
        }
        JointRoute { points, along, rounding: ROUNDING }
    }

    /// With corners less rounded, so that it keeps closer to its lines.
    pub fn sharper(&self, part: f64) -> JointRoute {
        JointRoute { rounding: self.rounding * part, ..self.clone() }
    }

    pub fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    pub fn end(&self) -> &[f64] {
        &self.points[self.points.len() - 1]
    }

    /// Its corners and ends, by how far along they are.
    pub fn points_where(&self, is_wanted: impl Fn(f64) -> bool) -> impl Iterator<Item = Vec<f64>> {
        let points = self.points.iter().zip(&self.along);
        points.filter(move |(_, along)| is_wanted(**along)).map(|(point, _)| point.clone())
    }

    /// The posture so far along the path.
    pub fn at(&self, s: f64) -> Vec<f64> {
        let last = self.points.len() - 1;
        if let Some(corner) = (1..last).find(|i| (s - self.along[*i]).abs() < self.reach(*i)) {
            // A parabola that leaves one line and comes to the other with their directions.
            let reach = self.reach(corner);
            let u = (s - self.along[corner] + reach) / (2.0 * reach);
            let (from, to) =
                (self.on_lines(self.along[corner] - reach), self.on_lines(self.along[corner] + reach));
            let (a, b) = (between(&from, &self.points[corner], u), between(&self.points[corner], &to, u));
            return between(&a, &b, u);
        }
        self.on_lines(s)
    }

    /// The greatest part of its full speed so far along the path: full, but slower around corners that could not be rounded well.
    pub fn limit(&self, s: f64) -> f64 {
        let corners = 1..self.points.len() - 1;
        let near = corners.filter(|i| (s - self.along[*i]).abs() <= self.reach(*i) + CORNER);
        near.fold(1.0, |limit, i| limit.min((self.reach(i) / ROUNDING).max(SLOWEST)))
    }

    /// The seconds to full speed in which no joint comes to its speed more quickly, in the mean, than it may.
    pub fn rise(&self, accelerations: &[f64]) -> f64 {
        let lengths = self.along.iter().zip(self.along.iter().skip(1)).map(|(from, to)| to - from);
        let ends = self.points.iter().zip(self.points.iter().skip(1));
        let lines = ends.zip(lengths).filter(|(_, length)| *length > 0.0);
        lines.fold(0.0, |rise: f64, ((from, to), length)| rise.max(span(from, to, accelerations) / length))
    }

    pub fn has_corners(&self) -> bool {
        self.points.len() > 2
    }

    /// How far around a corner its rounding goes.
    fn reach(&self, corner: usize) -> f64 {
        let before = self.along[corner] - self.along[corner - 1];
        let after = self.along[corner + 1] - self.along[corner];
        self.rounding.min(before / 2.0).min(after / 2.0)
    }

    fn on_lines(&self, s: f64) -> Vec<f64> {
        let next = self.along.partition_point(|along| *along <= s);
        if next == 0 || next == self.points.len() {
            let end = if next == 0 { 0 } else { self.points.len() - 1 };
            return self.points[end].clone();
        }
        let (from, to) = (self.along[next - 1], self.along[next]);
        between(&self.points[next - 1], &self.points[next], (s - from) / (to - from))
    }
}

/// Postures, each at its time in seconds; between two of them each joint goes at an even speed.
pub(crate) struct JointTrack {
    /// The first at a time above 0, and later ones later.
    pub points: Vec<(f64, Vec<f64>)>,
}

impl JointTrack {
    /// The posture at a time, for an arm that begins at `from`.
    pub fn at(&self, t: f64, from: &[f64]) -> Vec<f64> {
        let next = self.points.partition_point(|(time, _)| *time <= t);
        let Some((end, to)) = self.points.get(next) else {
            return self.points.last().map_or(from, |(_, posture)| posture).to_vec();
        };
        let (begin, before) = match next.checked_sub(1).and_then(|at| self.points.get(at)) {
            Some((time, posture)) => (*time, posture.as_slice()),
            None => (0.0, from),
        };
        between(before, to, (t - begin) / (end - begin))
    }

    pub fn length(&self) -> f64 {
        self.points.last().map_or(0.0, |(time, _)| *time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn corners_are_rounded_and_ends_are_met() {
        let points = vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]];
        let route = JointRoute::new(points, &[1.0, 1.0]);
        assert!((route.length() - 2.0).abs() < 1e-12);
        assert_eq!((route.at(0.0), route.at(2.0)), (vec![0.0, 0.0], vec![1.0, 1.0]));
        assert_eq!(route.at(0.5), [0.5, 0.0]);
        let corner = route.at(1.0);
        assert!(corner[0] < 1.0 && corner[1] > 0.0, "{corner:?}");
        assert_eq!(route.sharper(0.0).at(1.0), [1.0, 0.0]);
    }

    #[test]
    fn a_single_posture_is_a_way() {
        let route = JointRoute::new(vec![vec![0.3]], &[1.0]);
        assert_eq!((route.length(), route.at(0.0), route.at(1.0)), (0.0, vec![0.3], vec![0.3]));
    }

    proptest! {
        #[test]
        fn no_joint_is_faster_than_it_may(
            points in prop::collection::vec(prop::collection::vec(-2.0f64..2.0, 3), 1..6),
            speeds in prop::collection::vec(0.1f64..2.0, 3),
        ) {
            let route = JointRoute::new(points, &speeds);
            let h = route.length() / 500.0;
            for i in 0..500 {
                let (a, b) = (route.at(f64::from(i) * h), route.at(f64::from(i + 1) * h));
                prop_assert!(span(&a, &b, &speeds) <= h * (1.0 + 1e-6) + 1e-12);
            }
        }
    }
}
