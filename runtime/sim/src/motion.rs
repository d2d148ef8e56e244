//! A motion of an arm on its path: where its joints should be, on a clock of its own that waits for an arm that lags behind.

use hrdsl_harness::{CommandId, PlannedPoint};

use crate::{
    math::SpaceVector,
    profile::{LimitedPace, MotionProfile, brake_time, braking},
    route::{JointRoute, JointTrack},
};

/// What is to be reached.
pub(crate) enum ArmGoal {
    Place(SpaceVector),
    Joints,
}

/// How an arm goes to its goal.
pub(crate) enum ArmPath {
    /// Along a straight path, by a smooth ramp.
    Straight(JointRoute, MotionProfile),
    /// Along a path with corners.
    Route(JointRoute, LimitedPace),
    /// As was given.
    Track(JointTrack),
}

/// How far points of a path are apart at most, s.
const POINTS: f64 = 0.05;

pub(crate) struct ArmMotion {
    pub id: CommandId,
    pub goal: ArmGoal,
    /// Where the arm was and how fast it went when the motion was asked for.
    from: Vec<f64>,
    speed: Vec<f64>,
    /// For how long it first brakes.
    brake: f64,
    path: ArmPath,
    /// Seconds of the motion that are over.
    clock: f64,
    /// Seconds for which the arm has not been able to follow.
    pub stuck: f64,
}

impl ArmPath {
    /// Along a path, at full speed after so many seconds.
    pub fn along(route: JointRoute, rise: f64) -> ArmPath {
        if route.has_corners() {
            let pace = LimitedPace::new(route.length(), rise, |s| route.limit(s));
            return ArmPath::Route(route, pace);
        }
        let profile = MotionProfile::new(route.length(), 1.0, rise);
        ArmPath::Straight(route, profile)
    }

    /// The posture after so many seconds, of an arm that begins at `from`.
    fn at(&self, t: f64, from: &[f64]) -> Vec<f64> {
        match self {
            ArmPath::Straight(route, profile) => route.at(profile.at(t) * route.length()),
            ArmPath::Route(route, pace) => route.at(pace.at(t)),
            ArmPath::Track(track) => track.at(t, from),
        }
    }

    /// Seconds from start to end.
    fn length(&self) -> f64 {
        match self {
            ArmPath::Straight(_, profile) => profile.length(),
            ArmPath::Route(_, pace) => pace.length(),
            ArmPath::Track(track) => track.length(),
        }
    }

    /// Its points with their times, as close as [`POINTS`] says; speeds and accelerations by differences.
    pub fn points(&self, from: &[f64]) -> Vec<PlannedPoint> {
        const H: f64 = 1e-3;
        let length = self.length();
        let last = (length / POINTS).ceil() as usize;
        let point = |i: usize| {
            let time = if i == last { length } else { length * i as f64 / last as f64 };
            let positions = self.at(time, from);
            let (before, after) = (self.at((time - H).max(0.0), from), self.at(time + H, from));
            let rests = i == 0 || i == last;
            let (velocities, accelerations) = before
                .iter()
                .zip(&positions)
                .zip(&after)
                .map(|((a, b), c)| {
                    // It begins and ends at rest, beyond which it has no other half.
                    let velocity = if rests { 0.0 } else { (c - a) / (2.0 * H) };
                    (velocity, (a - 2.0 * b + c) / (H * H))
                })
                .unzip();
            PlannedPoint { time, positions, velocities, accelerations }
        };
        (0..=last).map(point).collect()
    }
}

impl ArmMotion {
    /// One that begins from a posture and a speed; what is under way is braked first, unless a trajectory says what to do.
    pub fn new(
        id: CommandId,
        goal: ArmGoal,
        (from, speed): (Vec<f64>, Vec<f64>),
        path: ArmPath,
    ) -> ArmMotion {
        let moving = speed.iter().any(|v| *v != 0.0);
        let brake = match &path {
            ArmPath::Straight(..) | ArmPath::Route(..) if moving => brake_time(),
            ArmPath::Straight(..) | ArmPath::Route(..) | ArmPath::Track(_) => 0.0,
        };
        ArmMotion { id, goal, from, speed, brake, path, clock: 0.0, stuck: 0.0 }
    }

    /// The posture aimed at, so many seconds of the motion after its beginning.
    fn at(&self, t: f64) -> Vec<f64> {
        if t < self.brake {
            let (travel, _) = braking(t);
            return self.from.iter().zip(&self.speed).map(|(q, v)| q + v * travel).collect();
        }
        self.path.at(t - self.brake, &self.from)
    }

    /// The posture aimed at now.
    pub fn aim(&self) -> Vec<f64> {
        self.at(self.clock)
    }

    /// The posture aimed at when so many seconds of the motion have passed from now.
    pub fn aim_after(&self, time: f64) -> Vec<f64> {
        self.at(self.clock + time)
    }

    /// Lets time pass, at a rate of 0 to 1.
    pub fn pass(&mut self, time: f64, rate: f64) {
        self.clock += time * rate;
        self.stuck = if rate < STUCK { self.stuck + time } else { 0.0 };
    }

    /// How fast the joints should go now, in a motion that is not held up.
    pub fn speed(&self) -> Vec<f64> {
        const H: f64 = 1e-4;
        let (a, b) = (self.at((self.clock - H).max(0.0)), self.at(self.clock));
        a.iter().zip(&b).map(|(a, b)| if self.is_over() { 0.0 } else { (b - a) / H }).collect()
    }

    pub fn is_over(&self) -> bool {
        self.clock >= self.length()
    }

    /// Seconds since it should have been over.
    pub fn overdue(&self) -> f64 {
        self.clock - self.length()
    }

    fn length(&self) -> f64 {
        self.brake + self.path.length()
    }

    /// The posture in which it ends.
    pub fn end(&self) -> Vec<f64> {
        match &self.path {
            ArmPath::Straight(route, _) | ArmPath::Route(route, _) => route.end().to_vec(),
            ArmPath::Track(track) => track.at(f64::INFINITY, &self.from),
        }
    }
}

/// Below this rate a motion counts as held up.
const STUCK: f64 = 0.1;
