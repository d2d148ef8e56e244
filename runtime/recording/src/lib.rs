//! A run as a file that other tools open, too: MCAP, with the steps that are judged, and a picture of the world beside them.
//!
//! # Map
//! - [`scene`] is what there is to be seen, from the data of a world;
//! - [`message`] is what hrdsl's own messages consist of, and [`schema`] their schemas; [`foxglove`] those that other tools know;
//! - [`columns`] are numbers over time, in little room;
//! - [`write`](write()) makes the file, [`read`](read()) takes it apart, as far as it goes; [`export`](export()) makes one for other tools of it.
//!
//! The judged steps are the very lines of a recording in text (`hrdsl_trace::record`), a message each: so both forms have the same verdicts.
//! `spec/recordings.md` lists the channels.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod channel;
pub mod columns;
mod container;
mod export;
pub mod foxglove;
pub mod message;
mod number;
mod read;
pub mod scene;
pub mod schema;
mod write;

pub use export::export;
pub use read::{RecordingError, RecordingFile, is_export, is_mcap, read};
pub use write::{RecordingForm, RunOnFile, write, write_as};

/// The CRC-32 of bytes, as recordings have it of files of code.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}
