//! One description from its file to data: expanded, read, checked, with its meshes and its SRDF.

use std::collections::BTreeMap;

use hrdsl_source::{SourceFiles, Span};

use crate::{
    fault::{RobotFault, RobotPlace, say},
    files::{
        package::PackageTable,
        reader::{RobotReader, read_text},
    },
    mesh::model::TriangleMesh,
    srdf::{model::SrdfSemantics, read::read_semantics},
    urdf::{meshes::read_meshes, model::UrdfRobot, read::read_urdf},
    xacro::{XacroRequest, expand_xacro},
    xml::{XmlElement, read_xml},
};

/// What is to be read, and what is needed for it.
#[derive(Clone, Debug)]
pub struct RobotRequest<'a> {
    /// The file of the description: URDF, or xacro, which is found out.
    pub path: &'a str,
    /// Where that path is written.
    pub place: RobotPlace,
    /// What xacro's `$(arg NAME)` is, in the place of its defaults.
    pub arguments: &'a [(String, String)],
    /// What `$(env NAME)` is: nothing is taken from the process.
    pub environment: &'a [(String, String)],
    pub packages: &'a PackageTable,
    /// The file of the SRDF, if there is one; it may be xacro, too.
    pub semantics: Option<(&'a str, RobotPlace)>,
    /// Which meshes are read.
    pub meshes: MeshChoice,
}

/// Which meshes of a robot are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshChoice {
    /// None, and nothing is said of missing files.
    None,
    /// Those that touch.
    Collisions,
    /// Those that are seen, too.
    All,
}

impl<'a> RobotRequest<'a> {
    /// Of a file, without arguments, with the meshes of collisions.
    #[must_use]
    pub fn new(path: &'a str, place: Span, packages: &'a PackageTable) -> Self {
        Self {
            path,
            place: place.into(),
            arguments: &[],
            environment: &[],
            packages,
            semantics: None,
            meshes: MeshChoice::Collisions,
        }
    }
}

/// What was read. With an error among the faults the rest is not to be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotReading {
    /// `None` if its links are no tree.
    pub robot: Option<UrdfRobot>,
    pub semantics: Option<SrdfSemantics>,
    /// By the paths that shapes name; in metres, before a shape's scale.
    pub meshes: BTreeMap<String, TriangleMesh>,
    pub faults: Vec<RobotFault>,
    /// All files of text that were read, in order: the description, and what it includes.
    pub files: Vec<String>,
}

impl RobotReading {
    /// Whether nothing that was found is an error.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.robot.is_some() && !self.faults.iter().any(RobotFault::is_error)
    }
}

/// Reads a robot. `files` gets the texts that are read, so that faults have a place.
pub fn read_robot(request: &RobotRequest, files: &mut SourceFiles, reader: &dyn RobotReader) -> RobotReading {
    let before = files.iter().count();
    let mut reading = RobotReading::default();
    let root = expanded(request, request.path, request.place, files, reader, &mut reading.faults);
    if let Some(root) = root {
        reading.robot = read_urdf(&root, request.path, request.packages, reader, &mut reading.faults);
    }
    if let (Some(robot), Some((path, place))) = (&reading.robot, request.semantics) {
        let root = expanded(request, path, place, files, reader, &mut reading.faults);
        reading.semantics = root.and_then(|root| read_semantics(&root, robot, &mut reading.faults));
    }
    if let (Some(robot), true) = (&reading.robot, request.meshes != MeshChoice::None) {
        let collisions_only = request.meshes == MeshChoice::Collisions;
        reading.meshes = read_meshes(robot, collisions_only, reader, &mut reading.faults);
    }
    reading.files = files.iter().skip(before).map(|(_, file)| file.name.clone()).collect();
    reading
}

/// The root of a file, expanded if it has words of xacro in it.
fn expanded(
    request: &RobotRequest,
    path: &str,
    place: RobotPlace,
    files: &mut SourceFiles,
    reader: &dyn RobotReader,
    faults: &mut Vec<RobotFault>,
) -> Option<XmlElement> {
    let mut kept = |read: Result<XmlElement, RobotFault>| read.map_err(|fault| say(faults, fault)).ok();
    let root = kept(read_text(reader, files, path, place).and_then(|(file, text)| read_xml(file, &text)))?;
    if !is_xacro(&root) {
        return Some(root);
    }
    let xacro = XacroRequest {
        path,
        arguments: request.arguments,
        environment: request.environment,
        packages: request.packages,
        reader,
    };
    let mut warnings = Vec::new();
    let expanded = kept(expand_xacro(&root, &xacro, files, &mut warnings));
    warnings.into_iter().for_each(|warning| say(faults, warning));
    expanded
}

/// Whether a word of xacro is in it, or something that it replaces.
fn is_xacro(element: &XmlElement) -> bool {
    element.name.starts_with("xacro:")
        || element
            .attributes
            .iter()
            .any(|a| a.name.starts_with("xacro:") || a.value.contains("${") || a.value.contains("$("))
        || element.elements().any(is_xacro)
}

/// The text of a description after xacro, as XML again: to compare, and to look at.
///
/// # Errors
/// The first fault.
pub fn expanded_text(
    request: &RobotRequest,
    files: &mut SourceFiles,
    reader: &dyn RobotReader,
) -> Result<String, Vec<RobotFault>> {
    let mut faults = Vec::new();
    match expanded(request, request.path, request.place, files, reader, &mut faults) {
        Some(root) => Ok(root.to_string()),
        None => Err(faults),
    }
}
