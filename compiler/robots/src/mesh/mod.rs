//! Meshes: files of triangles as indexed triangles in metres.

mod builder;
pub(crate) mod collada;
pub(crate) mod model;
pub(crate) mod obj;
pub(crate) mod stl;

use crate::{files::path::ending_of, limits::MOST_MESH_BYTES, mesh::model::TriangleMesh};

/// The endings of the files that are read.
pub(crate) const READ_FORMATS: &str = "stl, obj, dae";

/// Reads the mesh of a file, by the ending of its name.
///
/// # Errors
/// What is wrong with it, with the line if it has lines.
pub fn read_mesh(path: &str, bytes: &[u8]) -> Result<TriangleMesh, String> {
    if bytes.len() > MOST_MESH_BYTES {
        return Err(format!("it has more than {MOST_MESH_BYTES} bytes"));
    }
    let mesh = match ending_of(path).as_str() {
        "stl" => stl::read_stl(bytes),
        "obj" => obj::read_obj(bytes),
        "dae" => collada::read_collada(bytes),
        other => Err(format!("`{other}` is no ending of {READ_FORMATS}")),
    }?;
    if mesh.triangles.is_empty() {
        return Err("it has no triangle that has an area".to_owned());
    }
    Ok(mesh)
}
