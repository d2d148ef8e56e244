//! The interpreters of a campaign's programs: forked from servers that each worker has, or started anew.

use std::collections::{BTreeMap, btree_map::Entry};

use hrdsl_ir::system::SystemProgram;
use hrdsl_sut::{ForkServer, LaunchSpec, SutError, SutProcess};

use super::CampaignSetup;

/// How the interpreters of a campaign's programs are started: found out once, before its first test, so that it is the same for all
/// tests, whichever worker runs them.
#[derive(Clone, Debug, Default)]
pub struct ForkPlan {
    /// For each program, what its fork servers import beforehand; none, if each test starts the program anew.
    pub modules: Vec<Option<Vec<String>>>,
    /// Whether each test has fork servers of its own, instead of those of its worker.
    pub is_fresh: bool,
}

/// The fork servers of a worker, by the numbers of the system's programs; each is started when it is first needed.
#[derive(Default)]
pub(super) struct WorkerServers(pub(super) BTreeMap<usize, ForkServer>);

impl CampaignSetup<'_> {
    /// Finds out which programs can be forked, and what is imported beforehand; gives a sentence for each that should be and
    /// cannot.
    ///
    /// # Errors
    /// Only if what the programs need to know cannot be kept for them.
    pub fn plan_forks(&mut self, is_fresh: bool) -> Result<Vec<String>, String> {
        let system = self.told_system()?;
        let mut complaints = Vec::new();
        let plan = |program: &SystemProgram| {
            let launch = self.launch(&system, program, 0, None);
            if !launch.can_fork() {
                return None;
            }
            let found = ForkServer::find_modules(&launch);
            // What is absent is told by the tests.
            if let Err(why @ SutError::Io { .. }) = &found {
                complaints.push(format!("{}: {why}", program.name));
            }
            found.ok()
        };
        let modules = self.system.programs.iter().map(plan).collect();
        self.forks = ForkPlan { modules, is_fresh };
        Ok(complaints)
    }

    /// Starts a program: by the fork server that this worker has for it, if it is forked.
    pub(super) fn start(
        &self,
        program: usize,
        launch: &LaunchSpec,
        servers: &mut WorkerServers,
    ) -> Result<SutProcess, SutError> {
        let Some(modules) = self.forks.modules.get(program).and_then(Option::as_ref) else {
            return SutProcess::spawn(launch);
        };
        let server = match servers.0.entry(program) {
            Entry::Occupied(there) => there.into_mut(),
            Entry::Vacant(place) => place.insert(ForkServer::start(launch, modules)?),
        };
        SutProcess::fork(launch, server)
    }
}
