//! TChecker's figures: from the file beside the bench, or measured on this machine.

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use nix::sys::resource::{UsageWho, getrusage};

/// TChecker's best algorithm on a model.
#[derive(Clone, Debug)]
pub struct PeerFigures {
    pub algorithm: String,
    /// Symbolic states stored.
    pub stored: u64,
    /// User and system.
    pub seconds: f64,
    /// The most that was resident.
    pub megabytes: f64,
}

/// Where TChecker's figures come from.
pub enum Peer {
    /// The lines of the file, and what they say of themselves.
    Known(Vec<(String, i64, PeerFigures)>, String),
    /// `tck-reach`, and the folder of its generators.
    Here(PathBuf, PathBuf),
}

/// Family, size, algorithm, stored, seconds, megabytes; `#`: what they were measured with.
const FILE: &str = include_str!("../tchecker.csv");

/// Our family, and the generator's name.
const GENERATORS: [(&str, &str); 10] = [
    ("fischer", "fischer"),
    ("csma_cd", "csmacd"),
    ("critical_region", "critical-region"),
    ("train_gate", "train_gate"),
    ("fire_alarm", "fire-alarm"),
    ("fischer_async", "fischer-async"),
    ("corsso", "corsso"),
    ("philosophers", "dining-philosophers"),
    ("fddi", "fddi"),
    ("parallel", "parallel"),
];

/// With local time, by inclusion, and by aLU.
const ALGORITHMS: [&str; 3] = ["concur19", "covreach", "aLU-covreach"];

/// Seconds that the first algorithm may take; the next may take three times as many as the best, and one more.
const LIMIT: f64 = 600.0;

/// A process without input.
#[allow(clippy::disallowed_methods, reason = "a bench measures whole processes")]
pub fn command(program: &Path) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null());
    command
}

/// Processor seconds of the processes that were waited for.
pub fn children_seconds() -> f64 {
    let Ok(usage) = getrusage(UsageWho::RUSAGE_CHILDREN) else { return 0.0 };
    let seconds = |t: nix::sys::time::TimeVal| t.tv_sec() as f64 + t.tv_usec() as f64 * 1e-6;
    seconds(usage.user_time()) + seconds(usage.system_time())
}

impl Peer {
    /// # Errors
    /// What is missing to measure.
    pub fn of(program: Option<&str>, examples: Option<&str>) -> Result<Self, String> {
        let Some(examples) = examples else {
            return match program {
                None => Ok(Self::known()),
                Some(_) => {
                    Err("say with --examples where TChecker's generators are, its folder `examples`".into())
                }
            };
        };
        let on_path = || {
            let path = std::env::var_os("PATH")?;
            std::env::split_paths(&path).map(|p| p.join("tck-reach")).find(|p| p.is_file())
        };
        let program = program.map(PathBuf::from).or_else(on_path);
        let program = program.filter(|p| p.is_file()).ok_or("there is no tck-reach: give --tchecker PATH")?;
        Ok(Self::Here(program, PathBuf::from(examples)))
    }

    fn known() -> Self {
        let lines = FILE.lines().filter(|line| !line.starts_with('#')).skip(1);
        let known = lines.filter_map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let &[family, size, algorithm, stored, seconds, megabytes] = fields.as_slice() else {
                return None;
            };
            let figures = PeerFigures {
                algorithm: algorithm.to_owned(),
                stored: stored.parse().ok()?,
                seconds: seconds.parse().ok()?,
                megabytes: megabytes.parse().ok()?,
            };
            Some((family.to_owned(), size.parse().ok()?, figures))
        });
        let said = FILE.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or_default();
        Self::Known(known.collect(), said.to_owned())
    }

    /// With what the figures were measured.
    pub fn origin(&self) -> String {
        match self {
            Peer::Known(_, said) => format!(
                "{said}.\nIts seconds are that machine's, ours are this one's: to compare them, measure both with --tchecker and --examples"
            ),
            Peer::Here(program, _) => format!("{}, measured now", program.display()),
        }
    }

    /// The algorithm that takes the fewest seconds.
    pub fn best(&self, family: &str, size: i64) -> Option<PeerFigures> {
        let all: Vec<PeerFigures> = match self {
            Peer::Known(lines, _) => {
                let of = lines.iter().filter(|(f, s, _)| f == family && *s == size);
                of.map(|(_, _, figures)| figures.clone()).collect()
            }
            Peer::Here(program, examples) => {
                let generator = GENERATORS.iter().find(|g| g.0 == family)?.1;
                let model = model(&examples.join(format!("{generator}.sh")), size)?;
                let (mut all, mut limit) = (Vec::new(), LIMIT);
                for algorithm in ALGORITHMS {
                    if let Some(figures) = measured(program, algorithm, model.path(), limit) {
                        limit = limit.min(3.0 * figures.seconds + 1.0);
                        all.push(figures);
                    }
                }
                all
            }
        };
        all.into_iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }
}

/// What the generator prints, as a file.
fn model(generator: &Path, size: i64) -> Option<tempfile::NamedTempFile> {
    let file = tempfile::NamedTempFile::new().ok()?;
    let out = file.reopen().ok()?;
    let made = command(Path::new("bash")).arg(generator).arg(size.to_string()).stdout(out).status().ok()?;
    made.success().then_some(file)
}

/// `None`: the algorithm does not serve the model, or takes too long.
fn measured(program: &Path, algorithm: &str, model: &Path, limit: f64) -> Option<PeerFigures> {
    let before = children_seconds();
    let mut command = command(Path::new("timeout"));
    command
        .arg(limit.to_string())
        .arg(program)
        .args(["-a", algorithm, "-s", "bfs"])
        .arg(model)
        .stderr(Stdio::null());
    let out = command.output().ok()?;
    let seconds = children_seconds() - before;
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let number = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().parse::<u64>().ok()
    };
    let figures = PeerFigures {
        algorithm: algorithm.to_owned(),
        stored: number("STORED_STATES ")?,
        seconds,
        megabytes: number("MEMORY_MAX_RSS ")? as f64 * 1.024e-3,
    };
    out.status.success().then_some(figures)
}
