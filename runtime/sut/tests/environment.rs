//! What is installed for robot code: that it is what the requirements say now, whatever was installed before.
#![allow(clippy::disallowed_methods, reason = "tests start pythons and pips")]

mod common;

use std::{
    cell::RefCell,
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Barrier,
};

use common::{launch, run};
use hrdsl_sut::{
    EnvironmentNeeds, HookedPackage, PreparationStep, ProgramRequest, PythonEnv, SutError, SutProcess,
};
use tempfile::TempDir;

/// A build backend inside the project, so that nothing is downloaded. As setuptools does, it builds in `build/lib`,
/// packs all that it finds there, and leaves a folder of metadata.
const BACKEND: &str = r#"
import glob, os, shutil, zipfile

def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    os.makedirs("build/lib", exist_ok=True)
    os.makedirs("mylib.egg-info", exist_ok=True)
    for module in glob.glob("mylib*.py"):
        shutil.copy(module, "build/lib")
    name = "mylib-1.0-py3-none-any.whl"
    info = "mylib-1.0.dist-info/"
    with zipfile.ZipFile(os.path.join(wheel_directory, name), "w") as wheel:
        for module in sorted(glob.glob("build/lib/*.py")):
            wheel.write(module, os.path.basename(module))
        wheel.writestr(info + "METADATA", "Metadata-Version: 2.1\nName: mylib\nVersion: 1.0\n")
        wheel.writestr(info + "WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr(info + "RECORD", "")
    return name

build_editable = build_wheel
"#;

const PROJECT: &str = "[build-system]\nrequires = []\nbuild-backend = \"backend\"\nbackend-path = [\".\"]\n[project]\nname = \"mylib\"\nversion = \"1.0\"\n";

/// A project's folder with robot code, its library, and a cache of its own that has all but the requirements.
struct Project {
    folder: TempDir,
    cache: PathBuf,
}

impl Project {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("environment");
        let project = Self { folder, cache };
        project.write("robot.py", "import mylib\nprint(mylib.GREETING)\n");
        project
    }

    fn with_library(greeting: &str) -> Self {
        let project = Self::new();
        project.library("mylib", greeting);
        project
    }

    fn library(&self, folder: &str, greeting: &str) {
        self.write(&format!("{folder}/pyproject.toml"), PROJECT);
        self.write(&format!("{folder}/backend.py"), BACKEND);
        self.greet(folder, greeting);
    }

    fn greet(&self, folder: &str, greeting: &str) {
        // The name of the temporary folder, so that what this test installs nobody has installed before.
        let text = format!("GREETING = {greeting:?}  # {}\n", self.folder.path().display());
        self.write(&format!("{folder}/mylib.py"), &text);
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.at(name).parent().unwrap()).unwrap();
        fs::write(self.at(name), text).unwrap();
    }

    fn prepare_with(
        &self,
        python: &str,
        listen: &dyn Fn(PreparationStep<'_>),
    ) -> Result<PythonEnv, SutError> {
        let list = self.at("requirements.txt");
        let requirements = list.exists().then_some(list.as_path());
        PythonEnv::prepare(
            &EnvironmentNeeds { python, dir: self.folder.path(), requirements, cache: &self.cache },
            listen,
        )
    }

    /// The environment, and what was installed for it.
    fn prepare(&self) -> (PythonEnv, Vec<String>) {
        let installed = RefCell::new(Vec::new());
        let env = self.prepare_with("python3", &|step| {
            if let PreparationStep::Started { what } = step {
                installed.borrow_mut().push(what.to_owned());
            }
        });
        let installed = installed.into_inner().into_iter().filter(|what| what != "coverage.py").collect();
        (env.unwrap(), installed)
    }

    fn output(&self, env: PythonEnv) -> String {
        let mut launch = launch(&["python3", "robot.py"]);
        launch.env = env;
        launch.dir = self.folder.path().to_owned();
        let (requests, finished) = run(&launch);
        assert_eq!(requests.last(), Some(&ProgramRequest::Done), "{}", finished.output);
        finished.output.stdout.text()
    }

    /// What the robot says, and how many times something was installed for that.
    fn greeting(&self) -> (String, usize) {
        let (env, installed) = self.prepare();
        (self.output(env).trim().to_owned(), installed.len())
    }

    /// Where the requirements are installed.
    fn packages(&self) -> PathBuf {
        let script = "import mylib, os\nprint(os.path.dirname(mylib.__file__))\n";
        let robot = fs::read_to_string(self.at("robot.py")).unwrap();
        self.write("robot.py", script);
        let folder = self.greeting().0;
        self.write("robot.py", &robot);
        PathBuf::from(folder)
    }

    /// The temporary folders in the cache of a project that has one of its own.
    fn unfinished(&self) -> Vec<String> {
        let names = fs::read_dir(&self.cache).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.contains("making")).collect()
    }
}

/// What it installed serves no other test.
impl Drop for Project {
    fn drop(&mut self) {
        let mark = self.folder.path().display().to_string();
        for entry in fs::read_dir(&self.cache).into_iter().flatten().flatten() {
            let text = fs::read_to_string(entry.path().join("mylib.py")).unwrap_or_default();
            if text.contains(&mark) {
                let _ = fs::remove_dir_all(entry.path());
                let _ = fs::remove_file(self.cache.join(format!(".{}.lock", entry.file_name().display())));
            }
        }
    }
}

fn expect(said: (String, usize), greeting: &str, installed: usize) {
    assert_eq!((said.0.as_str(), said.1), (greeting, installed));
}

#[test]
fn projects_with_the_same_line_do_not_share_what_differs() {
    let [one, two] = ["one", "two"].map(Project::with_library);
    for project in [&one, &two] {
        project.write("requirements.txt", "./mylib\n");
    }
    expect(one.greeting(), "one", 1);
    expect(two.greeting(), "two", 1);
    expect(one.greeting(), "one", 0);
}

/// However the folder is named: its contents decide, and only they.
#[test]
fn an_edited_library_is_installed_again() {
    for list in ["-e ./mylib", "mylib @ file:mylib", "-r more/list.txt", "./mylib ; python_version >= '3'"] {
        let project = Project::with_library("old");
        project.write("more/list.txt", "--requirement=list2.txt\n");
        project.write("more/list2.txt", "./mylib\n");
        project.write("requirements.txt", list);
        expect(project.greeting(), "old", 1);
        project.write("mylib/__pycache__/mylib.cpython-311.pyc", "x");
        project.write("mylib/build/lib/mylib.py", "x");
        project.write("mylib/.git/HEAD", "x");
        project.write("mylib/venv/pyvenv.cfg", "x");
        expect(project.greeting(), "old", 0);
        project.greet("mylib", "new");
        expect(project.greeting(), "new", 1);
    }
}

/// What tools left in the folder before gets into no test, and the folder stays as it was.
#[test]
fn libraries_are_built_from_a_copy() {
    let project = Project::with_library("clean");
    project.write("requirements.txt", "-e ./mylib");
    project.write("mylib/build/lib/mylib_deleted.py", "");
    let before = tree(&project.at("mylib"));
    project.write(
        "robot.py",
        "import mylib\ntry:\n    import mylib_deleted\nexcept ImportError:\n    print('gone')\n",
    );
    expect(project.greeting(), "gone", 1);
    assert_eq!(tree(&project.at("mylib")), before, "nothing is written into the user's folder");
}

#[test]
fn archives_and_folders_of_archives_count_by_their_contents() {
    for list in [
        "./mylib-1.0-py3-none-any.whl",
        "--no-index\n-f .\nmylib",
        "--no-index\n-c limits.txt\n--find-links .\nmylib",
    ] {
        let project = Project::new();
        project.write("limits.txt", "mylib<2\n");
        project.write("requirements.txt", list);
        wheel(&project, "mylib-1.0-py3-none-any.whl", "old");
        expect(project.greeting(), "old", 1);
        wheel(&project, "mylib-1.0-py3-none-any.whl", "new");
        expect(project.greeting(), "new", 1);
        expect(project.greeting(), "new", 0);
    }
}

/// pip keeps what it built of an archive under the archive's name.
#[test]
fn an_archive_of_sources_is_built_again() {
    let project = Project::with_library("old");
    project.write("requirements.txt", "./mylib-1.0.tar.gz");
    let pack = || {
        project.write("mylib/PKG-INFO", "Metadata-Version: 2.1\nName: mylib\nVersion: 1.0\n");
        let script = "import tarfile; t = tarfile.open('mylib-1.0.tar.gz', 'w:gz'); t.add('mylib', 'mylib-1.0'); t.close()";
        python(&project, &["-c", script]);
    };
    pack();
    expect(project.greeting(), "old", 1);
    project.greet("mylib", "new");
    pack();
    expect(project.greeting(), "new", 1);
}

#[test]
fn a_constraint_that_changes_is_seen() {
    let project = Project::new();
    for version in ["1.0", "2.0"] {
        wheel(&project, &format!("mylib-{version}-py3-none-any.whl"), version);
    }
    project.write("requirements.txt", "--no-index --find-links .\nmylib\n-c limits.txt\n");
    project.write("limits.txt", "mylib<2\n");
    expect(project.greeting(), "1.0", 1);
    project.write("limits.txt", "mylib<3\n");
    expect(project.greeting(), "2.0", 1);
}

#[test]
fn a_damaged_folder_is_noticed_and_made_again() {
    let project = Project::with_library("whole");
    project.write("requirements.txt", "./mylib");
    expect(project.greeting(), "whole", 1);
    let packages = project.packages();
    let module = packages.join("mylib.py");
    let damages: [&dyn Fn(); 4] = [
        &|| fs::remove_file(&module).unwrap(),
        &|| fs::write(&module, "GREETING = 'wrong'\n").unwrap(),
        &|| fs::write(packages.join(".hrdsl-manifest.json"), "{").unwrap(),
        &|| fs::remove_dir_all(&packages).and_then(|()| fs::create_dir(&packages)).unwrap(),
    ];
    for damage in damages {
        damage();
        expect(project.greeting(), "whole", 1);
        expect(project.greeting(), "whole", 0);
    }
    let files_of_programs = packages.join("mylib_cache.bin");
    fs::write(files_of_programs, "x").unwrap();
    expect(project.greeting(), "whole", 0);
}

#[test]
fn of_several_that_need_the_same_one_installs_and_the_others_wait() {
    let project = Project::with_library("once");
    project.write("requirements.txt", "./mylib");
    let together = Barrier::new(3);
    let installed: Vec<usize> = std::thread::scope(|scope| {
        let prepare = || {
            together.wait();
            project.prepare().1.len()
        };
        let threads: Vec<_> = (0..3).map(|_| scope.spawn(prepare)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert_eq!(installed.iter().sum::<usize>(), 1, "{installed:?}");
    expect(project.greeting(), "once", 0);
}

#[test]
fn what_an_interrupted_installation_leaves_is_removed() {
    let mut project = Project::with_library("whole");
    project.cache = project.at("cache");
    project.write("requirements.txt", "./mylib");
    project.write("cache/.packages-0123.making-abc/made/mylib.py", "");
    project.write("mylib/backend.py", "raise SystemExit('no')\n");
    assert!(project.prepare_with("python3", &|_| {}).is_err());
    assert!(project.unfinished().is_empty(), "{:?}", project.unfinished());
    let tag = fs::read_to_string(project.at("cache/CACHEDIR.TAG")).unwrap();
    assert!(tag.starts_with("Signature: 8a477f597d28d172789f06886806bc55"));
}

/// Else what was half of one state and half of another would be kept as the one.
#[test]
fn a_library_that_changes_while_it_is_installed_is_not_kept() {
    let project = Project::with_library("old");
    project.write("requirements.txt", "./mylib");
    let edit = format!("open({:?}, 'a').write('#')\n", project.at("mylib/mylib.py").display().to_string());
    project.write("mylib/backend.py", &format!("{edit}{BACKEND}"));
    let error = project.prepare_with("python3", &|_| {}).unwrap_err().to_string();
    assert!(error.contains("changed while they were installed"), "{error}");
    project.write("mylib/backend.py", BACKEND);
    project.greet("mylib", "new");
    expect(project.greeting(), "new", 1);
}

#[test]
fn pip_is_heard_while_it_works() {
    let project = Project::with_library("heard");
    project.write("requirements.txt", "./mylib");
    let steps = RefCell::new(Vec::new());
    let listen = |step: PreparationStep<'_>| steps.borrow_mut().push(format!("{step:?}"));
    project.prepare_with("python3", &listen).unwrap();
    let steps: Vec<String> =
        steps.into_inner().into_iter().filter(|step| step.contains("\"mylib\"")).collect();
    assert!(steps[0].starts_with("Started") && steps.last().unwrap().starts_with("Finished"), "{steps:#?}");
    let folder = project.at("mylib").display().to_string();
    let names = |step: &String| step.starts_with("Working") && step.contains(&folder);
    assert!(steps.iter().any(names), "the folder that the user knows, not the copy: {steps:#?}");
}

#[test]
fn faults_name_the_line_of_the_requirements() {
    for (list, place, what) in [
        ("# head\n\n./none\n", "requirements.txt:3", "`./none`"),
        ("-r more/list.txt\n", "list.txt:2", "no file"),
        (
            "--no-index\nno-such-project-here\n",
            "requirements.txt:2: no-such-project-here",
            "No matching distribution",
        ),
        ("--no-index\n\n./mylib\n", "requirements.txt:3: ./mylib", "the backend says why"),
    ] {
        let project = Project::with_library("x");
        project.write("mylib/backend.py", "raise SystemExit('the backend says why')\n");
        project.write("more/list.txt", "\n-r none.txt");
        project.write("requirements.txt", list);
        let error = project.prepare_with("python3", &|_| {}).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(what), "{list}: {error}");
        assert!(!error.contains("making"), "{error}");
    }
}

#[test]
fn a_list_that_does_not_exist_is_named() {
    let project = Project::new();
    let list = project.at("none/requirements.txt");
    let dir = project.folder.path();
    let needs = EnvironmentNeeds { python: "python3", dir, requirements: Some(&list), cache: &project.cache };
    let error = PythonEnv::prepare(&needs, &|_| {}).unwrap_err();
    let is_named =
        matches!(&error, SutError::Absent { looked_for, .. } if *looked_for == list.display().to_string());
    assert!(is_named, "{error}");
    // Comments alone need no folder.
    project.write("requirements.txt", "# nothing yet\n");
    assert_eq!(project.prepare().1.len(), 0);
}

/// Modules in the scenario's folder, or the one where the command was given, are the program's, not pip's.
#[test]
fn modules_of_the_project_are_not_taken_for_those_of_the_library() {
    let project = Project::with_library("mine");
    project.write("requirements.txt", "./mylib");
    for module in ["json.py", "site.py", "logging.py", "queue.py", "pip.py"] {
        project.write(module, "raise SystemExit('not this one')\n");
    }
    project.write("robot.py", "import sys\nsys.path.pop(0)\nimport mylib\nprint(mylib.GREETING)\n");
    expect(project.greeting(), "mine", 1);
}

#[test]
fn the_interpreter_of_a_virtual_environment_runs_with_its_packages() {
    let project = Project::with_library("from the folder");
    python(&project, &["-m", "venv", "--without-pip", ".venv"]);
    let site = site_packages(&project.at(".venv"));
    fs::write(site.join("mylib.py"), "GREETING = 'from the environment'\n").unwrap();
    fs::create_dir(project.at("beside")).unwrap();
    fs::write(project.at("beside/linked.py"), "GREETING = 'by a line of a .pth file'\n").unwrap();
    fs::write(site.join("linked.pth"), project.at("beside").display().to_string()).unwrap();
    project.write(
        "robot.py",
        "import mylib, linked, sys\nprint(mylib.GREETING, linked.GREETING, sys.executable, sep='|')\n",
    );
    let absolute = project.at(".venv/bin/python").display().to_string();
    let robot = |word: &str, greeting: &str| {
        let mut launch = launch(&[word, "robot.py"]);
        launch.dir = project.folder.path().to_owned();
        launch.env = project.prepare_with(word, &|_| {}).unwrap();
        let version = launch.env.version();
        assert!(version.starts_with("3.") && version.split('.').count() == 3, "{version}");
        let (_, finished) = run(&launch);
        let said = finished.output.stdout.text();
        let parts: Vec<&str> = said.trim().split('|').collect();
        assert_eq!(parts[..2], [greeting, "by a line of a .pth file"], "{}", finished.output);
        assert!(Path::new(parts[2]).starts_with(project.at(".venv/bin")), "{said}");
    };
    for word in [".venv/bin/python", "./.venv/bin/python3", &absolute] {
        robot(word, "from the environment");
    }
    // Requirements come before the interpreter's own packages.
    project.write("requirements.txt", "./mylib");
    robot(".venv/bin/python", "from the folder");
}

/// Its finder is a hook, which does not run: the user learns it once, not by a puzzle.
#[test]
fn an_editable_package_behind_a_hook_is_told() {
    let project = Project::new();
    python(&project, &["-m", "venv", "--without-pip", ".venv"]);
    let site = site_packages(&project.at(".venv"));
    let info = site.join("my_lib-1.0.dist-info");
    fs::create_dir(&info).unwrap();
    fs::write(info.join("RECORD"), "__editable__.my_lib-1.0.pth,sha256=x,1\n").unwrap();
    project.library("code of it", "x");
    let folder = project.at("code of it").display().to_string();
    let url = format!("file://{}", folder.replace(' ', "%20"));
    let origin = format!(r#"{{"url": "{url}", "dir_info": {{"editable": true}}}}"#);
    fs::write(info.join("direct_url.json"), origin).unwrap();
    let hook = "import __editable___my_lib_1_0_finder; __editable___my_lib_1_0_finder.install()\n";
    fs::write(site.join("__editable__.my_lib-1.0.pth"), hook).unwrap();
    let told = RefCell::new(Vec::new());
    let listen = |step: PreparationStep<'_>| {
        if let PreparationStep::Hooked { packages } = step {
            told.borrow_mut().extend(packages.to_vec());
        }
    };
    project.prepare_with(".venv/bin/python", &listen).unwrap();
    let expected = HookedPackage { package: "my_lib".into(), folder: Some(folder) };
    assert_eq!(told.take(), [expected]);
    // Once it is required, there is nothing to tell.
    project.write("requirements.txt", "-e './code of it'");
    project.prepare_with(".venv/bin/python", &listen).unwrap();
    assert_eq!(told.take(), []);
}

#[test]
fn any_python_of_the_path_may_be_named() {
    let project = Project::new();
    let (env, _) = project.prepare();
    let minor = env.version().split('.').nth(1).unwrap().to_owned();
    let word = format!("python3.{minor}");
    let mut launch = launch(&[&word, "-c", "print('here')"]);
    launch.env = project.prepare_with(&word, &|_| {}).unwrap();
    assert_eq!(launch.env.version(), env.version());
    assert_eq!(PythonEnv::interpreter_of([launch.command.as_slice()]), word);
    assert_eq!(PythonEnv::interpreter_of([["./robot".to_owned()].as_slice()]), "python3");
}

/// The last line of the output says what to do.
#[test]
fn a_module_that_is_not_found_is_followed_by_advice() {
    let project = Project::new();
    project.library("libs/mine", "x");
    project.library("outer", "x");
    project.write("tools/plain/helpers.py", "");
    project.write("tools/known.py", "");
    project.write("venv/pyvenv.cfg", "");
    project.write("venv/lib/no_such_thing.py", "");
    let outer = project.at("outer").display().to_string();
    let outer = format!("hrdsl: {outer} is the folder of a project: put `./outer` into requirements.txt");
    for (robot, last) in [
        ("import no_such_thing", "hrdsl: put `no_such_thing` into requirements.txt beside the scenario (or "),
        (
            "import helpers",
            "hrdsl: `helpers` is at tools/plain/helpers.py, where no module is looked for: add `sys.path",
        ),
        ("import mylib", "hrdsl: `mylib` is at libs/mine/mylib.py: put `./libs/mine` into requirements.txt"),
        ("import outer.inner", &outer),
        ("import sys\nsys.path.append('tools')\nimport known.inner", "hrdsl: `known` at "),
        ("import sys\nsys.modules['csv'] = None\nimport csv", "hrdsl: `csv` belongs to Python"),
        ("raise ModuleNotFoundError('mine')", "ModuleNotFoundError: mine"),
        ("def f(:", "SyntaxError: invalid syntax"),
    ] {
        project.write("robot.py", robot);
        let mut launch = launch(&["python3", "robot.py"]);
        launch.dir = project.folder.path().to_owned();
        let mut process = SutProcess::spawn(&launch).unwrap();
        let error = process.next().unwrap_err();
        let stderr = error.output().unwrap().stderr.text();
        assert!(stderr.lines().last().unwrap().starts_with(last), "{robot}: {stderr}");
        assert!(stderr.contains("File \"") && !stderr.contains("runner.py"), "{stderr}");
    }
}

// ── helpers ──

fn python(project: &Project, args: &[&str]) {
    let status = Command::new("python3").args(args).current_dir(project.folder.path()).status();
    assert!(status.unwrap().success());
}

fn wheel(project: &Project, name: &str, greeting: &str) {
    let version = name.split('-').nth(1).unwrap();
    let greeting = format!("GREETING = {greeting:?}  # {}\n", project.folder.path().display());
    let script = format!(
        "import zipfile; z = zipfile.ZipFile({name:?}, 'w'); d = 'mylib-{version}.dist-info/'\n\
        z.writestr('mylib.py', {greeting:?})\n\
        z.writestr(d + 'METADATA', 'Metadata-Version: 2.1\\nName: mylib\\nVersion: {version}\\n')\n\
        z.writestr(d + 'WHEEL', 'Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n')\n\
        z.writestr(d + 'RECORD', ''); z.close()"
    );
    python(project, &["-c", &script]);
}

fn site_packages(environment: &Path) -> PathBuf {
    let lib = fs::read_dir(environment.join("lib")).unwrap().next().unwrap().unwrap();
    lib.path().join("site-packages")
}

/// All files below a folder, with their contents.
fn tree(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path)
            } else {
                files.push((path.clone(), fs::read(path).unwrap()))
            }
        }
    }
    files.sort();
    files
}
