//! PGM: grey values as words (P2) or as bytes (P5).

use super::image::MapImage;
use crate::limits::MOST_CELLS;

pub(super) fn read_pgm(bytes: &[u8]) -> Result<MapImage, String> {
    let mut words = PgmWords { bytes, at: 0 };
    let is_text = words.word() == Some(b"P2");
    let mut number = |what: &str| words.number().ok_or_else(|| format!("its {what} is missing"));
    let (width, height, most) = (number("width")?, number("height")?, number("largest grey value")?);
    if !(1..=0xffff).contains(&most) {
        return Err(format!("its largest grey value is {most}"));
    }
    let cells = width.checked_mul(height).filter(|cells| (1..=MOST_CELLS).contains(cells));
    let cells =
        cells.ok_or_else(|| format!("it has {width} × {height} cells, and at most {MOST_CELLS} are read"))?;
    // A text of two bytes a cell is the shortest that can be meant.
    if bytes.len() / if is_text { 2 } else { 1 } < cells.saturating_sub(1) {
        return Err("it ends before its last row".to_owned());
    }
    let values: Vec<usize> = if is_text {
        (0..cells).map_while(|_| words.number()).collect()
    } else {
        // One blank ends the head.
        let body = bytes.get(words.at + 1..).unwrap_or_default();
        if most > 255 {
            body.chunks_exact(2)
                .take(cells)
                .map(|pair| pair.iter().fold(0, |sum, b| sum * 256 + usize::from(*b)))
                .collect()
        } else {
            body.iter().take(cells).map(|byte| usize::from(*byte)).collect()
        }
    };
    if values.len() < cells {
        return Err("it ends before its last row".to_owned());
    }
    let shades: Vec<f64> = values.iter().map(|value| *value.min(&most) as f64 / most as f64).collect();
    Ok(MapImage { width, height, with_alpha: shades.clone(), clear: vec![false; cells], shades })
}

struct PgmWords<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> PgmWords<'a> {
    /// The next word; a `#` begins a comment up to the end of its line.
    fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            let byte = *self.bytes.get(self.at)?;
            if byte == b'#' {
                let rest = self.bytes.get(self.at..)?;
                self.at += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
            } else if byte.is_ascii_whitespace() {
                self.at += 1;
            } else {
                break;
            }
        }
        let rest = self.bytes.get(self.at..)?;
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        rest.get(..length)
    }

    fn number(&mut self) -> Option<usize> {
        std::str::from_utf8(self.word()?).ok()?.parse().ok()
    }
}
