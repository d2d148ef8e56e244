//! Blocks in the language: each compiles, or fails or warns as its fence says.
//!
//! | fence | the block is |
//! |---|---|
//! | `hri` | a scenario of its own |
//! | `hri,run` | the same, of which the log follows: see `conformance.rs` |
//! | `hri,then` | a part of the page's scenario: all of them together compile without a warning |
//! | `hri,item` | declarations, which are put after the standard scenario of `spec/README.md` |
//! | `hri,standard` | that scenario |
//! | `hri,file=NAME` | a module, or another file, that the next block uses |
//! | `hri,piece` | a part of a scenario that another test puts together: that of the standard library |
//!
//! After it may stand `fails=HRnnnn` or `warns=HRnnnn`, each perhaps with `="text"`: the text at the place of the fault.

use hrdsl_compiler::{CompilationResult, InputFile, ModuleLoader, ModuleText, compile_with};

use crate::fixing;
use crate::page::{Block, read, split};

/// What a fence says.
#[derive(Default)]
struct Rule {
    form: Form,
    file: Option<String>,
    /// The code, whether it is an error's, and the text at its place.
    expect: Option<(String, bool, Option<String>)>,
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Form {
    #[default]
    Whole,
    Then,
    Item,
    Standard,
    Piece,
}

fn rule(info: &str) -> Result<Rule, String> {
    let mut rule = Rule::default();
    // The text may contain commas: it is the last.
    let (head, text) = info.split_once("=\"").map_or((info, None), |(h, t)| (h, Some(t)));
    let text = match text.map(|t| t.strip_suffix('"').ok_or("the text has no end")) {
        Some(text) => Some(text?.to_owned()),
        None => None,
    };
    for word in head.split(',').skip(1) {
        match word.split_once('=') {
            None if word == "run" => rule.form = Form::Whole,
            None if word == "then" => rule.form = Form::Then,
            None if word == "item" => rule.form = Form::Item,
            None if word == "standard" => rule.form = Form::Standard,
            None if word == "piece" => rule.form = Form::Piece,
            Some(("file", name)) => rule.file = Some(name.to_owned()),
            Some((kind @ ("fails" | "warns"), code)) => {
                rule.expect = Some((code.to_owned(), kind == "fails", text.clone()));
            }
            Some(_) | None => return Err(format!("`{word}` means nothing in a fence")),
        }
    }
    Ok(rule)
}

struct Modules(Vec<ModuleText>);

impl ModuleLoader for Modules {
    fn load(&self, _from: &str, path: &str) -> Result<ModuleText, String> {
        self.0.iter().find(|f| f.name == path).cloned().ok_or("there is no such file".to_owned())
    }

    /// A page that shows no files says nothing about which there are.
    fn means_a_file(&self, path: &str) -> Option<bool> {
        (!self.0.is_empty()).then(|| self.0.iter().any(|f| f.name == path))
    }
}

/// The scenario that `hri,item` continues.
fn standard() -> String {
    let page = read("spec/README.md");
    let block = split(&page).0.into_iter().find(|b| b.info == "hri,standard");
    block.expect("spec/README.md has a block `hri,standard`").text
}

/// What is wrong with the blocks of a page, each with its place, and how many were compiled.
pub fn faults(page: &str, blocks: &[Block]) -> (Vec<String>, usize) {
    let (mut faults, mut compiled) = (Vec::new(), 0);
    let (mut files, mut grown) = (Vec::new(), String::new());
    for block in blocks.iter().filter(|b| b.info.split(',').next() == Some("hri")) {
        let name = format!("{page}:{}", block.line);
        let rule = match rule(&block.info) {
            Ok(rule) => rule,
            Err(why) => {
                faults.push(format!("{name}: {why}"));
                continue;
            }
        };
        if let Some(file) = rule.file {
            files.push(ModuleText { name: file, text: block.text.clone() });
            continue;
        }
        let text = match rule.form {
            Form::Piece => continue,
            Form::Whole | Form::Standard => block.text.clone(),
            Form::Item => format!("{}{}", standard(), block.text),
            Form::Then => {
                // So that places are those of the page.
                grown += &"\n".repeat(block.line.saturating_sub(grown.lines().count()));
                grown += &block.text;
                compiled += 1;
                continue;
            }
        };
        let modules = Modules(std::mem::take(&mut files));
        let compilation = compile_with(InputFile { name: &name, text: &text }, &[], &modules);
        compiled += 1;
        faults.extend(fault(&compilation, rule.expect.as_ref(), &text).map(|f| format!("{name}: {f}")));
        let again = |text: &str| compile_with(InputFile { name: &name, text }, &[], &modules);
        faults.extend(fixing::faults(&text, &again).0);
    }
    if !grown.is_empty() {
        let whole = compile_with(InputFile { name: page, text: &grown }, &[], &Modules(files));
        if !whole.diagnostics.is_empty() {
            faults.push(format!("{page}: the blocks together{}", listed(&whole)));
        }
    }
    (faults, compiled)
}

/// What is wrong with a compilation, given what is to be.
fn fault(
    c: &CompilationResult,
    expect: Option<&(String, bool, Option<String>)>,
    text: &str,
) -> Option<String> {
    let compiles = c.program.is_some() && !c.diagnostics.iter().any(|d| d.is_error());
    let Some((code, is_error, at)) = expect else {
        return (!compiles).then(|| format!("does not compile{}", listed(c)));
    };
    let what = if *is_error { "fail" } else { "warn" };
    if !is_error && !compiles {
        return Some(format!("does not compile{}", listed(c)));
    }
    let with_code = |d: &&hrdsl_source::Diagnostic| d.code.to_string() == *code && d.is_error() == *is_error;
    let found: Vec<_> = c.diagnostics.iter().filter(with_code).collect();
    if found.is_empty() {
        return Some(format!("does not {what} with {code}{}", listed(c)));
    }
    let others = c.diagnostics.iter().any(|d| d.is_error() && d.code.to_string() != *code);
    if *is_error && others {
        return Some(format!("fails with more than {code}{}", listed(c)));
    }
    let Some(at) = at else { return None };
    let texts: Vec<&str> = found
        .iter()
        .map(|d| text.get(d.span().start as usize..d.span().end as usize).unwrap_or("(in another file)"))
        .collect();
    (!texts.contains(&at.as_str()))
        .then(|| format!("{what}s with {code} at `{}`, not `{at}`", texts.join("`, `")))
}

/// The diagnostics, by place in the block.
fn listed(compilation: &CompilationResult) -> String {
    let mut lines = String::new();
    for d in &compilation.diagnostics {
        let place = compilation.files.place(d.span());
        lines += &format!("\n    {place} {} {}", d.code, d.message);
    }
    if lines.is_empty() { ": nothing is said about it".to_owned() } else { lines }
}

#[test]
fn a_wrong_block_is_a_fault() {
    let block = |info: &str, text: &str| Block { info: info.to_owned(), line: 1, text: text.to_owned() };
    let wrong = "scenario x\nevent e from nobody\n";
    let count = |blocks: &[Block]| faults("page", blocks).0.len();
    assert_eq!(count(&[block("hri", wrong)]), 1);
    assert_eq!(count(&[block("hri,fails=HR0503", wrong)]), 1);
    assert_eq!(count(&[block("hri,fails=HR0101", wrong)]), 0);
    assert_eq!(count(&[block("hri,fails=HR0101=\"nobody\"", wrong)]), 0);
    assert_eq!(count(&[block("hri,fails=HR0101=\"somebody\"", wrong)]), 1);
    assert_eq!(count(&[block("hri,warns=HR0101", wrong)]), 1);
    assert_eq!(count(&[block("hri,maybe", wrong)]), 1);
    assert_eq!(count(&[block("text", wrong)]), 0);
    let module = block("hri,file=m.hri", "actor a : environment\n");
    let user = block("hri", "scenario x\nuse \"m.hri\"\nevent e from a\n");
    assert_eq!(count(&[module.clone(), user.clone()]), 0);
    assert_eq!(count(&[module, block("hri", "scenario y\n"), user]), 1);
    let first = block("hri,then", "scenario x\nactor a : environment\n");
    assert_eq!(count(&[first.clone(), block("hri,then", "stimulus s by a { hold 1 s }\n")]), 0);
    assert_eq!(count(&[first, block("hri,then", "event e from b\n")]), 1);
    assert_eq!(count(&[block("hri,item", "event twice from nobody\n")]), 1);
}
