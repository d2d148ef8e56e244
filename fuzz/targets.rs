//! What holds for every input: the bodies of the fuzz targets. `compiler/tests/corpus.rs` replays the corpus through them.

use hrdsl_compiler::{InputFile, ModuleLoader, ModuleText, compile_with};
use hrdsl_source::{Diagnostic, FileId};

/// Divides the input of [`checker`]: scenario, the module that it uses as a file, its tests.
pub const SEPARATOR: &str = "\n//====\n";

/// Takes one input; panics if something does not hold.
pub type Target = fn(&[u8]);

/// By the names of the targets.
pub const TARGETS: &[(&str, Target)] =
    &[("lexer", lexer), ("parser", parser), ("checker", checker), ("formatter", formatter)];

/// Tokens lie in the text, one after the other.
pub fn lexer(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let (tokens, diagnostics) = hrdsl_syntax::lex_only(&text);
    let mut last = 0;
    for token in tokens {
        assert!(last <= token.start && token.start < token.end, "token at {token:?} after {last}");
        assert!(text.get(token.clone()).is_some(), "token at {token:?}");
        last = token.end;
    }
    within(&diagnostics, |_| Some(&text));
}

/// Every text gives a tree, and diagnostics whose places and fixes lie in it.
pub fn parser(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let (file, diagnostics) = hrdsl_syntax::parse(FileId(0), &text);
    for item in &file.items {
        assert!(text.get(item.span.range()).is_some(), "item at {:?}", item.span);
    }
    within(&diagnostics, |_| Some(&text));
}

/// The whole compiler: there is a program if and only if there are no errors.
pub fn checker(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let mut files = text.splitn(3, SEPARATOR);
    let scenario = InputFile { name: "scenario.hri", text: files.next().unwrap_or_default() };
    let module = OneModule(files.next().unwrap_or_default());
    let tests: Vec<InputFile<'_>> = files.map(|text| InputFile { name: "tests.hri", text }).collect();
    let c = compile_with(scenario, &tests, &module);
    assert_eq!(c.program.is_none(), c.has_errors());
    within(&c.diagnostics, |file| c.files.get(file).map(|f| f.text.as_str()));
}

/// What can be formatted keeps its tokens but for separators, and stays as it is when it is formatted again.
pub fn formatter(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let Ok(once) = hrdsl_syntax::format(&text) else { return };
    assert_eq!(words(&text), words(&once));
    assert_eq!(hrdsl_syntax::format(&once).as_ref(), Ok(&once));
}

/// The tokens of a text without the separators, which the formatter may set and take away, as it may the blank of `5 s`.
fn words(text: &str) -> Vec<String> {
    let (tokens, _) = hrdsl_syntax::lex_only(text);
    let words = tokens.into_iter().map(|t| &text[t]).filter(|t| !matches!(*t, ";" | ","));
    let word = |w: &str| if w.starts_with('"') { w.to_owned() } else { w.split_whitespace().collect() };
    words.map(word).collect()
}

/// Whatever file is used, it is this one.
struct OneModule<'a>(&'a str);

impl ModuleLoader for OneModule<'_> {
    fn load(&self, _from: &str, _path: &str) -> Result<ModuleText, String> {
        Ok(ModuleText { name: "module.hri".to_owned(), text: self.0.to_owned() })
    }
}

/// All places that diagnostics name lie in their files, between characters.
fn within<'t>(diagnostics: &[Diagnostic], text: impl Fn(FileId) -> Option<&'t str>) {
    for d in diagnostics {
        assert!(!d.message.is_empty(), "{d:?}");
        let edits = d.fixes.iter().flat_map(|f| &f.edits).map(|e| e.span);
        for span in d.labels.iter().map(|l| l.span).chain(edits) {
            assert!(text(span.file).is_some_and(|t| t.get(span.range()).is_some()), "{span:?} of {d:?}");
        }
    }
}
