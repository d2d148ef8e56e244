//! Values of YAML files as values of expressions, with the units that xacro knows.

use super::{
    evaluate::{ExprNames, evaluate},
    parse::parse_expression,
    value::{EvalResult, XacroValue, not_done, wrong},
};
use crate::yaml::value::YamlValue;

/// What a number under a tag is multiplied by.
const UNITS: [(&str, f64); 6] = [
    ("!radians", 1.0),
    ("!degrees", std::f64::consts::PI / 180.0),
    ("!meters", 1.0),
    ("!millimeters", 0.001),
    ("!foot", 0.3048),
    ("!inches", 0.0254),
];

/// In a YAML file only Python's own names are known.
struct NoNames;

impl ExprNames for NoNames {
    fn lookup(&mut self, _: &[String]) -> EvalResult<Option<(XacroValue, usize)>> {
        Ok(None)
    }

    fn outer(&mut self, name: &str, _: &[XacroValue]) -> EvalResult<XacroValue> {
        not_done(format!("`{name}` in a YAML file"), "write the number")
    }

    fn all_names(&self) -> Vec<String> {
        Vec::new()
    }
}

pub(super) fn value_of(yaml: &YamlValue) -> EvalResult<XacroValue> {
    match yaml {
        YamlValue::Null => Ok(XacroValue::None),
        YamlValue::Bool(value) => Ok(XacroValue::Bool(*value)),
        YamlValue::Int(value) => Ok(XacroValue::Int(*value)),
        YamlValue::Float(value) => Ok(XacroValue::Float(*value)),
        YamlValue::Text(text) => XacroValue::text(text),
        YamlValue::List(items) => XacroValue::list(items.iter().map(value_of).collect::<EvalResult<_>>()?),
        YamlValue::Map(pairs) => {
            let pairs = pairs.iter().map(|(key, value)| Ok((value_of(key)?, value_of(value)?)));
            XacroValue::dict(pairs.collect::<EvalResult<_>>()?)
        }
        YamlValue::Tagged(tag, text) => match (tag.as_str(), UNITS.iter().find(|(unit, _)| unit == tag)) {
            (_, Some((_, factor))) => {
                let value = evaluate(&parse_expression(text)?, &mut NoNames)?;
                match value.number() {
                    Some(number) => Ok(XacroValue::Float(number * factor)),
                    None => wrong(format!("`{tag} {text}` is no number"), "write a number behind the unit"),
                }
            }
            ("!!str", None) => XacroValue::text(text),
            (_, None) => not_done(format!("tag `{tag}` of YAML"), "write a number without it"),
        },
    }
}
