//! UPPAAL: models and queries to scenarios, networks to models.

mod export;
mod import;

pub use export::{Exported, export};
pub use import::{Options, import};
