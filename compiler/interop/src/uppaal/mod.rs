//! UPPAAL: models and queries to scenarios, networks to models.

mod export;
mod import;

pub use export::{UppaalDocument, export};
pub use import::{UppaalOptions, import};
