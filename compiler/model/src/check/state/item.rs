//! Items: what an expression yields, a value of one part or of several.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, NameSyntax};

use crate::{InferredType, Type, TypedExpr, types::TypeLayout};

/// The most nodes that are made by copying expressions, as `a[i]` copies the index for each element.
pub(crate) const MAX_COPIES: usize = 2_000_000;

/// The names of the parts of a short array.
const AXES: [&str; 3] = ["x", "y", "z"];

/// What an expression yields.
#[derive(Clone, Debug)]
pub(crate) enum ExprItem {
    One(TypedExpr),
    /// Of the checker's record of this number.
    Record(u16, Vec<ExprItem>, Span),
    Array(Vec<ExprItem>, Span),
    /// `(a, b)`: an array, or a record where one is due.
    Tuple(Vec<ExprItem>, Span),
}

/// One part of an argument that is given for a parameter, with the type of the part.
pub(crate) enum ArgumentPart<'e> {
    /// `_`
    Any,
    /// Not looked at yet.
    Syntax(&'e ast::ExprSyntax, Type),
    /// A part of something that was looked at as a whole.
    Done(TypedExpr, Type),
    /// A part of a variable: its name with the part's.
    Variable(NameSyntax, Type),
}

impl ExprItem {
    pub fn error(span: Span) -> Self {
        ExprItem::One(TypedExpr::error(span))
    }

    pub fn span(&self) -> Span {
        match self {
            ExprItem::One(e) => e.span,
            ExprItem::Record(_, _, span) | ExprItem::Array(_, span) | ExprItem::Tuple(_, span) => *span,
        }
    }

    /// How many nodes its expressions have; a constant is one.
    pub(crate) fn nodes(&self) -> usize {
        match self {
            ExprItem::One(e) => nodes(e),
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                parts.iter().map(ExprItem::nodes).sum()
            }
        }
    }

    pub(crate) fn at(self, span: Span) -> Self {
        match self {
            ExprItem::One(e) => ExprItem::One(TypedExpr { span, ..e }),
            ExprItem::Record(id, parts, _) => ExprItem::Record(id, parts, span),
            ExprItem::Array(parts, _) => ExprItem::Array(parts, span),
            ExprItem::Tuple(parts, _) => ExprItem::Tuple(parts, span),
        }
    }

    /// Where the name stands that stands for it.
    pub fn named_at(&self, span: Span) -> Self {
        self.clone().at(span)
    }

    /// Its single values, in order.
    pub fn flatten(self, out: &mut Vec<TypedExpr>) {
        match self {
            ExprItem::One(e) => out.push(e),
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                parts.into_iter().for_each(|p| p.flatten(out));
            }
        }
    }

    /// Whether it is an array of one where that is due.
    pub(crate) fn is_one_of(&self, layout: &TypeLayout) -> bool {
        let one = matches!(self, ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) if parts.len() == 1);
        one && matches!(layout, TypeLayout::Array(..))
    }

    /// The names of its parts, if it is a vector: two or three numbers.
    pub(crate) fn axes(&self) -> &'static [&'static str] {
        let number = |part: &ExprItem| matches!(part, ExprItem::One(e) if e.ty.is_number());
        match self {
            ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) if parts.iter().all(number) => {
                axes(parts.len())
            }
            ExprItem::One(_) | ExprItem::Record(..) | ExprItem::Array(..) | ExprItem::Tuple(..) => &[],
        }
    }

    /// How many single values it has.
    pub(crate) fn singles(&self) -> usize {
        match self {
            ExprItem::One(_) => 1,
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                parts.iter().map(ExprItem::singles).sum()
            }
        }
    }

    pub(crate) fn parts(&self) -> Option<&[ExprItem]> {
        match self {
            ExprItem::One(_) => None,
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                Some(parts)
            }
        }
    }

    /// Whether all its single values are known.
    pub fn is_constant(&self) -> bool {
        match self {
            ExprItem::One(e) => e.constant().is_some(),
            ExprItem::Record(_, parts, _) | ExprItem::Array(parts, _) | ExprItem::Tuple(parts, _) => {
                parts.iter().all(ExprItem::is_constant)
            }
        }
    }

    /// Whether nothing is known of it: it has a diagnostic, or is a goal's argument.
    pub(crate) fn is_unknown(&self) -> bool {
        matches!(self, ExprItem::One(e) if e.ty == InferredType::Unknown)
    }
}

pub(crate) fn axes(len: usize) -> &'static [&'static str] {
    AXES.get(..len).filter(|_| len > 1).unwrap_or_default()
}

fn nodes(e: &TypedExpr) -> usize {
    let mut n = 0;
    e.each(&mut |_| n += 1);
    n
}
