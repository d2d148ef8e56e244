//! Diagnostics and pages as output: for people, as JSON, as SARIF.

mod around;
mod diff;
mod excerpt;
mod formula;
mod human;
mod json;
mod page;
mod sarif;

pub use around::around;
pub use diff::unified;
pub use formula::formula;
pub use human::{SHOWN, diagnostic, totals};
pub use json::document as json;
pub use page::terminal as page;
pub use sarif::document as sarif;
