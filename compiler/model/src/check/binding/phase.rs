//! The phase of bindings: what one system exchanges with its middleware.

use std::ops::{Deref, DerefMut};

use hrdsl_ir::binding::{MiddlewareBinding, MiddlewareKind};
use hrdsl_messages::{MessageLibrary, RosVersion};
use hrdsl_source::Span;
use hrdsl_syntax::ast::MiddlewareSyntax;

use crate::check::{checker::Checker, state::robot::PlacedRobot, template::CheckerPhase};
use crate::{ActorId, TypedExpr};

/// Takes the world's descriptions, the actor of a system and the definitions of its middleware, and gives the binding.
pub(in crate::check) struct BindingPhase<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    /// The parts of the world that are made from descriptions.
    pub(super) robots: &'c [PlacedRobot],
    /// For whom something is bound.
    pub(super) actor: ActorId,
    pub(super) library: &'a MessageLibrary,
}

impl<'c, 'a> BindingPhase<'c, 'a> {
    /// Checks the middleware of a system. `None` where the definitions are not there: they were not asked for.
    pub(in crate::check) fn check(
        checker: &'c mut Checker<'a>,
        robots: &'c [PlacedRobot],
        middleware: &MiddlewareSyntax,
        actor: ActorId,
        origin: Span,
    ) -> Option<MiddlewareBinding<TypedExpr>> {
        let ros1 = middleware.version.text == "ros1";
        let kind = if ros1 { MiddlewareKind::Ros1 } else { MiddlewareKind::Ros2 };
        let library = checker.source.interfaces.iter().find(|l| kind_of(l) == kind)?;
        Some(Self { checker, robots, actor, library }.middleware(middleware, kind, origin))
    }
}

fn kind_of(library: &MessageLibrary) -> MiddlewareKind {
    match library.version() {
        RosVersion::Ros1 => MiddlewareKind::Ros1,
        RosVersion::Ros2 => MiddlewareKind::Ros2,
    }
}

/// It sees all that the checker knows.
impl<'a> Deref for BindingPhase<'_, 'a> {
    type Target = Checker<'a>;

    fn deref(&self) -> &Checker<'a> {
        self.checker
    }
}

impl<'a> DerefMut for BindingPhase<'_, 'a> {
    fn deref_mut(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}

impl<'a> CheckerPhase<'a> for BindingPhase<'_, 'a> {
    fn checker(&mut self) -> &mut Checker<'a> {
        self.checker
    }
}
