//! The build of a figure, and its postures: where its bodies are when its feet, its hip, its head and its hands are given.
//!
//! The figure's own frame lies on the ground below its hip at the start, x ahead. The pelvis keeps upright over the feet; the trunk leans
//! about the hip; limbs are two bones between three pivots, whose middle one bends as it is drawn, or, if it is drawn straight, knees
//! forward and elbows back and down.

use hrdsl_ir::world::{BodyId, Figure, Limb};

use crate::math::{BodyFrame, RotationQuat, SpaceVector, about, v3};
use crate::physics::PhysicsAdapter;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// The farthest that a trunk leans, rad: 70°.
const FARTHEST_LEAN: f64 = 1.22;
/// Lower than this no hip is, m.
const LEAST_HIP: f64 = 0.1;
/// How low the hip goes, of its height.
const LOWEST_HIP: f64 = 0.35;
/// How many postures between upright and bowed are looked at.
const BOWS: i32 = 20;
/// How much of an arm's length is reached with ease, and how much of that downwards.
const EASY_REACH: f64 = 0.9;
const STEEP_REACH: f64 = 0.85;
/// How much a limb that can reach no farther is still bent, m.
const BENT: f64 = 1e-3;
/// How far a middle pivot is from the straight line if it says how the limb bends, m.
const DRAWN: f64 = 0.01;

/// What is measured of a figure once.
#[derive(Clone, Debug)]
pub(super) struct FigureBuild {
    pub pelvis: BodyId,
    pub trunk: BodyId,
    pub head: BodyId,
    /// The height of the hip, m.
    pub hip: f64,
    /// In the frame of the hip.
    pelvis_local: BodyFrame,
    trunk_local: BodyFrame,
    /// From the hip, in the frame of the trunk's lean; how it is turned in the figure's.
    head_local: BodyFrame,
    pub limbs: Vec<LimbBuild>,
}

#[derive(Clone, Debug)]
pub(super) struct LimbBuild {
    pub upper: BodyId,
    pub lower: BodyId,
    pub end: Option<BodyId>,
    /// Whether it hangs on the trunk: an arm.
    pub is_arm: bool,
    /// Its first pivot, in the frame of the hip or of the lean.
    root: SpaceVector,
    lengths: [f64; 2],
    /// Where its end is at the start, in the figure's frame.
    pub rest: SpaceVector,
    /// To which side its middle pivot goes, in the figure's frame.
    bend: SpaceVector,
    /// The bodies in the frames of their bones.
    upper_local: BodyFrame,
    lower_local: BodyFrame,
    end_local: BodyFrame,
    /// The last pivot from the end of the lower bone, in its frame.
    wrist_local: SpaceVector,
}

/// How somebody stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FigurePosture {
    /// The figure's frame.
    pub stance: BodyFrame,
    /// Where the hip is from above the feet, level, m.
    pub sway: SpaceVector,
    /// The height of the hip, m.
    pub hip: f64,
    /// Forward, rad.
    pub lean: f64,
}

impl FigureBuild {
    /// Measures a figure as it is drawn.
    pub fn new(figure: &Figure, physics: &PhysicsAdapter) -> (FigureBuild, BodyFrame) {
        let ahead = physics.start(figure.pelvis).x_axis();
        let heading = libm::atan2(ahead.y, ahead.x);
        let hip = v3(figure.hip);
        let lowers = figure.limbs.iter().map(|limb| limb.lower).chain([figure.pelvis]);
        let ground = lowers.map(|body| physics.lowest(body)).fold(hip.z - LEAST_HIP, f64::min);
        let stance = BodyFrame::new(SpaceVector::new(hip.x, hip.y, ground), about(SpaceVector::z(), heading));
        let at_hip = BodyFrame::new(hip, stance.turn);
        let local = |body: BodyId| at_hip.inverse().then(&physics.start(body));
        let limbs = figure.limbs.iter().map(|limb| LimbBuild::new(limb, figure, &stance, &at_hip, physics));
        let build = FigureBuild {
            pelvis: figure.pelvis,
            trunk: figure.trunk,
            head: figure.head,
            hip: hip.z - ground,
            pelvis_local: local(figure.pelvis),
            trunk_local: local(figure.trunk),
            head_local: local(figure.head),
            limbs: limbs.collect(),
        };
        (build, stance)
    }

    /// Where the head is in the figure's frame when it stands upright.
    pub fn head_at_rest(&self) -> BodyFrame {
        BodyFrame::new(SpaceVector::z() * self.hip + self.head_local.at, self.head_local.turn)
    }

    /// The hip and the lean that bring the head to a height above the ground, as near as can be; and how far ahead of the feet it is
    /// then, and how high.
    pub fn bow(&self, height: f64) -> (f64, f64, f64, f64) {
        let from_hip = self.head_local.at;
        let (length, drawn) =
            ((from_hip.x.powi(2) + from_hip.z.powi(2)).sqrt(), libm::atan2(from_hip.x, from_hip.z));
        let upright = self.hip + from_hip.z;
        let lean_at = |height: f64, hip: f64| libm::acos(((height - hip) / length).clamp(-1.0, 1.0)) - drawn;
        let (hip, lean) = if height >= upright {
            (self.hip, 0.0)
        } else {
            let lean = lean_at(height, self.hip);
            if lean <= FARTHEST_LEAN {
                (self.hip, lean.max(0.0))
            } else {
                let below = height - length * libm::cos(FARTHEST_LEAN + drawn);
                (below.max(LOWEST_HIP * self.hip), FARTHEST_LEAN)
            }
        };
        let (ahead, up) = (length * libm::sin(lean + drawn), length * libm::cos(lean + drawn));
        (hip, lean, ahead, hip + up)
    }

    /// Whether a hand reaches a place, as the figure stands; both in its own frame, for this lean and height of the hip.
    pub fn reaches(&self, limb: &LimbBuild, (hip, lean): (f64, f64), place: SpaceVector) -> bool {
        (place - self.shoulder(limb, hip, lean)).norm() <= limb.lengths[0] + limb.lengths[1]
    }

    /// How to reach a place at a height above the ground with a hand: the height of the hip and the lean, and how far the place is then
    /// ahead of the feet, and to the left of them. The figure bows no more than it must.
    pub fn step_up(&self, limb: &LimbBuild, height: f64) -> (f64, f64, f64, f64) {
        let reach = EASY_REACH * (limb.lengths[0] + limb.lengths[1]);
        let bows = (0..=BOWS).map(|i| f64::from(i) / f64::from(BOWS));
        let leans = bows.clone().map(|part| (self.hip, part * FARTHEST_LEAN));
        let crouches = bows.map(|part| (self.hip * (1.0 - part * (1.0 - LOWEST_HIP)), FARTHEST_LEAN));
        let low_enough =
            |(hip, lean): &(f64, f64)| self.shoulder(limb, *hip, *lean).z - height <= STEEP_REACH * reach;
        let lowest = (self.hip * LOWEST_HIP, FARTHEST_LEAN);
        let (hip, lean) = leans.chain(crouches).find(low_enough).unwrap_or(lowest);
        let shoulder = self.shoulder(limb, hip, lean);
        let below = (shoulder.z - height).clamp(-reach, reach);
        (hip, lean, shoulder.x + (reach * reach - below * below).sqrt(), shoulder.y)
    }

    /// In the figure's frame.
    fn shoulder(&self, limb: &LimbBuild, hip: f64, lean: f64) -> SpaceVector {
        SpaceVector::z() * hip + about(SpaceVector::y(), lean) * limb.root
    }

    /// Where the head is in the figure's frame, for a height of the hip and a lean.
    pub fn head_at(&self, hip: f64, lean: f64) -> SpaceVector {
        SpaceVector::z() * hip + about(SpaceVector::y(), lean) * self.head_local.at
    }

    /// The frames of the hip and of the lean about it.
    pub fn frames(&self, posture: &FigurePosture) -> (BodyFrame, BodyFrame) {
        let stance = &posture.stance;
        let hip = BodyFrame::new(stance.at + posture.sway + SpaceVector::z() * posture.hip, stance.turn);
        (hip, BodyFrame::new(hip.at, hip.turn * about(SpaceVector::y(), posture.lean)))
    }

    /// Where pelvis, trunk and, if it is not turned in a way of its own, head are, of the frames of hip and lean.
    pub fn torso(
        &self,
        stance: &BodyFrame,
        (hip, lean): &(BodyFrame, BodyFrame),
    ) -> [(BodyId, BodyFrame); 3] {
        let head = BodyFrame::new(lean.point(self.head_local.at), stance.turn * self.head_local.turn);
        let (pelvis, trunk) = (hip.then(&self.pelvis_local), lean.then(&self.trunk_local));
        [(self.pelvis, pelvis), (self.trunk, trunk), (self.head, head)]
    }

    /// Where its bodies hang together as they are now: a body, a point in the world, and another body.
    pub fn pivots(&self, physics: &PhysicsAdapter) -> Vec<(BodyId, SpaceVector, BodyId)> {
        let hip = physics.pose(self.pelvis).then(&self.pelvis_local.inverse()).at;
        // Where the neck is nobody says: midway is near enough for a fall.
        let neck = (physics.pose(self.trunk).at + physics.pose(self.head).at) / 2.0;
        let mut pivots = vec![(self.pelvis, hip, self.trunk), (self.trunk, neck, self.head)];
        for limb in &self.limbs {
            let of = if limb.is_arm { self.trunk } else { self.pelvis };
            let top = |body: BodyId, local: &BodyFrame| physics.pose(body).then(&local.inverse()).at;
            pivots.push((of, top(limb.upper, &limb.upper_local), limb.upper));
            pivots.push((limb.upper, top(limb.lower, &limb.lower_local), limb.lower));
            let wrist = physics.pose(limb.lower).point(limb.wrist_local);
            pivots.extend(limb.end.map(|end| (limb.lower, wrist, end)));
        }
        pivots
    }

    /// Where the bodies of a limb are whose end is to come to a place; `moved` is how far the trunk is from where it is to be.
    pub fn limb(
        &self,
        limb: &LimbBuild,
        stance: &BodyFrame,
        (hip, lean): &(BodyFrame, BodyFrame),
        end: SpaceVector,
        moved: SpaceVector,
    ) -> [(BodyId, BodyFrame); 3] {
        let root = if limb.is_arm { lean.point(limb.root) + moved } else { hip.point(limb.root) };
        let [upper, lower] = limb.bones(root, end, stance.turn * limb.bend);
        let at_end =
            lower.then(&BodyFrame::new(-SpaceVector::z() * limb.lengths[1], RotationQuat::identity()));
        [
            (limb.upper, upper.then(&limb.upper_local)),
            (limb.lower, lower.then(&limb.lower_local)),
            (limb.end.unwrap_or(limb.lower), at_end.then(&limb.end_local)),
        ]
    }
}

impl LimbBuild {
    fn new(
        limb: &Limb,
        figure: &Figure,
        stance: &BodyFrame,
        hip: &BodyFrame,
        physics: &PhysicsAdapter,
    ) -> LimbBuild {
        let [root, middle, last] = limb.pivots.map(v3);
        let end = limb.end.map_or(last, |end| physics.start(end).at);
        let is_arm = limb.of == figure.trunk;
        let usual = if is_arm { SpaceVector::new(-0.5, 0.0, -1.0) } else { SpaceVector::x() };
        let line = (end - root).normalize();
        let aside = (middle - root) - line * (middle - root).dot(&line);
        let bend = if aside.norm() > DRAWN { stance.turn.inverse() * aside.normalize() } else { usual };
        let lengths = [(middle - root).norm(), (end - middle).norm()];
        let own = BodyFrame::new(SpaceVector::zeros(), RotationQuat::identity());
        let mut build = LimbBuild {
            upper: limb.upper,
            lower: limb.lower,
            end: limb.end,
            is_arm,
            root: hip.inverse().point(root),
            lengths,
            rest: stance.inverse().point(end),
            bend,
            upper_local: own,
            lower_local: own,
            end_local: own,
            wrist_local: SpaceVector::zeros(),
        };
        let [upper, lower] = build.bones(root, end, stance.turn * bend);
        let at_end = lower.then(&BodyFrame::new(-SpaceVector::z() * lengths[1], RotationQuat::identity()));
        build.upper_local = upper.inverse().then(&physics.start(limb.upper));
        build.lower_local = lower.inverse().then(&physics.start(limb.lower));
        build.end_local = limb.end.map_or(own, |end| at_end.inverse().then(&physics.start(end)));
        build.wrist_local = physics.start(limb.lower).inverse().point(last);
        build
    }

    /// The frames of its bones: at their upper pivots, each with the bone along its −z.
    fn bones(&self, root: SpaceVector, end: SpaceVector, bend: SpaceVector) -> [BodyFrame; 2] {
        let [a, b] = self.lengths;
        let way = end - root;
        let line = if way.norm() > 1e-9 { way.normalize() } else { -SpaceVector::z() };
        let far = way.norm().clamp((a - b).abs() + BENT, a + b - BENT);
        let aside = bend - line * bend.dot(&line);
        let aside = if aside.norm() > 1e-6 { aside.normalize() } else { across(&line) };
        let along = (a * a + far * far - b * b) / (2.0 * far);
        let middle = root + line * along + aside * (a * a - along * along).max(0.0).sqrt();
        let normal = line.cross(&aside);
        let bone = |from: SpaceVector, to: SpaceVector| {
            BodyFrame::new(from, with_axes((from - to).normalize(), normal))
        };
        [bone(root, middle), bone(middle, root + line * far)]
    }
}

/// Some unit vector across another.
fn across(line: &SpaceVector) -> SpaceVector {
    let other = if line.x.abs() < 0.9 { SpaceVector::x() } else { SpaceVector::y() };
    line.cross(&other).normalize()
}

/// The rotation with these z and y axes, which are across each other.
fn with_axes(z: SpaceVector, y: SpaceVector) -> RotationQuat {
    let x = y.cross(&z);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z])))
}
