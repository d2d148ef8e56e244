//! For whom something is bound, and where it stands.

use hrdsl_messages::MessageLibrary;

use crate::ActorId;

/// What is being bound: for whom, and to which definitions.
#[derive(Clone, Copy)]
pub(super) struct BindingScope<'a> {
    pub actor: ActorId,
    pub library: &'a MessageLibrary,
}

/// Whose entries they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BindingPlace {
    /// Messages go to the programs, so that fields get values.
    pub fields: bool,
    /// Messages come from them, so that rules say what they mean.
    pub rules: bool,
    /// Messages go at a rate, whatever happens.
    pub periodic: bool,
    /// There is an arm, whose joints may have other names.
    pub joints: bool,
}

impl BindingPlace {
    pub const OUTPUT: Self = Self { fields: false, rules: true, periodic: false, joints: false };
    pub const SERVICE: Self = Self { fields: true, rules: true, periodic: true, joints: false };

    pub fn input(periodic: bool) -> Self {
        Self { fields: true, rules: false, periodic, joints: false }
    }
}
