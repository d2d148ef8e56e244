//! Text to tokens to AST. Nothing outside this crate sees logos or lalrpop.
//!
//! # Steps
//!
//! 1. [`token`]: the vocabulary, one table of all keywords.
//! 2. `lex`: text to tokens; comments go, doc comments are kept aside, numbers take their units; `words` finds the keywords
//!    that can only be names.
//! 3. `outline`: tokens to one run for each declaration; missing closing braces are put in; `heads`
//!    says whether a keyword starts one.
//! 4. `grammar`: one run to one AST node (LALRPOP), as `run` asks for it.
//! 5. [`parse()`]: drives the above; a run that does not fit is read again member by member (`recover`), and what does
//!    not fit then costs that member alone (`report` says why).
//!
//! [`format()`] writes a text anew in the one style of the language (`print`).

pub mod ast;
mod binding;
mod context;
mod context_formula;
mod expected;
mod expr;
mod heads;
mod item_rules;
mod lex;
mod outline;
mod parse;
mod pattern;
mod print;
mod recover;
mod report;
mod run;
mod scope;
mod suites;
mod system;
mod temporal;
pub mod token;
mod words;
mod world;

#[allow(clippy::all, clippy::pedantic, unused, missing_docs, reason = "lalrpop writes it")]
mod grammar {
    lalrpop_util::lalrpop_mod!(generated, "/grammar.rs");
    pub use generated::UnitParser;
}

pub use item_rules::ItemRules;
pub use outline::{MAX_HEIGHT, MAX_NESTING};
pub use parse::{MAX_BYTES, parse};
pub use pattern::{CountBound, LastingBound, RequirementPattern, SentenceMapping};
pub use print::format;
pub use scope::{BannedEvents, DemandedCount, DemandedEvents, RequirementScope, RequirementSentence};
pub use temporal::{
    TemporalFormula, TemporalJunction, TemporalKind, TemporalLook, TemporalReach, TemporalWindow,
};

/// The grammar as the parser is made of it: `src/grammar.lalrpop` with the registry of keywords put in.
pub const GRAMMAR: &str = include_str!(concat!(env!("OUT_DIR"), "/grammar.lalrpop"));

/// Where the words of a text are that are no units: names and keywords, in order.
pub fn words(text: &str) -> impl Iterator<Item = std::ops::Range<usize>> {
    let tokens = lex::lex(hrdsl_source::FileId(0), text).tokens.into_iter();
    let is_word =
        |t: &std::ops::Range<usize>| text[t.clone()].starts_with(|c: char| c == '_' || c.is_alphabetic());
    tokens.map(|t| t.start as usize..t.end as usize).filter(is_word)
}

/// The spans of the tokens of a text, in order: for fuzzing the lexer by itself.
#[doc(hidden)]
#[must_use]
pub fn lex_only(text: &str) -> (Vec<std::ops::Range<usize>>, Vec<hrdsl_source::Diagnostic>) {
    let lexed = lex::lex(hrdsl_source::FileId(0), text);
    let spans = lexed.tokens.iter().map(|t| t.start as usize..t.end as usize).collect();
    (spans, lexed.diagnostics)
}
