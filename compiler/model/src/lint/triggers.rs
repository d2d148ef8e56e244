//! What the rules ask of a plan's trigger.

use crate::{GoalId, Parameter, Scenario, TriggerOn, TypedAgent};

/// The goal that the plan is there to achieve.
pub(crate) fn achieved(on: TriggerOn) -> Option<GoalId> {
    if let TriggerOn::GoalAdded(goal) = on { Some(goal) } else { None }
}

/// The goal that the plan achieves, or whose failure it handles.
pub(crate) fn goal_of(on: TriggerOn) -> Option<GoalId> {
    if let TriggerOn::GoalAdded(goal) | TriggerOn::GoalFailed(goal) = on { Some(goal) } else { None }
}

/// The parameters of what the trigger matches; those of a goal promise no range.
pub(crate) fn matched<'a>(scenario: &'a Scenario, agent: &'a TypedAgent, on: TriggerOn) -> &'a [Parameter] {
    if let TriggerOn::Perceived(event) = on {
        return scenario.events.get(usize::from(event.0)).map_or(&[], |e| &e.params);
    }
    let belief = on.belief().and_then(|belief| agent.beliefs.get(usize::from(belief.0)));
    belief.map_or(&[], |belief| &belief.params)
}
