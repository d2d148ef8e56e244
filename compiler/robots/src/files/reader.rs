//! The only way to files: what is read is asked of a reader that somebody hands in.

use hrdsl_source::{FileId, SourceFiles};

use super::path::{folder_of, joined};
use crate::{
    fault::{RobotFault, RobotFaultKind, RobotPlace},
    limits::MOST_TEXT_BYTES,
};

/// Reads files and folders; nothing else here touches them. Paths are joined by `/`.
pub trait RobotReader {
    /// The bytes of a file. More than [`MOST_MESH_BYTES`](crate::limits::MOST_MESH_BYTES) need not be read.
    ///
    /// # Errors
    /// Why it cannot be read, as the end of a sentence: "there is no such file".
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String>;

    /// What a folder holds, in any order. Links are followed.
    ///
    /// # Errors
    /// The same.
    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String>;

    /// The folder that paths start from which do not begin at the root, whole. A description that asks for a folder is told it from
    /// there, since it may name a file by it anywhere. Empty where paths are names and nothing else.
    fn working_folder(&self) -> String {
        String::new()
    }

    /// Whether there is a file of this path.
    fn is_file(&self, file: &str) -> bool {
        self.bytes(file).is_ok()
    }
}

/// A file or a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RobotEntry {
    pub name: String,
    pub is_folder: bool,
}

/// The path of a file that another names by `written`: from that one's folder, or from the root. What lies in the working folder is
/// named from there, as it was on the way here, so that nothing depends on where that is.
pub(crate) fn path_beside(reader: &dyn RobotReader, file: &str, written: &str) -> String {
    let path = joined(folder_of(file), written);
    let here = reader.working_folder();
    let inside = path.strip_prefix(&here).filter(|_| !here.is_empty());
    inside.and_then(|rest| rest.strip_prefix('/')).map_or(path.clone(), str::to_owned)
}

/// A folder as a description is told it: from the root.
pub(crate) fn whole_path(reader: &dyn RobotReader, folder: &str) -> String {
    joined(&reader.working_folder(), folder)
}

/// The text of a file, as one of the files that faults can name.
pub(crate) fn read_text(
    reader: &dyn RobotReader,
    files: &mut SourceFiles,
    path: &str,
    place: RobotPlace,
) -> Result<(FileId, String), RobotFault> {
    let unreadable = |reason: String| {
        RobotFaultKind::Unreadable { path: path.to_owned(), reason }.at(place, "name a file that can be read")
    };
    let bytes = reader.bytes(path).map_err(unreadable)?;
    if bytes.len() > MOST_TEXT_BYTES {
        let kind = RobotFaultKind::TooMuch { what: "bytes of a description", limit: MOST_TEXT_BYTES };
        return Err(kind.at(place, "name a smaller file"));
    }
    let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not written in UTF-8".to_owned()))?;
    // Files are counted in 16 bits.
    if files.iter().count() >= usize::from(u16::MAX) {
        return Err(unreadable("too many files are read already".to_owned()));
    }
    Ok((files.add(path, text.as_str()), text))
}
