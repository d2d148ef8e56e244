//! Which of many samples are worth keeping: those between which the others lie on lines.

use hrdsl_ir::Nanos;

/// Keeps as few samples of `N` numbers as it takes to stay within limits of all of them.
///
/// What lies between two that are kept allows the line a range of slopes in each number; the line goes on while there is one for all.
#[derive(Clone, Debug)]
pub(crate) struct KeyframeTrack<const N: usize> {
    limits: [f64; N],
    kept: Vec<(Nanos, [f64; N])>,
    last: Option<(Nanos, [f64; N])>,
    slopes: [(f64, f64); N],
}

const ANY_SLOPE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl<const N: usize> KeyframeTrack<N> {
    pub fn new(limits: [f64; N]) -> Self {
        Self { limits, kept: Vec::new(), last: None, slopes: [ANY_SLOPE; N] }
    }

    /// What was last seen.
    pub fn last(&self) -> Option<&[f64; N]> {
        self.last.as_ref().map(|(_, values)| values)
    }

    /// The next sample. Those that would have come since the last, had anything moved, come at least every `period`.
    pub fn add(&mut self, time: Nanos, values: [f64; N], period: Nanos) {
        let Some((before, held)) = self.last else {
            self.kept.push((time, values));
            self.last = Some((time, values));
            return;
        };
        if time <= before {
            return;
        }
        if time - before > 2 * period {
            self.extend(time - period, held);
        }
        self.extend(time, values);
    }

    fn extend(&mut self, time: Nanos, values: [f64; N]) {
        let Some(mut from) = self.kept.last().copied() else { return };
        let fits = {
            let span = (time - from.0) as f64;
            let rises = values.iter().zip(&from.1).map(|(to, from)| (to - from) / span);
            rises.zip(&self.slopes).all(|(rise, (low, high))| *low <= rise && rise <= *high)
        };
        if !fits && let Some(last) = self.last {
            self.kept.push(last);
            (from, self.slopes) = (last, [ANY_SLOPE; N]);
        }
        let span = (time - from.0) as f64;
        for (((slope, limit), to), from) in self.slopes.iter_mut().zip(&self.limits).zip(&values).zip(&from.1)
        {
            let (rise, give) = ((to - from) / span, limit / span);
            *slope = (slope.0.max(rise - give), slope.1.min(rise + give));
        }
        self.last = Some((time, values));
    }

    /// All that is kept, the last sample among them; nothing if all of it is one and the same within the limits.
    pub fn finish(mut self) -> Vec<(Nanos, [f64; N])> {
        if let Some(last) = self.last
            && self.kept.last().is_none_or(|kept| kept.0 != last.0)
        {
            self.kept.push(last);
        }
        let Some((_, first)) = self.kept.first().copied() else { return self.kept };
        let near = |values: &[f64; N]| {
            values.iter().zip(&first).zip(&self.limits).all(|((a, b), limit)| (a - b).abs() <= *limit)
        };
        if self.kept.iter().all(|(_, values)| near(values)) { Vec::new() } else { self.kept }
    }
}

#[cfg(test)]
mod tests {
    use super::KeyframeTrack;

    fn kept(samples: &[(i64, f64)], limit: f64) -> Vec<(i64, f64)> {
        let mut track = KeyframeTrack::new([limit]);
        for (time, value) in samples {
            track.add(*time, [*value], 10);
        }
        track.finish().into_iter().map(|(time, [value])| (time, value)).collect()
    }

    #[test]
    fn a_line_is_its_ends_and_a_bend_is_kept() {
        let line: Vec<(i64, f64)> = (0..20).map(|i| (i * 10, i as f64)).collect();
        assert_eq!(kept(&line, 0.01), [(0, 0.0), (190, 19.0)]);
        let bend: Vec<(i64, f64)> = (0..20).map(|i| (i * 10, f64::from((i as i32 - 10).abs()))).collect();
        assert_eq!(kept(&bend, 0.01), [(0, 10.0), (100, 0.0), (190, 9.0)]);
    }

    #[test]
    fn what_is_left_out_is_nowhere_farther_than_the_limit_allows() {
        let curve: Vec<(i64, f64)> = (0..400).map(|i| (i * 10, f64::from(i as i32).sqrt() * 3.0)).collect();
        let kept = kept(&curve, 0.05);
        assert!(kept.len() < 40, "{}", kept.len());
        for (time, value) in &curve {
            let next = kept.iter().position(|(t, _)| t >= time).unwrap().max(1);
            let ((t0, a), (t1, b)) = (kept[next - 1], kept[next]);
            let is = a + (b - a) * (time - t0) as f64 / (t1 - t0) as f64;
            assert!((is - value).abs() <= 0.11, "{time}: {is} {value}");
        }
    }

    #[test]
    fn a_rest_in_which_nobody_looked_stays_a_rest() {
        assert_eq!(
            kept(&[(0, 0.0), (10, 1.0), (5000, 2.0)], 0.01),
            [(0, 0.0), (10, 1.0), (4990, 1.0), (5000, 2.0)]
        );
    }

    #[test]
    fn what_never_moves_is_not_kept() {
        assert!(kept(&[(0, 1.0), (10, 1.001), (20, 1.0)], 0.01).is_empty());
        assert!(kept(&[], 0.01).is_empty());
    }
}
