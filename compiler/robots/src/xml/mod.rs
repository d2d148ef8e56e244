//! XML as a tree of our own, each part with its place.

mod ask;
mod numbers;
mod read;
mod tree;
mod write;

pub(crate) use numbers::{number_in, numbers_in};
pub(crate) use read::{DeclaredText, depth_of, read_xml};
pub(crate) use tree::{XmlAttribute, XmlElement, XmlNode, XmlText};
