//! The request for a way of an arm.

use hrdsl_harness::{ArmTarget, MotionPlanRequest, PlanForm, SystemRequest};
use serde::{Deserialize, Serialize};

/// A way that a program asks for: to a place or to a posture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanRequest {
    pub device: String,
    #[serde(default)]
    pub to: Option<[f64; 3]>,
    #[serde(default)]
    pub joints: Option<Vec<f64>>,
    /// Where it begins, if not where the arm is.
    #[serde(default)]
    pub from: Option<Vec<f64>>,
    /// Whether all its corners are told.
    #[serde(default)]
    pub way: bool,
    /// Whether its points are told with their times.
    #[serde(default)]
    pub timed: bool,
    #[serde(default)]
    pub speeds: Option<Vec<f64>>,
    #[serde(default)]
    pub accelerations: Option<Vec<f64>>,
}

impl PlanRequest {
    /// Why it makes no sense whatever the scenario, if it does not.
    pub(super) fn fault(&self) -> Option<String> {
        let leads_nowhere = self.to.is_none() && self.joints.is_none();
        leads_nowhere.then(|| "plan needs a place `to` go, or `joints`".to_owned())
    }

    /// What it asks of the harness. INVARIANT: `fault` refuses one with neither a place nor a posture.
    pub(crate) fn asked(self) -> SystemRequest {
        let PlanRequest { device, to, joints, from, way, timed, speeds, accelerations } = self;
        let to = joints.map_or(ArmTarget::Place(to.unwrap_or_default()), ArmTarget::Posture);
        let form = match (timed, way) {
            (true, _) => PlanForm::Timed,
            (false, true) => PlanForm::Corners,
            (false, false) => PlanForm::End,
        };
        SystemRequest::Plan { device, wanted: MotionPlanRequest { to, from, speeds, accelerations }, form }
    }
}
