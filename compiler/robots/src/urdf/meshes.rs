//! The meshes of a robot: read, and looked at with the scale that they are used with.

use std::collections::BTreeMap;

use super::model::{UrdfMesh, UrdfRobot};
use crate::{
    fault::{RobotFault, RobotFaultKind, say},
    files::{path::ending_of, reader::RobotReader},
    limits::HUGE_MESH,
    mesh::{READ_FORMATS, model::TriangleMesh, read_mesh},
};

/// Reads each mesh that a robot names, once; without scale. What is wrong with one that is only seen is a warning.
pub(crate) fn read_meshes(
    robot: &UrdfRobot,
    collisions_only: bool,
    reader: &dyn RobotReader,
    faults: &mut Vec<RobotFault>,
) -> BTreeMap<String, TriangleMesh> {
    let mut meshes = BTreeMap::new();
    let mut failed: BTreeMap<String, ()> = BTreeMap::new();
    for (mesh, touches) in robot.meshes() {
        let Some(path) = &mesh.path else { continue };
        if collisions_only && !touches {
            continue;
        }
        if !meshes.contains_key(path) && !failed.contains_key(path) {
            match one_mesh(mesh, path, reader) {
                Ok(read) => drop(meshes.insert(path.clone(), read)),
                Err(fault) => {
                    failed.insert(path.clone(), ());
                    let severity = if touches { fault.severity } else { hrdsl_source::Severity::Warning };
                    say(faults, RobotFault { severity, ..fault });
                }
            }
        }
        if let Some(size) = meshes.get(path).map(|read| read.scaled(mesh.scale).largest_extent())
            && size > HUGE_MESH
        {
            let kind = RobotFaultKind::HugeMesh { path: path.clone(), size };
            let help = "it was probably drawn in millimetres: write `scale=\"0.001 0.001 0.001\"`";
            say(faults, kind.warned(mesh.place, help));
        }
    }
    meshes
}

fn one_mesh(mesh: &UrdfMesh, path: &str, reader: &dyn RobotReader) -> Result<TriangleMesh, RobotFault> {
    let help = format!("name one of {READ_FORMATS}, converted from it");
    if !READ_FORMATS.split(", ").any(|ending| ending == ending_of(path)) {
        return Err(RobotFaultKind::UnreadFormat(path.to_owned()).at(mesh.place, help));
    }
    let bytes = reader.bytes(path).map_err(|reason| {
        let help = format!("put the file there ({reason}), or name another");
        RobotFaultKind::MissingFile(path.to_owned()).at(mesh.place, help)
    })?;
    read_mesh(path, &bytes).map_err(|reason| {
        let help = "export it again";
        RobotFaultKind::BrokenMesh { path: path.to_owned(), reason }.at(mesh.place, help)
    })
}
