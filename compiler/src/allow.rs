//! `allow`: warnings that somebody has looked at, and why they do not matter.

use std::collections::BTreeMap;

use hrdsl_source::{Code, Diagnostic, REGISTRY, Span};
use hrdsl_syntax::ast::{
    AgentMemberKind, Allow, AutomatonMemberKind, CrossMemberKind, File, Item, ItemKind, WorldMember,
    WorldMemberKind,
};

/// One `allow` line and what it stands before.
struct Allowance<'a> {
    allow: &'a Allow,
    /// The line itself.
    span: Span,
    /// `None`: nothing follows it.
    target: Option<Span>,
}

/// Takes the allowed warnings away, and says which allowances are for nothing.
pub(crate) fn apply(ast: &[File], diagnostics: &mut Vec<Diagnostic>) {
    let allowances: Vec<Allowance<'_>> = ast.iter().flat_map(allowances).collect();
    if allowances.is_empty() {
        return;
    }
    let broken = diagnostics.iter().any(Diagnostic::is_error);
    let mut used = vec![false; allowances.len()];
    let mut by_code: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, a) in allowances.iter().enumerate() {
        by_code.entry(&a.allow.code.text).or_default().push(i);
    }
    let fits = |a: &Allowance<'_>, d: &Diagnostic| {
        let inside = |t: Span| t.file == d.span().file && t.start <= d.span().start && d.span().end <= t.end;
        a.target.is_some_and(inside)
    };
    diagnostics.retain(|d| {
        let mut allowed = false;
        if d.is_error() {
            return true;
        }
        let of_code = by_code.get(d.code.to_string().as_str()).map(Vec::as_slice).unwrap_or_default();
        for i in of_code.iter().copied().filter(|i| fits(&allowances[*i], d)) {
            used[i] = true;
            allowed |= !allowances[i].allow.reason.text.trim().is_empty();
        }
        !allowed
    });
    for (allowance, used) in allowances.iter().zip(used) {
        let is = |d: &Diagnostic| d.is_error() && d.code.to_string() == allowance.allow.code.text;
        let errors = || broken && diagnostics.iter().any(|d| is(d) && fits(allowance, d));
        diagnostics.extend(judge(allowance, used, broken, errors()));
    }
}

/// What is wrong with an allowance itself.
fn judge(allowance: &Allowance<'_>, used: bool, broken: bool, on_error: bool) -> Option<Diagnostic> {
    let allow = allowance.allow;
    let code = &allow.code;
    if !REGISTRY.iter().any(|info| info.code.to_string() == code.text) {
        let message = format!("no diagnostic has the code `{}`", code.text);
        let error = Diagnostic::error(Code::UNKNOWN_NAME, code.span, message);
        let codes: Vec<String> = REGISTRY.iter().map(|info| info.code.to_string()).collect();
        let near = hrdsl_model::nearest(&code.text, codes.iter().map(String::as_str));
        return Some(match near {
            Some(near) => error.help(format!("did you mean `{near}`?")).fix(
                format!("replace `{}` by `{near}`", code.text),
                code.span,
                near,
                false,
            ),
            None => error.help("`hrdsl explain` lists the codes"),
        });
    }
    if allow.reason.text.trim().is_empty() {
        let error = Diagnostic::warning(Code::USELESS_ALLOW, allow.reason.span, "the reason is empty");
        return Some(error.help("say why this does not matter here"));
    }
    if on_error {
        let message = format!("`{}` is an error here, which cannot be allowed", code.text);
        let error = Diagnostic::warning(Code::USELESS_ALLOW, code.span, message);
        return Some(error.help("mend the error, and take the line away"));
    }
    // With errors in the text some warnings were not looked for.
    (!used && !broken).then(|| {
        let message = format!("nothing that follows has a warning `{}`", code.text);
        Diagnostic::warning(Code::USELESS_ALLOW, code.span, message).help("take the line away").fix(
            "remove the allowance",
            allowance.span,
            "",
            true,
        )
    })
}

fn allowances(file: &File) -> Vec<Allowance<'_>> {
    let mut all = Vec::new();
    let items = file.items.iter();
    pair(items.map(|i| (if let ItemKind::Allow(a) = &i.kind { Some(a) } else { None }, i.span)), &mut all);
    for item in &file.items {
        members(item, &mut all);
    }
    all
}

fn members<'a>(item: &'a Item, all: &mut Vec<Allowance<'a>>) {
    fn of_world<'a>(members: &'a [WorldMember], all: &mut Vec<Allowance<'a>>) {
        let one = |m: &'a WorldMember| {
            (if let WorldMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)
        };
        pair(members.iter().map(one), all);
    }
    match &item.kind {
        ItemKind::Agent(agent) => pair(
            agent
                .members
                .iter()
                .map(|m| (if let AgentMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemKind::Automaton(automaton) => pair(
            automaton
                .members
                .iter()
                .map(|m| (if let AutomatonMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemKind::Cross(cross) => pair(
            cross
                .members
                .iter()
                .map(|m| (if let CrossMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemKind::Part(part) => of_world(&part.members, all),
        ItemKind::World(world) => of_world(&world.members, all),
        ItemKind::Use(_)
        | ItemKind::Allow(_)
        | ItemKind::Enum { .. }
        | ItemKind::Record { .. }
        | ItemKind::Actor { .. }
        | ItemKind::Const { .. }
        | ItemKind::Event(_)
        | ItemKind::Stimulus(_)
        | ItemKind::Var(_)
        | ItemKind::Channel(_)
        | ItemKind::Function(_)
        | ItemKind::Query(_)
        | ItemKind::Network { .. }
        | ItemKind::Require(_)
        | ItemKind::Assume(_)
        | ItemKind::Cover(_)
        | ItemKind::Suite(_)
        | ItemKind::System(_)
        | ItemKind::Test(_)
        | ItemKind::Instance(_)
        | ItemKind::Error => {}
    }
}

/// Each allowance stands for the next thing that is none.
fn pair<'a>(list: impl Iterator<Item = (Option<&'a Allow>, Span)>, all: &mut Vec<Allowance<'a>>) {
    let first = all.len();
    for (allow, target) in list {
        match allow {
            Some(allow) => all.push(Allowance { allow, span: target, target: None }),
            None => {
                let waiting = all[first..].iter_mut().rev().take_while(|a| a.target.is_none());
                waiting.for_each(|a| a.target = Some(target));
            }
        }
    }
}
