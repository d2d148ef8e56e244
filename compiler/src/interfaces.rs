//! The definitions of ROS interfaces that a scenario's systems use: the standard packages, and the workspaces that are named.

use std::sync::Arc;

use hrdsl_messages::{
    InterfaceName, InterfaceTable, MessageLibrary, MessageLibraryBuilder, RosVersion, WorkspaceEntry,
    WorkspaceReader,
};
use hrdsl_source::{SourceFiles, Span};
use hrdsl_syntax::ast::{self, BindingMemberKind, ItemSyntaxKind, SystemMemberKind};

use crate::modules::ModuleLoader;

/// Where there are no files.
struct NoWorkspace;

impl WorkspaceReader for NoWorkspace {
    fn entries(&self, _folder: &str) -> Result<Vec<WorkspaceEntry>, String> {
        Err("there are no files here".to_owned())
    }

    fn text(&self, _file: &str) -> Result<String, String> {
        Err("there are no files here".to_owned())
    }
}

/// A workspace that a binding names, in the file of this place.
struct NamedWorkspace {
    version: RosVersion,
    file: usize,
    path: String,
    span: Span,
}

/// One library for each version that is used; none, if there is no binding.
pub(crate) fn load(
    files: &mut SourceFiles,
    ast: &[Arc<ast::FileSyntax>],
    loader: &dyn ModuleLoader,
) -> Vec<MessageLibrary> {
    let (versions, workspaces) = named(ast);
    let names: Vec<String> = files.iter().map(|(_, file)| file.name.clone()).collect();
    let library = |version: RosVersion| {
        let (packages, folder) = match version {
            RosVersion::Ros1 => (hrdsl_stdlib::ROS1_PACKAGES, "ros1"),
            RosVersion::Ros2 => (hrdsl_stdlib::ROS2_PACKAGES, "ros2"),
        };
        let mut builder = MessageLibraryBuilder::new(version, files);
        for (package, text) in packages {
            builder = builder.package(package, &format!("std/{folder}/{package}"), text);
        }
        for workspace in workspaces.iter().filter(|w| w.version == version) {
            let from = names.get(workspace.file).map_or("", String::as_str);
            let reader = loader.workspaces(from);
            let reader = reader.as_deref().unwrap_or(&NoWorkspace);
            builder = builder.workspace(reader, &workspace.path, workspace.span);
        }
        builder.finish()
    };
    versions.into_iter().map(library).collect()
}

/// The versions that systems use, each once, and the workspaces.
fn named(ast: &[Arc<ast::FileSyntax>]) -> (Vec<RosVersion>, Vec<NamedWorkspace>) {
    let (mut versions, mut workspaces) = (Vec::new(), Vec::new());
    for (file, syntax) in ast.iter().enumerate() {
        for item in &syntax.items {
            let ItemSyntaxKind::System(system) = &item.kind else { continue };
            for member in &system.members {
                let SystemMemberKind::Middleware(middleware) = &member.kind else { continue };
                let version =
                    if middleware.version.text == "ros1" { RosVersion::Ros1 } else { RosVersion::Ros2 };
                if !versions.contains(&version) {
                    versions.push(version);
                }
                for member in &middleware.members {
                    let BindingMemberKind::Messages(path) = &member.kind else { continue };
                    let (path, span) = (path.text.clone(), path.span);
                    workspaces.push(NamedWorkspace { version, file, path, span });
                }
            }
        }
    }
    (versions, workspaces)
}

/// All definitions in which nothing is wrong.
pub(crate) fn table(library: &MessageLibrary) -> Option<InterfaceTable> {
    let all: Vec<InterfaceName> = library
        .messages()
        .map(|(name, _)| name)
        .chain(library.services().map(|(name, _)| name))
        .chain(library.actions().map(|(name, _)| name))
        .cloned()
        .collect();
    let sound = library.closure(&all).or_else(|_| {
        let sound = |name: &&InterfaceName| library.closure(std::slice::from_ref(*name)).is_ok();
        let names: Vec<InterfaceName> = all.iter().filter(sound).cloned().collect();
        library.closure(&names)
    });
    // INVARIANT: what has just been looked at is sound.
    sound.ok()
}
