//! What is known of the energy of everything that forces move, between one step and the next.

/// What is known of the energy, and the first fault that was found.
#[derive(Clone, Debug, Default)]
pub struct EnergyWatch {
    /// By body of the scenario, if forces alone move it: its energies of motion and of height, J.
    pub known: Vec<Option<(f64, f64)>>,
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
