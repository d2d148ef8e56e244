//! Networks of timed automata as text for other tools.
//!
//! - [`uppaal`]: UPPAAL's XML, with its queries
//! - [`tchecker`]: TChecker's text format
//! - [`picture`]: Graphviz's DOT and Mermaid's state diagrams
//!
//! What another tool cannot say is an [`Obstacle`]; nothing is left out silently.

pub mod picture;
mod show;
pub mod tchecker;
mod unit;
pub mod uppaal;

use hrdsl_ir::Span;

/// What keeps a network from being exported.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    pub message: String,
    /// Where it is written.
    pub origin: Span,
}
