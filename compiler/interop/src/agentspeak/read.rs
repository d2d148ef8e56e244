//! Files to agents: programs, projects, and what their options give.

use hrdsl_source::Span;

use super::{
    ast::{AgentSpeakLiteral, AgentSpeakProgram},
    parse::AgentSpeakReader,
    project,
    system::{AgentSpeakAgent, AgentSpeakSystem},
};
use crate::exchange::{
    note::SyntaxError,
    source::{ForeignLoader, ForeignSource, too_large},
};

/// The agents of programs and projects.
///
/// # Errors
/// What cannot be read.
pub fn read(
    files: &[ForeignSource],
    loader: &dyn ForeignLoader,
    name: Option<&str>,
) -> Result<AgentSpeakSystem, Vec<SyntaxError>> {
    let mut reader = AgentSpeakReader::new(loader);
    let mut system = AgentSpeakSystem::default();
    let mut named = name.map(str::to_owned);
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

fn add(
    system: &mut AgentSpeakSystem,
    program: AgentSpeakProgram,
    name: String,
    beliefs: Vec<AgentSpeakLiteral>,
    goals: Vec<AgentSpeakLiteral>,
) {
    system.programs.push(program);
    let program = system.programs.len() - 1;
    push(system, AgentSpeakAgent { name, program, beliefs, goals });
}

/// Two agents never have the same name.
fn push(system: &mut AgentSpeakSystem, mut entry: AgentSpeakAgent) {
    while system.agents.iter().any(|a| a.name == entry.name) {
        entry.name.push('_');
    }
    system.agents.push(entry);
}

/// The most beliefs, goals, rules and plans of all programs, and the most agents: names, types and what is never used are
/// found by comparing them with each other.
const MAX_ITEMS: usize = 3_000;
const MAX_AGENTS: usize = 5000;

/// What is wrong with the number of things to import, if anything.
fn too_many(files: &[ForeignSource], system: &AgentSpeakSystem) -> Option<SyntaxError> {
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

fn read_project(
    reader: &mut AgentSpeakReader<'_>,
    file: &ForeignSource,
    system: &mut AgentSpeakSystem,
) -> Option<String> {
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
            push(system, AgentSpeakAgent { name, program, beliefs: beliefs.clone(), goals: goals.clone() });
        }
    }
    Some(project.name)
}

/// The program of an agent, in the first folder that has it.
fn load(
    reader: &mut AgentSpeakReader<'_>,
    from: &ForeignSource,
    paths: &[String],
    file: &str,
    span: Span,
) -> Option<ForeignSource> {
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
fn given(reader: &mut AgentSpeakReader<'_>, place: Option<Span>) -> Vec<AgentSpeakLiteral> {
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
