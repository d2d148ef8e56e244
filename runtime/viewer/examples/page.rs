//! Prints a page of documents that files hold, the first two side by side: `cargo run -p hrdsl-viewer --example page -- a.json b.json > page.html`.
#![expect(clippy::disallowed_methods, reason = "an example reads files")]

use std::{env, error::Error, fs, io::Write};

use hrdsl_viewer::{PageOpening, RunGroup, SharedAssets, ViewedRun, page};

fn main() -> Result<(), Box<dyn Error>> {
    let read = |path: String| -> Result<ViewedRun, Box<dyn Error>> {
        let document = serde_json::from_slice(&fs::read(&path)?)?;
        let label = path.rsplit('/').next().unwrap_or(&path).to_owned();
        Ok(ViewedRun { id: path, label, group: RunGroup::Version, requirement: None, beside: None, document })
    };
    let runs = env::args().skip(1).map(read).collect::<Result<Vec<_>, _>>()?;
    let opening = PageOpening { run: None, beside: runs.get(1).map(|run| run.id.clone()) };
    let html = page("Documents", &runs, &SharedAssets::default(), &opening);
    std::io::stdout().write_all(html.as_bytes())?;
    Ok(())
}
