//! `--models`: mutants of the automata that play the system, held against what the code does.

use std::collections::BTreeSet;

use hrdsl_compiler::CompilationResult;
use hrdsl_ir::Span;
use hrdsl_runtime::{
    campaign::{CampaignSetup, SingleRun},
    mutation::{MODEL_OPERATORS, ModelMutant, MutationPlan, RecordedRuns},
    results::{ConformanceOutcome, TestResult},
};
use hrdsl_source::nearest;

use super::{MutateArgs, MutationRuns, sample};
use crate::{commands::campaign::progress_bar, fault::CommandFault, terminal};

/// Holds the runs of the original against the mutants of its models.
pub fn contradicted(
    args: &MutateArgs,
    compilation: &CompilationResult,
    campaign: &CampaignSetup<'_>,
    originals: &[SingleRun],
) -> Result<MutationRuns, CommandFault> {
    for name in &args.operator {
        if !MODEL_OPERATORS.contains(&name.as_str()) {
            let near = nearest(name, MODEL_OPERATORS);
            let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            let known = MODEL_OPERATORS.join(", ");
            return Err(format!("--operator: models have no operator `{name}`{near} (there are {known})"));
        }
    }
    let files = &compilation.files;
    let place = |span: Span| (files.name(span.file).to_owned(), files.position(span).line);
    let mutants = ModelMutant::all(campaign.program, &place);
    let is_wanted = |operator: &String| args.operator.is_empty() || args.operator.contains(operator);
    let listed = mutants.iter().map(|mutant| &mutant.mutant).filter(|mutant| is_wanted(&mutant.operator));
    let listed: Vec<_> = listed.cloned().collect();
    if listed.is_empty() {
        return Err(format!("`{}` has no automaton that plays the system", campaign.program.name));
    }
    let conforming = originals.iter().filter(|run| conforms(&run.result)).count();
    terminal::say_line(format_args!(
        "{conforming} of {} runs conform to the models as they are; only these can contradict a mutant",
        originals.len()
    ));
    let of: BTreeSet<String> = listed.iter().map(|mutant| mutant.file.clone()).collect();
    let plan = MutationPlan::new(listed, originals, sample(args));
    let runs = RecordedRuns::new(campaign.program, &campaign.conformance, originals);
    let sentinels = of.iter().map(|file| runs.outcome(&ModelMutant::sentinel(file), &plan.order, false));
    let sentinels = sentinels.collect();
    let bar = progress_bar(plan.mutants.len(), "mutants");
    let mutants = runs.contradict(&plan, &mutants, (args.matrix, &campaign.stop), |_| bar.inc(1));
    bar.finish_and_clear();
    Ok(MutationRuns { plan, sentinels, mutants })
}

/// Whether some model allows all that a run did.
fn conforms(result: &TestResult) -> bool {
    let verdicts = &result.judgement.conformance;
    verdicts.iter().any(|verdict| verdict.outcome == ConformanceOutcome::Conforms)
}
