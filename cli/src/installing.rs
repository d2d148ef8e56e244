//! What is being installed, on standard error: on a terminal one line that moves, elsewhere a line at each end.

use std::{cell::RefCell, time::Duration};

use hrdsl_runtime::campaign::{HookedPackage, PreparationStep};
use indicatif::{ProgressBar, ProgressStyle};

use crate::terminal;

/// How much of what pip says is shown.
const WIDTH: usize = 60;

/// The console while an environment is prepared.
#[derive(Default)]
pub struct InstallProgress {
    line: RefCell<Option<ProgressBar>>,
}

impl InstallProgress {
    /// Shows a step.
    pub fn show(&self, step: PreparationStep<'_>) {
        match step {
            PreparationStep::Waiting { what } => {
                self.begin(&format!("waiting for another process, which installs {what}"));
            }
            PreparationStep::Damaged { what, why } => {
                self.print(&format!("what was installed ({what}) is damaged: {why}"));
            }
            PreparationStep::Started { what } => self.begin(&format!("installing {what}")),
            PreparationStep::Working { what, doing, .. } => {
                if let Some(line) = &*self.line.borrow() {
                    let doing: String = doing.chars().take(WIDTH).collect();
                    line.set_message(format!("installing {what}: {doing}"));
                }
            }
            PreparationStep::Finished { what, elapsed } => {
                self.end();
                self.print(&format!("installed {what} in {}", seconds(elapsed)));
            }
            PreparationStep::Hooked { packages } => self.print(&hooked(packages)),
        }
    }

    fn begin(&self, text: &str) {
        self.end();
        let line = ProgressBar::new_spinner();
        if line.is_hidden() {
            terminal::say_line(format_args!("{text} …"));
            return;
        }
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}  {msg}") {
            line.set_style(style);
        }
        line.set_message(text.to_owned());
        line.enable_steady_tick(Duration::from_millis(100));
        *self.line.borrow_mut() = Some(line);
    }

    fn print(&self, text: &str) {
        match &*self.line.borrow() {
            Some(line) => line.println(text),
            None => terminal::say_line(text),
        }
    }

    fn end(&self) {
        if let Some(line) = self.line.take() {
            line.finish_and_clear();
        }
    }
}

/// The line must not stay on the screen, however the preparation ends.
impl Drop for InstallProgress {
    fn drop(&mut self) {
        self.end();
    }
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

fn hooked(packages: &[HookedPackage]) -> String {
    let mut text = String::from(
        "warning: tests do not find these packages of the interpreter, which are installed as editable by a hook:\n",
    );
    for HookedPackage { package, folder } in packages {
        let line = match folder {
            Some(folder) => format!("  {package}: put its folder into requirements.txt: {folder}\n"),
            None => format!("  {package}: put its folder into requirements.txt\n"),
        };
        text.push_str(&line);
    }
    text + "requirements.txt lies beside the scenario; what it names is installed for the tests alone"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_hook_would_find_is_told_with_its_folder() {
        let package = |package: &str, folder: Option<&str>| HookedPackage {
            package: package.to_owned(),
            folder: folder.map(str::to_owned),
        };
        let text = hooked(&[package("a", Some("/src/a")), package("b", None)]);
        assert!(text.contains("\n  a: put its folder into requirements.txt: /src/a\n  b: put "), "{text}");
    }
}
