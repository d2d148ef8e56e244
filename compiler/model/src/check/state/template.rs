//! Templates: declarations with parameters, and what an instance gives for them.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemKind, Name};

use super::{item::Item, table::Map};
use crate::{ActorId, EventPattern, PointId, noun::Noun};

/// What a parameter of a template stands for.
#[derive(Clone, Debug)]
pub(crate) enum Given {
    Value(Item),
    /// One event or several alternatives.
    Events(Vec<EventPattern>),
    Actor(ActorId),
    /// Something of the world, by its full name.
    Thing(Noun, String),
    Point(PointId),
    /// Not known: in the check of the template by itself, or after a wrong argument. Nothing is said about it.
    Unknown,
}

/// A parameter with what it stands for.
#[derive(Clone, Debug)]
pub(crate) struct BoundParam {
    pub given: Given,
    /// The parameter's name, where it is declared.
    pub place: Span,
}

pub(crate) type Givens = Map<String, BoundParam>;

impl Given {
    /// Whether it is what a parameter of this kind stands for.
    pub(crate) fn is(&self, kind: Noun) -> bool {
        match self {
            Given::Unknown => true,
            Given::Value(_) => false,
            Given::Events(_) => kind == Noun::Event,
            Given::Actor(_) => kind == Noun::Actor,
            Given::Point(_) => kind == Noun::Point,
            Given::Thing(Noun::Arm | Noun::Gripper, _) if kind == Noun::Device => true,
            Given::Thing(of, _) => *of == kind,
        }
    }
}

/// A declaration with parameters.
#[derive(Clone, Copy)]
pub(crate) struct Template<'a> {
    pub kind: &'a ItemKind,
    pub name: &'a Name,
    pub params: &'a [ast::Param],
}
