//! The system under test.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemKind, SystemMemberKind as Member};

use super::Checker;
use crate::{
    ActorId, Role, System,
    report::{names, roles},
};

impl Checker<'_> {
    pub(super) fn systems(&mut self) {
        let mut found: Option<Span> = None;
        for (item, span) in self.each_item() {
            let ItemKind::System(system) = item else { continue };
            if let Some(first) = found {
                self.report(names::twice("system", span, first));
                continue;
            }
            found = Some(span);
            let resolved = self.system(system, span);
            self.s.system = Some(resolved);
        }
    }

    fn system(&mut self, system: &ast::System, span: Span) -> System {
        let actor = self.actor(&system.actor);
        if let Some(actor) = actor.filter(|a| self.role_of(*a) == Role::Environment) {
            let issue = roles::system_plays_environment(self.actor_name(actor), system.actor.span);
            self.report(issue);
        }
        let actor = actor.unwrap_or(ActorId(0));
        let mut resolved = System {
            actor,
            run: String::new(),
            coverage: Vec::new(),
            limit: 300.0,
            budget: 10.0,
            cpu: None,
            wall: None,
            memory: None,
            output: None,
            env: Vec::new(),
            online: false,
            span,
        };
        let mut runs = false;
        for member in &system.members {
            match &member.kind {
                Member::Run(text) => {
                    runs = true;
                    resolved.run.clone_from(&text.text);
                    if text.text.trim().is_empty() {
                        self.report(names::missing(
                            text.span,
                            "the command is empty",
                            "write `run \"python3 robot.py\"`",
                        ));
                    }
                }
                Member::Coverage(files) => resolved.coverage.extend(files.iter().map(|f| f.text.clone())),
                Member::Limit(e) => resolved.limit = self.time(e, "the limit", true).unwrap_or(300.0),
                Member::Budget(e) => resolved.budget = self.time(e, "the budget", true).unwrap_or(10.0),
                Member::Cpu(e) => resolved.cpu = self.time(e, "the processor time", true),
                Member::Wall(e) => resolved.wall = self.time(e, "the wall time", true),
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
