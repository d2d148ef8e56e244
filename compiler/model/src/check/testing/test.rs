//! Tests: written by hand or by a generator, in the scenario's vocabulary.

use hrdsl_ir::{
    coverage::BinName,
    test::{TestMethod, TestProvenance, TestScript},
    value::nanos,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, CallSyntax, ItemSyntaxKind, NameSyntax, TestMemberKind as Member, TextSyntax};

use super::phase::TestingPhase;
use crate::check::state::phase::CheckPhase;
use crate::check::template::CheckerPhase;
use crate::check::{
    checker::NOBODY,
    state::{scope::ExprEnv, table::NameTable},
    value::measure::text,
};
use crate::{
    ActorId, InferredType, Role, Test, TestStep, Value,
    noun::Noun,
    report::{names, roles, scenario_tests::bad_test, types},
};

impl TestingPhase<'_, '_> {
    /// The tests of the scenario itself, then those of the files of tests, which hold nothing else.
    pub(in crate::check) fn tests(&mut self, files: &[&ast::FileSyntax]) {
        let mut table = NameTable::default();
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Test(test) = item {
                self.test(test, span, &mut table);
            }
        }
        for item in files.iter().flat_map(|f| &f.items) {
            if let ItemSyntaxKind::Test(test) = &item.kind {
                self.test(test, item.span, &mut table);
            } else if item.kind != ItemSyntaxKind::Error {
                let message = "a file of tests holds tests only";
                self.report(bad_test(item.span, message, "move this to the scenario"));
            }
        }
        for scenario in files.iter().filter_map(|f| f.scenario.as_ref()) {
            if scenario.text != self.s.name {
                let message = format!("these are tests of `{}`, not of `{}`", scenario.text, self.s.name);
                let issue = bad_test(scenario.span, message, format!("did you mean `{}`?", self.s.name));
                self.report(issue);
            }
        }
    }

    fn test(&mut self, test: &ast::TestSyntax, span: Span, table: &mut NameTable) {
        let full = text(&test.name.names);
        // Its full name starts with the scenario's, whether that is written or not.
        let prefix = format!("{}.", self.s.name);
        let short = full.strip_prefix(&prefix).unwrap_or(&full);
        let suite = short.rsplit_once('.').map_or("", |(suite, _)| suite).to_owned();
        let mut resolved = Test {
            name: format!("{prefix}{short}"),
            seed: 0,
            provenance: TestProvenance { suite, ..TestProvenance::default() },
            scripts: Vec::new(),
            origin: span,
        };
        if self.source.looks_at(CheckPhase::Tests, span) {
            self.test_members(&test.members, &mut resolved);
        }
        let (issues, noun) = (&mut self.issues, Noun::Test);
        if issues.declare_as(table, noun, &full, test.name.span).is_some() {
            self.s.tests.push(resolved);
        }
    }

    /// Steps of the test itself are the script of all; where actors have blocks, there are none.
    fn test_members(&mut self, members: &[ast::TestMember], test: &mut Test) {
        let mut steps = Vec::new();
        let mut first = None;
        for member in members {
            if let Member::Script { actor, members } = &member.kind {
                self.script(actor, members, test);
                continue;
            }
            if let Some(step) = self.script_step(&member.kind, None) {
                first.get_or_insert(member.span);
                steps.push(step);
            }
            self.test_header(&member.kind, test);
        }
        if test.scripts.is_empty() {
            test.scripts = TestScript::of_all(steps);
        } else if let Some(span) = first {
            let help = "put it into the block of the actor that does it, or waits";
            self.report(bad_test(span, "a step beside the blocks of actors", help));
        }
    }

    /// `person { … }`
    fn script(&mut self, name: &NameSyntax, members: &[ast::TestMember], test: &mut Test) {
        let actor = self.actor(name);
        if let Some(actor) = actor
            && self.role_of(actor) == Role::System
        {
            let message = format!("`{}` is the system: the code under test plays it", name.text);
            self.report(bad_test(name.span, message, "a test says what the environment does"));
        }
        if actor.is_some() && test.scripts.iter().any(|script| script.actor == actor) {
            let message = format!("`{}` has a block already", name.text);
            self.report(bad_test(name.span, message, "put all that it does into one block"));
        }
        let mut steps = Vec::new();
        for member in members {
            match &member.kind {
                Member::Do { .. } | Member::Await { .. } | Member::Wait(_) => {
                    steps.extend(self.script_step(&member.kind, actor));
                }
                Member::Seed(_) | Member::Method(_) | Member::Because(_) | Member::Predicts(_) => {
                    let message = "this is said of the test, not of an actor";
                    self.report(bad_test(member.span, message, "move it before the blocks"));
                }
                Member::Script { .. } => {
                    let message = "a block of an actor within another";
                    self.report(bad_test(member.span, message, "put it after the other block"));
                }
                Member::Error => {}
            }
        }
        if actor.is_some() {
            test.scripts.push(TestScript { actor, steps });
        }
    }

    fn test_header(&mut self, member: &Member, test: &mut Test) {
        match member {
            Member::Seed(e) => test.seed = self.seed(e),
            Member::Method(name) => {
                let words = TestMethod::ALL.map(TestMethod::word);
                if let Some(at) = self.choice(Noun::Method, name, &words) {
                    test.provenance.method = TestMethod::ALL[at];
                }
            }
            Member::Because(text) => test.provenance.because.push(text.text.clone()),
            Member::Predicts(text) => {
                self.predicted(text);
                test.provenance.predicts.extend(BinName::parse(&text.text));
            }
            Member::Do { .. }
            | Member::Await { .. }
            | Member::Wait(_)
            | Member::Script { .. }
            | Member::Error => {}
        }
    }

    /// A step, of this actor if it stands in an actor's block.
    fn script_step(&mut self, member: &Member, actor: Option<ActorId>) -> Option<TestStep> {
        match member {
            Member::Do { call, with, meanwhile } => self.test_do(call, with, *meanwhile, actor),
            Member::Await { events, within } => {
                let patterns = self.patterns_with(events, &mut ExprEnv::constants());
                if let Some(actor) = actor {
                    for (pattern, span) in &patterns {
                        self.perceives(actor, pattern.event, *span, true);
                    }
                }
                let events = patterns.into_iter().map(|(pattern, _)| pattern).collect();
                let within = nanos(self.time(within, "the time to wait", true).unwrap_or(1.0));
                Some(TestStep::Await { events, within })
            }
            Member::Wait(e) => {
                let time = nanos(self.time(e, "the time to wait", false).unwrap_or(0.0));
                Some(TestStep::Wait { time })
            }
            Member::Seed(_)
            | Member::Method(_)
            | Member::Because(_)
            | Member::Predicts(_)
            | Member::Script { .. }
            | Member::Error => None,
        }
    }

    fn seed(&mut self, e: &ast::ExprSyntax) -> u64 {
        let Some(Value::Int(n)) = self.constant(e, InferredType::Int, &mut ExprEnv::constants()) else {
            return 0;
        };
        let seed = u64::try_from(n);
        if seed.is_err() {
            self.report(types::must_be("a seed", "at least 0", e.span));
        }
        seed.unwrap_or(0)
    }

    /// `cross.bin`
    fn predicted(&mut self, text: &TextSyntax) {
        let (cross, bin) = text.text.split_once('.').unwrap_or((&text.text, ""));
        let Some(id) = self.crosses.get(cross) else {
            let all = self.near_of(&[Noun::Cross]);
            let name = NameSyntax { text: cross.to_owned(), span: text.span };
            self.unknown(Noun::Cross, &name, &all, Some(Noun::Cross));
            return;
        };
        let bins: Vec<String> = self.s.crosses[usize::from(id)].bins.iter().map(|b| b.name.clone()).collect();
        if !bins.iter().any(|b| b == bin) {
            let issue = names::unknown(Noun::Bin, bin, text.span, bins.iter().map(String::as_str));
            self.report(issue);
        }
    }

    fn test_do(
        &mut self,
        call: &CallSyntax,
        with: &[(NameSyntax, ast::ExprSyntax)],
        meanwhile: bool,
        actor: Option<ActorId>,
    ) -> Option<TestStep> {
        let event = self.test_stimulus(&call.name)?;
        let by = self.s.events[usize::from(event.0)].from;
        if let Some(actor) = actor
            && by != actor
            && by != NOBODY
            && actor != NOBODY
        {
            let (by, actor) = (self.actor_name(by), self.actor_name(actor));
            self.report(roles::not_its_step(&call.name.text, by, actor, call.name.span));
        }
        let fields = self.fields_of(event);
        let args = self.args(Noun::Stimulus, call, &fields, &mut ExprEnv::constants());
        for arg in &args {
            if arg.constant().is_none() && arg.ty != InferredType::Unknown {
                self.report(types::not_constant(arg.span));
            }
        }
        let samples = self.samples(event, call, with)?;
        let args: Option<Vec<Value>> = args.iter().map(crate::TypedExpr::constant).collect();
        let args = args.filter(|a| a.len() == self.arity_of(event))?;
        Some(TestStep::Do { event, args, samples, meanwhile })
    }

    /// The values of the second tier: of every sample, or of none.
    fn samples(
        &mut self,
        event: crate::EventId,
        call: &CallSyntax,
        with: &[(NameSyntax, ast::ExprSyntax)],
    ) -> Option<Vec<Value>> {
        let stimulus = self.s.events[usize::from(event.0)].stimulus.as_ref();
        let declared = stimulus.map_or_else(Vec::new, |s| s.samples.clone());
        let all: Vec<String> = declared.iter().map(|s| s.name.clone()).collect();
        let mut values: Vec<Option<Value>> = vec![None; all.len()];
        let mut misspelt = false;
        for (name, value) in with {
            let Some(at) = all.iter().position(|s| *s == name.text) else {
                self.unknown(Noun::Sample, name, &all, Some(Noun::Sample));
                misspelt = true;
                continue;
            };
            if let Some(place) = self.events.table.span(event.0) {
                self.refer_within(name, place, Noun::Sample);
            }
            if values[at].is_some() {
                self.report(names::duplicate(Noun::Sample, &name.text, name.span, None));
            }
            let e = self.expr_of(value, declared[at].lo.ty, &mut ExprEnv::constants());
            self.in_range(&e, declared[at].ty);
            if e.constant().is_none() && e.ty != InferredType::Unknown {
                self.report(types::not_constant(e.span));
            }
            // A value with a diagnostic of its own is not missing.
            values[at] = Some(e.constant().unwrap_or(Value::Float(0.0)));
        }
        if with.is_empty() {
            return Some(Vec::new());
        }
        let missing: Vec<&str> =
            all.iter().zip(&values).filter(|(_, v)| v.is_none()).map(|(n, _)| n.as_str()).collect();
        if !missing.is_empty() && !misspelt {
            let message = format!("`{}` is given some of its samples only", call.name.text);
            let help = format!("add `{}`, or leave all to the seed", missing.join("`, `"));
            self.report(bad_test(call.name.span, message, help));
        }
        values.into_iter().collect()
    }
}
