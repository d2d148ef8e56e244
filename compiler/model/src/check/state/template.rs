//! Templates: declarations with parameters, and what an instance gives for them.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind, NameSyntax};

use super::{item::ExprItem, table::OrderedMap};
use crate::{ActorId, CoverpointId, EventPattern, noun::Noun};

/// What a parameter of a template stands for.
#[derive(Clone, Debug)]
pub(crate) enum TemplateArgument {
    Value(ExprItem),
    /// One event or several alternatives.
    Events(Vec<EventPattern>),
    Actor(ActorId),
    /// Something of the world, by its full name.
    Thing(Noun, String),
    Point(CoverpointId),
    /// Not known: in the check of the template by itself, or after a wrong argument. Nothing is said about it.
    Unknown,
}

/// A parameter with what it stands for.
#[derive(Clone, Debug)]
pub(crate) struct BoundParam {
    pub given: TemplateArgument,
    /// The parameter's name, where it is declared.
    pub place: Span,
}

pub(crate) type TemplateArguments = OrderedMap<String, BoundParam>;

impl TemplateArgument {
    /// Whether it is what a parameter of this kind stands for.
    pub(crate) fn is(&self, kind: Noun) -> bool {
        match self {
            TemplateArgument::Unknown => true,
            TemplateArgument::Value(_) => false,
            TemplateArgument::Events(_) => kind == Noun::Event,
            TemplateArgument::Actor(_) => kind == Noun::Actor,
            TemplateArgument::Point(_) => kind == Noun::Point,
            TemplateArgument::Thing(Noun::Arm | Noun::Gripper | Noun::Base | Noun::Laser, _)
                if kind == Noun::Device =>
            {
                true
            }
            TemplateArgument::Thing(of, _) => *of == kind,
        }
    }
}

/// A declaration with parameters.
#[derive(Clone, Copy)]
pub(crate) struct DeclaredTemplate<'a> {
    pub kind: &'a ItemSyntaxKind,
    pub name: &'a NameSyntax,
    pub params: &'a [ast::ParamSyntax],
}

/// A kind of parameter that is no type of values.
pub(crate) fn kind_word(text: &str) -> Option<Noun> {
    Some(match text {
        "event" => Noun::Event,
        "actor" => Noun::Actor,
        "cover" => Noun::Point,
        "place" => Noun::Body,
        "arm" => Noun::Arm,
        "gripper" => Noun::Gripper,
        "base" => Noun::Base,
        "laser" => Noun::Laser,
        _ => return None,
    })
}

/// What parameters of templates can be besides values.
pub(crate) const KIND_WORDS: [&str; 8] =
    ["event", "actor", "cover", "place", "arm", "gripper", "base", "laser"];

pub(crate) fn is_kind_word(text: &str) -> bool {
    kind_word(text).is_some()
}
