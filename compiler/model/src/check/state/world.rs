//! Names of the world: full names (`robot.palm`) of everything in it, by kind.

use super::table::NameTable;
use std::collections::BTreeSet;

use hrdsl_source::Span;

use crate::{BodyId, BodyRef, CurrentId, noun::Noun};

/// Full names (`robot.palm`) of everything in the world, by kind.
#[derive(Default)]
pub(crate) struct WorldNames {
    pub instances: NameTable,
    pub bodies: NameTable,
    pub joints: NameTable,
    pub arms: NameTable,
    pub grippers: NameTable,
    pub bases: NameTable,
    pub lasers: NameTable,
    pub limbs: NameTable,
    pub figures: NameTable,
    pub currents: NameTable,
    pub signals: NameTable,
    /// Instances of unknown parts: nothing is said about what they have.
    pub broken: BTreeSet<String>,
    /// How many members there are so far.
    pub members: usize,
}

impl WorldNames {
    fn tables(&self) -> [(Noun, &NameTable); 11] {
        [
            (Noun::Body, &self.bodies),
            (Noun::Current, &self.currents),
            (Noun::Gripper, &self.grippers),
            (Noun::Arm, &self.arms),
            (Noun::Base, &self.bases),
            (Noun::Laser, &self.lasers),
            (Noun::Limb, &self.limbs),
            (Noun::Figure, &self.figures),
            (Noun::Joint, &self.joints),
            (Noun::Signal, &self.signals),
            (Noun::PartInstance, &self.instances),
        ]
    }

    /// Where a full name is declared: that of something of this kind if there is one, else whatever it is of.
    pub fn place_of(&self, noun: Noun, full: &str) -> Option<Span> {
        let tables = self.tables();
        let of_kind = tables.iter().find(|(of, _)| *of == noun).and_then(|(_, table)| table.span_of(full));
        of_kind.or_else(|| tables.iter().find_map(|(_, table)| table.span_of(full)))
    }

    pub fn get(&self, noun: Noun, full: &str) -> Option<u16> {
        self.tables().into_iter().find(|(n, _)| *n == noun).and_then(|(_, t)| t.get(full))
    }

    pub fn kind_of(&self, full: &str) -> Option<Noun> {
        self.tables().into_iter().find(|(_, t)| t.get(full).is_some()).map(|(n, _)| n)
    }

    pub fn body_ref(&self, full: &str) -> Option<BodyRef> {
        let body = self.bodies.get(full).map(|id| BodyRef::Body(BodyId(id)));
        body.or_else(|| self.currents.get(full).map(|id| BodyRef::Current(CurrentId(id))))
    }

    pub fn is_instance(&self, full: &str) -> bool {
        self.instances.get(full).is_some()
    }

    /// The names of this kind directly below a prefix. Where a body is meant, a current body will do;
    /// where a device is, whatever is one.
    pub fn below(&self, noun: Noun, prefix: &str) -> Vec<String> {
        let fits = |n: Noun| {
            n == noun
                || noun == Noun::Body && n == Noun::Current
                || noun == Noun::Device && matches!(n, Noun::Arm | Noun::Gripper | Noun::Base | Noun::Laser)
        };
        let tables = self.tables().into_iter().filter(|(n, _)| fits(*n));
        let names = tables.flat_map(|(_, t)| t.names().filter_map(|n| n.strip_prefix(prefix)));
        names.filter(|n| !n.contains('.')).map(str::to_owned).collect()
    }
}
