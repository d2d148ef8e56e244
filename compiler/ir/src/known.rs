//! Names of what a Program is known to have.

/// The name of something that was looked up by an id of the same Program, for a text that people read.
///
/// The checker gave the id, so that it is there, whatever `what` it is. Should it be missing all the same, that is a fault of hrdsl's own and
/// is told as one: no text is made of it.
#[must_use]
#[track_caller]
pub fn known_name<'a>(what: &str, name: Option<&'a str>) -> &'a str {
    name.unwrap_or_else(|| panic!("this program has no such {what}"))
}
