//! Which system is tested.

use std::path::Path;

use hrdsl_ir::{Program, system::SystemUnderTest};

use super::CampaignArgs;
use crate::{fault::CommandFault, files, terminal};

/// The file of `--system FILE`, seen from the scenario's folder.
pub fn system_file(args: &CampaignArgs) -> Result<Option<String>, CommandFault> {
    let Some(file) = args.system.as_deref().filter(|name| is_file_name(name)) else { return Ok(None) };
    let path = Path::new(file);
    if !path.is_file() {
        return Err(format!("--system: there is no file {}", terminal::shown(path)));
    }
    Ok(Some(files::relative(path, &files::folder(&args.file)).display().to_string()))
}

pub fn is_file_name(name: &str) -> bool {
    name.ends_with(".hri")
}

/// The system of this name, or of that file, which was read last; or the first.
pub fn chosen_system<'p>(
    program: &'p Program,
    name: Option<&str>,
) -> Result<&'p SystemUnderTest, CommandFault> {
    let last = program.systems.last().map(|system| system.origin.file);
    if let Some(name) = name.filter(|name| is_file_name(name)) {
        let own = program.systems.first().is_some_and(|system| Some(system.origin.file) == last);
        let found = program.systems.iter().find(|s| Some(s.origin.file) == last && !own);
        return found.ok_or_else(|| format!("{name} has no `system`"));
    }
    let Some(first) = program.systems.first() else {
        return Err("the scenario has no `system` block: there is nothing to run".to_owned());
    };
    let Some(name) = name else { return Ok(first) };
    let names: Vec<&str> = program.systems.iter().map(|s| s.name.as_str()).collect();
    program
        .systems
        .iter()
        .find(|s| s.name == name)
        .ok_or_else(|| format!("no system is called `{name}`; there are {}", names.join(", ")))
}
