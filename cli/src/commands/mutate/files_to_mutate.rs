//! Which files of the code under test are mutated: those whose coverage is measured, else the scripts that are run.

use std::path::Path;

use hrdsl_ir::system::{SystemProgram, SystemUnderTest};

use crate::{covered_files, fault::CommandFault};

/// The system with the coverage of all files that are to be mutated measured.
///
/// # Errors
/// A system without a file of Python.
pub fn measured(system: &SystemUnderTest, dir: &Path) -> Result<SystemUnderTest, CommandFault> {
    let mut system = covered_files::named(system, dir);
    for program in &mut system.programs {
        program.coverage.retain(|file| is_python(file));
    }
    if system.coverage().is_empty() {
        for program in &mut system.programs {
            program.coverage.extend(script(program, dir));
        }
    }
    if system.coverage().is_empty() {
        return Err(format!(
            "system `{}` has no file of Python that could be mutated: name its files in `coverage`",
            system.name
        ));
    }
    Ok(system)
}

/// The system with no coverage measured.
pub fn bare(system: &SystemUnderTest) -> SystemUnderTest {
    let mut system = system.clone();
    for program in &mut system.programs {
        program.coverage.clear();
    }
    system
}

fn is_python(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|extension| extension == "py")
}

/// The script of a command such as `python3 robot.py --legs 2`, or the file of its module.
fn script(program: &SystemProgram, dir: &Path) -> Option<String> {
    let words = program.run.get(1..)?;
    let module = words.iter().position(|word| word == "-m").and_then(|at| words.get(at + 1));
    let module = module.map(|name| format!("{}.py", name.replace('.', "/")));
    let script = words.iter().find(|word| is_python(word)).cloned();
    module.into_iter().chain(script).find(|file| dir.join(file).is_file())
}
