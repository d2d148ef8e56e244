//! Columns of numbers as documents have them: whole, and as differences.

use crate::document::{PoseNumbers, PoseTrack};

/// Tenths of a millimetre in a metre, and ten-thousandths in 1.
pub const FINE: f64 = 10_000.0;
/// Hundredths of a newton in a newton.
pub const FORCE: f64 = 100.0;

/// The first value, and then what each differs from the one before.
#[must_use]
pub fn differences(values: impl IntoIterator<Item = i64>) -> Vec<i64> {
    rows(&values.into_iter().collect::<Vec<_>>(), 1)
}

/// The values of differences.
#[must_use]
pub fn sums(differences: &[i64]) -> Vec<i64> {
    let add = |sum: &mut i64, difference: &i64| {
        *sum = sum.wrapping_add(*difference);
        Some(*sum)
    };
    differences.iter().scan(0, add).collect()
}

/// The same for rows of numbers that lie one after the other: each differs from the one in the same place of the row before.
#[must_use]
pub fn rows(values: &[i64], width: usize) -> Vec<i64> {
    let before = std::iter::repeat_n(&0, width).chain(values);
    values.iter().zip(before).map(|(value, before)| value - before).collect()
}

/// A value and what is missing as whole numbers of `scale`, as differences; what is not finite is no value.
#[must_use]
pub fn samples(values: impl IntoIterator<Item = f64>, scale: f64) -> Vec<Option<i64>> {
    let mut before = 0;
    let difference = |value: f64| {
        value.is_finite().then(|| {
            let whole = (value / scale).round() as i64;
            whole - std::mem::replace(&mut before, whole)
        })
    };
    values.into_iter().map(difference).collect()
}

/// How far a body may be drawn from where it was: metres, and parts of a quaternion.
#[derive(Clone, Copy, Debug)]
pub struct PoseTolerance {
    pub place: f64,
    pub turn: f64,
}

impl Default for PoseTolerance {
    fn default() -> Self {
        Self { place: 0.001, turn: 0.002 }
    }
}

/// The track of a body from its poses at many times, with as few of them as it takes to stay within the tolerance; none if it never moves.
#[must_use]
pub fn pose_track(body: usize, poses: &[(u64, PoseNumbers)], tolerance: PoseTolerance) -> Option<PoseTrack> {
    let poses = continuous(poses);
    let kept = keyframes(&poses, tolerance);
    let (_, first) = poses.first()?;
    if kept.iter().all(|(_, pose)| is_near(pose, first, tolerance)) {
        return None;
    }
    let whole = |numbers: &[f64]| numbers.iter().map(|n| (n * FINE).round() as i64).collect::<Vec<_>>();
    let (mut places, mut turns) = (Vec::new(), Vec::new());
    for (_, [x, y, z, turn @ ..]) in &kept {
        places.extend(whole(&[*x, *y, *z]));
        turns.extend(whole(turn));
    }
    let turns = rows(&turns, 4);
    let is_turning = turns.iter().skip(4).any(|d| *d != 0) || turns.first_chunk() != Some(&[0, 0, 0, 10_000]);
    Some(PoseTrack {
        body,
        t: differences(kept.iter().map(|(t, _)| *t as i64)),
        p: rows(&places, 3),
        q: if is_turning { turns } else { Vec::new() },
    })
}

/// A track with as few of its times as it takes to stay within a wider tolerance of it.
#[must_use]
pub fn coarser(track: &PoseTrack, tolerance: PoseTolerance) -> PoseTrack {
    let (times, places, turns) = (summed(&track.t, 1), summed(&track.p, 3), summed(&track.q, 4));
    let part = |whole: &i64| *whole as f64 / FINE;
    let upright = [0, 0, 0, FINE as i64];
    let turns = turns.chunks_exact(4).chain(std::iter::repeat(upright.as_slice()));
    let poses: Vec<(u64, PoseNumbers)> = times
        .iter()
        .zip(places.chunks_exact(3))
        .zip(turns)
        .map(|((t, place), turn)| {
            let mut pose = [0.0; 7];
            for (number, whole) in pose.iter_mut().zip(place.iter().chain(turn)) {
                *number = part(whole);
            }
            (t.unsigned_abs(), pose)
        })
        .collect();
    // What hardly moves is left as it was: without a track it would be where it was at the start.
    pose_track(track.body, &poses, tolerance).unwrap_or_else(|| track.clone())
}

/// The rows that differences were made of.
fn summed(column: &[i64], width: usize) -> Vec<i64> {
    let mut row = vec![0_i64; width];
    let mut values = Vec::with_capacity(column.len());
    for differences in column.chunks(width) {
        for (sum, difference) in row.iter_mut().zip(differences) {
            *sum += difference;
            values.push(*sum);
        }
    }
    values
}

/// The same orientations, with signs by which each is on the near side of the one before.
fn continuous(poses: &[(u64, PoseNumbers)]) -> Vec<(u64, PoseNumbers)> {
    let mut before: Option<PoseNumbers> = None;
    let turned = |(t, pose): &(u64, PoseNumbers)| {
        let [x, y, z, i, j, k, w] = *pose;
        let is_far = before.is_some_and(|[.., bi, bj, bk, bw]| i * bi + j * bj + k * bk + w * bw < 0.0);
        let pose = if is_far { [x, y, z, -i, -j, -k, -w] } else { *pose };
        before = Some(pose);
        (*t, pose)
    };
    poses.iter().map(turned).collect()
}

fn is_near(a: &PoseNumbers, b: &PoseNumbers, tolerance: PoseTolerance) -> bool {
    let limits = [tolerance.place, tolerance.place, tolerance.place].into_iter().chain([tolerance.turn; 4]);
    a.iter().zip(b).zip(limits).all(|((a, b), limit)| (a - b).abs() <= limit)
}

/// Those between which the others lie on lines: the longest line from each on that leaves nothing out.
///
/// What lies between two that are kept allows the line a range of slopes in each number; the line goes on while there is one for all.
fn keyframes(poses: &[(u64, PoseNumbers)], tolerance: PoseTolerance) -> Vec<(u64, PoseNumbers)> {
    let limits = [tolerance.place, tolerance.place, tolerance.place, tolerance.turn, tolerance.turn];
    let limits: Vec<f64> = limits.into_iter().chain([tolerance.turn; 2]).collect();
    let mut kept: Vec<(u64, PoseNumbers)> = poses.first().copied().into_iter().collect();
    let Some(mut from) = kept.first().copied() else { return kept };
    let free = [(f64::NEG_INFINITY, f64::INFINITY); 7];
    let (mut slopes, mut last) = (free, from);
    for &(t, pose) in poses.iter().skip(1) {
        if t == last.0 {
            continue;
        }
        let span = |from: &(u64, PoseNumbers)| (t - from.0) as f64;
        let rises = |from: &(u64, PoseNumbers)| -> Vec<f64> {
            let span = span(from);
            pose.iter().zip(&from.1).map(|(to, from)| (to - from) / span).collect()
        };
        let fits = rises(&from).iter().zip(&slopes).all(|(rise, (low, high))| low <= rise && rise <= high);
        if !fits {
            kept.push(last);
            (from, slopes) = (last, free);
        }
        let rise = rises(&from);
        for (((low, high), rise), limit) in slopes.iter_mut().zip(rise).zip(&limits) {
            let give = limit / span(&from);
            (*low, *high) = (low.max(rise - give), high.min(rise + give));
        }
        last = (t, pose);
    }
    if last.0 != from.0 {
        kept.push(last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_add_up_to_what_was_given() {
        assert_eq!(differences([5, 7, 7, 4]), [5, 2, 0, -3]);
        assert_eq!(rows(&[1, 2, 3, 5, 6, 1], 2), [1, 2, 2, 3, 3, -4]);
        assert_eq!(summed(&rows(&[1, 2, 3, 5, 6, 1], 2), 2), [1, 2, 3, 5, 6, 1]);
    }

    #[test]
    fn what_is_not_finite_is_no_value() {
        let column = samples([0.5, f64::NAN, 0.75, f64::INFINITY], 0.25);
        assert_eq!(column, [Some(2), None, Some(1), None]);
    }

    /// Where a track says that the body was.
    fn place(track: &PoseTrack, t: i64) -> Vec<f64> {
        let (times, places) = (summed(&track.t, 1), summed(&track.p, 3));
        let next = times.iter().position(|at| *at >= t).unwrap_or(times.len() - 1).max(1);
        let part = (t - times[next - 1]) as f64 / (times[next] - times[next - 1]) as f64;
        let of = |at: usize, axis: usize| places[at * 3 + axis] as f64 / FINE;
        (0..3).map(|axis| of(next - 1, axis) + part * (of(next, axis) - of(next - 1, axis))).collect()
    }

    #[test]
    fn a_track_stays_within_its_tolerance_with_few_times() {
        let at = |t: u64| {
            let s = t as f64 / 1000.0;
            [s.min(2.0), libm_sin(s) * 0.3, 1.0, 0.0, 0.0, 0.0, 1.0]
        };
        let poses: Vec<(u64, PoseNumbers)> = (0..500).map(|i| (i * 10, at(i * 10))).collect();
        let track = pose_track(3, &poses, PoseTolerance::default()).unwrap();
        assert!(track.t.len() < 60, "{}", track.t.len());
        assert!(track.q.is_empty());
        let coarse = coarser(&track, PoseTolerance { place: 0.01, turn: 0.01 });
        assert!(coarse.t.len() * 2 < track.t.len(), "{} of {}", coarse.t.len(), track.t.len());
        for (t, pose) in &poses {
            for (is, was) in place(&coarse, *t as i64).iter().zip(pose) {
                assert!((is - was).abs() < 0.0221, "{t}: {is} {was}");
            }
            for (is, was) in place(&track, *t as i64).iter().zip(pose) {
                assert!((is - was).abs() < 0.0021, "{t}: {is} {was}");
            }
        }
    }

    /// Good enough for a curve, and the same everywhere.
    fn libm_sin(x: f64) -> f64 {
        let x = x - (x / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        x - x.powi(3) / 6.0 + x.powi(5) / 120.0 - x.powi(7) / 5040.0
    }

    #[test]
    fn what_rests_has_no_track_and_orientations_stay_on_one_side() {
        let rest = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0];
        assert_eq!(pose_track(0, &[(0, rest), (10, rest), (20, rest)], PoseTolerance::default()), None);
        assert_eq!(pose_track(0, &[], PoseTolerance::default()), None);
        let turned = |sign: f64| [1.0, 2.0, 3.0, 0.0, 0.0, 0.6 * sign, 0.8 * sign];
        let track =
            pose_track(0, &[(0, rest), (10, turned(1.0)), (20, turned(-1.0))], PoseTolerance::default());
        assert_eq!(summed(&track.unwrap().q, 4), [0, 0, 0, 10_000, 0, 0, 6000, 8000, 0, 0, 6000, 8000]);
    }

    #[test]
    fn a_rest_before_a_jump_stays_a_rest() {
        let at = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let poses = [(0, at(0.0)), (10, at(0.0)), (1000, at(0.0)), (1010, at(1.0)), (2000, at(1.0))];
        let track = pose_track(0, &poses, PoseTolerance::default()).unwrap();
        assert_eq!(summed(&track.t, 1), [0, 1000, 1010, 2000]);
        assert_eq!(summed(&track.p, 3), [0, 0, 0, 0, 0, 0, 10_000, 0, 0, 10_000, 0, 0]);
    }
}
