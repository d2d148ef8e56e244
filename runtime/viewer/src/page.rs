//! The page: the template of the viewer, filled with the data of runs.

use std::io::Write;

use flate2::{Compression, write::DeflateEncoder};
use serde::Serialize;

use crate::{
    document::{SharedAssets, ViewDocument, ViewEnd},
    requirement::ViewVerdict,
};

/// What the build of `viewer/` makes: all of the page but the data.
const TEMPLATE: &str = include_str!(concat!(env!("OUT_DIR"), "/viewer.html"));
/// Where in the template the title belongs.
const TITLE: &str = "<!--hrdsl:title-->";
/// Where in the template the data belong.
const DATA: &str = "<!--hrdsl:data-->";

/// In which list of the page a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RunGroup {
    /// A test with a violation.
    Failure,
    /// A test that passes, and is like one that fails.
    Passing,
    /// Another version of a test, such as the one before a change.
    Version,
    #[default]
    Other,
}

/// A run with its place on a page.
#[derive(Clone, Debug)]
pub struct ViewedRun {
    /// What the address of the page calls it, such as the name of its test; each is there once.
    pub id: String,
    /// What people read.
    pub label: String,
    pub group: RunGroup,
    /// The requirement for whose sake it is on the page: the page opens at its first violation.
    pub requirement: Option<String>,
    /// The run with which it is compared if somebody asks for it.
    pub beside: Option<String>,
    pub document: ViewDocument,
}

/// What a page shows first.
#[derive(Clone, Debug, Default)]
pub struct PageOpening {
    /// The run; without it, the first.
    pub run: Option<String>,
    /// The one beside it: the two are compared.
    pub beside: Option<String>,
}

#[derive(Serialize)]
struct PageIndex<'a> {
    format: &'static str,
    version: u32,
    title: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    open: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    compare: Option<&'a str>,
    runs: Vec<IndexedRun<'a>>,
}

#[derive(Serialize)]
struct IndexedRun<'a> {
    id: &'a str,
    label: &'a str,
    group: RunGroup,
    #[serde(skip_serializing_if = "Option::is_none")]
    requirement: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    beside: Option<&'a str>,
    ended: ViewEnd,
    verdicts: Vec<(&'a str, ViewVerdict)>,
}

/// A page that replays these runs: one file that needs nothing else.
///
/// Each run is packed by itself, and is unpacked by the browser when somebody looks at it; `shared` is packed once for all of them.
///
/// ```
/// use hrdsl_viewer::{PageOpening, RunGroup, SharedAssets, ViewDocument, ViewedRun, page};
///
/// let document = ViewDocument { scenario: "cup".into(), tick: 1_000_000, end: 5_000, ..ViewDocument::new() };
/// let run = ViewedRun {
///     id: "tests.t001".into(),
///     label: "tests.t001".into(),
///     group: RunGroup::Failure,
///     requirement: Some("R1".into()),
///     beside: None,
///     document,
/// };
/// let html = page("cup", &[run], &SharedAssets::default(), &PageOpening::default());
/// assert!(html.starts_with("<!doctype html>"));
/// ```
#[must_use]
pub fn page(title: &str, runs: &[ViewedRun], shared: &SharedAssets, opening: &PageOpening) -> String {
    let index = PageIndex {
        format: "hrdsl-view-page",
        version: 1,
        title,
        open: opening.run.as_deref(),
        compare: opening.beside.as_deref(),
        runs: runs.iter().map(indexed).collect(),
    };
    let mut data = element("index", "application/json", &json(&index));
    let assets = packed_assets(shared);
    if !assets.is_empty() {
        data += &element("assets", "text/plain", &assets);
    }
    for (place, run) in runs.iter().enumerate() {
        data += &element(&format!("run-{place}"), "text/plain", &packed(&run.document));
    }
    filled(&escaped(title), &data)
}

/// A run as pages have it: JSON, compressed (raw deflate) and in base64.
#[must_use]
pub fn packed_run(document: &ViewDocument) -> String {
    packed(document)
}

/// What runs share as pages have it, in the same form; empty if they share nothing.
#[must_use]
pub fn packed_assets(shared: &SharedAssets) -> String {
    if *shared == SharedAssets::default() { String::new() } else { packed(shared) }
}

/// The page without its runs, for other pages that carry runs and open the viewer on demand: a list of three texts, between which the title and
/// the data belong, in the same form.
#[must_use]
pub fn packed_page() -> String {
    packed(&pieces())
}

/// The template before its title, between title and data, and after them.
fn pieces() -> [&'static str; 3] {
    let (before, rest) = TEMPLATE.split_once(TITLE).unwrap_or((TEMPLATE, ""));
    let (between, after) = rest.split_once(DATA).unwrap_or((rest, ""));
    [before, between, after]
}

fn indexed(run: &ViewedRun) -> IndexedRun<'_> {
    IndexedRun {
        id: &run.id,
        label: &run.label,
        group: run.group,
        requirement: run.requirement.as_deref(),
        beside: run.beside.as_deref(),
        ended: run.document.ended,
        verdicts: run.document.requirements.iter().map(|r| (r.id.as_str(), r.verdict)).collect(),
    }
}

/// The template with its two marks replaced. What is put in is not looked through for marks.
fn filled(title: &str, data: &str) -> String {
    let [before, between, after] = pieces();
    [before, title, between, data, after].concat()
}

fn element(id: &str, kind: &str, text: &str) -> String {
    format!("<script type=\"{kind}\" id=\"hrdsl-{id}\">{text}</script>\n")
}

/// JSON in which nothing ends or begins an element.
fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default().replace('<', "\\u003c")
}

/// JSON, compressed (raw deflate) and in base64.
fn packed(value: &impl Serialize) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    // Neither can fail: the types have no maps with keys that are no strings, and memory takes all that is written.
    let text = serde_json::to_vec(value).unwrap_or_default();
    let written = encoder.write_all(&text).and_then(|()| encoder.finish());
    base64(&written.unwrap_or_default())
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digit = |bits: u32| DIGITS.get((bits & 63) as usize).map_or('A', |d| char::from(*d));
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |place: usize| u32::from(chunk.get(place).copied().unwrap_or_default());
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            text.push(if place <= chunk.len() { digit(bits >> (18 - 6 * place)) } else { '=' });
        }
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(id: &str) -> ViewedRun {
        ViewedRun {
            id: id.to_owned(),
            label: id.to_owned(),
            group: RunGroup::Other,
            requirement: None,
            beside: None,
            document: ViewDocument { scenario: "s".to_owned(), ..ViewDocument::new() },
        }
    }

    #[test]
    fn the_template_has_its_marks_once() {
        for mark in [TITLE, DATA] {
            assert_eq!(TEMPLATE.matches(mark).count(), 1, "{mark}");
        }
        assert!(TEMPLATE.find(TITLE) < TEMPLATE.find(DATA));
        assert!(TEMPLATE.len() < 2 * 1024 * 1024, "{} bytes", TEMPLATE.len());
    }

    #[test]
    fn the_template_fetches_nothing() {
        for tag in ["<link rel=\"stylesheet\"", "<script src", "<img src=\"http", "@import"] {
            assert!(!TEMPLATE.contains(tag), "{tag}");
        }
        assert!(TEMPLATE.contains("default-src 'none'"));
    }

    #[test]
    fn whatever_a_name_says_it_stays_text() {
        let evil = "</script><script>alert(1)</script><!--hrdsl:data-->";
        let html = page(evil, &[run(evil)], &SharedAssets::default(), &PageOpening::default());
        let count = |text: &str, what: &str| text.matches(what).count();
        assert_eq!(count(&html, "alert(1)</script>"), 0);
        // One for the index, one for the run.
        assert_eq!(count(&html, "</script>"), count(TEMPLATE, "</script>") + 2);
        assert!(html.contains("&lt;/script&gt;&lt;script&gt;alert(1)"));
    }

    #[test]
    fn a_run_is_packed_as_browsers_unpack_it() {
        let html = page("t", &[run("a")], &SharedAssets::default(), &PageOpening::default());
        let (_, rest) = html.split_once("id=\"hrdsl-run-0\">").unwrap();
        let (text, _) = rest.split_once("</script>").unwrap();
        let bytes = decoded(text);
        let mut unpacked = String::new();
        std::io::Read::read_to_string(&mut flate2::read::DeflateDecoder::new(&bytes[..]), &mut unpacked)
            .unwrap();
        let read: ViewDocument = serde_json::from_str(&unpacked).unwrap();
        assert_eq!(read, run("a").document);
    }

    #[test]
    fn the_parts_put_together_are_the_page() {
        let document = run("a").document;
        let html = page("t", &[run("a")], &SharedAssets::default(), &PageOpening::default());
        assert!(html.contains(&format!("id=\"hrdsl-run-0\">{}</script>", packed_run(&document))));
        assert_eq!(packed_assets(&SharedAssets::default()), "");
        let mut unpacked = String::new();
        let bytes = decoded(&packed_page());
        std::io::Read::read_to_string(&mut flate2::read::DeflateDecoder::new(&bytes[..]), &mut unpacked)
            .unwrap();
        let pieces: Vec<String> = serde_json::from_str(&unpacked).unwrap();
        assert_eq!(pieces.len(), 3);
        assert!(html.starts_with(&format!("{}t{}", pieces[0], pieces[1])) && html.ends_with(&pieces[2]));
    }

    fn decoded(text: &str) -> Vec<u8> {
        let value = |c: char| match c {
            'A'..='Z' => c as u32 - 'A' as u32,
            'a'..='z' => c as u32 - 'a' as u32 + 26,
            '0'..='9' => c as u32 - '0' as u32 + 52,
            '+' => 62,
            _ => 63,
        };
        let text: Vec<char> = text.trim_end_matches('=').chars().collect();
        let mut bytes = Vec::new();
        for chunk in text.chunks(4) {
            let bits = chunk.iter().enumerate().fold(0, |bits, (i, c)| bits | value(*c) << (18 - 6 * i));
            bytes.extend_from_slice(&bits.to_be_bytes()[1..chunk.len()]);
        }
        bytes
    }

    #[test]
    fn base64_is_as_in_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
            assert_eq!(decoded(text), bytes.as_bytes());
        }
    }
}
