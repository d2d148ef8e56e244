//! `allow`: warnings that somebody has looked at, and why they do not matter.

use std::{collections::BTreeMap, sync::Arc};

use hrdsl_source::{Diagnostic, DiagnosticCode, REGISTRY, Span};
use hrdsl_syntax::ast::{
    AgentMemberKind, AllowSyntax, AutomatonMemberKind, CrossMemberKind, FileSyntax, ItemSyntax,
    ItemSyntaxKind, WorldMember, WorldMemberKind,
};

/// One `allow` line and what it stands before.
struct LintAllowance<'a> {
    allow: &'a AllowSyntax,
    /// The line itself.
    span: Span,
    /// `None`: nothing follows it.
    target: Option<Span>,
}

/// Takes the allowed warnings away, and says which allowances are for nothing.
pub(crate) fn apply(ast: &[Arc<FileSyntax>], diagnostics: &mut Vec<Diagnostic>) {
    let allowances: Vec<LintAllowance<'_>> = ast.iter().flat_map(|file| allowances(file)).collect();
    if allowances.is_empty() {
        return;
    }
    let broken = diagnostics.iter().any(Diagnostic::is_error);
    let mut used = vec![false; allowances.len()];
    let mut on_error = used.clone();
    let targets = AllowanceIndex::of(&allowances);
    diagnostics.retain(|d| {
        let mut allowed = false;
        targets.each(&d.code.to_string(), d.span(), &mut |i| {
            (if d.is_error() { &mut on_error } else { &mut used })[i] = true;
            allowed |= !allowances[i].allow.reason.text.trim().is_empty();
        });
        d.is_error() || !allowed
    });
    for (i, allowance) in allowances.iter().enumerate() {
        diagnostics.extend(judge(allowance, used[i], broken, on_error[i]));
    }
}

/// The allowances of each code by what they stand before.
struct AllowanceIndex<'a> {
    by_code: BTreeMap<&'a str, Vec<AllowanceTarget>>,
}

/// What some allowances stand before, and the one around it, which has a smaller number.
struct AllowanceTarget {
    span: Span,
    allowances: Vec<usize>,
    around: Option<usize>,
}

impl<'a> AllowanceIndex<'a> {
    fn of(all: &[LintAllowance<'a>]) -> Self {
        let mut order: Vec<(Span, usize)> =
            all.iter().enumerate().filter_map(|(i, a)| Some((a.target?, i))).collect();
        // What is around others comes before them.
        order.sort_by_key(|(span, i)| (span.file, span.start, std::cmp::Reverse(span.end), *i));
        let mut by_code: BTreeMap<&str, Vec<AllowanceTarget>> = BTreeMap::new();
        for (span, i) in order {
            let targets = by_code.entry(&all[i].allow.code.text).or_default();
            match targets.last_mut().filter(|last| last.span == span) {
                Some(same) => same.allowances.push(i),
                None => {
                    let around = around(targets, targets.len().checked_sub(1), span);
                    targets.push(AllowanceTarget { span, allowances: vec![i], around });
                }
            }
        }
        Self { by_code }
    }

    /// The allowances of a code that stand before something in which a span is.
    fn each(&self, code: &str, span: Span, f: &mut dyn FnMut(usize)) {
        let Some(targets) = self.by_code.get(code) else { return };
        let before = targets.partition_point(|t| (t.span.file, t.span.start) <= (span.file, span.start));
        let mut at = around(targets, before.checked_sub(1), span);
        while let Some(target) = at.map(|at| &targets[at]) {
            target.allowances.iter().for_each(|i| f(*i));
            at = target.around;
        }
    }
}

/// The innermost target around a span, from this one outwards.
fn around(targets: &[AllowanceTarget], mut at: Option<usize>, span: Span) -> Option<usize> {
    let is_around = |t: Span| t.file == span.file && t.start <= span.start && span.end <= t.end;
    while let Some(target) = at.map(|at| &targets[at]).filter(|t| !is_around(t.span)) {
        at = target.around;
    }
    at
}

/// What is wrong with an allowance itself.
fn judge(allowance: &LintAllowance<'_>, used: bool, broken: bool, on_error: bool) -> Option<Diagnostic> {
    let allow = allowance.allow;
    let code = &allow.code;
    if !REGISTRY.iter().any(|info| info.code.to_string() == code.text) {
        let message = format!("no diagnostic has the code `{}`", code.text);
        let error = Diagnostic::error(DiagnosticCode::UNKNOWN_NAME, code.span, message);
        let codes: Vec<String> = REGISTRY.iter().map(|info| info.code.to_string()).collect();
        let near = hrdsl_source::nearest(&code.text, codes.iter().map(String::as_str));
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
        let error =
            Diagnostic::warning(DiagnosticCode::USELESS_ALLOW, allow.reason.span, "the reason is empty");
        return Some(error.help("say why this does not matter here"));
    }
    if on_error {
        let message = format!("`{}` is an error here, which cannot be allowed", code.text);
        let error = Diagnostic::warning(DiagnosticCode::USELESS_ALLOW, code.span, message);
        return Some(error.help("fix the error, and take the line away"));
    }
    // With errors in the text some warnings were not looked for.
    (!used && !broken).then(|| {
        let message = format!("nothing that follows has a warning `{}`", code.text);
        Diagnostic::warning(DiagnosticCode::USELESS_ALLOW, code.span, message).help("take the line away").fix(
            "remove the allowance",
            allowance.span,
            "",
            true,
        )
    })
}

fn allowances(file: &FileSyntax) -> Vec<LintAllowance<'_>> {
    let mut all = Vec::new();
    let items = file.items.iter();
    pair(
        items.map(|i| (if let ItemSyntaxKind::Allow(a) = &i.kind { Some(a) } else { None }, i.span)),
        &mut all,
    );
    for item in &file.items {
        members(item, &mut all);
    }
    all
}

fn members<'a>(item: &'a ItemSyntax, all: &mut Vec<LintAllowance<'a>>) {
    fn of_world<'a>(members: &'a [WorldMember], all: &mut Vec<LintAllowance<'a>>) {
        let one = |m: &'a WorldMember| {
            (if let WorldMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)
        };
        pair(members.iter().map(one), all);
    }
    match &item.kind {
        ItemSyntaxKind::Agent(agent) => pair(
            agent
                .members
                .iter()
                .map(|m| (if let AgentMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemSyntaxKind::Automaton(automaton) => pair(
            automaton
                .members
                .iter()
                .map(|m| (if let AutomatonMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemSyntaxKind::Cross(cross) => pair(
            cross
                .members
                .iter()
                .map(|m| (if let CrossMemberKind::Allow(a) = &m.kind { Some(a) } else { None }, m.span)),
            all,
        ),
        ItemSyntaxKind::Part(part) => of_world(&part.members, all),
        ItemSyntaxKind::World(world) => of_world(&world.members, all),
        ItemSyntaxKind::Use(_)
        | ItemSyntaxKind::Allow(_)
        | ItemSyntaxKind::Enum { .. }
        | ItemSyntaxKind::Record { .. }
        | ItemSyntaxKind::Actor { .. }
        | ItemSyntaxKind::Const { .. }
        | ItemSyntaxKind::Event(_)
        | ItemSyntaxKind::Stimulus(_)
        | ItemSyntaxKind::Var(_)
        | ItemSyntaxKind::Channel(_)
        | ItemSyntaxKind::Function(_)
        | ItemSyntaxKind::Query(_)
        | ItemSyntaxKind::Network { .. }
        | ItemSyntaxKind::Require(_)
        | ItemSyntaxKind::Assume(_)
        | ItemSyntaxKind::Cover(_)
        | ItemSyntaxKind::Suite(_)
        | ItemSyntaxKind::Device(_)
        | ItemSyntaxKind::System(_)
        | ItemSyntaxKind::Test(_)
        | ItemSyntaxKind::Instance(_)
        | ItemSyntaxKind::Error => {}
    }
}

/// Each allowance stands for the next thing that is none.
fn pair<'a>(list: impl Iterator<Item = (Option<&'a AllowSyntax>, Span)>, all: &mut Vec<LintAllowance<'a>>) {
    let first = all.len();
    for (allow, target) in list {
        match allow {
            Some(allow) => all.push(LintAllowance { allow, span: target, target: None }),
            None => {
                let waiting = all[first..].iter_mut().rev().take_while(|a| a.target.is_none());
                waiting.for_each(|a| a.target = Some(target));
            }
        }
    }
}
