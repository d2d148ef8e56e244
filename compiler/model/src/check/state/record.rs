//! Records as they were declared: their fields, and how far they are known.

use std::rc::Rc;

use hrdsl_syntax::ast::{NameSyntax, ParamSyntax as SyntaxParam};

use crate::types::TypeLayout;

/// The most single values that something of a record or array type has.
pub(crate) const MAX_PARTS: usize = 256;

/// Parameters or fields as they were declared: names and layouts.
pub(crate) type DeclaredFields = Rc<[(String, TypeLayout)]>;

/// How far the fields of a record are known.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum RecordState {
    Unseen,
    /// Its own fields are being worked out.
    Open,
    Done,
}

pub(crate) struct RecordEntry<'a> {
    pub name: &'a NameSyntax,
    pub syntax: &'a [SyntaxParam],
    pub fields: DeclaredFields,
    pub state: RecordState,
    /// How many single values it has.
    pub size: usize,
}
