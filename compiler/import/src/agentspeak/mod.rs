//! Jason's AgentSpeak: `.asl` programs and `.mas2j` projects to a scenario.
//!
//! # Steps
//! 1. `lex`, `parse`, `project`: files to programs and agents
//! 2. `survey`: what each program does with which belief, goal and action
//! 3. `infer`: what types their arguments have (`types`: classes of places where the same values meet)
//! 4. `names`: what everything is called in the scenario
//! 5. `write`: the text; what cannot be written is left out, with a comment
//! 6. `quirks`: what looks like a mistake, or means something else in a scenario
//!
//! [`import`] does them all.

mod ast;
mod infer;
mod internal;
mod lex;
mod names;
mod parse;
mod project;
mod quirks;
mod survey;
mod types;
mod write;

use hrdsl_source::{Files, Span};

use self::{
    ast::{Literal, Program},
    names::Names,
    parse::{Reader, place},
    survey::{Survey, survey},
    types::{Ty, Types},
};
use crate::{Imported, Loader, Note, Severity, Source, SyntaxError, too_large};

/// How to import.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The scenario's name; otherwise that of the project, or of the first file.
    pub name: Option<String>,
}

/// One agent of the system.
#[derive(Debug)]
pub(crate) struct Entry {
    name: String,
    /// Index into [`System::programs`].
    program: usize,
    /// What the project gives it besides its program.
    beliefs: Vec<Literal>,
    goals: Vec<Literal>,
}

/// All agents and their programs.
#[derive(Debug, Default)]
pub(crate) struct System {
    name: String,
    files: Files,
    programs: Vec<Program>,
    agents: Vec<Entry>,
    skipped: Vec<(Span, String)>,
}

impl System {
    /// The comment at the place of something that is left out, with its text.
    fn comment(&self, span: Span, reason: &str) -> String {
        let (file, line, _) = place(&self.files, span);
        let mut comment = format!("// not carried over: {file}:{line}: {reason}");
        for line in self.files.text(span).lines().filter(|l| !l.trim().is_empty()) {
            comment += &format!("\n//   {}", line.trim().replace('\t', " "));
        }
        comment
    }
}

/// Makes a scenario from programs (`.asl`, one agent each) and projects (`.mas2j`).
///
/// # Errors
/// What cannot be read, and what was expected there.
pub fn import(
    files: &[Source],
    loader: &dyn Loader,
    options: &Options,
) -> Result<Imported, Vec<SyntaxError>> {
    let system = read(files, loader, options)?;
    let mut surveys: Vec<Survey> = system.programs.iter().map(survey).collect();
    for agent in &system.agents {
        for belief in &agent.beliefs {
            surveys[agent.program].belief(belief, survey::What::Initial);
        }
        for goal in &agent.goals {
            surveys[agent.program].goal(goal, survey::What::Adopted);
        }
    }
    let inferred = infer::infer(&system);
    let names = Names::new(&system, &inferred.types, &surveys);
    let writer = write::Writer { system: &system, inferred: &inferred, names: &names, surveys: &surveys };
    let written = writer.write();
    let mut report = Report { files: &system.files, notes: Vec::new() };
    for (span, reason) in &written.left_out {
        report.note(*span, Severity::LeftOut, reason.clone(), None);
    }
    for (span, remark) in system.skipped.iter().chain(&written.remarks) {
        report.note(*span, Severity::Warning, remark.clone(), None);
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
    Ok(Imported { text, notes })
}

struct Report<'a> {
    files: &'a Files,
    notes: Vec<Note>,
}

impl Report<'_> {
    fn note(&mut self, span: Span, severity: Severity, message: String, help: Option<String>) {
        let (file, line, column) = place(self.files, span);
        self.notes.push(Note { file, line, column, severity, message, help });
    }

    /// What has another name.
    fn names(&mut self, names: &Names, types: &Types, surveys: &[Survey]) {
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
                self.note(span, Severity::Info, format!("the {what} `{old}` is called `{new}`"), None);
            }
        }
    }

    /// Of what type nothing is known.
    fn types(&mut self, types: &Types, surveys: &[Survey]) {
        let beliefs = types.beliefs.iter().map(|t| (t, false));
        for ((key, places), goal) in beliefs.chain(types.goals.iter().map(|t| (t, true))) {
            let find = |s: &Survey| {
                let mentions = if goal { &s.goals } else { &s.beliefs };
                mentions.iter().find(|m| m.key == *key).map(|m| m.span)
            };
            let Some(span) = surveys.iter().find_map(find) else { continue };
            for (i, place) in places.iter().enumerate() {
                if types.leaves(*place).iter().any(|l| *types.get(l.of) == Ty::Unknown) {
                    let message = format!(
                        "nothing says of what type argument {} of `{}` is: `int` is assumed",
                        i + 1,
                        key.0
                    );
                    self.note(span, Severity::Info, message, None);
                }
            }
        }
    }
}

// ── Reading ──

fn read(files: &[Source], loader: &dyn Loader, options: &Options) -> Result<System, Vec<SyntaxError>> {
    let mut reader = Reader::new(loader);
    let mut system = System::default();
    let mut named = options.name.clone();
    reader.errors.extend(files.iter().filter_map(too_large));
    for file in files.iter().filter(|f| too_large(f).is_none()) {
        if file.name.ends_with(".mas2j") {
            let name = read_project(&mut reader, file, &mut system);
            named = named.or(name);
        } else {
            let program = reader.program(&file.name, &file.text);
            let name = stem(&file.name).to_owned();
            add(&mut system, program, name, Vec::new(), Vec::new());
        }
    }
    let first = files.first().map(|f| stem(&f.name).to_owned());
    reader.errors.extend(too_many(files, &system));
    system.name = named.or(first).unwrap_or_else(|| "imported".to_owned());
    system.files = std::mem::take(&mut reader.files);
    let mut errors = reader.errors;
    if errors.is_empty() && system.agents.is_empty() {
        let file = files.first().map(|f| f.name.clone()).unwrap_or_default();
        errors.push(SyntaxError { file, line: 1, column: 1, message: "there is no agent".to_owned() });
    }
    errors.sort();
    errors.dedup();
    if errors.is_empty() { Ok(system) } else { Err(errors) }
}

fn add(system: &mut System, program: Program, name: String, beliefs: Vec<Literal>, goals: Vec<Literal>) {
    system.programs.push(program);
    let program = system.programs.len() - 1;
    push(system, Entry { name, program, beliefs, goals });
}

/// Two agents never have the same name.
fn push(system: &mut System, mut entry: Entry) {
    while system.agents.iter().any(|a| a.name == entry.name) {
        entry.name.push('_');
    }
    system.agents.push(entry);
}

/// The most beliefs, goals, rules and plans of all programs, and the most agents: names, types and what is never used are
/// found by comparing them with each other.
const MAX_ITEMS: usize = 3_000;
const MAX_AGENTS: usize = 500;

/// What is wrong with the number of things to import, if anything.
fn too_many(files: &[Source], system: &System) -> Option<SyntaxError> {
    let items: usize = system.programs.iter().map(|p| p.items.len()).sum();
    let message = if items > MAX_ITEMS {
        format!(
            "the programs have {items} beliefs, goals, rules and plans; at most {MAX_ITEMS} are imported at once"
        )
    } else if system.agents.len() > MAX_AGENTS {
        format!("there are more than {MAX_AGENTS} agents, as many as are imported at once")
    } else {
        return None;
    };
    let file = files.first().map(|f| f.name.clone()).unwrap_or_default();
    Some(SyntaxError { file, line: 1, column: 1, message })
}

/// The file's name without its folder and ending.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

fn read_project(reader: &mut Reader<'_>, file: &Source, system: &mut System) -> Option<String> {
    let id = reader.files.add(&file.name, &file.text);
    let project = match project::project(id, &file.text) {
        Ok(project) => project,
        Err(fault) => {
            reader.error(fault.span, fault.message);
            return None;
        }
    };
    system.skipped.extend(project.skipped);
    for entry in project.agents {
        let Some(source) = load(reader, file, &project.paths, &entry.file, entry.span) else { continue };
        let program = reader.program(&source.name, &source.text);
        let beliefs = given(reader, entry.beliefs);
        let goals = given(reader, entry.goals);
        if entry.count == 1 {
            add(system, program, entry.name, beliefs, goals);
            continue;
        }
        system.programs.push(program);
        let program = system.programs.len() - 1;
        for n in (1..=entry.count).take(MAX_AGENTS + 1) {
            let name = format!("{}{n}", entry.name);
            push(system, Entry { name, program, beliefs: beliefs.clone(), goals: goals.clone() });
        }
    }
    Some(project.name)
}

/// The program of an agent, in the first folder that has it.
fn load(reader: &mut Reader<'_>, from: &Source, paths: &[String], file: &str, span: Span) -> Option<Source> {
    let folders = paths.iter().map(|p| format!("{}/{file}", p.trim_end_matches('/')));
    let mut first = None;
    for path in folders.chain([file.to_owned(), format!("src/agt/{file}"), format!("src/asl/{file}")]) {
        match reader.loader.load(&from.name, &path) {
            Ok(source) => return Some(source),
            Err(message) => {
                first.get_or_insert(message);
            }
        }
    }
    reader.error(span, first.unwrap_or_default());
    None
}

/// Beliefs or goals in the options of a project.
fn given(reader: &mut Reader<'_>, place: Option<Span>) -> Vec<Literal> {
    let Some(place) = place else { return Vec::new() };
    let mut parser = reader.piece(place);
    match parser.literals() {
        Ok(all) => all,
        Err(fault) => {
            reader.error(fault.span, fault.message);
            Vec::new()
        }
    }
}
