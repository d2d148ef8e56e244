//! STL: triangles without indices, as bytes or as text.

use super::{
    builder::MeshBuilder,
    model::{MeshAxis, TriangleMesh},
};
use crate::space::transform::RobotVector;

const HEADER: usize = 80;
const RECORD: usize = 50;

pub(crate) fn read_stl(bytes: &[u8]) -> Result<TriangleMesh, String> {
    // Files of bytes may begin with `solid`, too: their length decides.
    match counted(bytes) {
        Some((count, records)) if records.len() == count * RECORD => read_records(records),
        _ if begins_as_text(bytes) => read_lines(&String::from_utf8_lossy(bytes)),
        Some((count, records)) => match records.get(..count * RECORD) {
            // Some programs write more behind the triangles.
            Some(records) => read_records(records),
            None => Err(format!(
                "it says that it has {count} triangles, and ends after {}",
                records.len() / RECORD
            )),
        },
        None => Err("it is too short".to_owned()),
    }
}

/// How many triangles there are, and what follows.
fn counted(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (count, records) = bytes.get(HEADER..)?.split_first_chunk::<4>()?;
    Some((u32::from_le_bytes(*count) as usize, records))
}

fn begins_as_text(bytes: &[u8]) -> bool {
    let start = bytes.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or_default();
    bytes
        .get(start..)
        .is_some_and(|rest| rest.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")))
}

fn read_records(records: &[u8]) -> Result<TriangleMesh, String> {
    let mut builder = MeshBuilder::default();
    for record in records.chunks_exact(RECORD) {
        // A normal, which follows from the corners, then three corners, then two bytes that mean nothing.
        let mut numbers = record.chunks_exact(4).skip(3).filter_map(|bytes| bytes.first_chunk::<4>());
        let mut number = || numbers.next().map_or(0.0, |bytes| f64::from(f32::from_le_bytes(*bytes)));
        let corners = [(); 3].map(|()| [(); 3].map(|()| number()));
        builder.triangle(corners)?;
    }
    Ok(builder.finish(MeshAxis::Z))
}

fn read_lines(text: &str) -> Result<TriangleMesh, String> {
    let mut builder = MeshBuilder::default();
    let mut corners: Vec<RobotVector> = Vec::new();
    for (at, line) in (1..).zip(text.lines()) {
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        match word.to_ascii_lowercase().as_str() {
            "vertex" => {
                let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
                let corner = RobotVector::try_from(numbers);
                corners.push(corner.map_err(|_| format!("line {at}: a vertex is three numbers"))?);
            }
            "endloop" => {
                if corners.len() < 3 {
                    return Err(format!("line {at}: a facet has three vertices"));
                }
                builder.polygon(&corners).map_err(|reason| format!("line {at}: {reason}"))?;
                corners.clear();
            }
            "solid" | "facet" | "outer" | "endfacet" | "endsolid" => {}
            _ => return Err(format!("line {at}: `{}` is no word of STL", word.escape_debug())),
        }
    }
    if corners.is_empty() {
        Ok(builder.finish(MeshAxis::Z))
    } else {
        Err("it ends within a facet".to_owned())
    }
}
