//! The system under test.

use hrdsl_ir::value::{SECOND, nanos};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind, SystemMemberKind as Member};

use super::phase::TestingPhase;
use crate::check::{binding::phase::BindingPhase, checker::NOBODY, template::CheckerPhase};
use crate::{
    ActorId, Role, SystemProgram, SystemUnderTest, TypedExpr,
    noun::Noun,
    report::{names, roles, systems},
};

impl TestingPhase<'_, '_> {
    pub(in crate::check) fn systems(&mut self) {
        let mut known: Vec<(String, Span)> = Vec::new();
        // The first is meant where none is named: one of the scenario's own comes before those of modules.
        let mut items: Vec<_> = self.each_item().collect();
        items.rotate_left(self.source.from_modules);
        for (item, span) in items {
            let ItemSyntaxKind::System(system) = item else { continue };
            let name = system.name();
            if let Some((_, first)) = known.iter().find(|(n, _)| *n == name.text) {
                self.report(names::duplicate(Noun::System, &name.text, name.span, Some(*first)));
                continue;
            }
            known.push((name.text.clone(), name.span));
            let resolved = self.system(system, span);
            self.s.systems.push(resolved);
        }
    }

    fn system(&mut self, system: &ast::SystemSyntax, span: Span) -> SystemUnderTest<TypedExpr> {
        let actor = self.actor(&system.actor);
        if let Some(actor) = actor.filter(|a| *a != NOBODY && self.role_of(*a) == Role::Environment) {
            let issue = roles::system_plays_environment(self.actor_name(actor), system.actor.span);
            self.report(issue);
        }
        let actor = actor.unwrap_or(ActorId(0));
        let mut resolved = SystemUnderTest {
            name: system.name().text.clone(),
            actor,
            programs: Vec::new(),
            limit: 300 * SECOND,
            budget: 10 * SECOND,
            cpu: None,
            wall: None,
            memory: None,
            output: None,
            env: Vec::new(),
            online: false,
            binding: None,
            origin: span,
        };
        for member in &system.members {
            self.system_member(member, &mut resolved);
        }
        self.programs(system, &mut resolved);
        resolved
    }

    fn system_member(&mut self, member: &ast::SystemMember, resolved: &mut SystemUnderTest<TypedExpr>) {
        match &member.kind {
            Member::Limit(e) => {
                resolved.limit = self.time(e, "the limit", true).map_or(resolved.limit, nanos);
            }
            Member::Budget(e) => {
                resolved.budget = self.time(e, "the budget", true).map_or(resolved.budget, nanos);
            }
            Member::Cpu(e) => resolved.cpu = self.time(e, "the processor time", true).map(nanos),
            Member::Wall(e) => resolved.wall = self.time(e, "the wall time", true).map(nanos),
            Member::Memory(e) => resolved.memory = self.amount_of_data(e, "the memory"),
            Member::Output(e) => resolved.output = self.amount_of_data(e, "the output"),
            Member::Env(names) => resolved.env.extend(names.iter().map(|n| n.text.clone())),
            Member::Online => resolved.online = true,
            Member::Middleware(middleware) => {
                if let Some(first) = &resolved.binding {
                    let (kind, first) = (first.kind.name(), first.origin);
                    self.report(systems::second_binding(&middleware.version.text, member.span, kind, first));
                    return;
                }
                resolved.binding =
                    BindingPhase::check(self.checker, &self.robots, middleware, resolved.actor, member.span);
            }
            Member::Run(_) | Member::Coverage(_) | Member::Program(_) | Member::Error => {}
        }
    }

    /// The programs that are named; or the one whose command stands in the system itself.
    fn programs(&mut self, system: &ast::SystemSyntax, resolved: &mut SystemUnderTest<TypedExpr>) {
        let broken = system.members.iter().any(|m| m.kind == Member::Error);
        let own = self.program(&system.actor, &system.members);
        let mut known: Vec<(String, Span)> = Vec::new();
        for member in &system.members {
            let Member::Program(program) = &member.kind else { continue };
            let name = &program.name;
            if let Some((_, first)) = known.iter().find(|(n, _)| *n == name.text) {
                self.report(names::duplicate(Noun::Program, &name.text, name.span, Some(*first)));
            }
            known.push((name.text.clone(), name.span));
            for inner in &program.members {
                if !matches!(inner.kind, Member::Run(_) | Member::Coverage(_) | Member::Error) {
                    self.report(systems::not_of_a_program(inner.span));
                }
            }
            let checked = self.program(name, &program.members);
            let unread = program.members.iter().any(|m| m.kind == Member::Error);
            if checked.run.is_empty() && !unread && !has_run(&program.members) {
                let message = format!("the program `{}` has no command to run", name.text);
                self.report(names::missing(name.span, message, "add `run \"python3 robot.py\"`"));
            }
            resolved.programs.push(checked);
        }
        let alone = system.members.iter().find(|m| matches!(m.kind, Member::Run(_) | Member::Coverage(_)));
        match alone {
            Some(member) if !resolved.programs.is_empty() => {
                self.report(systems::beside_programs(member.span));
            }
            _ if !resolved.programs.is_empty() => {}
            _ => {
                if !broken && !has_run(&system.members) {
                    let message = "the system has no command to run";
                    let help = "add `run \"python3 robot.py\"`";
                    self.report(names::missing(system.actor.span, message, help));
                }
                resolved.programs.push(own);
            }
        }
    }

    fn program(&mut self, name: &ast::NameSyntax, members: &[ast::SystemMember]) -> SystemProgram {
        let mut program = SystemProgram {
            name: name.text.clone(),
            run: Vec::new(),
            coverage: Vec::new(),
            origin: name.span,
        };
        for member in members {
            if let Member::Run(text) = &member.kind {
                program.run = words(&text.text);
                if text.text.trim().is_empty() {
                    let message = "the command is empty";
                    self.report(names::missing(text.span, message, "write `run \"python3 robot.py\"`"));
                }
            }
            if let Member::Coverage(files) = &member.kind {
                program.coverage.extend(files.iter().map(|f| f.text.clone()));
            }
        }
        program
    }
}

fn has_run(members: &[ast::SystemMember]) -> bool {
    members.iter().any(|m| matches!(m.kind, Member::Run(_)))
}

/// Splits a command at white space; quotes, single or double, keep words together.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut quote: Option<char> = None;
    for c in command.chars() {
        match quote {
            Some(q) if c == q => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '"' || c == '\'' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            None => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

#[cfg(test)]
mod tests {
    #[test]
    fn commands_split_at_white_space_outside_of_quotes() {
        assert_eq!(super::words(" python3  robot.py "), ["python3", "robot.py"]);
        assert_eq!(super::words(r#"sh -c "a b" '' x'y z'"#), ["sh", "-c", "a b", "", "xy z"]);
    }
}
