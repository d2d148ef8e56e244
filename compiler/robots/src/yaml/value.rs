//! What a YAML file says.

/// A value; mappings in the order of the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum YamlValue {
    Null,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<YamlValue>),
    Map(Vec<(YamlValue, YamlValue)>),
    /// `!degrees 90`: the text of a scalar under a tag, which whoever reads it understands or not.
    Tagged(String, String),
}

impl YamlValue {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&YamlValue> {
        let YamlValue::Map(pairs) = self else { return None };
        pairs.iter().find(|(k, _)| matches!(k, YamlValue::Text(text) if text == key)).map(|(_, value)| value)
    }

    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Int(number) => Some(*number as f64),
            Self::Float(number) => Some(*number),
            Self::Null | Self::Bool(_) | Self::Text(_) | Self::List(_) | Self::Map(_) | Self::Tagged(..) => {
                None
            }
        }
    }
}
