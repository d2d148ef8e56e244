//! What is known of the energy of everything that forces move, between one step and the next.

/// What is known of a body that forces alone move.
#[derive(Clone, Copy, Debug)]
pub struct BodyEnergy {
    /// J
    pub motion: f64,
    pub height: f64,
    pub sleeps: bool,
}

/// What is found of all bodies after a step.
pub struct EnergyAfterStep {
    /// The mass of what forces alone move, kg.
    pub loose: f64,
    /// The fastest of what is moved, and can give energy, of late, m/s.
    pub fastest: f64,
}

/// What is known of the energy, and the first fault that was found.
#[derive(Clone, Debug, Default)]
pub struct EnergyWatch {
    /// By body of the scenario, if forces alone move it; and a step before.
    pub known: Vec<Option<BodyEnergy>>,
    pub before: Vec<Option<BodyEnergy>>,
    /// What wheels can have done in the step, J.
    pub wheels: f64,
    /// The fastest of what is moved, of late, m/s.
    pub fastest_moved: f64,
    pub fault: Option<String>,
}

impl EnergyWatch {
    pub fn add_wheels(&mut self, work: f64) {
        self.wheels += work;
    }
}
