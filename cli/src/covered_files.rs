//! The files that `coverage` means: names, and patterns of names (`"*.py"`, `"src/**/*.py"`), from the scenario's folder.

use std::path::Path;

use glob::{MatchOptions, Pattern};
use hrdsl_compiler::is_file_pattern;
use hrdsl_ir::system::SystemUnderTest;

/// A `*` stays within a folder, and what is hidden is named in full.
const HOW: MatchOptions =
    MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };

/// The system with the files whose coverage is measured each by its name.
pub fn named(system: &SystemUnderTest, folder: &Path) -> SystemUnderTest {
    let mut system = system.clone();
    for program in &mut system.programs {
        let mut files: Vec<String> = Vec::new();
        for file in program.coverage.iter().flat_map(|name| matching(folder, name)) {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        program.coverage = files;
    }
    system
}

/// The files that a name means, in the order of their names. One without wildcards means itself, whether or not it is there.
fn matching(folder: &Path, name: &str) -> Vec<String> {
    if !is_file_pattern(name) || folder.join(name).is_file() {
        return vec![name.to_owned()];
    }
    let whole = Path::new(&Pattern::escape(&folder.display().to_string())).join(name);
    let Ok(found) = glob::glob_with(&whole.display().to_string(), HOW) else { return Vec::new() };
    let files = found.filter_map(Result::ok).filter(|path| path.is_file());
    // What tests leave behind may hold copies of the programs.
    let relative =
        files.filter_map(|path| Some(path.strip_prefix(folder).unwrap_or(&path).to_str()?.to_owned()));
    relative.filter(|file| !file.starts_with("hrdsl-out/")).collect()
}

/// Whether a name means a file that is there.
pub fn is_there(folder: &Path, name: &str) -> bool {
    matching(folder, name).iter().any(|file| folder.join(file).is_file())
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "tests write files")]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::Builder::new().prefix("a[b]*").tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        folder
    }

    #[test]
    fn patterns_mean_files_in_order_and_names_mean_themselves() {
        let all = [
            "b.py",
            "a.py",
            "notes.txt",
            ".hidden.py",
            "lib/c.py",
            "lib/deep/d.py",
            "hrdsl-out/x/files/a.py",
        ];
        let folder = folder(&all);
        let found = |name: &str| matching(folder.path(), name).join(" ");
        assert_eq!(found("*.py"), "a.py b.py");
        assert_eq!(found("**/*.py"), "a.py b.py lib/c.py lib/deep/d.py");
        assert_eq!(found("lib/*"), "lib/c.py");
        assert_eq!(found("[ab].py"), "a.py b.py");
        assert_eq!(found("gone.py"), "gone.py");
        assert_eq!(found("*.cc"), "");
        assert_eq!(found("[.py"), "", "no pattern at all");
        assert!(
            is_there(folder.path(), "lib/**/?.py")
                && !is_there(folder.path(), "lib")
                && !is_there(folder.path(), "[.py")
        );
    }

    #[test]
    fn a_file_with_a_star_in_its_name_is_that_file() {
        let folder = folder(&["a*.py", "ab.py"]);
        assert_eq!(matching(folder.path(), "a*.py"), ["a*.py"]);
    }
}
