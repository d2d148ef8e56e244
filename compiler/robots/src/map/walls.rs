//! Rectangles that together cover exactly the occupied cells.

use super::cells::CellGrid;

/// Cells of a rectangle: the first column and row, from the top left, and how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellRectangle {
    pub column: usize,
    pub row: usize,
    pub width: usize,
    pub height: usize,
}

/// Takes, from the first occupied cell that is not covered, in reading order, the widest run to the right and then as many
/// rows below as have the same run free; and so on. No cell is covered twice.
pub(crate) fn rectangles(grid: &CellGrid) -> Vec<CellRectangle> {
    let mut open = grid.occupied.clone();
    let mut found = Vec::new();
    let width = grid.width;
    if width == 0 {
        return found;
    }
    let is_open = |open: &[bool], row: usize, from: usize, to: usize| {
        row < grid.height
            && open.get(row * width + from..row * width + to).is_some_and(|run| run.iter().all(|cell| *cell))
    };
    for at in 0..open.len() {
        if !open.get(at).copied().unwrap_or_default() {
            continue;
        }
        let (row, column) = (at / width, at % width);
        let run = open.get(at..(row + 1) * width).unwrap_or_default();
        let wide = run.iter().take_while(|cell| **cell).count();
        let mut high = 1;
        while is_open(&open, row + high, column, column + wide) {
            high += 1;
        }
        for below in row..row + high {
            if let Some(run) = open.get_mut(below * width + column..below * width + column + wide) {
                run.fill(false);
            }
        }
        found.push(CellRectangle { column, row, width: wide, height: high });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{collection::vec, prelude::*};

    proptest! {
        #[test]
        fn rectangles_cover_each_occupied_cell_once_and_no_other(width in 1usize..12, cells in vec(any::<bool>(), 0..120)) {
            let height = cells.len() / width;
            let grid = CellGrid { width, height, occupied: cells[..width * height].to_vec() };
            let mut covered = vec![0; width * height];
            for r in rectangles(&grid) {
                for row in r.row..r.row + r.height {
                    for column in r.column..r.column + r.width {
                        covered[row * width + column] += 1;
                    }
                }
            }
            let expected: Vec<i32> = grid.occupied.iter().map(|o| i32::from(*o)).collect();
            prop_assert_eq!(covered, expected);
        }
    }
}
