//! How a search can fail.

use crate::{network::error::ModelError, witness::run::WitnessRun};

/// Why a search gave no report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// The model is at fault; the witness, if there is one, leads to the state in which it is.
    #[error("{error}")]
    Model { error: ModelError, witness: Option<Box<WitnessRun>> },
    /// The engine contradicts itself: a witness that does not replay. Never the model's fault.
    #[error("internal error of the model checker: {0}")]
    Internal(String),
}

impl From<ModelError> for SearchError {
    fn from(error: ModelError) -> Self {
        SearchError::Model { error, witness: None }
    }
}
