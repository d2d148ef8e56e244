//! A file of requirements as pip reads it (pip's page "Requirements File Format"): the lines of it and of all files
//! that it includes, and what local files and folders they name.
//!
//! Only what names something local is understood; the rest goes to pip as it was written.

use std::{
    fmt, fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

use super::{
    named::{self, LocalRequirement},
    options::{self, OptionKind},
};
use crate::error::SutError;

/// What pip is to install.
#[derive(Debug)]
pub(super) struct PipRequirements {
    /// Where pip runs: paths in requirements are relative to it, wherever the requirement stands.
    pub folder: PathBuf,
    pub lines: Vec<RequirementLine>,
    /// Those of the files that are given as constraints.
    pub constraints: Vec<RequirementLine>,
}

/// A line, or several that `\` joins; without its comment.
#[derive(Debug)]
pub(super) struct RequirementLine {
    pub origin: LineOrigin,
    /// As it was written.
    pub text: String,
    /// With the values of variables; it may hold passwords.
    pub expanded: String,
    /// `None` for a line of options.
    pub name: Option<String>,
    pub local: Option<LocalRequirement>,
}

/// Where a line stands.
#[derive(Clone, Debug)]
pub(super) struct LineOrigin {
    pub file: PathBuf,
    pub line: usize,
}

impl fmt::Display for LineOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

impl LineOrigin {
    pub(super) fn error(&self, what: impl fmt::Display, detail: impl Into<String>) -> SutError {
        SutError::Environment { what: format!("{self}: {what}"), detail: detail.into() }
    }
}

/// The values of environment variables.
pub(super) type EnvVarLookup<'a> = &'a dyn Fn(&str) -> Option<String>;

impl PipRequirements {
    /// Reads a file and all that it includes.
    pub(super) fn read(list: &Path, variables: EnvVarLookup<'_>) -> Result<Self, SutError> {
        Self::read_as(FileRole::Requirements, list, list.parent().unwrap_or(Path::new(".")), variables)
    }

    /// Reads a file of constraints for a pip that runs in `folder`.
    pub(super) fn read_constraints(
        list: &Path,
        folder: &Path,
        variables: EnvVarLookup<'_>,
    ) -> Result<Self, SutError> {
        Self::read_as(FileRole::Constraints, list, folder, variables)
    }

    fn read_as(
        role: FileRole,
        list: &Path,
        folder: &Path,
        variables: EnvVarLookup<'_>,
    ) -> Result<Self, SutError> {
        let found = Self { folder: folder.to_owned(), lines: Vec::new(), constraints: Vec::new() };
        let mut reader = RequirementsReader { found, variables, open: Vec::new() };
        reader.file(list, role, None)?;
        Ok(reader.found)
    }

    /// Requirements that are no user's.
    pub(super) fn built_in(text: &str, folder: &Path) -> Self {
        let line = |(at, text): (usize, &str)| RequirementLine {
            origin: LineOrigin { file: PathBuf::from("built in"), line: at + 1 },
            text: text.to_owned(),
            expanded: text.to_owned(),
            name: Some(named::title(text, None)),
            local: None,
        };
        let lines = text.lines().enumerate().map(line).collect();
        Self { folder: folder.to_owned(), lines, constraints: Vec::new() }
    }

    /// Requirements, in the order of the file; without lines of options.
    pub(super) fn named(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().filter_map(|line| line.name.as_deref())
    }

    pub(super) fn all_lines(&self) -> impl Iterator<Item = &RequirementLine> {
        self.lines.iter().chain(&self.constraints)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum FileRole {
    Requirements,
    Constraints,
}

struct RequirementsReader<'a> {
    found: PipRequirements,
    variables: EnvVarLookup<'a>,
    /// The files that are being read, each included by the one before.
    open: Vec<PathBuf>,
}

impl RequirementsReader<'_> {
    fn file(&mut self, file: &Path, role: FileRole, from: Option<&LineOrigin>) -> Result<(), SutError> {
        let bytes = fs::read(file).map_err(|e| match (e.kind(), from) {
            (ErrorKind::NotFound, Some(origin)) => origin.error(
                format!("there is no file {}", file.display()),
                "an included file is looked for beside the file that includes it",
            ),
            (ErrorKind::NotFound, None) => {
                SutError::Absent { what: "list of requirements", looked_for: file.display().to_string() }
            }
            _ => SutError::io(format!("cannot read {}", file.display()))(e),
        })?;
        let identity = file.canonicalize().unwrap_or_else(|_| file.to_owned());
        if let (Some(origin), true) = (from, self.open.contains(&identity)) {
            return Err(origin
                .error(format!("{} includes itself", file.display()), "take this line, or that one, out"));
        }
        self.open.push(identity);
        for (line, text) in logical_lines(&decode(&bytes)) {
            self.line(LineOrigin { file: file.to_owned(), line }, text, role)?;
        }
        self.open.pop();
        Ok(())
    }

    fn line(&mut self, origin: LineOrigin, text: String, role: FileRole) -> Result<(), SutError> {
        let expanded = expand(&text, self.variables);
        let (requirement, option_words) = options::split(&expanded);
        if !requirement.is_empty() {
            let local = named::local(requirement, &self.found.folder, &origin)?;
            let name = Some(named::title(requirement, local.as_ref()));
            let local = local.map(|local| local.followed_by(option_words));
            self.push(RequirementLine { origin, text, expanded, name, local }, role);
            return Ok(());
        }
        let choices = options::parse(option_words).map_err(|why| origin.error(why, "pip cannot read it"))?;
        let value = |option: &str| choices.iter().find(|c| c.option == option).and_then(|c| c.value.clone());
        if let Some(editable) = value("--editable") {
            return self.editable(origin, &editable, &choices, role);
        }
        let included = value("--requirement")
            .map(|file| (file, FileRole::Requirements))
            .or_else(|| value("--constraint").map(|file| (file, FileRole::Constraints)));
        if let Some((file, role)) = included
            && let Some(file) = named::path_of(&file)
        {
            let beside = origin.file.parent().unwrap_or(Path::new(".")).join(file);
            return self.file(&beside, role, Some(&origin));
        }
        let local = value("--find-links")
            .and_then(|links| named::links(&links, &origin, &self.found.folder))
            .map(|links| links.followed_by(&options::join_without(&choices, "--find-links")));
        // What requires is said by requirements, wherever the options stand.
        self.push(RequirementLine { origin, text, expanded, name: None, local }, FileRole::Requirements);
        Ok(())
    }

    /// What pip would only link to is installed as any other package: programs run without the hooks of links.
    fn editable(
        &mut self,
        origin: LineOrigin,
        what: &str,
        choices: &[OptionKind],
        role: FileRole,
    ) -> Result<(), SutError> {
        let rest = options::join_without(choices, "--editable");
        let shown = if named::is_folder(what, &self.found.folder) && !what.contains('/') {
            format!("./{what}") // only as editable may a folder's name stand alone
        } else {
            what.to_owned()
        };
        let local = named::local(&shown, &self.found.folder, &origin)?;
        let name = Some(named::title(&shown, local.as_ref()));
        let local = local.map(|local| local.followed_by(&rest));
        let text = format!("{shown} {rest}").trim_end().to_owned();
        self.push(RequirementLine { origin, expanded: text.clone(), text, name, local }, role);
        Ok(())
    }

    fn push(&mut self, line: RequirementLine, role: FileRole) {
        match role {
            FileRole::Requirements => self.found.lines.push(line),
            FileRole::Constraints => self.found.constraints.push(line),
        }
    }
}

/// UTF-8, or what a mark at the beginning says: some consoles write UTF-16.
fn decode(bytes: &[u8]) -> String {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair)).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        _ => String::from_utf8_lossy(bytes).into_owned(),
    }
}

/// The lines that are not empty, joined at `\` and without comments, with the number of the first of each.
fn logical_lines(text: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (at, line) in text.lines().enumerate() {
        let (number, mut joined) = open.take().unwrap_or((at + 1, String::new()));
        let is_comment = line.trim_start().starts_with('#');
        if is_comment {
            joined.push(' '); // a comment ends what was to go on
        }
        if line.ends_with('\\') && !is_comment {
            joined.push_str(line.trim_matches('\\'));
            open = Some((number, joined));
        } else {
            joined.push_str(line);
            lines.push((number, joined));
        }
    }
    lines.extend(open);
    for (_, line) in &mut lines {
        let text = without_comment(line).trim();
        *line = text.to_owned();
    }
    lines.retain(|(_, line)| !line.is_empty());
    lines
}

/// A comment begins at a `#` at the line's beginning or after a blank.
fn without_comment(line: &str) -> &str {
    let is_start = |&(at, _): &(usize, &str)| at == 0 || line[..at].ends_with(char::is_whitespace);
    line.match_indices('#').find(is_start).map_or(line, |(at, _)| &line[..at])
}

/// `${NAME}` of capital letters, digits and `_`, where the variable has a value; everything else stays.
fn expand(text: &str, variables: EnvVarLookup<'_>) -> String {
    let mut expanded = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("${") {
        let (before, from) = rest.split_at(at);
        expanded.push_str(before);
        let name = from[2..].split('}').next().filter(|name| from.len() > 2 + name.len());
        let is_name = |name: &&str| {
            !name.is_empty()
                && name.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_')
        };
        match name.filter(is_name).and_then(|name| Some((name, variables(name).filter(|v| !v.is_empty())?))) {
            Some((name, value)) => {
                expanded.push_str(&value);
                rest = &from[name.len() + 3..];
            }
            None => {
                expanded.push_str("${");
                rest = &from[2..];
            }
        }
    }
    expanded + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(files: &[(&str, &str)]) -> Result<PipRequirements, SutError> {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let variables = |name: &str| (name == "TOKEN").then(|| "s3cret".to_owned());
        PipRequirements::read(&folder.path().join("requirements.txt"), &variables)
    }

    fn texts(lines: &[RequirementLine]) -> Vec<&str> {
        lines.iter().map(|line| line.text.as_str()).collect()
    }

    #[test]
    fn comments_continuations_and_variables_are_as_pip_has_them() {
        let text = "# head\n\n a==1  # why\nb \\\n  >=2 \\\n  ,<3\nc#d\nurl @ https://${TOKEN}@x/${NONE}/${low}.zip\n\
            e \\\n# end\nf";
        let found = read(&[("requirements.txt", text)]).unwrap();
        let expected =
            ["a==1", "b   >=2   ,<3", "c#d", "url @ https://${TOKEN}@x/${NONE}/${low}.zip", "e", "f"];
        assert_eq!(texts(&found.lines), expected);
        assert_eq!(found.lines[3].expanded, "url @ https://s3cret@x/${NONE}/${low}.zip");
        let lines: Vec<usize> = found.lines.iter().map(|line| line.origin.line).collect();
        assert_eq!(lines, [3, 4, 7, 8, 9, 11]);
    }

    #[test]
    fn included_files_are_read_beside_those_that_include_them() {
        let found = read(&[
            ("requirements.txt", "a\n-r more/b.txt\n--constraint=more/c.txt\nd"),
            ("more/b.txt", "--requirement deeper.txt\nb\n"),
            ("more/deeper.txt", "--pre\ndeep\n"),
            ("more/c.txt", "a<2\n-r deeper.txt\n"),
        ])
        .unwrap();
        assert_eq!(texts(&found.lines), ["a", "--pre", "deep", "b", "--pre", "deep", "d"]);
        assert_eq!(texts(&found.constraints), ["a<2"]);
        assert_eq!(found.named().collect::<Vec<_>>(), ["a", "deep", "b", "deep", "d"]);
    }

    #[test]
    fn faults_name_the_file_and_the_line() {
        for (text, place, what) in [
            ("a\n-r none.txt", "requirements.txt:2: ", "there is no file"),
            ("\n-c requirements.txt", "requirements.txt:2: ", "includes itself"),
            ("a\n\n./none", "requirements.txt:3: ", "there is no `./none`"),
            ("a \\\n\nnone-1.0.whl", "requirements.txt:3: ", "there is no `none-1.0.whl`"),
            ("./folder[x]", "requirements.txt:1: ", "neither a pyproject.toml nor a setup.py"),
            ("-f 'links", "requirements.txt:1: ", "does not end"),
        ] {
            let error = read(&[("requirements.txt", text), ("folder/x.py", "")]).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains(what), "{text}: {error}");
        }
        assert!(read(&[("requirements.txt", "./none; sys_platform == 'x'")]).is_ok(), "for another machine");
    }

    #[test]
    fn what_is_local_is_known_in_all_its_forms() {
        let project = ("lib/pyproject.toml", "");
        for (line, put) in [
            ("./lib", "/x y"),
            ("lib/", "/x y"),
            ("./lib[a,b] ; python_version > '3'", "/x y[a,b] ; python_version > '3'"),
            ("-e ./lib", "/x y"),
            ("-e lib", "/x y"),
            ("--editable=./lib[a] --config-settings k=v", "/x y[a] --config-settings 'k=v'"),
            ("name[a] @ file:lib ; os_name == 'x'", "name[a] @ file:///x%20y ; os_name == 'x'"),
            ("file:lib#egg=lib", "file:///x%20y#egg=lib"),
            ("--no-index -f lib", "--find-links '/x y' --no-index"),
        ] {
            let found = read(&[("requirements.txt", line), project]).unwrap();
            let local = found.lines[0].local.as_ref().unwrap_or_else(|| panic!("{line} is local"));
            assert_eq!(local.with(Path::new("/x y")), put, "{line}");
            assert!(local.path.ends_with("lib"), "{line}");
        }
        for line in ["lib", "lib==1", "git+https://x/lib@1", "x @ https://y/lib", "--index-url https://y/lib"]
        {
            assert!(read(&[("requirements.txt", line), project]).unwrap().lines[0].local.is_none(), "{line}");
        }
        let found = read(&[("requirements.txt", "x @ git+file:///repo@main#egg=x"), project]).unwrap();
        assert_eq!(found.lines[0].local.as_ref().unwrap().path, Path::new("/repo"));
    }

    #[test]
    fn files_of_other_encodings_are_read() {
        let utf16: Vec<u8> = "\u{feff}a\r\nb\r\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(logical_lines(&decode(&utf16)), [(1, "a".to_owned()), (2, "b".to_owned())]);
        assert_eq!(decode(b"\xef\xbb\xbfa"), "a");
    }

    #[test]
    fn titles_are_short_and_hold_no_passwords() {
        let title = |text: &str| named::title(text, None);
        assert_eq!(title("numpy>=1"), "numpy");
        assert_eq!(title("https://user:word@host/a/b-1.0.zip#sha256=1"), "b-1.0.zip");
        assert_eq!(title("git+https://user:word@host/a/b.git@main"), "b.git@main");
        let found =
            read(&[("requirements.txt", "-e './my lib'\n."), ("my lib/setup.py", ""), ("setup.py", "")]);
        assert_eq!(found.as_ref().unwrap().named().next(), Some("my lib"));
    }
}
