//! Cells: which are occupied, by the rules of the map server's three modes.

use super::{image::MapImage, read::MapMode};

/// A grid of cells, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CellGrid {
    pub width: usize,
    pub height: usize,
    pub occupied: Vec<bool>,
}

/// The mode and its thresholds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellRule {
    pub mode: MapMode,
    pub negate: bool,
    pub occupied_thresh: f64,
}

impl CellRule {
    /// Which cells are occupied; those that are free or unknown are not.
    pub fn grid(&self, image: &MapImage) -> CellGrid {
        let shades = match self.mode {
            // An opacity counts as a channel in this mode, and is looked at for itself in the others.
            MapMode::Trinary => &image.with_alpha,
            MapMode::Scale | MapMode::Raw => &image.shades,
        };
        let occupied = shades.iter().zip(&image.clear).map(|(shade, clear)| self.is_occupied(*shade, *clear));
        CellGrid { width: image.width, height: image.height, occupied: occupied.collect() }
    }

    fn is_occupied(&self, shade: f64, clear: bool) -> bool {
        let shade = if self.negate { 1.0 - shade } else { shade };
        match self.mode {
            MapMode::Trinary => 1.0 - shade > self.occupied_thresh,
            MapMode::Scale if clear => false,
            // Between the thresholds it is a degree; only those beyond the upper one are certain.
            MapMode::Scale => 1.0 - shade > self.occupied_thresh,
            // The value itself is the occupancy, in percent; more than 100 is unknown.
            MapMode::Raw => {
                let value = libm::round(shade * 255.0);
                value <= 100.0 && value > self.occupied_thresh * 100.0
            }
        }
    }
}
