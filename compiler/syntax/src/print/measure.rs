//! The measures of a page.

/// Columns of a line; comments at its end may go further.
pub(super) const WIDTH: usize = 110;

/// Blanks of one more level.
pub(super) const STEP: usize = 2;
