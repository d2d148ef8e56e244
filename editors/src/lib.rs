//! Highlighting for editors: what the registry of keywords says, in the forms that editors read.
//!
//! Each form is a template in `templates/` with places for lists of words; [`generated`] fills them. The results are
//! committed where the editors expect them, and a test fails when they are not what comes out here.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::wildcard_enum_match_arm))]

mod template;
pub mod words;

/// A file that is made here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GeneratedFile {
    /// Where it is committed, from the `editors` folder.
    pub path: &'static str,
    pub text: String,
}

/// All files, for all editors.
///
/// # Errors
/// A template that cannot be filled: says what is wrong with it.
pub fn generated() -> Result<Vec<GeneratedFile>, String> {
    textmate()
}

/// The TextMate grammar of the Visual Studio Code extension, and the words that its tests are about.
///
/// # Errors
/// A template that cannot be filled: says what is wrong with it.
pub fn textmate() -> Result<Vec<GeneratedFile>, String> {
    let template = include_str!("../templates/hrdsl.tmLanguage.template");
    Ok(vec![
        GeneratedFile {
            path: "vscode/syntaxes/hrdsl.tmLanguage.json",
            text: template::fill(template, &words::list)?,
        },
        GeneratedFile { path: "vscode/test/keywords.json", text: words::registry() },
    ])
}
