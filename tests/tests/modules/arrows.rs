//! Which file imports what from which: each path leads to the file that defines what it names.

use std::collections::{BTreeMap, BTreeSet};

use crate::tree::{ModuleId, Tree};

/// From a file to those that define what it imports, with the names.
pub type Arrows = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// What a path leads to.
#[derive(Clone, PartialEq, Eq)]
enum Target {
    Module(ModuleId),
    /// An item, in the module that defines it.
    Item(ModuleId, String),
}

/// What is asked for when a module and an item have the same name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    Module,
    Item,
}

/// How many `pub use` may follow each other.
const DEPTH: usize = 24;

/// All arrows between different files of a target. The root imports nothing: it is the façade.
pub fn arrows(tree: &Tree) -> Arrows {
    let mut all: Arrows = tree.files.keys().map(|f| (f.clone(), BTreeMap::new())).collect();
    let facade = &tree.modules[0].file;
    for (id, module) in tree.modules.iter().enumerate() {
        if module.file == *facade {
            continue;
        }
        for path in &module.paths {
            // A module that is only named gives no arrow; what is used of it does.
            let Some(Target::Item(of, name)) = tree.resolve(id, path, DEPTH) else { continue };
            let to = &tree.modules[of].file;
            if *to != module.file {
                all.entry(module.file.clone()).or_default().entry(to.clone()).or_default().insert(name);
            }
        }
    }
    all
}

impl Tree {
    fn resolve(&self, from: ModuleId, path: &[String], depth: usize) -> Option<Target> {
        let depth = depth.checked_sub(1)?;
        let (first, mut rest) = path.split_first()?;
        let wanted = |rest: &[String]| if rest.is_empty() { Wanted::Item } else { Wanted::Module };
        let mut at = match first.as_str() {
            "crate" => Target::Module(0),
            "self" => Target::Module(from),
            "super" => Target::Module(self.modules[from].parent?),
            name => self.lookup(from, name, wanted(rest), depth)?,
        };
        while let (Target::Module(module), Some((name, more))) = (&at, rest.split_first()) {
            rest = more;
            at = match name.as_str() {
                "super" => Target::Module(self.modules[*module].parent?),
                "self" => at,
                name => self.lookup(*module, name, wanted(more), depth)?,
            };
        }
        Some(at)
    }

    fn lookup(&self, module: ModuleId, name: &str, wanted: Wanted, depth: usize) -> Option<Target> {
        let depth = depth.checked_sub(1)?;
        let here = &self.modules[module];
        let child = here.children.get(name).map(|child| Target::Module(*child));
        let item = here.items.contains(name).then(|| Target::Item(module, name.to_owned()));
        let brought = here.uses.get(name).into_iter().flatten();
        let mut found: Vec<Target> =
            brought.filter_map(|path| self.resolve_as(module, path, wanted, depth)).collect();
        found.extend(item.into_iter().chain(child));
        let fits = |t: &&Target| matches!(t, Target::Module(_)) == (wanted == Wanted::Module);
        if let Some(target) = found.iter().find(fits).or(found.first()) {
            return Some(target.clone());
        }
        let in_glob = |path: &Vec<String>| match self.resolve_as(module, path, Wanted::Module, depth)? {
            Target::Module(of) if of != module => self.lookup(of, name, wanted, depth),
            Target::Module(_) | Target::Item(..) => None,
        };
        if let Some(target) = here.globs.iter().find_map(in_glob) {
            return Some(target);
        }
        here.perhaps.contains(name).then(|| Target::Item(module, name.to_owned()))
    }

    /// As `resolve`, but what the last word stands for is said.
    fn resolve_as(&self, from: ModuleId, path: &[String], wanted: Wanted, depth: usize) -> Option<Target> {
        match (wanted, path.split_last()) {
            (Wanted::Module, Some((last, before))) if !before.is_empty() => {
                match self.resolve(from, path, depth)? {
                    Target::Module(module) => Some(Target::Module(module)),
                    item @ Target::Item(..) => match self.resolve_as(from, before, Wanted::Module, depth)? {
                        Target::Module(of) => self.lookup(of, last, Wanted::Module, depth).or(Some(item)),
                        Target::Item(..) => Some(item),
                    },
                }
            }
            (Wanted::Module | Wanted::Item, _) => self.resolve(from, path, depth),
        }
    }
}
