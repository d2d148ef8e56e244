//! UPPAAL: models and queries to scenarios, networks to models, and the traces that it writes.

mod export;
mod import;
mod rate;
mod trace;

pub use export::{UppaalDocument, export, export_with};
pub use import::{UppaalOptions, import};
pub use trace::{UppaalMove, UppaalTrace, read_trace};
