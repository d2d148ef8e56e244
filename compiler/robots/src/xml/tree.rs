//! The tree: elements, their attributes, and the text between them.

use hrdsl_source::Span;

use crate::fault::RobotPlace;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct XmlElement {
    /// As it is written: `xacro:if`.
    pub name: String,
    /// Of the name.
    pub place: RobotPlace,
    pub attributes: Vec<XmlAttribute>,
    pub children: Vec<XmlNode>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct XmlAttribute {
    pub name: String,
    pub value: String,
    /// Of the value, as it is written.
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum XmlNode {
    Element(XmlElement),
    Text(XmlText),
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct XmlText {
    pub text: String,
    pub span: Span,
}

impl XmlElement {
    /// The elements directly in it.
    pub fn elements(&self) -> impl DoubleEndedIterator<Item = &XmlElement> {
        self.children.iter().filter_map(|node| match node {
            XmlNode::Element(element) => Some(element),
            XmlNode::Text(_) => None,
        })
    }

    /// Those of this name.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a XmlElement> {
        self.elements().filter(move |element| element.name == name)
    }

    /// The first of this name.
    pub fn child(&self, name: &str) -> Option<&XmlElement> {
        self.elements().find(|element| element.name == name)
    }

    pub fn attribute(&self, name: &str) -> Option<&XmlAttribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The place of an attribute's value in this element.
    pub fn place_of(&self, attribute: &XmlAttribute) -> RobotPlace {
        RobotPlace { span: attribute.span, call: self.place.call }
    }

    /// The text directly in it.
    pub fn text(&self) -> String {
        let texts = self.children.iter().filter_map(|node| match node {
            XmlNode::Text(text) => Some(text.text.as_str()),
            XmlNode::Element(_) => None,
        });
        texts.collect()
    }
}
