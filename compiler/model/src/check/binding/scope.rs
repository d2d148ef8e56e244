//! Where something is bound.

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
