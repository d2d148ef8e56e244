//! What an exchange with any tool is made of: sources that are read, notes and obstacles that are told, names and times.

pub mod name;
pub mod note;
pub mod obstacle;
pub mod source;
pub mod time;
