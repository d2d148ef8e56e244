//! The system under test.

use hrdsl_ir::value::{SECOND, nanos};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind, SystemMemberKind as Member};

use crate::check::checker::Checker;
use crate::{
    ActorId, Role, SystemUnderTest,
    report::{names, roles},
};

impl Checker<'_> {
    pub(in crate::check) fn systems(&mut self) {
        let mut found: Option<Span> = None;
        for (item, span) in self.each_item() {
            let ItemSyntaxKind::System(system) = item else { continue };
            if let Some(first) = found {
                self.report(names::twice("system", span, first));
                continue;
            }
            found = Some(span);
            let resolved = self.system(system, span);
            self.s.system = Some(resolved);
        }
    }

    fn system(&mut self, system: &ast::SystemSyntax, span: Span) -> SystemUnderTest {
        let actor = self.actor(&system.actor);
        if let Some(actor) = actor.filter(|a| self.role_of(*a) == Role::Environment) {
            let issue = roles::system_plays_environment(self.actor_name(actor), system.actor.span);
            self.report(issue);
        }
        let actor = actor.unwrap_or(ActorId(0));
        let mut resolved = SystemUnderTest {
            actor,
            run: Vec::new(),
            coverage: Vec::new(),
            limit: 300 * SECOND,
            budget: 10 * SECOND,
            cpu: None,
            wall: None,
            memory: None,
            output: None,
            env: Vec::new(),
            online: false,
            origin: span,
        };
        let mut runs = false;
        for member in &system.members {
            match &member.kind {
                Member::Run(text) => {
                    runs = true;
                    resolved.run = words(&text.text);
                    if text.text.trim().is_empty() {
                        self.report(names::missing(
                            text.span,
                            "the command is empty",
                            "write `run \"python3 robot.py\"`",
                        ));
                    }
                }
                Member::Coverage(files) => resolved.coverage.extend(files.iter().map(|f| f.text.clone())),
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
                Member::Error => runs = true,
            }
        }
        if !runs {
            let message = "the system has no command to run";
            self.report(names::missing(system.actor.span, message, "add `run \"python3 robot.py\"`"));
        }
        resolved
    }
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
