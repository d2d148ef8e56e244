//! Reports from [`Results`](crate::results::Results): the only module that writes prose.
//!
//! Whatever comes from a scenario, a test or a robot program is untrusted text: it is cleaned ([`text`]) and escaped
//! before it reaches a terminal, a browser or an XML parser.

mod facts;
#[cfg(test)]
pub(crate) mod fixture;
mod html;
mod junit;
mod model;
mod reasoning;
mod terminal;
mod text;

pub use html::html;
pub use junit::junit;
pub use model::explain_text;
pub use reasoning::{AgentEnd, End, Picked, ending, reasoning};
pub use terminal::summary;
