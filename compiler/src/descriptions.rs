//! The descriptions of robots, and the maps, that parts and worlds are made from: read once each, with what is wrong in them.

use std::sync::Arc;

use hrdsl_model::{DescriptionLibrary, DescriptionRequest};
use hrdsl_robots::{
    MeshChoice, PackageTable, RobotEntry, RobotFault, RobotReader, RobotRequest, read_map, read_robot,
};
use hrdsl_source::{Diagnostic, DiagnosticCode, SourceFiles};
use hrdsl_syntax::ast::{self, ItemSyntaxKind, PartSyntax, TextSyntax, WorldMember, WorldMemberKind};

use crate::modules::ModuleLoader;

/// Where there are no files.
struct NoRobots;

impl RobotReader for NoRobots {
    fn bytes(&self, _file: &str) -> Result<Vec<u8>, String> {
        Err("there are no files here".to_owned())
    }

    fn entries(&self, _folder: &str) -> Result<Vec<RobotEntry>, String> {
        Err("there are no files here".to_owned())
    }
}

/// Reads all that is named. Files are found from the folder of the file that names them.
pub(crate) fn load(
    files: &mut SourceFiles,
    ast: &[Arc<ast::FileSyntax>],
    diagnostics: &mut Vec<Diagnostic>,
    loader: &dyn ModuleLoader,
) -> DescriptionLibrary {
    let mut library = DescriptionLibrary::default();
    let names: Vec<String> = files.iter().map(|(_, file)| file.name.clone()).collect();
    let reader = loader.robots();
    let reader: &dyn RobotReader = reader.as_deref().unwrap_or(&NoRobots);
    for (syntax, name) in ast.iter().zip(&names) {
        let mut reading = DescriptionReading { files, diagnostics, reader, library: &mut library, name };
        for item in &syntax.items {
            if let ItemSyntaxKind::Part(part) = &item.kind {
                reading.part(part);
                reading.maps(&part.members);
            } else if let ItemSyntaxKind::World(world) = &item.kind {
                reading.maps(&world.members);
            }
        }
    }
    library
}

struct DescriptionReading<'a> {
    files: &'a mut SourceFiles,
    diagnostics: &'a mut Vec<Diagnostic>,
    reader: &'a dyn RobotReader,
    library: &'a mut DescriptionLibrary,
    /// Of the file that names what is read.
    name: &'a str,
}

impl DescriptionReading<'_> {
    fn part(&mut self, part: &PartSyntax) {
        let Some(request) = DescriptionRequest::of(part) else { return };
        let Some(WorldMemberKind::Robot(path)) = part.description.as_ref().map(|d| &d.kind) else { return };
        // Another folder may have another file of that name.
        if self.library.has_robot(path.span.file, &request) {
            return;
        }
        let mut packages = PackageTable::new();
        for member in &part.members {
            let WorldMemberKind::Packages(folder) = &member.kind else { continue };
            let found = packages.search(self.reader, self.files, &self.beside(folder), folder.span.into());
            self.say(&found);
        }
        let semantics = part.members.iter().find_map(|member| {
            let WorldMemberKind::Semantics(path) = &member.kind else { return None };
            Some((self.beside(path), path.span.into()))
        });
        let here = self.beside(path);
        let wanted = RobotRequest {
            path: &here,
            place: path.span.into(),
            arguments: &request.arguments,
            environment: &[],
            packages: &packages,
            semantics: semantics.as_ref().map(|(path, place)| (path.as_str(), *place)),
            meshes: MeshChoice::Collisions,
        };
        let reading = read_robot(&wanted, self.files, self.reader);
        self.say(&reading.faults);
        self.library.add_robot(path.span.file, request, reading);
    }

    fn maps(&mut self, members: &[WorldMember]) {
        for member in members {
            let WorldMemberKind::Walls(walls) = &member.kind else { continue };
            let (path, file) = (&walls.path, walls.path.span.file);
            if self.library.map(file, &path.text).is_some() {
                continue;
            }
            let here = self.beside(path);
            let map = match read_map(&here, path.span, self.files, self.reader) {
                Ok(map) => Some(map),
                Err(fault) => {
                    self.say(&[fault]);
                    None
                }
            };
            self.library.add_map(file, path.text.clone(), map);
        }
    }

    /// A path from the folder of the file that names it.
    fn beside(&self, path: &TextSyntax) -> String {
        match self.name.rsplit_once('/') {
            Some((folder, _)) if !path.text.starts_with('/') => format!("{folder}/{}", path.text),
            Some(_) | None => path.text.clone(),
        }
    }

    fn say(&mut self, faults: &[RobotFault]) {
        let told = faults.iter().map(|fault| fault.diagnostic(DiagnosticCode::BAD_DESCRIPTION));
        self.diagnostics.extend(told);
    }
}
