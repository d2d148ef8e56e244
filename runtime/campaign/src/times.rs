//! Where the processor time of a campaign goes: of each thread that works on its tests, and of the programs.

use std::{
    sync::{Mutex, PoisonError},
    time::Duration,
};

use hrdsl_harness::{SeamTimes, SpentTime};
use hrdsl_ir::{Nanos, value::seconds};
use hrdsl_sut::ProcessorClocks;
use serde::Serialize;

/// Processor time of a campaign's tests by what it was spent on, in seconds. That of looking at the clock is in none of its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CampaignTimes {
    /// Simulated seconds of all tests.
    pub simulated: f64,
    /// The steps of the physics engine alone.
    pub engine: f64,
    /// The programs under test, under code coverage if that is measured.
    pub programs: f64,
    /// The physics beside the engine: motors and what they answer to, people's muscles, surfaces that yield, how finely a step is divided.
    pub world: f64,
    /// Reading signals and devices.
    pub sensing: f64,
    /// Planning ways, and beginning commands and actions.
    pub planning: f64,
    /// Reading and writing messages of the programs.
    pub exchange: f64,
    /// The loop itself: who hears what, and what is recorded.
    pub harness: f64,
    /// Monitors and coverpoints.
    pub judgement: f64,
    /// Recordings as text, and their files.
    pub recordings: f64,
    /// What is left of the tests: their results.
    pub results: f64,
    /// Building worlds, starting programs and ending them, in hrdsl.
    pub start_up: f64,
    /// The cells of the programs, and interpreters until they begin with a test.
    pub cells: f64,
}

impl CampaignTimes {
    /// All processor time of the tests.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.engine + self.programs + self.world + self.own() + self.start_up + self.cells
    }

    /// What hrdsl itself takes while tests run: for all that is neither physics nor the programs.
    #[must_use]
    pub fn own(&self) -> f64 {
        self.sensing
            + self.planning
            + self.exchange
            + self.harness
            + self.judgement
            + self.recordings
            + self.results
    }
}

/// What the work on one test took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TestTimes {
    pub simulated: Nanos,
    /// All of it.
    pub whole: SpentTime,
    pub start_up: SpentTime,
    /// The loop, with the seams below it.
    pub run: SpentTime,
    pub seams: SeamTimes,
    pub judgement: SpentTime,
    pub recordings: SpentTime,
    pub programs: Duration,
}

impl TestTimes {
    /// Adds its times to those of a campaign; a look at the clock takes so long.
    pub fn add_to(&self, sum: &mut CampaignTimes, look: Duration) {
        let net = |spent: SpentTime| spent.net(look).as_secs_f64();
        let looks = |spent: SpentTime| (look.saturating_mul(spent.intervals)).as_secs_f64();
        let seams = &self.seams;
        let (engine, stepping) = (net(seams.engine), net(seams.stepping) - 2.0 * looks(seams.engine));
        // Of an interval, one look is in it, and another one around it.
        let around = |spent: &SpentTime| spent.time.as_secs_f64() + looks(*spent);
        let beyond = [seams.stepping, seams.sensing, seams.planning, seams.exchange];
        let run = net(self.run);
        sum.simulated += seconds(self.simulated);
        sum.engine += engine;
        sum.world += (stepping - engine).max(0.0);
        sum.sensing += net(seams.sensing);
        sum.planning += net(seams.planning);
        sum.exchange += net(seams.exchange);
        sum.harness += (run - beyond.iter().map(around).sum::<f64>()).max(0.0);
        sum.judgement += net(self.judgement);
        sum.recordings += net(self.recordings);
        sum.start_up += net(self.start_up);
        let parts = [self.run, self.judgement, self.recordings, self.start_up];
        sum.results += (net(self.whole) - parts.iter().map(around).sum::<f64>()).max(0.0);
        sum.programs += self.programs.as_secs_f64();
    }
}

/// Adds up the times of a campaign's tests.
pub(super) struct CampaignStopwatch {
    /// With what a look at the clock takes, and what all children took before.
    clocks: Option<(ProcessorClocks, Duration, Duration)>,
    sum: Mutex<CampaignTimes>,
}

impl CampaignStopwatch {
    pub fn start(clocks: Option<ProcessorClocks>) -> Self {
        let clocks = clocks.map(|clocks| (clocks, clocks.reading(), (clocks.children)()));
        Self { clocks, sum: Mutex::default() }
    }

    pub fn add(&self, times: &TestTimes) {
        if let Some((_, look, _)) = self.clocks {
            times.add_to(&mut self.sum.lock().unwrap_or_else(PoisonError::into_inner), look);
        }
    }

    /// The sum, when all programs have ended: what their processes took besides is that of their cells.
    pub fn end(self) -> Option<CampaignTimes> {
        let (clocks, _, before) = self.clocks?;
        let mut sum = self.sum.into_inner().unwrap_or_else(PoisonError::into_inner);
        let children = (clocks.children)().saturating_sub(before).as_secs_f64();
        sum.cells = (children - sum.programs).max(0.0);
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use hrdsl_harness::{SeamTimes, SpentTime};

    use super::{CampaignTimes, TestTimes};

    fn spent(micros: u64, intervals: u32) -> SpentTime {
        SpentTime { time: Duration::from_micros(micros), intervals }
    }

    /// Each look takes one microsecond: an interval has one in it, and whatever is around it another one.
    #[test]
    fn what_is_spent_on_looking_at_the_clock_is_nobodys() {
        let seams = SeamTimes {
            engine: spent(55, 5),    // 50
            stepping: spent(162, 2), // 160: 50 of the engine, 10 of its looks, 100 of the world
            sensing: spent(40, 10),  // 30
            ..SeamTimes::default()
        };
        let times = TestTimes {
            simulated: 2_000_000_000,
            seams,
            // 162 + 2 of the steps, 40 + 10 of the sensing, 70 of the loop, 1 of its own look.
            run: spent(285, 1),
            judgement: spent(21, 1),
            // 286 and 22 of these, 9 of the results, 1 of its own look.
            whole: spent(318, 1),
            programs: Duration::from_micros(200),
            ..TestTimes::default()
        };
        let mut sum = CampaignTimes::default();
        times.add_to(&mut sum, Duration::from_micros(1));
        let micros = [sum.engine, sum.world, sum.sensing, sum.harness, sum.judgement, sum.results];
        assert_eq!(micros.map(|s| (s * 1e6).round()), [50.0, 100.0, 30.0, 70.0, 20.0, 9.0]);
        assert_eq!((sum.total() * 1e6).round(), 479.0);
        assert_eq!((sum.own() * 1e6).round(), 129.0);
    }
}
