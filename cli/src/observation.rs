//! How traces show what the code did, as the command line says it, and where what they are held against is written.

use std::time::Duration;

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::{Nanos, Program, Role, Span};
use hrdsl_runtime::{conformance::ConformanceOptions, results::CampaignResults};
use hrdsl_source::nearest;

use crate::{fault::CommandFault, quantity};

/// How traces show what the code did, to the automata that model it.
#[derive(clap::Args, Clone, Debug)]
pub struct ObservationArgs {
    /// What the code makes may be recorded so much later than it happened, as `50ms`, when it is held against its model.
    #[arg(long, value_name = "TIME", value_parser = quantity::time)]
    latency: Option<Duration>,
    /// An event of the code that happens without being recorded; may be given several times.
    #[arg(long, value_name = "EVENT")]
    unobserved: Vec<String>,
}

impl ObservationArgs {
    /// # Errors
    /// An event that the scenario does not have.
    pub fn options(&self, program: &Program) -> Result<ConformanceOptions, CommandFault> {
        let latency = self.latency.map_or(Ok(0), |t| Nanos::try_from(t.as_nanos()));
        let event = |name: &String| {
            let id = program.event_named(name).ok_or_else(|| {
                let near = nearest(name, program.events.iter().map(|e| e.name.as_str()));
                let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
                format!("--unobserved: the scenario has no event `{name}`{near}")
            })?;
            let from = program.actor(program.event(id).from);
            match from.role {
                Role::System => Ok(id),
                Role::Environment => Err(format!(
                    "--unobserved: `{name}` comes from `{}`, which no code plays: name an event that the code makes",
                    from.name
                )),
            }
        };
        Ok(ConformanceOptions {
            latency: latency.map_err(|e| format!("--latency: {e}"))?,
            unobserved: self.unobserved.iter().map(event).collect::<Result<_, _>>()?,
        })
    }

    /// The same as words of a command.
    pub fn words(&self) -> impl Iterator<Item = String> + '_ {
        let latency = self.latency.map(|t| format!("--latency {}s", t.as_secs_f64()));
        latency.into_iter().chain(self.unobserved.iter().map(|name| format!("--unobserved {name}")))
    }
}

/// Says of each place of a model in which line of the scenario it is.
pub fn locate(results: &mut CampaignResults, compilation: &CompilationResult) {
    results.locate(&|span| line(compilation, span));
}

/// The line of the scenario in which something is. What is in a module has none.
pub fn line(compilation: &CompilationResult, span: Span) -> Option<usize> {
    (span.file.0 == 0).then(|| compilation.files.position(span).line as usize)
}
