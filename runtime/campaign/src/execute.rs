//! One test: its world and its programs are made, the loop runs, and they end.

use std::time::Duration;

use hrdsl_harness::{
    ActorPlayer, HarnessError, HarnessLoop, HarnessRun, RunStopwatch, RunTermination, ScriptPlayer,
    SystemFault, SystemPlayer, TimedSystem, TimedWorld, WorldBackend, WorldStage,
};
use hrdsl_ir::{test::Test, value::seconds};
use hrdsl_sim::{SimulatedWorld, SimulationError};
use hrdsl_sut::{FinishedProcess, HarnessReply, LockStep, ReplyAnswer, SutProcess};

use super::{CampaignSetup, CampaignSystem, failed, forks::WorkerServers, times::TestTimes};

/// Processor time, or sleep, that the program has to end when its test is over.
const GRACE: Duration = Duration::from_secs(5);

impl CampaignSetup<'_> {
    /// Runs one test to its end, without a judgement.
    pub(super) fn execute(
        &self,
        system: &CampaignSystem<'_>,
        test: &Test,
        servers: &mut WorkerServers,
        times: &mut TestTimes,
    ) -> (HarnessRun, Vec<(String, FinishedProcess)>) {
        let declared = system.declared;
        let watch = self.clocks.map(|clocks| RunStopwatch::new(clocks.thread));
        let stage = match self.measured(&mut times.start_up, || self.stage(test.seed, watch.as_ref())) {
            Ok(stage) => stage,
            Err(why) => return (failed(HarnessError::World(why.to_string())), Vec::new()),
        };
        let mut processes: Vec<(String, SutProcess)> = Vec::new();
        if self.forks.is_fresh {
            servers.0.clear();
        }
        for (number, program) in declared.programs.iter().enumerate() {
            let launch = self.launch(system, program, test.seed, Some(test));
            match self.measured(&mut times.start_up, || self.start(number, &launch, servers)) {
                Ok(process) => processes.push((program.name.clone(), process)),
                Err(error) => {
                    let finished = finish(processes);
                    return (failed(HarnessError::System(SystemFault::from(error))), finished);
                }
            }
        }
        let programs = processes.iter_mut().map(|(name, process)| {
            let system = LockStep::new(process, name);
            (name.clone(), TimedSystem { system, watch: watch.clone() })
        });
        let player = SystemPlayer::of_programs(self.program, declared.actor, programs)
            .with_binding(declared.binding.as_ref());
        let player = if self.replays { player.writing_down() } else { player };
        let mut players: Vec<Box<dyn ActorPlayer + '_>> = vec![Box::new(player)];
        players
            .extend(ScriptPlayer::all(self.program, test).map(|p| Box::new(p) as Box<dyn ActorPlayer + '_>));
        let run = HarnessLoop::new(self.program, players, stage, declared.limit);
        let run = self.measured(&mut times.run, || run.run());
        times.seams = watch.map(|watch| watch.times()).unwrap_or_default();
        let reason = stop_reason(&run.ended, declared.limit);
        let finished = self.measured(&mut times.start_up, || {
            for (_, process) in &mut processes {
                // It may have ended by itself: then nobody reads this.
                let answer = ReplyAnswer::Stop { reason: reason.clone() };
                let _ = process.reply(&HarnessReply { time: run.trace.end, answer });
            }
            finish(processes)
        });
        (run, finished)
    }

    /// The world of a test, behind a stopwatch if there is one.
    fn stage(
        &self,
        seed: u64,
        watch: Option<&RunStopwatch>,
    ) -> Result<Option<WorldStage<'_>>, SimulationError> {
        let Some(world) = SimulatedWorld::new(self.program, seed)? else { return Ok(None) };
        let world: Box<dyn WorldBackend> = match (self.clocks, watch) {
            (Some(clocks), Some(watch)) => {
                Box::new(TimedWorld { world: world.timed(clocks.thread), watch: watch.clone() })
            }
            (Some(_) | None, Some(_) | None) => Box::new(world),
        };
        let stage = WorldStage::new(self.program, world);
        Ok(Some(if self.replays { stage.picturing() } else { stage }))
    }
}

fn finish(processes: Vec<(String, SutProcess)>) -> Vec<(String, FinishedProcess)> {
    processes.into_iter().map(|(name, process)| (name, process.finish(GRACE))).collect()
}

/// What programs are told when they have to end.
fn stop_reason(ended: &RunTermination, limit: hrdsl_ir::Nanos) -> String {
    match ended {
        RunTermination::Quiescent => "the test is over: nothing is left that could happen".to_owned(),
        RunTermination::Limit => format!("the test is over: it lasts {} s", seconds(limit)),
        RunTermination::Fault(fault) => {
            let fault = fault.to_string();
            format!("the test has broken off: {}", fault.lines().next().unwrap_or_default())
        }
    }
}
