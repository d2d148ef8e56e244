//! The pages of the diagnostic codes: each code of the registry has one, whose first example gives just this code, and
//! whose second is fixed.

#![allow(clippy::disallowed_methods, reason = "the test reads the pages")]

use std::{collections::BTreeSet, fs, path::Path};

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, compile_with};
use hrdsl_source::REGISTRY;

/// The fenced blocks: what follows the fence, and the text.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(info) = line.strip_prefix("```") {
            let text: Vec<&str> = lines.by_ref().take_while(|l| !l.starts_with("```")).collect();
            blocks.push((info.to_owned(), text.join("\n")));
        }
    }
    blocks
}

/// An example with the files that it uses.
struct Example {
    info: String,
    text: String,
    files: Vec<ModuleText>,
}

impl ModuleLoader for Example {
    fn load(&self, _from: &str, path: &str) -> Result<ModuleText, String> {
        self.files.iter().find(|f| f.name == path).cloned().ok_or("there is no such file".to_owned())
    }

    fn means_a_file(&self, path: &str) -> Option<bool> {
        (!self.files.is_empty()).then(|| self.files.iter().any(|f| f.name == path))
    }
}

/// The examples: a block `hri,file=NAME` is a file that the next example uses.
fn examples(page: &str) -> Vec<Example> {
    let (mut examples, mut files) = (Vec::new(), Vec::new());
    for (info, text) in blocks(page) {
        match info.strip_prefix("hri,file=") {
            Some(name) => files.push(ModuleText { name: name.to_owned(), text }),
            None => examples.push(Example { info, text, files: std::mem::take(&mut files) }),
        }
    }
    examples
}

/// The codes of a text's diagnostics, and whether it compiles.
fn said(example: &Example) -> (BTreeSet<String>, bool) {
    let c = compile_with(InputFile { name: "page.hri", text: &example.text }, &[], example);
    (c.diagnostics.iter().map(|d| d.code.to_string()).collect(), c.program.is_some())
}

#[test]
fn every_code_has_a_page_with_an_example_that_fails_and_one_that_does_not() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/codes");
    let mut faults = Vec::new();
    for info in REGISTRY {
        let code = info.code.to_string();
        let page = fs::read_to_string(folder.join(format!("{code}.md"))).unwrap_or_default();
        assert!(
            page.starts_with(&format!("# {code}: {}\n", info.title)),
            "{code}: no page, or another title"
        );
        let examples = examples(&page);
        let [failing, fixed] = examples.as_slice() else {
            panic!("{code}: two blocks are needed, and there are {}", examples.len())
        };
        let wrong = &failing.info;
        let (codes, compiles) = said(failing);
        match wrong.split_once(',') {
            Some(("hri", rule)) if rule == format!("fails={code}") => {
                assert!(!compiles, "{code} does not fail")
            }
            // What is said of which place, `warns=HR0604="…"`, is held by the test of the specification.
            Some(("hri", rule))
                if rule.split_once("=\"").map_or(rule, |(rule, _)| rule) == format!("warns={code}") =>
            {
                assert!(compiles, "{code} fails");
            }
            _ => panic!("{code}: the fence `{wrong}` means nothing"),
        }
        assert_eq!(fixed.info, "hri");
        if codes != BTreeSet::from([code.clone()]) {
            faults.push(format!("{code}: the failing example gives {codes:?}"));
        }
        let (codes, compiles) = said(fixed);
        if !codes.is_empty() || !compiles {
            faults.push(format!("{code}: the fixed example gives {codes:?}"));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    let pages = fs::read_dir(&folder).unwrap().count();
    assert_eq!(pages, REGISTRY.len(), "pages without a code");
}
