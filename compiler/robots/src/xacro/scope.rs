//! Scopes: properties, blocks, macros and namespaces, each with what lies around it.

use std::{collections::BTreeMap, rc::Rc};

use super::{parameters::MacroParameter, value::XacroValue};
use crate::{fault::RobotPlace, xml::XmlElement};

/// Index into [`XacroScopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ScopeId(usize);

/// The scope of the description itself.
pub(super) const TOP: ScopeId = ScopeId(0);

/// All scopes that are open, and those of namespaces.
#[derive(Debug, Default)]
pub(super) struct XacroScopes {
    scopes: Vec<XacroScope>,
}

#[derive(Debug, Default)]
struct XacroScope {
    parent: Option<ScopeId>,
    /// Of an include with `ns`, not of a macro.
    is_space: bool,
    symbols: BTreeMap<String, XacroSymbol>,
    /// By their names with the stars before them.
    blocks: BTreeMap<String, Rc<XmlElement>>,
    macros: BTreeMap<String, Rc<XacroMacro>>,
    spaces: BTreeMap<String, ScopeId>,
}

/// What a property is.
#[derive(Clone, Debug)]
pub(super) enum XacroSymbol {
    Value(XacroValue),
    /// EvalResult when it is first asked for.
    Text(Rc<str>, RobotPlace),
    /// That is being done.
    Busy,
}

#[derive(Debug)]
pub(super) struct XacroMacro {
    pub parameters: Vec<MacroParameter>,
    /// Of `params`, or of the macro's name.
    pub place: RobotPlace,
    pub body: XmlElement,
}

impl XacroScopes {
    /// With the scope of the description.
    pub fn new() -> Self {
        Self { scopes: vec![XacroScope::default()] }
    }

    /// A new scope within another.
    pub fn open(&mut self, parent: ScopeId, is_space: bool) -> ScopeId {
        self.scopes.push(XacroScope { parent: Some(parent), is_space, ..XacroScope::default() });
        ScopeId(self.scopes.len() - 1)
    }

    /// Drops a scope and all that were opened after it.
    pub fn close(&mut self, scope: ScopeId) {
        self.scopes.truncate(scope.0.max(1));
    }

    fn get(&self, scope: ScopeId) -> Option<&XacroScope> {
        self.scopes.get(scope.0)
    }

    /// A scope, and those around it from the inside.
    fn outwards(&self, scope: ScopeId) -> impl Iterator<Item = (ScopeId, &XacroScope)> {
        let next = |(_, scope): &(ScopeId, &XacroScope)| {
            let parent = scope.parent?;
            Some((parent, self.get(parent)?))
        };
        std::iter::successors(self.get(scope).map(|found| (scope, found)), next)
    }

    /// The property of this name, and the scope that has it.
    pub fn symbol(&self, scope: ScopeId, name: &str) -> Option<(ScopeId, XacroSymbol)> {
        self.outwards(scope).find_map(|(id, scope)| Some((id, scope.symbols.get(name)?.clone())))
    }

    pub fn set(&mut self, scope: ScopeId, name: &str, symbol: XacroSymbol) {
        if let Some(scope) = self.scopes.get_mut(scope.0) {
            scope.symbols.insert(name.to_owned(), symbol);
        }
    }

    /// Takes a property away, wherever it is.
    pub fn remove(&mut self, scope: ScopeId, name: &str) {
        let all: Vec<ScopeId> = self.outwards(scope).map(|(id, _)| id).collect();
        for ScopeId(id) in all {
            if let Some(scope) = self.scopes.get_mut(id) {
                scope.symbols.remove(name);
            }
        }
    }

    pub fn block(&self, scope: ScopeId, name: &str) -> Option<Rc<XmlElement>> {
        self.outwards(scope).find_map(|(_, scope)| scope.blocks.get(name).cloned())
    }

    pub fn set_block(&mut self, scope: ScopeId, name: &str, block: XmlElement) {
        if let Some(scope) = self.scopes.get_mut(scope.0) {
            scope.blocks.insert(name.to_owned(), Rc::new(block));
        }
    }

    /// The macro of this name.
    pub fn find_macro(&self, scope: ScopeId, name: &str) -> Option<Rc<XacroMacro>> {
        self.outwards(scope).find_map(|(_, scope)| scope.macros.get(name).cloned())
    }

    pub fn set_macro(&mut self, scope: ScopeId, name: &str, definition: XacroMacro) {
        if let Some(scope) = self.scopes.get_mut(scope.0) {
            scope.macros.insert(name.to_owned(), Rc::new(definition));
        }
    }

    pub fn space(&self, scope: ScopeId, name: &str) -> Option<ScopeId> {
        self.outwards(scope).find_map(|(_, scope)| scope.spaces.get(name).copied())
    }

    pub fn set_space(&mut self, scope: ScopeId, name: &str, space: ScopeId) {
        if let Some(scope) = self.scopes.get_mut(scope.0) {
            scope.spaces.insert(name.to_owned(), space);
        }
    }

    /// Where `scope="parent"` puts a property: the scope of the caller, past namespaces.
    pub fn parent(&self, scope: ScopeId) -> Option<ScopeId> {
        let here = self.get(scope)?;
        let parent = here.parent?;
        if here.is_space {
            return Some(parent);
        }
        self.outwards(parent).find(|(_, scope)| !scope.is_space).map(|(id, _)| id)
    }

    /// The names of all properties and namespaces that can be seen from a scope.
    pub fn names(&self, scope: ScopeId) -> Vec<String> {
        self.outwards(scope)
            .flat_map(|(_, scope)| scope.symbols.keys().chain(scope.spaces.keys()))
            .cloned()
            .collect()
    }

    pub fn macro_names(&self, scope: ScopeId) -> Vec<String> {
        self.outwards(scope).flat_map(|(_, scope)| scope.macros.keys()).cloned().collect()
    }

    pub fn block_names(&self, scope: ScopeId) -> Vec<String> {
        let names = self.outwards(scope).flat_map(|(_, scope)| scope.blocks.keys());
        names.map(|name| name.trim_start_matches('*').to_owned()).collect()
    }
}
