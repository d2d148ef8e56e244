//! TChecker: systems to scenarios, networks to systems.

mod export;
mod import;

pub use export::export;
pub use import::{TcheckerOptions, import};
