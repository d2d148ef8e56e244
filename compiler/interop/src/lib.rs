//! Models that go to and fro between hrdsl and other tools, one folder for each tool. It is pure: files come from a [`ForeignLoader`].
//!
//! - [`agentspeak`]: Jason's `.asl` and `.mas2j` to scenarios
//! - [`uppaal`]: UPPAAL's models in XML and their queries, to scenarios and from networks; its traces
//! - [`tchecker`]: the text format of TChecker, to scenarios and from networks
//! - [`picture`]: networks in Graphviz's DOT and as Mermaid's state diagrams
//! - [`automaton`]: formulas as deterministic timed automata, which [`picture`] draws
//! - `exchange`: what they share: sources, notes and obstacles, names, times
//!
//! No tool knows another. What a scenario cannot say is left out, with a comment at its place and a [`ImportNote`]; what keeps a
//! network from another tool is an [`ExportObstacle`]; nothing is left out silently.

pub mod agentspeak;
pub mod automaton;
mod exchange;
pub mod picture;
pub mod tchecker;
pub mod uppaal;

pub use exchange::{
    note::{ImportNote, ImportedScenario, NoteSeverity, SyntaxError},
    obstacle::ExportObstacle,
    source::{ForeignLoader, ForeignSource, MAX_BYTES, NoForeignFiles},
};
