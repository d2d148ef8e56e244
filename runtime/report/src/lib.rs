//! Reports: [`CampaignResults`](hrdsl_results::CampaignResults) to what people look at, and nothing else: the same results give the same bytes.
//!
//! # Map
//! - [`html`] is a page, [`html_with`] one with replays and faults, [`junit`] XML for continuous integration, [`summary`] for a terminal,
//!   [`trigger_totals`] how often each requirement was asked there;
//! - [`explain_text`] says what a suite's tests are for;
//! - [`text`] cleans. Whatever comes from a scenario, a test or a robot program is untrusted: it is cleaned and escaped before
//!   it reaches a terminal, a browser or an XML parser.
#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod facts;
#[cfg(test)]
mod fixture;
mod html;
mod junit;
mod model;
mod terminal;
pub mod text;

pub use html::{PageReplays, PageSupplement, html, html_with};
pub use junit::junit;
pub use model::explain_text;
pub use terminal::{summary, summary_of_recordings, trigger_totals};
