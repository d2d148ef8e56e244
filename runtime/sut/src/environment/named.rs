//! What a requirement names: a project of an index, something remote, or a local file or folder.

use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

use super::{options::quoted, requirements::LineOrigin};
use crate::error::SutError;

/// Something local, with the text around it on its line.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct LocalRequirement {
    pub kind: LocalKind,
    pub path: PathBuf,
    before: String,
    after: String,
    form: RequirementForm,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LocalKind {
    /// A project's folder.
    Folder,
    /// A wheel or an archive.
    File,
    /// A folder of wheels and archives, or a page that links to some.
    Links,
    /// A repository from which a version control system takes the project.
    Repository,
}

/// How a path is written on its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RequirementForm {
    Path,
    Url,
    Option,
}

const ARCHIVES: &[&str] =
    &[".whl", ".zip", ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz", ".tar.xz", ".txz", ".tar.lzma", ".tlz"];
/// What has a meaning in a URL, apart from `/`.
const IN_URL: &AsciiSet =
    &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'_').remove(b'.').remove(b'~').remove(b'+');

impl LocalRequirement {
    pub(super) fn followed_by(mut self, more: &str) -> Self {
        if !more.is_empty() {
            self.after = format!("{} {more}", self.after);
        }
        self
    }

    /// The text around the path.
    pub(super) fn around(&self) -> [&str; 2] {
        [&self.before, &self.after]
    }

    /// The line with another path.
    pub(super) fn with(&self, path: &Path) -> String {
        let path = path.to_string_lossy();
        let path = match self.form {
            RequirementForm::Path => path.into_owned(),
            RequirementForm::Url => format!("file://{}", utf8_percent_encode(&path, IN_URL)),
            RequirementForm::Option => quoted(&path),
        };
        format!("{}{path}{}", self.before, self.after)
    }

    pub(super) fn is_archive_of_sources(&self) -> bool {
        self.kind == LocalKind::File && is_archive_of_sources(&self.path)
    }
}

/// Whether pip builds a wheel from a file, and keeps it under the file's name.
pub(super) fn is_archive_of_sources(path: &Path) -> bool {
    let name = path.to_string_lossy().to_ascii_lowercase();
    !name.ends_with(".whl") && ARCHIVES.iter().any(|end| name.ends_with(end))
}

/// What is local in a requirement, for a pip that runs in `folder`.
///
/// # Errors
/// It is meant to be local, and pip could not install it.
pub(super) fn local(
    text: &str,
    folder: &Path,
    origin: &LineOrigin,
) -> Result<Option<LocalRequirement>, SutError> {
    let at_url = split_at_url(text).or_else(|| is_url(text).then_some(("", text)));
    let found = match at_url {
        Some((before, url)) => by_url(before, url, folder),
        None => by_path(text, folder, origin)?,
    };
    if let Some(local) = found.as_ref().filter(|local| local.kind == LocalKind::Folder) {
        let has = |file: &str| local.path.join(file).is_file();
        // A part of the folder may be meant.
        if !has("pyproject.toml") && !has("setup.py") && !local.after.contains("subdirectory=") {
            return Err(origin.error(
                format!("{} has neither a pyproject.toml nor a setup.py", local.path.display()),
                "pip installs folders of Python projects only; modules beside the program need no requirement",
            ));
        }
    }
    Ok(found)
}

/// `name[extras] @ url`, parted before the URL.
fn split_at_url(text: &str) -> Option<(&str, &str)> {
    let (name, url) = text.split_once('@')?;
    let bare = name.split('[').next().unwrap_or(name).trim();
    let url = url.trim_start();
    (project(bare) == Some(bare) && is_url(url)).then(|| text.split_at(text.len() - url.len()))
}

fn is_url(text: &str) -> bool {
    let scheme = text.split_once(':').map_or("", |(scheme, _)| scheme).to_ascii_lowercase();
    matches!(&*scheme, "file" | "http" | "https" | "ftp" | "ssh") || scheme.contains('+')
}

fn by_url(before: &str, url: &str, folder: &Path) -> Option<LocalRequirement> {
    let end = url.find(char::is_whitespace).unwrap_or(url.len());
    let address = url[..end].split('#').next().unwrap_or(url);
    let repository = address.split_once('+').filter(|(system, _)| !system.contains(':'));
    let file = repository.map_or(address, |(_, file)| file);
    if !file.starts_with("file:") {
        return None;
    }
    let path = joined(folder, path_of(file)?);
    let kind = match repository {
        Some(_) => return Some(repository_at(path, before, url)),
        None if path.is_dir() => LocalKind::Folder,
        None if path.is_file() => LocalKind::File,
        None => return None, // pip says so, with the URL
    };
    let after = url[address.len()..].to_owned();
    Some(LocalRequirement { kind, path, before: before.to_owned(), after, form: RequirementForm::Url })
}

/// A revision may follow the path; the whole line tells which.
fn repository_at(path: PathBuf, before: &str, url: &str) -> LocalRequirement {
    let text = path.to_string_lossy();
    let without = text.rsplit_once('@').map(|(path, _)| PathBuf::from(path));
    let path = without.filter(|_| !path.exists()).unwrap_or(path);
    let (before, kind) = (format!("{before}{url}"), LocalKind::Repository);
    LocalRequirement { kind, path, before, after: String::new(), form: RequirementForm::Url }
}

fn by_path(text: &str, folder: &Path, origin: &LineOrigin) -> Result<Option<LocalRequirement>, SutError> {
    let (requirement, marker) = text.split_at(text.find(';').unwrap_or(text.len()));
    let name = requirement.trim();
    let bare = without_extras(name);
    let path = joined(folder, bare);
    let looks_like_a_path = bare.contains('/') || bare.starts_with('.');
    let is_archive = ARCHIVES.iter().any(|end| bare.to_ascii_lowercase().ends_with(end));
    let kind = match () {
        () if looks_like_a_path && path.is_dir() => LocalKind::Folder,
        () if is_archive && path.is_file() => LocalKind::File,
        // With a marker it may be for another machine.
        () if (looks_like_a_path || is_archive) && marker.is_empty() => {
            return Err(origin.error(
                format!("there is no `{bare}`"),
                format!("paths in requirements are relative to {}", folder.display()),
            ));
        }
        () => return Ok(None),
    };
    let extras = &name[bare.len()..];
    let after = if marker.is_empty() { extras.to_owned() } else { format!("{extras} {marker}") };
    Ok(Some(LocalRequirement { kind, path, before: String::new(), after, form: RequirementForm::Path }))
}

/// Without `.` between, so that it reads well.
fn joined(folder: &Path, path: impl AsRef<Path>) -> PathBuf {
    folder.join(path).components().collect()
}

fn without_extras(text: &str) -> &str {
    match text.rfind('[') {
        Some(at) if at > 0 && text.ends_with(']') => text[..at].trim_end(),
        Some(_) | None => text,
    }
}

/// The place of `--find-links`, if it is local: beside the file that names it, else as pip sees it.
pub(super) fn links(value: &str, origin: &LineOrigin, folder: &Path) -> Option<LocalRequirement> {
    let path = path_of(value)?;
    let beside = origin.file.parent().unwrap_or(Path::new(".")).join(&path);
    let path = if beside.exists() { beside } else { folder.join(path) };
    let before = "--find-links ".to_owned();
    let kind = LocalKind::Links;
    path.exists().then_some(LocalRequirement {
        kind,
        path,
        before,
        after: String::new(),
        form: RequirementForm::Option,
    })
}

/// The path that a value of an option is: it may be written as a URL.
pub(super) fn path_of(value: &str) -> Option<PathBuf> {
    if !is_url(value) {
        return Some(PathBuf::from(value));
    }
    let path = value.strip_prefix("file:")?;
    let path = path.strip_prefix("//").map_or(path, |rest| rest.strip_prefix("localhost").unwrap_or(rest));
    Some(PathBuf::from(percent_decode_str(path).decode_utf8_lossy().into_owned()))
}

/// Whether an editable requirement is a folder.
pub(super) fn is_folder(text: &str, folder: &Path) -> bool {
    !is_url(text) && folder.join(without_extras(text)).is_dir()
}

/// What a requirement is called: its project, or the last part of a path or an address, which may hold a password
/// before.
pub(super) fn title(text: &str, local: Option<&LocalRequirement>) -> String {
    let named = project(text).map(str::to_owned);
    let file = || Some(local?.path.file_name()?.to_string_lossy().into_owned());
    let address = || text.split(['#', '?', ' ']).next().unwrap_or(text).trim_end_matches('/');
    named.or_else(file).unwrap_or_else(|| address().rsplit('/').next().unwrap_or(text).to_owned())
}

/// The project's name at a requirement's beginning, if it begins with one.
pub(super) fn project(text: &str) -> Option<&str> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let name = &text[..text.find(|c| !is_part(c)).unwrap_or(text.len())];
    let after = text[name.len()..].trim_start();
    let ends = after.is_empty() || after.starts_with(['<', '>', '=', '!', '~', '[', '(', ';', '@', ',']);
    (name.starts_with(|c: char| c.is_ascii_alphanumeric()) && ends).then_some(name)
}
