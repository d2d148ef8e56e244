//! Items: what an expression yields, a value of one part or of several.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, Name};

use crate::{Expr, Kind, Type, types::Layout};

/// The most nodes that are made by copying expressions, as `a[i]` copies the index for each element.
pub(crate) const MAX_COPIES: usize = 2_000_000;

/// The names of the parts of a short array.
const AXES: [&str; 3] = ["x", "y", "z"];

/// What an expression yields.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    One(Expr),
    /// Of the checker's record of this number.
    Record(u16, Vec<Item>, Span),
    Array(Vec<Item>, Span),
    /// `(a, b)`: an array, or a record where one is due.
    Tuple(Vec<Item>, Span),
}

/// One part of an argument that is given for a parameter, with the type of the part.
pub(crate) enum Part<'e> {
    /// `_`
    Any,
    /// Not looked at yet.
    Syntax(&'e ast::Expr, Type),
    /// A part of something that was looked at as a whole.
    Done(Expr, Type),
    /// A part of a variable: its name with the part's.
    Variable(Name, Type),
}

impl Item {
    pub fn error(span: Span) -> Self {
        Item::One(Expr::error(span))
    }

    pub fn span(&self) -> Span {
        match self {
            Item::One(e) => e.span,
            Item::Record(_, _, span) | Item::Array(_, span) | Item::Tuple(_, span) => *span,
        }
    }

    /// How many nodes its expressions have; a constant is one.
    pub(crate) fn nodes(&self) -> usize {
        match self {
            Item::One(e) => nodes(e),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().map(Item::nodes).sum()
            }
        }
    }

    pub(crate) fn at(self, span: Span) -> Self {
        match self {
            Item::One(e) => Item::One(Expr { span, ..e }),
            Item::Record(id, parts, _) => Item::Record(id, parts, span),
            Item::Array(parts, _) => Item::Array(parts, span),
            Item::Tuple(parts, _) => Item::Tuple(parts, span),
        }
    }

    /// Where the name stands that stands for it.
    pub fn named_at(&self, span: Span) -> Self {
        self.clone().at(span)
    }

    /// Its single values, in order.
    pub fn flatten(self, out: &mut Vec<Expr>) {
        match self {
            Item::One(e) => out.push(e),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.into_iter().for_each(|p| p.flatten(out));
            }
        }
    }

    /// Whether it is an array of one where that is due.
    pub(crate) fn is_one_of(&self, layout: &Layout) -> bool {
        let one = matches!(self, Item::Array(parts, _) | Item::Tuple(parts, _) if parts.len() == 1);
        one && matches!(layout, Layout::Array(..))
    }

    /// The names of its parts, if it is a vector: two or three numbers.
    pub(crate) fn axes(&self) -> &'static [&'static str] {
        let number = |part: &Item| matches!(part, Item::One(e) if e.ty.is_number());
        match self {
            Item::Array(parts, _) | Item::Tuple(parts, _) if parts.iter().all(number) => axes(parts.len()),
            Item::One(_) | Item::Record(..) | Item::Array(..) | Item::Tuple(..) => &[],
        }
    }

    /// How many single values it has.
    pub(crate) fn singles(&self) -> usize {
        match self {
            Item::One(_) => 1,
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().map(Item::singles).sum()
            }
        }
    }

    pub(crate) fn parts(&self) -> Option<&[Item]> {
        match self {
            Item::One(_) => None,
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => Some(parts),
        }
    }

    /// Whether all its single values are known.
    pub fn is_constant(&self) -> bool {
        match self {
            Item::One(e) => e.constant().is_some(),
            Item::Record(_, parts, _) | Item::Array(parts, _) | Item::Tuple(parts, _) => {
                parts.iter().all(Item::is_constant)
            }
        }
    }

    /// Whether nothing is known of it: it has a diagnostic, or is a goal's argument.
    pub(crate) fn is_unknown(&self) -> bool {
        matches!(self, Item::One(e) if e.ty == Kind::Unknown)
    }
}

pub(crate) fn axes(len: usize) -> &'static [&'static str] {
    AXES.get(..len).filter(|_| len > 1).unwrap_or_default()
}

fn nodes(e: &Expr) -> usize {
    let mut n = 0;
    e.each(&mut |_| n += 1);
    n
}
