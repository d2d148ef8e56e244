//! PNG, in any of its kinds of colours.

use png::{ColorType, Decoder, Limits, Transformations};

use super::image::MapImage;
use crate::limits::{MOST_CELLS, MOST_MESH_BYTES};

pub(super) fn read_png(bytes: &[u8]) -> Result<MapImage, String> {
    let mut decoder =
        Decoder::new_with_limits(std::io::Cursor::new(bytes), Limits { bytes: 4 * MOST_MESH_BYTES });
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let cells = width.checked_mul(height).filter(|cells| *cells <= MOST_CELLS);
    let cells =
        cells.ok_or_else(|| format!("it has {width} × {height} cells, and at most {MOST_CELLS} are read"))?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(|error| error.to_string())?;
    let (colors, has_alpha) = match info.color_type {
        ColorType::Grayscale | ColorType::Indexed => (1, false),
        ColorType::GrayscaleAlpha => (1, true),
        ColorType::Rgb => (3, false),
        ColorType::Rgba => (3, true),
    };
    let channels = colors + usize::from(has_alpha);
    let mean = |values: &[u8]| {
        let sum: u32 = values.iter().map(|value| u32::from(*value)).sum();
        f64::from(sum) / (255.0 * values.len().max(1) as f64)
    };
    let rows = || pixels.chunks_exact(channels).take(cells);
    let image = MapImage {
        width,
        height,
        shades: rows().map(|pixel| mean(pixel.get(..colors).unwrap_or(pixel))).collect(),
        with_alpha: rows().map(mean).collect(),
        clear: rows().map(|pixel| has_alpha && pixel.last().is_some_and(|alpha| *alpha < 255)).collect(),
    };
    if image.shades.len() == cells { Ok(image) } else { Err("it ends before its last row".to_owned()) }
}
