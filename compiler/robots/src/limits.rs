//! How much is read: what is beyond is said at its place, and never read in part without a word.

/// Of one file of XML or YAML, DAE excepted.
pub const MOST_TEXT_BYTES: usize = 16 << 20;
/// Of one file with a mesh or an image.
pub const MOST_MESH_BYTES: usize = 256 << 20;
/// Triangles of one mesh.
pub const MOST_TRIANGLES: usize = 4_000_000;
/// How deep elements lie in elements.
pub const MOST_XML_DEPTH: usize = 200;
/// Elements of a description, after all macros are expanded.
pub const MOST_ELEMENTS: usize = 500_000;
/// How deep macros, includes and blocks lie in each other while they are expanded.
pub const MOST_EXPANSION_DEPTH: usize = 120;
/// Bytes of one text that xacro computes, and items of one list.
pub const MOST_VALUE_SIZE: usize = 1 << 20;
/// Bytes of all texts that xacro computes for one description.
pub const MOST_COMPUTED_BYTES: usize = 128 << 20;
/// How deep parentheses lie in an expression, and lists in a YAML file.
pub const MOST_NESTING: usize = 48;
/// Values of a YAML file, with those that aliases repeat.
pub const MOST_YAML_VALUES: usize = 1_000_000;
/// Links of a robot; joints are one fewer.
pub const MOST_LINKS: usize = 20_000;
/// What is said of one description.
pub const MOST_FAULTS: usize = 200;
/// Folders that are looked into, to find packages.
pub const MOST_FOLDERS: usize = 100_000;
/// How deep a package lies below the folder that is searched.
pub const MOST_FOLDER_DEPTH: usize = 16;
/// Cells of an occupancy map.
pub const MOST_CELLS: usize = 100_000_000;
/// Nodes of a COLLADA scene, with those that it has several times.
pub const MOST_SCENE_NODES: usize = 100_000;
/// A mesh that is larger than this, in metres, was probably drawn in millimetres.
pub const HUGE_MESH: f64 = 100.0;
