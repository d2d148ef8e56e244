//! The section about faults in the code, and which oracle noticed each.

use hrdsl_results::{
    MutantFate, MutantOracle, MutantReport, MutationReport, OracleScore, RequirementName, TestMethod,
};
use serde::Serialize;

use crate::text;

#[derive(Serialize)]
pub struct FaultSection {
    in_short: String,
    /// What is to be kept in mind with the numbers.
    notes: Vec<String>,
    methods: Vec<&'static str>,
    oracles: Vec<OracleRow>,
    missed: Vec<MissedFault>,
}

/// What noticed faults.
#[derive(Serialize)]
struct OracleRow {
    oracle: String,
    noticed: usize,
    /// For each method.
    per_method: Vec<usize>,
    alone: usize,
    faults: Vec<NoticedFault>,
}

#[derive(Serialize)]
struct NoticedFault {
    place: String,
    operator: String,
    what: String,
    test: String,
}

/// A fault that nothing noticed.
#[derive(Serialize)]
struct MissedFault {
    place: String,
    operator: String,
    what: String,
    /// Where its run first goes another way, or that no test reaches it.
    how: String,
    /// What would notice it, as far as something is known.
    proposals: Vec<String>,
}

/// How many of the faults a requirement noticed, in words; nothing of faults in models, which recordings are held against: no requirement is
/// asked then.
pub fn noticed_by(requirement: &RequirementName, found: &MutationReport) -> String {
    if found.about.models {
        return String::new();
    }
    let such = |score: &&OracleScore| match &score.oracle {
        MutantOracle::Requirement(name) => name == requirement,
        MutantOracle::Prediction | MutantOracle::Conformance | MutantOracle::Error => false,
    };
    let killed = found.oracles.iter().find(such).map_or(0, |score| score.killed);
    format!("noticed {killed} of {}", text::count(noticeable(found), "fault"))
}

/// Faults that something could have noticed.
fn noticeable(found: &MutationReport) -> usize {
    let counts = &found.counts;
    counts.killed + counts.survived + counts.not_reached
}

/// What `hrdsl mutate` found.
pub fn section(found: &MutationReport) -> FaultSection {
    let has = |method: &TestMethod| found.methods.iter().any(|score| score.method == *method);
    let methods: Vec<TestMethod> = TestMethod::ALL.into_iter().filter(has).collect();
    FaultSection {
        in_short: format!("{} of {} noticed", found.counts.killed, text::count(noticeable(found), "fault")),
        notes: notes(found),
        methods: methods.iter().map(|method| method.word()).collect(),
        oracles: found.oracles.iter().map(|score| oracle_row(found, score, &methods)).collect(),
        missed: found.mutants.iter().filter_map(|mutant| missed(mutant, found.about.models)).collect(),
    }
}

fn notes(found: &MutationReport) -> Vec<String> {
    let mut notes = vec![format!(
        "Small changes of {}, each put into it by itself, against {}.",
        if found.about.models { "its models" } else { "the code under test" },
        text::count(found.about.tests, "test")
    )];
    if !found.about.matrix {
        notes.push(
            "Each fault was tried until a first test noticed it: other oracles, and other tests, may notice it, too."
                .to_owned(),
        );
    }
    if let Some(drawn) = found.drawn {
        notes.push(format!("{drawn} of {} faults were drawn at random.", found.worth));
    }
    if found.interrupted {
        notes.push("This was interrupted: some faults were not tried.".to_owned());
    }
    let (same, more) = (found.counts.not_distinguished, found.counts.permissive);
    if same + more > 0 {
        let runs = text::count(same + more, "more fault");
        notes.push(if found.about.models {
            format!("The models allow the same with {runs}, or more, wherever a run came; they do not count.")
        } else {
            format!(
                "All runs are the same as the original’s in {runs}, which may be as good; they do not count."
            )
        });
    }
    notes
}

fn oracle_row(found: &MutationReport, score: &OracleScore, methods: &[TestMethod]) -> OracleRow {
    let noticed = |mutant: &MutantReport| {
        let first = mutant.noticed.iter().find(|noticed| noticed.oracles.contains(&score.oracle))?;
        Some(NoticedFault {
            place: place(mutant),
            operator: mutant.operator.clone(),
            what: mutant.what.clone(),
            test: first.test.to_string(),
        })
    };
    OracleRow {
        oracle: match &score.oracle {
            MutantOracle::Requirement(name) => name.to_string(),
            MutantOracle::Prediction | MutantOracle::Conformance | MutantOracle::Error => {
                score.oracle.to_string()
            }
        },
        noticed: score.killed,
        per_method: methods.iter().map(|m| score.methods.get(m).copied().unwrap_or(0)).collect(),
        alone: score.alone,
        faults: found.mutants.iter().filter_map(noticed).collect(),
    }
}

fn missed(mutant: &MutantReport, is_of_model: bool) -> Option<MissedFault> {
    let how = match mutant.fate {
        MutantFate::NotReached if is_of_model => "no run can be there".to_owned(),
        MutantFate::NotReached => "no test executes it".to_owned(),
        MutantFate::Survived if is_of_model => "it allows less somewhere, and no run shows that".to_owned(),
        MutantFate::Survived => mutant.difference.as_ref().map_or_else(String::new, |difference| {
            format!(
                "in {}: {} instead of {}",
                difference.test.as_str(),
                difference.mutant,
                difference.original
            )
        }),
        MutantFate::Killed
        | MutantFate::NotDistinguished
        | MutantFate::Permissive
        | MutantFate::Equivalent
        | MutantFate::Duplicate
        | MutantFate::Invalid
        | MutantFate::NotRun => return None,
    };
    Some(MissedFault {
        place: place(mutant),
        operator: mutant.operator.clone(),
        what: mutant.what.clone(),
        how,
        proposals: mutant.proposals.iter().map(|proposal| proposal.pattern.clone()).collect(),
    })
}

fn place(mutant: &MutantReport) -> String {
    format!("{}:{}", mutant.file, mutant.line)
}
