//! Names of other tools as names of a scenario: what all importers do with them.

use indexmap::IndexSet;

/// Only ASCII letters, digits and `_`; a letter first.
pub(crate) fn clean(name: &str) -> String {
    let mut out: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !out.starts_with(|c: char| c.is_ascii_alphabetic()) {
        out.insert_str(0, "x_");
    }
    out
}

/// A name that is not yet in `used`.
pub(crate) fn unused(mut name: String, used: &IndexSet<String>) -> String {
    while used.contains(&name) {
        name.push('_');
    }
    name
}
