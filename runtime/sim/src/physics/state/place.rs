//! Where the two sides of each joint are: found once after each step of the engine, and asked for many times.

use std::cell::Cell;

use hrdsl_ir::world::JointMotion;
use rapier3d::prelude::*;

use crate::math::{BodyFrame, SpaceVector, angle_between, from_pose, twist};

/// A body that joints are on, and how it was moved from where it was at the start.
struct JointedBody {
    handle: RigidBodyHandle,
    /// What takes it back to its own origin: the inverse of its start.
    home: BodyFrame,
    /// Where the engine had it when this was found, and what that comes to.
    pose: Pose,
    moved: BodyFrame,
    is_news: bool,
}

/// The bodies that joints are on.
#[derive(Default)]
pub(crate) struct JointedBodies {
    all: Vec<JointedBody>,
}

impl JointedBodies {
    /// Adds the two sides of a joint, whose axis and anchor at the start are these: their numbers, and where it is.
    pub fn place(
        &mut self,
        sides: [(RigidBodyHandle, BodyFrame); 2],
        bodies: &RigidBodySet,
        line: (&SpaceVector, &SpaceVector),
    ) -> ([usize; 2], JointPlace) {
        let numbers = sides.map(|(handle, start)| self.add(handle, &bodies[handle], &start));
        let [parent, child] = numbers.map(|number| self.moved(number));
        (numbers, JointPlace::of(line, parent, child))
    }

    /// The number of a body in here, which starts so.
    fn add(&mut self, handle: RigidBodyHandle, body: &RigidBody, start: &BodyFrame) -> usize {
        if let Some(known) = self.all.iter().position(|body| body.handle == handle) {
            return known;
        }
        let (home, pose) = (start.inverse(), *body.position());
        let moved = from_pose(&pose).then(&home);
        self.all.push(JointedBody { handle, home, pose, moved, is_news: true });
        self.all.len() - 1
    }

    pub fn moved(&self, number: usize) -> &BodyFrame {
        &self.all[number].moved
    }

    /// Whether a body was elsewhere before [`Self::look`].
    pub fn is_news(&self, number: usize) -> bool {
        self.all[number].is_news
    }

    /// Looks where the engine has the bodies now.
    pub fn look(&mut self, bodies: &RigidBodySet) {
        for body in &mut self.all {
            let pose = bodies[body.handle].position();
            body.is_news = *pose != body.pose;
            if body.is_news {
                (body.pose, body.moved) = (*pose, from_pose(pose).then(&body.home));
            }
        }
    }
}

/// Where a joint is, as its bodies are now.
#[derive(Clone, Debug)]
pub(crate) struct JointPlace {
    /// Its axis, and its anchor on the parent.
    pub axis: SpaceVector,
    pub anchor: SpaceVector,
    /// From the anchor on the parent to that on the child, m.
    gap: SpaceVector,
    /// Of a hinge, the axis on the child.
    child_axis: SpaceVector,
    /// What is not always asked for: the angle of a hinge, rad, -π..π; and how far the two sides are tilted against each other, rad.
    angle: Cell<Option<f64>>,
    tilt: Cell<Option<f64>>,
}

impl JointPlace {
    /// Of a joint whose axis and anchor were these at the start, and whose bodies were moved so.
    pub fn of(
        (axis, anchor): (&SpaceVector, &SpaceVector),
        parent: &BodyFrame,
        child: &BodyFrame,
    ) -> JointPlace {
        let at = parent.point(*anchor);
        JointPlace {
            axis: parent.turn * axis,
            anchor: at,
            gap: child.point(*anchor) - at,
            child_axis: child.turn * axis,
            angle: Cell::new(None),
            tilt: Cell::new(None),
        }
    }

    /// How far a hinge is turned about this axis, which it has at the start, rad, -π..π; with how its bodies are moved.
    pub fn angle(&self, axis: &SpaceVector, parent: &BodyFrame, child: &BodyFrame) -> f64 {
        found_once(&self.angle, || twist(&(parent.turn.inverse() * child.turn), axis))
    }

    /// How far a slider is from its start, m.
    pub fn way(&self) -> f64 {
        self.gap.dot(&self.axis)
    }

    /// How far the two sides have come apart, m.
    pub fn apart(&self, motion: JointMotion) -> f64 {
        match motion {
            JointMotion::Hinge => self.gap.norm(),
            JointMotion::Slider => (self.gap - self.axis * self.gap.dot(&self.axis)).norm(),
        }
    }

    /// Whether the two sides are tilted against each other by more than so much, rad.
    pub fn is_tilted(&self, motion: JointMotion, by: f64, parent: &BodyFrame, child: &BodyFrame) -> bool {
        let is_straight = match motion {
            // An angle is less than its tangent: mostly it need not be known.
            JointMotion::Hinge => {
                let across = self.axis.cross(&self.child_axis).norm();
                across < 0.9 * by * self.axis.dot(&self.child_axis)
            }
            JointMotion::Slider => false,
        };
        !is_straight && self.tilt(motion, parent, child) > by
    }

    /// How far the two sides are tilted against each other, rad.
    pub fn tilt(&self, motion: JointMotion, parent: &BodyFrame, child: &BodyFrame) -> f64 {
        found_once(&self.tilt, || match motion {
            JointMotion::Hinge => angle_between(&self.axis, &self.child_axis),
            JointMotion::Slider => 2.0 * (parent.turn.inverse() * child.turn).imag().norm(),
        })
    }
}

fn found_once(known: &Cell<Option<f64>>, find: impl FnOnce() -> f64) -> f64 {
    known.get().unwrap_or_else(|| {
        let found = find();
        known.set(Some(found));
        found
    })
}
