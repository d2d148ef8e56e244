//! The zones of states whose successors are not computed yet.
//!
//! Few of all states wait, but a whole zone of local times is large beside what is kept of a state for good. Nearly all bounds are
//! small, so that a zone is kept in half the room wherever all of its bounds fit.

use prefetch_index::prefetch_index;

use super::zone::{INF, LocalZone, LocalZoneBound};
use crate::search::store::{LINE, NIL};

/// By node, the zone that it waits with.
pub(super) struct WaitingZones {
    /// By node: its zone's place, as [`pack`](Self::pack) makes it, or [`NIL`].
    places: Vec<u32>,
    /// A slab for zones that are written at once, then one for each worker.
    narrow: Vec<ZoneSlab<i16>>,
    wide: ZoneSlab<LocalZoneBound>,
    /// How many wait, narrow and wide, and the most that ever did.
    count: [usize; 2],
    most: [usize; 2],
    /// How many bounds a zone has.
    bounds: usize,
}

/// Zones of one length, end to end.
#[derive(Default)]
pub(super) struct ZoneSlab<N> {
    bounds: Vec<N>,
    /// How many it has given numbers to.
    zones: u32,
    /// The numbers of zones that nobody waits with.
    free: Vec<u32>,
    /// Numbers of zones that are not written yet, and where in the worker's batch they begin.
    unwritten: Vec<(u32, usize)>,
}

/// A zone, in half the room where its bounds let it.
pub(super) enum PackedZone<'a> {
    Narrow(&'a [i16]),
    Wide(&'a [LocalZoneBound]),
    /// Narrow, in the batch of this worker from there on, which writes it [itself](ZoneSlab::write).
    Unwritten {
        worker: usize,
        at: usize,
    },
}

impl<'a> PackedZone<'a> {
    /// Packs the zone, with that room for it.
    pub(super) fn of(zone: &'a LocalZone, room: &'a mut Vec<i16>) -> Self {
        let bounds = zone.bounds();
        room.clear();
        if append_narrow(bounds, room) { Self::Narrow(room) } else { Self::Wide(bounds) }
    }
}

/// In which slab a zone is, and its number there.
enum ZonePlace {
    Narrow { slab: usize, number: u32 },
    Wide(u32),
}

impl ZonePlace {
    const WIDE: u32 = 1 << 31;

    /// Where zones of its kind are counted.
    fn kind(&self) -> usize {
        match self {
            Self::Narrow { .. } => 0,
            Self::Wide(_) => 1,
        }
    }
}

impl<N: Copy + Default> ZoneSlab<N> {
    /// The number of a zone that is to be written.
    fn number(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.zones += 1;
            self.zones - 1
        })
    }

    /// Where to write a zone.
    fn room(&mut self, number: u32, length: usize) -> &mut [N] {
        let at = number as usize * length;
        if self.bounds.len() < at + length {
            self.bounds.resize(at + length, N::default());
        }
        &mut self.bounds[at..at + length]
    }

    /// Writes what is unwritten, from the batch that it stands in.
    pub(super) fn write(&mut self, batch: &[N], length: usize) {
        let mut unwritten = std::mem::take(&mut self.unwritten);
        // In order: of two with one number the last is the right one.
        for (number, at) in unwritten.drain(..) {
            self.room(number, length).copy_from_slice(&batch[at..at + length]);
        }
        self.unwritten = unwritten;
    }

    fn zone(&self, number: u32, length: usize) -> &[N] {
        &self.bounds[number as usize * length..][..length]
    }
}

impl WaitingZones {
    /// For so many workers that write zones themselves.
    pub(super) fn new(workers: usize) -> Self {
        Self {
            places: Vec::new(),
            narrow: (0..=workers).map(|_| ZoneSlab::default()).collect(),
            wide: ZoneSlab::default(),
            count: [0; 2],
            most: [0; 2],
            bounds: 0,
        }
    }

    /// The slabs of the workers.
    pub(super) fn of_workers(&mut self) -> &mut [ZoneSlab<i16>] {
        &mut self.narrow[1..]
    }

    /// How many zones are to be written.
    pub(super) fn unwritten(&self) -> usize {
        self.narrow.iter().map(|slab| slab.unwritten.len()).sum()
    }

    /// INVARIANT: budgets of memory keep all numbers of zones far below 2³¹.
    fn pack(&self, place: &ZonePlace) -> u32 {
        match place {
            ZonePlace::Narrow { slab, number } => number * self.narrow.len() as u32 + *slab as u32,
            ZonePlace::Wide(number) => number | ZonePlace::WIDE,
        }
    }

    fn unpack(&self, packed: u32) -> ZonePlace {
        let slabs = self.narrow.len() as u32;
        match packed & ZonePlace::WIDE {
            0 => ZonePlace::Narrow { slab: (packed % slabs) as usize, number: packed / slabs },
            _ => ZonePlace::Wide(packed & !ZonePlace::WIDE),
        }
    }

    /// The next node waits with this zone.
    pub(super) fn push(&mut self, zone: PackedZone) {
        let place = match zone {
            PackedZone::Narrow(bounds) => {
                self.bounds = bounds.len();
                let number = self.narrow[0].number();
                self.narrow[0].room(number, bounds.len()).copy_from_slice(bounds);
                ZonePlace::Narrow { slab: 0, number }
            }
            PackedZone::Unwritten { worker, at } => {
                let slab = &mut self.narrow[1 + worker];
                let number = slab.number();
                slab.unwritten.push((number, at));
                ZonePlace::Narrow { slab: 1 + worker, number }
            }
            PackedZone::Wide(bounds) => {
                self.bounds = bounds.len();
                let number = self.wide.number();
                self.wide.room(number, bounds.len()).copy_from_slice(bounds);
                ZonePlace::Wide(number)
            }
        };
        self.places.push(self.pack(&place));
        let kind = place.kind();
        self.count[kind] += 1;
        self.most[kind] = self.most[kind].max(self.count[kind]);
    }

    /// Makes `zone`, which is one of the same network, that of the node, which waits no longer; `false`: it did not wait.
    pub(super) fn take(&mut self, node: u32, zone: &mut LocalZone) -> bool {
        let waits = self.read(node, zone);
        self.forget(node);
        waits
    }

    /// Makes `zone`, which is one of the same network, that of the node; `false`: it does not wait.
    pub(super) fn read(&self, node: u32, zone: &mut LocalZone) -> bool {
        let place = self.places[node as usize];
        if place == NIL {
            return false;
        }
        let bounds = zone.bounds_mut();
        match self.unpack(place) {
            ZonePlace::Narrow { slab, number } => {
                widen(self.narrow[slab].zone(number, bounds.len()), bounds);
            }
            ZonePlace::Wide(number) => bounds.copy_from_slice(self.wide.zone(number, bounds.len())),
        }
        true
    }

    /// Has the processor fetch the zones of these nodes, unless they are wide, while it does other things.
    pub(super) fn prefetch(&self, nodes: &[u32]) {
        for &n in nodes {
            let place = self.places[n as usize];
            if place != NIL
                && let ZonePlace::Narrow { slab, number } = self.unpack(place)
            {
                for at in (0..self.bounds).step_by(LINE / size_of::<i16>()) {
                    prefetch_index(&self.narrow[slab].bounds, number as usize * self.bounds + at);
                }
            }
        }
    }

    /// The node waits no longer; whether it did.
    pub(super) fn forget(&mut self, node: u32) -> bool {
        let place = std::mem::replace(&mut self.places[node as usize], NIL);
        if place == NIL {
            return false;
        }
        let place = self.unpack(place);
        self.count[place.kind()] -= 1;
        match place {
            ZonePlace::Narrow { slab, number } => self.narrow[slab].free.push(number),
            ZonePlace::Wide(number) => self.wide.free.push(number),
        }
        true
    }

    /// The memory for as many zones as ever waited, with a place in a list for each that waits. It does not depend on the workers.
    pub(super) fn bytes(&self) -> usize {
        let [narrow, wide] = self.most;
        (narrow * size_of::<i16>() + wide * size_of::<LocalZoneBound>()) * self.bounds
            + (self.places.len() + self.count.iter().sum::<usize>()) * size_of::<u32>()
    }
}

/// What stands for no bound.
const NO_BOUND: i16 = i16::MAX;

/// Adds the bounds in half the room; `false`: one of them does not fit, and nothing was added.
pub(super) fn append_narrow(bounds: &[LocalZoneBound], out: &mut Vec<i16>) -> bool {
    let at = out.len();
    out.resize(at + bounds.len(), NO_BOUND);
    let fits = narrow(bounds, &mut out[at..]);
    if !fits {
        out.truncate(at);
    }
    fits
}

/// Writes the bounds in half the room; `false`: one of them does not fit.
fn narrow(bounds: &[LocalZoneBound], out: &mut [i16]) -> bool {
    let mut fits = true;
    for (to, &b) in out.iter_mut().zip(bounds) {
        let there = b < INF;
        fits &= !there | (i32::from(b as i16) == b && b as i16 != NO_BOUND);
        *to = if there { b as i16 } else { NO_BOUND };
    }
    fits
}

fn widen(bounds: &[i16], out: &mut [LocalZoneBound]) {
    for (to, &b) in out.iter_mut().zip(bounds) {
        *to = if b == NO_BOUND { INF } else { i32::from(b) };
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bound() -> impl Strategy<Value = LocalZoneBound> {
        prop_oneof![
            3 => -40i32..40,
            1 => Just(INF),
            1 => prop::sample::select(vec![-32_769, -32_768, -32_767, 32_766, 32_767, 32_768, 1 << 20, -(1 << 20)]),
        ]
    }

    proptest! {
        /// Whatever is pushed, taken and forgotten: each node comes back with its own zone, once.
        #[test]
        fn zones_come_back_as_they_were(all in prop::collection::vec((prop::collection::vec(bound(), 16), 0usize..8), 1..40)) {
            let mut waiting = WaitingZones::new(2);
            let mut batches = [Vec::new(), Vec::new()];
            let mut here: Vec<Option<LocalZone>> = Vec::new();
            let mut zone = LocalZone::start(1, 3);
            for (bounds, old) in all {
                zone.bounds_mut().copy_from_slice(&bounds);
                let at = batches[old % 2].len();
                if old > 2 && append_narrow(&bounds, &mut batches[old % 2]) {
                    waiting.push(PackedZone::Unwritten { worker: old % 2, at });
                } else {
                    waiting.push(PackedZone::of(&zone, &mut Vec::new()));
                }
                // Some are left before they are written.
                let written = old < 5;
                if written {
                    waiting.of_workers().iter_mut().zip(&mut batches).for_each(|(slab, batch)| {
                        slab.write(batch, 16);
                        batch.clear();
                    });
                }
                here.push(Some(zone.clone()));
                let old = old.min(here.len() - 1);
                let known = here[old].take();
                if written && old % 2 == 0 {
                    prop_assert_eq!(waiting.take(old as u32, &mut zone), known.is_some());
                    if let Some(known) = known {
                        prop_assert_eq!(&zone, &known);
                    }
                } else {
                    waiting.forget(old as u32);
                }
            }
            waiting.of_workers().iter_mut().zip(&batches).for_each(|(slab, batch)| slab.write(batch, 16));
            for (node, known) in here.into_iter().enumerate() {
                let taken = waiting.take(node as u32, &mut zone);
                prop_assert_eq!(taken.then(|| zone.clone()), known);
            }
        }
    }
}
