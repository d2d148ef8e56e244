//! Scopes: what an expression can see besides constants.

use super::table::OrderedMap;
use std::rc::Rc;

use hrdsl_source::Span;

use crate::{AutomatonVar, FunctionId, InferredType, Type, VariableRef, noun::Noun, types::TypeLayout};

/// A name of the place's own scope.
#[derive(Clone, Debug)]
pub(crate) struct LocalName {
    pub name: String,
    pub noun: Noun,
    /// `None`: a clock, which has no value in an expression.
    pub leaf: Option<VariableRef>,
    pub ty: InferredType,
    /// Of a whole number, if its type says so.
    pub range: Option<(i64, i64)>,
    /// It has a value here.
    pub bound: bool,
    /// Its name, or that of what it is a part of, where it is declared.
    pub place: Span,
}

/// Names that many expressions see: the variables and clocks of an automaton, or the shared variables. The numbers of
/// the variables' leaves are their places.
#[derive(Clone, Debug, Default)]
pub(crate) struct NameScope {
    pub names: OrderedMap<String, LocalName>,
    /// Without values; of an array each element, and the array itself.
    pub clocks: OrderedMap<String, LocalName>,
    /// The sizes of the arrays of clocks.
    pub clock_arrays: OrderedMap<String, Vec<u16>>,
    /// As in [`ExprEnv::layouts`].
    pub layouts: OrderedMap<String, TypeLayout>,
    pub functions: OrderedMap<String, CallableFunction>,
    /// Of an automaton: where its locations are declared.
    pub locations: OrderedMap<String, Span>,
}

/// What a call of a function of automata needs to know.
#[derive(Clone, Debug)]
pub(crate) struct CallableFunction {
    pub id: FunctionId,
    /// A parameter whose type has a diagnostic is of unknown layout.
    pub params: Rc<[(String, TypeLayout)]>,
    /// `None`: it has no value; of a type with a diagnostic nothing is known.
    pub result: Option<Option<Type>>,
    /// Its name, where it is declared.
    pub span: Span,
}

/// Which arrays are indexed at run time. The others are taken apart, by indices that lie in them for certain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum IndexedArrays {
    #[default]
    None,
    /// Those of the automaton's and the shared variables.
    Variables,
    /// And those of locals: in a function.
    Locals,
}

impl NameScope {
    pub fn add_variable(&mut self, leaf: VariableRef, var: &AutomatonVar, place: Span) {
        let local = LocalName {
            name: var.name.clone(),
            noun: Noun::Variable,
            leaf: Some(leaf),
            ty: InferredType::of(var.ty()),
            range: var.ty().range(),
            bound: true,
            place,
        };
        self.names.insert(var.name.clone(), local);
    }

    pub fn add_clock(&mut self, name: &str, place: Span) {
        let (noun, ty) = (Noun::Clock, InferredType::Unknown);
        let clock =
            LocalName { name: name.to_owned(), noun, leaf: None, ty, range: None, bound: true, place };
        self.clocks.insert(name.to_owned(), clock);
    }
}

/// The scope of an expression.
#[derive(Clone, Debug, Default)]
pub(crate) struct ExprEnv {
    /// Variables that stand in a goal for what that gives.
    pub opened: Vec<hrdsl_syntax::ast::NameSyntax>,
    /// The place's own.
    pub locals: Vec<LocalName>,
    /// The automaton's.
    pub own: Rc<NameScope>,
    /// All automata's.
    pub shared: Rc<NameScope>,
    /// Names that stand for several locals, which are called `name.x` or `name[0]`.
    pub layouts: Vec<(String, TypeLayout)>,
    /// Names that are bound by something with a diagnostic: nothing is said about what they stand for.
    pub broken: Vec<String>,
    pub elements: IndexedArrays,
    /// A function that is called may change variables.
    pub effects: bool,
    /// Measurements are allowed; names of the world have this prefix (`robot.` inside of a part, else empty).
    pub world: Option<String>,
    /// Names that start with an upper-case letter are an agent's variables.
    pub plan: bool,
    /// What a name without a value is said not to be.
    pub noun: Option<Noun>,
}

impl ExprEnv {
    /// Only constants.
    pub fn constants() -> Self {
        Self::default()
    }

    /// Constants, signals and measurements.
    pub fn measured(prefix: &str) -> Self {
        Self { world: Some(prefix.to_owned()), noun: Some(Noun::Signal), ..Self::default() }
    }

    pub fn find(&self, name: &str) -> Option<&LocalName> {
        let local = self.locals.iter().find(|l| l.name == name);
        local
            .or_else(|| self.own.names.get(name))
            .or_else(|| self.own.clocks.get(name))
            .or_else(|| self.shared.names.get(name))
            .or_else(|| self.shared.clocks.get(name))
    }

    /// Where a name is declared that is a local's, or stands for several.
    pub fn place_of(&self, name: &str) -> Option<Span> {
        let part =
            |l: &&LocalName| l.name.strip_prefix(name).is_some_and(|rest| rest.starts_with(['.', '[']));
        self.find(name).or_else(|| self.all().find(part)).map(|l| l.place)
    }

    /// What a leaf stands for.
    pub fn of_leaf(&self, leaf: VariableRef) -> Option<&LocalName> {
        match leaf {
            VariableRef::Own(i) => self.own.names.get_index(usize::from(i)).map(|(_, local)| local),
            VariableRef::Shared(i) => self.shared.names.get_index(usize::from(i)).map(|(_, local)| local),
            VariableRef::Local(_) | VariableRef::Signal(_) => {
                self.locals.iter().find(|l| l.leaf == Some(leaf))
            }
        }
    }

    /// The function of automata of this name.
    pub fn function(&self, name: &str) -> Option<&CallableFunction> {
        self.own.functions.get(name).or_else(|| self.shared.functions.get(name))
    }

    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.own.functions.keys().chain(self.shared.functions.keys()).map(String::as_str)
    }

    /// All names, those of the place itself first.
    pub fn all(&self) -> impl Iterator<Item = &LocalName> {
        let own = self.own.names.values().chain(self.own.clocks.values());
        let shared = self.shared.names.values().chain(self.shared.clocks.values());
        self.locals.iter().chain(own).chain(shared)
    }

    /// The names that stand for several values.
    pub fn layout_names(&self) -> impl Iterator<Item = &str> {
        let local = self.layouts.iter().map(|(name, _)| name.as_str());
        local.chain(self.own.layouts.keys().chain(self.shared.layouts.keys()).map(String::as_str))
    }

    pub fn find_mut(&mut self, name: &str) -> Option<&mut LocalName> {
        self.locals.iter_mut().find(|l| l.name == name)
    }

    /// The number of the next [`VariableRef::LocalName`].
    pub fn next_local(&self) -> u16 {
        u16::try_from(self.locals.len()).unwrap_or(u16::MAX)
    }

    /// Adds a local without looking whether the name is free.
    pub fn push_local(&mut self, name: &str, place: Span, noun: Noun, ty: InferredType) -> u16 {
        let at = self.next_local();
        let leaf = Some(VariableRef::Local(at));
        self.locals.push(LocalName {
            name: name.to_owned(),
            noun,
            leaf,
            ty,
            range: None,
            bound: true,
            place,
        });
        at
    }

    /// The same for one whose type is declared.
    pub fn push_typed(&mut self, name: &str, place: Span, noun: Noun, ty: Type) -> u16 {
        let at = self.push_local(name, place, noun, InferredType::of(ty));
        if let Some(local) = self.locals.last_mut() {
            local.range = ty.range();
        }
        at
    }

    /// Says of what parts a name is.
    pub fn declare_layout(&mut self, name: &str, layout: TypeLayout) {
        if self.layout(name).is_none() {
            self.layouts.push((name.to_owned(), layout));
        }
    }

    pub fn layout(&self, name: &str) -> Option<&TypeLayout> {
        let local = self.layouts.iter().find(|(n, _)| n == name).map(|(_, layout)| layout);
        local.or_else(|| self.own.layouts.get(name)).or_else(|| self.shared.layouts.get(name))
    }

    /// A variable is of this kind, which was not known before.
    pub fn refine(&mut self, leaf: VariableRef, ty: InferredType) {
        if let Some(local) = self.locals.iter_mut().find(|l| l.leaf == Some(leaf)) {
            local.ty = local.ty.with(ty).unwrap_or(local.ty);
        }
    }
}

/// Whether names like this are an agent's variables.
pub(crate) fn is_variable_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_uppercase())
}
