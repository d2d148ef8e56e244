//! The system: the seam to whatever plays its actor, and the player that answers it and lets its programs speak with each other.

mod binding;
mod graph;
mod history;
mod mailbox;
mod parameters;
pub mod player;
mod program;
pub mod seam;
mod vocabulary;
