//! What an expression can see besides constants.

use hrdsl_source::Span;
use hrdsl_syntax::ast::Name;

use super::Checker;
use crate::{Kind, Leaf, Type, noun::Noun, report::names::duplicate};

/// A name of the place's own scope.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    pub name: String,
    pub noun: Noun,
    /// `None`: a clock, which has no value in an expression.
    pub leaf: Option<Leaf>,
    pub ty: Kind,
    /// It has a value here.
    pub bound: bool,
}

/// The scope of an expression.
#[derive(Clone, Debug, Default)]
pub(crate) struct Env {
    pub locals: Vec<Local>,
    /// Measurements are allowed; names of the world have this prefix (`robot.` inside of a part, else empty).
    pub world: Option<String>,
    /// Names that start with an upper-case letter are an agent's variables.
    pub plan: bool,
    /// What a name without a value is said not to be.
    pub noun: Option<Noun>,
}

impl Env {
    /// Only constants.
    pub fn constants() -> Self {
        Self::default()
    }

    /// Constants, signals and measurements.
    pub fn measured(prefix: &str) -> Self {
        Self { world: Some(prefix.to_owned()), noun: Some(Noun::Signal), ..Self::default() }
    }

    pub fn find(&self, name: &str) -> Option<&Local> {
        self.locals.iter().find(|l| l.name == name)
    }

    pub fn find_mut(&mut self, name: &str) -> Option<&mut Local> {
        self.locals.iter_mut().find(|l| l.name == name)
    }

    /// How many names are [`Leaf::Local`]: the next one's number.
    pub fn next_local(&self) -> u16 {
        let n = self.locals.iter().filter(|l| matches!(l.leaf, Some(Leaf::Local(_)))).count();
        u16::try_from(n).unwrap_or(u16::MAX)
    }

    /// Adds a local without looking whether the name is free.
    pub fn push_local(&mut self, name: &str, noun: Noun, ty: Kind) -> u16 {
        let at = self.next_local();
        self.locals.push(Local { name: name.to_owned(), noun, leaf: Some(Leaf::Local(at)), ty, bound: true });
        at
    }

    /// A variable is of this kind, which was not known before.
    pub fn refine(&mut self, leaf: Leaf, ty: Kind) {
        if let Some(local) = self.locals.iter_mut().find(|l| l.leaf == Some(leaf) && l.ty == Kind::Unknown) {
            local.ty = ty;
        }
    }
}

impl Checker<'_> {
    /// Adds a local with a name that must be free.
    pub(super) fn add_local(&mut self, env: &mut Env, name: &Name, noun: Noun, ty: Type) {
        self.check_free(env, noun, name);
        env.push_local(&name.text, noun, ty.kind());
    }

    /// The name is neither a local nor a constant.
    pub(super) fn check_free(&mut self, env: &Env, noun: Noun, name: &Name) {
        let constant: Option<Span> = self.consts.get(name.text.as_str()).map(|c| c.name.span);
        if let Some(local) = env.find(&name.text) {
            let issue = duplicate(local.noun, &name.text, name.span, None);
            self.report(issue);
        } else if constant.is_some() {
            let issue = duplicate(Noun::Constant, &name.text, name.span, constant);
            self.report(issue);
        } else if noun == Noun::Clock
            && let Some(id) = self.shared.get(&name.text)
        {
            let issue = duplicate(Noun::Variable, &name.text, name.span, self.shared.span(id));
            self.report(issue);
        }
    }
}
