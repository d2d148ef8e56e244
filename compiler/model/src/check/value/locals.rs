//! Locals: a name that is declared in a place must be free there.

use hrdsl_source::Span;
use hrdsl_syntax::ast::NameSyntax;

use crate::check::{checker::Checker, state::scope::ExprEnv};
use crate::{noun::Noun, report::names::duplicate, types::TypeLayout};

impl Checker<'_> {
    /// Adds a local with a name that must be free.
    pub(in crate::check) fn add_local(
        &mut self,
        env: &mut ExprEnv,
        name: &NameSyntax,
        noun: Noun,
        layout: &TypeLayout,
    ) {
        self.check_free(env, noun, name);
        let mut leaves = Vec::new();
        self.leaves(&name.text, layout, &mut leaves);
        for (part, ty) in leaves {
            env.push_typed(&part, name.span, noun, ty);
        }
        if !matches!(layout, TypeLayout::Scalar(_)) {
            env.declare_layout(&name.text, layout.clone());
        }
    }

    /// The name is neither a local, a parameter of the template, nor a constant.
    pub(in crate::check) fn check_free(&mut self, env: &ExprEnv, noun: Noun, name: &NameSyntax) {
        let constant: Option<Span> = self.consts.get(name.text.as_str()).map(|c| c.name.span);
        let local = env.find(&name.text).map(|l| l.noun);
        let local = local.or_else(|| env.layout(&name.text).map(|_| Noun::Variable));
        let value = self.types.values.get(name.text.as_str()).and_then(|of| of.first()).copied();
        if let Some(local) = local {
            let issue = duplicate(local, &name.text, name.span, None);
            self.report(issue);
        } else if self.given(&name.text).is_some() {
            let issue = duplicate(Noun::Parameter, &name.text, name.span, None);
            self.report(issue);
        } else if let Some(of) = value {
            let declared = self.s.enums.iter().find(|e| e.of == of).map(|e| e.span);
            self.report(duplicate(Noun::EnumValue, &name.text, name.span, declared));
        } else if constant.is_some() {
            let issue = duplicate(Noun::Constant, &name.text, name.span, constant);
            self.report(issue);
        } else if noun == Noun::Clock
            && let Some(id) = self.shared.names.get(&name.text)
        {
            let issue = duplicate(Noun::Variable, &name.text, name.span, self.shared.names.span(id));
            self.report(issue);
        }
    }
}
