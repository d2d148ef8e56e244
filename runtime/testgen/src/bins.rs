//! Why a bin of a cross was not hit, from the numbers that runs had for the coverpoints.

use std::collections::BTreeSet;

use hrdsl_ir::coverage::{BinCondition, CoverBin, Coverage, CoverpointId};

/// Values that are listed one by one, at most.
const LISTED: usize = 8;

/// Which of the bin's conditions was never met, with the values that were reached. `seen` has the numbers of all points
/// for each run, each combination once.
pub fn why(coverage: &Coverage, cross: u16, bin: u16, seen: &BTreeSet<Vec<i64>>) -> String {
    let Some(cross) = coverage.crosses.get(usize::from(cross)) else {
        return "there is no such cross".to_owned();
    };
    let Some(bin) = cross.bins.get(usize::from(bin)) else { return "there is no such bin".to_owned() };
    if seen.is_empty() {
        return "there was no run".to_owned();
    }
    let parts = match &bin.when {
        BinCondition::And(parts) => parts.as_slice(),
        whole @ (BinCondition::In { .. } | BinCondition::Not(_) | BinCondition::Or(_)) => {
            std::slice::from_ref(whole)
        }
    };
    let holds = |c: &BinCondition, numbers: &[i64]| c.holds(coverage, &|p| number(numbers, p));
    let never: Vec<&BinCondition> = parts.iter().filter(|c| !seen.iter().any(|n| holds(c, n))).collect();
    if !never.is_empty() {
        let texts: Vec<String> = never.iter().map(|c| unmet(coverage, c, seen)).collect();
        return texts.join("; ");
    }
    // The first of those that come nearest.
    let missing =
        |numbers: &Vec<i64>| -> Vec<&BinCondition> { parts.iter().filter(|c| !holds(c, numbers)).collect() };
    let nearest = seen.iter().map(missing).min_by_key(Vec::len).unwrap_or_default();
    if nearest.is_empty() {
        return "its condition was met only together with what the cross ignores".to_owned();
    }
    let texts: Vec<String> = nearest.iter().map(|c| format!("`{}`", text(coverage, c, true))).collect();
    format!(
        "each of its conditions was met, but never all at once: in the nearest run {} was not",
        texts.join(", ")
    )
}

fn number(numbers: &[i64], point: CoverpointId) -> i64 {
    numbers.get(usize::from(point.0)).copied().unwrap_or(0)
}

/// What the point of a condition was, and what it must be.
fn unmet(coverage: &Coverage, condition: &BinCondition, seen: &BTreeSet<Vec<i64>>) -> String {
    match condition {
        BinCondition::In { point, bin } => {
            let (name, bin) = declared(coverage, *point, *bin);
            format!("`{name}` was {}, needs {}", values(*point, seen), needed(bin))
        }
        BinCondition::Not(inner) => match &**inner {
            BinCondition::In { point, bin } => {
                let (name, bin) = declared(coverage, *point, *bin);
                format!("`{name}` was {}, must not be {}", values(*point, seen), needed(bin))
            }
            BinCondition::Not(_) | BinCondition::And(_) | BinCondition::Or(_) => {
                format!("`{}` was never met", text(coverage, condition, false))
            }
        },
        BinCondition::And(_) | BinCondition::Or(_) => {
            let mut points = BTreeSet::new();
            points_of(condition, &mut points);
            let was = |p: &CoverpointId| format!("`{}` was {}", coverage.point(*p).name, values(*p, seen));
            let were: Vec<String> = points.iter().map(was).collect();
            format!("`{}` was never met: {}", text(coverage, condition, false), were.join(", "))
        }
    }
}

fn points_of(condition: &BinCondition, points: &mut BTreeSet<CoverpointId>) {
    match condition {
        BinCondition::In { point, .. } => {
            points.insert(*point);
        }
        BinCondition::Not(c) => points_of(c, points),
        BinCondition::And(cs) | BinCondition::Or(cs) => cs.iter().for_each(|c| points_of(c, points)),
    }
}

fn declared(coverage: &Coverage, point: CoverpointId, bin: u16) -> (&str, &CoverBin) {
    let point = coverage.point(point);
    (&point.name, point.bin(bin))
}

/// `0..3`, `0, 2, 5`
fn values(point: CoverpointId, seen: &BTreeSet<Vec<i64>>) -> String {
    let values: BTreeSet<i64> = seen.iter().map(|n| number(n, point)).collect();
    let (Some(lo), Some(hi)) = (values.first(), values.last()) else { return "never counted".to_owned() };
    let is_gapless = usize::try_from(hi - lo).is_ok_and(|d| d + 1 == values.len());
    if lo == hi {
        format!("always {lo}")
    } else if is_gapless && values.len() > 2 {
        format!("{lo}..{hi}")
    } else if values.len() <= LISTED {
        values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    } else {
        format!("{} numbers of {lo}..{hi}", values.len())
    }
}

/// `4`, `2..3`, `4 or more`
fn needed(bin: &CoverBin) -> String {
    match bin.hi {
        Some(hi) if hi == bin.lo => bin.lo.to_string(),
        Some(hi) => format!("{}..{hi}", bin.lo),
        None => format!("{} or more", bin.lo),
    }
}

/// The condition as it is written, in parentheses if it must be one.
fn text(coverage: &Coverage, condition: &BinCondition, is_inner: bool) -> String {
    let joined = |cs: &[BinCondition], op: &str| {
        let all: Vec<String> = cs.iter().map(|c| text(coverage, c, true)).collect();
        if is_inner { format!("({})", all.join(op)) } else { all.join(op) }
    };
    match condition {
        BinCondition::In { point, bin } => {
            let (name, bin) = declared(coverage, *point, *bin);
            format!("{name}.{}", bin.name)
        }
        BinCondition::Not(c) => format!("!{}", text(coverage, c, true)),
        BinCondition::And(cs) => joined(cs, " && "),
        BinCondition::Or(cs) => joined(cs, " || "),
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Span,
        coverage::{CoverCross, Coverpoint, CrossBin},
    };

    use super::*;

    fn point(name: &str, bins: &[(&str, i64, Option<i64>)]) -> Coverpoint {
        let bin =
            |(name, lo, hi): &(&str, i64, Option<i64>)| CoverBin { name: (*name).into(), lo: *lo, hi: *hi };
        Coverpoint {
            name: name.into(),
            count: vec![],
            bins: bins.iter().map(bin).collect(),
            origin: Span::default(),
        }
    }

    fn is(point: u16, bin: u16) -> BinCondition {
        BinCondition::In { point: CoverpointId(point), bin }
    }

    fn coverage(when: BinCondition, ignore: Vec<BinCondition>) -> Coverage {
        let bin = CrossBin { name: "b".into(), when, origin: Span::default() };
        let cross = CoverCross {
            name: "c".into(),
            points: vec![CoverpointId(0), CoverpointId(1)],
            bins: vec![bin],
            ignore,
            origin: Span::default(),
        };
        Coverage {
            points: vec![
                point("asked", &[("none", 0, Some(0)), ("two", 2, Some(3)), ("four", 4, Some(4))]),
                point("given", &[("no", 0, Some(0)), ("some", 1, None)]),
            ],
            crosses: vec![cross],
        }
    }

    fn why_not(when: BinCondition, ignore: Vec<BinCondition>, seen: &[[i64; 2]]) -> String {
        why(&coverage(when, ignore), 0, 0, &seen.iter().map(|n| n.to_vec()).collect())
    }

    #[test]
    fn the_condition_that_was_never_met_is_named_with_its_values() {
        let both = || BinCondition::And(vec![is(0, 2), is(1, 1)]);
        let seen = [[0, 0], [1, 1], [2, 0], [3, 2]];
        assert_eq!(why_not(both(), vec![], &seen), "`asked` was 0..3, needs 4");
        assert_eq!(
            why_not(both(), vec![], &[[0, 0], [7, 0], [9, 0]]),
            "`asked` was 0, 7, 9, needs 4; `given` was always 0, needs 1 or more"
        );
        assert_eq!(why_not(is(0, 1), vec![], &[[0, 0], [1, 0]]), "`asked` was 0, 1, needs 2..3");
        let not = BinCondition::Not(Box::new(is(1, 0)));
        assert_eq!(why_not(not, vec![], &[[1, 0]]), "`given` was always 0, must not be 0");
        let either = BinCondition::Or(vec![is(0, 2), BinCondition::Not(Box::new(is(1, 0)))]);
        assert_eq!(
            why_not(either, vec![], &[[1, 0]]),
            "`asked.four || !given.no` was never met: `asked` was always 1, `given` was always 0"
        );
        assert_eq!(why_not(both(), vec![], &[]), "there was no run");
    }

    #[test]
    fn conditions_that_never_came_together_are_said_so() {
        let both = || BinCondition::And(vec![is(0, 2), is(1, 1)]);
        assert_eq!(
            why_not(both(), vec![], &[[4, 0], [1, 3]]),
            "each of its conditions was met, but never all at once: in the nearest run `asked.four` was not"
        );
        assert_eq!(
            why_not(both(), vec![is(1, 1)], &[[4, 3]]),
            "its condition was met only together with what the cross ignores"
        );
    }
}
