//! `hrdsl sim` and what robot code needs: which Python, which packages, and what the console says of them.
#![allow(clippy::disallowed_methods, reason = "tests start the binary")]

mod support;

use std::{fs, path::Path, process::Output};

use serde_json::Value;
use support::{command, expect_code, folder, handover, root, stderr};

const ROBOT: &str = "import sys\nimport mylib\nsys.exit('says ' + mylib.GREETING + ' in ' + sys.prefix)\n";

/// A wheel in a folder `links`; with a mark that makes it another one than that of any other test.
fn wheel(folder: &Path, links: &str, version: &str) {
    let greeting = format!("GREETING = {version:?}  # {}\n", folder.display());
    let script = format!(
        "import os, zipfile; os.makedirs({links:?}, exist_ok=True)\n\
        z = zipfile.ZipFile('{links}/mylib-{version}-py3-none-any.whl', 'w'); d = 'mylib-{version}.dist-info/'\n\
        z.writestr('mylib.py', {greeting:?})\n\
        z.writestr(d + 'METADATA', 'Metadata-Version: 2.1\\nName: mylib\\nVersion: {version}\\n')\n\
        z.writestr(d + 'WHEEL', 'Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n')\n\
        z.writestr(d + 'RECORD', ''); z.close()"
    );
    python(folder, &["-c", &script]);
}

fn python(folder: &Path, args: &[&str]) {
    let status = std::process::Command::new("python3").args(args).current_dir(folder).status();
    assert!(status.unwrap().success());
}

/// The example with another robot, started by this command.
fn project(run: &str, robot: &str) -> tempfile::TempDir {
    let text = fs::read_to_string(handover()).unwrap();
    let text = text.replace("limit 300 s", "limit 40 s\n  budget 20 s").replace("python3 robot.py", run);
    folder(&[("scenario.hri", &text), ("robot.py", robot)])
}

/// Runs one test, from another folder than the scenario's.
fn sim(folder: &Path, variables: &[(&str, &str)]) -> (Output, String) {
    let elsewhere = tempfile::tempdir().unwrap();
    let scenario = folder.join("scenario.hri");
    let out = command()
        .args(["sim", scenario.to_str().unwrap(), "--suite", "random_tests", "-n", "1", "-o", "out"])
        .current_dir(elsewhere.path())
        .envs(variables.iter().copied())
        .output()
        .unwrap();
    let results = fs::read(elsewhere.path().join("out/results.json"));
    let results: Value = results.map_or(Value::Null, |text| serde_json::from_slice(&text).unwrap());
    let error = results["tests"][0]["error"].as_str().unwrap_or_default().to_owned();
    (out, error)
}

/// What pip is told beside the requirements counts: by variables and by its configuration file.
#[test]
fn pips_configuration_decides_what_is_tested() {
    let folder = project("python3 robot.py", ROBOT);
    let folder = folder.path();
    fs::write(folder.join("requirements.txt"), "mylib\n").unwrap();
    wheel(folder, "one", "1.0");
    wheel(folder, "two", "2.0");
    let [one, two] = ["one", "two"].map(|links| folder.join(links).display().to_string());
    let conf = folder.join("pip.conf").display().to_string();
    let variables =
        |links| [("PIP_NO_INDEX", "1"), ("PIP_FIND_LINKS", links), ("PIP_CONFIG_FILE", "/dev/null")];

    let (out, error) = sim(folder, &variables(&one));
    expect_code(&out, 3);
    assert!(error.contains("says 1.0"), "{error}");
    let said = stderr(&out);
    assert!(said.contains("installing mylib …\n") && said.contains("installed mylib in "), "{said}");

    let (out, error) = sim(folder, &[variables(&one)[0], variables(&one)[1], ("PIP_TIMEOUT", "7")]);
    assert!(error.contains("says 1.0") && !stderr(&out).contains("install"), "{}", stderr(&out));

    let (_, error) = sim(folder, &variables(&two));
    assert!(error.contains("says 2.0"), "{error}");

    fs::write(&conf, format!("[global]\nno-index = true\n[install]\nfind-links =\n    {one}\n    {two}\n"))
        .unwrap();
    let configured = [("PIP_CONFIG_FILE", conf.as_str()), ("PIP_FIND_LINKS", "")];
    let (_, error) = sim(folder, &configured);
    assert!(error.contains("says 2.0"), "{error}");
    fs::remove_file(folder.join("two/mylib-2.0-py3-none-any.whl")).unwrap();
    let (_, error) = sim(folder, &configured);
    assert!(error.contains("says 1.0"), "{error}");
    forget(folder);
}

/// Removes what was installed for a project: it serves no other test.
fn forget(project: &Path) {
    for entry in fs::read_dir(root().join("target/hrdsl-cache")).unwrap().flatten() {
        let text = fs::read_to_string(entry.path().join("mylib.py")).unwrap_or_default();
        if text.contains(&project.display().to_string()) {
            fs::remove_dir_all(entry.path()).unwrap();
        }
    }
}

#[test]
fn the_run_command_says_which_python() {
    let folder = project(".venv/bin/python robot.py", ROBOT);
    python(folder.path(), &["-m", "venv", "--without-pip", ".venv"]);
    let lib = fs::read_dir(folder.path().join(".venv/lib")).unwrap().next().unwrap().unwrap();
    fs::write(lib.path().join("site-packages/mylib.py"), "GREETING = 'hello'\n").unwrap();
    let (out, error) = sim(folder.path(), &[]);
    expect_code(&out, 3);
    assert!(error.contains("says hello"), "{error}");

    let folder = project("nowhere/bin/python robot.py", ROBOT);
    let (out, _) = sim(folder.path(), &[]);
    expect_code(&out, 2);
    assert!(stderr(&out).contains("/nowhere/bin/python` (install Python"), "{}", stderr(&out));
}
