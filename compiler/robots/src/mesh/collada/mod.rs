//! COLLADA: the triangles of its geometries, where the nodes of the scene put them.

mod geometry;
mod matrix;
mod nodes;
mod scene;

use roxmltree::{Document, Node};

use super::{
    builder::MeshBuilder,
    model::{MeshAxis, TriangleMesh},
};
use crate::xml::DeclaredText;
use nodes::{first, text_of};
use scene::place_scene;

pub(crate) fn read_collada(bytes: &[u8]) -> Result<TriangleMesh, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not written in UTF-8".to_owned())?;
    if crate::xml::depth_of(text) > crate::limits::MOST_XML_DEPTH {
        return Err("its elements lie too deep in each other".to_owned());
    }
    let declared = DeclaredText::new(text);
    let document = Document::parse(&declared.text).map_err(|error| error.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("it begins with `<{}>`", root.tag_name().name()));
    }
    let mut builder = MeshBuilder::default();
    place_scene(root, unit(root)?, &mut builder)?;
    Ok(builder.finish(up_axis(root)))
}

/// Metres for one unit of the file.
fn unit(root: Node) -> Result<f64, String> {
    let written =
        first(root, "asset").and_then(|asset| first(asset, "unit")).and_then(|unit| unit.attribute("meter"));
    let Some(written) = written else { return Ok(1.0) };
    let meters = written.trim().parse::<f64>().ok().filter(|meters| meters.is_finite() && *meters > 0.0);
    meters.ok_or_else(|| format!("its unit is `{written}` metres"))
}

fn up_axis(root: Node) -> MeshAxis {
    let written =
        first(root, "asset").and_then(|asset| first(asset, "up_axis")).map(text_of).unwrap_or_default();
    match written.trim() {
        "X_UP" => MeshAxis::X,
        "Z_UP" => MeshAxis::Z,
        // So says its standard.
        _ => MeshAxis::Y,
    }
}
