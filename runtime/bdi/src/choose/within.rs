//! Sets of beliefs that conditions allow: all of them, enough for every tuple that is allowed, or a random sample.

use std::collections::BTreeSet;

use hrdsl_ir::suite::ExploreMode;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    cover::{CANDIDATES, FactorChoice, UncoveredTuples, tuples},
    fewer::fewer_allowed,
    sets::{AlternativeRow, MAX_SETS, shuffle},
    space::{AllowedSpace, NextRow},
};

/// Tuples that are looked at, at most: each is compared with what is allowed.
const MAX_TUPLES: u128 = 10_000_000;

/// Rows drawn in a row that were there already, after which no more are drawn.
const MISSES: usize = 1_000;

/// What was found within a space.
#[derive(Debug, Default)]
pub(super) struct AllowedRows {
    pub rows: Vec<AlternativeRow>,
    /// A limit cut short what was asked for.
    pub cut: bool,
    pub notes: Vec<String>,
    /// For `Wise`: of how many alternatives the tuples are that all occur, and how many rows have them.
    pub strength: Option<(usize, usize)>,
}

/// As [`explore`](super::explore), but `Learn` is as `Random`.
pub(super) fn within(
    space: &mut AllowedSpace<'_>,
    method: ExploreMode,
    tests: usize,
    rng: &mut ChaCha8Rng,
) -> AllowedRows {
    match method {
        ExploreMode::Exhaustive => {
            let (rows, end) = first(space, tests);
            AllowedRows { rows, cut: end != NextRow::End, ..AllowedRows::default() }
        }
        ExploreMode::Wise(strength) => {
            let mut found = covering(space, usize::from(strength).max(2), rng);
            found.cut |= found.rows.len() >= MAX_SETS;
            fit(&mut found, space, tests, rng);
            fill(&mut found, space, tests, rng);
            found
        }
        ExploreMode::Random | ExploreMode::Learn => {
            let mut found = AllowedRows::default();
            found.cut = !fill(&mut found, space, tests, rng);
            found
        }
    }
}

/// Takes fewer rows with the same tuples if there are more than `tests` and as few are found; says how many rows would do.
fn fit(found: &mut AllowedRows, space: &mut AllowedSpace<'_>, tests: usize, rng: &ChaCha8Rng) {
    let Some((strength, needed)) = &mut found.strength else { return };
    if found.rows.len() <= tests || found.rows.len() >= MAX_SETS {
        return;
    }
    // A stream of its own: what else is drawn does not depend on whether fewer rows were looked for.
    let mut rng = ChaCha8Rng::from_seed(rng.get_seed());
    rng.set_stream(1);
    let sizes = space.sizes.clone();
    let least = fewer_allowed(&sizes, *strength, found.rows.clone(), tests, space, &mut rng);
    *needed = least.len();
    // If some tests will be left out in any case, the first greedy rows have more tuples than any others.
    if least.len() <= tests {
        found.rows = least;
    }
}

/// The first allowed rows, and what comes after them.
fn first(space: &mut AllowedSpace<'_>, limit: usize) -> (Vec<AlternativeRow>, NextRow) {
    let mut rows = Vec::new();
    let mut next = space.next(&vec![0; space.sizes.len()]);
    while let NextRow::Row(row) = &next {
        if rows.len() >= limit {
            break;
        }
        rows.push(row.clone());
        next = after(space, row);
    }
    (rows, next)
}

/// The first allowed row after this one.
pub(super) fn after(space: &mut AllowedSpace<'_>, row: &AlternativeRow) -> NextRow {
    let mut from = row.clone();
    match from.last_mut() {
        Some(last) => *last += 1,
        None => return NextRow::End,
    }
    space.next(&from)
}

/// Adds different random rows until there are as many as were asked for, or all; `false` if a bound ended that.
fn fill(found: &mut AllowedRows, space: &mut AllowedSpace<'_>, tests: usize, rng: &mut ChaCha8Rng) -> bool {
    let allowed = space.allowed();
    let most = allowed.map_or(usize::MAX, |n| usize::try_from(n).unwrap_or(usize::MAX));
    let wanted = tests.min(MAX_SETS).min(most);
    let rows = &mut found.rows;
    let mut seen: BTreeSet<AlternativeRow> = rows.iter().cloned().collect();
    if rows.len() < wanted && allowed.is_some_and(|n| n <= 4 * wanted as u128) {
        let (mut rest, _) = first(space, most);
        rest.retain(|row| !seen.contains(row));
        shuffle(&mut rest, rng);
        rest.truncate(wanted.saturating_sub(rows.len()));
        rows.append(&mut rest);
    }
    let mut misses = 0;
    while rows.len() < wanted && misses < MISSES {
        match space.draw(rng) {
            Some(row) if seen.insert(row.clone()) => {
                rows.push(row);
                misses = 0;
            }
            Some(_) | None => misses += 1,
        }
    }
    rows.len() >= wanted
}

/// Rows in which every tuple occurs that some allowed row has; otherwise as
/// [`covering`](super::cover::covering).
fn covering(space: &mut AllowedSpace<'_>, mut strength: usize, rng: &mut ChaCha8Rng) -> AllowedRows {
    let sizes = space.sizes.clone();
    if sizes.len() < 2 || (strength > 2 && strength >= sizes.len()) {
        let (rows, end) = first(space, MAX_SETS);
        let strength = Some((strength, rows.len()));
        return AllowedRows { rows, cut: end != NextRow::End, strength, ..AllowedRows::default() };
    }
    let asked = strength;
    while strength > 2 && tuples(&sizes, strength) > MAX_TUPLES {
        strength -= 1;
    }
    let mut uncovered = UncoveredTuples::new(&sizes, strength);
    let excluded = uncovered.exclude(space, rng);
    let mut found = AllowedRows { cut: strength < asked, ..AllowedRows::default() };
    if excluded > 0 {
        found.notes.push(excluded_note(excluded, strength, space.is_exact()));
    }
    while uncovered.left > 0 && found.rows.len() < MAX_SETS {
        let start = uncovered.open_tuple(uncovered.neediest());
        let begun = TupleCandidates::new(space, &start);
        let mut best: Option<(usize, AlternativeRow)> = None;
        for _ in 0..CANDIDATES {
            let (gain, row) = begun.candidate(&uncovered, rng);
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, row));
            }
        }
        // INVARIANT: each candidate has the open tuple that it began with, so this ends.
        let Some((_, row)) = best else { break };
        uncovered.cover(&row);
        found.rows.push(row);
    }
    found.strength = Some((strength, found.rows.len()));
    found
}

fn excluded_note(excluded: u64, strength: usize, is_exact: bool) -> String {
    let what = if strength == 2 { "pairs".to_owned() } else { format!("combinations of {strength}") };
    if is_exact {
        format!("{excluded} {what} of alternatives occur in no belief set that the conditions allow")
    } else {
        format!(
            "{excluded} {what} of alternatives were found in no belief set that the conditions allow; it was searched for at random"
        )
    }
}

/// A tuple that candidates begin with, and by group the allowed rows that have it; `None`: all of them.
struct TupleCandidates<'s, 'a> {
    space: &'s AllowedSpace<'a>,
    start: &'s [FactorChoice],
    matching: Vec<Option<Vec<u32>>>,
}

impl<'s, 'a> TupleCandidates<'s, 'a> {
    fn new(space: &'s AllowedSpace<'a>, start: &'s [FactorChoice]) -> Self {
        let mut begun = Self { space, start, matching: vec![None; space.groups.len()] };
        let mut matching = begun.matching.clone();
        start.iter().for_each(|place| begun.narrow(&mut matching, *place));
        begun.matching = matching;
        begun
    }

    /// Leaves the rows that have this alternative.
    fn narrow(&self, matching: &mut [Option<Vec<u32>>], (factor, alternative): FactorChoice) {
        let Some(at) = self.space.group_of[factor] else { return };
        let group = &self.space.groups[at];
        let Some(place) = group.place(factor) else { return };
        let has = |row: &u32| u32::from(group.row(*row as usize)[place]) == alternative;
        match &mut matching[at] {
            Some(rows) => rows.retain(has),
            all => *all = Some((0..group.len() as u32).filter(has).collect()),
        }
    }

    /// By alternative: whether a row that is left has it.
    fn permitted(&self, matching: &[Option<Vec<u32>>], factor: usize) -> Vec<bool> {
        let size = self.space.sizes[factor] as usize;
        let Some(at) = self.space.group_of[factor] else { return vec![true; size] };
        let (group, mut permitted, mut left) = (&self.space.groups[at], vec![false; size], size);
        let Some(place) = group.place(factor) else { return permitted };
        let mut mark = |row: usize| {
            left -= usize::from(!std::mem::replace(&mut permitted[usize::from(group.row(row)[place])], true));
            left == 0
        };
        match &matching[at] {
            Some(rows) => rows.iter().any(|r| mark(*r as usize)),
            None => (0..group.len()).any(mark),
        };
        permitted
    }

    /// As [`candidate`](super::cover), of what is permitted.
    fn candidate(&self, uncovered: &UncoveredTuples<'_>, rng: &mut ChaCha8Rng) -> (usize, AlternativeRow) {
        let mut row: AlternativeRow = vec![0; self.space.sizes.len()];
        let mut placed: Vec<usize> = self.start.iter().map(|(factor, _)| *factor).collect();
        self.start.iter().for_each(|(factor, alternative)| row[*factor] = *alternative);
        let mut order: Vec<usize> = (0..row.len()).filter(|f| !placed.contains(f)).collect();
        shuffle(&mut order, rng);
        let mut matching = self.matching.clone();
        let mut gain = 0;
        for factor in order {
            let gains = uncovered.gains(factor, &placed, &row);
            let permitted = self.permitted(&matching, factor);
            let of = |a: &u32| permitted[*a as usize];
            let among = || (0..gains.len() as u32).filter(of);
            let most = among().map(|a| gains[a as usize]).max().unwrap_or(0);
            let ties: Vec<u32> = among().filter(|a| gains[*a as usize] == most).collect();
            // INVARIANT: an allowed row has what is placed, so that something is permitted.
            let drawn = rng.random_range(0..ties.len().max(1) as u32) as usize;
            row[factor] = ties.get(drawn).copied().unwrap_or(0);
            self.narrow(&mut matching, (factor, row[factor]));
            placed.insert(placed.partition_point(|f| *f < factor), factor);
            gain += most;
        }
        (gain, row)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::choose::{BATCH, BeliefExplorer, BeliefFactor, ChooseError, FactorAlternative, sets::row_at};
    use hrdsl_ir::bdi::{AgentId, BeliefId, InitialFact};

    /// A condition: the factors in its scope, and how often it holds, of 8; which rows these are comes from a hash.
    type Clause = (BTreeSet<usize>, u8);

    fn holds(clauses: &[(Vec<usize>, u8)], clause: usize, row: &[u32]) -> bool {
        let (scope, often) = &clauses[clause];
        let start = 0xcbf2_9ce4_8422_2325 ^ clause as u64;
        let hash =
            scope.iter().fold(start, |h, f| (h ^ u64::from(row[*f] + 1)).wrapping_mul(0x0100_0000_01b3));
        (hash >> 20) % 8 < u64::from(*often)
    }

    fn clauses(sizes: &[u32], drawn: &[Clause]) -> Vec<(Vec<usize>, u8)> {
        let fits = |scope: &BTreeSet<usize>| scope.iter().copied().filter(|f| *f < sizes.len()).collect();
        drawn.iter().map(|(scope, often)| (fits(scope), *often)).collect()
    }

    fn space<'a>(
        sizes: &[u32],
        clauses: &'a [(Vec<usize>, u8)],
        max: u128,
        rng: &mut ChaCha8Rng,
    ) -> AllowedSpace<'a> {
        let scopes = clauses.iter().map(|(scope, _)| scope.clone()).collect();
        let holds = move |clause: usize, row: &AlternativeRow| holds(clauses, clause, row);
        AllowedSpace::limited(sizes.to_vec(), scopes, Box::new(holds), max, rng)
    }

    /// The allowed rows, by trying all.
    fn allowed(sizes: &[u32], clauses: &[(Vec<usize>, u8)]) -> Vec<AlternativeRow> {
        let count: u32 = sizes.iter().product();
        let all = (0..count).map(|i| row_at(sizes, i.into()));
        all.filter(|row| (0..clauses.len()).all(|c| holds(clauses, c, row))).collect()
    }

    fn sub_tuples(rows: &[AlternativeRow], factors: usize, strength: usize) -> BTreeSet<Vec<(usize, u32)>> {
        let mut found = BTreeSet::new();
        for mask in (0u32..1 << factors).filter(|m| m.count_ones() as usize == strength.min(factors)) {
            let chosen: Vec<usize> = (0..factors).filter(|f| mask >> f & 1 == 1).collect();
            found.extend(rows.iter().map(|r| chosen.iter().map(|f| (*f, r[*f])).collect::<Vec<_>>()));
        }
        found
    }

    fn factors(sizes: &[u32]) -> Vec<BeliefFactor> {
        let fact = |f: u16, a: u32| InitialFact {
            belief: BeliefId(f),
            args: vec![hrdsl_ir::Value::Int(a.into())],
            annotations: vec![],
        };
        let alternative = |f, a| FactorAlternative { facts: vec![fact(f, a)], text: format!("b{f}({a})") };
        let factor = |(f, n): (u16, &u32)| BeliefFactor {
            agent: AgentId(0),
            name: format!("b{f}"),
            alternatives: (0..*n).map(|a| alternative(f, a)).collect(),
        };
        (0u16..).zip(sizes).map(factor).collect()
    }

    /// The rows that an explorer makes, batch by batch.
    fn explored(
        sizes: &[u32],
        space: AllowedSpace<'_>,
        method: ExploreMode,
        tests: u32,
        seed: u64,
    ) -> Result<Vec<AlternativeRow>, ChooseError> {
        let rng = ChaCha8Rng::seed_from_u64(seed);
        let mut explorer = BeliefExplorer::within(space, &factors(sizes), (method, tests), rng)?;
        let mut rows = Vec::new();
        loop {
            let batch = explorer.next_batch();
            if batch.is_empty() {
                return Ok(rows);
            }
            assert!(batch.len() <= BATCH);
            explorer.learn(&vec![1; batch.len()]);
            let of = |fact: &InitialFact| fact.args[0].as_f64().map_or(0, |n| n as u32);
            rows.extend(
                batch
                    .iter()
                    .map(|set| set.facts.iter().map(|(_, fact)| of(fact)).collect::<AlternativeRow>()),
            );
        }
    }

    const METHODS: [ExploreMode; 5] = [
        ExploreMode::Exhaustive,
        ExploreMode::Wise(2),
        ExploreMode::Wise(3),
        ExploreMode::Random,
        ExploreMode::Learn,
    ];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]
        #[test]
        fn what_is_allowed_is_explored_and_nothing_else(
            sizes in prop::collection::vec(1u32..5, 0..6),
            drawn in prop::collection::vec((prop::collection::btree_set(0usize..6, 0..4), 1u8..8), 0..5),
            tests in 1u32..60,
            seed: u64,
        ) {
            let clauses = clauses(&sizes, &drawn);
            let allowed = allowed(&sizes, &clauses);
            for method in METHODS {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let space = space(&sizes, &clauses, u128::MAX, &mut rng);
                prop_assert_eq!(space.allowed(), Some(allowed.len() as u128));
                let found = explored(&sizes, space, method, tests, seed);
                let Ok(rows) = found else {
                    prop_assert!(allowed.is_empty());
                    continue;
                };
                prop_assert!(!allowed.is_empty());
                let distinct: BTreeSet<&AlternativeRow> = rows.iter().collect();
                prop_assert_eq!(distinct.len(), rows.len());
                prop_assert!(rows.iter().all(|row| allowed.contains(row)), "{:?}", method);
                let least = allowed.len().min(tests as usize);
                match method {
                    ExploreMode::Exhaustive => prop_assert_eq!(&rows[..], &allowed[..least]),
                    ExploreMode::Wise(strength) => {
                        let (n, t) = (sizes.len(), usize::from(strength));
                        prop_assert_eq!(sub_tuples(&rows, n, t), sub_tuples(&allowed, n, t));
                        prop_assert!(rows.len() >= least);
                    }
                    ExploreMode::Random | ExploreMode::Learn => prop_assert_eq!(rows.len(), least),
                }
            }
        }

        #[test]
        fn in_a_space_too_large_to_go_through_nothing_else_is_explored_either(
            sizes in prop::collection::vec(1u32..5, 1..6),
            drawn in prop::collection::vec((prop::collection::btree_set(0usize..6, 1..4), 3u8..8), 1..4),
            seed: u64,
        ) {
            let clauses = clauses(&sizes, &drawn);
            let allowed = allowed(&sizes, &clauses);
            for method in METHODS {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let Ok(rows) = explored(&sizes, space(&sizes, &clauses, 0, &mut rng), method, 20, seed) else {
                    continue;
                };
                prop_assert!(rows.iter().all(|row| allowed.contains(row)), "{:?}", method);
                let distinct: BTreeSet<&AlternativeRow> = rows.iter().collect();
                prop_assert_eq!(distinct.len(), rows.len());
                // So small a space is found whole at random.
                if let ExploreMode::Wise(t) = method {
                    let (n, t) = (sizes.len(), usize::from(t));
                    prop_assert_eq!(sub_tuples(&rows, n, t), sub_tuples(&allowed, n, t));
                }
            }
        }
    }

    /// The greedy rows of a space, and what is left of them.
    fn both(
        sizes: &[u32],
        clauses: &[(Vec<usize>, u8)],
        strength: usize,
        seed: u64,
    ) -> [Vec<AlternativeRow>; 2] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut space = space(sizes, clauses, u128::MAX, &mut rng);
        let greedy = covering(&mut space, strength, &mut rng);
        let mut fewer =
            AllowedRows { rows: greedy.rows.clone(), strength: greedy.strength, ..AllowedRows::default() };
        // As many as are found are enough, so that they are taken.
        fit(&mut fewer, &mut space, 0, &rng);
        let needed = fewer.strength.map_or(0, |(_, needed)| needed);
        fit(&mut fewer, &mut space, needed, &rng);
        assert_eq!(fewer.rows.len(), needed.min(greedy.rows.len()));
        [greedy.rows, fewer.rows]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        #[test]
        fn fewer_rows_have_every_tuple_that_conditions_allow(
            sizes in prop::collection::vec(1u32..5, 2..7),
            drawn in prop::collection::vec((prop::collection::btree_set(0usize..7, 1..4), 2u8..8), 1..5),
            strength in 2usize..4,
            seed: u64,
        ) {
            let clauses = clauses(&sizes, &drawn);
            let allowed = allowed(&sizes, &clauses);
            prop_assume!(!allowed.is_empty());
            let [greedy, fewer] = both(&sizes, &clauses, strength, seed);
            prop_assert!(fewer.len() <= greedy.len());
            prop_assert!(fewer.iter().all(|row| allowed.contains(row)));
            let distinct: BTreeSet<&AlternativeRow> = fewer.iter().collect();
            prop_assert_eq!(distinct.len(), fewer.len());
            let of = |rows: &[AlternativeRow]| sub_tuples(rows, sizes.len(), strength);
            prop_assert_eq!(of(&fewer), of(&allowed));
            let again = both(&sizes, &clauses, strength, seed);
            prop_assert_eq!(&again[1], &fewer);
        }
    }

    /// Which rows are allowed, by conditions with these scopes.
    type ShapeCondition = (Vec<Vec<usize>>, fn(&[u32]) -> bool);

    /// Sizes, conditions, the tuples' size, the greedy rows, and the rows that are left of them.
    type ConditionedShape = (&'static str, Vec<u32>, ShapeCondition, usize, usize, usize);

    fn shapes() -> Vec<ConditionedShape> {
        let differ: fn(&[u32]) -> bool = |part| part.windows(2).all(|w| w[0] != w[1]);
        let not_both: fn(&[u32]) -> bool = |part| part[0] != 0 || part[1] != 0;
        let few: fn(&[u32]) -> bool = |part| part.iter().sum::<u32>() <= 4;
        let upwards: fn(&[u32]) -> bool = |part| part.windows(2).all(|w| w[0] <= w[1]);
        let neighbours = |n: usize| (0..n - 1).map(|f| vec![f, f + 1]).collect::<Vec<_>>();
        let couples = |n: usize| (0..n / 2).map(|f| vec![2 * f, 2 * f + 1]).collect::<Vec<_>>();
        vec![
            ("13 of 3, of each couple not both the first", vec![3; 13], (couples(13), not_both), 2, 19, 15),
            ("10 of 3, neighbours differ", vec![3; 10], (neighbours(10), differ), 2, 17, 15),
            ("8 of 4, neighbours differ", vec![4; 8], (neighbours(8), differ), 2, 28, 22),
            ("16 of 2, at most four held", vec![2; 16], (vec![(0..16).collect()], few), 2, 26, 26),
            ("6 of 5, the first three upwards", vec![5; 6], (vec![vec![0, 1, 2]], upwards), 2, 42, 37),
            ("8 of 3, neighbours differ", vec![3; 8], (neighbours(8), differ), 3, 49, 39),
        ]
    }

    #[test]
    fn no_shape_with_conditions_takes_more_rows_than_it_did() {
        let mut wrong = Vec::new();
        for (name, sizes, (scopes, allows), strength, most_greedy, most) in shapes() {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            let parts = scopes.clone();
            let holds = move |clause: usize, row: &AlternativeRow| {
                allows(&parts[clause].iter().map(|f| row[*f]).collect::<Vec<_>>())
            };
            let mut space = AllowedSpace::new(sizes.clone(), scopes, Box::new(holds), &mut rng);
            let mut found = covering(&mut space, strength, &mut rng);
            let tuples = sub_tuples(&found.rows, sizes.len(), strength);
            let greedy = found.rows.len();
            fit(&mut found, &mut space, 0, &rng);
            let needed = found.strength.map_or(0, |(_, needed)| needed);
            fit(&mut found, &mut space, needed, &rng);
            assert_eq!(sub_tuples(&found.rows, sizes.len(), strength), tuples, "{name}");
            if greedy > most_greedy || found.rows.len() > most {
                wrong.push(format!("{name}: {greedy}, {}", found.rows.len()));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    /// 40 beliefs of which at most three are held.
    fn few_of_many(rng: &mut ChaCha8Rng) -> AllowedSpace<'static> {
        let few = |_, row: &AlternativeRow| row.iter().sum::<u32>() <= 3;
        AllowedSpace::new(vec![2; 40], vec![(0..40).collect()], Box::new(few), rng)
    }

    #[test]
    fn few_of_many_beliefs_are_found_in_a_vast_space() {
        // Each three that are held need a row of their own: the strength of 3 would take long.
        for method in METHODS.into_iter().filter(|method| *method != ExploreMode::Wise(3)) {
            let mut rng = ChaCha8Rng::seed_from_u64(5);
            let space = few_of_many(&mut rng);
            assert_eq!((space.allowed(), space.is_exact()), (None, false));
            let rows = explored(&[2; 40], space, method, 50, 5).unwrap();
            assert!(rows.iter().all(|row| row.iter().sum::<u32>() <= 3), "{method:?}");
            assert!(rows.len() >= 50, "{method:?}: {}", rows.len());
            if method == ExploreMode::Wise(2) {
                let held = |r: &AlternativeRow, f: usize, g: usize| r[f] == 1 && r[g] == 1;
                let pairs = (0..40).flat_map(|f| (0..f).map(move |g| (f, g)));
                for (f, g) in pairs {
                    assert!(rows.iter().any(|r| held(r, f, g)), "{f} {g}");
                }
            }
        }
    }

    #[test]
    fn what_no_row_fulfils_is_said() {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let never = |_, row: &AlternativeRow| row[1] == 2;
        let space = AllowedSpace::new(vec![2, 2], vec![vec![1]], Box::new(never), &mut rng);
        let error = explored(&[2, 2], space, ExploreMode::Wise(2), 9, 0).unwrap_err();
        assert_eq!(error.to_string(), "no belief set fulfils what `where` says of b1");
        let space = AllowedSpace::new(vec![2], vec![vec![]], Box::new(|_, _| false), &mut rng);
        let error = explored(&[2], space, ExploreMode::Learn, 9, 0).unwrap_err();
        assert_eq!(error.to_string(), "no belief set fulfils what `where` says");
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let differ = |_, row: &AlternativeRow| row[0] != row[1];
        let space = AllowedSpace::new(vec![3, 3, 2], vec![vec![0, 1]], Box::new(differ), &mut rng);
        let explorer =
            BeliefExplorer::within(space, &factors(&[3, 3, 2]), (ExploreMode::Wise(2), 9), rng).unwrap();
        assert_eq!(
            explorer.notes,
            [
                "the conditions allow 12 of 18 belief sets; 6 are left out",
                "3 pairs of alternatives occur in no belief set that the conditions allow"
            ]
        );
        assert!(!explorer.cut && explorer.space == 18);
    }
}
