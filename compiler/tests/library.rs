//! The table of the library's parts, which tells what module to use, is that of the library.

use hrdsl_model::LIBRARY_PARTS;
use hrdsl_source::FileId;
use hrdsl_stdlib::MODULES;
use hrdsl_syntax::{ast::ItemSyntaxKind, parse};

#[test]
fn the_table_of_parts_is_that_of_the_library() {
    let mut parts = Vec::new();
    for (module, text) in MODULES {
        for item in parse(FileId(0), text).0.items {
            if let ItemSyntaxKind::Part(part) = item.kind {
                parts.push((part.name.text, *module));
            }
        }
    }
    parts.sort();
    assert_eq!(parts, LIBRARY_PARTS.iter().map(|(p, m)| ((*p).to_owned(), *m)).collect::<Vec<_>>());
}
