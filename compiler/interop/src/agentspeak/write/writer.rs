//! All that the text is made of.

use crate::agentspeak::{
    infer::Inferred,
    names::{Names, unused},
    survey::Survey,
    system::System,
};

/// All that the text is made of.
pub struct Writer<'a> {
    pub system: &'a System,
    pub inferred: &'a Inferred,
    pub names: &'a Names,
    pub surveys: &'a [Survey],
}

/// The name of the rule that answers with the whole numbers from one to another.
pub fn between(names: &Names) -> String {
    unused("between".to_owned(), &names.beliefs.values().cloned().collect())
}
