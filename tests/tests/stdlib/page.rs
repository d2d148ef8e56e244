//! The page of the standard library, made from the modules' comments.

use std::fmt::Write;

use crate::library::{Declaration, Module};

const HEAD: &str = "\
# The standard library

The modules that come with hrdsl, written in the language. `use std.person` makes what a module declares visible; parts are put
into the world, templates become instances ([world.md](world.md#parts), [requirements.md](requirements.md)).

This page is made from the comments in `stdlib/`. Of each module it shows a scenario; the examples under the declarations
stand where that has `// …`, and all of them together are compiled by a test.
";

pub fn page(modules: &[Module]) -> String {
    let mut page = HEAD.to_owned();
    page += "\n| module | declares |\n|---|---|\n";
    for module in modules {
        let names: Vec<String> = module.declarations.iter().map(|d| format!("`{}`", d.name)).collect();
        let anchor = module.path.replace('.', "");
        writeln!(page, "| [`{}`](#{anchor}) | {} |", module.path, names.join(", ")).unwrap();
    }
    for module in modules {
        write!(page, "\n## {}\n\n{}\n", module.path, module.about).unwrap();
        if !module.frame.is_empty() {
            write!(page, "\n```hri,piece\n{}```\n", module.frame).unwrap();
        }
        for declaration in &module.declarations {
            entry(&mut page, declaration);
        }
    }
    page
}

fn entry(page: &mut String, d: &Declaration) {
    write!(page, "\n### {}\n\n```text\n{}\n```\n\n", d.name, d.text).unwrap();
    let doc =
        d.doc.replace("```hri\n", "```hri,piece\n").replace("```hri,piece\nscenario", "```hri\nscenario");
    writeln!(page, "{doc}").unwrap();
    if !d.members.is_empty() {
        page.push_str("\n| has | | |\n|---|---|---|\n");
    }
    for (sort, name, doc) in &d.members {
        writeln!(page, "| {sort} | `{name}` | {} |", doc.replace('\n', " ")).unwrap();
    }
}
