//! The section about names of the middleware at which somebody was alone.

use hrdsl_results::{CampaignResults, InterfaceWarning, TestName};
use serde::Serialize;

use super::pieces::TestLink;

#[derive(Serialize)]
pub struct InterfaceSection {
    warnings: Vec<InterfaceRow>,
    notes: Vec<InterfaceRow>,
}

#[derive(Serialize)]
struct InterfaceRow {
    name: String,
    type_name: String,
    sentence: String,
    /// What was perhaps meant; empty if nothing is near.
    near: String,
    /// What to add to the binding; empty if there is nothing to add.
    line: String,
    tests: u32,
    first: TestLink,
}

/// `None`: everybody met somebody.
pub fn section(results: &CampaignResults, link: &dyn Fn(&TestName) -> TestLink) -> Option<InterfaceSection> {
    let row = |warning: &InterfaceWarning| InterfaceRow {
        name: warning.name.clone(),
        type_name: warning.type_name.clone().unwrap_or_default(),
        sentence: warning.sentence(),
        near: warning.near.clone().unwrap_or_default(),
        line: warning.line.clone().unwrap_or_default(),
        tests: warning.tests,
        first: link(&warning.first),
    };
    let of = |is_note: bool| results.warnings.iter().filter(move |w| w.is_note() == is_note).map(row);
    let section = InterfaceSection { warnings: of(false).collect(), notes: of(true).collect() };
    (!results.warnings.is_empty()).then_some(section)
}
