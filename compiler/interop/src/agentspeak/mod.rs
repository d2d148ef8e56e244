//! Jason's AgentSpeak: `.asl` programs and `.mas2j` projects to a scenario.
//!
//! # Steps
//! 1. `lex`, `parse`, `project`, `read`: files to programs and agents (`system`)
//! 2. `survey`: what each program does with which belief, goal and action
//! 3. `infer`: what types their arguments have (`types`: classes of places where the same values meet)
//! 4. `names`: what everything is called in the scenario
//! 5. `write`: the text; what cannot be written is left out, with a comment
//! 6. `quirks`: what looks like a mistake, or means something else in a scenario
//!
//! [`import`] does them all.

mod alternatives;
mod ast;
mod infer;
mod internal;
mod lex;
mod names;
mod parse;
mod project;
mod quirks;
mod read;
mod survey;
mod system;
mod tags;
mod term;
mod texts;
mod types;
mod write;

use hrdsl_source::{SourceFiles, Span};

use self::{
    names::AgentSpeakNames,
    parse::place,
    survey::{PredicateSurvey, survey},
    types::{AgentSpeakType, UnificationTable},
};
use crate::exchange::{
    note::{ImportNote, ImportedScenario, NoteSeverity, SyntaxError},
    source::{ForeignLoader, ForeignSource},
};

/// How to import.
#[derive(Clone, Debug, Default)]
pub struct AgentSpeakOptions {
    /// The scenario's name; otherwise that of the project, or of the first file.
    pub name: Option<String>,
}

/// Makes a scenario from programs (`.asl`, one agent each) and projects (`.mas2j`).
///
/// # Errors
/// What cannot be read, and what was expected there.
pub fn import(
    files: &[ForeignSource],
    loader: &dyn ForeignLoader,
    options: &AgentSpeakOptions,
) -> Result<ImportedScenario, Vec<SyntaxError>> {
    let system = read::read(files, loader, options.name.as_deref())?;
    let mut surveys: Vec<PredicateSurvey> = system.programs.iter().map(survey).collect();
    for agent in &system.agents {
        for belief in &agent.beliefs {
            surveys[agent.program].belief(belief, survey::OccurrenceKind::Initial);
        }
        for goal in &agent.goals {
            surveys[agent.program].goal(goal, survey::OccurrenceKind::Adopted);
        }
    }
    let inferred = infer::infer(&system);
    let names = AgentSpeakNames::new(&system, &inferred.types, &surveys);
    let writer = write::AgentSpeakTranslator {
        system: &system,
        inferred: &inferred,
        names: &names,
        surveys: &surveys,
    };
    let written = writer.write();
    let mut report = NoteCollector { files: &system.files, notes: Vec::new() };
    for (span, reason) in &written.left_out {
        report.note(*span, NoteSeverity::LeftOut, reason.clone(), None);
    }
    for (span, remark) in system.skipped.iter().chain(&written.remarks) {
        report.note(*span, NoteSeverity::Warning, remark.clone(), None);
    }
    for (span, severity, message, help) in quirks::quirks(&system, &surveys) {
        report.note(span, severity, message, help);
    }
    report.names(&names, &inferred.types, &surveys);
    report.types(&inferred.types, &surveys);
    let mut notes = report.notes;
    notes.sort();
    notes.dedup();
    let text = hrdsl_syntax::format(&written.text).unwrap_or(written.text);
    Ok(ImportedScenario { text, notes })
}

struct NoteCollector<'a> {
    files: &'a SourceFiles,
    notes: Vec<ImportNote>,
}

impl NoteCollector<'_> {
    fn note(&mut self, span: Span, severity: NoteSeverity, message: String, help: Option<String>) {
        let (file, line, column) = place(self.files, span);
        self.notes.push(ImportNote { file, line, column, severity, message, help });
    }

    /// What has another name.
    fn names(&mut self, names: &AgentSpeakNames, types: &UnificationTable, surveys: &[PredicateSurvey]) {
        let mut renamed = Vec::new();
        for (key, name) in &names.beliefs {
            let found = surveys.iter().flat_map(|s| &s.beliefs).find(|m| m.key == *key);
            renamed.push((found.map(|m| m.span), "belief", &key.0, name));
        }
        for (key, name) in &names.goals {
            let found = surveys.iter().flat_map(|s| &s.goals).find(|m| m.key == *key);
            renamed.push((found.map(|m| m.span), "goal", &key.0, name));
        }
        for ((_, key), name) in &names.actions {
            let found = surveys.iter().find_map(|s| s.actions.get(key)).copied();
            renamed.push((found, "action", &key.0, name));
        }
        let agents = names.agents.iter().map(|(old, new)| (Some(Span::default()), "agent", old, new));
        let values = names.enums.iter().flat_map(|e| &e.values);
        renamed.extend(agents);
        for (old, new) in values {
            let place = types.terms.keys().find(|s| self.files.text(**s) == old).copied();
            renamed.push((Some(place.unwrap_or_default()), "value", old, new));
        }
        for (span, what, old, new) in renamed {
            if old != new
                && let Some(span) = span
            {
                self.note(span, NoteSeverity::Info, format!("the {what} `{old}` is called `{new}`"), None);
            }
        }
    }

    /// Of what type nothing is known.
    fn types(&mut self, types: &UnificationTable, surveys: &[PredicateSurvey]) {
        let beliefs = types.beliefs.iter().map(|t| (t, false));
        for ((key, places), goal) in beliefs.chain(types.goals.iter().map(|t| (t, true))) {
            let find = |s: &PredicateSurvey| {
                let mentions = if goal { &s.goals } else { &s.beliefs };
                mentions.iter().find(|m| m.key == *key).map(|m| m.span)
            };
            let Some(span) = surveys.iter().find_map(find) else { continue };
            for (i, place) in places.iter().enumerate() {
                if types.leaves(*place).iter().any(|l| *types.get(l.of) == AgentSpeakType::Unknown) {
                    let message = format!(
                        "nothing says of what type argument {} of `{}` is: `int` is assumed",
                        i + 1,
                        key.0
                    );
                    self.note(span, NoteSeverity::Info, message, None);
                }
            }
        }
    }
}
