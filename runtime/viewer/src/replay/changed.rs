//! What of a world is another since it was recorded.

use std::collections::BTreeSet;

use hrdsl_recording::scene::{RecordedBody, RecordedScene, RecordedShape};

/// So many names are told.
const MOST: usize = 5;

/// A sentence about what has changed, if anything has. A mesh that is gone is no other world: something stands for it.
pub(super) fn said(then: &RecordedScene, now: &RecordedScene) -> Option<String> {
    if then == now {
        return None;
    }
    if without_meshes(then) == without_meshes(now) {
        let same = |(then, now): &(&RecordedBody, &RecordedBody)| then == now;
        let others =
            then.bodies.iter().zip(&now.bodies).filter(|pair| !same(pair)).map(|(then, _)| &*then.name);
        return Some(format!(
            "Meshes are gone, or others than those of the recording, and boxes stand for them: {}.",
            few(others.collect())
        ));
    }
    let differs = |body: &&RecordedBody, others: &RecordedScene| !others.bodies.contains(body);
    let bodies = then.bodies.iter().filter(|body| differs(body, now));
    let bodies = bodies.chain(now.bodies.iter().filter(|body| differs(body, then))).map(|body| &*body.name);
    let joints = then.joints.iter().filter(|joint| !now.joints.contains(joint));
    let joints = joints.chain(now.joints.iter().filter(|joint| !then.joints.contains(joint)));
    let names: BTreeSet<&str> = bodies.chain(joints.map(|joint| &*joint.name)).collect();
    let which = if names.is_empty() { String::new() } else { format!(" ({})", few(names)) };
    Some(format!("The world of the scenario has changed since{which}: the one of the recording is shown."))
}

fn few(names: BTreeSet<&str>) -> String {
    let told = names.iter().take(MOST).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST) {
        0 => told,
        rest => format!("{told} and {rest} more"),
    }
}

/// The scene with one and the same mesh in the place of all.
fn without_meshes(scene: &RecordedScene) -> RecordedScene {
    let mut scene = scene.clone();
    for shape in scene.bodies.iter_mut().flat_map(|body| &mut body.shapes) {
        if let RecordedShape::Mesh { mesh, extent, middle, .. } = shape {
            mesh.clear();
            (*extent, *middle) = ([0.0; 3], [0.0; 3]);
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use hrdsl_recording::scene::RecordedBodyKind;

    use super::*;

    fn body(name: &str, shape: RecordedShape) -> RecordedBody {
        RecordedBody {
            name: name.to_owned(),
            kind: RecordedBodyKind::Thing,
            pose: [0.0; 7],
            shapes: vec![shape],
            carrier: None,
            ghost: false,
        }
    }

    fn scene(mesh: &str, size: f64) -> RecordedScene {
        let mesh = RecordedShape::Mesh {
            mesh: mesh.to_owned(),
            extent: [size; 3],
            middle: [0.0; 3],
            pose: [0.0; 7],
        };
        let plain = RecordedShape::Box { size: [1.0; 3], pose: [0.0; 7] };
        RecordedScene { bodies: vec![body("cup", mesh), body("table", plain)], ..RecordedScene::default() }
    }

    #[test]
    fn a_mesh_that_is_gone_is_no_other_world() {
        let then = scene("a", 1.0);
        assert_eq!(said(&then, &then), None);
        let gone = said(&then, &scene("b", 2.0)).unwrap();
        assert!(gone.starts_with("Meshes are gone") && gone.ends_with("stand for them: cup."), "{gone}");
    }

    #[test]
    fn what_has_changed_is_named() {
        let then = scene("a", 1.0);
        let mut now = scene("b", 2.0);
        now.bodies[1].pose[0] = 1.0;
        now.bodies.extend(
            (0..5).map(|n| body(&format!("new{n}"), RecordedShape::Sphere { radius: 1.0, pose: [0.0; 7] })),
        );
        let changed = said(&then, &now).unwrap();
        let expected = "The world of the scenario has changed since (cup, new0, new1, new2, new3 and 2 more): the one of the recording is shown.";
        assert_eq!(changed, expected);
    }
}
