//! Addresses of meshes: `package://`, `model://`, `file://` and paths.

use super::{
    package::PackageTable,
    path::joined,
    reader::{RobotReader, path_beside},
};
use crate::fault::{RobotFault, RobotFaultKind, RobotPlace};

/// The path of a file that a description names by an address; `file` is the description's own.
pub(crate) fn resolve_address(
    address: &str,
    place: RobotPlace,
    file: &str,
    packages: &PackageTable,
    reader: &dyn RobotReader,
) -> Result<String, RobotFault> {
    let bad = |help: &str| RobotFaultKind::BadAddress(address.to_owned()).at(place, help);
    let Some((scheme, rest)) = address.split_once("://") else {
        if address.trim().is_empty() {
            return Err(bad("write `package://PACKAGE/meshes/FILE.stl`, or a path from this file"));
        }
        return Ok(path_beside(reader, file, address));
    };
    match scheme {
        "package" | "model" => {
            let (name, path) = rest.split_once('/').ok_or_else(|| bad("write `package://PACKAGE/FILE`"))?;
            match packages.found_from(name, file, reader) {
                Some(folder) => Ok(joined(&folder, path.trim_start_matches('/'))),
                None => Err(packages.unknown(name, place)),
            }
        }
        "file" => Ok(path_beside(reader, file, rest)),
        _ => Err(bad("write `package://PACKAGE/FILE`, `file:///FILE` or a path from this file")),
    }
}
