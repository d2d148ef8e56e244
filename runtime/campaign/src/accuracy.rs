//! What a world says of how exact it was, as it stands in the results.

use hrdsl_harness::WorldAccuracy;
use hrdsl_results::{BodyPenetration, JointGap, LimitExcess, PhysicsAccuracy};

pub fn physics(found: WorldAccuracy) -> PhysicsAccuracy {
    let pair = |(depth, bodies)| BodyPenetration { depth, bodies };
    PhysicsAccuracy {
        self_penetration: found.self_penetration.map(pair),
        penetration: found.penetration.map(pair),
        beyond_limit: found.beyond_limit.map(|(by, joint)| LimitExcess { by, joint }),
        joint_gap: found.joint_gap.map(|(apart, joint)| JointGap { apart, joint }),
    }
}
