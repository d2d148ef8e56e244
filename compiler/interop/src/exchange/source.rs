//! Files of other tools, and how those that they name are found.

use super::note::SyntaxError;

/// The most bytes of one program or model, files that it includes among them.
pub const MAX_BYTES: usize = 8 << 20;

/// What is wrong with the size of a file, if anything.
pub(crate) fn too_large(source: &ForeignSource) -> Option<SyntaxError> {
    (source.text.len() > MAX_BYTES).then(|| SyntaxError {
        file: source.name.clone(),
        line: 1,
        column: 1,
        message: format!("the file is larger than {} MiB: import a part of it", MAX_BYTES >> 20),
    })
}

/// A file: its name as it is to be shown, and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForeignSource {
    pub name: String,
    pub text: String,
}

/// Reads the files that others name: the programs of a project, what a program includes.
pub trait ForeignLoader {
    /// The file `path`, as it is written in the file `from`.
    ///
    /// # Errors
    /// What is wrong with it.
    fn load(&self, from: &str, path: &str) -> Result<ForeignSource, String>;
}

/// There are no other files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoForeignFiles;

impl ForeignLoader for NoForeignFiles {
    fn load(&self, _: &str, path: &str) -> Result<ForeignSource, String> {
        Err(format!("there is no file `{path}`"))
    }
}
