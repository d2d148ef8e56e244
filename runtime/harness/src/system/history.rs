//! What was open at some time of a run, and who waited for what: names that nobody served are found by it.

use std::collections::{BTreeMap, BTreeSet, btree_map::Entry};

use hrdsl_ir::{Nanos, value::SECOND};

use super::graph::ProgramIndex;
use crate::port::{AwaitedPort, PortDeclaration, PortHistory, PortKind, PortUse, VainWait};

/// So many names are kept at most: a program that makes up ever new ones shows what it does long before.
const MOST: usize = 10_000;
/// Who waits again before so much time has passed has not given up.
const BREATH: Nanos = SECOND;

/// The ports of a run, those that were closed among them.
#[derive(Default)]
pub(super) struct GraphHistory {
    /// With the type that was said first.
    used: BTreeMap<(PortKind, String, ProgramIndex), Option<String>>,
    opened: BTreeSet<(PortKind, String)>,
    waits: BTreeMap<(ProgramIndex, PortKind, String), OpenWait>,
}

type UsedPort<'a> = (&'a (PortKind, String, ProgramIndex), &'a Option<String>);

struct OpenWait {
    since: Nanos,
    give_up: Option<Nanos>,
}

impl GraphHistory {
    pub fn opened(&mut self, program: ProgramIndex, declared: &PortDeclaration) {
        let PortDeclaration { kind, name, type_name, .. } = declared;
        self.uses((*kind, name.clone(), program), Some(type_name.clone()));
        if self.opened.len() < MOST {
            self.opened.insert((*kind, name.clone()));
        }
    }

    /// A program begins to wait. One that looks again and again, each time for a while, waits since the first time.
    pub fn awaited(&mut self, program: ProgramIndex, awaited: AwaitedPort, now: Nanos) {
        let AwaitedPort { kind, name, type_name, give_up } = awaited;
        self.uses((kind, name.clone(), program), type_name);
        let has_room = self.waits.len() < MOST;
        let wait = match self.waits.entry((program, kind, name)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) if has_room => new.insert(OpenWait { since: now, give_up }),
            Entry::Vacant(_) => return,
        };
        if wait.give_up.is_some_and(|end| end.saturating_add(BREATH) < now) {
            wait.since = now;
        }
        wait.give_up = give_up;
    }

    fn uses(&mut self, key: (PortKind, String, ProgramIndex), type_name: Option<String>) {
        if self.used.len() < MOST {
            let known = self.used.entry(key).or_default();
            *known = known.take().or(type_name);
        }
    }

    /// A program that has ended waits for nothing.
    pub fn left(&mut self, program: ProgramIndex) {
        self.waits.retain(|(waits, ..), _| *waits != program);
    }

    /// All of it at the end of the run; programs that have no name are the scenario.
    pub fn told(&self, names: &[String], end: Nanos) -> PortHistory {
        let port = |((kind, name, program), type_name): UsedPort<'_>| PortUse {
            kind: *kind,
            name: name.clone(),
            program: names.get(*program).cloned(),
            type_name: type_name.clone(),
        };
        let is_there =
            |kind: PortKind, name: &str| self.opened.contains(&(kind.counterpart(), name.to_owned()));
        let lasts = |wait: &OpenWait| wait.give_up.is_none_or(|give_up| give_up >= end);
        let waits = self.waits.iter().filter(|((_, kind, name), wait)| lasts(wait) && !is_there(*kind, name));
        let wait = |((program, kind, name), wait): (&(ProgramIndex, PortKind, String), &OpenWait)| VainWait {
            program: names.get(*program).cloned().unwrap_or_default(),
            kind: *kind,
            name: name.clone(),
            since: wait.since,
        };
        PortHistory { uses: self.used.iter().map(port).collect(), waits: waits.map(wait).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::port::PortQos;

    fn port(kind: PortKind, name: &str) -> PortDeclaration {
        let (name, type_name) = (name.to_owned(), "pkg/Type".to_owned());
        PortDeclaration { port: 1, kind, name, type_name, kept: 0, depth: 1, qos: PortQos::default() }
    }

    fn awaited(name: &str, give_up: Option<i64>) -> AwaitedPort {
        let give_up = give_up.map(|seconds| seconds * SECOND);
        AwaitedPort { kind: PortKind::Client, name: name.to_owned(), type_name: None, give_up }
    }

    /// Which names `a` waits for in vain at the end of second 10, and since which second.
    fn vain(history: &GraphHistory) -> Vec<(String, i64)> {
        let told = history.told(&["a".to_owned()], 10 * SECOND);
        told.waits.into_iter().map(|wait| (wait.name, wait.since / SECOND)).collect()
    }

    #[test]
    fn ports_are_kept_once_with_the_scenario_as_nobody() {
        let mut history = GraphHistory::default();
        for program in [0, 0, 1] {
            history.opened(program, &port(PortKind::Publisher, "/scan"));
        }
        let told = history.told(&["a".to_owned()], 0);
        let programs: Vec<Option<String>> = told.uses.into_iter().map(|port| port.program).collect();
        assert_eq!(programs, [Some("a".to_owned()), None]);
        history.awaited(0, awaited("/plan", None), 0);
        history.opened(0, &port(PortKind::Client, "/plan"));
        let plan = history.told(&["a".to_owned()], 0).uses.into_iter().find(|port| port.name == "/plan");
        assert_eq!(plan.and_then(|port| port.type_name).as_deref(), Some("pkg/Type"), "it said so later");
        history.awaited(0, awaited("/plan", None), 0);
        history.opened(0, &port(PortKind::Client, "/plan"));
        let plan = history.told(&["a".to_owned()], 0).uses.into_iter().find(|port| port.name == "/plan");
        assert_eq!(plan.and_then(|port| port.type_name).as_deref(), Some("pkg/Type"), "it said so later");
    }

    #[test]
    fn a_wait_lasts_until_somebody_comes_or_it_is_given_up() {
        let mut history = GraphHistory::default();
        history.awaited(0, awaited("/ever", None), 2 * SECOND);
        history.awaited(0, awaited("/short", Some(9)), 2 * SECOND);
        history.awaited(0, awaited("/served", None), 2 * SECOND);
        history.opened(1, &port(PortKind::Server, "/served"));
        history.opened(1, &port(PortKind::Client, "/ever"));
        assert_eq!(vain(&history), [("/ever".to_owned(), 2)]);
        history.left(0);
        assert_eq!(vain(&history), []);
    }

    #[test]
    fn who_looks_again_and_again_waits_since_the_first_time() {
        let mut history = GraphHistory::default();
        for second in 3..10 {
            history.awaited(0, awaited("/often", Some(second + 1)), second * SECOND);
        }
        history.awaited(0, awaited("/anew", Some(2)), 0);
        history.awaited(0, awaited("/anew", None), 6 * SECOND);
        assert_eq!(vain(&history), [("/anew".to_owned(), 6), ("/often".to_owned(), 3)]);
    }
}
