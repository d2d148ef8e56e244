//! The parts of an expression as it is written.

use hrdsl_syntax::ast::{ExprSyntax, ExprSyntaxKind as Syntax, NameSyntax, PathSyntax};

/// The expressions that it is made of, in the order of the text. An internal action's arguments are terms.
fn operands(e: &ExprSyntax) -> Vec<&ExprSyntax> {
    match &e.kind {
        Syntax::Bool(_) | Syntax::Int(_) | Syntax::Float(_) | Syntax::Text(_) => Vec::new(),
        Syntax::Quantity { .. } | Syntax::Any | Syntax::Path(_) => Vec::new(),
        Syntax::Internal(_) | Syntax::Error => Vec::new(),
        Syntax::Call { args, .. } | Syntax::Tuple(args) => args.iter().collect(),
        Syntax::List { items, rest } => items.iter().chain(rest.as_deref()).collect(),
        Syntax::Field { of, .. } | Syntax::Strong(of) | Syntax::Unary { operand: of, .. } => vec![of],
        Syntax::Binary { left, right, .. } | Syntax::Unify { left, right } => vec![left, right],
        Syntax::Index { of, index } => vec![of, index],
        Syntax::If { condition, then, otherwise } => vec![condition, then, otherwise],
        Syntax::Annotated { of, annotations } => std::iter::once(&**of).chain(annotations).collect(),
    }
}

/// Calls `f` with each name, dotted or not, that an expression reads.
pub(in crate::check) fn each_path<'e>(e: &'e ExprSyntax, f: &mut dyn FnMut(&'e PathSyntax)) {
    if let Syntax::Path(path) = &e.kind {
        f(path);
    }
    operands(e).into_iter().for_each(|operand| each_path(operand, f));
}

/// Whether a function of this name is called somewhere in an expression.
pub(in crate::check) fn calls(e: &ExprSyntax, name: &str) -> bool {
    let here = matches!(&e.kind, Syntax::Call { callee, .. }
        if matches!(callee.names.as_slice(), [only] if only.text == name));
    here || operands(e).into_iter().any(|operand| calls(operand, name))
}

/// The first names of all paths in an expression.
pub(in crate::check) fn names_in(e: &ExprSyntax) -> Vec<&NameSyntax> {
    let mut names = Vec::new();
    each_path(e, &mut |path| names.extend(path.names.first()));
    names
}
