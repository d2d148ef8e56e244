//! Clock regions: which valuations no constraint can tell apart, now or after any delay.

use std::cmp::Ordering;

use hrdsl_ir::ta::ClockOp;

/// The whole part of each clock, and the rank of its fraction among all fractions: 0 is none, and there are no gaps.
pub type Region = Vec<(i64, u8)>;

/// What is told apart.
#[derive(Clone, Copy, Debug)]
pub struct Grain {
    /// The greatest constant, in units.
    pub most: i64,
    /// Differences of clocks are compared, too: then they are kept up to `most`, whatever the clocks themselves are.
    pub differences: bool,
}

/// The clock is above all constants, and no more is known of it.
fn beyond(grain: Grain, clock: (i64, u8)) -> bool {
    !grain.differences && clock.0 > grain.most
}

/// Puts a region into its one form.
pub fn tidy(grain: Grain, region: &mut Region) {
    if grain.differences {
        close_gaps(grain, region);
    } else {
        for c in region.iter_mut() {
            if c.0 > grain.most || (c.0 == grain.most && c.1 > 0) {
                *c = (grain.most + 1, 0);
            }
        }
    }
    let mut ranks: Vec<u8> = region.iter().map(|c| c.1).filter(|&r| r > 0).collect();
    ranks.sort_unstable();
    ranks.dedup();
    for c in region.iter_mut() {
        c.1 = ranks.iter().position(|&r| r == c.1).map_or(0, |at| at as u8 + 1);
    }
}

/// Between neighbours in size (0 among them) that are further apart than `most`, whole units are left out.
// INVARIANT: differences of at most `most` stay what they are, and greater ones stay greater; delays, resets and copies keep that.
fn close_gaps(grain: Grain, region: &mut Region) {
    let mut order: Vec<usize> = (0..region.len()).collect();
    order.sort_unstable_by_key(|&i| region[i]);
    let (mut below, mut less) = ((0, 0), 0);
    for i in order {
        let mut now = region[i];
        now.0 -= less;
        let enough = if now.1 > below.1 { grain.most } else { grain.most + 1 };
        let more = (now.0 - below.0 - enough).max(0);
        less += more;
        now.0 -= more;
        region[i] = now;
        below = now;
    }
}

/// The next region in time; itself, if time changes nothing any more.
pub fn later(grain: Grain, region: &Region) -> Region {
    let mut next = region.clone();
    if region.iter().any(|&c| !beyond(grain, c) && c.1 == 0) {
        for c in next.iter_mut().filter(|c| !beyond(grain, **c)) {
            c.1 += 1;
        }
    } else if let Some(last) = region.iter().filter(|&&c| !beyond(grain, c)).map(|c| c.1).max() {
        for c in next.iter_mut().filter(|c| c.1 == last && !beyond(grain, **c)) {
            *c = (c.0 + 1, 0);
        }
    }
    tidy(grain, &mut next);
    next
}

/// Whether `x − y op bound` holds for the whole region. `None`: the region does not know.
pub fn holds(grain: Grain, x: (i64, u8), y: (i64, u8), op: ClockOp, bound: i64) -> Option<bool> {
    if bound.abs() > grain.most || beyond(grain, y) {
        return None;
    }
    let fraction = match x.1.cmp(&y.1) {
        Ordering::Less => -1,
        Ordering::Equal => i64::from(beyond(grain, x)),
        Ordering::Greater => 1,
    };
    // Twice the value: even where it is whole, odd between two whole numbers.
    let (value, bound) = (2 * (x.0 - y.0) + fraction, 2 * bound);
    Some(match op {
        ClockOp::Lt => value < bound,
        ClockOp::Le => value <= bound,
        ClockOp::Eq => value == bound,
        ClockOp::Ge => value >= bound,
        ClockOp::Gt => value > bound,
    })
}

#[test]
fn time_goes_through_all_regions_of_two_clocks() {
    let grain = Grain { most: 1, differences: false };
    let mut region = vec![(0, 0), (0, 1)];
    let mut seen = vec![region.clone()];
    while later(grain, &region) != region {
        region = later(grain, &region);
        seen.push(region.clone());
    }
    let expected = [
        [(0, 0), (0, 1)],
        [(0, 1), (0, 2)],
        [(0, 1), (1, 0)],
        [(0, 1), (2, 0)],
        [(1, 0), (2, 0)],
        [(2, 0), (2, 0)],
    ];
    assert_eq!(seen, expected.map(|r| r.to_vec()));
}

#[test]
fn differences_are_kept_while_clocks_grow() {
    let grain = Grain { most: 2, differences: true };
    let mut region = vec![(1, 0), (0, 0)];
    for _ in 0..50 {
        assert_eq!(holds(grain, region[0], region[1], ClockOp::Eq, 1), Some(true));
        region = later(grain, &region);
    }
    assert!(region[0].0 < 6, "{region:?}");
    assert_eq!(holds(grain, region[1], (0, 0), ClockOp::Gt, 2), Some(true));
}
