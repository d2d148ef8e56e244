//! What a module says of itself: the comment at its head, and the doc comments of its declarations.

use hrdsl_compiler::{
    CompilationResult, InputFile,
    ast::{
        DeviceMemberKind, InstanceSyntax, ItemSyntaxKind, TemplateSyntaxKind, WorldMemberKind as Member,
        WorldSyntax,
    },
    compile,
};

/// Where the pieces of examples stand in the scenario at a module's head.
const HOLE: &str = "// …";

pub struct Module {
    pub path: &'static str,
    /// The comment at the head, without the scenario in it.
    pub about: String,
    /// The scenario at the head.
    pub frame: String,
    pub declarations: Vec<Declaration>,
    pub compilation: CompilationResult,
}

pub struct Declaration {
    pub name: String,
    /// Whether a scenario makes instances of it.
    pub sort: Option<Sorted>,
    /// As written; of a part its first line.
    pub text: String,
    pub doc: String,
    /// What a part has: its sort, name and doc comment.
    pub members: Vec<(&'static str, String, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sorted {
    Part,
    Require,
}

pub fn modules() -> Vec<Module> {
    hrdsl_stdlib::MODULES.iter().map(|(path, text)| module(path, text)).collect()
}

fn module(path: &'static str, text: &str) -> Module {
    let head: Vec<&str> = text.lines().take_while(|l| l.starts_with("//") && !l.starts_with("///")).collect();
    let head: Vec<&str> = head.iter().map(|l| l[2..].strip_prefix(' ').unwrap_or(&l[2..])).collect();
    let head = head.join("\n");
    let frame = blocks(&head).into_iter().next().unwrap_or_default();
    let about = head.split("```").next().unwrap_or_default().trim().to_owned();
    let compilation = compile(InputFile { name: path, text }, &[]);
    let files = &compilation.files;
    let declaration = |item: &hrdsl_compiler::ast::ItemSyntax| {
        let whole = files.text(item.span);
        let (name, sort, members) = match &item.kind {
            ItemSyntaxKind::Part(part) => (part.name.text.clone(), Some(Sorted::Part), &part.members[..]),
            ItemSyntaxKind::Require(require) => {
                (require.name.text.clone(), require.params.as_ref().map(|_| Sorted::Require), &[][..])
            }
            ItemSyntaxKind::Const { name, .. } => (name.text.clone(), None, &[][..]),
            ItemSyntaxKind::Device(device) => {
                let commands = device.members.iter().filter_map(|m| match &m.kind {
                    DeviceMemberKind::Command(command) => {
                        let (from, to) = (command.name.span.start, m.span.end);
                        let span = hrdsl_source::Span { start: from, end: to, ..m.span };
                        Some(("command", files.text(span).to_owned(), m.doc.clone()))
                    }
                    DeviceMemberKind::State(state) => {
                        let span = hrdsl_source::Span { start: state.name.span.start, ..m.span };
                        Some(("state", files.text(span).to_owned(), m.doc.clone()))
                    }
                    DeviceMemberKind::Error => None,
                });
                let text = format!("device {}", device.kind.text);
                let (name, doc, members) = (device.kind.text.clone(), item.doc.clone(), commands.collect());
                return Some(Declaration { name, sort: None, text, doc, members });
            }
            ItemSyntaxKind::Use(_) => return None,
            other => panic!("{path}: the page does not know how to show {other:?}"),
        };
        let members = members.iter().filter_map(|m| member(&m.kind).map(|(s, n)| (s, n, m.doc.clone())));
        let text = if sort == Some(Sorted::Part) { whole.split(" {").next().unwrap_or(whole) } else { whole };
        Some(Declaration {
            name,
            sort,
            text: text.to_owned(),
            doc: item.doc.clone(),
            members: members.collect(),
        })
    };
    let declarations = compilation.ast[0].items.iter().filter_map(declaration).collect();
    Module { path, about, frame, declarations, compilation }
}

fn member(kind: &Member) -> Option<(&'static str, String)> {
    Some(match kind {
        Member::Body(body) => ("body", body.name.text.clone()),
        Member::Joint(joint) => ("joint", joint.name.text.clone()),
        Member::Arm(arm) => ("arm", arm.name.text.clone()),
        Member::Gripper(gripper) => ("gripper", gripper.name.text.clone()),
        Member::Base(base) => ("base", base.name.text.clone()),
        Member::Laser(laser) => ("laser", laser.name.text.clone()),
        Member::Limb(limb) => ("limb", limb.name.text.clone()),
        Member::Figure(figure) => ("figure", figure.name.text.clone()),
        Member::Scanner { name, .. } => ("laser", name.text.clone()),
        Member::Walls(walls) => ("walls", walls.name.text.clone()),
        Member::Posture(posture) => ("posture", posture.name.text.clone()),
        Member::Current { name, .. } => ("current", name.text.clone()),
        Member::Signal { name, .. } => ("signal", name.text.clone()),
        Member::Part { name, .. } => ("part", name.text.clone()),
        Member::Step(_)
        | Member::Sample(_)
        | Member::Gravity(_)
        | Member::Robot(_)
        | Member::Packages(_)
        | Member::Argument { .. }
        | Member::Semantics(_)
        | Member::Start(_)
        | Member::Rule(_)
        | Member::Allow(_)
        | Member::Error => return None,
    })
}

/// The blocks of code in the language in a text.
pub fn blocks(text: &str) -> Vec<String> {
    let parts = text.split("```hri\n").skip(1);
    parts.filter_map(|rest| Some(rest.split_once("```")?.0.to_owned())).collect()
}

impl Module {
    /// The scenarios that its examples are: one with all pieces, and those that are whole.
    pub fn examples(&self) -> Vec<String> {
        let all: Vec<String> = self.declarations.iter().flat_map(|d| blocks(&d.doc)).collect();
        let (whole, pieces): (Vec<String>, Vec<String>) =
            all.into_iter().partition(|b| b.starts_with("scenario"));
        let mut examples = whole;
        if !self.frame.is_empty() {
            assert_eq!(self.frame.matches(HOLE).count(), 1, "{}: where do the pieces stand?", self.path);
            examples.push(self.frame.replacen(HOLE, &pieces.concat(), 1));
        }
        assert!(pieces.is_empty() || !self.frame.is_empty(), "{}: pieces of nothing", self.path);
        examples
    }
}

/// What a scenario makes instances of.
pub fn instantiated(c: &CompilationResult) -> Vec<(Sorted, String)> {
    let mut all = Vec::new();
    for item in &c.ast[0].items {
        match &item.kind {
            ItemSyntaxKind::Instance(InstanceSyntax { sort: TemplateSyntaxKind::Require, of, .. }) => {
                all.push((Sorted::Require, of.text.clone()))
            }
            ItemSyntaxKind::World(WorldSyntax { members }) => {
                all.extend(members.iter().filter_map(|m| match &m.kind {
                    Member::Part { of, .. } => Some((Sorted::Part, of.text.clone())),
                    _ => None,
                }))
            }
            _ => {}
        }
    }
    all
}
