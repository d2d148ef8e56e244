//! Embeds the SDK and the client libraries of ROS: every file of Python below `sdk/python`, but for tests and benchmarks.

use std::{env, error::Error, fmt::Write as _, fs, path::Path};

/// The folders that programs under test can search.
const FOLDERS: [&str; 3] = ["hrdsl", "ros1", "ros2"];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../sdk/python");
    let mut files = Vec::new();
    for folder in FOLDERS {
        println!("cargo::rerun-if-changed={}", root.join(folder).display());
        collect(&root, folder, &mut files)?;
    }
    files.sort();
    let mut text =
        String::from("/// By their paths below the folder of the SDK.\nconst SDK: &[(&str, &str)] = &[\n");
    for file in files {
        writeln!(text, "    ({file:?}, include_str!({:?})),", root.join(&file).display().to_string())?;
    }
    text.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR")?).join("sdk.rs"), text)?;
    Ok(())
}

fn collect(root: &Path, folder: &str, files: &mut Vec<String>) -> Result<(), Box<dyn Error>> {
    let Ok(entries) = fs::read_dir(root.join(folder)) else { return Ok(()) };
    for entry in entries {
        let entry = entry?;
        let name =
            entry.file_name().into_string().map_err(|name| format!("{name:?} is no name for a module"))?;
        let path = format!("{folder}/{name}");
        if entry.file_type()?.is_dir() {
            collect(root, &path, files)?;
        } else if name.ends_with(".py") {
            files.push(path);
        }
    }
    Ok(())
}
