//! Values of a file's first document, from what the parser tells of it.
//!
//! Words are taken as by PyYAML, which is what descriptions and maps are written for: as YAML 1.1 has them, with `<<` that merges.

use std::collections::BTreeMap;

use saphyr_parser::{Event, Parser, ScalarStyle, Tag};

use super::{scalar::plain, value::YamlValue};
use crate::limits::{MOST_NESTING, MOST_YAML_VALUES};

/// What is wrong, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct YamlFault {
    pub at: usize,
    pub reason: String,
}

/// Reads the first document of a file.
pub(crate) fn read_yaml(text: &str) -> Result<YamlValue, YamlFault> {
    // The parser counts characters.
    let byte = |index: usize| text.char_indices().nth(index).map_or(text.len(), |(at, _)| at);
    let mut builder = ValueBuilder::default();
    for told in Parser::new_from_str(text) {
        let (event, span) = told
            .map_err(|error| YamlFault { at: byte(error.marker().index()), reason: error.info().into() })?;
        let done =
            builder.take(event).map_err(|reason| YamlFault { at: byte(span.start.index()), reason })?;
        if let Some(value) = done {
            return Ok(value);
        }
    }
    Ok(YamlValue::Null)
}

/// A value whose end has not come yet.
struct OpenValue {
    anchor: usize,
    kind: OpenKind,
}

enum OpenKind {
    List(Vec<YamlValue>),
    Map(OpenMap),
}

#[derive(Default)]
struct OpenMap {
    pairs: Vec<(YamlValue, YamlValue)>,
    /// Where the pair of a key is, by how the key is written for programmers.
    places: BTreeMap<String, usize>,
    key: Option<MapKey>,
    /// What `<<` brings in, the first before the others.
    merged: Vec<YamlValue>,
}

enum MapKey {
    Merge,
    Value(YamlValue),
}

/// Puts values together.
#[derive(Default)]
struct ValueBuilder {
    open: Vec<OpenValue>,
    /// By the parser's numbers of anchors, which are from 1.
    anchors: BTreeMap<usize, YamlValue>,
    /// How many values there are, those that aliases repeat with them.
    count: usize,
}

impl ValueBuilder {
    /// Takes what comes next; gives the document's value at its end, and says why there is none.
    fn take(&mut self, event: Event<'_>) -> Result<Option<YamlValue>, String> {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                self.counted(1)?;
                let is_plain = style == ScalarStyle::Plain && tag.is_none();
                if is_plain && text == "<<" && self.takes_merge() {
                    return Ok(None);
                }
                let value = match tag {
                    Some(tag) => YamlValue::Tagged(written(&tag), text.into_owned()),
                    None if is_plain => plain(&text),
                    None => YamlValue::Text(text.into_owned()),
                };
                self.put(anchor, value)
            }
            Event::Alias(anchor) => {
                let known = self.anchors.get(&anchor);
                let value = known.ok_or("an alias stands within what it is an alias of")?.clone();
                self.counted(size(&value))?;
                self.put(0, value)
            }
            Event::SequenceStart(anchor, tag) => {
                self.begin(anchor, tag.as_deref(), "seq", OpenKind::List(Vec::new())).map(|()| None)
            }
            Event::MappingStart(anchor, tag) => {
                self.begin(anchor, tag.as_deref(), "map", OpenKind::Map(OpenMap::default())).map(|()| None)
            }
            Event::SequenceEnd | Event::MappingEnd => match self.open.pop() {
                Some(OpenValue { anchor, kind: OpenKind::List(items) }) => {
                    self.put(anchor, YamlValue::List(items))
                }
                Some(OpenValue { anchor, kind: OpenKind::Map(map) }) => self.put(anchor, map.close()),
                None => Ok(None),
            },
            Event::DocumentStart(_) | Event::StreamStart | Event::Nothing => Ok(None),
            Event::DocumentEnd | Event::StreamEnd => Ok(Some(YamlValue::Null)),
        }
    }

    fn counted(&mut self, more: usize) -> Result<(), String> {
        self.count += more;
        if self.count > MOST_YAML_VALUES {
            return Err(format!(
                "there are more than {MOST_YAML_VALUES} values, with those that aliases repeat"
            ));
        }
        Ok(())
    }

    fn begin(
        &mut self,
        anchor: usize,
        tag: Option<&Tag>,
        allowed: &str,
        kind: OpenKind,
    ) -> Result<(), String> {
        self.counted(1)?;
        if let Some(tag) = tag.filter(|tag| !tag.is_yaml_core_schema() || tag.suffix != allowed) {
            return Err(format!("the tag `{}` of a list or mapping is not read", written(tag)));
        }
        if self.open.len() >= MOST_NESTING {
            return Err(format!("lists and mappings lie deeper than {MOST_NESTING} in each other"));
        }
        self.open.push(OpenValue { anchor, kind });
        Ok(())
    }

    /// Whether a key is awaited, so that `<<` merges.
    fn takes_merge(&mut self) -> bool {
        let Some(OpenValue { kind: OpenKind::Map(map), .. }) = self.open.last_mut() else { return false };
        let is_key = map.key.is_none();
        if is_key {
            map.key = Some(MapKey::Merge);
        }
        is_key
    }

    /// A whole value: that of the document if nothing is open.
    fn put(&mut self, anchor: usize, value: YamlValue) -> Result<Option<YamlValue>, String> {
        if anchor != 0 {
            self.anchors.insert(anchor, value.clone());
        }
        let Some(OpenValue { kind, .. }) = self.open.last_mut() else { return Ok(Some(value)) };
        match kind {
            OpenKind::List(items) => items.push(value),
            OpenKind::Map(map) => match map.key.take() {
                None => map.key = Some(MapKey::Value(value)),
                Some(MapKey::Value(key)) => map.put(key, value),
                Some(MapKey::Merge) => map.merge(value)?,
            },
        }
        Ok(None)
    }
}

impl OpenMap {
    fn merge(&mut self, value: YamlValue) -> Result<(), String> {
        match value {
            YamlValue::Map(_) => self.merged.push(value),
            YamlValue::List(items) if items.iter().all(|item| matches!(item, YamlValue::Map(_))) => {
                self.merged.extend(items);
            }
            YamlValue::Null
            | YamlValue::Bool(_)
            | YamlValue::Int(_)
            | YamlValue::Float(_)
            | YamlValue::Text(_)
            | YamlValue::List(_)
            | YamlValue::Tagged(..) => return Err("`<<` merges a mapping, or a list of mappings".to_owned()),
        }
        Ok(())
    }

    /// Of two values of one key the later counts, as for the readers that descriptions are written for.
    fn put(&mut self, key: YamlValue, value: YamlValue) {
        let next = self.pairs.len();
        let place = *self.places.entry(format!("{key:?}")).or_insert(next);
        match self.pairs.get_mut(place) {
            Some((_, old)) => *old = value,
            None => self.pairs.push((key, value)),
        }
    }

    /// Its own pairs, and those of merged mappings whose keys it does not have.
    fn close(mut self) -> YamlValue {
        for map in std::mem::take(&mut self.merged) {
            let YamlValue::Map(others) = map else { continue };
            for (key, value) in others {
                if !self.places.contains_key(&format!("{key:?}")) {
                    self.put(key, value);
                }
            }
        }
        YamlValue::Map(self.pairs)
    }
}

/// A tag as files have it: `!degrees`, `!!str`.
fn written(tag: &Tag) -> String {
    let handle = if tag.is_yaml_core_schema() { "!!" } else { &tag.handle };
    format!("{handle}{}", tag.suffix)
}

/// How many values are in one, with itself.
fn size(value: &YamlValue) -> usize {
    match value {
        YamlValue::List(items) => 1 + items.iter().map(size).sum::<usize>(),
        YamlValue::Map(pairs) => 1 + pairs.iter().map(|(key, value)| size(key) + size(value)).sum::<usize>(),
        YamlValue::Null
        | YamlValue::Bool(_)
        | YamlValue::Int(_)
        | YamlValue::Float(_)
        | YamlValue::Text(_)
        | YamlValue::Tagged(..) => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use YamlValue::{Bool, Float, Int, List, Map, Null, Tagged, Text};

    fn text(text: &str) -> YamlValue {
        Text(text.to_owned())
    }

    fn map(pairs: Vec<(&str, YamlValue)>) -> YamlValue {
        Map(pairs.into_iter().map(|(k, v)| (text(k), v)).collect())
    }

    #[test]
    fn blocks_brackets_and_scalars() {
        let read = read_yaml(
            "# map\n---\nimage: a.pgm   # the picture\norigin: [-1.5, 2, 0.0]\nlimits:\n  j1: {lo: !degrees -90, hi: 1e3}\n  \
             j2:\n    - 1\n    - x: yes\n      y: '#no'\n    -\n      - ~\nlist:\n- a\n- \"b: \\\"c\\\"\"\nempty:\n---\nother: 1\n",
        );
        let tagged = Tagged("!degrees".into(), "-90".into());
        let expected = map(vec![
            ("image", text("a.pgm")),
            ("origin", List(vec![Float(-1.5), Int(2), Float(0.0)])),
            (
                "limits",
                map(vec![
                    ("j1", map(vec![("lo", tagged), ("hi", text("1e3"))])),
                    (
                        "j2",
                        List(vec![
                            Int(1),
                            map(vec![("x", Bool(true)), ("y", text("#no"))]),
                            List(vec![Null]),
                        ]),
                    ),
                ]),
            ),
            ("list", List(vec![text("a"), text("b: \"c\"")])),
            ("empty", Null),
        ]);
        assert_eq!(read, Ok(expected));
        assert_eq!(read_yaml(""), Ok(Null));
        assert_eq!(read_yaml("# nothing\n"), Ok(Null));
    }

    #[test]
    fn what_is_said_once_is_meant_several_times() {
        let finger = || map(vec![("mass", Float(0.5)), ("size", List(vec![Int(1), Int(2)]))]);
        let read = |source| read_yaml(source).unwrap();
        assert_eq!(
            read("left: &finger\n  mass: 0.5\n  size: [1, 2]\nright: *finger\n"),
            map(vec![("left", finger()), ("right", finger())])
        );
        // A mapping's own pairs go before merged ones, and of those the first.
        let merged = "a: &a {x: 1, y: 2}\nb: &b {y: 3, z: 4}\nc:\n  y: 9\n  <<: [*b, *a]\n'<<': 5\n";
        let c = map(vec![("y", Int(9)), ("z", Int(4)), ("x", Int(1))]);
        let Map(pairs) = read(merged) else { panic!("a mapping") };
        assert_eq!(pairs[2], (text("c"), c));
        assert_eq!(pairs[3], (text("<<"), Int(5)));
        assert_eq!(
            read("a: |\n  b\n  c\nd: >\n  e\n  f\n"),
            map(vec![("a", text("b\nc\n")), ("d", text("e f\n"))])
        );
        assert_eq!(read("!!str 1"), Tagged("!!str".into(), "1".into()));
        assert_eq!(read("!!map {a: 1}"), map(vec![("a", Int(1))]));
        assert_eq!(read("a: 1\na: 2\n"), map(vec![("a", Int(2))]));
    }

    #[test]
    fn what_is_not_read_is_refused_at_its_place() {
        let bomb = (0..30)
            .fold("a: &x0 [1]\n".to_owned(), |text, n| format!("{text}b{n}: &x{} [*x{n}, *x{n}]\n", n + 1));
        let deep = "[".repeat(MOST_NESTING + 1);
        for (source, at, word) in [
            ("a: [1, 2\n", None, ""),
            ("a: 1\n  b: 2\n", Some(8), ""),
            ("<<: 1\n", Some(4), "merges"),
            ("é: *a\n", Some(4), ""),
            ("a: &a [*a]\n", Some(7), "within"),
            ("a: 'b\n", None, ""),
            ("a: !what [1]\n", Some(3), "!what"),
            (&bomb, None, "aliases repeat"),
            (&deep, Some(MOST_NESTING), "deeper"),
        ] {
            let fault = read_yaml(source).unwrap_err();
            assert!(
                at.is_none_or(|at| at == fault.at) && fault.reason.contains(word),
                "{source:?}: {fault:?}"
            );
        }
    }
}
