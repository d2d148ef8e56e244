//! Files and streams: text that is read, text that is written.

use std::{
    fs,
    io::{Read, Write},
    path::{Path, PathBuf},
};

use crate::{fault::CommandFault, terminal};

/// What is longer is none of hrdsl's own files, in bytes.
const LONGEST: u64 = 4 << 30;

/// Reads a scenario, or tests.
///
/// # Errors
/// The file's name and what is wrong with it: that it cannot be read, or is of another kind, by the ending of its name; then also what to do with it.
pub fn read_scenario(path: &Path) -> Result<String, CommandFault> {
    if !path.exists() {
        return read(path);
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let (kind, instead) = match ending.to_ascii_lowercase().as_str() {
        "urdf" | "xacro" => {
            ("describes a robot", "a scenario's world takes it in: `part NAME from \"FILE\" { … }`")
        }
        "srdf" => (
            "says what a robot's groups are",
            "it goes with the description: `semantics \"FILE\"` in the part that is made from it",
        ),
        "asl" | "mas2j" => {
            ("is of Jason", "`hrdsl import agentspeak FILE` makes a scenario of it, `hrdsl run FILE` runs it")
        }
        "xml" | "xta" => ("is no scenario", "`hrdsl import uppaal FILE` makes one of a model of UPPAAL"),
        "mcap" | "jsonl" => {
            ("is a recording", "`hrdsl judge SCENARIO FILE` judges it, `hrdsl view SCENARIO FILE` shows it")
        }
        "py" => ("is a program", "a scenario names it: `system ROBOT { run \"python3 FILE\" }`"),
        _ => return read(path),
    };
    let file = terminal::shown(path);
    Err(format!("{file} {kind}; {}", instead.replace("FILE", &file)))
}

/// Reads a text file of which a compiler takes no more than a scenario may have.
///
/// # Errors
/// The file's name and what is wrong with it.
pub fn read(path: &Path) -> Result<String, CommandFault> {
    // One byte more than the compiler takes, so that it says that the file is too large; what never ends is not read on.
    read_up_to(path, hrdsl_compiler::MAX_BYTES as u64 + 1)
}

/// Reads a text file that no compiler reads, such as results and recordings, however long it is.
///
/// # Errors
/// The same, and that it has more than [`LONGEST`] bytes.
pub fn read_whole(path: &Path) -> Result<String, CommandFault> {
    let text = read_up_to(path, LONGEST + 1)?;
    if text.len() as u64 > LONGEST {
        return Err(format!("{} has more than {} GB", terminal::shown(path), LONGEST >> 30));
    }
    Ok(text)
}

fn read_up_to(path: &Path, most: u64) -> Result<String, CommandFault> {
    let fault = |e: std::io::Error| {
        if e.kind() == std::io::ErrorKind::NotFound {
            format!("no such file: {}", terminal::shown(path))
        } else {
            format!("cannot read {}: {e}", terminal::shown(path))
        }
    };
    let mut bytes = Vec::new();
    fs::File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).map_err(fault)?;
    text(bytes, &terminal::shown(path))
}

/// Reads all of stdin.
///
/// # Errors
/// What is wrong with it.
pub fn read_stdin() -> Result<String, CommandFault> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|e| format!("cannot read standard input: {e}"))?;
    text(bytes, "standard input")
}

fn text(bytes: Vec<u8>, name: &str) -> Result<String, CommandFault> {
    String::from_utf8(bytes)
        .map_err(|e| format!("{name} is not UTF-8 text (byte {})", e.utf8_error().valid_up_to()))
}

/// Writes a file, and the folders above it.
///
/// # Errors
/// The file's name and what is wrong.
pub fn write(path: &Path, text: &str) -> Result<(), CommandFault> {
    write_bytes(path, text.as_bytes())
}

/// The same of a file that is not text.
///
/// # Errors
/// The same.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), CommandFault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", terminal::shown(path));
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fault)?;
    }
    fs::write(path, bytes).map_err(fault)
}

/// Puts another text in a file's place, all of it or nothing: it is written beside the file, and renamed.
///
/// # Errors
/// The file's name and what is wrong.
pub fn replace(path: &Path, text: &str) -> Result<(), CommandFault> {
    let fault = |e: std::io::Error| format!("cannot write {}: {e}", terminal::shown(path));
    // Of a link, what it leads to is replaced.
    let target = path.canonicalize().map_err(fault)?;
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let beside = target.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
    let written = (|| {
        let mut file = fs::File::create_new(&beside)?;
        file.write_all(text.as_bytes())?;
        file.set_permissions(fs::metadata(&target)?.permissions())?;
        file.sync_all()?;
        fs::rename(&beside, &target)
    })();
    written.map_err(|e| {
        // What is left of the attempt is of no use; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&beside);
        fault(e)
    })
}

/// A document as JSON, for people to read and machines to parse.
///
/// # Errors
/// A number that JSON cannot hold.
pub fn json(document: &impl serde::Serialize) -> Result<String, CommandFault> {
    serde_json::to_string_pretty(document).map(|text| text + "\n").map_err(|e| format!("cannot print: {e}"))
}

/// A path as it is seen from a folder.
#[must_use]
pub fn relative(path: &Path, from: &Path) -> PathBuf {
    let (Ok(path), Ok(from)) = (path.canonicalize(), from.canonicalize()) else { return path.to_owned() };
    let common = path.components().zip(from.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(common).map(|_| std::path::Component::ParentDir);
    up.chain(path.components().skip(common)).collect()
}

/// The folder of a scenario, where its robot code is.
#[must_use]
pub fn folder(scenario: &Path) -> PathBuf {
    match scenario.parent() {
        Some(folder) if folder.as_os_str().is_empty() => PathBuf::from("."),
        Some(folder) => folder.to_owned(),
        None => PathBuf::from("."),
    }
}
