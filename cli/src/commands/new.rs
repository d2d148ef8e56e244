//! `hrdsl new`: a small project that checks, generates by all methods and runs.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use hrdsl_compiler::token::{KEYWORDS, KeywordClass};

use crate::{exit::CommandExit, fault::CommandFault, terminal};

/// Begin a project: a scenario, a robot program, a README.
///
/// The scenario checks, generates tests by all three methods, and runs against the robot program.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  hrdsl new greeter
  hrdsl new greeter --dir ~/robots")]
pub struct NewArgs {
    /// The project's name, and that of its folder and scenario: letters, digits and `_`.
    name: String,
    /// The folder in which the project's folder is made.
    #[arg(long, value_name = "PATH", default_value = ".")]
    dir: PathBuf,
}

/// The files, by name in the project; `{{name}}` in them is the project's name.
const TEMPLATES: [(&str, &str); 4] = [
    ("scenario.hri", include_str!("../../templates/scenario.hri")),
    ("robot.py", include_str!("../../templates/robot.py")),
    ("README.md", include_str!("../../templates/README.md")),
    (".gitignore", include_str!("../../templates/gitignore")),
];

const PLACEHOLDER: &str = "{{name}}";

/// # Errors
/// A name that is no name, files that are there already, or cannot be written.
pub fn run(args: &NewArgs) -> Result<CommandExit, CommandFault> {
    let name = &args.name;
    check(name)?;
    let here = args.dir.as_os_str() == ".";
    let folder = if here { PathBuf::from(name) } else { args.dir.join(name) };
    let there =
        TEMPLATES.iter().map(|(file, _)| folder.join(file)).find(|path| path.symlink_metadata().is_ok());
    if let Some(path) = there {
        return Err(format!(
            "{} is there already, and nothing is overwritten: choose another name",
            terminal::shown(&path)
        ));
    }
    for (file, template) in TEMPLATES {
        create(&folder.join(file), &template.replace(PLACEHOLDER, name))?;
    }
    let shown = terminal::shown(&folder);
    terminal::print(&format!(
        "made {shown}: scenario.hri, robot.py, README.md, .gitignore\n\nGo on with\n  hrdsl check {shown}\n  hrdsl gen {shown}/scenario.hri -o {shown}/tests\n  hrdsl sim {shown}/scenario.hri\n"
    ))?;
    Ok(CommandExit::Ok)
}

/// Whether a scenario can be called that.
fn check(name: &str) -> Result<(), CommandFault> {
    if let Some(keyword) = KEYWORDS.iter().find(|k| k.word == name) {
        match keyword.class {
            KeywordClass::Reserved => {
                return Err(format!(
                    "`{name}` is a keyword of the language ({}) and cannot be a name; `{name}_` can",
                    keyword.place
                ));
            }
            KeywordClass::Head | KeywordClass::Hard | KeywordClass::Soft => {}
        }
    }
    let fits = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts && name.chars().all(fits) && name != "_" {
        return Ok(());
    }
    let fixed: String = name.chars().map(|c| if fits(c) { c } else { '_' }).collect();
    let fixed = fixed.trim_matches('_');
    let reason =
        "a name is made of the letters a to z and A to Z, digits and `_`, and does not begin with a digit";
    Err(match fixed.chars().next() {
        Some(first) if !first.is_ascii_digit() => format!("`{name}` is no name: {reason}; `{fixed}` is one"),
        Some(_) | None => format!("`{name}` is no name: {reason}"),
    })
}

/// Writes a file that must not be there.
fn create(path: &Path, text: &str) -> Result<(), CommandFault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", terminal::shown(path));
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fault)?;
    }
    fs::File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes())).map_err(fault)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_language() {
        for name in ["greeter", "_x", "tests", "Robot2", "agent"] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        for name in ["", "_", "2b", "my-robot", "a b", "ü", "../x", "not", "true"] {
            assert!(check(name).is_err(), "{name}");
        }
        assert!(check("my-robot").unwrap_err().ends_with("`my_robot` is one"));
        assert!(check("true").unwrap_err().contains("keyword"));
    }

    #[test]
    fn the_placeholder_is_in_the_files_and_goes() {
        let whole: String = TEMPLATES.iter().map(|(_, t)| t.replace(PLACEHOLDER, "x")).collect();
        assert!(TEMPLATES[0].1.contains("scenario {{name}}\n") && !whole.contains("{{"));
    }
}
