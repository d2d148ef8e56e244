//! How much is read: what is beyond is said at its place, and never read in part without a word.

/// Of one file with a definition, or of a `package.xml`.
pub const MOST_BYTES: usize = 1 << 20;
/// Of a name.
pub const MOST_NAME_BYTES: usize = 255;
/// Fields and constants of one message.
pub const MOST_MEMBERS: usize = 4096;
/// How deep messages lie in messages.
pub const MOST_DEPTH: u32 = 64;
/// Values that a message holds before anything is put into its sequences: arrays of a fixed size, multiplied.
pub const MOST_FIXED_VALUES: u64 = 1 << 24;
/// What is said of one definition.
pub const MOST_FAULTS: usize = 100;
/// Files that are read of one workspace, those that say the name of a package among them.
pub const MOST_FILES: usize = 20_000;
/// Folders that are looked into, to find the packages of one workspace.
pub const MOST_FOLDERS: usize = 100_000;
/// How deep a package lies below the folder of its workspace.
pub const MOST_FOLDER_DEPTH: usize = 16;
