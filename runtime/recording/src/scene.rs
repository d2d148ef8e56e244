//! What there is to be seen of a world: its bodies with their shapes at the start, its joints and its lasers.

use hrdsl_ir::{
    shape::BodyShape,
    solid::{PlacedSolid, SolidGeometry, SolidMesh},
    world::{Body, BodyId, BodyMotion, Joint, JointMotion, Laser, Vec3, World},
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::number::rounded;

/// x, y, z in metres, then the quaternion x, y, z, w.
pub type RecordedPose = [f64; 7];

/// A world as it looks at the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordedScene {
    pub bodies: Vec<RecordedBody>,
    pub joints: Vec<RecordedJoint>,
    #[serde(default)]
    pub lasers: Vec<RecordedLaser>,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordedBody {
    /// `robot.palm`; the name of its frame, too.
    pub name: String,
    pub kind: RecordedBodyKind,
    /// At the start, in the world.
    pub pose: RecordedPose,
    pub shapes: Vec<RecordedShape>,
    /// The place among the bodies of the one with which it is rigidly one, and moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carrier: Option<usize>,
    /// It collides with nothing.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ghost: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RecordedBodyKind {
    Robot,
    /// Somebody alive.
    Person,
    /// Furniture, and what is carried.
    Thing,
    /// Floors and walls.
    Room,
}

/// A shape, with its pose in its body's frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum RecordedShape {
    Box {
        size: [f64; 3],
        pose: RecordedPose,
    },
    Sphere {
        radius: f64,
        pose: RecordedPose,
    },
    /// Along z.
    Cylinder {
        radius: f64,
        length: f64,
        pose: RecordedPose,
    },
    /// Along z; the length is without the caps.
    Capsule {
        radius: f64,
        length: f64,
        pose: RecordedPose,
    },
    /// Its points are in the scenario's own files, not in the recording.
    Mesh {
        /// A digest of its points and triangles.
        mesh: String,
        /// The box that encloses it: full lengths, and its middle in the mesh's frame.
        extent: [f64; 3],
        middle: [f64; 3],
        pose: RecordedPose,
    },
}

/// A joint, with its limits in rad or m; without them it turns for ever.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordedJoint {
    pub name: String,
    pub unit: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
    /// Where it is at the start.
    pub start: f64,
}

/// A planar laser scanner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordedLaser {
    pub name: String,
    /// The place of its body among the bodies.
    pub body: usize,
    /// Where the beams begin, in the body's frame.
    pub at: [f64; 3],
    pub angles: [f64; 2],
    pub beams: u16,
    pub range: [f64; 2],
}

/// What is to be seen of a world.
#[must_use]
pub fn scene(world: &World) -> RecordedScene {
    let kinds = BodyKinds::of(world);
    let bodies = world.bodies.iter().enumerate().map(|(at, body)| RecordedBody {
        name: body.name.clone(),
        kind: kinds.kind(at, body),
        pose: pose(body.position, body.rotation),
        shapes: shapes(body),
        carrier: carrier(world, at),
        ghost: body.ghost,
    });
    RecordedScene {
        bodies: bodies.collect(),
        joints: world.joints.iter().map(joint).collect(),
        lasers: world.lasers.iter().map(laser).collect(),
    }
}

/// The meshes of a world by their digests, which a scene only names.
pub fn meshes(world: &World) -> impl Iterator<Item = &SolidMesh> {
    let solids = world.bodies.iter().filter_map(|body| body.solid.as_ref());
    solids.flat_map(|solid| &solid.shapes).filter_map(|placed| match &placed.geometry {
        SolidGeometry::Mesh(mesh) => Some(&**mesh),
        SolidGeometry::Plain(_) => None,
    })
}

fn joint(joint: &Joint) -> RecordedJoint {
    let unit = match joint.motion {
        JointMotion::Hinge => "rad",
        JointMotion::Slider => "m",
    };
    RecordedJoint {
        name: joint.name.clone(),
        unit: unit.to_owned(),
        limits: (!joint.is_endless()).then(|| [fine(joint.lo), fine(joint.hi)]),
        start: fine(joint.drive.start),
    }
}

fn laser(laser: &Laser) -> RecordedLaser {
    RecordedLaser {
        name: laser.name.clone(),
        body: usize::from(laser.body.0),
        at: laser.at.map(fine),
        angles: [fine(laser.lo), fine(laser.hi)],
        beams: laser.beams,
        range: [fine(laser.nearest), fine(laser.farthest)],
    }
}

/// The body that stands for all that this one is rigidly one with, if that is another one.
fn carrier(world: &World, at: usize) -> Option<usize> {
    let mut root = at;
    // Joints form no circles; if they did, they would be no more than so many.
    for _ in 0..world.joints.len() {
        let above = world.joints.iter().find(|j| j.is_rigid() && usize::from(j.child.0) == root);
        let Some(above) = above else { break };
        root = usize::from(above.parent.0);
    }
    (root != at).then_some(root)
}

/// Which bodies are of a robot, or of somebody alive.
struct BodyKinds {
    /// By body: a number of what it is joined to.
    groups: Vec<usize>,
    robots: Vec<usize>,
    people: Vec<BodyId>,
}

impl BodyKinds {
    fn of(world: &World) -> Self {
        let mut groups: Vec<usize> = (0..world.bodies.len()).collect();
        let group = |groups: &[usize], body: BodyId| groups.get(usize::from(body.0)).copied();
        for joint in &world.joints {
            let (Some(from), Some(to)) = (group(&groups, joint.parent), group(&groups, joint.child)) else {
                continue;
            };
            for known in groups.iter_mut().filter(|known| **known == to) {
                *known = from;
            }
        }
        let arms = world.arms.iter().map(|arm| arm.tip);
        let bodies =
            arms.chain(world.grippers.iter().map(|g| g.palm)).chain(world.bases.iter().map(|b| b.body));
        let people: Vec<BodyId> = world
            .figures
            .iter()
            .flat_map(|f| {
                let limbs = f.limbs.iter().flat_map(|l| [Some(l.upper), Some(l.lower), l.end]);
                limbs.flatten().chain([f.pelvis, f.trunk, f.head])
            })
            .collect();
        let robots = bodies.filter(|body| !people.contains(body)).filter_map(|body| group(&groups, body));
        Self { robots: robots.collect(), groups, people }
    }

    fn kind(&self, at: usize, body: &Body) -> RecordedBodyKind {
        let is_person = self.people.iter().any(|known| usize::from(known.0) == at);
        let is_robot = self.groups.get(at).is_some_and(|group| self.robots.contains(group));
        if is_person {
            return RecordedBodyKind::Person;
        }
        if is_robot {
            return RecordedBodyKind::Robot;
        }
        match body.motion {
            BodyMotion::Guided => RecordedBodyKind::Person,
            BodyMotion::Kinematic if body.stiffness.is_some() => RecordedBodyKind::Person,
            BodyMotion::Fixed if is_of_the_room(body) => RecordedBodyKind::Room,
            BodyMotion::Fixed | BodyMotion::Dynamic | BodyMotion::Kinematic => RecordedBodyKind::Thing,
        }
    }
}

/// Floors and walls are boxes that are thin one way, and large another.
fn is_of_the_room(body: &Body) -> bool {
    const THIN: f64 = 0.3;
    const LARGE: f64 = 1.8;
    let BodyShape::Box { size } = body.shape else { return body.solid.is_some() };
    let least = size.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = size.iter().copied().fold(0.0, f64::max);
    body.solid.is_some() || least <= THIN && greatest >= LARGE
}

fn shapes(body: &Body) -> Vec<RecordedShape> {
    let Some(solid) = &body.solid else { return vec![plain(body.shape, pose([0.0; 3], [0.0; 3]))] };
    let placed = |placed: &PlacedSolid| {
        let pose = pose(placed.position, placed.rotation);
        match &placed.geometry {
            SolidGeometry::Plain(shape) => plain(*shape, pose),
            SolidGeometry::Mesh(mesh) => {
                let (extent, middle) = extent(mesh);
                RecordedShape::Mesh { mesh: mesh.digest.clone(), extent, middle, pose }
            }
        }
    };
    solid.shapes.iter().map(placed).collect()
}

fn plain(shape: BodyShape, pose: RecordedPose) -> RecordedShape {
    match shape {
        BodyShape::Box { size } => RecordedShape::Box { size: size.map(fine), pose },
        BodyShape::Sphere { radius } => RecordedShape::Sphere { radius: fine(radius), pose },
        BodyShape::Capsule { radius, length } => {
            RecordedShape::Capsule { radius: fine(radius), length: fine(length), pose }
        }
        BodyShape::Cylinder { radius, length } => {
            RecordedShape::Cylinder { radius: fine(radius), length: fine(length), pose }
        }
    }
}

fn extent(mesh: &SolidMesh) -> ([f64; 3], [f64; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in &mesh.points {
        for ((low, high), x) in low.iter_mut().zip(&mut high).zip(point) {
            (*low, *high) = (low.min(f64::from(*x)), high.max(f64::from(*x)));
        }
    }
    if mesh.points.is_empty() {
        return ([0.0; 3], [0.0; 3]);
    }
    let ([a, b, c], [x, y, z]) = (low, high);
    ([x - a, y - b, z - c].map(fine), [x + a, y + b, z + c].map(|x| fine(x / 2.0)))
}

/// A hundredth of a millimetre is more than anybody sees.
fn fine(x: f64) -> f64 {
    rounded(x, 1e5)
}

/// A place, and roll, pitch, yaw about the fixed axes.
fn pose([x, y, z]: Vec3, [roll, pitch, yaw]: Vec3) -> RecordedPose {
    let half = |angle: f64| (libm::sin(angle / 2.0), libm::cos(angle / 2.0));
    let ((sr, cr), (sp, cp), (sy, cy)) = (half(roll), half(pitch), half(yaw));
    let turn = [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ];
    let [i, j, k, w] = turn.map(|x| rounded(x, 1e6));
    [fine(x), fine(y), fine(z), i, j, k, w]
}

/// A pose in another: first `outer`, then `inner` in its frame.
#[must_use]
pub fn composed(outer: &RecordedPose, inner: &RecordedPose) -> RecordedPose {
    let [x, y, z, i, j, k, w] = *outer;
    let [a, b, c, l, m, n, v] = *inner;
    let [a, b, c] = turned([i, j, k, w], [a, b, c]);
    [
        x + a,
        y + b,
        z + c,
        w * l + i * v + j * n - k * m,
        w * m + j * v + k * l - i * n,
        w * n + k * v + i * m - j * l,
        w * v - i * l - j * m - k * n,
    ]
}

/// The pose of `inner` in the frame of `outer`, of two in the same frame.
#[must_use]
pub fn relative(outer: &RecordedPose, inner: &RecordedPose) -> RecordedPose {
    let [x, y, z, i, j, k, w] = *outer;
    let back = [-i, -j, -k, w];
    let [a, b, c] = turned(back, [-x, -y, -z]);
    composed(&[a, b, c, -i, -j, -k, w], inner)
}

fn turned([i, j, k, w]: [f64; 4], [a, b, c]: [f64; 3]) -> [f64; 3] {
    let cross = |[a, b, c]: [f64; 3]| [j * c - k * b, k * a - i * c, i * b - j * a];
    let [p, q, r] = cross([a, b, c]);
    let [s, t, u] = cross([p, q, r]);
    [a + 2.0 * (w * p + s), b + 2.0 * (w * q + t), c + 2.0 * (w * r + u)]
}

#[cfg(test)]
mod tests {
    use super::{composed, pose, relative};

    fn is_near(a: [f64; 7], b: [f64; 7]) -> bool {
        a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5)
    }

    #[test]
    fn angles_are_about_the_fixed_axes() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let half = 0.5_f64.sqrt();
        assert!(is_near(pose([1.0, 2.0, 3.0], [0.0, 0.0, quarter]), [1.0, 2.0, 3.0, 0.0, 0.0, half, half]));
        // Roll first: what was up then points to the right, and stays there when it is turned about x no more.
        let turned = composed(&pose([0.0; 3], [quarter, 0.0, quarter]), &pose([0.0, 0.0, 1.0], [0.0; 3]));
        assert!((turned[0] - 1.0).abs() < 1e-5, "{turned:?}");
    }

    #[test]
    fn what_is_relative_composes_to_what_it_was() {
        let (a, b) = (pose([1.0, -2.0, 0.5], [0.3, -0.4, 2.0]), pose([0.2, 0.1, -1.0], [1.0, 0.2, -0.7]));
        assert!(is_near(composed(&a, &relative(&a, &b)), b));
    }
}
