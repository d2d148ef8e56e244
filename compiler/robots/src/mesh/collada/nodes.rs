//! Elements of COLLADA by their names.

use roxmltree::Node;

/// The children of this name, whatever the prefix.
pub(super) fn all<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'a str) -> impl Iterator<Item = Node<'a, 'i>> + 'a {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

pub(super) fn first<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'a str) -> Option<Node<'a, 'i>> {
    all(node, name).next()
}

/// The text of an element, in pieces if comments lie between.
pub(super) fn text_of(node: Node) -> String {
    node.children().filter(Node::is_text).filter_map(|text| text.text()).collect()
}
