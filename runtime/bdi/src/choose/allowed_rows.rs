//! How rows may be changed, so that conditions still allow them.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{cover::FactorChoice, fewer::RowRules, sets::AlternativeRow, space::AllowedSpace};

impl RowRules for AllowedSpace<'_> {
    fn permits(&mut self, row: &AlternativeRow, (factor, alternative): FactorChoice) -> bool {
        let Some(group) = self.group_of[factor] else { return true };
        let mut changed = row.clone();
        changed[factor] = alternative;
        self.allows(group, &changed)
    }

    /// In each group the allowed row that has the tuple's alternatives and the fewest others than this one, one drawn among
    /// equals.
    fn changes(
        &mut self,
        row: &AlternativeRow,
        tuple: &[FactorChoice],
        rng: &mut ChaCha8Rng,
    ) -> (Vec<FactorChoice>, usize) {
        let (mut changes, mut work) = (Vec::new(), 0);
        let mut groups: Vec<usize> = tuple.iter().filter_map(|(f, _)| self.group_of[*f]).collect();
        groups.sort_unstable();
        groups.dedup();
        changes.extend(tuple.iter().copied().filter(|(f, _)| self.group_of[*f].is_none()));
        for at in groups {
            let group = &self.groups[at];
            work += group.len();
            let wanted: Vec<(usize, u16)> =
                tuple.iter().filter_map(|(f, a)| Some((group.place(*f)?, *a as u16))).collect();
            let present: Vec<u16> = group.factors.iter().map(|f| row[*f] as u16).collect();
            let (mut nearest, mut fewest) = (Vec::new(), usize::MAX);
            for index in 0..group.len() {
                let other = group.row(index);
                if wanted.iter().any(|(place, a)| other[*place] != *a) {
                    continue;
                }
                let differ = other.iter().zip(&present).filter(|(a, b)| a != b).count();
                if differ < fewest {
                    (nearest, fewest) = (Vec::new(), differ);
                }
                if differ == fewest {
                    nearest.push(index);
                }
            }
            if nearest.is_empty() {
                return (Vec::new(), work);
            }
            let drawn = nearest[rng.random_range(0..nearest.len() as u32) as usize];
            changes.extend(group.factors.iter().copied().zip(group.row(drawn).iter().map(|a| u32::from(*a))));
        }
        (changes, work)
    }
}
