//! Names of the middleware at which somebody is alone: found over all tests, since what one test does not reach another may.

use std::collections::{BTreeMap, BTreeSet};

use hrdsl_harness::{PortHistory, PortKind, PortUse, VainWait};
use hrdsl_ir::{binding::MiddlewareBinding, value::seconds};
use hrdsl_results::{InterfaceFault, InterfaceRole, InterfaceWarning, TestName, UnservedWait};
use hrdsl_source::nearest;

use crate::PortedTest;

/// What a middleware's own tools publish and hear. That nobody is there means nothing.
const INFRASTRUCTURE: [&str; 9] = [
    "/clock",
    "/diagnostics",
    "/diagnostics_agg",
    "/parameter_events",
    "/rosout",
    "/rosout_agg",
    "/statistics",
    "/tf",
    "/tf_static",
];

/// What programs waited for in vain until a test was over.
pub(crate) fn unserved_waits(ports: &PortHistory) -> Vec<UnservedWait> {
    let wait = |wait: &VainWait| UnservedWait {
        program: wait.program.clone(),
        role: role(wait.kind),
        name: wait.name.clone(),
        since: seconds(wait.since),
    };
    ports.waits.iter().map(wait).collect()
}

/// The names at which programs, or the binding, were alone in every test.
pub(crate) fn warnings(binding: Option<&MiddlewareBinding>, tests: &[PortedTest]) -> Vec<InterfaceWarning> {
    let graph = CampaignGraph::of(tests);
    let mut alone: Vec<InterfaceWarning> =
        graph.lonely().map(|((kind, name), users)| graph.warning(binding, (*kind, name), users)).collect();
    alone.sort_by(|a, b| (a.fault, a.role, &a.name).cmp(&(b.fault, b.role, &b.name)));
    let meant = |name: &str| {
        alone.iter().any(|w| w.fault == InterfaceFault::Unserved && w.near.as_deref() == Some(name))
    };
    let bound = binding.map(bound_names).unwrap_or_default();
    let unused = bound.into_iter().filter(|bound| !graph.uses(bound) && !meant(&bound.name));
    let unused: Vec<InterfaceWarning> = unused.filter_map(|bound| graph.unused(bound, tests)).collect();
    let notes = alone.partition_point(|w| w.fault < InterfaceFault::Unused);
    alone.splice(notes..notes, unused);
    alone
}

/// Who is at a name, over all tests.
#[derive(Default)]
struct PortUsers {
    type_name: Option<String>,
    programs: BTreeSet<String>,
    /// Whether the scenario itself is one of them.
    is_bound: bool,
    tests: BTreeSet<TestName>,
}

/// All ports of all tests.
#[derive(Default)]
struct CampaignGraph {
    ports: BTreeMap<(PortKind, String), PortUsers>,
}

/// What the binding says of a name.
struct BoundName {
    /// What a program must be to make use of it.
    kind: PortKind,
    name: String,
    type_name: String,
}

impl CampaignGraph {
    fn of(tests: &[PortedTest]) -> Self {
        let mut graph = Self::default();
        for test in tests {
            for PortUse { kind, name, program, type_name } in &test.ports.uses {
                let users = graph.users((*kind, name.clone()), test);
                if users.type_name.is_none() {
                    users.type_name.clone_from(type_name);
                }
                match program {
                    Some(program) => drop(users.programs.insert(program.clone())),
                    None => users.is_bound = true,
                }
            }
        }
        graph
    }

    fn users(&mut self, key: (PortKind, String), test: &PortedTest) -> &mut PortUsers {
        let users = self.ports.entry(key).or_default();
        users.tests.insert(test.finished.result.name.clone());
        users
    }

    /// What programs have alone.
    fn lonely(&self) -> impl Iterator<Item = (&(PortKind, String), &PortUsers)> {
        self.ports.iter().filter(|((kind, name), users)| {
            let matters = match kind {
                PortKind::Subscriber | PortKind::Client | PortKind::ActionClient | PortKind::Publisher => {
                    true
                }
                // A server that nobody asks does no harm.
                PortKind::Server | PortKind::ActionServer => false,
            };
            let is_met = self.ports.contains_key(&(kind.counterpart(), name.clone()));
            matters && !is_met && !users.is_bound && !INFRASTRUCTURE.contains(&name.as_str())
        })
    }

    fn warning(
        &self,
        binding: Option<&MiddlewareBinding>,
        (kind, name): (PortKind, &str),
        users: &PortUsers,
    ) -> InterfaceWarning {
        let fault =
            if kind == PortKind::Publisher { InterfaceFault::Unheard } else { InterfaceFault::Unserved };
        let type_name = users.type_name.as_deref().map(short_type);
        let others = self.ports.iter().filter(|((other, _), _)| *other == kind.counterpart());
        let others: Vec<(&str, &PortUsers)> =
            others.map(|((_, name), users)| (name.as_str(), users)).collect();
        let alike = others.iter().filter(|(_, other)| {
            users.type_name.is_none() || other.type_name.is_none() || other.type_name == users.type_name
        });
        let near = (fault == InterfaceFault::Unserved).then(|| near_name(name, alike.map(|(name, _)| *name)));
        InterfaceWarning {
            fault,
            role: role(kind),
            name: name.to_owned(),
            line: binding.is_some().then(|| line(kind, name, type_name.as_deref())),
            type_name,
            programs: users.programs.iter().cloned().collect(),
            near: near.flatten(),
            tests: u32::try_from(users.tests.len()).unwrap_or(u32::MAX),
            first: users.tests.first().cloned().unwrap_or_default(),
        }
    }

    /// Whether a program makes use of a name of the binding.
    fn uses(&self, bound: &BoundName) -> bool {
        let fits = |name: &str| match bound.name.split_once('*') {
            Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| rest.ends_with(after)),
            None => name == bound.name,
        };
        self.ports
            .iter()
            .any(|((kind, name), users)| *kind == bound.kind && !users.programs.is_empty() && fits(name))
    }

    /// A name of the binding that no program uses, unless all tests broke off before it could.
    fn unused(&self, bound: BoundName, tests: &[PortedTest]) -> Option<InterfaceWarning> {
        let whole =
            tests.iter().filter(|t| t.finished.result.error.is_none()).map(|t| &t.finished.result.name);
        let whole: BTreeSet<&TestName> = whole.collect();
        let first = (*whole.first()?).clone();
        let lonely = self.lonely().filter(|((kind, _), _)| *kind == bound.kind);
        let near = near_name(&bound.name, lonely.map(|((_, name), _)| name.as_str()));
        Some(InterfaceWarning {
            fault: InterfaceFault::Unused,
            role: role(bound.kind),
            name: bound.name,
            type_name: Some(short_type(&bound.type_name)),
            programs: Vec::new(),
            near,
            line: None,
            tests: u32::try_from(whole.len()).unwrap_or(u32::MAX),
            first,
        })
    }
}

fn bound_names(binding: &MiddlewareBinding) -> Vec<BoundName> {
    let bound = |kind, name: &str, interface: &str| BoundName {
        kind,
        name: name.to_owned(),
        type_name: interface.to_owned(),
    };
    let inputs = binding.inputs.iter().map(|i| bound(PortKind::Subscriber, &i.topic, &i.interface));
    let outputs = binding.outputs.iter().map(|o| bound(PortKind::Publisher, &o.topic, &o.interface));
    let services = binding.services.iter().map(|s| bound(PortKind::Client, &s.service, &s.interface));
    let actions = binding.actions.iter().map(|a| bound(PortKind::ActionClient, &a.action, &a.interface));
    inputs.chain(outputs).chain(services).chain(actions).collect()
}

/// The name that was probably meant: the same in another namespace, or one that is written almost alike.
fn near_name<'n>(name: &str, others: impl Iterator<Item = &'n str>) -> Option<String> {
    let others: Vec<&str> = others.filter(|other| !INFRASTRUCTURE.contains(other)).collect();
    let base = |name: &str| name.rsplit('/').next().map(str::to_owned);
    let moved = others.iter().find(|other| base(other) == base(name)).copied();
    moved.or_else(|| nearest(name, others.iter().copied())).map(str::to_owned)
}

/// As the binding writes it: `sensor_msgs/LaserScan`, be it of ROS 1 or 2.
fn short_type(type_name: &str) -> String {
    match type_name.split('/').collect::<Vec<_>>().as_slice() {
        [package, _, name] => format!("{package}/{name}"),
        _ => type_name.to_owned(),
    }
}

/// What to write into the binding.
fn line(kind: PortKind, name: &str, type_name: Option<&str>) -> String {
    let direction = match kind {
        PortKind::Subscriber => " in",
        PortKind::Publisher => " out",
        PortKind::Client | PortKind::Server | PortKind::ActionClient | PortKind::ActionServer => "",
    };
    // Who only waits for a service need not know its type.
    let of = type_name.filter(|t| t.contains('/')).unwrap_or("PACKAGE/NAME");
    format!("{} \"{name}\": {of}{direction} {{ … }}", kind.sort())
}

fn role(kind: PortKind) -> InterfaceRole {
    match kind {
        PortKind::Publisher => InterfaceRole::Publisher,
        PortKind::Subscriber => InterfaceRole::Subscriber,
        PortKind::Server => InterfaceRole::Server,
        PortKind::Client => InterfaceRole::Client,
        PortKind::ActionServer => InterfaceRole::ActionServer,
        PortKind::ActionClient => InterfaceRole::ActionClient,
    }
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{
        Span,
        binding::{MessageRules, MessageTemplate, MiddlewareKind, TopicInput, TopicOutput},
    };
    use hrdsl_judge::FinishedTest;
    use hrdsl_results::TestResult;

    use super::*;

    type PortFixture<'a> = (PortKind, &'a str, Option<&'a str>);

    fn test(name: &str, error: bool, ports: &[PortFixture<'_>]) -> PortedTest {
        let uses = ports.iter().map(|(kind, name, program)| PortUse {
            kind: *kind,
            name: (*name).to_owned(),
            program: program.map(str::to_owned),
            type_name: Some("std_msgs/msg/Int8".to_owned()),
        });
        let error = error.then(|| "it died".to_owned());
        let result = TestResult { name: name.into(), error, ..TestResult::default() };
        PortedTest {
            finished: FinishedTest { result, ..FinishedTest::default() },
            ports: PortHistory { uses: uses.collect(), waits: Vec::new() },
        }
    }

    fn binding(inputs: &[&str], outputs: &[&str]) -> MiddlewareBinding {
        let rules = || MessageRules { reads: Vec::new(), rules: Vec::new(), conditions: Vec::new() };
        let (interface, origin) = ("std_msgs/msg/Int8".to_owned(), Span::default());
        MiddlewareBinding {
            kind: MiddlewareKind::Ros2,
            packages: BTreeMap::new(),
            parameters: BTreeMap::new(),
            inputs: inputs
                .iter()
                .map(|topic| TopicInput {
                    topic: (*topic).to_owned(),
                    interface: interface.clone(),
                    period: None,
                    latched: false,
                    message: MessageTemplate { text: vec![String::new()], gaps: Vec::new() },
                    origin,
                })
                .collect(),
            outputs: outputs
                .iter()
                .map(|topic| TopicOutput {
                    topic: (*topic).to_owned(),
                    interface: interface.clone(),
                    rules: rules(),
                    origin,
                })
                .collect(),
            services: Vec::new(),
            actions: Vec::new(),
            groups: Vec::new(),
            transitions: Vec::new(),
            origin,
        }
    }

    fn told(binding: Option<&MiddlewareBinding>, tests: &[PortedTest]) -> Vec<String> {
        let text = |w: &InterfaceWarning| {
            let advice = w.advice().map(|a| format!("; {a}")).unwrap_or_default();
            format!("{}{advice} [{} {}]", w.sentence(), w.tests, w.first)
        };
        warnings(binding, tests).iter().map(text).collect()
    }

    use PortKind::{Client, Publisher, Server, Subscriber};

    #[test]
    fn a_name_counts_once_over_all_tests_and_not_if_any_test_serves_it() {
        let both = [(Subscriber, "/scan", Some("b")), (Client, "/plan", Some("a"))];
        let served = [both[0], both[1], (Publisher, "/scan", Some("c"))];
        let tests = [test("t2", false, &both), test("t1", true, &both), test("t3", false, &served)];
        assert_eq!(told(None, &tests), ["a uses the service /plan, which nobody serves [3 t1]"]);
        let again = [tests[0].clone(), tests[1].clone()];
        let said = [
            "b subscribes to /scan, which nobody publishes [2 t1]",
            "a uses the service /plan, which nobody serves [2 t1]",
        ];
        assert_eq!(told(None, &again), said);
    }

    #[test]
    fn the_advice_names_what_is_near_and_what_to_add() {
        let ports = [
            (Subscriber, "/scann", Some("brain")),
            (Subscriber, "/laser", Some("brain")),
            (Publisher, "/scan", None),
            (Publisher, "/odd", Some("brain")),
        ];
        let bound = binding(&["/scan"], &[]);
        let said = [
            "brain subscribes to /laser, which nobody publishes; add to the binding: topic \"/laser\": std_msgs/Int8 in { … } \
             [1 t]",
            "brain subscribes to /scann, which nobody publishes; did you mean /scan? If not, add to the binding: \
             topic \"/scann\": std_msgs/Int8 in { … } [1 t]",
            "brain publishes /odd, which nobody subscribes to; add to the binding: topic \"/odd\": std_msgs/Int8 out { … } [1 t]",
        ];
        assert_eq!(told(Some(&bound), &[test("t", false, &ports)]), said);
    }

    #[test]
    fn what_the_binding_names_is_used_by_a_program() {
        let ports = [
            (Publisher, "/arm/hip_controller/command", Some("arm")),
            (Subscriber, "/arm/hip_controller/command", None),
            (Publisher, "/brain/poured", Some("brain")),
        ];
        let bound = binding(&["/orders"], &["/arm/*_controller/command", "/poured"]);
        let tests = [test("t", false, &ports), test("u", true, &[])];
        let said = [
            "no program subscribes to /orders, which the binding publishes [1 t]",
            "no program publishes /poured, which the binding hears; did you mean /brain/poured? [1 t]",
            "brain publishes /brain/poured, which nobody subscribes to; add to the binding: \
             topic \"/brain/poured\": std_msgs/Int8 out { … } [1 t]",
        ];
        assert_eq!(told(Some(&bound), &tests), said);
        assert_eq!(told(Some(&bound), &tests[1..]), [""; 0], "they broke off before they could");
    }

    #[test]
    fn who_waits_for_a_service_needs_it_and_infrastructure_is_nobodys_fault() {
        let mut waits = test("t", false, &[(Publisher, "/rosout", Some("a")), (Server, "/idle", Some("a"))]);
        let (program, name) = ("a".to_owned(), "/idel".to_owned());
        let awaited =
            PortUse { kind: Client, name: name.clone(), program: Some(program.clone()), type_name: None };
        waits.ports.uses.push(awaited);
        waits.ports.waits.push(VainWait { program, kind: Client, name, since: 1_500_000_000 });
        let said = [
            "a uses the service /idel, which nobody serves; did you mean /idle? If not, add to the binding: \
                     service \"/idel\": PACKAGE/NAME { … } [1 t]",
        ];
        assert_eq!(told(Some(&binding(&[], &[])), std::slice::from_ref(&waits)), said);
        let wait = unserved_waits(&waits.ports);
        assert_eq!(
            wait[0].sentence(),
            "a waited from 1.50 s to the end for the service /idel, which nobody serves"
        );
    }
}
