//! What another tool cannot say.

use hrdsl_ir::Span;

/// What keeps a network from being exported.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportObstacle {
    pub message: String,
    /// Where it is written.
    pub origin: Span,
}
