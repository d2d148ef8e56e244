//! Recordings as runs of a page: what `view` makes pages of, and `sim` puts on the report.

use std::{fs, path::Path};

use hrdsl_ir::Program;
use hrdsl_runtime::{
    recording::{self, RecordingFile},
    viewer::{
        RunGroup, SharedAssets, ViewDocument, ViewedRun, document::ViewShape, replay::replay,
        requirement::ViewVerdict,
    },
};

use super::sources::CodeSources;
use crate::{fault::CommandFault, terminal};

/// A recording with its place on a page.
///
/// # Errors
/// A file that cannot be read, or is no recording of the scenario.
pub fn viewed(program: &Program, path: &Path, sources: &mut CodeSources) -> Result<ViewedRun, CommandFault> {
    let shown = terminal::shown(path);
    let bytes = fs::read(path).map_err(|e| format!("cannot read {shown}: {e}"))?;
    let document = document(program, bytes, sources).map_err(|why| format!("{shown}: {why}"))?;
    let stem = || path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let id = document.test.clone().unwrap_or_else(stem);
    let requirement = first_violated(&document);
    let group = if requirement.is_some() { RunGroup::Failure } else { RunGroup::Other };
    Ok(ViewedRun { label: id.clone(), id, group, requirement, beside: None, document })
}

/// The document of a recording, of either form.
///
/// # Errors
/// Bytes that are no recording of the scenario.
pub fn document(
    program: &Program,
    bytes: Vec<u8>,
    sources: &mut CodeSources,
) -> Result<ViewDocument, CommandFault> {
    let mut document = replay(program, &opened(bytes)?, sources.units())?;
    sources.take(&mut document);
    Ok(document)
}

/// A recording, of either form.
fn opened(bytes: Vec<u8>) -> Result<RecordingFile, CommandFault> {
    if recording::is_mcap(&bytes) {
        return recording::read(&bytes).map_err(|e| e.to_string());
    }
    let text = String::from_utf8(bytes).map_err(|_| "it is neither MCAP nor UTF-8 text")?;
    Ok(RecordingFile { text, ..RecordingFile::default() })
}

/// A recording in the form that other tools play.
///
/// # Errors
/// A file that cannot be read, or is no whole recording of the scenario with a picture.
pub fn exported(program: &Program, path: &Path) -> Result<Vec<u8>, CommandFault> {
    let shown = terminal::shown(path);
    let bytes = fs::read(path).map_err(|e| format!("cannot read {shown}: {e}"))?;
    opened(bytes).and_then(|file| recording::export(program, &file)).map_err(|why| format!("{shown}: {why}"))
}

/// The requirement that was violated first.
fn first_violated(document: &ViewDocument) -> Option<String> {
    let failed = document.requirements.iter().filter(|r| r.verdict == ViewVerdict::Fail);
    let first = failed.min_by_key(|r| r.violations.first().map_or(u64::MAX, |violation| violation.t));
    first.map(|requirement| requirement.id.clone())
}

/// Only those meshes that some run shows.
pub fn keep_used<'d>(assets: &mut SharedAssets, runs: impl IntoIterator<Item = &'d ViewDocument>) {
    let shapes = runs.into_iter().flat_map(|run| &run.scene.bodies).flat_map(|body| &body.shapes);
    let used: Vec<&String> = shapes
        .filter_map(|shape| match shape {
            ViewShape::Mesh { mesh, .. } => Some(mesh),
            ViewShape::Box { .. }
            | ViewShape::Sphere { .. }
            | ViewShape::Cylinder { .. }
            | ViewShape::Capsule { .. } => None,
        })
        .collect();
    assets.meshes.retain(|digest, _| used.contains(&digest));
}
