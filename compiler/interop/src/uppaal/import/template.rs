//! Templates whose labels have been read.

use hrdsl_source::Span;
use indexmap::IndexSet;

use super::{
    ast::{
        UppaalBinaryOperator, UppaalDeclaration, UppaalExpr, UppaalExprKind, UppaalParameter, UppaalSelect,
        UppaalSync,
    },
    fault::UppaalFault,
    lex::UppaalFragment,
    parse::UppaalParser,
    xml::{UppaalTemplate, UppaalTransition},
};

/// A template whose labels have been read.
#[derive(Default)]
pub struct ParsedTemplate {
    pub name: String,
    pub params: Vec<UppaalParameter>,
    pub declarations: Vec<UppaalDeclaration>,
    /// By location.
    pub invariants: Vec<Option<UppaalExpr>>,
    pub edges: Vec<ParsedEdge>,
    /// Names that something is assigned to, or that are given to functions.
    pub assigned: IndexSet<String>,
}

pub struct ParsedEdge {
    pub select: Vec<UppaalSelect>,
    pub guard: Option<UppaalExpr>,
    pub sync: Option<UppaalSync>,
    pub assign: Vec<UppaalExpr>,
}

impl ParsedEdge {
    /// Where its labels begin.
    pub fn span(&self) -> Span {
        let label = self.guard.as_ref().or(self.sync.as_ref().map(|s| &s.channel)).or(self.assign.first());
        label.map(|e| e.span).or(self.select.first().map(|s| s.span)).unwrap_or_default()
    }
}

fn read<T>(
    piece: &UppaalFragment,
    faults: &mut Vec<UppaalFault>,
    parse: impl FnOnce(&mut UppaalParser) -> Result<T, UppaalFault>,
) -> Option<T> {
    if piece.is_blank() {
        return None;
    }
    let parsed = UppaalParser::new(piece).and_then(|mut parser| {
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

pub fn declarations(piece: &UppaalFragment, faults: &mut Vec<UppaalFault>) -> Vec<UppaalDeclaration> {
    read(piece, faults, UppaalParser::declarations).unwrap_or_default()
}

/// In the old language commas join the conditions of a guard.
fn conjunction(parser: &mut UppaalParser) -> Result<Option<UppaalExpr>, UppaalFault> {
    let all = parser.list(";")?;
    Ok(all.into_iter().reduce(|a, b| {
        let span = a.span.to(b.span);
        UppaalExpr { kind: UppaalExprKind::Binary(UppaalBinaryOperator::And, Box::new(a), Box::new(b)), span }
    }))
}

/// Reads all labels of a template.
pub fn template(template: &UppaalTemplate, faults: &mut Vec<UppaalFault>) -> ParsedTemplate {
    let params = read(&template.parameters, faults, |p| p.params(")")).unwrap_or_default();
    let declarations = declarations(&template.declaration, faults);
    let invariants =
        template.locations.iter().map(|l| read(&l.invariant, faults, conjunction).flatten()).collect();
    let edge = |t: &UppaalTransition, faults: &mut Vec<UppaalFault>| ParsedEdge {
        select: read(&t.select, faults, UppaalParser::selects).unwrap_or_default(),
        guard: read(&t.guard, faults, conjunction).flatten(),
        sync: read(&t.sync, faults, UppaalParser::sync),
        assign: read(&t.assign, faults, |p| p.list(";")).unwrap_or_default(),
    };
    let edges: Vec<ParsedEdge> = template.transitions.iter().map(|t| edge(t, faults)).collect();
    let mut assigned = IndexSet::new();
    let mut note = |e: &UppaalExpr| match &e.kind {
        UppaalExprKind::Assign(_, to, _) | UppaalExprKind::Step { of: to, .. } => {
            assigned.extend(to.root().map(str::to_owned));
        }
        UppaalExprKind::Call(_, args) => {
            assigned.extend(args.iter().filter_map(UppaalExpr::root).map(str::to_owned));
        }
        _ => {}
    };
    edges.iter().flat_map(|e| &e.assign).for_each(|e| e.each(&mut note));
    for declaration in &declarations {
        if let UppaalDeclaration::Function(function) = declaration {
            function.body.iter().for_each(|s| s.each(&mut note));
        }
    }
    ParsedTemplate { name: template.name.clone(), params, declarations, invariants, edges, assigned }
}
