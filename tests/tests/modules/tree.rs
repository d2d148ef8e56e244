//! The modules of a crate as they are written: what each defines, what it makes visible, and which paths it names.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    Attribute, Item, Meta, UseTree,
    visit::{self, Visit},
};

pub type ModuleId = usize;

/// A module: a file, or a part of one.
#[derive(Default)]
pub struct Module {
    pub parent: Option<ModuleId>,
    /// The file, from the crate's `src`.
    pub file: String,
    pub children: BTreeMap<String, ModuleId>,
    /// Names of the items that it defines.
    pub items: BTreeSet<String>,
    /// Words in macros between its items, some of which become items.
    pub perhaps: BTreeSet<String>,
    /// What it brings into its scope, by the name in that scope.
    pub uses: BTreeMap<String, Vec<Vec<String>>>,
    /// Modules that it brings into its scope with all that is in them.
    pub globs: Vec<Vec<String>>,
    /// All paths that it names, those of its `use` among them.
    pub paths: BTreeSet<Vec<String>>,
}

/// A file: what it says about itself.
pub struct File {
    /// The first sentence of its inner doc comment.
    pub sentence: Option<String>,
}

/// One target of a crate: a library or a program.
pub struct Tree {
    /// The root module is the first.
    pub modules: Vec<Module>,
    pub files: BTreeMap<String, File>,
    src: PathBuf,
}

impl Tree {
    /// The modules from the file `root` on.
    pub fn read(src: &Path, root: &Path) -> Self {
        let mut tree = Self { modules: Vec::new(), files: BTreeMap::new(), src: src.to_owned() };
        tree.file(None, root, root.parent().unwrap());
        tree
    }

    /// `folder` is where the modules that the file declares are.
    fn file(&mut self, parent: Option<ModuleId>, path: &Path, folder: &Path) -> ModuleId {
        let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let file = path.strip_prefix(&self.src).unwrap().display().to_string();
        self.files.insert(file.clone(), File { sentence: sentence(&parsed.attrs) });
        self.module(parent, file, &parsed.items, folder)
    }

    fn module(&mut self, parent: Option<ModuleId>, file: String, items: &[Item], folder: &Path) -> ModuleId {
        let id = self.modules.len();
        self.modules.push(Module { parent, file: file.clone(), ..Module::default() });
        for item in items {
            if only_for_tests(attributes(item)) {
                continue;
            }
            self.define(id, item);
            if let Item::Mod(module) = item {
                let name = module.ident.to_string();
                let child = match &module.content {
                    Some((_, items)) => self.module(Some(id), file.clone(), items, &folder.join(&name)),
                    None => {
                        let inside = folder.join(&name);
                        let plain = folder.join(format!("{name}.rs"));
                        let path = if plain.exists() { plain } else { inside.join("mod.rs") };
                        self.file(Some(id), &path, &inside)
                    }
                };
                self.modules[id].children.insert(name, child);
            } else {
                Paths { module: &mut self.modules[id], within: 0 }.visit_item(item);
            }
        }
        id
    }

    fn define(&mut self, id: ModuleId, item: &Item) {
        let module = &mut self.modules[id];
        let name = match item {
            Item::Const(i) => &i.ident,
            Item::Enum(i) => &i.ident,
            Item::Fn(i) => &i.sig.ident,
            Item::Static(i) => &i.ident,
            Item::Struct(i) => &i.ident,
            Item::Trait(i) => &i.ident,
            Item::TraitAlias(i) => &i.ident,
            Item::Type(i) => &i.ident,
            Item::Union(i) => &i.ident,
            Item::Macro(i) => {
                words(&i.mac.tokens, &mut module.perhaps);
                match &i.ident {
                    Some(name) => name,
                    None => return,
                }
            }
            // Impls, modules, foreign items: nothing that is imported by its name from here.
            _ => return,
        };
        module.items.insert(name.to_string());
    }
}

/// Collects the paths of a module.
struct Paths<'m> {
    module: &'m mut Module,
    /// How many functions are around: what they import is in their own scope.
    within: usize,
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if only_for_tests(attributes(item)) {
            return;
        }
        self.within += usize::from(matches!(item, Item::Fn(_) | Item::Impl(_) | Item::Trait(_)));
        visit::visit_item(self, item);
        self.within -= usize::from(matches!(item, Item::Fn(_) | Item::Impl(_) | Item::Trait(_)));
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !only_for_tests(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        // `::a` is another crate's.
        if item.leading_colon.is_none() {
            imports(&item.tree, &mut Vec::new(), self.module, self.within > 0);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.module.paths.insert(path.segments.iter().map(|s| s.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    /// `pub(in path)` imports nothing.
    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let Meta::List(list) = &attribute.meta {
            in_tokens(&list.tokens, &mut self.module.paths);
        }
    }

    fn visit_macro(&mut self, mac: &'ast syn::Macro) {
        self.visit_path(&mac.path);
        in_tokens(&mac.tokens, &mut self.module.paths);
    }
}

/// `within`: in a function, whose imports give way to those of the module.
fn imports(tree: &UseTree, before: &mut Vec<String>, module: &mut Module, within: bool) {
    let mut bring = |name: String, path: Vec<String>| {
        module.paths.insert(path.clone());
        let known = module.uses.entry(name).or_default();
        if known.is_empty() || !within {
            known.push(path);
        }
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.to_string());
            imports(&path.tree, before, module, within);
            before.pop();
        }
        UseTree::Name(name) if name.ident == "self" => {
            bring(before.last().cloned().unwrap_or_default(), before.clone());
        }
        UseTree::Name(name) => {
            let name = name.ident.to_string();
            bring(name.clone(), [before.clone(), vec![name]].concat());
        }
        UseTree::Rename(rename) if rename.ident == "self" => bring(rename.rename.to_string(), before.clone()),
        UseTree::Rename(rename) => {
            bring(rename.rename.to_string(), [before.clone(), vec![rename.ident.to_string()]].concat());
        }
        UseTree::Glob(_) => module.globs.push(before.clone()),
        UseTree::Group(group) => group.items.iter().for_each(|t| imports(t, before, module, within)),
    }
}

/// Paths of two and more words in the arguments of a macro, and single words, which may be imported by `*`.
fn in_tokens(tokens: &TokenStream, paths: &mut BTreeSet<Vec<String>>) {
    let (mut path, mut colons): (Vec<String>, usize) = (Vec::new(), 0);
    for token in tokens.clone() {
        match token {
            TokenTree::Ident(word) => {
                if colons < 2 && !path.is_empty() {
                    paths.insert(std::mem::take(&mut path));
                }
                path.push(word.to_string());
                colons = 0;
            }
            TokenTree::Punct(mark) if mark.as_char() == ':' && !path.is_empty() => colons += 1,
            TokenTree::Group(group) => {
                in_tokens(&group.stream(), paths);
                paths.insert(std::mem::take(&mut path));
                colons = 0;
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {
                paths.insert(std::mem::take(&mut path));
                colons = 0;
            }
        }
    }
    paths.insert(path);
    paths.remove(&Vec::new());
}

fn words(tokens: &TokenStream, into: &mut BTreeSet<String>) {
    for token in tokens.clone() {
        match token {
            TokenTree::Ident(word) => {
                into.insert(word.to_string());
            }
            TokenTree::Group(group) => words(&group.stream(), into),
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}

/// `#[cfg(test)]`, alone or with others.
fn only_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|a| match &a.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let mut said = BTreeSet::new();
            words(&list.tokens, &mut said);
            said.contains("test") && !said.contains("not") && !said.contains("any")
        }
        Meta::List(_) | Meta::Path(_) | Meta::NameValue(_) => false,
    })
}

/// The first sentence of `//!`.
fn sentence(attributes: &[Attribute]) -> Option<String> {
    let line = |a: &Attribute| match &a.meta {
        Meta::NameValue(doc) if doc.path.is_ident("doc") => match &doc.value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        Meta::NameValue(_) | Meta::List(_) | Meta::Path(_) => None,
    };
    let paragraph: Vec<String> =
        attributes.iter().filter_map(line).take_while(|l| !l.trim().is_empty()).collect();
    let text = paragraph.iter().map(|l| l.trim()).collect::<Vec<_>>().join(" ");
    let end = text.find(". ").map_or(text.as_str(), |end| &text[..end]);
    let end = end.trim_end_matches(['.', ':']).trim();
    (!end.is_empty()).then(|| end.to_owned())
}
