//! Beliefs given by hand: each is put behind its declaration in the scenario's text, so that the compiler reads and checks it.

use std::path::Path;

use hrdsl_compiler::{
    CompilationResult, InputFile, ModuleLoader, ModuleText, RobotReader, ast, compile_with,
};
use hrdsl_ir::{
    Program,
    bdi::{Agent, AgentId, BeliefId, InitialFact},
};

use crate::{fault::CommandFault, files, reach::DiskModules};

/// One of the beliefs, and whose it is.
struct GivenBelief<'a> {
    /// As written, without the agent's name.
    text: &'a str,
    /// Without `~`.
    name: &'a str,
    agent: AgentId,
}

/// The facts that the text lists: `wants(2), Human.shows(1, true)`; `agents` may have them.
///
/// # Errors
/// What is no belief, or none of these agents', or does not fit its declaration.
pub fn facts(
    scenario: &Path,
    compilation: &CompilationResult,
    program: &Program,
    agents: &[AgentId],
    text: &str,
) -> Result<Vec<(AgentId, InitialFact)>, CommandFault> {
    let given = split(text)?
        .into_iter()
        .map(|piece| owned(program, agents, piece))
        .collect::<Result<Vec<GivenBelief<'_>>, CommandFault>>()?;
    // One by one: each is the last that its belief is declared to hold.
    given.iter().map(|g| Ok((g.agent, fact(scenario, compilation, program, g)?))).collect()
}

/// The pieces between commas that are in no parentheses.
fn split(text: &str) -> Result<Vec<&str>, CommandFault> {
    let fault =
        |what: &str| Err(format!("--beliefs: {what} in `{text}`; write it like `wants(2), shows(1, true)`"));
    let (mut pieces, mut depth, mut start, mut quoted) = (Vec::new(), 0usize, 0, false);
    for (at, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '(' | '[' => depth += 1,
            ')' | ']' if depth == 0 => return fault("a bracket too much"),
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                pieces.push(text[start..at].trim());
                start = at + 1;
            }
            '{' | '}' | ';' | '\n' => return fault(&format!("a `{}`", c.escape_default())),
            _ => {}
        }
    }
    if quoted || depth > 0 {
        return fault("something that is not closed");
    }
    pieces.push(text[start..].trim());
    if pieces.iter().any(|p| p.is_empty()) || text.contains("//") {
        return fault("something that is no belief");
    }
    Ok(pieces)
}

fn owned<'a>(program: &Program, agents: &[AgentId], piece: &'a str) -> Result<GivenBelief<'a>, CommandFault> {
    let head = piece.find(['(', '[']).unwrap_or(piece.len());
    let (owner, text) = match piece[..head].split_once('.') {
        Some((owner, _)) => (Some(owner.trim()), piece[owner.len() + 1..].trim()),
        None => (None, piece),
    };
    let head = text.find(['(', '[']).unwrap_or(text.len());
    let name = text[..head].trim().trim_start_matches('~');
    let agent = |id: &AgentId| &program.agents[usize::from(id.0)];
    if let Some(owner) = owner
        && !agents.iter().any(|id| agent(id).name == owner)
    {
        let known: Vec<&str> = agents.iter().map(|id| agent(id).name.as_str()).collect();
        return Err(format!("--beliefs: no agent `{owner}` in the suite; it has: {}", known.join(", ")));
    }
    let declares = |id: &&AgentId| {
        owner.is_none_or(|o| agent(id).name == o) && agent(id).beliefs.iter().any(|b| b.name == name)
    };
    let owners: Vec<AgentId> = agents.iter().filter(declares).copied().collect();
    match owners.as_slice() {
        [one] => Ok(GivenBelief { text, name, agent: *one }),
        [] => {
            let theirs = agents.iter().filter(|id| owner.is_none_or(|o| agent(id).name == o));
            let known = theirs
                .flat_map(|id| agent(id).beliefs.iter().map(|b| format!("{}.{}", agent(id).name, b.name)));
            let known: Vec<String> = known.filter(|n| !n.contains('~')).collect();
            Err(format!("--beliefs: no belief `{name}`; the suite's agents have: {}", known.join(", ")))
        }
        several => {
            let each: Vec<String> = several.iter().map(|id| format!("`{}.{text}`", agent(id).name)).collect();
            Err(format!("--beliefs: several agents have `{name}`: write {}", each.join(" or ")))
        }
    }
}

fn fact(
    scenario: &Path,
    compilation: &CompilationResult,
    program: &Program,
    given: &GivenBelief<'_>,
) -> Result<InitialFact, CommandFault> {
    let agent = &program.agents[usize::from(given.agent.0)];
    let undeclared = || format!("--beliefs: `{}` is declared where nothing can be added to it", given.name);
    let declared = agent.beliefs.iter().find(|b| b.name == given.name).ok_or_else(undeclared)?;
    let file = compilation.files.get(declared.origin.file).ok_or_else(undeclared)?;
    let (end, has_some) = declaration(compilation, given.name, declared.origin).ok_or_else(undeclared)?;
    let mark = if has_some { "," } else { " =" };
    // What ends with nothing, like `belief away`, ends where the next word begins.
    let text = format!("{}{mark} {} {}", &file.text[..end], given.text, &file.text[end..]);
    let disk = DiskModules::of(Some(scenario));
    let changed = FileOverlay { disk, name: &file.name, text: &text };
    let name = scenario.display().to_string();
    let own = files::read_scenario(scenario)?;
    let head = if file.name == name { &text } else { &own };
    let compiled = compile_with(InputFile { name: &name, text: head }, &[], &changed);
    let Some(changed) = &compiled.program else {
        let first = compiled.diagnostics.iter().find(|d| d.is_error());
        let help = first.and_then(|d| d.help.as_deref()).map_or_else(String::new, |h| format!(" ({h})"));
        let why = first.map_or("it cannot be read", |d| d.message.as_str());
        return Err(format!("--beliefs: `{}`: {why}{help}", given.text));
    };
    let there = &changed.agents[usize::from(given.agent.0)];
    let name_of = |agent: &'_ Agent, id: BeliefId| agent.beliefs[usize::from(id.0)].name.clone();
    let of_it = |f: &&InitialFact| name_of(there, f.belief).trim_start_matches('~') == given.name;
    let fact = there.initial_beliefs.iter().rfind(of_it).ok_or_else(undeclared)?;
    let name = name_of(there, fact.belief);
    let here = agent.beliefs.iter().position(|b| b.name == name);
    let here = here.and_then(|at| u16::try_from(at).ok());
    let belief = here.ok_or_else(|| format!("--beliefs: nothing in the scenario is about `{name}`"))?;
    Ok(InitialFact { belief: BeliefId(belief), ..fact.clone() })
}

/// Where a belief's declaration ends, and whether it says what is believed at the start.
fn declaration(
    compilation: &CompilationResult,
    wanted: &str,
    origin: hrdsl_source::Span,
) -> Option<(usize, bool)> {
    let file = compilation.ast.get(usize::from(origin.file.0))?;
    let agents = file.items.iter().filter_map(|item| {
        let ast::ItemSyntaxKind::Agent(agent) = &item.kind else { return None };
        Some(agent)
    });
    agents.flat_map(|a| &a.members).find_map(|member| {
        let ast::AgentMemberKind::Belief { name, initial, .. } = &member.kind else { return None };
        let is_it = name.text == wanted && member.span.start <= origin.start && origin.end <= member.span.end;
        is_it.then_some((member.span.range().end, !initial.is_empty()))
    })
}

/// The files on disk, one of them changed.
struct FileOverlay<'a> {
    disk: DiskModules,
    name: &'a str,
    text: &'a str,
}

impl ModuleLoader for FileOverlay<'_> {
    fn load(&self, from: &str, path: &str) -> Result<ModuleText, String> {
        let source = self.disk.load(from, path)?;
        let is_it = source.name == self.name;
        Ok(if is_it { ModuleText { text: self.text.to_owned(), ..source } } else { source })
    }

    fn robots(&self) -> Option<Box<dyn RobotReader + '_>> {
        self.disk.robots()
    }

    fn means_a_file(&self, path: &str) -> Option<bool> {
        self.disk.means_a_file(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_in_parentheses_do_not_part() {
        assert_eq!(split("wants(2), shows(1, [2, 3])[sure(1)], near").unwrap().len(), 3);
        assert_eq!(split("says(\"a, b)\")").unwrap(), ["says(\"a, b)\")"]);
        for wrong in ["", "a,", "a(1", "a)", "a } b", "a // b", "says(\"x)"] {
            assert!(split(wrong).is_err(), "{wrong}");
        }
    }
}
