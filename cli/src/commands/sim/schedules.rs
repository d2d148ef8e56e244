//! `--schedules`: the same tests with other orders of the programs' threads, to find races.

use hrdsl_runtime::campaign::CampaignSetup;

use super::comparison::{OtherWay, WayWords};

/// The variable from which the order of threads follows.
pub const VARIABLE: &str = "HRDSL_SCHEDULE";

/// So many other orders.
pub fn others<'p>(campaign: &CampaignSetup<'p>, schedules: u32) -> Vec<OtherWay<'p>> {
    let other = |schedule: u32| {
        let mut variables = campaign.variables.clone();
        variables.retain(|(name, _)| name != VARIABLE);
        variables.push((VARIABLE.into(), schedule.to_string().into()));
        let campaign = CampaignSetup { variables, ..campaign.clone() };
        OtherWay { option: format!("--schedule {schedule}"), campaign }
    };
    (1..=schedules).map(other).collect()
}

pub fn words() -> WayWords {
    WayWords {
        topic: "schedules",
        several: "other orders of their threads",
        one: "in another order of their threads",
        usual: "in the usual order".to_owned(),
        progress: "in other orders of the threads",
    }
}
