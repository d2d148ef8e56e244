//! The zones of states whose successors are not computed yet.
//!
//! Few of all states wait, but a whole zone of local times is large beside what is kept of a state for good. Nearly all bounds are
//! small, so that a zone is kept in half the room wherever all of its bounds fit.

use super::zone::{INF, LocalZone, LocalZoneBound};
use crate::search::store::NIL;

/// By node, the zone that it waits with.
#[derive(Default)]
pub(super) struct WaitingZones {
    /// By node: its zone's place, as [`ZonePlace`] packs it, or [`NIL`].
    places: Vec<u32>,
    /// How many wait.
    count: usize,
    narrow: ZoneSlab<i16>,
    wide: ZoneSlab<LocalZoneBound>,
}

/// Zones of one length, end to end.
#[derive(Default)]
struct ZoneSlab<N> {
    bounds: Vec<N>,
    /// The numbers of zones that nobody waits with.
    free: Vec<u32>,
}

/// A zone, in half the room where its bounds let it.
pub(super) enum PackedZone<'a> {
    Narrow(&'a [i16]),
    Wide(&'a [LocalZoneBound]),
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
    Narrow(u32),
    Wide(u32),
}

impl ZonePlace {
    const WIDE: u32 = 1 << 31;

    fn pack(&self) -> u32 {
        match self {
            Self::Narrow(n) => *n,
            Self::Wide(n) => n | Self::WIDE,
        }
    }

    fn unpack(packed: u32) -> Self {
        if packed & Self::WIDE == 0 { Self::Narrow(packed) } else { Self::Wide(packed & !Self::WIDE) }
    }
}

impl<N: Copy + Default> ZoneSlab<N> {
    /// Room for a zone: its number, and where to write it.
    fn room(&mut self, length: usize) -> (u32, &mut [N]) {
        let number = self.free.pop().unwrap_or_else(|| {
            let next = self.bounds.len() / length.max(1);
            self.bounds.resize(self.bounds.len() + length, N::default());
            next as u32
        });
        (number, &mut self.bounds[number as usize * length..][..length])
    }

    fn zone(&self, number: u32, length: usize) -> &[N] {
        &self.bounds[number as usize * length..][..length]
    }

    fn bytes(&self) -> usize {
        size_of_val(self.bounds.as_slice())
    }
}

impl WaitingZones {
    /// The next node waits with this zone.
    pub(super) fn push(&mut self, zone: PackedZone) {
        let place = match zone {
            PackedZone::Narrow(bounds) => {
                let (number, room) = self.narrow.room(bounds.len());
                room.copy_from_slice(bounds);
                ZonePlace::Narrow(number)
            }
            PackedZone::Wide(bounds) => {
                let (number, room) = self.wide.room(bounds.len());
                room.copy_from_slice(bounds);
                ZonePlace::Wide(number)
            }
        };
        self.places.push(place.pack());
        self.count += 1;
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
        match ZonePlace::unpack(place) {
            ZonePlace::Narrow(number) => widen(self.narrow.zone(number, bounds.len()), bounds),
            ZonePlace::Wide(number) => bounds.copy_from_slice(self.wide.zone(number, bounds.len())),
        }
        true
    }

    /// The node waits no longer; whether it did.
    pub(super) fn forget(&mut self, node: u32) -> bool {
        let place = std::mem::replace(&mut self.places[node as usize], NIL);
        if place == NIL {
            return false;
        }
        self.count -= 1;
        match ZonePlace::unpack(place) {
            ZonePlace::Narrow(number) => self.narrow.free.push(number),
            ZonePlace::Wide(number) => self.wide.free.push(number),
        }
        true
    }

    /// With a place in a list for each that waits.
    pub(super) fn bytes(&self) -> usize {
        self.narrow.bytes() + self.wide.bytes() + (self.places.len() + self.count) * size_of::<u32>()
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
            let mut waiting = WaitingZones::default();
            let mut here: Vec<Option<LocalZone>> = Vec::new();
            let mut zone = LocalZone::start(1, 3);
            for (bounds, old) in all {
                zone.bounds_mut().copy_from_slice(&bounds);
                waiting.push(PackedZone::of(&zone, &mut Vec::new()));
                here.push(Some(zone.clone()));
                let old = old.min(here.len() - 1);
                let known = here[old].take();
                if old % 2 == 0 {
                    prop_assert_eq!(waiting.take(old as u32, &mut zone), known.is_some());
                    if let Some(known) = known {
                        prop_assert_eq!(&zone, &known);
                    }
                } else {
                    waiting.forget(old as u32);
                }
            }
            for (node, known) in here.into_iter().enumerate() {
                let taken = waiting.take(node as u32, &mut zone);
                prop_assert_eq!(taken.then(|| zone.clone()), known);
            }
        }
    }
}
