//! What is lost if there are fewer tests than all tuples of alternatives take.

use hrdsl_bdi::choose::SetTuples;
use hrdsl_results::LostTuples;

/// The tuples that are lost if only the first of the different tests are made; `sets` has, for each of them, the numbers of
/// the belief sets that lead to it. `None` if all are made, or none is lost.
pub fn lost(tuples: &SetTuples, sets: &[Vec<u64>], made: usize) -> Option<LostTuples> {
    let kept = sets.get(..made).filter(|kept| kept.len() < sets.len())?;
    let (all, lost) = tuples.lost(kept.iter().flatten().copied());
    let cut = LostTuples { strength: tuples.strength, all, lost, needed: tuples.needed };
    (lost > 0).then_some(cut)
}

/// What is said of it.
pub fn warning(cut: LostTuples, made: usize) -> String {
    let LostTuples { strength, all, lost, needed } = cut;
    let what = match strength {
        1 => "alternatives".to_owned(),
        2 => "pairs of alternatives".to_owned(),
        _ => format!("combinations of {strength} alternatives"),
    };
    let are = if lost == 1 { "is" } else { "are" };
    format!(
        "warning: {lost} of {all} {what} {are} in none of the {made} tests; `tests {needed}` is enough for all"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warning_counts() {
        let of = |strength, lost, made| warning(LostTuples { strength, all: 702, lost, needed: 15 }, made);
        assert_eq!(
            of(2, 312, 8),
            "warning: 312 of 702 pairs of alternatives are in none of the 8 tests; `tests 15` is enough for all"
        );
        assert_eq!(
            of(3, 1, 14),
            "warning: 1 of 702 combinations of 3 alternatives is in none of the 14 tests; `tests 15` is enough for all"
        );
    }
}
