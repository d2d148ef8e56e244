//! What to write in the place of commands by which nodes are started where ROS is installed.

use std::path::Path;

/// Programs of ROS that start others.
const STARTERS: [&str; 4] = ["ros2", "rosrun", "roslaunch", "roscore"];

/// Where packages say which commands they have, and what stands between two of them there.
const DECLARATIONS: [(&str, &[char]); 3] =
    [("setup.py", &[',', '[', ']', '(', ')', '{', '}']), ("setup.cfg", &['\n']), ("pyproject.toml", &['\n'])];

/// What was looked for and what to write instead, if the command cannot work: a starter of ROS, or an entry point of the
/// package in the folder, which is not installed.
pub(crate) fn advice(word: &str, rest: &[String], dir: &Path) -> Option<String> {
    if STARTERS.contains(&word) {
        // `ros2 run PACKAGE NAME`, `rosrun PACKAGE NAME`
        let names = if word == "ros2" { rest.get(1..) } else { Some(rest) };
        let name = names.and_then(|names| names.get(1)).filter(|_| word != "roslaunch");
        let found = name.and_then(|name| command(name, dir));
        let instead = found.unwrap_or_else(|| "python3 -m PACKAGE.MODULE`, or `python3 SCRIPT".to_owned());
        return Some(format!(
            "`{word}`, and no ROS is used: each node is a program of its own; write `{instead}`"
        ));
    }
    if word.contains('/') || on_path(word) {
        return None;
    }
    let instead = command(word, dir)?;
    Some(format!("`{word}`, an entry point of a package that is not installed: write `{instead}`"))
}

/// The command that does what an entry point of this name does, or the script of this name.
fn command(name: &str, dir: &Path) -> Option<String> {
    for (file, between) in DECLARATIONS {
        let text = std::fs::read_to_string(dir.join(file)).unwrap_or_default();
        if let Some((module, function)) = text.split(between).find_map(|part| entry_point(part, name)) {
            let is_run = module_file(&module, dir).is_some_and(|text| text.contains("__main__"));
            return Some(if is_run {
                format!("python3 -m {module}")
            } else {
                format!("python3 -c 'from {module} import {function}; {function}()'")
            });
        }
    }
    let scripts = ["scripts", "nodes", "bin"].map(|folder| format!("{folder}/{name}"));
    scripts.into_iter().find(|script| dir.join(script).is_file()).map(|script| format!("python3 {script}"))
}

/// The text of a module in the folder.
fn module_file(module: &str, dir: &Path) -> Option<String> {
    std::fs::read_to_string(dir.join(module.replace('.', "/")).with_extension("py")).ok()
}

/// The module and the function of an entry point such as `'brain = tea_bot.brain:main'`, if it has this name.
fn entry_point(part: &str, name: &str) -> Option<(String, String)> {
    let bare: String =
        part.chars().filter(|c| !matches!(c, '\'' | '"' | '\\') && !c.is_whitespace()).collect();
    let (own, target) = bare.split_once('=')?;
    let (module, function) = target.split_once(':').filter(|_| own == name)?;
    let is_name =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.'));
    (is_name(module) && is_name(function)).then(|| (module.to_owned(), function.to_owned()))
}

fn on_path(word: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(word).is_file())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::advice;

    const SETUP: &str = "setup(entry_points={
        'console_scripts': [
            'brain = tea_bot.brain:main', \"kettle=\"
            'tea_bot.kettle:run',
        ],
    })";

    #[test]
    fn what_is_written_instead() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(
            dir.path().join("setup.cfg"),
            "[options.entry_points]\nconsole_scripts =\n  brew = tea_bot:brew\n",
        )
        .unwrap();
        fs::write(dir.path().join("setup.py"), SETUP).unwrap();
        for folder in ["tea_bot", "scripts"] {
            fs::create_dir(dir.path().join(folder)).unwrap();
        }
        fs::write(dir.path().join("tea_bot/brain.py"), "if __name__ == '__main__':\n    main()\n").unwrap();
        fs::write(dir.path().join("tea_bot/kettle.py"), "def run(): ...\n").unwrap();
        fs::write(dir.path().join("scripts/pour"), "").unwrap();
        let told = |words: &[&str]| {
            let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
            advice(&words[0], &words[1..], dir.path()).unwrap_or_default()
        };
        assert!(told(&["brain"]).ends_with("write `python3 -m tea_bot.brain`"));
        assert!(told(&["kettle"]).ends_with("write `python3 -c 'from tea_bot.kettle import run; run()'`"));
        assert!(told(&["brew"]).ends_with("write `python3 -c 'from tea_bot import brew; brew()'`"));
        assert!(told(&["ros2", "run", "tea_bot", "brain"]).ends_with("write `python3 -m tea_bot.brain`"));
        assert!(told(&["rosrun", "tea_bot", "pour"]).ends_with("write `python3 scripts/pour`"));
        assert!(
            told(&["roslaunch", "tea_bot", "brain"])
                .ends_with("write `python3 -m PACKAGE.MODULE`, or `python3 SCRIPT`")
        );
        assert_eq!(told(&["tea"]), "");
        assert_eq!(told(&["./brain"]), "");
        assert_eq!(told(&["sh"]), "");
    }
}
