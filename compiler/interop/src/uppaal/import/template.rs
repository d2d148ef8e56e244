//! Templates whose labels have been read.

use indexmap::IndexSet;

use super::{
    ast::{BinaryOp, Decl, Expr, ExprKind, Param, Select, Sync},
    fault::Fault,
    lex::Piece,
    parse::Parser,
    xml::{Template, Transition},
};

/// A template whose labels have been read.
pub struct ParsedTemplate {
    pub name: String,
    pub params: Vec<Param>,
    pub declarations: Vec<Decl>,
    /// By location.
    pub invariants: Vec<Option<Expr>>,
    pub edges: Vec<ParsedEdge>,
    /// Names that something is assigned to, or that are given to functions.
    pub assigned: IndexSet<String>,
}

pub struct ParsedEdge {
    pub select: Vec<Select>,
    pub guard: Option<Expr>,
    pub sync: Option<Sync>,
    pub assign: Vec<Expr>,
}

fn read<T>(
    piece: &Piece,
    faults: &mut Vec<Fault>,
    parse: impl FnOnce(&mut Parser) -> Result<T, Fault>,
) -> Option<T> {
    if piece.is_blank() {
        return None;
    }
    let parsed = Parser::new(piece).and_then(|mut parser| {
        if parser.at_end() {
            return Ok(None);
        }
        let out = parse(&mut parser)?;
        parser.end()?;
        Ok(Some(out))
    });
    parsed.unwrap_or_else(|fault| {
        faults.push(fault);
        None
    })
}

pub fn declarations(piece: &Piece, faults: &mut Vec<Fault>) -> Vec<Decl> {
    read(piece, faults, Parser::declarations).unwrap_or_default()
}

/// In the old language commas join the conditions of a guard.
fn conjunction(parser: &mut Parser) -> Result<Option<Expr>, Fault> {
    let all = parser.list(";")?;
    Ok(all.into_iter().reduce(|a, b| {
        let span = a.span.to(b.span);
        Expr { kind: ExprKind::Binary(BinaryOp::And, Box::new(a), Box::new(b)), span }
    }))
}

/// Reads all labels of a template.
pub fn template(template: &Template, faults: &mut Vec<Fault>) -> ParsedTemplate {
    let params = read(&template.parameters, faults, |p| p.params(")")).unwrap_or_default();
    let declarations = declarations(&template.declaration, faults);
    let invariants =
        template.locations.iter().map(|l| read(&l.invariant, faults, conjunction).flatten()).collect();
    let edge = |t: &Transition, faults: &mut Vec<Fault>| ParsedEdge {
        select: read(&t.select, faults, Parser::selects).unwrap_or_default(),
        guard: read(&t.guard, faults, conjunction).flatten(),
        sync: read(&t.sync, faults, Parser::sync),
        assign: read(&t.assign, faults, |p| p.list(";")).unwrap_or_default(),
    };
    let edges: Vec<ParsedEdge> = template.transitions.iter().map(|t| edge(t, faults)).collect();
    let mut assigned = IndexSet::new();
    let mut note = |e: &Expr| match &e.kind {
        ExprKind::Assign(_, to, _) | ExprKind::Step { of: to, .. } => {
            assigned.extend(to.root().map(str::to_owned));
        }
        ExprKind::Call(_, args) => {
            assigned.extend(args.iter().filter_map(Expr::root).map(str::to_owned));
        }
        _ => {}
    };
    edges.iter().flat_map(|e| &e.assign).for_each(|e| e.each(&mut note));
    for declaration in &declarations {
        if let Decl::Function(function) = declaration {
            function.body.iter().for_each(|s| s.each(&mut note));
        }
    }
    ParsedTemplate { name: template.name.clone(), params, declarations, invariants, edges, assigned }
}
