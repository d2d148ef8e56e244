//! The viewer: recorded tests as one page that replays them in 3D, with everything else that happened on a time line below.
//!
//! The page itself is TypeScript, in `viewer/` at the top of the project; the build script bundles it. `spec/view.md` says how it is read.
//!
//! # Map
//! - [`ViewDocument`] is the data of one run; `spec/view.schema.json` is its schema, [`schema`] prints it;
//! - [`requirement`] is what it says of requirements;
//! - [`columns`] makes the columns of whole numbers that documents have, tracks of bodies among them;
//! - [`replay`] makes a document of a program and a recording;
//! - [`page()`] puts runs into the page; [`packed_run`], [`packed_assets`] and [`packed_page`] are its parts, for pages that open it on demand.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

pub mod columns;
pub mod document;
mod page;
pub mod replay;
pub mod requirement;

pub use document::{SharedAssets, ViewDocument};
pub use page::{PageOpening, RunGroup, ViewedRun, packed_assets, packed_page, packed_run, page};

impl ViewDocument {
    /// A document without anything in it, with ticks of a millisecond.
    #[must_use]
    pub fn new() -> Self {
        Self {
            format: document::FORMAT.to_owned(),
            version: document::VERSION,
            hrdsl: env!("CARGO_PKG_VERSION").to_owned(),
            tick: 1_000_000,
            ..Self::default()
        }
    }
}

/// The schema of documents, in JSON Schema (2020-12), as text that ends in a line break.
///
/// # Errors
/// None that is known: the schema is plain data.
pub fn schema() -> Result<String, serde_json::Error> {
    let mut schema = schemars::schema_for!(ViewDocument);
    let assets = schemars::schema_for!(SharedAssets);
    if let Some(definitions) = schema.get_mut("$defs").and_then(|d| d.as_object_mut()) {
        let mut assets = serde_json::Value::from(assets);
        if let Some(object) = assets.as_object_mut() {
            object.remove("$schema");
            object.remove("$defs");
        }
        definitions.insert("SharedAssets".to_owned(), assets);
    }
    Ok(serde_json::to_string_pretty(&schema)? + "\n")
}
