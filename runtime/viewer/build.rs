//! Bundles the page of the viewer: `viewer/` at the top of the project becomes one file, `viewer.html`, in the folder of the build.
//!
//! The sources are copied there first, so that nothing is written beside them. `HRDSL_VIEWER_TEMPLATE` names a file that was bundled elsewhere,
//! for machines without Node.
#![expect(
    clippy::disallowed_methods,
    reason = "a build script reads and writes files, and starts the bundler"
)]

use std::{
    env,
    error::Error,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// What the bundle is made from; tests and samples are not.
const SOURCES: [&str; 5] = ["package.json", "package-lock.json", "build.mjs", "page.html", "src"];

const ELSEWHERE: &str = "HRDSL_VIEWER_TEMPLATE";

fn main() {
    let Err(error) = bundle() else { return };
    // One by one: what npm says has many lines.
    for line in error.to_string().lines() {
        println!("cargo::error={line}");
    }
}

fn bundle() -> Outcome<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={ELSEWHERE}");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let bundle = out.join("viewer.html");
    if let Some(made) = env::var_os(ELSEWHERE).filter(|made| !made.is_empty()) {
        println!("cargo::rerun-if-changed={}", made.display());
        fs::copy(&made, &bundle).map_err(|e| format!("{ELSEWHERE}={}: {e}", made.display()))?;
        return Ok(());
    }
    let sources = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../viewer");
    let copy = out.join("viewer");
    fs::create_dir_all(&copy)?;
    for name in SOURCES {
        let source = sources.join(name);
        println!("cargo::rerun-if-changed={}", source.display());
        if !source.exists() {
            return Err(format!("{} is not there: {}", source.display(), instead()).into());
        }
        // A file that is gone must not stay in the copy.
        let _ = fs::remove_dir_all(copy.join(name));
        copy_all(&source, &copy.join(name))?;
    }
    install(&copy)?;
    run("node", &["build.mjs", "--out", &bundle.to_string_lossy()], &copy)?;
    Ok(())
}

fn copy_all(from: &Path, to: &Path) -> Outcome<()> {
    if !from.is_dir() {
        // By content: a copy of a file that may not be written to may be written to.
        fs::write(to, fs::read(from)?)?;
        return Ok(());
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        copy_all(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

/// Fetches the packages of the lock file, or takes them from npm's cache; does nothing if they are there from the build before.
fn install(copy: &Path) -> Outcome<()> {
    let (lock, installed) = (fs::read(copy.join("package-lock.json"))?, copy.join("installed-lock.json"));
    if fs::read(&installed).is_ok_and(|before| before == lock) && copy.join("node_modules").is_dir() {
        return Ok(());
    }
    let arguments = ["ci", "--omit=dev", "--prefer-offline", "--ignore-scripts", "--no-audit", "--no-fund"];
    run("npm", &arguments, copy)?;
    fs::write(installed, lock)?;
    Ok(())
}

fn run(program: &str, arguments: &[&str], folder: &Path) -> Outcome<()> {
    let mut command = Command::new(program);
    command.args(arguments.iter().map(OsStr::new)).current_dir(folder).stdin(Stdio::null());
    let output = command.output().map_err(|e| {
        format!(
            "the viewer's page is bundled with Node 20 or newer, and `{program}` cannot be started: {e}. Install Node.js with npm, or {}",
            instead()
        )
    })?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    let shown = String::from_utf8_lossy(&said);
    Err(format!(
        "`{program} {}` failed while the viewer's page was bundled ({}):\n{shown}\nWithout a network, npm needs its cache; or {}",
        arguments.join(" "),
        output.status,
        instead()
    )
    .into())
}

fn instead() -> String {
    format!("let {ELSEWHERE} name a viewer.html that `npm run build` made in `viewer/` on another machine")
}
