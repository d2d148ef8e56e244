//! The names of bins, as they are printed, stored and read back: `legs.four`, `human_robot.4 legs, ready`.

/// The name of a bin of a point or cross. The owner is an identifier, so that the first dot ends it; a line break or another
/// control character in the bin's name becomes a space, so that a name is one line.
#[must_use]
pub fn bin(owner: &str, bin: &str) -> String {
    format!("{owner}.{}", bin.replace(char::is_control, " "))
}

/// The owner and the bin of a name that [`bin`] made; `None` if it has not that form.
#[must_use]
pub fn split(name: &str) -> Option<(&str, &str)> {
    name.split_once('.').filter(|(owner, bin)| !owner.is_empty() && !bin.is_empty())
}
