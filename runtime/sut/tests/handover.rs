//! The example's robot code through whole hand-overs, against a scripted person.

mod common;

use std::{collections::BTreeMap, path::PathBuf};

use common::{GRACE, launch, reply};
use hrdsl_harness::SystemArrival;
use hrdsl_ir::{Nanos, Value, value::nanos, value::seconds};
use hrdsl_sut::{
    FinishedProcess, LaunchSpec, ProgramExit, ProgramRequest, ProtocolArgument, ReplyAnswer, SutProcess,
};

/// What the person does with one leg.
#[derive(Clone, Copy, PartialEq)]
enum Person {
    TakesIt,
    LooksAway,
    /// Lets go after the decision, before the release.
    LetsGo,
    SaysNothing,
}

/// Something that will arrive.
#[derive(Clone, Copy, PartialEq)]
enum Coming {
    Event(&'static str),
    /// The end of a command, by the program's number for it, and whether it succeeded.
    Ended(u64, bool),
}

/// A harness in a few lines: time passes in sleeps, waits and motions; the person and the sensors are a script.
struct Harness {
    time: Nanos,
    legs: Vec<Person>,
    offered: usize,
    holds: bool,
    arm_works: bool,
    /// Events to come, and those that came, in order of time.
    queue: Vec<(Nanos, Coming)>,
    mailbox: Vec<(Nanos, Coming)>,
    emitted: Vec<(Nanos, String, BTreeMap<String, ProtocolArgument>)>,
}

impl Harness {
    fn new(legs: &[Person]) -> Self {
        let queue = vec![(nanos(10.0), Coming::Event("leg_request"))];
        let legs = legs.to_vec();
        Self {
            time: 0,
            legs,
            offered: 0,
            holds: false,
            arm_works: true,
            queue,
            mailbox: vec![],
            emitted: vec![],
        }
    }

    fn soon(&mut self, after: f64, event: &'static str) {
        self.later(after, Coming::Event(event));
    }

    fn later(&mut self, after: f64, what: Coming) {
        self.queue.push((self.time + nanos(after), what));
        self.queue.sort_by_key(|(time, _)| *time);
    }

    fn pass(&mut self, until: Nanos) {
        while self.queue.first().is_some_and(|(time, _)| *time <= until) {
            self.mailbox.push(self.queue.remove(0));
        }
        self.time = until;
    }

    fn leg(&self) -> Person {
        self.legs[self.offered.saturating_sub(1).min(self.legs.len() - 1)]
    }

    fn emitted(&mut self, event: &str) {
        match event {
            "handover_offered" => {
                self.offered += 1;
                if self.leg() != Person::SaysNothing {
                    self.holds = true;
                    self.soon(2.0, "human_ready");
                }
            }
            "sense" => self.soon(0.2, "sensed"),
            "decided" if self.leg() == Person::LetsGo => self.holds = false,
            "released" | "discarded" => {
                self.holds = false;
                self.soon(15.0, "leg_request");
            }
            _ => {}
        }
    }

    fn arrival(&self, (time, what): (Nanos, Coming)) -> SystemArrival {
        match what {
            Coming::Event(name) => {
                let readings =
                    [("gaze", self.leg() != Person::LooksAway), ("pressure", self.holds), ("location", true)];
                let args = readings.iter().filter(|_| name == "sensed");
                let args = args.map(|&(k, v)| (k.to_owned(), Value::Bool(v))).collect();
                SystemArrival::Event { name: name.to_owned(), args, time }
            }
            Coming::Ended(call, works) => {
                let how = if works { Ok(()) } else { Err("the planner finds no way".to_owned()) };
                SystemArrival::Ended { call, how }
            }
        }
    }

    fn wait(&mut self, until: Option<Nanos>, give_up: Option<Nanos>) -> ReplyAnswer {
        let limit = until.iter().chain(&give_up).min().copied().unwrap_or(self.time + nanos(300.0));
        while self.mailbox.is_empty() && self.time < limit {
            let next = self.queue.first().map_or(limit, |(time, _)| (*time).min(limit));
            self.pass(next);
        }
        let came = std::mem::take(&mut self.mailbox);
        let arrivals: Vec<SystemArrival> = came.into_iter().map(|coming| self.arrival(coming)).collect();
        ReplyAnswer::Arrived { gave_up: arrivals.is_empty() && give_up == Some(limit), arrivals }
    }

    fn answer(&mut self, request: ProgramRequest) -> ReplyAnswer {
        match request {
            ProgramRequest::Hello { version, .. } => ReplyAnswer::Hello { version, program: "robot".into() },
            // Of `drop` the program keeps the events itself, and asks whether there are such.
            ProgramRequest::Now | ProgramRequest::Drop { .. } | ProgramRequest::Done => ReplyAnswer::Ok,
            ProgramRequest::Emit { event, args } => {
                self.emitted(&event);
                self.emitted.push((self.time, event, args));
                ReplyAnswer::Ok
            }
            ProgramRequest::Wait { until, give_up } => self.wait(until, give_up),
            ProgramRequest::Read { signal } => {
                assert_eq!(signal, "pressure");
                ReplyAnswer::Value(Value::Bool(self.holds))
            }
            ProgramRequest::Act { on, call: Some(call), wait: false, .. } => {
                self.later(1.5, Coming::Ended(call, on != "robot.arm" || self.arm_works));
                ReplyAnswer::Ok
            }
            other => panic!("the SDK does not ask for this: {other:?}"),
        }
    }

    fn run(&mut self, launch: &LaunchSpec) -> FinishedProcess {
        let mut process = SutProcess::spawn(launch).unwrap();
        loop {
            let request = process.next().unwrap();
            let done = request == ProgramRequest::Done;
            let answer = self.answer(request);
            reply(&mut process, self.time, answer);
            if done {
                return process.finish(GRACE);
            }
        }
    }

    fn times(&self, event: &str) -> Vec<f64> {
        self.emitted.iter().filter(|(_, name, _)| name == event).map(|&(time, ..)| seconds(time)).collect()
    }
}

fn robot(seed: u64) -> LaunchSpec {
    let dir = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples/handover");
    LaunchSpec {
        dir,
        seed,
        coverage: vec!["robot.py".into(), "fsm.py".into()],
        lines: false,
        ..launch(&["python3", "robot.py"])
    }
}

#[test]
fn four_legs_to_four_people() {
    let mut harness =
        Harness::new(&[Person::TakesIt, Person::LooksAway, Person::LetsGo, Person::SaysNothing]);
    let finished = harness.run(&robot(3));
    assert_eq!(finished.exit, ProgramExit::Code(0), "{}", finished.output);
    let order: Vec<&str> = harness.emitted.iter().map(|(_, name, _)| name.as_str()).collect();
    let leg = |end| ["handover_offered", "sense", "decided", end];
    let expected = [leg("released"), leg("discarded"), leg("released")].concat();
    assert_eq!(order, [expected, vec!["handover_offered", "timed_out", "discarded"]].concat());
    let ready: Vec<ProtocolArgument> =
        harness.emitted.iter().filter_map(|(.., args)| args.get("ready").cloned()).collect();
    assert_eq!(ready, [true, false, true].map(|b| ProtocolArgument::Scalar(Value::Bool(b))));

    let late: Vec<f64> = harness
        .times("decided")
        .iter()
        .zip(harness.times("released").iter().take(1))
        .map(|(d, r)| r - d)
        .collect();
    assert!(late[0] < 10.0, "the first leg comes in time: {late:?}");
    let held_on = harness.times("released")[1] - harness.times("decided")[2];
    assert!(held_on > 10.0, "this seed's window is long, and the robot holds on: {held_on}");

    let text = finished.output.stdout.text();
    assert!(
        text.contains("legs handled: 4 (released 2, discarded 2)") && text.contains("outcome: finished"),
        "{text}"
    );
    let coverage = finished.coverage.expect("coverage");
    let (all, some) = (coverage[0].statements.len(), coverage[0].executed.len());
    assert!((240..=280).contains(&all), "{all} statements");
    assert!(some * 100 > all * 85, "{some} of {all} statements");
    assert!(coverage[0].executed_branches.len() > coverage[0].branches.len() / 2);
}

#[test]
fn the_same_seed_is_the_same_run() {
    let run = |seed| {
        let mut harness = Harness::new(&[Person::LetsGo]);
        let finished = harness.run(&robot(seed));
        (harness.emitted, finished.output, finished.coverage)
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5).0, run(6).0, "another seed draws another window");
}

#[test]
fn an_arm_that_fails_ends_the_work() {
    let mut harness = Harness::new(&[Person::TakesIt]);
    harness.arm_works = false;
    let finished = harness.run(&robot(1));
    assert_eq!(finished.exit, ProgramExit::Code(0));
    let text = finished.output.stdout.text();
    assert!(text.contains("attempt 3 to rest failed: the planner finds no way"), "{text}");
    assert!(harness.emitted.is_empty());
}
