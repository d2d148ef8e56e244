//! Worlds for tests, as text.
#![allow(dead_code, reason = "each test binary uses its own part")]

use hrdsl_compiler::InputFile;
use hrdsl_ir::event::StimulusStep;
use hrdsl_ir::world::{BodyId, Signal, SignalId, World};
use hrdsl_ir::{Nanos, Program};
use hrdsl_sim::WorldSimulation;

/// A scenario in a world of its own.
pub struct Scene {
    pub program: Program,
    pub sim: WorldSimulation,
}

impl Scene {
    /// `members` is what is in the world, `stimuli` what `someone` can do, each by a name and the actions of its body.
    pub fn new(members: &str, stimuli: &[(&str, &str)]) -> Scene {
        Scene::with("", members, stimuli)
    }

    /// The same with more modules than `std.person`.
    pub fn with(uses: &str, members: &str, stimuli: &[(&str, &str)]) -> Scene {
        let stimuli: String =
            stimuli.iter().map(|(name, body)| format!("stimulus {name} by someone {{ {body} }}\n")).collect();
        let text = format!(
            "scenario scene\nuse std.person\n{uses}\nactor someone : environment\nactor robot : system\n{stimuli}world {{\n{members}\n}}\n"
        );
        let compiled = hrdsl_compiler::compile(InputFile { name: "scene.hri", text: &text }, &[]);
        let issues: Vec<String> =
            compiled.diagnostics.iter().filter(|d| d.is_error()).map(|d| format!("{d:?}")).collect();
        let program = compiled.program.unwrap_or_else(|| panic!("{text}\n{}", issues.join("\n")));
        let sim = built(program.world.as_ref().expect("a world"), &program.signals);
        Scene { program, sim }
    }

    /// Begins anew, with another physics step.
    pub fn at_step(&mut self, step: Nanos) {
        let world = self.program.world.as_mut().expect("a world");
        world.step = step;
        self.sim = built(world, &self.program.signals);
    }

    pub fn body(&self, name: &str) -> BodyId {
        let world = self.program.world.as_ref().expect("a world");
        let at = world.bodies.iter().position(|b| b.name == name).unwrap_or_else(|| panic!("no body {name}"));
        BodyId(u16::try_from(at).expect("few bodies"))
    }

    /// The value of a signal now.
    pub fn read(&self, name: &str) -> f64 {
        let at = self.program.signals.iter().position(|s| s.name == name);
        let at = u16::try_from(at.unwrap_or_else(|| panic!("no signal {name}"))).expect("few signals");
        let value = self.sim.read(SignalId(at));
        value.as_f64().or_else(|| value.as_bool().map(f64::from)).expect("a number or a truth")
    }

    pub fn at(&self, name: &str) -> [f64; 3] {
        self.sim.pose(self.body(name)).expect("a body").0
    }

    /// Begins the actions of a stimulus, all at once.
    pub fn act(&mut self, stimulus: &str) {
        let event = self.program.events.iter().find(|e| e.name == stimulus).expect("a stimulus");
        for step in &event.stimulus.as_ref().expect("a stimulus").steps {
            let StimulusStep::Act(action) = step else { panic!("actions alone") };
            self.sim.act(action, &|_| None).unwrap_or_else(|e| panic!("{stimulus}: {e}"));
        }
    }

    /// Lets time pass, in steps; `each` looks at every one.
    pub fn go_on(&mut self, seconds: f64, mut each: impl FnMut(&Scene)) {
        let end = self.sim.now() + (seconds * 1e9) as Nanos;
        let step = self.program.world.as_ref().expect("a world").step;
        while self.sim.now() < end {
            self.sim.advance(self.sim.now() + step);
            each(self);
        }
    }
}

fn built(world: &World, signals: &[Signal]) -> WorldSimulation {
    WorldSimulation::new(world, signals).unwrap_or_else(|e| panic!("{e}"))
}
