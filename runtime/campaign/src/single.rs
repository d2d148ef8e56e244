//! Tests one by one, for whoever decides after each what is run next.

use std::time::Duration;

use hrdsl_harness::SystemFaultKind;
use hrdsl_ir::test::Test;
use hrdsl_results::{FileCoverage, RunMark, TestResult};
use hrdsl_sut::{LaunchMutant, PinnedCore};

use super::{CampaignSetup, CampaignSystem, TestAttempt, forks::WorkerServers};

/// A worker that runs the tests that it is given, one after the other; its fork servers serve all of them.
pub struct SingleRunner<'c> {
    campaign: &'c CampaignSetup<'c>,
    system: CampaignSystem<'c>,
    servers: WorkerServers,
    /// A speed-up, and one processor for the program whatever the number of workers.
    _pinned: Option<PinnedCore>,
}

/// What came of one test.
#[derive(Clone, Debug)]
pub struct SingleRun {
    pub result: TestResult,
    /// JSON Lines.
    pub recording: String,
    /// The code that it executed, of the files that are measured.
    pub executed: Vec<FileCoverage>,
    /// Processor time of its programs.
    pub cpu: Duration,
}

impl<'c> SingleRunner<'c> {
    /// A worker, for the thread that asks.
    ///
    /// # Errors
    /// Only if what the programs need to know cannot be kept for them.
    pub fn new(campaign: &'c CampaignSetup<'c>) -> Result<Self, String> {
        let system = campaign.told_system()?;
        let _pinned = hrdsl_sut::pin_to_free_core();
        Ok(Self { campaign, system, servers: WorkerServers::default(), _pinned })
    }

    /// Runs a test, with a mutant of the code if there is one; what befalls it is its result. A test that wall time has ended is run
    /// once more. `None`: everything is to end.
    pub fn run(&mut self, test: &Test, mutant: Option<&LaunchMutant>) -> Option<SingleRun> {
        self.system.mutant = mutant.cloned();
        let mut attempt = self.attempt(test)?;
        if attempt.fault == Some(SystemFaultKind::WallTime) {
            attempt = self.attempt(test)?;
            if attempt.fault != Some(SystemFaultKind::WallTime) {
                attempt.finished.finished.result.marks.push(RunMark::DependsOnLoad);
            }
        }
        let TestAttempt { finished, recording, times, .. } = attempt;
        let finished = finished.finished;
        let (result, executed) = (finished.result, finished.executed);
        Some(SingleRun { result, recording, executed, cpu: times.programs })
    }

    fn attempt(&mut self, test: &Test) -> Option<TestAttempt> {
        if self.campaign.stop.is_set() {
            return None;
        }
        let attempt = self.campaign.run_one(&self.system, test, &mut self.servers);
        (attempt.fault != Some(SystemFaultKind::Interrupted)).then_some(attempt)
    }
}
