//! What the tests share: the standard libraries, and folders as workspaces.

#![allow(clippy::disallowed_methods, reason = "the tests read their fixtures")]
#![allow(dead_code, reason = "each test uses a part of it")]

use std::{fs, path::Path};

use hrdsl_messages::{MessageLibrary, MessageLibraryBuilder, RosVersion, WorkspaceEntry, WorkspaceReader};
use hrdsl_source::SourceFiles;

/// The packages of the standard library.
pub fn packages(version: RosVersion) -> &'static [(&'static str, &'static str)] {
    match version {
        RosVersion::Ros1 => hrdsl_stdlib::ROS1_PACKAGES,
        RosVersion::Ros2 => hrdsl_stdlib::ROS2_PACKAGES,
    }
}

/// A builder that has them.
pub fn with_standard(version: RosVersion, files: &mut SourceFiles) -> MessageLibraryBuilder<'_> {
    let builder = MessageLibraryBuilder::new(version, files);
    packages(version).iter().fold(builder, |builder, (name, text)| builder.package(name, name, text))
}

/// The library of them alone.
pub fn standard(version: RosVersion) -> MessageLibrary {
    with_standard(version, &mut SourceFiles::default()).finish()
}

/// A folder of this machine as a workspace: paths are taken from it.
pub struct FolderOnDisk<'a>(pub &'a Path);

impl WorkspaceReader for FolderOnDisk<'_> {
    fn entries(&self, folder: &str) -> Result<Vec<WorkspaceEntry>, String> {
        let entries = fs::read_dir(self.0.join(folder)).map_err(|_| "there is no such folder".to_owned())?;
        let entry = |e: fs::DirEntry| WorkspaceEntry {
            name: e.file_name().to_string_lossy().into_owned(),
            is_folder: e.path().is_dir(),
        };
        Ok(entries.flatten().map(entry).collect())
    }

    fn text(&self, file: &str) -> Result<String, String> {
        fs::read_to_string(self.0.join(file)).map_err(|error| error.to_string())
    }
}
