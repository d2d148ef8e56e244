//! The formatter: text to the same text as everybody writes it. `spec/style.md` is the style.
//!
//! # Steps
//!
//! 1. `marks`: what the tree knows of single tokens: where members start, which braces are blocks, which signs are unary.
//! 2. `trivia`: the tokens with the comments and line ends around them; separators that mean nothing go.
//! 3. `shape`: members and blocks.
//! 4. `spacing`: blanks between two tokens, and where a line may break.
//! 5. `flat` and `layout`: members to lines.
//! 6. `align`: columns of neighbouring lines; lines to text.
//!
//! Tokens are copied and never made anew, but for separators: what is formatted means what it meant.

mod align;
mod flat;
mod layout;
mod marks;
mod measure;
mod shape;
mod spacing;
mod trivia;

use hrdsl_source::{Diagnostic, FileId};

use crate::parse::read;

/// The text in the style of the language, comments kept.
///
/// # Errors
/// The diagnostics of a text with faults, which is not to be changed.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let (tree, tokens, diagnostics) = read(FileId(0), text);
    if !diagnostics.is_empty() {
        return Err(diagnostics);
    }
    let marks = marks::marks(&tree, &tokens);
    let tokens = trivia::tokens(text, &tokens, &marks);
    let members = shape::members(&tokens);
    let lines = layout::lines(&tokens, &members);
    Ok(align::text(lines))
}
