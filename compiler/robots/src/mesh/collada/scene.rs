//! The scene: nodes with their maps, and the geometries that they show.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{
    super::builder::MeshBuilder,
    geometry::{numbers, triangles_of},
    matrix::AffineMap,
    nodes::{all, first, text_of},
};
use crate::limits::{MOST_SCENE_NODES, MOST_XML_DEPTH};

struct ScenePlacer<'a, 'i, 'b> {
    /// Everything that has an `id`.
    ids: BTreeMap<&'a str, Node<'a, 'i>>,
    builder: &'b mut MeshBuilder,
    nodes: usize,
}

/// Adds all triangles of the scene that the file shows; of a file without a scene all its geometries.
pub(super) fn place_scene(root: Node, unit: f64, builder: &mut MeshBuilder) -> Result<(), String> {
    let ids = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut placer = ScenePlacer { ids, builder, nodes: 0 };
    let map = AffineMap::scale([unit; 3]);
    let shown = first(root, "scene").and_then(|scene| first(scene, "instance_visual_scene"));
    let shown = shown.and_then(|instance| placer.target(instance, "url"));
    let shown = shown
        .or_else(|| first(root, "library_visual_scenes").and_then(|library| first(library, "visual_scene")));
    match shown {
        Some(scene) => all(scene, "node").try_for_each(|node| placer.node(node, &map, 0)),
        None => all(root, "library_geometries")
            .flat_map(|library| all(library, "geometry"))
            .try_for_each(|geometry| triangles_of(geometry, &map, placer.builder)),
    }
}

impl<'a, 'i> ScenePlacer<'a, 'i, '_> {
    /// What a reference within the file leads to.
    fn target(&self, node: Node<'a, 'i>, attribute: &str) -> Option<Node<'a, 'i>> {
        let id = node.attribute(attribute)?.strip_prefix('#')?;
        self.ids.get(id).copied()
    }

    fn needs(&self, node: Node<'a, 'i>, attribute: &str) -> Result<Node<'a, 'i>, String> {
        self.target(node, attribute).ok_or_else(|| {
            let written = node.attribute(attribute).unwrap_or_default();
            format!("`{written}` leads to nothing in the file")
        })
    }

    fn node(&mut self, node: Node<'a, 'i>, above: &AffineMap, depth: usize) -> Result<(), String> {
        self.nodes += 1;
        if depth > MOST_XML_DEPTH || self.nodes > MOST_SCENE_NODES {
            return Err("its scene has too many nodes, or one that contains itself".to_owned());
        }
        let mut map = *above;
        for child in node.children().filter(Node::is_element) {
            if let Some(step) = step_of(child)? {
                map = map.after(&step);
            }
        }
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "node" => self.node(child, &map, depth + 1)?,
                "instance_node" => self.node(self.needs(child, "url")?, &map, depth + 1)?,
                "instance_geometry" => triangles_of(self.needs(child, "url")?, &map, self.builder)?,
                "instance_controller" => self.controller(self.needs(child, "url")?, &map)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// A skin or a morph as it is before anything moves it.
    fn controller(&mut self, controller: Node<'a, 'i>, map: &AffineMap) -> Result<(), String> {
        let Some(skin) = first(controller, "skin").or_else(|| first(controller, "morph")) else {
            return Ok(());
        };
        let map = match first(skin, "bind_shape_matrix") {
            Some(matrix) => map.after(&matrix_in(matrix)?),
            None => *map,
        };
        triangles_of(self.needs(skin, "source")?, &map, self.builder)
    }
}

fn matrix_in(node: Node) -> Result<AffineMap, String> {
    let [a, b, c, d, e, f, g, h, i, j, k, l, _, _, _, _] = exactly::<16>(node)?;
    Ok(AffineMap { rows: [[a, b, c, d], [e, f, g, h], [i, j, k, l]] })
}

/// One step of a node's map, if the element is one.
fn step_of(node: Node) -> Result<Option<AffineMap>, String> {
    Ok(Some(match node.tag_name().name() {
        "matrix" => matrix_in(node)?,
        "translate" => AffineMap::translate(exactly::<3>(node)?),
        "rotate" => AffineMap::rotate(exactly::<4>(node)?),
        "scale" => AffineMap::scale(exactly::<3>(node)?),
        other @ ("skew" | "lookat") => return Err(format!("`<{other}>` of its scene is not read")),
        _ => return Ok(None),
    }))
}

fn exactly<const N: usize>(node: Node) -> Result<[f64; N], String> {
    let found = numbers(&text_of(node))?;
    <[f64; N]>::try_from(found)
        .map_err(|found| format!("`<{}>` has {} numbers, and needs {N}", node.tag_name().name(), found.len()))
}
