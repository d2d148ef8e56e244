//! OBJ: points and polygons; what is said of colours, curves and groups is passed over.

use super::{
    builder::MeshBuilder,
    model::{MeshAxis, TriangleMesh},
};
use crate::space::transform::RobotVector;

pub(crate) fn read_obj(bytes: &[u8]) -> Result<TriangleMesh, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut builder = MeshBuilder::default();
    let mut points: Vec<RobotVector> = Vec::new();
    let mut lines = (1..).zip(text.lines());
    while let Some((at, line)) = lines.next() {
        let mut whole = line.to_owned();
        // A line that ends in a backslash goes on.
        while let Some(before) = whole.strip_suffix('\\') {
            let next = lines.next().map(|(_, next)| next).unwrap_or_default();
            whole = format!("{before} {next}");
        }
        let mut words = whole.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                points.push(point(words).ok_or_else(|| format!("line {at}: a point is three numbers"))?)
            }
            Some("f") => {
                let corners = words.map(|word| corner(word, &points)).collect::<Option<Vec<RobotVector>>>();
                // Of two points it is a line, which has no area.
                let corners =
                    corners.ok_or_else(|| format!("line {at}: a face names points by their numbers"))?;
                builder.polygon(&corners).map_err(|reason| format!("line {at}: {reason}"))?;
            }
            Some(_) | None => {}
        }
    }
    Ok(builder.finish(MeshAxis::Z))
}

/// Three numbers; some programs write a weight or a colour behind them.
fn point<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<RobotVector> {
    let mut number = || words.next()?.parse::<f64>().ok().filter(|number| number.is_finite());
    Some([number()?, number()?, number()?])
}

/// `7`, `7/1`, `7//2`, `7/1/2`; from 1, or from the last if it is negative.
fn corner(word: &str, points: &[RobotVector]) -> Option<RobotVector> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let at = match number {
        1.. => usize::try_from(number - 1).ok()?,
        0 => return None,
        _ => points.len().checked_sub(usize::try_from(number.checked_neg()?).ok()?)?,
    };
    points.get(at).copied()
}
