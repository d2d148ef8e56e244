//! The replays on the page of a report: which recordings are kept for it, and how a report that is made again finds them.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use hrdsl_ir::Program;
use hrdsl_runtime::{
    report::{self, PageReplays, PageSupplement},
    results::{
        CampaignResults, MutationReport, ReplayPair, ShownReplays, ShownRun, TestName, UnreplayedTest,
    },
    viewer::{
        ViewDocument,
        columns::{PoseTolerance, coarser},
        packed_assets, packed_page, packed_run,
        replay::mesh_assets,
    },
};

use super::{
    recorded::{document, keep_used},
    sources::CodeSources,
};
use crate::{fault::CommandFault, files, results_folder::REPLAYS, terminal};

/// The file of the replays that a report shows, in the folder of the recordings.
const FILE: &str = "shown.json";
/// So large a report may be, in bytes.
const LARGEST_PAGE: usize = 8 << 20;
/// So much of it a test may take, in bytes.
const LARGEST_RUN: usize = 200 << 10;
/// How far a body may be drawn from where it was in a test that is too large otherwise.
const COARSE: PoseTolerance = PoseTolerance { place: 0.005, turn: 0.01 };
/// What each pair takes besides its runs, at most: its buttons, and its line in the index.
const FOR_EACH_PAIR: usize = 2 << 10;

fn recording_of(results: &Path, test: &TestName) -> PathBuf {
    results.join(REPLAYS).join(format!("{}.mcap", test.file_stem()))
}

/// Removes the recordings of passing tests beside which no failing one is looked at.
///
/// # Errors
/// A file that cannot be removed.
pub fn keep_failing(results: &CampaignResults, folder: &Path) -> Result<(), CommandFault> {
    let beside: BTreeSet<TestName> =
        results.replay_pairs().into_iter().filter_map(|pair| pair.beside).collect();
    for test in results.tests.iter().filter(|t| t.error.is_none() && !t.has_failed()) {
        let path = recording_of(folder, &test.name);
        if !beside.contains(&test.name) && path.exists() {
            fs::remove_file(&path).map_err(|e| format!("cannot remove {}: {e}", terminal::shown(&path)))?;
        }
    }
    Ok(())
}

/// Makes the replays of a campaign's report from the recordings below its folder, with the code among the sources, and writes them there; `None` if there is nothing to replay, or
/// if they cannot be written, which is said: a report must be the same when it is made again.
#[must_use]
pub fn make(
    program: &Program,
    sources: CodeSources,
    results: &CampaignResults,
    folder: &Path,
) -> Option<ShownReplays> {
    let pairs = results.replay_pairs();
    if results.view.is_empty() || pairs.is_empty() {
        return None;
    }
    let mut table = ReplayTable { program, folder, sources, runs: BTreeMap::new() };
    let mut shown = ShownReplays::default();
    let mut room = LARGEST_PAGE.saturating_sub(report::html(results).len() + packed_page().len());
    for pair in pairs {
        table.add(&mut shown, &mut room, pair);
    }
    table.finish(&mut shown, results, room);
    let text = shown.to_json().map_err(|e| e.to_string());
    let written = text.and_then(|text| files::write(&folder.join(REPLAYS).join(FILE), &text));
    if let Err(why) = &written {
        terminal::say_line(format_args!("warning: the report is without replays: {why}"));
    }
    written.ok().map(|()| shown)
}

/// The recordings that were read for a page, each once.
struct ReplayTable<'a> {
    program: &'a Program,
    folder: &'a Path,
    sources: CodeSources,
    /// The document and its packed form, or why there is none.
    runs: BTreeMap<TestName, Result<(ViewDocument, String), String>>,
}

impl ReplayTable<'_> {
    /// Puts a pair on the page, as far as there is room for it.
    fn add(&mut self, shown: &mut ShownReplays, room: &mut usize, mut pair: ReplayPair) {
        let test = pair.test.clone();
        if !self.take(shown, room, &test) {
            return;
        }
        pair.beside = pair.beside.filter(|beside| self.take(shown, room, beside));
        *room = room.saturating_sub(FOR_EACH_PAIR);
        shown.pairs.push(pair);
    }

    /// Whether a run is on the page; if not, it says why.
    fn take(&mut self, shown: &mut ShownReplays, room: &mut usize, test: &TestName) -> bool {
        if shown.runs.iter().any(|run| run.test == *test) {
            return true;
        }
        let (program, folder, sources) = (self.program, self.folder, &mut self.sources);
        let read = self.runs.entry(test.clone()).or_insert_with(|| packed(program, folder, sources, test));
        let why = match read {
            Ok((_, data)) if data.len() <= *room => {
                *room -= data.len();
                shown.runs.push(ShownRun { test: test.clone(), data: data.clone() });
                return true;
            }
            Ok(_) => format!("there is no room for it, as the page may have {} MB", LARGEST_PAGE >> 20),
            Err(why) => why.clone(),
        };
        if shown.left_out.iter().all(|left| left.test != *test) {
            shown.left_out.push(UnreplayedTest { test: test.clone(), why });
        }
        false
    }

    /// Puts the meshes on the page that its runs show, if there is room for them; boxes stand for them otherwise.
    fn finish(&self, shown: &mut ShownReplays, results: &CampaignResults, room: usize) {
        let (mut assets, _) = mesh_assets(self.program);
        let documents = shown.runs.iter().filter_map(|run| self.runs.get(&run.test)?.as_ref().ok());
        let documents = documents.map(|(document, _)| document);
        keep_used(&mut assets, documents.clone());
        self.sources.put(&mut assets, documents);
        let packed = packed_assets(&assets);
        if packed.len() <= room {
            shown.assets = packed;
        }
        // What the campaign could not record has its reason there.
        for left in &mut shown.left_out {
            if let Some(known) = results.unreplayed.iter().find(|known| known.test == left.test) {
                left.why.clone_from(&known.why);
            }
        }
    }
}

/// The document of a test, packed; without forces of contacts and with coarser poses, if it is too large with them.
fn packed(
    program: &Program,
    folder: &Path,
    sources: &mut CodeSources,
    test: &TestName,
) -> Result<(ViewDocument, String), String> {
    let bytes =
        fs::read(recording_of(folder, test)).map_err(|e| format!("its recording cannot be read: {e}"))?;
    let mut document = document(program, bytes, sources)?;
    let mut data = packed_run(&document);
    if data.len() > LARGEST_RUN {
        document.contacts.clear();
        document.notes.push(
            "The report leaves the forces of contacts out, for which there is no room; `hrdsl view` shows them."
                .to_owned(),
        );
        data = packed_run(&document);
    }
    if data.len() > LARGEST_RUN {
        for track in &mut document.poses {
            *track = coarser(track, COARSE);
        }
        document.notes.push(
            "The report shows bodies within a centimetre of where they were, for there is no room for more; `hrdsl view` shows them closer."
                .to_owned(),
        );
        data = packed_run(&document);
    }
    if data.len() > LARGEST_RUN {
        let (size, limit) = (data.len().div_ceil(1 << 10), LARGEST_RUN >> 10);
        return Err(format!("it would take {size} KB of the {limit} KB that a test may have on this page"));
    }
    Ok((document, data))
}

/// The replays that were made for the report of these results. What cannot be read is said; the report is then without them.
#[must_use]
pub fn read(results: &Path) -> Option<ShownReplays> {
    let path = results.join(REPLAYS).join(FILE);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return None,
        Err(e) => {
            terminal::say_line(format_args!(
                "warning: the report is without replays: cannot read {}: {e}",
                terminal::shown(&path)
            ));
            return None;
        }
    };
    let shown = ShownReplays::from_json(&text);
    if let Err(why) = &shown {
        terminal::say_line(format_args!(
            "warning: the report is without replays: {}: {why}",
            terminal::shown(&path)
        ));
    }
    shown.ok()
}

/// The report as a page, with its replays and the faults that its tests would have noticed.
#[must_use]
pub fn page(
    results: &CampaignResults,
    shown: Option<&ShownReplays>,
    faults: Option<&MutationReport>,
) -> String {
    // Where nothing is shown, the viewer would be of no use.
    let viewer = shown.filter(|shown| !shown.pairs.is_empty()).map(|_| packed_page()).unwrap_or_default();
    let replays = shown.map(|shown| PageReplays { shown, viewer: &viewer });
    report::html_with(results, PageSupplement { replays: replays.as_ref(), faults })
}
