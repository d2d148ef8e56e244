//! Parameters: the values with which the programs of ROS 1 begin.

use hrdsl_ir::binding::{MiddlewareBinding, MiddlewareKind};
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax, TextSyntax};

use crate::check::state::scope::ExprEnv;
use crate::check::{binding::phase::BindingPhase, template::CheckerPhase};
use crate::{
    TypedExpr, TypedExprKind, Value,
    noun::Noun,
    report::{bindings, names, types},
};

impl BindingPhase<'_, '_> {
    /// `parameter "/brew_time" = 2.5`
    pub(super) fn parameter(
        &mut self,
        name: &TextSyntax,
        value: &ast::ExprSyntax,
        binding: &mut MiddlewareBinding<TypedExpr>,
    ) {
        if binding.kind == MiddlewareKind::Ros2 {
            self.report(bindings::no_parameters(name.span));
            return;
        }
        self.binding_name(name, false);
        let within = |outer: &str, inner: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let known =
            binding.parameters.keys().find(|known| within(known, &name.text) || within(&name.text, known));
        if let Some(known) = known {
            let issue = names::duplicate(Noun::Parameter, known, name.span, None);
            self.report(issue.help("a parameter has one value, or others below it"));
            return;
        }
        let Some(json) = self.parameter_json(value) else { return };
        binding.parameters.insert(name.text.clone(), json);
    }

    /// A constant as JSON; a quantity goes in SI units.
    fn parameter_json(&mut self, value: &ast::ExprSyntax) -> Option<String> {
        if let Syntax::List { items, rest: None } = &value.kind {
            let items: Vec<Option<String>> = items.iter().map(|item| self.parameter_json(item)).collect();
            let items = items.into_iter().collect::<Option<Vec<String>>>()?;
            return Some(format!("[{}]", items.join(",")));
        }
        let value = self.expr(value, &mut ExprEnv::constants());
        let json = match value.constant() {
            Some(Value::Bool(b)) => Some(b.to_string()),
            Some(Value::Int(n)) => Some(n.to_string()),
            Some(Value::Float(x)) => Some(format!("{x:?}")),
            Some(Value::Text(text)) => serde_json::to_string(text.as_str()).ok(),
            Some(Value::Symbol(symbol)) => serde_json::to_string(symbol.name()).ok(),
            Some(Value::List(_)) | None => None,
        };
        if json.is_none() && value.kind != TypedExprKind::Error {
            self.report(types::not_constant(value.span));
        }
        json
    }
}
