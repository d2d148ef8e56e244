//! Lists the pages of `spec/codes/`, so that they are embedded.
#![allow(clippy::disallowed_methods, reason = "a build script reads and writes files")]

use std::{env, fmt::Write, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../spec/codes").canonicalize()?;
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut pages: Vec<(u16, PathBuf)> = Vec::new();
    for entry in fs::read_dir(&folder)? {
        let path = entry?.path();
        let name = path.file_stem().and_then(|n| n.to_str()).unwrap_or_default();
        if let Some(number) = name.strip_prefix("HR").and_then(|n| n.parse().ok()) {
            pages.push((number, path));
        }
    }
    pages.sort();
    let mut list = "&[\n".to_owned();
    for (number, path) in &pages {
        writeln!(list, "    ({number}, include_str!({:?})),", path.display().to_string())?;
    }
    list += "]\n";
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("pages.rs"), list)?;
    Ok(())
}
