//! One geometry: its points, and the polygons of all kinds between them.

use roxmltree::Node;

use super::{
    super::builder::MeshBuilder,
    matrix::AffineMap,
    nodes::{all, first, text_of},
};
use crate::space::transform::RobotVector;

/// Numbers with blanks between them, all finite.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |word: &str| {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| format!("`{}` is no finite number", word.escape_debug()))
    };
    text.split_ascii_whitespace().map(number).collect()
}

fn indices(node: Node) -> Result<Vec<usize>, String> {
    let index = |word: &str| word.parse().map_err(|_| format!("`{}` is no index", word.escape_debug()));
    text_of(node).split_ascii_whitespace().map(index).collect()
}

/// Adds the triangles of a `geometry`, each point mapped.
pub(super) fn triangles_of(geometry: Node, map: &AffineMap, builder: &mut MeshBuilder) -> Result<(), String> {
    let Some(mesh) = first(geometry, "mesh").or_else(|| first(geometry, "convex_mesh")) else {
        return Ok(());
    };
    let mut adder = PolygonAdder { mesh, map, builder, points: None };
    for part in mesh.children().filter(Node::is_element) {
        match part.tag_name().name() {
            "triangles" => adder.equal(part, 3)?,
            "polylist" => adder.polylist(part)?,
            "polygons" => adder.polygons(part)?,
            "tristrips" => adder.strips(part)?,
            "trifans" => adder.fans(part)?,
            _ => {}
        }
    }
    Ok(())
}

struct PolygonAdder<'a, 'i, 'b> {
    mesh: Node<'a, 'i>,
    map: &'b AffineMap,
    builder: &'b mut MeshBuilder,
    /// The points of the source that was read last, and its name.
    points: Option<(String, Vec<RobotVector>)>,
}

/// Where in each corner's indices that of its point is.
struct CornerLayout {
    stride: usize,
    offset: usize,
}

impl PolygonAdder<'_, '_, '_> {
    fn equal(&mut self, part: Node, corners: usize) -> Result<(), String> {
        let Some(layout) = self.layout(part)? else { return Ok(()) };
        for list in all(part, "p") {
            let points = self.corners(&indices(list)?, &layout)?;
            points.chunks_exact(corners).try_for_each(|polygon| self.add(polygon))?;
        }
        Ok(())
    }

    fn polylist(&mut self, part: Node) -> Result<(), String> {
        let Some(layout) = self.layout(part)? else { return Ok(()) };
        let counts = first(part, "vcount").map(indices).transpose()?.unwrap_or_default();
        let list = first(part, "p").map(indices).transpose()?.unwrap_or_default();
        let points = self.corners(&list, &layout)?;
        let mut rest = points.as_slice();
        for count in counts {
            let (polygon, after) = rest.split_at_checked(count).ok_or("a `polylist` has too few indices")?;
            self.add(polygon)?;
            rest = after;
        }
        Ok(())
    }

    fn polygons(&mut self, part: Node) -> Result<(), String> {
        let Some(layout) = self.layout(part)? else { return Ok(()) };
        if first(part, "ph").is_some() {
            return Err("polygons with holes (`<ph>`) are not read".to_owned());
        }
        for list in all(part, "p") {
            let points = self.corners(&indices(list)?, &layout)?;
            self.add(&points)?;
        }
        Ok(())
    }

    fn strips(&mut self, part: Node) -> Result<(), String> {
        let Some(layout) = self.layout(part)? else { return Ok(()) };
        for list in all(part, "p") {
            let points = self.corners(&indices(list)?, &layout)?;
            for (at, window) in points.windows(3).enumerate() {
                if let [a, b, c] = window {
                    // Every second triangle of a strip runs the other way round.
                    let corners = if at % 2 == 0 { [*a, *b, *c] } else { [*a, *c, *b] };
                    self.add(&corners)?;
                }
            }
        }
        Ok(())
    }

    fn fans(&mut self, part: Node) -> Result<(), String> {
        let Some(layout) = self.layout(part)? else { return Ok(()) };
        for list in all(part, "p") {
            let points = self.corners(&indices(list)?, &layout)?;
            self.add(&points)?;
        }
        Ok(())
    }

    fn add(&mut self, polygon: &[RobotVector]) -> Result<(), String> {
        if self.map.mirrors() {
            let back: Vec<RobotVector> = polygon.iter().rev().copied().collect();
            self.builder.polygon(&back)
        } else {
            self.builder.polygon(polygon)
        }
    }

    /// Finds the points of a part; `None` if it has none.
    fn layout(&mut self, part: Node) -> Result<Option<CornerLayout>, String> {
        let offset =
            |input: Node| input.attribute("offset").and_then(|o| o.parse::<usize>().ok()).unwrap_or_default();
        let stride = all(part, "input").map(|input| offset(input).saturating_add(1)).max().unwrap_or(1);
        let semantic = |input: &Node| input.attribute("semantic").unwrap_or_default().to_owned();
        let Some(input) = all(part, "input").find(|i| matches!(semantic(i).as_str(), "VERTEX" | "POSITION"))
        else {
            return Ok(None);
        };
        let mut source = reference(input)?;
        if semantic(&input) == "VERTEX" {
            let mut vertices =
                all(self.mesh, "vertices").filter(|v| v.attribute("id") == Some(source.as_str()));
            let vertices = vertices.next().ok_or_else(|| format!("`#{source}` leads to no `<vertices>`"))?;
            let position = all(vertices, "input").find(|i| semantic(i) == "POSITION");
            source = reference(position.ok_or("`<vertices>` has no POSITION")?)?;
        }
        if self.points.as_ref().is_none_or(|(name, _)| *name != source) {
            let points = self.source(&source)?;
            self.points = Some((source, points));
        }
        Ok(Some(CornerLayout { stride, offset: offset(input) }))
    }

    /// The points of a `source`, mapped.
    fn source(&self, id: &str) -> Result<Vec<RobotVector>, String> {
        let mut sources = all(self.mesh, "source").filter(|source| source.attribute("id") == Some(id));
        let source = sources.next().ok_or_else(|| format!("`#{id}` leads to no `<source>`"))?;
        let array = first(source, "float_array").ok_or_else(|| format!("`#{id}` has no `<float_array>`"))?;
        let values = numbers(&text_of(array))?;
        let accessor = first(source, "technique_common").and_then(|common| first(common, "accessor"));
        let number = |name: &str, otherwise: usize| -> usize {
            let written = accessor.and_then(|accessor| accessor.attribute(name));
            written.and_then(|written| written.parse().ok()).unwrap_or(otherwise)
        };
        let (stride, start) = (number("stride", 3), number("offset", 0));
        if stride < 3 {
            return Err(format!("the points of `#{id}` have {stride} coordinates"));
        }
        let values = values.get(start..).unwrap_or_default();
        let point = |record: &[f64]| match record {
            [x, y, z, ..] => Some(self.map.place([*x, *y, *z])),
            _ => None,
        };
        Ok(values.chunks(stride).filter_map(point).take(number("count", usize::MAX)).collect())
    }

    /// The points of a list of indices.
    fn corners(&self, list: &[usize], layout: &CornerLayout) -> Result<Vec<RobotVector>, String> {
        let points = self.points.as_ref().map(|(_, points)| points.as_slice()).unwrap_or_default();
        let corner = |record: &[usize]| {
            let at = *record.get(layout.offset)?;
            points.get(at).copied()
        };
        let corners = list.chunks_exact(layout.stride).map(corner).collect::<Option<Vec<RobotVector>>>();
        corners.ok_or_else(|| "an index leads to no point".to_owned())
    }
}

fn reference(input: Node) -> Result<String, String> {
    let source = input.attribute("source").and_then(|source| source.strip_prefix('#'));
    source.map(str::to_owned).ok_or_else(|| "an `<input>` has no source".to_owned())
}
