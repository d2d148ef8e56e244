//! Running the real binary.
#![allow(dead_code, reason = "each test binary uses its own part")]
#![allow(clippy::disallowed_methods, reason = "tests start the binary")]

pub mod uppaal;

use std::{
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

pub fn handover() -> PathBuf {
    root().join("examples/handover/scenario.hri")
}

pub fn hrdsl<I: AsRef<std::ffi::OsStr>>(args: impl IntoIterator<Item = I>) -> Output {
    command().args(args).output().unwrap()
}

/// In a folder, with the arguments of a line.
pub fn hrdsl_in(folder: &Path, line: &str) -> Output {
    command().args(line.split_whitespace()).current_dir(folder).output().unwrap()
}

/// The same, with this text on standard input.
pub fn hrdsl_reading(folder: &Path, line: &str, input: &str) -> Output {
    let mut command = command();
    command.args(line.split_whitespace()).current_dir(folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

/// The binary, without colours and with the cache of the tests.
pub fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hrdsl"));
    command
        .env("NO_COLOR", "1")
        .env_remove("CLICOLOR_FORCE")
        .env("HRDSL_CACHE", root().join("target/hrdsl-cache"));
    command
}

/// A folder with these files.
pub fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// A scenario with one stimulus of this name.
pub fn scenario(name: &str, stimulus: &str) -> String {
    format!(
        "scenario {name}\n\nactor guest : environment\nactor robot : system\n\nevent called from guest to robot\n\nstimulus {stimulus} by guest {{ emit called }}\n"
    )
}

pub fn stdout(out: &Output) -> String {
    String::from_utf8(out.stdout.clone()).unwrap()
}

pub fn stderr(out: &Output) -> String {
    String::from_utf8(out.stderr.clone()).unwrap()
}

/// Fails with everything that was printed.
pub fn expect_code(out: &Output, code: i32) {
    assert_eq!(out.status.code(), Some(code), "stdout:\n{}\nstderr:\n{}", stdout(out), stderr(out));
}

/// All files below a folder, by relative path.
pub fn tree(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let mut out = std::collections::BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                out.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    out
}

/// The elements of a page as Chromium has them when this sign is among them, or at the end of its patience; `None` if there is no Chromium.
pub fn shown_by_chromium(address: &str, sign: &str) -> Option<String> {
    let places = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    let browser = places.into_iter().find(|place| Path::new(place).exists())?;
    let mut shown = String::new();
    // Its own time passes while threads unpack what the page carries: on a busy machine it ends before they are done.
    for budget in [20_000, 60_000, 120_000, 240_000] {
        let mut command = Command::new(browser);
        command.args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]);
        // That time passes in all frames of a page only if they are of one process.
        command.args(["--disable-dev-shm-usage", "--disable-features=IsolateSandboxedIframes", "--dump-dom"]);
        let output = command.arg(format!("--virtual-time-budget={budget}")).arg(address).output().unwrap();
        shown = String::from_utf8_lossy(&output.stdout).into_owned();
        if shown.contains(sign) {
            break;
        }
    }
    Some(shown)
}
