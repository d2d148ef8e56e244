//! What an arm plans: paths to places and postures, at the speeds that are asked for, and when it is where on them.

use hrdsl_harness::{ArmTarget, MotionPlanRequest, PlannedTrajectory};
use hrdsl_ir::world::{Vec3, World};

use super::{ArmControl, ArmMoment};
use crate::{
    clearance::ArmClearance,
    error::CommandError,
    math::{SpaceVector, v3},
    motion::ArmPath,
    physics::PhysicsAdapter,
    planner::{NoRoute, RoutePlanner},
    profile::RISE,
    route::JointRoute,
};

impl ArmControl {
    /// Plans a path of the tool to a place, from where the arm would stand if it were stopped now.
    pub fn plan_place(
        &self,
        target: Vec3,
        limit: Option<f64>,
        at: &ArmMoment<'_>,
    ) -> Result<JointRoute, CommandError> {
        self.route(&ArmTarget::Place(target), &self.stop(), &self.speeds_within(limit), at)
    }

    /// Plans a path to a posture.
    pub fn plan_posture(
        &self,
        posture: &[f64],
        limit: Option<f64>,
        at: &ArmMoment<'_>,
    ) -> Result<JointRoute, CommandError> {
        self.route(&ArmTarget::Posture(posture.to_vec()), &self.stop(), &self.speeds_within(limit), at)
    }

    /// The path that is asked for, with the times at which the arm would go it.
    pub fn plan_motion(
        &self,
        wanted: &MotionPlanRequest,
        world: &World,
        at: &ArmMoment<'_>,
    ) -> Result<PlannedTrajectory, CommandError> {
        let numbers = match &wanted.to {
            ArmTarget::Place(place) => &place[..],
            ArmTarget::Posture(posture) => posture,
        };
        let from = wanted.from.as_deref().unwrap_or_default();
        if numbers.iter().chain(from).any(|x| !x.is_finite()) {
            return Err(CommandError::NotFinite);
        }
        if let ArmTarget::Posture(posture) = &wanted.to {
            self.check(posture, world)?;
        }
        let speeds = match &wanted.speeds {
            Some(asked) => {
                self.speeds.iter().zip(self.each(asked)?).map(|(v, asked)| v.min(*asked)).collect()
            }
            None => self.speeds.clone(),
        };
        let from = match &wanted.from {
            Some(posture) if posture.len() != self.joints.len() => {
                let (expected, given) = (self.joints.len(), posture.len());
                return Err(CommandError::WrongJointCount { expected, given });
            }
            Some(posture) => posture.clone(),
            None => self.stop(),
        };
        let route = self.route(&wanted.to, &from, &speeds, at)?;
        let rise = match &wanted.accelerations {
            Some(asked) => route.rise(self.each(asked)?),
            None => RISE,
        };
        let corners = route.points_where(|_| true).collect();
        Ok(PlannedTrajectory { corners, points: ArmPath::along(route, rise).points(&from) })
    }

    /// Limits, if there is one for each joint.
    fn each<'n>(&self, limits: &'n [f64]) -> Result<&'n [f64], CommandError> {
        let (expected, given) = (self.joints.len(), limits.len());
        if given != expected {
            return Err(CommandError::WrongLimitCount { expected, given });
        }
        if limits.iter().any(|x| !(x.is_finite() && *x > 0.0)) {
            return Err(CommandError::BadSpeed);
        }
        Ok(limits)
    }

    fn route(
        &self,
        to: &ArmTarget,
        from: &[f64],
        speeds: &[f64],
        at: &ArmMoment<'_>,
    ) -> Result<JointRoute, CommandError> {
        let clearance = ArmClearance::new(&self.figure, &self.chain, at.physics, &at.held, &*at.is_known);
        let mut planner = RoutePlanner { chain: &self.chain, clearance, speeds };
        let route = match to {
            ArmTarget::Place(place) => planner.reach_place(from, self.relative(at.physics, v3(*place))),
            ArmTarget::Posture(posture) => planner.reach_posture(from, posture),
        };
        route.map_err(|why| self.no_route(why, at.physics))
    }

    fn no_route(&self, why: NoRoute, physics: &PhysicsAdapter) -> CommandError {
        match why {
            NoRoute::Unreachable(distance) => CommandError::Unreachable { distance },
            NoRoute::Obstructed(a, b) => {
                CommandError::Obstructed { by: physics.name(b).to_owned(), part: physics.name(a).to_owned() }
            }
        }
    }

    fn speeds_within(&self, limit: Option<f64>) -> Vec<f64> {
        self.speeds.iter().map(|v| limit.map_or(*v, |l| v.min(l))).collect()
    }

    /// The place, as it would be if the arm's base were where it was at the start.
    fn relative(&self, physics: &PhysicsAdapter, target: SpaceVector) -> SpaceVector {
        let base = self.figure.base;
        if physics.is_fixed(base) {
            return target;
        }
        physics.start(base).point(physics.pose(base).inverse().point(target))
    }
}
