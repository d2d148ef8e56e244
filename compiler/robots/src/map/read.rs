//! `map.yaml`: what the picture means, and where it lies.

use hrdsl_source::{FileId, SourceFiles, Span, nearest};

use super::{
    cells::CellRule,
    image::read_image,
    walls::{CellRectangle, rectangles},
};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    files::{
        path::{folder_of, joined},
        reader::{RobotReader, read_text},
    },
    yaml::{read_yaml, value::YamlValue},
};

/// An occupancy map as walls.
#[derive(Clone, Debug, PartialEq)]
pub struct OccupancyMap {
    /// The file of the picture.
    pub image: String,
    /// Columns and rows of its cells.
    pub columns: usize,
    pub rows: usize,
    /// The edge of a cell, m.
    pub resolution: f64,
    /// Where the lower left corner of the picture lies: x, y, and how far it is turned to the left, m and rad.
    pub origin: [f64; 3],
    pub mode: MapMode,
    /// How many cells are occupied.
    pub occupied: usize,
    /// They cover the occupied cells and nothing else, from the top left of the picture, in reading order.
    pub walls: Vec<MapWall>,
}

/// How grey values are read, as the map server of ROS calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapMode {
    /// Occupied, free or unknown, by thresholds.
    Trinary,
    /// A degree between the thresholds.
    Scale,
    /// The value itself is a percentage.
    Raw,
}

impl MapMode {
    pub const ALL: [Self; 3] = [Self::Trinary, Self::Scale, Self::Raw];

    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Trinary => "trinary",
            Self::Scale => "scale",
            Self::Raw => "raw",
        }
    }
}

/// A rectangle of occupied cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapWall {
    /// Its centre in the frame of the map, m.
    pub center: [f64; 2],
    /// Along its own x and y, m.
    pub size: [f64; 2],
    /// How far it is turned to the left, rad: the same for all walls of a map.
    pub yaw: f64,
}

/// Reads a map and its picture; `place` is where its path is written.
///
/// # Errors
/// The first thing that is wrong with it.
pub fn read_map(
    path: &str,
    place: impl Into<RobotPlace>,
    files: &mut SourceFiles,
    reader: &dyn RobotReader,
) -> Result<OccupancyMap, RobotFault> {
    let place = place.into();
    let (file, text) = read_text(reader, files, path, place)?;
    let yaml = read_yaml(&text).map_err(|fault| {
        let span = Span::new(file, fault.at, (fault.at + 1).min(text.len()));
        RobotFaultKind::BadYaml(fault.reason).at(span, "write `key: value` on each line")
    })?;
    let description = MapDescription { yaml: &yaml, file, text: &text };
    let image_path = joined(folder_of(path), description.image()?);
    let at_image = description.place_of("image");
    let bytes = reader.bytes(&image_path).map_err(|reason| {
        let help = format!("put the picture there ({reason}), or name another");
        RobotFaultKind::MissingFile(image_path.clone()).at(at_image, help)
    })?;
    let image = read_image(&bytes).map_err(|reason| {
        RobotFaultKind::BrokenImage { path: image_path.clone(), reason }.at(at_image, "save it as PGM or PNG")
    })?;
    let (resolution, origin, rule) = (description.resolution()?, description.origin()?, description.rule()?);
    let grid = rule.grid(&image);
    let wall = |rectangle: &CellRectangle| placed(rectangle, image.height, resolution, origin);
    Ok(OccupancyMap {
        image: image_path,
        columns: image.width,
        rows: image.height,
        resolution,
        origin,
        mode: rule.mode,
        occupied: grid.occupied.iter().filter(|cell| **cell).count(),
        walls: rectangles(&grid).iter().map(wall).collect(),
    })
}

/// Rows are counted from the top, and the map from the bottom.
fn placed(rectangle: &CellRectangle, rows: usize, resolution: f64, [x, y, yaw]: [f64; 3]) -> MapWall {
    let [column, row, width, height] =
        [rectangle.column, rectangle.row, rectangle.width, rectangle.height].map(|n| n as f64);
    let along = (column + width / 2.0) * resolution;
    let up = (rows as f64 - row - height / 2.0) * resolution;
    let (s, c) = (libm::sin(yaw), libm::cos(yaw));
    MapWall {
        center: [x + c * along - s * up, y + s * along + c * up],
        size: [width * resolution, height * resolution],
        yaw,
    }
}

struct MapDescription<'a> {
    yaml: &'a YamlValue,
    file: FileId,
    text: &'a str,
}

impl MapDescription<'_> {
    /// Where a key stands, or the start of the file.
    fn place_of(&self, key: &str) -> RobotPlace {
        let mut at = 0;
        for line in self.text.split_inclusive('\n') {
            if line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with(':')) {
                let start = at + line.len() - line.trim_start().len();
                return Span::new(self.file, start, at + line.trim_end().len()).into();
            }
            at += line.len();
        }
        Span::new(self.file, 0, 0).into()
    }

    fn bad<T>(&self, key: &str, reason: String, help: &str) -> Result<T, RobotFault> {
        Err(RobotFaultKind::BadMap(reason).at(self.place_of(key), help))
    }

    fn image(&self) -> Result<&str, RobotFault> {
        match self.yaml.get("image") {
            Some(YamlValue::Text(path)) if !path.is_empty() => Ok(path),
            _ => self.bad("image", "no `image` is named".to_owned(), "write `image: map.pgm`"),
        }
    }

    fn number(&self, key: &str, otherwise: Option<f64>, help: &str) -> Result<f64, RobotFault> {
        let number = match self.yaml.get(key) {
            Some(value) => value.number().or_else(|| boolean(value)),
            None => otherwise,
        };
        match number.filter(|number| number.is_finite()) {
            Some(number) => Ok(number),
            None => self.bad(key, format!("`{key}` is missing or no finite number"), help),
        }
    }

    fn resolution(&self) -> Result<f64, RobotFault> {
        const HELP: &str = "write the edge of a cell in metres: `resolution: 0.05`";
        let resolution = self.number("resolution", None, HELP)?;
        if resolution > 0.0 {
            Ok(resolution)
        } else {
            self.bad("resolution", format!("`resolution` is {resolution}"), HELP)
        }
    }

    fn origin(&self) -> Result<[f64; 3], RobotFault> {
        let numbers = match self.yaml.get("origin") {
            Some(YamlValue::List(items)) => items.iter().map(YamlValue::number).collect::<Option<Vec<f64>>>(),
            _ => None,
        };
        let three = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
        match three.filter(|three| three.iter().all(|number| number.is_finite())) {
            Some(origin) => Ok(origin),
            None => self.bad(
                "origin",
                "`origin` is no three numbers".to_owned(),
                "write `origin: [x, y, yaw]`, in metres and radians",
            ),
        }
    }

    fn rule(&self) -> Result<CellRule, RobotFault> {
        let mode = match self.yaml.get("mode") {
            None => MapMode::Trinary,
            Some(value) => {
                let word = if let YamlValue::Text(word) = value { word.as_str() } else { "" };
                match MapMode::ALL.into_iter().find(|mode| mode.word() == word) {
                    Some(mode) => mode,
                    None => {
                        let near = nearest(word, MapMode::ALL.map(MapMode::word)).unwrap_or("trinary");
                        return self.bad(
                            "mode",
                            format!("`{word}` is no mode"),
                            &format!("write `mode: {near}`"),
                        );
                    }
                }
            }
        };
        let threshold = |key: &str, otherwise: f64| -> Result<f64, RobotFault> {
            let help = format!("write a part of 1: `{key}: {otherwise}`");
            let value = self.number(key, Some(otherwise), &help)?;
            if (0.0..=1.0).contains(&value) {
                Ok(value)
            } else {
                self.bad(key, format!("`{key}` is {value}"), &help)
            }
        };
        let (occupied_thresh, free_thresh) =
            (threshold("occupied_thresh", 0.65)?, threshold("free_thresh", 0.25)?);
        if free_thresh > occupied_thresh {
            return self.bad(
                "free_thresh",
                format!("`free_thresh`, {free_thresh}, is above `occupied_thresh`, {occupied_thresh}"),
                "exchange the two",
            );
        }
        let negate = self.number("negate", Some(0.0), "write `negate: 0`")? != 0.0;
        Ok(CellRule { mode, negate, occupied_thresh })
    }
}

fn boolean(value: &YamlValue) -> Option<f64> {
    if let YamlValue::Bool(said) = value { Some(f64::from(u8::from(*said))) } else { None }
}
