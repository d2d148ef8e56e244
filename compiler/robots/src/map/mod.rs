//! Occupancy maps: a picture and its description as walls.

pub(crate) mod cells;
pub(crate) mod image;
mod pgm;
mod picture;
pub(crate) mod read;
pub(crate) mod walls;
