//! Which zone covers which: what one leads to, the other does, too.

use crate::{
    search::options::SubsumptionRelation,
    zone::{
        dbm::{Dbm, DbmNumber, dominates},
        extrapolation::{ActiveClocks, NONE, thresholds},
    },
};

/// What an entry of a zone must be at least to cover a zone.
pub(super) fn demands<N: DbmNumber>(
    subsumption: SubsumptionRelation,
    frame: &ActiveClocks,
    zone: &Dbm<N>,
    out: &mut Vec<N>,
    flat: &[N],
) {
    match subsumption {
        SubsumptionRelation::Inclusion | SubsumptionRelation::Equality => {
            out.clear();
            out.extend_from_slice(flat);
        }
        SubsumptionRelation::Simulation => thresholds(frame, zone, out),
    }
}

pub(super) fn subsumes<N: DbmNumber>(subsumption: SubsumptionRelation, old: &[N], demands: &[N]) -> bool {
    match subsumption {
        SubsumptionRelation::Equality => old == demands,
        SubsumptionRelation::Inclusion | SubsumptionRelation::Simulation => dominates(old, demands),
    }
}

/// Whether the new zone covers the old one, both without padding.
pub(super) fn covers<N: DbmNumber>(
    subsumption: SubsumptionRelation,
    frame: &ActiveClocks,
    new: &[N],
    old: &[N],
) -> bool {
    match subsumption {
        SubsumptionRelation::Equality => false,
        SubsumptionRelation::Inclusion => dominates(new, old),
        SubsumptionRelation::Simulation => {
            let dim = frame.dim();
            let rows = new.chunks_exact(dim).zip(old.chunks_exact(dim)).zip(&frame.bounds);
            rows.clone().all(|((new_row, old_row), lu)| {
                lu.lower == NONE
                    || new_row
                        .iter()
                        .zip(old_row)
                        .enumerate()
                        .all(|(x, (a, b))| a >= b || !breaks(frame, old, x, *a, lu.lower))
            })
        }
    }
}

/// Whether an entry of the greater zone that is less than that of the smaller one keeps it from covering.
fn breaks<N: DbmNumber>(frame: &ActiveClocks, old: &[N], x: usize, entry: N, lower: i64) -> bool {
    let upper = frame.bounds[x].upper;
    let least: i64 = old[x].into();
    if upper == NONE || least < 1 - 2 * upper {
        return false;
    }
    let entry: i64 = entry.into();
    entry < 2 * (lower + (least + 1).div_euclid(2))
}
