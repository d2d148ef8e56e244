//! The picture of a map, by its kind.

use super::{pgm::read_pgm, picture::read_png};

/// A picture in shades of grey, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapImage {
    pub width: usize,
    pub height: usize,
    /// From 0, black, to 1, white; the mean of the channels.
    pub shades: Vec<f64>,
    /// The same with an opacity as one more channel.
    pub with_alpha: Vec<f64>,
    /// Whether a cell is not wholly opaque.
    pub clear: Vec<bool>,
}

/// Reads PGM and PNG, by what they begin with.
pub(crate) fn read_image(bytes: &[u8]) -> Result<MapImage, String> {
    match bytes {
        [b'P', b'2' | b'5', ..] => read_pgm(bytes),
        [0x89, b'P', b'N', b'G', ..] => read_png(bytes),
        _ => Err("it is neither PGM (P2, P5) nor PNG".to_owned()),
    }
}
