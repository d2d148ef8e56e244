//! One module for each command.

pub mod calibrate;
pub mod campaign;
pub mod check;
pub mod completions;
pub mod conformance;
pub mod emit;
pub mod explain;
pub mod export;
pub mod fmt;
pub mod generate;
pub mod import;
pub mod inspect;
pub mod judge;
pub mod man;
pub mod mutate;
pub mod new;
pub mod prove;
pub mod recorded;
pub mod report;
pub mod run;
pub mod search_options;
pub mod shown;
pub mod sim;
pub mod sources;
pub mod step;
pub mod view;
