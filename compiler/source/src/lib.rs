//! Where text came from: spans, files, line index, diagnostics and the registry of diagnostic codes.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod codes;
mod diagnostic;
mod files;
mod nearest;
mod printable;
mod shared_words;
mod span;
mod symbol;

pub use codes::{CodeInfo, DiagnosticCode, GROUPS, REGISTRY};
pub use diagnostic::{Diagnostic, Severity, SpanLabel, SuggestedFix, TextEdit};
pub use files::{SourceFile, SourceFiles, TextPosition};
pub use nearest::{distance, nearest};
pub use printable::{is_steering, printable, printable_char, printable_line};
pub use shared_words::{BinaryOp, LocationKind, OperatorSort, UnaryOp};
pub use span::{FileId, Span};
pub use symbol::{Enumeration, InternedTotals, Symbol};
