//! Where the processor time of a run goes: a world and a system behind stopwatches, for whoever asks. Without them nothing is read.

use std::{cell::Cell, rc::Rc};

use hrdsl_ir::{
    Nanos, Value,
    device::DeviceBody,
    device_state::DeviceState,
    world::{BodyId, JointId, SignalId, Vec3, WorldAction},
};

use crate::{
    command::CheckedCommand,
    fault::SystemFault,
    spent::{SpentTime, ThreadClock},
    system::seam::{RequestTicket, SystemActor, SystemAnswer, SystemRequest},
    world::{BodyPose, CommandId, MotionPlanRequest, PlannedTrajectory, WorldAccuracy, WorldBackend},
};

/// What the parts of a run took that are beyond the harness's seams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeamTimes {
    /// The world's steps, those of its engine among them.
    pub stepping: SpentTime,
    /// The steps of its engine alone.
    pub engine: SpentTime,
    /// Reading signals and devices.
    pub sensing: SpentTime,
    /// Planning ways, and beginning commands and actions.
    pub planning: SpentTime,
    /// Speaking with the system, without the time in which that works.
    pub exchange: SpentTime,
}

/// The times of one run, which its world and its system write while it goes on.
#[derive(Clone, Debug)]
pub struct RunStopwatch {
    clock: ThreadClock,
    times: Rc<Cell<SeamTimes>>,
}

impl RunStopwatch {
    #[must_use]
    pub fn new(clock: ThreadClock) -> Self {
        Self { clock, times: Rc::default() }
    }

    #[must_use]
    pub fn times(&self) -> SeamTimes {
        self.times.get()
    }

    fn measure<T>(&self, part: fn(&mut SeamTimes) -> &mut SpentTime, act: impl FnOnce() -> T) -> T {
        let mut spent = SpentTime::default();
        let result = spent.measure(self.clock, act);
        let mut times = self.times.get();
        *part(&mut times) += spent;
        self.times.set(times);
        result
    }
}

/// A world behind a stopwatch.
pub struct TimedWorld<W> {
    pub world: W,
    pub watch: RunStopwatch,
}

impl<W: WorldBackend> WorldBackend for TimedWorld<W> {
    fn next_wake(&self) -> Option<Nanos> {
        self.world.next_wake()
    }

    fn advance(&mut self, to: Nanos) {
        self.watch.measure(|t| &mut t.stepping, || self.world.advance(to));
        let times = SeamTimes { engine: self.world.engine_time(), ..self.watch.times.get() };
        self.watch.times.set(times);
    }

    fn engine_time(&self) -> SpentTime {
        self.world.engine_time()
    }

    fn fault(&self) -> Option<String> {
        self.world.fault()
    }

    fn accuracy(&self) -> Option<WorldAccuracy> {
        self.world.accuracy()
    }

    fn read(&mut self, signal: SignalId) -> Value {
        self.watch.measure(|t| &mut t.sensing, || self.world.read(signal))
    }

    fn reading(&mut self, signal: SignalId) -> Value {
        self.watch.measure(|t| &mut t.sensing, || self.world.reading(signal))
    }

    fn changes(&self) -> Option<u64> {
        self.world.changes()
    }

    fn act(&mut self, action: &WorldAction, vars: &[Value]) -> Result<(), String> {
        self.watch.measure(|t| &mut t.planning, || self.world.act(action, vars))
    }

    fn command(&mut self, command: &CheckedCommand<'_>) -> Result<CommandId, String> {
        self.watch.measure(|t| &mut t.planning, || self.world.command(command))
    }

    fn state(&self, device: DeviceBody, what: DeviceState) -> Option<Vec<f64>> {
        self.watch.measure(|t| &mut t.sensing, || self.world.state(device, what))
    }

    fn sampled_at(&self, device: DeviceBody) -> Option<Nanos> {
        self.world.sampled_at(device)
    }

    fn plan(&self, device: DeviceBody, wanted: &MotionPlanRequest) -> Result<PlannedTrajectory, String> {
        self.watch.measure(|t| &mut t.planning, || self.world.plan(device, wanted))
    }

    fn poses(&self, tell: &mut dyn FnMut(BodyPose)) {
        self.watch.measure(|t| &mut t.sensing, || self.world.poses(tell));
    }

    fn joints(&self, tell: &mut dyn FnMut(JointId, f64)) {
        self.watch.measure(|t| &mut t.sensing, || self.world.joints(tell));
    }

    fn contacts(&self, least: f64, tell: &mut dyn FnMut([BodyId; 2], Vec3)) {
        self.watch.measure(|t| &mut t.sensing, || self.world.contacts(least, tell));
    }

    fn contact_point(&self, bodies: [BodyId; 2]) -> Option<Vec3> {
        self.watch.measure(|t| &mut t.sensing, || self.world.contact_point(bodies))
    }

    fn take_ended(&mut self) -> Vec<(CommandId, Result<(), String>)> {
        self.world.take_ended()
    }
}

/// A system behind a stopwatch.
pub struct TimedSystem<S> {
    pub system: S,
    /// `None`: nobody asks for times.
    pub watch: Option<RunStopwatch>,
}

impl<S> TimedSystem<S> {
    fn measure<T>(&mut self, act: impl FnOnce(&mut S) -> T) -> T {
        match &self.watch {
            Some(watch) => watch.measure(|t| &mut t.exchange, || act(&mut self.system)),
            None => act(&mut self.system),
        }
    }
}

impl<S: SystemActor> SystemActor for TimedSystem<S> {
    fn is_ready(&self) -> bool {
        self.system.is_ready()
    }

    fn next(&mut self, now: Nanos) -> Result<Option<(RequestTicket, SystemRequest)>, SystemFault> {
        self.measure(|system| system.next(now))
    }

    fn answer(&mut self, ticket: RequestTicket, now: Nanos, answer: SystemAnswer) -> Result<(), SystemFault> {
        self.measure(|system| system.answer(ticket, now, answer))
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::Cell, time::Duration};

    use super::RunStopwatch;
    use crate::spent::SpentTime;

    thread_local! {
        static NOW: Cell<u64> = const { Cell::new(0) };
    }

    /// Each look at it takes a microsecond.
    fn clock() -> Duration {
        NOW.set(NOW.get() + 1_000);
        Duration::from_nanos(NOW.get())
    }

    #[test]
    fn a_part_is_charged_what_it_takes_without_the_clock() {
        let watch = RunStopwatch::new(clock);
        for _ in 0..3 {
            watch.measure(|t| &mut t.sensing, || NOW.set(NOW.get() + 7_000));
        }
        watch.measure(|t| &mut t.planning, || ());
        let times = watch.times();
        assert_eq!(times.sensing, SpentTime { time: Duration::from_micros(24), intervals: 3 });
        assert_eq!(times.sensing.net(Duration::from_micros(1)), Duration::from_micros(21));
        assert_eq!(times.planning.net(Duration::from_micros(1)), Duration::ZERO);
        assert_eq!(times.stepping, SpentTime::default());
    }
}
