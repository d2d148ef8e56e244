//! What the schema says of types that are not declared here: each is one of some words.

use hrdsl_ir::{monitor::RequirementKind, suite::CoverItemKind, test::TestMethod};
use hrdsl_trace::RunEnd;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::Serialize;

pub fn test_method(_: &mut SchemaGenerator) -> Schema {
    words(&TestMethod::ALL)
}

pub fn run_end(_: &mut SchemaGenerator) -> Schema {
    words(&RunEnd::ALL)
}

pub fn requirement_kind(_: &mut SchemaGenerator) -> Schema {
    words(&[RequirementKind::Safety, RequirementKind::Functional])
}

pub fn item_kind(_: &mut SchemaGenerator) -> Schema {
    words(&CoverItemKind::ALL)
}

fn words<T: Serialize>(all: &[T]) -> Schema {
    json_schema!({ "type": "string", "enum": all })
}
