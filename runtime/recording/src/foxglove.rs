//! Messages that other tools know, by the names and fields that Foxglove documents for them: schemas, and the scene in their terms.

use serde_json::{Value, json};

use crate::scene::{
    RecordedBody, RecordedBodyKind, RecordedPose, RecordedScene, RecordedShape, composed, relative,
};

/// The frame in which everything is.
pub const WORLD: &str = "world";

fn object(title: &str, properties: Value) -> Value {
    let required: Vec<&String> = properties.as_object().map(|o| o.keys().collect()).unwrap_or_default();
    json!({ "title": title, "type": "object", "required": required, "properties": properties })
}

fn numbers(title: &str, names: &[&str]) -> Value {
    let properties = names.iter().map(|name| ((*name).to_owned(), json!({ "type": "number" })));
    object(title, Value::Object(properties.collect()))
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn whole() -> Value {
    json!({ "type": "integer", "minimum": 0 })
}

fn time() -> Value {
    let nanoseconds = json!({ "type": "integer", "minimum": 0, "maximum": 999_999_999 });
    object("time", json!({ "sec": whole(), "nsec": nanoseconds }))
}

fn duration() -> Value {
    let nanoseconds = json!({ "type": "integer", "minimum": 0, "maximum": 999_999_999 });
    object("duration", json!({ "sec": { "type": "integer" }, "nsec": nanoseconds }))
}

fn vector() -> Value {
    numbers("foxglove.Vector3", &["x", "y", "z"])
}

fn quaternion() -> Value {
    numbers("foxglove.Quaternion", &["x", "y", "z", "w"])
}

fn pose() -> Value {
    object("foxglove.Pose", json!({ "position": vector(), "orientation": quaternion() }))
}

fn color() -> Value {
    numbers("foxglove.Color", &["r", "g", "b", "a"])
}

/// The schema of `foxglove.SceneUpdate`. Primitives that no scene of ours has are said to be lists, and no more.
#[must_use]
pub fn scene_update() -> Value {
    let sized = || json!({ "pose": pose(), "size": vector(), "color": color() });
    let mut cylinder = sized();
    if let Some(fields) = cylinder.as_object_mut() {
        fields.insert("bottom_scale".to_owned(), json!({ "type": "number" }));
        fields.insert("top_scale".to_owned(), json!({ "type": "number" }));
    }
    let pair = object("foxglove.KeyValuePair", json!({ "key": text(), "value": text() }));
    let others = || json!({ "type": "array", "items": { "type": "object" } });
    let entity = object(
        "foxglove.SceneEntity",
        json!({
            "timestamp": time(),
            "frame_id": text(),
            "id": text(),
            "lifetime": duration(),
            "frame_locked": { "type": "boolean" },
            "metadata": list(pair),
            "arrows": others(),
            "cubes": list(object("foxglove.CubePrimitive", sized())),
            "spheres": list(object("foxglove.SpherePrimitive", sized())),
            "cylinders": list(object("foxglove.CylinderPrimitive", cylinder)),
            "lines": others(),
            "triangles": others(),
            "texts": others(),
            "models": others(),
        }),
    );
    let deletion = json!({ "timestamp": time(), "type": { "type": "integer" }, "id": text() });
    let deletions = list(object("foxglove.SceneEntityDeletion", deletion));
    object("foxglove.SceneUpdate", json!({ "deletions": deletions, "entities": list(entity) }))
}

/// The schema of `foxglove.FrameTransforms`.
#[must_use]
pub fn frame_transforms() -> Value {
    let transform = json!({
        "timestamp": time(),
        "parent_frame_id": text(),
        "child_frame_id": text(),
        "translation": vector(),
        "rotation": quaternion(),
    });
    let transforms = list(object("foxglove.FrameTransform", transform));
    object("foxglove.FrameTransforms", json!({ "transforms": transforms }))
}

/// The schema of `foxglove.JointStates`.
#[must_use]
pub fn joint_states() -> Value {
    let number = || json!({ "type": "number" });
    let joint = json!({
        "title": "foxglove.JointState",
        "type": "object",
        "required": ["name"],
        "properties": {
            "name": text(),
            "position": number(),
            "velocity": number(),
            "acceleration": number(),
            "effort": number(),
        },
    });
    object("foxglove.JointStates", json!({ "timestamp": time(), "joints": list(joint) }))
}

/// The schema of `foxglove.Log`.
#[must_use]
pub fn log() -> Value {
    let level = json!({ "title": "foxglove.LogLevel", "type": "integer", "minimum": 0, "maximum": 5 });
    object(
        "foxglove.Log",
        json!({
            "timestamp": time(),
            "level": level,
            "message": text(),
            "name": text(),
            "file": text(),
            "line": whole(),
        }),
    )
}

/// All bodies as entities of one update, each in a frame of its own name.
pub(crate) fn entities(scene: &RecordedScene) -> Value {
    let entities: Vec<Value> = scene.bodies.iter().map(entity).collect();
    json!({ "deletions": [], "entities": entities })
}

fn entity(body: &RecordedBody) -> Value {
    let alpha = if body.ghost { 0.25 } else { 1.0 };
    let [r, g, b] = match body.kind {
        RecordedBodyKind::Robot => [0.27, 0.47, 0.75],
        RecordedBodyKind::Person => [0.88, 0.55, 0.35],
        RecordedBodyKind::Thing => [0.62, 0.52, 0.4],
        RecordedBodyKind::Room => [0.8, 0.8, 0.78],
    };
    let color = json!({ "r": r, "g": g, "b": b, "a": alpha });
    let (mut cubes, mut spheres, mut cylinders) = (Vec::new(), Vec::new(), Vec::new());
    let sized = |pose: &RecordedPose, [x, y, z]: [f64; 3]| json!({ "pose": pose_message(pose), "size": { "x": x, "y": y, "z": z }, "color": color.clone() });
    let straight = |pose: &RecordedPose, radius: f64, length: f64| {
        let mut cylinder = sized(pose, [2.0 * radius, 2.0 * radius, length]);
        if let Some(fields) = cylinder.as_object_mut() {
            fields.insert("bottom_scale".to_owned(), json!(1));
            fields.insert("top_scale".to_owned(), json!(1));
        }
        cylinder
    };
    let shifted = |pose: &RecordedPose, [x, y, z]: [f64; 3]| composed(pose, &[x, y, z, 0.0, 0.0, 0.0, 1.0]);
    for shape in &body.shapes {
        match shape {
            RecordedShape::Box { size, pose } => cubes.push(sized(pose, *size)),
            RecordedShape::Sphere { radius, pose } => spheres.push(sized(pose, [2.0 * radius; 3])),
            RecordedShape::Cylinder { radius, length, pose } => {
                cylinders.push(straight(pose, *radius, *length))
            }
            RecordedShape::Capsule { radius, length, pose } => {
                cylinders.push(straight(pose, *radius, *length));
                for end in [-length / 2.0, length / 2.0] {
                    spheres.push(sized(&shifted(pose, [0.0, 0.0, end]), [2.0 * radius; 3]));
                }
            }
            // The box around it: its points are not in the recording.
            RecordedShape::Mesh { extent, middle, pose, .. } => {
                cubes.push(sized(&shifted(pose, *middle), *extent))
            }
        }
    }
    json!({
        "timestamp": { "sec": 0, "nsec": 0 },
        "frame_id": body.name,
        "id": body.name,
        "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": true,
        "metadata": [],
        "arrows": [],
        "cubes": cubes,
        "spheres": spheres,
        "cylinders": cylinders,
        "lines": [],
        "triangles": [],
        "texts": [],
        "models": [],
    })
}

fn pose_message(pose: &RecordedPose) -> Value {
    let [x, y, z, i, j, k, w] = *pose;
    json!({ "position": { "x": x, "y": y, "z": z }, "orientation": { "x": i, "y": j, "z": k, "w": w } })
}

/// Where all bodies are at the start: those that are one with another in its frame.
pub(crate) fn start_transforms(scene: &RecordedScene) -> Value {
    let transform = |body: &RecordedBody| {
        let carrier = body.carrier.and_then(|at| scene.bodies.get(at));
        let pose = carrier.map_or(body.pose, |carrier| relative(&carrier.pose, &body.pose));
        let [x, y, z, i, j, k, w] = pose.map(|x| crate::number::rounded(x, 1e6));
        json!({
            "timestamp": { "sec": 0, "nsec": 0 },
            "parent_frame_id": carrier.map_or(WORLD, |carrier| carrier.name.as_str()),
            "child_frame_id": body.name,
            "translation": { "x": x, "y": y, "z": z },
            "rotation": { "x": i, "y": j, "z": k, "w": w },
        })
    };
    json!({ "transforms": scene.bodies.iter().map(transform).collect::<Vec<_>>() })
}
