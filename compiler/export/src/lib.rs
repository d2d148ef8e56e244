//! Networks of automata to the files of other tools: `Program` in, text out. It is pure: whoever calls it writes files.
//!
//! - [`uppaal`]: UPPAAL's XML and its queries
//!
//! One module is one tool. What its language cannot say is an error with a name and a place ([`Unsaid`]); all of them are
//! given at once, and nothing is left out silently.

pub mod uppaal;

use hrdsl_source::Span;

/// Something that the other tool's language cannot say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsaid {
    /// Where the scenario says it.
    pub span: Span,
    pub message: String,
}

/// The texts of an export.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exported {
    /// The model.
    pub text: String,
    /// The queries alone, in a file of their own if the tool has one; otherwise empty.
    pub queries: String,
    /// What was left out; the model means the same without it.
    pub left_out: Vec<Unsaid>,
}

/// The greatest common divisor; of 0 and n it is n.
#[must_use]
pub fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
