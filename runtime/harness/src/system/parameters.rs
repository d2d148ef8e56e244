//! One tree of parameters for all programs of a system, as the server of ROS 1 has it: values by names with slashes.
//!
//! A value stays the text that its program wrote. Objects alone are looked into, since their members are parameters below.

use std::{fmt, iter};

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use serde_json::value::RawValue;

use super::{
    seam::{ParameterRequest, SystemAnswer},
    vocabulary::refuse,
};
use crate::port::MessageText;

/// So many bytes the tree has at most as JSON, which must fit into one reply.
const MOST: usize = 1_000_000;
/// Objects and lists may lie in each other so deep.
const DEEPEST: usize = 100;

/// A value, or the parameters below a name, in the order in which they came.
#[derive(Clone, Debug)]
enum ParameterNode {
    Value(MessageText),
    Below(Vec<(String, ParameterNode)>),
}

/// The parameters of a system.
#[derive(Debug)]
pub(super) struct ParameterTree {
    root: Vec<(String, ParameterNode)>,
    /// Bytes of it as JSON, at most.
    size: usize,
}

impl Default for ParameterTree {
    fn default() -> Self {
        Self { root: Vec::new(), size: 2 }
    }
}

impl ParameterTree {
    /// What a program asks of it.
    pub fn answer(&mut self, request: ParameterRequest) -> SystemAnswer {
        let absent = |name: &str| SystemAnswer::Ended(Err(format!("there is no parameter `{name}`")));
        match request {
            ParameterRequest::Get { name } => {
                self.get(&name).map_or_else(|| absent(&name), SystemAnswer::Json)
            }
            ParameterRequest::Set { name, value } => match self.set(&name, &value) {
                Ok(()) => SystemAnswer::Ok,
                Err(why) => refuse(why, None),
            },
            ParameterRequest::Delete { name } => {
                if self.delete(&name) {
                    SystemAnswer::Ended(Ok(()))
                } else {
                    absent(&name)
                }
            }
        }
    }

    /// The value of a parameter, or an object of those below; `None`: there is none.
    pub fn get(&self, name: &str) -> Option<MessageText> {
        let parts: Vec<&str> = parts(name).collect();
        let mut text = String::new();
        match parts.as_slice() {
            [] => write_below(&self.root, &mut text),
            parts => match find(&self.root, parts)? {
                ParameterNode::Value(value) => return Some(value.clone()),
                ParameterNode::Below(below) => write_below(below, &mut text),
            },
        }
        Some(text.into())
    }

    /// Sets a value; an object replaces all that was below the name.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let parts: Vec<&str> = parts(name).collect();
        if parts.len() > DEEPEST || depth(value) > DEEPEST {
            return Err(format!(
                "a parameter has more than {DEEPEST} names, objects and lists in each other"
            ));
        }
        let node = read(value).map_err(|e| format!("the value of `{name}` cannot be read: {e}"))?;
        let comes = node.size() + parts.iter().map(|part| member_size(part) + 2).sum::<usize>();
        let goes = match parts.as_slice() {
            [] => self.size,
            parts => find(&self.root, parts).map_or(0, ParameterNode::size),
        };
        if (self.size + comes).saturating_sub(goes) > MOST {
            return Err(format!("the parameters would take more than {MOST} bytes"));
        }
        match (parts.as_slice(), node) {
            ([], ParameterNode::Below(root)) => {
                self.size = below_size(&root);
                self.root = root;
            }
            ([], ParameterNode::Value(_)) => {
                return Err("the root of the parameters can only be an object".to_owned());
            }
            (parts, node) => self.size = self.size.saturating_add_signed(put(&mut self.root, parts, node)),
        }
        Ok(())
    }

    /// Removes a parameter and those below; whether there was one.
    pub fn delete(&mut self, name: &str) -> bool {
        let parts: Vec<&str> = parts(name).collect();
        let Some((last, above)) = parts.split_last() else { return false };
        let mut below = &mut self.root;
        for part in above {
            match below.iter_mut().find(|(key, _)| key == part) {
                Some((_, ParameterNode::Below(inner))) => below = inner,
                Some((_, ParameterNode::Value(_))) | None => return false,
            }
        }
        let Some(at) = below.iter().position(|(key, _)| key == last) else { return false };
        let (key, node) = below.remove(at);
        self.size = self.size.saturating_sub(member_size(&key) + node.size());
        true
    }
}

impl ParameterNode {
    fn size(&self) -> usize {
        match self {
            ParameterNode::Value(text) => text.len(),
            ParameterNode::Below(below) => below_size(below),
        }
    }
}

fn below_size(below: &[(String, ParameterNode)]) -> usize {
    2 + below.iter().map(|(key, node)| member_size(key) + node.size()).sum::<usize>()
}

/// The bytes of a member without its value: its name, the colon and the comma.
fn member_size(key: &str) -> usize {
    quoted(key).len() + 2
}

fn quoted(key: &str) -> String {
    serde_json::Value::from(key).to_string()
}

fn parts(name: &str) -> impl Iterator<Item = &str> {
    name.split('/').filter(|part| !part.is_empty())
}

fn find<'t>(below: &'t [(String, ParameterNode)], parts: &[&str]) -> Option<&'t ParameterNode> {
    let (first, rest) = parts.split_first()?;
    let (_, node) = below.iter().find(|(key, _)| key == first)?;
    match node {
        _ if rest.is_empty() => Some(node),
        ParameterNode::Below(inner) => find(inner, rest),
        ParameterNode::Value(_) => None,
    }
}

/// Puts a node at a name of at least one part, where a value on the way makes room; by how many bytes that grows.
fn put(below: &mut Vec<(String, ParameterNode)>, parts: &[&str], node: ParameterNode) -> isize {
    let Some((first, rest)) = parts.split_first() else { return 0 };
    let signed = |size: usize| isize::try_from(size).unwrap_or(isize::MAX);
    let mut grown = 0;
    let at = below.iter().position(|(key, _)| key == first).unwrap_or_else(|| {
        below.push(((*first).to_owned(), ParameterNode::Below(Vec::new())));
        grown += signed(member_size(first) + 2);
        below.len() - 1
    });
    let Some((_, own)) = below.get_mut(at) else { return grown };
    if rest.is_empty() {
        grown += signed(node.size()) - signed(own.size());
        *own = node;
        return grown;
    }
    if let ParameterNode::Value(text) = own {
        grown += 2 - signed(text.len());
        *own = ParameterNode::Below(Vec::new());
    }
    match own {
        ParameterNode::Below(inner) => grown + put(inner, rest, node),
        ParameterNode::Value(_) => grown,
    }
}

fn write_below(below: &[(String, ParameterNode)], text: &mut String) {
    for ((key, node), sign) in below.iter().zip(iter::once('{').chain(iter::repeat(','))) {
        text.push(sign);
        text.push_str(&quoted(key));
        text.push(':');
        match node {
            ParameterNode::Value(value) => text.push_str(value),
            ParameterNode::Below(inner) => write_below(inner, text),
        }
    }
    text.push_str(if below.is_empty() { "{}" } else { "}" });
}

/// How deep brackets lie in each other, outside of texts.
fn depth(value: &str) -> usize {
    let (mut now, mut most, mut is_text, mut is_escaped) = (0_usize, 0, false, false);
    for byte in value.bytes() {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' if is_text => is_escaped = true,
            b'"' => is_text = !is_text,
            b'{' | b'[' if !is_text => {
                now += 1;
                most = most.max(now);
            }
            b'}' | b']' if !is_text => now = now.saturating_sub(1),
            _ => {}
        }
    }
    most
}

/// The members of an object, in their order.
struct ObjectMembers<'l>(Vec<(String, &'l RawValue)>);

impl<'l> Deserialize<'l> for ObjectMembers<'l> {
    fn deserialize<D: Deserializer<'l>>(deserializer: D) -> Result<Self, D::Error> {
        struct MembersVisitor;
        impl<'l> Visitor<'l> for MembersVisitor {
            type Value = ObjectMembers<'l>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<M: MapAccess<'l>>(self, mut map: M) -> Result<Self::Value, M::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry()? {
                    members.push(member);
                }
                Ok(ObjectMembers(members))
            }
        }
        deserializer.deserialize_map(MembersVisitor)
    }
}

fn read(value: &str) -> serde_json::Result<ParameterNode> {
    if !value.trim_start().starts_with('{') {
        let raw: &RawValue = serde_json::from_str(value)?;
        return Ok(ParameterNode::Value(raw.get().into()));
    }
    let ObjectMembers(members) = serde_json::from_str(value)?;
    let mut below = Vec::new();
    for (key, text) in members {
        let node = read(text.get())?;
        put(&mut below, &[key.as_str()], node);
    }
    Ok(ParameterNode::Below(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(values: &[(&str, &str)]) -> ParameterTree {
        let mut tree = ParameterTree::default();
        values.iter().for_each(|(name, value)| tree.set(name, value).unwrap());
        tree
    }

    fn all(tree: &ParameterTree) -> String {
        let text = tree.get("/").unwrap();
        // Each member has room for a comma, the last one, too.
        assert!(tree.size >= text.len() && tree.size == below_size(&tree.root), "{} {text}", tree.size);
        text.to_string()
    }

    #[test]
    fn values_stay_as_they_were_written_and_in_their_order() {
        let mut tree = tree(&[("/b/x", " 1.50 "), ("a", "[1e22, {\"z\": 1}]"), ("/b/y/", "\"t\\u00fc\"")]);
        assert_eq!(all(&tree), r#"{"b":{"x":1.50,"y":"t\u00fc"},"a":[1e22, {"z": 1}]}"#);
        assert_eq!(tree.get("b/x").as_deref(), Some("1.50"));
        assert_eq!(tree.get("/b").as_deref(), Some(r#"{"x":1.50,"y":"t\u00fc"}"#));
        for absent in ["/c", "/b/x/y", "/a/z", "/b/z"] {
            assert_eq!(tree.get(absent), None, "{absent}");
        }
        tree.set("/b", r#"{"w": {}, "v": {"u": 1, "u": 2}}"#).unwrap();
        assert_eq!(all(&tree), r#"{"b":{"w":{},"v":{"u":2}},"a":[1e22, {"z": 1}]}"#);
        tree.set("/a/deep/er", "3").unwrap();
        assert_eq!(all(&tree), r#"{"b":{"w":{},"v":{"u":2}},"a":{"deep":{"er":3}}}"#);
        assert!(tree.delete("/a/deep") && tree.delete("b/v/u"));
        for absent in ["/a/deep", "/", "/b/v/u/w", "/c/d"] {
            assert!(!tree.delete(absent), "{absent}");
        }
        assert_eq!(all(&tree), r#"{"b":{"w":{},"v":{}},"a":{}}"#);
        tree.set("/", r#"{"only": true}"#).unwrap();
        assert_eq!(all(&tree), r#"{"only":true}"#);
    }

    #[test]
    fn what_is_no_parameter_is_refused_and_changes_nothing() {
        let mut tree = tree(&[("/a", "1")]);
        let deep = format!("{}1{}", "[".repeat(DEEPEST + 1), "]".repeat(DEEPEST + 1));
        let bracket = format!("\"{}\\\"{}\"", "[".repeat(200), "{".repeat(200));
        let large = format!("\"{}\"", "x".repeat(MOST));
        for (name, value, why) in [
            ("/", "1", "the root of the parameters can only be an object"),
            ("/b", "{\"a\": }", "the value of `/b` cannot be read: expected value"),
            ("/b", &deep, "more than 100 names, objects and lists in each other"),
            (&"/b".repeat(DEEPEST + 1), "1", "more than 100 names, objects and lists in each other"),
            ("/b", &large, "the parameters would take more than 1000000 bytes"),
        ] {
            let error = tree.set(name, value).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        assert_eq!(all(&tree), r#"{"a":1}"#);
        tree.set("/b", &bracket).unwrap();
    }

    #[test]
    fn a_full_tree_has_room_for_what_takes_the_place_of_something() {
        let half = format!("\"{}\"", "x".repeat(MOST / 2));
        let mut tree = tree(&[("/a", &half)]);
        tree.set("/b", &half).unwrap_err();
        for _ in 0..3 {
            tree.set("/a", &half).unwrap();
        }
        assert!(tree.delete("/a"));
        tree.set("/b", &half).unwrap();
        tree.set("/", "{}").unwrap();
        assert_eq!(all(&tree), "{}");
    }
}
