//! The command that runs one test of a campaign again.

use std::path::Path;

use super::{SimArgs, choices::ReplaysArg, physics_steps};
use crate::{commands::campaign::is_file_name, files::relative};

/// The command that runs one test again, up to its name, as it is typed in the folder of the results: so it stays the same
/// wherever both lie.
pub fn words(args: &SimArgs, out: &Path) -> String {
    let mut words = vec!["hrdsl sim".to_owned(), quoted(&relative(&args.campaign.file, out))];
    if args.campaign.tests.is_empty() {
        words.push("tests".to_owned());
    }
    words.extend(args.campaign.tests.iter().map(|t| quoted(&relative(t, out))));
    let times = [("--cpu-limit", args.campaign.cpu_limit), ("--wall-limit", args.campaign.wall_limit)];
    let times = times.iter().filter_map(|(name, t)| Some(format!("{name} {}ms", (*t)?.as_millis())));
    let sizes =
        [("--memory-limit", args.campaign.memory_limit), ("--output-limit", args.campaign.output_limit)];
    let sizes = sizes.iter().filter_map(|(name, size)| Some(format!("{name} {}", (*size)?)));
    // The hashes of texts follow from it.
    words.extend((args.campaign.seed != 0).then(|| format!("--seed {}", args.campaign.seed)));
    words.extend(args.schedule.map(|k| format!("--schedule {k}")));
    words.extend(args.physics_step.map(physics_steps::option));
    let system = |name: &String| {
        if is_file_name(name) { quoted(&relative(Path::new(name), out)) } else { name.clone() }
    };
    words.extend(args.campaign.system.iter().map(|name| format!("--system {}", system(name))));
    words.extend(times.chain(sizes));
    words.extend(args.campaign.observation.words());
    words.push("--test".to_owned());
    words.join(" ")
}

/// The command that makes a page of one test, up to its name, as it is typed in the folder of the results; empty if no test is recorded for it.
pub fn view_of_results(args: &SimArgs, out: &Path) -> String {
    if args.replays == ReplaysArg::None {
        return String::new();
    }
    format!("hrdsl view {} --results .", quoted(&relative(&args.campaign.file, out)))
}

/// The line that says how a test is looked at.
pub fn view_words(args: &SimArgs) -> String {
    let results = args.out.as_ref().map(|out| format!(" --results {}", quoted(out))).unwrap_or_default();
    format!("to look at one test: hrdsl view {} NAME{results}\n", quoted(&args.campaign.file))
}

/// A word for a shell.
pub fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+=:@%,".contains(c);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}
